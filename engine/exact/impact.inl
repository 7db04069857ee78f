/* impact.inl - rigid contacts: impacts with velocity jumps, and bodies that stay together after their rebounds have decayed.
 *
 *   an impact        q becomes -e q by J = (1 + e) m q, which acts on the floors of both sides by weights
 *   staying together p'' = 0: forces f of each order from J M^-1 J^T f = relative accelerations without them, until one falls
 *                    through 0
 *
 * Included by chain.inl alone, once per lane count, after nonlinear_contact.inl. */

enum {
	REFINEMENTS = 2, /* solutions per order: the first, and iterative refinement by its residual */
	ROUNDS_A_LINK = 4,
};

static const double HOPS_END =
    1e-12; /* fraction of a sample: if all further rebounds take less time, the sides stay together */

static bool link_rigid(const struct link *l)
{
	return pound_contact_force(l->link->law.model) == POUND_FORCE_IMPACT;
}

/* ---- staying together ---- */

/* Order n of a floor's acceleration, in the units of the step, without the forces of held contacts not yet added. */
static double floor_acceleration(const struct chain *c, int i, int n, double ground)
{
	double force = 0, damping;
	for (int above = 0; above < 2; above++) {
		const int k = i + above;
		if (above && c->inverse_above.at[i] == 0)
			break;
		double s;
		if (c->curved_step.on)
			s = fma(c->dashpot.at[k], c->curved_step.rates[n].at[k],
			        c->stiffness.at[k] * c->drifts[n].at[k]) +
			    (n == 0 ? c->offset.at[k] : 0);
		else
			s = fma(c->dash.at[k] * (n + 1), c->drifts[n + 1].at[k], c->spring.at[k] * c->drifts[n].at[k]) +
			    (n == 0 ? c->force.at[k] : 0);
		force += above ? s : -s;
	}
	if (c->mass_damping.at[i] == 0)
		damping = 0;
	else if (c->curved_step.on) {
		damping = 0;
		for (int k = i; k >= 0; k = c->base.at[k] != 0 ? -1 : k - 1)
			damping += c->curved_step.rates[n].at[k];
		damping *= c->mass_damping.at[i];
	} else
		damping = c->mass_damping_step.at[i] * (n + 1) * c->displacements[n + 1].at[i];
	return fma(force, c->inverse_mass.at[i], -c->push.at[i] - damping - ground);
}

/* Relative acceleration (or velocity) of the sides of each held link, by forces (or impulses) on all held links. */
static void held_apply(const struct chain *c, const double *push, double *closing)
{
	double floors[POUND_CHAIN_FLOORS];
	memset(floors, 0, sizeof *floors * (size_t)c->task->n_floors);
	for (int j = 0; j < c->n_links; j++)
		for (int k = 0; c->link[j].held && k < c->link[j].n_ends; k++) {
			const int i = c->link[j].floor[k];
			floors[i] = fma(c->link[j].weight[k] * c->inverse_mass.at[i], push[j], floors[i]);
		}
	for (int j = 0; j < c->n_links; j++) {
		closing[j] = 0;
		for (int k = 0; c->link[j].held && k < c->link[j].n_ends; k++)
			closing[j] = fma(c->link[j].weight[k], floors[c->link[j].floor[k]], closing[j]);
	}
}

/* Solves J M^-1 J^T f = b for the held links, by conjugate gradients preconditioned by the diagonal: links that share no floor, or
 * only heavy ones, take few iterations, and nearly dependent links do no harm.
 *
 * Given    b    (n_links)
 * Returns  f    (n_links), 0 of links that are not held
 * Source   Hestenes and Stiefel 1952, J. Res. NBS 49, 409-436
 */
static void held_solve(const struct chain *c, const double *b, double *f)
{
	double left[LINKS], way[LINKS], closing[LINKS], size = 0;
	int held = 0;
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		left[j] = l->held ? b[j] : 0;
		way[j] = left[j] / l->inverse_mass;
		f[j] = 0;
		size = fma(left[j], way[j], size);
		held += l->held;
	}
	const double least = DBL_EPSILON * DBL_EPSILON * size;
	for (int round = 0; round < ROUNDS_A_LINK * held && size > least; round++) {
		double along = 0, next = 0;
		held_apply(c, way, closing);
		for (int j = 0; j < c->n_links; j++)
			along = fma(way[j], closing[j], along);
		if (!(along > 0))
			break;
		const double share = size / along;
		for (int j = 0; j < c->n_links; j++) {
			f[j] = fma(share, way[j], f[j]);
			left[j] = fma(-share, closing[j], left[j]);
			next = fma(left[j], left[j] / c->link[j].inverse_mass, next);
		}
		for (int j = 0; j < c->n_links; j++)
			way[j] = fma(next / size, way[j], left[j] / c->link[j].inverse_mass);
		size = next;
	}
}

/* Adds order n of the forces of held links.
 *
 * Given    ground  of order n
 * Returns  overlaps  of held links, whose overlap is 0: their forces instead
 */
static void held_push(struct chain *c, int n, double ground)
{
	double closing[LINKS] = {0}, force[LINKS];
	for (int j = 0; j < c->n_links; j++)
		c->overlaps[n][j] = c->link[j].held ? 0 : c->overlaps[n][j];
	for (int k = 0; k < REFINEMENTS; k++) {
		for (int j = 0; j < c->n_links; j++) {
			const struct link *l = &c->link[j];
			closing[j] = 0;
			for (int e = 0; l->held && e < l->n_ends; e++)
				closing[j] = fma(l->weight[e], floor_acceleration(c, l->floor[e], n, ground), closing[j]);
		}
		held_solve(c, closing, force);
		for (int j = 0; j < c->n_links; j++) {
			if (!c->link[j].held)
				continue;
			c->overlaps[n][j] += force[j];
			push_add(c, &c->link[j], force[j]);
		}
	}
}

