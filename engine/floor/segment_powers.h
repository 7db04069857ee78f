/* segment_powers.h - derivatives of powers of a piece's time at the starts of equal segments of the piece. */
#ifndef SEGMENT_POWERS_H
#define SEGMENT_POWERS_H

#include <stdalign.h>

#include "engine/floor/floor_pieces.h"

enum {
	POUND_SEGMENTS = 16,                          /* maximum of a piece; a power of two */
	POUND_SEGMENT_DERIVATIVES = POUND_FLOOR_ROOM, /* the 0th to the 23rd */
};

/* Segment j of n: [n + j][k][m] is d^m/ds^m t^k at the start of the segment; t is the elapsed fraction of the piece, s of the
 * segment.  In segment 0 of n only the m-th derivative of t^m, start[n][m], is not 0. */
struct pound_segment_powers {
	alignas(64) double number[POUND_SEGMENT_DERIVATIVES]; /* 0, 1, 2, .. */
	double start[POUND_SEGMENTS + 1][POUND_SEGMENT_DERIVATIVES];
	alignas(64) double segment[2 * POUND_SEGMENTS][POUND_FLOOR_ORDER + 1][POUND_SEGMENT_DERIVATIVES];
};

void pound_segment_powers_fill(struct pound_segment_powers *powers);

#endif
