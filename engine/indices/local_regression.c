/* local_regression.c - first-order indices by local-linear regression, each row predicted from its neighbors.
 *
 * 1. In every sample block of the design the rows are sorted by the input's value, and each row is predicted from the K and
 *    from the 2 K nearest ranks on either side, without itself.
 * 2. The mean product of output and prediction estimates the variance of the conditional mean, with a bias because the
 *    conditional mean changes between a row and its neighbors.  At a jump the bias is proportional to the mean distance
 *    between them, so that the two reaches K and 2 K are extrapolated linearly to distance 0.
 * 3. The extrapolation step is added to the interval, because the bias may not be linear in the distance.
 *
 * Every sample block of a Latin hypercube or random design is used, so that all runs count for each input.
 * Invalid for quasi-random designs, where neighbors in one input are related in the others. */
#include "engine/indices/indices.h"

#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <string.h>

/* The least-squares line through all but one of the first `n` values against their ranks, at the excluded rank. */
static double line_without(const double *y, int n, int left_out)
{
	double x_mean = (0.5 * n * (n - 1) - left_out) / (n - 1), y_mean = 0.0, xx = 0.0, xy = 0.0;
	for (int k = 0; k < n; k++)
		if (k != left_out)
			y_mean += y[k] / (n - 1);
	for (int k = 0; k < n; k++)
		if (k != left_out) {
			xx += (k - x_mean) * (k - x_mean);
			xy += (k - x_mean) * (y[k] - y_mean);
		}
	return y_mean + xy / xx * (left_out - x_mean);
}

/* Leave-one-out predictions of values sorted by an input, from the neighbors.
 *
 * Given    y         (n)     outputs in ascending order of the input
 *          reach     K       ranks on either side  1 <= K, 2 K + 1 <= n
 * Returns  fit       (n)     least-squares line through the other 2 K of 2 K + 1 ranks, at the rank itself;
 *                            the window is centered (the line is then the mean) except at the ends
 *
 * Test     unit_local_regression: the_golden_predictions_are_met
 */
void pound_local_regression_fit(const double *y, int n, int reach, double *fit)
{
	const int width = 2 * reach + 1;
	for (int i = 0; i < n; i++) {
		int first = i < reach ? 0 : i >= n - reach ? n - width : i - reach;
		if (i - first != reach) {
			fit[i] = line_without(y + first, width, i - first);
			continue;
		}
		double sum = 0.0;
		for (int k = 1; k <= reach; k++)
			sum += y[i - k] + y[i + k];
		fit[i] = sum / (2 * reach);
	}
}

// ten ranks on either side if there are enough rows
static int reach_of(int n_rows)
{
	return n_rows >= 300 ? 10 : n_rows / 30;
}

/* Predictions by the means of the other rows with the same value; 0 for a row that is alone with its value.
 *
 * Given    y         (n)     outputs in ascending order of the input
 *          level     (n)     index of the input's value
 */
static void levels_fit(const double *y, const double *level, int n, double *fit)
{
	for (int first = 0, end; first < n; first = end) {
		double sum = 0.0;
		for (end = first; end < n && level[end] == level[first]; end++)
			sum += y[end];
		for (int i = first; i < end; i++)
			fit[i] = end - first > 1 ? (sum - y[i]) / (end - first - 1) : 0.0;
	}
}

/* One input's means over the sample blocks, for each row: output times prediction with reach K (near) and 2 K (wide), and
 * the wide prediction squared. */
struct window_sums {
	double *near, *wide, *square; /* (n_rows) each */
};

/* Layout of the scratch memory. */
struct space {
	double *variance, *y, *fit, *fit_wide, *level; /* (n_rows) each */
	struct window_sums sums;
	size_t *order;      /* (n_rows) */
	double *group_sums; /* (groups, at most n_rows) */
	double *influence;  /* of each row on each input's index  (n_inputs x n_rows) */
	double *step;       /* extrapolation step from reach K to distance 0, of each input's index  (n_inputs) */
	double *square;     /* of a discrete input: squared predictions over the variance, else INFINITY */
};

