/* adaptive_motion.c - the equations of motion of the adaptive solver: floors, stories and contacts on their present branches,
 * extended beyond the ends of the branches. */
#include "engine/solver/adaptive.h"

#include <gsl/gsl_errno.h>
#include <string.h>

/* ---- scenes ---- */

/* Adds a floor to a contact.  The weights of the floors of a side add up to 1 less the weight of the ground. */
static void link_join(struct adaptive_scene *s, struct adaptive_link *l, int floor, double weight)
{
	l->floor[l->n_ends] = floor;
	l->weight[l->n_ends++] = weight;
	l->inverse_mass += weight * weight * s->floors[floor].inverse_mass;
}

/* Fills a scene with a row of buildings at rest.
 *
 * Given    s   with its arrays, all 0
 */
void pound_adaptive_lay_row(struct adaptive_scene *s, const struct pound_chain_task *task)
{
	for (int i = 0, base = 0; i < s->n; i++) {
		const struct pound_chain_floor *floor = &task->floors[i];
		const bool above = i + 1 < s->n && !floor[1].base;
		base = floor->base ? i : base;
		s->floors[i] = (struct adaptive_floor){.story = &floor->story,
		                                       .per_mass = 1 / floor->mass,
		                                       .damping = floor->dashpot / floor->mass,
		                                       .mass_damping = floor->mass_damping,
		                                       .modal = floor->modal,
		                                       .above = above ? floor[1].mass / floor->mass : 0,
		                                       .inverse_mass = 1 / floor->mass,
		                                       .drive = 1,
		                                       .inner = !floor->base,
		                                       .base = base};
		s->floors[base].storeys = i - base + 1;
		for (int j = base + 1; j <= i; j++)
			s->floors[j].storeys = i - base + 1;
	}
	for (int k = 0; k < s->n_links; k++) {
		const struct pound_link *link = &task->links[k];
		struct adaptive_link *l = &s->links[k];
		double driven[2] = {0, 0};
		*l = (struct adaptive_link){.law = link->law, .meets = true, .gap = link->gap};
		for (int side = 0; side < 2; side++)
			for (int end = 0; end < 2; end++) {
				const double weight = link->weight[side][end];
				if (link->floor[side][end] == POUND_CHAIN_GROUND || weight == 0)
					continue;
				driven[side] += weight;
				link_join(s, l, link->floor[side][end], side ? -weight : weight);
			}
		l->drive = driven[1] - driven[0];
		l->impulse_unit = 1 / l->inverse_mass;
	}
}

/* Fills a scene with a pair; contact forces are per left mass.
 *
 * Given    s   with its arrays, all 0
 */
void pound_adaptive_lay_pair(struct adaptive_scene *s, const struct pound_task *task)
{
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *body = &task->bodies[i];
		s->floors[i] = (struct adaptive_floor){.story = &body->backbone,
		                                       .per_mass = 1,
		                                       .damping = body->damping,
		                                       .inverse_mass = i ? task->mass_ratio : 1,
		                                       .drive = body->drive,
		                                       .base = i,
		                                       .storeys = 1,
		                                       .u = body->u,
		                                       .v = body->v};
	}
	s->links[0] = (struct adaptive_link){.law = pound_task_law(task),
	                                     .meets = task->contact,
	                                     .gap = task->gap,
	                                     .drive = task->bodies[1].drive - task->bodies[0].drive,
	                                     .impulse_unit = 1};
	link_join(s, &s->links[0], 0, 1);
	link_join(s, &s->links[0], 1, -1);
}

/* ---- equations ---- */

/* Acceleration of a floor from the story below it [m/s2]. */
static double own_acceleration(const struct adaptive_floor *f, double d, double rate)
{
	return -f->damping * rate - f->per_mass * f->at.branch.stiffness * d - f->per_mass * f->at.branch.offset;
}

/* Velocity of a floor relative to the ground: the sum of the drift rates below it [m/s]. */
double pound_adaptive_velocity(const struct adaptive_scene *s, int i, const double *y)
{
	double v = 0;
	for (int j = s->floors[i].base; j <= i; j++)
		v += y[rate_state(j)];
	return v;
}

