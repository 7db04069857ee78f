/* floor_pieces.c - the motion of one floor, from the instants that the exact solver reports, as pieces.
 *
 * 1. Free motion over a whole sample is given by its state; a polynomial is made from it where needed.
 * 2. Any other interval between two instants is a power series in time, or several if one is too long: of the floor's
 *    absolute acceleration -(c v + r + F)/m1 and of its part -F/m1.
 * 3. A contact whose own oscillation has decayed has series as long as the bodies' own motion allows, at any stiffness.
 *
 * The solver decides which events happen and when; nothing is decided here. */
#include "engine/floor/floor_pieces.h"
#include "engine/exact/tolerances.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum {
	N = POUND_FLOOR_ORDER,
	ORDER_LEAST = 5,       /* so that linear forcing has a fourth derivative, which bounds need */
	STEPS_LIMIT = 1 << 19, /* of series in one interval */
	SETTLED_ROUNDS = 8,
};

static const double REACH = 1.5;              /* largest rate * step of a series */
static const double NOTHING_BESIDE = 0x1p-48; /* of the largest acceleration */

/* Smallest rate_touch * step of a quasi-static contact: each coefficient of its overlap is found from the next two, with factors up
 * to N G/(W^2 h) and N^2/(W h)^2, W, G the contact's rate and damping.  With the bodies' own damping a contact of restitution 0 is
 * 1.01 times critical, so that rate_touch <= 1.15 W: the factors are below 0.3 and 0.02. */
static const double QUASI_STATIC_LEAST = 180;

/* Largest neglected acceleration of a contact's own oscillation, over the terms of the bodies' accelerations, at any stiffness;
 * and the exponent of e by which losses damp an oscillation from there to below NOTHING_BESIDE. */
static const double SWING_MOST = 0x1p-24, SWING_LOST = 36;

/* Derivatives by the elapsed fraction of the step; times 1/n! they are the coefficients of its powers. */
struct body_series {
	int order;
	double step;
	// of left, right and overlap; index n + 1 has derivative n of their velocities.  Separated: of left only
	double y[3][N + 2];
	// of the floor's acceleration without its branch's offset, and of the contact's part of it, times the step squared
	double floor[N + 1], push[N + 1];
};

/* ---- polynomials ---- */

/* Order of a polynomial without its last terms that are below rounding of the others.
 *
 * Given    size  (order + 1) magnitudes of its terms;  sum: their sum
 */
static int order_kept(const double *size, int order, double sum)
{
	double rest = 0;
	while (order > 0 && rest + size[order] <= NOTHING_BESIDE * sum)
		rest += size[order--];
	return order;
}

/* Bounds an acceleration over a step with two of its derivatives.
 *
 * Given    a  its coefficients  (order + 1)
 * Returns  value  its order, without last terms below rounding of the others
 */
int pound_floor_bound(struct pound_polynomial *a, int order)
{
	double size[N + 2], bound[3][2] = {{0}};
	for (int n = 0; n <= order; n++)
		size[n] = fabs(a->c[n]);
	size[order + 1] = 0;
	// even and odd terms summed separately: two shorter chains of additions
	for (int n = 0; n <= order; n += 2)
		for (int j = 0; j < 2; j++)
			bound[0][j] += size[n + j];
	a->bound[0] = bound[0][0] + bound[0][1];
	order = order_kept(size, order, a->bound[0]);
	size[order + 1] = 0;
	for (int n = 0; n <= order; n += 2)
		for (int j = 0; j < 2; j++) {
			bound[1][j] += (n + j) * size[n + j];
			bound[2][j] += (double)((n + j) * (n + j - 1)) * size[n + j];
		}
	a->bound[1] = bound[1][0] + bound[1][1];
	a->bound[2] = bound[2][0] + bound[2][1];
	return order;
}

/* An acceleration over a step.
 *
 * Given    a  derivatives by the elapsed fraction of the step, times the step squared;  offset: subtracted
 * Returns  value  its order
 */
