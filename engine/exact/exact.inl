/* exact.inl - the exact event-driven march, many simulations side by side in lanes.
 *
 * Between events a pair of oscillators is linear and the ground motion a straight line, so:
 * 1. whole samples without contact, eight of them before their proofs, and whole substeps of contact, go by precomputed exact maps,
 *    where a bound proves that nothing lies inside (free_motion.inl, contact_substep.inl);
 * 2. what they cannot prove is done by power series in time, cut at the first root of a guard (step.inl);
 * 3. simulations wait in one queue for each kind of step; one that fills a batch gives the next, which is carried into
 *    lanes, goes on until half of it is done with that kind of step (of free motion: a quarter), and is carried out to the next
 *    queues;
 * 4. samples that may hold a largest displacement are noted, and looked into at the end where none was larger;
 * 5. behind a step, lanes with the same future are sent on one after the other: a branch that every lane takes at random
 *    costs more than what it decides;
 * 6. simulations of one scene, of laws of one branch, make their maps once, and their constants stay in lanes from batch to
 *    batch;
 * 7. tasks that differ in nothing but their laws are one simulation until a first one of them may yield (shared_start.inl);
 * 8. one that is observed goes through the same steps, and stops at every event and, in going contact, at every sample; its observer
 *    hears of every sample, or of those that may hold a largest u_1 - u_2.
 * A simulation's bits depend on itself alone: not on its lane, its neighbours or the lane count. */
#include "engine/exact/task.h"

#include <assert.h>
#include <string.h>

enum {
	ORDER_LOW = 13,  /* of the series of a displacement while separated */
	ORDER_HIGH = 17, /* while touching */
};

// clang-format off
#include "engine/exact/simulation.inl"
#include "engine/exact/free_motion.inl"
#include "engine/exact/contact_substep.inl"
#include "engine/exact/series.inl"
#include "engine/exact/contact_map.inl"
#include "engine/exact/energy.inl"
#include "engine/exact/step.inl"
#include "engine/exact/observer.inl"
#include "engine/exact/next_step.inl"
#include "engine/exact/shared_start.inl"
#include "engine/exact/batch.inl"
#include "engine/exact/scheduler.inl"
// clang-format on

enum {
	CONTACT_ROUNDS = 2, /* moves of going contact before it is asked who is left: no branch foresees that */
};

/* ---- whole samples without contact ---- */

/* the ground motion in front of each lane */
struct ahead {
	const double *ground[W]; /* from where it started */
	int64_t gone;            /* samples that lanes still in free motion have gone since */
	unsigned moving;         /* lanes that still do */
	vd samples;              /* that are left */
	unsigned edged;          /* lanes that stopped where an edge may be reached */
	unsigned observed;       /* lanes of TRAIT_OBSERVED */
};

/* The next ROW samples of the lanes in free motion, as far as there are any.
 *
 * Returns  value  lanes that have fewer
 */
LANE_INLINE unsigned ground_load(struct work *work, const struct ahead *ahead, vd ground[ROW])
{
	const double *at[W];
	const unsigned moving = ahead->moving;
	unsigned whole = moving & ~vbits(vless(ahead->samples, vsplat(ROW)));
	for (int l = 0; l < W; l++) {
		at[l] = whole >> l & 1 ? ahead->ground[l] + ahead->gone : work->beyond[l];
		// the line that the next ROW end in: that in which they begin has come with these
		__builtin_prefetch((const void *)((uintptr_t)at[l] + (2 * ROW - 1) * sizeof(double)));
	}
	double samples[W];
	lanes_store(samples, ahead->samples);
	for (unsigned ends = moving & ~whole; ends;) {
		int l = lane_next(&ends);
		memcpy(work->beyond[l], ahead->ground[l] + ahead->gone, sizeof(double) * (size_t)samples[l]);
	}
	rows_load(ground, at, 0);
	return moving & ~whole;
}

/* Notes the largest displacements that lanes may have inside a sample of a stretch.
 *
 * Given    s, r   the stretch and the sample in it;  gone: samples before that since the batch began
 *          noted  lanes whose body i may have it there
 * Returns  value  lanes that have no room for another
 */
