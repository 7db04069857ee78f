/* outputs.h - from the responses to the signals of a scene to its outputs. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "engine/pound.h"

void pound_outputs_measure(int row, const struct pound_scene *scene, const struct pound_response *response,
                           double *numerator, double *denominator);

#endif
