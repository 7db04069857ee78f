/* fixed_step.c - two integrators with a fixed step: Newmark's average acceleration and central differences.
 *
 * 1. A sample interval is divided into the fewest equal steps that are not longer than the requested step.
 * 2. Branches of laws are updated at the end of a step, for a monotonic change of displacement within the step; contact is
 *    checked there by the sign of the overlap and, without tension, of the force.  No event is located.
 * 3. The error decreases with the square of the step as long as no branch changes, and with its first power if bodies touch or
 *    separate: the initial force of the dashpot acts up to one step late.
 *
 * Newmark 1959, J. Eng. Mech. Div. ASCE 85(3), 67-94; Chopra, Dynamics of Structures, ch. 5. */
#include "engine/solver/fixed_step.h"

#include <float.h>
#include <math.h>

#include "engine/exact/counts.h"
#include "engine/solver/solver.h"

struct stepped_task {
	const struct pound_task *task;
	struct pound_task_result *result;
	double step, frequency; /* [s], [1/s] */
	struct pound_law_state at[POUND_OSCILLATORS];
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS];
	double
	    rate[POUND_OSCILLATORS];  /* newmark: acceleration; central difference: velocity half a step later */
	struct pound_contact_law law; /* of the contact */
	struct pound_touch touch;     /* while touching: branch of the contact force */
	double force;                 /* contact force per left mass [m/s2] */
	bool touching;
	double start;        /* of the sample interval [s] */
	int k;               /* number of the step in the interval, from 1 */
	double impulse;      /* of the current contact, per left mass [m/s] */
	double ground;       /* acceleration where the step ends [m/s2] */
	double counted_time; /* of contacts that count [s] */
	struct pound_counts_scale counts_scale;
	double speed_max[POUND_OSCILLATORS]; /* [m/s] */
	bool too_long[2]; /* step above the stability limit, for separated and for touching bodies */
};

/* ---- contact at the end of a step ---- */

/* Factor from the contact force per left mass to the force on a body per its mass, positive to the left. */
static double share(const struct pound_task *task, int i)
{
	return i == 0 ? 1 : -task->mass_ratio;
}

/* Solves the two equations coupled by a contact: a_0 x_0 + s (x_0 - x_1) = b_0, a_1 x_1 - r s (x_0 - x_1) = b_1. */
static void pair_solve(const double a[2], double s, double r, const double b[2], double x[2])
{
	double determinant = a[0] * a[1] + s * (a[1] + r * a[0]);
	x[0] = (b[0] * (a[1] + r * s) + s * b[1]) / determinant;
	x[1] = (b[1] * (a[0] + s) + r * s * b[0]) / determinant;
}

/* Largest tangent stiffness of the contact for overlaps up to p, per left mass [1/s2]. */
static double touch_stiffness(const struct stepped_task *c, double p)
{
	const bool power = c->task->force == POUND_FORCE_POWER;
	return c->law.stiffness * (power ? 1.5 * sqrt(p) : 1);
}

/* Records a contact at its end or at the end of the signal; one that does not count (counts.h) adds no contact and no time. */
static void contact_over(struct stepped_task *c)
{
	const struct pound_task *task = c->task;
	struct pound_task_result *r = c->result;
	// upper bound of the overlap, where the force of a power law is stiffest
	const double reach = fabs(c->u[0]) + fabs(c->u[1]) + task->gap;
	const double stiff = (1 + task->mass_ratio) * touch_stiffness(c, reach);
	struct pound_counts counts = {.time = c->start + c->k * c->step,
	                              .steps = (r->contact_time - c->counted_time) / c->step,
	                              .blur = sqrt(stiff) * reach,
	                              .changed = (1 + task->mass_ratio) * c->impulse + fabs(c->v[0] - c->v[1])};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		counts.body[i] = (struct pound_counts_body){c->u[i],
		                                            c->v[i],
		                                            c->at[i].branch.stiffness,
		                                            c->at[i].branch.offset,
		                                            task->bodies[i].damping,
		                                            task->bodies[i].drive * c->ground};
	r->impulse_max = fmax(r->impulse_max, c->impulse);
	if (pound_contact_counts(&counts, &c->counts_scale)) {
		r->contacts++;
		c->counted_time = r->contact_time;
	} else
		r->contact_time = c->counted_time;
}

