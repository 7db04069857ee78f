/* chain_peaks.inl - largest values inside a step: of drifts, displacements, accelerations and contact forces.
 *
 * If the bound of a quantity exceeds its largest value so far, the roots of its rate are found one after the other: with several
 * modes it can reverse several times in a step.
 *
 * Included by chain.inl alone, once per lane count, after chain_events.inl. */

enum {
	REVERSALS = 16, /* most reversals searched per step */
	LEADING =
	    4, /* most leading zeros of a rate's series: there are three where a contact begins in nonlinear_contact.inl */
};

/* Bound of |u| inside a step, its ends excluded. */
LANE_INLINE vd enclosure_reach(const struct enclosure *c)
{
	const vd third = vsplat(1.0 / 3), b1 = vfma(third, c->v0, c->u0), b2 = vfma(-third, c->v1, c->u1);
	return vfma(vsplat(POUND_CUBIC_ERROR), c->fourth_max, vmax(vabs(b1), vabs(b2)));
}

/* Shifts the origin of a series to time t. */
static void power_shift(struct power *x, int order, vd t)
{
	for (int i = 0; i < order; i++)
		for (int n = order - 1; n >= i; n--)
			x->c[n] = vfma(t, x->c[n + 1], x->c[n]);
}

/* Largest magnitude inside a step.
 *
 * Given    x       series; overwritten
 *          end     fraction of the step at which it ended
 *          top     the largest value so far, including both ends
 *          mirror  -1: magnitudes; 0: only values above 0
 *          lanes   lanes to search
 */
LANE_SHARED vd top_follow(struct power *x, int order, vd end, vd top, vd mirror, vm lanes)
{
	const vd zero = vsplat(0), one = vsplat(1);
	struct motion rate;
	for (int reversal = 0; reversal < REVERSALS; reversal++) {
		struct motion m = {.u = *x};
		motion_velocity(&rate.u, &m, order);
		const vd *v = rate.u.c;
		const struct enclosure enclosure = enclosure_make(&rate.u, order);
		vd way = v[LEADING];
		for (int n = LEADING - 1; n >= 0; n--)
			way = vselect(vequal(v[n], zero), way, v[n]);
		const vd sign = vselect(vless(way, zero), one, -one);
		struct search search = {.time = vmin(end, one), .event = vsplat(EVENT_NONE)};
		struct guard reversals = guard_of(&rate.u, &enclosure, zero, sign);
		search_crossing(&reversals, order, lanes, vsplat(EVENT_STORY), &search);
		lanes &= ~vequal(search.event, vsplat(EVENT_NONE));
		if (!vany(lanes))
			break;
		const vd t = search.time;
		const vd value = power_at(x, order, t);
		top = vselect(lanes, vmax(top, vmax(value, mirror * value)), top);
		power_shift(x, order, t);
		x->c[1] = vselect(vequal(search.event, vsplat(EVENT_STORY)), zero, x->c[1]);
		end = end - t;
		const struct enclosure rest = enclosure_make(x, order);
		lanes &= vless(zero, end) & vless(top, enclosure_reach(&rest));
		if (!vany(lanes))
			break;
	}
	return top;
}

/* Updates the largest values of a column of series, for a step that ended at a fraction of its length. */
LANE_INLINE void tops_keep(const struct chain *c, const struct column series[TERMS],
                           const struct enclosures *enclosures, const struct column *end, double time,
                           struct column *tops)
{
	for (int i = 0; i < c->wide; i += W) {
		const struct enclosure enclosure = enclosure_load(enclosures, i);
		const vd top = vmax(column_load(tops, i), vabs(column_load(end, i)));
		const vm inside = vless(top, enclosure_reach(&enclosure));
		if (!vany(inside)) {
			column_store(tops, i, top);
			continue;
		}
		struct power x;
		power_load(&x, c->order, series, i);
		column_store(tops, i, top_follow(&x, c->order, vsplat(time), top, vsplat(-1), inside));
	}
}

/* Updates the largest accelerations of a vector of floors. */
static void acceleration_follow(struct chain *c, struct power *x, int i, double time)
{
	const vd there = power_at(x, c->order, vsplat(time));
	vd top = vmax(column_load(&c->top_acceleration, i), vmax(vabs(x->c[0]), vabs(there)));
	const struct enclosure enclosure = enclosure_make(x, c->order);
	const vm inside = vless(top, enclosure_reach(&enclosure));
	if (vany(inside))
		top = top_follow(x, c->order, vsplat(time), top, vsplat(-1), inside);
	column_store(&c->top_acceleration, i, top);
}

