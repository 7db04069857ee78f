/* root.c - the first root of a polynomial over a step, by parabolas that pass none. */
#include "engine/floor/root.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

enum {
	N = POUND_ROOT_ORDER,
	ROUNDS = 64,
	DEFLATE_MAX = 6, /* leading zeros of a guard: at rest, touching, equal ground */
};

/* First time in (0, limit] at which a guard, not positive at 0, becomes positive.
 *
 * Given    g       (order + 1)  its coefficients, order <= POUND_ROOT_ORDER
 *          limit   last time of interest
 * Returns  t       that time, or a safe one where the search had to give up
 *          value   whether there is one up to the limit
 *
 * A parabola with the guard's value and slope at t and a bound of its curvature lies above the guard, so no root lies
 * before the parabola's.
 * Test     unit_trace
 */
enum pound_root pound_root_first(const double *g, int order, double limit, double *t)
{
	for (int m = 0; m < DEFLATE_MAX && g[0] == 0 && order > 0; m++, g++, order--)
		;
	if (g[0] >= 0) {
		*t = 0;
		return g[0] > 0 ? POUND_ROOT_FOUND : POUND_ROOT_NONE;
	}
	double top = g[0];
	for (int n = 1; n <= order; n++)
		top += g[n] > 0 ? g[n] : 0;
	if (top < 0)
		return POUND_ROOT_NONE;
	double own[N + 1], d[N + 1] = {0}, large = 0, curved = 0;
	for (int n = 0; n <= order; n++)
		large = fabs(g[n]) > large ? fabs(g[n]) : large;
	// squares are taken: what would vanish in them is raised by a power of two
	const double raise = large < 0x1p-400 ? 0x1p600 : 1;
	for (int n = 0; n <= order; n++)
		own[n] = g[n] * raise;
	for (int n = 1; n <= order; n++)
		d[n - 1] = n * own[n];
	for (int n = order; n > 2; n--)
		curved += (double)n * (n - 1) * fabs(own[n]);
	double second = order > 1 ? 2 * own[2] : 0, bend = fmax(0, second + curved);
	curved += fabs(second);
	*t = 0;
	for (int round = 0; round < ROUNDS; round++) {
		double slope = order > 0 ? pound_root_value(d, order - 1, *t) : 0;
		double below = fmin(pound_root_value(own, order, *t), 0);
		double root = sqrt(slope * slope - 2 * bend * below);
		double step = slope > 0 ? -2 * below / (slope + root) : bend > 0 ? (root - slope) / bend : 2;
		bool near = step * step * curved < 0.5 * DBL_EPSILON * slope;
		if (!near && step < 0.5 * DBL_EPSILON)
			return POUND_ROOT_CUT;
		*t += step;
		if (*t > limit)
			return POUND_ROOT_NONE;
		if (near)
			return POUND_ROOT_FOUND;
	}
	return POUND_ROOT_CUT;
}