/* Updates the result at the end of a step; for impulses the force is linear within a step. */
static void task_note(struct stepped_task *c, double force, bool touching, double approach)
{
	struct pound_task_result *r = c->result;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		if (fabs(c->u[i]) > r->displacement_max[i])
			r->displacement_max[i] = fabs(c->u[i]);
	if (touching && !c->touching) {
		if (r->contacts == 0)
			r->first_contact = c->start + c->k * c->step, r->first_speed = approach;
		c->impulse = 0;
	}
	c->impulse += 0.5 * (c->force + force) * c->step;
	if (touching)
		r->contact_time += c->step;
	else if (c->touching)
		contact_over(c);
	c->touching = touching;
	c->force = force;
}

/* ---- Newmark ---- */

/* One step of average acceleration; false: the iteration has not converged.
 *
 *   d = u1 - u,  v1 = 2 d/h - v,  a1 = 4 d/h^2 - 4 v/h - a,  a1 + c v1 + r(u + d) + share F(d) = -a_g
 *
 * On the assumed branches r and F are linear, so an iteration of Newton's method is one linear solve; nonlinear contact forces
 * are replaced by their tangents.  The force of a dashpot begins with a jump, so it can happen that the solution with contact is
 * separated and the solution without contact overlaps: then, after POUND_FIXED_ROUNDS iterations, the bodies stay in contact or
 * separated as at the start of the step.
 */
static bool newmark_advance(struct stepped_task *c, double ground)
{
	const struct pound_task *task = c->task;
	double h = c->step;
	double p = c->u[0] - c->u[1] - task->gap, q = c->v[0] - c->v[1], p1 = p;
	struct pound_law_state at[2] = {c->at[0], c->at[1]};
	struct pound_touch touch = c->touch;
	bool touching = c->touching, converged = false;
	double d[2], a[2], b[2];
	for (int round = 0; round < 2 * POUND_FIXED_ROUNDS && !converged; round++) {
		struct pound_fixed_force force =
		    touching ? pound_fixed_force_over(&touch.on, p, p1) : (struct pound_fixed_force){0};
		double stiff = force.slope + force.rate * (2 / h), still = force.still + force.rate * -q;
		for (int i = 0; i < 2; i++) {
			const struct pound_task_body *body = &task->bodies[i];
			a[i] = 4 / (h * h) + 2 * body->damping / h + at[i].branch.stiffness;
			b[i] = 4 / h * c->v[i] + c->rate[i] + body->damping * c->v[i] - body->drive * ground -
			       pound_fixed_restoring(&at[i], c->u[i]) - share(task, i) * still;
		}
		pair_solve(a, stiff, task->mass_ratio, b, d);
		converged = true;
		for (int i = 0; i < 2; i++) {
			struct pound_law_state next = c->at[i];
			pound_fixed_follow(&task->bodies[i].backbone, &next, c->u[i], c->u[i] + d[i]);
			converged &= pound_fixed_same_law(&next, &at[i]);
			at[i] = next;
		}
		const double before = p1;
		p1 = p + d[0] - d[1];
		struct pound_touch next = pound_fixed_touch(&c->law, &c->touch, c->touching, p, p1, q);
		bool touch_now = task->contact && pound_fixed_touches(&c->law, &next, p1, 2 / h * (d[0] - d[1]) - q);
		if (round >= POUND_FIXED_ROUNDS)
			touch_now = c->touching;
		converged &= touch_now == touching && (!touching || pound_fixed_same_touch(&next, &touch)) &&
		             (!touching || touch.on.form == POUND_TOUCH_STRAIGHT ||
		              fabs(p1 - before) <= POUND_FIXED_SETTLED * fabs(p1));
		touching = touch_now;
		touch = next;
	}
	for (int i = 0; i < 2; i++) {
		double v = 2 / h * d[i] - c->v[i];
		c->rate[i] = 2 / h * (v - c->v[i]) - c->rate[i];
		c->v[i] = v;
		c->u[i] += d[i];
		c->at[i] = at[i];
	}
	c->touch = touch;
	double overlap = c->u[0] - c->u[1] - task->gap;
	task_note(c, touching ? pound_contact_force_on(&touch.on, overlap, c->v[0] - c->v[1]) : 0, touching, q);
	return converged;
}

/* ---- central differences ---- */

/* Square of the highest angular frequency of the bodies, on the first and stiffest branches of their laws, coupled by a contact
 * stiffness per left mass [1/s2]. */
static double stiffest(const struct pound_task *task, double contact)
{
	const double left = task->bodies[0].backbone.stiffness, right = task->bodies[1].backbone.stiffness;
	const double mean = 0.5 * (left + contact + right + task->mass_ratio * contact);
	const double half = 0.5 * (left + contact - right - task->mass_ratio * contact);
	return mean + sqrt(half * half + task->mass_ratio * contact * contact);
}