static int polynomial_fill(struct pound_polynomial *into, const double *a, int order, double offset,
                           double step)
{
	const double per_step = 1 / step;
	into->c[0] = a[0] * per_step * per_step - offset;
	for (int n = 1; n <= order; n++)
		into->c[n] = a[n] * POUND_FACTOR[n] * per_step * per_step;
	return pound_floor_bound(into, order);
}

/* Coefficients of the absolute acceleration -(c v + r) of a body in free motion over a sample.
 *
 * Given    state  as in struct pound_floor_piece
 *          k, c   stiffness [1/s2] and damping [1/s] per mass;  h  the sample step [s]
 * Returns  a      [m/s2]  (order + 1)
 *
 *   r' = h k v     v' = -h (c v + r + forcing)     by the elapsed fraction of the sample
 * Test     unit_floor_pieces: every_piece_leads_to_the_next
 */
void pound_floor_free_motion(const double state[4], double k, double c, double h, int order, double *a)
{
	const double hk = h * k, hc = h * c;
	double r = state[0], v = state[1];
	for (int n = 0; n <= order; n++) {
		double force = n == 0 ? h * state[2] : n == 1 ? h * state[3] : 0;
		a[n] = -(c * v + r) * POUND_FACTOR[n];
		double next = -(hc * v + (h * r + force));
		r = hk * v;
		v = next;
	}
}

/* Coefficients of a drive over a piece of a stretch.
 *
 * Given    damping  of the left body, per mass [1/s]
 * Returns  c        [m/s2]  (value + 1): the piece's own, or of a floor in free motion, computed into `room`
 *          value    their order; -1: the drive is 0
 * Test     unit_floor_pieces: every_piece_leads_to_the_next
 */
int pound_floor_drive(const struct pound_floor_stretch *stretch, const struct pound_floor_piece *piece,
                      enum pound_drive drive, double damping, double room[POUND_FLOOR_ROOM], const double **c)
{
	const struct pound_polynomial *own = drive == POUND_DRIVE_PUSH ? &piece->push : &piece->floor;
	*c = own->c;
	if (!(own->bound[0] > 0))
		return -1;
	if (piece->map < 0)
		return piece->order;
	double size[N + 1], sum = 0;
	*c = room;
	pound_floor_free_motion(piece->state, stretch->stiffness[piece->map], damping, piece->step,
	                        stretch->order, room);
	for (int n = 0; n <= stretch->order; n++)
		sum += size[n] = fabs(room[n]);
	return order_kept(size, stretch->order, sum);
}

/* ---- series ---- */

/* Test     unit_floor_pieces: terms_end_in_rounding */
int pound_floor_terms(double x)
{
	int n = 0;
	for (int k = 0; k <= POUND_FLOOR_TERMS; k++) // all are compared: an early exit would be mispredicted
		n += x > POUND_TERMS_REACH[k];
	return n;
}

/* Order of the series of a step from x = rate * step. */
static int order_of(double x)
{
	int n = pound_floor_terms(x);
	return n < ORDER_LEAST ? ORDER_LEAST : n > N ? N : n;
}

/* Derivatives n and n + 1 of left, right and overlap by the elapsed fraction of a step, and the coefficients of the recurrence for
 * the next, scaled to the step. */
struct body_terms {
	double u[3], w[3];
	double c[2], k[2], force[2], increase[2]; /* of each body */
	double spring, dash, both, ratio;         /* of the contact, 1 + m1/m2, m1/m2 */
};

static struct body_terms terms_of(const struct pound_task *task, const struct pound_instant_of_task *at,
                                  double dt)
{
	const double dt2 = dt * dt;
	struct body_terms m = {.both = 1 + task->mass_ratio, .ratio = task->mass_ratio};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		m.c[i] = b->damping * dt;
		m.k[i] = at->stiffness[i] * dt2;
		m.force[i] = (b->drive * at->ground + at->spring_offset[i]) * dt2;
		m.increase[i] = b->drive * at->slope * dt2 * dt;
		m.u[i] = at->u[i];
		m.w[i] = at->v[i] * dt;
	}
	m.u[2] = at->overlap;
	m.w[2] = at->overlap_rate * dt;
	m.spring = task->contact_stiffness * dt2;
	m.dash = task->contact_damping * dt;
	return m;
}

