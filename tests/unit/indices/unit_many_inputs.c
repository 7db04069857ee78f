/* unit_many_inputs.c - the largest number of inputs that a study may have, for a function with known indices.
 *
 * In a product of independent factors with mean 1 and variances v_j, a set u explains prod_u (1 + v_j) - 1. */
#include "tests/support/check.h"

#include "engine/pound.h"

#include <math.h>
#include <string.h>

enum { D = POUND_INPUTS_MAX, ROWS = 1024 };

static const unsigned group = 0xc0000001; // the first and the last two

/* Sobol's g: the first, the middle and the last inputs matter, half of all have no effect. */
static double weight(int j)
{
	return j % 2 ? INFINITY : j == 0 || j == 16 || j == 30 ? 0.5 : 6 + j;
}

static double factor_variance(int j)
{
	// the last input matters, too: its bit is the sign bit of an int
	const double a = j == D - 1 ? 1 : weight(j);
	return isinf(a) ? 0 : 1 / (3 * (1 + a) * (1 + a));
}

static double product(const double *x)
{
	double y = 1;
	for (int j = 0; j < D; j++) {
		const double v = factor_variance(j);
		y *= v > 0 ? 1 + sqrt(3 * v) * (fabs(4 * x[j] - 2) - 1) : 1;
	}
	return y;
}

static double explained(unsigned set)
{
	double part = 1;
	for (int j = 0; j < D; j++)
		part *= set >> j & 1 ? 1 + factor_variance(j) : 1;
	return part - 1;
}

static bool holds(struct pound_estimate e, double want)
{
	return e.low <= want && want <= e.high;
}

static void the_last_input_has_its_indices_as_the_first(void **state)
{
	const double whole = explained(~0u);
	(void)state;
	for (int method = 0; pound_design_name(method); method++)
		for (int order = 0; order < 2; order++) {
			static struct pound_input inputs[D];
			static char name[] = "y";
			static char *names[] = {name};
			struct pound_study study = {.kind = POUND_KIND_SENSITIVITY,
			                            .elsewhere = true,
			                            .n_inputs = D,
			                            .inputs = inputs,
			                            .design = {.method = method, .rows = ROWS, .seed = 5, .order = order},
			                            .n_outputs = 1,
			                            .output_names = names,
			                            .n_groups = 1,
			                            .groups = {{.inputs = group}}};
			for (int j = 0; j < D; j++)
				inputs[j].distribution = (struct pound_distribution){.p = {0, 1}};
			struct pound_run *run = pound_run_create(&study, 1);
			assert_non_null(run);
			assert_int_equal(pound_run_samples(run), (order ? 2 * D : D) + 3);
			for (int i = 0; i < ROWS; i++)
				for (int p = 0; p < pound_run_samples(run); p++) {
					double x[D];
					pound_run_sample_inputs(run, i, p, x);
					pound_run_sample_assign(run, i, p, 0, product(x), NAN);
				}
			assert_int_equal(pound_run_reduce(run, 0, 0), POUND_OK);
			const struct pound_indices *indices = &pound_run_result(run)->cells[0].indices[0];
			int inside = 0;
			double worst = 0;
			for (int j = 0; j < D; j++) {
				const double first = explained(1u << j) / whole, total = 1 - explained(~0u ^ 1u << j) / whole;
				const struct pound_estimate *s1 = &indices->index[POUND_S1][j],
				                            *st = &indices->index[POUND_ST][j];
				worst = fmax(worst, fmax(fabs(s1->value - first), fabs(st->value - total)));
				inside += holds(*s1, first) + holds(*st, total);
			}
			check_report("%s, order %d: worst error %.3f, %d of %d intervals hold", pound_design_name(method),
			             order, worst, inside, 2 * D);
			// 0.05 is six standard errors of a mean of 1,024 products
			assert_true(worst < 0.05);
			assert_true(inside >= 2 * D * 3 / 4);
			assert_true(fabs(indices->groups.first[0].value - explained(group) / whole) < 0.05);
			assert_true(fabs(indices->groups.total[0].value - 1 + explained(~group) / whole) < 0.05);
			assert_int_equal(indices->sets.n_second, order ? D * (D - 1) / 2 : 0);
			for (int k = 0; k < indices->sets.n_second; k++) {
				const unsigned set = indices->sets.second[k].inputs;
				const double want =
				    (explained(set) - explained(set & (set - 1)) - explained(set & -set)) / whole;
				assert_int_equal(__builtin_popcount(set), 2);
				assert_true(fabs(indices->sets.second[k].estimate.value - want) < 0.05);
			}
			pound_run_free(run);
		}
}

CHECK_MAIN(cmocka_unit_test(the_last_input_has_its_indices_as_the_first))
