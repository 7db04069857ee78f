/* free_motion.inl - whole samples without contact and whole substeps of contact, by precomputed exact maps.
 *
 * Included by exact.inl, once per lane count, and by its test.  A map takes a simulation over its sample or substep at once; the
 * cubic through both ends, widened by the bound of its error, proves that nothing lies between: no contact, no release, no
 * edge of a law, no new largest displacement.  A lane in which it cannot prove that stays in front of it; but a sample that
 * may hold nothing but a largest displacement is moved over, and noted.
 *
 * Included by exact.inl after simulation.inl. */

#include <float.h>
#include <math.h>

#include "engine/exact/place.h"
#include "engine/exact/tolerances.h"
#include "engine/numeric/lanes.h"

struct lanes {
	POUND_ROWS(vd)
};

/* Largest rate * time of a map over a sample; above the shorter one it takes more terms. */
static const double REACH_MAP = 2, REACH_MAP_SHORT = 0.8;

/* terms of order n of psi, the response to an initial velocity of 1, and of its derivative times h; sums over the orders:
 * psi and h psi', the integrals of psi once and twice, and what bounds the fourth derivative of each column of the map */
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

/* Exact map of u'' + c u' + k u = -(a + d t/h) over one sample h, and what bounds the error of the cubic through its ends.
 *
 * Given    k, c, h   [1/s2], [1/s], [s]   h (c + k^1/2) <= REACH_MAP
 * Returns  map       columns for u, v, a, d
 *
 * All columns come from the power series of psi, the response to an initial velocity of 1: the response to an initial
 * displacement is psi' + c psi, those to constant and growing forcing are its integrals.  By linearity the fourth derivative
 * is at most the sum of the inputs' magnitudes times that of their own columns, and these are at most the sums of their
 * terms' magnitudes; 16 roundings of the displacement at either end are added.
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

/* One body's map over one whole sample, from displacement, velocity and the ground motion at both ends; its error. */
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

/* Where a body is one whole sample later.
 *
 * Given    f             its map
 *          ground, next  acceleration at both ends [m/s2]
 */
LANE_INLINE struct place free_move(const struct free_map *f, struct place from, vd ground, vd next)
{
	vd u_force = vfma(f->u_ground, ground, vfma(f->u_next, next, f->u_force));
	vd v_force = vfma(f->v_ground, ground, vfma(f->v_next, next, f->v_force));
	return (struct place){.u = vfma(f->uu, from.u, vfma(f->uv, from.v, u_force)),
	                      .v = vfma(f->vv, from.v, vfma(f->vu, from.u, v_force))};
}

/* What is known of the way there.
 *
 * Given    f      its map
 *          forcing  bound of |ground| + |next - ground|
 *          third  of the sample
 */
LANE_INLINE struct cubic cubic_of(const struct free_map *f, struct place from, struct place to, vd forcing,
                                  vd third)
{
	vd error = vfma(f->error_ground, forcing, f->error_force);
	return (struct cubic){.u = to.u,
	                      .v = to.v,
	                      .b1 = vfma(third, from.v, from.u),
	                      .b2 = vfma(-third, to.v, to.u),
	                      .error = vfma(f->error_u, vabs(from.u), vfma(f->error_v, vabs(from.v), error))};
}

/* the ends of a body's branch: displacements, and the way in which it must go (0: either) */
struct edges {
	vd low, high, direction;
};

/* How far a body may go inside a sample or substep, apart from its ends. */
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

/* How far a third of a sample or substep takes a body one way at least, by its velocity anywhere inside.
 *
 * Given    v    velocity at the start;  f: the free motion from there
 *          way  +1, -1
 *
 * The velocity's control points times h/3 are its own at the ends, and b2 - b1 between; what they miss the velocity by is
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

/* samples of free motion of lanes, one after the other */
struct stretch {
	vd ground[ROW + 1]; /* acceleration at them [m/s2] */
	struct place at[2][ROW + 1];
	vd top[2][ROW + 1];    /* the largest displacement up to there */
	vd bound[2][ROW];      /* of |u| inside a sample */
	unsigned edge[ROW];    /* lanes in which an edge of a branch may be reached inside a sample */
	unsigned meet[ROW];    /* in which bodies may touch */
	unsigned peak[2][ROW]; /* and those in which a body may have its largest displacement */
};