LANE_SHARED unsigned peaks_keep(const struct batch *b, int i, const struct stretch *s, int r, unsigned noted,
                                int64_t gone)
{
	double u[W], v[W], top[W], bound[W];
	lanes_store(u, s->at[i][r].u);
	lanes_store(v, s->at[i][r].v);
	lanes_store(top, s->top[i][r]);
	lanes_store(bound, s->bound[i][r]);
	unsigned full = 0;
	while (noted) {
		int l = lane_next(&noted);
		struct simulation *sim = b->sim[l];
		const struct pound_peak peak = {.next = sim->next + gone,
		                                .u = u[l],
		                                .v = v[l],
		                                .stiffness = sim->x.body[i].stiffness,
		                                .offset = sim->x.body[i].offset,
		                                .bound = bound[l]};
		if (!peak_note(sim, i, &peak, top[l]))
			full |= 1u << l;
	}
	return full;
}

/* What the observers of lanes have seen at most, a row for each side.
 *
 * Returns  value  lanes whose observers are to hear of every sample
 */
LANE_INLINE unsigned observers_most(const struct batch *b, unsigned lanes, vd most[2])
{
	double known[2][W] = {0};
	unsigned every = 0;
	while (lanes) {
		int l = lane_next(&lanes);
		const double *of = b->sim[l]->task->observer->most;
		for (int k = 0; of && k < 2; k++)
			known[k][l] = of[k];
		every |= of ? 0 : 1u << l;
	}
	most[0] = lanes_of(known[0]), most[1] = lanes_of(known[1]);
	return every;
}

/* Reports to the observers of lanes the samples of free motion in a stretch. */
LANE_SHARED void stretch_observe(const struct batch *b, const struct ahead *ahead,
                                 const struct observed_stretch *stretch)
{
	const struct stretch *s = stretch->samples;
	double samples[W];
	unsigned exceeds[ROW], any = 0;
	vd most[ROW + 1][2];
	lanes_store(samples, stretch->moved);
	const unsigned every = observers_most(b, ahead->observed, most[0]);
	for (int r = 0; r < ROW; r++) {
		exceeds[r] = every | stretch_exceeds(stretch, r, most[r], most[r + 1]);
		any |= exceeds[r];
	}
	for (unsigned lanes = ahead->observed; lanes;) {
		const int l = lane_next(&lanes);
		struct simulation *sim = b->sim[l];
		const int64_t before = sim->next + ahead->gone - 1; // the sample at which the stretch begins
		const int n = (int)samples[l];
		int passed = any >> l & 1 ? 0 : n;
		for (int r = passed; r <= n; r++) {
			const bool ends = r == n, looked = !ends && exceeds[r] >> l & 1;
			if (passed > 0 && (looked || ends)) {
				stretch_carry(sim, s, r, l);
				stretch_pass(sim, most[r], before + r, l, passed);
				passed = 0;
			}
			if (looked) {
				stretch_carry(sim, s, r + 1, l);
				simulation_observe(sim, before + r + 1);
			} else
				passed++;
		}
	}
}

/* Free motion over ROW samples at most, and not beyond the end of any lane: each as far as it has no event.
 *
 * Returns  g       their states there
 *          ahead   what is left in front of each, and those still in free motion, with samples left
 */
