/* step.inl - one step up to an event, by power series in time.
 *
 * Included by exact.inl alone, once per lane count.  A step ends at the first root of a guard (contact opens or closes, an
 * edge of a branch is reached, the velocity reverses), found to rounding, or at its planned length.
 *
 * Included by exact.inl after energy.inl. */

/* what ends a step; the event of an edge of body i is EVENT_BODY + EVENT_EDGES i + edge */
enum { EVENT_CONTACT = EVENT_OWN, EVENT_CLEARS, EVENT_BODY, EVENT_EDGES = 3 };

/* lanes of a step by power series, and their states */
struct event_lanes {
	struct scope scope;
	vm active;          /* lanes in use */
	vm released, fresh; /* as in struct simulation */
	vm decided;         /* lanes in which an edge of a branch decided how far they went */
};

/* Derivatives of left, right and overlap by the elapsed fraction of the step, from one order to the next, and the coefficients of
 * the equations of motion, all scaled to the step.  For a single body only [0] is set; spring and dash only while touching. */
struct terms {
	vd u[3], v[3];            /* derivatives n and n + 1 */
	vd c[2], k[2];            /* negative damping and stiffness of each body */
	vd force[2], increase[2]; /* its forcing at the start of the step, and the increase over the step */
	vd spring, dash;          /* of the contact */
	vm still[2];              /* lanes in which a body has zero velocity */
	// only for level bodies (bodies_level)
	vm level;                     /* lanes in which no derivative has separated or closed the bodies yet */
	struct kinematics by_time[2]; /* derivatives n and n + 1 by time */
	vd per_time;                  /* the step to the power of n + 2 */
};

/* Derivatives 0 and 1, at the start of a step. */
LANE_INLINE struct terms terms_start(const struct lanes *g, const struct scope *scope)
{
	struct terms t;
	vd dt = g->dt, dt2 = dt * dt;
	for (int i = 0; i < (scope->paired ? 2 : 1); i++) {
		t.u[i] = g->u[i], t.v[i] = g->v[i] * dt;
		t.c[i] = -g->body[i].damping * dt;
		t.k[i] = -g->body[i].stiffness * dt2;
		t.force[i] = -vfma(g->body[i].drive, g->ground, g->body[i].offset) * dt2;
		t.increase[i] = -(g->body[i].drive * g->slope) * dt2 * dt;
		t.still[i] = vequal(g->v[i], vsplat(0));
	}
	if (!scope->paired)
		return t;
	t.u[2] = g->p, t.v[2] = g->q * dt;
	if (scope->touching) {
		t.spring = g->contact_stiffness * dt2;
		t.dash = g->contact_damping * dt;
	}
	return t;
}

/* Lanes whose bodies are level: zero overlap, and equal velocities to rounding. */
LANE_INLINE vm bodies_level(const struct lanes *g)
{
	vd alike = vsplat(DBL_EPSILON) * (vabs(g->v[0]) + vabs(g->v[1]));
	return vequal(g->p, vsplat(0)) & ~vless(alike, vabs(g->q));
}

/* Level bodies separate or close by the difference of their accelerations.  A difference below the rounding error of its
 * terms is set to zero, and the next derivative decides: otherwise nearly identical bodies would separate and meet
 * endlessly.  Derivatives by time are compared, as derivatives by the fraction of a step round differently in contact and without,
 * where steps have another length.
 *
 * Given    separating  derivative n of the difference of the accelerations, scaled to the step
 * Returns  t      level: lanes in which no derivative has decided yet
 *          value  the difference, or 0
 */
LANE_SHARED vd separation_zero_rounding(struct terms *t, const struct lanes *g, vd separating, int n)
{
	vd a[2], made = vsplat(0);
	for (int i = 0; i < 2; i++) {
		vd damping = g->body[i].damping * t->by_time[i].v, spring = g->body[i].stiffness * t->by_time[i].u;
		vd drive = vsplat(0), offset = drive;
		if (n < 2)
			drive = g->body[i].drive * (n ? g->slope : g->ground);
		if (n == 0)
			offset = g->body[i].offset;
		a[i] = -(damping + spring + (drive + offset));
		made = made + (vabs(damping) + vabs(spring)) + (vabs(drive) + vabs(offset));
		t->by_time[i] = (struct kinematics){t->by_time[i].v, a[i]};
	}
	vd separating_by_time = a[0] - a[1];
	vm was = t->level;
	t->level &= ~vless(vsplat(POUND_UNDECIDED) * made, vabs(separating_by_time));
	separating = vselect(was, separating_by_time * t->per_time, separating);
	t->per_time = t->per_time * g->dt;
	return vselect(t->level, vsplat(0), separating);
}

