/* adaptive.c - GSL's steppers of adaptive step, restarted at every event.
 *
 * 1. Between events the laws and the contact stay as they are and are followed beyond their edges, so that what the
 *    stepper sees is smooth.  Steps end at the samples, where the ground motion has its kinks.
 * 2. A step after which a guard has changed its sign is taken again, shorter and shorter, to the first such change.
 *    Their rates have guards too, so displacements, the overlap and the contact's force go one way within a step: no
 *    contact or release between two looks is missed, and the largest displacement is at a step's end.  A rate that turns
 *    twice within a step is found at its farthest between the turns, by the cubic through both ends.
 * 3. The stepper is rk8pd.  A stretch that takes it too many steps is stiff (bodies pressed together), and goes on
 *    with msbdf up to the next event or sample.
 *
 * Independent of the march but for the laws and what an event is. */
#include <float.h>
#include <math.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include "engine/exact/counts.h"
#include "engine/solver/solver.h"

enum {
	STIFF_STEPS = 200,     /* of rk8pd since the last event in one sample interval; an impact takes some 20 */
	STEPS_LIMIT = 1 << 17, /* in one sample interval: the tolerance is out of reach */
	EVENTS_LIMIT = 2048,   /* in one sample interval: more is chatter */
};

/* Below this part of the response to be expected a component need not be exact to the tolerance. */
static const double FLOOR = 1e-3;

/* the overlap and its rate are followed too: the difference of two displacements would lose digits */
enum { U1, V1, U2, V2, P, Q, IMPULSE, STATES };

/* what ends a step; turns first, for they make the others change their sign once at most */
enum guard {
	TURN,
	TURN_2,
	TURN_OVERLAP,
	TURN_FORCE,
	TURNS,
	LOW = TURNS,
	LOW_2,
	HIGH,
	HIGH_2,
	CONTACT,
	CLEARS,
	TOUCH_LOW,
	TOUCH_HIGH,
	GUARDS
};

struct adaptive_task {
	const struct pound_task *task;
	struct pound_task_result *result;
	struct pound_law_state at[POUND_OSCILLATORS];
	struct pound_contact_law law;
	struct pound_touch touch; /* while touching: branch of the contact's force */
	bool touching, parted;    /* parted: overlapping without force */
	bool held;                /* touching, rigid: both velocities stay the same */
	double release;           /* C/K where contact ends at zero force [s], 0: it ends at zero overlap */
	double ground, slope;     /* acceleration in the interval: ground + slope t */
	double start, t;          /* of the interval; since then [s] */
	double y[STATES];
	double way[TURNS]; /* sign of each rate when a step begins; 0: it may turn */
	gsl_odeiv2_system system;
	gsl_odeiv2_driver *explicit, *implicit;
	double counted_time; /* of contacts that count [s] */
	struct pound_counts_scale counts_scale;
	double touch_steps; /* of the current contact */
	int steps;          /* since the interval began, or the last event */
	int events;         /* since the interval began, without turns that change nothing */
};

/* ---- the equations ---- */

static double contact_force(const struct adaptive_task *c, const double y[])
{
	return c->touching && !c->held ? pound_contact_force_on(&c->touch.on, y[P], y[Q]) : 0;
}

/* Acceleration of a body by its own spring and dashpot [m/s2]. */
static double own_acceleration(const struct adaptive_task *c, int i, const double y[])
{
	const struct pound_branch *branch = &c->at[i].branch;
	return -c->task->bodies[i].damping * y[V1 + 2 * i] - branch->stiffness * y[U1 + 2 * i] - branch->offset;
}

/* Relative acceleration of the bodies without contact [m/s2].
 *
 * Not the difference of two accelerations: when the ground begins to move its rounding would decide who meets.
 */
static double relative_acceleration(const struct adaptive_task *c, double t, const double y[])
{
	const double a = c->ground + c->slope * t;
	return (c->task->bodies[1].drive - c->task->bodies[0].drive) * a +
	       (own_acceleration(c, 0, y) - own_acceleration(c, 1, y));
}

