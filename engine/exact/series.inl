/* series.inl - motion between two events as power series in time, and the first root of a guard on it.
 *
 * Included by exact.inl, after free_motion.inl, and by chain.inl, once per lane count.  The including file defines the orders of
 * the series, ORDER_LOW and ORDER_HIGH: odd, as terms are taken in pairs. */

#include <float.h>

#include "engine/exact/kinematics.h"
#include "engine/exact/tolerances.h"
#include "engine/numeric/lanes.h"

enum {
	ROOT_ROUNDS = 64, /* of the safe root search; it converges quadratically but for double roots */
	QUICK_ROUNDS = 5, /* of Halley's method from the parabola through both ends */
	DEFLATE_MAX = 6,  /* most leading zero coefficients of a guard: at rest, touching, equal ground motion */
};

/* Runs BODY for n from one order up to another, unrolled: the orders are constants. */
#define ORDERS_UP(n, from, to, ...)                               \
	_Pragma("GCC unroll 20") for (int n = (from); n <= (to); n++) \
	{                                                             \
		__VA_ARGS__                                               \
	}
/* Runs BODY for odd n, down from order - `below`, unrolled for either order. */
#define ORDERS_ODD(n, order, below, ...)                                                         \
	_Pragma("GCC unroll 10") for (int n = ORDER_HIGH - (below); n > 0;                           \
	                              n -= 2) if (n <= ORDER_LOW - (below) || (order) == ORDER_HIGH) \
	{                                                                                            \
		__VA_ARGS__                                                                              \
	}

/* Coefficients of a series. */
struct power {
	vd c[ORDER_HIGH + 1];
};

/* A motion over a step of time 0 .. 1: its displacement. */
struct motion {
	struct power u;
	struct kinematics end; /* displacement, and velocity times the step */
	vd fourth_max;         /* bound of the fourth derivative over the step */
};

/* Both bodies and the overlap over a step.  The overlap is integrated as a separate variable: in a stiff contact the difference
 * u1 - u2 - gap would cancel. */
struct series {
	int order;
	struct motion body[2], overlap;
};

/* Value of a series at time t, even and odd terms summed separately: half the latency of Horner's rule. */
LANE_INLINE vd power_at(const struct power *s, int order, vd t)
{
	vd t2 = t * t, even = s->c[order - 1], odd = s->c[order];
	ORDERS_ODD(n, order, 2, even = vfma(even, t2, s->c[n - 1]); odd = vfma(odd, t2, s->c[n]);)
	return vfma(odd, t, even);
}

/* Value and derivative: with x = t^2 of even(x) + t odd(x), by Horner's rule for the derivatives of both as well. */
LANE_INLINE struct kinematics kinematics_at(const struct power *s, int order, vd t)
{
	vd t2 = t * t, even_rate = s->c[order - 1], odd_rate = s->c[order];
	vd even = vfma(even_rate, t2, s->c[order - 3]), odd = vfma(odd_rate, t2, s->c[order - 2]);
	ORDERS_ODD(n, order, 4, even_rate = vfma(even_rate, t2, even); odd_rate = vfma(odd_rate, t2, odd);
	           even = vfma(even, t2, s->c[n - 1]); odd = vfma(odd, t2, s->c[n]);)
	return (struct kinematics){vfma(odd, t, even), vfma(2.0 * t, vfma(odd_rate, t, even_rate), odd)};
}

/* Factor of coefficient n in the bound of the fourth derivative. */
LANE_INLINE double fourth(int n)
{
	return (double)n * (n - 1) * (n - 2) * (n - 3);
}

/* Sums the series at the end of the step. */
LANE_INLINE void motion_end(struct motion *m, int order)
{
	vd u = m->u.c[0], v = vsplat(0);
	ORDERS_UP(n, 1, order, u = u + m->u.c[n]; v = n < 2 ? m->u.c[n] : vfma(vsplat(n), m->u.c[n], v);)
	m->end = (struct kinematics){u, v};
}

/* Bounds the fourth derivative of a motion by the magnitudes of its terms. */
LANE_INLINE void motion_bound(struct motion *m, int order)
{
	vd fourth_max = vsplat(0);
	ORDERS_UP(n, 4, order, fourth_max = vfma(vsplat(fourth(n)), vabs(m->u.c[n]), fourth_max);)
	m->fourth_max = fourth_max;
}