/* A body at rest on a branch boundary moves to the next branch or back by the sign of its acceleration.  An acceleration below
 * the rounding error of its terms is set to zero, and higher derivatives decide: otherwise each of two branches, with different
 * rounding, would send the body to the other one endlessly.
 *
 * Given    b      acceleration of body i, times the step squared;  push: acceleration by the contact, likewise; 0 while separated
 *          still  lanes in which the body has zero velocity
 */
LANE_SHARED vd still_zero_rounding(const struct lanes *g, int i, vd b, vd push, vm still)
{
	vd u = g->u[i], made = vabs(g->body[i].stiffness * u) + vabs(g->body[i].offset);
	made = vfma(made + vabs(g->body[i].drive * g->ground), g->dt * g->dt, vabs(push));
	vm ends =
	    vequal(u, g->body[i].high) | vequal(u, g->body[i].low) | ~vequal(g->body[i].direction, vsplat(0));
	vm nothing = still & ends & vless(vabs(b), vsplat(POUND_UNDECIDED) * made);
	return vselect(nothing, vsplat(0), b);
}

/* Advances from derivatives n and n + 1 to n + 1 and n + 2.
 *
 * Given    level  the bodies of some lane are level
 */
LANE_INLINE void terms_next(struct terms *t, const struct lanes *g, int n, const struct scope *scope,
                            bool level)
{
	vd b[2];
	for (int i = 0; i < (scope->paired ? 2 : 1); i++) {
		vd slow = t->k[i] * t->u[i];
		if (n < 2)
			slow = slow + (n ? t->increase[i] : t->force[i]);
		b[i] = vfma(t->c[i], t->v[i], slow);
	}
	vd separating = b[0];
	if (scope->paired)
		separating = b[0] - b[1];
	if (level)
		separating = separation_zero_rounding(t, g, separating, n);
	vd push = vsplat(0);
	if (scope->touching) {
		push = vfma(t->dash, t->v[2], t->spring * t->u[2]);
		b[0] = b[0] - push;
		b[1] = vfma(g->mass_ratio, push, b[1]);
		separating = vfma(g->both, -push, separating);
	}
	for (int i = 0; i < (scope->paired ? 2 : 1); i++)
		if (n == 0 && vany(t->still[i]))
			b[i] = still_zero_rounding(g, i, b[i], i ? g->mass_ratio * push : push, t->still[i]);
	for (int j = 0; j < (scope->paired ? 3 : 1); j++) {
		t->u[j] = t->v[j];
		t->v[j] = j < 2 ? b[j] : separating;
	}
}

/* Stores coefficient n of every motion. */
LANE_INLINE void terms_keep(const struct terms *t, struct motion *const into[3], int n, int motions)
{
	vd share = vsplat(POUND_FACTOR[n]);
	for (int j = 0; j < motions; j++)
		into[j]->u.c[n] = t->u[j] * share;
}

/* Searches for the edges of a body's branch. */
LANE_SHARED void body_search(const struct series *s, const struct lanes *g, int i, vm active,
                             struct search *search)
{
	vd zero = vsplat(0), one = vsplat(1), body = vsplat(EVENT_BODY + EVENT_EDGES * i);
	const struct motion *m = &s->body[i];
	struct enclosure c = enclosure_of(m);
	vm past_high = may_cross(&c, g->body[i].high, one) & active;
	vm past_low = may_cross(&c, g->body[i].low, -one) & active;
	vm reversals = ~vequal(g->body[i].direction, zero) & active;
	// one search for the lanes that may pass either edge, and another one for the low edge of lanes that may pass both
	for (vm past = past_high | past_low; vany(past); past = past_high & past_low, past_high = vmask(0)) {
		vd level = vselect(past_high, g->body[i].high, g->body[i].low), sign = vselect(past_high, one, -one);
		vd edge = vselect(past_high, vsplat(POUND_EDGE_HIGH), vsplat(POUND_EDGE_LOW));
		struct guard guard = guard_of(&m->u, &c, level, sign);
		search_crossing(&guard, s->order, past, body + edge, search);
	}
	if (!vany(reversals))
		return;
	c = enclosure_of_velocity(m, s->order);
	reversals &= may_cross(&c, zero, -g->body[i].direction);
	if (!vany(reversals))
		return;
	struct power velocity;
	motion_velocity(&velocity, m, s->order);
	struct guard guard = guard_of(&velocity, &c, zero, -g->body[i].direction);
	search_crossing(&guard, s->order, reversals, body + vsplat(POUND_EDGE_REVERSAL), search);
}

