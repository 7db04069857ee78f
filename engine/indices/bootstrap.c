/* bootstrap.c - 95 % intervals of a statistic of row means, by resampling whole rows.
 *
 * 1. A resample draws n_rows rows with replacement; the draws are a function of (seed, resample) alone.
 * 2. Each resample gives one value of the statistic of its means.
 * 3. The interval goes from the 2.5 % to the 97.5 % quantile of these values.
 *
 * Efron, Tibshirani 1993, An introduction to the bootstrap, chapter 13.  For random and Latin hypercube designs only: rows
 * of a quasi-random design are not a random sample, and intervals would be several times too wide (see jackknife.c). */
#include "engine/indices/indices.h"

#include "engine/indices/bootstrap_sums.h"
#include "engine/numeric/cpu_width.h"

#include <assert.h>
#include <math.h>
#include <stdalign.h>
#include <string.h>

enum {
	TILE = POUND_TILE,
	GROUP = POUND_RESAMPLE_GROUP,
	WIDTH_MAX = (POUND_MOMENTS_MAX + TILE - 1) / TILE * TILE, /* moments in whole tiles */
	ENDS_MAX = POUND_RESAMPLES / 40 + 2,                      /* values up to a quantile of 2.5 % */
};

static double *moments_of_row(const struct pound_tiles *moments, int row, int tile)
{
	return moments->tile + ((size_t)tile * moments->n_rows + row) * TILE;
}

static struct pound_tiles moments_of(const struct pound_statistic *statistic, int n_rows, double *scratch)
{
	struct pound_tiles moments = {n_rows, (statistic->n_moments + TILE - 1) / TILE, scratch, statistic->stop};
	for (int i = 0; i < n_rows && !pound_stopped(statistic->stop); i++) {
		double m[WIDTH_MAX] = {0};
		statistic->moments(statistic->subject, i, m);
		for (int t = 0; t < moments.n_tiles; t++)
			memcpy(moments_of_row(&moments, i, t), m + TILE * t, sizeof *m * TILE);
	}
	return moments;
}

static void moments_means(const struct pound_tiles *moments, int n_moments, double *mean)
{
	for (int k = 0; k < n_moments && !pound_stopped(moments->stop); k++) {
		double sum = 0.0;
		for (int i = 0; i < moments->n_rows; i++)
			sum += moments_of_row(moments, i, k / TILE)[k % TILE];
		mean[k] = sum / moments->n_rows;
	}
}

/* Quantile of n values, linear between the order statistics around (n - 1) p.
 *
 * Valid    p up to 2.5 % or from 97.5 %: only the few values beyond the quantile are kept, sorted by insertion
 */
static double quantile(const double *value, int n, double p)
{
	const int below = (int)((n - 1) * p), up = p < 0.5 ? 1 : -1;
	// ranks of the two order statistics, counted from the nearer end
	const int at = up > 0 ? below : n - 1 - below, next = below < n - 1 ? at + up : at;
	const int wanted = (at > next ? at : next) + 1;
	double kept[ENDS_MAX];
	int have = 0;
	for (int i = 0; i < n; i++) {
		const double x = up * value[i];
		if (have == wanted && !(x < kept[wanted - 1]))
			continue;
		int place = have < wanted ? have++ : wanted - 1;
		for (; place > 0 && x < kept[place - 1]; place--)
			kept[place] = kept[place - 1];
		kept[place] = x;
	}
	return up * (kept[at] + ((n - 1) * p - below) * (kept[next] - kept[at]));
}

size_t pound_bootstrap_scratch(int n_rows, int n_moments, int n_values)
{
	size_t tiles = (n_moments + TILE - 1) / TILE;
	return tiles * n_rows * TILE + (size_t)n_values * POUND_RESAMPLES + TILE;
}

