/* march.c - the exact event-driven march, many simulations side by side in lanes.
 *
 * Between events a pair of oscillators is linear and the ground motion a straight line, so:
 * 1. free flight takes whole samples by a precomputed exact map; Bernstein bounds of the cubic through the ends,
 *    widened by the bound of its error, prove that no contact, no edge of a law and no new maximum lies inside;
 * 2. what they cannot prove, and every contact, is done by power series in time, cut at the first root of a guard
 *    (contact opens or closes, an edge of a piece is reached, the velocity turns), found to rounding;
 * 3. simulations change between the two groups of lanes as they fly and touch; lanes are refilled from a pool.
 * A simulation's bits depend on itself alone: not on its lane, its neighbours or the lane count. */
#include "engine/march.h"

#include <assert.h>
#include <float.h>
#include <stdalign.h>
#include <string.h>

#include "engine/lanes.h"

enum {
	POOL = 4 * W,           /* simulations in flight */
	ORDER_FREE = 14,        /* of the series while apart */
	ORDER_TOUCH = 22,       /* while touching */
	MAPS = 4,               /* free-flight maps a body keeps */
	ROOT_ROUNDS = 64,       /* of a root search; quadratic, so 4 to 6 are usual */
	DEFLATE_MAX = 5,        /* leading zeros of a guard: at rest, touching, equal ground */
	EVENTS_LIMIT = 1 << 17, /* in one sample interval: more is chatter */
};

/* Largest rate * time of a series step: the last term kept is below 2^-54 of the first.
 * 0.4^14/14! = 3e-17, 1.4^22/22! = 1.5e-18 (touching has the larger factor before the power). */
static const double REACH_FREE = 0.4, REACH_TOUCH = 1.4;

/* The cubic through both ends of an interval misses the function by at most h^4/384 max |u''''| (Hermite). */
static const double CUBIC_ERROR = 1.0 / 384;

static const double NEVER = -1e300; /* overlap of bodies that cannot meet */

/* Columns of a simulation: `double` in a simulation at rest in the pool, `vd` in a group of lanes.  A group is loaded
 * and saved by ranges of columns: event steps read from the first to map, flight from state to the end. */
#define COLUMNS(T)                                                                                 \
	/* constants of event steps */                                                                 \
	T step, damping[2], contact_stiffness, contact_damping, mass_ratio, release, reach[2];         \
	/* changed by event steps; touching, parted, fresh (contact force exactly 0 now) are 0 or 1 */ \
	T p, q, left, slope, touching, parted, fresh, impulse, contact_time;                           \
	/* changed by both */                                                                          \
	T u[2], v[2], top[2], ground;                                                                  \
	/* read by both: the piece of each body's law */                                               \
	T gap, drive[2], stiffness[2], offset[2], low[2], high[2], direction[2];                       \
	/* map of each body over one sample, and what bounds its error */                              \
	T uu[2], uv[2], ua[2], ud[2], vu[2], vv[2], va[2], vd[2], eu[2], ev[2], ea[2], ed[2], third, error_turn;

struct column {
	COLUMNS(double)
};

struct lanes {
	COLUMNS(vd)
};

enum {
	COLUMN_FIRST = 0,
	COLUMN_MOVED = offsetof(struct column, p) / sizeof(double),
	COLUMN_STATE = offsetof(struct column, u) / sizeof(double),
	COLUMN_READ = offsetof(struct column, gap) / sizeof(double),
	COLUMN_MAP = offsetof(struct column, uu) / sizeof(double),
	COLUMN_END = sizeof(struct column) / sizeof(double),
};

/* exact map of one body over one sample: (u, v) -> (u, v), with forcing a at the start growing by d */
struct map {
	double stiffness; /* of the piece it belongs to; < 0: none */
	double uu, uv, ua, ud, vu, vv, va, vd;
	double eu, ev, ea, ed; /* bound of the cubic's error: eu |u| + ev |v| + ea |a| + ed |d| */
};

struct simulation {
	struct column x;
	const struct pound_march_task *task;
	struct pound_march_result *result;
	struct pound_branch at[2];
	struct map maps[2][MAPS];
	int map_next[2];
	int sample; /* index of the sample at or before now */
	int events; /* in this sample interval */
	int64_t contacts_begun;
	bool can_fly; /* samples are short enough for free flight in one map */
};

struct queue {
	int n;
	int member[POOL];
};

struct work {
	alignas(64) struct lanes fly;
	alignas(64) struct lanes meet;
	struct simulation pool[POOL];
	int fly_lane[W], meet_lane[W]; /* which simulation, -1: none */
	struct queue idle, flyers, meeters;
	const struct pound_march_task *tasks;
	struct pound_march_result *results;
	int n, started;
};

