/* design.h - the input values at which a model is run: the rows of two matrices A and B, and mixtures of their columns.
 *
 * Values have the units of the inputs; x is (rows x 2 x n_inputs), row i of A and then row i of B, with
 * pound_design_rows_most(study) rows.  A row depends on its number only, so a growing design keeps its rows. */
#ifndef DESIGN_H
#define DESIGN_H

#include "engine/design/row_samples.h"
#include "engine/numeric/stop.h"

/* The design as probabilities u, and as input values x  (rows x 2 x n_inputs each); stop: checked throughout, NULL: never. */
void pound_design_probabilities(const struct pound_study *study, const atomic_bool *stop, double *u);
void pound_design_values(const struct pound_study *study, const double *u, const atomic_bool *stop,
                         double *x);

/* Groups of rows; each group is a complete design, independent of the other groups.  Row i belongs to group i / run % n.
 * n = 0: no groups, and rows are treated as independent. */
struct pound_grouping {
	int n, run;
};
struct pound_grouping pound_design_grouping(const struct pound_study *study);

/* Value of input j in the sample of a row that takes the columns `from_b` (bit j: column j) from B, all others from A. */
double pound_design_input(const double *x, int n_inputs, int row, unsigned from_b, int j);

#endif
