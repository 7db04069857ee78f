/* chain_series.inl - the power series of a chain over a step: all floors in lanes, order by order.
 *
 *   S = k h^2 D_n + c h (n+1) D_(n+1)                             spring and dashpot of a story
 *   A = (S of the story above - S)/m - contacts/m
 *   D_(n+2) = (A - A of the floor below - a0 h (n+1) D_(n+1))/((n+1)(n+2))      below the lowest story: the ground's A
 *   U_(n+2) = (A - ground - a0 h (n+1) U_(n+1))/((n+1)(n+2))
 *
 * D are drifts and U displacements, by the elapsed fraction of the step.  A drift has its own series: the difference of two
 * displacements would cancel in a stiff story; the overlap of a contact likewise.
 *
 * Included by chain.inl alone, once per lane count, after series.inl. */

/* factors of coefficient n: in the rate at the end, in the bound of the fourth derivative, and 1/((n + 1)(n + 2)) */
struct term {
	double rate, fourth, share;
};
#define TERM(n)                                                                       \
	{                                                                                 \
		(n), (n) * ((n)-1.0) * ((n)-2.0) * ((n)-3.0), 1 / (((n) + 1.0) * ((n) + 2.0)) \
	}
static const struct term TERM_OF[TERMS] = {TERM(0),  TERM(1),  TERM(2),  TERM(3),  TERM(4),  TERM(5),
                                           TERM(6),  TERM(7),  TERM(8),  TERM(9),  TERM(10), TERM(11),
                                           TERM(12), TERM(13), TERM(14), TERM(15), TERM(16), TERM(17),
                                           TERM(18), TERM(19), TERM(20), TERM(21)};

LANE_INLINE vd column_load(const struct column *x, int j)
{
	return lanes_load(&x->at[j]);
}
LANE_INLINE void column_store(struct column *x, int j, vd value)
{
	lanes_store(&x->at[j], value);
}

/* Column entries at end k of a vector of links. */
LANE_INLINE vd ends_load(const struct link_ends *x, int k, int j, const double *column)
{
	if (x->follows[k][j / ROW])
		return lanes_load(column + x->floor[k][j]);
	double at[W];
	for (int l = 0; l < W; l++)
		at[l] = column[x->floor[k][j + l]];
	return lanes_of(at);
}

/* Adds order n of a link's force to the external forces on its floors, over masses. */
LANE_INLINE void push_add(struct chain *c, const struct link *l, double force)
{
	double *push = c->push.at;
	push[l->floor[0]] = fma(l->share[0], force, push[l->floor[0]]);
	push[l->floor[1]] = fma(l->share[1], force, push[l->floor[1]]);
	for (int k = 2; k < l->n_ends; k++)
		c->push.at[l->floor[k]] = fma(l->share[k], force, c->push.at[l->floor[k]]);
}

/* Order n of a contact's force, times the step squared. */
LANE_INLINE double link_force(const struct chain *c, const struct link *l, int j, int n)
{
	const double force = fma(l->dash * (n + 1), c->overlaps[n + 1][j], l->spring * c->overlaps[n][j]);
	return n == 0 ? force + l->force : force;
}

static void held_push(struct chain *c, int n, double ground); /* impact.inl */

/* Adds the forces of modal damping of order n, over masses. */
LANE_SHARED void modal_add(struct chain *c, int n)
{
	const struct pound_chain_task *task = c->task;
	for (int first = 0, stories; first < c->n; first += stories) {
		stories = building_stories(task, first);
		for (int i = first; i < first + stories && task->floors[i].modal; i++) {
			double sum = 0;
			for (int j = 0; j < stories; j++)
				sum = fma(task->floors[i].modal[j], c->drifts[n + 1].at[first + j], sum);
			c->push.at[i] += c->dt * (n + 1) * c->inverse_mass.at[i] * sum;
		}
	}
}

/* Whether a link is level: its sides meet with zero overlap and equal velocities to rounding. */
LANE_INLINE bool link_level(const struct chain *c, const struct link *l)
{
	if (l->p != 0)
		return false;
	double alike = 0;
	for (int k = 0; k < l->n_ends; k++)
		alike += fabs(l->weight[k] * c->w.at[l->floor[k]]);
	return fabs(l->q) <= DBL_EPSILON * alike;
}