static_assert(sizeof(struct column) % sizeof(double) == 0, "columns are doubles and nothing else");

/* ---- a simulation at rest in the pool: scalar work, done when it changes groups or reaches an edge ---- */

/* Exact map of u'' + c u' + k u = -(a + d t/h) over one sample h, by its power series, and its error coefficients.
 *
 * Given    k, c, h   [1/s2], [1/s], [s]   h (c + k h) <= 1/2
 * Returns  map       columns for u, v, a, d
 *
 * With A2, A3, A4 the largest |u''|, |u'''|, |u''''| inside and h (c + k h) <= 1/2:
 *   A3 <= 2 (|u0'''| + h k |u0''|),  A2 <= |u0''| + h A3,  A4 <= c A3 + k A2,  error <= A4 h^4/384
 *   |u0''| <= c |v| + k |u| + |a|,  |u0'''| <= c |u0''| + k |v| + |d|/h
 */
static void map_fill(struct map *map, double k, double c, double h)
{
	double *column[4][2] = {
	    {&map->uu, &map->vu}, {&map->uv, &map->vv}, {&map->ua, &map->va}, {&map->ud, &map->vd}};
	double ch = c * h, kh = k * h * h;
	for (int j = 0; j < 4; j++) {
		double u = j == 0, w = j == 1 ? h : 0; // w: u' h
		double u_sum = 0, w_sum = 0;
		for (int n = 0; n < 20; n++) {
			double force = j == 2 && n == 0 ? h * h : j == 3 && n == 1 ? h * h : 0;
			double w_next = -(ch * w + kh * u + force) / (n + 1);
			u_sum += u;
			w_sum += w;
			u = w / (n + 1);
			w = w_next;
		}
		*column[j][0] = u_sum;
		*column[j][1] = w_sum / h;
	}
	map->stiffness = k;
	double a3_acc = 2 * (c + h * k), a4_acc = c * a3_acc + k * (1 + h * a3_acc); // per |u0''|
	double a4_jerk = (c + k * h) * 2; // per |u0'''| apart from c |u0''|
	double quartic = h * h * h * h * CUBIC_ERROR;
	map->eu = quartic * a4_acc * k;
	map->ev = quartic * (a4_acc * c + a4_jerk * k);
	map->ea = quartic * a4_acc;
	map->ed = quartic * a4_jerk / h;
}

/* Puts a body's current piece, and the map that belongs to it, into the columns. */
static void piece_load(struct simulation *sim, int i)
{
	const struct pound_piece *piece = &sim->at[i].piece;
	sim->x.stiffness[i] = piece->stiffness;
	sim->x.offset[i] = piece->offset;
	sim->x.low[i] = piece->low;
	sim->x.high[i] = piece->high;
	sim->x.direction[i] = piece->direction;
	if (!sim->can_fly)
		return;
	struct map *map = NULL;
	for (int m = 0; m < MAPS && !map; m++)
		if (sim->maps[i][m].stiffness == piece->stiffness)
			map = &sim->maps[i][m];
	if (!map) {
		map = &sim->maps[i][sim->map_next[i]];
		sim->map_next[i] = (sim->map_next[i] + 1) % MAPS;
		map_fill(map, piece->stiffness, sim->x.damping[i], sim->x.step);
	}
	struct column *x = &sim->x;
	x->uu[i] = map->uu, x->uv[i] = map->uv, x->ua[i] = map->ua, x->ud[i] = map->ud;
	x->vu[i] = map->vu, x->vv[i] = map->vv, x->va[i] = map->va, x->vd[i] = map->vd;
	x->eu[i] = map->eu, x->ev[i] = map->ev, x->ea[i] = map->ea, x->ed[i] = map->ed;
}

/* Enters the interval behind sample `sim->sample`. */
static void interval_enter(struct simulation *sim)
{
	const double *a = &sim->task->ground[sim->sample];
	sim->x.ground = a[0];
	sim->x.slope = (a[1] - a[0]) / sim->x.step;
	sim->x.left = sim->x.step;
	sim->events = 0;
}