static struct space carve(double *scratch, int n_rows, int n_inputs)
{
	const size_t n = (size_t)n_rows;
	return (struct space){.variance = scratch,
	                      .y = scratch + n,
	                      .fit = scratch + 2 * n,
	                      .fit_wide = scratch + 3 * n,
	                      .level = scratch + 4 * n,
	                      .sums = {scratch + 5 * n, scratch + 6 * n, scratch + 7 * n},
	                      .order = (size_t *)(scratch + 8 * n),
	                      .group_sums = scratch + 9 * n,
	                      .influence = scratch + 10 * n,
	                      .step = scratch + (10 + (size_t)n_inputs) * n,
	                      .square = scratch + (10 + (size_t)n_inputs) * n + n_inputs};
}

size_t pound_local_regression_scratch(const struct pound_sample_values *shape)
{
	return (size_t)(10 + shape->n_inputs) * shape->n_rows + 2 * (size_t)shape->n_inputs;
}

/* Adds a sample block, with the rows in `order`; levels: values of a discrete input, 0: other inputs.
 *
 * Means at values are of outputs about the block's own mean.  Of n rows, with the variance W within the values and its part A that
 * is additive in the other inputs, their mean product lacks W / n:
 *
 *   random rows           the square of the block's mean has W / n
 *   a Latin hypercube     the square of the block's mean has (W - A) / n, and the product of two rows with one value -A / n
 *
 * The mean of y (y - fit) estimates W.
 */
static void block_add(const struct pound_rows *rows, int sample, double grand, int levels,
                      const struct space *at)
{
	const int n = rows->n_rows, n_samples = rows->n_samples, reach = reach_of(n);
	if (pound_stopped(rows->stop))
		return;
	double mean = grand;
	if (levels > 0) {
		mean = 0.0;
		for (int k = 0; k < n; k++)
			mean += rows->y[at->order[k] * n_samples + sample] / n;
	}
	for (int k = 0; k < n; k++)
		at->y[k] = rows->y[at->order[k] * n_samples + sample] - mean;
	if (levels > 0) {
		levels_fit(at->y, at->level, n, at->fit);
		memcpy(at->fit_wide, at->fit, sizeof *at->fit * (size_t)n);
	} else {
		pound_local_regression_fit(at->y, n, reach, at->fit);
		pound_local_regression_fit(at->y, n, 2 * reach, at->fit_wide);
	}
	for (int k = 0; k < n; k++) {
		const double within = levels > 0 ? at->y[k] * (at->y[k] - at->fit[k]) / n : 0.0;
		at->sums.near[at->order[k]] += (at->y[k] * at->fit[k] + within) / n_samples;
		at->sums.wide[at->order[k]] += (at->y[k] * at->fit_wide[k] + within) / n_samples;
		at->sums.square[at->order[k]] += at->fit_wide[k] * at->fit_wide[k] / n_samples;
	}
}

/* Distances of the ends of the interval from the estimate. */
struct sides {
	double below, above;
};

/* The interval of a line is symmetric.  The variance of the estimate from means at values, h^2 over z^2, is proportional to their mean
 * square Q.  An estimate that is too low by D comes from a mean square of Q + D: with the variance at that end, D is the root of
 *
 *   D^2 = h^2 (Q + D) / Q          D = sqrt(h^2 + r^2 / 4) +- r / 2,  r = h^2 / Q
 *
 * Source   Wilson 1927, J. Am. Stat. Assoc. 22, 209-212: for a proportion
 * Test     unit_local_regression: a_weak_discrete_input_has_no_bias_and_its_interval_holds
 */
