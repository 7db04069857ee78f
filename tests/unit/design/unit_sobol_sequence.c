/* unit_sobol_sequence.c - Sobol' points are as uniform as required, scrambled or not. */
#include "engine/design/sobol_sequence.h"
#include "tests/support/check.h"

#include <gsl/gsl_qrng.h>
#include <math.h>
#include <string.h>

static const int degrees[POUND_SEQUENCE_COLUMNS] = {
    0, 1, 2, 3, 3, 4, 4, 5, 5, 5, 5, 5, 5, 6, 6, 6, 6, 6, 6, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7,
    7, 7, 7, 7, 7, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9};

static struct pound_sequence net_of(int column, int scramble)
{
	struct pound_sequence net;
	pound_sequence_init(&net, column);
	if (scramble)
		pound_sequence_scramble(&net, (struct pound_stream){.seed = 42, .sample = column, .row = scramble});
	return net;
}

/* The polynomial of a column with its leading term, recovered from the direction numbers: each is a sum of the s
 * before it; all polynomials of the degree are tried on 24 direction numbers. */
static unsigned polynomial_of(int column)
{
	const struct pound_sequence net = net_of(column, 0);
	const uint32_t *v = net.direction;
	const int s = degrees[column];
	for (unsigned inner = 0; inner < 1u << (s - 1); inner++) {
		bool holds = true;
		for (int k = s; k < 24 && holds; k++) {
			uint32_t sum = v[k - s] ^ v[k - s] >> s;
			for (int i = 1; i < s; i++)
				sum ^= inner >> (s - 1 - i) & 1 ? v[k - i] : 0;
			holds = sum == v[k];
		}
		if (holds)
			return 1u << s | inner << 1 | 1;
	}
	return 0;
}

/* The order of x modulo a polynomial: the smallest power that is 1. */
static int order_of_x(unsigned polynomial, int degree)
{
	unsigned power = 1;
	for (int n = 1; n < 1 << degree; n++) {
		power <<= 1;
		power ^= power >> degree & 1 ? polynomial : 0;
		if (power == 1)
			return n;
	}
	return 0;
}

static void polynomials_are_primitive_and_each_is_used_once(void **state)
{
	(void)state;
	bool used[1024] = {false};
	for (int c = 1; c < POUND_SEQUENCE_COLUMNS; c++) {
		unsigned p = polynomial_of(c);
		assert_true(p > 0 && !used[p]);
		used[p] = true;
		// x generates all 2^s - 1 nonzero elements; 1 for x + 1
		assert_int_equal(order_of_x(p, degrees[c]), (1 << degrees[c]) - 1);
	}
}

static void the_first_points_are_those_of_the_literature(void **state)
{
	(void)state;
	// Joe and Kuo 2008 give v_k = m_k / 2^k for x^3 + x^2 + 1 and m = 1, 3, 7; the column here is x^3 + x + 1, m = 1, 3, 1
	static const double want[4][8] = {{0, 1 / 2., 1 / 4., 3 / 4., 1 / 8., 5 / 8., 3 / 8., 7 / 8.},
	                                  {0, 1 / 2., 3 / 4., 1 / 4., 5 / 8., 1 / 8., 3 / 8., 7 / 8.},
	                                  {0, 1 / 2., 3 / 4., 1 / 4., 3 / 8., 7 / 8., 5 / 8., 1 / 8.},
	                                  {0, 1 / 2., 3 / 4., 1 / 4., 1 / 8., 5 / 8., 7 / 8., 3 / 8.}};
	for (int c = 0; c < 4; c++) {
		const struct pound_sequence net = net_of(c, 0);
		for (uint32_t i = 0; i < 8; i++)
			check_near(pound_sequence_point(&net, i), want[c][i] + 0x1p-33, 0);
	}
}

/* An independent generator agrees in the columns with the same direction numbers: the first two. */
static void the_first_columns_are_those_of_another_generator(void **state)
{
	(void)state;
	gsl_qrng *other = gsl_qrng_alloc(gsl_qrng_sobol, 2);
	for (uint32_t n = 1; n < 1000; n++) {
		double x[2];
		gsl_qrng_get(other, x);
		for (int c = 0; c < 2; c++) {
			const struct pound_sequence net = net_of(c, 0);
			// its points are in the order of a Gray code
			check_near(pound_sequence_point(&net, n ^ n >> 1), x[c], 0x1p-29);
		}
	}
	gsl_qrng_free(other);
}

