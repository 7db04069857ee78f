/* unit_conditional_mean.c - the mean output given one input: linear functions exactly, known functions within
 * measured errors. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <gsl/gsl_integration.h>
#include <math.h>

enum { D = FUNCTION_INPUTS };

/* From the outputs, or from the residuals of the polynomials of chaos_expansion.c. */
static void curves_of(const struct function *f, const struct pound_design *design,
                      struct function_noise noise, bool trend, struct pound_curve curves[D])
{
	struct pound_sample_values values = function_values_of(f, design, noise);
	struct pound_rows rows;
	double *u = function_design_of(design);
	struct pound_closed_results results;
	double *scratch =
	    malloc(sizeof *scratch * (pound_rows_scratch(&values) + pound_chaos_expansion_scratch(&values) +
	                              pound_conditional_scratch(values.n_rows)));
	pound_rows_init(&rows, &values, scratch);
	double *rest = scratch + pound_rows_scratch(&values);
	const struct pound_conditional plain = {.rows = &rows, .u = u, .y = rows.y};
	for (int j = 0; j < D && !trend; j++)
		pound_conditional_mean(&plain, j, rest, &curves[j]);
	if (trend)
		pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u},
		                              noise.n_signals > 1 ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT, rest,
		                              &results, curves);
	free(scratch), free(u);
	function_values_free(&values);
}

static const struct function_noise noiseless = {1, 0.0, true};

static double lines(const double *u)
{
	return 3.0 + 2.0 * u[0] - 0.5 * u[2];
}

static void a_straight_line_is_met_but_for_what_the_other_inputs_scatter(void **state)
{
	(void)state;
	struct pound_curve curves[D];
	const struct function f = {.name = "lines", .y = lines};
	curves_of(&f, &(struct pound_design){.rows = 4000, .seed = 1}, noiseless, false, curves);
	for (int k = 0; k < POUND_CURVE; k++) {
		double u = pound_conditional_place(k);
		// standard deviations of the sum of the others: 0.14, 0.60, 0.58, 0.60; rows near a place: over 0.06 of 8000
		check_near(curves[0].mean[k].value, 2.75 + 2.0 * u, 5 * 0.14 / sqrt(480));
		check_near(curves[1].mean[k].value, 3.75, 5 * 0.60 / sqrt(480));
		check_near(curves[2].mean[k].value, 4.0 - 0.5 * u, 5 * 0.58 / sqrt(480));
	}
}

static double one_line(const double *u)
{
	return 1e3 + 2.0 * u[1];
}

static void a_line_of_one_input_is_exact_and_so_is_its_band(void **state)
{
	(void)state;
	struct pound_curve curves[D];
	const struct function f = {.name = "one_line", .y = one_line};
	for (int k = 0; k < 4; k++) {
		const int rows = k % 2 ? 1000 : POUND_ROWS_MIN;
		const bool trend = k > 1;
		curves_of(&f, &(struct pound_design){.rows = rows, .seed = 2}, noiseless, trend, curves);
		for (int i = 0; i < POUND_CURVE; i++) {
			const struct pound_estimate *mean = &curves[1].mean[i];
			double want = 1e3 + 2.0 * pound_conditional_place(i);
			// rounding of outputs of 1e3
			check_near(mean->value, want, 1e-11);
			check_near(mean->low, want, 1e-11);
			check_near(mean->high, want, 1e-11);
		}
	}
}

/* Mean of a function given one input, by Gauss quadrature with 12 points in each half of the other inputs' ranges. */
static double truth(const struct function *f, int input, double place)
{
	enum { POINTS = 12 };
	gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(POINTS);
	double x[2 * POINTS], w[2 * POINTS], u[D], sum = 0.0;
	for (int k = 0; k < 2 * POINTS; k++)
		gsl_integration_glfixed_point(0.5 * (k / POINTS), 0.5 * (k / POINTS + 1), (size_t)(k % POINTS), &x[k],
		                              &w[k], rule);
	gsl_integration_glfixed_table_free(rule);
	const int p = input == 0, q = input <= 1 ? 2 : 1, r = input <= 2 ? 3 : 2;
	u[input] = place;
	for (int i = 0; i < 2 * POINTS; i++)
		for (int j = 0; j < 2 * POINTS; j++)
			for (int k = 0; k < 2 * POINTS; k++) {
				u[p] = x[i], u[q] = x[j], u[r] = x[k];
				sum += w[i] * w[j] * w[k] * f->y(u);
			}
	return sum;
}

/* The same for the function of steps in closed form, as quadrature points miss the steps. */
static double steps_truth(int input, double place)
{
	const double beyond[] = {fmin(fmax(2.0 * place - 0.6, 0.0), 1.0), 0.2 + 0.5 * place, 0.45, 0.45};
	return 2.0 * beyond[input] * (input == 2 ? 0.5 + place : 1.0) + 0.5 * (input == 3 ? place > 0.7 : 0.3) +
	       0.4 * (input == 1 ? place : 0.5);
}

static void truth_fill(const struct function *f, double want[D][POUND_CURVE])
{
	for (int j = 0; j < D; j++)
		for (int k = 0; k < POUND_CURVE; k++)
			want[j][k] = f == function_named("steps") ? steps_truth(j, pound_conditional_place(k))
			                                          : truth(f, j, pound_conditional_place(k));
}

enum { SEEDS = 8 };

struct performance {
	double error, coverage; /* root mean square in standard deviations of the output; coverage of the bands */
};

