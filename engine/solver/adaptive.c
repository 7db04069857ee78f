/* adaptive.c - GSL's adaptive steppers, restarted at every event.
 *
 * 1. Between events each law and contact keeps its branch, extended beyond the branch's ends, so that the right-hand side is
 *    smooth.  Steps end at the samples, where the ground acceleration has kinks.
 * 2. If a guard has changed its sign after a step, the step is shortened to the first such change.  Rates have guards, too, so
 *    displacements, overlaps and contact forces are monotonic within a step: no contact or release within a step is missed, and
 *    the largest displacement is at the end of a step.  If a rate reverses twice within a step, the cubic through both ends
 *    finds its extreme between the reversals, and the step ends there.
 * 3. The stepper is rk8pd.  If it needs many steps the system is stiff (bodies in sustained contact), and msbdf continues to the
 *    next event or sample.
 *
 * Shares with the exact solver only the laws, the contact models and the rule which contacts count.  Pairs and rows of buildings
 * are both a scene of floors and contacts (adaptive.h).  Only pairs may have rigid impacts. */
#include "engine/solver/adaptive.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include <gsl/gsl_errno.h>

enum {
	STIFF_STEPS = 200,     /* steps of rk8pd after which msbdf continues; an impact takes about 20 */
	STEPS_LIMIT = 1 << 17, /* steps in one sample interval; more: the tolerance cannot be reached */
	EVENTS_LIMIT = 2048,   /* events in one sample interval; more: chatter */
	STATES_STIFF = 256,    /* most states for msbdf, which stores n x n matrices */
};

/* Fraction of the expected response below which a component need not be accurate to the tolerance. */
static const double FLOOR = 1e-3;

/* ---- events ---- */

/* Magnitudes of the terms that accelerate a side of a contact, whose rounding errors are in its velocity. */
static struct pound_counts_body side_of(const struct adaptive_task *c, const struct adaptive_link *l,
                                        int side)
{
	const struct adaptive_scene *s = &c->scene;
	const double ground = s->ground + s->slope * c->t;
	struct pound_counts_body b = {.damping = DBL_MAX};
	for (int e = 0; e < l->n_ends; e++) {
		const struct adaptive_floor *f = &s->floors[l->floor[e]];
		const double weight = fabs(l->weight[e]);
		if ((l->weight[e] < 0) != side)
			continue;
		b.ground = f->drive * ground;
		b.v += weight * pound_adaptive_velocity(s, l->floor[e], c->y);
		for (int j = 0; j <= (f->above > 0); j++)
			b.offset += weight * (j ? f->above : 1) * f[j].per_mass *
			            (fabs(f[j].at.branch.stiffness * c->y[drift_state(l->floor[e] + j)]) +
			             fabs(f[j].at.branch.offset));
		b.damping = fmin(b.damping, f->damping + f->mass_damping);
	}
	b.damping = b.damping == DBL_MAX ? 0 : b.damping;
	return b;
}

/* Records a contact at its end or at the end of the signal; one that does not count (counts.h) adds no contact and no time. */
static void contact_over(struct adaptive_task *c, int k)
{
	struct adaptive_link *l = &c->scene.links[k];
	const double *p = &c->y[overlap_state(&c->scene, k)];
	const struct pound_counts counts = {.body = {side_of(c, l, 0), side_of(c, l, 1)},
	                                    .time = c->start + c->t,
	                                    .steps = l->touch_steps,
	                                    .changed = l->inverse_mass * p[2] + fabs(p[1])};
	l->measures[POUND_LINK_IMPULSE_MAX] = fmax(l->measures[POUND_LINK_IMPULSE_MAX], p[2]);
	if (pound_contact_counts(&counts, &l->scale)) {
		l->measures[POUND_LINK_CONTACTS]++;
		l->counted_time = l->time;
	} else
		l->time = l->counted_time;
}

