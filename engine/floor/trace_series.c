/* trace_series.c - the motion of a trace over one step, as power series in time.
 *
 * The step is short enough for them to end in rounding.  A contact whose own swing has died away is a series too, as long as
 * the bodies' own motion allows, however stiff. */
#include "engine/floor/trace_series.h"

#include <float.h>
#include <math.h>

#include "engine/exact/tolerances.h"

enum {
	N = POUND_TRACE_ORDER,
	ORDER_LEAST = 5, /* so that growing forcing has a fourth derivative, which bounds are made of */
};

/* Least rate_touch * step of a settled contact: its overlap is found from a power on by those above, which count by up to
 * N G/(W^2 h) and N^2/(W h)^2.  With the bodies' own damping a contact of no restitution is 1.01 times critical, so that
 * rate_touch is up to 1.15 W: below 0.3 and 0.02. */
static const double SETTLED_LEAST = 180;
enum { SETTLED_ROUNDS = 8 };

/* Largest acceleration of a swing that is left out, over what the bodies' are made of, however stiff the contact; and the
 * power of e by which losses take a swing from there to POUND_NOTHING_BESIDE, and more. */
static const double SWING_MOST = 0x1p-24, SWING_LOST = 36;

/* Test     unit_trace: terms_end_in_rounding */
int pound_trace_terms(double x)
{
	int n = 0;
	while (x > POUND_TERMS_REACH[n])
		n++;
	return n;
}

/* Order of the series of a step. */
int pound_trace_order(double x)
{
	int n = pound_trace_terms(x);
	return n < ORDER_LEAST ? ORDER_LEAST : n > N ? N : n;
}

/* Whether a body stands still where its piece ends. */
static bool stands_at_end(const struct pound_trace *t, int i)
{
	const struct pound_piece *piece = &t->at[i].piece;
	return t->v[i] == 0 && (piece->direction != 0 || t->u[i] == piece->high || t->u[i] == piece->low);
}

/* Whether a body that stands still where its piece ends stays there: its acceleration would send it on to the next piece or
 * back, but is no more than the rounding of what it is made of.  Then what differs in its later course decides.
 *
 * Given    b  acceleration of body i, times the square of the step;  push: of the contact, so too
 */
static bool still_stays(const struct pound_trace *t, int i, double b, double push, double dt)
{
	const struct pound_march_body *body = &t->task->bodies[i];
	const struct pound_piece *piece = &t->at[i].piece;
	double made = fabs(piece->stiffness * t->u[i]) + fabs(piece->offset) + fabs(body->drive * t->ground);
	return stands_at_end(t, i) && fabs(b) < POUND_UNDECIDED * (made * dt * dt + fabs(push));
}

/* Takes the accelerations of bodies that stay where they stand, and what of the difference is left.
 *
 * Given    b, push, apart  of the bodies and the contact, and the difference, times the square of the step
 */
static double still_settle(const struct pound_trace *t, double b[2], double push, double apart, double dt)
{
	for (int i = 0; i < 2; i++)
		if (still_stays(t, i, b[i], push * (i ? t->task->mass_ratio : 1), dt)) {
			b[i] = 0;
			apart = b[0] - b[1];
		}
	return apart;
}

/* Whether bodies touch without overlap, at one velocity but for a rounding. */
static bool bodies_level(const struct pound_trace *t)
{
	return t->p == 0 && fabs(t->q) <= DBL_EPSILON * (fabs(t->v[0]) + fabs(t->v[1]));
}

/* derivatives by time of bodies that are level */
struct level {
	bool is;         /* nothing has decided yet */
	double at[2][2]; /* derivatives n and n + 1 of each body */
	double scale;    /* the step to the power of n + 2 */
};

/* What parts or presses bodies that are level: nothing, where it is no more than the rounding of what their accelerations are
 * made of; the next derivative decides.
 *
 * Returns  level  of the next order
 *          value  derivative n of the difference of their accelerations, scaled to the step
 */
static double apart_settle(struct level *level, const struct pound_trace *t, double dt, int n)
{
	double a[2], made = 0;
	for (int i = 0; i < 2; i++) {
		const struct pound_march_body *b = &t->task->bodies[i];
		const struct pound_piece *piece = &t->at[i].piece;
		double damping = b->damping * level->at[i][1], spring = piece->stiffness * level->at[i][0];
		double drive = n == 0 ? b->drive * t->ground : n == 1 ? b->drive * t->slope : 0;
		double offset = n == 0 ? piece->offset : 0;
		a[i] = -(damping + spring + (drive + offset));
		made += fabs(damping) + fabs(spring) + fabs(drive) + fabs(offset);
		level->at[i][0] = level->at[i][1];
		level->at[i][1] = a[i];
	}
	double apart = (a[0] - a[1]) * level->scale;
	level->is = !(fabs(a[0] - a[1]) > POUND_UNDECIDED * made);
	level->scale *= dt;
	return level->is ? 0 : apart;
}

/* Derivatives n and n + 1 of left, right and overlap by the share of a step that is gone, and what makes the next: all scaled
 * to the step. */
