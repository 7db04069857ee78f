/* design.c - designs by name.  A design fills one column of A or B with probabilities u in (0, 1); the quantile of
 * the input's distribution makes values of them.
 *
 * A column is a function of (seed, matrix, input) alone. */
#include "engine/design.h"

#include "engine/random.h"

#include <assert.h>

struct design {
	const char *name;
	void (*column)(struct pound_stream stream, int rows, int stride, double *u);
};

static void random_column(struct pound_stream stream, int rows, int stride, double *u)
{
	for (int i = 0; i < rows; i++)
		u[(size_t)i * stride] = pound_random_uniform(stream, i);
}

/* Latin hypercube column: one point in each of n equal strata of u, uniform within it, in random order.
 *
 * The place within a stratum has 32 bits and stays off its edges by 2^-33: with up to 2^20 strata neither adding
 * the stratum's number nor dividing by n can round a point into the next one.
 *
 * Source   McKay, Beckman, Conover 1979, Technometrics 21(2), 239-245; Fisher-Yates for the order
 * Test     unit_design: a_latin_hypercube_has_one_point_in_every_stratum_of_every_column
 */
static void latin_column(struct pound_stream stream, int rows, int stride, double *u)
{
	assert(rows <= POUND_ROWS_MAX);
	struct pound_stream order = stream;
	order.signal++;
	for (int i = 0; i < rows; i++) {
		double place = ((double)pound_random_words(stream, i).v[0] + 0.5) * 0x1p-32;
		double point = (i + place) / rows;
		// the inside-out shuffle: the new point takes the place of a random earlier one, or its own
		int k = (int)pound_random_below(order, i, i + 1);
		u[(size_t)i * stride] = u[(size_t)k * stride];
		u[(size_t)k * stride] = point;
	}
}

static const struct design designs[] = {
    {"lhs", latin_column},
    {"random", random_column},
};

enum { DESIGNS = sizeof designs / sizeof designs[0] };

const char *pound_design_name(int row)
{
	return row >= 0 && row < DESIGNS ? designs[row].name : NULL;
}

/* The probabilities that a study's two matrices are made of.
 *
 * Given    study         -                        inputs and design
 * Returns  u             (rows x 2 x n_inputs)    in (0, 1); row i of A, then row i of B
 *
 * Test     unit_design
 */
void pound_design_probabilities(const struct pound_study *study, double *u)
{
	const int d = study->n_inputs;
	for (int matrix = 0; matrix < 2; matrix++)
		for (int j = 0; j < d; j++) {
			struct pound_stream stream = {
			    .seed = study->design.seed, .what = POUND_STREAM_DESIGN, .sample = j, .signal = 2 * matrix};
			designs[study->design.method].column(stream, study->design.rows, 2 * d, u + matrix * d + j);
		}
}

/* The input values of a study's two matrices.
 *
 * Given    study         -                        -            inputs and design
 * Returns  x             (rows x 2 x n_inputs)    the inputs'  row i of A, then row i of B
 *
 * Test     unit_design: values_are_quantiles_of_the_inputs_distributions
 */
void pound_design_fill(const struct pound_study *study, double *x)
{
	const int d = study->n_inputs;
	pound_design_probabilities(study, x);
	for (size_t k = 0; k < (size_t)study->design.rows * 2 * d; k++)
		x[k] = pound_distribution_quantile(&study->inputs[k % d].distribution, x[k]);
}

double pound_design_input(const double *x, int n_inputs, int row, int sample, int j)
{
	bool from_b = sample == POUND_SAMPLE_B || sample == POUND_SAMPLE_MIXED + j;
	return x[((size_t)row * 2 + from_b) * n_inputs + j];
}
