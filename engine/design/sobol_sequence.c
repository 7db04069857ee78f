/* sobol_sequence.c - randomly scrambled Sobol' points.
 *
 * 1. A column has 32 direction numbers; point i is the exclusive or of the direction numbers of the set bits of i.
 * 2. A scramble adds to every binary digit of a point (modulo 2) a random subset of the digits before it and a random digit.
 *
 * A point is computed without the points before it.  Each block of 2^m points, from a multiple of 2^m on, is a (t, m, s)-net
 * in base 2; a scramble keeps this property, and makes every single point uniformly distributed.
 *
 * Sobol' 1967, USSR Comput. Math. Math. Phys. 7(4), 86-112.  Scramble: Matousek 1998, J. Complexity 14, 527-556. */
#include "engine/design/sobol_sequence.h"

enum { DEGREE_MAX = 9 };

/* Primitive polynomials x^s + a_1 x^(s-1) + ... + 1 over the field of two elements, with a = a_1 .. a_(s-1) in binary, and
 * the first s direction numbers m_k < 2^k, odd.  Row k is for column k + 1; column 0 is the van der Corput sequence.
 *
 * Source   Joe, Kuo 2008, SIAM J. Sci. Comput. 30, 2635-2654: their table "new-joe-kuo-6", dimensions 2 to 64
 * Test     unit_sobol_sequence: polynomials_are_primitive_and_each_is_used_once */
// clang-format off
static const struct polynomial {
	int degree, a, m[DEGREE_MAX];
} polynomials[POUND_SEQUENCE_COLUMNS - 1] = {
	{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}},
	{4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}},
	{5, 2, {1, 1, 5, 5, 17}}, {5, 4, {1, 1, 5, 5, 5}}, {5, 7, {1, 1, 7, 11, 19}},
	{5, 11, {1, 1, 5, 1, 1}}, {5, 13, {1, 1, 1, 3, 11}}, {5, 14, {1, 3, 5, 5, 31}},
	{6, 1, {1, 3, 3, 9, 7, 49}}, {6, 13, {1, 1, 1, 15, 21, 21}}, {6, 16, {1, 3, 1, 13, 27, 49}},
	{6, 19, {1, 1, 1, 15, 7, 5}}, {6, 22, {1, 3, 1, 15, 13, 25}}, {6, 25, {1, 1, 5, 5, 19, 61}},
	{7, 1, {1, 3, 7, 11, 23, 15, 103}}, {7, 4, {1, 3, 7, 13, 13, 15, 69}}, {7, 7, {1, 1, 3, 13, 7, 35, 63}},
	{7, 8, {1, 3, 5, 9, 1, 25, 53}}, {7, 14, {1, 3, 1, 13, 9, 35, 107}}, {7, 19, {1, 3, 1, 5, 27, 61, 31}},
	{7, 21, {1, 1, 5, 11, 19, 41, 61}}, {7, 28, {1, 3, 5, 3, 3, 13, 69}}, {7, 31, {1, 1, 7, 13, 1, 19, 1}},
	{7, 32, {1, 3, 7, 5, 13, 19, 59}}, {7, 37, {1, 1, 3, 9, 25, 29, 41}}, {7, 41, {1, 3, 5, 13, 23, 1, 55}},
	{7, 42, {1, 3, 7, 3, 13, 59, 17}},
	{7, 50, {1, 3, 1, 3, 5, 53, 69}}, {7, 55, {1, 1, 5, 5, 23, 33, 13}}, {7, 56, {1, 1, 7, 7, 1, 61, 123}},
	{7, 59, {1, 1, 7, 9, 13, 61, 49}}, {7, 62, {1, 3, 3, 5, 3, 55, 33}}, {8, 14, {1, 3, 1, 15, 31, 13, 49, 245}},
	{8, 21, {1, 3, 5, 15, 31, 59, 63, 97}}, {8, 22, {1, 3, 1, 11, 11, 11, 77, 249}}, {8, 38, {1, 3, 1, 11, 27, 43, 71, 9}},
	{8, 47, {1, 1, 7, 15, 21, 11, 81, 45}}, {8, 49, {1, 3, 7, 3, 25, 31, 65, 79}}, {8, 50, {1, 3, 1, 1, 19, 11, 3, 205}},
	{8, 52, {1, 1, 5, 9, 19, 21, 29, 157}}, {8, 56, {1, 3, 7, 11, 1, 33, 89, 185}}, {8, 67, {1, 3, 3, 3, 15, 9, 79, 71}},
	{8, 70, {1, 3, 7, 11, 15, 39, 119, 27}}, {8, 84, {1, 1, 3, 1, 11, 31, 97, 225}}, {8, 97, {1, 1, 1, 3, 23, 43, 57, 177}},
	{8, 103, {1, 3, 7, 7, 17, 17, 37, 71}}, {8, 115, {1, 3, 1, 5, 27, 63, 123, 213}}, {8, 122, {1, 1, 3, 5, 11, 43, 53, 133}},
	{9, 8, {1, 3, 5, 5, 29, 17, 47, 173, 479}}, {9, 13, {1, 3, 3, 11, 3, 1, 109, 9, 69}}, {9, 16, {1, 1, 1, 5, 17, 39, 23, 5, 343}},
	{9, 22, {1, 3, 1, 5, 25, 15, 31, 103, 499}}, {9, 25, {1, 1, 1, 11, 11, 17, 63, 105, 183}}, {9, 44, {1, 1, 5, 11, 9, 29, 97, 231, 363}},
	{9, 47, {1, 1, 5, 15, 19, 45, 41, 7, 383}}, {9, 52, {1, 3, 7, 7, 31, 19, 83, 137, 221}}, {9, 55, {1, 1, 1, 3, 23, 15, 111, 223, 83}},
	{9, 59, {1, 1, 5, 13, 31, 15, 55, 25, 161}}, {9, 62, {1, 1, 3, 13, 25, 47, 39, 87, 257}},
};
// clang-format on

