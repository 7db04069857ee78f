/* unit_chaos_expansion.c - indices with a polynomial control variate: polynomials exactly, known functions within limits. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2 };

static struct pound_closed_results indices_kept(const struct pound_sample_values *values, const double *u,
                                                bool corrected, double *kept)
{
	struct pound_closed_results result;
	struct pound_rows rows;
	size_t rows_size = pound_rows_scratch(values);
	double *scratch = malloc(sizeof *scratch * (rows_size + pound_chaos_expansion_scratch(values)));
	pound_rows_init(&rows, values, scratch);
	pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u, .kept = kept},
	                              corrected ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT, scratch + rows_size,
	                              &result, NULL);
	free(scratch);
	return result;
}

static struct pound_closed_results indices_of(const struct pound_sample_values *values, const double *u,
                                              bool corrected)
{
	return indices_kept(values, u, corrected, NULL);
}

static const struct function_noise noiseless = {1, 0.0, true};

/* x1 + 2 x2 x3 + x1 x2^2 of centered uniform inputs of variance 1, with terms of total degree 3. */
static double cubic(const double *u)
{
	double x[D];
	for (int j = 0; j < D; j++)
		x[j] = sqrt(12.0) * (u[j] - 0.5);
	return x[0] + 2.0 * x[1] * x[2] + x[0] * x[1] * x[1];
}

static void a_polynomial_within_the_degree_is_met_exactly(void **state)
{
	(void)state;
	// x1 (1 + x2^2) + 2 x2 x3 with E x^2 = 1, Var x^2 = 9/5 - 1: variances x1: 4, x1 x2: 4/5, x2 x3: 4
	static const double first[D] = {4.0 / 8.8, 0.0, 0.0, 0.0};
	static const double total[D] = {4.8 / 8.8, 4.8 / 8.8, 4.0 / 8.8, 0.0};
	const struct function f = {.name = "cubic", .y = cubic, .variance = 8.8};
	struct pound_sample_values values = function_values(&f, 200, 1, noiseless);
	double *u = function_design(200, 1);
	struct pound_closed_results got = indices_of(&values, u, false);
	for (int j = 0; j < D; j++) {
		// rounding errors of normal equations of 126 terms, whose condition number is some tens
		check_near(got.first[j].value, first[j], 1e-11);
		check_near(got.total[j].value, total[j], 1e-11);
		check_near(got.total[j].high - got.total[j].low, 0.0, 1e-11);
	}
	free(u);
	function_values_free(&values);
}

static void the_degree_grows_with_the_rows_and_falls_with_the_inputs(void **state)
{
	(void)state;
	assert_int_equal(pound_chaos_expansion_degree(1000, 4, 6), 6);
	assert_int_equal(pound_chaos_expansion_degree(250, 4, 6), 6);
	assert_int_equal(pound_chaos_expansion_degree(100, 4, 6), 4);
	assert_int_equal(pound_chaos_expansion_degree(2, 4, 6), 0);
	assert_int_equal(pound_chaos_expansion_degree(1000, 16, 18), 2);
	assert_int_equal(pound_chaos_expansion_degree(1000, 1, 3), 6);
}

static void shift_and_scale_change_no_index(void **state)
{
	(void)state;
	struct pound_sample_values values = function_values(function_named("cusp"), 300, 2, noiseless);
	double *u = function_design(300, 2);
	struct pound_closed_results want = indices_of(&values, u, false);
	for (int k = 0; k < 300 * SAMPLES; k++)
		((double *)values.numerator)[k] = 1e6 + 3.0 * values.numerator[k];
	struct pound_closed_results got = indices_of(&values, u, false);
	for (int j = 0; j < D; j++) {
		check_near(got.first[j].value, want.first[j].value, 1e-9);
		check_near(got.total[j].value, want.total[j].value, 1e-9);
		check_near(got.total[j].high, want.total[j].high, 1e-9);
	}
	free(u);
	function_values_free(&values);
}

