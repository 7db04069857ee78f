/* free_motion.inl - whole samples without contact, by precomputed exact maps.
 *
 * Included by exact.inl, once per lane count, and by its test.  A map advances a simulation over one sample; the cubic
 * through both ends, widened by its error bound, proves that no event lies between: no contact, no edge of a law, no new
 * largest displacement.  A lane without this proof stops before the sample; but if only a largest
 * displacement is possible, the sample is passed and noted.
 *
 * Included by exact.inl after simulation.inl. */

#include <float.h>
#include <math.h>

#include "engine/exact/kinematics.h"
#include "engine/exact/tolerances.h"
#include "engine/numeric/lanes.h"

struct lanes {
	POUND_ROWS(vd)
};

/* Largest rate * time of a map over a sample; above REACH_MAP_SHORT the series takes more terms. */
static const double REACH_MAP = 2, REACH_MAP_SHORT = 0.8;

/* terms of order n of psi, the response to an initial velocity of 1, and of its derivative times h; sums over the orders:
 * psi and h psi', the integrals of psi once and twice, and bounds of the fourth derivative of each column of the map */
struct map_series {
	double u, w;
	double psi, rate, once, twice;
	double fourth_u, fourth_v, fourth_a, fourth_d;
};

/* Given    ch, kh  c h and k h^2 */
LANE_INLINE void map_order(struct map_series *s, double ch, double kh, int n)
{
	const double share = 1.0 / (n + 1), four = n * (n - 1.0) * (n - 2.0) * (n - 3.0);
	s->psi += s->u;
	s->rate += s->w;
	s->once = fma(s->u, share, s->once);
	s->twice = fma(s->u, share * (1.0 / (n + 2)), s->twice);
	s->fourth_u = fma(four, fabs(fma(ch, s->u, s->w)), s->fourth_u);
	s->fourth_v = fma(four, fabs(s->u), s->fourth_v);
	s->fourth_a = fma(n * (n - 1.0) * (n - 2.0), fabs(s->u), s->fourth_a);
	s->fourth_d = fma(n * (n - 1.0), fabs(s->u), s->fourth_d);
	const double w = fma(-(ch * share), s->w, -(kh * share) * s->u);
	s->u = s->w * share;
	s->w = w;
}

/* Exact map of u'' + c u' + k u = -(a + d t/h) over one sample h, and error bounds of the cubic through its ends.
 *
 * Given    k, c, h   [1/s2], [1/s], [s]   h (c + k^1/2) <= REACH_MAP
 * Returns  map       columns for u, v, a, d
 *
 * All columns come from the power series of psi, the response to an initial velocity of 1: the response to an initial
 * displacement is psi' + c psi, the responses to constant and growing forcing are its integrals.  By linearity the fourth derivative
 * is at most the sum of the inputs' magnitudes times the fourth derivatives of their columns, which are at most the sums of
 * their terms' magnitudes; 16 rounding errors of the displacement at either end are added.
 */
static void map_fill(struct pound_map *map, double k, double c, double h)
{
	const double ch = c * h, kh = k * h * h, quartic = POUND_CUBIC_ERROR, rounding = 16 * DBL_EPSILON;
	struct map_series s = {.w = h};
	_Pragma("GCC unroll 18") for (int n = 0; n < POUND_MAP_ORDERS; n++) map_order(&s, ch, kh, n);
	if (ch + sqrt(kh) > REACH_MAP_SHORT)
		for (int n = POUND_MAP_ORDERS; n < POUND_MAP_LONGER; n++)
			map_order(&s, ch, kh, n);
	map->uv = s.psi;
	map->uu = s.rate / h + c * s.psi;
	map->ua = -h * s.once;
	map->ud = -h * s.twice;
	map->va = -s.once;
	map->eu = quartic / h * s.fourth_u + 3 * rounding;
	map->ev = quartic * s.fourth_v + 2 * rounding * h;
	map->ef = quartic * h * fmax(s.fourth_a, s.fourth_d) + rounding * h * h;
}

/* a body's motion over a sample or substep: its end, the inner control points of the cubic, and the bound of its error */
struct cubic {
	vd u, v, b1, b2, error;
};

/* One body's map over a whole sample, from displacement, velocity and ground acceleration at both ends; its error bound. */
struct free_map {
	vd uu, uv, u_force, u_ground, u_next;
	vd vu, vv, v_force, v_ground, v_next;
	vd error_u, error_v, error_force, error_ground;
};

/* The map of a body on the branch it is on.
 *
 * With the response psi = uv to an initial velocity, uu = psi' + c psi, and the responses ua and ud to constant and
 * growing forcing have the derivatives -psi and va = ua/h, so that the velocity needs few columns of its own:
 *   u' = uu u + psi v + ua a + ud d     v' = uu v - psi (c v + k u + a) + va d
 * with the forcing a = offset + drive ground, and d = drive (next - ground).
 */
