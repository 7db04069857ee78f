/* fragility.c - fragility curves: the probability of pounding as a function of the intensity x of the ground motion.
 *
 *   P(x) = Phi(a + b ln x) = Phi(ln(x / median) / dispersion)
 *
 * 1. Maximum likelihood of the counts by Fisher scoring; the likelihood has one maximum.
 * 2. Intervals by a sandwich estimator, from the scores of the clusters summed over all intensities. */
#include <math.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include "engine/numeric/elementary.h"
#include "engine/separation/separation.h"

enum { ROUNDS = 100, HALVINGS = 40 };

static const double NORMAL_95 = 1.959963984540054; // quantile 0.975
static const double STEP_LEAST = 1e-12;            // sum of the changes of a and b that ends the iteration

/* The line a + b (ln x - center). */
struct line {
	double a, b;
};

/* of the log-likelihood: value, gradient by a and b, expected information  (aa, ab, bb) */
struct likelihood {
	double value, gradient[2], information[3];
};

/* pdf(z) / Phi(z) of the standard normal distribution; by the asymptote -z where both underflow */
static double density_over(double z)
{
	const double below = gsl_cdf_ugaussian_P(z);
	return below > 1e-300 ? gsl_ran_ugaussian_pdf(z) / below : -z;
}

/* Counts of one cluster at an intensity; cluster < 0: of all clusters. */
static struct pound_needed_count count_of(const struct pound_stripes *stripes, int stripe, int cluster,
                                          double gap)
{
	struct pound_needed needed = stripes->needed[stripe];
	if (cluster >= 0) {
		needed.gap += (size_t)cluster * (size_t)needed.size;
		needed.n_clusters = 1;
	}
	return pound_needed_count(&needed, gap);
}

static struct likelihood likelihood_of(const struct pound_stripes *stripes, int cluster, double gap,
                                       const struct line *line, double center)
{
	struct likelihood l = {0};
	for (int i = 0; i < stripes->n; i++) {
		const struct pound_needed_count count = count_of(stripes, i, cluster, gap);
		const double k = (double)count.pounding, rest = (double)count.runs - k;
		const double s = pound_elementary_log(stripes->intensity[i]) - center, z = line->a + line->b * s;
		const double up = density_over(z), down = density_over(-z);
		const double slope = k * up - rest * down, weight = (double)count.runs * up * down;
		if (k > 0)
			l.value += k * pound_elementary_log(fmax(gsl_cdf_ugaussian_P(z), 1e-300));
		if (rest > 0)
			l.value += rest * pound_elementary_log(fmax(gsl_cdf_ugaussian_Q(z), 1e-300));
		l.gradient[0] += slope;
		l.gradient[1] += slope * s;
		l.information[0] += weight;
		l.information[1] += weight * s;
		l.information[2] += weight * s * s;
	}
	return l;
}

/* Whether the likelihood has a maximum at finite a and b: a run without pounding is above the lowest intensity with pounding, and
 * a run with pounding is above the lowest intensity without. */
static bool overlap(const struct pound_stripes *stripes, double gap)
{
	int first_pounds = stripes->n, last_pounds = -1, first_survives = stripes->n, last_survives = -1;
	for (int i = 0; i < stripes->n; i++) {
		const struct pound_needed_count count = count_of(stripes, i, -1, gap);
		if (count.pounding > 0) {
			first_pounds = i < first_pounds ? i : first_pounds;
			last_pounds = i;
		}
		if (count.runs > count.pounding) {
			first_survives = i < first_survives ? i : first_survives;
			last_survives = i;
		}
	}
	return last_survives > first_pounds && last_pounds > first_survives;
}

/* x = information^-1 y; false: the information is singular */
static bool solve(const double information[3], const double y[2], double x[2])
{
	const double det = information[0] * information[2] - information[1] * information[1];
	x[0] = (information[2] * y[0] - information[1] * y[1]) / det;
	x[1] = (information[0] * y[1] - information[1] * y[0]) / det;
	return det > 0 && isfinite(x[0]) && isfinite(x[1]);
}

/* e^x; x is limited to [-700, 700], so that nothing overflows. */
static double exponential(double x)
{
	return pound_elementary_exp(fmin(fmax(x, -700), 700));
}

