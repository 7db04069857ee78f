/* unit_segment_powers.c - derivatives of powers where segments of a piece begin, against factorials and the powers themselves. */
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

/* The series of a segment gives the power at its middle and at its end. */
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

/* Where it begins a segment takes on from the one before. */
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
