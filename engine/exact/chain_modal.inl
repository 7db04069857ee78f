/* chain_modal.inl - whole samples of a chain without contact, on elastic branches, by its modes.
 *
 *   q'' + c q' + w^2 q = -G (a + d t/h)          of each mode of each building, exact over a sample for any w h
 *
 * Drifts and their rates at the samples are sums over modes.  The cubic through both ends of a sample, widened by its error
 * bound, proves that no event lies between: no contact, no edge of a branch, no new largest value.  Without this proof the sample
 * is integrated by power series, as are rows with a yielding story: speed.md has the cost of modes of the tangent stiffness.
 *
 * Included by chain.inl alone, once per lane count, after chain_step.inl. */

static const double REACH_SERIES = 0.8; /* (w + c) h of a map's series: 0.8^18/18! = 3e-18 */
enum { ORDER_MAP = 18 };
/* Largest ratio of highest to lowest frequency for modal maps: shapes of low modes have rounding errors of the square of the ratio. */
static const double STIFF = 90;

/* response of a mode to an initial velocity of 1, its rate, and its integrals once and twice, after some time */
struct impulse_response {
	double psi, rate, once, twice;
};

/* The same over a time h, by the power series of a time short enough, doubled.
 *
 *   psi(2 h) = psi (2 psi' + c psi)                psi'(2 h) = psi'^2 - w^2 psi^2
 *   once(2 h) = once (1 + psi' + c psi) + psi^2    twice(2 h) = twice (1 + psi' + c psi) + (h + psi) once
 */
static struct impulse_response mode_response(double w, double c, double h)
{
	int halvings = 0;
	while ((w + c) * h > REACH_SERIES) {
		h *= 0.5;
		halvings++;
	}
	struct impulse_response r = {0, 0, 0, 0};
	const double ch = c * h, kh = w * h * (w * h);
	double u = 0, v = 1; // coefficient n of psi/h, and of its rate
	for (int n = 0; n <= ORDER_MAP; n++) {
		const double share = 1.0 / (n + 1);
		r.psi += u;
		r.rate += v;
		r.once = fma(u, share, r.once);
		r.twice = fma(u, share / (n + 2), r.twice);
		const double next = -fma(ch, v, kh * u) * share;
		u = v * share;
		v = next;
	}
	r.psi *= h, r.once *= h * h, r.twice *= h * h * h;
	for (; halvings > 0; halvings--, h *= 2) {
		const double grown = 1 + r.rate + c * r.psi;
		r = (struct impulse_response){.psi = r.psi * (2 * r.rate + c * r.psi),
		                              .rate = r.rate * r.rate - w * w * r.psi * r.psi,
		                              .once = r.once * grown + r.psi * r.psi,
		                              .twice = r.twice * grown + (h + r.psi) * r.once};
	}
	return r;
}

/* Computes a mode's map over a sample.
 *
 * Given    i      lane of the mode
 *          gain   G
 *
 * The fourth derivative is bounded by that of the motion about its quasi-static part, whose energy does not grow.  Above about
 * 8 radians per sample the motion itself gives a better bound.
 */
static void mode_fill(struct modal_motion *f, int i, double w, double c, double gain, double h)
{
	const struct impulse_response r = mode_response(w, c, h);
	const double x = w * h, ratio = c / w;
	const double quartic = x * x * x * x * (1 + ratio * (2 + ratio * (1 + ratio)));
	const double swing = x * sqrt(x) * (1 + ratio) / POUND_CUBIC_ERROR;
	f->uu.at[i] = r.rate + c * r.psi;
	f->uv.at[i] = r.psi;
	f->ua.at[i] = -gain * r.once;
	f->ud.at[i] = -gain * r.twice / h;
	f->vu.at[i] = -w * w * r.psi;
	f->vv.at[i] = r.rate;
	f->va.at[i] = -gain * r.psi;
	f->vd.at[i] = -gain * r.once / h;
	f->per_w2.at[i] = 1 / (w * w);
	f->w2.at[i] = w * w;
	f->damping.at[i] = c;
	f->gain.at[i] = gain;
	f->quasi_static.at[i] = gain / (w * w);
	f->quasi_static_lag.at[i] = gain * c / (w * w * w * w) / h;
	f->drift_speed.at[i] = gain / (w * w) / h;
	f->fourth_max.at[i] = smaller(quartic, swing);
	f->fourth_max_rate.at[i] = smaller(quartic, swing) / w;
}

