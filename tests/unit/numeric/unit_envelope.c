/* unit_envelope.c - symmetric matrices stored by rows from their first entry on, against full matrices. */
#include <math.h>
#include <string.h>

#include "engine/numeric/envelope.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"

enum { MOST = 40 };

static int first[MOST], begin[MOST];
static double values[MOST * (MOST + 1) / 2], whole[MOST][MOST], x[MOST], b[MOST];

/* Random springs between equations, each row to some rows before it, and a spring `ground` from each row to the ground. */
static struct pound_envelope springs(uint64_t *seed, int n, double ground)
{
	struct pound_envelope e = {n, first, begin, values};
	double spring[MOST][MOST] = {{0}};
	for (int i = 0; i < n; i++) {
		first[i] = i;
		for (int j = 0; j < i; j++)
			if (specimen_uniform(seed, 0, 1) < 0.15) {
				spring[i][j] = specimen_uniform(seed, 0.1, 10);
				first[i] = j < first[i] ? j : first[i];
			}
	}
	memset(values, 0, sizeof values);
	memset(whole, 0, sizeof whole);
	assert_true(pound_envelope_lay(&e) <= n * (n + 1) / 2);
	for (int i = 0; i < n; i++) {
		pound_envelope_add(&e, i, i, ground);
		whole[i][i] += ground;
		for (int j = 0; j < i; j++) {
			if (spring[i][j] == 0)
				continue;
			pound_envelope_add(&e, i, i, spring[i][j]);
			pound_envelope_add(&e, j, j, spring[i][j]);
			pound_envelope_add(&e, j, i, -spring[i][j]); // either order is the same entry
			whole[i][i] += spring[i][j], whole[j][j] += spring[i][j];
			whole[i][j] = whole[j][i] = -spring[i][j];
		}
	}
	return e;
}

static void a_solution_gives_the_right_side_again(void **state)
{
	(void)state;
	uint64_t seed = 5;
	for (int number = 0; number < 200; number++) {
		const int n = 1 + number % MOST;
		struct pound_envelope e = springs(&seed, n, 0.5);
		for (int i = 0; i < n; i++)
			x[i] = b[i] = specimen_uniform(&seed, -1, 1);
		assert_true(pound_envelope_decompose(&e));
		pound_envelope_solve(&e, x);
		for (int i = 0; i < n; i++) {
			double sum = 0, terms = 0;
			for (int j = 0; j < n; j++)
				sum += whole[i][j] * x[j], terms += fabs(whole[i][j] * x[j]);
			// rounding errors of a decomposition of n rows, relative to the terms
			check_near(sum, b[i], 4e-16 * n * (terms + 1));
		}
	}
}

/* Springs without ground allow a motion without force: with slightly negative ground springs the matrix is not
 * positive definite, with slightly positive ones it is. */
static void what_is_not_positive_definite_is_said(void **state)
{
	(void)state;
	uint64_t seed = 9;
	for (int number = 0; number < 100; number++) {
		const int n = 1 + number % MOST;
		const uint64_t same = seed;
		struct pound_envelope e = springs(&seed, n, 1e-9);
		assert_true(pound_envelope_decompose(&e));
		seed = same;
		e = springs(&seed, n, -1e-9);
		assert_false(pound_envelope_decompose(&e));
	}
	struct pound_envelope e = {1, first, begin, values};
	first[0] = begin[0] = 0;
	values[0] = NAN;
	assert_false(pound_envelope_decompose(&e));
}

CHECK_MAIN(cmocka_unit_test(a_solution_gives_the_right_side_again),
           cmocka_unit_test(what_is_not_positive_definite_is_said))
