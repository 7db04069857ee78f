/* unit_signal_split.c - components of an index's variance estimated by a pilot, against errors over many designs of
 * functions with known indices; predicted against actual bias of ratios of means. */
#include "engine/indices/signal_split.h"
#include "engine/numeric/random.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, N = POUND_SPLIT_SIGNALS };

static void parts_of(const struct pound_sample_values *values, const double *u, bool common, uint64_t seed,
                     struct pound_split_parts parts[2 * D])
{
	const struct pound_sampling sampling = {
	    .u = u, .random = true, .fresh_signals = !common, .n_resamples = 400};
	double *scratch = malloc(sizeof *scratch * pound_split_scratch(values));
	pound_split_estimate(values, &sampling, seed, scratch, parts);
	free(scratch);
}

/* Mean components from pilots of a function with noise. */
static void pilots(const struct function *f, int rows, int seeds, struct function_noise noise,
                   struct pound_split_parts mean[2 * D])
{
	memset(mean, 0, sizeof *mean * 2 * D);
	int seen = 0;
	for (int s = 0; s < seeds; s++) {
		struct pound_split_parts parts[2 * D];
		struct pound_sample_values values = function_values(f, rows, (uint64_t)(1000 + s), noise);
		double *u = function_design(rows, (uint64_t)(1000 + s));
		parts_of(&values, u, noise.common, (uint64_t)s, parts);
		const bool known = !isnan(parts[D].rows);
		seen += known;
		for (int k = 0; k < 2 * D && known; k++) {
			mean[k].rows += parts[k].rows;
			mean[k].signals += parts[k].signals;
			mean[k].pairs += parts[k].pairs;
			mean[k].bias += parts[k].bias;
		}
		function_values_free(&values);
		free(u);
	}
	assert_true(seen > seeds / 2);
	for (int k = 0; k < 2 * D; k++)
		mean[k] = (struct pound_split_parts){mean[k].rows / seen, mean[k].signals / seen,
		                                     mean[k].pairs / seen, mean[k].bias / seen};
}

/* Mean square error of all totals from designs of n rows with a number of signals, times n. */
static double total_error(const struct function *f, int rows, int seeds, struct function_noise noise)
{
	double square = 0.0;
	for (int s = 0; s < seeds; s++) {
		struct pound_sample_values values = function_values(f, rows, (uint64_t)s, noise);
		double *u = function_design(rows, (uint64_t)s);
		struct pound_estimate columns[POUND_N_INDICES][D];
		struct pound_indices indices = {0};
		for (int c = 0; c < POUND_N_INDICES; c++)
			indices.index[c] = columns[c];
		const struct pound_sampling sampling = {
		    .u = u, .random = true, .fresh_signals = !noise.common, .n_resamples = 8};
		double *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, &sampling));
		pound_index_columns_indices(&values, &sampling, (uint64_t)s, scratch, &indices);
		for (int j = 0; j < D; j++)
			square += pow(columns[POUND_ST][j].value - f->index[D + j], 2) / (D * seeds) * rows;
		free(scratch);
		free(u);
		function_values_free(&values);
	}
	return square;
}

static void the_variance_of_an_index_follows_its_three_parts(void **state)
{
	(void)state;
	const struct pound_split_parts parts = {.rows = 1.0, .signals = 6.0, .pairs = 12.0, .bias = 0.5};
	check_near(pound_split_variance(&parts, 2), 1.0 + 3.0 + 6.0, 1e-14);
	check_near(pound_split_variance(&parts, 4), 1.0 + 1.5 + 1.0, 1e-14);
	check_near(pound_split_bias(&parts, 5), 0.025, 1e-15);
	// the mean square errors over 60 designs are known to 1 / sqrt(2 60 4) at best; variances of intervals scatter likewise
	const struct function *f = function_named("cusp");
	for (int common = 0; common < 2; common++) {
		struct pound_split_parts mean[2 * D];
		pilots(f, 100, 30, (struct function_noise){N, 1.0, common}, mean);
		for (int r = 2; r <= 12; r *= 2) {
			double foreseen = 0.0;
			for (int j = 0; j < D; j++)
				foreseen += pound_split_variance(&mean[D + j], r) / D;
			const double found = total_error(f, 100, 60, (struct function_noise){r, 1.0, common});
			check_report("%s, %d signals: n x variance of ST %.2f foreseen, %.2f found",
			             common ? "common" : "independent", r, foreseen, found);
			assert_in_range(1000.0 * foreseen / found, 500, 2000);
		}
	}
}

static void without_noise_signals_are_worth_nothing(void **state)
{
	(void)state;
	struct pound_split_parts mean[2 * D];
	pilots(function_named("steps"), 60, 1, (struct function_noise){N, 0.0, true}, mean);
	for (int k = 0; k < 2 * D; k++) {
		check_near(mean[k].signals, 0.0, 1e-9 * mean[k].rows);
		check_near(mean[k].pairs, 0.0, 1e-9 * mean[k].rows);
	}
}

static void plain_means_have_no_bias(void **state)
{
	(void)state;
	struct pound_split_parts mean[2 * D];
	pilots(function_named("g_b"), 60, 1, (struct function_noise){N, 2.0, true}, mean);
	for (int k = 0; k < 2 * D; k++)
		check_near(mean[k].bias, 0.0, 1e-10);
}

