/* signal_split.h - variance of an index as a function of the number of signals per row, estimated from a pilot. */
#ifndef SIGNAL_SPLIT_H
#define SIGNAL_SPLIT_H

#include "engine/indices/indices.h"

enum { POUND_SPLIT_SIGNALS = 6 }; /* of a pilot: three pairs, two triples, all */

/* An index estimated from n rows of R signals has the variance (rows + signals / R + pairs / (R (R - 1))) / n, and the bias
 * bias / (R (R - 1)), because an output is a ratio of means over few signals.  NAN: unknown. */
struct pound_split_parts {
	double rows, signals, pairs, bias;
};

double pound_split_variance(const struct pound_split_parts *parts, int n_signals); /* times the rows */
double pound_split_bias(const struct pound_split_parts *parts, int n_signals);

size_t pound_split_scratch(const struct pound_sample_values *shape); /* doubles */
/* For every S1 and then every ST  (2 x n_inputs). */
void pound_split_estimate(const struct pound_sample_values *values, const struct pound_sampling *sampling,
                          uint64_t seed, double *scratch, struct pound_split_parts *parts);

#endif