/* A simulation at the start of its task. */
static void simulation_start(struct simulation *sim, const struct pound_march_task *task,
                             struct pound_march_result *result)
{
	memset(sim, 0, sizeof *sim);
	memset(result, 0, sizeof *result);
	sim->task = task;
	sim->result = result;
	sim->can_fly = true;
	struct column *x = &sim->x;
	double h = task->time_step;
	double rate = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *body = &task->bodies[i];
		double k = body->skeleton.stiffness;
		double omega = sqrt(k);
		rate = fmax(rate, fmax(omega, body->damping));
		sim->can_fly &= h * (body->damping + k * h) <= 0.5 && omega * h <= 1;
		x->u[i] = body->u, x->v[i] = body->v, x->top[i] = fabs(body->u);
		x->damping[i] = body->damping;
		x->drive[i] = body->drive;
		for (int m = 0; m < MAPS; m++)
			sim->maps[i][m].stiffness = -1;
	}
	x->step = h;
	x->gap = task->contact ? task->gap : -NEVER;
	x->contact_stiffness = task->contact ? task->contact_stiffness : 0;
	x->contact_damping = task->contact ? task->contact_damping : 0;
	x->mass_ratio = task->mass_ratio;
	x->release = task->contact && !task->tension ? task->contact_damping / task->contact_stiffness : 0;
	double stiff = (1 + task->mass_ratio) * x->contact_stiffness;
	x->reach[0] = rate > 0 ? REACH_FREE / rate : DBL_MAX;
	x->reach[1] = REACH_TOUCH / sqrt(rate * rate + stiff);
	x->third = h / 3;
	x->error_turn = 384 * sqrt(3) / (216 * h);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		pound_pieces_start(&task->bodies[i].skeleton, &sim->at[i]);
		piece_load(sim, i);
	}
	interval_enter(sim);
}

/* ---- groups of lanes ---- */

LANE_INLINE void lanes_load(struct lanes *group, int l, const struct simulation *sim, int from, int to)
{
	const double *x = (const double *)&sim->x;
	vd *g = (vd *)group;
	for (int j = from; j < to; j++)
		LANE(g[j], l) = x[j];
}

LANE_INLINE void lanes_save(const struct lanes *group, int l, struct simulation *sim, int from, int to)
{
	double *x = (double *)&sim->x;
	const vd *g = (const vd *)group;
	for (int j = from; j < to; j++)
		x[j] = LANE(g[j], l);
}

static void push(struct queue *queue, int member)
{
	queue->member[queue->n++] = member;
}
static int pop(struct queue *queue)
{
	return queue->member[--queue->n];
}

/* Writes a simulation's result and frees its place in the pool. */
static void simulation_end(struct work *work, int member, enum pound_status status)
{
	const struct simulation *sim = &work->pool[member];
	struct pound_march_result *r = sim->result;
	r->status = status;
	r->contact_time = sim->x.contact_time;
	if (sim->x.touching != 0) { // a contact still open at the end counts with what it has
		r->impulse_max = fmax(r->impulse_max, sim->x.impulse);
		r->contacts++;
	}
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		r->displacement_max[i] = sim->x.top[i];
		r->u[i] = sim->x.u[i];
		r->v[i] = sim->x.v[i];
	}
	push(&work->idle, member);
}

/* Sends a simulation that is apart to the group of event steps. */
static void meet_await(struct work *work, int member)
{
	struct column *x = &work->pool[member].x;
	x->p = fmin(x->u[0] - x->u[1] - x->gap, 0); // rounding must not make it overlap
	x->q = x->v[0] - x->v[1];
	push(&work->meeters, member);
}

/* Simulations in the group of event steps and on their way there. */
static int meeting(const struct work *work)
{
	int n = work->meeters.n;
	for (int l = 0; l < W; l++)
		n += work->meet_lane[l] >= 0;
	return n;
}

/* Takes the next task into an idle place of the pool; false: none left. */
static bool task_start(struct work *work)
{
	if (work->started == work->n || work->idle.n == 0)
		return false;
	int member = pop(&work->idle);
	simulation_start(&work->pool[member], &work->tasks[work->started], &work->results[work->started]);
	work->started++;
	if (work->pool[member].can_fly)
		push(&work->flyers, member);
	else
		meet_await(work, member);
	return true;
}

/* ---- free flight ---- */

/* Fills the empty lanes of free flight; false: all stay empty. */
static bool fly_fill(struct work *work)
{
	bool any = false;
	for (int l = 0; l < W; l++) {
		while (work->fly_lane[l] < 0 && work->flyers.n == 0 && task_start(work))
			;
		if (work->fly_lane[l] < 0 && work->flyers.n > 0) {
			work->fly_lane[l] = pop(&work->flyers);
			lanes_load(&work->fly, l, &work->pool[work->fly_lane[l]], COLUMN_STATE, COLUMN_END);
		}
		any |= work->fly_lane[l] >= 0;
	}
	return any;
}

/* Takes a simulation out of free flight: at the end of its signal, or to have its next interval done by series. */
static void fly_leave(struct work *work, int l)
{
	int member = work->fly_lane[l];
	struct simulation *sim = &work->pool[member];
	lanes_save(&work->fly, l, sim, COLUMN_STATE, COLUMN_READ);
	work->fly_lane[l] = -1;
	if (sim->sample == sim->task->n_samples - 1) {
		simulation_end(work, member, POUND_OK);
		return;
	}
	interval_enter(sim);
	meet_await(work, member);
}