static void rows_left_out_do_not_shift_the_inputs_of_the_others(void **state)
{
	(void)state;
	struct pound_sample_values values = function_values(function_named("cusp"), 300, 3, noiseless);
	double *u = function_design(300, 3), *y = (double *)values.numerator;
	struct pound_sample_values cut = {.n_rows = 250,
	                                  .n_inputs = D,
	                                  .n_signals = 1,
	                                  .numerator = y + 50 * SAMPLES,
	                                  .denominator = values.denominator + 50 * SAMPLES};
	struct pound_closed_results want = indices_of(&cut, u + 50 * 2 * D, false);
	for (int i = 0; i < 50; i++)
		y[i * SAMPLES + i % SAMPLES] = NAN;
	struct pound_closed_results got = indices_of(&values, u, false);
	for (int j = 0; j < D; j++)
		check_near(got.total[j].value, want.total[j].value, 0.0);
	free(u);
	function_values_free(&values);
}

static void nothing_is_defined_where_nothing_varies(void **state)
{
	(void)state;
	struct pound_sample_values values = function_values(function_named("cusp"), 60, 4, noiseless);
	double *u = function_design(60, 4);
	for (int k = 0; k < 60 * SAMPLES; k++)
		((double *)values.numerator)[k] = 4.2;
	struct pound_closed_results got = indices_of(&values, u, false);
	for (int j = 0; j < D; j++)
		assert_true(isnan(got.first[j].value) && isnan(got.total[j].value) && isnan(got.total[j].low));
	free(u);
	function_values_free(&values);
}

enum { SEEDS = 20, N = 1000 };

/* Over SEEDS designs: root mean square errors over the inputs, the largest mean error of an index relative to its
 * root mean square, and the mean coverage. */
struct performance {
	double first, total, bias, coverage;
};

static struct performance performance_of(const struct function *f, struct function_noise noise)
{
	struct performance p = {0};
	double bias[2 * D] = {0}, square[2 * D] = {0};
	for (int seed = 0; seed < SEEDS; seed++) {
		struct pound_sample_values values = function_values(f, N, seed, noise);
		double *u = function_design(N, seed);
		struct pound_closed_results got = indices_of(&values, u, noise.n_signals > 1);
		for (int k = 0; k < 2 * D; k++) {
			const struct pound_estimate *x = k < D ? &got.first[k] : &got.total[k - D];
			double error = x->value - f->index[k];
			bias[k] += error / SEEDS;
			square[k] += error * error / SEEDS;
			p.coverage += (double)(x->low <= f->index[k] && f->index[k] <= x->high) / (2 * D) / SEEDS;
		}
		free(u);
		function_values_free(&values);
	}
	for (int k = 0; k < 2 * D; k++) {
		p.bias = fmax(p.bias, fabs(bias[k]) / sqrt(square[k]));
		*(k < D ? &p.first : &p.total) += square[k] / D;
	}
	p.first = sqrt(p.first), p.total = sqrt(p.total);
	return p;
}

static void errors_over_designs_are_a_fraction_of_those_of_pick_freeze(void **state)
{
	(void)state;
	// measured over 150 designs; an RMSE over 20 designs and 4 inputs has a standard error of some 11 %
	static const struct {
		const char *name;
		double first, total;
	} measured[] = {{"ishigami", .0065, .0046},
	                {"g_a", .0039, .0026},
	                {"g_b", .0063, .0048},
	                {"cusp", .0040, .0034},
	                {"steps", .0150, .0115}};
	for (int k = 0; k < 5; k++) {
		struct performance p = performance_of(function_named(measured[k].name), noiseless);
		assert_true(p.first <= 1.3 * measured[k].first);
		assert_true(p.total <= 1.3 * measured[k].total);
		assert_true(p.bias <= 4.0 / sqrt(SEEDS)); // four standard errors of a mean
		// nominal .95; 160 intervals that are not independent
		assert_true(p.coverage >= 0.90);
	}
}

static void noise_of_few_signals_leaves_no_bias(void **state)
{
	(void)state;
	struct performance p = performance_of(function_named("cusp"), (struct function_noise){5, 1.0, true});
	assert_true(p.first <= 1.3 * 0.0218 && p.total <= 1.3 * 0.0097);
	assert_true(p.bias <= 4.0 / sqrt(SEEDS));
	assert_true(p.coverage >= 0.89);
}

