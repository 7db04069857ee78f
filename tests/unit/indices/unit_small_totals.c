/* unit_small_totals.c - intervals of a small total index whose squared differences few rows decide, through a whole run.
 *
 * y = x - P, P = x x_2 ... x_8 with uniform inputs.  The total effect of x_8 is E (x ... x_7)^2 / 12 = 3^-7 / 12.  The variance is
 * Var x + Var P - 2 Cov(x, P) = 1/12 + 3^-8 - 4^-8 - 2 (1/3 2^-7 - 1/2 2^-8). */
#include "tests/support/check.h"

#include "engine/pound.h"

#include <math.h>
#include <string.h>

enum { D = 8, ROWS = 250, SOBOL_ROWS = 256, DESIGNS = 120 };

static double output(const double *x)
{
	double product = 1;
	for (int j = 0; j < D; j++)
		product *= x[j];
	return x[0] - product;
}

/* Whether the interval of the last input's total, and the one of the first input's, contain the exact index. */
static void design_score(const struct pound_design *design, const double *exact, int *holds)
{
	static struct pound_input inputs[D];
	static char name[] = "y";
	static char *names[] = {name};
	const struct pound_study study = {.kind = POUND_KIND_SENSITIVITY,
	                                  .elsewhere = true,
	                                  .n_inputs = D,
	                                  .inputs = inputs,
	                                  .design = *design,
	                                  .n_outputs = 1,
	                                  .output_names = names};
	for (int j = 0; j < D; j++)
		inputs[j].distribution = (struct pound_distribution){.p = {0, 1}};
	struct pound_run *run = pound_run_create(&study, 1);
	assert_non_null(run);
	for (int i = 0; i < study.design.rows; i++)
		for (int p = 0; p < pound_run_samples(run); p++) {
			double x[D];
			pound_run_sample_inputs(run, i, p, x);
			pound_run_sample_assign(run, i, p, 0, output(x), NAN);
		}
	assert_int_equal(pound_run_reduce(run, 0, 0), POUND_OK);
	const struct pound_estimate *total = pound_run_result(run)->cells[0].indices[0].index[POUND_ST];
	for (int k = 0; k < 2; k++) {
		const struct pound_estimate *e = &total[k ? 0 : D - 1];
		holds[k] += e->low <= exact[k] && exact[k] <= e->high;
	}
	pound_run_free(run);
}

/* The binomial law of 120 designs gives a coverage of 0.90 a standard deviation of 0.027. */
static void intervals_of_a_small_total_hold(void **state)
{
	(void)state;
	const double square = pow(3, -D),
	             variance = 1. / 12 + square - pow(4, -D) - 2 * (pow(2, -7) / 3 - pow(2, -9));
	// x (1 - x_2 ... x_8) depends on x_1 with the mean square of its slope over 12
	const double exact[2] = {3 * square / 12 / variance, (1 - pow(2, -6) + 3 * square) / 12 / variance};
	for (int method = 0; pound_design_name(method); method++) {
		const bool sobol = strcmp(pound_design_name(method), "sobol") == 0;
		int holds[2] = {0, 0};
		for (int seed = 0; seed < DESIGNS; seed++)
			design_score(&(struct pound_design){.method = method,
			                                    .rows = sobol ? SOBOL_ROWS : ROWS,
			                                    .seed = (uint64_t)seed,
			                                    .resamples = 400},
			             exact, holds);
		check_report("%s: of %d intervals, %d of the smallest and %d of the largest total hold",
		             pound_design_name(method), DESIGNS, holds[0], holds[1]);
		for (int k = 0; k < 2; k++)
			assert_true(holds[k] > (0.90 - 3 * 0.027) * DESIGNS);
	}
}

CHECK_MAIN(cmocka_unit_test(intervals_of_a_small_total_hold))
