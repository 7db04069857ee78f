/* scheduler.inl - the work space of a run: its tasks, the queues of waiting simulations, and the batches taken from them.
 *
 * Included by exact.inl alone, once per lane count.
 *
 * Included by exact.inl after batch.inl. */

#include <assert.h>
#include <string.h>

enum { POOL = 128 /* simulations in progress at once */ };

/* simulations that wait for one kind of step, last in first out */
struct queue {
	int n;
	struct simulation *member[POOL];
};

/* kind of a batch: selects specialized code without per-lane checks */
enum kind {
	KIND_PLAIN,  /* all laws have one branch */
	KIND_EDGED,  /* a law has several branches */
	KIND_COMMON, /* all lanes in use, by simulations of one scene whose laws have one branch */
	KINDS
};

struct work {
	struct queue idle, queues[STAGES];
	const struct pound_task *tasks;
	struct pound_task_result *results;
	int n, started; /* number of tasks, and of those examined in this pass */
	int passed;    /* passes done: the first starts tasks whose laws have one branch, the second the others */
	int n_waiting; /* number of simulations in waiting[] */
	const atomic_bool *stop; /* NULL: never stopped */
	double beyond[W][ROW];   /* last, partial row of the ground motion; its tail is stale data */
	struct pound_common common;
	// work_init clears nothing from here on: simulation_start and shared_find do
	struct shared_starts shared_starts;
	struct simulation filler;      /* occupies the lanes that a batch leaves empty, and ... */
	struct pound_task_result none; /* ... its unused result */
	struct simulation pool[POOL];
	struct simulation
	    waiting[POOL * POUND_OTHERS]; /* left a shared start; they enter the pool before new tasks */
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

/* Ends a simulation: it goes on to examine noted samples, or returns to the idle ones. */
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

/* A task leaves a shared simulation; both repeat the step separately. */
LANE_SHARED void member_leave(struct work *work, struct simulation *sim, enum pound_stage stage)
{
	assert(work->n_waiting < POOL * POUND_OTHERS);
	shared_leave(sim, &work->waiting[work->n_waiting++], stage);
	push(&work->queues[stage], sim);
}

/* Puts a simulation into the queue of its next stage, or ends it. */
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

/* Takes the next batch from the same queue if it too is KIND_COMMON: the shared constants are in lanes already, and do not
 * change, as no task starts meanwhile.  Identical bodies take another path (contact_any in exact.inl). */
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

/* Takes an idle simulation and sets the pointers to its doubled maps: here and not for the whole pool at the start, as the
 * system would have to clear every page written to. */
static struct simulation *idle_take(struct work *work)
{
	struct simulation *sim = pop(&work->idle);
	for (int m = 0; m < POUND_CONTACT_MAPS; m++)
		sim->own_maps[m].doubled = &work->doubled[sim - work->pool][m];
	return sim;
}

/* Starts a task, and the tasks that share its simulation. */
static void task_start(struct work *work, int j)
{
	struct simulation *sim = idle_take(work);
	enum pound_stage stage = simulation_start(sim, &work->tasks[j], &work->results[j]);
	shared_gather(&work->shared_starts, work->tasks, work->results, j, sim);
	common_join(&work->common, sim);
	send(work, sim, stage);
}

/* Resumes waiting simulations and starts tasks while there is room: first the tasks whose laws have one branch, as batches of
 * only these need fewer checks. */
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

/* Prepares the work space; no task is started yet. */
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