static int derivative(double t, const double y[], double dydt[], void *of)
{
	const struct adaptive_task *c = of;
	const double a = c->ground + c->slope * t, apart = relative_acceleration(c, t, y);
	const double force = c->held ? apart / (1 + c->task->mass_ratio) : contact_force(c, y);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		dydt[U1 + 2 * i] = y[V1 + 2 * i];
		dydt[V1 + 2 * i] = -c->task->bodies[i].drive * a + own_acceleration(c, i, y) +
		                   (i == 0 ? -force : c->task->mass_ratio * force);
	}
	dydt[P] = y[Q];
	dydt[Q] = c->held ? 0 : apart - (1 + c->task->mass_ratio) * force;
	dydt[IMPULSE] = force;
	return GSL_SUCCESS;
}

static int jacobian(double t, const double y[], double *dfdy, double dfdt[], void *of)
{
	const struct adaptive_task *c = of;
	(void)t;
	double(*row)[STATES] = (double(*)[STATES])dfdy;
	memset(dfdy, 0, sizeof(double) * STATES * STATES);
	memset(dfdt, 0, sizeof(double) * STATES);
	if (c->touching && !c->held) { // of powers but for the growth of their dashpot with the overlap
		const struct pound_touch_line line = pound_contact_line(&c->touch.on, y[P]);
		row[IMPULSE][P] = line.slope;
		row[IMPULSE][Q] = line.rate;
	}
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *body = &c->task->bodies[i];
		double share = i == 0 ? -1 : c->task->mass_ratio;
		int u = U1 + 2 * i, v = V1 + 2 * i;
		row[u][v] = 1;
		row[v][u] = -c->at[i].branch.stiffness;
		row[v][v] = -body->damping;
		row[v][P] = share * row[IMPULSE][P];
		row[v][Q] = share * row[IMPULSE][Q];
		dfdt[v] = -body->drive * c->slope;
	}
	row[P][Q] = 1;
	for (int j = 0; j < STATES; j++)
		row[Q][j] = row[V1][j] - row[V2][j];
	dfdt[Q] = dfdt[V1] - dfdt[V2];
	return GSL_SUCCESS;
}

/* ---- guards ---- */

/* the rates that are states themselves */
static const int rate_state[] = {[TURN] = V1, [TURN_2] = V2, [TURN_OVERLAP] = Q};

/* What a guard of a turn looks at, the rate of a displacement, of the overlap or of the contact's force per stiffness, and
 * how fast that changes. */
struct rate {
	double value, change;
};

static struct rate rate_at(const struct adaptive_task *c, enum guard j, double t, const double y[])
{
	double dydt[STATES], dfdy[STATES][STATES], dfdt[STATES];
	derivative(t, y, dydt, (void *)c);
	if (j != TURN_FORCE)
		return (struct rate){y[rate_state[j]], dydt[rate_state[j]]};
	jacobian(t, y, &dfdy[0][0], dfdt, (void *)c);
	double jerk = dfdt[Q];
	for (int i = 0; i < STATES; i++)
		jerk += dfdy[Q][i] * dydt[i];
	return (struct rate){y[Q] + c->release * dydt[Q], dydt[Q] + c->release * jerk};
}

/* A guard above 0 is an event that has come to pass. */
static double guard(const struct adaptive_task *c, enum guard j, double t, const double y[])
{
	const struct pound_task *task = c->task;
	double force = y[P] + c->release * y[Q]; // per stiffness
	if (c->law.stiffness > 0 && !c->law.tension && c->touch.on.form == POUND_TOUCH_ROOT)
		force = pound_contact_force_on(&c->touch.on, y[P], y[Q]) / c->law.stiffness;
	if (c->held)
		force = relative_acceleration(c, t, y);
	switch (j) {
	case TURN:
	case TURN_2:
	case TURN_OVERLAP:
		return c->way[j] == 0 ? -1 : -c->way[j] * y[rate_state[j]];
	case TURN_FORCE:
		return c->way[j] == 0 ? -1 : -c->way[j] * rate_at(c, j, t, y).value;
	case LOW:
	case LOW_2:
		return c->at[j - LOW].branch.low - y[U1 + 2 * (j - LOW)];
	case HIGH:
	case HIGH_2:
		return y[U1 + 2 * (j - HIGH)] - c->at[j - HIGH].branch.high;
	case CONTACT:
		return !task->contact ? -1 : c->touching ? -force : c->parted ? force : y[P];
	case CLEARS:
		return c->parted ? -y[P] : -1;
	case TOUCH_LOW:
		return c->touching && c->touch.on.low > 0 ? c->touch.on.low - y[P] : -1;
	case TOUCH_HIGH:
		return c->touching && c->touch.on.high < DBL_MAX ? y[P] - c->touch.on.high : -1;
	case GUARDS:
		break;
	}
	return -1;
}

