/* request_motions.h - the ground motions that a block of a study needs. */
#ifndef REQUEST_MOTIONS_H
#define REQUEST_MOTIONS_H

#include "engine/ground/excitation.h"

struct pound_motion {
	struct pound_excitation excitation;
	struct pound_stream noise;
	bool halved; /* with an interpolated sample between every two */
	int n_samples;
	double time_step; /* [s] */
	int number;       /* index in the block */
	int exponent;     /* samples are scaled by 2^-exponent, so that the largest is in [1, 2) */
	double *ground;   /* (n_samples) */
};

void pound_motions_fill(struct pound_motion *motions, int n, bool scaled, double *ground, int64_t n_ground);

#endif