/* Damping of a building's modes, if damping does not couple them.
 *
 * Returns  value  false: the modes are coupled
 *          c      [1/s]  (n)
 */
static bool modes_damping(const struct pound_chain_floor *floor, int n, const struct pound_modes *modes,
                          double *c)
{
	const double ratio = floor->dashpot / floor->story.stiffness;
	bool apart = true;
	for (int i = 0; i < n; i++)
		apart &= fabs(floor[i].dashpot - ratio * floor[i].story.stiffness) <=
		         POUND_UNDECIDED * fabs(floor[i].dashpot);
	for (int r = 0; r < n; r++)
		c[r] = floor->mass_damping + ratio * modes->w[r] * modes->w[r];
	if (!floor->modal)
		return apart;
	for (int r = 0; r < n && apart; r++) {
		const double *shape = modes->shape[r];
		double force[POUND_STORIES], largest = 0;
		for (int i = 0; i < n; i++) {
			force[i] = 0;
			for (int j = 0; j < n; j++)
				force[i] += floor[i].modal[j] * (shape[j] - (j > 0 ? shape[j - 1] : 0));
		}
		for (int s = 0; s < n; s++) {
			double sum = 0;
			for (int i = 0; i < n; i++)
				sum += modes->shape[s][i] * force[i];
			if (s == r)
				c[r] += sum;
			else
				largest = larger(largest, fabs(sum));
		}
		apart = largest <= n * POUND_UNDECIDED * modes->w[n - 1];
	}
	return apart;
}

/* Lays out the shape rows: per vector of floors, one row for each mode of the buildings in it. */
static void modal_rows(struct chain *c)
{
	struct modal_motion *f = &c->modal_motion;
	int rows = 0;
	for (int j = 0; j < c->wide; j += ROW) {
		int first = j, last = j + ROW - 1 < c->n ? j + ROW : c->n;
		while (first > 0 && !c->task->floors[first].base)
			first--;
		while (last < c->n && !c->task->floors[last].base)
			last++;
		f->from[j / ROW] = first;
		f->upto[j / ROW] = last;
		f->row[j / ROW] = rows;
		rows += last - first;
	}
	f->can &= rows <= MODE_ROWS;
}

/* Makes modes and maps of a chain. */
static void modal_start(struct chain *c)
{
	const struct pound_chain_task *task = c->task;
	struct modal_motion *f = &c->modal_motion;
	f->wait = f->refused = f->notes = 0;
	f->room = KEPT / (NOTE_COLUMNS * c->wide) < NOTES ? KEPT / (NOTE_COLUMNS * c->wide) : NOTES;
	f->can = !(task->asked & (POUND_CHAIN_ENERGY | POUND_CHAIN_CLOSING)) && !task->observer;
	if (!f->can)
		return;
	for (int k = 0; k < 2; k++) // what is behind the last floor
		for (int i = c->n; i < c->wide; i++)
			f->at[k].u.at[i] = f->at[k].w.at[i] = 0;
	modal_rows(c);
	for (int j = 0; j < c->wide / ROW && f->can; j++)
		memset(f->shape[f->row[j]], 0, sizeof(double) * ROW * (size_t)(f->upto[j] - f->from[j]));
	for (int first = 0, n; first < c->n && f->can; first += n) {
		const struct pound_chain_floor *floor = &task->floors[first];
		struct pound_modes *modes = &f->modes;
		double mass[POUND_STORIES], stiffness[POUND_STORIES], damping[POUND_STORIES];
		n = building_stories(task, first);
		for (int i = 0; i < n; i++) {
			mass[i] = floor[i].mass;
			stiffness[i] = floor[i].story.stiffness;
		}
		pound_modes_fill(n, mass, stiffness, modes);
		f->can = modes->w[n - 1] <= STIFF * modes->w[0] && modes_damping(floor, n, modes, damping);
		for (int r = 0; r < n && f->can; r++) {
			double gain = 0;
			for (int i = 0; i < n; i++) {
				const int j = (first + i) / ROW;
				gain += mass[i] * modes->shape[r][i];
				f->shape[f->row[j] + first + r - f->from[j]][(first + i) % ROW] =
				    modes->shape[r][i] - (i > 0 ? modes->shape[r][i - 1] : 0);
			}
			mode_fill(f, first + r, modes->w[r], damping[r], gain, task->time_step);
		}
	}
}