/* Moves every lane over a sample of a stretch. */
LANE_INLINE void stretch_move(struct stretch *s, const struct free_map maps[2], int r,
                              const struct scope *scope)
{
	for (int i = 0; i < (scope->paired ? 2 : 1); i++)
		s->at[i][r + 1] = free_move(&maps[i], s->at[i][r], s->ground[r], s->ground[r + 1]);
}

/* Asks what may happen on the way. */
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

/* Flies every lane over a stretch, and asks what may have happened on the way: no lane waits for its proof.
 *
 * Given    s       ground
 *          g       where it begins;  maps: the bodies' maps
 */
LANE_INLINE void stretch_run(struct stretch *s, const struct lanes *g, const struct free_map maps[2],
                             const struct scope *scope)
{
	for (int i = 0; i < (scope->paired ? 2 : 1); i++) {
		s->at[i][0] = (struct place){g->u[i], g->v[i]};
		s->top[i][0] = g->top[i];
	}
	if (W == 8) {
		// there are registers for one thing after the other
		for (int r = 0; r < ROW; r++)
			stretch_move(s, maps, r, scope);
		for (int r = 0; r < ROW; r++)
			stretch_prove(s, g, maps, r, scope);
		return;
	}
	// a proof runs while the next move waits for the last
	_Pragma("GCC unroll 1") for (int r = 0; r < ROW; r++)
	{
		stretch_move(s, maps, r, scope);
		stretch_prove(s, g, maps, r, scope);
	}
}

/* Some lanes arrive at a sample of a stretch. */
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

/* ---- contact ---- */

/* how far contact has come: base u, v, overlap p, q; largest displacements of the base and the other body; maps
 * until another is asked for; samples behind the interval */
struct contact_state {
	vd x[4], top[2], impulse, ground, rise, substeps, rounds, left;
};

/* a linear form of the state, the ground motion, its growth over the map, and 1 */
struct linear_form {
	vd x[4], ground, rise, force;
};

/* the base body and the overlap in lanes, and the map of either */
struct contact_lanes {
	struct contact_state at;
	struct edges base, other; /* where a lane has a law of more than one branch */
	struct linear_form moved[CONTACT_IMPULSE + 1];
	struct linear_form error;                           /* of a substep, of the magnitudes */
	vm alike;                                           /* lanes of TRAIT_ALIKE */
	vd doubled[CONTACT_MAP_ROWS][POUND_CONTACT_INPUTS]; /* of a doubled map: its bounds and how it is split */
};

/* The form that a row of a map is of the state and the ground motion.
 *
 * Given    magnitudes  the row is one of these
 */
LANE_INLINE struct linear_form form_of(const vd row[POUND_CONTACT_INPUTS], const struct lanes *g,
                                       bool magnitudes)
{
	vd force[2] = {g->base_force, g->gap_force}, drive[2] = {g->base_drive, g->gap_drive};
	for (int i = 0; i < 2 && magnitudes; i++)
		force[i] = vabs(force[i]), drive[i] = vabs(drive[i]);
	return (struct linear_form){.x = {row[0], row[1], row[2], row[3]},
	                            .ground = vfma(row[4], drive[0], row[5] * drive[1]),
	                            .rise = vfma(row[6], drive[0], row[7] * drive[1]),
	                            .force = vfma(row[4], force[0], row[5] * force[1])};
}

LANE_INLINE vd form_at(const struct linear_form *f, const vd x[4], vd ground, vd rise)
{
	vd slow = vfma(f->ground, ground, vfma(f->rise, rise, f->force));
	return vfma(f->x[0], x[0], vfma(f->x[1], x[1], slow)) + vfma(f->x[2], x[2], f->x[3] * x[3]);
}

/* A row of a map applied to its inputs. */
LANE_INLINE vd contact_row(const vd row[POUND_CONTACT_INPUTS], const vd x[POUND_CONTACT_INPUTS])
{
	vd slow = vfma(row[6], x[6], row[7] * x[7]), force = vfma(row[4], x[4], row[5] * x[5]);
	return vfma(row[0], x[0], vfma(row[1], x[1], slow)) + vfma(row[2], x[2], vfma(row[3], x[3], force));
}