struct terms {
	double u[3], w[3];
	double c[2], k[2], force[2], increase[2]; /* of each body */
	double spring, dash, both, ratio;         /* of the contact, 1 + m1/m2, m1/m2 */
};

/* Derivative n of what the ground and its piece do to a body. */
static inline double forcing(const struct terms *m, int i, int n)
{
	return n == 0 ? m->force[i] : n == 1 ? m->increase[i] : 0;
}

/* Keeps derivative n, and makes the next. */
static inline void terms_next(struct pound_trace_series *s, struct terms *m, const struct pound_trace *t,
                              struct level *level, int n)
{
	double free[2], b[2];
	for (int i = 0; i < 2; i++) {
		free[i] = -(m->c[i] * m->w[i] + m->k[i] * m->u[i]);
		b[i] = free[i] - forcing(m, i, n);
	}
	double apart = level->is ? apart_settle(level, t, s->step, n) : b[0] - b[1];
	double push = m->spring * m->u[2] + m->dash * m->w[2];
	apart -= m->both * push;
	b[0] -= push;
	b[1] += m->ratio * push;
	if (n == 0)
		apart = still_settle(t, b, push, apart, s->step);
	s->floor[n] = free[0] - push;
	s->push[n] = -push;
	for (int j = 0; j < 3; j++) {
		s->y[j][n] = m->u[j];
		m->u[j] = m->w[j];
		m->w[j] = j < 2 ? b[j] : apart;
	}
}

static struct terms terms_of(const struct pound_trace *t, double dt)
{
	const struct pound_march_task *task = t->task;
	struct terms m = {.both = 1 + task->mass_ratio, .ratio = task->mass_ratio};
	for (int i = 0; i < 2; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		const struct pound_piece *piece = &t->at[i].piece;
		m.c[i] = b->damping * dt;
		m.k[i] = piece->stiffness * (dt * dt);
		m.force[i] = (b->drive * t->ground + piece->offset) * (dt * dt);
		m.increase[i] = b->drive * t->slope * (dt * dt) * dt;
		m.u[i] = t->u[i];
		m.w[i] = t->v[i] * dt;
	}
	m.u[2] = t->p;
	m.w[2] = t->q * dt;
	m.spring = t->touching ? task->contact_stiffness * (dt * dt) : 0;
	m.dash = t->touching ? task->contact_damping * dt : 0;
	return m;
}

static void series_fill(struct pound_trace_series *s, const struct pound_trace *t, double dt, int order)
{
	struct terms m = terms_of(t, dt);
	s->order = order;
	s->step = dt;
	struct level level = {
	    t->task->contact && bodies_level(t), {{t->u[0], t->v[0]}, {t->u[1], t->v[1]}}, dt * dt};
	for (int n = 0; n <= order; n++)
		terms_next(s, &m, t, &level, n);
	for (int j = 0; j < 3; j++)
		s->y[j][order + 1] = m.u[j];
}

/* Largest of what the accelerations of both bodies are made of, but for the contact's [m/s2]. */
static double pull_of(const struct pound_trace *t)
{
	double sum = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *b = &t->task->bodies[i];
		const struct pound_piece *piece = &t->at[i].piece;
		sum += fabs(b->damping * t->v[i]) + fabs(piece->stiffness * t->u[i]) + fabs(piece->offset) +
		       fabs(b->drive * t->ground);
	}
	return sum;
}

/* How large the acceleration of a contact's own swing may be, over what the bodies' are made of, to be left out: a rounding.
 *
 * Where its losses do not end it within a sample, rounding keeps it alive for ever, and more is left out.  A swing adds to
 * velocities by 1/rate_touch, where the bodies' own accelerations add by 1/rate: what is left out of these is a rounding, and
 * omega/rate times that of an oscillator of omega on the floor.  Not where the sign of a velocity decides. */
static double swing_nothing(const struct pound_trace *t)
{
	bool decides = t->at[0].piece.direction != 0 || t->at[1].piece.direction != 0;
	double lost = 0.5 * (1 + t->task->mass_ratio) * t->task->contact_damping * t->task->time_step;
	return decides || lost > SWING_LOST ? POUND_NOTHING_BESIDE
	                                    : fmin(POUND_NOTHING_BESIDE * t->rate_touch / t->rate, SWING_MOST);
}

/* Whether a contact may be settled: its overlap is neither fast nor accelerated, as the swinging one is all the time. */
static bool may_settle(const struct pound_trace *t, double pull)
{
	const struct pound_march_task *task = t->task;
	double apart = 0, slow = t->rate / t->rate_touch;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		double force = b->damping * t->v[i] + t->at[i].piece.stiffness * t->u[i] + t->at[i].piece.offset +
		               b->drive * t->ground;
		apart += i ? force : -force;
	}
	double push = task->contact_stiffness * t->p + task->contact_damping * t->q;
	return fabs(apart - (1 + task->mass_ratio) * push) <= fmax(4 * slow * slow, swing_nothing(t)) * pull;
}

