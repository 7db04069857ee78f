/* row_samples.h - the samples of a row of the design: mixtures of A and B, each given by the set of columns from B.
 *
 * Samples are always in the same sequence: A, B, A with column j from B for every j, B with column j from A for every j,
 * then all other mixtures.  The order of the design says where a row ends.  Samples for groups of inputs follow. */
#ifndef ROW_SAMPLES_H
#define ROW_SAMPLES_H

#include "engine/pound.h"

enum pound_order {
	POUND_ORDER_TOTAL,     /* up to A with a column from B: n_inputs + 2 samples */
	POUND_ORDER_SECOND,    /* up to B with a column from A: 2 n_inputs + 2; up to two inputs: n_inputs + 2 */
	POUND_ORDER_FACTORIAL, /* all 2^n_inputs; up to two inputs: n_inputs + 2 */
};

enum {
	POUND_SAMPLE_A = 0,
	POUND_SAMPLE_B = 1,
	POUND_SAMPLE_MIXED = 2, /* first of the samples A with column j from B */
};

int pound_order_samples(int order, int n_inputs);    /* samples of a row */
unsigned pound_order_mask(int n_inputs, int sample); /* bit j: column j is from B */
int pound_order_sample(int n_inputs, unsigned mask); /* the first sample with these columns from B */

#endif
