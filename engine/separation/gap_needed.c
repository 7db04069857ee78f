/* gap_needed.c - the probability of pounding with a gap, and the gap for a probability, from the gaps needed in runs. */
#include "engine/separation/separation.h"

#include <math.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort_double.h>

enum { BISECTIONS = 60 };

/* Most runs that an interval counts: with more, the continued fraction of the beta distribution is too long, and the interval is
 * narrow anyway. */
static const double RUNS_COUNTED = 1e5;

/* probability on each side of a 95 % interval */
static const double TAIL = 0.025;

/* Number of sorted gaps that are larger than a gap. */
static int64_t count_above(const double *sorted, int64_t n, double gap)
{
	int64_t low = -1, high = n;
	while (high - low > 1) {
		const int64_t middle = low + (high - low) / 2;
		if (sorted[middle] > gap)
			high = middle;
		else
			low = middle;
	}
	return n - high;
}

/* Counts the runs that need more than a gap; runs without a result are left out.
 *
 * Test     unit_separation: pounding_is_counted_run_by_run */
struct pound_needed_count pound_needed_count(const struct pound_needed *needed, double gap)
{
	struct pound_needed_count count = {0};
	if (needed->sorted && needed->size == 1)
		return (struct pound_needed_count){count_above(needed->sorted, needed->n_sorted, gap),
		                                   needed->n_sorted, needed->n_sorted};
	for (int c = 0; c < needed->n_clusters; c++) {
		bool any = false;
		for (int k = 0; k < needed->size; k++) {
			const double one = needed->gap[(size_t)c * (size_t)needed->size + (size_t)k];
			count.pounding += one > gap;
			count.runs += !isnan(one);
			any |= !isnan(one);
		}
		count.clusters += any;
	}
	return count;
}

/* The quantile of a beta distribution by bisection; a = 0: 0, b = 0: 1. */
static double beta_quantile(double p, double a, double b)
{
	double low = 0, high = 1;
	if (!(a > 0))
		return 0;
	if (!(b > 0))
		return 1;
	for (int k = 0; k < BISECTIONS; k++) {
		const double middle = 0.5 * (low + high);
		if (gsl_cdf_beta_P(middle, a, b) < p)
			low = middle;
		else
			high = middle;
	}
	return 0.5 * (low + high);
}

/* Effective number of independent runs of dependent runs in clusters.
 *
 *   n_eff = p (1 - p) / Var p * (t_(n-1) / t_(m-1))^2,   Var p = m/(m - 1) sum_c (k_c - p n_c)^2 / n^2,   at most n
 *
 * with n runs in m clusters, k_c of the n_c runs of cluster c pounding, and the 0.975 quantiles t of Student's distribution.
 * If all runs pound or none does, the variance is unknown, and each cluster counts as one run. */
static double runs_effective(const struct pound_needed *needed, double gap,
                             const struct pound_needed_count *count)
{
	const double n = (double)count->runs, p = (double)count->pounding / n, m = (double)count->clusters;
	double sum = 0;
	for (int c = 0; c < needed->n_clusters; c++) {
		const struct pound_needed one = {
		    .n_clusters = 1, .size = needed->size, .gap = needed->gap + (size_t)c * (size_t)needed->size};
		const struct pound_needed_count of = pound_needed_count(&one, gap);
		const double off = (double)of.pounding - p * (double)of.runs;
		sum += off * off;
	}
	const double variance = m / (m - 1) * sum / (n * n);
	if (m < 2 || !(variance > 0))
		return m;
	const double t = gsl_cdf_tdist_Qinv(TAIL, n - 1) / gsl_cdf_tdist_Qinv(TAIL, m - 1);
	return fmin(p * (1 - p) / variance * t * t, n);
}

/* The probability that a run pounds with a gap, with its 95 % interval; NAN: no run has a result.
 *
 * Independent runs: the exact binomial interval.  Clusters of runs: the interval of the effective number of independent runs.
 *
 * Source   Clopper and Pearson 1934, Biometrika 26, 404-413; Korn and Graubard 1998, Survey Methodology 24, 193-201
 * Test     unit_separation: the_band_is_the_exact_binomial_one, clusters_of_equal_runs_count_once
 */
struct pound_estimate pound_needed_probability(const struct pound_needed *needed, double gap)
{
	const struct pound_needed_count count = pound_needed_count(needed, gap);
	if (count.runs == 0)
		return (struct pound_estimate){NAN, NAN, NAN};
	const double p = (double)count.pounding / (double)count.runs;
	const double n =
	    fmin(needed->size == 1 ? (double)count.runs : runs_effective(needed, gap, &count), RUNS_COUNTED);
	const double k = needed->size == 1 && n == (double)count.runs ? (double)count.pounding : p * n;
	return (struct pound_estimate){p, beta_quantile(TAIL, k, n - k + 1),
	                               beta_quantile(1 - TAIL, k + 1, n - k)};
}

/* The needed gaps in ascending order, without runs that have no result; returns their number. */
int64_t pound_needed_sort(const struct pound_needed *needed, double *sorted)
{
	int64_t n = 0;
	for (size_t k = 0; k < (size_t)needed->n_clusters * (size_t)needed->size; k++)
		if (!isnan(needed->gap[k]))
			sorted[n++] = needed->gap[k];
	gsl_sort(sorted, 1, (size_t)n);
	return n;
}

/* Index of the first of n sorted gaps at which pounding is rare enough; n: there is none.
 *
 * Given    end   -1: low end of the interval of the probability of pounding <= probability; 0: value <= probability;
 *                1: high end < probability
 */
static int64_t first_below(const struct pound_needed *needed, const double *sorted, int64_t n,
                           double probability, int end)
{
	int64_t low = -1, high = n;
	while (high - low > 1) {
		const int64_t middle = low + (high - low) / 2;
		const struct pound_estimate at = pound_needed_probability(needed, sorted[middle]);
		const bool below = end < 0   ? at.low <= probability
		                   : end > 0 ? at.high < probability
		                             : at.value <= probability;
		if (below)
			high = middle;
		else
			low = middle;
	}
	return high;
}

/* The gap at which pounding has a given probability, and its 95 % interval.
 *
 * Given    sorted      (n)   m   by pound_needed_sort
 * Returns  value             m   the smallest needed gap that at most a fraction `probability` of the runs exceeds
 *          low, high         m   the gaps at which the ends of the interval of the probability of pounding reach that
 *                                probability; for independent runs these are the distribution-free order statistics;
 *                                high NAN: too few runs for an upper limit
 *
 * Source   David and Nagaraja 2003, Order Statistics, 7.1; Woodruff 1952, J. Am. Stat. Assoc. 47, 635-646
 * Test     unit_separation: the_gap_for_a_probability_has_the_interval_of_order_statistics
 */
struct pound_estimate pound_needed_gap(const struct pound_needed *needed, const double *sorted, int64_t n,
                                       double probability)
{
	if (n == 0)
		return (struct pound_estimate){NAN, NAN, NAN};
	const int64_t at = first_below(needed, sorted, n, probability, 0),
	              low = first_below(needed, sorted, n, probability, -1),
	              high = first_below(needed, sorted, n, probability, 1);
	// whether the interval reaches down to gap 0; all runs need more than -1 m
	const bool from_rest = pound_needed_probability(needed, -1).low <= probability;
	return (struct pound_estimate){sorted[at < n ? at : n - 1], from_rest ? 0 : sorted[low < n ? low : n - 1],
	                               high < n ? sorted[high] : NAN};
}