struct flight {
	vd u, v, b1, b2, error, error_turn;
};

/* One body over one whole sample, and the inner control points of the cubic through its ends. */
LANE_INLINE struct flight flight_step(const struct lanes *g, int i, vd rise)
{
	struct flight f;
	vd u = g->u[i], v = g->v[i];
	vd a = vfma(g->drive[i], g->ground, g->offset[i]);
	vd d = g->drive[i] * rise;
	f.u = vfma(g->uu[i], u, vfma(g->uv[i], v, vfma(g->ua[i], a, g->ud[i] * d)));
	f.v = vfma(g->vu[i], u, vfma(g->vv[i], v, vfma(g->va[i], a, g->vd[i] * d)));
	f.b1 = vfma(g->third, v, u);
	f.b2 = vfma(-g->third, f.v, f.u);
	vd e = vfma(g->eu[i], vabs(u), vfma(g->ev[i], vabs(v), vfma(g->ea[i], vabs(a), g->ed[i] * vabs(d))));
	f.error = vfma(vsplat(16 * DBL_EPSILON), vabs(u) + vabs(f.u), e);
	f.error_turn = f.error * g->error_turn;
	return f;
}

/* Lanes in which something may happen to a body inside the sample: an edge of its piece, a new largest displacement. */
LANE_INLINE vi flight_risk(const struct lanes *g, int i, const struct flight *f)
{
	vd high = vmax(f->b1, f->b2), low = vmin(f->b1, f->b2);
	vd ends = vmax(vmax(vabs(g->u[i]), vabs(f->u)), g->top[i]);
	vi risk = vless(ends, vmax(high, -low) + f->error);
	risk |= vless(g->high[i], vmax(high, f->u) + f->error);
	risk |= vless(vmin(low, f->u) - f->error, g->low[i]);
	// the velocity's control points: its own at the ends, 3 (b2 - b1)/h between
	vd along = vmin(vmin(g->direction[i] * g->v[i], g->direction[i] * f->v),
	                g->direction[i] * (f->b2 - f->b1) / g->third);
	risk |= vless(along - f->error_turn, vsplat(0)) & ~vequal(g->direction[i], vsplat(0));
	return risk;
}

/* One sample for every lane of free flight.
 *
 * Given    ground  acceleration at the next sample [m/s2]
 * Returns  value   lanes in which something may happen inside the sample; these stay where they were
 */
LANE_INLINE vi flight(struct lanes *g, vd ground)
{
	vd rise = ground - g->ground;
	struct flight f = flight_step(g, 0, rise), s = flight_step(g, 1, rise);
	vi risk = flight_risk(g, 0, &f) | flight_risk(g, 1, &s);
	vd p = vmax(vmax(f.b1 - s.b1, f.b2 - s.b2), f.u - s.u) - g->gap;
	risk |= vless(vsplat(0), p + (f.error + s.error) + vsplat(4 * DBL_EPSILON) * g->gap);
	g->u[0] = vselect(risk, g->u[0], f.u);
	g->v[0] = vselect(risk, g->v[0], f.v);
	g->u[1] = vselect(risk, g->u[1], s.u);
	g->v[1] = vselect(risk, g->v[1], s.v);
	g->top[0] = vmax(g->top[0], vabs(g->u[0]));
	g->top[1] = vmax(g->top[1], vabs(g->u[1]));
	g->ground = vselect(risk, g->ground, ground);
	return risk;
}

/* Flies until the group of the others is worth a step, or nobody flies. */
static void fly(struct work *work)
{
	static const double still[1];
	while (meeting(work) < W && fly_fill(work)) {
		const double *next[W], *end[W];
		int64_t moves[W];
		for (int l = 0; l < W; l++) {
			const struct simulation *sim = work->fly_lane[l] < 0 ? NULL : &work->pool[work->fly_lane[l]];
			next[l] = sim ? &sim->task->ground[sim->sample + 1] : still;
			end[l] = sim ? &sim->task->ground[sim->task->n_samples] : NULL;
			moves[l] = sim ? -1 : 0;
		}
		int64_t leaves;
		vi risk;
		do {
			vd ground;
			for (int l = 0; l < W; l++)
				LANE(ground, l) = *next[l];
			risk = flight(&work->fly, ground);
			leaves = 0;
			for (int l = 0; l < W; l++) {
				next[l] -= moves[l] & ~LANE(risk, l);
				leaves |= (LANE(risk, l) & moves[l]) | -(int64_t)(next[l] == end[l]);
			}
		} while (!leaves);
		for (int l = 0; l < W; l++) {
			if (!moves[l])
				continue;
			struct simulation *sim = &work->pool[work->fly_lane[l]];
			sim->sample = (int)(next[l] - sim->task->ground) - 1;
			if (LANE(risk, l) || next[l] == end[l])
				fly_leave(work, l);
		}
	}
}

