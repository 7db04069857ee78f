/* trace.c - one task followed by power series from event to event, every piece handed out.
 *
 * 1. Over a step the bodies and the overlap are power series; the step is short enough for them to end in rounding.
 *    A contact whose own swing has died away is a series too, as long as the bodies' own motion allows, however stiff.
 * 2. It is cut at the first root of a guard, found by parabolas that pass no root: contact opens or closes, an edge of
 *    a law is reached, a velocity turns.
 * 3. The floor's absolute acceleration -(c v + r + F)/m1 and its part -F/m1 are combinations of the same series.
 *
 * The march does the same in lanes and keeps nothing; what both must agree in is under test. */
#include "engine/trace.h"
#include "engine/stepping.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
	N = POUND_TRACE_ORDER,
	ROOT_ROUNDS = 64,
	DEFLATE_MAX = 6,        /* leading zeros of a guard: at rest, touching, equal ground */
	EVENTS_LIMIT = 1 << 17, /* in one sample interval: more is chatter */
	EDGES = 3,
};

static const double NOTHING_BESIDE = 0x1p-48; /* of the largest acceleration */
static const double REACH = 1;                /* largest rate * step of a series */

/* Least rate_touch * step of a settled contact: its overlap is found from a power on by those above, which count by up to
 * N G/(W^2 h) and N^2/(W h)^2, with G/W up to 2: below 0.3 and 0.02. */
static const double SETTLED_LEAST = 128;
enum { SETTLED_ROUNDS = 8 };

enum event { NOTHING, CUT, CONTACT, CLEARS, BODY }; // an edge of body i is BODY + EDGES i + edge

/* Both bodies and the overlap over a step of time 0 .. 1: displacement, and velocity times the step. */
struct series {
	int order;
	double step;
	double u[POUND_OSCILLATORS][N + 2], w[POUND_OSCILLATORS][N + 2], p[N + 2], q[N + 2];
};

/* First event found so far. */
struct search {
	double time;
	int event;
};

/* The even and the odd terms apart: half the latency of Horner's rule. */
static double power_at(const double *c, int order, double t)
{
	double even = 0, odd = 0, t2 = t * t;
	int n = order;
	if (n % 2 == 0)
		even = c[n--];
	for (; n > 0; n -= 2) {
		odd = odd * t2 + c[n];
		even = even * t2 + c[n - 1];
	}
	return odd * t + even;
}

/* Test     unit_trace: terms_end_in_rounding */
int pound_trace_terms(double x)
{
	int n = 0;
	while (x > POUND_TERMS_REACH[n])
		n++;
	return n;
}

/* Order of the series of a step. */
static int order_of(double x)
{
	int n = pound_trace_terms(x);
	return n < 4 ? 4 : n > N ? N : n;
}

/* ---- series ---- */

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
	double scale;    /* of a derivative to its coefficient: the step to the power of n + 2, over n! */
};