LANE_INLINE void free_stretch(struct work *work, const struct batch *b, struct ahead *ahead, struct lanes *g,
                              const struct free_map maps[2], const struct scope *scope)
{
	struct stretch s;
	unsigned on = ahead->moving;
	s.ground[0] = g->ground;
	unsigned more = vbits(vless(vsplat(ROW), ahead->samples)), ends = ground_load(work, ahead, s.ground + 1);
	stretch_run(&s, g, maps, scope);
	vd moved = vsplat(0), one = vsplat(1);
	for (int r = 0; r < ROW; r++) {
		if (ends)
			on &= vbits(vless(vsplat(r), ahead->samples));
		if (scope->edged) {
			ahead->edged |= on & s.edge[r];
			on &= ~s.edge[r];
		}
		if (scope->paired)
			on &= ~s.meet[r];
		for (int i = 0; i < (scope->paired && scope->right ? 2 : 1); i++)
			if (s.peak[i][r] & on)
				on &= ~peaks_keep(b, i, &s, r, s.peak[i][r] & on, ahead->gone + r);
		moved = vselect(vmask(on), moved + one, moved);
		stretch_keep(g, &s, r + 1, vmask(on), scope);
	}
	if (scope->observed) {
		const struct observed_stretch observed = {&s, g, maps, scope->paired, moved};
		stretch_observe(b, ahead, &observed);
	}
	g->ground = s.ground[ROW];
	ahead->samples = ahead->samples - moved;
	ahead->gone += ROW;
	ahead->moving = on & more;
}

/* Given    g, maps, scope  what does not change meanwhile */
LANE_INLINE void free_batch(struct work *work, const struct batch *b, enum pound_stage stage, struct lanes *g,
                            const struct free_map maps[2], struct scope scope)
{
	struct ahead ahead = {.moving = batch_lanes(b),
	                      .observed = scope.observed ? vbits(batch_trait(b, TRAIT_OBSERVED)) : 0};
	double ground[W], samples[W];
	lanes_fill(g, b, ROW_STATE);
	for (int l = 0; l < W; l++) {
		const struct simulation *sim = b->sim[l];
		ahead.ground[l] = &sim->ground[sim->next];
		samples[l] = (double)(free_end(sim) - sim->next + 1);
		ground[l] = ahead.ground[l][-1];
	}
	g->ground = lanes_of(ground);
	ahead.samples = lanes_of(samples);
	do
		free_stretch(work, b, &ahead, g, maps, &scope);
	while (__builtin_popcount(ahead.moving) > b->n * 3 / 4);
	unsigned on = ahead.moving;
	lanes_empty(g, b, ROW_STATE);
	lanes_store(samples, ahead.samples);
	for (int l = 0; l < b->n; l++)
		b->sim[l]->next = free_end(b->sim[l]) + 1 - (int64_t)samples[l];
	unsigned there = batch_lanes(b) & vbits(vequal(ahead.samples, vsplat(0)));
	unsigned met = batch_lanes(b) & ~there & ~on,
	         leaving = scope.edged ? met & batch_leaving(b, vmask(ahead.edged)) : 0;
	met &= ~leaving;
	while (met) {
		struct simulation *sim = b->sim[lane_next(&met)];
		send(work, sim, simulation_meet(sim));
	}
	while (leaving)
		member_leave(work, b->sim[lane_next(&leaving)], stage);
	while (on)
		push(&work->queues[stage], b->sim[lane_next(&on)]);
	while (there) {
		struct simulation *sim = b->sim[lane_next(&there)];
		send(work, sim, simulation_after_free(sim, stage));
	}
}

LANE_INLINE void free_lanes(struct work *work, struct batch *b, enum pound_stage stage, enum kind kind,
                            bool observed)
{
	const bool common = kind == KIND_COMMON;
	const struct state_rows *shared = common ? &work->common.x : NULL;
	struct lanes g;
	lanes_constant(&g, b, shared, ROW_LEFT);
	lanes_constant(&g, b, shared, ROW_MAP_LEFT);
	struct free_map maps[2] = {free_map_of(&g, 0)};
	if (stage == STAGE_FREE_PAIR) {
		lanes_constant(&g, b, shared, ROW_RIGHT);
		lanes_constant(&g, b, shared, ROW_MAP_RIGHT);
		maps[1] = free_map_of(&g, 1);
	}
	do
		free_batch(work, b, stage, &g, maps,
		           (struct scope){.paired = stage == STAGE_FREE_PAIR,
		                          .edged = kind == KIND_EDGED,
		                          .right = b->traits & TRAIT_RIGHT,
		                          .observed = observed});
	while (common && batch_again(work, b));
}

