/* floor.c - the spectra and the history of one floor under one task.
 *
 * 1. The exact solver integrates several tasks at once, in its lanes; each floor has its own observer, which buffers the reported
 *    instants and makes pieces of the floor's motion from them when the buffer is full, or at the end;
 * 2. every oscillator is integrated over these pieces before the next ones are made, so that memory does not grow with time. */
#include "engine/floor/floor.h"

#include <assert.h>
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "engine/numeric/cpu_width.h"
#include "engine/numeric/elementary.h"
#include "engine/solver/solver.h"

enum { INSTANTS = 256 /* buffered per floor before pieces are made from them */ };

/* a floor that is being integrated, and the oscillators on it */
struct follow {
	struct pound_floor_motion motion;
	struct pound_bank bank;
	struct pound_bank_input input;
	int lanes; /* of the bank */
	void *scratch;
	int n;
	struct pound_instant_of_task instants[INSTANTS]; /* (n) */
};

struct pound_floor {
	int n;         /* frequencies; arrays are in whole groups */
	double *omega; /* [rad/s] */
	double
	    *states; /* of the oscillators of every floor  (POUND_FLOORS x POUND_DRIVES x 3, whole groups each) */
	double damping;
	struct pound_floor_motion motion; /* for a history, and for a chain */
	struct pound_segment_powers powers;
	alignas(64) char scratch[POUND_SPECTRUM_SCRATCH];
	struct pound_floor_stretch stretch;
	struct follow follows[POUND_FLOORS];
};

typedef void width_bank(const struct pound_bank *, const struct pound_bank_input *, void *scratch);

/* Integrates a bank over a stretch with a lane count, 0: the widest; false: this processor does not have it. */
bool pound_oscillator_bank_lanes(int lanes, const struct pound_bank *bank,
                                 const struct pound_bank_input *stretch, void *scratch)
{
	static width_bank *const run[POUND_WIDTHS] = {pound_oscillator_bank_w8, pound_oscillator_bank_w4,
	                                              pound_oscillator_bank_w1, pound_oscillator_bank_portable};
	int width = pound_dispatch_width(lanes);
	if (width >= 0)
		run[width](bank, stretch, scratch);
	return width >= 0;
}

/* Frequency k of a spectrum [Hz]; both ends of a range are exact.
 *
 * Test     unit_floor: a_range_of_frequencies_is_a_geometric_one
 */
double pound_spectrum_frequency(const struct pound_spectrum *s, int k)
{
	if (s->frequencies_hz)
		return s->frequencies_hz[k];
	if (k == 0 || k == s->n - 1)
		return k == 0 ? s->min_hz : s->max_hz;
	double ratio = pound_elementary_log(s->max_hz / s->min_hz);
	return s->min_hz * pound_elementary_exp(ratio * k / (s->n - 1));
}

/* ---- work space ---- */

static int whole_groups(int n)
{
	return (n + POUND_SPECTRUM_GROUP - 1) / POUND_SPECTRUM_GROUP * POUND_SPECTRUM_GROUP;
}

size_t pound_floor_bytes(int n_frequencies)
{
	return sizeof(struct pound_floor) +
	       (1 + POUND_FLOORS * POUND_DRIVES * 3) * sizeof(double) * (size_t)whole_groups(n_frequencies);
}

struct pound_floor *pound_floor_init(void *memory, const struct pound_spectrum *spectrum)
{
	static const double PI = 3.14159265358979323846;
	struct pound_floor *floor = memory;
	int whole = whole_groups(spectrum->n);
	double *numbers = (double *)(floor + 1);
	pound_segment_powers_fill(&floor->powers);
	floor->n = spectrum->n;
	floor->damping = spectrum->damping_ratio;
	floor->omega = numbers;
	floor->states = numbers + whole;
	// the last group is padded with the last frequency
	for (int k = 0; k < whole; k++)
		floor->omega[k] = 2 * PI * pound_spectrum_frequency(spectrum, k < spectrum->n ? k : spectrum->n - 1);
	return floor;
}

/* ---- the motion ---- */

/* the callbacks of one integration */
struct follower {
	struct pound_task_observer
	    observer; /* of a pair: passes every instant to pound_floor_observe with floor->motion */
	struct pound_floor_taker taker;    /* called for every stretch of pieces: floor->stretch */
	struct pound_floor_beside *beside; /* of a chain, for struct pound_floor_motion */
};

