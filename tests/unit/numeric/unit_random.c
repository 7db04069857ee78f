/* Philox against the vectors published by its authors; the numbers made from it against exact counts and moments. */
#include <math.h>
#include <string.h>

#include "engine/numeric/random.h"
#include "tests/support/check.h"

static const struct pound_stream stream = {
    .seed = 42, .what = POUND_STREAM_DESIGN, .row = 7, .sample = 3, .signal = 1};

/* Random123 1.14, tests/kat_vectors, lines "philox4x32 10": counter, key, result */
static const struct {
	philox4x32_ctr_t counter;
	philox4x32_key_t key;
	philox4x32_ctr_t words;
} published[] = {
    {{{0, 0, 0, 0}}, {{0, 0}}, {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}},
    {{{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}},
     {{0xffffffff, 0xffffffff}},
     {{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}}},
    {{{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}},
     {{0xa4093822, 0x299f31d0}},
     {{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}},
};

static void philox_gives_the_published_words(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
		const philox4x32_ctr_t got = philox4x32_R(10, published[i].counter, published[i].key);
		assert_memory_equal(got.v, published[i].words.v, sizeof got.v);
	}
	// a stream is this counter and key: `what` = 0x13 and sample 0x198a2e share a word
	const struct pound_stream s = {.seed = 0x299f31d0a4093822,
	                               .what = 0x13,
	                               .row = 0x85a308d3,
	                               .sample = 0x198a2e,
	                               .signal = 0x03707344};
	const philox4x32_ctr_t got = pound_random_words(s, 0x243f6a88);
	assert_memory_equal(got.v, published[2].words.v, sizeof got.v);
}

static void every_part_of_the_address_changes_the_counter_or_the_key(void **state)
{
	(void)state;
	struct pound_stream s[7];
	for (int i = 0; i < 7; i++)
		s[i] = stream;
	s[1].seed ^= 1;
	s[2].seed ^= (uint64_t)1 << 63;
	s[3].what = POUND_STREAM_NOISE;
	s[4].row++;
	s[5].sample++;
	s[6].signal++;
	for (int i = 0; i < 7; i++)
		for (int j = 0; j < 7; j++) {
			const philox4x32_ctr_t a = pound_random_words(s[i], 5), b = pound_random_words(s[j], 5);
			const philox4x32_ctr_t c = pound_random_words(s[j], 6);
			assert_true((memcmp(a.v, b.v, sizeof a.v) == 0) == (i == j));
			assert_true(memcmp(a.v, c.v, sizeof a.v) != 0);
		}
}

static void uniform_numbers_have_the_moments_of_the_uniform_law(void **state)
{
	(void)state;
	enum { N = 100000 };
	double sum = 0, sum2 = 0, lagged = 0, before = 0.5;
	for (int k = 0; k < N; k++) {
		const double u = pound_random_uniform(stream, (uint32_t)k);
		assert_true(u > 0 && u < 1);
		sum += u - 0.5;
		sum2 += (u - 0.5) * (u - 0.5);
		lagged += (u - 0.5) * (before - 0.5);
		before = u;
	}
	// 5 standard errors: variances 1/12, 1/180, 1/144 of one term
	check_near(sum / N, 0, 5 * sqrt(1.0 / 12 / N));
	check_near(sum2 / N, 1.0 / 12, 5 * sqrt(1.0 / 180 / N));
	check_near(lagged / N, 0, 5 * sqrt(1.0 / 144 / N));
}

static void whole_numbers_below_a_bound_are_equally_likely(void **state)
{
	(void)state;
	enum { BOUND = 7, N = 70000 };
	int count[BOUND] = {0};
	for (int k = 0; k < N; k++)
		count[pound_random_below(stream, (uint32_t)k, BOUND)]++;
	double chi2 = 0;
	for (int i = 0; i < BOUND; i++)
		chi2 += (count[i] - N / BOUND) * (double)(count[i] - N / BOUND) / (N / BOUND);
	assert_true(chi2 < 30.7); /* 6 degrees of freedom: exceeded for 3 seeds in 100,000 */
	assert_int_equal(pound_random_below(stream, 0, 1), 0);
}

/* With n = 3 * 2^30 a quarter of the words must be rejected; otherwise every third number would be twice as frequent
 * as the others. */
static void words_beyond_the_last_multiple_of_the_bound_are_refused(void **state)
{
	(void)state;
	enum { N = 30000 };
	int count[3] = {0};
	for (int k = 0; k < N; k++)
		count[pound_random_below(stream, (uint32_t)k, 3u << 30) % 3]++;
	for (int i = 0; i < 3; i++)
		check_near(count[i], N / 3.0, 5 * sqrt(N * 2 / 9.0));
}

CHECK_MAIN(cmocka_unit_test(philox_gives_the_published_words),
           cmocka_unit_test(every_part_of_the_address_changes_the_counter_or_the_key),
           cmocka_unit_test(uniform_numbers_have_the_moments_of_the_uniform_law),
           cmocka_unit_test(whole_numbers_below_a_bound_are_equally_likely),
           cmocka_unit_test(words_beyond_the_last_multiple_of_the_bound_are_refused))
