/* unit_local_regression.c - local-linear first-order indices: golden predictions, exact lines, errors over a hundred designs. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2 };

static void the_golden_predictions_are_met(void **state)
{
	(void)state;
	// statistics_golden.json, loo_local_linear_n12_K2
	static const double y[12] = {-0.11, 0.42, 0.31, 0.78, 0.99, 0.98, 1.07, 0.79, 0.59, 0.0, -0.01, -0.18};
	static const double want[12] = {0.0799999999999997,
	                                0.137142857142857,
	                                0.52,
	                                0.675,
	                                0.785,
	                                0.9075,
	                                0.8375,
	                                0.66,
	                                0.4625,
	                                0.2975,
	                                -0.0185714285714285,
	                                -0.405};
	double fit[12], product = 0.0;
	pound_local_regression_fit(y, 12, 2, fit);
	for (int k = 0; k < 12; k++) {
		check_near(fit[k], want[k], 1e-15);
		product += y[k] * fit[k] / 12.0;
	}
	check_near(product, 0.34720714285714277, 1e-15);
}

static void a_straight_line_is_predicted_exactly(void **state)
{
	(void)state;
	double y[40], fit[40];
	for (int reach = 1; reach <= 19; reach++) {
		for (int k = 0; k < 40; k++)
			y[k] = 3.0 - 0.25 * k;
		pound_local_regression_fit(y, 40, reach, fit);
		for (int k = 0; k < 40; k++)
			check_near(fit[k], y[k], 1e-13);
	}
}

/* First-order indices from the rows of sample values over their design. */
static void first_of(const struct pound_sample_values *values, const double *x, bool corrected,
                     struct pound_estimate *first)
{
	struct pound_rows rows;
	double *scratch =
	    malloc(sizeof *scratch * (pound_rows_scratch(values) + pound_local_regression_scratch(values)));
	pound_rows_init(&rows, values, scratch);
	pound_local_regression_first(&rows, x, corrected ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT,
	                             scratch + pound_rows_scratch(values), first);
	free(scratch);
}

static void rows_left_out_do_not_shift_the_inputs_of_the_others(void **state)
{
	(void)state;
	enum { N = 400 };
	struct pound_sample_values values =
	    function_values(function_named("cusp"), N, 5, (struct function_noise){.n_signals = 1});
	double *x = function_design(N, 5), *y = (double *)values.numerator;
	struct pound_estimate want[D], got[D];
	// failed rows give the same result as rows that are cut off
	struct pound_sample_values cut = {.n_rows = N - 100,
	                                  .n_inputs = D,
	                                  .n_signals = 1,
	                                  .numerator = y + 100 * SAMPLES,
	                                  .denominator = values.denominator + 100 * SAMPLES};
	first_of(&cut, x + 100 * 2 * D, false, want);
	for (int i = 0; i < 100; i++)
		y[i * SAMPLES + i % SAMPLES] = NAN;
	first_of(&values, x, false, got);
	for (int j = 0; j < D; j++) {
		check_near(got[j].value, want[j].value, 0.0);
		check_near(got[j].low, want[j].low, 0.0);
	}
	free(x);
	function_values_free(&values);
}

static void too_few_rows_or_a_constant_output_have_no_indices(void **state)
{
	(void)state;
	struct pound_estimate first[D];
	struct pound_sample_values values =
	    function_values(function_named("cusp"), 100, 5, (struct function_noise){.n_signals = 1});
	double *x = function_design(100, 5);
	values.n_rows = 3;
	first_of(&values, x, false, first);
	assert_true(isnan(first[0].value) && isnan(first[D - 1].high));
	values.n_rows = 100;
	for (int k = 0; k < 100 * SAMPLES; k++)
		((double *)values.numerator)[k] = 4.2;
	first_of(&values, x, false, first);
	assert_true(isnan(first[0].value) && isnan(first[D - 1].high));
	free(x);
	function_values_free(&values);
}

static void shift_and_scale_change_no_index(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("g_a"), 300, 6, (struct function_noise){.n_signals = 1});
	double *x = function_design(300, 6);
	struct pound_estimate want[D], got[D];
	first_of(&values, x, false, want);
	for (int k = 0; k < 300 * SAMPLES; k++)
		((double *)values.numerator)[k] = 1e6 + 3.0 * values.numerator[k];
	first_of(&values, x, false, got);
	for (int j = 0; j < D; j++) {
		check_near(got[j].value, want[j].value, 1e-9);
		check_near(got[j].high, want[j].high, 1e-9);
	}
	free(x);
	function_values_free(&values);
}

