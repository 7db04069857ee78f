/* error_budget.c - errors of S1 and ST of an output caused by integration, number of rows, number of signals and failed
 * rows.
 *
 * 1. Integration: some runs are repeated on half the sample step, with the same signal.  The difference is treated as an
 *    independent error of every run.
 * 2. Rows: intervals of the first n/8, n/4, n/2 and of all n rows of the design (index_columns.c).
 * 3. Signals: part of the intervals, between bounds: noise_part.c from four signals on, else below a bound for pick-freeze.
 * 4. The effect of each source on the worst index, and the source whose effect exceeds the sum of the others within all bounds. */
#include "engine/indices/error_budget.h"
#include "engine/numeric/elementary.h"

#include <gsl/gsl_statistics_double.h>
#include <math.h>

const char *pound_error_name(int row)
{
	static const char *const names[] = {
#define X(member, name) name,
	    POUND_ERRORS(X)
#undef X
	};
	return row >= 0 && row < POUND_ERROR_NONE ? names[row] : NULL;
}

/* ---- integration ---- */

/* Mean numerator and denominator of a row's sample over its signals. */
static void means(const struct pound_sample_values *values, const struct pound_check *check, double *above,
                  double *below)
{
	const int n_signals = values->n_signals;
	size_t at = ((size_t)check->row * pound_values_samples(values) + check->sample) * n_signals;
	*above = *below = 0;
	for (int r = 0; r < n_signals; r++) {
		*above += values->numerator[at + r] / n_signals;
		*below += values->denominator[at + r] / n_signals;
	}
}

/* Relative difference of two numbers; 0 for equal numbers, even zeros. */
static double apart(double p, double q)
{
	return p == q ? 0 : fabs(p - q) / fmax(fabs(p), fabs(q));
}

/* Differences between runs and their checks.
 *
 * Given    values, checks
 * Returns  accuracy   runs_checked, runs_unchecked, difference_median, difference_largest
 *          value      variance that the differences add to an output (a mean over R signals); NAN: none checked
 * Memory   relative   (checks.n)
 *
 *   e = ((U' - U) - Y (u' - u)) / mean(u)          value = mean(e^2) / R
 *
 * Source   delta method for a ratio of means, as in valid_rows.c; errors of different signals taken as independent
 * Test     unit_error_budget: differences_of_runs_come_out_relative_and_as_a_variance
 */
static double differences(const struct pound_sample_values *values, struct pound_checks checks,
                          double *relative, struct pound_accuracy *accuracy)
{
	double squares = 0;
	int n = 0;
	for (int k = 0; k < checks.n; k++) {
		const struct pound_check *c = &checks.check[k];
		double above, below;
		means(values, c, &above, &below);
		double once = c->numerator[0] / c->denominator[0], again = c->numerator[1] / c->denominator[1];
		double e =
		    (c->numerator[1] - c->numerator[0] - above / below * (c->denominator[1] - c->denominator[0])) /
		    below;
		if (!isfinite(once) || !isfinite(again) || !isfinite(e))
			continue;
		relative[n++] = apart(once, again);
		squares += e * e;
	}
	accuracy->runs_checked = n;
	accuracy->runs_unchecked = checks.n - n;
	accuracy->difference_median = n ? gsl_stats_median(relative, 1, n) : NAN;
	accuracy->difference_largest = n ? gsl_stats_max(relative, 1, n) : NAN;
	return n ? squares / n / values->n_signals : NAN;
}

/* Change of the indices when an independent error with the fraction q of the variance is removed from all outputs.
 *
 *   S: q S / (1 - q)          T: q |1 - T| / (1 - q)
 *
 * Source   the error adds q to the variance, nothing to the covariance of B and C, and itself to half of (A - C)^2
 * Test     unit_error_budget: indices_move_no_more_than_stated_when_noise_is_added
 */
static double first_shift(double q, double first)
{
	return q < 1 ? fmin(1, q * fabs(first) / (1 - q)) : 1;
}

static double total_shift(double q, double total)
{
	return q < 1 ? fmin(1, q * fabs(1 - total) / (1 - q)) : 1;
}

/* Twice the standard deviation of an index caused by independent errors with the fraction q of the variance in n rows.
 *
 *   S: 2 sqrt(2 q / n) (sqrt(1 + T) + |S|)          T: 4 sqrt(q / n) (sqrt T + T / sqrt(d + 2))
 *
 * T is taken at the upper end of its interval: the polynomial behind ST changes with the errors even if T is 0.
 *
 * Source   to first order in the errors: b (c - a) changes by e_b (c - a) + b (e_c - e_a), the variance by 2 mean(a e_a),
 *          half of (c - a)^2 by (c - a) (e_c - e_a); variances of sums of independent terms, deviations of quotients added
 * Valid    Pick-freeze estimates; the columns S1 and ST change less.
 * Test     unit_error_budget: indices_move_no_more_than_stated_when_noise_is_added
 */
