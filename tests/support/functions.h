/* functions.h - functions of four independent uniform variables whose mean, variance and sensitivity indices are known,
 * and the sample values that running them over a Latin hypercube gives. */
#ifndef FUNCTIONS_H
#define FUNCTIONS_H

#include "engine/indices/indices.h"

enum { FUNCTION_INPUTS = 4, FUNCTION_PAIRS = 6 };

struct function {
	const char *name;
	double (*y)(const double *u);
	double mean, variance;
	double index[2 * FUNCTION_INPUTS]; /* first-order, then total */
	/* root mean square errors at n = 1000, Latin hypercube: of the centred Saltelli first-order index, and of
	 * Jansen's total with the variance of A and B; 0: not known */
	double error[2 * FUNCTION_INPUTS];
	double pair[FUNCTION_PAIRS]; /* second-order: 01, 02, 03, 12, 13, 23 */
	double shapley[FUNCTION_INPUTS];
};

extern const struct function functions[];
const struct function *function_named(const char *name); /* the row of that name */

/* How a simulator adds noise to a function: signals of each run, and the variance of the noise of each, over the
 * function's; shared by the runs of a row or fresh in every run. */
struct function_noise {
	int n_signals;
	double share;
	bool common;
};

/* Sample values of a function over the rows of a Latin hypercube; function_values_free. */
struct pound_sample_values function_values(const struct function *f, int n_rows, uint64_t seed,
                                           struct function_noise noise);
void function_values_free(struct pound_sample_values *values);

/* The rows of that Latin hypercube  (n_rows x 2 x FUNCTION_INPUTS); free. */
double *function_design(int n_rows, uint64_t seed);

/* The same of any design; rows and grouping are those of the whole design, even if it grows. */
struct pound_sample_values function_values_of(const struct function *f, const struct pound_design *design,
                                              struct function_noise noise);
double *function_design_of(const struct pound_design *design);
/* A study of such inputs, pointing to constant ones. */
struct pound_study function_study(const struct pound_design *design);

#endif
