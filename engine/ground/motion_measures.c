/* motion_measures.c - intensity measures of a ground motion: peaks, Arias intensity, significant duration.
 *
 * The acceleration is linear between samples, so in each interval velocity is a quadratic and displacement a cubic; both
 * start at 0.  There is no baseline correction: a baseline error of the record appears in the displacement. */
#include <assert.h>
#include <math.h>

#include "engine/pound.h"

static const double PI = 0x1.921fb54442d18p+1, GRAVITY = 9.80665;

/* motion in one interval; values at its start */
struct interval {
	double h;        /* length [s] */
	double a, slope; /* [m/s2], [m/s3] */
	double v, u;     /* [m/s], [m] */
};

static double velocity(const struct interval *i, double t)
{
	return i->v + t * (i->a + 0.5 * i->slope * t);
}

static double displacement(const struct interval *i, double t)
{
	return i->u + t * (i->v + t * (0.5 * i->a + i->slope * t / 6));
}

/* Integral of a^2 from 0 to t: ((a + s t)^3 - a^3)/(3 s), multiplied out to avoid the division by a zero slope s. */
static double squared(const struct interval *i, double t)
{
	const double s = i->slope * t;
	return t * (i->a * i->a + i->a * s + s * s / 3);
}

static void raise(double *most, double value)
{
	if (fabs(value) > *most)
		*most = fabs(value);
}

/* Peaks inside an interval: velocity at zeros of the acceleration, displacement at zeros of the velocity. */
static void interval_peaks(const struct interval *i, struct pound_motion_measures *m)
{
	const double root = -i->a / i->slope;
	if (root > 0 && root < i->h)
		raise(&m->pgv, velocity(i, root));
	const double square = i->a * i->a - 2 * i->slope * i->v;
	if (square < 0)
		return;
	// the root without cancellation first, the other one from the product of the roots
	const double sum = -(i->a + copysign(sqrt(square), i->a));
	const double roots[2] = {sum / i->slope, 2 * i->v / sum};
	for (int k = 0; k < 2; k++)
		if (roots[k] > 0 && roots[k] < i->h)
			raise(&m->pgd, displacement(i, roots[k]));
}

/* The time in an interval at which the integral of a^2 reaches a value, by bisection to rounding. */
static double time_of(const struct interval *i, double value)
{
	double low = 0, high = i->h;
	for (double middle = 0.5 * high; low < middle && middle < high; middle = 0.5 * (low + high))
		*(squared(i, middle) < value ? &low : &high) = middle;
	return high;
}

/* Moves to the next interval, between samples `a` and `b`. */
static void advance(struct interval *i, double a, double b, double h)
{
	const double v = velocity(i, i->h), u = displacement(i, i->h);
	*i = (struct interval){.h = h, .a = a, .slope = (b - a) / h, .v = v, .u = u};
}

/* Time between 5 % and 95 % of the integral of a^2 [s]. */
static double duration_between(int n, const double *a, double step, double total)
{
	double times[2] = {0}, sum = 0;
	struct interval i = {0};
	for (int t = 0, k = 0; t < n - 1 && k < 2; t++) {
		advance(&i, a[t], a[t + 1], step);
		const double before = sum;
		sum += squared(&i, step);
		for (; k < 2 && sum >= (k ? 0.95 : 0.05) * total; k++)
			times[k] = t * step + time_of(&i, (k ? 0.95 : 0.05) * total - before);
	}
	return times[1] - times[0];
}

/* Measures of a ground motion.
 *
 * Given    a      (n)   m/s2   at times 0, step, ..., linear in between  (n >= 2)
 *          step         s      > 0
 * Returns  measures            all 0 for a motion that is 0
 *
 *   v(t) = int_0^t a,  u(t) = int_0^t v,  Arias = pi/(2 g) int a^2 dt,  g = 9.80665 m/s2
 *   duration: between the times at which int a^2 reaches 5 % and 95 % of its final value
 *
 * Valid    Exact for the piecewise linear acceleration, to the rounding errors of sums of n terms.
 * Source   Arias 1970; Trifunac & Brady 1975 (5-95 %)
 * Test     unit_motion_measures: measures_of_motions_with_a_closed_form
 */
void pound_motion_measure(int n, const double *a, double step, struct pound_motion_measures *measures)
{
	assert(n >= 2 && step > 0);
	struct interval i = {0};
	double sum = 0;
	*measures = (struct pound_motion_measures){.pga = fabs(a[0])};
	for (int t = 0; t < n - 1; t++) {
		advance(&i, a[t], a[t + 1], step);
		raise(&measures->pga, a[t + 1]);
		raise(&measures->pgv, velocity(&i, step));
		raise(&measures->pgd, displacement(&i, step));
		interval_peaks(&i, measures);
		sum += squared(&i, step);
	}
	measures->arias = PI / (2 * GRAVITY) * sum;
	measures->duration = sum > 0 ? duration_between(n, a, step, sum) : 0;
}