static double first_spread(double q, double n, double first, double total_high)
{
	return 2 * sqrt(2 * q / n) * (sqrt(1 + fmax(total_high, 0)) + fabs(first));
}

static double total_spread(double q, double n, int d, double total_high)
{
	return 4 * sqrt(q / n) * (sqrt(fmax(total_high, 0)) + fmax(total_high, 0) / sqrt(d + 2.0));
}

/* Whether ST cannot be estimated because the samples of a row share noise of unknown covariance. */
static bool noise_shared(const struct pound_indices *indices)
{
	return indices->notes & (1u << POUND_NOTE_SHARED_SIGNAL | 1u << POUND_NOTE_SHARED_NOISE);
}

/* Upper end of the total index for the formulas above; without ST, of the raw total index, from the same differences. */
static double total_high(const struct pound_indices *indices, int input)
{
	return indices->index[noise_shared(indices) ? POUND_ST_RAW : POUND_ST][input].high;
}

/* Possible changes of S1 and ST by integration errors: shift plus spread. */
static void changes(struct pound_indices *indices, const struct pound_sample_values *values)
{
	struct pound_accuracy *accuracy = &indices->accuracy;
	const double q = accuracy->variance_share, n = values->n_rows;
	for (int j = 0; j < values->n_inputs; j++) {
		double first = indices->index[POUND_S1][j].value, total = indices->index[POUND_ST][j].value;
		double high = total_high(indices, j);
		double first_change = first_shift(q, first) + first_spread(q, n, first, high);
		double total_change = total_shift(q, total) + total_spread(q, n, values->n_inputs, high);
		bool known = isfinite(q) && isfinite(first) && isfinite(high);
		accuracy->inputs[j].first_change = known ? fmin(1, first_change) : NAN;
		accuracy->inputs[j].total_change = known && isfinite(total) ? fmin(1, total_change) : NAN;
	}
}

/* ---- rows ---- */

static double half(struct pound_estimate estimate)
{
	return 0.5 * (estimate.high - estimate.low);
}

/* Sets the half widths of all rows, from the indices, and the number of rows of each level that has half widths. */
static void half_widths(const struct pound_indices *indices, int n_rows, int n_inputs,
                        struct pound_accuracy *accuracy)
{
	const int last = POUND_LEVELS - 1;
	for (int j = 0; j < n_inputs; j++) {
		accuracy->inputs[j].first_half[last] = half(indices->index[POUND_S1][j]);
		accuracy->inputs[j].total_half[last] = half(indices->index[POUND_ST][j]);
	}
	for (int k = 0; k < POUND_LEVELS; k++) {
		bool some = k == last;
		for (int j = 0; j < n_inputs; j++)
			some |=
			    isfinite(accuracy->inputs[j].first_half[k]) || isfinite(accuracy->inputs[j].total_half[k]);
		accuracy->rows[k] = some ? n_rows >> (last - k) : 0;
	}
}

/* Root mean square of all half widths of a level, with or without ST. */
static double typical(const struct pound_accuracy *accuracy, int n_inputs, int level, bool totals)
{
	double squares = 0;
	for (int j = 0; j < n_inputs; j++)
		squares += pow(accuracy->inputs[j].first_half[level], 2) +
		           (totals ? pow(accuracy->inputs[j].total_half[level], 2) : 0);
	return sqrt(squares / ((totals ? 2 : 1) * n_inputs));
}

/* 2^x for x in [0, 64], exact to rounding, by bisection of the logarithm, which is the same on every machine. */
static double two_to(double x)
{
	double low = 1, high = 0x1p64, wanted = x * pound_elementary_log(2);
	for (double middle = 0x1p32; low < middle && middle < high; middle = low + 0.5 * (high - low))
		*(pound_elementary_log(middle) < wanted ? &low : &high) = middle;
	return high;
}

/* Half of the 95 % interval of the slope of a line through n points.
 *
 * Given    residual   -       sum of squared residuals;  n > 2
 *          xx         -       sum of squares of the abscissas about their mean
 *
 *   Student's quantile times (residual / (n - 2) / xx)^1/2; widths from M groups have a standard error of 1 / (2 (M - 1))^1/2 of
 *   their own, which residuals of so few points may not show
 */
