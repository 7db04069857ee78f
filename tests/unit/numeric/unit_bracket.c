/* unit_bracket.c - the search for a root: it converges fast, or ends where the function jumps over zero. */
#include <float.h>
#include <math.h>

#include "engine/numeric/bracket.h"
#include "tests/support/check.h"

/* Decreasing functions with one root, with slopes from -1 to -1e3 at the root. */
static double smooth(double x)
{
	return 1 - x - 0.3 * sin(x);
}

static double kinked(double x)
{
	return x < 0.7 ? 40 * (0.7 - x) : 0.2 * (0.7 - x);
}

static double steep(double x)
{
	return -tanh(1e3 * (x + 2.3)) - 0.1 * (x + 2.3);
}

/* Not monotonic: it comes near to 0 before its root. */
static double wavy(double x)
{
	return 3.3 - 0.4 * x + 1.3 * sin(3 * x);
}

static double leaping(double x)
{
	return x < 1.0 / 3 ? 0.5 - 0.1 * x : -0.2 - 0.1 * x;
}

/* Evaluations until |f| is small or no number lies between; where the search ends. */
static int evaluations(double (*f)(double), double x, double small, double *end, bool *jumps)
{
	struct pound_bracket bracket = {0};
	int n = 1;
	double value = f(x);
	*jumps = false;
	for (; fabs(value) > small && n < 200; n++) {
		double next = NAN;
		*jumps = !pound_bracket_next(&bracket, x, value, &next);
		if (*jumps)
			break;
		assert_true(isfinite(next) && next != x);
		value = f(x = next);
	}
	*end = x;
	return n;
}

/* Bisection takes log2(L w/small) evaluations for a function of slope L at the root and a bracket of width w: the
 * first step is as long as the function's value, and each further step at most four times as long.  At a kink an
 * interpolation may be wasted before each of them. */
static void a_root_is_found_from_either_side_in_twice_the_time_of_bisection(void **state)
{
	(void)state;
	static double (*const functions[])(double) = {smooth, kinked, steep, wavy};
	static const double slopes[] = {1.3, 40, 1e3, 4.3}, small = 1e-12;
	for (int k = 0; k < 4; k++)
		for (double start = -6; start <= 6; start += 0.37) {
			double end, apart = 12 + 4 * fabs(functions[k](start));
			bool jumps;
			int n = evaluations(functions[k], start, small, &end, &jumps);
			assert_false(jumps);
			assert_true(fabs(functions[k](end)) <= small);
			if (n > 2 * log2(slopes[k] * apart / small))
				fail_msg("function %d from %g: %d evaluations", k, start, n);
		}
}

static void near_a_root_digits_multiply(void **state)
{
	(void)state;
	double end;
	bool jumps;
	int few = evaluations(smooth, 3, 1e-3, &end, &jumps), more = evaluations(smooth, 3, 1e-14, &end, &jumps);
	assert_true(more - few <= 4); // bisection: 37
}

static void a_jump_over_the_root_is_found_between_two_neighbours(void **state)
{
	(void)state;
	for (double start = -6; start <= 6; start += 0.37) {
		double end;
		bool jumps;
		int n = evaluations(leaping, start, 1e-6, &end, &jumps);
		assert_true(jumps);
		check_near(end, 1.0 / 3, 4 * DBL_EPSILON);
		assert_true(
		    n < 3 * 60); // 60 halvings from 64 to a rounding, each after at most two steps that do not halve
	}
}

CHECK_MAIN(cmocka_unit_test(a_root_is_found_from_either_side_in_twice_the_time_of_bisection),
           cmocka_unit_test(near_a_root_digits_multiply),
           cmocka_unit_test(a_jump_over_the_root_is_found_between_two_neighbours))
