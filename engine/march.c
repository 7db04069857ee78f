/* march.c - the exact event-driven march, many simulations side by side in lanes.
 *
 * Between events a pair of oscillators is linear and the ground motion a straight line, so:
 * 1. free flight takes whole samples by a precomputed exact map; Bernstein bounds of the cubic through the ends,
 *    widened by the bound of its error, prove that no contact, no edge of a law and no new maximum lies inside;
 * 2. what they cannot prove, and every contact, is done by power series in time, cut at the first root of a guard
 *    (contact opens or closes, an edge of a piece is reached, the velocity turns), found to rounding;
 * 3. simulations change between the two groups of lanes as they fly and touch; lanes are refilled from a pool.
 * A simulation's bits depend on itself alone: not on its lane, its neighbours or the lane count. */
#include "engine/march.h"

#include <assert.h>
#include <float.h>
#include <stdalign.h>
#include <string.h>

#include "engine/lanes.h"
#include "engine/series.h"
#include "engine/simulation.h"

enum {
	POOL = 3 * W,           /* simulations in flight */
	EVENTS_LIMIT = 1 << 17, /* in one sample interval: more is chatter */
};

/* A step that a search was unsure of is followed by one this much shorter, and then by longer ones again: what decides
 * may be far below the rounding of a whole step. */
static const double SHORTER = 0x1p-8, SHORTEST = 0x1p-400, LONGER = 0x1p4;

struct lanes {
	COLUMNS(vd)
};

#include "engine/energy.h" // reads struct lanes

/* simulations side by side; a lane without one has member -1 and goes through the motions */
struct group {
	struct lanes x;
	int member[W];
	vi next, last; /* as in struct simulation */
	const double *ground[W];
	int n, n_edged, n_paired,
	    n_accounted; /* lanes in use, and how many of them have edges, have two bodies */
};

struct queue {
	int n;
	int member[POOL];
};

struct work {
	alignas(64) struct group fly;
	alignas(64) struct group meet;
	struct simulation pool[POOL];
	struct queue idle, flyers, meeters;
	const struct pound_march_task *tasks;
	struct pound_march_result *results;
	int n, started;
};

static_assert(sizeof(struct lanes) == W * sizeof(struct column), "columns are doubles and nothing else");

/* ---- groups of lanes ---- */

static void push(struct queue *queue, int member)
{
	queue->member[queue->n++] = member;
}

static int pop(struct queue *queue)
{
	return queue->member[--queue->n];
}

/* Puts a simulation into lane l of a group: columns [from, to). */
LANE_INLINE void lane_load(struct group *group, int l, struct work *work, int member, int from, int to)
{
	const double *x = (const double *)&work->pool[member].x;
	vd *g = (vd *)&group->x;
	// whole vectors are written: a load after a store of one lane would have to wait for it
	vi only = vonly(l);
	for (int j = from; j < to; j++)
		g[j] = vselect(only, vsplat(x[j]), g[j]);
	group->member[l] = member;
	group->next = (group->next & ~only) | (only & work->pool[member].next);
	group->last = (group->last & ~only) | (only & work->pool[member].last);
	group->ground[l] = work->pool[member].task->ground;
	group->n++;
	group->n_edged += work->pool[member].edged;
	group->n_paired += work->pool[member].paired;
	group->n_accounted += work->pool[member].accounted;
}

/* Takes the simulation out of lane l: columns [from, to) were changed. */
LANE_INLINE struct simulation *lane_save(struct group *group, int l, struct work *work, int from, int to)
{
	struct simulation *sim = &work->pool[group->member[l]];
	double *x = (double *)&sim->x;
	const double *g = (const double *)&group->x + l;
	for (int j = from; j < to; j++)
		x[j] = g[j * W];
	sim->next = LANE(group->next, l);
	group->member[l] = -1;
	group->n--;
	group->n_edged -= sim->edged;
	group->n_paired -= sim->paired;
	group->n_accounted -= sim->accounted;
	return sim;
}