/* The inputs of a map over some substeps: the state, the forcing of base and overlap, and its growth. */
LANE_INLINE void contact_inputs(vd x[POUND_CONTACT_INPUTS], const struct lanes *g,
                                const struct contact_state *at, vd rise)
{
	for (int j = 0; j < 4; j++)
		x[j] = at->x[j];
	x[4] = vfma(g->base_drive, at->ground, g->base_force);
	x[5] = vfma(g->gap_drive, at->ground, g->gap_force);
	x[6] = g->base_drive * rise;
	x[7] = g->gap_drive * rise;
}

/* Where the other body is, which stands off the base by gap and overlap.
 *
 * Given    off  side * gap
 */
LANE_INLINE vd other_body(vd base, vd overlap, vd side, vd off)
{
	return base - vfma(side, overlap, off);
}

/* Moves lanes over some substeps. */
LANE_INLINE void contact_move(const struct lanes *g, struct contact_lanes *s, const vd end[4], vd substeps,
                              vd rise, vm moves)
{
	struct contact_state *at = &s->at;
	at->impulse = vselect(moves, at->impulse + form_at(&s->moved[CONTACT_IMPULSE], at->x, at->ground, rise),
	                      at->impulse);
	at->ground = vselect(moves, at->ground + rise, at->ground);
	at->substeps = vselect(moves, at->substeps - substeps, at->substeps);
	at->top[0] = vselect(moves, vmax(at->top[0], vabs(end[0])), at->top[0]);
	at->top[1] = vselect(moves, vmax(at->top[1], vabs(other_body(end[0], end[2], g->side, g->side * g->gap))),
	                     at->top[1]);
	for (int j = 0; j < 4; j++)
		at->x[j] = vselect(moves, end[j], at->x[j]);
}

/* Lanes whose bodies touch without overlap and stay so, as they go the same way: neither presses the other nor leaves it.
 *
 * Given    p, q  overlap and its rate
 */
LANE_INLINE vm contact_still(const struct contact_lanes *s, vd p, vd q)
{
	return s->alike & vequal(p, vsplat(0)) & vequal(q, vsplat(0));
}

/* An overlap that nothing else presses: it dies away, down to nothing.
 *
 * Given    bound  magnitudes of the state;  error  of both cubics
 * Returns  end    0 where nothing is left;  value  error of the overlap's cubic: there, by its own columns alone
 */
LANE_INLINE vd contact_fades(const struct lanes *g, const struct contact_lanes *s, const vd bound[4],
                             vd error, vd end[4])
{
	vd own = vfma(s->error.x[2], bound[2], s->error.x[3] * bound[3]);
	vm over = s->alike & vless(vmax(vabs(end[2]), vabs(end[3]) * g->substep), vsplat(POUND_AT_REST));
	for (int j = 2; j < 4; j++)
		end[j] = vselect(over, vsplat(0), end[j]);
	return vselect(s->alike, own, error);
}

/* One substep of contact.
 *
 * Given    going   lanes that are to go on
 * Returns  s       those of them in which nothing can happen, at the end of the substep
 *          edge    lanes in which an edge of a branch may be reached
 *          value   those, and others in which something may happen inside it
 */
