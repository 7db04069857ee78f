/* row_samples.c - the samples of a row, each by the set of columns that it takes from B. */
#include "engine/design/row_samples.h"

#include <assert.h>

unsigned pound_inputs_all(int n)
{
	assert(n >= 1 && n <= POUND_INPUTS_MAX);
	return ~0u >> (POUND_INPUTS_MAX - n);
}

static_assert(POUND_INPUTS_MAX == 8 * sizeof(unsigned), "a bit for each input");

static int total(int n_inputs)
{
	return n_inputs + 2;
}

// two inputs: B with one column from A is A with the other column from B; one input: B with its column from A is A
static int second(int n_inputs)
{
	return n_inputs > 2 ? 2 * n_inputs + 2 : n_inputs + 2;
}

static int factorial(int n_inputs)
{
	assert(n_inputs <= POUND_FACTORIAL_INPUTS_MAX);
	return n_inputs > 2 ? 1 << n_inputs : n_inputs + 2;
}

static const struct {
	const char *name;
	int (*samples)(int n_inputs);
} orders[] = {
    [POUND_ORDER_TOTAL] = {"total", total},
    [POUND_ORDER_SECOND] = {"second", second},
    [POUND_ORDER_FACTORIAL] = {"factorial", factorial},
};

enum { ORDERS = sizeof orders / sizeof orders[0] };

const char *pound_order_name(int row)
{
	return row >= 0 && row < ORDERS ? orders[row].name : NULL;
}

int pound_order_samples(int order, int n_inputs)
{
	return orders[order].samples(n_inputs);
}

/* Whether a mixture takes at least two columns from each matrix; these come last, in ascending order of their masks. */
static bool is_other(int n_inputs, unsigned mask)
{
	int from_b = __builtin_popcount(mask);
	return from_b > 1 && from_b < n_inputs - 1;
}

/* The columns that a sample takes from B.
 *
 * Given    sample   -     from 0
 * Returns  value    -     bit j: column j
 *
 * Test     unit_row_samples: every_mixture_is_there_once_and_in_the_order_of_the_samples
 */
unsigned pound_order_mask(int n_inputs, int sample)
{
	const unsigned all = pound_inputs_all(n_inputs);
	if (sample < 2)
		return sample == POUND_SAMPLE_B ? all : 0;
	if (sample < 2 + n_inputs)
		return 1u << (sample - 2);
	if (sample < 2 + 2 * n_inputs)
		return all ^ 1u << (sample - 2 - n_inputs);
	unsigned mask = 0;
	for (int left = sample - 1 - 2 * n_inputs; left > 0; left -= is_other(n_inputs, mask))
		mask++;
	return mask;
}

/* The first sample that takes these columns from B.
 *
 * Test     unit_row_samples: every_mixture_is_there_once_and_in_the_order_of_the_samples
 */
int pound_order_sample(int n_inputs, unsigned mask)
{
	const unsigned all = pound_inputs_all(n_inputs);
	if (mask == 0 || mask == all)
		return mask ? POUND_SAMPLE_B : POUND_SAMPLE_A;
	if (__builtin_popcount(mask) == 1)
		return 2 + __builtin_ctz(mask);
	if (__builtin_popcount(mask) == n_inputs - 1)
		return 2 + n_inputs + __builtin_ctz(all ^ mask);
	int sample = 2 + 2 * n_inputs;
	for (unsigned other = 0; other < mask; other++)
		sample += is_other(n_inputs, other);
	return sample;
}
