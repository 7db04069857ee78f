/* run_study.c - a study computed in this process.
 *
 * 1. Threads take blocks, then reductions, each from a counter, so that which thread computes what is chance.
 * 2. This thread watches: it draws the bar and looks for Ctrl-C.
 * 3. The result is a function of the study alone; the engine sums by index, not by arrival. */
#include "client/bar.h"
#include "client/command.h"
#include "client/document.h"
#include "client/show.h"
#include "schema/json/problems.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

#include <errno.h>
#include <libgen.h>
#include <limits.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { REDRAW_MS = 100 };

static atomic_bool interrupted;

struct crew {
	struct pound_run *run;
	enum pound_status (*job)(struct pound_run *run, int index, int worker);
	int n_jobs;
	atomic_int next;        /* job that nobody has taken */
	atomic_int status;      /* first one that is not POUND_OK */
	atomic_llong runs_done; /* pounding runs in the finished blocks */
	sem_t finished;         /* posted by each thread at its end */
};

struct member {
	pthread_t thread;
	struct crew *crew;
	int worker;
};

static void note_interrupt(int number)
{
	(void)number;
	atomic_store(&interrupted, true);
}

static double seconds(clockid_t clock)
{
	struct timespec time;
	clock_gettime(clock, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void *member_work(void *of)
{
	struct member *member = of;
	struct crew *crew = member->crew;
	for (int i; (i = atomic_fetch_add(&crew->next, 1)) < crew->n_jobs;) {
		enum pound_status status = crew->job(crew->run, i, member->worker);
		if (status != POUND_OK) {
			int none = POUND_OK;
			atomic_compare_exchange_strong(&crew->status, &none, (int)status);
			break;
		}
		if (crew->job == pound_run_block)
			atomic_fetch_add(&crew->runs_done, pound_run_block_runs(crew->run, i));
	}
	sem_post(&crew->finished);
	return NULL;
}

/* Watches n threads until all have ended. */
static void watch(struct crew *crew, int n, int64_t runs_total, double start)
{
	while (n > 0) {
		struct timespec until;
		clock_gettime(CLOCK_REALTIME, &until);
		until.tv_nsec += REDRAW_MS * 1000000L;
		until.tv_sec += until.tv_nsec / 1000000000L;
		until.tv_nsec %= 1000000000L;
		if (sem_timedwait(&crew->finished, &until) == 0)
			n--;
		if (interrupted || atomic_load(&crew->status) != POUND_OK)
			pound_run_stop(crew->run);
		double done = (double)atomic_load(&crew->runs_done), total = (double)runs_total;
		double spent = seconds(CLOCK_MONOTONIC) - start;
		bar_draw(done, total, done > 0.0 ? spent * (total - done) / done : -1.0);
	}
}

/* Runs the blocks that are left, or all reductions, in n threads. */
static void crew_run(struct crew *crew, struct member *members, int n, int64_t runs_total, double start)
{
	int started = 0;
	for (; started < n; started++) {
		members[started] = (struct member){.crew = crew, .worker = started};
		if (pthread_create(&members[started].thread, NULL, member_work, &members[started]) != 0)
			break;
	}
	if (started == 0)
		atomic_store(&crew->status, POUND_NOMEM);
	watch(crew, started, runs_total, start);
	for (int i = 0; i < started; i++)
		pthread_join(members[i].thread, NULL);
}

/* All of one run: blocks, then reductions, for as long as the design grows. */
static enum pound_status compute(struct pound_run *run, int n_threads, int64_t runs_total, double start)
{
	struct crew crew = {.run = run};
	struct member *members = calloc((size_t)n_threads, sizeof *members);
	if (!members)
		return POUND_NOMEM;
	sem_init(&crew.finished, 0, 0);
	int blocks_done = 0;
	do {
		crew.job = pound_run_block;
		crew.n_jobs = pound_run_blocks(run);
		atomic_store(&crew.next, blocks_done);
		crew_run(&crew, members, n_threads, runs_total, start);
		blocks_done = crew.n_jobs;
		if (crew.status != POUND_OK)
			break;
		crew.job = pound_run_reduce;
		crew.n_jobs = pound_run_reductions(run);
		atomic_store(&crew.next, 0);
		crew_run(&crew, members, n_threads, runs_total, start);
	} while (crew.status == POUND_OK && pound_run_grow(run));
	bar_clear();
	sem_destroy(&crew.finished);
	free(members);
	return (enum pound_status)crew.status;
}

static double thread_cpu(void)
{
	return seconds(CLOCK_THREAD_CPUTIME_ID);
}

/* Writes every sample of a sensitivity study, or the histories of a study of spectra, to a file. */
static enum outcome write_samples(const struct pound_study *study, struct pound_run *run, const char *path)
{
	const char *end = strrchr(path, '.');
	bool npy = end && strcmp(end, ".npy") == 0;
	size_t n;
	pound_run_stop_by(run, &interrupted); // its crew, which looked for that, has gone home
	char *bytes = study->spectrum.histories ? (npy ? histories_to_npy : histories_to_csv)(study, run, &n)
	                                        : (npy ? samples_to_npy : samples_to_csv)(study, run, &n);
	FILE *file = bytes ? fopen(path, "wb") : NULL;
	bool written = file && fwrite(bytes, 1, n, file) == n;
	written = file && fclose(file) == 0 && written;
	if (!written)
		command_complain("cannot write '%s': %s", path,
		                 bytes         ? strerror(errno)
		                 : interrupted ? pound_status_text(POUND_STOPPED)
		                               : pound_status_text(POUND_NOMEM));
	free(bytes);
	return written ? OUTCOME_OK : OUTCOME_FAILED;
}

/* Whether a file can be written, as far as can be known without creating it: a study may take hours before it is. */
static bool writable(const char *path)
{
	char folder[PATH_MAX];
	snprintf(folder, sizeof folder, "%s", path);
	struct stat about;
	if (stat(path, &about) != 0)
		return errno == ENOENT && access(dirname(folder), W_OK | X_OK) == 0;
	if (S_ISDIR(about.st_mode))
		errno = EISDIR;
	return !S_ISDIR(about.st_mode) && access(path, W_OK) == 0;
}

static enum outcome run_and_print(const struct pound_study *study, const struct options *options)
{
	double wall = seconds(CLOCK_MONOTONIC);
	struct pound_run *run = pound_run_create_by(study, options->threads, &interrupted);
	if (run)
		pound_run_clock(run, thread_cpu);
	enum pound_status status = run ? compute(run, options->threads, study_runs(study), wall) : POUND_NOMEM;
	const struct timing timing = {.wall_s = seconds(CLOCK_MONOTONIC) - wall,
	                              .cpu_s = seconds(CLOCK_PROCESS_CPUTIME_ID),
	                              .threads = options->threads};
	enum outcome outcome = OUTCOME_OK;
	size_t n;
	char *json = status == POUND_OK ? result_to_json(study, pound_run_result(run), &timing, &n) : NULL;
	if (json)
		outcome = show_result(json, n, options);
	else if (interrupted || status == POUND_OK || status == POUND_NOMEM) {
		command_complain("%s", pound_status_text(interrupted ? POUND_STOPPED : POUND_NOMEM));
		outcome = OUTCOME_FAILED;
	} else {
		command_complain("the study failed: %s", pound_status_error(status));
		outcome = OUTCOME_STUDY_FAILED;
	}
	if (json && outcome == OUTCOME_OK && options->samples)
		outcome = write_samples(study, run, options->samples);
	free(json);
	pound_run_free(run);
	return outcome;
}

/* `pound run STUDY.json`: computes the study and prints its result.
 *
 * Returns  value   OUTCOME_USAGE: the study is invalid; OUTCOME_STUDY_FAILED; OUTCOME_FAILED: stopped, no memory
 * Test     client_run: every_quick_example_gives_the_same_bytes_by_1_2_and_4_threads_and_by_the_server
 */
enum outcome run_study(const struct options *options)
{
	size_t n;
	char *document = document_read(options->argument, &n);
	if (!document)
		return OUTCOME_FAILED;
	struct problems problems;
	struct pound_study *study = study_from_json(document, n, &problems);
	if (!study) {
		enum outcome outcome = document_reject(options->argument, &problems);
		document_hint(document, n);
		free(document);
		return outcome;
	}
	free(document);
	document_advise(study);
	if (options->samples && !samples_exist(study)) {
		command_complain("only sensitivity studies have samples, and floor spectra with \"histories\": true");
		study_free(study);
		return OUTCOME_USAGE;
	}
	if (options->samples && !writable(options->samples)) {
		command_complain("cannot write '%s': %s", options->samples, strerror(errno));
		study_free(study);
		return OUTCOME_FAILED;
	}
	// a second Ctrl-C ends the program at once
	const struct sigaction act = {.sa_handler = note_interrupt, .sa_flags = (int)SA_RESETHAND};
	sigaction(SIGINT, &act, NULL);
	sigaction(SIGTERM, &act, NULL);
	enum outcome outcome = run_and_print(study, options);
	study_free(study);
	return outcome;
}