/* Leaves lane l of a group with numbers that an event step can go through without harm. */
static void lane_rest(struct group *group, int l)
{
	static const double still[2];
	struct lanes *g = &group->x;
	LANE(g->step, l) = LANE(g->left, l) = LANE(g->reach[0], l) = LANE(g->reach[1], l) = LANE(g->pace, l) = 1;
	LANE(g->touching, l) = LANE(g->parted, l) = LANE(g->events, l) = 0;
	LANE(group->next, l) = LANE(group->last, l) = 1;
	group->ground[l] = still;
}

/* Lanes of a group that are in use. */
LANE_INLINE vi members(const struct group *group)
{
	vi used = {0};
	for (int l = 0; l < W; l++)
		LANE(used, l) = -(int64_t)(group->member[l] >= 0);
	return used;
}

/* Writes a simulation's result and frees its place in the pool. */
static void simulation_end(struct work *work, struct simulation *sim, enum pound_status status)
{
	struct pound_march_result *r = sim->result;
	const struct column *x = &sim->x;
	// a contact still open at the end counts with what it has
	r->status = status;
	r->contacts = (int64_t)(x->contacts + x->touching);
	r->impulse_max = fmax(x->impulse_max, x->touching != 0 ? x->impulse : 0);
	r->contact_time = x->contact_time;
	r->energy_residual = sim->accounted ? pound_simulation_residual(sim) : NAN;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		r->displacement_max[i] = sim->task->bodies[i].followed ? x->top[i] : NAN;
		r->u[i] = x->u[i];
		r->v[i] = x->v[i];
	}
	push(&work->idle, (int)(sim - work->pool));
}

/* Sends a simulation that is apart to the group of event steps. */
static void meet_await(struct work *work, struct simulation *sim)
{
	struct column *x = &sim->x;
	pound_simulation_interval(sim);
	double p = x->u[0] - x->u[1] - x->gap;
	x->p = p < 0 ? p : 0; // rounding must not make it overlap
	x->q = x->v[0] - x->v[1];
	push(&work->meeters, (int)(sim - work->pool));
}

/* Takes the next task into an idle place of the pool; false: none left. */
static bool task_start(struct work *work)
{
	if (work->started == work->n || work->idle.n == 0)
		return false;
	struct simulation *sim = &work->pool[pop(&work->idle)];
	pound_simulation_start(sim, &work->tasks[work->started], &work->results[work->started]);
	work->started++;
	if (sim->x.can_fly != 0)
		push(&work->flyers, (int)(sim - work->pool));
	else
		meet_await(work, sim);
	return true;
}

/* ---- free flight ---- */

/* Fills the empty lanes of free flight. */
static void fly_fill(struct work *work)
{
	for (int l = 0; l < W && work->fly.n < W; l++) {
		while (work->fly.member[l] < 0 && work->flyers.n == 0 && task_start(work))
			;
		if (work->fly.member[l] < 0 && work->flyers.n > 0)
			lane_load(&work->fly, l, work, pop(&work->flyers), COLUMN_STATE, COLUMN_END);
	}
}

struct flight {
	vd u, v, b1, b2, error;
};

/* One body over one whole sample, and the inner control points of the cubic through its ends.
 *
 * With the response psi = uv to an initial velocity, uu = psi' + c psi, and the responses ua and ud to constant and
 * growing forcing have the derivatives -psi and ua/h, so that the velocity needs no columns of its own:
 *   u' = uu u + psi v + ua a + ud d     v' = (uu - c psi) v - psi (k u + a) + ua d/h
 */
