/* chain_events.inl - the first event of a step of a chain: contacts that begin or end, branches that end.
 *
 * Every guard is checked over the whole step, in lanes: links, then stories.  The first root is taken; of simultaneous ones,
 * contacts before stories, then the lowest index; the others follow in steps of zero length.
 *
 * Included by chain.inl alone, once per lane count, after chain_series.inl. */

/* what ends a step: of a link, or of a story EVENT_STORY + its edge */
enum {
	EVENT_BEGINS = EVENT_OWN,
	EVENT_ENDS,   /* a contact ends, by its force or its overlap */
	EVENT_CLEARS, /* the overlap left after the force ended is gone */
	EVENT_LINK,   /* + edge of the branch of its force */
	EVENT_STORY = EVENT_LINK + 3,
	EVENT_END = EVENT_STORY + 3,
};

/* the first event so far */
struct first {
	double time; /* fraction of the step  1: none */
	int event, index;
};

static void first_take(struct first *first, double time, int event, int index)
{
	const bool links = event < EVENT_STORY, were_links = first->event < EVENT_STORY;
	bool sooner = time < first->time;
	if (time == first->time && event != EVENT_CUT) {
		const bool lower = links == were_links
		                       ? index < first->index || (index == first->index && event < first->event)
		                       : links;
		sooner = first->event == EVENT_CUT || first->event == EVENT_NONE || lower;
	}
	if (sooner)
		*first = (struct first){time, event, index};
}

/* Merges the results of a search in some lanes.
 *
 * Given    index  of the story or link in each lane  (W)
 */
static void search_take(struct first *first, const struct search *search, vm lanes, const int *index)
{
	double time[W], event[W];
	lanes_store(time, search->time);
	lanes_store(event, search->event);
	for (unsigned some = vbits(lanes); some; some &= some - 1) {
		const int l = __builtin_ctz(some);
		if (event[l] != EVENT_NONE)
			first_take(first, time[l], (int)event[l], index[l]);
	}
}

/* Searches for the time at which a guard becomes positive, in some lanes of a vector. */
static void guard_search(struct first *first, const struct chain *c, struct guard guard, vm lanes, int event,
                         const int *index)
{
	struct search search = {.time = vsplat(1), .event = vsplat(EVENT_NONE)};
	search_crossing(&guard, c->order, lanes, vsplat(event), &search);
	search_take(first, &search, lanes, index);
}

/* Searches for the branch edges of a vector of stories. */
LANE_INLINE void stories_search(struct first *first, const struct chain *c, int i)
{
	const vd zero = vsplat(0), one = vsplat(1);
	struct enclosure enclosure = enclosure_load(&c->drift, i);
	const vd low = column_load(&c->low, i), high = column_load(&c->high, i);
	const vd direction = column_load(&c->direction, i);
	const vm past_high = may_cross(&enclosure, high, one), past_low = may_cross(&enclosure, low, -one);
	vm reversals = ~vequal(direction, zero);
	if (!vany(past_high | past_low | reversals))
		return;
	int index[W];
	for (int l = 0; l < W; l++)
		index[l] = i + l;
	struct motion m;
	motion_load(&m, c, c->drifts, &c->drift, i);
	if (vany(past_low))
		guard_search(first, c, guard_of(&m.u, &enclosure, low, -one), past_low, EVENT_STORY + POUND_EDGE_LOW,
		             index);
	if (vany(past_high))
		guard_search(first, c, guard_of(&m.u, &enclosure, high, one), past_high,
		             EVENT_STORY + POUND_EDGE_HIGH, index);
	if (!vany(reversals))
		return;
	struct power velocity;
	if (c->curved_step.on) {
		power_load(&velocity, c->order, c->curved_step.rates, i);
		enclosure = enclosure_make(&velocity, c->order);
	} else
		enclosure = enclosure_of_velocity(&m, c->order);
	reversals &= may_cross(&enclosure, zero, -direction);
	if (!vany(reversals))
		return;
	if (!c->curved_step.on)
		motion_velocity(&velocity, &m, c->order);
	guard_search(first, c, guard_of(&velocity, &enclosure, zero, -direction), reversals,
	             EVENT_STORY + POUND_EDGE_REVERSAL, index);
}