/* Of what is observed all is in memory that others know of: code of its own, so that other lanes keep theirs in registers. */
LANE_SHARED void free_single_observed(struct work *work, struct batch *b)
{
	free_lanes(work, b, STAGE_FREE_SINGLE, KIND_EDGED, true);
}
LANE_SHARED void free_pair_observed(struct work *work, struct batch *b)
{
	free_lanes(work, b, STAGE_FREE_PAIR, KIND_EDGED, true);
}

LANE_INLINE void free_run(struct work *work, struct batch *b, enum pound_stage stage, enum kind kind)
{
	if (__builtin_expect(b->traits & TRAIT_OBSERVED, 0))
		(stage == STAGE_FREE_PAIR ? free_pair_observed : free_single_observed)(work, b);
	else
		free_lanes(work, b, stage, kind, false);
}

/* ---- whole substeps of contact ---- */

/* Accounts for the energy of the lanes that went over a map of some substeps. */
static void contact_account(const struct batch *b, const struct lanes *g, const struct contact_state *from,
                            const struct contact_state *to, vd substeps, unsigned going)
{
	vd inputs[POUND_CONTACT_INPUTS];
	contact_inputs(inputs, g, from, from->rise * substeps);
	while (going) {
		int l = lane_next(&going);
		double x[POUND_CONTACT_INPUTS], end[4];
		for (int j = 0; j < POUND_CONTACT_INPUTS; j++)
			x[j] = ((const double *)&inputs[j])[l];
		for (int j = 0; j < 4; j++)
			end[j] = ((const double *)&to->x[j])[l];
		contact_work(b->sim[l], x, end, ((const double *)&from->ground)[l], ((const double *)&from->rise)[l]);
	}
}

/* the ground motion at both ends of each lane's interval, and at the end of the next one, and where that stands */
struct samples {
	vd before, ground, next;
	vu at;
};

/* Given    left  samples behind the interval */
LANE_INLINE struct samples samples_of(const struct batch *b, vd *left)
{
	struct samples s;
	uint64_t at[W];
	double behind[W], before[W], ground[W];
	for (int l = 0; l < W; l++) {
		const struct simulation *sim = b->sim[l];
		const double *end = &sim->ground[sim->next];
		before[l] = end[-1];
		ground[l] = *end;
		behind[l] = (double)(sim->last - sim->next);
		at[l] = (uintptr_t)(sim->next < sim->last ? end + 1 : end);
	}
	*left = lanes_of(behind);
	s.before = lanes_of(before);
	s.ground = lanes_of(ground);
	s.at = lanes_at(at);
	s.next = vgather(s.at);
	return s;
}

/* Lanes at a sample enter the next interval.
 *
 * Given    share  of an interval that a substep is
 */
LANE_INLINE void samples_next(struct samples *s, struct contact_state *x, vm entering, vd substeps, vd share)
{
	vd left = x->left - vsplat(1), rise = (s->next - s->ground) * share;
	x->ground = vselect(entering, s->ground, x->ground);
	x->rise = vselect(entering, rise, x->rise);
	x->substeps = vselect(entering, substeps, x->substeps);
	x->left = vselect(entering, left, x->left);
	s->ground = vselect(entering, s->next, s->ground);
	s->at = vnext(entering & vless(vsplat(0), left), s->at);
	s->next = vgather(s->at);
}

/* Lanes that keep their doubled map: it has room before the next sample, and none longer has behind the one just entered. */
LANE_INLINE vm doubled_stays(const struct contact_lanes *s, vm entered)
{
	vd substeps = s->doubled[CONTACT_SPLIT][SPLIT_SUBSTEPS];
	return ~vless(s->at.substeps, substeps) & ~(entered & vless(substeps, s->at.substeps));
}

/* Carries one row of the maps into lanes: of one map, where it is common to all. */
LANE_INLINE void contact_row_load(vd row[POUND_CONTACT_INPUTS], const double *const map[W], int r,
                                  bool common)
{
	if (!common) {
		rows_load(row, map, r * POUND_CONTACT_INPUTS);
		return;
	}
	for (int j = 0; j < POUND_CONTACT_INPUTS; j++)
		row[j] = vsplat(map[0][r * POUND_CONTACT_INPUTS + j]);
}

