/* suite_references.h - what the records of a suite are scaled by, and how well they are sampled. */
#ifndef SUITE_REFERENCES_H
#define SUITE_REFERENCES_H

#include <stdatomic.h>

#include "engine/pound.h"

size_t pound_suite_scratch(const struct pound_excitation *suite); /* bytes, to be 64-byte aligned */

/* What the intensity is divided by to scale each record [m/s2]  (n_records). */
enum pound_status pound_suite_references(const struct pound_excitation *suite, void *scratch,
                                         const atomic_bool *stop, double *references);

/* What their samples are too few for: of each record by how much the larger of the displacements of the scene's bodies changes, when
 * it is interpolated at twice its rate  (n_records). */
enum pound_status pound_suite_differences(const struct pound_scene *scene, void *scratch,
                                          const atomic_bool *stop, double *differences);

#endif