/* Lists the links that act in a step. */
static void links_list(struct chain *c)
{
	c->touching.n = c->own.n = 0;
	c->held = false;
	memset(c->own_bits, 0, sizeof c->own_bits);
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		if (l->touching)
			c->touching.link[c->touching.n++] = (uint16_t)j;
		if (l->own) {
			c->own.link[c->own.n++] = (uint16_t)j;
			c->own_bits[j / ROW] |= (uint8_t)(1u << j % ROW);
		}
		c->held |= l->held;
	}
}

/* Sets order n of the external forces on floors (contacts, modal damping), over masses. */
static void pushes_set(struct chain *c, int n)
{
	for (int i = 0; i < c->wide; i += W)
		column_store(&c->push, i, vsplat(0));
	for (int k = 0; k < c->touching.n; k++) {
		const int j = c->touching.link[k];
		push_add(c, &c->link[j], link_force(c, &c->link[j], j, n));
	}
	if (c->modal)
		modal_add(c, n);
}

/* Force of a vector of stories, of order n. */
LANE_INLINE vd story_force(const struct chain *c, int i, int n, bool first)
{
	const vd elastic = column_load(&c->spring, i) * column_load(&c->drifts[n], i);
	const vd s = vfma(column_load(&c->dash, i) * vsplat(n + 1), column_load(&c->drifts[n + 1], i), elastic);
	return first ? s + column_load(&c->force, i) : s;
}

/* terms of an order of the series: compile-time constants at each call */
struct order_kind {
	bool first;  /* order 0: springs have offsets */
	bool driven; /* orders 0 and 1: the ground moves */
	bool pushed; /* external forces act on floors */
	bool moving; /* displacements are needed */
};

/* Order n + 2 of a vector of displacements, from accelerations of order n. */
LANE_INLINE void displacements_next(struct chain *c, int n, int i, vd a, double ground)
{
	const vd damping = column_load(&c->mass_damping_step, i) * vsplat(n + 1);
	const vd resisted = vfma(damping, column_load(&c->displacements[n + 1], i), vsplat(ground));
	column_store(&c->displacements[n + 2], i, (a - resisted) * vsplat(TERM_OF[n].share));
}

/* Order n + 2 of a vector of drifts, from order n of the accelerations of its floors, of the vector below and of the ground. */
LANE_INLINE void drifts_next(struct chain *c, int n, int i, vd below, vd a, vd base)
{
	const vd under = vfma(vbelow(below, a), column_load(&c->inner, i), base);
	const vd damping = column_load(&c->mass_damping_step, i) * vsplat(n + 1);
	const vd resisted = vfma(damping, column_load(&c->drifts[n + 1], i), under);
	column_store(&c->drifts[n + 2], i, (a - resisted) * vsplat(TERM_OF[n].share));
}

/* Computes order n + 2 of all floors from the lower orders.
 *
 * Given    ground  of order n, times the square of the step
 */
LANE_INLINE void floors_next(struct chain *c, int n, double ground, const struct order_kind kind)
{
	vd s = story_force(c, 0, n, kind.first), below = vsplat(0);
	for (int i = 0; i < c->wide; i += W) {
		const vd next = i + W < c->wide ? story_force(c, i + W, n, kind.first) : vsplat(0);
		vd a =
		    vfma(vabove(s, next), column_load(&c->inverse_above, i), -(s * column_load(&c->inverse_mass, i)));
		if (kind.pushed)
			a = a - column_load(&c->push, i);
		drifts_next(c, n, i, below, a, kind.driven ? column_load(&c->base, i) * vsplat(ground) : vsplat(0));
		if (kind.moving)
			displacements_next(c, n, i, a, ground);
		below = a;
		s = next;
	}
}

/* Sum of magnitudes of the terms of a floor's acceleration at order n, times the step squared. */
static double floor_terms(const struct chain *c, int i, int n)
{
	double terms = 0;
	for (int above = 0; above < 2; above++) {
		const int k = i + above;
		if (above && c->inverse_above.at[i] == 0)
			break;
		terms += fabs(c->spring.at[k] * c->drifts[n].at[k]) +
		         fabs(c->dash.at[k] * (n + 1) * c->drifts[n + 1].at[k]) + (n == 0 ? fabs(c->force.at[k]) : 0);
	}
	return terms * c->inverse_mass.at[i] +
	       fabs(c->mass_damping_step.at[i] * (n + 1) * c->displacements[n + 1].at[i]) + fabs(c->push.at[i]);
}

/* The sides of a level link separate or close by the difference of their accelerations.  A difference below the rounding
 * error of its terms is set to zero, and the next derivative decides: otherwise they would separate and meet
 * endlessly (step.inl: separation_zero_rounding).
 *
 * Given    ground  of order n
 */
