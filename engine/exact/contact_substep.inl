/* contact_substep.inl - whole substeps of contact by precomputed exact maps; many at once in sustained contact.
 *
 * The cubic through both ends, widened by its error bound, proves that no event lies between: no release, no edge of a law,
 * no new largest displacement.  A lane without this proof stops before the substep.
 *
 * Included by exact.inl after free_motion.inl, whose cubics and edges it uses. */

/* state in contact: base u, v, overlap p, q; largest displacements of the base and the other body; rounds: maps
 * until another one is chosen; left: samples after the interval */
struct contact_state {
	vd x[4], top[2], impulse, ground, rise, substeps, rounds, left;
};

/* a linear form of the state, the ground motion, its growth over the map, and 1 */
struct linear_form {
	vd x[4], ground, rise, force;
};

/* the base body and the overlap in lanes, and their maps */
struct contact_lanes {
	struct contact_state at;
	struct edges base, other; /* where a lane has a law of more than one branch */
	struct linear_form moved[CONTACT_IMPULSE + 1];
	struct linear_form error;                           /* substep: error bound, a form of magnitudes */
	vm alike;                                           /* lanes with TRAIT_ALIKE */
	vd doubled[CONTACT_MAP_ROWS][POUND_CONTACT_INPUTS]; /* doubled map: its bounds and CONTACT_SPLIT */
};

/* Converts a row of a map to a form of the state and the ground motion.
 *
 * Given    magnitudes  the row applies to magnitudes of the inputs
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

/* Displacement of the other body, from the base, gap and overlap.
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

/* Lanes of identical bodies with zero overlap and rate: they move together without contact force.
 *
 * Given    p, q  overlap and its rate
 */
LANE_INLINE vm contact_still(const struct contact_lanes *s, vd p, vd q)
{
	return s->alike & vequal(p, vsplat(0)) & vequal(q, vsplat(0));
}

/* The overlap of identical bodies: without closing acceleration it decays, and is set to zero once negligible.
 *
 * Given    bound  magnitudes of the state;  error  of both cubics
 * Returns  end    0 where negligible;  value  error of the overlap's cubic: for identical bodies from its own columns only
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
 * Given    going   lanes to advance
 * Returns  s       the lanes in which no event is possible, at the end of the substep
 *          edge    lanes in which an edge of a branch may be reached
 *          value   lanes in which any event is possible inside the substep
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
		// only for lanes whose contact ends at zero force
		risk |= ~vless(zero, force) & vless(zero, g->release);
	}
	if (scope->seldom)
		risk &= ~contact_still(s, end[2], end[3]);
	vd side = g->side, off = side * g->gap, v = x[1] - side * x[3];
	struct cubic o = {.u = other_body(b.u, p.u, side, off),
	                  .v = b.v - side * p.v,
	                  .b1 = other_body(b.b1, p.b1, side, off),
	                  .b2 = other_body(b.b2, p.b2, side, off)};
	// its rounding comes from base, overlap and gap
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

/* Rounding allowance of a doubled map's bounds over a body's displacement: for a body at rest they amount to a few dozen eps.  Smaller
 * motions are ignored. */
static const double SUSTAINED_ROUNDING = 64 * DBL_EPSILON;

/* Lanes in which a body's velocity keeps its sign over many substeps, except for reversals by less than the rounding of its
 * displacement: under a load that grows from rest, the velocity reaches 0 once per contact oscillation, and rounding would decide.
 *
 * All rates are times a third of the doubled map.  Where the oscillation's rate exceeds the slow rate by a small share of itself, it does
 * so for 2 acos(1 - share) radians, for a share up to 1 at most pi share^1/2.
 *
 * Given    along   lower bound of the slow rate;  swing: upper bound of the oscillation's rate;  error: of both
 *          radian  time per radian of the oscillation, over a third of the doubled map
 *          where   magnitude of the body's displacement
 */
LANE_INLINE vm sustained_steady(vd along, vd swing, vd error, vd radian, vd where)
{
	vd zero = vsplat(0), ahead = (swing + error) - along;
	vd back = ahead * vsqrt(ahead / swing) * (vsplat(3.15) * radian);
	return vless(ahead, zero) | (~vless(along, error) & vless(back, vsplat(SUSTAINED_ROUNDING) * where));
}

/* Lanes in which a body may have a new largest displacement over many substeps.
 *
 * Given    u, end     displacement at both ends
 *          low, high  bounds of the displacement in between, by the cubic of the slow motion
 *          steady     lanes of sustained_steady(): the displacement stays between its end values
 */
LANE_INLINE vm sustained_peaks(vd u, vd end, vd low, vd high, vm steady, vd top)
{
	vd most = vmax(vmax(vabs(u), vabs(end)), top);
	return vless(most, vfma(vsplat(-SUSTAINED_ROUNDING), most, vmax(high, -low))) & ~steady;
}

/* Lanes in which a body may reach an edge of its branch.
 *
 * A creeping body moves less than the rounding of its displacement: no velocity bound could prove its direction, so none is
 * required, and it may exceed the end of its branch by that rounding.  Its velocity at the start still counts: a body that
 * moves against its branch's direction must leave the branch now, however slow, or the motion would accumulate over many
 * doubled maps.
 *
 * Given    speed  the body's velocity at the start, times any positive factor
 */
LANE_INLINE vm sustained_edges(vd end, vd low, vd high, vd speed, vm steady, const struct edges *x)
{
	vd slack = vsplat(SUSTAINED_ROUNDING) * vabs(end), most = x->high + slack, least = x->low - slack;
	vm creeps = ~vless(2.0 * slack, high - low);
	vm inside = vless(most, high) | vless(low, least) | ~vequal(x->direction, vsplat(0));
	return (inside & ~steady & ~creeps) | vless(most, end) | vless(end, least) |
	       vless(x->direction * speed, vsplat(0));
}

/* Many substeps of contact, with any number of oscillations of the overlap, by a doubled map: see doubled_bounds in contact_map.inl.
 *
 * Given    going  lanes to advance
 * Returns  s      the lanes in which no event is possible, at the end of the map
 *          edge   lanes in which an edge of a branch may be reached
 *          value  lanes in which any event is possible meanwhile
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
	// hypotenuse, scaled against underflow, raised only by its rounding: in an undamped oscillation a coarser bound would always
	// exceed the largest displacement so far, and refuse every doubled map
	vd larger = vmax(vmax(a, c), vsplat(DBL_MIN)), lesser = vmin(a, c) / larger;
	vd swung = vsplat(1 + 4 * DBL_EPSILON) * larger * vsqrt(vfma(lesser, lesser, one));
	vd grown = vabs(change) + vabs(drift), curvature, swing;
	// first with the whole closing acceleration, then only its varying terms: see doubled_bounds in contact_map.inl
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
	// b2 - b1 from the map's increments: creeping bodies move less than the rounding of their displacements
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
		// rate of the slow motion, including the line that the overlap follows
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

/* Converts left and right body to base and other body, and back. */
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
