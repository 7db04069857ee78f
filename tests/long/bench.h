/* bench.h - the rows of `make bench`, and timing of several jobs under equal conditions.
 *
 * CPU seconds unless a row says wall. */
#ifndef BENCH_H
#define BENCH_H

#include <stdbool.h>
#include <stddef.h>
#include <time.h>

#include "engine/pound.h"

/* one row of the table; 0 or NULL leaves a cell blank */
struct bench_row {
	const char *what;
	double value;
	const char *unit;
	double ratio;     /* ratio to the row named by `to` */
	const char *to;   /* such as "the event solver" */
	double error;     /* relative, median over the signals */
	const char *goal; /* such as "at most 3" */
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

/* Runs the jobs in rotation, `repeats` times, so that other load affects all of them. */
void bench_jobs(struct bench_job *jobs, int n, int repeats);
double bench_seconds(clockid_t clock);

_Noreturn void bench_fail(const char *why);
struct pound_study *bench_study(const char *document);
void *bench_memory(size_t bytes); /* zeroed, 64-byte aligned; exits if out of memory */

/* groups of rows */
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