/* What parts or presses bodies that are level: nothing, where it is no more than the rounding of what their accelerations are
 * made of; the next derivative decides.
 *
 * Returns  level  of the next order
 *          value  the difference of their accelerations, coefficient n
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
	level->scale *= dt * POUND_SHARE[n];
	return level->is ? 0 : apart;
}

static void series_fill(struct series *s, const struct pound_trace *t, double dt, int order)
{
	const struct pound_march_task *task = t->task;
	double c[2], k[2], f0[2], f1[2], dt2 = dt * dt;
	for (int i = 0; i < 2; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		const struct pound_piece *piece = &t->at[i].piece;
		c[i] = b->damping * dt;
		k[i] = piece->stiffness * dt2;
		f0[i] = (b->drive * t->ground + piece->offset) * dt2;
		f1[i] = b->drive * t->slope * dt2 * dt;
		s->u[i][0] = t->u[i];
		s->w[i][0] = t->v[i] * dt;
	}
	double spring = t->touching ? task->contact_stiffness * dt2 : 0;
	double dash = t->touching ? task->contact_damping * dt : 0;
	s->order = order;
	s->step = dt;
	s->p[0] = t->p;
	s->q[0] = t->q * dt;
	for (int n = 0; n <= order && !task->contact; n++) { // the left body is alone
		double b = -(c[0] * s->w[0][n] + k[0] * s->u[0][n]) - (n == 0 ? f0[0] : n == 1 ? f1[0] : 0);
		bool stays = n == 0 && still_stays(t, 0, b, 0, dt);
		s->u[0][n + 1] = s->w[0][n] * POUND_SHARE[n];
		s->w[0][n + 1] = stays ? 0 : b * POUND_SHARE[n];
	}
	struct level level = {bodies_level(t), {{t->u[0], t->v[0]}, {t->u[1], t->v[1]}}, dt2};
	for (int n = 0; n <= order && task->contact; n++) {
		double share = POUND_SHARE[n], b[2];
		double push = spring * s->p[n] + dash * s->q[n];
		for (int i = 0; i < 2; i++) {
			b[i] = -(c[i] * s->w[i][n] + k[i] * s->u[i][n]) - (n == 0 ? f0[i] : n == 1 ? f1[i] : 0);
			s->u[i][n + 1] = s->w[i][n] * share;
		}
		double apart = level.is ? apart_settle(&level, t, dt, n) : b[0] - b[1];
		apart -= (1 + task->mass_ratio) * push;
		b[0] -= push;
		b[1] += task->mass_ratio * push;
		if (n == 0)
			apart = still_settle(t, b, push, apart, dt);
		s->w[0][n + 1] = b[0] * share;
		s->w[1][n + 1] = b[1] * share;
		s->p[n + 1] = s->q[n] * share;
		s->q[n + 1] = apart * share;
	}
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
	return fabs(apart - (1 + task->mass_ratio) * push) <= 4 * slow * slow * pull;
}

/* What of the overlap's rate its force has beside the overlap [s], where contact ends with the force; 0: with the overlap. */
static double release_of(const struct pound_march_task *task)
{
	return task->tension ? 0 : task->contact_damping / task->contact_stiffness;
}

/* Series of a contact that has settled: its overlap follows what presses the bodies on each other, and its own swing has
 * died away to rounding.
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
static bool series_settle(struct series *s, const struct pound_trace *t, double dt, int order, double pull)
{
	const struct pound_march_task *task = t->task;
	const double both = 1 + task->mass_ratio, share[2] = {1 / both, -task->mass_ratio / both}, dt2 = dt * dt;
	const double spring = both * task->contact_stiffness * dt2, dash = both * task->contact_damping * dt;
	const double w0 = (task->mass_ratio * t->u[0] + t->u[1]) / both;
	const double rate0 = (task->mass_ratio * t->v[0] + t->v[1]) / both * dt;
	double c[2], k[2], f[2][2], apart[N + 1], last = 0;
	for (int i = 0; i < 2; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		const struct pound_piece *piece = &t->at[i].piece;
		c[i] = b->damping * dt;
		k[i] = piece->stiffness * dt2;
		f[i][0] = (b->drive * t->ground + piece->offset) * dt2;
		f[i][1] = b->drive * t->slope * dt2 * dt;
	}
	s->order = order;
	s->step = dt;
	for (int n = 0; n <= N + 1; n++)
		s->p[n] = s->q[n] = 0;
	s->p[0] = t->p;
	// the first round has the bodies go along with an overlap that stays: what it finds takes another to reach them
	for (int round = 0; round < SETTLED_ROUNDS && (round < 2 || s->p[0] != last); round++) {
		double w = w0, rate = rate0;
		last = s->p[0];
		for (int n = 0; n <= order; n++) {
			double b[2], off = s->p[n] + (n == 0 ? task->gap : 0);
			for (int i = 0; i < 2; i++) {
				s->u[i][n] = w + share[i] * off;
				s->w[i][n] = rate + share[i] * s->q[n];
				b[i] = -(c[i] * s->w[i][n] + k[i] * s->u[i][n]) - (n < 2 ? f[i][n] : 0);
			}
			apart[n] = b[0] - b[1];
			w = rate * POUND_SHARE[n];
			rate = (task->mass_ratio * b[0] + b[1]) / both * POUND_SHARE[n];
		}
		for (int n = order; n >= 0; n--) {
			s->q[n] = (n + 1) * s->p[n + 1];
			s->p[n] = (apart[n] - dash * s->q[n] - (n + 1) * s->q[n + 1]) / spring;
		}
	}
	double swing = fabs(t->p - s->p[0]) * spring, hurry = fabs(t->q * dt - s->q[0]) * sqrt(spring);
	double force = s->p[0] + release_of(task) / dt * s->q[0];
	bool pressed = s->p[0] > 0 && force > 0; // or they are about to part
	return pressed && swing + hurry <= NOTHING_BESIDE * (pull * dt2);
}

/* ---- first roots ---- */

