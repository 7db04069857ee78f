/* power_integrals.h - what the powers of a polynomial over a piece contribute to its integrals over equal segments of the piece. */
#ifndef POWER_INTEGRALS_H
#define POWER_INTEGRALS_H

#include <stdalign.h>

#include "engine/floor/floor_pieces.h"

enum {
	POUND_KERNEL_SEGMENTS = 16,  /* of a piece, at most; a power of two */
	POUND_KERNEL_INTEGRALS = 24, /* once to as many times, whole vectors of eight */
};

/* Part j of n: [n + j][k][m] is the (m + 1)-fold integral of t^k over it, t the piece's time and the segment's own time
 * that of the integrals. */
struct pound_kernel {
	alignas(64) double segment[2 * POUND_KERNEL_SEGMENTS][POUND_FLOOR_ORDER + 1][POUND_KERNEL_INTEGRALS];
};

void pound_kernel_fill(struct pound_kernel *kernel);

#endif