enum { SEEDS = 100, N = 1000 };

/* Root mean square error over the inputs, largest bias, and coverage over SEEDS designs. */
struct performance {
	double rms, bias, coverage;
};

static struct performance performance_of(const struct function *f, struct function_noise noise)
{
	struct performance result = {0};
	double bias[D] = {0};
	for (int seed = 0; seed < SEEDS; seed++) {
		struct pound_sample_values values = function_values(f, N, seed, noise);
		double *x = function_design(N, seed);
		struct pound_estimate first[D];
		first_of(&values, x, noise.n_signals > 1, first);
		for (int j = 0; j < D; j++) {
			double error = first[j].value - f->index[j];
			bias[j] += error / SEEDS;
			result.rms += error * error / D / SEEDS;
			result.coverage +=
			    (double)(first[j].low <= f->index[j] && f->index[j] <= first[j].high) / D / SEEDS;
		}
		free(x);
		function_values_free(&values);
	}
	result.rms = sqrt(result.rms);
	for (int j = 0; j < D; j++)
		result.bias = fmax(result.bias, fabs(bias[j]));
	return result;
}

static void errors_over_designs_are_a_fraction_of_those_of_pick_freeze(void **state)
{
	(void)state;
	// measured over 100 designs; pick-freeze has 0.020 to 0.033, one reach alone 0.006 to 0.010 and a bias at jumps
	static const struct {
		const char *name;
		double rms;
	} measured[] = {{"ishigami", .0120}, {"g_a", .0106},   {"g_b", .0122},
	                {"cusp", .0116},     {"steps", .0117}, {"interactions", .0091}};
	for (int k = 0; k < 6; k++) {
		struct performance p =
		    performance_of(function_named(measured[k].name), (struct function_noise){1, 0.0, true});
		assert_true(p.rms <= 1.3 * measured[k].rms);
		assert_true(p.bias <= 0.006);
		// conservative: the influence function ignores that a Latin hypercube has less scatter
		assert_true(p.coverage >= 0.95);
	}
}

/* [1/4 < u1 < 3/4] + u2 + 0.3 [u4 > 1/2]; variances 1/4, 1/12, 0, 0.09/4, no interaction. */
static double jumps(const double *u)
{
	return (u[0] > 0.25 && u[0] < 0.75) + u[1] + 0.3 * (u[3] > 0.5);
}

static void a_jump_within_the_range_leaves_no_bias_and_the_interval_holds(void **state)
{
	(void)state;
	const double variance = 1.0 / 4.0 + 1.0 / 12.0 + 0.09 / 4.0;
	const struct function f = {.name = "jumps",
	                           .y = jumps,
	                           .variance = variance,
	                           .index = {0.25 / variance, 1.0 / 12.0 / variance, 0.0, 0.0225 / variance}};
	// one reach alone: a bias of 0.016, and a coverage of one third for the first input
	struct performance p = performance_of(&f, (struct function_noise){1, 0.0, true});
	assert_true(p.bias <= 0.004);
	assert_true(p.coverage >= 0.95);
}

/* sin(16 pi u1) + u2: variances 1/2, 1/12. */
static double waves(const double *u)
{
	return sin(16.0 * M_PI * u[0]) + u[1];
}

static void the_error_of_neighbours_is_in_the_interval(void **state)
{
	(void)state;
	const double variance = 1.0 / 2.0 + 1.0 / 12.0;
	const struct function f = {
	    .name = "waves", .y = waves, .variance = variance, .index = {0.5 / variance, 1.0 / 12.0 / variance}};
	// a wave of 6 of the wider reaches: extrapolation overshoots by some hundredths
	struct performance p = performance_of(&f, (struct function_noise){1, 0.0, true});
	assert_true(p.bias > 0.02);
	assert_true(p.coverage >= 0.95);
}

enum { LEVELS = 3 };

static double staircase(const double *u)
{
	return (u[0] > 0.2 ? 1.0 : 0.0) + (u[0] > 0.7 ? 2.0 : 0.0) + u[1];
}

