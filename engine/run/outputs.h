/* outputs.h - from the responses to the signals of a scene to its outputs. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "engine/pound.h"

/* What came out of a scene under one signal. */
struct pound_outcome {
	const struct pound_scene *scene;
	const struct pound_response *pair;    /* of two oscillators */
	const struct pound_row_response *row; /* of a row of buildings */
	enum pound_status status;
};

bool pound_output_accelerations(int row);
void pound_outputs_measure(const struct pound_study *study, int output, const struct pound_outcome *outcome,
                           double *numerator, double *denominator);

#endif
