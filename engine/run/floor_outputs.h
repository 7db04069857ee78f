/* floor_outputs.h - floor spectra as outputs of a study: of a block, over the signals, correlated with the impulse. */
#ifndef FLOOR_OUTPUTS_H
#define FLOOR_OUTPUTS_H

#include "engine/floor/floor.h"
#include "engine/indices/indices.h"
#include "engine/run/request.h"
#include "engine/run/run.h"

struct pound_ordinates; /* scratch memory of one worker */

int pound_ordinate_measures(
    const struct pound_study *study); /* doubles of a run, stored after its output values */
size_t pound_ordinate_bytes(const struct pound_study *study, int n_tasks); /* 0: no spectra requested */
struct pound_ordinates *pound_ordinate_init(void *memory, const struct pound_study *study, int n_tasks);

enum pound_status pound_ordinate_block(struct pound_ordinates *ordinates, const struct pound_study *study,
                                       const struct pound_request *request, double *values,
                                       const atomic_bool *stop, struct pound_work *work);

/* Points the spectra of a result into numbers  (POUND_N_SPECTRA x 4 x frequencies). */
void pound_ordinate_layout(const struct pound_study *study, double *numbers,
                           struct pound_floor_result *result);
size_t pound_ordinate_scratch(const struct pound_study *study, int n_rows); /* doubles */
void pound_ordinate_reduce(const struct pound_run *run, double *scratch, struct pound_floor_result *result);
struct pound_estimate pound_ordinate_correlation(const struct pound_run *run, int cell, int output,
                                                 double *scratch);

#endif
