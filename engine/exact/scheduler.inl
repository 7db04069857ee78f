/* scheduler.inl - what a march works on: its tasks, the simulations that wait in queues, and the batches that are taken out of them.
 *
 * Included by exact.inl alone, once per lane count.
 *
 * Included by exact.inl after batch.inl. */

#include <assert.h>
#include <string.h>

enum { POOL = 128 /* simulations at once */ };

/* simulations that wait for one kind of step, last come first served */
struct queue {
	int n;
	struct simulation *member[POOL];
};

/* of a batch: what its code need not ask of each lane */
enum kind {
	KIND_PLAIN,  /* all laws have one branch */
	KIND_EDGED,  /* a law has more */
	KIND_COMMON, /* all of one scene, whose laws have one branch, and no lane empty */
	KINDS
};

struct work {
	struct queue idle, queues[STAGES];
	const struct pound_task *tasks;
	struct pound_task_result *results;
	int n, started;          /* tasks, and those gone through in this pass */
	int passed;              /* 0: laws of one branch are started, 1: the others */
	int n_waiting;           /* simulations that wait */
	const atomic_bool *stop; /* NULL: never */
	double beyond[W][ROW];   /* ground motion up to its end, and whatever was there behind */
	struct pound_common common;
	// from here on nothing is cleared: a simulation's start does, and what finds the shared_starts
	struct shared_starts shared_starts;
	struct simulation filler;      /* of the lanes that a batch leaves empty, and ... */
	struct pound_task_result none; /* ... what comes of it */
	struct simulation pool[POOL];
	struct simulation waiting[POOL * POUND_OTHERS]; /* for room, out of a family: no task starts meanwhile */
	struct pound_doubled_maps doubled[POOL][POUND_CONTACT_MAPS], common_doubled;
};

static_assert(sizeof(struct work) <= POUND_EXACT_SCRATCH, "the work space is too small");

static void push(struct queue *queue, struct simulation *sim)
{
	queue->member[queue->n++] = sim;
}

static struct simulation *pop(struct queue *queue)
{
	return queue->member[--queue->n];
}

/* What becomes of a simulation that has come to an end. */
LANE_SHARED void finish(struct work *work, struct simulation *sim, enum pound_stage stage)
{
	common_leave(sim);
	stage = simulation_end(sim, stage == STAGE_CHATTER ? POUND_CHATTER : POUND_OK);
	if (stage < STAGES) {
		push(&work->queues[stage], sim);
		return;
	}
	shared_end(sim);
	push(&work->idle, sim);
}

/* A member leaves a family, and both try the step again. */
LANE_SHARED void member_leave(struct work *work, struct simulation *sim, enum pound_stage stage)
{
	assert(work->n_waiting < POOL * POUND_OTHERS);
	shared_leave(sim, &work->waiting[work->n_waiting++], stage);
	push(&work->queues[stage], sim);
}

/* Sends a simulation to where it goes next. */
LANE_INLINE void send(struct work *work, struct simulation *sim, enum pound_stage stage)
{
	if (stage < STAGES)
		push(&work->queues[stage], sim);
	else
		finish(work, sim, stage);
}

static void batch_take(struct batch *b, struct work *work, struct queue *queue)
{
	b->from = queue;
	b->n = queue->n < W ? queue->n : W;
	b->traits = 0;
	for (int l = 0; l < W; l++) {
		b->sim[l] = l < b->n ? pop(queue) : &work->filler;
		b->row[l] = (double *)&b->sim[l]->x;
		b->traits |= b->sim[l]->traits;
	}
}

static enum kind batch_kind(unsigned traits)
{
	return traits & TRAIT_EDGED ? KIND_EDGED : traits & TRAIT_OWN ? KIND_PLAIN : KIND_COMMON;
}

/* Takes the next batch of the queue behind one of a scene, if it is of the same kind: what they have in common is in lanes
 * already, and stays what it is, as no task starts meanwhile.  Alike bodies go another way (contact_any in exact.inl). */
LANE_INLINE bool batch_again(struct work *work, struct batch *b)
{
	struct queue *queue = b->from;
	unsigned traits = 0;
	if (queue->n < W || pound_stopped(work->stop))
		return false;
	for (int l = 1; l <= W; l++)
		traits |= queue->member[queue->n - l]->traits;
	if (batch_kind(traits) != KIND_COMMON || traits & (TRAIT_ALIKE | TRAIT_OBSERVED))
		return false;
	batch_take(b, work, queue);
	return true;
}

/* An idle simulation, with the places of its maps: written here and not for the whole pool, as a page that is written to is memory
 * that the system has to clear. */
static struct simulation *idle_take(struct work *work)
{
	struct simulation *sim = pop(&work->idle);
	for (int m = 0; m < POUND_CONTACT_MAPS; m++)
		sim->own_maps[m].doubled = &work->doubled[sim - work->pool][m];
	return sim;
}

/* Starts a task, with those that go along with it. */
static void task_start(struct work *work, int j)
{
	struct simulation *sim = idle_take(work);
	enum pound_stage stage = simulation_start(sim, &work->tasks[j], &work->results[j]);
	shared_gather(&work->shared_starts, work->tasks, work->results, j, sim);
	common_join(&work->common, sim);
	send(work, sim, stage);
}

/* Goes on with simulations that wait, and starts tasks, as long as there are any and there is room: first those of laws of
 * one branch, which need less when they are among themselves. */
static void tasks_start(struct work *work)
{
	while (work->n_waiting > 0 && work->idle.n > 0) {
		struct simulation *sim = idle_take(work);
		shared_resume(sim, &work->waiting[--work->n_waiting]);
		push(&work->queues[sim->stage], sim);
	}
	while (work->passed < 2 && work->idle.n > 0) {
		for (; work->started < work->n && work->idle.n > 0; work->started++)
			if (shared_first(&work->shared_starts, work->started) &&
			    shared_edged(&work->shared_starts, work->tasks, work->started) == work->passed)
				task_start(work, work->started);
		if (work->started < work->n)
			return;
		work->passed++;
		work->started = 0;
	}
}

/* Where a march begins: no task is started. */
static void work_init(struct work *work, const struct pound_task *tasks, struct pound_task_result *results,
                      int n, const atomic_bool *stop)
{
	static const double still[2];
	static const struct pound_contact_map loose;
	static const struct pound_task nothing = {.ground = still, .n_samples = 2, .time_step = 1};
	memset(work, 0, offsetof(struct work, shared_starts));
	work->tasks = tasks;
	work->results = results;
	work->n = n;
	work->stop = stop;
	shared_find(&work->shared_starts, tasks, n);
	simulation_start(&work->filler, &nothing, &work->none);
	work->filler.contact_map = &loose;
	work->filler.x.dt = 1;
	work->filler.x.gap = 0;
	work->common.maps.doubled = &work->common_doubled;
	for (int j = 0; j < POOL; j++)
		push(&work->idle, &work->pool[j]);
}
