/* chain_energy.inl - the work done in a step of a chain.
 *
 *   put in    -sum m a_g v        absorbed    sum (r + c d') d' + a0 m v^2 + v C d' + F q
 *
 * by quadrature over the step's series, independently of the equations of motion that produced them.
 *
 * Included by chain.inl alone, once per lane count, after chain_peaks.inl. */

/* Value of a series of one floor or link at a time, and its rate by the share of the step. */
static double column_at(const double *first, size_t stride, int order, double t, double *rate)
{
	double value = first[(size_t)order * stride], slope = 0;
	for (int n = order - 1; n >= 0; n--) {
		slope = fma(slope, t, value);
		value = fma(value, t, first[(size_t)n * stride]);
	}
	*rate = slope;
	return value;
}

static double series_at(const double *first, size_t stride, double t)
{
	double rate;
	return column_at(first, stride, ORDER_HIGH, t, &rate);
}

/* Overlap of the master contact from w, accurate however small. */
static double curved_overlap(const struct curved_step *x, double t)
{
	const double w = series_at(x->w, 1, t);
	return x->power == 1 ? w * w : w * w * (w * w);
}

/* powers at one time of a step, and the kinetic energy */
struct powers {
	double in, out, moving;
};

/* Adds the works on springs and contacts at that time.
 *
 * Given    weight  of that time in the step [s]
 */
static struct powers powers_at(struct chain *c, double t, double weight)
{
	const struct curved_step *x = &c->curved_step;
	double pace = 1; // of time by the share of the step, over c->dt
	const struct pound_chain_task *task = c->task;
	const double h = c->dt, elapsed = x->on ? series_at(x->clock, 1, t) : t * h;
	const double ground = fma(c->slope, elapsed, c->ground);
	double moving = 0; // velocity of the floor below
	if (x->on)
		pace = x->length * series_at(x->gauge, 1, t);
	struct powers p = {0, 0, 0};
	double rates[LONG];
	for (int i = 0; i < c->n; i++) {
		const double m = task->floors[i].mass;
		double w, v;
		column_at(&c->displacements[0].at[i], LONG, c->order, t, &w);
		const double d = column_at(&c->drifts[0].at[i], LONG, c->order, t, &v);
		w /= h, v /= h;
		if (x->on) {
			v = series_at(&x->rates[0].at[i], LONG, t);
			w = moving = fma(c->inner.at[i], moving, v);
		}
		rates[i] = v;
		p.in -= m * ground * w;
		const double spring = fma(c->stiffness.at[i], d, c->offset.at[i]);
		p.out += (spring + c->dashpot.at[i] * v) * v + c->mass_damping.at[i] * m * w * w;
		c->work_story.at[i] += weight * pace * spring * v;
		p.moving += 0.5 * m * w * w;
	}
	for (int first = 0, stories; c->modal && first < c->n; first += stories) {
		stories = building_stories(task, first);
		double w = 0;
		for (int i = 0; i < stories && task->floors[first + i].modal; i++) {
			w += rates[first + i];
			for (int j = 0; j < stories; j++)
				p.out += w * task->floors[first + i].modal[j] * rates[first + j];
		}
	}
	for (int j = 0; j < c->n_links; j++) {
		const struct pound_touch_branch *on = &c->link[j].at.on;
		double q, power;
		if (!c->link[j].touching)
			continue;
		const double overlap = column_at(&c->overlaps[0][j], LINKS, c->order, t, &q);
		q /= h;
		if (x->on) {
			q = series_at(x->links[j].rate, 1, t);
			power = pound_contact_force_on(on, j == x->master ? curved_overlap(x, t) : overlap, q) * q;
		} else
			power = fma(on->stiffness, overlap, fma(on->damping, q, on->offset)) * q;
		p.out += power;
		c->work_link[j] += weight * pace * power;
	}
	p.in *= pace, p.out *= pace;
	return p;
}

/* Adds the energy balance of a step that ended at a fraction of its length.  The largest kinetic energy is also taken at the
 * nodes, as the ground may take it back before the end of the step. */
static void energy_keep(struct chain *c, double time)
{
	const double elapsed = time * c->dt;
	double in = 0, out = 0, most = 0;
	for (int k = 0; k < POUND_GAUSS; k++) {
		const double node = k % 2 ? POUND_GAUSS_NODE[k / 2] : -POUND_GAUSS_NODE[k / 2];
		const double weight = 0.5 * POUND_GAUSS_WEIGHT[k / 2];
		const struct powers p = powers_at(c, (0.5 + 0.5 * node) * time, weight * elapsed);
		in += weight * p.in;
		out += weight * p.out;
		most = fmax(most, p.moving);
	}
	c->work_in = fma(elapsed, in, c->work_in);
	const double gap = fma(elapsed, out - in, c->work_low), sum = c->work_gap + gap;
	c->work_low = gap - (sum - c->work_gap);
	c->work_gap = sum;
	c->work_top = fmax(c->work_top, fmax(fabs(c->work_in), fmax(most, powers_at(c, time, 0).moving)));
}
