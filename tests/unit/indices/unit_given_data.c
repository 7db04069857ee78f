/* unit_given_data.c - indices of samples without a design, against closed forms; checks of the samples. */
#include <math.h>
#include <string.h>

#include "engine/given.h"
#include "tests/support/check.h"
#include "tests/support/given_samples.h"

enum { N = 2000, D = 3 };

/* Ishigami's function of uniform draws. */
static void ishigami(struct given_samples *s)
{
	for (int i = 0; i < s->given.n_rows; i++) {
		const double *u = s->x + (size_t)i * D;
		const double a = M_PI * (2 * u[0] - 1), b = M_PI * (2 * u[1] - 1), c = M_PI * (2 * u[2] - 1);
		s->y[i] = sin(a) + 7 * sin(b) * sin(b) + 0.1 * pow(c, 4) * sin(a);
	}
}

/* y = 1 + 2 u1 + 3 (u2 - 1/2) (u3 - 1/2) is a polynomial and explained completely, so errors come from the sample's
 * own moments, which the intervals include. */
static void a_polynomial_has_the_indices_of_its_coefficients(void **state)
{
	(void)state;
	struct given_samples s;
	struct pound_given_indices indices;
	const double v1 = 4.0 / 12, v23 = 9.0 / 144, v = v1 + v23;
	given_draw(&s, N, D, 7);
	for (int i = 0; i < N; i++) {
		const double *u = s.x + (size_t)i * D;
		s.y[i] = 1 + 2 * u[0] + 3 * (u[1] - 0.5) * (u[2] - 0.5);
	}
	given_check(&s);
	given_estimate(&s, &indices);
	assert_true(indices.explained > 0.999);
	check_near(indices.variance, v, 4 * v * sqrt(2.0 / N));
	// standard deviation of the fraction of two sample variances
	const double error = 4 * (v1 / v) * (v23 / v) * sqrt(2 * 2.0 / N);
	check_near(indices.first[0].value, v1 / v, error);
	check_near(indices.total[1].value, v23 / v, error);
	check_near(indices.total[2].value, v23 / v, error);
	assert_int_equal(indices.n_second, 3);
	check_near(indices.second[2].estimate.value, v23 / v, error);
	assert_int_equal(indices.second[2].inputs, 6);
	check_near(indices.second[0].estimate.value, 0, error);
	given_free(&s);
}

static void indices_of_ishigami_are_in_their_intervals(void **state)
{
	(void)state;
	static const double first[D] = {0.3139, 0.4424, 0.0}, total[D] = {0.5576, 0.4424, 0.2437};
	static const char *const names[] = {"S1", "ST"};
	enum { SEEDS = 40 };
	int missed = 0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct given_samples s;
		struct pound_given_indices indices;
		given_draw(&s, N, D, 1000 + (uint64_t)seed);
		ishigami(&s);
		given_check(&s);
		given_estimate(&s, &indices);
		assert_false(given_says(s.checks.notes, POUND_GIVEN_ARRANGED) ||
		             given_says(s.checks.notes, POUND_GIVEN_SERIAL));
		assert_true(indices.explained > 0.9);
		for (int j = 0; j < D; j++) {
			check_near(indices.first[j].value, first[j], 0.06);
			check_near(indices.total[j].value, total[j], 0.06);
			given_check_holds(indices.first[j], first[j], names[0], &missed);
			given_check_holds(indices.total[j], total[j], names[1], &missed);
		}
		given_free(&s);
	}
	// at least 0.90 of the intervals hold, less 2.4 binomial standard deviations of their number
	check_report("%d of %d intervals missed", missed, SEEDS * 2 * D);
	assert_true(missed <= 0.10 * SEEDS * 2 * D + 3 * sqrt(0.09 * SEEDS) * 2);
}

/* (u1 - 0.3) (u2 + 0.2) + u3 is a polynomial, so that all error of its indices is that of the moments of the samples. */
static void intervals_include_the_error_of_the_moments_of_the_samples(void **state)
{
	(void)state;
	enum { SEEDS = 100, FEW = 500 };
	// 0.7^2 / 12, 0.2^2 / 12, 1 / 12 and the interaction 1 / 144
	const double part[] = {0.49 / 12, 0.04 / 12, 1.0 / 12}, both = 1.0 / 144,
	             variance = part[0] + part[1] + part[2] + both;
	int missed[3] = {0}, missed_total[3] = {0};
	double error = 0.0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct given_samples s;
		struct pound_given_indices indices;
		given_draw(&s, FEW, D, 8000 + (uint64_t)seed);
		for (int i = 0; i < FEW; i++) {
			const double *u = s.x + (size_t)i * D;
			s.y[i] = (u[0] - 0.3) * (u[1] + 0.2) + u[2];
		}
		given_check(&s);
		given_estimate(&s, &indices);
		for (int j = 0; j < D; j++) {
			const double total = (part[j] + (j < 2 ? both : 0.0)) / variance;
			given_check_holds(indices.first[j], part[j] / variance, "S1", &missed[j]);
			given_check_holds(indices.total[j], total, "ST", &missed_total[j]);
			error += (indices.total[j].value - total) * (indices.total[j].value - total) / (3 * SEEDS);
		}
		given_free(&s);
	}
	// 0.95 +- 0.02 of 100; without the moments 0.69 of one index
	for (int j = 0; j < D; j++)
		assert_true(missed[j] <= 12 && missed_total[j] <= 12);
	// with the variance of the samples in place of the fit's: 0.025
	check_report("root mean square error of ST %.4f", sqrt(error));
	assert_true(sqrt(error) < 0.018);
}