/* Enclosure of a quantity over a step: values and slopes at both ends, and a bound of its fourth derivative. */
struct enclosure {
	vd u0, v0, u1, v1, fourth_max;
};

LANE_INLINE struct enclosure enclosure_of(const struct motion *m)
{
	return (struct enclosure){m->u.c[0], m->u.c[1], m->end.u, m->end.v, m->fourth_max};
}

LANE_INLINE struct enclosure enclosure_of_velocity(const struct motion *m, int order)
{
	vd fourth_max = vsplat(0), end = vsplat(0);
	ORDERS_UP(n, 2, order, end = vfma(vsplat(n * (n - 1.0)), m->u.c[n], end);)
	ORDERS_UP(n, 5, order, fourth_max = vfma(vsplat(n * fourth(n - 1)), vabs(m->u.c[n]), fourth_max);)
	return (struct enclosure){m->u.c[1], 2.0 * m->u.c[2], m->end.v, end, fourth_max};
}

/* Lanes in which a guard may cross a level inside a step; it starts on the permitted side.
 *
 * Given    sign  +1: permitted below the level, -1: above
 *
 * With g = sign (u - level) the cubic through the ends has the control points g0 <= 0, b1, b2, g1, and differs from g by at
 * most fourth_max/24 t^2 (1 - t)^2 <= fourth_max/384.  So g stays negative when the points after g0 are below -fourth_max/288 (see
 * POUND_CUBIC_ERROR), and also, from a start on the level itself, when b1 <= 0, g1 <= 0 and 3 b2 + fourth_max/24 <= 0.
 */
LANE_INLINE vm may_cross(const struct enclosure *c, vd level, vd sign)
{
	vd zero = vsplat(0), third = vsplat(1.0 / 3);
	vd g0 = sign * (c->u0 - level), g1 = sign * (c->u1 - level);
	vd b1 = vfma(sign * third, c->v0, g0), b2 = vfma(-sign * third, c->v1, g1);
	vd top = vmax(vmax(b1, b2), g1);
	vm inside = ~vless(vfma(vsplat(POUND_CUBIC_ERROR), c->fourth_max, top), zero);
	vm after = vless(zero, vmax(b1, g1)) | vless(zero, vfma(vsplat(1.0 / 24), c->fourth_max, 3.0 * b2));
	return inside & after;
}

/* Lower bound of a guard's rate over a step: the rate's control points are its values at the ends and `middle`;
 * they differ from it by at most sqrt(3)/216 of the fourth derivative. */
LANE_INLINE vd enclosure_slowest(const struct enclosure *c)
{
	vd middle = vfma(vsplat(3), c->u1 - c->u0, -(c->v0 + c->v1));
	return vmin(vmin(c->v0, c->v1), middle) - vsplat(0.00802) * c->fourth_max;
}

/* Bound of |u| inside a step, its ends excluded. */
LANE_INLINE vd reach_of(const struct motion *m)
{
	vd third = vsplat(1.0 / 3);
	vd b1 = vfma(third, m->u.c[1], m->u.c[0]), b2 = vfma(-third, m->end.v, m->end.u);
	return vfma(vsplat(POUND_CUBIC_ERROR), m->fourth_max, vmax(vabs(b1), vabs(b2)));
}

/* result of a search: one of these, or an event of the solver from EVENT_OWN on */
enum {
	EVENT_NONE,
	EVENT_CUT, /* a search was unsure: no event up to this time */
	EVENT_OWN,
};

/* First event found so far in each lane. */
struct search {
	vd time;  /* fraction of the step, 1: none yet */
	vd event; /* event number as a double */
};

/* Second derivative of a series, from its lower half: the omitted terms are near 1e-4 of it. */
LANE_INLINE vd curvature_at(const struct power *s, int order, vd t)
{
	vd sum = vsplat(0);
	if (order == ORDER_HIGH)
		for (int n = ORDER_HIGH / 2; n > ORDER_LOW / 2; n--)
			sum = vfma(sum, t, vsplat((double)n * (n - 1)) * s->c[n]);
	for (int n = ORDER_LOW / 2; n >= 2; n--)
		sum = vfma(sum, t, vsplat((double)n * (n - 1)) * s->c[n]);
	return sum;
}

