/* bench.h - the rows of `make bench`, and timing jobs beside each other.
 *
 * CPU seconds unless a row says wall. */
#ifndef BENCH_H
#define BENCH_H

#include <stdbool.h>
#include <stddef.h>
#include <time.h>

#include "engine/pound.h"

/* one line of the table; what is 0 or NULL is left blank */
struct bench_row {
	const char *what;
	double value;
	const char *unit;
	double ratio;     /* to what `to` says */
	const char *to;   /* "the event solver" */
	double error;     /* relative, median over the signals */
	const char *goal; /* "at most 3" */
	bool met;
};

void bench_print(struct bench_row row);
const char *bench_text(const char *format, ...)
    __attribute__((format(printf, 1, 2))); /* valid for the next 15 calls */

struct bench_job {
	void (*run)(void *of);
	void *of;
	double seconds; /* least CPU time of one run */
};

/* Runs all jobs in turn, `repeats` times, so that what else the machine does falls on all of them. */
void bench_jobs(struct bench_job *jobs, int n, int repeats);
double bench_seconds(clockid_t clock);

_Noreturn void bench_fail(const char *why);
struct pound_study *bench_study(const char *document);
void *bench_memory(size_t bytes); /* zeroed, 64-byte aligned; ends the program when there is none */

/* the groups of rows */
void bench_campaign(int rows);
void bench_reference(void);
void bench_kernel(void);
void bench_responses(void);
void bench_growth(void);
void bench_indices(void);
void bench_spectra(void);
void bench_chains(void);
void bench_separation(void);
void bench_outputs(void);

#endif
