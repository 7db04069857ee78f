/* segment_powers.c - derivatives of powers at the starts of segments of a piece. */
#include "engine/floor/segment_powers.h"

#include <string.h>

/* All segments, for each number n of segments that is a power of two.
 *
 *   t = (j + s)/n     d^m/ds^m t^k = k!/(k - m)! (j/n)^(k - m) n^-m  at s = 0
 *
 * Valid    exact except for rounding
 * Test     unit_segment_powers
 */
void pound_segment_powers_fill(struct pound_segment_powers *powers)
{
	memset(powers, 0, sizeof *powers);
	for (int m = 0; m < POUND_SEGMENT_DERIVATIVES; m++)
		powers->number[m] = m;
	for (int n = 1; n <= POUND_SEGMENTS; n *= 2)
		for (int j = 0; j < n; j++)
			for (int k = 0; k <= POUND_FLOOR_ORDER; k++) {
				double falling = 1; // k!/(k - m)! n^-m
				for (int m = 0; m <= k; m++) {
					double power = falling;
					for (int e = 0; e < k - m; e++)
						power *= (double)j / n;
					powers->segment[n + j][k][m] = power;
					falling *= (double)(k - m) / n;
				}
				powers->start[n][k] = powers->segment[n][k][k];
			}
}
