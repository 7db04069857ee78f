/* Normal numbers against Box-Muller with the C library's functions, and against the normal distribution. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/ground/normals.h"
#include "engine/numeric/cpu_width.h"
#include "tests/support/check.h"

static const struct pound_stream stream = {
    .seed = 42, .what = POUND_STREAM_NOISE, .row = 7, .sample = 3, .signal = 1};

enum { CHUNKS = 1000, DRAWS = CHUNKS * NOISE_CHUNK, NUMBERS = DRAWS * NOISE_WORDS };

static double number[NUMBERS]; /* (DRAWS x NOISE_WORDS) */

static void fill(int width, uint32_t first, double z[NOISE_WORDS][NOISE_CHUNK])
{
	static void (*const of[POUND_WIDTHS])(struct pound_stream, uint32_t, double[NOISE_WORDS][NOISE_CHUNK]) = {
	    pound_normals_w8, pound_normals_w4, pound_normals_w1, pound_normals_portable};
	of[width](stream, first, z);
}

static int draw_numbers(void **state)
{
	(void)state;
	for (int c = 0; c < CHUNKS; c++) {
		double z[NOISE_WORDS][NOISE_CHUNK];
		fill(pound_dispatch_width(0), (uint32_t)(c * NOISE_CHUNK), z);
		for (int l = 0; l < NOISE_CHUNK; l++)
			for (int w = 0; w < NOISE_WORDS; w++)
				number[(c * NOISE_CHUNK + l) * NOISE_WORDS + w] = z[w][l];
	}
	return 0;
}

/* The test of random.h compares single draws with the published words of Philox; a wrong bit in a word would change a
 * normal number by 2^-32 or more. */
static void chunks_hold_the_words_of_single_draws(void **state)
{
	(void)state;
	const uint32_t firsts[] = {0, 1, 12345, 0xfffffff0}; /* the last one wraps around */
	for (size_t i = 0; i < sizeof firsts / sizeof firsts[0]; i++) {
		double z[NOISE_WORDS][NOISE_CHUNK];
		fill(POUND_WIDTH_PORTABLE, firsts[i], z);
		for (int l = 0; l < NOISE_CHUNK; l++) {
			const philox4x32_ctr_t word = pound_random_words(stream, firsts[i] + (uint32_t)l);
			for (int w = 0; w < NOISE_WORDS; w += 2) {
				const double radius = sqrt(-2 * log((word.v[w] + 0.5) * 0x1p-32));
				const double angle = 2 * M_PI * ((word.v[w + 1] + 0.5) * 0x1p-32);
				// an angle rounded to 53 bits has an error of 2^-51
				check_near(z[w][l], radius * cos(angle), 7 * 0x1p-50);
				check_near(z[w + 1][l], radius * sin(angle), 7 * 0x1p-50);
			}
		}
	}
}

static void a_draw_is_the_same_in_whatever_chunk(void **state)
{
	(void)state;
	double a[NOISE_WORDS][NOISE_CHUNK], b[NOISE_WORDS][NOISE_CHUNK];
	fill(POUND_WIDTH_PORTABLE, 100, a);
	fill(POUND_WIDTH_PORTABLE, 107, b);
	for (int w = 0; w < NOISE_WORDS; w++)
		assert_memory_equal(&a[w][7], &b[w][0], (NOISE_CHUNK - 7) * sizeof(double));
}

static void lanes_of_any_width_give_the_same_bits(void **state)
{
	(void)state;
	for (int lanes = 1; lanes <= 8; lanes++)
		for (uint32_t first = 0; first < 100 * NOISE_CHUNK && pound_dispatch_width(lanes) >= 0;
		     first += NOISE_CHUNK) {
			double a[NOISE_WORDS][NOISE_CHUNK], b[NOISE_WORDS][NOISE_CHUNK];
			fill(POUND_WIDTH_PORTABLE, first, a);
			fill(pound_dispatch_width(lanes), first, b);
			assert_memory_equal(a, b, sizeof a);
		}
}

/* Each within 5 standard errors; moments of the normal distribution: 0, 1, 0, 3, variances 1, 2, 15, 96. */
static void the_first_four_moments_are_normal(void **state)
{
	(void)state;
	static const double moment[4] = {0, 1, 0, 3}, variance[4] = {1, 2, 15, 96};
	double sum[4] = {0};
	for (int i = 0; i < NUMBERS; i++) {
		double power = 1;
		for (int j = 0; j < 4; j++)
			sum[j] += power *= number[i];
	}
	for (int j = 0; j < 4; j++)
		check_near(sum[j] / NUMBERS, moment[j], 5 * sqrt(variance[j] / NUMBERS));
}

/* products z z' and (z^2 - 1) (z'^2 - 1) have the variances 1 and 4: within one draw and between neighbors in time */
static void numbers_are_uncorrelated_and_so_are_their_squares(void **state)
{
	(void)state;
	for (int lag = 1; lag <= 3 * NOISE_WORDS; lag++) {
		double product = 0, squares = 0;
		const int n = NUMBERS - lag;
		for (int i = 0; i < n; i++) {
			const double a = number[i], b = number[i + lag];
			product += a * b;
			squares += (a * a - 1) * (b * b - 1);
		}
		check_near(product / n, 0, 5 / sqrt(n));
		check_near(squares / n, 0, 5 * 2 / sqrt(n));
	}
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Kolmogorov-Smirnov: sqrt(n) D exceeds 2.23 once in 10,000; the number beyond 3.5 is Poisson with a mean of 59.6. */
static void the_distribution_is_normal_out_to_its_tails(void **state)
{
	(void)state;
	static double sorted[NUMBERS];
	memcpy(sorted, number, sizeof sorted);
	qsort(sorted, NUMBERS, sizeof sorted[0], ascending);
	double distance = 0;
	int far = 0;
	for (int i = 0; i < NUMBERS; i++) {
		const double p = 0.5 * erfc(-sorted[i] * M_SQRT1_2);
		distance = fmax(distance, fmax(p - (double)i / NUMBERS, (i + 1.0) / NUMBERS - p));
		far += fabs(sorted[i]) > 3.5;
	}
	check_near(sqrt(NUMBERS) * distance, 0, 2.23);
	const double expected = NUMBERS * erfc(3.5 * M_SQRT1_2);
	check_near(far, expected, 5 * sqrt(expected));
}

CHECK_MAIN(cmocka_unit_test(chunks_hold_the_words_of_single_draws),
           cmocka_unit_test(a_draw_is_the_same_in_whatever_chunk),
           cmocka_unit_test(lanes_of_any_width_give_the_same_bits),
           cmocka_unit_test_setup(the_first_four_moments_are_normal, draw_numbers),
           cmocka_unit_test_setup(numbers_are_uncorrelated_and_so_are_their_squares, draw_numbers),
           cmocka_unit_test_setup(the_distribution_is_normal_out_to_its_tails, draw_numbers))