/* Counts of 2^m points in the boxes of 2^a by 2^b intervals of two columns: all must be 2^(m - a - b). */
static void check_boxes(const struct pound_sequence *p, const struct pound_sequence *q, uint32_t first, int m,
                        int a, int b)
{
	static int count[1 << 12];
	memset(count, 0, sizeof count);
	for (uint32_t i = 0; i < UINT32_C(1) << m; i++) {
		int x = (int)(pound_sequence_point(p, first + i) * (1 << a)),
		    y = (int)(pound_sequence_point(q, first + i) * (1 << b));
		count[x << b | y]++;
	}
	for (int box = 0; box < 1 << (a + b); box++)
		assert_int_equal(count[box], 1 << (m - a - b));
}

/* Every elementary interval of the first, and of a later, block of 2^m points of two columns.
 *
 * Two polynomials of degrees s and t give a sequence whose boxes of volume 2^(s + t - 2 - m) contain equally many
 * points (Sobol' 1967); the van der Corput column counts as degree 1. */
static void check_columns(int scramble, int m, int columns)
{
	for (int c = 0; c < columns; c++)
		for (int e = 0; e < c; e++) {
			const struct pound_sequence p = net_of(c, scramble), q = net_of(e, scramble);
			int digits = m - (degrees[c] - 1) - (degrees[e] ? degrees[e] - 1 : 0);
			for (int a = 0; a <= digits; a++) {
				check_boxes(&p, &q, 0, m, a, digits - a);
				check_boxes(&p, &q, UINT32_C(5) << m, m, a, digits - a);
			}
		}
}

static void elementary_intervals_hold_equally_many_points(void **state)
{
	(void)state;
	check_columns(0, 10, 8);
	// a single column: one point in every interval of 2^-m, up to the last column
	for (int c = 0; c < POUND_SEQUENCE_COLUMNS; c++) {
		const struct pound_sequence net = net_of(c, 0);
		check_boxes(&net, &net, 0, 12, 12, 0);
	}
}

static void a_scramble_keeps_elementary_intervals(void **state)
{
	(void)state;
	for (int scramble = 1; scramble <= 2; scramble++) {
		check_columns(scramble, 10, 6);
		// the first two columns: every box of 2^-m exactly once
		for (int a = 0; a <= 8; a++) {
			const struct pound_sequence p = net_of(0, scramble), q = net_of(1, scramble);
			check_boxes(&p, &q, 0, 8, a, 8 - a);
		}
		for (int c = 0; c < POUND_SEQUENCE_COLUMNS; c++) {
			const struct pound_sequence net = net_of(c, scramble);
			check_boxes(&net, &net, UINT32_C(1) << 12, 12, 12, 0);
		}
	}
}

static void a_scrambled_point_is_uniform_and_another_scramble_is_unrelated(void **state)
{
	(void)state;
	enum { N = 4000 };
	for (uint32_t number = 0; number < 40; number += 13) {
		double sum = 0, square = 0, product = 0, pair = 0, before = 0;
		for (int s = 1; s <= N; s++) {
			const struct pound_sequence net = net_of(5, s);
			double x = pound_sequence_point(&net, number) - 0.5,
			       y = pound_sequence_point(&net, number + 1) - 0.5;
			sum += x;
			square += x * x;
			product += x * before;
			pair += x * y;
			before = x;
		}
		// five standard deviations of the means of N uniform numbers: variance 1/12, of squares 1/180, of products 1/144
		check_near(sum / N, 0, 5 * sqrt(1. / 12 / N));
		check_near(square / N, 1. / 12, 5 * sqrt(1. / 180 / N));
		check_near(product / N, 0, 5 * sqrt(1. / 144 / N));
		// neighboring points have a negative covariance, limited by that of two strata of one half: at least -1/12
		assert_true(pair / N < 5. / 12 / sqrt(N) && pair / N > -1. / 12);
	}
}

CHECK_MAIN(cmocka_unit_test(polynomials_are_primitive_and_each_is_used_once),
           cmocka_unit_test(the_first_points_are_those_of_the_literature),
           cmocka_unit_test(the_first_columns_are_those_of_another_generator),
           cmocka_unit_test(elementary_intervals_hold_equally_many_points),
           cmocka_unit_test(a_scramble_keeps_elementary_intervals),
           cmocka_unit_test(a_scrambled_point_is_uniform_and_another_scramble_is_unrelated))