/* Carries the maps into lanes: of a substep, or of a doubled map. */
LANE_INLINE void contact_maps_load(struct contact_lanes *s, const struct lanes *g, const double *const map[W],
                                   enum pound_stage stage, bool common)
{
	vd row[POUND_CONTACT_INPUTS];
	for (int r = 0; r <= CONTACT_IMPULSE; r++) {
		contact_row_load(row, map, r, common);
		s->moved[r] = form_of(row, g, false);
	}
	if (stage == STAGE_SUSTAINED) {
		for (int r = DOUBLED_ERROR; r < CONTACT_MAP_ROWS; r++)
			rows_load(s->doubled[r], map, r * POUND_CONTACT_INPUTS);
		return;
	}
	contact_row_load(row, map, CONTACT_ERROR, common);
	s->error = form_of(row, g, true);
}

/* Given    g, s  what does not change meanwhile, and of g the row PRESS */
LANE_INLINE void contact_batch(struct work *work, const struct batch *b, enum pound_stage stage,
                               struct lanes *g, struct contact_lanes *s, struct scope scope)
{
	const bool edged = scope.edged, seldom = scope.seldom;
	scope.forced = b->traits & TRAIT_FORCED;
	scope.right = b->traits & TRAIT_RIGHT;
	lanes_fill(g, b, ROW_STATE);
	lanes_fill(g, b, ROW_STEP);
	s->alike = seldom ? batch_trait(b, TRAIT_ALIKE) : vmask(0);
	const vm accounted = seldom ? batch_trait(b, TRAIT_ACCOUNTED) : vmask(0);
	const vm watched = seldom ? batch_trait(b, TRAIT_OBSERVED) : vmask(0);
	const vd before = g->substeps_done;
	vd zero = vsplat(0), one = vsplat(1), share = one / g->substeps_per_sample, behind;
	struct samples samples = samples_of(b, &behind);
	contact_load(s, g, (samples.ground - samples.before) * share, behind, &scope);
	const vd rounds = s->at.rounds,
	         substeps = stage == STAGE_SUSTAINED ? s->doubled[CONTACT_SPLIT][SPLIT_SUBSTEPS] : one;
	vm going = vmask(batch_lanes(b)), ended = vmask(0), refused = vmask(0), gone = vmask(0);
	vm decided = vmask(0);
	int few = b->n / 2;
	do {
		_Pragma("GCC unroll 1") for (int round = 0; round < CONTACT_ROUNDS; round++)
		{
			struct contact_state from;
			if (seldom)
				from = s->at;
			vm edge, risk = stage == STAGE_SUSTAINED ? sustained_contact(g, s, &scope, going, &edge)
			                                         : contact_substep(g, s, &scope, going, &edge);
			refused |= risk & going;
			if (edged)
				decided |= edge & going;
			going &= ~risk;
			if (seldom)
				contact_account(b, g, &from, &s->at, substeps, vbits(going & accounted));
			vm sampled = vequal(s->at.substeps, zero), last = vequal(s->at.left, zero);
			ended |= sampled & last & going;
			vm entered = sampled & ~last;
			samples_next(&samples, &s->at, entered, g->substeps_per_sample, share);
			s->at.rounds = vselect(going, s->at.rounds - one, s->at.rounds);
			gone |= vequal(s->at.rounds, zero) & going;
			going &= ~ended & ~gone;
			if (seldom) // a sample is an instant
				going &= ~(entered & watched);
			if (stage == STAGE_SUSTAINED)
				going &= doubled_stays(s, entered);
		}
	} while (__builtin_popcount(vbits(going)) > few);
	contact_store(&s->at, g);
	g->substeps_done = vfma(rounds - s->at.rounds, substeps, g->substeps_done);
	lanes_empty(g, b, ROW_STATE);
	lanes_empty(g, b, ROW_STEP);
	lanes_empty(g, b, ROW_CONTACT);
	double left[W], substeps_gone[W];
	lanes_store(left, s->at.left);
	if (seldom)
		lanes_store(substeps_gone, g->substeps_done - before);
	for (int l = 0; l < b->n; l++) {
		struct simulation *sim = b->sim[l];
		int64_t next = sim->last - (int64_t)left[l];
		const bool entered = next != sim->next;
		sim->steps = entered ? 0 : sim->steps;
		interval_set(sim, next);
		if (!seldom || !observed(sim))
			continue;
		sim->unobserved_substeps += substeps_gone[l];
		if (entered)
			simulation_observe(sim, next - 1);
	}
	unsigned stays = vbits(going), ends = vbits(ended), leaving = edged ? batch_leaving(b, decided) : 0;
	unsigned changes = batch_lanes(b) & ~stays & ~ends & ~leaving;
	while (leaving)
		member_leave(work, b->sim[lane_next(&leaving)], stage);
	while (stays)
		push(&work->queues[stage], b->sim[lane_next(&stays)]);
	while (changes) {
		int l = lane_next(&changes);
		struct simulation *sim = b->sim[l];
		send(work, sim, simulation_after_contact(sim, stage, vbits(refused) >> l & 1, vbits(gone) >> l & 1));
	}
	while (ends)
		finish(work, b->sim[lane_next(&ends)], STAGE_END);
}

