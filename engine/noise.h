/* noise.h - independent standard normal numbers, a chunk of a stream at a time. */
#ifndef NOISE_H
#define NOISE_H

#include "engine/random.h"

enum {
	NOISE_WORDS = 4,  /* normals of one draw */
	NOISE_CHUNK = 32, /* draws computed at a time */
};

/* z[w][l]: normal w of draw first + l  (NOISE_WORDS x NOISE_CHUNK) */
void pound_noise_normals(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK]);

#endif