/* One step of central differences, written with the velocities w half a step before and after:
 *
 *   (w1 - w)/h + c (w1 + w)/2 + r(u) + share F(u, (w1 + w)/2) = -a_g,   v = (w1 + w)/2
 */
static bool central_advance(struct stepped_task *c, double ground)
{
	const struct pound_task *task = c->task;
	double h = c->step, a[2], b[2], w[2];
	double approach = c->v[0] - c->v[1], before = c->u[0] - c->u[1] - task->gap;
	for (int i = 0; i < 2; i++) {
		const struct pound_task_body *body = &task->bodies[i];
		double u = c->u[i] + h * c->rate[i];
		pound_fixed_follow(&body->backbone, &c->at[i], c->u[i], u);
		c->u[i] = u;
		a[i] = c->frequency + body->damping / 2;
		b[i] = (c->frequency - body->damping / 2) * c->rate[i] - pound_fixed_restoring(&c->at[i], u) -
		       body->drive * ground;
	}
	double p = c->u[0] - c->u[1] - task->gap, q = c->rate[0] - c->rate[1], force = 0;
	bool touching = task->contact && p > 0;
	if (touching) {
		const struct pound_touch touch =
		    pound_fixed_touch(&c->law, &c->touch, c->touching, before, p, approach);
		const struct pound_touch_line line = pound_contact_line(&touch.on, p);
		double still = line.still + line.rate * (q / 2);
		const double pushed[2] = {b[0] - share(task, 0) * still, b[1] - share(task, 1) * still};
		pair_solve(a, line.rate / 2, task->mass_ratio, pushed, w);
		double rate = (q + w[0] - w[1]) / 2;
		touching = pound_fixed_touches(&c->law, &touch, p, rate);
		force = touching ? line.still + line.rate * rate : 0;
		c->touch = touch;
		if (task->force == POUND_FORCE_POWER)
			c->too_long[1] |= h * sqrt(stiffest(task, line.slope)) > 2;
	}
	for (int i = 0; i < 2 && !touching; i++)
		w[i] = b[i] / a[i];
	for (int i = 0; i < 2; i++) {
		c->v[i] = (c->rate[i] + w[i]) / 2;
		c->rate[i] = w[i];
	}
	task_note(c, force, touching, approach);
	return true;
}

/* ---- from the start of a task to its end ---- */

/* Velocities above which a response is unstable: POUND_FIXED_UNSTABLE times the bound from the work of the ground motion.
 *
 *   E' <= |a_g| sqrt(2 M E), so sqrt(2 E) <= sqrt(2 E_0) + sqrt(M) int |a_g| dt
 *
 * with E the energy and M the mass of all bodies that the ground motion drives.
 */
static void speed_limits(struct stepped_task *c)
{
	const struct pound_task *task = c->task;
	double push = 0, mass[2] = {1, task->mass_ratio > 0 ? 1 / task->mass_ratio : 1};
	double energy = 0, riding = 0;
	for (int t = 0; t < task->n_samples; t++)
		push += fabs(task->ground[t]) * task->time_step;
	for (int i = 0; i < 2; i++) {
		const struct pound_task_body *body = &task->bodies[i];
		energy += mass[i] * (body->v * body->v + body->backbone.stiffness * body->u * body->u);
		riding += mass[i] * body->drive;
	}
	for (int i = 0; i < 2; i++)
		c->speed_max[i] = POUND_FIXED_UNSTABLE * (sqrt(energy / mass[i]) + sqrt(riding / mass[i]) * push);
}

/* Fills the initial state, with the initial accelerations in `rate`. */
static void task_start(struct stepped_task *c, int n_steps)
{
	const struct pound_task *task = c->task;
	c->step = task->time_step / n_steps;
	c->frequency = n_steps / task->time_step;
	for (int i = 0; i < 2; i++) {
		pound_law_start(&task->bodies[i].backbone, &c->at[i]);
		c->u[i] = task->bodies[i].u;
		c->v[i] = task->bodies[i].v;
		pound_fixed_follow(&task->bodies[i].backbone, &c->at[i], 0, c->u[i]);
	}
	double p = c->u[0] - c->u[1] - task->gap, q = c->v[0] - c->v[1];
	c->law = pound_task_law(task);
	if (task->contact)
		c->touch = pound_fixed_touch(&c->law, &c->touch, c->touching, 0, p, q);
	c->touching = task->contact && pound_fixed_touches(&c->law, &c->touch, p, q);
	c->force = c->touching ? pound_contact_force_on(&c->touch.on, p, q) : 0;
	c->result->first_speed = c->touching ? q : 0;
	for (int i = 0; i < 2; i++) {
		const struct pound_task_body *body = &task->bodies[i];
		c->result->displacement_max[i] = fabs(c->u[i]);
		c->rate[i] = -body->drive * task->ground[0] - body->damping * c->v[i] -
		             pound_fixed_restoring(&c->at[i], c->u[i]) - share(task, i) * c->force;
	}
	speed_limits(c);
}