/* ---- entering and leaving ---- */

/* Whether every story is on an elastic branch, and nothing is about to touch. */
static bool modal_clear(const struct chain *c)
{
	for (int i = 0; c->edged && i < c->n; i++)
		if (c->stiffness.at[i] != c->task->floors[i].story.stiffness || c->direction.at[i] != 0)
			return false;
	for (int j = 0; j < c->n_links; j++)
		if (c->link[j].own)
			return false;
	return true;
}

/* Sum of a vector of ROW numbers, by index. */
LANE_INLINE double row_sum(const double x[ROW])
{
	double sum = 0;
	for (int l = 0; l < ROW; l++)
		sum += x[l];
	return sum;
}

/* Modal coordinates of the drifts off their elastic centers, q = 1/w^2 sum of k d times the shape's drift. */
static void modal_enter(struct chain *c)
{
	struct modal_motion *f = &c->modal_motion;
	for (int i = 0; i < c->wide; i += W) {
		const vd k = column_load(&c->initial, i);
		const vd shift = i < c->n ? -column_load(&c->offset, i) * column_load(&c->pliancy, i) : vsplat(0);
		column_store(&f->shift, i, shift);
		column_store(&f->at[0].d, i, column_load(&c->d, i));
		column_store(&f->at[0].v, i, column_load(&c->v, i));
		column_store(&f->elastic[0], i, k * (column_load(&c->d, i) - shift));
		column_store(&f->elastic[1], i, k * column_load(&c->v, i));
		column_store(&f->q, i, vsplat(0));
		column_store(&f->v, i, vsplat(0));
	}
	for (int j = 0; j < c->wide; j += ROW)
		for (int r = f->from[j / ROW]; r < f->upto[j / ROW]; r++) {
			alignas(64) double q[ROW], v[ROW];
			const double *shape = f->shape[f->row[j / ROW] + r - f->from[j / ROW]];
			for (int l = 0; l < ROW; l += W) {
				lanes_store(q + l, lanes_load(shape + l) * column_load(&f->elastic[0], j + l));
				lanes_store(v + l, lanes_load(shape + l) * column_load(&f->elastic[1], j + l));
			}
			f->q.at[r] += row_sum(q) * f->per_w2.at[r];
			f->v.at[r] += row_sum(v) * f->per_w2.at[r];
		}
	f->now = 0;
	f->moved = false;
}

/* ---- a sample ---- */

/* Advances the modes over a sample, and bounds their fourth derivatives. */
LANE_INLINE void modes_move(struct modal_motion *f, int wide, double ground, double rise)
{
	const vd a = vsplat(ground), d = vsplat(rise);
	for (int i = 0; i < wide; i += W) {
		const vd q = column_load(&f->q, i), v = column_load(&f->v, i);
		const vd quasi_static =
		    vfma(column_load(&f->quasi_static_lag, i), d, -(column_load(&f->quasi_static, i) * a));
		const vd off = vabs(q - quasi_static), speed = vabs(vfma(column_load(&f->drift_speed, i), d, v));
		column_store(&f->bound, i,
		             vfma(column_load(&f->fourth_max, i), off, column_load(&f->fourth_max_rate, i) * speed));
		const vd q_ground = vfma(column_load(&f->ua, i), a, column_load(&f->ud, i) * d);
		const vd v_ground = vfma(column_load(&f->va, i), a, column_load(&f->vd, i) * d);
		column_store(&f->q_next, i,
		             vfma(column_load(&f->uu, i), q, vfma(column_load(&f->uv, i), v, q_ground)));
		column_store(&f->v_next, i,
		             vfma(column_load(&f->vu, i), q, vfma(column_load(&f->vv, i), v, v_ground)));
	}
}

/* drifts of a vector of stories, their rates, and bounds of their fourth derivatives */
struct drifts {
	vd d, v, fourth_max;
};