/* Finds the largest displacement of a body inside the step, before the event found by the search.
 *
 * If the displacement at the first velocity reversal is proved to be the largest except for the step's end, it is kept: an error
 * of the reversal time enters squared.  Otherwise the step is cut at that reversal.
 */
LANE_SHARED void body_top(const struct series *s, struct lanes *g, int i, vm inside, struct search *search)
{
	const struct motion *m = &s->body[i];
	struct enclosure c = enclosure_of_velocity(m, s->order);
	struct power velocity;
	motion_velocity(&velocity, m, s->order);
	const vd *v = velocity.c;
	vd zero = vsplat(0), one = vsplat(1), t;
	// direction of motion: by the velocity, or from rest by the acceleration, or by its rate
	vd way = vselect(vequal(v[0], zero), vselect(vequal(v[1], zero), v[2], v[1]), v[0]);
	vd sign = vselect(vless(way, zero), one, -one);
	const struct guard reversals = guard_of(&velocity, &c, zero, sign);
	vm once = root_quick(&reversals, s->order, one, inside, &t);
	vd peak = power_at(&m->u, s->order, t), behind = one - t, behind2 = behind * behind;
	struct enclosure after = {peak, zero, m->end.u, m->end.v * behind, m->fourth_max * (behind2 * behind2)};
	vd most = vmax(vmax(vabs(peak), vabs(m->end.u)), g->top[i]);
	once &= ~(may_cross(&after, most, one) | may_cross(&after, -most, -one));
	g->top[i] = vselect(once & vless(t, search->time), vmax(g->top[i], vabs(peak)), g->top[i]);
	inside &= ~once;
	if (!vany(inside))
		return;
	struct power guard;
	for (int n = 0; n <= s->order; n++)
		guard.c[n] = sign * v[n];
	search_safe(&guard, s->order, inside, vsplat(EVENT_BODY + EVENT_EDGES * i + POUND_EDGE_REVERSAL), search);
}

/* Searches for the end of contact, or of the remaining overlap, if the contact cannot pull.
 *
 * Contact ends when its force p + C/K p' falls through 0 while still p > 0.  The bodies are then released: contact resumes
 * when this force rises through 0 again, and the bodies are clear when p has fallen to 0.
 */
LANE_SHARED void force_search(const struct series *s, const struct lanes *g, const struct event_lanes *e,
                              vm by_force, struct search *search)
{
	const struct motion *p = &s->overlap;
	vd sign = e->scope.touching ? vsplat(-1) : vsplat(1), phase_lead = g->release / g->dt;
	struct power guard, rate;
	motion_velocity(&rate, p, s->order);
	for (int n = 0; n <= s->order; n++)
		guard.c[n] = sign * vfma(phase_lead, rate.c[n], p->u.c[n]);
	// a force that has just passed 0 is taken as beyond it by the rounding error of its terms; otherwise
	// identical bodies would open and close contact at one instant endlessly
	vd acceleration = 2.0 * (vabs(s->body[0].u.c[2]) + vabs(s->body[1].u.c[2]));
	vd below = vmin(guard.c[0], -DBL_EPSILON * vfma(phase_lead, acceleration, p->u.c[0]));
	guard.c[0] = vselect(e->fresh, below, guard.c[0]);
	search_safe(&guard, s->order, by_force, vsplat(EVENT_CONTACT), search);
	if (e->scope.touching)
		return;
	for (int n = 0; n <= s->order; n++)
		guard.c[n] = -p->u.c[n];
	search_safe(&guard, s->order, by_force, vsplat(EVENT_CLEARS), search);
}

