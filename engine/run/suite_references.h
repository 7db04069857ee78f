/* suite_references.h - what the records of a suite are scaled by. */
#ifndef SUITE_REFERENCES_H
#define SUITE_REFERENCES_H

#include <stdatomic.h>

#include "engine/pound.h"

size_t pound_suite_scratch(const struct pound_excitation *suite); /* bytes, to be 64-byte aligned */

/* What the intensity is divided by to scale each record [m/s2]  (n_records). */
enum pound_status pound_suite_references(const struct pound_excitation *suite, void *scratch,
                                         const atomic_bool *stop, double *references);

#endif