static void what_no_polynomial_explains_has_no_total_indices(void **state)
{
	(void)state;
	struct given_samples s;
	struct pound_given_indices indices;
	given_draw(&s, N, D, 3);
	// parity of three inputs: first-order indices are 0, and no polynomial of low degree explains any of it
	for (int i = 0; i < N; i++) {
		s.y[i] = 1;
		for (int j = 0; j < D; j++)
			s.y[i] *= fmod(floor(8 * s.x[(size_t)i * D + j]), 2) ? 1 : -1;
	}
	given_check(&s);
	given_estimate(&s, &indices);
	assert_true(given_says(indices.notes, POUND_GIVEN_UNEXPLAINED));
	assert_true(given_says(indices.notes, POUND_GIVEN_NOISE_LIMITS));
	// without noise it is not the cause
	memset(s.noise, 0, sizeof *s.noise * N);
	s.given.noise_known = true;
	given_estimate(&s, &indices);
	assert_true(given_says(indices.notes, POUND_GIVEN_UNEXPLAINED));
	assert_false(given_says(indices.notes, POUND_GIVEN_NOISE_LIMITS));
	assert_int_equal(indices.n_second, 0);
	for (int j = 0; j < D; j++) {
		assert_true(isnan(indices.total[j].value));
		// four standard errors
		check_near(indices.first[j].value, 0.0, indices.first[j].high - indices.first[j].low);
	}
	given_free(&s);
}

static void an_input_of_few_values_is_discrete(void **state)
{
	(void)state;
	struct given_samples s;
	struct pound_given_indices indices;
	given_draw(&s, N, D, 11);
	// the first input has three values of equal probability: y = value + second input, (2/3) / (2/3 + 1/12)
	for (int i = 0; i < N; i++) {
		double *x = s.x + (size_t)i * D;
		x[0] = floor(3 * x[0]);
		s.y[i] = x[0] + x[1];
	}
	given_check(&s);
	assert_int_equal(s.inputs[0].distribution.n_values, 3);
	assert_int_equal(s.inputs[1].distribution.n_values, N);
	check_near(s.inputs[0].distribution.values[2], 2.0, 0.0);
	given_estimate(&s, &indices);
	check_near(indices.first[0].value, 8.0 / 9, 4 * (8.0 / 81) * sqrt(4.0 / N));
	// the conditional mean at the three values
	for (int k = 0; k < 3; k++)
		check_near(indices.curves[0].mean[k].value, k + 0.5, 5 * sqrt(1 / 12.0 / (N / 3.0)));
	given_free(&s);
}

