/* chain_step.inl - one step of a chain up to an event, and what follows it.
 *
 * Included by chain.inl alone, once per lane count, after chain_energy.inl. */

/* Longest step while some links touch; stiffnesses of contacts on one floor add up.
 *
 *   rate of the contacts^2 <= the largest sum over a link's floors of |w|/m times the sum over these floors' links of |w| K
 */
static double reach_touching(struct chain *c)
{
	double spring = 0, dash = 0, load[2][LONG];
	for (int s = 0; s < 2; s++)
		memset(load[s], 0, sizeof(double) * (size_t)c->wide);
	for (int o = 0; o < c->touching.n; o++) {
		const struct link *l = &c->link[c->touching.link[o]];
		for (int k = 0; k < l->n_ends; k++) {
			const int i = l->floor[k];
			const double share = fabs(l->weight[k]) * c->inverse_mass.at[i];
			load[0][i] = fma(share, l->at.on.stiffness, load[0][i]);
			load[1][i] = fma(share, l->at.on.damping, load[1][i]);
		}
	}
	for (int o = 0; o < c->touching.n; o++) {
		const struct link *l = &c->link[c->touching.link[o]];
		double sum[2] = {0, 0};
		for (int k = 0; k < l->n_ends; k++)
			for (int s = 0; s < 2; s++)
				sum[s] = fma(fabs(l->weight[k]), load[s][l->floor[k]], sum[s]);
		spring = larger(spring, sum[0]);
		dash = larger(dash, sum[1]);
	}
	const double rate =
	    rate_of(sqrt(c->rate_separated * c->rate_separated + spring), c->damping_separated + dash);
	return rate > 0 ? POUND_TERMS_REACH[ORDER_HIGH] / rate : DBL_MAX;
}

/* Sets the current interval to the one that ends at a sample. */
static void interval_set(struct chain *c, int64_t next)
{
	const double *a = &c->task->ground[next];
	c->ground = a[-1];
	c->slope = (a[0] - a[-1]) * (1 / c->task->time_step);
	c->remainder = c->task->time_step;
}

/* Chooses the length and order of the next step. */
static void step_choose(struct chain *c)
{
	if (c->reach == 0)
		c->reach = reach_touching(c);
	const double reach = c->reach * c->pace;
	c->dt = c->remainder <= reach ? c->remainder : c->remainder > 2 * reach ? reach : 0.5 * c->remainder;
	bool level = false;
	for (int k = 0; k < c->own.n; k++)
		level |= link_level(c, &c->link[c->own.link[k]]);
	// with a power of two as step length, scaled derivatives round equally with and without contact
	if (level)
		c->dt = ldexp(1, ilogb(c->dt));
	c->order = c->dt * POUND_TERMS_REACH[ORDER_HIGH] <= c->reach * POUND_TERMS_REACH[ORDER_LOW] ? ORDER_LOW
	                                                                                            : ORDER_HIGH;
}

/* ---- contacts ---- */

/* Magnitudes of the terms of a side's motion, for the rounding error of its velocity. */
static struct pound_counts_body side_of(const struct chain *c, const struct link *l, int side)
{
	struct pound_counts_body b = {.ground = c->ground};
	double damping = DBL_MAX;
	for (int k = 0; k < l->n_ends; k++) {
		const int i = l->floor[k];
		const double weight = fabs(l->weight[k]), m = c->inverse_mass.at[i];
		if ((l->weight[k] < 0) != side)
			continue;
		b.v = fma(weight, c->w.at[i], b.v);
		b.offset += weight * m * fabs(fma(c->stiffness.at[i], c->d.at[i], c->offset.at[i]));
		if (c->inverse_above.at[i] > 0)
			b.offset += weight * m * fabs(fma(c->stiffness.at[i + 1], c->d.at[i + 1], c->offset.at[i + 1]));
		damping = smaller(damping, c->mass_damping.at[i] + c->dashpot.at[i] * m);
	}
	b.damping = damping == DBL_MAX ? 0 : damping;
	return b;
}

/* Records a contact that has ended, or is still open at the end of the signal. */
static void contact_over(struct chain *c, struct link *l)
{
	double *m = l->measures;
	const double changed = l->inverse_mass * l->impulse + fabs(l->q), h = c->task->time_step;
	m[POUND_LINK_IMPULSE_MAX] = larger(m[POUND_LINK_IMPULSE_MAX], l->impulse);
	chain_displacements(c);
	const struct pound_counts counts = {.body = {side_of(c, l, 0), side_of(c, l, 1)},
	                                    .time = (double)c->next * h,
	                                    .steps = (l->time - l->counted_time) / h,
	                                    .changed = changed};
	if (pound_contact_counts(&counts, &l->scale)) {
		m[POUND_LINK_CONTACTS]++;
		l->counted_time = l->time;
		contact_record(c, l, chain_time(c), l->impulse);
	} else {
		l->time = l->counted_time;
	}
}

