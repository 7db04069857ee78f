/* trace.c - one task followed from event to event, every piece handed out.
 *
 * 1. A whole sample apart goes by an exact map, where a bound proves that nothing lies inside; of the floor's acceleration there
 *    its state is handed out, of which a polynomial is made where one is asked for.
 * 2. Any other step is a power series (trace_series.c), cut at the first root of a guard (root.c): contact opens or closes, an
 *    edge of a law is reached, a velocity turns.
 * 3. The floor's absolute acceleration -(c v + r + F)/m1 and its part -F/m1 come with the same series.
 *
 * The march does the same in lanes and keeps nothing; they share no code but the laws, and what both must agree in is under
 * test. */
#include "engine/floor/trace.h"
#include "engine/exact/counts.h"
#include "engine/exact/tolerances.h"
#include "engine/floor/root.h"
#include "engine/floor/trace_series.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

static_assert((int)POUND_TRACE_ORDER <= (int)POUND_ROOT_ORDER, "guards are as long as series");

enum {
	N = POUND_TRACE_ORDER,
	STEPS_LIMIT = 1 << 19, /* in one sample interval: more is chatter */
	EDGES = 3,
};

enum event { NOTHING, CUT, CONTACT, CLEARS, BODY }; // an edge of body i is BODY + EDGES i + edge

/* First event found so far. */
struct search {
	double time;
	int event;
};

/* ---- events ---- */

/* Notes the first root of a guard as the event where it comes first. */
static void search_guard(struct search *search, const double *g, int order, int event)
{
	double t;
	enum pound_root found = pound_root_first(g, order, search->time, &t);
	if (found == POUND_ROOT_NONE)
		return;
	search->time = t;
	search->event = found == POUND_ROOT_CUT ? CUT : event;
}

/* Looks for where a motion rises above a level (sign +1) or falls below it (-1).
 *
 * Given    y  its derivatives
 */
static void search_level(struct search *search, const double *y, int order, double level, double sign,
                         int event)
{
	double g[N + 1];
	g[0] = sign * (y[0] - level);
	for (int n = 1; n <= order; n++)
		g[n] = sign * y[n] * POUND_FACTOR[n];
	search_guard(search, g, order, event);
}

static void search_body(struct search *search, const struct pound_trace_series *s,
                        const struct pound_piece *piece, int i)
{
	int edge = BODY + EDGES * i;
	if (piece->high < DBL_MAX)
		search_level(search, s->y[i], s->order, piece->high, 1, edge + POUND_EDGE_HIGH);
	if (piece->low > -DBL_MAX)
		search_level(search, s->y[i], s->order, piece->low, -1, edge + POUND_EDGE_LOW);
	if (piece->direction != 0)
		search_level(search, s->y[i] + 1, s->order, 0, -piece->direction, edge + POUND_EDGE_TURN);
}

/* Apart, contact begins when the overlap rises through 0.  Touching, it ends when that falls through 0 or, where the
 * dashpot must not pull, when the force does; parted, when that force rises again or the overlap is gone. */
static void search_contact(struct search *search, const struct pound_trace_series *s,
                           const struct pound_trace *t)
{
	const double release = pound_trace_release(t->task), sign = t->touching ? -1 : 1, *p = s->y[2],
	             *q = p + 1;
	if (release == 0 || !(t->touching || t->parted)) {
		search_level(search, p, s->order, 0, sign, CONTACT);
		return;
	}
	double g[N + 1], lead = release / s->step;
	for (int n = 0; n <= s->order; n++)
		g[n] = sign * (p[n] + lead * q[n]) * POUND_FACTOR[n];
	if (t->fresh) {
		// the force has just passed 0: it is beyond by the rounding of the overlap and of its acceleration
		double pull = fabs(s->y[0][2]) + fabs(s->y[1][2]);
		g[0] = fmin(g[0], -DBL_EPSILON * (p[0] + lead * pull));
	}
	search_guard(search, g, s->order, CONTACT);
	if (t->parted)
		search_level(search, p, s->order, 0, -1, CLEARS);
}

/* ---- pieces ---- */

/* Order of a polynomial without the terms that are rounding beside the others.
 *
 * Given    size  (order + 1) magnitudes of its terms;  sum: of them
 */
static int order_kept(const double *size, int order, double sum)
{
	double rest = 0;
	while (order > 0 && rest + size[order] <= POUND_NOTHING_BESIDE * sum)
		rest += size[order--];
	return order;
}

