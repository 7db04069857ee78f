/* compute.c - blocks, then reductions, for as long as the design grows.
 *
 * 1. Threads of this process and the coordinator's worker groups take blocks in any order.
 * 2. The threads of this process make the reductions.
 * 3. The calling thread draws the progress bar and checks for Ctrl-C. */
#include "client/compute.h"

#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>
#include <time.h>

#include "client/command.h"
#include "client/progress_bar.h"
#include "schema/message/assignment.h"
#include "schema/message/coordinator.h"
#include "schema/study/study_json.h"

enum {
	REDRAW_MS = 100,
	SYNC_EVERY = 10,    /* redraws between two syncs of the checkpoint */
	LATE_LOOK_MS = 500, /* between two checks for assigned blocks that are late */
};

struct pool {
	struct compute *of;
	struct pound_run *run;
	struct checkpoint *checkpoint;
	struct coordinator *coordinator;
	struct coordinator_study study;
	pthread_mutex_t lock; /* protects the members below */
	pthread_cond_t changed;
	struct assignment blocks;
	int n_blocks, n_done;     /* blocks of the present design, finished blocks among them */
	int next, n_reductions;   /* next reduction, number of reductions ... */
	bool reducing;            /* ... true: threads run reductions, false: blocks */
	int64_t runs_done;        /* pounding runs in the finished blocks */
	enum pound_status status; /* first status other than POUND_OK */
	sem_t finished;           /* posted by each thread at its end */
};

struct member {
	pthread_t thread;
	struct pool *pool;
	int worker;
};