/* A copy of a pair with an observer and without largest displacements. */
static struct pound_task observed_pair(const struct pound_task *task,
                                       const struct pound_task_observer *observer)
{
	struct pound_task observed = *task;
	observed.observer = observer;
	observed.bodies[0].followed = observed.bodies[1].followed = false;
	return observed;
}

/* Integrates n pairs; a single one is faster in one lane than in many. */
static void pairs_follow(const struct pound_task *observed, struct pound_task_result *results, int n,
                         const struct pound_floor_ask *ask)
{
	bool followed = pound_exact_lanes(n > 1 ? 0 : 1, observed, results, n, ask->scratch, ask->stop);
	assert(followed);
	(void)followed;
}

static void chain_follow(struct pound_floor *floor, const struct pound_floor_ask *ask,
                         struct pound_chain_observer observer, const struct pound_floor_of_chain *chain)
{
	struct pound_chain_task observed = *chain->task;
	observer.observe = pound_floor_observe_chain;
	observer.into = &floor->motion;
	observed.observer = &observer;
	observed.asked = 0;
	chain->result->status = POUND_OK; // not written if stopped before the start
	pound_floor_start_chain(&floor->motion);
	pound_chain_lanes(0, &observed, chain->result, 1, ask->scratch, ask->stop);
}

/* Integrates, as a chain, a pair whose contact force the solver of pairs does not have. */
static void pair_follow_as_chain(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                 struct pound_task_result *result)
{
	struct pound_pair_chain pair;
	pound_pair_chain(ask->task, &pair);
	struct pound_chain_result rows = {.floors = pair.floor_measures[0], .links = pair.link_measures};
	memset(pair.floor_measures, 0, sizeof pair.floor_measures);
	memset(pair.link_measures, 0, sizeof pair.link_measures);
	const struct pound_chain_observer observer = {.floor = 0, .link = 0};
	chain_follow(floor, ask, observer, &(struct pound_floor_of_chain){&pair.task, 0, &rows});
	*result = (struct pound_task_result){.status = rows.status,
	                                     .impulse_max = rows.links[POUND_LINK_IMPULSE_MAX],
	                                     .contacts = (int64_t)rows.links[POUND_LINK_CONTACTS]};
	for (int i = 0; i < pair.task.n_floors; i++) {
		result->u[i] = pair.floor_measures[i][POUND_FLOOR_END_U];
		result->v[i] = pair.floor_measures[i][POUND_FLOOR_END_V];
	}
}

/* Test     unit_row_floors: a_history_has_the_contact_of_its_floor */
int pound_floor_contact(const struct pound_floor_of_chain *chain)
{
	const struct pound_link *links = chain->task->links;
	for (int j = 0; j < chain->task->n_links; j++)
		for (int k = 0; k < 2; k++)
			if (links[j].floor[0][k] == chain->floor && links[j].weight[0][k] == 1)
				return j;
	return -1;
}

/* Final displacement or velocity of the right level of a contact of a chain.
 *
 * Given    measure  POUND_FLOOR_END_U or POUND_FLOOR_END_V
 */
static double level_end(const struct pound_floor_of_chain *chain, int link, enum pound_floor_measure measure)
{
	double sum = 0;
	for (int k = 0; link >= 0 && k < 2; k++) {
		const int floor = chain->task->links[link].floor[1][k];
		if (floor != POUND_CHAIN_GROUND)
			sum += chain->task->links[link].weight[1][k] *
			       chain->result->floors[floor * POUND_FLOOR_MEASURES + measure];
	}
	return sum;
}

/* Sets the largest impulse of a contact on a floor of a chain over the floor's mass, and the number of contacts. */
static void impulses_fill(const struct pound_floor_of_chain *chain, struct pound_task_result *result)
{
	const struct pound_chain_task *task = chain->task;
	for (int j = 0; j < task->n_links; j++) {
		const double *link = chain->result->links + j * POUND_LINK_MEASURES;
		for (int side = 0; side < 2; side++)
			for (int w = 0; w < 2; w++) {
				const double weight = task->links[j].weight[side][w] / task->floors[chain->floor].mass;
				if (task->links[j].floor[side][w] != chain->floor || weight == 0)
					continue;
				result->impulse_max = fmax(result->impulse_max, weight * link[POUND_LINK_IMPULSE_MAX]);
				result->contacts += (int64_t)link[POUND_LINK_CONTACTS];
			}
	}
}

