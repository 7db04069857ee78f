/* segment_powers.h - derivatives of the powers of a polynomial over a piece where equal segments of the piece begin. */
#ifndef SEGMENT_POWERS_H
#define SEGMENT_POWERS_H

#include <stdalign.h>

#include "engine/floor/floor_pieces.h"

enum {
	POUND_SEGMENTS = 16,                          /* of a piece, at most; a power of two */
	POUND_SEGMENT_DERIVATIVES = POUND_FLOOR_ROOM, /* the 0th to the 23rd */
};

/* Segment j of n: [n + j][k][m] is the m-th derivative of t^k where it begins, t the piece's share of time and the segment's
 * own share that of the derivatives.  Of the first of n that of t^m is start[n][m], and all others are 0. */
struct pound_segment_powers {
	alignas(64) double number[POUND_SEGMENT_DERIVATIVES]; /* 0, 1, 2, .. */
	double start[POUND_SEGMENTS + 1][POUND_SEGMENT_DERIVATIVES];
	alignas(64) double segment[2 * POUND_SEGMENTS][POUND_FLOOR_ORDER + 1][POUND_SEGMENT_DERIVATIVES];
};

void pound_segment_powers_fill(struct pound_segment_powers *powers);

#endif
