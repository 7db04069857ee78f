/* design.h - where the model is run: the rows of two matrices A and B of input values, and their mixtures.
 *
 * Values are in the inputs' own units; x is (rows x 2 x n_inputs), row i of A and then row i of B. */
#ifndef DESIGN_H
#define DESIGN_H

#include "engine/pound.h"

enum {
	POUND_SAMPLE_A = 0, /* the samples of a row: A, B, and A with column j from B for every j */
	POUND_SAMPLE_B = 1,
	POUND_SAMPLE_MIXED = 2,
};

void pound_design_probabilities(const struct pound_study *study, double *u); /* of the same shape */
void pound_design_fill(const struct pound_study *study, double *x);

/* Input j of a sample of a row. */
double pound_design_input(const double *x, int n_inputs, int row, int sample, int j);

#endif
