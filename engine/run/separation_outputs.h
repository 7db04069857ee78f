/* separation_outputs.h - how wide a gap has to be: the part of a result that a study of separation has of its own. */
#ifndef SEPARATION_OUTPUTS_H
#define SEPARATION_OUTPUTS_H

#include "engine/run/run.h"

/* Doubles of its reduction's work space, bytes of its part of the result; 0: the study is of another kind. */
size_t pound_separation_scratch(const struct pound_cells *campaign);
size_t pound_separation_bytes(const struct pound_cells *campaign);

/* Lays its part of a result into memory. */
void pound_separation_layout(const struct pound_cells *campaign, void *memory,
                             struct pound_separation_result *result);

/* Fills it from the runs in hand. */
void pound_separation_reduce(struct pound_run *run, double *scratch);

#endif