LANE_INLINE struct drifts drifts_sum(const struct modal_motion *f, int i)
{
	const int j = i / ROW, from = f->from[j], upto = f->upto[j];
	const double *shape = &f->shape[f->row[j]][i % ROW];
	const vd zero = vsplat(0);
	struct drifts even = {column_load(&f->shift, i), zero, zero}, odd = {zero, zero, zero};
	int r = from;
	for (; r + 1 < upto; r += 2, shape += 2 * ROW) {
		const vd s = lanes_load(shape), t = lanes_load(shape + ROW);
		even.d = vfma(s, vsplat(f->q_next.at[r]), even.d);
		even.v = vfma(s, vsplat(f->v_next.at[r]), even.v);
		even.fourth_max = vfma(vabs(s), vsplat(f->bound.at[r]), even.fourth_max);
		odd.d = vfma(t, vsplat(f->q_next.at[r + 1]), odd.d);
		odd.v = vfma(t, vsplat(f->v_next.at[r + 1]), odd.v);
		odd.fourth_max = vfma(vabs(t), vsplat(f->bound.at[r + 1]), odd.fourth_max);
	}
	if (r < upto) {
		const vd s = lanes_load(shape);
		even.d = vfma(s, vsplat(f->q_next.at[r]), even.d);
		even.v = vfma(s, vsplat(f->v_next.at[r]), even.v);
		even.fourth_max = vfma(vabs(s), vsplat(f->bound.at[r]), even.fourth_max);
	}
	return (struct drifts){even.d + odd.d, even.v + odd.v, even.fourth_max + odd.fourth_max};
}

/* Elastic and damping forces of modes per modal mass at a sample, -(c q' + w^2 q), which sum to absolute accelerations; their
 * rates, and bounds of their fourth derivatives over the sample before.
 *
 * Given    ground  acceleration at the sample
 */
LANE_INLINE void modes_force(struct modal_motion *f, const struct column *q, const struct column *v, int wide,
                             double ground)
{
	for (int i = 0; i < wide; i += W) {
		const vd w2 = column_load(&f->w2, i), c = column_load(&f->damping, i), rate = column_load(v, i);
		const vd force = -vfma(c, rate, w2 * column_load(q, i));
		const vd second = force - column_load(&f->gain, i) * vsplat(ground);
		column_store(&f->force, i, force);
		column_store(&f->force_rate, i, -vfma(c, second, w2 * rate));
		// derivative n + 1 of a free motion is at most w + c times that of derivative n
		const vd more = vfma(c, c + vsqrt(w2), w2);
		column_store(&f->force_bound, i, more * column_load(&f->bound, i));
	}
}

/* Absolute accelerations of floors at a sample, and their rates: sums over stories of sums over modes. */
LANE_INLINE void accelerations_sum(struct chain *c, struct modal_place *at)
{
	struct modal_motion *f = &c->modal_motion;
	for (int i = 0; i < c->wide; i += W) {
		const int j = i / ROW, from = f->from[j], upto = f->upto[j];
		const double *shape = &f->shape[f->row[j]][i % ROW];
		vd a = vsplat(0), jerk = a, bound = a;
		for (int r = from; r < upto; r++, shape += ROW) {
			const vd s = lanes_load(shape);
			a = vfma(s, vsplat(f->force.at[r]), a);
			jerk = vfma(s, vsplat(f->force_rate.at[r]), jerk);
			bound = vfma(vabs(s), vsplat(f->force_bound.at[r]), bound);
		}
		column_store(&at->a, i, a);
		column_store(&at->jerk, i, jerk);
		column_store(&f->fourth_force, i, bound);
	}
	double *bound = f->fourth_force.at;
	floors_sum(c, 3,
	           (const struct summed[]){{at->a.at, at->a.at}, {at->jerk.at, at->jerk.at}, {bound, bound}});
}

/* a quantity of floors over a sample: values and rates at both ends, the bound of its fourth derivative, its largest values */
struct sampled {
	const struct column *u0, *v0, *u1, *v1, *fourth_max, *top;
	struct column *reach, *top_next;
};

