/* unit_valid_rows.c - ratios of means, their covariances over draws of the signals, and the rows that are left out. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"

#include <math.h>

enum { D = 1, SAMPLES = D + 2, SIGNALS = 3 };

/* Rows of one input from values; the caller frees rows->y. */
static struct pound_rows rows_of(int n_rows, int n_signals, const double *numerator,
                                 const double *denominator)
{
	struct pound_sample_values values = {.n_rows = n_rows,
	                                     .n_inputs = D,
	                                     .n_signals = n_signals,
	                                     .numerator = numerator,
	                                     .denominator = denominator};
	struct pound_rows rows;
	pound_rows_init(&rows, &values, malloc(sizeof(double) * pound_rows_scratch(&values)));
	return rows;
}

static const double ones[2 * SAMPLES * SIGNALS] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

static void outputs_are_ratios_of_means_less_the_mean_of_a_and_b(void **state)
{
	(void)state;
	const double numerator[] = {1, 2, 3, /* B */ 2, 2, 8, /* AB */ 0, 0, 3, 5, 5, 8, 1, 1, 1, 9, 9, 9};
	const double denominator[] = {1, 0, 1, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
	struct pound_rows rows = rows_of(2, SIGNALS, numerator, denominator);
	const double want[] = {3, 2, 1, 6, 1, 9};
	assert_int_equal(rows.n_rows, 2);
	check_near(rows.plain_mean, 3.0, 0.0);
	for (int k = 0; k < 6; k++)
		check_near(rows.plain[k], want[k] - 3.0, 0.0);
	// the first, without one signal each: 5/1, 4/2, 3/1, bias twice the mean minus 3; the others have no bias
	const double bias = 2 * ((5 + 2 + 3) / 3.0 - 3);
	check_near(rows.mean, 3.0 - bias / 4, 1e-15);
	for (int k = 0; k < 6; k++)
		check_near(rows.y[k] + rows.mean, want[k] - (k == 0 ? bias : 0), 1e-15);
	free(rows.y);
}

static void the_variance_of_a_ratio_of_means_is_that_of_its_residuals(void **state)
{
	(void)state;
	// deviations from the means: A (-2, -1, 3), B (1, 0, -1), the mixed sample twice those of A
	const double numerator[] = {1, 2, 6, 8, 7, 6, 0, 2, 10, 1, 2, 6, 8, 7, 6, 0, 2, 10};
	struct pound_rows rows = rows_of(2, SIGNALS, numerator, ones);
	double e[SAMPLES * SAMPLES];
	pound_rows_noise(&rows, 1, e);
	// mean squares over 3 - 1, of means of 3
	const double want[] = {14, -5, 28, -5, 2, -10, 28, -10, 56};
	for (int k = 0; k < SAMPLES * SAMPLES; k++)
		check_near(e[k], want[k] / 6.0, 1e-14);
	free(rows.y);

	// a numerator proportional to the denominator has no noise, a constant one has the denominator's noise
	const double proportional[] = {2, 4, 12, 3, 3, 3, 2, 4, 12}, below[] = {1, 2, 6, 1, 2, 6, 1, 2, 6};
	rows = rows_of(1, SIGNALS, proportional, below);
	pound_rows_noise(&rows, 0, e);
	check_near(e[0], 0.0, 0.0);
	check_near(e[1], 0.0, 0.0);
	// residuals 2, 1, -3 with weights 1/9, 2/9, 6/9 in a sum of 9
	check_near(e[SAMPLES + 1], (4 / (8 / 9.0) + 1 / (7 / 9.0) + 9 / (3 / 9.0)) / 81, 1e-15);
	free(rows.y);
}

static void the_noise_of_a_ratio_is_the_same_in_any_unit(void **state)
{
	(void)state;
	static const double units[] = {1, 0x1p530, 0x1p-550};
	double want[SAMPLES * SAMPLES];
	for (int k = 0; k < 3; k++) {
		double numerator[] = {3, 3, 3, 2, 4, 1, 5, 1, 2}, denominator[] = {1, 2, 6, 1, 2, 6, 3, 1, 2};
		double e[SAMPLES * SAMPLES];
		for (int i = 0; i < SAMPLES * SIGNALS; i++)
			numerator[i] *= units[k], denominator[i] *= units[k];
		struct pound_rows rows = rows_of(1, SIGNALS, numerator, denominator);
		assert_int_equal(rows.n_rows, 1);
		pound_rows_noise(&rows, 0, k ? e : want);
		for (int i = 0; i < SAMPLES * SAMPLES && k; i++)
			check_near(e[i], want[i], 0.0);
		free(rows.y);
	}
	assert_true(want[0] > 0);
}

/* If one signal makes up the denominator, the ratio does not show the scatter between signals. */
static void a_row_whose_denominator_is_one_signal_s_alone_is_left_out(void **state)
{
	(void)state;
	static const double numerator[] = {1, 0, 0, 1, 2, 3, 1, 2, 3},
	                    denominator[] = {1, 0, 0, 1, 1, 1, 1, 1, 1};
	struct pound_rows rows = rows_of(1, SIGNALS, numerator, denominator);
	assert_int_equal(rows.n_rows, 0);
	free(rows.y);
}

static void one_signal_says_nothing_of_the_noise(void **state)
{
	(void)state;
	const double numerator[] = {1, 2, 3};
	struct pound_rows rows = rows_of(1, 1, numerator, ones);
	double e[SAMPLES * SAMPLES];
	pound_rows_noise(&rows, 0, e);
	for (int k = 0; k < SAMPLES * SAMPLES; k++)
		assert_true(isnan(e[k]));
	assert_true(isnan(rows.ratio_bias));
	free(rows.y);
}

static void a_known_variance_stands_for_noise_that_samples_do_not_share(void **state)
{
	(void)state;
	const double numerator[] = {1, 2, 3}, variance[] = {0.25, 0, 4};
	struct pound_sample_values values = {.n_rows = 1,
	                                     .n_inputs = D,
	                                     .n_signals = 1,
	                                     .numerator = numerator,
	                                     .denominator = ones,
	                                     .variance = variance};
	struct pound_rows rows;
	double e[SAMPLES * SAMPLES];
	pound_rows_init(&rows, &values, malloc(sizeof(double) * pound_rows_scratch(&values)));
	pound_rows_noise(&rows, 0, e);
	for (int p = 0; p < SAMPLES; p++)
		for (int q = 0; q < SAMPLES; q++)
			check_near(e[p * SAMPLES + q], p == q ? variance[p] : 0.0, 0.0);
	free(rows.y);
}

static void a_row_is_left_out_for_any_number_it_lacks(void **state)
{
	(void)state;
	enum { N = 5, ROW = SAMPLES * SIGNALS };
	double numerator[N * ROW], denominator[N * ROW];
	for (int k = 0; k < N * ROW; k++) {
		numerator[k] = k;
		denominator[k] = 1.0;
	}
	numerator[0 * ROW + 4] = NAN;
	denominator[2 * ROW + ROW - 1] = NAN;
	for (int r = 0; r < SIGNALS; r++)
		denominator[4 * ROW + r] = 0.0; // zero denominator
	struct pound_rows rows = rows_of(N, SIGNALS, numerator, denominator);
	assert_int_equal(rows.n_rows, 2);
	assert_int_equal(rows.row[0], 1);
	assert_int_equal(rows.row[1], 3);
	check_near(rows.y[1] + rows.mean, ROW + 4.0, 1e-14);
	check_near(rows.y[SAMPLES + 1] + rows.mean, 3 * ROW + 4.0, 1e-14);
	free(rows.y);
}

static void equal_outputs_are_exact_zeros_about_their_mean(void **state)
{
	(void)state;
	double numerator[2 * SAMPLES * SIGNALS];
	for (int k = 0; k < 2 * SAMPLES * SIGNALS; k++)
		numerator[k] = 0.1;
	struct pound_rows rows = rows_of(2, SIGNALS, numerator, ones);
	for (int k = 0; k < 2 * SAMPLES; k++)
		check_near(rows.y[k], 0.0, 0.0);
	check_near(rows.mean, 0.1, 1e-16);
	free(rows.y);
}

static void the_jackknife_sees_the_bias_of_a_ratio_of_few_signals(void **state)
{
	(void)state;
	// numerator and denominator independent, uniform on (0, 2): E[U/u] - 1 = 1 / (3 R) + O(R^-2), by the delta method
	enum { N = 4000, R = 10 };
	double *numerator = malloc(sizeof *numerator * N * SAMPLES * R),
	       *denominator = malloc(sizeof *denominator * N * SAMPLES * R), mean = 0.0, fair = 0.0;
	uint64_t word = 1;
	for (int k = 0; k < N * SAMPLES * R; k++)
		for (int side = 0; side < 2; side++) {
			word = word * 6364136223846793005u + 1442695040888963407u;
			*(side ? &denominator[k] : &numerator[k]) = (double)(word >> 32) * 0x1p-31 + 1e-9;
		}
	struct pound_rows rows = rows_of(N, R, numerator, denominator);
	for (int k = 0; k < N * SAMPLES; k++)
		mean += (rows.plain[k] + rows.plain_mean) / (N * SAMPLES),
		    fair += (rows.y[k] + rows.mean) / (N * SAMPLES);
	// a ratio has a standard deviation of sqrt(2 / 3 R) = 0.26, the mean of 12000 ratios 0.0024
	check_near(mean, 1.0 + 1.0 / (3 * R), 0.010);
	check_near(rows.ratio_bias, mean - 1.0, 0.010);
	check_near(mean - rows.ratio_bias, 1.0, 0.010);
	check_near(fair, mean - rows.ratio_bias, 1e-12);
	free(rows.y), free(numerator), free(denominator);
}

static void an_input_of_few_values_has_as_many_levels(void **state)
{
	(void)state;
	double numbers[POUND_CURVE + 1];
	struct pound_input input = {.name = "k"};
	const struct pound_rows unknown = {0}, rows = {.inputs = &input};
	for (int k = 0; k <= POUND_CURVE; k++)
		numbers[k] = k;
	assert_int_equal(pound_rows_levels(&unknown, 0), 0);
	assert_int_equal(pound_rows_levels(&rows, 0), 0); // uniform
	while (!pound_distribution_lists_values(input.distribution.type))
		input.distribution.type++;
	input.distribution.values = numbers;
	const int many[] = {1, 3, POUND_CURVE, POUND_CURVE + 1}, want[] = {1, 3, POUND_CURVE, 0};
	for (int k = 0; k < 4; k++) {
		input.distribution.n_values = many[k];
		assert_int_equal(pound_rows_levels(&rows, 0), want[k]);
	}
}

CHECK_MAIN(cmocka_unit_test(outputs_are_ratios_of_means_less_the_mean_of_a_and_b),
           cmocka_unit_test(the_variance_of_a_ratio_of_means_is_that_of_its_residuals),
           cmocka_unit_test(the_noise_of_a_ratio_is_the_same_in_any_unit),
           cmocka_unit_test(a_row_whose_denominator_is_one_signal_s_alone_is_left_out),
           cmocka_unit_test(one_signal_says_nothing_of_the_noise),
           cmocka_unit_test(a_known_variance_stands_for_noise_that_samples_do_not_share),
           cmocka_unit_test(a_row_is_left_out_for_any_number_it_lacks),
           cmocka_unit_test(equal_outputs_are_exact_zeros_about_their_mean),
           cmocka_unit_test(an_input_of_few_values_has_as_many_levels),
           cmocka_unit_test(the_jackknife_sees_the_bias_of_a_ratio_of_few_signals))