/* Sum of magnitudes of the terms of a held contact's force at the start of a step, in the units of the step. */
static double held_terms(const struct chain *c, const struct link *l)
{
	const double h2 = c->dt * c->dt;
	double made = 0;
	for (int k = 0; k < l->n_ends; k++)
		made += fabs(l->weight[k]) * (floor_terms(c, l->floor[k], 0) + fabs(c->ground) * h2);
	return made / l->inverse_mass;
}

/* Releases a held contact, with zero overlap. */
static void held_end(struct link *l)
{
	l->held = l->touching = false;
	l->p = l->q = 0;
}

/* ---- impacts ---- */

/* Changes velocities by an impulse between the sides of a link. */
static void impulse_apply(struct chain *c, const struct link *by, double impulse)
{
	for (int k = 0; k < by->n_ends; k++) {
		const int i = by->floor[k];
		const double change = -by->weight[k] * impulse * c->inverse_mass.at[i];
		c->v.at[i] += change;
		if (c->inverse_above.at[i] != 0)
			c->v.at[i + 1] -= change;
		if (c->task->observer && c->task->observer->floor == i)
			c->jump += change;
		for (int j = 0; j < c->n_links; j++) {
			struct link *l = &c->link[j];
			for (int e = 0; l->own && e < l->n_ends; e++)
				if (l->floor[e] == i)
					l->q = fma(l->weight[e], change, l->q);
		}
	}
}

/* Gives bodies that are held together a common velocity, conserving momentum. */
static void held_merge(struct chain *c)
{
	double closing[LINKS] = {0}, impulse[LINKS];
	for (int j = 0; j < c->n_links; j++)
		closing[j] = c->link[j].held ? c->link[j].q : 0;
	held_solve(c, closing, impulse);
	for (int j = 0; j < c->n_links; j++) {
		if (!c->link[j].held)
			continue;
		impulse_apply(c, &c->link[j], impulse[j]);
		c->link[j].impulse += impulse[j];
		c->work_gap += 0.5 * impulse[j] * closing[j];
		c->work_link[j] += 0.5 * impulse[j] * closing[j];
	}
	for (int j = 0; j < c->n_links; j++)
		if (c->link[j].held)
			c->link[j].q = 0;
}

/* Releases held links whose sides have got different velocities by another link's impact. */
static void held_separate(struct chain *c)
{
	for (int j = 0; j < c->n_links; j++) {
		struct link *l = &c->link[j];
		const double q = l->q;
		if (!l->held || q == 0)
			continue;
		held_end(l);
		l->q = q;
	}
}

/* Relative acceleration of the sides of a link without its force [m/s2]. */
static double link_acceleration(struct chain *c, const struct link *l)
{
	double sum = 0;
	c->dt = 1;
	chain_displacements(c);
	links_list(c);
	series_start(c);
	pushes_set(c, 0);
	held_push(c, 0, c->ground);
	for (int k = 0; k < l->n_ends; k++)
		sum = fma(l->weight[k], floor_acceleration(c, l->floor[k], 0, c->ground), sum);
	return sum;
}

/* Reports a contact that counts. */
static void contact_record(const struct chain *c, const struct link *l, double end, double impulse)
{
	const struct pound_chain_recorder *recorder = c->task->recorder;
	if (recorder)
		recorder->record(recorder->into, &(struct pound_chain_contact){.link = (int)(l - c->link),
		                                                               .begin = l->begin,
		                                                               .end = end,
		                                                               .speed = l->speed,
		                                                               .impulse = impulse});
}

/* The impact of two sides that meet.
 *
 * Given    l   p = 0, q >= 0
 */
static void impact(struct chain *c, struct link *l, double time)
{
	const struct pound_contact_law *law = &l->link->law;
	double *m = l->measures, q = fmax(l->q, 0), e = law->restitution;
	const bool time_is_series = c->curved_step.on;
	c->curved_step.on = false;
	l->own = true;
	l->p = 0;
	const double a = link_acceleration(c, l);
	const double hops = e < 1 ? 2 * e * q / (a * (1 - e)) : INFINITY;
	// sides that meet with zero speed are driven together by an acceleration or a higher derivative
	const bool stays = q == 0 || (a > 0 && hops < HOPS_END * c->task->time_step);
	const double impulse = (1 + (stays ? 0 : e)) * q / l->inverse_mass;
	l->held = l->touching = stays;
	l->impulse = 0;
	memset(&l->at, 0, sizeof l->at);
	if (stays) {
		l->q = q;
		held_merge(c);
	} else {
		impulse_apply(c, l, impulse);
		l->q = -e * q;
		c->work_gap += 0.5 * (1 - e * e) * q * q / l->inverse_mass;
		c->work_link[l - c->link] += 0.5 * (1 - e * e) * q * q / l->inverse_mass;
		held_separate(c);
	}
	m[POUND_LINK_IMPULSE_MAX] = fmax(m[POUND_LINK_IMPULSE_MAX], impulse);
	m[POUND_LINK_SPEED_MAX] = fmax(m[POUND_LINK_SPEED_MAX], q);
	if (q >= law->speed_floor) {
		if (m[POUND_LINK_CONTACTS]++ == 0) {
			m[POUND_LINK_FIRST_TIME] = time;
			m[POUND_LINK_FIRST_SPEED] = q;
		}
		l->begin = time;
		l->speed = q;
		contact_record(c, l, time, impulse);
	}
	c->reach = 0;
	c->curved_step.on = time_is_series;
}
