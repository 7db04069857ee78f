/* compute.c - blocks, then reductions, for as long as the design grows.
 *
 * 1. Threads of this process and the coordinator's worker groups take blocks in any order.
 * 2. The threads of this process make the reductions.
 * 3. The calling thread draws the progress bar and looks for Ctrl-C. */
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
	LATE_LOOK_MS = 500, /* between two looks whether a block that is out is late */
};

struct crew {
	struct compute *of;
	struct pound_run *run;
	struct checkpoint *checkpoint;
	struct coordinator *coordinator;
	struct coordinator_study study;
	pthread_mutex_t lock; /* of what follows */
	pthread_cond_t changed;
	struct assignment blocks;
	int n_blocks, n_done;     /* to run now, done of them */
	int next, n_reductions;   /* reduction to take, ... */
	bool reducing;            /* ... instead of blocks */
	int64_t runs_done;        /* pounding runs in the finished blocks */
	enum pound_status status; /* first one that is not POUND_OK */
	sem_t finished;           /* posted by each thread at its end */
};

struct member {
	pthread_t thread;
	struct crew *crew;
	int worker;
};

static double seconds(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Under the lock. */
static void block_end(struct crew *crew, int block, enum pound_status status)
{
	if (status == POUND_OK) {
		crew->n_done++;
		crew->runs_done += pound_run_block_runs(crew->run, block);
	} else if (crew->status == POUND_OK)
		crew->status = status;
	pthread_cond_broadcast(&crew->changed);
}

/* Takes the next block for a thread (ASSIGNMENT_HERE) or a worker group, -1: there is none now.  Under the lock. */
static int block_take(struct crew *crew, int taker)
{
	const double now = seconds();
	int block = assignment_next(&crew->blocks, crew->n_blocks, taker, now);
	if (block >= 0)
		assignment_take(&crew->blocks, block, taker, now);
	return block;
}

/* The next step of a thread, -1: there will be none.  Under the lock. */
static int step_take(struct crew *crew)
{
	if (crew->status != POUND_OK)
		return -1;
	if (crew->reducing)
		return crew->next < crew->n_reductions ? crew->next++ : -1;
	while (crew->n_done < crew->n_blocks && crew->status == POUND_OK) {
		int block = block_take(crew, ASSIGNMENT_HERE);
		if (block >= 0)
			return block;
		struct timespec until;
		clock_gettime(CLOCK_MONOTONIC, &until);
		until.tv_nsec += LATE_LOOK_MS * 1000000L;
		until.tv_sec += until.tv_nsec / 1000000000L;
		until.tv_nsec %= 1000000000L;
		pthread_cond_clockwait(&crew->changed, &crew->lock, CLOCK_MONOTONIC, &until);
	}
	return -1;
}

static void *member_work(void *of)
{
	struct member *member = of;
	struct crew *crew = member->crew;
	pthread_mutex_lock(&crew->lock);
	for (int i; (i = step_take(crew)) >= 0;) {
		const bool reducing = crew->reducing;
		pthread_mutex_unlock(&crew->lock);
		enum pound_status status = reducing ? pound_run_reduce(crew->run, i, member->worker)
		                                    : pound_run_block(crew->run, i, member->worker);
		if (!reducing && status == POUND_OK)
			checkpoint_add(crew->checkpoint, i, pound_run_block_values(crew->run, i));
		pthread_mutex_lock(&crew->lock);
		if (!reducing && status == POUND_OK)
			assignment_done(&crew->blocks, i, ASSIGNMENT_HERE, seconds());
		if (!reducing || status != POUND_OK)
			block_end(crew, i, status);
	}
	pthread_mutex_unlock(&crew->lock);
	sem_post(&crew->finished);
	return NULL;
}

/* ---- what the coordinator asks ---- */

static bool remote_wanted(void *of)
{
	struct crew *crew = of;
	pthread_mutex_lock(&crew->lock);
	bool wanted = !crew->reducing && crew->status == POUND_OK && crew->n_done < crew->n_blocks;
	pthread_mutex_unlock(&crew->lock);
	return wanted;
}

static bool remote_lives(void *of, uint64_t study)
{
	struct crew *crew = of;
	(void)study;
	pthread_mutex_lock(&crew->lock);
	bool lives = crew->status == POUND_OK;
	pthread_mutex_unlock(&crew->lock);
	return lives;
}

static bool remote_take(void *of, int group, const uint64_t refused[], int n_refused,
                        struct coordinator_block *block)
{
	struct crew *crew = of;
	(void)refused;
	if (n_refused)
		return false;
	pthread_mutex_lock(&crew->lock);
	block->number = crew->reducing || crew->status != POUND_OK ? -1 : block_take(crew, group);
	pthread_mutex_unlock(&crew->lock);
	block->study = &crew->study;
	return block->number >= 0;
}

static void remote_back(void *of, int group, const struct coordinator_block *block)
{
	struct crew *crew = of;
	pthread_mutex_lock(&crew->lock);
	assignment_back(&crew->blocks, block->number, group);
	pthread_cond_broadcast(&crew->changed);
	pthread_mutex_unlock(&crew->lock);
}

static void remote_done(void *of, int group, const struct coordinator_block *block, const struct message *m,
                        const double *values)
{
	struct crew *crew = of;
	const enum pound_status status = (enum pound_status)m->status;
	pthread_mutex_lock(&crew->lock);
	crew->of->elsewhere_s += m->cpu_s;
	if (status != POUND_OK) {
		assignment_back(&crew->blocks, block->number, group);
		block_end(crew, block->number, status);
	} else if (assignment_done(&crew->blocks, block->number, group, seconds())) {
		pound_run_block_restore(crew->run, block->number, values);
		checkpoint_add(crew->checkpoint, block->number, values);
		block_end(crew, block->number, POUND_OK);
	}
	pthread_mutex_unlock(&crew->lock);
}

static void remote_log(const char *line)
{
	bar_clear();
	command_complain("%s", line);
}

static bool remote_start(struct crew *crew)
{
	const struct compute *of = crew->of;
	const struct coordinator_source source = {.of = crew,
	                                          .wanted = remote_wanted,
	                                          .take = remote_take,
	                                          .back = remote_back,
	                                          .done = remote_done,
	                                          .lives = remote_lives,
	                                          .log = remote_log};
	crew->study = (struct coordinator_study){1, of->study, of->run, of->document, of->length};
	if (!of->launch->command)
		return true;
	if (!message_movable(of->study)) {
		remote_log(
		    "no workers are started: results or times of this study depend on the processor, so all blocks "
		    "run in this process");
		return true;
	}
	crew->coordinator = coordinator_start(of->launch, &source);
	return crew->coordinator;
}

/* ---- one phase after the other ---- */

/* Watches n threads until all have ended. */
static void watch(struct crew *crew, int n, double start)
{
	const double total = (double)study_runs(crew->of->study);
	for (int redraws = 1; n > 0; redraws++) {
		struct timespec until;
		clock_gettime(CLOCK_REALTIME, &until);
		until.tv_nsec += REDRAW_MS * 1000000L;
		until.tv_sec += until.tv_nsec / 1000000000L;
		until.tv_nsec %= 1000000000L;
		if (sem_timedwait(&crew->finished, &until) == 0)
			n--;
		pthread_mutex_lock(&crew->lock);
		if (*crew->of->interrupted && crew->status == POUND_OK) {
			crew->status = POUND_STOPPED;
			pthread_cond_broadcast(&crew->changed);
		}
		const bool stop = crew->status != POUND_OK;
		const double done = (double)crew->runs_done;
		pthread_mutex_unlock(&crew->lock);
		if (stop)
			pound_run_stop(crew->run);
		if (redraws % SYNC_EVERY == 0)
			checkpoint_sync(crew->checkpoint);
		double spent = seconds() - start;
		bar_draw(done, total, done > 0.0 ? spent * (total - done) / done : -1.0);
	}
}

/* Runs the blocks that are left, or all reductions, in n threads. */
static void crew_run(struct crew *crew, struct member *members, int n, double start)
{
	int started = 0;
	coordinator_wake(crew->coordinator);
	for (; started < n; started++) {
		members[started] = (struct member){.crew = crew, .worker = started};
		if (pthread_create(&members[started].thread, NULL, member_work, &members[started]) != 0)
			break;
	}
	if (started == 0)
		crew->status = POUND_NOMEM;
	watch(crew, started, start);
	for (int i = 0; i < started; i++)
		pthread_join(members[i].thread, NULL);
}

static void restored(void *to, int block)
{
	struct crew *crew = to;
	assignment_restore(&crew->blocks, block);
}

/* Blocks that are done of the first n. */
static int done_of(const struct crew *crew, int n)
{
	int done = 0;
	for (int block = 0; block < n; block++)
		done += assignment_is_done(&crew->blocks, block);
	return done;
}

/* Computes a run.
 *
 * Status   POUND_STOPPED   interrupted, or the checkpoint is refused
 * Test     client_worker: every_example_gives_the_same_bytes_with_any_number_of_groups
 */
enum pound_status compute_run(struct compute *of)
{
	const double start = seconds();
	struct crew crew = {
	    .of = of, .run = of->run, .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
	struct member *members = calloc((size_t)of->n_threads, sizeof *members);
	if (!members || !assignment_init(&crew.blocks, pound_run_blocks_most(of->run))) {
		free(members);
		return POUND_NOMEM;
	}
	if (of->checkpoint)
		crew.checkpoint = checkpoint_open(of->checkpoint, of->study, of->run, restored, &crew);
	of->refused = of->checkpoint && !crew.checkpoint;
	crew.reducing = true; // nothing is taken yet
	if (of->refused)
		crew.status = POUND_STOPPED;
	else if (!remote_start(&crew))
		crew.status = POUND_NOMEM;
	sem_init(&crew.finished, 0, 0);
	while (crew.status == POUND_OK) {
		pthread_mutex_lock(&crew.lock);
		crew.reducing = false;
		crew.n_blocks = pound_run_blocks(of->run);
		crew.n_done = done_of(&crew, crew.n_blocks);
		crew.runs_done = 0;
		for (int block = 0; block < crew.n_blocks; block++)
			crew.runs_done +=
			    assignment_is_done(&crew.blocks, block) ? pound_run_block_runs(of->run, block) : 0;
		pthread_mutex_unlock(&crew.lock);
		crew_run(&crew, members, of->n_threads, start);
		if (crew.status != POUND_OK)
			break;
		pthread_mutex_lock(&crew.lock);
		crew.reducing = true;
		crew.next = 0;
		crew.n_reductions = pound_run_reductions(of->run);
		pthread_mutex_unlock(&crew.lock);
		crew_run(&crew, members, of->n_threads, start);
		if (crew.status != POUND_OK || !pound_run_grow(of->run))
			break;
	}
	bar_clear();
	if (crew.coordinator && crew.status == POUND_OK)
		command_complain("worker groups ran %ld of %d blocks", coordinator_blocks(crew.coordinator),
		                 crew.n_blocks);
	coordinator_stop(crew.coordinator);
	checkpoint_close(crew.checkpoint);
	sem_destroy(&crew.finished);
	assignment_free(&crew.blocks);
	free(members);
	return crew.status;
}