/* A rigid impact: velocities jump.  If the remaining bounces take less than HOPS_END sample intervals, the bodies stay in
 * contact.
 *
 *   v_1 -= J, v_2 += r J,  J = (1 + e) q/(1 + r)       duration of the remaining bounces: 2 e q/(a (1 - e))
 *
 * with q the approach speed, r the mass ratio and a the overlap acceleration without contact force.
 */
static void contact_impact(struct adaptive_task *c, int k)
{
	static const double HOPS_END = 1e-12; // of a sample interval
	struct adaptive_scene *s = &c->scene;
	struct adaptive_link *l = &s->links[k];
	double *m = l->measures, *p = &c->y[overlap_state(s, k)];
	const double q = fmax(p[1], 0), a = pound_adaptive_apart(s, k, c->t, c->y);
	double e = l->law.restitution;
	l->held = q == 0 || (a > 0 && e < 1 && 2 * e * q < a * (1 - e) * HOPS_END * c->time_step);
	if (l->held)
		e = 0;
	const double impulse = (1 + e) * q / l->inverse_mass;
	for (int j = 0; j < l->n_ends; j++) {
		assert(!s->floors[l->floor[j]].inner);
		c->y[rate_state(l->floor[j])] -= l->weight[j] * s->floors[l->floor[j]].inverse_mass * impulse;
	}
	p[0] = 0;
	p[1] = -e * q;
	p[2] = l->touch_steps = 0;
	l->touching = l->held;
	m[POUND_LINK_IMPULSE_MAX] = fmax(m[POUND_LINK_IMPULSE_MAX], impulse);
	if (q >= l->law.speed_floor && m[POUND_LINK_CONTACTS]++ == 0)
		m[POUND_LINK_FIRST_TIME] = c->start + c->t, m[POUND_LINK_FIRST_SPEED] = q;
}

static void contact_transition(struct adaptive_task *c, int k)
{
	struct adaptive_link *l = &c->scene.links[k];
	double *m = l->measures, *p = &c->y[overlap_state(&c->scene, k)];
	if (l->held) {
		m[POUND_LINK_IMPULSE_MAX] = fmax(m[POUND_LINK_IMPULSE_MAX], p[2]);
		l->held = l->touching = false;
		return;
	}
	if (pound_contact_force(l->law.model) == POUND_FORCE_IMPACT) {
		contact_impact(c, k);
		return;
	}
	if (l->touching) {
		contact_over(c, k);
		l->touching = false;
		l->parted = !l->law.tension && l->law.dashpot > 0 && p[0] > 0;
		return;
	}
	if (!l->parted)
		pound_contact_begin(&l->law, &l->touch, p[1]);
	if (m[POUND_LINK_CONTACTS] == 0)
		m[POUND_LINK_FIRST_TIME] = c->start + c->t, m[POUND_LINK_FIRST_SPEED] = p[1];
	p[2] = l->touch_steps = 0;
	l->touching = true;
	l->parted = false;
}

static void story_transition(struct adaptive_task *c, int i, enum pound_edge edge)
{
	struct adaptive_floor *f = &c->scene.floors[i];
	const double d = edge == POUND_EDGE_LOW    ? f->at.branch.low
	                 : edge == POUND_EDGE_HIGH ? f->at.branch.high
	                                           : c->y[drift_state(i)];
	if (edge != POUND_EDGE_REVERSAL || f->at.branch.direction != 0)
		pound_law_leave(f->story, &f->at, edge, d);
}