/* Derivative n of a body's forcing by the ground and the offset of its branch. */
static inline double forcing(const struct body_terms *m, int i, int n)
{
	return n == 0 ? m->force[i] : n == 1 ? m->increase[i] : 0;
}

static void series_separated(struct body_series *s, struct body_terms m)
{
	double u = m.u[0], w = m.w[0];
	for (int n = 0; n <= s->order; n++) {
		s->y[0][n] = u;
		s->floor[n] = -(m.c[0] * w + m.k[0] * u);
		u = w;
		w = s->floor[n] - forcing(&m, 0, n);
	}
	s->y[0][s->order + 1] = u;
}

static void series_contact(struct body_series *s, struct body_terms m)
{
	for (int n = 0; n <= s->order; n++) {
		double free[2], next[3];
		for (int i = 0; i < 2; i++) {
			free[i] = -(m.c[i] * m.w[i] + m.k[i] * m.u[i]);
			next[i] = free[i] - forcing(&m, i, n);
		}
		const double push = m.spring * m.u[2] + m.dash * m.w[2];
		next[2] = next[0] - next[1] - m.both * push;
		next[0] -= push;
		next[1] += m.ratio * push;
		s->floor[n] = free[0] - push;
		s->push[n] = -push;
		for (int j = 0; j < 3; j++) {
			s->y[j][n] = m.u[j];
			m.u[j] = m.w[j];
			m.w[j] = next[j];
		}
	}
	for (int j = 0; j < 3; j++)
		s->y[j][s->order + 1] = m.u[j];
}

/* ---- quasi-static contact ---- */

/* Largest negligible acceleration of a contact's own oscillation, over the terms of the bodies' accelerations: a rounding.
 *
 * If losses do not damp the oscillation within a sample, rounding errors sustain it, and more is neglected.  It changes velocities
 * by its acceleration over rate_touch, the bodies' own accelerations by theirs over rate: the neglected part of the velocities is a
 * rounding, and of the response of an oscillator on the floor with frequency omega it is omega/rate roundings. */
static double swing_nothing(const struct pound_floor_motion *motion)
{
	const struct pound_task *task = motion->task;
	double lost = 0.5 * (1 + task->mass_ratio) * task->contact_damping * task->time_step;
	return lost > SWING_LOST ? NOTHING_BESIDE
	                         : fmin(NOTHING_BESIDE * motion->rate_touch / motion->rate, SWING_MOST);
}

/* Whether a contact may be quasi-static: the acceleration of its overlap is small (series_quasi_static then checks the rate).
 *
 * Returns  terms  sum of the magnitudes of all terms of both bodies' accelerations, without the contact's [m/s2]
 */
static bool may_be_quasi_static(const struct pound_floor_motion *motion,
                                const struct pound_instant_of_task *at, double *terms)
{
	const struct pound_task *task = motion->task;
	double closing = 0, slow = motion->rate / motion->rate_touch;
	*terms = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const double term[4] = {task->bodies[i].damping * at->v[i], at->stiffness[i] * at->u[i],
		                        at->spring_offset[i], task->bodies[i].drive * at->ground};
		double force = term[0] + term[1] + term[2] + term[3];
		*terms += fabs(term[0]) + fabs(term[1]) + fabs(term[2]) + fabs(term[3]);
		closing += i ? force : -force;
	}
	double push = task->contact_stiffness * at->overlap + task->contact_damping * at->overlap_rate;
	return fabs(closing - (1 + task->mass_ratio) * push) <=
	       fmax(4 * slow * slow, swing_nothing(motion)) * *terms;
}