/* Direction numbers of a column, without scrambling.
 *
 * Given    column   -      -      [0, POUND_SEQUENCE_COLUMNS)
 * Returns  net      -      -      v_k = m_k / 2^k as 32 binary digits, the first one in the highest bit; no shift
 *
 *   v_k = a_1 v_(k-1) + ... + a_(s-1) v_(k-s+1) + v_(k-s) + v_(k-s) / 2^s        (sums without carry)
 *
 * Source   Bratley, Fox 1988, ACM Trans. Math. Softw. 14, 88-100
 * Test     unit_sobol_sequence: elementary_intervals_hold_equally_many_points
 */
void pound_sequence_init(struct pound_sequence *net, int column)
{
	assert(column >= 0 && column < POUND_SEQUENCE_COLUMNS);
	const struct polynomial *p = column ? &polynomials[column - 1] : NULL;
	const int s = p ? p->degree : 0;
	uint32_t *v = net->direction;
	net->shift = 0;
	for (int k = 0; k < POUND_SEQUENCE_DIGITS; k++) {
		const uint32_t first = UINT32_C(1) << (POUND_SEQUENCE_DIGITS - 1 - k);
		if (k < s || !p) {
			v[k] = p ? (uint32_t)p->m[k] * first : first;
			continue;
		}
		v[k] = v[k - s] ^ v[k - s] >> s;
		for (int i = 1; i < s; i++)
			v[k] ^= p->a >> (s - 1 - i) & 1 ? v[k - i] : 0;
	}
}

/* Scrambles a column.
 *
 * Given    stream   -      -      another stream gives an independent scramble
 * Returns  net      -      -      digit k plus a random subset of the digits before it plus a random digit, modulo 2
 *
 * Source   Matousek 1998, J. Complexity 14, 527-556: random linear scrambling with a digital shift; the mean of a function
 *          over the points has the same variance as with nested uniform scrambling (Owen 1995)
 * Test     unit_sobol_sequence: a_scramble_keeps_elementary_intervals
 */
void pound_sequence_scramble(struct pound_sequence *net, struct pound_stream stream)
{
	uint32_t digits[POUND_SEQUENCE_DIGITS] = {0};
	for (int k = 0; k < POUND_SEQUENCE_DIGITS; k++) {
		const int place = POUND_SEQUENCE_DIGITS - 1 - k;
		// the digit and a random subset of the digits before it
		const uint32_t random = pound_random_words(stream, (uint32_t)k / 4).v[k % 4];
		const uint32_t taken = (random & -(UINT32_C(2) << place)) | UINT32_C(1) << place;
		for (int i = 0; i < POUND_SEQUENCE_DIGITS; i++)
			digits[i] |= (uint32_t)__builtin_parity(net->direction[i] & taken) << place;
	}
	for (int i = 0; i < POUND_SEQUENCE_DIGITS; i++)
		net->direction[i] = digits[i];
	net->shift = pound_random_words(stream, POUND_SEQUENCE_DIGITS / 4).v[0];
}

/* A point of a column: the middle of the interval of length 2^-32 that its digits define. */
double pound_sequence_point(const struct pound_sequence *net, uint32_t number)
{
	uint32_t digits = net->shift;
	for (int k = 0; number; k++, number >>= 1)
		digits ^= number & 1 ? net->direction[k] : 0;
	return ((double)digits + 0.5) * 0x1p-32;
}