static void independent_samples_pass_and_others_are_named(void **state)
{
	(void)state;
	struct given_samples s;
	struct pound_given_indices indices;
	int flagged = 0;
	for (int seed = 0; seed < 100; seed++) {
		given_draw(&s, 500, D, 5000 + (uint64_t)seed);
		given_check(&s);
		flagged += s.checks.notes != 1u << POUND_GIVEN_NOISE;
		given_free(&s);
	}
	// one set in a hundred fails by chance
	assert_true(flagged <= 5);
	given_draw(&s, N, D, 5);
	for (int i = 0; i < N; i++)
		s.x[(size_t)i * D + 2] = s.x[(size_t)i * D + 1] + 0.5 * s.x[(size_t)i * D + 2];
	ishigami(&s);
	given_check(&s);
	assert_true(given_says(s.checks.notes, POUND_GIVEN_DEPENDENT));
	assert_int_equal(s.checks.pair[0], 1);
	assert_int_equal(s.checks.pair[1], 2);
	assert_true(s.checks.correlation > 0.7);
	assert_false(given_says(s.checks.notes, POUND_GIVEN_NOT_MONOTONIC) ||
	             given_says(s.checks.notes, POUND_GIVEN_COLLINEAR));
	given_estimate(&s, &indices);
	assert_true(isnan(indices.total[0].value) && isnan(indices.explained) && indices.n_second == 0);
	assert_true(isfinite(indices.first[1].value));
	given_free(&s);
	// uncorrelated, but on a circle
	given_draw(&s, N, 2, 6);
	for (int i = 0; i < N; i++) {
		const double turn = 2 * M_PI * s.x[(size_t)i * 2];
		s.x[(size_t)i * 2] = cos(turn);
		s.x[(size_t)i * 2 + 1] = sin(turn);
	}
	given_check(&s);
	assert_true(given_says(s.checks.notes, POUND_GIVEN_DEPENDENT));
	assert_true(given_says(s.checks.notes, POUND_GIVEN_NOT_MONOTONIC));
	assert_true(fabs(s.checks.correlation) < 0.1);
	given_free(&s);
	// the first input is on a parabola over the second; the third is a decreasing function of the second
	given_draw(&s, N, D, 7);
	for (int i = 0; i < N; i++) {
		double *x = s.x + (size_t)i * D;
		x[0] = (x[1] - 0.5) * (x[1] - 0.5);
		x[2] = -x[1] * x[1];
	}
	given_check(&s);
	assert_true(given_says(s.checks.notes, POUND_GIVEN_DEPENDENT));
	assert_true(given_says(s.checks.notes, POUND_GIVEN_COLLINEAR));
	assert_false(given_says(s.checks.notes, POUND_GIVEN_NOT_MONOTONIC));
	assert_int_equal(s.checks.pair[0], 1);
	assert_int_equal(s.checks.pair[1], 2);
	check_near(s.checks.correlation, -1.0, 1e-9);
	given_free(&s);
	// a lattice: equal distances in one input are equal distances in the other
	given_draw(&s, N, 2, 8);
	s.given.sorted = true;
	for (int i = 0; i < N; i++) {
		s.x[(size_t)i * 2] = (i + 0.5) / N;
		s.x[(size_t)i * 2 + 1] = fmod((i + 0.5) * 0.6180339887498949, 1.0);
	}
	given_check(&s);
	assert_true(given_says(s.checks.notes, POUND_GIVEN_ARRANGED));
	given_free(&s);
}

static void a_constant_has_no_indices(void **state)
{
	(void)state;
	struct given_samples s;
	struct pound_given_indices indices;
	given_draw(&s, 64, 1, 9);
	for (int i = 0; i < 64; i++)
		s.y[i] = 0.1;
	given_check(&s);
	assert_int_equal(s.checks.pair[0], -1);
	given_estimate(&s, &indices);
	assert_true(given_says(indices.notes, POUND_GIVEN_CONSTANT));
	assert_true(isnan(indices.first[0].value) && isnan(indices.total[0].value));
	given_free(&s);
}

/* A rare value in a discrete input: two of its rows are near each other in another input by chance. */
static void a_rare_value_is_no_arrangement(void **state)
{
	(void)state;
	enum { SETS = 60, ROWS = 1000 };
	for (int set = 0; set < SETS; set++) {
		struct given_samples s;
		given_draw(&s, ROWS, D, 4000 + (uint64_t)set);
		for (int i = 0; i < ROWS; i++)
			s.x[(size_t)i * D] = s.x[(size_t)i * D] < 0.005;
		given_check(&s);
		assert_false(given_says(s.checks.notes, POUND_GIVEN_ARRANGED));
		given_free(&s);
	}
}

static void a_shift_and_a_scale_change_nothing(void **state)
{
	(void)state;
	struct given_samples s;
	struct pound_given_indices indices, moved;
	given_draw(&s, N, D, 12);
	ishigami(&s);
	given_check(&s);
	given_estimate(&s, &indices);
	for (int i = 0; i < N; i++)
		s.y[i] = 1e6 + 3 * s.y[i];
	for (int i = 0; i < N * D; i++)
		s.x[i] = exp(s.x[i]);
	given_check(&s);
	given_estimate(&s, &moved);
	// 1e6 / 3 standard deviations of the output, each value rounded to DBL_EPSILON / 2 of 1e6
	for (int j = 0; j < D; j++) {
		check_near(moved.first[j].value, indices.first[j].value, 1e-9);
		check_near(moved.total[j].value, indices.total[j].value, 1e-9);
	}
	given_free(&s);
}

CHECK_MAIN(cmocka_unit_test(a_polynomial_has_the_indices_of_its_coefficients),
           cmocka_unit_test(indices_of_ishigami_are_in_their_intervals),
           cmocka_unit_test(intervals_include_the_error_of_the_moments_of_the_samples),
           cmocka_unit_test(what_no_polynomial_explains_has_no_total_indices),
           cmocka_unit_test(an_input_of_few_values_is_discrete),
           cmocka_unit_test(independent_samples_pass_and_others_are_named),
           cmocka_unit_test(a_constant_has_no_indices), cmocka_unit_test(a_rare_value_is_no_arrangement),
           cmocka_unit_test(a_shift_and_a_scale_change_nothing))