/* Integrates a task to its end.
 *
 * Given    ask       its task, or its chain, stop and scratch
 * Returns  result    of the exact solver; of a chain its status, and the final state of the floor as the left body's
 * Status   POUND_CHATTER and others  the motion could not be computed, or not to its end
 *          POUND_STOPPED             stop was set
 */
static enum pound_status floor_follow(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                      const struct follower *follower, struct pound_task_result *result)
{
	struct pound_floor_motion *motion = &floor->motion;
	*motion = (struct pound_floor_motion){.stretch = &floor->stretch,
	                                      .taker = follower->taker,
	                                      .stop = ask->stop,
	                                      .pushed = true,
	                                      .beside = follower->beside};
	if (ask->chain.task) {
		// a history reports one contact, spectra include all
		const int link = follower->beside ? pound_floor_contact(&ask->chain) : -1;
		const struct pound_chain_observer observer = {.floor = ask->chain.floor, .link = link};
		const double *floors = ask->chain.result->floors + ask->chain.floor * POUND_FLOOR_MEASURES;
		chain_follow(floor, ask, observer, &ask->chain);
		*result = (struct pound_task_result){
		    .status = ask->chain.result->status,
		    .u = {floors[POUND_FLOOR_END_U], level_end(&ask->chain, link, POUND_FLOOR_END_U)},
		    .v = {floors[POUND_FLOOR_END_V], level_end(&ask->chain, link, POUND_FLOOR_END_V)}};
		impulses_fill(&ask->chain, result);
	} else if (pound_runs_as_chain(ask->task)) {
		pair_follow_as_chain(floor, ask, result);
	} else {
		const struct pound_task observed = observed_pair(ask->task, &follower->observer);
		motion->task = ask->task;
		pound_floor_start(motion);
		pairs_follow(&observed, result, 1, ask);
	}
	if (pound_stopped(ask->stop))
		return POUND_STOPPED;
	motion->taker.take(motion->taker.into);
	return motion->status ? motion->status : result->status;
}

/* ---- spectra ---- */

/* Integrates the oscillators of a floor over the current pieces. */
static void follow_take(void *of)
{
	const struct follow *follow = of;
	bool done = pound_oscillator_bank_lanes(follow->lanes, &follow->bank, &follow->input, follow->scratch);
	assert(done);
	(void)done;
}

/* Initializes floor k, with oscillators at rest. */
static struct follow *follow_begin(struct pound_floor *floor, const struct pound_floor_ask *ask, int k)
{
	struct follow *follow = &floor->follows[k];
	const size_t whole = (size_t)whole_groups(floor->n);
	double *state = floor->states + (size_t)k * POUND_DRIVES * 3 * whole;
	memset(state, 0, POUND_DRIVES * 3 * whole * sizeof *state);
	follow->bank = (struct pound_bank){.n_groups = (int)whole / POUND_SPECTRUM_GROUP,
	                                   .n_drives = ask->n_drives,
	                                   .damping = floor->damping,
	                                   .radians = ask->radians,
	                                   .powers = &floor->powers,
	                                   .omega = floor->omega};
	for (int d = 0; d < POUND_DRIVES; d++, state += 3 * whole) {
		follow->bank.z[d] = state;
		follow->bank.v[d] = state + whole;
		follow->bank.top[d] = state + 2 * whole;
	}
	follow->input = (struct pound_bank_input){.stretch = &floor->stretch,
	                                          .time_step = ask->chain.task ? ask->chain.task->time_step
	                                                                       : ask->task->time_step,
	                                          .damping = ask->chain.task ? 0 : ask->task->bodies[0].damping};
	follow->lanes = ask->lanes;
	follow->scratch = floor->scratch;
	follow->n = 0;
	follow->motion = (struct pound_floor_motion){.task = ask->task,
	                                             .stretch = &floor->stretch,
	                                             .taker = {follow_take, follow},
	                                             .stop = ask->stop,
	                                             .pushed = ask->n_drives > 1};
	return follow;
}

