/* unit_power_integrals.c - integrals of powers over segments of a piece, against factorials and against each other. */
#include <math.h>

#include "engine/floor/power_integrals.h"
#include "tests/support/check.h"

static struct pound_kernel kernel;

static void the_whole_piece_gives_factorials(void **state)
{
	(void)state;
	pound_kernel_fill(&kernel);
	for (int k = 0; k <= POUND_FLOOR_ORDER; k++)
		for (int m = 0; m < POUND_KERNEL_INTEGRALS; m++) {
			double exact = tgamma(k + 1) / tgamma(m + k + 2);
			check_near(kernel.segment[1][k][m] / exact, 1, 1e-14);
		}
}

/* Simpson's rule of (1 - s)^m/m! ((j + s)/n)^k, the m + 1 integrals in one. */
static void parts_give_the_integrals_of_cauchy(void **state)
{
	(void)state;
	pound_kernel_fill(&kernel);
	static const int orders[] = {0, 1, 5, 12};
	for (int n = 2; n <= POUND_KERNEL_SEGMENTS; n *= 2)
		for (int j = 0; j < n; j++)
			for (int i = 0; i < 4; i++)
				for (int m = 0; m < 4; m++) {
					double sum = 0, steps = 200;
					for (int t = 0; t <= 200; t++) {
						double s = t / steps, weight = t == 0 || t == 200 ? 1 : t % 2 ? 4 : 2;
						sum += weight * pow(1 - s, m) / tgamma(m + 1) * pow((j + s) / n, orders[i]) /
						       (3 * steps);
					}
					check_near(kernel.segment[n + j][orders[i]][m], sum, 1e-7);
				}
}

/* Simple integrals over the segments of a piece add up to that over the piece. */
static void parts_add_up(void **state)
{
	(void)state;
	pound_kernel_fill(&kernel);
	for (int n = 2; n <= POUND_KERNEL_SEGMENTS; n *= 2)
		for (int k = 0; k <= POUND_FLOOR_ORDER; k++) {
			double sum = 0;
			for (int j = 0; j < n; j++)
				sum += kernel.segment[n + j][k][0] / n;
			check_near(sum, 1.0 / (k + 1), 1e-15);
		}
}

CHECK_MAIN(cmocka_unit_test(the_whole_piece_gives_factorials),
           cmocka_unit_test(parts_give_the_integrals_of_cauchy), cmocka_unit_test(parts_add_up))