static void contact_begins(struct chain *c, struct link *l)
{
	double *m = l->measures;
	if (link_rigid(l)) {
		impact(c, l, chain_time(c));
		return;
	}
	if (!l->released) {
		l->p = 0; // from here exactly
		pound_contact_begin(&l->link->law, &l->at, l->q);
	}
	if (!l->released)
		m[POUND_LINK_SPEED_MAX] = fmax(m[POUND_LINK_SPEED_MAX], l->q);
	l->touching = l->own = true;
	l->released = l->fresh = false;
	l->impulse = 0;
	l->begin = chain_time(c);
	l->speed = l->q;
	if (m[POUND_LINK_CONTACTS] == 0) {
		m[POUND_LINK_FIRST_TIME] = l->begin;
		m[POUND_LINK_FIRST_SPEED] = l->q;
	}
	c->reach = 0;
}

static void contact_ends(struct chain *c, struct link *l)
{
	if (l->held) {
		l->measures[POUND_LINK_IMPULSE_MAX] = larger(l->measures[POUND_LINK_IMPULSE_MAX], l->impulse);
		held_end(l);
		c->reach = 0;
		return;
	}
	l->touching = false;
	l->released = l->fresh = link_forced(l) && l->p > 0;
	if (!l->released)
		l->p = 0;
	contact_over(c, l);
	c->reach = 0;
}

/* Moves a contact at an edge of its branch to the next branch, or ends it. */
static void link_leave(struct chain *c, struct link *l, enum pound_edge edge)
{
	if (edge == POUND_EDGE_LOW && l->at.on.low == 0) {
		contact_ends(c, l);
		return;
	}
	if (edge == POUND_EDGE_REVERSAL)
		l->q = 0;
	else
		l->p = edge == POUND_EDGE_HIGH ? l->at.on.high : l->at.on.low;
	pound_contact_leave(&l->link->law, &l->at, edge, l->p);
	c->reach = 0;
}

/* Moves a story's law to its next branch; the drift is set exactly to the edge. */
static void story_leave(struct chain *c, int i, enum pound_edge edge, bool moved)
{
	if (edge == POUND_EDGE_REVERSAL) {
		if (moved)
			c->v.at[i] = 0;
	} else {
		c->d.at[i] = edge == POUND_EDGE_HIGH ? c->high.at[i] : c->low.at[i];
	}
	pound_law_leave(&c->task->floors[i].story, &c->laws[i], edge, c->d.at[i]);
	story_branch_enter(c, i);
}

/* ---- the step ---- */

/* Value and rate of a vector of floors at a fraction of the step: kinematics_at (series.inl) on series in memory. */
LANE_INLINE struct kinematics column_kinematics(const struct column series[TERMS], int order, int i, vd t)
{
	const vd t2 = t * t;
	vd even_rate = column_load(&series[order - 1], i), odd_rate = column_load(&series[order], i);
	vd even = vfma(even_rate, t2, column_load(&series[order - 3], i));
	vd odd = vfma(odd_rate, t2, column_load(&series[order - 2], i));
	for (int n = order - 4; n > 0; n -= 2) {
		even_rate = vfma(even_rate, t2, even), odd_rate = vfma(odd_rate, t2, odd);
		even = vfma(even, t2, column_load(&series[n - 1], i));
		odd = vfma(odd, t2, column_load(&series[n], i));
	}
	return (struct kinematics){vfma(odd, t, even), vfma(2.0 * t, vfma(odd_rate, t, even_rate), odd)};
}

/* overlaps at a fraction of the step, their rates, and their means up to there; rates by the fraction of the step */
struct overlaps_at {
	struct column p, rate, area;
};

/* Overlaps of the integrated links at a fraction of the step. */
LANE_INLINE void overlaps_place(const struct chain *c, double time, struct overlaps_at *at)
{
	const vd t = vsplat(time);
	for (int k = 0, next = 0; k < c->own.n; k++) {
		const int j = c->own.link[k] / W * W;
		if (j < next)
			continue;
		next = j + W;
		vd p = lanes_load(&c->overlaps[c->order][j]), rate = vsplat(0),
		   area = p * vsplat(POUND_SHARE[c->order]);
		for (int n = c->order - 1; n >= 0; n--) {
			const vd x = lanes_load(&c->overlaps[n][j]);
			rate = vfma(rate, t, p);
			p = vfma(p, t, x);
			area = vfma(area, t, x * vsplat(POUND_SHARE[n]));
		}
		column_store(&at->p, j, p);
		column_store(&at->rate, j, rate);
		column_store(&at->area, j, area);
	}
}

