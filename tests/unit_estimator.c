/* unit_estimator.c - golden values of every estimator, exact properties, and errors over a hundred designs. */
#include "engine/indices.h"
#include "tests/check.h"
#include "tests/functions.h"

#include <math.h>
#include <string.h>

static const struct pound_estimator *estimator_named(const char *name)
{
	int row = 0;
	while (strcmp(pound_estimator_row(row)->name, name))
		row++;
	return pound_estimator_row(row);
}

/* Indexes from the outputs of n rows, centred by the mean of A and B; value is first, total  (2 x d). */
static void indices_of(const struct pound_estimator *e, const double *y, int n, int d, double *value)
{
	double centre = 0.0, mean[POUND_MOMENTS_MAX] = {0};
	for (int i = 0; i < n; i++)
		centre += (y[i * (d + 2)] + y[i * (d + 2) + 1]) / (2 * n);
	for (int i = 0; i < n; i++) {
		double row[POUND_INPUTS_MAX + 2], m[POUND_MOMENTS_MAX];
		for (int p = 0; p < d + 2; p++)
			row[p] = y[i * (d + 2) + p] - centre;
		e->moments(row, d, m);
		for (int k = 0; k < e->n_moments(d); k++)
			mean[k] += m[k] / n;
	}
	e->indices(mean, d, 0.0, value);
}

// statistics_golden.json, estimators_d2_n6: A, B, AB1, AB2 of each row
static const double golden[6][4] = {{3.3, 3.13, 3.25, 3.65},  {1.96, 2.68, 2.88, 2.3},
                                    {3.75, 2.98, 3.6, 3.27},  {3.94, 2.15, 2.62, 2.7},
                                    {1.05, 3.88, 2.65, 3.08}, {1.7, 3.78, 2.26, 2.66}};

static void every_estimator_gives_its_golden_values(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		double value[4]; // S1, S2, T1, T2
	} wanted[] = {
	    {"saltelli", {0.572576783750673, 0.755503894911683, 0.880662387875659, 1.13121640616328}},
	    {"jansen", {0.555890909451146, 0.732940154739772, 0.543610132384069, 0.698270652608221}},
	    {"janon", {-0.290158571798581, 0.211008458289029, 0.638703519771557, 0.807695833524315}},
	    {"martinez", {-0.270880651629076, 0.248766784611024, 0.429037425339638, 0.65761429733521}},
	};
	int n = (int)(sizeof wanted / sizeof wanted[0]);
	for (int e = 0; e < n; e++) {
		double value[4];
		indices_of(estimator_named(wanted[e].name), &golden[0][0], 6, 2, value);
		for (int k = 0; k < 4; k++)
			check_near(value[k], wanted[e].value[k], 1e-12 * fabs(wanted[e].value[k]));
	}
	assert_null(pound_estimator_row(n));
}

/* Outputs of one signal without noise  (n_rows x 6). */
static double *outputs_of(const struct function *f, int n, uint64_t seed)
{
	struct pound_sample_values values = function_values(f, n, seed, (struct function_noise){.n_signals = 1});
	return (double *)values.numerator;
}

static void an_input_without_effect_has_a_total_of_exactly_zero(void **state)
{
	(void)state;
	double *y = outputs_of(function_named("ishigami"), 100, 3); // its fourth input does nothing
	for (int row = 0; pound_estimator_row(row); row++) {
		double value[8];
		indices_of(pound_estimator_row(row), y, 100, 4, value);
		assert_true(value[7] == 0.0);
	}
	double value[8];
	indices_of(estimator_named("saltelli"), y, 100, 4, value);
	assert_true(value[3] == 0.0);
	free(y);
}

