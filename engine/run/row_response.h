/* row_response.h - the response of a row of buildings as the numbers that are kept of it. */
#ifndef ROW_RESPONSE_H
#define ROW_RESPONSE_H

#include "engine/run/outputs.h"

/* A response in n doubles, all NAN where it failed; and back, for the scene with its own buildings. */
void pound_row_keep(const struct pound_outcome *outcome, int n, double *kept);
struct pound_row_response pound_row_kept(const struct pound_scene *scene, const double *kept);

double
pound_row_impulse(const struct pound_outcome *outcome); /* the largest, over the mass of building 0 [m/s] */

#endif
