/* floor.c - the spectra and the history of one floor under one task.
 *
 * 1. The exact solver follows the task; the floor is its observer, and makes pieces of its motion, stretch by stretch;
 * 2. every oscillator rides over a stretch before the next one is made, so that memory does not grow with time. */
#include "engine/floor/floor.h"

#include <assert.h>
#include <stdalign.h>
#include <string.h>

#include "engine/numeric/cpu_width.h"
#include "engine/numeric/elementary.h"

struct pound_floor {
	int n;         /* frequencies; arrays are in whole groups */
	double *omega; /* [rad/s] */
	double *z[POUND_DRIVES], *v[POUND_DRIVES], *top[POUND_DRIVES];
	double damping;
	struct pound_floor_motion motion;
	struct pound_kernel kernel;
	alignas(64) char scratch[POUND_SPECTRUM_SCRATCH];
	struct pound_floor_stretch stretch;
};

typedef void width_ride(const struct pound_bank *, const struct pound_ride *, void *scratch);

/* Takes a bank over a stretch at a lane count; 0: the widest there is; false: this machine has no such lanes. */
bool pound_oscillator_bank_lanes(int lanes, const struct pound_bank *bank, const struct pound_ride *stretch,
                                 void *scratch)
{
	static width_ride *const run[POUND_WIDTHS] = {pound_oscillator_bank_w8, pound_oscillator_bank_w4,
	                                              pound_oscillator_bank_w1, pound_oscillator_bank_portable};
	int width = pound_dispatch_width(lanes);
	if (width >= 0)
		run[width](bank, stretch, scratch);
	return width >= 0;
}

/* Frequency k of a spectrum, both ends of a range exact [Hz].
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

/* Whether a floor can be followed under a form of contact force; where it cannot the study is refused where it is read. */
bool pound_floor_takes_force(enum pound_force force)
{
	return force == POUND_FORCE_LINEAR;
}

/* ---- work space ---- */

static int whole_groups(int n)
{
	return (n + POUND_SPECTRUM_GROUP - 1) / POUND_SPECTRUM_GROUP * POUND_SPECTRUM_GROUP;
}

size_t pound_floor_bytes(int n_frequencies)
{
	return sizeof(struct pound_floor) +
	       (1 + 3 * POUND_DRIVES) * sizeof(double) * (size_t)whole_groups(n_frequencies);
}

struct pound_floor *pound_floor_init(void *memory, const struct pound_spectrum *spectrum)
{
	static const double PI = 3.14159265358979323846;
	struct pound_floor *floor = memory;
	int whole = whole_groups(spectrum->n);
	double *numbers = (double *)(floor + 1);
	pound_kernel_fill(&floor->kernel);
	floor->n = spectrum->n;
	floor->damping = spectrum->damping_ratio;
	floor->omega = numbers;
	for (int d = 0; d < POUND_DRIVES; d++) {
		floor->z[d] = numbers += whole;
		floor->v[d] = numbers += whole;
		floor->top[d] = numbers += whole;
	}
	// what fills the last group is its last frequency once more
	for (int k = 0; k < whole; k++)
		floor->omega[k] = 2 * PI * pound_spectrum_frequency(spectrum, k < spectrum->n ? k : spectrum->n - 1);
	return floor;
}

/* ---- the motion ---- */

/* Follows a task to its end.
 *
 * Given    taker    called for every stretch of pieces: floor->stretch
 *          stop     looked at throughout; NULL: never
 *          scratch  POUND_EXACT_SCRATCH bytes, 64-byte aligned
 * Returns  result   of the exact solver
 * Status   POUND_CHATTER and others  the motion could not be followed, or not to its end
 *          POUND_STOPPED             stop was set
 */
static enum pound_status floor_follow(struct pound_floor *floor, const struct pound_task *task,
                                      const struct pound_floor_taker *taker, const atomic_bool *stop,
                                      void *scratch, struct pound_task_result *result)
{
	struct pound_floor_motion *motion = &floor->motion;
	const struct pound_task_observer observer = {pound_floor_observe, motion};
	struct pound_task observed = *task;
	observed.observer = &observer;
	// whoever wants the largest displacements has them
	observed.bodies[0].followed = observed.bodies[1].followed = false;
	*motion =
	    (struct pound_floor_motion){.task = task, .stretch = &floor->stretch, .taker = *taker, .stop = stop};
	pound_floor_start(motion);
	// one task alone is done sooner in one lane than in many
	bool followed = pound_exact_lanes(1, &observed, result, 1, scratch, stop);
	assert(followed);
	(void)followed;
	if (pound_stopped(stop))
		return POUND_STOPPED;
	taker->take(taker->into);
	return motion->status ? motion->status : result->status;
}

/* ---- spectra ---- */

/* what takes a bank over a stretch */
struct riders {
	const struct pound_bank *bank;
	struct pound_ride ride;
	int lanes;
	void *scratch;
};