static double sign(double x)
{
	return (x > 0) - (x < 0);
}

/* The guards of velocities look for the way they go now, or for the one that a branch of a law ends against. */
static void ways_set(struct adaptive_task *c)
{
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		double direction = c->at[i].branch.direction;
		c->way[i] = direction != 0 ? direction : sign(c->y[V1 + 2 * i]);
	}
	// a contact ends with its force, or with the overlap
	bool forced = c->release > 0 && (c->touching || c->parted);
	const double direction = c->touching ? c->touch.on.direction : 0;
	c->way[TURN_OVERLAP] = !c->task->contact || c->held ? 0 : direction != 0 ? direction : sign(c->y[Q]);
	c->way[TURN_FORCE] = forced ? sign(rate_at(c, TURN_FORCE, c->t, c->y).value) : 0;
}

/* ---- events ---- */

/* A contact has ended, or the signal has in it. */
static void contact_over(struct adaptive_task *c)
{
	const struct pound_task *task = c->task;
	struct pound_task_result *r = c->result;
	const double ground = c->ground + c->slope * c->t;
	struct pound_counts counts = {.time = c->start + c->t,
	                              .steps = c->touch_steps,
	                              .changed = (1 + task->mass_ratio) * c->y[IMPULSE] + fabs(c->y[Q])};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		counts.body[i] = (struct pound_counts_body){
		    c->y[U1 + 2 * i],       c->y[V1 + 2 * i],        c->at[i].branch.stiffness,
		    c->at[i].branch.offset, task->bodies[i].damping, task->bodies[i].drive * ground};
	r->impulse_max = fmax(r->impulse_max, c->y[IMPULSE]);
	if (pound_contact_counts(&counts, &c->counts_scale)) {
		r->contacts++;
		c->counted_time = r->contact_time;
	} else
		r->contact_time = c->counted_time;
}

/* Velocities jump; where the hops that follow are over in next to no time, bodies stay together.
 *
 *   v_1 -= J, v_2 += r J,  J = (1 + e) q/(1 + r)       hops that are left: 2 e q/(a (1 - e)), a their relative acceleration
 */
static void contact_impact(struct adaptive_task *c)
{
	static const double HOPS_END = 1e-12; // of a sample
	struct pound_task_result *r = c->result;
	const double q = fmax(c->y[Q], 0), a = relative_acceleration(c, c->t, c->y);
	double e = c->law.restitution;
	c->held = q == 0 || (a > 0 && e < 1 && 2 * e * q < a * (1 - e) * HOPS_END * c->task->time_step);
	if (c->held)
		e = 0;
	const double impulse = (1 + e) * q / (1 + c->task->mass_ratio);
	c->y[V1] -= impulse;
	c->y[V2] += c->task->mass_ratio * impulse;
	c->y[P] = 0;
	c->y[Q] = -e * q;
	c->y[IMPULSE] = c->touch_steps = 0;
	c->touching = c->held;
	r->impulse_max = fmax(r->impulse_max, impulse);
	if (q >= c->law.speed_floor && r->contacts++ == 0)
		r->first_contact = c->start + c->t, r->first_speed = q;
}

static void contact_transition(struct adaptive_task *c)
{
	struct pound_task_result *r = c->result;
	if (c->held) {
		r->impulse_max = fmax(r->impulse_max, c->y[IMPULSE]);
		c->held = c->touching = false;
		return;
	}
	if (c->task->force == POUND_FORCE_IMPACT) {
		contact_impact(c);
		return;
	}
	if (c->touching) {
		contact_over(c);
		c->touching = false;
		c->parted = !c->law.tension && c->law.dashpot > 0 && c->y[P] > 0;
		return;
	}
	if (!c->parted)
		pound_contact_begin(&c->law, &c->touch, c->y[Q]);
	if (r->contacts == 0)
		r->first_contact = c->start + c->t, r->first_speed = c->y[Q];
	c->y[IMPULSE] = c->touch_steps = 0;
	c->touching = true;
	c->parted = false;
}