/* Makes pieces from the buffered instants and integrates the oscillators over them, in the stretch that all floors share. */
static void follow_empty(struct follow *follow)
{
	follow->motion.stretch->n = follow->motion.stretch->n_maps = 0;
	for (int i = 0; i < follow->n; i++)
		pound_floor_observe(&follow->motion, &follow->instants[i]);
	follow->n = 0;
	if (!pound_stopped(follow->motion.stop))
		follow_take(follow);
}

static void follow_observe(void *of, const struct pound_instant_of_task *instant)
{
	struct follow *follow = of;
	follow->instants[follow->n++] = *instant;
	if (follow->n == INSTANTS)
		follow_empty(follow);
}

static void answer_fill(const struct pound_floor *floor, const struct follow *follow,
                        const struct pound_task_result *result, struct pound_floor_answer *answer)
{
	for (int d = 0; d < follow->bank.n_drives; d++)
		for (int k = 0; k < floor->n; k++)
			answer->psa[d][k] = floor->omega[k] * floor->omega[k] * follow->bank.top[d][k];
	answer->impulse_max = result->impulse_max;
	answer->contacts = result->contacts;
	answer->status = pound_stopped(follow->motion.stop) ? POUND_STOPPED
	                 : follow->motion.status            ? follow->motion.status
	                                                    : result->status;
}

/* Pseudo-acceleration spectra of the floors of n tasks, at most POUND_FLOORS.
 *
 * Given    asks     all with the same stop and scratch; the processor must have their lane counts
 * Returns  answers  largest w^2 |z| during the ground motion, of oscillators initially at rest
 *          value    the first status that is not POUND_OK
 * Status   POUND_CHATTER  the motion could not be computed; the answer is invalid
 *          POUND_STOPPED  stop was set; the answer is invalid
 *
 * Source   model.md 7 of the project's design pages
 * Test     unit_floor
 */
enum pound_status pound_floor_spectra(struct pound_floor *floor, const struct pound_floor_ask *asks,
                                      struct pound_floor_answer *answers, int n)
{
	struct pound_task observed[POUND_FLOORS];
	struct pound_task_observer observers[POUND_FLOORS];
	struct pound_task_result results[POUND_FLOORS] = {0}; // not written if stopped before the start
	int of[POUND_FLOORS], n_observed = 0;
	enum pound_status status = POUND_OK;
	assert(n <= POUND_FLOORS);
	for (int k = 0; k < n; k++) {
		struct follow *follow = follow_begin(floor, &asks[k], k);
		if (asks[k].chain.task || pound_runs_as_chain(asks[k].task)) {
			const struct follower chain = {.taker = {follow_take, follow}};
			follow->motion.status = floor_follow(floor, &asks[k], &chain, &results[k]);
			continue;
		}
		observers[n_observed] = (struct pound_task_observer){.observe = follow_observe, .into = follow};
		observed[n_observed] = observed_pair(asks[k].task, &observers[n_observed]);
		pound_floor_start(&follow->motion);
		of[n_observed++] = k;
	}
	struct pound_task_result found[POUND_FLOORS] = {0};
	if (n_observed)
		pairs_follow(observed, found, n_observed, asks);
	for (int i = 0; i < n_observed; i++) {
		follow_empty(&floor->follows[of[i]]);
		results[of[i]] = found[i];
	}
	for (int k = 0; k < n; k++) {
		answer_fill(floor, &floor->follows[k], &results[k], &answers[k]);
		status = status ? status : answers[k].status;
	}
	return status;
}

/* ---- history ---- */

/* Largest relative error of a spectrum computed from the rows of a history, and the largest ratio of the contact force's spectrum
 * to the floor's spectrum for which it holds (impact_only over pounding in a result; 16 at 0.1 Hz in the example). */
static const double ROWS_ERROR = 0.005, ROWS_DRIFT = 60;

