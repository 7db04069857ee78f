/* indices.h - from the outputs of a design's runs to sensitivity indexes and their intervals.
 *
 *   sample values -> one number for each sample of a row (sobol.c) -> moments of a row (estimator.c)
 *                 -> means of moments over rows, all rows or resampled ones (interval.c) -> indexes (estimator.c)
 *
 * A row of the design with all its samples and signals is the unit throughout: it is kept or dropped, and
 * resampled, as a whole.  Nothing here allocates; sums are taken in the order of rows. */
#ifndef INDICES_H
#define INDICES_H

#include "engine/pound.h"

/* One output of one cell: a ratio of means over the signals, of every sample (0: A, 1: B, 2 + j: A with column j
 * from B).  NAN in any number of a row: a failed run. */
struct pound_sample_values {
	int n_rows, n_inputs, n_signals;
	const double *numerator, *denominator; /* (n_rows x (n_inputs + 2) x n_signals) each */
};

/* An estimator: what it adds up over the rows, and the indexes as a function of the means of that.
 * y: the outputs of a row's samples, centred  (n_inputs + 2);  m: moments;  value: first then total  (2 x n_inputs) */
struct pound_estimator {
	const char *name;
	int (*n_moments)(int n_inputs);
	void (*moments)(const double *y, int n_inputs, double *m);
	void (*indices)(const double *m, int n_inputs, double variance_floor, double *value);
};

const struct pound_estimator *pound_estimator_row(int row); /* NULL past the last */

/* Moments of the rows in tiles of eight columns: a resample reads whole cache lines. */
enum { POUND_TILE = 8 };

struct pound_moments {
	int n_rows, n_moments;
	double *tiles; /* (pound_interval_tiles(n_moments) x n_rows x POUND_TILE), zero beyond n_moments */
};

/* Numbers that are a function of the means of moments. */
struct pound_statistic {
	int n_values;
	void (*values)(const void *subject, const double *mean, double *value);
	const void *subject;
};

enum { POUND_RESAMPLES = 2000, POUND_MOMENTS_MAX = 5 * POUND_INPUTS_MAX + 16 };

int pound_interval_tiles(int n_moments);
double *pound_interval_moment(const struct pound_moments *moments, int row, int tile); /* (POUND_TILE) */
void pound_interval_means(const struct pound_moments *moments, double *mean);
void pound_interval_bootstrap(const struct pound_moments *moments, const struct pound_statistic *statistic,
                              uint64_t seed, double *scratch, struct pound_estimate *estimates);

/* Ratio of means over the signals, and the variance of that ratio. */
double pound_sobol_ratio(const double *numerator, const double *denominator, int n_signals, double *variance);

size_t pound_sobol_scratch(int n_rows, int n_inputs, int n_signals); /* doubles */
int pound_sobol_indices(const struct pound_sample_values *values, uint64_t seed, double *scratch,
                        struct pound_indices *indices); /* rows dropped */

#endif