LANE_INLINE vm contact_substep(const struct lanes *g, struct contact_lanes *s, const struct scope *scope,
                               vm going, vm *edge)
{
	vd zero = vsplat(0), third = g->substep * vsplat(1.0 / 3), end[4], bound[4];
	const vd *x = s->at.x, ground = s->at.ground, rise = s->at.rise;
	const vd *top = s->at.top;
	for (int j = 0; j < 4; j++) {
		bound[j] = vabs(x[j]);
		end[j] = x[j] + form_at(&s->moved[CONTACT_U + j], x, ground, rise);
	}
	vd error = form_at(&s->error, bound, vabs(ground), vabs(rise)), error_overlap = error;
	if (scope->seldom)
		error_overlap = contact_fades(g, s, bound, error, end);
	struct cubic b = {.u = end[0], .v = end[1]}, p = {.u = end[2], .v = end[3]};
	b.b1 = vfma(third, x[1], x[0]);
	b.b2 = vfma(-third, b.v, b.u);
	p.b1 = vfma(third, x[3], x[2]);
	p.b2 = vfma(-third, p.v, p.u);
	vd rounding = vsplat(16 * DBL_EPSILON);
	p.error = vfma(rounding, bound[2] + vabs(p.u), error_overlap);
	b.error = vfma(rounding, bound[0] + vabs(b.u), error);
	vd least = vmin(vmin(p.b1, p.b2), p.u) - p.error;
	vm risk = ~vless(zero, least);
	if (scope->forced) {
		vd force = vfma(g->release / third, cubic_slowest(x[3], &p, third, vsplat(1)), vmin(least, x[2]));
		// a lane whose contact ends with its overlap is not to notice what its neighbours' does
		risk |= ~vless(zero, force) & vless(zero, g->release);
	}
	if (scope->seldom)
		risk &= ~contact_still(s, end[2], end[3]);
	vd side = g->side, off = side * g->gap, v = x[1] - side * x[3];
	struct cubic o = {.u = other_body(b.u, p.u, side, off),
	                  .v = b.v - side * p.v,
	                  .b1 = other_body(b.b1, p.b1, side, off),
	                  .b2 = other_body(b.b2, p.b2, side, off)};
	// the magnitudes it is made of are those of base, overlap and gap
	o.error = vfma(vsplat(2), b.error + p.error, 2.0 * rounding * g->gap);
	*edge = vmask(0);
	if (scope->edged)
		*edge = cubic_edges(x[1], &b, third, &s->base) | cubic_edges(v, &o, third, &s->other);
	if (scope->edged || scope->right) {
		risk |= cubic_peaks(&b, top[0]) | cubic_peaks(&o, top[1]);
	} else {
		vm left = vless(zero, side);
		struct cubic l = {.u = vselect(left, b.u, o.u),
		                  .b1 = vselect(left, b.b1, o.b1),
		                  .b2 = vselect(left, b.b2, o.b2),
		                  .error = vselect(left, b.error, o.error)};
		risk |= cubic_peaks(&l, vselect(left, top[0], top[1]));
	}
	risk |= *edge;
	contact_move(g, s, end, vsplat(1), rise, going & ~risk);
	return risk;
}

/* What the bounds of a doubled map make of the roundings of a body that stands, over where it is: a few dozen.  Less than this is no
 * motion, and none is looked for. */
static const double SUSTAINED_ROUNDING = 64 * DBL_EPSILON;

/* Lanes in which a body's velocity keeps its sign over many substeps, but for times in which it goes back by less than the rounding
 * of where it is: pressed from rest by a load that grows, it stands still once in every swing, and rounding would decide.
 *
 * All rates are times a third of the doubled map.  Where the swing is ahead of the slow motion by a small share of itself it is so for
 * 2 acos(1 - share) of its radians, for a share up to 1 at most pi share^1/2.
 *
 * Given    along   of the slow motion, at least;  swing: of the swing, at most;  error: of both
 *          radian  time of the swing's radian, over a third of the doubled map
 *          where   magnitude of its displacement
 */
LANE_INLINE vm sustained_steady(vd along, vd swing, vd error, vd radian, vd where)
{
	vd zero = vsplat(0), ahead = (swing + error) - along;
	vd back = ahead * vsqrt(ahead / swing) * (vsplat(3.15) * radian);
	return vless(ahead, zero) | (~vless(along, error) & vless(back, vsplat(SUSTAINED_ROUNDING) * where));
}

/* Lanes in which a body may have a new largest displacement over many substeps.
 *
 * Given    u, end     at both ends
 *          low, high  its motion lies between, by the cubic of the slow part of it
 *          steady     lanes of sustained_steady(): nothing lies beyond the ends
 */
LANE_INLINE vm sustained_peaks(vd u, vd end, vd low, vd high, vm steady, vd top)
{
	vd most = vmax(vmax(vabs(u), vabs(end)), top);
	return vless(most, vfma(vsplat(-SUSTAINED_ROUNDING), most, vmax(high, -low))) & ~steady;
}

/* Lanes in which an edge of its branch may be reached.
 *
 * A body that creeps goes less far than the rounding of where it is: no bound of its velocity could show that it goes on, so that
 * none is asked for, and at the end of its branch it may be beyond by as much.  Its velocity at the start still counts: who
 * goes back where a branch only goes on must leave that now, however slowly it goes, or what it goes adds up from doubled map to
 * doubled map.
 *
 * Given    speed  its velocity at the start, or any multiple of it
 */