static void event_pass(struct adaptive_task *c, const struct guard *g)
{
	struct adaptive_link *l = g->of < c->scene.n_links ? &c->scene.links[g->of] : NULL;
	// bodies in sustained contact reverse with every rounding error, so only reversals that end a branch count
	c->events += g->kind >= TURNS || pound_adaptive_turn_ends(c, g);
	if (g->kind == CONTACT)
		contact_transition(c, g->of);
	else if (g->kind == CLEARS)
		l->parted = false;
	else if (g->kind == TOUCH_LOW)
		pound_contact_leave(&l->law, &l->touch, POUND_EDGE_LOW, l->touch.on.low);
	else if (g->kind == TOUCH_HIGH)
		pound_contact_leave(&l->law, &l->touch, POUND_EDGE_HIGH, l->touch.on.high);
	else if (g->kind == TURN_OVERLAP && pound_adaptive_turn_ends(c, g))
		pound_contact_leave(&l->law, &l->touch, POUND_EDGE_REVERSAL, c->y[overlap_state(&c->scene, g->of)]);
	else if (g->kind == HIGH)
		story_transition(c, g->of, POUND_EDGE_HIGH);
	else if (g->kind == LOW)
		story_transition(c, g->of, POUND_EDGE_LOW);
	else if (g->kind == TURN)
		story_transition(c, g->of, POUND_EDGE_REVERSAL);
	c->steps = 0;
	gsl_odeiv2_driver_reset(c->explicit);
}

/* ---- steps ---- */

static size_t states_bytes(const struct adaptive_task *c)
{
	return sizeof(double) * (size_t)c->scene.n_states;
}

/* Integrates from the start of a step to t; false: the stepper failed. */
static bool state_at(struct adaptive_task *c, double t, double *y)
{
	double now = c->t;
	memcpy(y, c->y, states_bytes(c));
	gsl_odeiv2_driver_reset(c->explicit);
	c->explicit->h = t - now;
	return gsl_odeiv2_driver_apply(c->explicit, &now, t, y) == GSL_SUCCESS;
}

/* Moves the end of a step to the sign change of a guard: false position (Illinois), with bisection in every third round.
 *
 * Given    g         -               guard, at most 0 at the start of the step
 *          t, y      -, (n_states)   end of the step, where the guard is above 0
 * Returns  t, y      -, (n_states)   the new end, where the guard is just above 0
 *          value     -               false: the stepper failed
 */
static bool locate(struct adaptive_task *c, const struct guard *g, double *t, double *y)
{
	double low = c->t, g_low = pound_adaptive_guard(c, g, c->t, c->y),
	       g_high = pound_adaptive_guard(c, g, *t, y);
	int side = 0;
	for (int round = 1; *t - low > 4 * DBL_EPSILON * c->time_step; round++) {
		double next = *t - g_high * (*t - low) / (g_high - g_low);
		if (round % 3 == 0 || !(next > low && next < *t))
			next = low + (*t - low) / 2;
		if (!(next > low && next < *t))
			break;
		if (!state_at(c, next, c->middle))
			return false;
		double value = pound_adaptive_guard(c, g, next, c->middle);
		// the value at an end that is kept twice is halved, so that the other end moves, too
		if (value > 0) {
			*t = next, g_high = value;
			memcpy(y, c->middle, states_bytes(c));
			g_low = side > 0 ? g_low / 2 : g_low;
			side = 1;
		} else {
			low = next, g_low = value;
			g_high = side < 0 ? g_high / 2 : g_high;
			side = -1;
		}
	}
	return true;
}

/* The first guard that is above 0 now; NULL: none. */
static const struct guard *crossed(const struct adaptive_task *c)
{
	int j = 0;
	while (j < c->n_guards && !(pound_adaptive_guard(c, &c->guards[j], c->t, c->y) > 0))
		j++;
	return j < c->n_guards ? &c->guards[j] : NULL;
}

/* Shortens a step within which a rate may reverse twice to the extreme of the rate between the reversals.
 *
 * Given    t, y   -, (n_states)   end of the step
 * Returns  t, y   -, (n_states)   the same, or an earlier end at which the guard of a reversal is above 0
 *          value  -               false: the stepper failed
 */