/* A value and its 95 % interval, from the logarithm of the value and the variance of the logarithm. */
static struct pound_estimate around(double logarithm, double variance)
{
	const double half = NORMAL_95 * sqrt(variance);
	return (struct pound_estimate){exponential(logarithm), exponential(logarithm - half),
	                               exponential(logarithm + half)};
}

/* Median and dispersion with their intervals, by the delta method from a, b and their covariance (aa, ab, bb). */
static struct pound_fragility described(const struct line *line, const double variance[3], double center)
{
	// ln median = center - a/b, ln dispersion = -ln b
	const double by_a = -1 / line->b, by_b = line->a / (line->b * line->b);
	const double of_median =
	    by_a * by_a * variance[0] + 2 * by_a * by_b * variance[1] + by_b * by_b * variance[2];
	const double of_dispersion = variance[2] / (line->b * line->b);
	return (struct pound_fragility){.median = around(center - line->a / line->b, of_median),
	                                .dispersion = around(-pound_elementary_log(line->b), of_dispersion)};
}

/* The lognormal fragility curve of a gap by maximum likelihood.
 *
 * Given    stripes          counts of needed gaps at each intensity; at least 2 clusters
 *          gap      m
 * Returns  value            NAN if there is no curve: no run pounds, all runs pound, or all pound from one intensity on
 *                           and none below
 *
 * Covariance of a and b, with the information I and the scores s_c of n clusters: I^-1 (n/(n - 1) sum s_c s_c') I^-1.  It is
 * valid if the same ground motions are scaled to all intensities, and if each intensity has its own ground motions.
 *
 * Source   Baker 2015, Earthquake Spectra 31, 579-599; Liang and Zeger 1986, Biometrika 73, 13-22
 * Test     unit_separation: a_fragility_curve_is_found_again_its_intervals_cover
 */
struct pound_fragility pound_fragility_fit(const struct pound_stripes *stripes, double gap)
{
	const struct pound_estimate none = {NAN, NAN, NAN};
	struct pound_fragility fit = {none, none, none};
	const int n_clusters = stripes->needed[0].n_clusters;
	double center = 0, step[2] = {1, 1}, meat[3] = {0}, variance[3];
	struct line line = {0, 0};
	if (!overlap(stripes, gap) || n_clusters < 2)
		return fit;
	for (int i = 0; i < stripes->n; i++)
		center += pound_elementary_log(stripes->intensity[i]) / stripes->n;
	struct likelihood l = likelihood_of(stripes, -1, gap, &line, center);
	for (int round = 0; round < ROUNDS && fabs(step[0]) + fabs(step[1]) > STEP_LEAST; round++) {
		if (!solve(l.information, l.gradient, step))
			return fit;
		struct line next;
		struct likelihood there;
		double share = 1;
		for (int k = 0; k < HALVINGS; k++, share *= 0.5) {
			next = (struct line){line.a + share * step[0], line.b + share * step[1]};
			there = likelihood_of(stripes, -1, gap, &next, center);
			if (there.value >= l.value)
				break;
		}
		if (!(there.value >= l.value))
			break; // no improvement above rounding errors
		line = next;
		l = there;
	}
	if (!(line.b > 0))
		return fit;
	for (int c = 0; c < n_clusters; c++) {
		const struct likelihood one = likelihood_of(stripes, c, gap, &line, center);
		meat[0] += one.gradient[0] * one.gradient[0];
		meat[1] += one.gradient[0] * one.gradient[1];
		meat[2] += one.gradient[1] * one.gradient[1];
	}
	double left[2][2];
	const double columns[2][2] = {{meat[0], meat[1]}, {meat[1], meat[2]}};
	for (int k = 0; k < 2; k++)
		if (!solve(l.information, columns[k], left[k]))
			return fit;
	// rows of I^-1 meat, times I^-1 again
	for (int k = 0; k < 2; k++) {
		double row[2];
		solve(l.information, (const double[2]){left[0][k], left[1][k]}, row);
		variance[k] = row[0], variance[k + 1] = row[1];
	}
	for (int k = 0; k < 3; k++)
		variance[k] *= n_clusters / (n_clusters - 1.0);
	return described(&line, variance, center);
}
