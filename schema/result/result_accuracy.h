/* result_accuracy.h - the `accuracy` members of a result: of one output, and of the whole study. */
#ifndef RESULT_ACCURACY_H
#define RESULT_ACCURACY_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* A member of the object that is open in w. */
void result_accuracy_output(struct writer *w, const struct pound_study *study,
                            const struct pound_indices *indices);
void result_accuracy_study(struct writer *w, const struct pound_study *study,
                           const struct pound_result *result);

/* `rows` of `timing`: what the rows of each half width took or would have taken, in proportion. */
void result_accuracy_timing(struct writer *w, const struct pound_result *result, double cpu_s);

#endif
