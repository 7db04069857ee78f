/* bracket.c - a root of a decreasing function of one variable; the caller evaluates the function.
 *
 * 1. Until the root is bracketed: limited secant steps, up if the function is positive and down if it is negative.
 * 2. Then Chandrupatla's method: inverse quadratic interpolation if the last three points allow it, else bisection. */
#include "engine/numeric/bracket.h"

#include <float.h>
#include <math.h>

/* Smallest step over |f|, and largest step over the previous step, until the root is bracketed: secant steps that all stop
 * short of the root would never bracket it. */
static const double STEP_LEAST = 0.5, STEP_GROWTH = 4;

static double step_open(const struct pound_bracket *b)
{
	double f = b->f[0];
	if (b->n == 1)
		return f;
	double last = b->x[0] - b->x[1], slope = (f - b->f[1]) / last;
	double most = fmax(STEP_GROWTH * fabs(last), fabs(f)), step = slope < 0 ? fabs(f / slope) : most;
	return copysign(fmin(fmax(step, STEP_LEAST * fabs(f)), most), f);
}

/* The next point in a bracket, as a fraction of the way from the newest point to the other end.
 *
 * Source   Chandrupatla 1997, Advances in Engineering Software 28, 145-149
 */
static double share_closed(const struct pound_bracket *b)
{
	const double *x = b->x, *f = b->f;
	if (b->n == 2)
		return f[0] / (f[0] - f[1]);
	double xi = (x[0] - x[1]) / (x[2] - x[1]), phi = (f[0] - f[1]) / (f[2] - f[1]);
	if (!(phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi))
		return 0.5;
	double near = f[0] / (f[1] - f[0]) * f[2] / (f[1] - f[2]);
	double far = (x[2] - x[0]) / (x[1] - x[0]) * f[0] / (f[2] - f[0]) * f[1] / (f[2] - f[1]);
	return near + far;
}

/* Takes the value of the function at a point and returns the next point.
 *
 * Given    x, f  a point and the value there, not 0: > 0 if the root is above x
 * Returns  next  the point to evaluate next
 *          value false: the ends of the bracket are at most 2 eps max(1, |x|) apart, so the function jumps over 0
 * Test     unit_bracket
 */
bool pound_bracket_next(struct pound_bracket *b, double x, double f, double *next)
{
	const bool changes = b->n > 0 && (f > 0) != (b->f[0] > 0);
	// in a bracket, the new point replaces the newest one if both have the same sign; else the newest becomes x[1]
	const int left = b->closed && !changes ? 0 : 1;
	b->x[2] = b->x[left], b->f[2] = b->f[left];
	if (left)
		b->x[1] = b->x[0], b->f[1] = b->f[0];
	b->x[0] = x, b->f[0] = f;
	b->n++;
	b->closed |= changes;
	if (!b->closed) {
		*next = x + step_open(b);
		return true;
	}
	double way = b->x[1] - x, least = DBL_EPSILON * fmax(1, fabs(x)) / fabs(way);
	if (!(least < 0.5))
		return false;
	*next = x + fmin(fmax(share_closed(b), least), 1 - least) * way;
	return true;
}
