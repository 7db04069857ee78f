/* Standard normal numbers from Philox words.
 *
 *   1. the ten rounds of Philox4x32 over the counters of a chunk of draws
 *   2. Box-Muller: of each two words one gives the radius, the other the angle
 *
 * Every loop runs over a chunk of fixed length, so that compilers make vector instructions of it; no result
 * depends on how wide they are.
 * Box, Muller 1958, Ann. Math. Stat. 29, 610-611. */
#include "engine/noise.h"

#include <math.h>

#include "engine/elementary.h"

/* The words of draws first .. first + NOISE_CHUNK - 1 (modulo 2^32), as pound_random_words gives each of
 * them.
 *
 * Source   Salmon, Moraes, Dror, Shaw 2011, Parallel random numbers: as easy as 1, 2, 3, SC11, section 3.3
 * Test     unit_noise: chunks_hold_the_words_of_single_draws, through the normals made of them */
static inline __attribute__((always_inline)) void words(struct pound_stream stream, uint32_t first,
                                                        uint64_t w[NOISE_WORDS][NOISE_CHUNK])
{
	const uint64_t low = 0xffffffff;
	const philox4x32_ctr_t counter = pound_random_counter(stream, first);
	const philox4x32_key_t key = pound_random_key(stream);
	for (int l = 0; l < NOISE_CHUNK; l++) {
		uint64_t x0 = counter.v[0] + (uint32_t)l, x1 = counter.v[1], x2 = counter.v[2], x3 = counter.v[3];
		uint32_t k0 = key.v[0], k1 = key.v[1];
		// words in 64 bits, so that vectors keep them in place; the upper halves are rubbish between rounds
#pragma GCC unroll 10
		for (int round = 0; round < 10; round++) {
			const uint64_t p0 = (x0 & low) * PHILOX_M4x32_0, p1 = (x2 & low) * PHILOX_M4x32_1;
			x0 = p1 >> 32 ^ x1 ^ k0;
			x1 = p1;
			x2 = p0 >> 32 ^ x3 ^ k1;
			x3 = p0;
			k0 += PHILOX_W32_0;
			k1 += PHILOX_W32_1;
		}
		w[0][l] = x0 & low;
		w[1][l] = x1 & low;
		w[2][l] = x2 & low;
		w[3][l] = x3 & low;
	}
}

/* (word + 1/2) / 2^32, in (0, 1): the word becomes the last bits of a number between 2^52 and 2^53 */
static inline double fraction(uint64_t word)
{
	return (pound_elementary_double(word | 0x4330000000000000) - (0x1p52 - 0.5)) * 0x1p-32;
}

static inline __attribute__((always_inline)) void normals(struct pound_stream stream, uint32_t first,
                                                          double z[NOISE_WORDS][NOISE_CHUNK])
{
	uint64_t word[NOISE_WORDS][NOISE_CHUNK];
	words(stream, first, word);
	for (int w = 0; w < NOISE_WORDS; w += 2)
		for (int l = 0; l < NOISE_CHUNK; l++) {
			double sine, cosine;
			const double radius = sqrt(-2 * pound_elementary_log(fraction(word[w][l])));
			pound_elementary_sincos(fraction(word[w + 1][l]), &sine, &cosine);
			z[w][l] = radius * cosine;
			z[w + 1][l] = radius * sine;
		}
}

/* the same operations on eight, four and two numbers at a time */
__attribute__((target("avx512dq,avx512vl"))) static void
normals_of_8(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK])
{
	normals(stream, first, z);
}

__attribute__((target("avx2"))) static void normals_of_4(struct pound_stream stream, uint32_t first,
                                                         double z[NOISE_WORDS][NOISE_CHUNK])
{
	normals(stream, first, z);
}

static void normals_of_2(struct pound_stream stream, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK])
{
	normals(stream, first, z);
}

/* The widest vectors of this processor, as the number of doubles in one. */
int pound_noise_width(void)
{
	if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
		return 8;
	return __builtin_cpu_supports("avx2") ? 4 : 2;
}

/* Independent standard normal numbers of a chunk of draws.
 *
 * Given    width                                    pound_noise_width() or less
 *          stream, first                            draws first .. first + NOISE_CHUNK - 1 of the stream
 * Returns  z         (NOISE_WORDS x NOISE_CHUNK)    z[w][l] is number w of draw first + l, whatever the width
 *
 *   z_w = sqrt(-2 ln u) cos 2 pi v,   z_w+1 = sqrt(-2 ln u) sin 2 pi v,   u, v from words w, w + 1
 *
 * Valid    |z| <= 6.77, as u >= 2^-33: a true normal number goes beyond that once in 8e10.
 * Test     unit_noise */
void pound_noise_normals(int width, struct pound_stream stream, uint32_t first,
                         double z[NOISE_WORDS][NOISE_CHUNK])
{
	(width == 8 ? normals_of_8 : width == 4 ? normals_of_4 : normals_of_2)(stream, first, z);
}
