/* nonlinear_contact_step.inl - the step of nonlinear_contact.inl up to its first event.
 *
 * Included by chain.inl alone, once per lane count, after chain_energy.inl. */

/* Searches for the time at which a series rises above 0. */
static void curve_search(struct first *first, const struct chain *c, const double guard[TERMS], int event,
                         int index)
{
	struct power g;
	for (int n = 0; n <= ORDER_HIGH; n++)
		g.c[n] = vsplat(guard[n]);
	const struct enclosure enclosure = enclosure_make(&g, c->order);
	const vd zero = vsplat(0), one = vsplat(1);
	const vm lane = vmask(1) & may_cross(&enclosure, zero, one);
	const int lanes[W] = {index};
	if (vany(lane))
		guard_search(first, c, guard_of(&g, &enclosure, zero, one), lane, event, lanes);
}

/* Fills a guard with a series times a sign. */
static void guard_fill(double guard[TERMS], const double *series, double sign)
{
	for (int n = 0; n <= ORDER_HIGH; n++)
		guard[n] = sign * series[n];
}

/* Searches for the end of a contact at zero force, or for the return of the force: K p^1.25 + c q has the force's sign. */
static void forced_search(struct first *first, const struct chain *c, int j)
{
	const struct curved_step *x = &c->curved_step;
	const struct link *l = &c->link[j];
	const struct curve *v = &x->links[j];
	const double K = l->at.on.stiffness, C = l->at.on.damping;
	const double sign = l->touching ? -1 : 1;
	double guard[TERMS];
	for (int n = 0; n <= ORDER_HIGH; n++) {
		const double power =
		    j == x->master ? product_at(x->w2, x->w3, n) : product_at(v->overlap, v->quarter, n);
		guard[n] = sign * fma(K, power, C * v->rate[n]);
	}
	// a force that has just passed 0 is taken as beyond it (chain_events.inl: forces_search)
	if (l->fresh)
		guard[0] = fmin(guard[0], -DBL_EPSILON * C * fabs(l->q));
	curve_search(first, c, guard, l->touching ? EVENT_ENDS : EVENT_BEGINS, j);
}

/* Searches for the edges of a contact with a nonlinear force. */
static void curved_search(struct first *first, const struct chain *c, int j)
{
	const struct curved_step *x = &c->curved_step;
	const struct link *l = &c->link[j];
	double guard[TERMS];
	if (x->still && link_still(l))
		return;
	if (l->touching && l->at.on.direction != 0) {
		guard_fill(guard, x->links[j].rate, -l->at.on.direction);
		curve_search(first, c, guard, EVENT_LINK + POUND_EDGE_REVERSAL, j);
	}
	if (j == x->master)
		guard_fill(guard, x->w, -1);
	else if (x->links[j].beside)
		guard_fill(guard, x->links[j].ratio, -1);
	else
		guard_fill(guard, x->links[j].overlap, -1);
	curve_search(first, c, guard, l->touching ? EVENT_LINK + POUND_EDGE_LOW : EVENT_CLEARS, j);
	if (!l->link->law.tension && l->at.on.form == POUND_TOUCH_ROOT)
		forced_search(first, c, j);
}

/* The first event of a step, or the sample at the end of the interval if it comes first. */
static struct first nonlinear_events(struct chain *c)
{
	struct curved_step *x = &c->curved_step;
	struct first first = events_search(c);
	for (int j = 0; j < c->n_links; j++)
		if (link_curved(&c->link[j]))
			curved_search(&first, c, j);
	x->sampled = false;
	if (x->power == 0) {
		x->sampled = first.event == EVENT_NONE && x->length >= c->remainder;
		return first;
	}
	struct first sample = {.time = 1, .event = EVENT_NONE, .index = -1};
	double guard[TERMS];
	memcpy(guard, x->clock, sizeof guard);
	guard[0] = -c->remainder;
	curve_search(&sample, c, guard, EVENT_CLEARS, 0);
	if (sample.event == EVENT_CUT && sample.time < first.time)
		return sample;
	if (sample.event != EVENT_NONE && sample.time < first.time) {
		x->sampled = true;
		return (struct first){.time = sample.time, .event = EVENT_NONE, .index = -1};
	}
	return first;
}

/* Integral of a series over the time up to a share of the step. */
static double curved_integral(const struct curved_step *x, const double series[TERMS], double time)
{
	double sum = 0;
	for (int n = ORDER_HIGH; n >= 0; n--)
		sum = fma(sum, time, POUND_SHARE[n] * (x->power == 0 ? series[n] : product_at(x->gauge, series, n)));
	return sum * time * x->length;
}

/* The impulse of a contact up to a share of the step. */
static double curve_impulse(const struct chain *c, int j, double time)
{
	double force[TERMS];
	for (int n = 0; n <= ORDER_HIGH; n++)
		force[n] = curve_force(c, j, n);
	return curved_integral(&c->curved_step, force, time);
}

/* Moves floors and links to a fraction of the step. */
static void nonlinear_arrive(struct chain *c, double time)
{
	struct curved_step *x = &c->curved_step;
	for (int i = 0; i < c->wide; i += W) {
		struct power d, v;
		power_load(&d, c->order, c->drifts, i);
		power_load(&v, c->order, x->rates, i);
		column_store(&c->d, i, power_at(&d, c->order, vsplat(time)));
		column_store(&c->v, i, power_at(&v, c->order, vsplat(time)));
	}
	const double elapsed = x->sampled ? c->remainder : series_at(x->clock, 1, time);
	for (int j = 0; j < c->n_links; j++) {
		struct link *l = &c->link[j];
		if (!l->own)
			continue;
		if (l->held) {
			double force[TERMS];
			for (int n = 0; n <= ORDER_HIGH; n++)
				force[n] = c->overlaps[n][j];
			l->impulse += curved_integral(x, force, time);
			l->time += elapsed;
			l->p = l->q = 0;
			continue;
		}
		if (l->touching) {
			l->impulse += curve_impulse(c, j, time);
			l->time += elapsed;
		}
		l->p = series_at(x->links[j].overlap, 1, time);
		l->q = series_at(x->links[j].rate, 1, time);
		if (j == x->master)
			l->p = curved_overlap(x, time);
		else if (x->links[j].beside)
			l->p = curved_overlap(x, time) * series_at(x->links[j].ratio, 1, time);
		l->fresh = false;
	}
	c->ground = fma(c->slope, elapsed, c->ground);
	c->remainder = x->sampled ? 0 : fmax(c->remainder - elapsed, 0);
}