/* Largest spacing of rows for linear interpolation: h^2 |a''| over the size of a.
 *
 *   theta^2 = min(12 E/D, max((pi E)^2, 4 pi^2 xi E))
 *
 * | h, a | time between two rows, acceleration of the floor |        | E | ROWS_ERROR |
 * | A, W | size and rate of a component of it, such as one contact: a'' = W^2 A, theta = W h |   | D | ROWS_DRIFT |
 * | w, xi | frequency and damping of an oscillator on the floor |
 *
 * The error of linear interpolation between rows is a'' s (h - s)/2, in the mean h^2 a''/12.
 * 1. An oscillator slower than the rows responds to the mean: all contacts appear theta^2/12 weaker.  Its spectrum is the
 *    difference between contacts and the floor's own restoring force, at most D times less than either.
 * 2. An oscillator with the period of the rows, w = 2 pi/h, responds to the first harmonic, h^2 a''/(2 pi^2).  If damped, its
 *    spectrum errs by at most 1/(2 xi) times this: theta^2/(4 pi^2 xi) A; if undamped, by w/2 times the integral of this while
 *    a'' keeps its sign (the integral of a'' is 2 W A): theta/pi A.  Its spectrum is at least A.
 * Source   Nigam and Jennings, Bulletin of the Seismological Society of America 59 (1969) 909: a piecewise linear record
 */
static double rows_spacing(double xi)
{
	static const double PI = 3.14159265358979323846;
	const double undamped = PI * PI * ROWS_ERROR * ROWS_ERROR, damped = 4 * PI * PI * xi * ROWS_ERROR;
	return fmin(12 * ROWS_ERROR / ROWS_DRIFT, fmax(undamped, damped));
}

enum { MOTION_ORDER = POUND_FLOOR_ORDER + 2 };

/* The motion of both bodies over a piece: coefficients of powers of the elapsed fraction of its step. */
struct piece_motion {
	double start, step;
	double u[POUND_OSCILLATORS][MOTION_ORDER + 1], gap[MOTION_ORDER + 1];
	double acceleration[POUND_OSCILLATORS][MOTION_ORDER + 1], push[MOTION_ORDER + 1];
	double ground[2];
};

/* State of the output of a history's rows. */
struct chronicle {
	struct pound_floor *floor;
	pound_floor_take *take;
	void *into;
	double spacing; /* rows_spacing */
	bool of_chain;  /* `beside` is used instead of `from` */
	struct pound_floor_beside beside;
	struct pound_instant_of_task from; /* start of this interval */
	struct pound_floor_instant last;   /* end of the previous piece */
	double largest;                    /* acceleration in any piece without contact [m/s2] */
	double open,
	    needed; /* time since the last row [s]; largest |a''| since then over spacing times size of a [1/s2] */
};

static double polynomial_at(const double *c, int order, double s)
{
	double sum = 0;
	for (int n = order; n >= 0; n--)
		sum = sum * s + c[n];
	return sum;
}

/* Series of the right body over a piece of the left floor's motion, order by order.
 *
 *   u2'' = -(c2 u2' + k2 u2 + o2) - r P - d2 g     gap'' = u2'' - u1''
 *
 * | P | the piece's push, -F/m1 |   | g | ground | | d | drive, 0: a rigid wall |   | r | m1/m2 |
 * | c2, k2, o2 | damping, stiffness and offset of the right body's branch, per mass |
 * Valid    to rounding, as the piece: its step is short enough for the right body's rates, too
 */
static void right_fill(struct piece_motion *m, const struct chronicle *chronicle)
{
	const struct pound_instant_of_task *at = &chronicle->from;
	const struct pound_task *task = chronicle->floor->motion.task;
	const struct pound_task_body *right = &task->bodies[1];
	const double h = m->step;
	for (int n = 0; n <= POUND_FLOOR_ORDER; n++) {
		const double ground = n < 2 ? m->ground[n] : 0, per_step = h * h / ((n + 1) * (n + 2));
		const double spring = at->stiffness[1] * m->u[1][n] + (n == 0 ? at->spring_offset[1] : 0);
		const double pulled =
		    -(right->damping * (n + 1) * m->u[1][n + 1] / h + spring) - task->mass_ratio * m->push[n];
		const double left = m->acceleration[0][n] - task->bodies[0].drive * ground;
		const double other = pulled - right->drive * ground;
		m->acceleration[1][n] = other + ground;
		m->u[0][n + 2] = left * per_step;
		m->u[1][n + 2] = other * per_step;
		m->gap[n + 2] = (other - left) * per_step;
	}
}

