/* unit_rows.c - ratios of means, their covariances over draws of the signals, and the rows that are left out. */
#include "engine/indices.h"
#include "tests/check.h"

#include <math.h>

enum { D = 1, SAMPLES = D + 2, SIGNALS = 3 };

/* Rows of one input from values; the memory goes with rows->y. */
static struct pound_rows rows_of(int n_rows, int n_signals, const double *numerator,
                                 const double *denominator)
{
	struct pound_sample_values values = {n_rows, D, n_signals, numerator, denominator, NULL, {0}};
	struct pound_rows rows;
	pound_rows_init(&rows, &values, malloc(sizeof(double) * pound_rows_scratch(n_rows, D, n_signals)));
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
	check_near(rows.mean, 3.0, 0.0);
	for (int k = 0; k < 6; k++)
		check_near(rows.y[k], want[k] - 3.0, 0.0);
	free(rows.y);
}

static void the_variance_of_a_ratio_of_means_is_that_of_its_linearisation(void **state)
{
	(void)state;
	// deviations from the means: A (-2, -1, 3), B (1, 0, -1), the mixed sample twice those of A
	const double numerator[] = {1, 2, 6, 8, 7, 6, 0, 2, 10, 1, 2, 6, 8, 7, 6, 0, 2, 10};
	struct pound_rows rows = rows_of(2, SIGNALS, numerator, ones);
	const double *e = rows.noise + pound_rows_noises(D);
	// mean squares over 3 - 1, of means of 3
	check_near(e[POUND_NOISE_AA], 14.0 / 6.0, 1e-15);
	check_near(e[POUND_NOISE_BB], 2.0 / 6.0, 1e-15);
	check_near(e[POUND_NOISE_AB], -5.0 / 6.0, 1e-15);
	check_near(e[POUND_NOISE_MIXED], 56.0 / 6.0, 1e-14);
	check_near(e[POUND_NOISE_MIXED + 1], 28.0 / 6.0, 1e-14);
	check_near(e[POUND_NOISE_MIXED + 2], -10.0 / 6.0, 1e-14);
	free(rows.y);

	// a numerator in proportion to the denominator leaves nothing to chance, a constant one the denominator's
	const double proportional[] = {2, 4, 12, 3, 3, 3, 2, 4, 12}, below[] = {1, 2, 6, 1, 2, 6, 1, 2, 6};
	rows = rows_of(1, SIGNALS, proportional, below);
	check_near(rows.noise[POUND_NOISE_AA], 0.0, 0.0);
	check_near(rows.noise[POUND_NOISE_BB], 14.0 / 9.0 / 6.0, 1e-15);
	check_near(rows.noise[POUND_NOISE_AB], 0.0, 0.0);
	free(rows.y);
}

static void one_signal_says_nothing_of_the_noise(void **state)
{
	(void)state;
	const double numerator[] = {1, 2, 3};
	struct pound_rows rows = rows_of(1, 1, numerator, ones);
	for (int k = 0; k < pound_rows_noises(D); k++)
		assert_true(isnan(rows.noise[k]));
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
		denominator[4 * ROW + r] = 0.0; // no mean to divide by
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

CHECK_MAIN(cmocka_unit_test(outputs_are_ratios_of_means_less_the_mean_of_a_and_b),
           cmocka_unit_test(the_variance_of_a_ratio_of_means_is_that_of_its_linearisation),
           cmocka_unit_test(one_signal_says_nothing_of_the_noise),
           cmocka_unit_test(a_row_is_left_out_for_any_number_it_lacks),
           cmocka_unit_test(equal_outputs_are_exact_zeros_about_their_mean))