/* ---- events, by power series ---- */

enum event { NOTHING, CUT, CLOSES, PARTS, CLEARS, BODY };

// the event of an edge of body i is BODY + EDGES i + edge
enum { EDGES = 3 };

struct series {
	int order;
	vd u[2][ORDER_TOUCH + 2],
	    v[2][ORDER_TOUCH + 2];                 /* powers of time over the step; v is u' times the step */
	vd p[ORDER_TOUCH + 2], q[ORDER_TOUCH + 2]; /* overlap and its rate, integrated in their own right: the */
	/* difference u1 - u2 - gap would lose a stiff contact's digits */
	vd u_bend[2], p_bend; /* bounds of the fourth derivatives */
};

struct ends {
	vd u[2], v[2], p, q;
};

/* Series of both bodies and of the overlap over a step. */
static void series_fill(struct series *s, const struct lanes *g, vd dt, vi touching)
{
	vd dt2 = dt * dt, zero = vsplat(0);
	vd c[2], k[2], f0[2], f1[2];
	for (int i = 0; i < 2; i++) {
		c[i] = -g->damping[i] * dt;
		k[i] = -g->stiffness[i] * dt2;
		f0[i] = -vfma(g->drive[i], g->ground, g->offset[i]) * dt2;
		f1[i] = -(g->drive[i] * g->slope) * dt2 * dt;
		s->u[i][0] = g->u[i];
		s->v[i][0] = g->v[i] * dt;
		s->u_bend[i] = zero;
	}
	vd spring = vselect(touching, g->contact_stiffness * dt2, zero);
	vd dash = vselect(touching, g->contact_damping * dt, zero);
	vd both = vsplat(1) + g->mass_ratio;
	s->p[0] = g->p;
	s->q[0] = g->q * dt;
	s->p_bend = zero;
	s->order = vany(touching) ? ORDER_TOUCH : ORDER_FREE;
	for (int n = 0; n <= s->order; n++) {
		vd share = vsplat(1.0 / (n + 1));
		vd a0 = vfma(c[0], s->v[0][n], k[0] * s->u[0][n]);
		vd a1 = vfma(c[1], s->v[1][n], k[1] * s->u[1][n]);
		if (n < 2) {
			a0 += n ? f1[0] : f0[0];
			a1 += n ? f1[1] : f0[1];
		}
		vd force = vfma(spring, s->p[n], dash * s->q[n]);
		s->u[0][n + 1] = s->v[0][n] * share;
		s->u[1][n + 1] = s->v[1][n] * share;
		s->p[n + 1] = s->q[n] * share;
		s->v[0][n + 1] = (a0 - force) * share;
		s->v[1][n + 1] = vfma(g->mass_ratio, force, a1) * share;
		s->q[n + 1] = vfma(-both, force, a0 - a1) * share;
		if (n == ORDER_FREE && s->order > ORDER_FREE) {
			// lanes apart end here, so that a lane's bits do not depend on its neighbours
			for (int i = 0; i < 2; i++) {
				s->v[i][n + 1] = vselect(touching, s->v[i][n + 1], zero);
				s->u[i][n + 1] = vselect(touching, s->u[i][n + 1], zero);
			}
			s->p[n + 1] = vselect(touching, s->p[n + 1], zero);
			s->q[n + 1] = vselect(touching, s->q[n + 1], zero);
		}
	}
	for (int n = 4; n <= s->order; n++) {
		vd weight = vsplat((double)n * (n - 1) * (n - 2) * (n - 3));
		s->u_bend[0] = vfma(weight, vabs(s->u[0][n]), s->u_bend[0]);
		s->u_bend[1] = vfma(weight, vabs(s->u[1][n]), s->u_bend[1]);
		s->p_bend = vfma(weight, vabs(s->p[n]), s->p_bend);
	}
}

static vd horner(const vd *c, int order, vd t)
{
	vd r = vsplat(0);
	for (int n = order; n >= 0; n--)
		r = vfma(r, t, c[n]);
	return r;
}

static struct ends series_ends(const struct series *s, vd t)
{
	struct ends e;
	for (int i = 0; i < 2; i++) {
		e.u[i] = horner(s->u[i], s->order, t);
		e.v[i] = horner(s->v[i], s->order, t);
	}
	e.p = horner(s->p, s->order, t);
	e.q = horner(s->q, s->order, t);
	return e;
}

/* First event found so far in each lane. */
struct search {
	vd time;  /* as a share of the step, 1: none yet */
	vi event; /* enum event */
};

