/* row_samples.h - which samples a row of the design has: mixtures of A and B, each a set of the columns that are from B.
 *
 * Samples come in one order for all: A, B, A with column j from B for every j, B with column j from A for every j,
 * and then all other mixtures; an order of the design is how far a row goes.  A study's groups of inputs follow. */
#ifndef ROW_SAMPLES_H
#define ROW_SAMPLES_H

#include "engine/pound.h"

enum pound_order {
	POUND_ORDER_TOTAL,     /* up to A with a column from B: n_inputs + 2 samples */
	POUND_ORDER_SECOND,    /* up to B with a column from A: 2 n_inputs + 2 */
	POUND_ORDER_FACTORIAL, /* all 2^n_inputs */
};

enum {
	POUND_SAMPLE_A = 0,
	POUND_SAMPLE_B = 1,
	POUND_SAMPLE_MIXED = 2, /* from here A with column j from B */
};

int pound_order_samples(int order, int n_inputs);    /* of a row */
unsigned pound_order_mask(int n_inputs, int sample); /* bit j: column j is from B */
int pound_order_sample(int n_inputs, unsigned mask); /* the first one with these columns from B */

#endif