/* Series of a quasi-static contact: its overlap follows the force between the bodies, and its own oscillation is below
 * a rounding.
 *
 * Given    terms    from may_be_quasi_static;  s: its order and step
 * Returns  value   false: not quasi-static; s is invalid
 *
 *   w = (m1 u1 + m2 u2)/(m1 + m2)     w'' = (r b1 + b2)/(1 + r)     r = m1/m2
 *   p'' = b1 - b2 - (1 + r) (K p + C p')
 *
 * with the accelerations b1, b2 of the bodies without their contact.  The overlap is the solution whose power series is as short
 * as the series of w: each coefficient follows from the next two, from the last downwards.  Its contribution to b1 and b2 is
 * smaller than their terms by (rate/W)^2, so that few rounds suffice.
 */
static bool series_quasi_static(struct body_series *s, const struct pound_floor_motion *motion,
                                const struct pound_instant_of_task *at, double terms)
{
	const double dt = s->step;
	const struct body_terms m = terms_of(motion->task, at, dt);
	const double share[2] = {1 / m.both, -m.ratio / m.both};
	const double spring = m.both * m.spring, dash = m.both * m.dash;
	const double w0 = (m.ratio * m.u[0] + m.u[1]) / m.both;
	const double rate0 = (m.ratio * m.w[0] + m.w[1]) / m.both;
	const int order = s->order;
	double u[2][N + 1], w[2][N + 1], p[N + 2] = {m.u[2]}, q[N + 2] = {0}, closing[N + 1], last = 0;
	// round 0 moves the bodies with a constant overlap; the overlap that it finds enters their motion in round 1
	for (int round = 0; round < SETTLED_ROUNDS && (round < 2 || p[0] != last); round++) {
		double mean = w0, rate = rate0;
		last = p[0];
		for (int n = 0; n <= order; n++) {
			double b[2], off = p[n] + (n == 0 ? motion->task->gap : 0);
			for (int i = 0; i < 2; i++) {
				u[i][n] = mean + share[i] * off;
				w[i][n] = rate + share[i] * q[n];
				b[i] = -(m.c[i] * w[i][n] + m.k[i] * u[i][n]) - forcing(&m, i, n);
			}
			closing[n] = b[0] - b[1];
			mean = rate * POUND_SHARE[n];
			rate = (m.ratio * b[0] + b[1]) / m.both * POUND_SHARE[n];
		}
		for (int n = order; n >= 0; n--) {
			q[n] = (n + 1) * p[n + 1];
			p[n] = (closing[n] - dash * q[n] - (n + 1) * q[n + 1]) / spring;
		}
	}
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
	double swing = fabs(m.u[2] - p[0]) * spring, scaled_rate = fabs(m.w[2] - q[0]) * sqrt(spring);
	return swing + scaled_rate <= swing_nothing(motion) * (terms * (dt * dt));
}

/* ---- the next series ---- */

/* Step of a series within the remaining time. */
static double step_length(double left, double rate)
{
	double reach = rate > 0 ? REACH / rate : DBL_MAX, steps = left / reach;
	return steps <= 1 ? left : steps > 2 ? reach : 0.5 * left;
}

/* The series from an instant on: over all of the remaining time, or as far as it is accurate.
 *
 * Valid    to rounding: REACH^n/n! is below rounding at the first neglected term
 */
static void series_next(struct body_series *s, const struct pound_floor_motion *motion,
                        const struct pound_instant_of_task *at, double left)
{
	const double rate = at->touching ? motion->rate_touch : motion->rate;
	double terms;
	s->step = step_length(left, motion->rate);
	if (at->touching && rate * s->step >= QUASI_STATIC_LEAST && may_be_quasi_static(motion, at, &terms)) {
		s->order = order_of(motion->rate * s->step);
		if (series_quasi_static(s, motion, at, terms))
			return;
	}
	s->step = step_length(left, rate);
	s->order = order_of(rate * s->step);
	(at->touching ? series_contact : series_separated)(s, terms_of(motion->task, at, s->step));
}

