/* outputs.h - outputs of a scene from its responses to signals. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "engine/pound.h"

/* The response of a scene under one signal. */
struct pound_outcome {
	const struct pound_scene *scene;
	const struct pound_response *pair;    /* of two oscillators */
	const struct pound_row_response *row; /* of a row of buildings */
	enum pound_status status;
};

/* Additional data that an output reads, beyond what every study computes. */
enum pound_output_ask {
	POUND_ASKS_RIGHT = 1,         /* the right body's displacements, with and without pounding */
	POUND_ASKS_ACCELERATIONS = 2, /* of floors */
	POUND_ASKS_FORCES = 4,        /* of contacts */
	POUND_ASKS_FREE_PAIR = 8,     /* both oscillators together without contact, observed */
	POUND_ASKS_ENERGIES = 16,     /* input and dissipated */
	POUND_ASKS_STILL = 32, /* approach speeds and residual displacements, available in every chain run */
	POUND_ASKS_FREE_FLOORS = 64, /* accelerations without pounding */
	// for any of these two oscillators are run as a row of one-story buildings
	POUND_ASKS_CHAIN = POUND_ASKS_ACCELERATIONS | POUND_ASKS_FORCES | POUND_ASKS_ENERGIES | POUND_ASKS_STILL,
};

unsigned pound_outputs_asked(const struct pound_study *study); /* bits */
void pound_outputs_measure(const struct pound_study *study, int output, const struct pound_outcome *outcome,
                           double *numerator, double *denominator);

#endif