/* Searches for the beginning or end of a contact: the overlap p rises or falls through 0. */
LANE_INLINE void contact_search(const struct series *s, const struct lanes *g, const struct event_lanes *e,
                                struct search *search)
{
	vd zero = vsplat(0), sign = e->scope.touching ? vsplat(-1) : vsplat(1);
	vm by_force = vmask(0);
	if (e->scope.forced)
		by_force = (e->scope.touching ? ~vequal(g->release, zero) : e->released) & e->active;
	struct enclosure c = enclosure_of(&s->overlap);
	vm risk = may_cross(&c, zero, sign) & e->active & ~by_force;
	if (vany(risk)) {
		struct guard guard = guard_of(&s->overlap.u, &c, zero, sign);
		search_crossing(&guard, s->order, risk, vsplat(EVENT_CONTACT), search);
	}
	if (vany(by_force))
		force_search(s, g, e, by_force, search);
}

/* Moves the ends of a step to its events. */
LANE_INLINE void series_cut(struct series *s, vm event, vd time, const struct scope *scope)
{
	struct motion *m[3] = {&s->body[0], &s->body[1], &s->overlap};
	for (int j = 0; j < (scope->paired ? 3 : 1); j++) {
		struct kinematics at = kinematics_at(&m[j]->u, s->order, time);
		m[j]->end.u = vselect(event, at.u, m[j]->end.u);
		m[j]->end.v = vselect(event, at.v, m[j]->end.v);
	}
}

/* Integral of the contact force over the step, per mass of the left body. */
LANE_INLINE vd impulse_of(const struct lanes *g, const struct series *s, vd time)
{
	struct power area; // of the overlap from 0 to t, over t
	ORDERS_UP(n, 0, ORDER_HIGH, area.c[n] = s->overlap.u.c[n] * vsplat(1.0 / (n + 1));)
	vd elapsed = time * g->dt;
	return vfma(g->contact_stiffness, power_at(&area, ORDER_HIGH, time) * elapsed,
	            g->contact_damping * (s->overlap.end.u - s->overlap.u.c[0]));
}

/* Number of bodies whose motion inside the step matters: always the left one. */
LANE_INLINE int bodies_watched(const struct event_lanes *e)
{
	return e->scope.paired && (e->scope.edged || e->scope.right) ? 2 : 1;
}

/* Computes the series of a step, and the fourth-derivative bounds of the watched motions.
 *
 * Given    level  lanes with level bodies; NULL: none
 */
LANE_INLINE void series_make(struct series *s, const struct lanes *g, int watched, const struct scope *scope,
                             const vm *level)
{
	struct motion *into[3] = {&s->body[0], &s->body[1], &s->overlap};
	struct terms t = terms_start(g, scope);
	const int order = scope->touching ? ORDER_HIGH : ORDER_LOW, motions = scope->paired ? 3 : 1;
	s->order = order;
	if (level) {
		t.level = *level;
		t.per_time = g->dt * g->dt;
		for (int i = 0; i < 2; i++)
			t.by_time[i] = (struct kinematics){g->u[i], g->v[i]};
	}
	ORDERS_UP(n, 0, order, terms_keep(&t, into, n, motions);
	          if (n < order) terms_next(&t, g, n, scope, level != NULL);)
	// no effect on results: makes gcc read the coefficients from memory, where it would otherwise keep them twice
	__asm__ volatile("" ::: "memory");
	for (int j = 0; j < motions; j++)
		motion_end(into[j], order);
	for (int i = 0; i < watched; i++)
		motion_bound(&s->body[i], order);
	if (scope->paired)
		motion_bound(&s->overlap, order);
}

LANE_SHARED void series_single(struct series *s, const struct lanes *g)
{
	series_make(s, g, 1, &(struct scope){.paired = false}, NULL);
}
LANE_SHARED void series_pair(struct series *s, const struct lanes *g, int watched)
{
	series_make(s, g, watched, &(struct scope){.paired = true}, NULL);
}
LANE_SHARED void series_contact(struct series *s, const struct lanes *g, int watched)
{
	series_make(s, g, watched, &(struct scope){.paired = true, .touching = true}, NULL);
}
LANE_SHARED void series_level(struct series *s, const struct lanes *g, int watched, struct scope scope,
                              vm level)
{
	if (scope.touching)
		series_make(s, g, watched, &(struct scope){.paired = true, .touching = true}, &level);
	else
		series_make(s, g, watched, &(struct scope){.paired = true}, &level);
}

