/* Worker threads and the studies they run.
 *
 *   worker 0  | claim | open | block 0 | block 2 | block 3      | reduce 0 | finish |
 *   worker 1  | wait         | block 1 | block 4 | block 5 | ...| reduce 1 | claim the next study ...
 *   committer                          | commit 0 1   | commit 4 2 5 3 |
 *
 * 1. While fewer than OPEN_MAX studies are open, a worker claims a queued one: the oldest of the tokens other than the one
 *    with the most open studies, else the oldest.
 * 2. A worker takes the next step of one of the open studies: a block, or when all blocks are stored a reduction.  It
 *    chooses the token with the least CPU time, summed over its open studies, and of this token the study with the least
 *    CPU time.  So short studies end soon even if queued after long ones.
 * 3. The committer thread commits all waiting finished blocks in one transaction; a block counts after its commit.
 * 4. The worker that ends the last reduction asks whether the design grows; if so, more blocks and reductions follow.
 * 5. The worker that ends the last step of a study serializes and stores its result.
 * 6. With --launcher or --worker-listen, worker groups in other processes take blocks by the same rule (groups.inl); their
 *    values go to the committer like the values of workers.
 * 7. The watch thread ends a study that runs for longer than the limit.
 *
 * The store decides about cancelling and deleting; here they only save time: for a study that is not running, the store
 * accepts no more blocks and no result. */
#include "server/workers.h"
#include "server/stored_run.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "schema/message/assignment.h"
#include "schema/message/coordinator.h"
#include "schema/result/result_json.h"
#include "schema/study/study_status.h"
#include "server/log.h"

enum {
	WORKER_NICENESS = 10, /* requests are answered first */
	PATIENCE = 1,         /* [s] between two attempts to get memory or to store something */
	MEMORY_TRIES = 30,    /* before a study fails for lack of memory */
	OPEN_MAX = 4,         /* studies whose steps are taken in turn */
	WAITING_MAX = 256,    /* finished blocks that may wait for a commit; at this limit workers wait */
};

static const double STOP_MAX = 0.3;  /* [s] for workers to exit after the stop flag is set */
static const double LATE_LOOK = 0.5; /* [s] between two checks whether a worker group is late with a block */

struct job {
	TAILQ_ENTRY(job) others;
	int64_t id;
	char client[STORE_CLIENT_SIZE]; /* name of its token, "": none */
	bool opened;
	struct stored_run of;
	struct assignment blocks;
	bool movable;                   /* worker groups may run its blocks */
	struct coordinator_study known; /* as worker groups know it */
	int n_out;                      /* blocks assigned to worker groups */
	int n_views;                    /* of its run, which keep it in memory, but do not delay its end */
	int reduction;                  /* the next to assign */
	int n_reductions, reductions_left;
	int n_inside;                  /* workers in one of its steps, plus finished blocks not yet committed */
	bool ended;                    /* no more of its steps are taken, ... */
	atomic_bool stop;              /* ... and steps under way stop soon */
	bool finished;                 /* its end is stored, or need not be */
	const char *error;             /* why it failed, NULL if it did not */
	double cpu_s, cpu_s_estimated; /* [s] */
	bool over;                     /* the store knows that it took much longer than estimated */
	int64_t memory;                /* estimated [bytes] */
	double started;                /* [s] monotonic, less the time it ran under earlier servers */
};

/* A finished block; its values are in its run. */
struct finished {
	struct job *job;
	struct store_block block;
};

struct work {
	struct store *store;
	struct coordinator *coordinator; /* of worker groups, NULL: there are none */
	pthread_mutex_t lock;            /* of all below */
	pthread_cond_t changed;
	pthread_cond_t waits; /* wakes the committer: a block waits, or the workers have exited */
	struct finished waiting[WAITING_MAX], committing[WAITING_MAX];
	int n_waiting;
	TAILQ_HEAD(, job) jobs; /* oldest first */
	bool queued;            /* the store may hold a queued study */
	bool claiming;          /* a worker is claiming the next study */
	bool stopping;
	bool drained;        /* the workers have exited */
	double time_max;     /* limit of the time a study runs [s], ... */
	double cpu_max;      /* ... and of its estimated CPU time [s] */
	int64_t memory_left; /* of the limit for all running studies [bytes] */
	bool watched;        /* was started: ... */
	pthread_t watch;     /* ... the thread that enforces time_max */
	bool commits;        /* committer was started */
	pthread_t committer;
	uint64_t n_opened;
	int n_started;
	int n_workers;
	pthread_t workers[]; /* (n_workers) */
};