/* Moves the state of an instant to the end of a series; terms are summed from the smallest. */
static void instant_move(struct pound_instant_of_task *at, const struct body_series *s)
{
	double *const u[3] = {&at->u[0], &at->u[1], &at->overlap};
	double *const v[3] = {&at->v[0], &at->v[1], &at->overlap_rate};
	for (int j = 0; j < (at->touching ? 3 : 1); j++) {
		double sum[2] = {0};
		for (int n = s->order; n >= 0; n--)
			for (int d = 0; d < 2; d++)
				sum[d] += s->y[j][n + d] * POUND_FACTOR[n];
		*u[j] = sum[0];
		*v[j] = sum[1] / s->step;
	}
	at->ground += at->slope * s->step;
}

/* ---- pieces ---- */

/* Index of a stiffness in a stretch; -1: there are too many. */
static int map_of(struct pound_floor_stretch *stretch, double stiffness, double damping, double step)
{
	int m = 0;
	while (m < stretch->n_maps && stretch->stiffness[m] != stiffness)
		m++;
	if (m == POUND_FLOOR_MAPS)
		return -1;
	if (m < stretch->n_maps)
		return m;
	stretch->n_maps++;
	stretch->stiffness[m] = stiffness;
	double(*bound)[4] = memset(stretch->bound[m], 0, sizeof stretch->bound[m]);
	for (int j = 0; j < 4; j++) {
		const double unit[4] = {j == 0, j == 1, j == 2, j == 3};
		double a[N + 1];
		pound_floor_free_motion(unit, stiffness, damping, step, stretch->order, a);
		for (int n = 0; n <= stretch->order; n++) {
			bound[0][j] += fabs(a[n]);
			bound[1][j] += n * fabs(a[n]);
			bound[2][j] += n * (n - 1.0) * fabs(a[n]);
		}
	}
	return m;
}

/* Makes space for another piece. */
static void stretch_room(struct pound_floor_motion *motion)
{
	struct pound_floor_stretch *stretch = motion->stretch;
	if (stretch->n < POUND_FLOOR_PIECES)
		return;
	motion->taker.take(motion->taker.into);
	stretch->n = stretch->n_maps = 0;
}

struct pound_floor_piece *pound_floor_piece_add(struct pound_floor_motion *motion, double start, double step)
{
	stretch_room(motion);
	struct pound_floor_piece *piece = &motion->stretch->piece[motion->stretch->n++];
	piece->start = start;
	piece->step = step;
	piece->sampled = motion->sampled;
	piece->after_event = motion->after_event;
	piece->jump = motion->jump;
	piece->map = -1;
	motion->sampled = motion->after_event = false;
	motion->jump = 0;
	return piece;
}

/* Adds a piece of the left body. */
static struct pound_floor_piece *piece_next(struct pound_floor_motion *motion,
                                            const struct pound_instant_of_task *at, double step)
{
	struct pound_floor_piece *piece = pound_floor_piece_add(motion, at->time, step);
	piece->u = at->u[0];
	piece->v = at->v[0];
	return piece;
}

/* Adds the piece of the floor over a sample of free motion.
 *
 * Given    map  index of its stiffness
 */
static void free_motion_add(struct pound_floor_motion *motion, int map)
{
	const struct pound_instant_of_task *at = &motion->from;
	const double h = motion->task->time_step, drive = motion->task->bodies[0].drive;
	struct pound_floor_piece *piece = piece_next(motion, at, h);
	piece->map = map;
	piece->order = -1;
	piece->state[0] = at->stiffness[0] * at->u[0] + at->spring_offset[0];
	piece->state[1] = at->v[0];
	piece->state[2] = drive * at->ground;
	piece->state[3] = drive * (at->slope * h);
	pound_floor_free_motion(piece->state, at->stiffness[0], motion->task->bodies[0].damping, h, 1,
	                        piece->floor.c);
	for (int d = 0; d < 3; d++) {
		piece->floor.bound[d] = piece->push.bound[d] = 0;
		for (int j = 0; j < 4; j++)
			piece->floor.bound[d] += motion->stretch->bound[map][d][j] * fabs(piece->state[j]);
	}
}

