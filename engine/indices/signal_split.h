/* signal_split.h - how the variance of an index depends on how many signals each row has, from a pilot. */
#ifndef SIGNAL_SPLIT_H
#define SIGNAL_SPLIT_H

#include "engine/indices/indices.h"

enum { POUND_SPLIT_SIGNALS = 6 }; /* of a pilot: three pairs, two triples, all */

/* Of an index estimated from n rows of R signals: variance (rows + signals / R + pairs / (R (R - 1))) / n, and bias
 * bias / (R (R - 1)), as an output is a ratio of means of few signals.  NAN: unknown. */
struct pound_split_parts {
	double rows, signals, pairs, bias;
};

double pound_split_variance(const struct pound_split_parts *parts, int n_signals); /* times the rows */
double pound_split_bias(const struct pound_split_parts *parts, int n_signals);

size_t pound_split_scratch(const struct pound_sample_values *shape); /* doubles */
/* Of every S1 and then every ST  (2 x n_inputs). */
void pound_split_estimate(const struct pound_sample_values *values, const struct pound_sampling *sampling,
                          uint64_t seed, double *scratch, struct pound_split_parts *parts);

#endif