/* Lanes that may have a largest value inside the sample. */
LANE_INLINE unsigned sampled_peaks(const struct chain *c, const struct sampled *x)
{
	const vd h = vsplat(c->task->time_step);
	unsigned some = 0;
	for (int i = 0; i < c->wide; i += W) {
		const struct enclosure enclosure = {column_load(x->u0, i), column_load(x->v0, i) * h,
		                                    column_load(x->u1, i), column_load(x->v1, i) * h,
		                                    column_load(x->fourth_max, i)};
		const vd top = vmax(column_load(x->top, i), vabs(enclosure.u1)), reach = enclosure_reach(&enclosure);
		const vm inside = vless(top, reach);
		some |= vbits(inside);
		column_store(x->reach, i, vselect(inside, reach, vsplat(0)));
		column_store(x->top_next, i, top);
	}
	return some;
}

/* Overlaps of a vector of links at a sample, and their rates. */
LANE_INLINE struct kinematics links_at(const struct chain *c, const struct modal_place *at, int j)
{
	const struct link_ends *ends = &c->ends;
	struct kinematics x = {-lanes_load(&ends->gap[j]), vsplat(0)};
	for (int k = 0; k < ends->n[j / ROW]; k++) {
		const vd weight = lanes_load(&ends->weight[k][j]);
		x.u = vfma(weight, ends_load(ends, k, j, at->u.at), x.u);
		x.v = vfma(weight, ends_load(ends, k, j, at->w.at), x.v);
	}
	return x;
}

/* Whether a link may begin to touch inside the sample that leads to a place. */
static bool links_risk(struct chain *c, const struct modal_place *to)
{
	struct modal_motion *f = &c->modal_motion;
	const struct link_ends *ends = &c->ends;
	const vd zero = vsplat(0), third = vsplat(c->task->time_step / 3);
	vm risk = vmask(0);
	for (int j = 0; j < c->wide_links; j += W) {
		const struct kinematics x = links_at(c, to, j);
		vd fourth_max = zero;
		for (int k = 0; k < ends->n[j / ROW]; k++)
			fourth_max = vfma(vabs(lanes_load(&ends->weight[k][j])),
			                  ends_load(ends, k, j, f->fourth_drift.at), fourth_max);
		const vd b1 = vfma(third, lanes_load(&f->rate[j]), lanes_load(&f->overlap[j]));
		const vd b2 = vfma(-third, x.v, x.u), top = vmax(vmax(b1, b2), x.u);
		lanes_store(&f->overlap_next[j], x.u);
		lanes_store(&f->rate_next[j], x.v);
		risk |= ~vless(vfma(vsplat(POUND_CUBIC_ERROR), fourth_max, top), zero);
	}
	return vany(risk);
}

/* ---- samples that may hold largest values ---- */

LANE_INLINE double *note_column(struct chain *c, int k, int column)
{
	return &c->modal_motion.kept[(k * NOTE_COLUMNS + column) * c->wide];
}

/* Whether a noted sample may still contain a largest value. */
static bool note_stands(struct chain *c, int k)
{
	const struct column *tops[] = {&c->top_drift, &c->top_displacement, &c->top_acceleration};
	for (int m = 0; m < 3; m++) {
		const double *reach = note_column(c, k, NOTE_REACH + m);
		for (int i = 0; i < c->n; i++)
			if (reach[i] > tops[m]->at[i])
				return true;
	}
	return false;
}

/* Notes the sample that ends at c->next, to be examined at the end: usually larger values follow.
 *
 * Returns  value  false: there is no room
 */
LANE_SHARED bool note_keep(struct chain *c, const struct modal_place *from)
{
	static const unsigned asked[] = {POUND_CHAIN_DRIFTS, POUND_CHAIN_DISPLACEMENTS,
	                                 POUND_CHAIN_ACCELERATIONS};
	struct modal_motion *f = &c->modal_motion;
	const size_t bytes = sizeof(double) * (size_t)c->wide;
	if (f->notes == f->room) {
		int kept = 0;
		for (int k = 0; k < f->notes; k++) {
			if (!note_stands(c, k))
				continue;
			f->noted[kept] = f->noted[k];
			memmove(note_column(c, kept++, 0), note_column(c, k, 0), NOTE_COLUMNS * bytes);
		}
		f->notes = kept;
		if (kept == f->room)
			return false;
	}
	const int k = f->notes++;
	f->noted[k] = c->next;
	memcpy(note_column(c, k, NOTE_D), from->d.at, bytes);
	memcpy(note_column(c, k, NOTE_V), from->v.at, bytes);
	memcpy(note_column(c, k, NOTE_SHIFT), f->shift.at, bytes);
	const struct column *reach[] = {&f->reach, &f->displacement_reach, &f->acceleration_reach};
	for (int m = 0; m < 3; m++)
		if (c->task->asked & asked[m])
			memcpy(note_column(c, k, NOTE_REACH + m), reach[m]->at, bytes);
		else
			memset(note_column(c, k, NOTE_REACH + m), 0, bytes);
	return true;
}

