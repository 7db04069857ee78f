/* elementary.h - logarithm, exponential, sine and cosine from +, -, *, / only.
 *
 * Functions of the C library differ between machines in the last bit; these give the same bits everywhere.
 * No branches and no conversions of 64-bit integers, so compilers vectorize loops over arrays.
 * The polynomials interpolate at Chebyshev points; their approximation error is below 0.2 ulp. */
#ifndef ELEMENTARY_H
#define ELEMENTARY_H

#include <stdint.h>
#include <string.h>

static inline uint64_t pound_elementary_bits(double x)
{
	uint64_t bits;
	memcpy(&bits, &x, sizeof bits);
	return bits;
}

static inline double pound_elementary_double(uint64_t bits)
{
	double x;
	memcpy(&x, &bits, sizeof x);
	return x;
}

/* Natural logarithm to 2 ulp; x > 0, finite and normal.
 *
 *   x = 2^e m, m in [1/sqrt 2, sqrt 2)     f = m - 1     s = f / (2 + f)
 *   ln m = 2 artanh s = 2 s + s z L(z) = f - s (f - z L(z)),   z = s^2 */
static inline double pound_elementary_log(double x)
{
	const uint64_t half_root = 0x3fe6a09e667f3bcd; /* 1/sqrt 2 */
	const uint64_t scaled = pound_elementary_bits(x) - half_root + ((uint64_t)1023 << 52);
	const double f = pound_elementary_double((scaled & 0x000fffffffffffff) + half_root) - 1;
	// the bits of 2^52 + biased exponent
	const double e = pound_elementary_double((scaled >> 52) | 0x4330000000000000) - (0x1p52 + 1023);
	const double s = f / (2 + f), z = s * s;
	// sums in pairs (Estrin) shorten the chain of dependent operations
	const double z2 = z * z;
	const double l01 = 0x1.5555555555558p-1 + z * 0x1.9999999995273p-2;
	const double l23 = 0x1.2492492dfd86cp-2 + z * 0x1.c71c62d5e53e0p-3;
	const double l45 = 0x1.7462b91b8df65p-3 + z * 0x1.39fdcceb4bb45p-3;
	const double l = l01 + z2 * (l23 + z2 * (l45 + z2 * 0x1.2b5f68a50d903p-3));
	// ln 2 as the sum of two doubles; e times the first one is exact
	return e * 0x1.62e42fefa3800p-1 + (f - (s * (f - z * l) - e * 0x1.ef35793c76730p-45));
}

/* Sine and cosine of 2 pi x to 2 ulp, |x| < 2^49.
 *
 *   4 x = q + r, q an integer, |r| <= 1/2     sin(pi/2 r) = r (pi/2 + z S(z)),   cos(pi/2 r) = 1 + z C(z),   z = r^2
 *   odd q: sine and cosine are swapped;  q mod 4 = 2, 3: the sine changes its sign;  q mod 4 = 1, 2: the cosine does. */
static inline void pound_elementary_sincos(double x, double *sine, double *cosine)
{
	const double shifted = 4 * x + 0x1.8p52;
	const uint64_t q = pound_elementary_bits(shifted);
	const double r = 4 * x - (shifted - 0x1.8p52), z = r * r;
	const double z2 = z * z;
	const double s01 = -0x1.4abbce625be52p-1 + z * 0x1.466bc6775a476p-4;
	const double s23 = -0x1.32d2cce500387p-8 + z * 0x1.50783208843ebp-13;
	const double s45 = -0x1.e3027dea82bd7p-19 + z * 0x1.e4a9d9166f052p-25;
	const double s = s01 + z2 * (s23 + z2 * s45);
	const double c01 = -0x1.3bd3cc9be45dep+0 + z * 0x1.03c1f081b5ac0p-2;
	const double c23 = -0x1.55d3c7e3cb241p-6 + z * 0x1.e1f5068688d5bp-11;
	const double c45 = -0x1.a6d1eef479be1p-16 + z * 0x1.f9ce245cada0bp-22;
	const double c = c01 + z2 * (c23 + z2 * (c45 - z2 * 0x1.b2f3eb054afcdp-28));
	const uint64_t a = pound_elementary_bits(r * (0x1.921fb54442d18p+0 + z * s));
	const uint64_t b = pound_elementary_bits(1 + z * c);
	const uint64_t swap = (a ^ b) & (0 - (q & 1));
	*sine = pound_elementary_double((a ^ swap) ^ (q & 2) << 62);
	*cosine = pound_elementary_double((b ^ swap) ^ ((q + 1) & 2) << 62);
}

/* e^x to 2 ulp, |x| < 708.
 *
 *   x = k ln 2 + r, |r| <= ln 2/2     e^x = 2^k (1 + r + r^2/2! + ... + r^13/13!) */
static inline double pound_elementary_exp(double x)
{
	static const double share[] = {1.0 / 13, 1.0 / 12, 1.0 / 11, 1.0 / 10, 1.0 / 9, 1.0 / 8,
	                               1.0 / 7,  1.0 / 6,  1.0 / 5,  1.0 / 4,  1.0 / 3, 1.0 / 2};
	const double shifted = x * 0x1.71547652b82fep+0 + 0x1.8p52, k = shifted - 0x1.8p52;
	const double r = (x - k * 0x1.62e42fefa3800p-1) - k * 0x1.ef35793c76730p-45; // ln 2 as two doubles
	double sum = 1;
	for (int n = 0; n < 12; n++)
		sum = 1 + r * share[n] * sum;
	// the integer k is in the last bits of `shifted`
	const uint64_t power = (pound_elementary_bits(shifted) + 1023) << 52;
	return pound_elementary_double(power) * (1 + r * sum);
}

#endif