LANE_INLINE struct flight flight_step(const struct lanes *g, int i, vd rise)
{
	struct flight f;
	vd u = g->u[i], v = g->v[i], c = g->damping[i], psi = g->uv[i];
	vd a = vfma(g->drive[i], g->ground, g->offset[i]), d = g->drive[i] * rise, s = d * g->per_step;
	vd spring = vfma(g->stiffness[i], u, a);
	f.u = vfma(g->uu[i], u, vfma(psi, v, vfma(g->ua[i], a, g->ud[i] * d)));
	f.v = vfma(vfma(-c, psi, g->uu[i]), v, vfma(-psi, spring, g->ua[i] * s));
	f.b1 = vfma(g->third, v, u);
	f.b2 = vfma(-g->third, f.v, f.u);
	// |u''| and |u'''| at the start, for the bound of the cubic's error
	vd speed = vabs(v), acc = vfma(c, speed, vfma(g->stiffness[i], vabs(u), vabs(a)));
	vd jerk = vfma(c, acc, vfma(g->stiffness[i], speed, vabs(s)));
	vd error = vfma(g->ea[i], acc, g->ej[i] * jerk);
	f.error = vfma(vsplat(16 * DBL_EPSILON), vabs(u) + vabs(f.u), error);
	return f;
}

/* Lanes in which something may happen to a body inside the sample: a new largest displacement, an edge of its piece. */
LANE_INLINE vi flight_risk(const struct lanes *g, int i, const struct flight *f, bool edged)
{
	vd high = vmax(f->b1, f->b2), low = vmin(f->b1, f->b2);
	vd ends = vmax(vmax(vabs(g->u[i]), vabs(f->u)), g->top[i]);
	vi risk = vless(ends, vmax(high, -low) + f->error);
	if (!edged)
		return risk;
	risk |= vless(g->high[i], vmax(high, f->u) + f->error);
	risk |= vless(vmin(low, f->u) - f->error, g->low[i]);
	// the velocity's control points times h/3: its own at the ends, b2 - b1 between; it misses the velocity by at
	// most sqrt(3)/216 h^3 of the fourth derivative, which is 384 sqrt(3)/648 of the displacement's error
	vd way = g->direction[i];
	vd along = vmin(vmin(way * (g->third * g->v[i]), way * (g->third * f->v)), way * (f->b2 - f->b1));
	risk |= vless(along, vsplat(1.0265) * f->error) & ~vequal(way, vsplat(0));
	return risk;
}

/* One sample for every lane of free flight.
 *
 * Given    ground  acceleration at the next sample [m/s2]
 *          edged   a lane has a law of more than one piece;  paired: a lane has two bodies
 * Returns  value   lanes in which something may happen inside the sample; these stay where they were
 */
LANE_INLINE vi flight(struct lanes *g, vd ground, bool edged, bool paired)
{
	vd rise = ground - g->ground;
	struct flight f = flight_step(g, 0, rise);
	vi risk = flight_risk(g, 0, &f, edged);
	if (paired) {
		struct flight s = flight_step(g, 1, rise);
		vd p = vmax(vmax(f.b1 - s.b1, f.b2 - s.b2), f.u - s.u) - g->gap;
		risk |= flight_risk(g, 1, &s, edged);
		risk |= vless(vsplat(0), p + (f.error + s.error) + vsplat(4 * DBL_EPSILON) * g->gap);
		g->u[1] = vselect(risk, g->u[1], s.u);
		g->v[1] = vselect(risk, g->v[1], s.v);
		g->top[1] = vmax(g->top[1], vabs(g->u[1]));
	}
	g->u[0] = vselect(risk, g->u[0], f.u);
	g->v[0] = vselect(risk, g->v[0], f.v);
	g->top[0] = vmax(g->top[0], vabs(g->u[0]));
	g->ground = vselect(risk, g->ground, ground);
	return risk;
}

/* Ground acceleration of each lane at its sample `next`. */
LANE_INLINE vd ground_at(const struct group *g, vi next)
{
	int64_t sample[W];
	vd a = {0};
	memcpy(sample, &next, sizeof sample);
	for (int l = 0; l < W; l++)
		LANE(a, l) = g->ground[l][sample[l]];
	return a;
}

/* Flies one sample a round, until a lane cannot be flown or was flown to its end; these lanes come back. */
LANE_INLINE vi fly_on(struct group *g, bool edged, bool paired)
{
	vi flying = members(g), next = g->next, leaves;
	do {
		vi stays = flight(&g->x, ground_at(g, next), edged, paired);
		leaves = (stays | vequal_index(next, g->last)) & flying;
		next += ~stays & flying & 1;
	} while (!vany(leaves));
	g->next = next;
	return leaves;
}