/* A statistic's values, with 95 % percentile bootstrap intervals.
 *
 * Given    statistic  -               moments of a row, and n_values numbers from their means
 *          n_rows     -               [1, 2^20]
 *          seed       -               same seed, same resamples
 *          n_resamples                a multiple of 8, at most POUND_RESAMPLES
 * Returns  estimates  (n_values)      low and high are NAN where no resample defines the value
 * Memory   scratch    (pound_bootstrap_scratch)
 *
 * Resamples with an undefined value (all rows equal) are left out of its quantiles; a value undefined for the rows
 * themselves has no interval.
 *
 * Valid    Independent rows or one Latin hypercube, for which intervals are 3-13 % too wide
 * Source   percentile interval, Efron, Tibshirani 1993, section 13.3
 * Test     unit_bootstrap: intervals_of_a_mean_are_those_of_the_normal_law
 */
void pound_bootstrap_interval(const struct pound_statistic *statistic, int n_rows,
                              struct pound_resampling resampling, double *scratch,
                              struct pound_estimate *estimates)
{
	assert(statistic->n_moments <= POUND_MOMENTS_MAX && statistic->n_values <= POUND_VALUES_MAX);
	assert(n_rows <= POUND_RESAMPLE_ROWS_MAX);
	assert(resampling.n % GROUP == 0 && resampling.n <= POUND_RESAMPLES);
	const int n_moments = statistic->n_moments;
	double *on_cache_line = (double *)(((uintptr_t)scratch + 63) / 64 * 64);
	const struct pound_tiles moments = moments_of(statistic, n_rows, on_cache_line);
	const int width = moments.n_tiles * TILE;
	double *resampled = moments.tile + (size_t)width * n_rows;
	alignas(64) double sum[GROUP * WIDTH_MAX];
	double mean[WIDTH_MAX], value[POUND_VALUES_MAX];
	int defined[POUND_VALUES_MAX] = {0};
	moments_means(&moments, n_moments, mean);
	statistic->values(statistic->subject, mean, value);
	for (int v = 0; v < statistic->n_values; v++)
		estimates[v] = (struct pound_estimate){value[v], NAN, NAN};
	for (int r = 0; r < resampling.n && !pound_stopped(statistic->stop); r++) {
		if (r % GROUP == 0)
			pound_bootstrap_sums(pound_dispatch_width(0), &moments, resampling.seed, r, sum);
		for (int k = 0; k < n_moments; k++)
			mean[k] = sum[r % GROUP * width + k] / n_rows;
		statistic->values(statistic->subject, mean, value);
		for (int v = 0; v < statistic->n_values; v++)
			if (!isnan(value[v]))
				resampled[v * POUND_RESAMPLES + defined[v]++] = value[v];
	}
	for (int v = 0; v < statistic->n_values; v++)
		if (defined[v] && !isnan(estimates[v].value)) {
			estimates[v].low = quantile(resampled + v * POUND_RESAMPLES, defined[v], 0.025);
			estimates[v].high = quantile(resampled + v * POUND_RESAMPLES, defined[v], 0.975);
		}
}

/* A statistic's values, with 95 % intervals by the jackknife for grouped rows, else by the bootstrap.
 *
 * Given    scatter    -               groups: leave one out (jackknife.c); none: resample rows
 *          the rest                   as for pound_bootstrap_interval
 * Returns  estimates  (n_values)
 * Memory   scratch    (pound_bootstrap_scratch)
 *
 * Test     unit_jackknife: rows_in_groups_are_never_resampled
 */
void pound_bootstrap_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                               int n_rows, struct pound_resampling resampling, double *scratch,
                               struct pound_estimate *estimates)
{
	assert(pound_jackknife_scratch(scatter, statistic->n_moments) <=
	       pound_bootstrap_scratch(n_rows, statistic->n_moments, statistic->n_values));
	if (scatter->grouping.n)
		pound_jackknife_estimates(statistic, scatter, n_rows, scratch, estimates);
	else
		pound_bootstrap_interval(statistic, n_rows, resampling, scratch, estimates);
}