/* sin(24 pi u1) + u2: variances 1/2, 1/12. */
static double short_waves(const double *u)
{
	return sin(24.0 * M_PI * u[0]) + u[1];
}

static void a_polynomial_that_cannot_follow_does_no_harm(void **state)
{
	(void)state;
	enum { FEW = 250, DESIGNS = 40 };
	const double variance = 1.0 / 2.0 + 1.0 / 12.0;
	const double want[D] = {0.5 / variance, 1.0 / 12.0 / variance, 0.0, 0.0};
	const struct function f = {.name = "short_waves", .y = short_waves, .variance = variance};
	double square = 0.0, plain = 0.0;
	for (uint64_t seed = 0; seed < DESIGNS; seed++) {
		struct pound_sample_values values = function_values(&f, FEW, seed, noiseless);
		double *u = function_design(FEW, seed), above, below = 0.0;
		struct pound_closed_results got = indices_of(&values, u, false);
		for (int i = 0; i < FEW; i++)
			for (int p = 0; p < 2; p++)
				below += pow(values.numerator[i * SAMPLES + p] - 0.5, 2) / (2 * FEW);
		for (int j = 0; j < D; j++) {
			above = 0.0;
			for (int i = 0; i < FEW; i++) {
				const double *y = values.numerator + (size_t)i * SAMPLES;
				above += (y[1] - 0.5) * (y[2 + j] - y[0]) / FEW;
			}
			square += pow(got.first[j].value - want[j], 2);
			plain += pow(above / below - want[j], 2);
		}
		free(u);
		function_values_free(&values);
	}
	// 210 terms for 1200 samples: the full polynomial would have 1.3 times the error of the plain estimate, the
	// weighted one 0.8
	assert_true(square <= plain);
}

/* Successive outputs: of all rows, another of the same rows, two without one row, of fewer rows, with other groups. */
static void what_is_kept_of_a_design_changes_no_bit(void **state)
{
	(void)state;
	enum { ROWS = 200, FEWER = 100 };
	static const struct {
		const char *of;
		int n_rows, failed; /* -1: no failed row */
		int groups;
	} cases[] = {{"cusp", ROWS, -1, 0},  {"steps", ROWS, -1, 0}, {"steps", ROWS, 7, 0}, {"cusp", ROWS, 8, 0},
	             {"cusp", FEWER, -1, 0}, {"cusp", FEWER, -1, 8}, {"cusp", ROWS, -1, 0}};
	double *u = function_design(ROWS, 1), *kept = NULL;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct pound_sample_values values = function_values(function_named(cases[k].of), ROWS, 1, noiseless);
		if (!kept)
			kept = calloc(pound_chaos_expansion_kept_size(&values), sizeof *kept);
		values.n_rows = cases[k].n_rows;
		values.grouping = (struct pound_grouping){cases[k].groups, 1};
		if (cases[k].failed >= 0)
			((double *)values.numerator)[cases[k].failed * SAMPLES] = NAN;
		const struct pound_closed_results want = indices_of(&values, u, false);
		for (int again = 0; again < 2; again++) {
			const struct pound_closed_results got = indices_kept(&values, u, false, kept);
			assert_memory_equal(got.first, want.first, sizeof want.first[0] * D);
			assert_memory_equal(got.total, want.total, sizeof want.total[0] * D);
		}
		function_values_free(&values);
	}
	free(u), free(kept);
}

CHECK_MAIN(cmocka_unit_test(a_polynomial_within_the_degree_is_met_exactly),
           cmocka_unit_test(the_degree_grows_with_the_rows_and_falls_with_the_inputs),
           cmocka_unit_test(shift_and_scale_change_no_index),
           cmocka_unit_test(rows_left_out_do_not_shift_the_inputs_of_the_others),
           cmocka_unit_test(nothing_is_defined_where_nothing_varies),
           cmocka_unit_test(errors_over_designs_are_a_fraction_of_those_of_pick_freeze),
           cmocka_unit_test(noise_of_few_signals_leaves_no_bias),
           cmocka_unit_test(a_polynomial_that_cannot_follow_does_no_harm),
           cmocka_unit_test(what_is_kept_of_a_design_changes_no_bit))
