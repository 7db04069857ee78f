/* row_response.h - the response of a row of buildings as the numbers that are kept of it. */
#ifndef ROW_RESPONSE_H
#define ROW_RESPONSE_H

#include "engine/run/outputs.h"
#include "engine/solver/convergence.h"

/* A response in n doubles, all NAN where it failed; and back, for the scene with its own buildings. */
void pound_row_keep(const struct pound_outcome *outcome, int n, double *kept);
struct pound_row_response pound_row_kept(const struct pound_scene *scene, const double *kept);

/* What a convergence study keeps of one, without its history and its time; all NAN where it failed. */
void pound_row_trial(const struct pound_outcome *outcome, struct pound_trial_run *trial);

double
pound_row_impulse(const struct pound_outcome *outcome); /* the largest, over the mass of building 0 [m/s] */

#endif