/* Moves floors and links to a fraction of the step. */
static void step_arrive(struct chain *c, double time)
{
	const vd per_dt = vsplat(1 / c->dt);
	const bool whole = time == 1;
	for (int i = 0; i < c->wide; i += W) {
		struct kinematics at = {column_load(&c->drift.u1, i), column_load(&c->drift.v1, i)};
		if (!whole)
			at = column_kinematics(c->drifts, c->order, i, vsplat(time));
		column_store(&c->d, i, at.u);
		column_store(&c->v, i, at.v * per_dt);
	}
	const double elapsed = time * c->dt;
	struct overlaps_at at;
	overlaps_place(c, time, &at);
	for (int o = 0; o < c->own.n; o++) {
		const int j = c->own.link[o];
		struct link *l = &c->link[j];
		if (l->held) {
			double sum = 0;
			for (int n = c->order - 2; n >= 0; n--)
				sum = fma(sum, time, c->overlaps[n][j] * POUND_SHARE[n]);
			l->impulse += sum * elapsed / (c->dt * c->dt);
			l->time += elapsed;
			l->p = l->q = 0;
			continue;
		}
		const double p = whole ? c->overlap.u1.at[j] : at.p.at[j];
		l->q = (whole ? c->overlap.v1.at[j] : at.rate.at[j]) / c->dt;
		if (l->touching) {
			const double spring = fma(l->at.on.stiffness, at.area.at[j], l->at.on.offset) * elapsed;
			l->impulse += fma(l->at.on.damping, p - l->p, spring);
			l->time += elapsed;
		}
		l->p = p;
		l->fresh = false;
	}
	c->ground = fma(c->slope, elapsed, c->ground);
	c->remainder = larger(c->remainder - elapsed, 0);
}

/* Updates the largest values up to a fraction of the step. */
static void step_tops(struct chain *c, double time)
{
	const unsigned asked = c->task->asked;
	if (asked & POUND_CHAIN_DRIFTS)
		tops_keep(c, c->drifts, &c->drift, &c->d, time, &c->top_drift);
	if (asked & POUND_CHAIN_DISPLACEMENTS) {
		chain_displacements(c);
		tops_keep(c, c->displacements, &c->displacement, &c->u, time, &c->top_displacement);
	}
	for (int j = 0; j < c->n_watched; j++)
		closing_keep(c, &c->link[j], time);
	if (asked & POUND_CHAIN_FORCES)
		for (int j = 0; j < c->n_links; j++)
			if (c->link[j].touching)
				force_keep(c, &c->link[j], j, time);
}

static void event_apply(struct chain *c, const struct first *first)
{
	const int i = first->index;
	const bool moved = first->time > 0;
	if (first->event >= EVENT_STORY)
		story_leave(c, i, (enum pound_edge)(first->event - EVENT_STORY), moved);
	else if (first->event >= EVENT_LINK)
		link_leave(c, &c->link[i], (enum pound_edge)(first->event - EVENT_LINK));
	else if (first->event == EVENT_BEGINS)
		contact_begins(c, &c->link[i]);
	else if (first->event == EVENT_ENDS)
		contact_ends(c, &c->link[i]);
	else if (first->event == EVENT_CLEARS) {
		c->link[i].p = 0;
		c->link[i].released = false;
	}
}

/* Initializes the overlap of a link that begins to be integrated, from its floors. */
static void overlap_enter(struct chain *c, const struct first *first)
{
	if (first->event != EVENT_BEGINS || c->link[first->index].own)
		return;
	struct link *l = &c->link[first->index];
	l->p = 0;
	l->q = link_sum(l, c->w.at);
}

/* One step: to the next event, or by the planned length. */
static void chain_step(struct chain *c)
{
	if (c->moving)
		chain_displacements(c);
	c->curved_step.on = chain_curved(c);
	links_list(c);
	if (c->curved_step.on) {
		nonlinear_series(c);
	} else {
		step_choose(c);
		series_chain(c);
	}
	const struct first first = c->curved_step.on ? nonlinear_events(c) : events_search(c);
	if (first.time > 0) {
		if (c->task->observer)
			pieces_report(c, first.time);
		if (c->task->asked & POUND_CHAIN_ENERGY)
			energy_keep(c, first.time);
		if (c->task->asked & POUND_CHAIN_ACCELERATIONS)
			accelerations_keep(c, first.time);
		if (c->curved_step.on)
			nonlinear_arrive(c, first.time);
		else
			step_arrive(c, first.time);
		step_tops(c, first.time);
	}
	if (first.event != EVENT_NONE && first.event < EVENT_STORY && c->moving)
		chain_displacements(c);
	overlap_enter(c, &first);
	event_apply(c, &first);
	c->after_event |= first.event > EVENT_CUT;
	c->pace = first.event == EVENT_CUT ? larger(c->pace * POUND_STEP_SHORTER, POUND_STEP_SHORTEST)
	                                   : smaller(c->pace * POUND_STEP_LONGER, 1);
}