static struct sides sides_of(const struct pound_rows *rows, int n, const struct space *at, int input,
                             double share)
{
	const double *influence = at->influence + (size_t)input * rows->n_rows;
	const double sampling = share * pound_jackknife_half_width(influence, n, &rows->scatter, at->group_sums);
	const double half = sqrt(sampling * sampling + at->step[input] * at->step[input]);
	const double square = share * at->square[input], lean = square > 0.0 ? 0.5 * half * half / square : 0.0;
	const double middle = lean > 0.0 ? sqrt(half * half + lean * lean) : half;
	return (struct sides){middle - lean, middle + lean};
}

/* Index and interval from the rows' mean products and the variance of their outputs about the grand mean.
 *
 * Returns  influence  (n_rows)  NAN if the index is undefined
 *
 *   S V = near + (1 + 1/K) (near - wide):  linear extrapolation to distance 0 from mean distances (K + 1) / 2, (2 K + 1) / 2
 *
 * The influence of a row on mean(y m), with the prediction m estimated from other rows, is 2 y m - m^2.  The difference of two
 * such means consists of products of the errors of two rows; its influence is sqrt(2) y (m - m'), as each pair counts twice.
 */
static struct pound_estimate influence_interval(const struct pound_rows *rows, int input, int levels,
                                                const struct space *at)
{
	const int n = rows->n_rows;
	const double further = 1.0 + 1.0 / reach_of(n);
	double *influence = at->influence + (size_t)input * n;
	double v = 0.0, near = 0.0, wide = 0.0, square = 0.0;
	for (int i = 0; i < n; i++) {
		v += at->variance[i] / n;
		near += at->sums.near[i] / n;
		wide += at->sums.wide[i] / n;
		square += at->sums.square[i] / n;
	}
	const bool varies = v > rows->variance_floor;
	const double s = varies ? (near + further * (near - wide)) / v : NAN;
	at->step[input] = further * (near - wide) / v;
	for (int i = 0; i < n; i++) {
		const double change = (1.0 + further) * (at->sums.near[i] - at->sums.wide[i]);
		influence[i] =
		    (2.0 * at->sums.wide[i] - at->sums.square[i] + M_SQRT2 * change - s * at->variance[i]) / v;
	}
	at->square[input] = levels > 0 ? square / v : INFINITY;
	const struct sides sides = sides_of(rows, n, at, input, 1.0);
	return (struct pound_estimate){s, s - sides.below, s + sides.above};
}

/* Mean over the samples of a row of the squared outputs about the grand mean, less their noise variance. */
static double variances_fill(const struct pound_rows *rows, bool corrected, double *variance)
{
	const int n_samples = rows->n_samples, n_noises = n_samples * rows->n_signals;
	const size_t n_all = (size_t)rows->n_rows * n_samples;
	double grand = 0.0;
	for (size_t k = 0; k < n_all; k++)
		grand += rows->y[k];
	grand /= n_all;
	for (int i = 0; i < rows->n_rows && !pound_stopped(rows->stop); i++) {
		const double *y = rows->y + (size_t)i * n_samples,
		             *deviation = rows->deviation + (size_t)i * n_noises;
		double squares = 0.0, noise = 0.0;
		for (int p = 0; p < n_samples; p++)
			squares += (y[p] - grand) * (y[p] - grand);
		for (int k = 0; k < n_noises; k++)
			noise += deviation[k] * deviation[k];
		variance[i] = (corrected ? squares - noise : squares) / n_samples;
	}
	return grand;
}

/* Sorts the rows by an input's column of A or B; for a discrete input also sets the value index of each. */
static void rows_sort(const struct pound_rows *rows, const double *x, int matrix, int input, int levels,
                      const struct space *at)
{
	const int n = rows->n_rows, d = rows->n_inputs;
	for (int i = 0; i < n; i++)
		at->y[i] = x[(rows->row[i] * 2 + matrix) * d + input];
	gsl_sort_index(at->order, at->y, 1, (size_t)n);
	for (int k = 0; k < n && levels > 0; k++)
		at->level[k] = pound_distribution_level(&rows->inputs[input].distribution, at->y[at->order[k]]);
}