LANE_INLINE void step_begin(struct series *s, const struct lanes *g, const struct event_lanes *e)
{
	int watched = bodies_watched(e);
	vm level = e->scope.paired ? bodies_level(g) & e->active : vmask(0);
	if (!e->scope.paired)
		series_single(s, g);
	else if (vany(level))
		series_level(s, g, watched, e->scope, level);
	else if (e->scope.touching)
		series_contact(s, g, watched);
	else
		series_pair(s, g, watched);
	s->order = e->scope.touching ? ORDER_HIGH : ORDER_LOW; // tells the compiler the value
}

/* Moves lanes to the end of a step, or to the fraction `time` of it. */
LANE_INLINE void step_end(struct lanes *g, const struct series *s, const struct event_lanes *e, vd time,
                          vm arrived)
{
	vd per_dt = vsplat(1) / g->dt, elapsed = time * g->dt;
	if (e->scope.touching) {
		g->impulse = vselect(arrived, g->impulse + impulse_of(g, s, time), g->impulse);
		g->contact_time = vselect(arrived, g->contact_time + elapsed, g->contact_time);
	}
	for (int i = 0; i < (e->scope.paired ? 2 : 1); i++) {
		g->u[i] = vselect(arrived, s->body[i].end.u, g->u[i]);
		g->v[i] = vselect(arrived, s->body[i].end.v * per_dt, g->v[i]);
		g->top[i] = vmax(g->top[i], vabs(g->u[i]));
	}
	if (e->scope.paired) {
		g->p = vselect(arrived, s->overlap.end.u, g->p);
		g->q = vselect(arrived, s->overlap.end.v * per_dt, g->q);
	}
	g->ground = vselect(arrived, vfma(g->slope, elapsed, g->ground), g->ground);
	g->remainder = vselect(arrived, vmax(g->remainder - elapsed, vsplat(0)), g->remainder);
}

/* One step: every lane advances to its next event, or by the planned step.
 *
 * Given    accounted  the energy balance is requested for some lane
 * Returns  value      the events;  e: decided;  g: state at the end of the step, dt: its actual length
 */
LANE_INLINE vd event_step(struct lanes *g, struct event_lanes *e, bool accounted)
{
	vd one = vsplat(1), zero = vsplat(0);
	struct series s;
	step_begin(&s, g, e);
	struct search search = {.time = one, .event = zero};
	if (e->scope.paired)
		contact_search(&s, g, e, &search);
	if (e->scope.edged) {
		struct search before = search;
		for (int i = 0; i < (e->scope.paired ? 2 : 1); i++)
			body_search(&s, g, i, e->active, &search);
		e->decided = ~vequal(search.time, before.time) | ~vequal(search.event, before.event);
	}
	for (int i = 0; i < bodies_watched(e); i++) {
		// the end of the step is ignored if an event cuts the step before it
		vd end = vselect(vless(search.time, one), zero, vabs(s.body[i].end.u));
		vm inside = vless(vmax(g->top[i], end), reach_of(&s.body[i])) & e->active;
		// a branch with a direction ends where the velocity reverses: before the event found, |u| is largest at an end
		if (e->scope.edged)
			inside &= vequal(g->body[i].direction, zero);
		if (vany(inside))
			body_top(&s, g, i, inside, &search);
	}
	vm event = ~vequal(search.event, zero);
	if (vany(event))
		series_cut(&s, event, search.time, &e->scope);
	if (accounted)
		energy_add(g, &s, search.time, e->scope);
	// in a step of zero length nothing may change, not even by rounding
	vm moved = vless(zero, search.time);
	step_end(g, &s, e, search.time, moved);
	g->dt = search.time * g->dt;
	// the velocity at a reversal is exactly 0, except in a step of zero length: the reversal was before it
	for (int i = 0; i < (e->scope.paired ? 2 : 1); i++) {
		vd reversal = vsplat(EVENT_BODY + EVENT_EDGES * i + POUND_EDGE_REVERSAL);
		g->v[i] = vselect(vequal(search.event, reversal) & moved, zero, g->v[i]);
	}
	vm cut = vequal(search.event, vsplat(EVENT_CUT));
	g->pace = vselect(cut, vmax(g->pace * vsplat(POUND_STEP_SHORTER), vsplat(POUND_STEP_SHORTEST)),
	                  vmin(g->pace * vsplat(POUND_STEP_LONGER), one));
	return search.event;
}

