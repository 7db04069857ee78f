/* statistics.h - what `make statistics` compares on: functions with exact indexes, and other packages' formulas. */
#ifndef STATISTICS_H
#define STATISTICS_H

#include "tests/functions.h"

extern const struct function statistics_functions[]; /* beside functions[]; ends with a row of NULLs */

/* First-order indexes, then totals, from the outputs of n rows of samples, of which the first d + 2 are A, B and A with
 * column j from B. */
struct statistics_package {
	const char *name;
	void (*indices)(const double *y, int n, int d, int n_samples, double *value); /* value  (2 x d) */
};

extern const struct statistics_package statistics_packages[]; /* ends with a row of NULLs */

#endif
