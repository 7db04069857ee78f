/* unit_interval.c - the law of the resamples, and intervals whose ends are known. */
#include "engine/indices.h"
#include "tests/check.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

/* Moments of n rows from a function of row and column, on a cache line; freed by the caller through tiles. */
static struct pound_moments moments_of(int n_rows, int n_moments, double (*value)(int row, int k))
{
	int tiles = pound_interval_tiles(n_moments);
	struct pound_moments m = {n_rows, n_moments,
	                          aligned_alloc(64, sizeof(double) * POUND_TILE * tiles * (size_t)n_rows)};
	for (int i = 0; i < n_rows; i++)
		for (int k = 0; k < tiles * POUND_TILE; k++)
			pound_interval_moment(&m, i, k / POUND_TILE)[k % POUND_TILE] = k < n_moments ? value(i, k) : 0.0;
	return m;
}

/* What a statistic saw: the sums over all resamples of its means and of their products. */
struct seen {
	int n_moments, resamples;
	double sum[64], product[64][64];
};

static void watch(const void *subject, const double *mean, double *value)
{
	struct seen *seen = (struct seen *)subject;
	for (int k = 0; k < seen->n_moments; k++) {
		seen->sum[k] += mean[k];
		for (int l = 0; l < seen->n_moments; l++)
			seen->product[k][l] += mean[k] * mean[l];
	}
	*value = seen->resamples++;
}

static struct seen watched(const struct pound_moments *moments, uint64_t seed)
{
	struct seen seen = {.n_moments = moments->n_moments};
	struct pound_statistic statistic = {1, watch, &seen};
	struct pound_estimate estimate;
	double *scratch = malloc(sizeof *scratch * POUND_RESAMPLES);
	pound_interval_bootstrap(moments, &statistic, seed, scratch, &estimate);
	free(scratch);
	assert_int_equal(seen.resamples, POUND_RESAMPLES);
	return seen;
}

static double one_hot(int row, int k)
{
	return row == k;
}
static double modulo(int row, int k)
{
	return row % 48 == k;
}
static double by_128(int row, int k)
{
	return row / 128 == k;
}

/* Counts of resampled rows in groups of given shares against the multinomial law's mean and covariance. */
static void check_multinomial(struct pound_moments moments, const double *share, uint64_t seed)
{
	struct seen seen = watched(&moments, seed);
	const double n = moments.n_rows, b = POUND_RESAMPLES;
	for (int k = 0; k < moments.n_moments; k++) {
		double variance = share[k] * (1.0 - share[k]) / n;
		check_near(seen.sum[k] / b, share[k], 5.0 * sqrt(variance / b));
		for (int l = 0; l <= k; l++) {
			double want = (k == l) * share[k] / n - share[k] * share[l] / n;
			double other = share[l] * (1.0 - share[l]) / n;
			double got = seen.product[k][l] / b - share[k] * seen.sum[l] / b - share[l] * seen.sum[k] / b +
			             share[k] * share[l];
			// a covariance of b draws has variance (v1 v2 + c^2) / b, with the fourth moment of one row
			double spread = (variance * other + want * want + (k == l) * share[k] / (n * n * n)) / b;
			check_near(got, want, 5.0 * sqrt(spread));
		}
	}
	free(moments.tiles);
}

static void rows_are_drawn_as_often_as_a_multinomial_says(void **state)
{
	(void)state;
	double share[64];
	static const int sizes[] = {1, 2, 3, 12, 47};
	for (int s = 0; s < 5; s++) {
		for (int k = 0; k < sizes[s]; k++)
			share[k] = 1.0 / sizes[s];
		check_multinomial(moments_of(sizes[s], sizes[s], one_hot), share, s);
	}
	static const int larger[] = {48 * 20, 48 * 22, 48 * 64, 48 * 111};
	for (int s = 0; s < 4; s++) {
		for (int k = 0; k < 48; k++)
			share[k] = 1.0 / 48.0;
		check_multinomial(moments_of(larger[s], 48, modulo), share, s);
	}
}

