/* unit_noise_correction.c - the correction for few signals: golden values, exact zeros, and the bias that it removes. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>

enum { D = FUNCTION_INPUTS };

static struct pound_pick_freeze pick_freeze(const struct pound_rows *rows, uint64_t seed)
{
	struct pound_pick_freeze result;
	const struct pound_sample_values shape = {.n_rows = rows->n_rows, .n_inputs = rows->n_inputs};
	double *scratch = malloc(sizeof *scratch * pound_noise_correction_scratch(&shape));
	pound_noise_correction_estimates(rows, (struct pound_resampling){seed, POUND_RESAMPLES}, scratch,
	                                 &result);
	free(scratch);
	return result;
}

static struct pound_rows rows_of(const struct pound_sample_values *values)
{
	struct pound_rows rows;
	size_t n = pound_rows_scratch(values);
	pound_rows_init(&rows, values, malloc(sizeof(double) * n));
	return rows;
}

static void the_golden_row_set_is_met(void **state)
{
	(void)state;
	// statistics_golden.json, noise_corrected_d2_n5_R3: A, B, AB1, AB2, each five rows of three signals
	static const double y[4][5][3] = {
	    {{-0.38, -0.42, 0.99}, {0.41, 0.99, 2.57}, {0.31, 1.86, 0.13}, {0.9, 0.49, 0.77}, {2.18, -0.7, 1.58}},
	    {{-0.01, -0.73, 1.24},
	     {-0.15, 0.3, 2.16},
	     {1.39, 1.3, 0.56},
	     {-0.05, -0.12, 0.74},
	     {2.13, -0.38, 1.82}},
	    {{-0.5, -0.23, 1.83},
	     {-0.01, -0.02, 1.74},
	     {0.18, 1.99, 0.14},
	     {1.14, -0.16, 0.74},
	     {2.15, -0.88, 1.66}},
	    {{-0.65, -0.18, 1.21}, {-0.51, 0.87, 2.06}, {0.64, 1.98, 0.3}, {1.12, 0.0, 0.45}, {1.8, -1.58, 0.7}},
	};
	double numerator[5][4][3], denominator[5][4][3];
	for (int i = 0; i < 5; i++)
		for (int p = 0; p < 4; p++)
			for (int r = 0; r < 3; r++) {
				numerator[i][p][r] = 2.0 * y[p][i][r];
				denominator[i][p][r] = 2.0;
			}
	struct pound_sample_values values = {.n_rows = 5,
	                                     .n_inputs = 2,
	                                     .n_signals = 3,
	                                     .numerator = &numerator[0][0][0],
	                                     .denominator = &denominator[0][0][0]};
	struct pound_rows rows = rows_of(&values);
	rows.variance_floor = -INFINITY; // the golden variance of the mean response is negative
	struct pound_pick_freeze got = pick_freeze(&rows, 1);
	check_near(got.first[0].value, 0.453843547944774, 1e-12);
	check_near(got.first[1].value, 0.548739839865292, 1e-12);
	check_near(got.total[0].value, -0.189569541388471, 1e-12);
	check_near(got.total[1].value, -0.270815466455106, 1e-12);
	const double mean_variance = -0.25937711111111117, noise = 1.1738916666666668;
	check_near(got.signal_total_one.value, 1.2836227258882096, 1e-12);
	check_near(got.signal_total.value, noise / 3.0 / (mean_variance + noise / 3.0), 1e-11);
	check_near(got.signal_first.value, 0.8865366666666668 / (mean_variance + noise), 1e-12);
	free(rows.y);
}

static void a_single_signal_cannot_be_corrected(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("cusp"), 50, 2, (struct function_noise){1, 1.0, true});
	struct pound_rows rows = rows_of(&values);
	struct pound_pick_freeze got = pick_freeze(&rows, 1);
	for (int j = 0; j < D; j++) {
		assert_true(isfinite(got.first_raw[j].value) && isfinite(got.total_raw[j].high));
		assert_true(isnan(got.first[j].value) && isnan(got.total[j].value) && isnan(got.total[j].low));
	}
	assert_true(isnan(got.signal_total.value) && isnan(got.signal_total_one.high));
	free(rows.y);
	function_values_free(&values);
}

static void raw_and_corrected_agree_without_noise(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("steps"), 300, 3, (struct function_noise){4, 0.0, true});
	struct pound_rows rows = rows_of(&values);
	struct pound_pick_freeze got = pick_freeze(&rows, 1);
	for (int j = 0; j < D; j++) {
		// the centering means differ by the sampling error of a mean, whose square enters
		check_near(got.first[j].value, got.first_raw[j].value, 1.0 / 300.0);
		check_near(got.total[j].value, got.total_raw[j].value, 1e-14);
		check_near(got.with_signal[j].value, 0.0, 1e-14);
	}
	check_near(got.signal_total.value, 0.0, 1e-14);
	free(rows.y);
	function_values_free(&values);
}

static void an_input_without_effect_keeps_a_total_of_zero_under_common_signals(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("ishigami"), 200, 4, (struct function_noise){5, 1.0, true});
	struct pound_rows rows = rows_of(&values);
	struct pound_pick_freeze got = pick_freeze(&rows, 1);
	assert_true(got.total_raw[3].value == 0.0 && got.total[3].value == 0.0);
	assert_true(got.total[3].low == 0.0 && got.total[3].high == 0.0);
	assert_true(got.first_raw[3].value == 0.0 && got.first[3].value == 0.0 &&
	            got.with_signal[3].value == 0.0);
	free(rows.y);
	function_values_free(&values);
}

enum { SEEDS = 100, N = 1000 };

/* Errors of one kind of indices over SEEDS designs: first-order, then total. */
struct errors {
	double bias[2 * D], square[2 * D];
	int covered;
};