static void link_zero_rounding(struct chain *c, struct link *l, int j, int n, double ground)
{
	double made = fabs(ground);
	for (int k = 0; k < l->n_ends; k++)
		made += fabs(l->weight[k]) * floor_terms(c, l->floor[k], n);
	double *overlap = &c->overlaps[n + 2][j];
	if (fabs(*overlap) * (n + 1) * (n + 2) <= POUND_UNDECIDED * made)
		*overlap = 0;
	else
		l->level = false;
}

/* A story at rest on a branch boundary leaves it by the sign of its acceleration: one below the rounding error of its
 * terms is set to zero (step.inl: still_zero_rounding). */
static void story_zero_rounding(struct chain *c, int i, double ground)
{
	const double d = c->d.at[i];
	if (i >= c->n || (d != c->low.at[i] && d != c->high.at[i] && c->direction.at[i] == 0))
		return;
	double made = floor_terms(c, i, 0);
	made += c->inner.at[i] != 0 ? floor_terms(c, i - 1, 0) : fabs(ground);
	if (fabs(2 * c->drifts[2].at[i]) < POUND_UNDECIDED * made)
		c->drifts[2].at[i] = 0;
}

/* Orders 0 and 1 of the step, and its coefficients; links_list has listed the links as they are now. */
static void series_start(struct chain *c)
{
	const vd h = vsplat(c->dt), h2 = h * h;
	assert(c->touching.n <= c->n_links &&
	       c->own.n <= c->n_links); // else the lists are stale, from an earlier step
	c->level = false;
	for (int i = 0; i < c->wide; i += W) {
		column_store(&c->spring, i, column_load(&c->stiffness, i) * h2);
		column_store(&c->dash, i, column_load(&c->dashpot, i) * h);
		column_store(&c->force, i, column_load(&c->offset, i) * h2);
		column_store(&c->mass_damping_step, i, column_load(&c->mass_damping, i) * h);
		column_store(&c->drifts[0], i, column_load(&c->d, i));
		column_store(&c->drifts[1], i, column_load(&c->v, i) * h);
		column_store(&c->displacements[0], i, column_load(&c->u, i));
		column_store(&c->displacements[1], i, column_load(&c->w, i) * h);
	}
	for (int o = 0; o < c->own.n; o++) {
		const int j = c->own.link[o];
		struct link *l = &c->link[j];
		c->overlaps[0][j] = l->p;
		c->overlaps[1][j] = l->q * c->dt;
		l->spring = l->at.on.stiffness * (c->dt * c->dt);
		l->dash = l->at.on.damping * c->dt;
		l->force = l->at.on.offset * (c->dt * c->dt);
		l->level = link_level(c, l);
		c->level |= l->level;
	}
}

/* Order n + 2 of overlaps that are integrated as separate variables. */
LANE_INLINE void overlaps_next(struct chain *c, int n, double ground)
{
	if (!c->held && !c->level) {
		for (int k = 0; k < c->own.n; k++) {
			const int j = c->own.link[k];
			c->overlaps[n + 2][j] = link_sum(&c->link[j], c->displacements[n + 2].at);
		}
		return;
	}
	for (int k = 0; k < c->own.n; k++) {
		const int j = c->own.link[k];
		struct link *l = &c->link[j];
		if (l->held) {
			c->overlaps[n + 2][j] = 0;
			continue;
		}
		c->overlaps[n + 2][j] = link_sum(l, c->displacements[n + 2].at);
		if (l->level)
			link_zero_rounding(c, l, j, n, ground);
	}
}

/* Stories at rest on a branch boundary. */
static void stories_zero_rounding(struct chain *c, double ground)
{
	for (int i = 0; i < c->n; i += W)
		for (unsigned still = vbits(vequal(column_load(&c->v, i), vsplat(0))); still; still &= still - 1)
			story_zero_rounding(c, i + __builtin_ctz(still), ground);
}

/* One order of all series. */
LANE_INLINE void series_order(struct chain *c, int n, double ground, const struct order_kind kind)
{
	if (kind.pushed) {
		pushes_set(c, n);
		if (c->held)
			held_push(c, n, ground);
	}
	floors_next(c, n, ground, kind);
	if (kind.first && c->edged)
		stories_zero_rounding(c, ground);
	if (kind.moving && c->own.n > 0)
		overlaps_next(c, n, ground);
}

