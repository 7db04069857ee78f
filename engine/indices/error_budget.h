/* error_budget.h - how far the indices of an output may be off, and for want of what. */
#ifndef ERROR_BUDGET_H
#define ERROR_BUDGET_H

#include "engine/indices/indices.h"

/* One output of a run that was made twice: [0] for the result, [1] on half the sample step. */
struct pound_check {
	int row, sample;
	double numerator[2], denominator[2]; /* NAN: failed */
};

struct pound_checks {
	int n;
	struct pound_check *check; /* (n) */
};

/* Fills indices->accuracy; the rest of the indices is known, by pound_index_columns_indices.  scratch: (checks.n) */
void pound_accuracy_estimate(const struct pound_sample_values *values, struct pound_checks checks,
                             double *scratch, struct pound_indices *indices);

#endif
