/* random.h - counter-based random numbers: they depend on where they are used, not on the order of the calls.
 *
 * The address of a draw is a stream (seed, what, row, sample, signal) and an index k.  The seed is the key of a Philox4x32-10
 * permutation, the remaining address its counter.  No state; any thread.
 * Salmon, Moraes, Dror, Shaw 2011, Parallel random numbers: as easy as 1, 2, 3, SC11. */
#ifndef RANDOM_H
#define RANDOM_H

#include <assert.h>
#include <stdint.h>

#include <Random123/philox.h>

/* purpose of a stream  < 2^8 */
enum {
	POUND_STREAM_NOISE = 1,
	POUND_STREAM_DESIGN,
	POUND_STREAM_BOOTSTRAP,
	POUND_STREAM_RECORD,
	POUND_STREAM_SHUFFLE
};

struct pound_stream {
	uint64_t seed;
	uint32_t what;   /* one of the enum above */
	uint32_t row;    /* of the design */
	uint32_t sample; /* of the row; in a design: the input  < 2^24 */
	uint32_t signal; /* of the sample */
};

static inline philox4x32_key_t pound_random_key(struct pound_stream s)
{
	return (philox4x32_key_t){{(uint32_t)s.seed, (uint32_t)(s.seed >> 32)}};
}

static inline philox4x32_ctr_t pound_random_counter(struct pound_stream s, uint32_t k)
{
	assert(s.what < 1u << 8 && s.sample < 1u << 24);
	return (philox4x32_ctr_t){{k, s.row, s.what << 24 | s.sample, s.signal}};
}

/* Draw k of a stream: four independent 32-bit words. */
static inline philox4x32_ctr_t pound_random_words(struct pound_stream s, uint32_t k)
{
	return philox4x32_R(10, pound_random_counter(s, k), pound_random_key(s));
}

/* Draw k as a number in (0, 1): an odd multiple of 2^-53, so never 0 or 1, and the mean is exactly 1/2. */
static inline double pound_random_uniform(struct pound_stream s, uint32_t k)
{
	const philox4x32_ctr_t r = pound_random_words(s, k);
	const uint64_t bits = (uint64_t)r.v[1] << 32 | r.v[0];
	return ((double)(int64_t)(bits >> 12) + 0.5) * 0x1p-52;
}

/* Draw k as an integer in [0, n), n >= 1, all equally likely: the high half of word * n; a word is rejected if the low half is
 * less than 2^32 mod n.  If all four words are rejected, the permutation is applied to them for four more.
 * Lemire 2019, ACM Trans. Model. Comput. Simul. 29(1), 3. */
static inline uint32_t pound_random_below(struct pound_stream s, uint32_t k, uint32_t n)
{
	const uint32_t surplus = -n % n;
	const philox4x32_key_t key = pound_random_key(s);
	philox4x32_ctr_t r = pound_random_counter(s, k);
	for (;;) {
		r = philox4x32_R(10, r, key);
		for (int i = 0; i < 4; i++) {
			const uint64_t m = (uint64_t)r.v[i] * n;
			if ((uint32_t)m >= surplus)
				return (uint32_t)(m >> 32);
		}
	}
}

#endif
