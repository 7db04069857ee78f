/* hazard.c - the mean annual rate of pounding, from the probability at each intensity and the hazard curve.
 *
 *   rate(gap) = integral of P(pounding | x, gap) |d lambda(x)|
 *
 *   x        intensity of the ground motion
 *   lambda   mean annual rate at which x is exceeded [1/a]: linear in logarithms between points of the hazard curve
 *   P        linear in ln x between the intensities; below the first one constant, above the last one 1, which overestimates
 *            the rate
 *
 * The rate is a weighted sum of the probabilities, plus the rate of exceeding the last intensity.  Its interval is from the
 * scatter of the weighted sums of the clusters. */
#include <math.h>
#include <string.h>

#include <gsl/gsl_sort_double.h>

#include "engine/numeric/elementary.h"
#include "engine/separation/separation.h"

static const double NORMAL_95 = 1.959963984540054; // quantile 0.975

/* The rate at which an intensity is exceeded; beyond the hazard curve the rate at its nearest point [1/a]. */
static double exceeded(const struct pound_hazard *hazard, double x)
{
	int k = 0;
	if (x <= hazard->intensity[0])
		return hazard->rate[0];
	while (k < hazard->n && hazard->intensity[k] < x)
		k++;
	if (k == hazard->n)
		return hazard->rate[hazard->n - 1];
	const double share = pound_elementary_log(x / hazard->intensity[k - 1]) /
	                     pound_elementary_log(hazard->intensity[k] / hazard->intensity[k - 1]);
	return hazard->rate[k - 1] *
	       pound_elementary_exp(share * pound_elementary_log(hazard->rate[k] / hazard->rate[k - 1]));
}

/* Adds the weights from an interval of intensities in which hazard curve and probability are each one straight line.
 *
 * Given    x        (2)   ends of the interval
 *          stripes  (2)   the two intensities of stripes around it
 *
 *   lambda = l0 e^(-k s), s = ln(x/x0) in [0, length]:   integral of |d lambda| = l0 - l1
 *   integral of s |d lambda| = (l0 - l1)/k - length l1 */
static void piece_add(const struct pound_hazard *hazard, const double x[2], const double stripes[2],
                      double weights[2])
{
	const double l0 = exceeded(hazard, x[0]), l1 = exceeded(hazard, x[1]);
	const double length = pound_elementary_log(x[1] / x[0]),
	             whole = pound_elementary_log(stripes[1] / stripes[0]);
	if (!(length > 0) || !(l0 > l1))
		return;
	const double moment = (l0 - l1) * length / pound_elementary_log(l0 / l1) - length * l1;
	const double up = (pound_elementary_log(x[0] / stripes[0]) * (l0 - l1) + moment) / whole;
	weights[0] += l0 - l1 - up;
	weights[1] += up;
}

/* The weights of the probabilities in the annual rate.
 *
 * Returns  weights  (stripes->n)  1/a
 *          value                  1/a   rate of exceeding the last intensity
 *
 * Test     unit_separation: the_rate_over_a_power_law_is_its_closed_form */
double pound_hazard_weights(const struct pound_hazard *hazard, const struct pound_stripes *stripes,
                            double *weights)
{
	const double *x = stripes->intensity, last = x[stripes->n - 1];
	memset(weights, 0, sizeof *weights * (size_t)stripes->n);
	weights[0] = hazard->rate[0] - exceeded(hazard, x[0]);
	for (int i = 0; i + 1 < stripes->n; i++) {
		double from = x[i];
		for (int k = 0; k <= hazard->n && from < x[i + 1]; k++) {
			const double to = k < hazard->n ? fmin(hazard->intensity[k], x[i + 1]) : x[i + 1];
			if (to <= from)
				continue;
			piece_add(hazard, (const double[2]){from, to}, &x[i], &weights[i]);
			from = to;
		}
	}
	return exceeded(hazard, last);
}

/* The mean annual rate of pounding with a gap [1/a], with its 95 % interval from the scatter of the clusters; NAN: an intensity
 * has no run with a result. */
struct pound_estimate pound_hazard_rate(const struct pound_stripes *stripes, const double *weights,
                                        double beyond, double gap)
{
	const int n = stripes->needed[0].n_clusters;
	double rate = beyond, squares = 0;
	struct pound_needed_count all[POUND_STRIPES_MAX];
	for (int i = 0; i < stripes->n; i++) {
		all[i] = pound_needed_count(&stripes->needed[i], gap);
		if (all[i].runs == 0)
			return (struct pound_estimate){NAN, NAN, NAN};
		rate += weights[i] * (double)all[i].pounding / (double)all[i].runs;
	}
	for (int c = 0; c < n; c++) {
		double off = 0;
		for (int i = 0; i < stripes->n; i++) {
			struct pound_needed one = stripes->needed[i];
			one.gap += (size_t)c * (size_t)one.size;
			one.n_clusters = 1;
			const struct pound_needed_count count = pound_needed_count(&one, gap);
			const double p = (double)all[i].pounding / (double)all[i].runs;
			off += weights[i] * ((double)count.pounding - p * (double)count.runs) / (double)all[i].runs;
		}
		squares += off * off;
	}
	const double half = n > 1 ? NORMAL_95 * sqrt(squares * n / (n - 1.0)) : NAN;
	return (struct pound_estimate){rate, fmax(rate - half, beyond), rate + half};
}

/* The first sorted gap at which the low end of the rate's interval (end -1), the rate (0) or the high end (1) is at most
 * `rate`; NAN: there is none. */
static double first_rare(const struct pound_stripes *stripes, const double *weights, double beyond,
                         double rate, const struct pound_needed *sorted, int end)
{
	int low = -1, high = sorted->size;
	while (high - low > 1) {
		const int middle = low + (high - low) / 2;
		const struct pound_estimate at = pound_hazard_rate(stripes, weights, beyond, sorted->gap[middle]);
		if ((end < 0 ? at.low : end > 0 ? at.high : at.value) <= rate)
			high = middle;
		else
			low = middle;
	}
	return high < sorted->size ? sorted->gap[high] : NAN;
}

/* The gap at which the mean annual rate of pounding falls to a rate, and its 95 % interval.
 *
 * Given    beyond            1/a   rate of exceeding the last intensity
 *          rate              1/a
 *          scratch           -     as many doubles as all stripes have runs
 * Returns  value             m     NAN: no needed gap has a rate that low, as if `beyond` exceeds it; low and high likewise
 * Test     unit_separation: the_rate_over_a_power_law_is_its_closed_form
 */
struct pound_estimate pound_hazard_gap(const struct pound_stripes *stripes, const double *weights,
                                       double beyond, double rate, double *scratch)
{
	int64_t n = 0;
	for (int i = 0; i < stripes->n; i++)
		n += pound_needed_sort(&stripes->needed[i], scratch + n);
	gsl_sort(scratch, 1, (size_t)n);
	const struct pound_needed sorted = {.n_clusters = 1, .size = (int)n, .gap = scratch};
	const double low = first_rare(stripes, weights, beyond, rate, &sorted, -1);
	// whether the interval reaches down to gap 0; all runs need more than -1 m
	const bool from_rest = pound_hazard_rate(stripes, weights, beyond, -1).low <= rate;
	return (struct pound_estimate){first_rare(stripes, weights, beyond, rate, &sorted, 0),
	                               from_rest ? 0 : low,
	                               first_rare(stripes, weights, beyond, rate, &sorted, 1)};
}
