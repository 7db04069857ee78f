/* normals.h - independent standard normal numbers of a random stream, in chunks. */
#ifndef NORMALS_H
#define NORMALS_H

#include "engine/numeric/random.h"

enum {
	NOISE_WORDS = 4,  /* normal numbers of one draw */
	NOISE_CHUNK = 32, /* draws computed at a time */
};

/* z[w][l]: normal number w of draw first + l, the same bits at any width  (NOISE_WORDS x NOISE_CHUNK).
 * normals.inl, compiled once for each width of cpu_width.h. */
void pound_normals_w8(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK]);
void pound_normals_w4(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK]);
void pound_normals_w1(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK]);
void pound_normals_portable(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK]);

#endif
