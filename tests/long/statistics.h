/* statistics.h - parts of `make statistics`: functions with exact indices, formulas of other packages, jobs for all
 * cores, and the tables, each of which prints itself as Markdown. */
#ifndef STATISTICS_H
#define STATISTICS_H

#include "tests/support/functions.h"

enum { STATISTICS_INDEXES = 2 * FUNCTION_INPUTS }; /* first-order, then total */

/* The functions of functions.c, then those of statistics_functions.c; NULL after the last. */
extern const struct function statistics_functions[]; /* ends with a row of NULLs */
const struct function *statistics_function(int k);

/* First-order indices, then totals, from the outputs of n rows of n_samples samples: A, B, A with column j from B, ... */
struct statistics_package {
	const char *name;
	void (*indices)(const double *y, int n, int d, int n_samples, double *value); /* value  (2 x d) */
};

extern const struct statistics_package statistics_packages[]; /* ends with a row of NULLs */

/* Errors of one estimator's indices over the seeds, and how often its intervals cover the exact values. */
struct statistics_score {
	int n;
	double bias[STATISTICS_INDEXES], square[STATISTICS_INDEXES], covered[STATISTICS_INDEXES]; /* sums */
};

void statistics_score_values(struct statistics_score *score, const struct function *f, const double *value);
/* of two columns of an output's indices */
void statistics_score_indices(struct statistics_score *score, const struct function *f,
                              const struct pound_indices *indices, enum pound_index first,
                              enum pound_index total);
/* For first-order indices (0), totals (1) or both (-1): root mean square error, coverage, largest bias. */
double statistics_error(const struct statistics_score *score, int total);
double statistics_coverage(const struct statistics_score *score, int total);
double statistics_bias(const struct statistics_score *score, int total);

/* A design of n rows, or of the nearest power of two for Sobol' sequences. */
struct pound_design statistics_design(int method, int rows, uint64_t seed);

/* A study of four uniform inputs and one output, run in this program. */
struct pound_study statistics_study(const struct pound_design *design);

/* Assigns the outputs of rows [first, number of rows so far) to a run of such a study, and to y (rows x samples)
 * unless it is NULL. */
void statistics_assign(struct pound_run *run, const struct function *f, int first, double *y);

void *statistics_sure(void *memory); /* exits if out of memory */

/* Runs jobs 0 .. n - 1, in any order, on all cores; progress goes to stderr. */
void statistics_jobs(int n, void (*job)(void *of, int k), void *of);

void statistics_designs(int n_seeds); /* errors and coverage by design and number of rows */
void statistics_named(int n_seeds);   /* errors of the named estimators */
void statistics_noise(int n_seeds);   /* bias, errors and coverage under noise */
void statistics_growth(int n_seeds);  /* designs that grow until their intervals are narrow */
void statistics_signals(
    int n_seeds);                   /* CPU time to a half width with signals "auto" and with fixed numbers */
void statistics_tails(int n_seeds); /* a few samples dominate the variance; many inputs */
void statistics_given(int n_seeds); /* random samples without a design */

#endif
