/* power_integrals.c - integrals of powers over segments of a piece. */
#include "engine/floor/power_integrals.h"

#include <string.h>

/* Adds (j + s)^k/n^k, by its powers of s, integrated m + 1 times over s from 0 to 1.
 *
 *   t^k = sum C(k, i) (j/n)^(k - i) (s/n)^i     the (m + 1)-fold integral of s^i is i!/(m + i + 1)!
 */
static void power_fill(int j, int n, int k, double out[POUND_KERNEL_INTEGRALS])
{
	double from = (double)j / n, binomial = 1, own = 1;
	for (int i = 0; i <= k; i++) {
		double weight = binomial * own, term = 1;
		for (int e = 0; e < k - i; e++)
			weight *= from;
		for (int m = 0; m < POUND_KERNEL_INTEGRALS; m++) {
			term /= m == 0 ? i + 1 : m + i + 1;
			out[m] += weight * term;
		}
		binomial = binomial * (k - i) / (i + 1);
		own /= n;
	}
}

/* All segments of all powers of two.
 *
 * Valid    every term is positive: exact but for rounding
 * Test     unit_power_integrals
 */
void pound_kernel_fill(struct pound_kernel *kernel)
{
	memset(kernel, 0, sizeof *kernel);
	for (int n = 1; n <= POUND_KERNEL_SEGMENTS; n *= 2)
		for (int j = 0; j < n; j++)
			for (int k = 0; k <= POUND_FLOOR_ORDER; k++)
				power_fill(j, n, k, kernel->segment[n + j][k]);
}
