/* chain_observer.inl - reports the motion of floors, piece by piece, to the observer of a chain (chain.h).
 *
 * A piece is a step up to its event, and its series are the step's.
 *
 * Included by chain.inl alone, once per lane count, after nonlinear_contact_step.inl. */

/* Coefficient n of a contact's force over a step in time, or in the variable of nonlinear_contact.inl. */
static double link_force_at(const struct chain *c, int j, int n)
{
	const struct link *l = &c->link[j];
	const double per_h2 = 1 / (c->dt * c->dt);
	if (l->held)
		return c->overlaps[n][j] * per_h2;
	return c->curved_step.on ? curve_force(c, j, n) : link_force(c, l, j, n) * per_h2;
}

/* Acceleration of the contacts, or of the observed one, on floor i of order n. */
static double push_at(const struct chain *c, int i, int n)
{
	const int observed = c->task->observer->link;
	double sum = 0;
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		const bool pushes = l->touching && (observed < 0 || j == observed);
		for (int k = 0; pushes && k < l->n_ends; k++)
			if (l->floor[k] == i)
				sum -= l->weight[k] * c->inverse_mass.at[i] * link_force_at(c, j, n);
	}
	return sum;
}

/* Absolute acceleration of floor i of order n. */
static double acceleration_at(const struct chain *c, int i, int n)
{
	const struct curved_step *x = &c->curved_step;
	const double per_h2 = 1 / (c->dt * c->dt);
	double sum = x->on    ? fma(c->slope, x->clock[n], n == 0 ? c->ground : 0)
	             : n == 0 ? c->ground
	             : n == 1 ? c->slope * c->dt
	                      : 0;
	if (i == POUND_CHAIN_GROUND)
		return sum;
	if (!x->on)
		return fma((n + 1.0) * (n + 2.0) * per_h2, c->displacements[n + 2].at[i], sum);
	double floor = 0;
	for (int k = i; k >= 0; k = c->base.at[k] != 0 ? -1 : k - 1)
		floor += x->accelerations[n].at[k];
	return sum + floor;
}

/* Fills the motion of the observed floor and of the level opposite, up to a fraction of the step. */
static void floors_report(const struct chain *c, double time, struct pound_chain_piece *piece)
{
	static const int ground[2] = {POUND_CHAIN_GROUND, POUND_CHAIN_GROUND};
	static const double whole[2] = {1, 0};
	const struct pound_chain_observer *observer = c->task->observer;
	const struct pound_link *link = observer->link >= 0 ? &c->task->links[observer->link] : NULL;
	const int *floor = link ? link->floor[1] : ground;
	const double *weight = link ? link->weight[1] : whole;
	struct pound_chain_floor_motion *own = &piece->floors[0], *other = &piece->floors[1];
	double power = 1;
	own->u = c->u.at[observer->floor];
	own->v = c->w.at[observer->floor];
	own->jump = c->jump;
	memset(other, 0, sizeof *other);
	for (int k = 0; k < 2; k++)
		if (floor[k] != POUND_CHAIN_GROUND) {
			other->u += weight[k] * c->u.at[floor[k]];
			other->v += weight[k] * c->w.at[floor[k]];
		}
	for (int n = 0; n <= piece->order; n++, power *= time) {
		own->acceleration[n] = acceleration_at(c, observer->floor, n) * power;
		own->push[n] = push_at(c, observer->floor, n) * power;
		for (int k = 0; k < 2; k++)
			if (weight[k] != 0)
				other->acceleration[n] += weight[k] * acceleration_at(c, floor[k], n) * power;
	}
}

/* Reports the motion of the observed floors up to a fraction of the step. */
static void pieces_report(struct chain *c, double time)
{
	const struct pound_chain_observer *observer = c->task->observer;
	const struct curved_step *x = &c->curved_step;
	struct pound_chain_piece piece = {.time = chain_time(c),
	                                  .ground = c->ground,
	                                  .slope = c->slope,
	                                  .order = x->on ? ORDER_HIGH : c->order - 2,
	                                  .sampled = c->remainder == c->task->time_step,
	                                  .after_event = c->after_event,
	                                  .time_is_series = x->on && x->power > 0};
	double power = 1;
	for (int n = 0; n <= ORDER_HIGH && x->on; n++, power *= time)
		piece.clock[n] = x->clock[n] * power;
	piece.length = !x->on ? time * c->dt : x->sampled ? c->remainder : series_at(x->clock, 1, time);
	for (int j = 0; j < c->n_links; j++)
		for (int k = 0; k < c->link[j].n_ends; k++)
			piece.touching |= c->link[j].touching && c->link[j].floor[k] == observer->floor;
	if (observer->link >= 0) {
		const struct link *l = &c->link[observer->link];
		piece.overlap = l->own ? l->p : link_sum(l, c->u.at) - l->link->gap;
		piece.overlap_rate = l->own ? l->q : link_sum(l, c->w.at);
	}
	floors_report(c, time, &piece);
	c->jump = 0;
	c->after_event = false;
	observer->observe(observer->into, &piece);
}
