/* design.h - where the model is run: the rows of two matrices A and B of input values, and their mixtures.
 *
 * Values are in the inputs' own units; x is (rows x 2 x n_inputs), row i of A and then row i of B, with
 * pound_design_rows_most(study) rows.  A row is a function of its number, so that a design that grows keeps its rows. */
#ifndef DESIGN_H
#define DESIGN_H

#include "engine/design/row_samples.h"
#include "engine/numeric/stop.h"

/* as probabilities, and as values of the inputs; `stop` is looked at throughout, NULL: never  (rows x 2 x n_inputs) each */
void pound_design_probabilities(const struct pound_study *study, const atomic_bool *stop, double *u);
void pound_design_values(const struct pound_study *study, const double *u, const atomic_bool *stop,
                         double *x);

/* Rows that come in groups, each a design of its own and independent of the others: row i is of group i / run % n.
 * n = 0: there are none, every row is as good as independent of the others. */
struct pound_grouping {
	int n, run;
};
struct pound_grouping pound_design_grouping(const struct pound_study *study);

/* Input j of the sample of a row that has these columns from B. */
double pound_design_input(const double *x, int n_inputs, int row, unsigned from_b, int j);

#endif