/* Flies until the group of the others is worth a step, or nobody flies. */
static void fly(struct work *work)
{
	struct group *g = &work->fly;
	while (work->meet.n + work->meeters.n < W) {
		fly_fill(work);
		if (g->n == 0)
			return;
		vi leaves = g->n_paired ? (g->n_edged ? fly_on(g, true, true) : fly_on(g, false, true))
		                        : (g->n_edged ? fly_on(g, true, false) : fly_on(g, false, false));
		for (int l = 0; l < W; l++) {
			if (!LANE(leaves, l))
				continue;
			struct simulation *sim = lane_save(g, l, work, COLUMN_STATE, COLUMN_READ);
			lane_rest(g, l);
			if (sim->next > sim->last)
				simulation_end(work, sim, POUND_OK);
			else
				meet_await(work, sim);
		}
	}
}

/* ---- events, by power series ---- */

enum event { NOTHING, CUT, CONTACT, CLEARS, BODY };

// the event of an edge of body i is BODY + EDGES i + edge
enum { EDGES = 3 };

/* What the recurrences of a step read: each body's damping and stiffness, the contact's, all scaled to the step. */
struct rates {
	vd c[2], k[2], spring, dash, mass_ratio, both;
};

/* coefficients of one order of left, right and overlap, and the sums over the orders so far */
struct terms {
	vd u[3], v[3], u1[3], v1[3], bend[3];
};

/* One order of the series of both bodies and of the overlap: keeps coefficient n, adds it to the ends and to the bounds
 * of the fourth derivatives, and makes coefficient n + 1.
 *
 * Given    force  part of this order of the ground motion and the pieces, orders 0 and 1 only
 */
LANE_INLINE void series_order(struct series *s, const struct rates *r, int n, vd force_1, vd force_2,
                              struct terms *x)
{
	struct motion *into[3] = {&s->body[0], &s->body[1], &s->overlap};
	vd share = vsplat(1.0 / (n + 1)), u[3], v[3];
#pragma GCC unroll 3
	for (int j = 0; j < 3; j++) {
		u[j] = x->u[j], v[j] = x->v[j];
		into[j]->u.c[n] = u[j];
		into[j]->v.c[n] = v[j];
		x->u1[j] = x->u1[j] + u[j];
		x->v1[j] = x->v1[j] + v[j];
		if (n >= 4)
			x->bend[j] = vfma(vsplat(fourth(n)), vabs(u[j]), x->bend[j]);
		x->u[j] = v[j] * share;
	}
	vd b0 = vfma(r->c[0] * share, v[0], (r->k[0] * share) * u[0]);
	vd b1 = vfma(r->c[1] * share, v[1], (r->k[1] * share) * u[1]);
	if (n < 2) {
		b0 = vfma(force_1, share, b0);
		b1 = vfma(force_2, share, b1);
	}
	vd push = vfma(r->spring * share, u[2], (r->dash * share) * v[2]);
	x->v[0] = b0 - push;
	x->v[1] = vfma(r->mass_ratio, push, b1);
	x->v[2] = vfma(r->both, -push, b0 - b1);
}