LANE_INLINE void acceleration_top(struct chain *c, const struct column series[TERMS], int i, double time)
{
	struct power x;
	power_load(&x, c->order, series, i);
	acceleration_follow(c, &x, i, time);
}

/* Largest absolute accelerations in a step, on both sides of its ends. */
static void accelerations_keep(struct chain *c, double time)
{
	const double h = c->dt, rise = c->slope * h;
	if (c->curved_step.on) {
		curved_floor_accelerations(c);
		for (int i = 0; i < c->wide; i += W)
			acceleration_top(c, c->curved_step.accelerations, i, time);
		return;
	}
	const vd per_h2 = vsplat(1 / (h * h)), zero = vsplat(0);
	for (int i = 0; i < c->wide; i += W) {
		struct power x;
		for (int n = 0; n <= ORDER_HIGH; n++)
			x.c[n] = n + 2 > c->order
			             ? zero
			             : vsplat((n + 1.0) * (n + 2.0)) * per_h2 * column_load(&c->displacements[n + 2], i);
		x.c[0] = x.c[0] + vsplat(c->ground);
		x.c[1] = x.c[1] + vsplat(rise);
		acceleration_follow(c, &x, i, time);
	}
}

/* Updates the largest compressive force of a contact. */
static void force_keep(struct chain *c, struct link *l, int j, double time)
{
	const double k = l->at.on.stiffness, damping = l->at.on.damping / c->dt;
	struct power x = {0};
	for (int n = 0; n <= c->order; n++) {
		if (c->curved_step.on || l->held) {
			x.c[n] = vsplat(!l->held            ? curve_force(c, j, n)
			                : n + 2 <= c->order ? c->overlaps[n][j] / (c->dt * c->dt)
			                                    : 0);
			continue;
		}
		const double next = n < c->order ? c->overlaps[n + 1][j] : 0;
		x.c[n] = vsplat(fma(k, c->overlaps[n][j], damping * (n + 1) * next) + (n == 0 ? l->at.on.offset : 0));
	}
	double *most = &l->measures[POUND_LINK_FORCE_MAX], value[W];
	const struct enclosure enclosure = enclosure_make(&x, c->order);
	lanes_store(value, power_at(&x, c->order, vsplat(time)));
	vd top = vsplat(fmax(*most, fmax(value[0], ((const double *)&x.c[0])[0])));
	const vm inside = vless(top, enclosure_reach(&enclosure)) & vmask(1);
	if (vany(inside))
		top = top_follow(&x, c->order, vsplat(time), top, vsplat(0), inside);
	lanes_store(value, top);
	*most = value[0];
}

/* Largest weighted sum of displacements over the ends of a link in a step.
 *
 * Given    l        a link, or one side of it
 *          mirror   -1: magnitudes; 0: only values above 0
 *          most     the largest so far; updated
 */
static void ends_keep(const struct chain *c, const struct link *l, double mirror, double time, double *most)
{
	const struct enclosures *x = &c->displacement;
	const double there = link_sum(l, c->u.at);
	double fourth_max = 0, value[W];
	for (int k = 0; k < l->n_ends; k++)
		fourth_max = fma(fabs(l->weight[k]), x->fourth_max.at[l->floor[k]], fourth_max);
	const struct enclosure enclosure = {vsplat(link_sum(l, x->u0.at)), vsplat(link_sum(l, x->v0.at)),
	                                    vsplat(link_sum(l, x->u1.at)), vsplat(link_sum(l, x->v1.at)),
	                                    vsplat(fourth_max)};
	*most = fmax(*most, fmax(there, mirror * there));
	const vm inside = vless(vsplat(*most), enclosure_reach(&enclosure)) & vmask(1);
	if (!vany(inside))
		return;
	struct power series = {0};
	for (int n = 0; n <= c->order; n++)
		series.c[n] = vsplat(link_sum(l, c->displacements[n].at));
	lanes_store(value, top_follow(&series, c->order, vsplat(time), vsplat(*most), vsplat(mirror), inside));
	*most = value[0];
}

/* Updates the largest closing displacement, and the largest displacements of both sides, of a link without force. */
static void closing_keep(const struct chain *c, const struct link *l, double time)
{
	struct link side[2] = {{.n_ends = 0}, {.n_ends = 0}};
	for (int k = 0; k < l->n_ends; k++) {
		struct link *of = &side[l->weight[k] < 0];
		of->floor[of->n_ends] = l->floor[k];
		of->weight[of->n_ends++] = l->weight[k];
	}
	ends_keep(c, l, 0, time, &l->measures[POUND_LINK_CLOSING_MAX]);
	for (int k = 0; k < 2; k++)
		ends_keep(c, &side[k], -1, time, &l->measures[POUND_LINK_LEFT_MAX + k]);
}