static void body_transition(struct adaptive_task *c, int i, enum pound_edge edge)
{
	struct pound_law_state *at = &c->at[i];
	double u = edge == POUND_EDGE_LOW    ? at->branch.low
	           : edge == POUND_EDGE_HIGH ? at->branch.high
	                                     : c->y[U1 + 2 * i];
	if (edge != POUND_EDGE_REVERSAL || at->branch.direction != 0)
		pound_law_leave(&c->task->bodies[i].backbone, at, edge, u);
}

static void event_pass(struct adaptive_task *c, enum guard j)
{
	// bodies that are pressed to rest turn by every rounding: turns count where a branch of a law ends with them
	c->events += j >= TURNS || (j == TURN_OVERLAP && c->touching && c->touch.on.direction != 0) ||
	             (j < TURN_OVERLAP && c->at[j - TURN].branch.direction != 0);
	if (j == CONTACT)
		contact_transition(c);
	else if (j == CLEARS)
		c->parted = false;
	else if (j == TOUCH_LOW || j == TOUCH_HIGH)
		pound_contact_leave(&c->law, &c->touch, j == TOUCH_LOW ? POUND_EDGE_LOW : POUND_EDGE_HIGH,
		                    j == TOUCH_LOW ? c->touch.on.low : c->touch.on.high);
	else if (j == TURN_OVERLAP && c->touching && c->touch.on.direction != 0)
		pound_contact_leave(&c->law, &c->touch, POUND_EDGE_REVERSAL, c->y[P]);
	else if (j >= HIGH)
		body_transition(c, j - HIGH, POUND_EDGE_HIGH);
	else if (j >= LOW)
		body_transition(c, j - LOW, POUND_EDGE_LOW);
	else if (j < TURN_OVERLAP)
		body_transition(c, j - TURN, POUND_EDGE_REVERSAL);
	c->steps = 0;
	gsl_odeiv2_driver_reset(c->explicit);
}

/* ---- steps ---- */

/* The state at t, from that at the start of a step. */
static bool state_at(struct adaptive_task *c, const double from[STATES], double t, double y[STATES])
{
	double now = c->t;
	memcpy(y, from, sizeof(double) * STATES);
	gsl_odeiv2_driver_reset(c->explicit);
	c->explicit->h = t - now;
	return gsl_odeiv2_driver_apply(c->explicit, &now, t, y) == GSL_SUCCESS;
}

/* Moves the end of a step to where a guard has just come above 0: false position, each third time the middle.
 *
 * Given    from      (STATES)        at the start, guard not above 0
 * Returns  t, y      -, (STATES)     the end, guard above 0 there
 *          value     -               false: the stepper failed
 */
static bool locate(struct adaptive_task *c, enum guard j, const double from[STATES], double *t,
                   double y[STATES])
{
	double low = c->t, g_low = guard(c, j, c->t, from), g_high = guard(c, j, *t, y), middle[STATES];
	int side = 0;
	for (int round = 1; *t - low > 4 * DBL_EPSILON * c->task->time_step; round++) {
		double next = *t - g_high * (*t - low) / (g_high - g_low);
		if (round % 3 == 0 || !(next > low && next < *t))
			next = low + (*t - low) / 2;
		if (!(next > low && next < *t))
			break;
		if (!state_at(c, from, next, middle))
			return false;
		double g = guard(c, j, next, middle);
		// of an end that stays, half the value, so that the other one moves
		if (g > 0) {
			*t = next, g_high = g;
			memcpy(y, middle, sizeof middle);
			g_low = side > 0 ? g_low / 2 : g_low;
			side = 1;
		} else {
			low = next, g_low = g;
			g_high = side < 0 ? g_high / 2 : g_high;
			side = -1;
		}
	}
	return true;
}

/* The first guard that is above 0 already, GUARDS: none. */
static enum guard crossed(const struct adaptive_task *c)
{
	enum guard j = TURN;
	while (j < GUARDS && !(guard(c, j, c->t, c->y) > 0))
		j++;
	return j;
}

/* Where in a step the cubic through both ends of a guard is highest, if that is inside and likely above 0.
 *
 * Given    g, d   guard and its rate times the step, at both ends; neither g is above 0
 * Returns  value  share of the step; 0: it is highest at an end, or likely below 0
 */
