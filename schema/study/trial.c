/* trial.c - runs a study for a limited time and measures its CPU time.
 *
 * The engine polls a stop flag while it runs (pound_run_stop_by); a watching thread sets the flag when the CPU time is used up. */
#include "schema/study/trial.h"

#include <pthread.h>
#include <time.h>

/* [ns] between two readings of the CPU time */
static const long LOOK_EVERY = 2000000;

struct watch {
	pthread_mutex_t lock;
	pthread_cond_t ended;
	bool over; /* the runs have ended */
	clockid_t clock;
	double until; /* time on `clock` to stop at [s] */
	const atomic_bool *unwanted;
	atomic_bool stop;
};

static double seconds_of(clockid_t clock)
{
	struct timespec now;
	clock_gettime(clock, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double cpu_now(void)
{
	return seconds_of(CLOCK_THREAD_CPUTIME_ID);
}

static void *watch_run(void *of)
{
	struct watch *watch = of;
	pthread_mutex_lock(&watch->lock);
	while (!watch->over && !watch->stop) {
		struct timespec next;
		watch->stop = seconds_of(watch->clock) > watch->until || (watch->unwanted && *watch->unwanted);
		clock_gettime(CLOCK_REALTIME, &next);
		next.tv_nsec += LOOK_EVERY;
		next.tv_sec += next.tv_nsec / 1000000000;
		next.tv_nsec %= 1000000000;
		pthread_cond_timedwait(&watch->ended, &watch->lock, &next);
	}
	pthread_mutex_unlock(&watch->lock);
	return NULL;
}

/* Runs all blocks, with reductions if `whole`, until the stop flag is set. */
static enum pound_status run_all(struct pound_run *run, bool whole)
{
	enum pound_status status = POUND_OK;
	for (int block = 0, done = 0; !status && !done;) {
		for (; block < pound_run_blocks(run) && !status; block++)
			status = pound_run_block(run, block, 0);
		for (int k = 0; whole && k < pound_run_reductions(run) && !status; k++)
			status = pound_run_reduce(run, k, 0);
		done = !whole || status || !pound_run_grow(run);
	}
	return status;
}

/* Test     unit_trial: a_trial_ends_when_its_time_is_over */
struct trial trial_run(const struct pound_study *study, bool whole, double cpu_most,
                       const atomic_bool *unwanted)
{
	const double start = cpu_now();
	struct watch watch = {.lock = PTHREAD_MUTEX_INITIALIZER,
	                      .ended = PTHREAD_COND_INITIALIZER,
	                      .until = start + cpu_most,
	                      .unwanted = unwanted};
	pthread_t thread;
	if (pthread_getcpuclockid(pthread_self(), &watch.clock) ||
	    pthread_create(&thread, NULL, watch_run, &watch))
		return (struct trial){.complete = false};
	struct pound_run *run = pound_run_create_by(study, 1, &watch.stop);
	enum pound_status status = run ? POUND_OK : POUND_NOMEM;
	if (run) {
		pound_run_stop_by(run, &watch.stop);
		pound_run_clock(run, cpu_now);
		status = run_all(run, whole);
		pound_run_free(run);
	}
	const struct trial trial = {.cpu_s = cpu_now() - start,
	                            .complete = status != POUND_STOPPED && status != POUND_NOMEM};
	pthread_mutex_lock(&watch.lock);
	watch.over = true;
	pthread_cond_signal(&watch.ended);
	pthread_mutex_unlock(&watch.lock);
	pthread_join(thread, NULL);
	return trial;
}
