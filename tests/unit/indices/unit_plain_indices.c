/* unit_plain_indices.c - indices of one output from its sample values: known functions, noise, failed runs, intervals. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2 };

struct indices {
	struct pound_indices of;
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX];
	int dropped;
};

static struct indices *indices_of(const struct pound_sample_values *values, uint64_t seed)
{
	struct indices *result = calloc(1, sizeof *result);
	size_t n = pound_plain_scratch(values);
	double *scratch = malloc(sizeof *scratch * n);
	result->of.index[POUND_S1_RAW] = result->first;
	result->of.index[POUND_ST_RAW] = result->total;
	result->dropped =
	    pound_plain_indices(values, (struct pound_resampling){seed, POUND_RESAMPLES}, scratch, &result->of);
	free(scratch);
	return result;
}

static const struct function_noise noiseless = {.n_signals = 1};

static void golden_values_come_out_of_sample_values(void **state)
{
	(void)state;
	// statistics_golden.json, estimators_d2_n6: A, B, AB1, AB2 of each row, as ratios of means of two signals
	static const double y[6][4] = {{3.3, 3.13, 3.25, 3.65},  {1.96, 2.68, 2.88, 2.3},
	                               {3.75, 2.98, 3.6, 3.27},  {3.94, 2.15, 2.62, 2.7},
	                               {1.05, 3.88, 2.65, 3.08}, {1.7, 3.78, 2.26, 2.66}};
	double numerator[6][4][2], denominator[6][4][2];
	for (int i = 0; i < 6; i++)
		for (int p = 0; p < 4; p++)
			for (int r = 0; r < 2; r++) {
				denominator[i][p][r] = r ? 0.5 : 2.5;
				numerator[i][p][r] = r ? 3.0 * y[i][p] + 7.0 : -7.0;
			}
	struct pound_sample_values values = {.n_rows = 6,
	                                     .n_inputs = 2,
	                                     .n_signals = 2,
	                                     .numerator = &numerator[0][0][0],
	                                     .denominator = &denominator[0][0][0]};
	struct indices *got = indices_of(&values, 1);
	check_near(got->first[0].value, 0.572576783750673, 1e-12);
	check_near(got->first[1].value, 0.755503894911683, 1e-12);
	check_near(got->total[0].value, 0.880662387875659, 1e-12);
	check_near(got->total[1].value, 1.13121640616328, 2e-12);
	check_near(got->of.mean, 34.3 / 12.0, 1e-14);
	free(got);
}

static void ishigami_comes_out_within_its_sampling_error(void **state)
{
	(void)state;
	const struct function *f = function_named("ishigami");
	struct pound_sample_values values = function_values(f, 4000, 11, noiseless);
	struct indices *got = indices_of(&values, 1);
	for (int j = 0; j < 3; j++) {
		// four standard deviations, which are half of those at n = 1000
		check_near(got->first[j].value, f->index[j], 4.0 * 0.5 * f->error[j]);
		check_near(got->total[j].value, f->index[D + j], 4.0 * 0.5 * f->error[D + j]);
	}
	assert_true(got->first[3].value == 0.0 && got->first[3].low == 0.0 && got->first[3].high == 0.0);
	assert_true(got->total[3].value == 0.0 && got->total[3].low == 0.0 && got->total[3].high == 0.0);
	// mean and variance of 8000 outputs with a kurtosis of 3.5
	check_near(got->of.mean, f->mean, 4.0 * sqrt(f->variance / 8000.0));
	check_near(got->of.variance, f->variance, 4.0 * f->variance * sqrt(2.5 / 8000.0));
	assert_true(isnan(got->of.noise_share));
	assert_int_equal(got->dropped, 0);
	free(got);
	function_values_free(&values);
}

static void fresh_noise_moves_ishigamis_indices_where_theory_says(void **state)
{
	(void)state;
	// known_answers 5.11: independent noise of variance 0.1 V in every run
	static const double first[3] = {.2854, .4022, 0.0}, total[3] = {.5978, .4931, .3124};
	const struct function *f = function_named("ishigami");
	struct pound_sample_values values = function_values(f, 4000, 12, (struct function_noise){1, 0.1, false});
	struct indices *got = indices_of(&values, 1);
	for (int j = 0; j < 3; j++) {
		check_near(got->first[j].value, first[j], 4.0 * 0.5 * f->error[j]);
		check_near(got->total[j].value, total[j], 4.0 * 0.5 * f->error[D + j]);
	}
	free(got);
	function_values_free(&values);
}

static void the_noise_share_is_that_of_the_signals_mean(void **state)
{
	(void)state;
	const struct function *f = function_named("cusp");
	for (int common = 0; common < 2; common++) {
		struct pound_sample_values values =
		    function_values(f, 1000, 13, (struct function_noise){5, 1.0, common});
		struct indices *got = indices_of(&values, 1);
		// a mean of five has 1/5 of the noise: (1/5) / (1 + 1/5).  With common noise, 1000 rows of 4 degrees of
		// freedom give its variance to sqrt(2 / 4000) = 2 %, and the outputs' variance is known to some 3 %
		check_near(got->of.noise_share, 1.0 / 6.0, 4.0 * 0.04 / 6.0);
		free(got);
		function_values_free(&values);
	}
}

static void rows_with_a_failed_run_are_left_out_whole(void **state)
{
	(void)state;
	enum { N = 300, KEPT = 297 };
	const struct function_noise noise = {2, 0.5, true};
	struct pound_sample_values values = function_values(function_named("cusp"), N, 14, noise);
	struct pound_sample_values shorter = function_values(function_named("cusp"), KEPT, 14, noise);
	double *numerator = (double *)values.numerator, *denominator = (double *)values.denominator;
	double *kept = (double *)shorter.numerator;
	const int size = SAMPLES * noise.n_signals;
	static const int failed[] = {0, 17, 299};
	for (int i = 0, k = 0; i < N; i++)
		if (i != failed[0] && i != failed[1] && i != failed[2])
			memcpy(kept + size * k++, numerator + size * i, sizeof *kept * size);
	numerator[0] = NAN;
	numerator[size * 17 + size - 1] = NAN;
	denominator[size * 299 + 3] = NAN;
	struct indices *got = indices_of(&values, 2), *want = indices_of(&shorter, 2);
	assert_int_equal(got->dropped, 3);
	assert_memory_equal(got->first, want->first, sizeof got->first);
	assert_memory_equal(got->total, want->total, sizeof got->total);
	assert_true(got->of.mean == want->of.mean && got->of.noise_share == want->of.noise_share);
	free(got), free(want);
	function_values_free(&values);
	function_values_free(&shorter);
}

static void nothing_is_defined_where_nothing_varies_or_nothing_is_left(void **state)
{
	(void)state;
	double numerator[8 * SAMPLES * 3], denominator[8 * SAMPLES * 3];
	for (int failed = 0; failed < 2; failed++) {
		for (int k = 0; k < 8 * SAMPLES * 3; k++) {
			denominator[k] = 0.1 + 0.7 * (k % 17);
			numerator[k] = failed ? NAN : 1.1 * denominator[k]; // 1.1 except for rounding
		}
		struct pound_sample_values values = {
		    .n_rows = 8, .n_inputs = D, .n_signals = 3, .numerator = numerator, .denominator = denominator};
		struct indices *got = indices_of(&values, 3);
		assert_int_equal(got->dropped, failed ? 8 : 0);
		for (int j = 0; j < D; j++) {
			assert_true(isnan(got->first[j].value) && isnan(got->first[j].low) && isnan(got->first[j].high));
			assert_true(isnan(got->total[j].value) && isnan(got->total[j].low) && isnan(got->total[j].high));
		}
		assert_true(isnan(got->of.noise_share));
		if (!failed)
			check_near(got->of.mean, 1.1, 1e-15);
		free(got);
	}
}

static void the_order_of_the_rows_does_not_matter(void **state)
{
	(void)state;
	enum { N = 500 };
	struct pound_sample_values values = function_values(function_named("g_b"), N, 15, noiseless);
	struct indices *want = indices_of(&values, 4);
	double *y = (double *)values.numerator, row[SAMPLES];
	for (int i = 0; i < N; i++) {
		double *a = y + SAMPLES * i, *b = y + SAMPLES * ((i * 7919) % N);
		memcpy(row, a, sizeof row), memcpy(a, b, sizeof row), memcpy(b, row, sizeof row);
	}
	struct indices *got = indices_of(&values, 4);
	for (int j = 0; j < D; j++) {
		check_near(got->first[j].value, want->first[j].value, 1e-12);
		check_near(got->total[j].value, want->total[j].value, 1e-12);
		// other rows are resampled, so the ends differ by their own error, 3 % of the half width each
		double half = 0.5 * (want->first[j].high - want->first[j].low);
		check_near(got->first[j].low, want->first[j].low, 5.0 * 1.4 * 0.03 * half);
	}
	free(got), free(want);
	function_values_free(&values);
}

static void shift_and_scale_of_the_output_leave_indices_and_intervals(void **state)
{
	(void)state;
	struct pound_sample_values values = function_values(function_named("cusp"), 500, 16, noiseless);
	struct indices *want = indices_of(&values, 4);
	for (int k = 0; k < 500 * SAMPLES; k++)
		((double *)values.numerator)[k] = 1e6 + 3.0 * values.numerator[k];
	struct indices *got = indices_of(&values, 4);
	for (int j = 0; j < D; j++) {
		check_near(got->first[j].value, want->first[j].value, 1e-9);
		check_near(got->first[j].low, want->first[j].low, 1e-9);
		check_near(got->total[j].value, want->total[j].value, 1e-9);
		check_near(got->total[j].high, want->total[j].high, 1e-9);
	}
	free(got), free(want);
	function_values_free(&values);
}

static void intervals_cover_the_truth_about_as_often_as_they_say(void **state)
{
	(void)state;
	enum { SEEDS = 200, N = 250 };
	static const char *const names[] = {"ishigami", "cusp", "steps"};
	double mean = 0.0;
	int counted = 0;
	for (int k = 0; k < 3; k++) {
		const struct function *f = function_named(names[k]);
		int covered[2 * D] = {0};
		for (int seed = 0; seed < SEEDS; seed++) {
			struct pound_sample_values values = function_values(f, N, 1000 + seed, noiseless);
			struct indices *got = indices_of(&values, seed);
			for (int j = 0; j < D; j++) {
				covered[j] += got->first[j].low <= f->index[j] && f->index[j] <= got->first[j].high;
				covered[D + j] +=
				    got->total[j].low <= f->index[D + j] && f->index[D + j] <= got->total[j].high;
			}
			free(got);
			function_values_free(&values);
		}
		for (int j = 0; j < 2 * D; j++) {
			if (f->index[D + j % D] == 0.0)
				continue;
			// lowest single coverage measured: .929; four binomial standard deviations for 200 seeds
			assert_true(covered[j] >= SEEDS * (0.929 - 4.0 * sqrt(0.929 * 0.071 / SEEDS)));
			mean += (double)covered[j] / SEEDS;
			counted++;
		}
	}
	// .948 for first-order, .966 for total indices; the 22 are far from independent
	check_near(mean / counted, 0.957, 0.025);
}

CHECK_MAIN(cmocka_unit_test(golden_values_come_out_of_sample_values),
           cmocka_unit_test(ishigami_comes_out_within_its_sampling_error),
           cmocka_unit_test(fresh_noise_moves_ishigamis_indices_where_theory_says),
           cmocka_unit_test(the_noise_share_is_that_of_the_signals_mean),
           cmocka_unit_test(rows_with_a_failed_run_are_left_out_whole),
           cmocka_unit_test(nothing_is_defined_where_nothing_varies_or_nothing_is_left),
           cmocka_unit_test(the_order_of_the_rows_does_not_matter),
           cmocka_unit_test(shift_and_scale_of_the_output_leave_indices_and_intervals),
           cmocka_unit_test(intervals_cover_the_truth_about_as_often_as_they_say))