static double hump(const double g[2], const double d[2])
{
	if (!(d[0] > 0 && d[1] < 0))
		return 0;
	const double rise = g[1] - g[0], b = 3 * rise - 2 * d[0] - d[1], a = d[0] + d[1] - 2 * rise;
	// the root between 0 and 1 of the cubic's rate, d0 + 2 b s + 3 a s^2
	const double s = d[0] / (sqrt(b * b - 3 * a * d[0]) - b);
	const double top = g[0] + s * (d[0] + s * (b + s * a)), height = top - fmax(g[0], g[1]);
	// the cubic errs by a part of the height
	return top + 0.25 * height > 0 ? s : 0;
}

/* Ends a step where a rate that turns twice within it is at its farthest in between.
 *
 * Given    t, y   end of the step
 * Returns  t, y   the same, or an earlier end, one above 0 there;  value: false: the stepper failed
 */
static bool turns_find(struct adaptive_task *c, double *t, double y[STATES])
{
	for (enum guard j = TURN; j < TURNS; j++) {
		// contact ends with its force, which has a guard of its own, or with an overlap that the steps then resolve
		if (c->way[j] == 0 || (j == TURN_OVERLAP && c->touching))
			continue;
		const struct rate start = rate_at(c, j, c->t, c->y), end = rate_at(c, j, *t, y);
		const double h = *t - c->t, way = -c->way[j];
		const double g[2] = {way * start.value, way * end.value},
		             d[2] = {way * start.change * h, way * end.change * h};
		const double s = g[1] > 0 ? 0 : hump(g, d);
		double middle[STATES];
		if (s == 0)
			continue;
		if (!state_at(c, c->y, c->t + s * h, middle))
			return false;
		if (guard(c, j, c->t + s * h, middle) > 0) {
			*t = c->t + s * h;
			memcpy(y, middle, sizeof middle);
		}
	}
	return true;
}

/* One step, cut at its first event; false: the stepper failed. */
static bool task_step(struct adaptive_task *c)
{
	double y[STATES], t = c->t, left = c->task->time_step - c->t;
	gsl_odeiv2_driver *driver = c->steps < STIFF_STEPS ? c->explicit : c->implicit;
	if (c->steps == STIFF_STEPS) {
		gsl_odeiv2_driver_reset(driver);
		driver->h = c->explicit->h;
	}
	driver->h = fmin(fmax(driver->h, DBL_EPSILON * c->task->time_step), left);
	memcpy(y, c->y, sizeof y);
	if (gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, &c->system, &t, c->task->time_step,
	                            &driver->h, y) != GSL_SUCCESS)
		return false;
	double h = driver->h;
	enum guard event = GUARDS;
	if (!turns_find(c, &t, y))
		return false;
	for (enum guard j = TURN; j < GUARDS; j++)
		if (guard(c, j, t, y) > 0) {
			event = j;
			if (!locate(c, j, c->y, &t, y))
				return false;
		}
	driver->h = h;
	c->steps++;
	c->result->contact_time += c->touching ? t - c->t : 0;
	c->touch_steps += c->touching;
	memcpy(c->y, y, sizeof y);
	c->t = t;
	bool finite = true;
	for (int j = 0; j < STATES; j++)
		finite &= isfinite(y[j]);
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		c->result->displacement_max[i] = fmax(c->result->displacement_max[i], fabs(y[U1 + 2 * i]));
	if (event != GUARDS)
		event_pass(c, event);
	return finite;
}

static enum pound_status interval_run(struct adaptive_task *c, int sample)
{
	const struct pound_task *task = c->task;
	c->start = (sample - 1) * task->time_step;
	c->ground = task->ground[sample - 1];
	c->slope = (task->ground[sample] - c->ground) / task->time_step;
	c->t = 0;
	c->steps = c->events = 0;
	for (int n = 0; c->t < task->time_step; n++) {
		ways_set(c);
		if (n == STEPS_LIMIT)
			return POUND_TOLERANCE;
		enum guard j = crossed(c);
		if (j != GUARDS)
			event_pass(c, j);
		else if (!task_step(c))
			return POUND_TOLERANCE;
		if (c->events > EVENTS_LIMIT)
			return POUND_CHATTER;
	}
	return POUND_OK;
}

/* ---- from the start of a task to its end ---- */

/* Sizes that components have at least where they matter: of the response to be expected. */
static void scales_fill(const struct adaptive_task *c, double scale[STATES])
{
	const struct pound_task *task = c->task;
	double w = 1 / (task->n_samples * task->time_step), a = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		w = fmax(w, sqrt(task->bodies[i].backbone.stiffness));
	for (int t = 0; t < task->n_samples; t++)
		a = fmax(a, fabs(task->ground[t]));
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		a = fmax(a, w * fmax(fabs(task->bodies[i].v), w * fabs(task->bodies[i].u)));
	a = a > 0 ? a : 1;
	for (int j = 0; j < STATES; j++)
		scale[j] = FLOOR * a / (j == U1 || j == U2 || j == P ? w * w : w);
}