/* The same for a floor of a chain. */
static void beside_fill(struct piece_motion *m, const struct pound_floor_beside *beside)
{
	for (int n = 0; n <= POUND_FLOOR_ORDER; n++) {
		const double ground = n < 2 ? m->ground[n] : 0, per_step = m->step * m->step / ((n + 1) * (n + 2));
		const double other = n <= beside->order ? beside->right.c[n] : 0;
		m->acceleration[1][n] = other;
		m->u[0][n + 2] = (m->acceleration[0][n] - ground) * per_step;
		m->u[1][n + 2] = (other - ground) * per_step;
		m->gap[n + 2] = (other - m->acceleration[0][n]) * per_step;
	}
}

/* Series of both bodies over a piece.
 *
 * Given    start  both bodies at its start
 */
static void motion_fill(struct piece_motion *m, const struct chronicle *chronicle,
                        const struct pound_floor_piece *p, const struct pound_floor_instant *start)
{
	const struct pound_floor *floor = chronicle->floor;
	const double h = p->step, *c;
	const double slope = chronicle->of_chain ? chronicle->beside.slope : chronicle->from.slope;
	const double damping = chronicle->of_chain ? 0 : floor->motion.task->bodies[0].damping;
	double room[POUND_FLOOR_ROOM];
	*m = (struct piece_motion){.start = p->start, .step = h, .ground = {start->ground, slope * h}};
	for (int d = 0; d < POUND_DRIVES; d++) {
		const int order = pound_floor_drive(&floor->stretch, p, (enum pound_drive)d, damping, room, &c);
		for (int n = 0; n <= order; n++)
			(d == POUND_DRIVE_PUSH ? m->push : m->acceleration[0])[n] = c[n];
	}
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		m->u[i][0] = start->u[i];
		m->u[i][1] = start->v[i] * h;
	}
	m->gap[0] = start->gap;
	m->gap[1] = start->gap_rate * h;
	if (chronicle->of_chain)
		beside_fill(m, &chronicle->beside);
	else
		right_fill(m, chronicle);
}

static double rate_at(const struct piece_motion *m, const double *c, double s)
{
	double sum = 0;
	for (int n = MOTION_ORDER; n > 0; n--)
		sum = sum * s + n * c[n];
	return sum / m->step;
}

static struct pound_floor_instant instant_at(const struct piece_motion *m, double s)
{
	struct pound_floor_instant now = {.time = m->start + s * m->step,
	                                  .gap = polynomial_at(m->gap, MOTION_ORDER, s),
	                                  .gap_rate = rate_at(m, m->gap, s),
	                                  .ground = m->ground[0] + s * m->ground[1],
	                                  .push = polynomial_at(m->push, MOTION_ORDER, s)};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		now.u[i] = polynomial_at(m->u[i], MOTION_ORDER, s);
		now.v[i] = rate_at(m, m->u[i], s);
		now.acceleration[i] = polynomial_at(m->acceleration[i], MOTION_ORDER, s);
	}
	return now;
}

/* Both bodies at the start of a piece, without the accelerations. */
static struct pound_floor_instant piece_start(const struct chronicle *chronicle,
                                              const struct pound_floor_piece *p)
{
	const struct pound_instant_of_task *at = &chronicle->from;
	const struct pound_floor_beside *beside = &chronicle->beside;
	struct pound_floor_instant start = chronicle->last;
	start.time = p->start;
	if (!p->sampled && !p->after_event)
		return start;
	if (chronicle->of_chain) {
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			start.u[i] = beside->u[i], start.v[i] = beside->v[i];
		start.gap = -beside->overlap;
		start.gap_rate = -beside->overlap_rate;
		start.ground = beside->ground;
		return start;
	}
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		start.u[i] = at->u[i], start.v[i] = at->v[i];
	start.gap = at->touching ? -at->overlap : chronicle->floor->motion.task->gap - (at->u[0] - at->u[1]);
	start.gap_rate = at->touching ? -at->overlap_rate : at->v[1] - at->v[0];
	start.ground = at->ground;
	return start;
}