static bool turns_find(struct adaptive_task *c, double *t, double *y)
{
	pound_adaptive_derivative(c->t, c->y, c->at_start, &c->scene);
	pound_adaptive_derivative(*t, y, c->at_end, &c->scene);
	for (int j = 0; j < c->n_turns; j++) {
		const struct guard *of = &c->guards[j];
		// a contact ends at zero force, which has a separate guard, or at zero overlap, which the steps resolve
		if (of->way == 0 || (of->kind == TURN_OVERLAP && c->scene.links[of->of].touching))
			continue;
		const struct rate start = pound_adaptive_rate(c, of, c->y, c->at_start),
		                  end = pound_adaptive_rate(c, of, y, c->at_end);
		const double h = *t - c->t, way = -of->way;
		const double g[2] = {way * start.value, way * end.value},
		             d[2] = {way * start.change * h, way * end.change * h};
		const double s = g[1] > 0 ? 0 : pound_adaptive_hump(g, d);
		if (s == 0 || !pound_adaptive_turn_matters(c, of, h, y))
			continue;
		if (!state_at(c, c->t + s * h, c->turned))
			return false;
		if (pound_adaptive_guard(c, of, c->t + s * h, c->turned) > 0) {
			*t = c->t + s * h;
			memcpy(y, c->turned, states_bytes(c));
			pound_adaptive_derivative(*t, y, c->at_end, &c->scene);
		}
	}
	return true;
}

/* Updates the largest drifts and displacements at the end of a step; false: a state is not finite. */
static bool floors_note(struct adaptive_task *c)
{
	double u = 0;
	bool finite = true;
	for (int j = 0; j < c->scene.n_states; j++)
		finite &= isfinite(c->y[j]);
	for (int i = 0; i < c->scene.n; i++) {
		double *m = &c->floor_measures[i * POUND_FLOOR_MEASURES];
		const double d = c->y[drift_state(i)];
		u = c->scene.floors[i].inner ? u + d : d;
		m[POUND_FLOOR_DRIFT_MAX] = fmax(m[POUND_FLOOR_DRIFT_MAX], fabs(d));
		m[POUND_FLOOR_DISPLACEMENT_MAX] = fmax(m[POUND_FLOOR_DISPLACEMENT_MAX], fabs(u));
	}
	return finite;
}

/* One step, shortened to its first event; false: the stepper failed or a state is not finite. */
static bool task_step(struct adaptive_task *c)
{
	double *y = c->end, t = c->t, left = c->time_step - c->t;
	gsl_odeiv2_driver *driver = c->steps < STIFF_STEPS || !c->implicit ? c->explicit : c->implicit;
	if (c->steps == STIFF_STEPS && c->implicit) {
		gsl_odeiv2_driver_reset(driver);
		driver->h = c->explicit->h;
	}
	driver->h = fmin(fmax(driver->h, DBL_EPSILON * c->time_step), left);
	memcpy(y, c->y, states_bytes(c));
	if (gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, &c->system, &t, c->time_step, &driver->h,
	                            y) != GSL_SUCCESS)
		return false;
	double h = driver->h;
	const struct guard *event = NULL;
	if (!turns_find(c, &t, y))
		return false;
	for (int j = 0; j < c->n_guards; j++)
		if (pound_adaptive_guard(c, &c->guards[j], t, y) > 0 &&
		    pound_adaptive_turn_matters(c, &c->guards[j], t - c->t, y)) {
			event = &c->guards[j];
			if (!locate(c, event, &t, y))
				return false;
		}
	driver->h = h;
	c->steps++;
	for (int k = 0; k < c->scene.n_links; k++) {
		struct adaptive_link *l = &c->scene.links[k];
		l->time += l->touching ? t - c->t : 0;
		l->touch_steps += l->touching;
	}
	memcpy(c->y, y, states_bytes(c));
	c->t = t;
	const bool finite = floors_note(c);
	if (event)
		event_pass(c, event);
	return finite;
}

static enum pound_status interval_run(struct adaptive_task *c, int sample)
{
	c->start = (sample - 1) * c->time_step;
	c->scene.ground = c->samples[sample - 1];
	c->scene.slope = (c->samples[sample] - c->scene.ground) / c->time_step;
	c->t = 0;
	c->steps = c->events = 0;
	for (int n = 0; c->t < c->time_step; n++) {
		pound_adaptive_ways(c);
		if (n == STEPS_LIMIT)
			return POUND_TOLERANCE;
		const struct guard *event = crossed(c);
		if (event)
			event_pass(c, event);
		else if (!task_step(c))
			return POUND_TOLERANCE;
		if (c->events > EVENTS_LIMIT)
			return POUND_CHATTER;
	}
	return POUND_OK;
}