/* Looks for the first time at which a guard becomes positive, and notes it as the event where it comes first.
 *
 * Given    guard   power series over the step, not positive at 0 but for rounding  (order + 1), destroyed
 *          active  lanes to search
 * Returns  search  time and event of the lanes that have one, up to the time already there
 *
 * A parabola with the guard's value and slope at t and with a bound of its curvature lies above the guard, so no
 * root lies before the parabola's; stepping from root to root converges quadratically to the guard's first root and
 * passes none.  A guard that starts at exactly 0 is divided by the powers of time it starts with: the sign of its
 * first term decides.  Where the search has not converged (a double root) the step is cut at the safe time reached.
 */
static void guard_search(vd *guard, int order, vi active, int64_t event, struct search *search)
{
	vd zero = vsplat(0);
	for (int m = 0; m < DEFLATE_MAX; m++) {
		vi leading = vequal(guard[0], zero) & active;
		if (!vany(leading))
			break;
		for (int n = 0; n < order; n++)
			guard[n] = vselect(leading, guard[n + 1], guard[n]);
		guard[order] = vselect(leading, zero, guard[order]);
	}
	active &= ~vequal(guard[0], zero);
	vd bend = zero;
	for (int n = order; n > 2; n--)
		bend = vfma(vsplat((double)n * (n - 1)), vabs(guard[n]), bend);
	vd curved = vfma(vsplat(2), vabs(guard[2]), bend); // either way, for the error left by a step
	bend = vmax(zero, vfma(vsplat(2), guard[2], bend));
	vd t = zero;
	vi found = active & vless(zero, guard[0]);
	vi going = active & ~found;
	vd g = guard[0], slope = guard[1];
	for (int round = 0; round < ROOT_ROUNDS && vany(going); round++) {
		if (round > 0) {
			g = zero;
			slope = zero;
			for (int n = order; n > 0; n--) {
				g = vfma(g, t, guard[n]);
				slope = vfma(slope, t, guard[n] * vsplat(n));
			}
			g = vfma(g, t, guard[0]);
		}
		vd below = vmin(g, zero);
		vd root = vsqrt(vfma(slope, slope, -2.0 * bend * below));
		vd step = vselect(vless(zero, slope), -2.0 * below / (slope + root), (root - slope) / bend);
		step = vselect(vless(zero, slope) | vless(zero, bend), step, vsplat(2));
		vi near = vless(step * step * curved, vsplat(0.5 * DBL_EPSILON) * slope) |
		          vless(step, vsplat(0.5 * DBL_EPSILON));
		t = vselect(going, t + step, t);
		going &= ~vless(search->time, t);
		found |= going & near;
		going &= ~near;
	}
	search->time = vselect(found | going, t, search->time);
	search->event = (search->event & ~(found | going)) | (found & event) | (going & CUT);
}

/* What bounds say of one body over a step: the cubic through its ends, and its error. */
struct hull {
	vd high, low, top;
};

LANE_INLINE struct hull hull_of(vd u0, vd v0, vd u1, vd v1, vd bend)
{
	vd third = vsplat(1.0 / 3), error = vsplat(CUBIC_ERROR) * bend;
	vd b1 = vfma(third, v0, u0), b2 = vfma(-third, v1, u1);
	struct hull h;
	h.high = vmax(vmax(b1, b2), u1) + error;
	h.low = vmin(vmin(b1, b2), u1) - error;
	h.top = vmax(vmax(b1, b2), -vmin(b1, b2)) + error;
	return h;
}

/* Looks for the edges of a body's piece, and for the turn of its velocity where that matters. */
static void body_search(const struct series *s, const struct lanes *g, int i, const struct ends *e, vi active,
                        struct search *search)
{
	vd guard[ORDER_TOUCH + 2];
	vd zero = vsplat(0);
	struct hull hull = hull_of(s->u[i][0], s->v[i][0], e->u[i], e->v[i], s->u_bend[i]);
	int64_t body = BODY + EDGES * i;
	vi past_high = vless(g->high[i], hull.high) & active;
	vi past_low = vless(hull.low, g->low[i]) & active;
	vi bound_to_turn = ~vequal(g->direction[i], zero) & active;
	vi new_top = vless(vmax(g->top[i], vabs(e->u[i])), hull.top) & active;
	if (vany(past_high)) {
		memcpy(guard, s->u[i], sizeof guard);
		guard[0] -= g->high[i];
		guard_search(guard, s->order, past_high, body + POUND_EDGE_HIGH, search);
	}
	if (vany(past_low)) {
		for (int n = 0; n <= s->order; n++)
			guard[n] = -s->u[i][n];
		guard[0] += g->low[i];
		guard_search(guard, s->order, past_low, body + POUND_EDGE_LOW, search);
	}
	if (vany(bound_to_turn | new_top)) {
		// which way it goes now: by its velocity, or from rest by its acceleration, or by the rate of that
		vd way = vselect(vequal(s->v[i][0], zero), vselect(vequal(s->v[i][1], zero), s->v[i][2], s->v[i][1]),
		                 s->v[i][0]);
		way = vselect(bound_to_turn, g->direction[i], way);
		vd sign = vselect(vless(way, zero), vsplat(1), vsplat(-1));
		for (int n = 0; n <= s->order; n++)
			guard[n] = sign * s->v[i][n];
		guard_search(guard, s->order, bound_to_turn | new_top, body + POUND_EDGE_TURN, search);
	}
}