LANE_INLINE void contact_run(struct work *work, struct batch *b, enum pound_stage stage, struct scope scope)
{
	struct lanes g;
	struct contact_lanes s;
	const struct state_rows *shared = scope.common ? &work->common.x : NULL;
	lanes_constant(&g, b, shared, ROW_PAIR);
	lanes_fill(&g, b, ROW_CONTACT);
	if (scope.edged) {
		lanes_constant(&g, b, shared, ROW_LEFT);
		lanes_constant(&g, b, shared, ROW_RIGHT);
	}
	const double *map[W];
	for (int l = 0; l < W; l++)
		map[l] = b->sim[l]->contact_map->row[0];
	contact_maps_load(&s, &g, map, stage, scope.common);
	for (bool again = true; again;) {
		contact_batch(work, b, stage, &g, &s, scope);
		again = scope.common && batch_again(work, b);
		if (again)
			lanes_fill(&g, b, ROW_CONTACT);
	}
}

/* What is asked for or happens seldom goes one way for all laws. */
static void contact_seldom(struct work *work, struct batch *b, enum pound_stage stage)
{
	const struct scope scope = {.edged = true, .seldom = true};
	if (stage == STAGE_SUSTAINED)
		contact_run(work, b, STAGE_SUSTAINED, scope);
	else
		contact_run(work, b, STAGE_CONTACT, scope);
}

LANE_INLINE void contact_any(struct work *work, struct batch *b, enum pound_stage stage, enum kind kind)
{
	if (b->traits & (TRAIT_ACCOUNTED | TRAIT_ALIKE | TRAIT_OBSERVED))
		contact_seldom(work, b, stage);
	else
		contact_run(work, b, stage,
		            (struct scope){.edged = kind == KIND_EDGED, .common = kind == KIND_COMMON});
}

/* ---- one step up to an event ---- */

LANE_INLINE struct event_lanes event_lanes_of(const struct batch *b, enum pound_stage stage)
{
	struct event_lanes e = {.scope = {.touching = stage == STAGE_STEP_CONTACT,
	                                  .paired = stage != STAGE_STEP_SINGLE && stage != STAGE_FINISH_SINGLE,
	                                  .edged = b->traits & TRAIT_EDGED,
	                                  .right = b->traits & TRAIT_RIGHT,
	                                  .forced = b->traits & TRAIT_FORCED},
	                        .active = vmask(batch_lanes(b)),
	                        .released = vmask(0),
	                        .fresh = vmask(0),
	                        .decided = vmask(0)};
	if (e.scope.forced)
		batch_forces(b, &e.released, &e.fresh);
	return e;
}