/* First time in (0, limit] at which a guard, not positive at 0, becomes positive.
 *
 * Given    g       (order + 1)  its coefficients
 * Returns  value   NOTHING; CONTACT for found; CUT where the search had to give up
 *          t       that time, or a safe one
 *
 * A parabola with the guard's value and slope at t and a bound of its curvature lies above the guard, so no root lies
 * before the parabola's.
 */
static int root_first(const double *g, int order, double limit, double *t)
{
	for (int m = 0; m < DEFLATE_MAX && g[0] == 0 && order > 0; m++, g++, order--)
		;
	if (g[0] >= 0) {
		*t = 0;
		return g[0] > 0 ? CONTACT : NOTHING;
	}
	double top = g[0], curved = 0, d[N + 1] = {0};
	for (int n = 1; n <= order; n++) {
		top += g[n] > 0 ? g[n] : 0;
		d[n - 1] = n * g[n];
	}
	if (top < 0)
		return NOTHING;
	double raised[N + 1], large = 0;
	for (int n = 0; n <= order; n++)
		large = fmax(large, fabs(g[n]));
	if (large < 0x1p-400) { // squares are taken: what would vanish in them is raised by a power of two
		for (int n = 0; n <= order; n++) {
			raised[n] = g[n] * 0x1p600;
			d[n] *= 0x1p600;
		}
		g = raised;
	}
	for (int n = order; n > 2; n--)
		curved += (double)n * (n - 1) * fabs(g[n]);
	double second = order > 1 ? 2 * g[2] : 0, bend = fmax(0, second + curved);
	curved += fabs(second);
	*t = 0;
	for (int round = 0; round < ROOT_ROUNDS; round++) {
		double slope = order > 0 ? power_at(d, order - 1, *t) : 0, below = fmin(power_at(g, order, *t), 0);
		double root = sqrt(slope * slope - 2 * bend * below);
		double step = slope > 0 ? -2 * below / (slope + root) : bend > 0 ? (root - slope) / bend : 2;
		bool near = step * step * curved < 0.5 * DBL_EPSILON * slope;
		if (!near && step < 0.5 * DBL_EPSILON)
			return CUT;
		*t += step;
		if (*t > limit)
			return NOTHING;
		if (near)
			return CONTACT;
	}
	return CUT;
}

/* Notes the first root of a guard as the event where it comes first. */
static void search_guard(struct search *search, const double *g, int order, int event)
{
	double t;
	int found = root_first(g, order, search->time, &t);
	if (found == NOTHING)
		return;
	search->time = t;
	search->event = found == CUT ? CUT : event;
}

/* Looks for where the series of a motion rises above a level (sign +1) or falls below it (-1). */
static void search_level(struct search *search, const double *c, int order, double level, double sign,
                         int event)
{
	double g[N + 1];
	g[0] = sign * (c[0] - level);
	for (int n = 1; n <= order; n++)
		g[n] = sign * c[n];
	search_guard(search, g, order, event);
}

static void search_body(struct search *search, const struct series *s, const struct pound_piece *piece, int i)
{
	int edge = BODY + EDGES * i;
	if (piece->high < DBL_MAX)
		search_level(search, s->u[i], s->order, piece->high, 1, edge + POUND_EDGE_HIGH);
	if (piece->low > -DBL_MAX)
		search_level(search, s->u[i], s->order, piece->low, -1, edge + POUND_EDGE_LOW);
	if (piece->direction != 0)
		search_level(search, s->w[i], s->order, 0, -piece->direction, edge + POUND_EDGE_TURN);
}