static void means_at_the_values_of_a_discrete_input_are_its_index(void **state)
{
	(void)state;
	// values 0, 1, 3 with probabilities 0.2, 0.5, 0.3: mean 1.4, variance 3.2 - 1.96
	static const double numbers[LEVELS] = {0, 1, 3}, weights[LEVELS] = {2, 5, 3};
	const double variance = 1.24 + 1.0 / 12.0;
	const struct function f = {.name = "staircase", .y = staircase};
	struct pound_input inputs[D] = {{.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}}};
	while (!pound_distribution_lists_values(inputs[0].distribution.type))
		inputs[0].distribution.type++;
	inputs[0].distribution.n_values = LEVELS;
	inputs[0].distribution.values = numbers;
	inputs[0].distribution.weights = weights;
	struct pound_sample_values values = function_values(&f, N, 5, (struct function_noise){.n_signals = 1});
	values.inputs = inputs;
	double *x = function_design(N, 5);
	struct pound_estimate first[D];
	first_of(&values, x, false, first);
	// a hypercube has the levels in proportion; what remains is the variance of u2 within the levels, 1/12 over 3000 rows
	check_near(first[0].value, 1.24 / variance, 2e-3);
	assert_true(first[0].low <= 1.24 / variance && 1.24 / variance <= first[0].high);
	check_near(first[1].value, 1.0 / 12.0 / variance, 0.03);
	free(x);
	function_values_free(&values);
}

/* Waves times a factor of three values, equally probable, whose ratio of mean square to squared mean is 1 + 0.0104 / 3. */
static double weak_values(const double *u)
{
	const double factor = u[1] < 1.0 / 3.0 ? 1.02 : u[1] < 2.0 / 3.0 ? 0.92 : 1.06;
	return (1.0 + 0.8 * sin(16.0 * M_PI * u[0])) * factor;
}

static void a_weak_discrete_input_has_no_bias_and_its_interval_holds(void **state)
{
	(void)state;
	enum { DESIGNS = 300, ROWS = 250 };
	static const double numbers[LEVELS] = {0, 1, 2};
	const struct function f = {.name = "weak values", .y = weak_values};
	const double ratio = 1.0 + 0.0104 / 3.0, exact = (ratio - 1.0) / (1.32 * ratio - 1.0);
	struct pound_input inputs[D];
	for (int j = 0; j < D; j++)
		inputs[j].distribution = (struct pound_distribution){.p = {0, 1}};
	while (!pound_distribution_steps(inputs[1].distribution.type))
		inputs[1].distribution.type++;
	inputs[1].distribution.n_values = LEVELS;
	inputs[1].distribution.values = numbers;
	for (int method = 0; method < 2; method++) {
		double bias = 0.0, covered = 0.0;
		for (int seed = 0; seed < DESIGNS; seed++) {
			const struct pound_design design = {.method = method, .rows = ROWS, .seed = (uint64_t)seed};
			struct pound_sample_values values =
			    function_values_of(&f, &design, (struct function_noise){.n_signals = 1});
			double *x = function_design_of(&design);
			struct pound_estimate first[D];
			values.inputs = inputs;
			first_of(&values, x, false, first);
			bias += (first[1].value - exact) / DESIGNS;
			covered += (first[1].low <= exact && exact <= first[1].high) / (double)DESIGNS;
			free(x);
			function_values_free(&values);
		}
		// without the correction by the variance within the values: a bias of -0.004, and 0.86 of symmetric intervals hold
		assert_true(fabs(bias) <= 0.002);
		assert_true(covered >= 0.93);
	}
}

static void noise_of_few_signals_leaves_no_bias(void **state)
{
	(void)state;
	struct performance p = performance_of(function_named("cusp"), (struct function_noise){5, 1.0, true});
	assert_true(p.rms <= 1.3 * 0.0155);
	assert_true(p.bias <= 0.006);
	assert_true(p.coverage >= 0.93);
}

CHECK_MAIN(cmocka_unit_test(the_golden_predictions_are_met),
           cmocka_unit_test(a_straight_line_is_predicted_exactly),
           cmocka_unit_test(rows_left_out_do_not_shift_the_inputs_of_the_others),
           cmocka_unit_test(too_few_rows_or_a_constant_output_have_no_indices),
           cmocka_unit_test(shift_and_scale_change_no_index),
           cmocka_unit_test(errors_over_designs_are_a_fraction_of_those_of_pick_freeze),
           cmocka_unit_test(a_jump_within_the_range_leaves_no_bias_and_the_interval_holds),
           cmocka_unit_test(the_error_of_neighbours_is_in_the_interval),
           cmocka_unit_test(means_at_the_values_of_a_discrete_input_are_its_index),
           cmocka_unit_test(a_weak_discrete_input_has_no_bias_and_its_interval_holds),
           cmocka_unit_test(noise_of_few_signals_leaves_no_bias))