LANE_INLINE void series_orders(struct chain *c, const bool pushed, const bool moving)
{
	const double h2 = c->dt * c->dt;
	series_order(c, 0, c->ground * h2, (struct order_kind){true, true, pushed, moving});
	series_order(c, 1, c->slope * c->dt * h2, (struct order_kind){false, true, pushed, moving});
	for (int n = 2; n + 2 <= c->order; n++)
		series_order(c, n, 0, (struct order_kind){false, false, pushed, moving});
}

/* Enclosures of some vectors of series over a step.
 *
 * Given    series  coefficients; order n begins at n strides
 */
LANE_INLINE void enclosures_of(const double *series, size_t stride, int order, struct enclosures *to, int i,
                               const int vectors)
{
	vd u[4], v[4], fourth_max[4];
	for (int k = 0; k < vectors; k++) {
		u[k] = lanes_load(series + i + k * W);
		v[k] = fourth_max[k] = vsplat(0);
		column_store(&to->u0, i + k * W, u[k]);
		column_store(&to->v0, i + k * W, lanes_load(series + stride + i + k * W));
	}
	for (int n = 1; n <= order; n++) {
		const vd rate = vsplat(TERM_OF[n].rate), fourth = vsplat(TERM_OF[n].fourth);
		for (int k = 0; k < vectors; k++) {
			const vd x = lanes_load(series + (size_t)n * stride + i + k * W);
			u[k] = u[k] + x;
			v[k] = vfma(rate, x, v[k]);
			if (n >= 4)
				fourth_max[k] = vfma(fourth, vabs(x), fourth_max[k]);
		}
	}
	for (int k = 0; k < vectors; k++) {
		column_store(&to->u1, i + k * W, u[k]);
		column_store(&to->v1, i + k * W, v[k]);
		column_store(&to->fourth_max, i + k * W, fourth_max[k]);
	}
}

/* Enclosures of a column of series over a step: several vectors at once, as each sum is one dependency chain. */
LANE_SHARED void enclosures_make(const struct chain *c, const struct column series[TERMS],
                                 struct enclosures *to)
{
	const double *first = series[0].at;
	int i = 0;
	for (; i + 4 * W <= c->wide; i += 4 * W)
		enclosures_of(first, LONG, c->order, to, i, 4);
	for (; i + 2 * W <= c->wide; i += 2 * W)
		enclosures_of(first, LONG, c->order, to, i, 2);
	for (; i < c->wide; i += W)
		enclosures_of(first, LONG, c->order, to, i, 1);
}

/* Enclosure of a series over a step. */
static struct enclosure enclosure_make(const struct power *x, int order)
{
	vd u = x->c[0], v = vsplat(0), fourth_max = vsplat(0);
	for (int n = 1; n <= order; n++) {
		u = u + x->c[n];
		v = vfma(vsplat(TERM_OF[n].rate), x->c[n], v);
		if (n >= 4)
			fourth_max = vfma(vsplat(TERM_OF[n].fourth), vabs(x->c[n]), fourth_max);
	}
	return (struct enclosure){x->c[0], x->c[1], u, v, fourth_max};
}

/* Computes the series and enclosures of a step of length c->dt. */
static void series_chain(struct chain *c)
{
	series_start(c);
	if (c->modal || c->touching.n > 0)
		series_orders(c, true, c->moving);
	else if (c->moving)
		series_orders(c, false, true);
	else
		series_orders(c, false, false);
	enclosures_make(c, c->drifts, &c->drift);
	if (c->moving)
		enclosures_make(c, c->displacements, &c->displacement);
}

/* The series of a vector of floors; 0 beyond their order. */
LANE_INLINE void power_load(struct power *x, int order, const struct column series[TERMS], int i)
{
	for (int n = 0; n <= ORDER_HIGH; n++)
		x->c[n] = n <= order ? column_load(&series[n], i) : vsplat(0);
}

LANE_INLINE void motion_load(struct motion *m, const struct chain *c, const struct column series[TERMS],
                             const struct enclosures *enclosure, int i)
{
	power_load(&m->u, c->order, series, i);
	m->end = (struct kinematics){column_load(&enclosure->u1, i), column_load(&enclosure->v1, i)};
	m->fourth_max = column_load(&enclosure->fourth_max, i);
}

LANE_INLINE struct enclosure enclosure_load(const struct enclosures *x, int i)
{
	return (struct enclosure){column_load(&x->u0, i), column_load(&x->v0, i), column_load(&x->u1, i),
	                          column_load(&x->v1, i), column_load(&x->fourth_max, i)};
}
