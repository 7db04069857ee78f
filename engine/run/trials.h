/* trials.h - the trials of a convergence study. */
#ifndef TRIALS_H
#define TRIALS_H

#include "engine/run/run.h"
#include "engine/solver/convergence.h"

enum { POUND_TRIAL_MEASURES = sizeof(struct pound_trial_run) / sizeof(double) };

/* Adds histories and CPU times to a block of one trial. */
enum pound_status pound_trials_block(const struct pound_run *run, struct pound_request *request, int first,
                                     int n, struct pound_trial_run *runs);

void pound_trials_reduce(struct pound_run *run, double *scratch);

#endif
