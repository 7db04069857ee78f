/* unit_stop.c - time from a stop request to the end of the run: each of the long loops, interrupted at many times. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/latency.h"
#include "tests/support/study_documents.h"

#define SCENE                                                                                       \
	"\"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], \"excitation\": " \
	"{\"signals\": 2}}, "
#define INPUT(path, name, low, high)                                                              \
	"{\"path\": \"" path "\", \"name\": \"" name "\", \"distribution\": {\"type\": \"uniform\", " \
	"\"min\": " low ", \"max\": " high "}}"
#define INPUTS                                                                         \
	"\"inputs\": [" INPUT("/oscillators/0/frequency_hz", "f_1", "0.5",                 \
	                      "5") ", " INPUT("/oscillators/1/frequency_hz", "f_2", "0.5", \
	                                      "5") ", " INPUT("/contact/restitution", "eps", "0", "1") "], "

/* Long computations, with their number of rows or pulses; the second number is for make soak. */
static const struct {
	const char *what, *document;
	int n[2];
	enum { CREATE, BLOCK, REDUCE } step;
} CASES[] = {
    {"a design is drawn",
     "{\"kind\": \"sensitivity\", " SCENE INPUTS "\"design\": {\"rows\": %d}}",
     {100000, 1000000},
     CREATE},
    {"a train of pulses",
     "{\"kind\": \"floor_spectrum\", " SCENE
     "\"spectrum\": {\"frequencies_hz\": {\"count\": 2}, \"pulses\": %d}}",
     {1000000, 1000000},
     BLOCK},
    {"a hypercube is reduced",
     "{\"kind\": \"sensitivity\", " SCENE INPUTS "\"design\": {\"rows\": %d}}",
     {20000, 1000000},
     REDUCE},
    {"nets are reduced, with sets and ratios",
     "{\"kind\": \"sensitivity\", " SCENE INPUTS
     "\"ratios\": [{\"name\": \"f_1/f_2\", \"of\": [\"/oscillators/0/frequency_hz\", "
     "\"/oscillators/1/frequency_hz\"]}], "
     "\"design\": {\"rows\": %d, \"method\": \"sobol\", \"order\": \"factorial\"}}",
     {16384, 524288},
     REDUCE},
};

/* Fills the blocks as if they had been run. */
static void blocks_fill(struct pound_run *run)
{
	uint64_t x = 1;
	for (int b = 0; b < pound_run_blocks(run); b++) {
		size_t n = pound_run_block_size(run, b);
		double *values = malloc(sizeof *values * n);
		for (size_t k = 0; k < n; k++) {
			x = x * 6364136223846793005u + 1442695040888963407u;
			// the last values are counts of failed runs
			values[k] = k < n - POUND_N_FAILURES ? 1 + (double)(x >> 11) * 0x1p-53 : 0;
		}
		pound_run_block_restore(run, b, values);
		free(values);
	}
}

struct trial {
	const struct pound_study *study;
	struct pound_run *run;
	int step;
	atomic_bool stop;
	bool stopped;
};

static void *tried(void *of)
{
	struct trial *trial = of;
	if (trial->step == CREATE) {
		struct pound_run *run = pound_run_create_by(trial->study, 1, &trial->stop);
		trial->stopped = !run;
		pound_run_free(run);
	} else
		trial->stopped = (trial->step == BLOCK ? pound_run_block(trial->run, 0, 0)
		                                       : pound_run_reduce(trial->run, 0, 0)) == POUND_STOPPED;
	return NULL;
}

/* Seconds from the stop request, which follows after `delay` seconds, to the end; -1: it ended before the request. */
static double stopped_after(struct trial *trial, double delay)
{
	pthread_t thread;
	const double whole = floor(delay);
	trial->stop = false;
	assert_int_equal(pthread_create(&thread, NULL, tried, trial), 0);
	nanosleep(&(struct timespec){(time_t)whole, (long)(1e9 * (delay - whole))}, NULL);
	double stopped = latency_now();
	trial->stop = true;
	pthread_join(thread, NULL);
	return trial->stopped ? latency_now() - stopped : -1;
}

static void what_takes_long_ends_soon_when_it_is_stopped(void **state)
{
	enum { TIMES = 6 };
	(void)state;
	for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
		char document[4096];
		double longest = 0, start;
		int stopped = 0;
		snprintf(document, sizeof document, CASES[i].document, CASES[i].n[check_soaks()]);
		struct pound_study *study = study_documents_study(document);
		study->design.resamples = study->n_inputs ? 400 : 0; // leaves time for the other loops
		struct trial trial = {.study = study, .step = CASES[i].step};
		if (trial.step != CREATE) {
			trial.run = pound_run_create(study, 1);
			assert_non_null(trial.run);
			pound_run_stop_by(trial.run, &trial.stop);
		}
		if (trial.step == REDUCE)
			blocks_fill(trial.run);
		start = latency_now();
		tried(&trial);
		const double whole = latency_now() - start;
		for (int k = 0; k < TIMES; k++) {
			double s = stopped_after(&trial, whole * (k + 0.5) / TIMES);
			longest = s > longest ? s : longest;
			stopped += s >= 0;
		}
		check_report("while %s, %.2f s: stopped %d times, after %.0f ms at most", CASES[i].what, whole,
		             stopped, 1e3 * longest);
		// the other runs ended before the request
		assert_true(stopped > 0);
		assert_true(longest <= 0.5);
		pound_run_free(trial.run);
		study_free(study);
	}
}

CHECK_MAIN(cmocka_unit_test(what_takes_long_ends_soon_when_it_is_stopped))