/* Fills `still`: accelerations of floors from stories and damping, without ground motion and contacts [m/s2]. */
static void still_fill(const struct adaptive_scene *s, const double *y)
{
	double below = 0; // velocity
	for (int i = 0; i < s->n; i++) {
		const struct adaptive_floor *f = &s->floors[i];
		const double rate = y[rate_state(i)], v = f->inner ? below + rate : rate;
		below = v;
		s->still[i] = own_acceleration(f, y[drift_state(i)], rate);
		if (f->above > 0)
			s->still[i] -= f->above * own_acceleration(f + 1, y[drift_state(i + 1)], y[rate_state(i + 1)]);
		if (f->mass_damping > 0)
			s->still[i] -= f->mass_damping * v;
		for (int j = 0; f->modal && j < f->storeys; j++)
			s->still[i] -= f->inverse_mass * f->modal[j] * y[rate_state(f->base + j)];
	}
}

/* Overlap acceleration of a contact without contact forces [m/s2]; after still_fill.
 *
 * The ground acceleration enters once, by `drive`: in a difference of two floor accelerations it would cancel only to rounding
 * errors, which would decide which bodies meet when the ground begins to move.
 */
static double apart_of(const struct adaptive_scene *s, const struct adaptive_link *l, double t)
{
	const double a = s->ground + s->slope * t;
	double own = 0;
	for (int e = 0; e < l->n_ends; e++)
		own += l->weight[e] * s->still[l->floor[e]];
	return l->drive * a + own;
}

/* Overlap acceleration of a contact without contact forces [m/s2]; > 0: its sides are pressed together. */
double pound_adaptive_apart(const struct adaptive_scene *s, int k, double t, const double *y)
{
	still_fill(s, y);
	return apart_of(s, &s->links[k], t);
}

/* Force of a contact; of a rigid one the force that keeps the overlap constant.  After still_fill. */
static double force_of(const struct adaptive_scene *s, int k, double t, const double *y)
{
	const struct adaptive_link *l = &s->links[k];
	const double *p = &y[overlap_state(s, k)];
	if (l->held)
		return apart_of(s, l, t) / l->inverse_mass;
	return l->touching ? pound_contact_force_on(&l->touch.on, p[0], p[1]) : 0;
}

/* Contribution of all other contacts to the overlap acceleration of a contact [m/s2]. */
static double others_push(const struct adaptive_scene *s, const struct adaptive_link *l, double force)
{
	double sum = 0;
	for (int e = 0; e < l->n_ends; e++) {
		const int i = l->floor[e];
		sum += l->weight[e] * (s->push[i] + l->weight[e] * s->floors[i].inverse_mass * force);
	}
	return sum;
}

/* The right-hand side for GSL: dydt of the states y at time t in the interval. */
int pound_adaptive_derivative(double t, const double *y, double *dydt, void *of)
{
	const struct adaptive_scene *s = of;
	const double a = s->ground + s->slope * t;
	still_fill(s, y);
	memset(s->push, 0, sizeof(double) * (size_t)s->n);
	for (int k = 0; k < s->n_links; k++) {
		const struct adaptive_link *l = &s->links[k];
		const double force = dydt[overlap_state(s, k) + 2] = force_of(s, k, t, y);
		for (int e = 0; e < l->n_ends && l->touching; e++)
			s->push[l->floor[e]] += -l->weight[e] * s->floors[l->floor[e]].inverse_mass * force;
	}
	for (int i = 0; i < s->n; i++) {
		const struct adaptive_floor *f = &s->floors[i];
		dydt[drift_state(i)] = y[rate_state(i)];
		dydt[rate_state(i)] = f->inner ? (s->still[i] + s->push[i]) - (s->still[i - 1] + s->push[i - 1])
		                               : -f->drive * a + s->still[i] + s->push[i];
	}
	for (int k = 0; k < s->n_links; k++) {
		const struct adaptive_link *l = &s->links[k];
		const int p = overlap_state(s, k);
		dydt[p] = y[p + 1];
		dydt[p + 1] =
		    l->held ? 0 : apart_of(s, l, t) - l->inverse_mass * dydt[p + 2] + others_push(s, l, dydt[p + 2]);
	}
	return GSL_SUCCESS;
}