static void riders_take(void *of)
{
	const struct riders *riders = of;
	bool ridden = pound_oscillator_bank_lanes(riders->lanes, riders->bank, &riders->ride, riders->scratch);
	assert(ridden);
	(void)ridden;
}

/* Pseudo-acceleration spectra of the floor of a task.
 *
 * Given    ask      the task; an undefined lane count is a fault of the caller
 * Returns  answer   largest w^2 |z| of oscillators at rest at first, while the ground motion lasts
 * Status   POUND_CHATTER  the motion could not be followed; the answer is not to be used
 *          POUND_STOPPED  stop was set; nor is it
 *
 * Source   model.md 7 of the project's design pages
 * Test     unit_floor
 */
enum pound_status pound_floor_spectra(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                      struct pound_floor_answer *answer)
{
	int whole = whole_groups(floor->n);
	struct pound_bank bank = {.n_groups = whole / POUND_SPECTRUM_GROUP,
	                          .n_drives = ask->n_drives,
	                          .damping = floor->damping,
	                          .radians = ask->radians,
	                          .kernel = &floor->kernel,
	                          .omega = floor->omega};
	struct riders riders = {.bank = &bank,
	                        .ride = {.stretch = &floor->stretch,
	                                 .time_step = ask->task->time_step,
	                                 .damping = ask->task->bodies[0].damping},
	                        .lanes = ask->lanes,
	                        .scratch = floor->scratch};
	struct pound_task_result result = {0}; // stopped before it began it is not written
	for (int d = 0; d < ask->n_drives; d++) {
		bank.z[d] = floor->z[d], bank.v[d] = floor->v[d], bank.top[d] = floor->top[d];
		memset(floor->z[d], 0, 3 * sizeof(double) * (size_t)whole);
	}
	const struct pound_floor_taker taker = {riders_take, &riders};
	enum pound_status status = floor_follow(floor, ask->task, &taker, ask->stop, ask->scratch, &result);
	for (int d = 0; d < ask->n_drives; d++)
		for (int k = 0; k < floor->n; k++)
			answer->psa[d][k] = floor->omega[k] * floor->omega[k] * floor->top[d][k];
	answer->impulse_max = result.impulse_max;
	answer->contacts = result.contacts;
	return status;
}

/* ---- history ---- */

/* Where the rows of a history go, and the last of them: the end of the piece before. */
struct chronicle {
	struct pound_floor *floor;
	pound_floor_take *take;
	void *into;
	struct pound_floor_instant last;
};

/* A drive at both ends of a piece [m/s2]. */
static void drive_ends(const struct pound_floor *floor, const struct pound_floor_piece *piece,
                       enum pound_drive drive, double ends[2])
{
	const double *c, damping = floor->motion.task->bodies[0].damping;
	double room[POUND_FLOOR_ORDER + 1];
	const int order = pound_floor_drive(&floor->stretch, piece, drive, damping, room, &c);
	ends[0] = order < 0 ? 0 : c[0];
	ends[1] = 0;
	for (int n = order; n >= 0; n--)
		ends[1] += c[n];
}

static void chronicle_take(void *of)
{
	struct chronicle *chronicle = of;
	struct pound_floor_instant *last = &chronicle->last;
	const struct pound_floor_stretch *stretch = &chronicle->floor->stretch;
	for (int i = 0; i < stretch->n; i++) {
		const struct pound_floor_piece *p = &stretch->piece[i];
		double whole[2], push[2];
		drive_ends(chronicle->floor, p, POUND_DRIVE_FLOOR, whole);
		drive_ends(chronicle->floor, p, POUND_DRIVE_PUSH, push);
		const struct pound_floor_instant now = {p->start, p->u, p->v, whole[0], push[0]};
		last->time = now.time, last->u = now.u, last->v = now.v;
		if (p->after_event)
			chronicle->take(chronicle->into, last);
		if (p->sampled || p->after_event)
			chronicle->take(chronicle->into, &now);
		last->acceleration = whole[1];
		last->push = push[1];
	}
}

/* The history of a task's floor.
 *
 * Given    ask     the task; its drives, radians and lanes are not looked at
 * Returns  take    called in the order of time; at an event twice, for what was before and what is after
 * Status   POUND_CHATTER  the motion could not be followed to its end
 *          POUND_STOPPED  stop was set
 * Test     unit_floor: a_history_has_every_sample_and_both_sides_of_every_event, a_floor_that_takes_hours_is_stopped
 */
enum pound_status pound_floor_history(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                      pound_floor_take *take, void *into)
{
	const struct pound_task *task = ask->task;
	struct chronicle chronicle = {.floor = floor, .take = take, .into = into};
	const struct pound_floor_taker taker = {chronicle_take, &chronicle};
	struct pound_task_result result = {0};
	enum pound_status status = floor_follow(floor, task, &taker, ask->stop, ask->scratch, &result);
	chronicle.last.time = (task->n_samples - 1) * task->time_step;
	chronicle.last.u = result.u[0], chronicle.last.v = result.v[0];
	if (!status)
		take(into, &chronicle.last);
	return status;
}