/* Series of both bodies and of the overlap over a step, their ends and the bounds of their fourth derivatives. */
static void series_fill(struct series *s, const struct lanes *g, vd dt, vi touching)
{
	vd dt2 = dt * dt, zero = vsplat(0);
	struct rates r;
	vd f0[2], f1[2];
	for (int i = 0; i < 2; i++) {
		r.c[i] = -g->damping[i] * dt;
		r.k[i] = -g->stiffness[i] * dt2;
		f0[i] = -vfma(g->drive[i], g->ground, g->offset[i]) * dt2;
		f1[i] = -(g->drive[i] * g->slope) * dt2 * dt;
	}
	r.spring = vselect(touching, g->contact_stiffness * dt2, zero);
	r.dash = vselect(touching, g->contact_damping * dt, zero);
	r.mass_ratio = g->mass_ratio;
	r.both = vsplat(1) + g->mass_ratio;
	struct terms x = {.u = {g->u[0], g->u[1], g->p}, .v = {g->v[0] * dt, g->v[1] * dt, g->q * dt}};
	for (int j = 0; j < 3; j++)
		x.u1[j] = x.v1[j] = x.bend[j] = zero;
	s->order = vany(touching) ? ORDER_TOUCH : ORDER_FREE;
	series_order(s, &r, 0, f0[0], f0[1], &x);
	series_order(s, &r, 1, f1[0], f1[1], &x);
	ORDERS_UP(n, 2, ORDER_FREE, series_order(s, &r, n, zero, zero, &x);)
	if (s->order > ORDER_FREE) {
		// lanes apart end here, so that a lane's bits do not depend on its neighbours
		for (int j = 0; j < 3; j++) {
			x.u[j] = vselect(touching, x.u[j], zero);
			x.v[j] = vselect(touching, x.v[j], zero);
		}
		ORDERS_UP(n, ORDER_FREE + 1, ORDER_TOUCH, series_order(s, &r, n, zero, zero, &x);)
	}
	struct motion *into[3] = {&s->body[0], &s->body[1], &s->overlap};
	for (int j = 0; j < 3; j++) {
		into[j]->u1 = x.u1[j];
		into[j]->v1 = x.v1[j];
		into[j]->bend = x.bend[j];
		into[j]->u.c[s->order + 1] = into[j]->v.c[s->order + 1] = zero;
	}
}

/* Looks for the edges of a body's piece. */
static void body_search(const struct series *s, struct lanes *g, int i, vi active, struct search *search)
{
	vd zero = vsplat(0), one = vsplat(1), body = vsplat(BODY + EDGES * i);
	const struct motion *m = &s->body[i];
	vi past_high = may_cross(m, g->high[i], one) & active;
	vi past_low = may_cross(m, g->low[i], -one) & active;
	vi turns = ~vequal(g->direction[i], zero) & active;
	if (vany(past_high))
		search_crossing(m, s->order, g->high[i], one, past_high, body + vsplat(POUND_EDGE_HIGH), CUT, search);
	if (vany(past_low))
		search_crossing(m, s->order, g->low[i], -one, past_low, body + vsplat(POUND_EDGE_LOW), CUT, search);
	if (vany(turns)) {
		struct motion velocity;
		motion_velocity(&velocity, m, s->order);
		turns &= may_cross(&velocity, zero, -g->direction[i]);
		search_crossing(&velocity, s->order, zero, -g->direction[i], turns, body + vsplat(POUND_EDGE_TURN),
		                CUT, search);
	}
}

/* Follows the largest displacement of a body inside the step, before what the search found.
 *
 * Where the velocity turns once, the displacement there is kept: an error of the turning time enters squared.  Where
 * it may turn more often, the step is cut at the first turn.
 */
static void body_top(const struct series *s, struct lanes *g, int i, vi active, struct search *search)
{
	const struct motion *m = &s->body[i];
	vi inside = vless(vmax(g->top[i], vabs(m->u1)), reach_of(m)) & active;
	if (!vany(inside))
		return;
	struct motion velocity;
	motion_velocity(&velocity, m, s->order);
	const vd *v = m->v.c;
	vd zero = vsplat(0), one = vsplat(1), t;
	// which way it goes now: by its velocity, or from rest by its acceleration, or by the rate of that
	vd way = vselect(vequal(v[0], zero), vselect(vequal(v[1], zero), v[2], v[1]), v[0]);
	vd sign = vselect(vless(way, zero), one, -one);
	vi once = root_quick(&velocity.u, &velocity.v, s->order, zero, sign, sign * v[0], sign * m->v1, one,
	                     velocity.bend, inside, &t);
	vd turn = vabs(power_at(&m->u, s->order, t));
	g->top[i] = vselect(once & vless(t, search->time), vmax(g->top[i], turn), g->top[i]);
	inside &= ~once;
	if (!vany(inside))
		return;
	struct power guard;
	for (int n = 0; n <= s->order; n++)
		guard.c[n] = sign * v[n];
	search_safe(&guard, s->order, inside, vsplat(BODY + EDGES * i + POUND_EDGE_TURN), CUT, search);
}