/* ---- from the start of a task to its end ---- */

/* Absolute scales of the error control: FLOOR times the expected size of each state, from the largest ground acceleration, the
 * motion at the start and the highest frequency of a story. */
static void scales_fill(struct adaptive_task *c)
{
	const struct adaptive_scene *s = &c->scene;
	double w = 1 / (c->n_samples * c->time_step), a = 0;
	for (int i = 0; i < s->n; i++)
		w = fmax(w, sqrt(s->floors[i].per_mass * s->floors[i].story->stiffness));
	for (int t = 0; t < c->n_samples; t++)
		a = fmax(a, fabs(c->samples[t]));
	for (int i = 0; i < s->n; i++)
		a = fmax(a, w * fmax(fabs(s->floors[i].v), w * fabs(s->floors[i].u)));
	a = a > 0 ? a : 1;
	for (int i = 0; i < s->n; i++) {
		c->scale[drift_state(i)] = FLOOR * a / (w * w);
		c->scale[rate_state(i)] = FLOOR * a / w;
	}
	for (int k = 0; k < s->n_links; k++) {
		const int p = overlap_state(s, k);
		c->scale[p] = FLOOR * a / (w * w);
		c->scale[p + 1] = FLOOR * a / w;
		c->scale[p + 2] = FLOOR * a / w * s->links[k].impulse_unit;
	}
}

static void task_start(struct adaptive_task *c, struct pound_chain_result *result)
{
	struct adaptive_scene *s = &c->scene;
	c->floor_measures = result->floors;
	for (int i = 0; i < s->n; i++) {
		struct adaptive_floor *f = &s->floors[i];
		double *m = &result->floors[i * POUND_FLOOR_MEASURES];
		pound_law_start(f->story, &f->at);
		c->y[drift_state(i)] = f->u;
		c->y[rate_state(i)] = f->v;
		for (int j = 0; j < POUND_FLOOR_MEASURES; j++)
			m[j] = NAN;
		m[POUND_FLOOR_DRIFT_MAX] = m[POUND_FLOOR_DISPLACEMENT_MAX] = fabs(f->u);
	}
	for (int k = 0; k < s->n_links; k++) {
		struct adaptive_link *l = &s->links[k];
		double *p = &c->y[overlap_state(s, k)];
		l->measures = &result->links[k * POUND_LINK_MEASURES];
		for (int j = 0; j < POUND_LINK_MEASURES; j++)
			l->measures[j] = 0;
		l->measures[POUND_LINK_FORCE_MAX] = NAN;
		for (int e = 0; e < l->n_ends; e++) {
			p[0] += l->weight[e] * s->floors[l->floor[e]].u;
			p[1] += l->weight[e] * s->floors[l->floor[e]].v;
		}
		p[0] -= l->gap;
		// only linear forces have a guard of their rate: the rate of p^0.25 q is not finite at zero overlap
		const bool line =
		    l->meets && !l->law.tension && pound_contact_force(l->law.model) == POUND_FORCE_LINEAR;
		l->release = line ? l->law.dashpot / l->law.stiffness : 0;
	}
}