static double seconds(clockid_t clock)
{
	struct timespec now;
	clock_gettime(clock, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A time [s] as struct timespec. */
static struct timespec at(double time)
{
	const double whole = floor(time);
	return (struct timespec){.tv_sec = (time_t)whole, .tv_nsec = (long)(1e9 * (time - whole))};
}

/* Ends a study: no more steps of it are taken, steps under way stop soon. */
static void end(struct job *job, const char *error)
{
	if (!job->error && !job->ended)
		job->error = error;
	job->ended = true;
	job->stop = true;
}

/* Waits before another attempt to get memory or to store something; false: do not try again, for the study (NULL: none) or the
 * server stops. */
static bool patient(struct work *work, const struct job *job)
{
	const struct timespec until = at(seconds(CLOCK_MONOTONIC) + PATIENCE);
	pthread_mutex_lock(&work->lock);
	while (!work->stopping && !(job && job->stop) &&
	       pthread_cond_clockwait(&work->changed, &work->lock, CLOCK_MONOTONIC, &until) != ETIMEDOUT)
		;
	bool stopping = work->stopping || (job && job->stop);
	pthread_mutex_unlock(&work->lock);
	return !stopping;
}

static void finish(struct work *work, struct job *job)
{
	// a copy: job->error may be read by other threads meanwhile
	const char *error = job->error;
	size_t length = 0;
	char *result = NULL;
	if (!error) {
		struct timing timing = {.wall_s = seconds(CLOCK_MONOTONIC) - job->started,
		                        .cpu_s = job->cpu_s,
		                        .threads = work->n_workers};
		int tries = MEMORY_TRIES;
		while (!(result = result_to_json(job->of.study, pound_run_result(job->of.run), &timing, &length)) &&
		       --tries)
			if (!patient(work, job))
				return; // the next start tries again
		error = result ? NULL : "out of memory";
	}
	enum store_status status;
	do
		status = store_finish(work->store, job->id, result, length, error, job->cpu_s);
	while (status == STORE_FAILED && patient(work, job));
	if (status == STORE_OK)
		log_line("study %016llx %s", (unsigned long long)job->id, error ? error : "succeeded");
	free(result);
}

static void drop(struct work *work, struct job *job)
{
	TAILQ_REMOVE(&work->jobs, job, others);
	assignment_free(&job->blocks);
	stored_run_close(&job->of);
	work->memory_left += job->memory;
	work->queued = true; // the next study may have waited for this memory
	pthread_cond_broadcast(&work->changed);
	free(job);
}

/* Finishes a study if it is complete or ended and no worker is in it; under the lock, which is released meanwhile. */
static void finish_if_complete(struct work *work, struct job *job)
{
	if (job->n_inside || (!job->ended && (job->reductions_left || stored_run_left(&job->of))))
		return;
	if (!job->finished && (!job->ended || job->error)) {
		job->ended = true;
		job->n_inside = 1;
		pthread_mutex_unlock(&work->lock);
		finish(work, job);
		pthread_mutex_lock(&work->lock);
		job->n_inside = 0;
	}
	job->finished = true;
	// worker groups may still have a block that was also run elsewhere: have them return it
	if (job->n_out > 0)
		coordinator_wake(work->coordinator);
	else if (job->n_views == 0)
		drop(work, job);
}

/* Passes a finished block to the committer; blocks while too many wait.  Under the lock. */
static void hand_over(struct work *work, struct job *job, int block, double cpu_s)
{
	while (work->n_waiting == WAITING_MAX && !work->stopping && !job->stop)
		pthread_cond_wait(&work->changed, &work->lock);
	if (work->n_waiting == WAITING_MAX) {
		job->n_inside--;
		finish_if_complete(work, job);
		return;
	}
	work->waiting[work->n_waiting++] =
	    (struct finished){job,
	                      {.study = job->id,
	                       .number = block,
	                       .runs = pound_run_block_runs(job->of.run, block),
	                       .cpu_s = cpu_s,
	                       .wall_s = seconds(CLOCK_MONOTONIC) - job->started,
	                       .n = (int)pound_run_block_size(job->of.run, block),
	                       .values = pound_run_block_values(job->of.run, block)}};
	pthread_cond_signal(&work->waits);
}

/* Commits the waiting blocks in one transaction; the lock is released meanwhile. */
static void commit_waiting(struct work *work)
{
	struct finished *done = work->committing;
	struct store_block *blocks[WAITING_MAX];
	enum store_status status;
	const int n = work->n_waiting;
	memcpy(done, work->waiting, (size_t)n * sizeof done[0]);
	work->n_waiting = 0;
	pthread_mutex_unlock(&work->lock);
	for (int i = 0; i < n; i++)
		blocks[i] = &done[i].block;
	do
		status = store_keep(work->store, blocks, n);
	while (status == STORE_FAILED && patient(work, NULL));
	pthread_mutex_lock(&work->lock);
	for (int i = 0; i < n; i++) {
		struct job *job = done[i].job;
		job->n_inside--;
		if (status == STORE_OK && done[i].block.kept)
			job->of.stored[done[i].block.number] = true;
		else
			end(job, NULL);
		finish_if_complete(work, job);
	}
	pthread_cond_broadcast(&work->changed);
}

/* Test     service_power: a_cut_loses_no_block_of_a_commit_that_returned */
static void *commit(void *of)
{
	struct work *work = of;
	pthread_mutex_lock(&work->lock);
	while (work->n_waiting > 0 || !work->drained)
		if (work->n_waiting > 0)
			commit_waiting(work);
		else
			pthread_cond_wait(&work->waits, &work->lock);
	pthread_mutex_unlock(&work->lock);
	return NULL;
}

#include "server/crashes.inl"

struct step {
	struct job *job;
	int block, reduction; /* one of the two; the other is -1 */
};

/* The taker of a step: a thread of this process, or a worker group with the studies that it cannot run. */
struct taker {
	int number;
	const uint64_t *refused; /* (n_refused) */
	int n_refused;
};

/* Whether a taker may run blocks of a study. */
static bool suits(const struct job *job, const struct taker *taker)
{
	bool may = job->movable || taker->number == ASSIGNMENT_HERE;
	for (int i = 0; i < taker->n_refused; i++)
		may = may && taker->refused[i] != job->known.id;
	return may;
}

/* The next step of a study, without taking it; false: it has none now. */
static bool next_step(struct job *job, const struct taker *taker, struct step *step)
{
	if (!job->opened || job->ended || !suits(job, taker))
		return false;
	const int block =
	    assignment_next(&job->blocks, pound_run_blocks(job->of.run), taker->number, seconds(CLOCK_MONOTONIC));
	if (block >= 0)
		*step = (struct step){job, block, -1};
	else if (taker->number == ASSIGNMENT_HERE && job->reduction < job->n_reductions &&
	         !stored_run_left(&job->of))
		*step = (struct step){job, -1, job->reduction};
	else
		return false;
	return true;
}

/* CPU time of all open studies with the same token as a study [s]. */
static double client_cpu(const struct work *work, const struct job *job)
{
	double sum = 0;
	const struct job *other;
	TAILQ_FOREACH(other, &work->jobs, others)
	if (!strcmp(other->client, job->client))
		sum += other->cpu_s;
	return sum;
}

/* Takes the next step, of the study that rule 2 chooses.
 *
 * Test     service_queue: short_studies_end_soon_behind_a_long_one
 */
static bool take(struct work *work, const struct taker *taker, struct step *step)
{
	double client_least = INFINITY, least = INFINITY;
	struct step next;
	struct job *job;
	TAILQ_FOREACH(job, &work->jobs, others)
	{
		if (!next_step(job, taker, &next))
			continue;
		double of_client = client_cpu(work, job);
		if (of_client > client_least || (of_client == client_least && job->cpu_s >= least))
			continue;
		client_least = of_client;
		least = job->cpu_s;
		*step = next;
	}
	if (least == INFINITY)
		return false;
	if (step->block >= 0)
		assignment_take(&step->job->blocks, step->block, taker->number, seconds(CLOCK_MONOTONIC));
	else
		step->job->reduction++;
	*(taker->number == ASSIGNMENT_HERE ? &step->job->n_inside : &step->job->n_out) += 1;
	return true;
}

/* Stores the CPU time of a study that takes much longer than estimated: committed blocks update it, reductions do not.  Ends a study
 * that takes much longer than the limit.  Under the lock, which is released meanwhile.
 *
 * Test     service_queue: a_study_that_takes_far_more_than_the_cpu_limit_has_failed
 */
static void note_over(struct work *work, struct job *job)
{
	if (study_status_over(job->cpu_s, work->cpu_max))
		end(job, "cpu-limit: it took three times the CPU time of the server's --cpu-max");
	if (job->over || !study_status_over(job->cpu_s, job->cpu_s_estimated))
		return;
	job->over = true;
	const double cpu_s = job->cpu_s;
	pthread_mutex_unlock(&work->lock);
	store_spent(work->store, job->id, cpu_s);
	pthread_mutex_lock(&work->lock);
}

/* Runs a step; the lock is released meanwhile. */
static void perform(struct work *work, const struct step *step, int worker)
{
	struct job *job = step->job;
	study_here = job->id;
	double cpu_s = stored_run_clock();
	pthread_mutex_unlock(&work->lock);
	enum pound_status status;
	int tries = MEMORY_TRIES;
	do
		status = step->block >= 0 ? pound_run_block(job->of.run, step->block, worker)
		                          : pound_run_reduce(job->of.run, step->reduction, worker);
	while (status == POUND_NOMEM && --tries && patient(work, job));
	cpu_s = stored_run_clock() - cpu_s;
	pthread_mutex_lock(&work->lock);
	job->cpu_s += cpu_s;
	note_over(work, job);
	if (status == POUND_OK && step->block >= 0) {
		assignment_done(&job->blocks, step->block, ASSIGNMENT_HERE, seconds(CLOCK_MONOTONIC));
		hand_over(work, job, step->block, cpu_s);
	} else {
		job->n_inside--;
		if (status != POUND_OK)
			end(job, pound_status_error(status));
		else if (--job->reductions_left == 0 && pound_run_grow(job->of.run)) {
			job->reduction = 0;
			job->reductions_left = job->n_reductions;
			coordinator_wake(work->coordinator);
		}
		finish_if_complete(work, job);
	}
	study_here = 0;
	pthread_cond_broadcast(&work->changed);
}

/* Opens the run of a claimed study, waiting for memory or the disk; the lock is released meanwhile. */
static void open_run(struct work *work, struct job *job)
{
	struct stored_run opened;
	const char *error;
	int tries = MEMORY_TRIES;
	pthread_mutex_unlock(&work->lock);
	study_here = job->id;
	while ((error = stored_run_open(work->store, job->id, work->n_workers, &job->stop, &opened)) &&
	       opened.passing && --tries && patient(work, job))
		stored_run_close(&opened);
	if (!error && !assignment_init(&job->blocks, pound_run_blocks_most(opened.run)))
		error = "out of memory";
	for (int block = 0; !error && block < job->blocks.n; block++)
		if (opened.stored[block])
			assignment_restore(&job->blocks, block);
	// unusable blocks would count as done; if deleting them fails they do, until they are run again
	if (!error && opened.leftovers)
		store_prune(work->store, job->id);
	pthread_mutex_lock(&work->lock);
	job->of = opened;
	job->opened = !error;
	job->cpu_s = opened.cpu_s;
	job->started = seconds(CLOCK_MONOTONIC) - opened.wall_s;
	if (error)
		end(job, opened.passing && work->stopping ? NULL : error); // the next start tries again
	else {
		job->n_reductions = job->reductions_left = pound_run_reductions(opened.run);
		job->movable = message_movable(opened.study);
		job->known = (struct coordinator_study){++work->n_opened, opened.study, opened.run, opened.document,
		                                        opened.length};
		coordinator_wake(work->coordinator);
	}
}

/* Whether one more study may be open. */
static bool has_place(const struct work *work)
{
	int n = 0;
	const struct job *job;
	TAILQ_FOREACH(job, &work->jobs, others)
	n += !job->ended;
	return n < OPEN_MAX;
}

/* The token with the most open studies; "": there are none. */
static const char *busiest(const struct work *work)
{
	const char *client = "";
	int most = 0;
	const struct job *job, *other;
	TAILQ_FOREACH(job, &work->jobs, others)
	{
		int n = 0;
		TAILQ_FOREACH(other, &work->jobs, others)
		n += !strcmp(other->client, job->client);
		if (n > most) {
			most = n;
			client = job->client;
		}
	}
	return client;
}

/* Claims and opens a queued study; the lock is released meanwhile. */
static void claim(struct work *work)
{
	struct job *job = calloc(1, sizeof *job);
	char avoided[STORE_CLIENT_SIZE];
	snprintf(avoided, sizeof avoided, "%s", busiest(work));
	work->claiming = true;
	// before the query, so that a study queued during it is not missed
	work->queued = false;
	// a study that needs more than the limit was accepted under another limit, and runs alone
	const int64_t memory = TAILQ_EMPTY(&work->jobs) ? INT64_MAX : work->memory_left;
	struct store_claimed claimed = {0};
	pthread_mutex_unlock(&work->lock);
	enum store_status status = job ? store_claim(work->store, memory, avoided, &claimed) : STORE_FAILED;
	bool again = status == STORE_FAILED && (!job || patient(work, job));
	pthread_mutex_lock(&work->lock);
	work->queued = work->queued || again || status == STORE_OK;
	if (status == STORE_OK) {
		job->id = claimed.id;
		job->cpu_s_estimated = claimed.cpu_s;
		job->memory = claimed.memory;
		strcpy(job->client, claimed.client);
		job->n_inside = 1;
		work->memory_left -= job->memory;
		TAILQ_INSERT_TAIL(&work->jobs, job, others);
		open_run(work, job);
		job->n_inside = 0;
		finish_if_complete(work, job);
		study_here = 0;
	} else
		free(job);
	work->claiming = false;
	pthread_cond_broadcast(&work->changed);
}

/* Waits for a change; with a timeout if there are worker groups, because a late block is not signalled. */
static void wait_changed(struct work *work)
{
	const struct timespec until = at(seconds(CLOCK_MONOTONIC) + LATE_LOOK);
	if (work->coordinator)
		pthread_cond_clockwait(&work->changed, &work->lock, CLOCK_MONOTONIC, &until);
	else
		pthread_cond_wait(&work->changed, &work->lock);
}

static void *worker(void *of)
{
	struct work *work = of;
	const struct taker here = {.number = ASSIGNMENT_HERE};
	struct step step = {0};
	setpriority(PRIO_PROCESS, (id_t)gettid(), WORKER_NICENESS);
	pthread_mutex_lock(&work->lock);
	int number = work->n_started++;
	while (!work->stopping) {
		if (work->queued && !work->claiming && has_place(work))
			claim(work);
		else if (take(work, &here, &step))
			perform(work, &step, number);
		else
			wait_changed(work);
	}
	pthread_mutex_unlock(&work->lock);
	return NULL;
}

#include "server/groups.inl"
#include "server/views.inl"

/* Ends the studies that have reached the time limit; under the lock.
 *
 * Returns  value   when the next study will reach it [s] monotonic
 */
static double end_late(struct work *work)
{
	double now = seconds(CLOCK_MONOTONIC), next = now + work->time_max;
	for (struct job *job = TAILQ_FIRST(&work->jobs); job;) {
		double until = job->started + work->time_max;
		bool runs = job->opened && !job->ended, late = runs && until <= now;
		if (runs && !late)
			next = fmin(next, until);
		if (late)
			end(job, "timeout: it ran for longer than the server's --time-max");
		// finish_if_complete releases the lock, so the list may have changed
		if (late && job->n_inside == 0) {
			finish_if_complete(work, job);
			job = TAILQ_FIRST(&work->jobs);
		} else
			job = TAILQ_NEXT(job, others);
	}
	return next;
}

/* In a thread of its own, because all workers may be in steps that do not end.
 *
 * Test     service_queue: a_study_that_runs_for_too_long_has_failed
 */
static void *watch(void *of)
{
	struct work *work = of;
	pthread_mutex_lock(&work->lock);
	while (!work->stopping) {
		const struct timespec until = at(end_late(work));
		pthread_cond_clockwait(&work->changed, &work->lock, CLOCK_MONOTONIC, &until);
	}
	pthread_mutex_unlock(&work->lock);
	return NULL;
}

/* Starts the workers, which run the studies queued in the store.
 *
 * Given    n_workers   >= 1
 *          time_max    limit of the time a study runs [s]
 *          cpu_max     limit of its estimated CPU time [s]; a study that takes three times as much fails
 *          memory_max  limit of the estimated memory of all running studies together [bytes]
 *          launch      of worker groups
 * Returns  value       for work_stop; NULL: no memory, or no threads
 */
struct work *work_start(struct store *store, int n_workers, double time_max, double cpu_max,
                        int64_t memory_max, const struct launch *launch)
{
	struct work *work = calloc(1, sizeof *work + (size_t)n_workers * sizeof work->workers[0]);
	if (!work) {
		log_line("cannot start %d workers: out of memory", n_workers);
		return NULL;
	}
	watch_crashes(store);
	work->store = store;
	work->time_max = time_max;
	work->cpu_max = cpu_max;
	work->memory_left = memory_max;
	work->n_workers = n_workers;
	work->queued = true;
	TAILQ_INIT(&work->jobs);
	pthread_mutex_init(&work->lock, NULL);
	pthread_cond_init(&work->changed, NULL);
	pthread_cond_init(&work->waits, NULL);
	work->watched = pthread_create(&work->watch, NULL, watch, work) == 0;
	work->commits = pthread_create(&work->committer, NULL, commit, work) == 0;
	work->coordinator = launch->command || launch->at ? groups_start(work, launch) : NULL;
	int started = 0;
	const bool groups = work->coordinator || !(launch->command || launch->at);
	while (groups && work->watched && work->commits && started < n_workers &&
	       pthread_create(&work->workers[started], NULL, worker, work) == 0)
		started++;
	if (started == n_workers)
		return work;
	log_line("cannot start more than %d of %d workers: the system gives no more threads", started, n_workers);
	work->n_workers = started;
	work_stop(work, true);
	return NULL;
}

/* Notifies the workers that the store has a queued study. */
void work_wake(struct work *work)
{
	pthread_mutex_lock(&work->lock);
	work->queued = true;
	pthread_cond_broadcast(&work->changed);
	pthread_mutex_unlock(&work->lock);
}

/* Stops the run of a study that was cancelled or deleted in the store.
 *
 * Given    id   of the study, running or not
 * Test     service_queue: a_study_can_be_cancelled_at_any_moment
 */
void work_drop(struct work *work, int64_t id)
{
	pthread_mutex_lock(&work->lock);
	struct job *job;
	TAILQ_FOREACH(job, &work->jobs, others)
	if (job->id == id) {
		end(job, NULL);
		finish_if_complete(work, job);
		coordinator_wake(work->coordinator);
		pthread_cond_broadcast(&work->changed);
		break;
	}
	pthread_mutex_unlock(&work->lock);
}

/* Stops the workers; studies that were running continue at the next start.
 *
 * Given    alone   no thread of another part can use work any more, so that it may be freed
 * Returns  value   false: a worker is in an operation that cannot be interrupted, such as a write to a slow disk, so work
 *                  and its store must not be freed before the program exits
 * Test     service_stop: it_ends_soon_whatever_runs_and_so_does_a_cancelled_study
 */
bool work_stop(struct work *work, bool alone)
{
	pthread_mutex_lock(&work->lock);
	work->stopping = true;
	struct job *job;
	TAILQ_FOREACH(job, &work->jobs, others)
	end(job, NULL);
	pthread_cond_broadcast(&work->changed);
	pthread_mutex_unlock(&work->lock);
	groups_stop(work);
	// CLOCK_REALTIME, because thread sanitizers support no other timed join; if it is set back, the alarm ends the wait
	const struct timespec until = at(seconds(CLOCK_REALTIME) + STOP_MAX);
	for (int w = 0; w < work->n_workers; w++)
		if (pthread_timedjoin_np(work->workers[w], NULL, &until) != 0)
			return false;
	pthread_mutex_lock(&work->lock);
	work->drained = true;
	pthread_cond_signal(&work->waits);
	pthread_mutex_unlock(&work->lock);
	if (work->commits && pthread_timedjoin_np(work->committer, NULL, &until) != 0)
		return false;
	if (work->watched)
		pthread_join(work->watch, NULL);
	pthread_mutex_lock(&work->lock);
	bool viewed = false;
	TAILQ_FOREACH(job, &work->jobs, others)
	viewed |= job->n_views > 0;
	pthread_mutex_unlock(&work->lock);
	if (viewed || !alone)
		return false;
	while ((job = TAILQ_FIRST(&work->jobs)))
		drop(work, job);
	pthread_cond_destroy(&work->waits);
	pthread_cond_destroy(&work->changed);
	pthread_mutex_destroy(&work->lock);
	free(work);
	return true;
}
