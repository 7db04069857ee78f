/* sobol_sequence.h - columns (dimensions) of scrambled Sobol' sequences; points are computed by their number. */
#ifndef SOBOL_SEQUENCE_H
#define SOBOL_SEQUENCE_H

#include "engine/numeric/random.h"

enum {
	POUND_SEQUENCE_COLUMNS = 64,
	POUND_SEQUENCE_DIGITS = 32, /* binary digits of a point and of its number */
};

struct pound_sequence {
	uint32_t direction
	    [POUND_SEQUENCE_DIGITS]; /* [k]: digits that bit k of a point's number adds (exclusive or), highest first */
	uint32_t shift;              /* added to every point (exclusive or) */
};

void pound_sequence_init(struct pound_sequence *net, int column);
void pound_sequence_scramble(struct pound_sequence *net, struct pound_stream stream);
double pound_sequence_point(const struct pound_sequence *net, uint32_t number); /* in (0, 1) */

#endif