/* A guard g = sign (u - level): the event is where it becomes positive. */
struct guard {
	const struct power *u;
	vd level, sign;
	vd g0, g1;     /* its values at the start of the step (<= 0 except for rounding) and at the end */
	vd fourth_max; /* bound of its fourth derivative over the step */
};

LANE_INLINE struct guard guard_of(const struct power *u, const struct enclosure *c, vd level, vd sign)
{
	return (struct guard){.u = u,
	                      .level = level,
	                      .sign = sign,
	                      .g0 = sign * (c->u0 - level),
	                      .g1 = sign * (c->u1 - level),
	                      .fourth_max = c->fourth_max};
}

/* First root by Halley's method if the guard is positive at the limit, with a proof that it is the first.
 *
 * Given    g       with g1 at the limit, the last time of interest
 *          active  lanes to search
 * Returns  value   lanes whose root t was found and proved
 *
 * The search starts at the root of the parabola through value and slope at 0 and the value at the limit.  With g(t) = 0,
 * the cubic through 0 and t over (t - time), and its error fourth_max/24 time^2 (t - time), stay negative before t when the
 * cubic's inner control points are, the second by more than the error: no root lies before t.
 */
LANE_SHARED vm root_quick(const struct guard *g, int order, vd limit, vm active, vd *root_time)
{
	const struct power *u = g->u;
	// local copies stay in registers: a write through a pointer could alias them
	const vd sign = g->sign, level = g->level, g0 = g->g0, g1 = g->g1, fourth_max = g->fourth_max;
	vd zero = vsplat(0), d0 = sign * u->c[1], slope = zero;
	vm sure = active & vless(zero, g1) & (vless(g0, zero) | vless(d0, zero));
	vd d = d0 * limit, c = g1 - (d + g0);
	vd root = vsqrt(vmax(vfma(d, d, -4.0 * c * g0), zero));
	vm up = vless(zero, d0);
	vd t = limit * vmin(vselect(up, -2.0 * g0, root - d) / vselect(up, d + root, 2.0 * c), vsplat(1));
	vm converged = vless(zero, zero);
	for (int round = 0; round < QUICK_ROUNDS && vany(sure & ~converged); round++) {
		struct kinematics at = kinematics_at(u, order, t);
		vd value = sign * (at.u - level), curvature = sign * curvature_at(u, order, t);
		slope = vselect(converged, slope, sign * at.v);
		vd fall = vfma(slope, slope, vsplat(-0.5) * value * curvature);
		vm rises = vless(zero, slope) & vless(zero, fall);
		vd next = vselect(rises, vmin(vmax(t - value * slope / fall, zero), limit), limit);
		vd step = next - t;
		t = vselect(converged, t, next);
		// the error after a step of s is near s (s curvature/slope)^2 + s^2/slope times the error of curvature_at: 1e-4 of the
		// magnitudes of its terms, so near an inflection an error of 1e-13 of the whole step may remain
		vd small = vsplat(0x1p-20);
		converged |= vless(vabs(step), small * t) & vless(vabs(step * curvature), small * slope) & rises;
	}
	*root_time = t;
	// the slope is from before the last step, which changed it by less than 2^-20
	return sure & converged & ~vless(zero, vfma(d0, t * vsplat(1.0 / 3), g0)) &
	       vless(fourth_max * (t * t * t) * vsplat(1.01 / 24), slope);
}

/* Safe root search: first time at which a guard, negative at 0, becomes positive.
 *
 * Given    g       guard, g(0) < 0 in the active lanes
 *          limit   last time of interest
 * Returns  value   lanes with a root; t: that time, or a safe time if the search gave up (`unsure`):
 *                  the guard does not rise there and the parabola permits only steps below rounding
 *
 * A parabola with the guard's value and slope at t and with a bound of its curvature lies above the guard, so no
 * root lies before the parabola's; stepping from root to root converges quadratically to the guard's first root and
 * passes none.
 */
