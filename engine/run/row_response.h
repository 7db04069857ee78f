/* row_response.h - packs the response of a row of buildings into doubles, and back. */
#ifndef ROW_RESPONSE_H
#define ROW_RESPONSE_H

#include "engine/run/outputs.h"
#include "engine/solver/convergence.h"

/* Packs a response into n doubles, all NAN if it failed; unpacks it, with the scene's own buildings. */
void pound_row_keep(const struct pound_outcome *outcome, int n, double *kept);
struct pound_row_response pound_row_kept(const struct pound_scene *scene, const double *kept);

/* The values of a response for a convergence study, without history and CPU time; all NAN if it failed. */
void pound_row_trial(const struct pound_outcome *outcome, struct pound_trial_run *trial);

double
pound_row_impulse(const struct pound_outcome *outcome); /* the largest, over the mass of building 0 [m/s] */

#endif