/* Given    g  what does not change meanwhile */
LANE_INLINE void step_batch(struct work *work, struct batch *b, enum pound_stage stage, struct lanes *g,
                            enum kind kind)
{
	struct event_lanes e = event_lanes_of(b, stage);
	if (kind == KIND_COMMON)
		e.scope.edged = false;
	const bool accounted = b->traits & TRAIT_ACCOUNTED;
	lanes_fill(g, b, ROW_STATE);
	lanes_fill(g, b, ROW_STEP);
	if (accounted)
		lanes_fill(g, b, ROW_WORK);
	vd events = event_step(g, &e, accounted);
	vm changes = vmask(0);
	if (e.scope.paired)
		changes = event_follow(g, &e, events);
	double event[W], left[W], speed[W];
	lanes_store(event, events);
	lanes_store(left, vfma(g->substeps, g->substep, g->remainder));
	lanes_store(speed, g->q);
	// the work done is kept of whole steps only, and an event is an instant
	if (b->traits & (TRAIT_ACCOUNTED | TRAIT_OBSERVED))
		changes &= ~batch_trait(b, TRAIT_ACCOUNTED | TRAIT_OBSERVED);
	if (vany(changes)) {
		e.scope.touching = !e.scope.touching;
		event_finish(g, &e, changes);
	}
	const unsigned leaving = e.scope.edged ? batch_leaving(b, e.decided) : 0;
	batch_forget(b, leaving, &work->filler);
	lanes_empty(g, b, ROW_STATE);
	lanes_empty(g, b, ROW_STEP);
	if (accounted)
		lanes_empty(g, b, ROW_WORK);
	for (int l = 0; l < b->n; l++) {
		struct simulation *sim = b->sim[l];
		if (leaving >> l & 1) {
			member_leave(work, sim, stage);
			continue;
		}
		sim->released = vbits(e.released) >> l & 1;
		sim->fresh = vbits(e.fresh) >> l & 1;
		if (observed(sim))
			sim->unobserved += sim->x.dt;
		send(work, sim, simulation_stepped(sim, (int)event[l], left[l], speed[l]));
	}
}

LANE_INLINE void step(struct work *work, struct batch *b, enum pound_stage stage, enum kind kind)
{
	const bool common = kind == KIND_COMMON;
	const struct state_rows *shared = common ? &work->common.x : NULL;
	struct lanes g;
	lanes_constant(&g, b, shared, ROW_LEFT);
	lanes_constant(&g, b, shared, ROW_PAIR);
	if (stage != STAGE_STEP_SINGLE)
		lanes_constant(&g, b, shared, ROW_RIGHT);
	do
		step_batch(work, b, stage, &g, kind);
	while (common && batch_again(work, b));
}

/* What is left of a sample. */
LANE_INLINE void finish_interval(struct work *work, struct batch *b, enum pound_stage stage)
{
	struct event_lanes e = event_lanes_of(b, stage);
	struct lanes g;
	lanes_fill(&g, b, ROW_STATE);
	lanes_fill(&g, b, ROW_STEP);
	lanes_fill(&g, b, ROW_LEFT);
	lanes_fill(&g, b, ROW_PAIR);
	if (e.scope.paired)
		lanes_fill(&g, b, ROW_RIGHT);
	event_finish(&g, &e, vmask(batch_lanes(b)));
	// nothing is to be taken back: they have not moved
	const unsigned leaving = e.scope.edged ? batch_leaving(b, e.decided) : 0;
	lanes_empty(&g, b, ROW_STATE);
	lanes_empty(&g, b, ROW_STEP);
	for (int l = 0; l < b->n; l++) {
		struct simulation *sim = b->sim[l];
		if (leaving >> l & 1) {
			member_leave(work, sim, stage);
			continue;
		}
		if (observed(sim) && sim->x.remainder == 0) // else it has stayed
			sim->unobserved += sim->x.dt;
		send(work, sim, simulation_next(sim));
	}
}

/* ---- the march ---- */

/* the stages' steps: of laws of one branch, of others, and of simulations of one scene */
#define STEP(name, ...)                                  \
	static void name(struct work *work, struct batch *b) \
	{                                                    \
		__VA_ARGS__;                                     \
	}