static void shift_and_scale_change_no_index(void **state)
{
	(void)state;
	double *y = outputs_of(function_named("cusp"), 1000, 5);
	for (int row = 0; pound_estimator_row(row); row++) {
		double value[8], moved[8];
		indices_of(pound_estimator_row(row), y, 1000, 4, value);
		for (int k = 0; k < 6000; k++)
			y[k] = 1e6 + 3.0 * y[k];
		indices_of(pound_estimator_row(row), y, 1000, 4, moved);
		// rounding of the shifted outputs: 1e6 eps relative to a deviation of 3 * 0.3, averaged over rows
		for (int k = 0; k < 8; k++)
			check_near(moved[k], value[k], 1e-9);
		for (int k = 0; k < 6000; k++)
			y[k] = (y[k] - 1e6) / 3.0;
	}
	free(y);
}

static void relabelling_the_inputs_relabels_the_indexes(void **state)
{
	(void)state;
	static const int label[4] = {2, 0, 3, 1};
	double *y = outputs_of(function_named("steps"), 200, 6), relabelled[200 * 6];
	for (int i = 0; i < 200; i++)
		for (int p = 0; p < 6; p++)
			relabelled[i * 6 + p] = y[i * 6 + (p < 2 ? p : 2 + label[p - 2])];
	for (int row = 0; pound_estimator_row(row); row++) {
		double value[8], other[8];
		indices_of(pound_estimator_row(row), y, 200, 4, value);
		indices_of(pound_estimator_row(row), relabelled, 200, 4, other);
		for (int j = 0; j < 4; j++) {
			check_near(other[j], value[label[j]], 1e-14);
			check_near(other[4 + j], value[4 + label[j]], 1e-14);
		}
	}
	free(y);
}

static void a_constant_output_has_undefined_indexes(void **state)
{
	(void)state;
	double y[40 * 6], value[8];
	for (int k = 0; k < 40 * 6; k++)
		y[k] = 2.5;
	for (int row = 0; pound_estimator_row(row); row++) {
		indices_of(pound_estimator_row(row), y, 40, 4, value);
		for (int k = 0; k < 8; k++)
			assert_true(isnan(value[k]));
	}
}

/* Root mean square and mean errors of an estimator's 8 indexes over designs of n = 1000. */
static void errors_of(const char *estimator, const struct function *f, int designs, double *rms, double *bias)
{
	const struct pound_estimator *e = estimator_named(estimator);
	for (int k = 0; k < 8; k++)
		rms[k] = bias[k] = 0.0;
	for (int seed = 0; seed < designs; seed++) {
		double value[8], *y = outputs_of(f, 1000, seed);
		indices_of(e, y, 1000, 4, value);
		for (int k = 0; k < 8; k++) {
			double error = value[k] - f->index[k];
			rms[k] += error * error / designs;
			bias[k] += error / designs;
		}
		free(y);
	}
	for (int k = 0; k < 8; k++)
		rms[k] = sqrt(rms[k]);
}

static void errors_over_designs_are_those_measured_for_the_formulas(void **state)
{
	(void)state;
	for (const struct function *f = functions; f->name; f++) {
		double s10[8], s10_bias[8], j[8], j_bias[8];
		errors_of("saltelli", f, 100, s10, s10_bias);
		errors_of("jansen", f, 100, j, j_bias);
		for (int k = 0; k < 8; k++) {
			const double *rms = k < 4 ? s10 : j, *bias = k < 4 ? s10_bias : j_bias;
			if (f->error[k] > 0.0) {
				// an RMSE of 100 designs is good to 7 %: three and a half of that; a mean to a tenth of the RMSE
				assert_true(rms[k] <= 1.25 * f->error[k]);
				check_near(bias[k], 0.0, 0.35 * f->error[k]);
			}
			// the variance over all samples makes the totals no worse
			if (k >= 4)
				assert_true(s10[k] <= 1.05 * j[k]);
		}
	}
}

CHECK_MAIN(cmocka_unit_test(every_estimator_gives_its_golden_values),
           cmocka_unit_test(an_input_without_effect_has_a_total_of_exactly_zero),
           cmocka_unit_test(shift_and_scale_change_no_index),
           cmocka_unit_test(relabelling_the_inputs_relabels_the_indexes),
           cmocka_unit_test(a_constant_output_has_undefined_indexes),
           cmocka_unit_test(errors_over_designs_are_those_measured_for_the_formulas))
