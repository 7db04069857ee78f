/* Logarithm, exponential, sine and cosine against the C library in 80-bit arithmetic, whose error is 2^-10 of ours. */
#include <float.h>
#include <math.h>

#include "engine/numeric/elementary.h"
#include "tests/support/check.h"

/* |got - want| in units of the last place of want */
static double ulps(double got, long double want)
{
	int e;
	frexpl(want, &e);
	return (double)(fabsl(got - want) / ldexpl(1, e - DBL_MANT_DIG));
}

static void logarithms_are_right_to_two_units_of_the_last_place(void **state)
{
	(void)state;
	double worst = 0;
	// the fractions from which noise is made
	for (uint64_t word = 0; word < (uint64_t)1 << 32; word += 4099) {
		const double x = ((double)word + 0.5) * 0x1p-32;
		worst = fmax(worst, ulps(pound_elementary_log(x), logl(x)));
	}
	// both sides of 1, down to the last place
	for (double d = 0x1p-53; d < 0.5; d *= 1.01) {
		worst = fmax(worst, ulps(pound_elementary_log(1 - d), logl(1 - d)));
		if (1 + d > 1)
			worst = fmax(worst, ulps(pound_elementary_log(1 + d), logl(1 + d)));
	}
	for (double x = DBL_MIN; x < DBL_MAX / 1.01; x *= 1.00937)
		worst = fmax(worst, ulps(pound_elementary_log(x), logl(x)));
	assert_true(worst > 0);
	check_near(worst, 0, 2);
	assert_true(pound_elementary_log(1) == 0);
}

static void sines_and_cosines_are_right_to_two_units_of_the_last_place(void **state)
{
	(void)state;
	const long double quarter_turn = 1.57079632679489661923132169163975144L;
	double worst = 0, sine, cosine;
	for (int scale = -40; scale <= 40; scale += 8)
		for (int i = -50000; i < 50000; i++) {
			const double x = ldexp((i + 0.37) / 50000, scale);
			const long double quarters = rintl(4 * (long double)x);
			const long double r =
			    (4 * (long double)x - quarters) * quarter_turn; /* the difference is exact */
			const int q = (int)(fmodl(quarters, 4) + 4) & 3;
			const long double s = sinl(r), c = cosl(r);
			pound_elementary_sincos(x, &sine, &cosine);
			worst = fmax(worst, ulps(sine, (long double[]){s, c, -s, -c}[q]));
			worst = fmax(worst, ulps(cosine, (long double[]){c, -s, -c, s}[q]));
		}
	assert_true(worst > 0);
	check_near(worst, 0, 2);
}

static void exponentials_are_right_to_two_units_of_the_last_place(void **state)
{
	(void)state;
	double worst = 0;
	for (int scale = -60; scale <= 8; scale += 4)
		for (int i = -5000; i < 5000; i++) {
			const double x = ldexp((i + 0.37) / 5000, scale);
			worst = fmax(worst, ulps(pound_elementary_exp(x), expl(x)));
		}
	for (double x = -708; x < 708; x += 0.1237)
		worst = fmax(worst, ulps(pound_elementary_exp(x), expl(x)));
	assert_true(worst > 0);
	check_near(worst, 0, 2);
	assert_true(pound_elementary_exp(0) == 1);
}

static void quarter_turns_are_exact(void **state)
{
	(void)state;
	static const double sine_at[4] = {0, 1, 0, -1}, cosine_at[4] = {1, 0, -1, 0};
	for (int i = -8; i <= 8; i++) {
		double sine, cosine;
		pound_elementary_sincos(0.25 * i, &sine, &cosine);
		assert_true(sine == sine_at[i & 3] && cosine == cosine_at[i & 3]);
	}
}

/* The hash is from gcc -O2; every other compiler, optimization and machine must give the same. */
static void the_bits_are_the_same_everywhere(void **state)
{
	(void)state;
	uint64_t hash = 0xcbf29ce484222325;
	for (int i = 1; i < 100000; i++) {
		double sine, cosine;
		pound_elementary_sincos(i * 0.7071e-3, &sine, &cosine);
		const double values[3] = {sine, cosine, pound_elementary_log(i * 1.0e-5)};
		for (int j = 0; j < 3; j++)
			hash = (hash ^ pound_elementary_bits(values[j])) * 0x100000001b3;
	}
	assert_int_equal(hash, 0xb2e5c54092227bde);
}

CHECK_MAIN(cmocka_unit_test(logarithms_are_right_to_two_units_of_the_last_place),
           cmocka_unit_test(sines_and_cosines_are_right_to_two_units_of_the_last_place),
           cmocka_unit_test(exponentials_are_right_to_two_units_of_the_last_place),
           cmocka_unit_test(quarter_turns_are_exact), cmocka_unit_test(the_bits_are_the_same_everywhere))
