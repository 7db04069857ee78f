/* suite_references.h - reference intensities of the records of a suite, and the adequacy of their sampling. */
#ifndef SUITE_REFERENCES_H
#define SUITE_REFERENCES_H

#include <stdatomic.h>

#include "engine/pound.h"

size_t pound_suite_scratch(const struct pound_excitation *suite); /* bytes, to be 64-byte aligned */

/* Reference intensity of each record: target intensity over this is its scale factor [m/s2]  (n_records). */
enum pound_status pound_suite_references(const struct pound_excitation *suite, void *scratch,
                                         const atomic_bool *stop, double *references);

/* Effect of coarse sampling: for each record the largest relative change of a body's peak displacement when the record is
 * interpolated at twice its rate  (n_records). */
enum pound_status pound_suite_differences(const struct pound_scene *scene, void *scratch,
                                          const atomic_bool *stop, double *differences);

#endif