static void errors_add(struct errors *e, const struct function *f, const struct pound_estimate *first,
                       const struct pound_estimate *total)
{
	for (int k = 0; k < 2 * D; k++) {
		const struct pound_estimate *x = k < D ? first + k : total + k - D;
		double error = x->value - f->index[k];
		e->bias[k] += error / SEEDS;
		e->square[k] += error * error / SEEDS;
		e->covered += x->low <= f->index[k] && f->index[k] <= x->high;
	}
}

/* Noise with the variance of the mean response, five signals: the bias is known. */
static void check_noise(bool common, const double *raw_bias, double raw_spread, double first_rms,
                        double total_rms)
{
	const struct function *f = function_named("cusp");
	struct errors raw = {0}, corrected = {0};
	double one = 0.0, all = 0.0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct pound_sample_values values =
		    function_values(f, N, seed, (struct function_noise){5, 1.0, common});
		struct pound_rows rows = rows_of(&values);
		struct pound_pick_freeze got = pick_freeze(&rows, seed);
		errors_add(&raw, f, got.first_raw, got.total_raw);
		errors_add(&corrected, f, got.first, got.total);
		one += got.signal_total_one.value / SEEDS;
		all += got.signal_total.value / SEEDS;
		free(rows.y);
		function_values_free(&values);
	}
	double first = 0.0, total = 0.0;
	for (int k = 0; k < 2 * D; k++) {
		// a mean of 100 designs has a standard error of a tenth of the RMSE, which is some 0.03
		check_near(corrected.bias[k], 0.0, 0.010);
		check_near(raw.bias[k], raw_bias[k], raw_spread);
		*(k < D ? &first : &total) += corrected.square[k] / D;
	}
	assert_true(sqrt(first) <= 1.25 * first_rms && sqrt(total) <= 1.25 * total_rms);
	check_near(one, 0.5, 0.005);
	check_near(all, 1.0 / 6.0, 0.005);
	double coverage = (double)corrected.covered / (2 * D * SEEDS);
	assert_true(coverage >= 0.92 && coverage <= 0.985);
	assert_true(raw.covered < corrected.covered);
}

static void common_signals_shrink_raw_indices_and_corrected_ones_are_unbiased(void **state)
{
	(void)state;
	// with nu = 1/5 of the variance as noise of the means, S -> S / (1 + nu) and T -> T / (1 + nu)
	double bias[2 * D];
	for (int k = 0; k < 2 * D; k++)
		bias[k] = -function_named("cusp")->index[k] / 6.0;
	check_noise(true, bias, 0.012, 0.027, 0.025);
}

static void fresh_signals_inflate_raw_totals_and_corrected_ones_are_unbiased(void **state)
{
	(void)state;
	// S -> S / (1 + nu), T -> (T + nu) / (1 + nu)
	double bias[2 * D];
	for (int k = 0; k < 2 * D; k++)
		bias[k] = ((k >= D) - function_named("cusp")->index[k]) / 6.0;
	check_noise(false, bias, 0.012, 0.034, 0.030);
}

static void
an_input_without_effect_has_a_raw_total_of_a_sixth_under_fresh_signals_and_none_corrected(void **state)
{
	(void)state;
	enum { FEW = 20 };
	double raw = 0.0, corrected = 0.0;
	for (int seed = 0; seed < FEW; seed++) {
		struct pound_sample_values values = function_values(function_named("ishigami"), N, (uint64_t)seed,
		                                                    (struct function_noise){5, 1.0, false});
		struct pound_rows rows = rows_of(&values);
		struct pound_pick_freeze got = pick_freeze(&rows, (uint64_t)seed);
		raw += got.total_raw[3].value / FEW;
		corrected += got.total[3].value / FEW;
		free(rows.y);
		function_values_free(&values);
	}
	// T -> (T + nu) / (1 + nu) with nu = 1/5; the standard deviation of one is 0.0097: four of the mean
	check_near(raw, 1.0 / 6.0, 0.009);
	check_near(corrected, 0.0, 0.009);
}

CHECK_MAIN(cmocka_unit_test(the_golden_row_set_is_met), cmocka_unit_test(a_single_signal_cannot_be_corrected),
           cmocka_unit_test(raw_and_corrected_agree_without_noise),
           cmocka_unit_test(an_input_without_effect_keeps_a_total_of_zero_under_common_signals),
           cmocka_unit_test(common_signals_shrink_raw_indices_and_corrected_ones_are_unbiased),
           cmocka_unit_test(fresh_signals_inflate_raw_totals_and_corrected_ones_are_unbiased),
           cmocka_unit_test(
               an_input_without_effect_has_a_raw_total_of_a_sixth_under_fresh_signals_and_none_corrected))
