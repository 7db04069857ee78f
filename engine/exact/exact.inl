/* exact.inl - the exact event-driven solver, W simulations at a time in SIMD lanes.
 *
 * Between events a pair of oscillators is linear and the ground motion is piecewise linear in time, so:
 * 1. whole samples without contact (eight are moved first, then proved) and whole substeps of contact are advanced by
 *    precomputed exact maps, where a bound proves that no event lies inside (free_motion.inl, contact_substep.inl);
 * 2. intervals without such a proof are integrated by power series in time, cut at the first root of a guard (step.inl);
 * 3. simulations wait in one queue per kind of step; a queue that fills a batch is taken next.  The batch is loaded into lanes,
 *    runs until half of its lanes (in free motion: a quarter) need another kind of step, and is stored to the next queues;
 * 4. samples that may contain the largest displacement are noted, and examined at the end if no larger one was found;
 * 5. after a step, the lanes are sent on in groups with the same outcome: one unpredictable branch per lane would cost
 *    more than the work it selects;
 * 6. simulations of one scene whose laws have one branch share their maps, and their constants stay in lanes from batch to
 *    batch;
 * 7. tasks that differ only in their laws run as one simulation until the first of them may yield (shared_start.inl);
 * 8. an observed simulation takes the same steps, but stops at every event and, during contact, at every sample; its observer
 *    is called at every sample, or only at those that may contain the largest u_1 - u_2.
 * The bits of a simulation's result do not depend on its lane, the other lanes or the lane count. */
#include "engine/exact/task.h"

#include <assert.h>
#include <string.h>

enum {
	ORDER_LOW = 13,  /* order of displacement series while separated */
	ORDER_HIGH = 17, /* ... in contact */
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
	CONTACT_ROUNDS =
	    2, /* substeps between two counts of the lanes still in contact: that branch is unpredictable */
};

/* ---- whole samples without contact ---- */

/* the remaining ground motion of each lane */
struct ahead {
	const double *ground[W]; /* its samples, from the start of the batch */
	int64_t gone;            /* samples passed since then by the lanes still in free motion */
	unsigned moving;         /* lanes still in free motion */
	vd samples;              /* samples left */
	unsigned edged;          /* lanes that stopped because a branch edge may be reached */
	unsigned observed;       /* lanes with TRAIT_OBSERVED */
};

/* Loads the next ROW ground samples of the lanes in free motion, or as many as are left.
 *
 * Returns  value  lanes with fewer than ROW left
 */
LANE_INLINE unsigned ground_load(struct work *work, const struct ahead *ahead, vd ground[ROW])
{
	const double *at[W];
	const unsigned moving = ahead->moving;
	unsigned whole = moving & ~vbits(vless(ahead->samples, vsplat(ROW)));
	for (int l = 0; l < W; l++) {
		at[l] = whole >> l & 1 ? ahead->ground[l] + ahead->gone : work->beyond[l];
		// prefetch the cache line in which the next ROW end; the line in which they begin is loaded here
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

/* Notes that the largest displacement of body i may lie inside a sample of a stretch.
 *
 * Given    s, r   the stretch and the sample in it;  gone: samples before it since the batch began
 *          noted  the lanes concerned
 * Returns  value  lanes without room for another note
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

/* Largest u_1 - u_2 and u_2 - u_1 reported to the observers of lanes so far.
 *
 * Returns  value  lanes whose observers want every sample
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

/* Reports the samples of free motion in a stretch to the lanes' observers. */
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

/* Advances each lane in free motion by up to ROW samples: to its first possible event or its last sample.
 *
 * Returns  g       the states there
 *          ahead   samples left, and the lanes still in free motion with samples left
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

/* Free motion of a batch, until a quarter of its lanes have stopped; g, maps and scope hold the constants. */
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

/* Observed batches have their own copy of the code: pointers to their state escape, which would keep it out of registers. */
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

/* Energy balance of the lanes that were advanced by a map over some substeps. */
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

/* ground acceleration at both ends of each lane's interval and at the end of the next one, and the address of the latter */
struct samples {
	vd before, ground, next;
	vu at;
};

/* Returns  left  samples after the interval */
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

/* Moves lanes at a sample into the next interval.
 *
 * Given    share  length of a substep over the interval's
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

/* Lanes that keep their doubled map: it fits before the next sample; on entering an interval, no longer one fits. */
LANE_INLINE vm doubled_stays(const struct contact_lanes *s, vm entered)
{
	vd substeps = s->doubled[CONTACT_SPLIT][SPLIT_SUBSTEPS];
	return ~vless(s->at.substeps, substeps) & ~(entered & vless(substeps, s->at.substeps));
}

/* Loads one row of the maps into lanes; a common map is broadcast. */
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

/* Loads the substep maps or doubled maps into lanes. */
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

/* Contact of a batch, until half of its lanes have stopped; g and s hold the constants, g also ROW_CONTACT. */
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
			if (seldom) // an observed lane stops at every sample
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

/* The rare cases (struct scope: seldom) share one copy of the code for all laws. */
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

/* One step of a batch by power series; g holds the constant rows. */
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
	// not finished in the same step: energy is summed over whole steps only, and an observer is called at every event
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

/* Finishes the current sample interval in one step where no event can occur. */
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
	// nothing to undo in the lanes that leave: they have not moved
	const unsigned leaving = e.scope.edged ? batch_leaving(b, e.decided) : 0;
	lanes_empty(&g, b, ROW_STATE);
	lanes_empty(&g, b, ROW_STEP);
	for (int l = 0; l < b->n; l++) {
		struct simulation *sim = b->sim[l];
		if (leaving >> l & 1) {
			member_leave(work, sim, stage);
			continue;
		}
		if (observed(sim) && sim->x.remainder == 0) // else it has not moved
			sim->unobserved += sim->x.dt;
		send(work, sim, simulation_next(sim));
	}
}

/* ---- the solver ---- */

/* the step of each stage and kind of batch */
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
 *          stop     polled between batches: once it is set the results are invalid; NULL: never stopped
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
		// stay with the queue as long as it fills a batch: its code is in the cache
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
