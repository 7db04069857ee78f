/* result_accuracy.h - the members `accuracy` of a result: of one output, and of the whole study. */
#ifndef RESULT_ACCURACY_H
#define RESULT_ACCURACY_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Write member `accuracy` into the object that is open in w. */
void result_accuracy_output(struct writer *w, const struct pound_study *study,
                            const struct pound_indices *indices);
void result_accuracy_study(struct writer *w, const struct pound_study *study,
                           const struct pound_result *result);

/* Writes member `rows` of `timing`: CPU time for each number of rows with half-widths, in proportion to the rows. */
void result_accuracy_timing(struct writer *w, const struct pound_result *result, double cpu_s);

#endif