/* Apart, contact begins when the overlap rises through 0.  Touching, it ends when that falls through 0 or, where the
 * dashpot must not pull, when the force does; parted, when that force rises again or the overlap is gone. */
static void search_contact(struct search *search, const struct series *s, const struct pound_trace *t)
{
	double release = release_of(t->task);
	double sign = t->touching ? -1 : 1;
	if (release == 0 || !(t->touching || t->parted)) {
		search_level(search, s->p, s->order, 0, sign, CONTACT);
		return;
	}
	double g[N + 1], lead = release / s->step;
	for (int n = 0; n <= s->order; n++)
		g[n] = sign * (s->p[n] + lead * s->q[n]);
	if (t->fresh) {
		// the force has just passed 0: it is beyond by the rounding of the overlap and of its acceleration
		double pull = fabs(s->w[0][1]) + fabs(s->w[1][1]);
		g[0] = fmin(g[0], -DBL_EPSILON * (s->p[0] + lead * pull));
	}
	search_guard(search, g, s->order, CONTACT);
	if (t->parted)
		search_level(search, s->p, s->order, 0, -1, CLEARS);
}

/* ---- pieces ---- */

/* Shortens a series to a share of its step, drops the terms that are rounding beside the others, and bounds it with two
 * derivatives; returns its order. */
static int polynomial_finish(struct pound_polynomial *a, int order, double share)
{
	double power = share, size[N + 1], rest = 0;
	size[0] = fabs(a->c[0]);
	for (int n = 1; n <= order; n++, power *= share) {
		a->c[n] *= power;
		size[n] = fabs(a->c[n]);
	}
	a->bound[0] = a->bound[1] = a->bound[2] = 0;
	for (int n = 0; n <= order; n++)
		a->bound[0] += size[n];
	while (order > 0 && rest + size[order] <= NOTHING_BESIDE * a->bound[0])
		rest += size[order--];
	for (int n = 1; n <= order; n++) {
		a->bound[1] += n * size[n];
		a->bound[2] += (double)(n * (n - 1)) * size[n];
	}
	return order;
}

/* Number of a stiffness in a stretch; -1: there are too many. */
static int map_of(struct pound_trace_stretch *stretch, double stiffness)
{
	for (int m = 0; m < stretch->n_maps; m++)
		if (stretch->stiffness[m] == stiffness)
			return m;
	if (stretch->n_maps == POUND_TRACE_MAPS)
		return -1;
	stretch->stiffness[stretch->n_maps] = stiffness;
	return stretch->n_maps++;
}

/* The floor over the first `share` of a step. */
static void piece_add(struct pound_trace *t, struct pound_trace_stretch *stretch, const struct series *s,
                      double share)
{
	const struct pound_march_task *task = t->task;
	const struct pound_piece *law = &t->at[0].piece;
	struct pound_trace_piece *piece = &stretch->piece[stretch->n++];
	double c = task->bodies[0].damping / s->step, dash = task->contact_damping / s->step;
	bool whole = t->sampled && !t->touching && s->step == task->time_step && share == 1;
	piece->start = (t->next) * task->time_step - t->left;
	piece->step = share * s->step;
	piece->u = t->u[0];
	piece->v = t->v[0];
	piece->sampled = t->sampled;
	piece->turned = t->turned;
	piece->map = whole ? map_of(stretch, law->stiffness) : -1;
	piece->state[0] = law->stiffness * t->u[0] + law->offset;
	piece->state[1] = t->v[0];
	piece->state[2] = t->ground;
	piece->state[3] = t->slope * s->step;
	if (!t->touching)
		memset(&piece->push, 0, sizeof piece->push);
	for (int n = 0; n <= s->order; n++)
		piece->floor.c[n] = -(c * s->w[0][n] + law->stiffness * s->u[0][n]);
	for (int n = 0; n <= s->order && t->touching; n++) {
		piece->push.c[n] = -(task->contact_stiffness * s->p[n] + dash * s->q[n]);
		piece->floor.c[n] += piece->push.c[n];
	}
	piece->floor.c[0] -= law->offset;
	piece->order = polynomial_finish(&piece->floor, s->order, share);
	if (!t->touching)
		return;
	int order = polynomial_finish(&piece->push, s->order, share);
	piece->order = order > piece->order ? order : piece->order;
	double area = 0;
	for (int n = order; n >= 0; n--)
		area += piece->push.c[n] * POUND_SHARE[n];
	t->impulse -= area * piece->step;
	t->contact_time += piece->step;
}