/* Looks for the beginning and the end of a contact. */
static void contact_search(const struct series *s, const struct lanes *g, vd dt, const struct ends *e,
                           vi active, struct search *search)
{
	vd guard[ORDER_TOUCH + 2];
	vd zero = vsplat(0);
	vi touching = vless(zero, g->touching) & active;
	vi parted = vless(zero, g->parted) & active;
	vi apart = active & ~touching & ~parted;
	vi pulls = vequal(g->release, zero); // the dashpot may pull: only the overlap decides
	struct hull hull = hull_of(s->p[0], s->q[0], e->p, e->q, s->p_bend);
	vi closes = apart & vless(zero, hull.high);
	if (vany(closes)) {
		memcpy(guard, s->p, sizeof guard);
		guard_search(guard, s->order, closes, CLOSES, search);
	}
	vi parts = touching & (vless(hull.low, zero) | ~pulls);
	vi force = touching | parted;
	if (vany(parts | parted)) {
		// touching ends when p + C/K p' falls through 0, and after parting begins again when it rises
		vd lead = g->release / dt;
		vd sign = vselect(parted, vsplat(1), vsplat(-1));
		for (int n = 0; n <= s->order; n++)
			guard[n] = sign * vfma(lead, s->q[n], s->p[n]);
		guard[0] = vselect(vless(zero, g->fresh), zero, guard[0]);
		guard_search(guard, s->order, (parts | parted) & force, PARTS, search);
	}
	if (vany(parted)) {
		for (int n = 0; n <= s->order; n++)
			guard[n] = -s->p[n];
		guard_search(guard, s->order, parted, CLEARS, search);
	}
}

/* ---- edges, one lane at a time ---- */

/* Contact begins, ends, or clears the overlap left after it. */
static void contact_turn(struct simulation *sim, int64_t event)
{
	struct column *x = &sim->x;
	if (event == CLEARS) {
		x->parted = 0;
		x->p = 0;
	} else if (x->touching == 0) {
		if (x->parted == 0)
			x->p = 0;
		if (sim->contacts_begun++ == 0) {
			sim->result->first_contact = (sim->sample + 1) * x->step - x->left;
			sim->result->first_speed = x->q;
		}
		x->fresh = x->parted;
		x->parted = 0;
		x->touching = 1;
		x->impulse = 0;
	} else {
		sim->result->contacts++;
		sim->result->impulse_max = fmax(sim->result->impulse_max, x->impulse);
		x->touching = 0;
		x->parted = x->release > 0 && x->p > 0;
		x->fresh = x->parted;
		if (x->parted == 0)
			x->p = 0;
	}
}

/* A body's law goes on to its next piece; from here the edge is exact. */
static void body_turn(struct simulation *sim, int i, enum pound_edge edge)
{
	struct column *x = &sim->x;
	if (edge == POUND_EDGE_TURN)
		x->v[i] = 0;
	else
		x->u[i] = edge == POUND_EDGE_HIGH ? x->high[i] : x->low[i];
	if (edge == POUND_EDGE_TURN && x->direction[i] == 0)
		return; // a turn that was only looked for as a largest displacement
	pound_pieces_leave(&sim->task->bodies[i].skeleton, &sim->at[i], edge, x->u[i]);
	piece_load(sim, i);
}

/* Whether a simulation at a sample may fly: apart, and not about to touch inside the next interval. */
static bool flies(const struct simulation *sim)
{
	const struct column *x = &sim->x;
	return sim->can_fly && x->touching == 0 && x->parted == 0 && x->p + x->step * x->q < 0;
}