/* First-order indices by leave-one-out local-linear regression in every sample block.
 *
 * Given    rows       -                            outputs and their noise
 *          x          (n x 2 x n_inputs)           the design, rows of A and B, or its probabilities; only the
 *                                                  order within a column counts, except for discrete inputs
 *          noise      -                            in the variance: kept or removed (NAN for one signal)
 * Returns  first      (n_inputs)                   with 95 % intervals from the influence of the rows; NAN for
 *                                                  fewer than POUND_ROWS_MIN rows
 * Memory   scratch    (pound_local_regression_scratch)
 *
 * The numerator needs no noise correction: a row and its neighbors have different signals.  For a discrete input
 * (pound_rows_levels) the means at its values replace the lines: without bias, without extrapolation.
 *
 * Valid    Latin hypercube and random designs of 30 rows or more; the bias of a jump is removed, the bias of a wave as long as
 *          some 8 reaches is 0.04 of the variance, and inside the interval
 * Source   lag averaging attains the efficiency bound: Klein, Rochet 2023, arXiv 2306.05842; extrapolation: Richardson
 * Test     unit_local_regression
 */
void pound_local_regression_first(const struct pound_rows *rows, const double *x, enum pound_noise noise,
                                  double *scratch, struct pound_estimate *first)
{
	const int n = rows->n_rows, d = rows->n_inputs;
	const struct space at = carve(scratch, n, d);
	bool enough = n >= POUND_ROWS_MIN;
	const double grand = enough ? variances_fill(rows, noise == POUND_NOISE_REMOVED, at.variance) : NAN;
	for (int j = 0; j < d; j++) {
		const int levels = pound_rows_levels(rows, j);
		memset(at.sums.near, 0, 3 * sizeof *at.sums.near * (size_t)n);
		for (int matrix = 0; matrix < 2 && enough && !pound_stopped(rows->stop); matrix++) {
			rows_sort(rows, x, matrix, j, levels, &at);
			for (int p = 0; p < rows->n_samples; p++)
				if ((pound_rows_mask(rows, p) >> j & 1) == (unsigned)matrix)
					block_add(rows, p, grand, levels, &at);
		}
		enough &= !pound_stopped(rows->stop);
		first[j] = enough ? influence_interval(rows, j, levels, &at) : (struct pound_estimate){NAN, NAN, NAN};
	}
}

void pound_local_regression_behind(const struct pound_rows *rows, double *scratch, double *behind)
{
	const struct space at = carve(scratch, rows->n_rows, rows->n_inputs);
	for (int j = 0; j < rows->n_inputs && !pound_stopped(rows->stop); j++)
		behind[j] = pound_jackknife_rows(at.influence + (size_t)j * rows->n_rows, rows->n_rows);
}

/* Half widths of the intervals from the influences of the first n rows.
 *
 * Given    n          at most rows->n_rows
 *          scratch    as pound_local_regression_first left it
 * Returns  half       (n_inputs)
 *
 * Test     unit_error_budget: half_widths_of_all_rows_are_those_of_the_indices
 */
void pound_local_regression_first_rows(const struct pound_rows *rows, int n, double *scratch, double *half)
{
	const struct space at = carve(scratch, rows->n_rows, rows->n_inputs);
	double of_all = 0.0, of_first = 0.0; // variances; influences are relative to the variance of all rows
	for (int i = 0; i < rows->n_rows; i++) {
		of_all += at.variance[i] / rows->n_rows;
		of_first += i < n ? at.variance[i] / n : 0.0;
	}
	for (int j = 0; j < rows->n_inputs && !pound_stopped(rows->stop); j++) {
		const struct sides sides = sides_of(rows, n, &at, j, of_all / of_first);
		half[j] = 0.5 * (sides.below + sides.above);
	}
}