static void task_start(struct adaptive_task *c)
{
	const struct pound_task *task = c->task;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		pound_law_start(&task->bodies[i].backbone, &c->at[i]);
		c->y[U1 + 2 * i] = task->bodies[i].u;
		c->y[V1 + 2 * i] = task->bodies[i].v;
		c->result->displacement_max[i] = fabs(task->bodies[i].u);
	}
	c->y[P] = c->y[U1] - c->y[U2] - task->gap;
	c->y[Q] = c->y[V1] - c->y[V2];
	c->law = pound_task_law(task);
	// of powers the force has no rate where their overlap ends
	const bool line = task->contact && !c->law.tension && task->force == POUND_FORCE_LINEAR;
	c->release = line ? c->law.dashpot / c->law.stiffness : 0;
}

static void task_end(struct adaptive_task *c, enum pound_status status)
{
	struct pound_task_result *r = c->result;
	if (status) {
		*r = (struct pound_task_result){.status = status};
		return;
	}
	// a contact still open at the end counts with what it has
	if (c->held)
		r->impulse_max = fmax(r->impulse_max, c->y[IMPULSE]);
	else if (c->touching)
		contact_over(c);
	if (r->contacts == 0)
		r->first_contact = r->first_speed = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		r->u[i] = c->y[U1 + 2 * i];
		r->v[i] = c->y[V1 + 2 * i];
		if (!c->task->bodies[i].followed)
			r->displacement_max[i] = NAN;
	}
}

/* The response of a task by adaptive steps.
 *
 * Given    solver    tolerance  -     of a step's error to the component and its change over the step
 *          task      -          -     see task.h
 * Returns  result    -          -     all 0 but the status where it failed
 * Status   POUND_TOLERANCE  the steps became too small or too many
 *          POUND_CHATTER    more events in one sample interval than allowed
 *          POUND_STOPPED    stop, which is looked at between samples, was set; NULL: never
 *          POUND_NOMEM      where the program has set GSL's error handler not to end it for that
 * Memory   allocates GSL's work space, some kB once for the task, and frees it
 *
 * Valid    Errors of a run are some ten to a hundred times the tolerance, until impacts have made them grow.  Steps
 *          follow from the C library's pow, so the last digits may be another machine's own.
 * Source   GSL Reference Manual 2.7, Ordinary Differential Equations; Prince and Dormand 1981, J. Comput. Appl. Math. 7,
 *          67-75 (rk8pd)
 * Test     unit_adaptive
 */
void pound_adaptive_run(const struct pound_solver *solver, const struct pound_task *task,
                        struct pound_task_result *result, const atomic_bool *stop)
{
	*result = (struct pound_task_result){0};
	struct adaptive_task c = {.task = task, .result = result};
	// at rest no velocity has a way yet, so the first steps are short and grow
	double scale[STATES], h = task->time_step * 0x1p-20;
	c.system = (gsl_odeiv2_system){derivative, jacobian, STATES, &c};
	task_start(&c);
	scales_fill(&c, scale);
	c.explicit = gsl_odeiv2_driver_alloc_scaled_new(&c.system, gsl_odeiv2_step_rk8pd, h, solver->tolerance,
	                                                solver->tolerance, 1, 1, scale);
	c.implicit = gsl_odeiv2_driver_alloc_scaled_new(&c.system, gsl_odeiv2_step_msbdf, h, solver->tolerance,
	                                                solver->tolerance, 1, 1, scale);
	enum pound_status status = c.explicit && c.implicit ? POUND_OK : POUND_NOMEM;
	if (!status)
		gsl_odeiv2_driver_set_nmax(c.explicit, STEPS_LIMIT);
	for (int t = 1; t < task->n_samples && !status; t++)
		status = pound_stopped(stop) ? POUND_STOPPED : interval_run(&c, t);
	task_end(&c, status);
	if (c.explicit)
		gsl_odeiv2_driver_free(c.explicit);
	if (c.implicit)
		gsl_odeiv2_driver_free(c.implicit);
}