/* Integrates a noted sample again, by power series, for its largest values only. */
static void note_look(struct chain *c, int k)
{
	const double *d = note_column(c, k, NOTE_D), *v = note_column(c, k, NOTE_V);
	const double *shift = note_column(c, k, NOTE_SHIFT);
	for (int i = 0; i < c->n; i++) {
		c->d.at[i] = d[i];
		c->v.at[i] = v[i];
		c->stiffness.at[i] = c->initial.at[i];
		c->offset.at[i] = -c->initial.at[i] * shift[i];
	}
	interval_set(c, c->modal_motion.noted[k]);
	while (c->remainder > 0) {
		if (c->moving)
			chain_displacements(c);
		step_choose(c);
		series_chain(c);
		if (c->task->asked & POUND_CHAIN_ACCELERATIONS)
			accelerations_keep(c, 1);
		step_arrive(c, 1);
		step_tops(c, 1);
	}
}

/* Examines the noted samples at the end of a chain. */
static void notes_look(struct chain *c)
{
	struct modal_motion *f = &c->modal_motion;
	if (f->notes == 0)
		return;
	const int n_links = c->n_links;
	const bool edged = c->edged;
	f->at[0].d = c->d;
	f->at[0].v = c->v;
	c->n_links = 0;
	links_list(c); // none acts
	c->edged = c->curved_step.on = false;
	c->pace = 1;
	c->reach = 0;
	for (int k = f->notes - 1; k >= 0; k--)
		if (note_stands(c, k))
			note_look(c, k);
	c->n_links = n_links;
	c->edged = edged;
	c->d = f->at[0].d;
	c->v = f->at[0].v;
}

/* Advances by modes over the sample that ends at c->next, if no event can occur inside.
 *
 * Returns  value  false: an event is possible; the state is unchanged
 */
LANE_INLINE bool modal_sample(struct chain *c, bool edged, bool moving)
{
	struct modal_motion *f = &c->modal_motion;
	const double *a = &c->task->ground[c->next];
	const vd h = vsplat(c->task->time_step), one = vsplat(1);
	const struct modal_place *from = &f->at[f->now];
	struct modal_place *to = &f->at[1 - f->now];
	modes_move(f, c->wide, a[-1], a[0] - a[-1]);
	const bool drifts = c->task->asked & POUND_CHAIN_DRIFTS;
	const bool displaced = c->task->asked & POUND_CHAIN_DISPLACEMENTS;
	const bool accelerated = c->task->asked & POUND_CHAIN_ACCELERATIONS;
	vm risk = vmask(0), inside = vmask(0);
	for (int i = 0; i < c->wide; i += W) {
		const struct drifts s = drifts_sum(f, i);
		const struct enclosure enclosure = {column_load(&from->d, i), column_load(&from->v, i) * h, s.d,
		                                    s.v * h, s.fourth_max};
		column_store(&to->d, i, s.d);
		column_store(&to->v, i, s.v);
		if (moving)
			column_store(&f->fourth_drift, i, s.fourth_max);
		if (edged)
			risk |= may_cross(&enclosure, column_load(&c->high, i), one) |
			        may_cross(&enclosure, column_load(&c->low, i), -one);
		if (!drifts)
			continue;
		const vd top = vmax(column_load(&c->top_drift, i), vabs(s.d));
		const vd reach = enclosure_reach(&enclosure);
		const vm higher = vless(top, reach);
		inside |= higher;
		column_store(&f->reach, i, vselect(higher, reach, vsplat(0)));
		column_store(&f->top, i, top);
	}
	if (vany(risk))
		return false;
	if (moving) {
		double *bound = f->fourth_drift.at;
		floors_sum(c, 3, (const struct summed[]){{to->d.at, to->u.at}, {to->v.at, to->w.at}, {bound, bound}});
		if (c->n_links > 0 && links_risk(c, to))
			return false;
	}
	unsigned peaks = vbits(inside);
	if (displaced)
		peaks |= sampled_peaks(c, &(struct sampled){&from->u, &from->w, &to->u, &to->w, &f->fourth_drift,
		                                            &c->top_displacement, &f->displacement_reach,
		                                            &f->top_displacement});
	if (accelerated) {
		modes_force(f, &f->q_next, &f->v_next, c->wide, a[0]);
		accelerations_sum(c, to);
		peaks |= sampled_peaks(c, &(struct sampled){&from->a, &from->jerk, &to->a, &to->jerk,
		                                            &f->fourth_force, &c->top_acceleration,
		                                            &f->acceleration_reach, &f->top_acceleration});
	}
	if (peaks && !note_keep(c, from))
		return false;
	for (int i = 0; i < c->wide; i += W) {
		column_store(&f->q, i, column_load(&f->q_next, i));
		column_store(&f->v, i, column_load(&f->v_next, i));
		if (drifts)
			column_store(&c->top_drift, i, column_load(&f->top, i));
		if (displaced)
			column_store(&c->top_displacement, i, column_load(&f->top_displacement, i));
		if (accelerated)
			column_store(&c->top_acceleration, i, column_load(&f->top_acceleration, i));
	}
	for (int j = 0; j < c->wide_links; j += W) {
		lanes_store(&f->overlap[j], lanes_load(&f->overlap_next[j]));
		lanes_store(&f->rate[j], lanes_load(&f->rate_next[j]));
	}
	f->now = 1 - f->now;
	f->moved = true;
	return true;
}