/* Looks for the beginning and the end of a contact.
 *
 * Apart, contact begins when the overlap p rises through 0.  Touching, it ends when p falls through 0, or where the
 * dashpot must not pull, when the force does: p + C/K p' = 0 with p > 0 still.  The bodies are then parted: the contact
 * goes on when that force rises again, and they are apart when p has fallen to 0.
 */
static void contact_search(const struct series *s, const struct lanes *g, vd dt, vi active,
                           struct search *search)
{
	const struct motion *p = &s->overlap;
	vd zero = vsplat(0), one = vsplat(1);
	vi touching = vless(zero, g->touching), parted = vless(zero, g->parted) & active;
	vi by_force = (touching | parted) & ~vequal(g->release, zero) & active;
	vd sign = vselect(touching, -one, one);
	vi risk = may_cross(p, zero, sign) & active & ~by_force;
	if (vany(risk))
		search_crossing(p, s->order, zero, sign, risk, vsplat(CONTACT), CUT, search);
	struct power guard;
	if (vany(by_force)) {
		vd lead = g->release / dt;
		for (int n = 0; n <= s->order; n++)
			guard.c[n] = sign * vfma(lead, p->v.c[n], p->u.c[n]);
		// where the force has just passed 0 it is beyond by the rounding of the overlap and of its acceleration, or
		// bodies that are alike would turn to and fro at one instant for ever
		vd pull = vabs(s->body[0].v.c[1]) + vabs(s->body[1].v.c[1]);
		vd below = vmin(guard.c[0], -DBL_EPSILON * vfma(lead, pull, p->u.c[0]));
		guard.c[0] = vselect(vless(zero, g->fresh), below, guard.c[0]);
		search_safe(&guard, s->order, by_force, vsplat(CONTACT), CUT, search);
	}
	if (vany(parted)) {
		for (int n = 0; n <= s->order; n++)
			guard.c[n] = -p->u.c[n];
		search_safe(&guard, s->order, parted, vsplat(CLEARS), CUT, search);
	}
}

/* ---- through an event ---- */

/* Contact begins, ends, or clears the overlap it left. */
static void contact_turn(struct lanes *g, vd event)
{
	vd zero = vsplat(0), one = vsplat(1);
	vi contact = vequal(event, vsplat(CONTACT)), clears = vequal(event, vsplat(CLEARS));
	vi touching = vless(zero, g->touching), parted = vless(zero, g->parted);
	vi ends = contact & touching;
	vi begins = contact & ~touching;
	vi parts = ends & vless(zero, g->release) & vless(zero, g->p);
	vi sharp = (begins & ~parted) | (ends & ~parts) | clears; // at no overlap, from here exactly
	g->impulse_max = vselect(ends, vmax(g->impulse_max, g->impulse), g->impulse_max);
	g->impulse = vselect(begins, zero, g->impulse);
	g->contacts = vselect(ends, g->contacts + one, g->contacts);
	g->p = vselect(sharp, zero, g->p);
	g->fresh = vselect((begins & parted) | parts, one, zero);
	g->touching = vselect(begins, one, vselect(ends, zero, g->touching));
	g->parted = vselect(parts, one, vselect(begins | clears, zero, g->parted));
}

/* Notes where and how fast the first contact began. */
static void first_contact(struct work *work, int l)
{
	struct lanes *g = &work->meet.x;
	const struct simulation *sim = &work->pool[work->meet.member[l]];
	if (LANE(g->contacts, l) > 0 || LANE(g->touching, l) == 0 || sim->result->first_speed != 0)
		return;
	sim->result->first_contact = (double)LANE(work->meet.next, l) * sim->x.step - LANE(g->left, l);
	sim->result->first_speed = LANE(g->q, l);
}