static double seconds(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Records the end of a block.  The caller holds the lock. */
static void block_end(struct pool *pool, int block, enum pound_status status)
{
	if (status == POUND_OK) {
		pool->n_done++;
		pool->runs_done += pound_run_block_runs(pool->run, block);
	} else if (pool->status == POUND_OK)
		pool->status = status;
	pthread_cond_broadcast(&pool->changed);
}

/* Takes the next block for a thread (ASSIGNMENT_HERE) or a worker group, -1: none at present.  The caller holds the lock. */
static int block_take(struct pool *pool, int taker)
{
	const double now = seconds();
	int block = assignment_next(&pool->blocks, pool->n_blocks, taker, now);
	if (block >= 0)
		assignment_take(&pool->blocks, block, taker, now);
	return block;
}

/* Returns the next block or reduction for a thread, waiting for it; -1: the phase has ended.  The caller holds the lock. */
static int step_take(struct pool *pool)
{
	if (pool->status != POUND_OK)
		return -1;
	if (pool->reducing)
		return pool->next < pool->n_reductions ? pool->next++ : -1;
	while (pool->n_done < pool->n_blocks && pool->status == POUND_OK) {
		int block = block_take(pool, ASSIGNMENT_HERE);
		if (block >= 0)
			return block;
		struct timespec until;
		clock_gettime(CLOCK_MONOTONIC, &until);
		until.tv_nsec += LATE_LOOK_MS * 1000000L;
		until.tv_sec += until.tv_nsec / 1000000000L;
		until.tv_nsec %= 1000000000L;
		pthread_cond_clockwait(&pool->changed, &pool->lock, CLOCK_MONOTONIC, &until);
	}
	return -1;
}

static void *member_work(void *of)
{
	struct member *member = of;
	struct pool *pool = member->pool;
	pthread_mutex_lock(&pool->lock);
	for (int i; (i = step_take(pool)) >= 0;) {
		const bool reducing = pool->reducing;
		pthread_mutex_unlock(&pool->lock);
		enum pound_status status = reducing ? pound_run_reduce(pool->run, i, member->worker)
		                                    : pound_run_block(pool->run, i, member->worker);
		if (!reducing && status == POUND_OK)
			checkpoint_add(pool->checkpoint, i, pound_run_block_values(pool->run, i));
		pthread_mutex_lock(&pool->lock);
		if (!reducing && status == POUND_OK)
			assignment_done(&pool->blocks, i, ASSIGNMENT_HERE, seconds());
		if (!reducing || status != POUND_OK)
			block_end(pool, i, status);
	}
	pthread_mutex_unlock(&pool->lock);
	sem_post(&pool->finished);
	return NULL;
}

/* ---- callbacks of the coordinator ---- */

static bool remote_wanted(void *of)
{
	struct pool *pool = of;
	pthread_mutex_lock(&pool->lock);
	bool wanted = !pool->reducing && pool->status == POUND_OK && pool->n_done < pool->n_blocks;
	pthread_mutex_unlock(&pool->lock);
	return wanted;
}

static bool remote_lives(void *of, uint64_t study)
{
	struct pool *pool = of;
	(void)study;
	pthread_mutex_lock(&pool->lock);
	bool lives = pool->status == POUND_OK;
	pthread_mutex_unlock(&pool->lock);
	return lives;
}

static bool remote_take(void *of, int group, const uint64_t refused[], int n_refused,
                        struct coordinator_block *block)
{
	struct pool *pool = of;
	(void)refused;
	if (n_refused)
		return false;
	pthread_mutex_lock(&pool->lock);
	block->number = pool->reducing || pool->status != POUND_OK ? -1 : block_take(pool, group);
	pthread_mutex_unlock(&pool->lock);
	block->study = &pool->study;
	return block->number >= 0;
}

static void remote_back(void *of, int group, const struct coordinator_block *block)
{
	struct pool *pool = of;
	pthread_mutex_lock(&pool->lock);
	assignment_back(&pool->blocks, block->number, group);
	pthread_cond_broadcast(&pool->changed);
	pthread_mutex_unlock(&pool->lock);
}

static void remote_done(void *of, int group, const struct coordinator_block *block, const struct message *m,
                        const double *values)
{
	struct pool *pool = of;
	const enum pound_status status = (enum pound_status)m->status;
	pthread_mutex_lock(&pool->lock);
	pool->of->elsewhere_s += m->cpu_s;
	if (status != POUND_OK) {
		assignment_back(&pool->blocks, block->number, group);
		block_end(pool, block->number, status);
	} else if (assignment_done(&pool->blocks, block->number, group, seconds())) {
		pound_run_block_restore(pool->run, block->number, values);
		checkpoint_add(pool->checkpoint, block->number, values);
		block_end(pool, block->number, POUND_OK);
	}
	pthread_mutex_unlock(&pool->lock);
}

static void remote_log(const char *line)
{
	bar_clear();
	command_complain("%s", line);
}

static bool remote_start(struct pool *pool)
{
	const struct compute *of = pool->of;
	const struct coordinator_source source = {.of = pool,
	                                          .wanted = remote_wanted,
	                                          .take = remote_take,
	                                          .back = remote_back,
	                                          .done = remote_done,
	                                          .lives = remote_lives,
	                                          .log = remote_log};
	pool->study = (struct coordinator_study){1, of->study, of->run, of->document, of->length};
	if (!of->launch->command && !of->launch->at)
		return true;
	if (!message_movable(of->study)) {
		remote_log(
		    "no workers are started: results or times of this study depend on the processor, so all blocks "
		    "run in this process");
		return true;
	}
	pool->coordinator = coordinator_start(of->launch, &source);
	return pool->coordinator;
}

/* ---- phases: blocks, reductions, growth of the design ---- */

/* Waits until n threads have ended; meanwhile draws the progress bar, syncs the checkpoint and checks for Ctrl-C. */
static void watch(struct pool *pool, int n, double start)
{
	const double total = (double)study_runs(pool->of->study);
	for (int redraws = 1; n > 0; redraws++) {
		struct timespec until;
		clock_gettime(CLOCK_REALTIME, &until);
		until.tv_nsec += REDRAW_MS * 1000000L;
		until.tv_sec += until.tv_nsec / 1000000000L;
		until.tv_nsec %= 1000000000L;
		if (sem_timedwait(&pool->finished, &until) == 0)
			n--;
		pthread_mutex_lock(&pool->lock);
		if (*pool->of->interrupted && pool->status == POUND_OK) {
			pool->status = POUND_STOPPED;
			pthread_cond_broadcast(&pool->changed);
		}
		const bool stop = pool->status != POUND_OK;
		const double done = (double)pool->runs_done;
		pthread_mutex_unlock(&pool->lock);
		if (stop)
			pound_run_stop(pool->run);
		if (redraws % SYNC_EVERY == 0)
			checkpoint_sync(pool->checkpoint);
		double spent = seconds() - start;
		bar_draw(done, total, done > 0.0 ? spent * (total - done) / done : -1.0);
	}
}

/* Runs the remaining blocks, or all reductions, in n threads. */
static void pool_run(struct pool *pool, struct member *members, int n, double start)
{
	int started = 0;
	coordinator_wake(pool->coordinator);
	for (; started < n; started++) {
		members[started] = (struct member){.pool = pool, .worker = started};
		if (pthread_create(&members[started].thread, NULL, member_work, &members[started]) != 0)
			break;
	}
	if (started == 0)
		pool->status = POUND_NOMEM;
	watch(pool, started, start);
	for (int i = 0; i < started; i++)
		pthread_join(members[i].thread, NULL);
}

static void restored(void *to, int block)
{
	struct pool *pool = to;
	assignment_restore(&pool->blocks, block);
}

/* The number of finished blocks among the first n. */
static int done_of(const struct pool *pool, int n)
{
	int done = 0;
	for (int block = 0; block < n; block++)
		done += assignment_is_done(&pool->blocks, block);
	return done;
}

/* Computes a run.
 *
 * Status   POUND_STOPPED   interrupted, or the checkpoint cannot be used
 * Test     client_worker: every_example_gives_the_same_bytes_with_any_number_of_groups
 */
enum pound_status compute_run(struct compute *of)
{
	const double start = seconds();
	struct pool pool = {
	    .of = of, .run = of->run, .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
	struct member *members = calloc((size_t)of->n_threads, sizeof *members);
	if (!members || !assignment_init(&pool.blocks, pound_run_blocks_most(of->run))) {
		free(members);
		return POUND_NOMEM;
	}
	if (of->checkpoint)
		pool.checkpoint = checkpoint_open(of->checkpoint, of->study, of->run, restored, &pool);
	of->refused = of->checkpoint && !pool.checkpoint;
	pool.reducing = true; // no blocks may be taken yet
	if (of->refused)
		pool.status = POUND_STOPPED;
	else if (!remote_start(&pool))
		pool.status = POUND_NOMEM;
	sem_init(&pool.finished, 0, 0);
	while (pool.status == POUND_OK) {
		pthread_mutex_lock(&pool.lock);
		pool.reducing = false;
		pool.n_blocks = pound_run_blocks(of->run);
		pool.n_done = done_of(&pool, pool.n_blocks);
		pool.runs_done = 0;
		for (int block = 0; block < pool.n_blocks; block++)
			pool.runs_done +=
			    assignment_is_done(&pool.blocks, block) ? pound_run_block_runs(of->run, block) : 0;
		pthread_mutex_unlock(&pool.lock);
		pool_run(&pool, members, of->n_threads, start);
		if (pool.status != POUND_OK)
			break;
		pthread_mutex_lock(&pool.lock);
		pool.reducing = true;
		pool.next = 0;
		pool.n_reductions = pound_run_reductions(of->run);
		pthread_mutex_unlock(&pool.lock);
		pool_run(&pool, members, of->n_threads, start);
		if (pool.status != POUND_OK || !pound_run_grow(of->run))
			break;
	}
	bar_clear();
	if (pool.coordinator && pool.status == POUND_OK)
		command_complain("worker groups ran %ld of %d blocks", coordinator_blocks(pool.coordinator),
		                 pool.n_blocks);
	coordinator_stop(pool.coordinator);
	checkpoint_close(pool.checkpoint);
	sem_destroy(&pool.finished);
	assignment_free(&pool.blocks);
	free(members);
	return pool.status;
}
