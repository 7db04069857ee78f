/* unit_motion_measures.c - peaks, Arias intensity and duration of motions with closed forms. */
#include <float.h>
#include <math.h>

#include "engine/pound.h"
#include "tests/support/check.h"

static const double PI = 3.14159265358979323846, G = 9.80665;

static void measures_of_motions_with_a_closed_form(void **state)
{
	(void)state;
	struct pound_motion_measures m;
	// a constant: v = A t, u = A t^2/2; the middle 90 % of the time
	const double constant[] = {2, 2, 2, 2, 2};
	pound_motion_measure(5, constant, 0.25, &m);
	check_near(m.pga, 2, 0);
	check_near(m.pgv, 2, 4 * DBL_EPSILON);
	check_near(m.pgd, 1, 4 * DBL_EPSILON);
	check_near(m.arias, PI / (2 * G) * 4, 8 * DBL_EPSILON);
	check_near(m.duration, 0.9, 8 * DBL_EPSILON);
	// a ramp through 0 at 1 s: v = t^2/2 - t, least at 1 s; u = t^3/6 - t^2/2, least at 2 s, where v is 0 again
	const double ramp[] = {-1, 2};
	pound_motion_measure(2, ramp, 3, &m);
	check_near(m.pga, 2, 0);
	check_near(m.pgv, 1.5, 8 * DBL_EPSILON);
	check_near(m.pgd, 2.0 / 3, 8 * DBL_EPSILON);
	check_near(m.arias, PI / (2 * G) * 3, 8 * DBL_EPSILON);
	// int a^2 = ((t - 1)^3 + 1)/3, 3 in all: 1 - cbrt(0.55) and 1 + cbrt(7.55)
	check_near(m.duration, cbrt(7.55) + cbrt(0.55), 16 * DBL_EPSILON);
	// a triangle and its mirror image: the velocity returns to 0, with peaks at a sample and between two
	const double doublet[] = {0, 1, 0, -1, 0};
	pound_motion_measure(5, doublet, 1, &m);
	check_near(m.pgv, 1, 8 * DBL_EPSILON);
	check_near(m.pgd, 2, 8 * DBL_EPSILON);
}

static void a_sine_has_its_measures_to_the_square_of_the_step(void **state)
{
	(void)state;
	enum { N = 4001 };
	static double a[N];
	const double w = 2 * PI, step = 10.0 / (N - 1);
	for (int i = 0; i < N; i++)
		a[i] = sin(w * i * step);
	struct pound_motion_measures m;
	pound_motion_measure(N, a, step, &m);
	// the trapezoidal rule gives (w h/2) cot(w h/2) = 1 - (w h)^2/12 - (w h)^4/720 - ... of the integral of a sine
	const double weak = w * w * step * step / 12 * (1 + w * w * step * step);
	check_near(m.pgv, 2 / w, 2 / w * weak);
	check_near(m.pgd, 10 / w, 10 / w * weak);
	check_near(m.arias, PI / (2 * G) * 5, PI / (2 * G) * 5 * 2 * weak);
	// whole periods: 5 and 95 % of int sin^2 are at 0.5 and 9.5 s
	check_near(m.duration, 9, 2 * step * step * w * w);
}

static void extremes_stay_finite(void **state)
{
	(void)state;
	struct pound_motion_measures m;
	const double nothing[] = {0, 0, 0};
	pound_motion_measure(3, nothing, 0.01, &m);
	assert_true(m.pga == 0 && m.pgv == 0 && m.pgd == 0 && m.arias == 0 && m.duration == 0);
	const double tiny[] = {0, 1e-300, -1e-300, 0};
	pound_motion_measure(4, tiny, 0.01, &m);
	assert_true(isfinite(m.pgv) && isfinite(m.pgd) && m.pgv > 0 && m.duration == 0);
	// scaling by a power of two scales the peaks exactly
	const double some[] = {0.3, -1.7, 2.9, 0.1, -0.4}, twice[] = {0.6, -3.4, 5.8, 0.2, -0.8};
	struct pound_motion_measures other;
	pound_motion_measure(5, some, 0.02, &m);
	pound_motion_measure(5, twice, 0.02, &other);
	assert_true(other.pgv == 2 * m.pgv && other.pgd == 2 * m.pgd && other.arias == 4 * m.arias);
	check_near(other.duration, m.duration, 0);
}

CHECK_MAIN(cmocka_unit_test(measures_of_motions_with_a_closed_form),
           cmocka_unit_test(a_sine_has_its_measures_to_the_square_of_the_step),
           cmocka_unit_test(extremes_stay_finite))
