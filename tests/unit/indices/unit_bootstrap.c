/* unit_bootstrap.c - the distribution of the resamples, and intervals with known ends. */
#include "engine/indices/bootstrap_sums.h"
#include "engine/indices/indices.h"
#include "engine/numeric/cpu_width.h"
#include "tests/support/check.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>

/* The moments of a statistic, and sums over all resamples of the means and of their products. */
struct seen {
	int n_moments, resamples;
	double (*moment)(int row, int k);
	double sum[64], product[64][64];
};

static void moments_of_seen(const void *subject, int row, double *m)
{
	const struct seen *seen = subject;
	for (int k = 0; k < seen->n_moments; k++)
		m[k] = seen->moment(row, k);
}

/* The first value, from all rows, is -1; the others are the numbers of the resamples. */
static void watch(const void *subject, const double *mean, double *value)
{
	struct seen *seen = (struct seen *)subject;
	*value = seen->resamples++;
	if (*value < 0.0)
		return;
	for (int k = 0; k < seen->n_moments; k++) {
		seen->sum[k] += mean[k];
		for (int l = 0; l < seen->n_moments; l++)
			seen->product[k][l] += mean[k] * mean[l];
	}
}

static struct pound_estimate *estimates_of(struct pound_statistic statistic, int n_rows, uint64_t seed)
{
	struct pound_estimate *estimates = malloc(sizeof *estimates * statistic.n_values);
	double *scratch =
	    malloc(sizeof *scratch * pound_bootstrap_scratch(n_rows, statistic.n_moments, statistic.n_values));
	pound_bootstrap_interval(&statistic, n_rows, (struct pound_resampling){seed, POUND_RESAMPLES}, scratch,
	                         estimates);
	free(scratch);
	return estimates;
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

/* Counts of resampled rows in groups, against the mean and the covariance of the multinomial distribution. */
static void check_multinomial(int n_rows, int groups, double (*moment)(int, int), const double *share,
                              uint64_t seed)
{
	struct seen seen = {.n_moments = groups, .resamples = -1, .moment = moment};
	free(
	    estimates_of((struct pound_statistic){groups, 1, moments_of_seen, watch, &seen, NULL}, n_rows, seed));
	assert_int_equal(seen.resamples, POUND_RESAMPLES);
	const double n = n_rows, b = POUND_RESAMPLES;
	for (int k = 0; k < groups; k++) {
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
}

static void rows_are_drawn_as_often_as_a_multinomial_says(void **state)
{
	(void)state;
	double share[64];
	static const int sizes[] = {1, 2, 3, 12, 47};
	for (int s = 0; s < 5; s++) {
		for (int k = 0; k < sizes[s]; k++)
			share[k] = 1.0 / sizes[s];
		check_multinomial(sizes[s], sizes[s], one_hot, share, s);
	}
	static const int larger[] = {48 * 20, 48 * 22, 48 * 64, 48 * 111};
	for (int s = 0; s < 4; s++) {
		for (int k = 0; k < 48; k++)
			share[k] = 1.0 / 48.0;
		check_multinomial(larger[s], 48, modulo, share, s);
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
		check_multinomial(sizes[s], groups, by_128, share, s);
	}
}

static void the_interval_ends_at_the_quantiles_of_the_resamples(void **state)
{
	(void)state;
	// the values are 0, 1, ... 1999 in the order of the resamples
	struct seen seen = {.n_moments = 1, .resamples = -1, .moment = one_hot};
	struct pound_estimate *e =
	    estimates_of((struct pound_statistic){1, 1, moments_of_seen, watch, &seen, NULL}, 10, 1);
	check_near(e->value, -1.0, 0.0);
	check_near(e->low, 0.025 * 1999.0, 1e-12);
	check_near(e->high, 0.975 * 1999.0, 1e-12);
	free(e);
}

static void first_row(const void *subject, int row, double *m)
{
	(void)subject;
	*m = row == 0;
}

/* 7 for a resample that contains row 0, otherwise undefined; always undefined; undefined for resamples that contain
 * row 0 once, as all rows do. */
static void seven_or_nothing(const void *subject, const double *mean, double *value)
{
	(void)subject;
	value[0] = mean[0] > 0.0 ? 7.0 : NAN;
	value[1] = NAN;
	value[2] = fabs(mean[0] - 0.1) > 1e-9 ? 7.0 : NAN;
}

static void undefined_resamples_are_left_out_and_undefined_values_have_no_interval(void **state)
{
	(void)state;
	struct pound_estimate *e =
	    estimates_of((struct pound_statistic){1, 3, first_row, seven_or_nothing, NULL, NULL}, 10, 1);
	check_near(e[0].low, 7.0, 0.0);
	check_near(e[0].high, 7.0, 0.0);
	assert_true(isnan(e[1].low) && isnan(e[1].high));
	assert_true(isnan(e[2].value) && isnan(e[2].low) && isnan(e[2].high));
	free(e);
}

enum { ROWS = 3000 };

static void normal_row(const void *subject, int row, double *m)
{
	(void)subject;
	m[0] = gsl_cdf_ugaussian_Pinv((row + 0.5) / ROWS);
	m[1] = 1e3 - 2.0 * m[0];
}

static void both_means(const void *subject, const double *mean, double *value)
{
	(void)subject;
	value[0] = mean[0];
	value[1] = mean[1];
}

static void intervals_of_a_mean_are_those_of_the_normal_law(void **state)
{
	(void)state;
	const struct pound_statistic statistic = {2, 2, normal_row, both_means, NULL, NULL};
	struct pound_estimate *e = estimates_of(statistic, ROWS, 5);
	check_near(e[0].value, 0.0, 1e-13);
	// a 2.5 % quantile of 2000 normal values has deviation sqrt(.025 .975 / 2000) / .0584 = .060
	check_near(e[0].low * sqrt(ROWS), -1.95996, 5.0 * 0.060);
	check_near(e[0].high * sqrt(ROWS), 1.95996, 5.0 * 0.060);
	check_near(e[1].low, 1e3 - 2.0 * e[0].high, 1e-10);
	check_near(e[1].high, 1e3 - 2.0 * e[0].low, 1e-10);

	struct pound_estimate *again = estimates_of(statistic, ROWS, 5),
	                      *other = estimates_of(statistic, ROWS, 6);
	assert_memory_equal(again, e, sizeof *e * 2);
	assert_true(other[0].low != e[0].low && other[0].high != e[0].high);
	free(e), free(again), free(other);
}

static void sums_are_the_same_bits_at_any_width(void **state)
{
	(void)state;
	enum { MOST = 2500, TILES = 2, SUMS = POUND_RESAMPLE_GROUP * TILES * POUND_TILE };
	static _Alignas(64) double table[TILES * MOST * POUND_TILE], want[SUMS], got[SUMS];
	static const int sizes[] = {1, 2, 7, 100, 1024, MOST};
	for (int k = 0; k < TILES * MOST * POUND_TILE; k++)
		table[k] = sin(k);
	for (int s = 0; s < 6; s++) {
		const struct pound_tiles tiles = {sizes[s], TILES, table, NULL};
		pound_bootstrap_sums(POUND_WIDTH_PORTABLE, &tiles, 3, 8, want);
		for (int lanes = 1; lanes <= 8; lanes++) {
			if (pound_dispatch_width(lanes) < 0)
				continue;
			pound_bootstrap_sums(pound_dispatch_width(lanes), &tiles, 3, 8, got);
			assert_memory_equal(got, want, sizeof want);
		}
	}
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct kept {
	int wanted, n;
	double value[POUND_RESAMPLES + 1];
};

/* The first `wanted` values, including the one from all rows, in no order; NAN afterwards. */
static void keep_mean(const void *subject, const double *mean, double *value)
{
	struct kept *kept = (struct kept *)subject;
	*value = kept->n < kept->wanted ? sin(1e3 * *mean) : NAN;
	kept->value[kept->n++] = *value;
}

static void uneven(const void *subject, int row, double *m)
{
	(void)subject;
	*m = row * row;
}

static void however_many_values_there_are_the_ends_are_their_quantiles(void **state)
{
	(void)state;
	static const int wanted[] = {2, 3, 4, 40, 41, 42, 43, 500, POUND_RESAMPLES + 1};
	for (int k = 0; k < 9; k++) {
		struct kept kept = {.wanted = wanted[k]};
		struct pound_estimate *e =
		    estimates_of((struct pound_statistic){1, 1, uneven, keep_mean, &kept, NULL}, 100, k);
		const int n = wanted[k] - 1;
		qsort(kept.value + 1, n, sizeof(double), ascending);
		check_near(e->low, gsl_stats_quantile_from_sorted_data(kept.value + 1, 1, n, 0.025), 1e-15);
		check_near(e->high, gsl_stats_quantile_from_sorted_data(kept.value + 1, 1, n, 0.975), 1e-15);
		free(e);
	}
}

CHECK_MAIN(cmocka_unit_test(rows_are_drawn_as_often_as_a_multinomial_says),
           cmocka_unit_test(rows_beyond_the_first_segment_are_drawn_as_often_as_the_others),
           cmocka_unit_test(sums_are_the_same_bits_at_any_width),
           cmocka_unit_test(the_interval_ends_at_the_quantiles_of_the_resamples),
           cmocka_unit_test(however_many_values_there_are_the_ends_are_their_quantiles),
           cmocka_unit_test(undefined_resamples_are_left_out_and_undefined_values_have_no_interval),
           cmocka_unit_test(intervals_of_a_mean_are_those_of_the_normal_law))