/* Whether a contact ends at zero force, which may precede zero overlap. */
static bool link_forced(const struct link *l)
{
	return !l->link->law.tension && l->at.on.damping > 0;
}

/* Encloses the overlaps of a vector of links over a step: by their own series if they are integrated, else by the enclosures of
 * their floors.
 *
 * Returns  value  bits of the links to search: integrated ones, and others that may begin to touch
 */
LANE_INLINE unsigned overlaps_bound(struct enclosures *x, const struct chain *c, int j)
{
	const struct link_ends *ends = &c->ends;
	const struct enclosures *floors = &c->displacement;
	const unsigned own = c->own_bits[j / ROW] >> j % ROW & ((1u << W) - 1);
	const vd zero = vsplat(0), gap = lanes_load(&ends->gap[j]);
	vd u0 = zero, v0 = zero, u1 = zero, v1 = zero, fourth_max = zero;
	for (int k = 0; k < ends->n[j / ROW]; k++) {
		const vd weight = lanes_load(&ends->weight[k][j]);
		u0 = vfma(weight, ends_load(ends, k, j, c->u.at), u0);
		v0 = vfma(weight, ends_load(ends, k, j, floors->v0.at), v0);
		u1 = vfma(weight, ends_load(ends, k, j, floors->u1.at), u1);
		v1 = vfma(weight, ends_load(ends, k, j, floors->v1.at), v1);
		fourth_max = vfma(vabs(weight), ends_load(ends, k, j, floors->fourth_max.at), fourth_max);
	}
	u0 = vmin(u0 - gap, zero); // a rounding must not make it overlap
	u1 = u1 - gap;
	const struct enclosure enclosure = {u0, v0, u1, v1, fourth_max};
	const unsigned some = vbits(may_cross(&enclosure, zero, vsplat(1))) & ~own;
	if (own) {
		enclosures_of(c->overlaps[0], LINKS, c->order, x, j, 1);
		const vm mask = vmask(own);
		u0 = vselect(mask, column_load(&x->u0, j), u0);
		v0 = vselect(mask, column_load(&x->v0, j), v0);
		u1 = vselect(mask, column_load(&x->u1, j), u1);
		v1 = vselect(mask, column_load(&x->v1, j), v1);
		fourth_max = vselect(mask, column_load(&x->fourth_max, j), fourth_max);
	}
	column_store(&x->u0, j, u0);
	column_store(&x->v0, j, v0);
	column_store(&x->u1, j, u1);
	column_store(&x->v1, j, v1);
	column_store(&x->fourth_max, j, fourth_max);
	return some | own;
}

/* Encloses all overlaps over a step, and lists the links to search. */
static void overlaps_enclose(struct chain *c, struct link_list *some)
{
	some->n = 0;
	for (int j = 0; j < c->wide_links; j += W)
		for (unsigned bits = overlaps_bound(&c->overlap, c, j); bits; bits &= bits - 1)
			some->link[some->n++] = (uint16_t)(j + __builtin_ctz(bits));
}

/* a vector of links */
struct link_lanes {
	int index[W]; /* -1: none */
	struct enclosure enclosure;
	unsigned open, released, touching;    /* which of the three */
	unsigned forced;                      /* touching, and ends with its force */
	double low[W], high[W], direction[W]; /* of the branches of links in contact */
	double
	    phase_lead[W]; /* damping over stiffness, over the step: time by which the force leads the overlap */
	double acceleration[W]; /* magnitude of the overlap's second derivative */
	unsigned fresh;
};

/* Values of the links of a vector, 0 where there is none. */
LANE_INLINE vd links_load(const int index[W], const double *from)
{
	double x[W];
	for (int l = 0; l < W; l++)
		x[l] = index[l] < 0 ? 0 : from[index[l]];
	return lanes_of(x);
}