/* Number of steps of a sample interval, none longer than the requested step, to rounding. */
int pound_fixed_steps(double time_step, double step)
{
	double steps = time_step / step;
	return (int)fmin(fmax(1, ceil(steps * (1 - 4 * DBL_EPSILON))), INT32_MAX);
}

/* The step that is used for a requested step [s]. */
double pound_fixed_step(double time_step, double step)
{
	return time_step / pound_fixed_steps(time_step, step);
}

typedef bool advance(struct stepped_task *c, double ground);

static void task_run(struct stepped_task *c, int n_steps, advance *step, const atomic_bool *stop)
{
	const struct pound_task *task = c->task;
	struct pound_task_result *r = c->result;
	for (int t = 1; t < task->n_samples && !r->status; t++) {
		double from = task->ground[t - 1], rise = (task->ground[t] - from) / n_steps;
		c->start = (t - 1) * task->time_step;
		for (int k = 1; k <= n_steps && !r->status; k++) {
			c->k = k;
			c->ground = from + rise * k;
			bool converged = step(c, c->ground);
			// NAN counts as above the limit
			if (!converged || c->too_long[c->touching] ||
			    !(fabs(c->v[0]) <= c->speed_max[0] && fabs(c->v[1]) <= c->speed_max[1]))
				r->status = POUND_UNSTABLE;
		}
		if (pound_stopped(stop))
			r->status = POUND_STOPPED;
	}
	if (c->touching)
		contact_over(c);
	if (r->contacts == 0)
		r->first_contact = r->first_speed = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		r->u[i] = c->u[i];
		r->v[i] = c->v[i];
		if (!task->bodies[i].followed)
			r->displacement_max[i] = NAN;
	}
	if (r->status)
		*r = (struct pound_task_result){.status = r->status};
}

/* The response of a task by Newmark's average acceleration.
 *
 * Given    solver    step      s       longest step
 *          task      -         -       see task.h
 *          stop      -         -       checked between samples; NULL: never
 * Returns  result    -         -       after a failure all 0 except the status
 * Status   POUND_UNSTABLE  the iteration of a step did not converge, or a velocity exceeded its limit (speed_limits)
 *          POUND_STOPPED   stop was set
 *
 * Valid    Stable for any step as long as no branch changes; a contact needs about 20 steps.
 * Test     unit_fixed_step: the_error_of_free_vibration_falls_with_the_square_of_the_step
 */
void pound_fixed_newmark(const struct pound_solver *solver, const struct pound_task *task,
                         struct pound_task_result *result, const atomic_bool *stop)
{
	*result = (struct pound_task_result){0};
	struct stepped_task c = {.task = task, .result = result};
	int n_steps = pound_fixed_steps(task->time_step, solver->step);
	task_start(&c, n_steps);
	task_run(&c, n_steps, newmark_advance, stop);
}

/* The response of a task by central differences, the explicit method.
 *
 * Given    solver    step      s       longest step
 *          task      -         -       see task.h
 *          stop      -         -       checked between samples; NULL: never
 * Returns  result    -         -       after a failure all 0 except the status
 * Status   POUND_UNSTABLE  the step exceeds 2/w, w: highest angular frequency of the bodies, while they touch with the contact
 *                          stiffness between them; or a velocity exceeded its limit (speed_limits)
 *          POUND_STOPPED   stop was set
 *
 * Test     unit_fixed_step: an_explicit_step_beyond_its_limit_ends_with_a_status
 */
void pound_fixed_central(const struct pound_solver *solver, const struct pound_task *task,
                         struct pound_task_result *result, const atomic_bool *stop)
{
	*result = (struct pound_task_result){0};
	struct stepped_task c = {.task = task, .result = result};
	int n_steps = pound_fixed_steps(task->time_step, solver->step);
	task_start(&c, n_steps);
	// a power law's stiffness depends on the overlap: central_advance checks it
	const bool power = task->force == POUND_FORCE_POWER;
	for (int i = 0; i < 2; i++) {
		c.rate[i] = c.v[i] + c.step / 2 * c.rate[i];
		c.too_long[i] = c.step * sqrt(stiffest(task, i == 1 && !power ? c.law.stiffness : 0)) > 2;
	}
	task_run(&c, n_steps, central_advance, stop);
}