static double slope_half(double residual, double xx, int n, int groups)
{
	const double by_points = pound_jackknife_student(n - 2) * sqrt(fmax(0, residual) / (n - 2) / xx);
	const double by_groups = groups > 1 ? POUND_NORMAL_95 / sqrt(2 * (groups - 1) * xx) : 0;
	return fmax(by_points, by_groups);
}

/* Decrease of the half widths with the rows: slope of the log-log regression line with its 95 % interval, and the rows that surely
 * halve them.
 *
 *   rows_to_halve = n 2^(-1/a),  a the upper end of the slope's interval for Sobol' points if it is below -1/2, else -1/2
 *
 * Widths of random rows and Latin hypercubes fall with the root of the rows, whatever the slope of a few widths is; widths of
 * Sobol' points as fast or faster.
 *
 * Test     unit_error_budget: half_widths_fall_with_the_root_of_the_rows, sobol_points_need_fewer_rows_if_it_shows
 */
static void slope(struct pound_indices *indices, const struct pound_sample_values *values, bool quasi_random,
                  bool totals)
{
	struct pound_accuracy *accuracy = &indices->accuracy;
	const double root = -0.5, steepest = -2; // scrambled points of smooth outputs: -3/2
	double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
	for (int k = 0; k < POUND_LEVELS; k++) {
		double half = typical(accuracy, values->n_inputs, k, totals);
		if (!(half > 0 && isfinite(half)))
			continue;
		double p = pound_elementary_log(accuracy->rows[k]), q = pound_elementary_log(half);
		n++, x += p, y += q, xx += p * p, xy += p * q, yy += q * q;
	}
	xx -= x * x / n, xy -= x * y / n, yy -= y * y / n;
	const double value = n > 1 ? xy / xx : NAN;
	const double error = n > 2 ? slope_half(yy - xy * xy / xx, xx, (int)n, values->grouping.n) : NAN;
	accuracy->slope = (struct pound_estimate){value, value - error, value + error};
	const double sure = quasi_random && value + error < root ? fmax(steepest, value + error) : root;
	// with fewer rows other estimators are used; where few rows hold the variance, widths do not yet follow a law
	const bool known = values->n_rows >= POUND_ROWS_MIN && isnan(indices->rows_needed);
	const bool any = known && typical(accuracy, values->n_inputs, POUND_LEVELS - 1, totals) > 0;
	accuracy->rows_to_halve = any ? accuracy->rows[POUND_LEVELS - 1] * two_to(-1 / sure) : NAN;
}

/* ---- all together ---- */

/* The errors of the widest interval by its two sources, which add up as squares. */
struct split {
	double others;                /* integration and failed rows */
	double noise_low, noise_high; /* by few signals */
	double rows_low, rows_high;   /* by few rows */
};

static double known(double error)
{
	return isnan(error) ? 0 : error;
}

static struct split split_of(const double errors[POUND_ERROR_NONE], double excitation_low)
{
	const double half = known(errors[POUND_ERROR_SAMPLING]);
	const double high = fmin(known(errors[POUND_ERROR_EXCITATION]), half),
	             low = fmin(known(excitation_low), high);
	return (struct split){.others =
	                          known(errors[POUND_ERROR_INTEGRATION]) + known(errors[POUND_ERROR_FAILED_ROWS]),
	                      .noise_low = low,
	                      .noise_high = high,
	                      .rows_low = sqrt((half - high) * (half + high)),
	                      .rows_high = sqrt((half - low) * (half + low))};
}

/* The error that is larger than the sum of all others wherever the two sources of the widest interval are within their bounds.
 *
 * Test     unit_error_budget: the_dominant_error_is_larger_than_the_others_together
 */
enum pound_error pound_accuracy_dominant(const double errors[POUND_ERROR_NONE], double excitation_low)
{
	const struct split s = split_of(errors, excitation_low);
	const double half = known(errors[POUND_ERROR_SAMPLING]);
	if (s.rows_low > s.noise_high + s.others)
		return POUND_ERROR_SAMPLING;
	if (s.noise_low > s.rows_high + s.others)
		return POUND_ERROR_EXCITATION;
	for (int k = POUND_ERROR_INTEGRATION; k <= POUND_ERROR_FAILED_ROWS; k++)
		if (known(errors[k]) > half + s.others - known(errors[k]))
			return (enum pound_error)k;
	return POUND_ERROR_NONE;
}

bool pound_accuracy_undecided(const double errors[POUND_ERROR_NONE], double excitation_low)
{
	const struct split s = split_of(errors, excitation_low);
	return pound_accuracy_dominant(errors, excitation_low) == POUND_ERROR_NONE &&
	       known(errors[POUND_ERROR_SAMPLING]) > s.others && s.noise_high > s.rows_low &&
	       s.rows_high > s.noise_low;
}