/* Over seeds, inputs and places; the error is the mean of the inputs' errors. */
static struct performance performance_of(const struct function *f, struct pound_design design,
                                         struct function_noise noise, double want[D][POUND_CURVE])
{
	struct performance performance = {0};
	double square[D] = {0.0};
	for (int seed = 0; seed < SEEDS; seed++) {
		struct pound_curve curves[D];
		design.seed = (uint64_t)seed;
		curves_of(f, &design, noise, true, curves);
		for (int j = 0; j < D; j++)
			for (int k = 0; k < POUND_CURVE; k++) {
				const struct pound_estimate *got = &curves[j].mean[k];
				double off = got->value - want[j][k], n = SEEDS * POUND_CURVE;
				square[j] += off * off / f->variance / n;
				performance.coverage += (got->low <= want[j][k] && want[j][k] <= got->high) / (D * n);
			}
	}
	for (int j = 0; j < D; j++)
		performance.error += sqrt(square[j]) / D;
	return performance;
}

static void errors_of_six_thousand_runs_are_a_fraction_of_those_of_smoothing_alone(void **state)
{
	(void)state;
	// with five signals whose noise leaves a quarter of the variance in their mean; smoothing without polynomials has
	// errors of 0.040, 0.043, 0.053, 0.046
	static const struct {
		const char *name;
		double quiet, noisy, coverage;
	} measured[] = {{"cusp", .0056, .0225, .93},
	                {"ishigami", .0100, .0261, .93},
	                {"g_b", .0094, .0258, .93},
	                {"steps", .0262, .0360, .93}};
	static const struct function_noise noises[] = {{1, 0.0, true}, {5, 1.25, false}};
	for (int k = 0; k < 4; k++) {
		const struct function *f = function_named(measured[k].name);
		double want[D][POUND_CURVE];
		truth_fill(f, want);
		for (int noisy = 0; noisy < 2; noisy++) {
			struct performance got =
			    performance_of(f, (struct pound_design){.rows = 1000}, noises[noisy], want);
			assert_true(got.error <= 1.2 * (noisy ? measured[k].noisy : measured[k].quiet));
			// nominal 0.95
			assert_true(got.coverage >= measured[k].coverage && got.coverage <= 0.98);
		}
	}
}

static void groups_of_rows_and_all_mixtures_are_taken_as_they_are(void **state)
{
	(void)state;
	const struct function *f = function_named("cusp");
	double want[D][POUND_CURVE];
	truth_fill(f, want);
	assert_string_equal(pound_design_name(2), "sobol");
	struct performance nets =
	    performance_of(f, (struct pound_design){.rows = 1024, .method = 2}, noiseless, want);
	assert_true(nets.error <= 0.0056 && nets.coverage >= 0.90);
	struct performance factorial = performance_of(
	    f, (struct pound_design){.rows = 375, .order = POUND_ORDER_FACTORIAL}, noiseless, want);
	assert_true(factorial.error <= 0.0092 && factorial.coverage >= 0.90);
}

static double by_level(const double *u)
{
	return (u[1] > 0.25 ? 4.0 : 0.0) + u[0] * (u[1] > 0.75 ? 2.0 : 1.0) + 0.2 * u[2];
}

static void a_discrete_input_has_one_exact_mean_for_each_of_its_values(void **state)
{
	(void)state;
	static const double numbers[] = {-1, 0, 7}, weights[] = {1, 2, 1}, want[] = {0.6, 4.6, 5.1};
	struct pound_input inputs[D] = {{.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}}};
	struct pound_distribution *discrete = &inputs[1].distribution;
	while (!pound_distribution_lists_values(discrete->type))
		discrete->type++;
	discrete->n_values = 3;
	discrete->values = numbers;
	discrete->weights = weights;
	assert_int_equal(pound_conditional_points(discrete), 3);
	assert_int_equal(pound_conditional_points(&inputs[0].distribution), POUND_CURVE);
	const struct function f = {.name = "by_level", .y = by_level};
	int covered = 0;
	for (int seed = 0; seed < 40; seed++) {
		const struct pound_design design = {.rows = 250, .seed = (uint64_t)seed};
		struct pound_sample_values values = function_values_of(&f, &design, noiseless);
		values.inputs = inputs;
		struct pound_rows rows;
		struct pound_curve curves[D];
		struct pound_closed_results results;
		double *u = function_design_of(&design);
		double *scratch =
		    malloc(sizeof *scratch * (pound_rows_scratch(&values) + pound_chaos_expansion_scratch(&values)));
		pound_rows_init(&rows, &values, scratch);
		pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u}, POUND_NOISE_KEPT,
		                              scratch + pound_rows_scratch(&values), &results, curves);
		for (int k = 0; k < 3; k++) {
			const struct pound_estimate *mean = &curves[1].mean[k];
			check_near(pound_conditional_x(discrete, k), numbers[k], 0.0);
			// the other inputs have a standard deviation of 0.6 at most, over some 125 rows of each matrix
			check_near(mean->value, want[k], 5 * 0.6 / sqrt(125));
			covered += mean->low <= want[k] && want[k] <= mean->high;
		}
		assert_true(isnan(curves[1].mean[3].value) && isnan(curves[1].mean[POUND_CURVE - 1].high));
		assert_false(isnan(curves[0].mean[POUND_CURVE - 1].value));
		free(scratch), free(u);
		function_values_free(&values);
	}
	// of 120 bands 114 hold on average, with a standard deviation of 2.4
	assert_true(covered >= 105);
}

CHECK_MAIN(cmocka_unit_test(a_straight_line_is_met_but_for_what_the_other_inputs_scatter),
           cmocka_unit_test(a_line_of_one_input_is_exact_and_so_is_its_band),
           cmocka_unit_test(errors_of_six_thousand_runs_are_a_fraction_of_those_of_smoothing_alone),
           cmocka_unit_test(groups_of_rows_and_all_mixtures_are_taken_as_they_are),
           cmocka_unit_test(a_discrete_input_has_one_exact_mean_for_each_of_its_values))
