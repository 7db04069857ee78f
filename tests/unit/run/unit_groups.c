/* unit_groups.c - indices of groups of inputs, for functions with known indices.
 *
 * In a product of independent factors with mean 1 and variances v_j, a set u explains prod_u (1 + v_j) - 1. */
#include "tests/support/check.h"

#include "engine/pound.h"

#include <math.h>
#include <string.h>

enum { D = 7, GROUPS = 4 };

static const double a[D] = {0, 0.5, 1, 2, 4, 9, 0};
// the last contains the input without effect, and overlaps another
static const unsigned sets[GROUPS] = {0x3, 0xc, 0x31, 0x60};

/* Sobol's g of the first six inputs. */
static double product(const double *x)
{
	double y = 1;
	for (int j = 0; j < D - 1; j++)
		y *= (fabs(4 * x[j] - 2) + a[j]) / (1 + a[j]);
	return y;
}

static double explained(unsigned set)
{
	double part = 1;
	for (int j = 0; j < D - 1; j++)
		part *= set >> j & 1 ? 1 + 1 / (3 * (1 + a[j]) * (1 + a[j])) : 1;
	return part - 1;
}

static double inert(const double *x)
{
	return x[0] + 2 * x[1] * x[2];
}

static struct pound_run *run_of(struct pound_study *study, double (*y)(const double *x))
{
	struct pound_run *run = pound_run_create(study, 1);
	assert_non_null(run);
	assert_int_equal(pound_run_samples(run), D + 2 + GROUPS);
	for (int i = 0; i < study->design.rows; i++)
		for (int p = 0; p < pound_run_samples(run); p++) {
			double x[D];
			pound_run_sample_inputs(run, i, p, x);
			pound_run_sample_assign(run, i, p, 0, y(x), NAN);
		}
	assert_int_equal(pound_run_reduce(run, 0, 0), POUND_OK);
	return run;
}

static struct pound_study study_of(int method)
{
	static struct pound_input inputs[D];
	static char name[] = "y";
	static char *names[] = {name};
	struct pound_study study = {.kind = POUND_KIND_SENSITIVITY,
	                            .elsewhere = true,
	                            .n_inputs = D,
	                            .inputs = inputs,
	                            .design = {.method = method, .rows = 2048, .seed = 11},
	                            .n_outputs = 1,
	                            .output_names = names,
	                            .n_groups = GROUPS};
	for (int j = 0; j < D; j++)
		inputs[j].distribution = (struct pound_distribution){.p = {0, 1}};
	for (int g = 0; g < GROUPS; g++)
		study.groups[g].inputs = sets[g];
	return study;
}

static void indices_of_a_group_are_those_of_its_inputs_as_one(void **state)
{
	(void)state;
	const double whole = explained(0x3f);
	for (int method = 0; pound_design_name(method); method++) {
		struct pound_study study = study_of(method);
		struct pound_run *run = run_of(&study, product);
		const struct pound_group_indices *groups = &pound_run_result(run)->cells[0].indices[0].groups;
		assert_int_equal(groups->n, GROUPS);
		for (int g = 0; g < GROUPS; g++) {
			const struct pound_estimate *first = &groups->first[g], *total = &groups->total[g];
			const double half[2] = {0.5 * (first->high - first->low), 0.5 * (total->high - total->low)};
			// one of 24 intervals of two standard deviations may miss, none by more than another half of its half width
			check_near(first->value, explained(sets[g]) / whole, 1.5 * half[0]);
			check_near(total->value, 1 - explained(0x3f & ~sets[g]) / whole, 1.5 * half[1]);
			assert_true(half[0] > 0 && half[0] < 0.1 && half[1] > 0 && half[1] < 0.1);
		}
		pound_run_free(run);
	}
}

static void a_group_without_effect_explains_nothing(void **state)
{
	(void)state;
	struct pound_study study = study_of(0);
	struct pound_run *run = run_of(&study, inert);
	const struct pound_indices *indices = &pound_run_result(run)->cells[0].indices[0];
	// a polynomial of second degree: only rounding errors remain
	check_near(indices->groups.total[3].value, 0, 1e-9);
	check_near(indices->groups.first[3].value, 0, 1e-9);
	// x0 has 1/12, 2 x1 x2 has 4 (1/9 - 1/16)
	const double one = 1.0 / 12, other = 4.0 * (1.0 / 9 - 1.0 / 16);
	check_near(indices->groups.first[2].value, one / (one + other), 1e-9);
	check_near(indices->groups.total[0].value, 1 - 4.0 / 48 / (one + other), 1e-9);
	pound_run_free(run);
}

CHECK_MAIN(cmocka_unit_test(indices_of_a_group_are_those_of_its_inputs_as_one),
           cmocka_unit_test(a_group_without_effect_explains_nothing))