STEP(free_single, free_run(work, b, STAGE_FREE_SINGLE, KIND_PLAIN))
STEP(free_single_edged, free_run(work, b, STAGE_FREE_SINGLE, KIND_EDGED))
STEP(free_single_common, free_run(work, b, STAGE_FREE_SINGLE, KIND_COMMON))
STEP(free_pair, free_run(work, b, STAGE_FREE_PAIR, KIND_PLAIN))
STEP(free_pair_edged, free_run(work, b, STAGE_FREE_PAIR, KIND_EDGED))
STEP(free_pair_common, free_run(work, b, STAGE_FREE_PAIR, KIND_COMMON))
STEP(contact_plain, contact_any(work, b, STAGE_CONTACT, KIND_PLAIN))
STEP(contact_edged, contact_any(work, b, STAGE_CONTACT, KIND_EDGED))
STEP(contact_common, contact_any(work, b, STAGE_CONTACT, KIND_COMMON))
STEP(sustained_plain, contact_any(work, b, STAGE_SUSTAINED, KIND_PLAIN))
STEP(sustained_edged, contact_any(work, b, STAGE_SUSTAINED, KIND_EDGED))
STEP(step_single, step(work, b, STAGE_STEP_SINGLE, KIND_EDGED))
STEP(step_pair, step(work, b, STAGE_STEP_PAIR, KIND_EDGED))
STEP(step_pair_common, step(work, b, STAGE_STEP_PAIR, KIND_COMMON))
STEP(step_contact, step(work, b, STAGE_STEP_CONTACT, KIND_EDGED))
STEP(step_contact_common, step(work, b, STAGE_STEP_CONTACT, KIND_COMMON))
STEP(finish_single, finish_interval(work, b, STAGE_FINISH_SINGLE))
STEP(finish_pair, finish_interval(work, b, STAGE_FINISH_PAIR))

static void (*const steps[STAGES][KINDS])(struct work *, struct batch *) = {
    [STAGE_FREE_SINGLE] = {free_single, free_single_edged, free_single_common},
    [STAGE_FREE_PAIR] = {free_pair, free_pair_edged, free_pair_common},
    [STAGE_CONTACT] = {contact_plain, contact_edged, contact_common},
    [STAGE_SUSTAINED] = {sustained_plain, sustained_edged, sustained_plain},
    [STAGE_STEP_SINGLE] = {step_single, step_single, step_single},
    [STAGE_STEP_PAIR] = {step_pair, step_pair, step_pair_common},
    [STAGE_STEP_CLEAR] = {step_pair, step_pair, step_pair_common},
    [STAGE_STEP_CONTACT] = {step_contact, step_contact, step_contact_common},
    [STAGE_FINISH_SINGLE] = {finish_single, finish_single, finish_single},
    [STAGE_FINISH_PAIR] = {finish_pair, finish_pair, finish_pair},
};

static_assert(sizeof(struct lanes) == W * sizeof(struct state_rows), "rows are doubles and nothing else");

/* Runs every task to its end.
 *
 * Given    tasks    (n)
 *          scratch  POUND_EXACT_SCRATCH bytes, 64-byte aligned
 *          stop     looked at between batches: when it is set the results are not to be used; NULL: never
 * Returns  results  (n); status POUND_CHATTER where a task ended early, POUND_OVERFLOW where its motion is not finite
 *
 * Source   model.md 1
 * Test     unit_march, unit_response; unit_status: a_run_that_takes_hours_is_stopped
 */
void POUND_EXACT(const struct pound_task *tasks, struct pound_task_result *results, int n, void *scratch,
                 const atomic_bool *stop)
{
	struct work *work = scratch;
	work_init(work, tasks, results, n, stop);
	struct queue *queue = &work->queues[0];
	while (!pound_stopped(stop)) {
		tasks_start(work);
		// as long as it fills a batch: its code is in the cache
		for (int stage = 0; stage < STAGES && queue->n < W; stage++)
			if (work->queues[stage].n > queue->n)
				queue = &work->queues[stage];
		if (queue->n == 0)
			break;
		struct batch b;
		batch_take(&b, work, queue);
		steps[queue - work->queues][batch_kind(b.traits)](work, &b);
	}
	lanes_leave();
}