/* Completes the result; a contact that has not ended is recorded as it is. */
static void task_end(struct adaptive_task *c)
{
	const struct adaptive_scene *s = &c->scene;
	for (int k = 0; k < s->n_links; k++) {
		const struct adaptive_link *l = &s->links[k];
		double *m = l->measures;
		if (l->held)
			m[POUND_LINK_IMPULSE_MAX] = fmax(m[POUND_LINK_IMPULSE_MAX], c->y[overlap_state(s, k) + 2]);
		else if (l->touching)
			contact_over(c, k);
		m[POUND_LINK_TIME] = l->time;
		if (m[POUND_LINK_CONTACTS] == 0)
			m[POUND_LINK_FIRST_TIME] = m[POUND_LINK_FIRST_SPEED] = 0;
	}
	double u = 0;
	for (int i = 0; i < s->n; i++) {
		const struct adaptive_floor *f = &s->floors[i];
		double *m = &c->floor_measures[i * POUND_FLOOR_MEASURES];
		u = (f->inner ? u : 0) + c->y[drift_state(i)];
		m[POUND_FLOOR_SHEAR_MAX] = pound_law_envelope(f->story, m[POUND_FLOOR_DRIFT_MAX]);
		m[POUND_FLOOR_RESIDUAL] = pound_law_residual(f->story, &f->at, c->y[drift_state(i)]);
		m[POUND_FLOOR_END_U] = u;
		m[POUND_FLOOR_END_V] = pound_adaptive_velocity(s, i, c->y);
	}
}

/* Integrates a task whose memory is assigned and whose scene is filled. */
static enum pound_status task_follow(struct adaptive_task *c, const struct pound_solver *solver,
                                     const atomic_bool *stop)
{
	const size_t n = (size_t)c->scene.n_states;
	// at rest no rate has a sign whose reversal could end a step, so the first steps are short
	const double h = c->time_step * 0x1p-20;
	c->system = (gsl_odeiv2_system){pound_adaptive_derivative, pound_adaptive_jacobian, n, &c->scene};
	scales_fill(c);
	c->explicit = gsl_odeiv2_driver_alloc_scaled_new(&c->system, gsl_odeiv2_step_rk8pd, h, solver->tolerance,
	                                                 solver->tolerance, 1, 1, c->scale);
	if (n <= STATES_STIFF)
		c->implicit = gsl_odeiv2_driver_alloc_scaled_new(
		    &c->system, gsl_odeiv2_step_msbdf, h, solver->tolerance, solver->tolerance, 1, 1, c->scale);
	enum pound_status status = c->explicit && (c->implicit || n > STATES_STIFF) ? POUND_OK : POUND_NOMEM;
	if (!status)
		gsl_odeiv2_driver_set_nmax(c->explicit, STEPS_LIMIT);
	for (int t = 1; t < c->n_samples && !status; t++)
		status = pound_stopped(stop) ? POUND_STOPPED : interval_run(c, t);
	if (!status)
		task_end(c);
	if (c->explicit)
		gsl_odeiv2_driver_free(c->explicit);
	if (c->implicit)
		gsl_odeiv2_driver_free(c->implicit);
	return status;
}

enum {
	STATE_ROWS = 9, /* arrays of states: 7 of the task, 1 of the scene, and a spare one behind `scale` */
	ROW_FLOORS = POUND_CHAIN_FLOORS,
	ROW_LINKS = POUND_CHAIN_LINKS,
};

/* Bytes of a task with these numbers of floors and contacts. */
#define TASK_BYTES(floors, links)                                                          \
	(sizeof(struct adaptive_floor) * (floors) + sizeof(struct adaptive_link) * (links) +   \
	 sizeof(struct guard) * (4 * (floors) + 6 * (links)) + sizeof(double) * 2 * (floors) + \
	 sizeof(double) * STATE_ROWS * (POUND_FLOOR_STATES * (floors) + POUND_LINK_STATES * (links)))

static_assert(TASK_BYTES(ROW_FLOORS, ROW_LINKS) <= POUND_CHAIN_SCRATCH_STRAIGHT,
              "a row fits into the smallest work space");

