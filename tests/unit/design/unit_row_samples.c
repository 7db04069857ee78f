/* unit_row_samples.c - the combinations of A and B in a row. */
#include "engine/design/row_samples.h"
#include "tests/support/check.h"

static void every_mixture_is_there_once_and_in_the_order_of_the_samples(void **state)
{
	(void)state;
	for (int d = 1; d <= POUND_FACTORIAL_INPUTS_MAX; d++) {
		int n = pound_order_samples(POUND_ORDER_FACTORIAL, d);
		bool seen[1 << POUND_FACTORIAL_INPUTS_MAX] = {false};
		for (int sample = 0; sample < n; sample++) {
			unsigned mask = pound_order_mask(d, sample);
			assert_true(mask < 1u << d);
			assert_true(d == 1 || !seen[mask]); // one input: A with its only column from B is B
			seen[mask] = true;
			assert_int_equal(pound_order_sample(d, mask), d == 1 && sample == 2 ? 1 : sample);
		}
		for (unsigned mask = 0; mask < 1u << d; mask++)
			assert_true(seen[mask]);
	}
}

static void a_row_begins_with_the_same_samples_in_every_order(void **state)
{
	(void)state;
	static const unsigned want[] = {0, 31, 1, 2, 4, 8, 16, 30, 29, 27, 23, 15};
	for (int sample = 0; sample < 12; sample++)
		assert_int_equal(pound_order_mask(5, sample), want[sample]);
	assert_int_equal(pound_order_samples(POUND_ORDER_TOTAL, 5), 7);
	assert_int_equal(pound_order_samples(POUND_ORDER_SECOND, 5), 12);
	assert_int_equal(pound_order_samples(POUND_ORDER_FACTORIAL, 5), 32);
	assert_int_equal(pound_order_samples(POUND_ORDER_SECOND, POUND_INPUTS_MAX) + POUND_GROUPS_MAX,
	                 POUND_SAMPLES_MAX);
}

static void mixtures_that_few_inputs_have_twice_are_made_once(void **state)
{
	(void)state;
	// B with a column from A is A with the other column from B
	assert_int_equal(pound_order_samples(POUND_ORDER_SECOND, 2), 4);
	assert_int_equal(pound_order_sample(2, 2u), 3);
	assert_int_equal(pound_order_samples(POUND_ORDER_SECOND, 1), 3);
}

CHECK_MAIN(cmocka_unit_test(every_mixture_is_there_once_and_in_the_order_of_the_samples),
           cmocka_unit_test(a_row_begins_with_the_same_samples_in_every_order),
           cmocka_unit_test(mixtures_that_few_inputs_have_twice_are_made_once))