/* ---- gradients ---- */

/* Adds `times` the gradient of a floor's acceleration from the story below it. */
static void story_gradient(const struct adaptive_scene *s, int i, double times, double *row)
{
	const struct adaptive_floor *f = &s->floors[i];
	row[drift_state(i)] += times * -(f->per_mass * f->at.branch.stiffness);
	row[rate_state(i)] += times * -f->damping;
}

/* Adds `times` the gradient of a floor's acceleration relative to the ground. */
static void floor_gradient(const struct adaptive_scene *s, int i, const double *y, double times, double *row)
{
	const struct adaptive_floor *f = &s->floors[i];
	story_gradient(s, i, times, row);
	if (f->above > 0)
		story_gradient(s, i + 1, -times * f->above, row);
	for (int j = f->base; j <= i && f->mass_damping > 0; j++)
		row[rate_state(j)] -= times * f->mass_damping;
	for (int j = 0; f->modal && j < f->storeys; j++)
		row[rate_state(f->base + j)] -= times * f->inverse_mass * f->modal[j];
	for (int k = 0; k < s->n_links; k++) {
		const struct adaptive_link *l = &s->links[k];
		const int p = overlap_state(s, k);
		for (int e = 0; e < l->n_ends && l->touching && !l->held; e++) {
			if (l->floor[e] != i)
				continue;
			// products and powers: without the derivative of the dashpot's coefficient with respect to the overlap
			const struct pound_touch_line line = pound_contact_line(&l->touch.on, y[p]);
			const double share = -l->weight[e] * f->inverse_mass;
			row[p] += times * (share * line.slope);
			row[p + 1] += times * (share * line.rate);
		}
	}
}

/* The gradient of the overlap acceleration of a contact. */
static void overlap_gradient(const struct adaptive_scene *s, int k, const double *y, double *row)
{
	const struct adaptive_link *l = &s->links[k];
	memset(row, 0, sizeof(double) * (size_t)s->n_states);
	for (int e = 0; e < l->n_ends; e++)
		floor_gradient(s, l->floor[e], y, l->weight[e], row);
}

/* The Jacobian of the right-hand side for GSL: dfdy (n_states x n_states), dfdt (n_states). */
int pound_adaptive_jacobian(double t, const double *y, double *dfdy, double *dfdt, void *of)
{
	const struct adaptive_scene *s = of;
	const int n = s->n_states;
	(void)t;
	memset(dfdy, 0, sizeof(double) * (size_t)n * (size_t)n);
	memset(dfdt, 0, sizeof(double) * (size_t)n);
	for (int i = 0; i < s->n; i++) {
		double *row = dfdy + rate_state(i) * n;
		dfdy[drift_state(i) * n + rate_state(i)] = 1;
		floor_gradient(s, i, y, 1, row);
		if (s->floors[i].inner)
			floor_gradient(s, i - 1, y, -1, row);
		else
			dfdt[rate_state(i)] = -s->floors[i].drive * s->slope;
	}
	for (int k = 0; k < s->n_links; k++) {
		const struct adaptive_link *l = &s->links[k];
		const int p = overlap_state(s, k);
		dfdy[p * n + p + 1] = 1;
		overlap_gradient(s, k, y, dfdy + (p + 1) * n);
		dfdt[p + 1] = l->drive * s->slope;
		if (!l->touching || l->held)
			continue;
		const struct pound_touch_line line = pound_contact_line(&l->touch.on, y[p]);
		dfdy[(p + 2) * n + p] = line.slope;
		dfdy[(p + 2) * n + p + 1] = line.rate;
	}
	return GSL_SUCCESS;
}

/* Time derivative of the overlap acceleration of a contact [m/s3]. */
double pound_adaptive_jerk(const struct adaptive_scene *s, int k, const double *y, const double *dydt)
{
	double jerk = s->links[k].drive * s->slope;
	overlap_gradient(s, k, y, s->row);
	for (int j = 0; j < s->n_states; j++)
		jerk += s->row[j] * dydt[j];
	return jerk;
}