/* Writes the rows of a piece: at its start, if a reported instant is there or a row is due, and inside. */
static void chronicle_piece(struct chronicle *chronicle, const struct pound_floor_piece *p)
{
	struct pound_floor_instant *last = &chronicle->last, start = piece_start(chronicle, p);
	struct piece_motion m;
	motion_fill(&m, chronicle, p, &start);
	start.acceleration[0] = m.acceleration[0][0], start.acceleration[1] = m.acceleration[1][0];
	start.push = m.push[0];
	if (!(chronicle->of_chain ? chronicle->beside.touching : chronicle->from.touching))
		chronicle->largest = fmax(chronicle->largest, p->floor.bound[0]);
	const double size = chronicle->spacing * fmax(chronicle->largest, p->floor.bound[0]);
	const double inside = size > 0 ? p->floor.bound[2] / size : 0; // square of the number of rows needed
	const double needed = fmax(chronicle->needed, inside / (m.step * m.step));
	const bool instant = p->sampled || p->after_event;
	const double open = chronicle->open + m.step;
	if (!instant && open * open * needed <= 1) {
		chronicle->open = open;
		chronicle->needed = needed;
		*last = instant_at(&m, 1);
		return;
	}
	if (p->after_event) {
		struct pound_floor_instant before = start;
		memcpy(before.acceleration, last->acceleration, sizeof before.acceleration);
		before.push = last->push;
		if (chronicle->of_chain) { // velocities may have jumped
			memcpy(before.v, last->v, sizeof before.v);
			before.gap_rate = last->gap_rate;
		}
		chronicle->take(chronicle->into, &before);
	}
	chronicle->take(chronicle->into, &start);
	const int n = (int)ceil(sqrt(inside));
	double time = start.time;
	for (int k = 1; k < n && !pound_stopped(chronicle->floor->motion.stop); k++) {
		const struct pound_floor_instant now = instant_at(&m, (double)k / n);
		if (now.time > time)
			chronicle->take(chronicle->into, &now);
		time = now.time;
	}
	chronicle->open = m.step / (n > 1 ? n : 1);
	chronicle->needed = inside / (m.step * m.step);
	*last = instant_at(&m, 1);
}

static void chronicle_take(void *of)
{
	struct chronicle *chronicle = of;
	struct pound_floor_stretch *stretch = &chronicle->floor->stretch;
	for (int i = 0; i < stretch->n; i++)
		chronicle_piece(chronicle, &stretch->piece[i]);
	stretch->n = 0;
}

/* Pieces are taken interval by interval, because the right body is known at the start of each interval. */
static void chronicle_observe(void *of, const struct pound_instant_of_task *instant)
{
	struct chronicle *chronicle = of;
	chronicle->from = chronicle->floor->motion.from;
	pound_floor_observe(&chronicle->floor->motion, instant);
	chronicle_take(chronicle);
}

/* The history of both bodies of a task.
 *
 * Given    ask     the task; its drives, radians and lanes are not used
 * Returns  take    called in the order of time: at every sample; twice at an event, with the states before and after it;
 *                  and between them as often as rows_spacing requires
 * Status   POUND_CHATTER  the motion could not be computed to its end
 *          POUND_STOPPED  stop was set
 * Valid    a response spectrum of the left floor's acceleration, linear between rows, is within 0.5 % of
 *          pound_floor_spectra at every frequency at which impact_only is at most 60 times pounding
 * Test     unit_floor: a_history_has_every_sample_and_both_sides_of_every_event, a_floor_that_takes_hours_is_stopped;
 *          unit_floor_history
 */
enum pound_status pound_floor_history(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                      pound_floor_take *take, void *into)
{
	const bool of_chain = ask->chain.task || pound_runs_as_chain(ask->task);
	struct chronicle chronicle = {.floor = floor,
	                              .take = take,
	                              .into = into,
	                              .spacing = rows_spacing(floor->damping),
	                              .of_chain = of_chain};
	const struct follower follower = {.observer = {.observe = chronicle_observe, .into = &chronicle},
	                                  .taker = {chronicle_take, &chronicle},
	                                  .beside = of_chain ? &chronicle.beside : NULL};
	struct pound_task_result result = {0};
	enum pound_status status = floor_follow(floor, ask, &follower, &result);
	const int n_samples = ask->chain.task ? ask->chain.task->n_samples : ask->task->n_samples;
	const double time_step = ask->chain.task ? ask->chain.task->time_step : ask->task->time_step;
	struct pound_floor_instant *last = &chronicle.last;
	last->time = (n_samples - 1) * time_step;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		last->u[i] = result.u[i], last->v[i] = result.v[i];
	if (!status)
		take(into, last);
	return status;
}