/* Sets negligible motion to rest while the ground does not move: subnormal numbers would make every operation a hundred times
 * slower, and bounds useless. */
static void modal_to_rest(struct chain *c)
{
	struct modal_motion *f = &c->modal_motion;
	const double *a = &c->task->ground[c->next];
	if (a[-1] != 0 || a[0] != 0)
		return;
	for (int i = 0; i < c->n; i++)
		if (fabs(f->q.at[i]) >= POUND_AT_REST || fabs(f->v.at[i]) * c->task->time_step >= POUND_AT_REST)
			return;
	memset(&f->q, 0, sizeof f->q);
	memset(&f->v, 0, sizeof f->v);
}

LANE_INLINE void modal_samples(struct chain *c, const atomic_bool *stop, bool edged, bool moving)
{
	for (; c->next < c->task->n_samples; c->next++) {
		if (c->next % STOP_STEPS == 0 && pound_stopped(stop))
			break;
		modal_to_rest(c);
		if (!modal_sample(c, edged, moving))
			break;
	}
}

/* Advances from the sample before c->next by modes until an event is possible.  Tries that pass no sample delay the next try. */
static void modal_advance(struct chain *c, const atomic_bool *stop)
{
	enum { WAIT_MAX = 8 };
	struct modal_motion *f = &c->modal_motion;
	if (f->wait > 0) {
		f->wait--;
		return;
	}
	if (!modal_clear(c))
		return;
	modal_enter(c);
	struct modal_place *at = &f->at[0];
	if (c->moving)
		floors_sum(c, 2, (const struct summed[]){{at->d.at, at->u.at}, {at->v.at, at->w.at}});
	for (int j = 0; j < c->wide_links; j += W) {
		const struct kinematics x = links_at(c, at, j);
		lanes_store(&f->overlap[j], x.u);
		lanes_store(&f->rate[j], x.v);
	}
	if (c->task->asked & POUND_CHAIN_ACCELERATIONS) {
		modes_force(f, &f->q, &f->v, c->wide, c->task->ground[c->next - 1]);
		accelerations_sum(c, &f->at[0]);
	}
	if (c->edged)
		modal_samples(c, stop, true, c->moving);
	else
		modal_samples(c, stop, false, c->moving);
	f->refused = f->moved ? 0 : f->refused < WAIT_MAX ? 2 * f->refused + 1 : f->refused;
	f->wait = f->refused / 2;
	if (!f->moved)
		return;
	for (int i = 0; i < c->wide; i += W) {
		column_store(&c->d, i, column_load(&f->at[f->now].d, i));
		column_store(&c->v, i, column_load(&f->at[f->now].v, i));
	}
}