/* What a lane of event steps does after its step: goes through an edge, enters the next interval, or leaves. */
static void meet_turn(struct work *work, int l, int64_t event, bool sampled)
{
	struct lanes *g = &work->meet;
	int member = work->meet_lane[l];
	struct simulation *sim = &work->pool[member];
	bool ends = sampled && sim->sample + 2 == sim->task->n_samples, leaves = ends;
	if (event == NOTHING && !sampled)
		return;
	lanes_save(g, l, sim, COLUMN_MOVED, COLUMN_READ);
	enum pound_status status = ++sim->events > EVENTS_LIMIT ? POUND_CHATTER : POUND_OK;
	if (event >= BODY)
		body_turn(sim, (int)(event - BODY) / EDGES, (enum pound_edge)((event - BODY) % EDGES));
	else if (event > CUT)
		contact_turn(sim, event);
	if (sampled) {
		sim->sample++;
		if (!ends)
			interval_enter(sim);
		leaves |= flies(sim);
	}
	if (leaves || status) {
		work->meet_lane[l] = -1;
		LANE(g->touching, l) = 0;
		LANE(g->parted, l) = 0;
		LANE(g->left, l) = LANE(g->step, l);
		if (ends || status)
			simulation_end(work, member, status);
		else
			push(&work->flyers, member);
	} else
		lanes_load(g, l, sim, COLUMN_MOVED, COLUMN_MAP);
}

/* Fills the empty lanes of event steps; false: all stay empty. */
static bool meet_fill(struct work *work)
{
	bool any = false;
	for (int l = 0; l < W; l++) {
		if (work->meet_lane[l] < 0 && work->meeters.n > 0) {
			work->meet_lane[l] = pop(&work->meeters);
			lanes_load(&work->meet, l, &work->pool[work->meet_lane[l]], COLUMN_FIRST, COLUMN_MAP);
		}
		any |= work->meet_lane[l] >= 0;
	}
	return any;
}

/* One event step: every lane goes on to its next event, its next sample, or as far as its series reaches. */
static void meet_step(struct work *work)
{
	struct lanes *g = &work->meet;
	vd one = vsplat(1), zero = vsplat(0);
	vi active;
	for (int l = 0; l < W; l++)
		LANE(active, l) = -(int64_t)(work->meet_lane[l] >= 0);
	vi touching = vless(zero, g->touching);
	vd reach = vselect(touching, g->reach[1], g->reach[0]);
	vd steps = g->left / reach;
	vi whole = ~vless(one, steps);
	vd dt = vselect(whole, g->left, vselect(vless(vsplat(2), steps), reach, 0.5 * g->left));

	struct series s;
	series_fill(&s, g, dt, touching);
	struct ends e = series_ends(&s, one);
	struct search search = {.time = one, .event = vless(one, one)};
	contact_search(&s, g, dt, &e, active, &search);
	for (int i = 0; i < 2; i++)
		body_search(&s, g, i, &e, active, &search);
	if (vany(search.event))
		e = series_ends(&s, search.time);

	// the integral of the contact force over the step, per mass of the left body
	if (vany(touching)) {
		vd overlap = zero;
		for (int n = s.order; n >= 0; n--)
			overlap = vfma(overlap, search.time, s.p[n] * vsplat(1.0 / (n + 1)));
		overlap = overlap * search.time * dt;
		vd impulse = vfma(g->contact_stiffness, overlap, g->contact_damping * (e.p - s.p[0]));
		g->impulse = vselect(touching, g->impulse + impulse, g->impulse);
		g->contact_time = vselect(touching, vfma(search.time, dt, g->contact_time), g->contact_time);
	}
	for (int i = 0; i < 2; i++) {
		g->u[i] = e.u[i];
		g->v[i] = e.v[i] / dt;
		g->top[i] = vmax(g->top[i], vabs(e.u[i]));
	}
	g->p = e.p;
	g->q = e.q / dt;
	g->fresh = zero;
	g->left = vfma(-search.time, dt, g->left);
	g->ground = vfma(g->slope, search.time * dt, g->ground);
	for (int l = 0; l < W; l++)
		if (work->meet_lane[l] >= 0)
			meet_turn(work, l, LANE(search.event, l), LANE(whole, l) && !LANE(search.event, l));
}

/* ---- the march ---- */

static_assert(sizeof(struct work) <= POUND_MARCH_SCRATCH, "the work space is too small");

void POUND_MARCH(const struct pound_march_task *tasks, struct pound_march_result *results, int n,
                 void *scratch)
{
	struct work *work = scratch;
	memset(work, 0, sizeof *work);
	work->tasks = tasks;
	work->results = results;
	work->n = n;
	for (int j = 0; j < POOL; j++)
		push(&work->idle, j);
	for (int l = 0; l < W; l++) {
		work->fly_lane[l] = work->meet_lane[l] = -1;
		LANE(work->meet.left, l) = LANE(work->meet.reach[0], l) = LANE(work->meet.reach[1], l) = 1;
	}
	for (fly(work); meet_fill(work); fly(work))
		meet_step(work);
}
