/* gap_needed.c - the probability that bodies with a gap pound, and the gap for a probability, from the gaps that runs need. */
#include "engine/separation/separation.h"

#include <math.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort_double.h>

enum { BISECTIONS = 60 };

/* Runs that an interval counts at most: from there on the continued fraction behind it is too long, and it is narrow. */
static const double RUNS_COUNTED = 1e5;

/* on either side of a 95 % interval */
static const double TAIL = 0.025;

/* Sorted gaps that are larger than a gap. */
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

/* Test     unit_separation: pounding_is_counted_run_by_run */
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

/* The quantile of a beta distribution; its ends where a parameter is 0. */
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

/* Runs that are worth as much as independent ones.
 *
 *   n_eff = p (1 - p) / Var p * (t_(n-1) / t_(clusters-1))^2,   Var p = clusters/(clusters - 1) sum_c (k_c - p n_c)^2 / n^2
 *
 * Where all runs pound or none does the variance is not known, and a cluster counts as one run. */
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

/* The probability that a run pounds with a gap, with its 95 % interval.
 *
 * Independent runs have the exact binomial interval; clusters of runs have the interval of as many independent runs as
 * give the same variance.
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

/* The gaps needed in ascending order, without runs that have no result; returns how many. */
int64_t pound_needed_sort(const struct pound_needed *needed, double *sorted)
{
	int64_t n = 0;
	for (size_t k = 0; k < (size_t)needed->n_clusters * (size_t)needed->size; k++)
		if (!isnan(needed->gap[k]))
			sorted[n++] = needed->gap[k];
	gsl_sort(sorted, 1, (size_t)n);
	return n;
}

/* The first of n sorted gaps, from index 0 on, at which an end of the interval (or the value) of the probability to pound is
 * at most, or below, a probability; n: none. */
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

/* The gap that is too small with a probability, and its 95 % interval.
 *
 * Given    sorted   (n)   by pound_needed_sort
 * Returns  value    the smallest gap needed that at most that share of the runs exceeds
 *          low, high   gaps between which the interval of the probability to pound has that probability: of independent runs
 *                   order statistics, whatever the distribution; high NAN: the runs are too few for an upper limit
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
	// even no gap at all may pound with that probability: every run needs more than -1 m
	const bool from_rest = pound_needed_probability(needed, -1).low <= probability;
	return (struct pound_estimate){sorted[at < n ? at : n - 1], from_rest ? 0 : sorted[low < n ? low : n - 1],
	                               high < n ? sorted[high] : NAN};
}