/* A body's law goes on to its next piece; from here the edge is exact. */
static void body_turn(struct work *work, int l, int i, enum pound_edge edge)
{
	struct lanes *g = &work->meet.x;
	struct simulation *sim = &work->pool[work->meet.member[l]];
	if (edge == POUND_EDGE_TURN)
		LANE(g->v[i], l) = 0;
	else
		LANE(g->u[i], l) = edge == POUND_EDGE_HIGH ? LANE(g->high[i], l) : LANE(g->low[i], l);
	if (edge == POUND_EDGE_TURN && LANE(g->direction[i], l) == 0)
		return; // a turn that was only looked for as a largest displacement
	pound_pieces_leave(&sim->task->bodies[i].skeleton, &sim->at[i], edge, LANE(g->u[i], l));
	pound_simulation_piece(sim, i);
	LANE(g->stiffness[i], l) = sim->x.stiffness[i];
	LANE(g->offset[i], l) = sim->x.offset[i];
	LANE(g->low[i], l) = sim->x.low[i];
	LANE(g->high[i], l) = sim->x.high[i];
	LANE(g->direction[i], l) = sim->x.direction[i];
}

/* Lanes at a sample enter the next interval; what comes back is the lanes that leave the group. */
static vi interval_turn(struct group *group, vi sampled)
{
	struct lanes *g = &group->x;
	group->next -= sampled;
	vi ends = vless_index(group->last, group->next);
	vd a0 = ground_at(group, group->next - 1), a1 = ground_at(group, group->next + ends);
	vd zero = vsplat(0);
	g->ground = vselect(sampled, a0, g->ground);
	g->slope = vselect(sampled, (a1 - a0) / g->step, g->slope);
	g->left = vselect(sampled, g->step, g->left);
	g->events = vselect(sampled, zero, g->events + vsplat(1));
	// apart, and not about to touch inside the next interval
	vi flies = vless(zero, g->can_fly) & vequal(g->touching + g->parted, zero) &
	           vless(vfma(g->step, g->q, g->p), zero);
	return (sampled & (ends | flies)) | vless(vsplat(EVENTS_LIMIT), g->events);
}

static void meet_leave(struct work *work, int l)
{
	struct group *group = &work->meet;
	bool chatter = LANE(group->x.events, l) > EVENTS_LIMIT;
	struct simulation *sim = lane_save(group, l, work, COLUMN_MOVED, COLUMN_READ);
	lane_rest(group, l);
	if (chatter || sim->next > sim->last)
		simulation_end(work, sim, chatter ? POUND_CHATTER : POUND_OK);
	else
		push(&work->flyers, (int)(sim - work->pool));
}

/* Moves the ends of a step to its events. */
static void series_cut(struct series *s, vi event, vd time)
{
	struct motion *m[3] = {&s->body[0], &s->body[1], &s->overlap};
	for (int j = 0; j < 3; j++) {
		m[j]->u1 = vselect(event, power_at(&m[j]->u, s->order, time), m[j]->u1);
		m[j]->v1 = vselect(event, power_at(&m[j]->v, s->order, time), m[j]->v1);
	}
}

/* Adds the integral of the contact force over the step, per mass of the left body, and its time. */
static void impulse_add(struct lanes *g, const struct series *s, vi touching, vd time, vd dt)
{
	struct power area; // of the overlap from 0 to t, over t
	area.c[s->order + 1] = vsplat(0);
	if (s->order > ORDER_FREE)
		ORDERS_UP(n, ORDER_FREE + 1, ORDER_TOUCH, area.c[n] = s->overlap.u.c[n] * vsplat(1.0 / (n + 1));)
	ORDERS_UP(n, 0, ORDER_FREE, area.c[n] = s->overlap.u.c[n] * vsplat(1.0 / (n + 1));)
	vd elapsed = time * dt;
	vd impulse = vfma(g->contact_stiffness, power_at(&area, s->order, time) * elapsed,
	                  g->contact_damping * (s->overlap.u1 - s->overlap.u.c[0]));
	g->impulse = vselect(touching, g->impulse + impulse, g->impulse);
	g->contact_time = vselect(touching, g->contact_time + elapsed, g->contact_time);
}