/* Series of a contact that has settled: its overlap follows what presses the bodies on each other, and its own swing adds
 * no more than a rounding.
 *
 * Given    pull    as pull_of has it
 * Returns  value   false: it has not settled; s is not to be used
 *
 *   w = (m1 u1 + m2 u2)/(m1 + m2)     w'' = (r b1 + b2)/(1 + r)     r = m1/m2
 *   p'' = b1 - b2 - (1 + r) (K p + C p')
 *
 * with the accelerations b1, b2 of the bodies without their contact.  The overlap is that part of the solution which has a
 * power series as short as that of w: its coefficients follow from those above, down from the last.  What it adds to b1 and
 * b2 is by (rate/W)^2 less than what they are made of, so that few rounds settle that.
 */
static bool series_settle(struct pound_trace_series *s, const struct pound_trace *t, double dt, int order,
                          double pull)
{
	const struct pound_march_task *task = t->task;
	const struct terms m = terms_of(t, dt);
	const double share[2] = {1 / m.both, -m.ratio / m.both};
	const double spring = m.both * m.spring, dash = m.both * m.dash;
	const double w0 = (m.ratio * t->u[0] + t->u[1]) / m.both;
	const double rate0 = (m.ratio * t->v[0] + t->v[1]) / m.both * dt;
	double u[2][N + 1], w[2][N + 1], p[N + 2] = {t->p}, q[N + 2] = {0}, apart[N + 1], last = 0;
	// the first round has the bodies go along with an overlap that stays: what it finds takes another to reach them
	for (int round = 0; round < SETTLED_ROUNDS && (round < 2 || p[0] != last); round++) {
		double mean = w0, rate = rate0;
		last = p[0];
		for (int n = 0; n <= order; n++) {
			double b[2], off = p[n] + (n == 0 ? task->gap : 0);
			for (int i = 0; i < 2; i++) {
				u[i][n] = mean + share[i] * off;
				w[i][n] = rate + share[i] * q[n];
				b[i] = -(m.c[i] * w[i][n] + m.k[i] * u[i][n]) - forcing(&m, i, n);
			}
			apart[n] = b[0] - b[1];
			mean = rate * POUND_SHARE[n];
			rate = (m.ratio * b[0] + b[1]) / m.both * POUND_SHARE[n];
		}
		for (int n = order; n >= 0; n--) {
			q[n] = (n + 1) * p[n + 1];
			p[n] = (apart[n] - dash * q[n] - (n + 1) * q[n + 1]) / spring;
		}
	}
	s->order = order;
	s->step = dt;
	double factorial = 1;
	for (int n = 0; n <= order; n++, factorial *= n) {
		const double push = m.spring * p[n] + m.dash * q[n];
		for (int i = 0; i < 2; i++) {
			s->y[i][n] = u[i][n] * factorial;
			s->y[i][n + 1] = w[i][n] * factorial;
		}
		s->y[2][n] = p[n] * factorial;
		s->y[2][n + 1] = q[n] * factorial;
		s->floor[n] = -(m.c[0] * w[0][n] + m.k[0] * u[0][n] + push) * factorial;
		s->push[n] = -push * factorial;
	}
	double swing = fabs(t->p - p[0]) * spring, hurry = fabs(t->q * dt - q[0]) * sqrt(spring);
	double force = p[0] + pound_trace_release(task) / dt * q[0];
	bool pressed = p[0] > 0 && force > 0; // or they are about to part
	return pressed && swing + hurry <= swing_nothing(t) * (pull * (dt * dt));
}

/* ---- the next step ---- */

/* How far a series reaches; whether that is to the next sample. */
static bool step_length(const struct pound_trace *t, double rate, double *dt)
{
	double reach = rate > 0 ? POUND_TRACE_REACH / rate * t->pace : DBL_MAX, steps = t->left / reach;
	*dt = steps <= 1 ? t->left : steps > 2 ? reach : 0.5 * t->left;
	return steps <= 1;
}

/* The series of the next step of a trace: to the next sample, or as far as it reaches.
 *
 * Returns  s  whole: it reaches the next sample; a share of its step is to be gone, up to the first event
 * Valid    to rounding: POUND_TRACE_REACH^n/n! is below that at the first term left out
 * Test     unit_trace
 */
void pound_trace_series(struct pound_trace_series *s, const struct pound_trace *t)
{
	double dt, rate = t->touching ? t->rate_touch : t->rate;
	s->whole = step_length(t, t->rate, &dt);
	// where a body stands, its two pieces are to see one motion, to the last bit
	bool stands = stands_at_end(t, 0) || stands_at_end(t, 1);
	if (t->touching && !stands && rate * dt >= SETTLED_LEAST) {
		double pull = pull_of(t);
		if (may_settle(t, pull) && series_settle(s, t, dt, pound_trace_order(t->rate * dt), pull))
			return;
	}
	s->whole = step_length(t, rate, &dt);
	series_fill(s, t, dt, pound_trace_order(rate * dt));
}