/* Largest contribution of the noise of few signals to an interval, which includes it: the smaller of an upper estimate for
 * pick-freeze indices and of the upper bound from the signals themselves, if it is known.
 *
 * Test     unit_error_budget: noise_adds_no_more_to_an_interval_than_there_is
 */
static double noise_most(double spread, struct pound_range noise, double half)
{
	return fmin(1, fmin(fmin(spread, noise.high), half));
}

/* Contribution of the noise of few signals to the intervals: the largest of all, and the least of the widest interval; the values
 * are corrected for the noise.  NAN: not known. */
static void excitation(const struct pound_indices *indices, int n_rows, int n_inputs,
                       struct pound_accuracy *accuracy)
{
	const double w = indices->noise_share, q = w < 1 ? w / (1 - w) : INFINITY;
	double worst = indices->notes >> POUND_NOTE_NOT_RANDOM & 1 ? 0 : NAN, widest = -1;
	accuracy->excitation_low = worst;
	for (int j = 0; j < n_inputs && isfinite(w); j++) {
		const struct pound_estimate first = indices->index[POUND_S1][j], total = indices->index[POUND_ST][j];
		const struct pound_range of_first = accuracy->inputs[j].first_noise,
		                         of_total = accuracy->inputs[j].total_noise;
		const double high = total_high(indices, j);
		worst = fmax(worst, noise_most(first_spread(q, n_rows, first.value, high), of_first, half(first)));
		if (half(first) > widest) {
			widest = half(first);
			accuracy->excitation_low = isnan(of_first.low) ? NAN : fmin(of_first.low, widest);
		}
		if (noise_shared(indices))
			continue;
		worst = fmax(worst, noise_most(total_spread(q, n_rows, n_inputs, high), of_total, half(total)));
		if (half(total) > widest) {
			widest = half(total);
			accuracy->excitation_low = isnan(of_total.low) ? NAN : fmin(of_total.low, widest);
		}
	}
	accuracy->errors[POUND_ERROR_EXCITATION] = worst;
}

/* Effect of each error on the worst index; NAN if unknown for all indices. */
static void errors_fill(const struct pound_indices *indices, const struct pound_sample_values *values,
                        double errors[POUND_ERROR_NONE])
{
	const struct pound_accuracy *accuracy = &indices->accuracy;
	const int last = POUND_LEVELS - 1;
	double sampling = NAN, integration = NAN, dropped = NAN;
	for (int j = 0; j < values->n_inputs; j++) {
		sampling =
		    fmax(sampling, fmax(accuracy->inputs[j].first_half[last], accuracy->inputs[j].total_half[last]));
		integration =
		    fmax(integration, fmax(accuracy->inputs[j].first_change, accuracy->inputs[j].total_change));
		dropped = fmax(dropped, fmax(accuracy->inputs[j].first_dropped, accuracy->inputs[j].total_dropped));
	}
	errors[POUND_ERROR_SAMPLING] = sampling;
	errors[POUND_ERROR_INTEGRATION] = integration;
	errors[POUND_ERROR_FAILED_ROWS] = dropped;
}

/* Error of the indices of an output, by source.
 *
 * Given    values        the output's runs
 *          checks        the repeated runs
 *          quasi_random  the design is of Sobol' points
 *          indices       of values, by pound_index_columns_indices
 * Returns  indices       accuracy
 * Memory   scratch       (checks.n)
 *
 * Valid    Pounding is chaotic: after many contacts rounding alone separates two runs of one scene, and neither is more
 *          accurate.  Large differences of single runs then mean that the scene does not determine the run; their effect
 *          on the indices stays small as long as such runs are few or agree on average.
 * Test     unit_error_budget
 */
void pound_accuracy_estimate(const struct pound_sample_values *values, struct pound_checks checks,
                             bool quasi_random, double *scratch, struct pound_indices *indices)
{
	struct pound_accuracy *accuracy = &indices->accuracy;
	double variance = differences(values, checks, scratch, accuracy);
	// a constant output has no indices
	accuracy->variance_share = indices->variance > 0 ? variance / indices->variance : NAN;
	changes(indices, values);
	half_widths(indices, values->n_rows, values->n_inputs, accuracy);
	slope(indices, values, quasi_random, !noise_shared(indices));
	errors_fill(indices, values, accuracy->errors);
	excitation(indices, values->n_rows, values->n_inputs, accuracy);
}