/* Values with lognormal denominators; the larger the first input, the weaker the correlation of the numerators with them. */
static void ratios_make(const double *u, int rows, uint64_t seed, int n_signals, double *numerator)
{
	double *denominator = numerator + (size_t)rows * (D + 2) * n_signals;
	for (int i = 0; i < rows; i++)
		for (int p = 0; p < D + 2; p++)
			for (int r = 0; r < n_signals; r++) {
				const double x0 = pound_design_input(u, D, i, pound_order_mask(D, p), 0),
				             x1 = pound_design_input(u, D, i, pound_order_mask(D, p), 1);
				double z[2];
				for (int k = 0; k < 2; k++) {
					const struct pound_stream stream = {
					    .seed = seed, .what = POUND_STREAM_NOISE, .row = i, .signal = 2 * r + k};
					const double v = pound_random_uniform(stream, 0);
					z[k] = log(v / (1.0 - v)) / 1.8138; // logistic, variance 1
				}
				const size_t at = ((size_t)i * (D + 2) + p) * n_signals + r;
				denominator[at] = exp(0.5 * z[0]);
				numerator[at] = (1.0 + x1) * exp(0.5 * ((1.0 - x0) * z[0] + 0.5 * z[1]));
			}
}

/* The mean corrected pick-freeze indices of such values over many designs. */
static void ratios_mean(int rows, int seeds, int n_signals, double mean[2 * D])
{
	memset(mean, 0, sizeof *mean * 2 * D);
	double of[2 * D] = {0}, variance = 0.0;
	for (int s = 0; s < seeds; s++) {
		double *u = function_design(rows, (uint64_t)s);
		double *numerator = malloc(2 * sizeof *numerator * (size_t)rows * (D + 2) * n_signals);
		ratios_make(u, rows, (uint64_t)s, n_signals, numerator);
		const struct pound_sample_values values = {.n_rows = rows,
		                                           .n_inputs = D,
		                                           .n_signals = n_signals,
		                                           .numerator = numerator,
		                                           .denominator =
		                                               numerator + (size_t)rows * (D + 2) * n_signals};
		struct pound_rows kept;
		double *memory = malloc(sizeof *memory * pound_rows_scratch(&values));
		pound_rows_init(&kept, &values, memory);
		struct pound_pick_freeze result;
		double *scratch = malloc(sizeof *scratch * pound_noise_correction_scratch(&values));
		pound_noise_correction_estimates(&kept, (struct pound_resampling){1, 8}, scratch, &result);
		// ratios of sums over the designs, so that ratios of few rows add no bias
		const double v = pound_rows_variance(&kept, kept.plain) * (1.0 - result.signal_total.value);
		variance += v;
		for (int j = 0; j < D; j++) {
			of[j] += v * result.first[j].value;
			of[D + j] += v * result.total[j].value;
		}
		free(scratch);
		free(memory);
		free(numerator);
		free(u);
	}
	for (int k = 0; k < 2 * D; k++)
		mean[k] = of[k] / variance;
}

static void the_bias_of_ratios_of_means_is_foreseen(void **state)
{
	(void)state;
	enum { PILOT = 400, ROWS = 2000, SEEDS = 6 };
	struct pound_split_parts mean[2 * D] = {{0}}, parts[2 * D];
	for (int s = 0; s < SEEDS; s++) {
		double *u = function_design(PILOT, (uint64_t)(100 + s));
		double *numerator = malloc(2 * sizeof *numerator * PILOT * (D + 2) * N);
		ratios_make(u, PILOT, (uint64_t)(100 + s), N, numerator);
		const struct pound_sample_values values = {.n_rows = PILOT,
		                                           .n_inputs = D,
		                                           .n_signals = N,
		                                           .numerator = numerator,
		                                           .denominator = numerator + PILOT * (D + 2) * N};
		parts_of(&values, u, true, 1, parts);
		for (int k = 0; k < 2 * D; k++)
			mean[k].bias += parts[k].bias / SEEDS;
		free(numerator);
		free(u);
	}
	double two[2 * D], many[2 * D], largest = 0.0, off = 0.0;
	ratios_mean(ROWS, 20, 2, two);
	ratios_mean(ROWS, 20, 16, many);
	for (int k = 0; k < 2 * D; k++) {
		const double found = two[k] - many[k], foreseen = pound_split_bias(&mean[k], 2);
		check_report("index %d: bias of two signals %+.3f found, %+.3f foreseen", k, found, foreseen);
		largest = fmax(largest, fabs(found));
		off = fmax(off, fabs(found - foreseen));
	}
	// the bias is visible, and at least half of it is predicted
	assert_true(largest > 0.02);
	assert_true(off < 0.5 * largest);
}

CHECK_MAIN(cmocka_unit_test(the_variance_of_an_index_follows_its_three_parts),
           cmocka_unit_test(without_noise_signals_are_worth_nothing),
           cmocka_unit_test(plain_means_have_no_bias),
           cmocka_unit_test(the_bias_of_ratios_of_means_is_foreseen))
