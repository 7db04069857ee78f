/* given_factorial.h - indices of a complete factorial design, by the analysis of variance. */
#ifndef GIVEN_FACTORIAL_H
#define GIVEN_FACTORIAL_H

#include "engine/given.h"

size_t pound_factorial_scratch(int n_rows); /* doubles */
/* Fills noise_share and `first`; if the noise is known, also `total` and `second`.  false: all of the variance may be noise. */
bool pound_factorial_indices(const struct pound_given *given, const struct pound_given_output *output,
                             double *scratch, struct pound_given_indices *indices);
/* Whether the noise of an output is known, by replicates or as given. */
bool pound_factorial_noise_known(const struct pound_given *given);

#endif