LANE_INLINE vm sustained_edges(vd end, vd low, vd high, vd speed, vm steady, const struct edges *x)
{
	vd slack = vsplat(SUSTAINED_ROUNDING) * vabs(end), most = x->high + slack, least = x->low - slack;
	vm creeps = ~vless(2.0 * slack, high - low);
	vm inside = vless(most, high) | vless(low, least) | ~vequal(x->direction, vsplat(0));
	return (inside & ~steady & ~creeps) | vless(most, end) | vless(end, least) |
	       vless(x->direction * speed, vsplat(0));
}

/* Many substeps of contact, in which it may swing often, by a doubled map: see doubled_bounds in contact_map.inl.
 *
 * Given    going  lanes that are to go on
 * Returns  s      those of them in which nothing can happen, at their end
 *          edge   lanes in which an edge of a branch may be reached
 *          value  those, and others in which something may happen meanwhile
 */
LANE_INLINE vm sustained_contact(const struct lanes *g, struct contact_lanes *s, const struct scope *scope,
                                 vm going, vm *edge)
{
	const vd *split = s->doubled[CONTACT_SPLIT];
	vd x[POUND_CONTACT_INPUTS], zero = vsplat(0), one = vsplat(1), bound[POUND_CONTACT_INPUTS], end[4],
	                            gone[4];
	vd substeps = split[SPLIT_SUBSTEPS], rise = s->at.rise * substeps,
	   third = g->substep * substeps * vsplat(1.0 / 3);
	contact_inputs(x, g, &s->at, rise);
	for (int j = 0; j < 4; j++)
		gone[j] = form_at(&s->moved[CONTACT_U + j], x, s->at.ground, rise), end[j] = x[j] + gone[j];
	vd w = vfma(-split[SPLIT_BASE], x[2], x[0]), rate = vfma(-split[SPLIT_BASE], x[3], x[1]);
	vd w1 = vfma(-split[SPLIT_BASE], end[2], end[0]), rate1 = vfma(-split[SPLIT_BASE], end[3], end[1]);
	vd closing = vfma(split[SPLIT_DAMPING], rate, vfma(split[SPLIT_STIFFNESS], w, x[5]));
	vd closing1 = vfma(split[SPLIT_DAMPING], rate1, vfma(split[SPLIT_STIFFNESS], w1, x[5] + x[7]));
	bound[0] = vabs(w);
	bound[1] = vabs(rate);
	bound[2] = vabs(closing) + vabs(closing1);
	bound[3] = vabs(vfma(-split[SPLIT_BASE], gone[3], gone[1]));
	for (int j = 4; j < POUND_CONTACT_INPUTS; j++)
		bound[j] = vabs(x[j]);
	const vd omega = split[SPLIT_OMEGA], per_omega = one / omega, yield = per_omega * per_omega;
	const vd change = closing1 - closing, drift = change * (per_omega / (g->substep * substeps));
	vd a = vabs(vfma(omega, x[3], -drift));
	vd c = vabs(vfma(omega * omega, x[2], vfma(split[SPLIT_TWO_ZETA], drift, -closing)));
	// the root of both squares, in their scale, raised by no more than its rounding: a coarser bound would stay above the
	// largest displacement of a contact that swings for ever, and refuse every doubled map
	vd larger = vmax(vmax(a, c), vsplat(DBL_MIN)), lesser = vmin(a, c) / larger;
	vd swung = vsplat(1 + 4 * DBL_EPSILON) * larger * vsqrt(vfma(lesser, lesser, one));
	vd grown = vabs(change) + vabs(drift), curvature, swing;
	// once by all that presses, and then by what of it swings: see doubled_bounds in contact_map.inl
	for (int round = 0; round < 2; round++) {
		curvature = contact_row(s->doubled[DOUBLED_CURVATURE], bound);
		swing = vfma(vsplat(0.5), curvature, swung);
		bound[2] = vmin(bound[2], swing + grown);
	}
	vd phase_lag = vmax(split[SPLIT_TWO_ZETA], split[SPLIT_PHASE_LEAD]) * vabs(drift),
	   beside = vsplat(0.125) * curvature;
	vm risk = ~vless(vfma(split[SPLIT_PHASE_LEAD], swing, phase_lag + beside), vmin(closing, closing1));
	risk &= ~contact_still(s, x[2], x[3]);
	vd still = yield * closing, ripple = yield * (swing + beside);
	vd error = vfma(split[SPLIT_RESIDUAL], ripple, contact_row(s->doubled[DOUBLED_ERROR], bound));
	ripple = vfma(yield, vabs(change) + phase_lag, ripple);
	// the common motion's cubic, and whether a body's velocity keeps its sign
	vd b1 = vfma(third, rate, w), b2 = vfma(-third, rate1, w1);
	vd reach = vfma(vsplat(4 * DBL_EPSILON), bound[0], error);
	vd high = vmax(vmax(b1, b2), vmax(w, w1)) + reach, low = vmin(vmin(b1, b2), vmin(w, w1)) - reach;
	// b2 - b1 by what the doubled map adds: creeping bodies go less far than the rounding of where they are
	vd way0 = third * rate, way1 = third * rate1;
	vd mean = vfma(-split[SPLIT_BASE], gone[2], gone[0]) - (way0 + way1);
	vd creep = yield * change * vsplat(1.0 / 3), scaled_rate = third * swing * per_omega,
	   off = g->side * g->gap;
	const struct edges *const edges[2] = {&s->base, &s->other};
	*edge = vmask(0);
	for (int i = 0; i < 2; i++) {
		vd share = i ? split[SPLIT_BASE] - g->side : split[SPLIT_BASE], size = vabs(share);
		vd u = i ? other_body(x[0], x[2], g->side, off) : x[0];
		vd u1 = i ? other_body(end[0], end[2], g->side, off) : end[0];
		vd mid = i ? vfma(share, still, -off) : share * still;
		// the line that the overlap follows goes along
		vd more = share * creep, speed = way0 + more, way = vselect(vless(speed, zero), -one, one);
		vd along = vmin(vmin(way * speed, way * (way1 + more)), way * (mean + more));
		vm steady = sustained_steady(along, size * scaled_rate, vsplat(1.0265) * error, per_omega / third,
		                             vmax(vabs(u), vabs(u1)));
		vd least = low + mid - size * ripple, most = high + mid + size * ripple;
		risk |= sustained_peaks(u, u1, least, most, steady, s->at.top[i]);
		if (scope->edged)
			*edge |= sustained_edges(u1, least, most, speed, steady, edges[i]);
	}
	risk |= *edge;
	contact_move(g, s, end, substeps, rise, going & ~risk);
	return risk;
}