static void link_lanes_make(struct link_lanes *x, const struct chain *c, const struct link_list *some,
                            int from)
{
	x->open = x->released = x->touching = x->forced = x->fresh = 0;
	for (int l = 0; l < W; l++) {
		x->low[l] = -DBL_MAX, x->high[l] = DBL_MAX;
		x->direction[l] = x->phase_lead[l] = x->acceleration[l] = 0;
		x->index[l] = from + l < some->n ? some->link[from + l] : -1;
		if (x->index[l] < 0)
			continue;
		const struct link *link = &c->link[x->index[l]];
		const unsigned bit = 1u << l;
		if (link_curved(link) || link->held)
			continue; // searched by nonlinear_contact_step.inl and held_search
		x->open |= link->touching || link->released ? 0 : bit;
		x->released |= link->released ? bit : 0;
		x->touching |= link->touching ? bit : 0;
		x->forced |= link->touching && link_forced(link) ? bit : 0;
		x->fresh |= link->fresh ? bit : 0;
		if (!(link->touching || link->released))
			continue;
		if (link->touching) {
			x->low[l] = x->forced & bit ? -DBL_MAX : link->at.on.low;
			x->high[l] = link->at.on.high;
			x->direction[l] = link->at.on.direction;
		}
		x->phase_lead[l] = link->at.on.damping / link->at.on.stiffness / c->dt;
		for (int k = 0; k < link->n_ends; k++)
			x->acceleration[l] += 2 * fabs(link->weight[k] * c->displacements[2].at[link->floor[k]]);
	}
	const struct enclosures *overlap = &c->overlap;
	x->enclosure =
	    (struct enclosure){links_load(x->index, overlap->u0.at), links_load(x->index, overlap->v0.at),
	                       links_load(x->index, overlap->u1.at), links_load(x->index, overlap->v1.at),
	                       links_load(x->index, overlap->fourth_max.at)};
}

/* Rates of overlaps of a vector of links: derivatives by the fraction of the step; in steps of nonlinear_contact.inl the rates by
 * time, as the derivative by s vanishes where a power contact begins or ends. */
static void link_rates(struct power *rate, const struct chain *c, const struct motion *overlap,
                       const int *index)
{
	if (!c->curved_step.on) {
		motion_velocity(rate, overlap, c->order);
		return;
	}
	for (int n = 0; n <= ORDER_HIGH; n++) {
		double value[W];
		for (int l = 0; l < W; l++)
			value[l] = n <= c->order && index[l] >= 0 ? c->curved_step.links[index[l]].rate[n] : 0;
		rate->c[n] = lanes_load(value);
	}
}

/* Searches for the time at which the force of a touching link falls through 0, or of a released link rises through it again, and
 * at which a released link is clear. */
static void forces_search(struct first *first, const struct chain *c, const struct link_lanes *x,
                          const struct motion *overlap, unsigned lanes)
{
	const vm touching = vmask(x->touching), some = vmask(lanes), fresh = vmask(x->fresh);
	const vd sign = vselect(touching, vsplat(-1), vsplat(1)), phase_lead = lanes_load(x->phase_lead);
	struct power guard = {0}, rate;
	link_rates(&rate, c, overlap, x->index);
	for (int n = 0; n <= c->order; n++)
		guard.c[n] = sign * vfma(phase_lead, rate.c[n], overlap->u.c[n]);
	// a force that has just passed 0 is taken as beyond it (step.inl: force_search)
	const vd below =
	    vmin(guard.c[0], -DBL_EPSILON * vfma(phase_lead, lanes_load(x->acceleration), overlap->u.c[0]));
	guard.c[0] = vselect(fresh, below, guard.c[0]);
	struct search search = {.time = vsplat(1), .event = vsplat(EVENT_NONE)};
	search_safe(&guard, c->order, some, vselect(touching, vsplat(EVENT_ENDS), vsplat(EVENT_BEGINS)), &search);
	search_take(first, &search, some, x->index);
	const vm released = some & ~touching;
	if (!vany(released))
		return;
	for (int n = 0; n <= c->order; n++)
		guard.c[n] = -overlap->u.c[n];
	search = (struct search){.time = vsplat(1), .event = vsplat(EVENT_NONE)};
	search_safe(&guard, c->order, released, vsplat(EVENT_CLEARS), &search);
	search_take(first, &search, released, x->index);
}