/* An acceleration over a share of a step: without the terms that are rounding beside the others, bounded with two
 * derivatives.
 *
 * Given    a  derivatives by the share of the step, times the step squared;  offset: besides
 * Returns  value  its order
 */
static int polynomial_fill(struct pound_polynomial *into, const double *a, int order, double offset,
                           double step, double share)
{
	const double per_step = 1 / step;
	double *const c = into->c, power = 1, size[N + 2], bound[3][2] = {{0}};
	c[0] = a[0] * per_step * per_step - offset;
	for (int n = 1; n <= order; n++)
		c[n] = a[n] * POUND_FACTOR[n] * per_step * per_step;
	for (int n = 1; n <= order && share != 1; n++)
		c[n] *= power *= share;
	for (int n = 0; n <= order; n++)
		size[n] = fabs(c[n]);
	size[order + 1] = 0;
	// the even and the odd terms apart: sums need not wait for each other
	for (int n = 0; n <= order; n += 2)
		for (int j = 0; j < 2; j++)
			bound[0][j] += size[n + j];
	into->bound[0] = bound[0][0] + bound[0][1];
	order = order_kept(size, order, into->bound[0]);
	size[order + 1] = 0;
	for (int n = 0; n <= order; n += 2)
		for (int j = 0; j < 2; j++) {
			bound[1][j] += (n + j) * size[n + j];
			bound[2][j] += (double)((n + j) * (n + j - 1)) * size[n + j];
		}
	into->bound[1] = bound[1][0] + bound[1][1];
	into->bound[2] = bound[2][0] + bound[2][1];
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

/* ---- flights ---- */

/* Coefficients of the absolute acceleration -(c v + r) of a body in flight over a sample.
 *
 * Given    state  as struct pound_trace_piece has it
 *          k, c   stiffness [1/s2] and damping [1/s] per mass;  h  the sample step [s]
 * Returns  a      [m/s2]  (order + 1)
 *
 *   r' = h k v     v' = -h (c v + r + forcing)     by the share of the sample that is gone
 * Test     unit_trace: the_acceleration_is_that_of_the_motion
 */
void pound_trace_flight(const double state[4], double k, double c, double h, int order, double *a)
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
 * Returns  c        [m/s2]  (value + 1): the piece's own, or those of a flight's floor, made into `room`
 *          value    their order; -1: the drive is 0
 * Test     unit_trace: the_acceleration_is_that_of_the_motion
 */
int pound_trace_drive(const struct pound_trace_stretch *stretch, const struct pound_trace_piece *piece,
                      enum pound_drive drive, double damping, double room[N + 1], const double **c)
{
	const struct pound_polynomial *own = drive == POUND_DRIVE_PUSH ? &piece->push : &piece->floor;
	*c = own->c;
	if (!(own->bound[0] > 0))
		return -1;
	if (piece->map < 0)
		return piece->order;
	double size[N + 1], sum = 0;
	*c = room;
	pound_trace_flight(piece->state, stretch->stiffness[piece->map], damping, piece->step, stretch->order,
	                   room);
	for (int n = 0; n <= stretch->order; n++)
		sum += size[n] = fabs(room[n]);
	return order_kept(size, stretch->order, sum);
}

/* A body over a sample h, by the power series of its responses to each input.
 *
 * The cubic through both ends misses the motion by POUND_CUBIC_ERROR of its fourth derivative at most, which by linearity is
 * bounded by the sums of the magnitudes of their terms; 16 roundings of what either end is made of are added.
 *
 * Given    k, c   stiffness [1/s2] and damping [1/s] per mass
 *          floor  it is the left body
 */
static void glide_fill(struct pound_trace_glide *g, double k, double c, double h, int order, bool floor)
{
	*g = (struct pound_trace_glide){.stiffness = k};
	for (int j = 0; j < 4; j++) {
		double u = j == 0, w = j == 1 ? h : 0, ends[2] = {0}, bend = 0, size = 0;
		for (int n = 0; n <= order; n++) {
			double force = (j == 2 && n == 0) || (j == 3 && n == 1) ? h * h : 0;
			ends[0] += u;
			ends[1] += w;
			bend += n * (n - 1.0) * (n - 2.0) * (n - 3.0) * fabs(u);
			size += fabs(u);
			double next = -(c * h * w + k * h * h * u + force) * POUND_SHARE[n];
			u = w * POUND_SHARE[n];
			w = next;
		}
		g->move[0][j] = ends[0];
		g->move[1][j] = ends[1] / h;
		g->error[j] = POUND_CUBIC_ERROR * bend + 16 * DBL_EPSILON * (size + (j == 0));
		if (!floor)
			continue;
		double unit[4] = {j == 0, j == 1, j == 2, j == 3}, a[N + 1];
		pound_trace_flight(unit, k, c, h, order, a);
		for (int n = 0; n <= order; n++) {
			g->bound[0][j] += fabs(a[n]);
			g->bound[1][j] += n * fabs(a[n]);
			g->bound[2][j] += n * (n - 1.0) * fabs(a[n]);
		}
	}
}

/* That of a body on the piece it is on. */
static const struct pound_trace_glide *glide_of(struct pound_trace *t, int i)
{
	const double stiffness = t->at[i].piece.stiffness;
	for (int m = 0; m < POUND_TRACE_GLIDES; m++)
		if (t->glide[i][m].stiffness == stiffness)
			return &t->glide[i][m];
	struct pound_trace_glide *g = &t->glide[i][t->glide_next[i]];
	t->glide_next[i] = (t->glide_next[i] + 1) % POUND_TRACE_GLIDES;
	glide_fill(g, stiffness, t->task->bodies[i].damping, t->task->time_step, t->order_sample, i == 0);
	return g;
}

/* The floor over a flight, a whole sample. */
static void flight_add(const struct pound_trace *t, struct pound_trace_stretch *stretch,
                       const struct pound_trace_glide *g, int map)
{
	const struct pound_piece *law = &t->at[0].piece;
	struct pound_trace_piece *piece = &stretch->piece[stretch->n++];
	const double h = t->task->time_step, drive = t->task->bodies[0].drive;
	piece->start = (t->next - 1) * h;
	piece->step = h;
	piece->u = t->u[0];
	piece->v = t->v[0];
	piece->sampled = true;
	piece->turned = t->turned;
	piece->map = map;
	piece->order = -1;
	piece->state[0] = law->stiffness * t->u[0] + law->offset;
	piece->state[1] = t->v[0];
	piece->state[2] = drive * t->ground;
	piece->state[3] = drive * (t->slope * h);
	for (int d = 0; d < 3; d++) {
		piece->floor.bound[d] = piece->push.bound[d] = 0;
		for (int j = 0; j < 4; j++)
			piece->floor.bound[d] += g->bound[d][j] * fabs(piece->state[j]);
	}
}

/* The floor over the first `share` of a step. */
static void piece_add(struct pound_trace *t, struct pound_trace_stretch *stretch,
                      const struct pound_trace_series *s, double share)
{
	const struct pound_march_task *task = t->task;
	const struct pound_piece *law = &t->at[0].piece;
	struct pound_trace_piece *piece = &stretch->piece[stretch->n++];
	piece->start = t->sampled ? (t->next - 1) * task->time_step : t->next * task->time_step - t->left;
	piece->step = share * s->step;
	piece->u = t->u[0];
	piece->v = t->v[0];
	piece->sampled = t->sampled;
	piece->turned = t->turned;
	piece->map = -1;
	piece->order = polynomial_fill(&piece->floor, s->floor, s->order, law->offset, s->step, share);
	if (!t->touching) {
		memset(&piece->push, 0, sizeof piece->push);
		return;
	}
	int order = polynomial_fill(&piece->push, s->push, s->order, 0, s->step, share);
	piece->order = order > piece->order ? order : piece->order;
	double area[2] = {0};
	for (int n = 0; n <= order; n++)
		area[n % 2] += piece->push.c[n] * POUND_SHARE[n];
	t->impulse -= (area[0] + area[1]) * piece->step;
	t->contact_time += piece->step;
	t->touch_steps++;
}

/* ---- through a step ---- */

/* A contact has ended, or the signal has in it. */
static void contact_over(struct pound_trace *t)
{
	const struct pound_march_task *task = t->task;
	struct pound_counts counts = {.time = t->next * task->time_step,
	                              .steps = (double)t->touch_steps,
	                              .changed = (1 + task->mass_ratio) * t->impulse + fabs(t->q)};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		counts.body[i] = (struct pound_counts_body){t->u[i],
		                                            t->v[i],
		                                            t->at[i].piece.stiffness,
		                                            t->at[i].piece.offset,
		                                            task->bodies[i].damping,
		                                            task->bodies[i].drive * t->ground};
	t->impulse_max = fmax(t->impulse_max, t->impulse);
	if (pound_contact_counts(&counts, &t->counts_scale)) {
		t->contacts++;
		t->counted_time = t->contact_time;
	} else
		t->contact_time = t->counted_time;
}

static void contact_turn(struct pound_trace *t, int event)
{
	bool was_parted = t->parted;
	t->fresh = false;
	if (event == CLEARS) {
		t->parted = false;
		t->p = 0;
	} else if (event == CONTACT && t->touching) {
		contact_over(t);
		t->touching = false;
		t->parted = t->fresh = !t->task->tension && t->task->contact_damping > 0 && t->p > 0;
		t->p = t->parted ? t->p : 0;
	} else if (event == CONTACT) {
		t->touching = true;
		t->parted = false;
		t->fresh = was_parted;
		t->p = was_parted ? t->p : 0;
		t->impulse = 0;
		t->touch_steps = 0;
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
	t->steps = 0;
	t->sampled = true;
	if (t->ground == 0 && t->slope == 0)
		motion_settle(t);
	if (!t->touching && !t->parted) {
		t->p = fmin(t->u[0] - t->u[1] - t->task->gap, 0); // rounding must not make it overlap
		t->q = t->v[0] - t->v[1];
	}
}

/* A motion at a time of its step: at the end the terms are added up, the smallest first. */
static void motion_at(const double *y, int order, double time, double *u, double *w)
{
	if (time == 1) {
		double even[2] = {0}, odd[2] = {0}; // two sums need not wait for each other
		for (int n = order / 2 * 2; n >= 0; n -= 2)
			for (int j = 0; j < 2; j++) {
				even[j] += y[n + j] * POUND_FACTOR[n];
				odd[j] += n < order ? y[n + 1 + j] * POUND_FACTOR[n + 1] : 0;
			}
		*u = even[0] + odd[0];
		*w = even[1] + odd[1];
		return;
	}
	double c[2][N + 1] = {{0}};
	for (int n = 0; n <= order; n++)
		for (int j = 0; j < 2; j++)
			c[j][n] = y[n + j] * POUND_FACTOR[n];
	*u = pound_root_value(c[0], order, time);
	*w = pound_root_value(c[1], order, time);
}

/* Moves the state to a time of the step. */
static void state_move(struct pound_trace *t, const struct pound_trace_series *s, double time)
{
	double dt = s->step;
	for (int i = 0; i < (t->task->contact ? POUND_OSCILLATORS : 1); i++) {
		motion_at(s->y[i], s->order, time, &t->u[i], &t->v[i]);
		t->v[i] /= dt;
	}
	if (t->task->contact) {
		motion_at(s->y[2], s->order, time, &t->p, &t->q);
		t->q /= dt;
	}
	t->left -= time * dt;
	t->ground += t->slope * (time * dt);
}

/* a body over a sample: its end, the inner control points of the cubic through both ends, and the bound of its error */
struct way {
	double u, v, b1, b2, error;
};

static struct way way_of(const struct pound_trace *t, int i, const struct pound_trace_glide *g)
{
	const struct pound_march_body *body = &t->task->bodies[i];
	const double h = t->task->time_step, third = h / 3;
	const double in[4] = {t->u[i], t->v[i], body->drive * t->ground + t->at[i].piece.offset,
	                      body->drive * (t->slope * h)};
	const double *u = g->move[0], *v = g->move[1], *e = g->error;
	struct way w = {.u = (u[0] * in[0] + u[1] * in[1]) + (u[2] * in[2] + u[3] * in[3]),
	                .v = (v[0] * in[0] + v[1] * in[1]) + (v[2] * in[2] + v[3] * in[3])};
	w.error = (e[0] * fabs(in[0]) + e[1] * fabs(in[1])) + (e[2] * fabs(in[2]) + e[3] * fabs(in[3]));
	w.b1 = t->u[i] + third * t->v[i];
	w.b2 = w.u - third * w.v;
	return w;
}

/* Whether a motion stays below a limit, by its control points. */
static bool way_below(const double point[3], double limit)
{
	return point[0] <= limit && point[1] <= limit && point[2] <= limit;
}

/* Whether no edge of a body's piece is reached on the way: the velocity's control points times h/3 are its own at the ends
 * and b2 - b1 between; they miss it by 288 sqrt(3)/648 of the error at most. */
static bool way_inside(const struct pound_trace *t, int i, const struct way *w)
{
	const struct pound_piece *piece = &t->at[i].piece;
	const double third = t->task->time_step / 3, back = -piece->direction;
	const double point[3] = {w->b1, w->b2, w->u}, mirrored[3] = {-w->b1, -w->b2, -w->u};
	const double backward[3] = {back * third * t->v[i], back * third * w->v, back * (w->b2 - w->b1)};
	return way_below(point, piece->high - w->error) && way_below(mirrored, -piece->low - w->error) &&
	       (back == 0 || way_below(backward, -0.77 * w->error));
}

/* Flies over a whole sample; false: something may happen in it, which series are to find out. */
static bool flight(struct pound_trace *t, struct pound_trace_stretch *stretch)
{
	const struct pound_march_task *task = t->task;
	const int bodies = task->contact ? POUND_OSCILLATORS : 1;
	if (!t->sampled || t->touching || t->parted || t->pace != 1 ||
	    t->rate * task->time_step > POUND_TRACE_REACH)
		return false;
	struct way w[POUND_OSCILLATORS];
	const struct pound_trace_glide *glide[POUND_OSCILLATORS];
	for (int i = 0; i < bodies; i++) {
		glide[i] = glide_of(t, i);
		w[i] = way_of(t, i, glide[i]);
	}
	for (int i = 0; i < bodies; i++)
		if (!way_inside(t, i, &w[i]))
			return false;
	if (bodies > 1) {
		const double apart[3] = {w[0].b1 - w[1].b1, w[0].b2 - w[1].b2, w[0].u - w[1].u};
		if (!way_below(apart, (1 - 4 * DBL_EPSILON) * task->gap - (w[0].error + w[1].error)))
			return false;
	}
	int map = map_of(stretch, t->at[0].piece.stiffness);
	if (map < 0)
		return false;
	flight_add(t, stretch, glide[0], map);
	for (int i = 0; i < bodies; i++) {
		t->u[i] = w[i].u;
		t->v[i] = w[i].v;
	}
	t->left = 0;
	t->turned = false;
	return true;
}

static void sample_next(struct pound_trace *t)
{
	if (++t->next < t->task->n_samples)
		interval_enter(t);
}

/* One step: to the next event, the next sample, or as far as a series reaches. */
static void step(struct pound_trace *t, struct pound_trace_stretch *stretch)
{
	if (flight(t, stretch)) {
		sample_next(t);
		return;
	}
	struct pound_trace_series s;
	pound_trace_series(&s, t);
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
	bool ends = (s.whole && search.event == NOTHING) || t->left <= 0;
	if (!ends && ++t->steps > STEPS_LIMIT)
		t->status = POUND_CHATTER;
	if (ends)
		sample_next(t);
}

/* Fastest of the motion in contact [rad/s]; past critical damping it is the faster of two roots.
 *
 * Given    rate  of the bodies
 */
static double rate_touch(const struct pound_march_task *task, double rate)
{
	const double both = 1 + task->mass_ratio, stiff = both * task->contact_stiffness;
	double frequency = 0, damping = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		frequency = fmax(frequency, sqrt(task->bodies[i].skeleton.stiffness));
		damping = fmax(damping, task->bodies[i].damping);
	}
	const double own = sqrt(frequency * frequency + stiff);
	const double zeta = 0.5 * (damping + both * task->contact_damping) / own;
	return fmax(sqrt(rate * rate + stiff), zeta > 1 ? own * (zeta + sqrt(zeta * zeta - 1)) : 0);
}

/* Puts a trace at the start of its task.
 *
 * Given    task   its bodies, contact and ground motion, which must outlive the trace
 */
void pound_trace_start(struct pound_trace *trace, const struct pound_march_task *task)
{
	assert(!task->contact ||
	       task->force == POUND_FORCE_LINEAR); // its forms of force: pound_floor_takes_force
	*trace = (struct pound_trace){.task = task, .next = 1, .pace = 1};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		trace->u[i] = b->u;
		trace->v[i] = b->v;
		trace->rate = fmax(trace->rate, fmax(sqrt(b->skeleton.stiffness), b->damping));
		pound_pieces_start(&b->skeleton, &trace->at[i]);
		for (int m = 0; m < POUND_TRACE_GLIDES; m++)
			trace->glide[i][m].stiffness = -1;
	}
	trace->rate_touch = task->contact ? rate_touch(task, trace->rate) : trace->rate;
	trace->order_sample = pound_trace_order(fmin(trace->rate * task->time_step, POUND_TRACE_REACH));
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
	stretch->order = trace->order_sample;
	bool going = trace->next < trace->task->n_samples;
	while (trace->next < trace->task->n_samples && stretch->n < POUND_TRACE_PIECES && !trace->status)
		step(trace, stretch);
	if (going && trace->next == trace->task->n_samples && trace->touching)
		contact_over(trace);
}
