/* run_study.c - runs a study without a server: from its document to its result. */
#include "client/command.h"
#include "client/compute.h"
#include "client/document.h"
#include "client/show.h"
#include "schema/json/problems.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

#include <errno.h>
#include <libgen.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static atomic_bool interrupted;

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

static double thread_cpu(void)
{
	return seconds(CLOCK_THREAD_CPUTIME_ID);
}

/* Writes the samples of a sensitivity study, the histories of floor spectra, or the contacts of responses to a file. */
static enum outcome write_samples(const struct pound_study *study, struct pound_run *run, const char *path)
{
	const char *end = strrchr(path, '.');
	bool npy = end && strcmp(end, ".npy") == 0;
	size_t n;
	const char *reason = NULL;
	pound_run_stop_by(run, &interrupted); // the threads that polled for a stop have ended
	char *bytes = histories_exist(study)
	                  ? (npy ? histories_to_npy : histories_to_csv)(study, run, -1, &n, &reason)
	                  : (npy ? samples_to_npy : samples_to_csv)(study, run, &n);
	FILE *file = bytes ? fopen(path, "wb") : NULL;
	bool written = file && fwrite(bytes, 1, n, file) == n;
	written = file && fclose(file) == 0 && written;
	if (!written)
		command_complain("cannot write '%s': %s", path,
		                 bytes         ? strerror(errno)
		                 : reason      ? reason
		                 : interrupted ? pound_status_text(POUND_STOPPED)
		                               : pound_status_text(POUND_NOMEM));
	free(bytes);
	return written ? OUTCOME_OK : OUTCOME_FAILED;
}

/* Whether a file can probably be written, without creating it: checked before a study that may run for hours. */
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

static enum outcome run_and_print(const struct pound_study *study, const char *document, size_t length,
                                  const struct options *options)
{
	struct launch launch = options->launch;
	char said[512] = "";
	const bool listens = !message_movable(study) || launch_listen(&launch, said, sizeof said);
	if (*said)
		command_complain("%s", said);
	if (!listens)
		return OUTCOME_FAILED;
	double wall = seconds(CLOCK_MONOTONIC);
	struct pound_run *run = pound_run_create_by(study, options->threads, &interrupted);
	if (run)
		pound_run_clock(run, thread_cpu);
	struct compute compute = {.study = study,
	                          .run = run,
	                          .document = document,
	                          .length = length,
	                          .n_threads = options->threads,
	                          .launch = &launch,
	                          .checkpoint = options->checkpoint,
	                          .interrupted = &interrupted};
	enum pound_status status = run ? compute_run(&compute) : POUND_NOMEM;
	const struct timing timing = {.wall_s = seconds(CLOCK_MONOTONIC) - wall,
	                              .cpu_s = seconds(CLOCK_PROCESS_CPUTIME_ID) + compute.elsewhere_s,
	                              .threads = options->threads};
	enum outcome outcome = OUTCOME_OK;
	size_t n;
	char *json = status == POUND_OK ? result_to_json(study, pound_run_result(run), &timing, &n) : NULL;
	if (json)
		outcome = show_result(json, n, options);
	else if (compute.refused)
		outcome = OUTCOME_FAILED;
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
	enum outcome outcome;
	char *document = document_whole(options->argument, &n, &outcome);
	if (!document)
		return outcome;
	struct problems problems;
	struct pound_study *study = study_from_json(document, n, &problems);
	if (!study) {
		outcome = document_reject(options->argument, &problems);
		document_hint(document, n);
		free(document);
		return outcome;
	}
	document_advise(study);
	if (options->samples && !samples_exist(study)) {
		command_complain("only sensitivity studies, floor spectra with \"histories\": true, and responses by "
		                 "the event solver of at most 250000 "
		                 "ground motion samples over all signals and cells have samples");
		study_free(study);
		free(document);
		return OUTCOME_USAGE;
	}
	if (options->samples && !writable(options->samples)) {
		command_complain("cannot write '%s': %s", options->samples, strerror(errno));
		study_free(study);
		free(document);
		return OUTCOME_FAILED;
	}
	// a second Ctrl-C ends the program at once
	const struct sigaction act = {.sa_handler = note_interrupt, .sa_flags = (int)SA_RESETHAND};
	sigaction(SIGINT, &act, NULL);
	sigaction(SIGTERM, &act, NULL);
	outcome = run_and_print(study, document, n, options);
	study_free(study);
	free(document);
	return outcome;
}
