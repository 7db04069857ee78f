/* unit_noise_part.c - the bounds of what the noise of few signals adds to an interval, against the scatter of the index over many
 * draws of the noise with one design. */
#include "engine/indices/indices.h"
#include "engine/numeric/random.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2, ROWS = 200, DRAWS = 100, SEED = 11 };

/* A draw of unit variance; skewed: exponential. */
static double draw(struct pound_stream stream, bool skewed)
{
	const double u = pound_random_uniform(stream, 0);
	return skewed ? -log(u) - 1 : gsl_cdf_ugaussian_Pinv(u);
}

/* Indices of a function with noise of its own in each sample and signal. */
static void indices_of(const struct pound_sample_values *clean, const double *u, int number, double deviation,
                       struct pound_closed_results *results)
{
	const int n_signals = clean->n_signals;
	const size_t n = (size_t)ROWS * SAMPLES * n_signals;
	double *numerator = malloc(sizeof *numerator * n);
	struct pound_sample_values values = *clean;
	values.numerator = numerator;
	for (int i = 0; i < ROWS; i++)
		for (int p = 0; p < SAMPLES; p++)
			for (int r = 0; r < n_signals; r++) {
				const size_t k = ((size_t)i * SAMPLES + p) * n_signals + r;
				struct pound_stream stream = {.seed = (uint64_t)(1000 + number),
				                              .what = POUND_STREAM_NOISE,
				                              .row = i,
				                              .sample = p,
				                              .signal = r};
				numerator[k] = clean->numerator[k] + deviation * draw(stream, number % 2);
			}
	struct pound_rows rows;
	double *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, NULL));
	pound_rows_init(&rows, &values, scratch);
	pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u, .random = true},
	                              POUND_NOISE_REMOVED, scratch + pound_rows_scratch(&values), results, NULL);
	free(scratch), free(numerator);
}

struct summary {
	double truth; /* half width by the noise alone: of the scatter of the index over the draws */
	int inside;   /* draws whose range contains it */
	double low;   /* mean over the draws */
};

/* Over many draws, of the first-order (0) or the total (1) index of an input. */
static struct summary summary_of(const struct pound_estimate (*index)[2][D],
                                 const struct pound_range (*range)[2][D], int which, int j)
{
	struct summary s = {0};
	double mean = 0, squares = 0;
	for (int k = 0; k < DRAWS; k++)
		mean += index[k][which][j].value / DRAWS;
	for (int k = 0; k < DRAWS; k++)
		squares += pow(index[k][which][j].value - mean, 2) / (DRAWS - 1);
	s.truth = POUND_NORMAL_95 * sqrt(squares);
	// the deviation of the draws has a standard error of (2 (DRAWS - 1))^-1/2; three of them
	const double margin = 3 / sqrt(2 * (DRAWS - 1));
	for (int k = 0; k < DRAWS; k++) {
		s.inside += range[k][which][j].low <= s.truth * (1 + margin) &&
		            range[k][which][j].high >= s.truth * (1 - margin);
		s.low += range[k][which][j].low / DRAWS;
	}
	return s;
}

static void the_bounds_hold_what_noise_adds_to_an_interval(void **state)
{
	(void)state;
	static const int signals[] = {4, 6, 9};
	double *u = function_design(ROWS, SEED);
	for (size_t c = 0; c < sizeof signals / sizeof signals[0]; c++) {
		struct pound_estimate(*index)[2][D] = calloc(DRAWS, sizeof *index);
		struct pound_range(*range)[2][D] = calloc(DRAWS, sizeof *range);
		const struct function *f = function_named("ishigami");
		struct pound_sample_values clean =
		    function_values(f, ROWS, SEED, (struct function_noise){.n_signals = signals[c]});
		for (int k = 0; k < DRAWS; k++) {
			struct pound_closed_results results;
			// noise of one signal with the variance of the function
			indices_of(&clean, u, k, sqrt(f->variance), &results);
			memcpy(index[k][0], results.first, sizeof index[k][0]);
			memcpy(index[k][1], results.total, sizeof index[k][1]);
			memcpy(range[k][0], results.noise.first, sizeof range[k][0]);
			memcpy(range[k][1], results.noise.total, sizeof range[k][1]);
		}
		for (int which = 0; which < 2; which++)
			for (int j = 0; j < D; j++) {
				const struct summary s = summary_of(index, range, which, j);
				// 95 of 100, of which a binomial number has a standard deviation of 2.2
				assert_in_range(s.inside, 88, DRAWS);
				// nor are the bounds so wide that they say nothing
				assert_true(s.low > 0.4 * s.truth);
			}
		free(index), free(range);
		function_values_free(&clean);
	}
	free(u);
}

static void bounds_need_four_signals_and_noise_that_is_removed(void **state)
{
	(void)state;
	double *u = function_design(ROWS, SEED);
	for (int n_signals = 3; n_signals <= 4; n_signals++) {
		struct pound_closed_results results;
		struct pound_sample_values clean = function_values(function_named("ishigami"), ROWS, SEED,
		                                                   (struct function_noise){.n_signals = n_signals});
		indices_of(&clean, u, 0, 1, &results);
		for (int j = 0; j < D; j++)
			assert_int_equal(isfinite(results.noise.total[j].low), n_signals >= 4);
		// without noise there is nothing to add
		indices_of(&clean, u, 0, 0, &results);
		for (int j = 0; j < D && n_signals == 4; j++)
			check_near(results.noise.first[j].high, 0, 1e-12);
		function_values_free(&clean);
	}
	free(u);
}

CHECK_MAIN(cmocka_unit_test(the_bounds_hold_what_noise_adds_to_an_interval),
           cmocka_unit_test(bounds_need_four_signals_and_noise_that_is_removed))