LANE_INLINE struct free_map free_map_of(const struct lanes *g, int i)
{
	vd psi = g->map[i].uv, drive = g->body[i].drive, offset = g->body[i].offset;
	return (struct free_map){.uu = g->map[i].uu,
	                         .uv = psi,
	                         .u_force = g->map[i].ua * offset,
	                         .u_ground = (g->map[i].ua - g->map[i].ud) * drive,
	                         .u_next = g->map[i].ud * drive,
	                         .vu = -psi * g->body[i].stiffness,
	                         .vv = vfma(-psi, g->body[i].damping, g->map[i].uu),
	                         .v_force = -psi * offset,
	                         .v_ground = -(psi + g->map[i].va) * drive,
	                         .v_next = g->map[i].va * drive,
	                         .error_u = g->map[i].eu,
	                         .error_v = g->map[i].ev,
	                         .error_force = g->map[i].ef * vabs(offset),
	                         .error_ground = g->map[i].ef * drive};
}

/* State of a body one whole sample later.
 *
 * Given    f             its map
 *          ground, next  acceleration at both ends [m/s2]
 */
LANE_INLINE struct kinematics free_move(const struct free_map *f, struct kinematics from, vd ground, vd next)
{
	vd u_force = vfma(f->u_ground, ground, vfma(f->u_next, next, f->u_force));
	vd v_force = vfma(f->v_ground, ground, vfma(f->v_next, next, f->v_force));
	return (struct kinematics){.u = vfma(f->uu, from.u, vfma(f->uv, from.v, u_force)),
	                           .v = vfma(f->vv, from.v, vfma(f->vu, from.u, v_force))};
}

/* The motion in between, as a cubic with an error bound.
 *
 * Given    f      the body's map
 *          forcing  bound of |ground| + |next - ground|
 *          third  of the sample
 */
LANE_INLINE struct cubic cubic_of(const struct free_map *f, struct kinematics from, struct kinematics to,
                                  vd forcing, vd third)
{
	vd error = vfma(f->error_ground, forcing, f->error_force);
	return (struct cubic){.u = to.u,
	                      .v = to.v,
	                      .b1 = vfma(third, from.v, from.u),
	                      .b2 = vfma(-third, to.v, to.u),
	                      .error = vfma(f->error_u, vabs(from.u), vfma(f->error_v, vabs(from.v), error))};
}

/* the ends of a body's branch: displacements, and the required sign of the velocity (0: any) */
struct edges {
	vd low, high, direction;
};

/* Bound of |u| inside a sample or substep, its ends excluded. */
LANE_INLINE vd cubic_reach(const struct cubic *f)
{
	return vmax(vabs(f->b1), vabs(f->b2)) + f->error;
}

/* Lanes in which a body may have a new largest displacement.
 *
 * Given    f  its motion;  top: the largest, not below the displacement at the start
 */
LANE_INLINE vm cubic_peaks(const struct cubic *f, vd top)
{
	return vless(vmax(top, vabs(f->u)), cubic_reach(f));
}

/* Lower bound of a body's velocity in one direction over a sample or substep, times a third of it.
 *
 * Given    v    velocity at the start;  f: the free motion from there
 *          way  direction: +1, -1
 *
 * The velocity's control points times h/3 are the velocity at the ends, and b2 - b1 between; they differ from the velocity by
 * at most sqrt(3)/216 h^3 of the fourth derivative, that is 288 sqrt(3)/648 of the error.
 */
LANE_INLINE vd cubic_slowest(vd v, const struct cubic *f, vd third, vd way)
{
	vd ends = vmin(way * (third * v), way * (third * f->v));
	return vmin(ends, way * (f->b2 - f->b1)) - vsplat(0.77) * f->error;
}

/* Lanes in which an edge of a body's branch may be reached.
 *
 * Given    v  velocity at the start;  f: the free motion from there
 */
LANE_INLINE vm cubic_edges(vd v, const struct cubic *f, vd third, const struct edges *x)
{
	vd high = vmax(f->b1, f->b2), low = vmin(f->b1, f->b2), zero = vsplat(0);
	vm risk = vless(x->high, vmax(high, f->u) + f->error);
	risk |= vless(vmin(low, f->u) - f->error, x->low);
	vm reversals = ~vequal(x->direction, zero);
	if (!vany(reversals))
		return risk;
	return risk | (vless(cubic_slowest(v, f, third, x->direction), zero) & reversals);
}

LANE_INLINE struct edges edges_of(const struct lanes *g, int i)
{
	return (struct edges){g->body[i].low, g->body[i].high, g->body[i].direction};
}

/* ROW consecutive samples of free motion, in lanes */
struct stretch {
	vd ground[ROW + 1]; /* ground acceleration at the samples [m/s2] */
	struct kinematics at[2][ROW + 1];
	vd top[2][ROW + 1];    /* largest displacement up to each sample */
	vd bound[2][ROW];      /* of |u| inside a sample */
	unsigned edge[ROW];    /* lanes in which an edge of a branch may be reached inside a sample */
	unsigned meet[ROW];    /* lanes in which the bodies may touch */
	unsigned peak[2][ROW]; /* lanes in which a body may have its largest displacement */
};

/* A stretch with some observed lanes. */
struct observed_stretch {
	const struct stretch *samples;
	const struct lanes *lanes;
	const struct free_map *maps; /* (2) */
	bool paired;
	vd moved; /* samples up to the end or the first event */
};

