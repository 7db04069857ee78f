/* separation_outputs.h - required gap widths: the results specific to separation studies. */
#ifndef SEPARATION_OUTPUTS_H
#define SEPARATION_OUTPUTS_H

#include "engine/run/run.h"

/* Scratch of the reduction in doubles, bytes of the separation result; 0: another kind of study. */
size_t pound_separation_scratch(const struct pound_cells *campaign);
size_t pound_separation_bytes(const struct pound_cells *campaign);

/* Points the separation result into memory. */
void pound_separation_layout(const struct pound_cells *campaign, void *memory,
                             struct pound_separation_result *result);

/* Fills the separation result from the finished runs. */
void pound_separation_reduce(struct pound_run *run, double *scratch);

#endif