/* Assigns the memory of a task, TASK_BYTES, and clears it. */
static void task_carve(struct adaptive_task *c, int n_floors, int n_links, char *memory)
{
	struct adaptive_scene *s = &c->scene;
	const size_t n = (size_t)n_floors, m = (size_t)n_links;
	const size_t states = POUND_FLOOR_STATES * n + POUND_LINK_STATES * m;
	double **const rows[STATE_ROWS - 1] = {&c->y,        &c->end,    &c->middle, &c->turned,
	                                       &c->at_start, &c->at_end, &s->row,    &c->scale};
	memset(memory, 0, TASK_BYTES(n, m));
	s->n = n_floors;
	s->n_links = n_links;
	s->n_states = (int)states;
	s->floors = (void *)memory, memory += sizeof *s->floors * n;
	s->links = (void *)memory, memory += sizeof *s->links * m;
	c->guards = (void *)memory, memory += sizeof *c->guards * (4 * n + 6 * m);
	s->still = (void *)memory, memory += sizeof(double) * n;
	s->push = (void *)memory, memory += sizeof(double) * n;
	for (int j = 0; j < STATE_ROWS - 1; j++) // the spare row follows the last one
		*rows[j] = (void *)memory, memory += sizeof(double) * states;
}

/* The response of a row of buildings by adaptive steps.
 *
 * Given    solver    tolerance  -     error of a step over a component plus its change in the step
 *          task      -          -     see chain.h; no rigid contacts
 *          stop      -          -     checked between samples; NULL: never
 * Returns  result    -          -     as from the exact solver; accelerations, largest forces, energy_residual: NAN
 * Status   POUND_TOLERANCE  the steps became too small or too many
 *          POUND_CHATTER    more events in one sample interval than allowed
 *          POUND_STOPPED    stop was set
 *          POUND_NOMEM      out of memory; GSL's default error handler ends the program instead
 * Memory   scratch: POUND_CHAIN_SCRATCH_STRAIGHT bytes, 64-byte aligned; GSL's work space is allocated and freed
 *
 * Valid    Errors of a run are 10 to 100 times the tolerance, until impacts amplify them.  msbdf is used only with at most
 *          STATES_STIFF states.  Step sizes depend on the C library's pow, so the last digits may differ between machines.
 * Source   GSL Reference Manual 2.7, Ordinary Differential Equations; Prince and Dormand 1981, J. Comput. Appl. Math. 7,
 *          67-75 (rk8pd)
 * Test     unit_solver_rows
 */
void pound_adaptive_row(const struct pound_solver *solver, const struct pound_chain_task *task,
                        struct pound_chain_result *result, void *scratch, const atomic_bool *stop)
{
	struct adaptive_task c = {
	    .samples = task->ground, .n_samples = task->n_samples, .time_step = task->time_step, .many = true};
	result->energy_residual = NAN;
	task_carve(&c, task->n_floors, task->n_links, scratch);
	pound_adaptive_lay_row(&c.scene, task);
	pound_adaptive_guards_lay(&c, task->asked);
	task_start(&c, result);
	result->status = task_follow(&c, solver, stop);
}

/* The response of a pair by adaptive steps.
 *
 * Given    as pound_adaptive_row; a pair may have rigid contacts and motion at the start
 * Returns  result    -          -     after a failure all 0 except the status
 * Status   as pound_adaptive_row
 * Memory   as pound_adaptive_row
 *
 * Test     unit_adaptive
 */
void pound_adaptive_run(const struct pound_solver *solver, const struct pound_task *task,
                        struct pound_task_result *result, const atomic_bool *stop)
{
	struct adaptive_task c = {
	    .samples = task->ground, .n_samples = task->n_samples, .time_step = task->time_step};
	double floors[POUND_OSCILLATORS][POUND_FLOOR_MEASURES], link[POUND_LINK_MEASURES];
	struct pound_chain_result rows = {.floors = floors[0], .links = link, .energy_residual = NAN};
	alignas(double) char memory[TASK_BYTES(POUND_OSCILLATORS, 1)];
	task_carve(&c, POUND_OSCILLATORS, 1, memory);
	pound_adaptive_lay_pair(&c.scene, task);
	pound_adaptive_guards_lay(&c, POUND_CHAIN_DRIFTS);
	task_start(&c, &rows);
	rows.status = task_follow(&c, solver, stop);
	if (rows.status)
		*result = (struct pound_task_result){.status = rows.status};
	else
		pound_pair_result(task, &rows, POUND_OSCILLATORS, result);
}
