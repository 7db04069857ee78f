/* normals.inl - standard normal numbers from Philox words.
 *
 *   1. the ten rounds of Philox4x32 over the counters of a chunk of draws
 *   2. Box-Muller: of each pair of words the first gives the radius, the second the angle
 *
 * Every loop over a chunk has a fixed length, so that compilers vectorize it; only the product of two 32-bit words needs
 * an intrinsic (vproduct), as compilers do not vectorize it.  No result depends on the vector width.
 * Box, Muller 1958, Ann. Math. Stat. 29, 610-611. */
#include "engine/ground/normals.h"

#include <math.h>
#include <stdalign.h>

#include "engine/numeric/elementary.h"
#include "engine/numeric/lanes.h"

/* The words of draws first .. first + NOISE_CHUNK - 1 (modulo 2^32), the same as from pound_random_words.
 *
 * Source   Salmon, Moraes, Dror, Shaw 2011, Parallel random numbers: as easy as 1, 2, 3, SC11, section 3.3
 * Test     unit_normals: chunks_hold_the_words_of_single_draws, by the normal numbers computed from them */
LANE_INLINE void words(struct pound_stream stream, uint32_t first, uint64_t w[NOISE_WORDS][NOISE_CHUNK])
{
	const philox4x32_ctr_t counter = pound_random_counter(stream, first);
	const philox4x32_key_t key = pound_random_key(stream);
	const vu zero = {0};
	for (int l = 0; l < NOISE_CHUNK; l++)
		w[0][l] = counter.v[0] + (uint32_t)l;
	// two vectors at a time, because each round waits for the previous one
	enum { TWO = 2 };
	for (int l = 0; l < NOISE_CHUNK; l += TWO * W) {
		vu x0[TWO], x1[TWO], x2[TWO], x3[TWO];
		for (int t = 0; t < TWO; t++) {
			x0[t] = *(vu *)&w[0][l + t * W];
			x1[t] = zero + counter.v[1];
			x2[t] = zero + counter.v[2];
			x3[t] = zero + counter.v[3];
		}
		uint32_t k0 = key.v[0], k1 = key.v[1];
		// 32-bit words in 64-bit elements, as vproduct needs them; the upper halves are arbitrary between rounds
#pragma GCC unroll 10
		for (int round = 0; round < 10; round++) {
#pragma GCC unroll 2
			for (int t = 0; t < TWO; t++) {
				const vu p0 = vproduct(x0[t], zero + PHILOX_M4x32_0),
				         p1 = vproduct(x2[t], zero + PHILOX_M4x32_1);
				x0[t] = p1 >> 32 ^ x1[t] ^ k0;
				x1[t] = p1;
				x2[t] = p0 >> 32 ^ x3[t] ^ k1;
				x3[t] = p0;
			}
			k0 += PHILOX_W32_0;
			k1 += PHILOX_W32_1;
		}
		for (int t = 0; t < TWO; t++) {
			const vu x[NOISE_WORDS] = {x0[t], x1[t], x2[t], x3[t]};
			for (int i = 0; i < NOISE_WORDS; i++)
				*(vu *)&w[i][l + t * W] = x[i] & UINT32_MAX;
		}
	}
}

/* (word + 1/2) / 2^32, in (0, 1): the word is put into the last bits of a double in [2^52, 2^53) */
static inline double fraction(uint64_t word)
{
	return (pound_elementary_double(word | 0x4330000000000000) - (0x1p52 - 0.5)) * 0x1p-32;
}

/* Independent standard normal numbers of a chunk of draws.
 *
 * Given    stream, first                            draws first .. first + NOISE_CHUNK - 1 of the stream
 * Returns  z         (NOISE_WORDS x NOISE_CHUNK)    z[w][l] is number w of draw first + l, for any lane width
 *
 *   z_w = sqrt(-2 ln u) cos 2 pi v,   z_w+1 = sqrt(-2 ln u) sin 2 pi v,   u, v from words w, w + 1
 *
 * Valid    |z| <= 6.77, as u >= 2^-33: a normal number exceeds that with probability 1 / 8e10.
 * Test     unit_normals */
void POUND_NORMALS(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK])
{
	alignas(sizeof(vu)) uint64_t word[NOISE_WORDS][NOISE_CHUNK];
	words(stream, first, word);
	// the square root has the longest latency: all roots first, then the angles
	double radius[NOISE_WORDS][NOISE_CHUNK];
	for (int w = 0; w < NOISE_WORDS; w += 2)
		for (int l = 0; l < NOISE_CHUNK; l++)
			radius[w][l] = sqrt(-2 * pound_elementary_log(fraction(word[w][l])));
	for (int w = 0; w < NOISE_WORDS; w += 2)
		for (int l = 0; l < NOISE_CHUNK; l++) {
			double sine, cosine;
			pound_elementary_sincos(fraction(word[w + 1][l]), &sine, &cosine);
			z[w][l] = radius[w][l] * cosine;
			z[w + 1][l] = radius[w][l] * sine;
		}
}