/* Updates the state at the beginning or end of a contact, or of the overlap that it left.
 *
 * Given    event  of the step
 * Returns  e      released and fresh
 *          value  lanes in which a contact began or ended
 */
LANE_INLINE vm event_follow(struct lanes *g, struct event_lanes *e, vd event)
{
	vd zero = vsplat(0);
	vm changes = vequal(event, vsplat(EVENT_CONTACT)) & e->active, released = e->released;
	if (e->scope.touching) {
		released = e->scope.forced ? changes & vless(zero, g->release) & vless(zero, g->p) : vmask(0);
		g->remainder = vselect(changes, vfma(g->substeps, g->substep, g->remainder), g->remainder);
		g->substeps = vselect(changes, zero, g->substeps);
	} else {
		vd substeps = vfloor(g->remainder / g->substep);
		g->remainder = vselect(changes, vmax(g->remainder - substeps * g->substep, zero), g->remainder);
		g->substeps = vselect(changes, substeps, g->substeps);
		g->impulse = vselect(changes, zero, g->impulse);
	}
	g->p = vselect(changes & ~released, zero, g->p); // from here exactly
	e->fresh = released & changes;
	if (e->scope.forced && !e->scope.touching) {
		vm clears = vequal(event, vsplat(EVENT_CLEARS));
		g->p = vselect(clears, zero, g->p);
		released &= ~clears & ~changes;
	}
	e->released = released;
	return changes;
}

/* Lanes in which a body may have a new largest displacement inside a step. */
LANE_INLINE vm peak_risk(const struct series *s, const struct lanes *g, int i)
{
	vd one = vsplat(1);
	struct enclosure c = enclosure_of(&s->body[i]);
	vd top = vmax(g->top[i], vabs(c.u1));
	return may_cross(&c, top, one) | may_cross(&c, -top, -one);
}

/* Lanes in which a body may reach an edge of its branch. */
LANE_INLINE vm edge_risk(const struct series *s, const struct lanes *g, int i)
{
	vd zero = vsplat(0), one = vsplat(1);
	struct enclosure c = enclosure_of(&s->body[i]);
	vm risk = may_cross(&c, g->body[i].high, one) | may_cross(&c, g->body[i].low, -one);
	vm reversals = ~vequal(g->body[i].direction, zero);
	if (!vany(reversals))
		return risk;
	c = enclosure_of_velocity(&s->body[i], s->order);
	return risk | (reversals & may_cross(&c, zero, -g->body[i].direction));
}

/* Finishes the remainder of an interval or substep in one step, in the lanes where no event can occur in it.
 *
 * Returns  e  decided
 */
LANE_INLINE void event_finish(struct lanes *g, struct event_lanes *e, vm finishing)
{
	vd one = vsplat(1), zero = vsplat(0);
	finishing &= ~e->released & ~e->fresh & vequal(g->pace, one) & vless(zero, g->remainder);
	if (!e->scope.touching)
		finishing &= ~vless(g->reach, g->remainder);
	if (!vany(finishing))
		return;
	g->dt = vselect(finishing, g->remainder, g->dt);
	struct series s;
	step_begin(&s, g, e);
	vm risk = vmask(0);
	if (e->scope.paired) {
		struct enclosure c = enclosure_of(&s.overlap);
		risk = may_cross(&c, zero, e->scope.touching ? -one : one);
		// while the overlap grows, the force does not fall to zero
		if (e->scope.touching && e->scope.forced)
			risk |= ~vless(zero, enclosure_slowest(&c)) & vless(zero, g->release);
	}
	for (int i = 0; i < bodies_watched(e); i++)
		risk |= peak_risk(&s, g, i);
	if (e->scope.edged) {
		vm edge = vmask(0);
		for (int i = 0; i < (e->scope.paired ? 2 : 1); i++)
			edge |= edge_risk(&s, g, i);
		risk |= edge;
		e->decided |= finishing & edge;
	}
	step_end(g, &s, e, one, finishing & ~risk);
}
