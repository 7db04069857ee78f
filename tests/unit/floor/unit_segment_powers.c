/* unit_segment_powers.c - derivatives of powers at the start of segments of a piece, against factorials and the powers. */
#include <math.h>

#include "engine/floor/segment_powers.h"
#include "tests/support/check.h"

static struct pound_segment_powers powers;

static void the_whole_piece_gives_factorials(void **state)
{
	(void)state;
	pound_segment_powers_fill(&powers);
	for (int k = 0; k <= POUND_FLOOR_ORDER; k++)
		for (int m = 0; m < POUND_SEGMENT_DERIVATIVES; m++)
			check_near(powers.segment[1][k][m] / tgamma(k + 1), m == k, 1e-14);
	for (int n = 1; n <= POUND_SEGMENTS; n *= 2)
		for (int k = 0; k <= POUND_FLOOR_ORDER; k++)
			check_near(powers.start[n][k] * pow(n, k) / tgamma(k + 1), 1, 1e-14);
}

/* The series of a segment gives the power at the middle and at the end of the segment. */
static void the_series_of_a_segment_is_the_power(void **state)
{
	(void)state;
	pound_segment_powers_fill(&powers);
	for (int n = 1; n <= POUND_SEGMENTS; n *= 2)
		for (int j = 0; j < n; j++)
			for (int k = 0; k <= POUND_FLOOR_ORDER; k++)
				for (double s = 0.5; s <= 1; s += 0.5) {
					double sum = 0, term = 1;
					for (int m = 0; m <= k; term *= s / ++m)
						sum += powers.segment[n + j][k][m] * term;
					check_near(sum / pow((j + s) / n, k), 1, 2e-14);
				}
}

/* A segment begins with the values at the end of the preceding one. */
static void segments_begin_where_the_one_before_ends(void **state)
{
	(void)state;
	pound_segment_powers_fill(&powers);
	for (int n = 2; n <= POUND_SEGMENTS; n *= 2)
		for (int j = 1; j < n; j++)
			for (int k = 0; k <= POUND_FLOOR_ORDER; k++)
				check_near(powers.segment[n + j][k][0] / pow((double)j / n, k), 1, 1e-14);
}

CHECK_MAIN(cmocka_unit_test(the_whole_piece_gives_factorials),
           cmocka_unit_test(the_series_of_a_segment_is_the_power),
           cmocka_unit_test(segments_begin_where_the_one_before_ends))