/* Adds the piece of the floor over a series. */
static void series_add(struct pound_floor_motion *motion, const struct pound_instant_of_task *at,
                       const struct body_series *s)
{
	struct pound_floor_piece *piece = piece_next(motion, at, s->step);
	piece->order = polynomial_fill(&piece->floor, s->floor, s->order, at->spring_offset[0], s->step);
	if (!at->touching || !motion->pushed) {
		memset(piece->push.bound, 0, sizeof piece->push.bound);
		return;
	}
	int order = polynomial_fill(&piece->push, s->push, s->order, 0, s->step);
	piece->order = order > piece->order ? order : piece->order;
}

/* Adds the pieces of the floor from the last instant on. */
static void interval_add(struct pound_floor_motion *motion, double length)
{
	struct pound_instant_of_task at = motion->from;
	struct body_series s;
	double gone = 0; // summed from 0: added to the time it would lose digits
	for (int steps = 0; !motion->status && !pound_stopped(motion->stop); steps++) {
		stretch_room(motion);
		series_next(&s, motion, &at, length);
		series_add(motion, &at, &s);
		if (s.step == length)
			return;
		length -= s.step;
		gone += s.step;
		instant_move(&at, &s);
		at.time = motion->from.time + gone;
		if (steps == STEPS_LIMIT)
			motion->status = POUND_CHATTER;
	}
}

/* Makes the pieces of the interval up to an instant.
 *
 * Source   model.md 1, 2 of the project's design pages
 * Test     unit_floor_pieces
 */
void pound_floor_observe(void *of, const struct pound_instant_of_task *instant)
{
	struct pound_floor_motion *motion = of;
	const double h = motion->task->time_step;
	if (motion->status || pound_stopped(motion->stop))
		return;
	motion->stretch->order = motion->order;
	if (instant->elapsed > 0) {
		const bool whole = motion->sampled && instant->sampled;
		int map = -1;
		stretch_room(motion);
		if (whole && !motion->from.touching && motion->rate * h <= REACH)
			map = map_of(motion->stretch, motion->from.stiffness[0], motion->task->bodies[0].damping, h);
		if (map >= 0)
			free_motion_add(motion, map);
		else
			interval_add(motion, whole ? h : instant->elapsed);
		motion->sampled = motion->after_event = false;
	}
	motion->sampled |= instant->sampled;
	motion->after_event |= !instant->sampled;
	motion->from = *instant;
}

/* Fastest rate of the motion in contact [rad/s]; beyond critical damping the faster of two roots.
 *
 * Given    rate  of the bodies
 */
static double rate_touch(const struct pound_task *task, double rate)
{
	const double both = 1 + task->mass_ratio, stiff = both * task->contact_stiffness;
	double frequency = 0, damping = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		frequency = fmax(frequency, sqrt(task->bodies[i].backbone.stiffness));
		damping = fmax(damping, task->bodies[i].damping);
	}
	const double own = sqrt(frequency * frequency + stiff);
	const double zeta = 0.5 * (damping + both * task->contact_damping) / own;
	return fmax(sqrt(rate * rate + stiff), zeta > 1 ? own * (zeta + sqrt(zeta * zeta - 1)) : 0);
}

/* Given    motion  task, stretch, taker and stop are set */
void pound_floor_start(struct pound_floor_motion *motion)
{
	const struct pound_task *task = motion->task;
	assert(!task->contact || task->force == POUND_FORCE_LINEAR); // other forms run as chains
	motion->status = POUND_OK;
	motion->rate = motion->jump = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		motion->rate = fmax(motion->rate, fmax(sqrt(b->backbone.stiffness), b->damping));
	}
	motion->rate_touch = task->contact ? rate_touch(task, motion->rate) : motion->rate;
	motion->from = (struct pound_instant_of_task){0};
	motion->sampled = motion->after_event = false;
	motion->order = order_of(fmin(motion->rate * task->time_step, REACH));
	motion->stretch->n = motion->stretch->n_maps = 0;
}