LANE_SHARED vm root_safe(const struct power *g, int order, vm active, vd limit, vd *root_time, vm *unsure)
{
	vd zero = vsplat(0), curved = zero;
	for (int n = order; n > 2; n--)
		curved = vfma(vsplat((double)n * (n - 1)), vabs(g->c[n]), curved);
	vd curvature_max = vmax(zero, vfma(vsplat(2), g->c[2], curved));
	curved = vfma(vsplat(2), vabs(g->c[2]), curved);
	vm going = active, found = vless(zero, zero), given_up = found;
	vd t = vselect(active, zero, *root_time);
	for (int round = 0; round < ROOT_ROUNDS && vany(going); round++) {
		struct kinematics at = kinematics_at(g, order, t);
		vd slope = at.v, below = vmin(at.u, zero);
		vd root = vsqrt(vfma(slope, slope, -2.0 * curvature_max * below));
		vm rises = vless(zero, slope);
		vd step = vselect(rises, -2.0 * below, root - slope) / vselect(rises, slope + root, curvature_max);
		step = vselect(rises | vless(zero, curvature_max), step, vsplat(2));
		vm near = vless(step * step * curved, vsplat(0.5 * DBL_EPSILON) * slope);
		vm stuck = vless(step, vsplat(0.5 * DBL_EPSILON)) & ~near;
		t = vselect(going & ~stuck, t + step, t);
		given_up |= going & stuck;
		going &= ~vless(limit, t) & ~stuck;
		found |= going & near;
		going &= ~near;
	}
	*root_time = t;
	*unsure = given_up | going;
	return found;
}

/* The safe search on any guard; the event is EVENT_CUT if the search gave up at a safe time.
 *
 * A guard that is exactly 0 at the start is divided by its leading power of time: the sign of its first term decides.
 */
LANE_SHARED void search_safe(struct power *guard, int order, vm active, vd event, struct search *search)
{
	vd zero = vsplat(0), large = zero;
	// scaled by a power of two where the squares taken below would underflow
	for (int n = 0; n <= order; n++)
		large = vmax(large, vabs(guard->c[n]));
	vd raise = vselect(vless(large, vsplat(0x1p-400)), vsplat(0x1p600), vsplat(1));
	for (int n = 0; n <= order; n++)
		guard->c[n] = guard->c[n] * raise;
	for (int m = 0; m < DEFLATE_MAX; m++) {
		vm leading = vequal(guard->c[0], zero) & active;
		if (!vany(leading))
			break;
		for (int n = 0; n < order; n++)
			guard->c[n] = vselect(leading, guard->c[n + 1], guard->c[n]);
		guard->c[order] = vselect(leading, zero, guard->c[order]);
	}
	vm found = active & vless(zero, guard->c[0]);
	active &= ~found & ~vequal(guard->c[0], zero);
	vd t = zero;
	vm unsure;
	found |= root_safe(guard, order, active, search->time, &t, &unsure);
	search->time = vselect(found | unsure, t, search->time);
	search->event = vselect(found, event, vselect(unsure, vsplat(EVENT_CUT), search->event));
}

/* The velocity of a motion, times the step. */
static void motion_velocity(struct power *v, const struct motion *m, int order)
{
	if (order == ORDER_HIGH)
		ORDERS_UP(n, ORDER_LOW + 1, ORDER_HIGH, v->c[n - 1] = vsplat(n) * m->u.c[n];)
	ORDERS_UP(n, 1, ORDER_LOW, v->c[n - 1] = vsplat(n) * m->u.c[n];)
	v->c[order] = vsplat(0);
}

/* Searches for the first time at which a guard crosses its level, and records it if it precedes the event found so far.
 *
 * Given    active  lanes to search
 *          event   the event to record
 * Returns  search  time and event, in the lanes with a root before the time already there
 */
LANE_INLINE void search_crossing(struct guard *g, int order, vm active, vd event, struct search *search)
{
	vd one = vsplat(1), t;
	vm shorter = vless(search->time, one) & active;
	if (vany(shorter))
		g->g1 = vselect(shorter, g->sign * (power_at(g->u, order, search->time) - g->level), g->g1);
	vm found = root_quick(g, order, search->time, active, &t);
	search->time = vselect(found, t, search->time);
	search->event = vselect(found, event, search->event);
	active &= ~found;
	if (!vany(active))
		return;
	struct power guard;
	for (int n = 0; n <= order; n++)
		guard.c[n] = g->sign * g->u->c[n];
	guard.c[0] = g->g0;
	search_safe(&guard, order, active, event, search);
}
