/* error_budget.h - error of the indices of an output, by source. */
#ifndef ERROR_BUDGET_H
#define ERROR_BUDGET_H

#include "engine/indices/indices.h"

/* One output of a run that was computed twice: [0] for the result, [1] on half the sample step. */
struct pound_check {
	int row, sample;
	double numerator[2], denominator[2]; /* NAN: failed */
};

struct pound_checks {
	int n;
	struct pound_check *check; /* (n) */
};

/* Fills indices->accuracy, after pound_index_columns_indices has filled the other members.  scratch: (checks.n) */
void pound_accuracy_estimate(const struct pound_sample_values *values, struct pound_checks checks,
                             bool quasi_random, double *scratch, struct pound_indices *indices);

#endif