/* ---- through a step ---- */

static void contact_turn(struct pound_trace *t, int event)
{
	bool was_parted = t->parted;
	t->fresh = false;
	if (event == CLEARS) {
		t->parted = false;
		t->p = 0;
	} else if (event == CONTACT && t->touching) {
		t->impulse_max = fmax(t->impulse_max, t->impulse);
		t->contacts++;
		t->touching = false;
		t->parted = t->fresh = !t->task->tension && t->task->contact_damping > 0 && t->p > 0;
		t->p = t->parted ? t->p : 0;
	} else if (event == CONTACT) {
		t->touching = true;
		t->parted = false;
		t->fresh = was_parted;
		t->p = was_parted ? t->p : 0;
		t->impulse = 0;
	}
}

static void body_turn(struct pound_trace *t, int i, enum pound_edge edge)
{
	const struct pound_piece *piece = &t->at[i].piece;
	if (edge == POUND_EDGE_TURN)
		t->v[i] = 0;
	else
		t->u[i] = edge == POUND_EDGE_HIGH ? piece->high : piece->low;
	pound_pieces_leave(&t->task->bodies[i].skeleton, &t->at[i], edge, t->u[i]);
}

/* Brings to rest what is left of next to nothing where the ground is silent: both bodies, or of bodies apart each by itself. */
static void motion_settle(struct pound_trace *t)
{
	bool over[POUND_OSCILLATORS];
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_piece *piece = &t->at[i].piece;
		over[i] = fabs(t->u[i]) < POUND_AT_REST && fabs(t->v[i]) * t->task->time_step < POUND_AT_REST &&
		          piece->offset == 0 && piece->low <= 0 && piece->high >= 0;
	}
	if (over[0] && over[1] && t->touching)
		contact_turn(t, CONTACT);
	if (over[0] && over[1])
		t->parted = t->fresh = false;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		if (over[i] && !t->touching && !t->parted)
			t->u[i] = t->v[i] = 0;
}

/* Enters the interval that ends at sample `next`. */
static void interval_enter(struct pound_trace *t)
{
	const double *a = &t->task->ground[t->next];
	t->ground = a[-1];
	t->slope = (a[0] - a[-1]) / t->task->time_step;
	t->left = t->task->time_step;
	t->events = 0;
	t->sampled = true;
	if (t->ground == 0 && t->slope == 0)
		motion_settle(t);
	if (!t->touching && !t->parted) {
		t->p = fmin(t->u[0] - t->u[1] - t->task->gap, 0); // rounding must not make it overlap
		t->q = t->v[0] - t->v[1];
	}
}

/* Moves the state to a time of the step. */
static void state_move(struct pound_trace *t, const struct series *s, double time)
{
	double dt = s->step;
	for (int i = 0; i < (t->task->contact ? POUND_OSCILLATORS : 1); i++) {
		t->u[i] = power_at(s->u[i], s->order, time);
		t->v[i] = power_at(s->w[i], s->order, time) / dt;
	}
	if (t->task->contact) {
		t->p = power_at(s->p, s->order, time);
		t->q = power_at(s->q, s->order, time) / dt;
	}
	t->left -= time * dt;
	t->ground += t->slope * (time * dt);
}

/* How far a series reaches; whether that is to the next sample. */
static bool step_length(const struct pound_trace *t, double rate, double *dt)
{
	double reach = rate > 0 ? REACH / rate * t->pace : DBL_MAX, steps = t->left / reach;
	*dt = steps <= 1 ? t->left : steps > 2 ? reach : 0.5 * t->left;
	return steps <= 1;
}