/* One event step: every lane goes on to its next event, its next sample, or as far as its series reaches. */
static void meet_step(struct work *work)
{
	struct group *group = &work->meet;
	struct lanes *g = &group->x;
	vd one = vsplat(1), zero = vsplat(0);
	vi active = members(group);
	vi touching = vless(zero, g->touching);
	vd reach = vselect(touching, g->reach[1], g->reach[0]) * g->pace;
	vd steps = g->left / reach;
	vi whole = ~vless(one, steps) & active;
	vd dt = vselect(whole, g->left, vselect(vless(vsplat(2), steps), reach, 0.5 * g->left));

	struct series s;
	series_fill(&s, g, dt, touching);
	struct search search = {.time = one, .event = zero};
	int bodies = group->n_paired ? 2 : 1;
	if (group->n_paired)
		contact_search(&s, g, dt, active, &search);
	for (int i = 0; i < bodies && group->n_edged; i++)
		body_search(&s, g, i, active, &search);
	for (int i = 0; i < bodies; i++)
		body_top(&s, g, i, active, &search);
	vi event = ~vequal(search.event, zero);
	g->pace = vselect(vequal(search.event, vsplat(CUT)), vmax(g->pace * SHORTER, vsplat(SHORTEST)),
	                  vmin(g->pace * LONGER, one));
	if (vany(event))
		series_cut(&s, event, search.time);
	if (group->n_accounted) {
		const vd mass[2] = {one, g->right_mass};
		energy_add(g, &s, dt, search.time, touching, mass);
	}
	if (vany(touching))
		impulse_add(g, &s, touching, search.time, dt);
	for (int i = 0; i < 2; i++) {
		g->u[i] = s.body[i].u1;
		g->v[i] = s.body[i].v1 / dt;
		g->top[i] = vmax(g->top[i], vabs(g->u[i]));
	}
	g->p = s.overlap.u1;
	g->q = s.overlap.v1 / dt;
	g->left = vfma(-search.time, dt, g->left);
	g->ground = vfma(g->slope, search.time * dt, g->ground);
	contact_turn(g, search.event);
	for (int l = 0; l < W && vany(event); l++) {
		int turn = (int)LANE(search.event, l) - BODY;
		if (turn >= 0)
			body_turn(work, l, turn / EDGES, (enum pound_edge)(turn % EDGES));
		else if (turn == CONTACT - BODY)
			first_contact(work, l);
	}
	vi leaves = interval_turn(group, whole & ~event) & active;
	for (int l = 0; l < W && vany(leaves); l++)
		if (LANE(leaves, l))
			meet_leave(work, l);
}

/* ---- the march ---- */

static_assert(sizeof(struct work) <= POUND_MARCH_SCRATCH, "the work space is too small");

/* Runs every task to its end.
 *
 * Given    tasks    (n)
 *          scratch  POUND_MARCH_SCRATCH bytes, 64-byte aligned
 * Returns  results  (n); status POUND_CHATTER where a task ended early
 *
 * Source   model.md 1
 * Test     unit_march, unit_response
 */
void POUND_MARCH(const struct pound_march_task *tasks, struct pound_march_result *results, int n,
                 void *scratch)
{
	struct work *work = scratch;
	memset(work, 0, sizeof *work);
	work->tasks = tasks;
	work->results = results;
	work->n = n;
	for (int j = 0; j < POOL; j++)
		push(&work->idle, j);
	for (int l = 0; l < W; l++) {
		work->fly.member[l] = work->meet.member[l] = -1;
		lane_rest(&work->fly, l);
		lane_rest(&work->meet, l);
	}
	for (;;) {
		fly(work);
		for (int l = 0; l < W && work->meeters.n > 0; l++)
			if (work->meet.member[l] < 0)
				lane_load(&work->meet, l, work, pop(&work->meeters), COLUMN_FIRST, COLUMN_MAP);
		if (work->meet.n == 0)
			return;
		meet_step(work);
	}
}