static void rows_beyond_the_first_segment_are_drawn_as_often_as_the_others(void **state)
{
	(void)state;
	static const int sizes[] = {1025, 2047, 3000, 5000};
	for (int s = 0; s < 4; s++) {
		double share[64];
		int groups = (sizes[s] + 127) / 128;
		for (int k = 0; k < groups; k++)
			share[k] = fmin(128.0, sizes[s] - 128.0 * k) / sizes[s];
		check_multinomial(moments_of(sizes[s], groups, by_128), share, s);
	}
}

static void the_interval_ends_at_the_quantiles_of_the_resamples(void **state)
{
	(void)state;
	// the values are 0, 1, ... 1999 in the order of the resamples
	struct pound_moments moments = moments_of(10, 1, one_hot);
	struct seen seen = {.n_moments = 1};
	struct pound_statistic statistic = {1, watch, &seen};
	struct pound_estimate estimate;
	double scratch[POUND_RESAMPLES];
	pound_interval_bootstrap(&moments, &statistic, 1, scratch, &estimate);
	check_near(estimate.low, 0.025 * 1999.0, 1e-12);
	check_near(estimate.high, 0.975 * 1999.0, 1e-12);
	free(moments.tiles);
}

/* 7 for a resample that holds row 0, undefined for the others. */
static void seven_or_nothing(const void *subject, const double *mean, double *value)
{
	(void)subject;
	value[0] = mean[0] > 0.0 ? 7.0 : NAN;
	value[1] = NAN;
}

static void undefined_resamples_are_left_out(void **state)
{
	(void)state;
	struct pound_moments moments = moments_of(10, 1, one_hot);
	struct pound_statistic statistic = {2, seven_or_nothing, NULL};
	struct pound_estimate estimates[2];
	double scratch[2 * POUND_RESAMPLES];
	pound_interval_bootstrap(&moments, &statistic, 1, scratch, estimates);
	check_near(estimates[0].low, 7.0, 0.0);
	check_near(estimates[0].high, 7.0, 0.0);
	assert_true(isnan(estimates[1].low) && isnan(estimates[1].high));
	free(moments.tiles);
}

enum { ROWS = 3000 };

static double normal_row(int row, int k)
{
	return k == 0 ? gsl_cdf_ugaussian_Pinv((row + 0.5) / ROWS) : 1e3 - 2.0 * normal_row(row, 0);
}

static void first_mean(const void *subject, const double *mean, double *value)
{
	(void)subject;
	value[0] = mean[0];
	value[1] = mean[1];
}

static void intervals_of_a_mean_are_those_of_the_normal_law(void **state)
{
	(void)state;
	struct pound_moments moments = moments_of(ROWS, 2, normal_row);
	struct pound_statistic statistic = {2, first_mean, NULL};
	struct pound_estimate e[2], again[2], other[2];
	double scratch[2 * POUND_RESAMPLES];
	pound_interval_bootstrap(&moments, &statistic, 5, scratch, e);
	// a 2.5 % quantile of 2000 normal values has deviation sqrt(.025 .975 / 2000) / .0584 = .060
	check_near(e[0].low * sqrt(ROWS), -1.95996, 5.0 * 0.060);
	check_near(e[0].high * sqrt(ROWS), 1.95996, 5.0 * 0.060);
	check_near(e[1].low, 1e3 - 2.0 * e[0].high, 1e-10);
	check_near(e[1].high, 1e3 - 2.0 * e[0].low, 1e-10);

	pound_interval_bootstrap(&moments, &statistic, 5, scratch, again);
	for (int v = 0; v < 2; v++)
		assert_true(again[v].low == e[v].low && again[v].high == e[v].high);
	pound_interval_bootstrap(&moments, &statistic, 6, scratch, other);
	assert_true(other[0].low != e[0].low && other[0].high != e[0].high);
	free(moments.tiles);
}

CHECK_MAIN(cmocka_unit_test(rows_are_drawn_as_often_as_a_multinomial_says),
           cmocka_unit_test(rows_beyond_the_first_segment_are_drawn_as_often_as_the_others),
           cmocka_unit_test(the_interval_ends_at_the_quantiles_of_the_resamples),
           cmocka_unit_test(undefined_resamples_are_left_out),
           cmocka_unit_test(intervals_of_a_mean_are_those_of_the_normal_law))