/* Fills the overlap series of links that are not integrated, from their floors. */
static void overlaps_fill(struct chain *c, unsigned lanes, const int *index)
{
	for (; lanes; lanes &= lanes - 1) {
		const int j = index[__builtin_ctz(lanes)];
		if (c->link[j].own)
			continue;
		for (int n = 1; n <= c->order; n++)
			c->overlaps[n][j] = link_sum(&c->link[j], c->displacements[n].at);
		c->overlaps[0][j] = c->overlap.u0.at[j];
	}
}

/* Searches a vector of links. */
static void links_search(struct first *first, struct chain *c, const struct link_list *some, int from)
{
	const vd zero = vsplat(0), one = vsplat(1);
	struct link_lanes x;
	link_lanes_make(&x, c, some, from);
	const vm open = vmask(x.open), touching = vmask(x.touching);
	const vd low = lanes_load(x.low), high = lanes_load(x.high), direction = lanes_load(x.direction);
	const vm begins = open & may_cross(&x.enclosure, zero, one);
	const vm past_low = touching & may_cross(&x.enclosure, low, -one);
	const vm past_high = touching & may_cross(&x.enclosure, high, one);
	vm reversals = touching & ~vequal(direction, zero);
	const unsigned by_force = x.forced | x.released;
	if (!vany(begins | past_low | past_high | reversals) && by_force == 0)
		return;
	overlaps_fill(c, vbits(begins), x.index);
	struct motion overlap;
	for (int n = 0; n <= ORDER_HIGH; n++)
		overlap.u.c[n] = n <= c->order ? links_load(x.index, c->overlaps[n]) : zero;
	overlap.end = (struct kinematics){x.enclosure.u1, x.enclosure.v1};
	overlap.fourth_max = x.enclosure.fourth_max;
	const struct power *p = &overlap.u;
	if (vany(begins))
		guard_search(first, c, guard_of(p, &x.enclosure, zero, one), begins, EVENT_BEGINS, x.index);
	if (vany(past_low))
		guard_search(first, c, guard_of(p, &x.enclosure, low, -one), past_low, EVENT_LINK + POUND_EDGE_LOW,
		             x.index);
	if (vany(past_high))
		guard_search(first, c, guard_of(p, &x.enclosure, high, one), past_high, EVENT_LINK + POUND_EDGE_HIGH,
		             x.index);
	if (by_force)
		forces_search(first, c, &x, &overlap, by_force);
	if (!vany(reversals))
		return;
	struct power velocity;
	link_rates(&velocity, c, &overlap, x.index);
	const struct enclosure enclosure = enclosure_make(&velocity, c->order);
	reversals &= may_cross(&enclosure, zero, -direction);
	if (!vany(reversals))
		return;
	guard_search(first, c, guard_of(&velocity, &enclosure, zero, -direction), reversals,
	             EVENT_LINK + POUND_EDGE_REVERSAL, x.index);
}

/* Searches for the time at which the force between the sides of a held rigid contact falls through 0. */
static void held_search(struct first *first, const struct chain *c, int j)
{
	struct power guard;
	for (int n = 0; n <= ORDER_HIGH; n++)
		guard.c[n] = vsplat(n + 2 <= c->order ? -c->overlaps[n][j] : 0);
	// below the rounding error of its terms: set to zero, the next derivative decides (chain_series.inl: link_zero_rounding)
	if (fabs(c->overlaps[0][j]) <= POUND_UNDECIDED * held_terms(c, &c->link[j]))
		guard.c[0] = vsplat(0);
	struct search search = {.time = vsplat(1), .event = vsplat(EVENT_NONE)};
	search_safe(&guard, c->order, vmask(1), vsplat(EVENT_ENDS), &search);
	int index[W] = {j};
	search_take(first, &search, vmask(1), index);
}

/* The first event of a step. */
static struct first events_search(struct chain *c)
{
	struct first first = {.time = 1, .event = EVENT_NONE, .index = -1};
	struct link_list some;
	overlaps_enclose(c, &some);
	for (int k = 0; k < some.n; k += W)
		links_search(&first, c, &some, k);
	for (int j = 0; c->held && j < c->n_links; j++)
		if (c->link[j].held)
			held_search(&first, c, j);
	for (int i = 0; c->edged && i < c->n; i += W)
		stories_search(&first, c, i);
	return first;
}