/* The series of the next step; whether it goes to the next sample. */
static bool series_next(struct series *s, const struct pound_trace *t)
{
	double dt, rate = t->touching ? t->rate_touch : t->rate;
	bool whole = step_length(t, t->rate, &dt);
	// where a body stands, its two pieces are to see one motion, to the last bit
	bool stands = stands_at_end(t, 0) || stands_at_end(t, 1);
	if (t->touching && !stands && rate * dt >= SETTLED_LEAST) {
		double pull = pull_of(t);
		if (may_settle(t, pull) && series_settle(s, t, dt, order_of(t->rate * dt), pull))
			return whole;
	}
	whole = step_length(t, rate, &dt);
	bool flight = whole && t->sampled && !t->touching;
	series_fill(s, t, dt, flight ? t->order_sample : order_of(rate * dt));
	return whole;
}

/* One step: to the next event, the next sample, or as far as a series reaches. */
static void step(struct pound_trace *t, struct pound_trace_stretch *stretch)
{
	struct series s;
	bool whole = series_next(&s, t);
	struct search search = {.time = 1, .event = NOTHING};
	if (t->task->contact)
		search_contact(&search, &s, t);
	for (int i = 0; i < (t->task->contact ? POUND_OSCILLATORS : 1); i++)
		search_body(&search, &s, &t->at[i].piece, i);
	t->pace = search.event == CUT ? fmax(t->pace * POUND_STEP_SHORTER, POUND_STEP_SHORTEST)
	                              : fmin(t->pace * POUND_STEP_LONGER, 1);
	if (search.time > 0) { // or nothing is to change, not by a rounding
		piece_add(t, stretch, &s, search.time);
		state_move(t, &s, search.time);
	}
	t->sampled = t->sampled && search.time == 0;
	t->turned = search.event > CUT || (t->turned && search.time == 0);
	contact_turn(t, search.event);
	if (search.event >= BODY)
		body_turn(t, (search.event - BODY) / EDGES, (enum pound_edge)((search.event - BODY) % EDGES));
	bool ends = (whole && search.event == NOTHING) || t->left <= 0;
	if (!ends && ++t->events > EVENTS_LIMIT)
		t->status = POUND_CHATTER;
	if (ends && ++t->next < t->task->n_samples)
		interval_enter(t);
}

/* Puts a trace at the start of its task.
 *
 * Given    task   its bodies, contact and ground motion, which must outlive the trace
 */
void pound_trace_start(struct pound_trace *trace, const struct pound_march_task *task)
{
	*trace = (struct pound_trace){.task = task, .next = 1, .pace = 1};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		trace->u[i] = b->u;
		trace->v[i] = b->v;
		trace->rate = fmax(trace->rate, fmax(sqrt(b->skeleton.stiffness), b->damping));
		pound_pieces_start(&b->skeleton, &trace->at[i]);
	}
	double stiff = task->contact ? (1 + task->mass_ratio) * task->contact_stiffness : 0;
	trace->rate_touch = sqrt(trace->rate * trace->rate + stiff);
	trace->order_sample = order_of(fmin(trace->rate * task->time_step, REACH));
	interval_enter(trace);
}

/* The next pieces of a trace.
 *
 * Returns  stretch   n = 0: the motion is over, or could not be followed further (trace->status)
 *          trace     contact results so far; one still open counts from the end with what it has
 * Source   model.md 1, 2 of the project's design pages
 * Test     unit_trace
 */
void pound_trace_next(struct pound_trace *trace, struct pound_trace_stretch *stretch)
{
	stretch->n = stretch->n_maps = 0;
	bool going = trace->next < trace->task->n_samples;
	while (trace->next < trace->task->n_samples && stretch->n < POUND_TRACE_PIECES && !trace->status)
		step(trace, stretch);
	if (going && trace->next == trace->task->n_samples && trace->touching) {
		trace->contacts++;
		trace->impulse_max = fmax(trace->impulse_max, trace->impulse);
	}
}