LANE_INLINE struct edges edges_select(vm mask, struct edges a, struct edges b)
{
	return (struct edges){vselect(mask, a.low, b.low), vselect(mask, a.high, b.high),
	                      vselect(mask, a.direction, b.direction)};
}

/* Sustained contact into lanes, and back. */
LANE_INLINE void contact_load(struct contact_lanes *s, const struct lanes *g, vd rise, vd left_samples,
                              const struct scope *scope)
{
	vm left = vless(vsplat(0), g->side);
	if (scope->edged) {
		s->base = edges_select(left, edges_of(g, 0), edges_of(g, 1));
		s->other = edges_select(left, edges_of(g, 1), edges_of(g, 0));
	}
	s->at = (struct contact_state){
	    .x = {vselect(left, g->u[0], g->u[1]), vselect(left, g->v[0], g->v[1]), g->p, g->q},
	    .top = {vselect(left, g->top[0], g->top[1]), vselect(left, g->top[1], g->top[0])},
	    .impulse = g->impulse,
	    .ground = g->ground,
	    .rise = rise,
	    .substeps = g->substeps,
	    .rounds = g->rounds,
	    .left = left_samples};
}

LANE_INLINE void contact_store(const struct contact_state *at, struct lanes *g)
{
	vm left = vless(vsplat(0), g->side);
	const vd *x = at->x;
	vd u = other_body(x[0], x[2], g->side, g->side * g->gap), v = x[1] - g->side * x[3];
	g->u[0] = vselect(left, x[0], u);
	g->v[0] = vselect(left, x[1], v);
	g->u[1] = vselect(left, u, x[0]);
	g->v[1] = vselect(left, v, x[1]);
	g->top[0] = vselect(left, at->top[0], at->top[1]);
	g->top[1] = vselect(left, at->top[1], at->top[0]);
	g->p = x[2];
	g->q = x[3];
	g->impulse = at->impulse;
	g->ground = at->ground;
	g->substeps = at->substeps;
	g->rounds = at->rounds;
}