/* Moves every lane over a sample of a stretch. */
LANE_INLINE void stretch_move(struct stretch *s, const struct free_map maps[2], int r,
                              const struct scope *scope)
{
	for (int i = 0; i < (scope->paired ? 2 : 1); i++)
		s->at[i][r + 1] = free_move(&maps[i], s->at[i][r], s->ground[r], s->ground[r + 1]);
}

/* Finds the lanes in which an event is possible inside a sample. */
LANE_INLINE void stretch_prove(struct stretch *s, const struct lanes *g, const struct free_map maps[2], int r,
                               const struct scope *scope)
{
	const int bodies = scope->paired ? 2 : 1, watched = scope->paired && scope->right ? 2 : 1;
	vd third = g->body[0].step_gap * vsplat(1.0 / 3);
	vd forcing = vabs(s->ground[r]) + vabs(s->ground[r + 1] - s->ground[r]);
	struct cubic f[2];
	vm edge = vmask(0);
	for (int i = 0; i < bodies; i++) {
		f[i] = cubic_of(&maps[i], s->at[i][r], s->at[i][r + 1], forcing, third);
		const struct edges edges = edges_of(g, i);
		if (scope->edged)
			edge |= cubic_edges(s->at[i][r].v, &f[i], third, &edges);
	}
	if (scope->edged)
		s->edge[r] = vbits(edge);
	for (int i = 0; i < watched; i++) {
		s->bound[i][r] = cubic_reach(&f[i]);
		s->top[i][r + 1] = vmax(s->top[i][r], vabs(f[i].u));
		s->peak[i][r] = vbits(vless(s->top[i][r + 1], s->bound[i][r]));
	}
	if (scope->paired) {
		vd gap = vsplat(1 - 4 * DBL_EPSILON) * g->body[1].step_gap;
		vd nearest = vmax(vmax(f[0].b1 - f[1].b1, f[0].b2 - f[1].b2), f[0].u - f[1].u);
		s->meet[r] = vbits(vless(gap, nearest + (f[0].error + f[1].error)));
	}
}

/* Moves every lane over a stretch, and finds possible events on the way: moves do not depend on the proofs.
 *
 * Given    s       ground
 *          g       states at its start;  maps: the bodies' maps
 */
LANE_INLINE void stretch_run(struct stretch *s, const struct lanes *g, const struct free_map maps[2],
                             const struct scope *scope)
{
	for (int i = 0; i < (scope->paired ? 2 : 1); i++) {
		s->at[i][0] = (struct kinematics){g->u[i], g->v[i]};
		s->top[i][0] = g->top[i];
	}
	if (W == 8) {
		// enough registers to do all moves, then all proofs
		for (int r = 0; r < ROW; r++)
			stretch_move(s, maps, r, scope);
		for (int r = 0; r < ROW; r++)
			stretch_prove(s, g, maps, r, scope);
		return;
	}
	// interleaved: a proof fills the latency of the dependent moves
	_Pragma("GCC unroll 1") for (int r = 0; r < ROW; r++)
	{
		stretch_move(s, maps, r, scope);
		stretch_prove(s, g, maps, r, scope);
	}
}

/* Lanes in which the relative displacement may be larger inside a sample of a stretch than at all samples up to
 * its end.
 *
 * Given    most   largest u_1 - u_2 and u_2 - u_1 at the samples up to its start  (2)
 * Returns  reach  ... up to its end  (2)
 */
LANE_INLINE unsigned stretch_exceeds(const struct observed_stretch *o, int r, const vd most[2], vd reach[2])
{
	const struct stretch *s = o->samples;
	vd third = o->lanes->body[0].step_gap * vsplat(1.0 / 3);
	vd forcing = vabs(s->ground[r]) + vabs(s->ground[r + 1] - s->ground[r]);
	const struct cubic left = cubic_of(&o->maps[0], s->at[0][r], s->at[0][r + 1], forcing, third);
	struct cubic right = {vsplat(0), vsplat(0), vsplat(0), vsplat(0), vsplat(0)};
	if (o->paired)
		right = cubic_of(&o->maps[1], s->at[1][r], s->at[1][r + 1], forcing, third);
	vd b1 = left.b1 - right.b1, b2 = left.b2 - right.b2, error = left.error + right.error,
	   p = left.u - right.u;
	reach[0] = vmax(most[0], p);
	reach[1] = vmax(most[1], -p);
	return vbits(vless(reach[0], vmax(b1, b2) + error) | vless(reach[1], error - vmin(b1, b2)));
}

/* Moves some lanes to a sample of a stretch. */
LANE_INLINE void stretch_keep(struct lanes *g, const struct stretch *s, int r, vm which,
                              const struct scope *scope)
{
	for (int i = 0; i < (scope->paired ? 2 : 1); i++) {
		g->u[i] = vselect(which, s->at[i][r].u, g->u[i]);
		g->v[i] = vselect(which, s->at[i][r].v, g->v[i]);
		if (i == 0 || scope->right)
			g->top[i] = vselect(which, s->top[i][r], g->top[i]);
	}
}
