/* local.c - first-order indexes by local-linear regression, each row predicted from its neighbours.
 *
 * 1. In every sample of the design the rows are sorted by the input's value.
 * 2. Each row is predicted from the K nearest ranks on either side, itself left out.
 * 3. The mean product of output and prediction estimates the variance of the conditional mean.
 *
 * Every sample block of a Latin hypercube or random design serves, so that all runs count for each input.
 * Wrong for quasi-random designs, where neighbours in one input are related in the others. */
#include "engine/indices.h"

#include <gsl/gsl_sort_double.h>
#include <math.h>

/* The least-squares line through all but one of the first `n` values against their ranks, at the rank left out. */
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

/* Predictions of values in the order of an input, each from its neighbours alone.
 *
 * Given    y         (n)     outputs in ascending order of the input
 *          reach     K       ranks on either side  1 <= K, 2 K + 1 <= n
 * Returns  fit       (n)     least-squares line through the 2 K other ones of 2 K + 1 ranks, at the rank itself;
 *                            the window is centred (the line is then the mean) but at the ends
 *
 * Test     unit_local: the_golden_predictions_are_met
 */
void pound_local_fit(const double *y, int n, int reach, double *fit)
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

// ten ranks a side once there are rows enough: the bias stays below 0.003 at n = 1000
static int reach_of(int n_rows)
{
	return n_rows >= 300 ? 10 : n_rows / 30;
}

/* One input's sums over the sample blocks: of each row, output times prediction and prediction squared. */
struct sums {
	double *product, *square; /* (n_rows) each */
};

static void block_add(const struct pound_rows *rows, int sample, double grand, const size_t *order, double *y,
                      double *fit, struct sums sums)
{
	const int n = rows->n_rows, n_samples = rows->n_samples;
	for (int k = 0; k < n; k++)
		y[k] = rows->y[order[k] * n_samples + sample] - grand;
	pound_local_fit(y, n, reach_of(n), fit);
	for (int k = 0; k < n; k++) {
		sums.product[order[k]] += y[k] * fit[k];
		sums.square[order[k]] += fit[k] * fit[k];
	}
}

/* Index and interval from a row's mean products, with the variance of its outputs about the grand mean.
 *
 * Returns  influence  (n_rows)  NAN where the index is undefined
 *
 * The influence of a row on S = mean(y m) / V, the prediction m estimated from the others, is
 * (2 y m - m^2 - S y^2) / V.
 */
static struct pound_estimate influence_interval(const struct pound_rows *rows, struct sums sums,
                                                const double *variance, double *group_sums, double *influence)
{
	const int n = rows->n_rows, n_samples = rows->n_samples;
	double v = 0.0, product = 0.0;
	for (int i = 0; i < n; i++) {
		v += variance[i] / n;
		product += sums.product[i] / n_samples / n;
	}
	const double s = v > rows->variance_floor ? product / v : NAN;
	for (int i = 0; i < n; i++)
		influence[i] = ((2.0 * sums.product[i] - sums.square[i]) / n_samples - s * variance[i]) / v;
	double half_width = pound_jackknife_half_width(influence, n, &rows->scatter, group_sums);
	return (struct pound_estimate){s, s - half_width, s + half_width};
}

/* Where everything lies in the scratch. */
struct space {
	double *variance, *y, *fit; /* (n_rows) each */
	struct sums sums;
	size_t *order;      /* (n_rows) */
	double *group_sums; /* (groups, at most n_rows) */
	double *influence;  /* of each row on each input's index  (n_inputs x n_rows) */
};

static struct space carve(double *scratch, int n_rows)
{
	const size_t n = (size_t)n_rows;
	return (struct space){.variance = scratch,
	                      .y = scratch + n,
	                      .fit = scratch + 2 * n,
	                      .sums = {scratch + 3 * n, scratch + 4 * n},
	                      .order = (size_t *)(scratch + 5 * n),
	                      .group_sums = scratch + 6 * n,
	                      .influence = scratch + 7 * n};
}

size_t pound_local_scratch(const struct pound_sample_values *shape)
{
	return (size_t)(7 + shape->n_inputs) * shape->n_rows;
}

/* Mean over the samples of a row of their squared outputs about the grand mean, less their noise. */
static double variances_fill(const struct pound_rows *rows, bool corrected, double *variance)
{
	const int n_samples = rows->n_samples, n_noises = n_samples * rows->n_signals;
	const size_t n_all = (size_t)rows->n_rows * n_samples;
	double grand = 0.0;
	for (size_t k = 0; k < n_all; k++)
		grand += rows->y[k];
	grand /= n_all;
	for (int i = 0; i < rows->n_rows; i++) {
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

/* First-order indexes by leave-one-out local-linear regression in every sample block.
 *
 * Given    rows       -                            outputs and their noise
 *          x          (n x 2 x n_inputs)           the design, rows of A and B, or its probabilities; only the
 *                                                  order within a column counts
 *          corrected  -                            the variance without the noise of few signals (NAN for one signal)
 * Returns  first      (n_inputs)                   with 95 % intervals from the influence of the rows; NAN for
 *                                                  fewer than POUND_ROWS_MIN
 * Memory   scratch    (pound_local_scratch)
 *
 * Noise needs no correction above: a row and its neighbours have different signals.
 *
 * Valid    Latin hypercube and random designs of 30 rows or more; bias below 0.003 at n = 1000, to 0.015 at n = 300
 * Source   lag averaging attains the efficiency bound: Klein, Rochet 2023, arXiv 2306.05842
 * Test     unit_local
 */
void pound_local_first(const struct pound_rows *rows, const double *x, bool corrected, double *scratch,
                       struct pound_estimate *first)
{
	const int n = rows->n_rows, d = rows->n_inputs;
	const struct space at = carve(scratch, n);
	const bool enough = n >= POUND_ROWS_MIN;
	const double grand = enough ? variances_fill(rows, corrected, at.variance) : NAN;
	for (int j = 0; j < d; j++) {
		for (int i = 0; i < n; i++)
			at.sums.product[i] = at.sums.square[i] = 0.0;
		for (int matrix = 0; matrix < 2 && enough; matrix++) {
			for (int i = 0; i < n; i++)
				at.y[i] = x[(rows->row[i] * 2 + matrix) * d + j];
			gsl_sort_index(at.order, at.y, 1, n);
			for (int p = 0; p < rows->n_samples; p++)
				if ((pound_order_mask(d, p) >> j & 1) == (unsigned)matrix)
					block_add(rows, p, grand, at.order, at.y, at.fit, at.sums);
		}
		first[j] = enough ? influence_interval(rows, at.sums, at.variance, at.group_sums,
		                                       at.influence + (size_t)j * n)
		                  : (struct pound_estimate){NAN, NAN, NAN};
	}
}

/* Half widths of the intervals that the first rows' influences give.
 *
 * Given    n          at most those of rows
 *          scratch    as pound_local_first left it
 * Returns  half       (n_inputs)
 *
 * Test     unit_accuracy: half_widths_of_all_rows_are_those_of_the_indexes
 */
void pound_local_first_rows(const struct pound_rows *rows, int n, double *scratch, double *half)
{
	const struct space at = carve(scratch, rows->n_rows);
	double of_all = 0.0, of_first = 0.0; // variances; an influence is a share of that of all rows
	for (int i = 0; i < rows->n_rows; i++) {
		of_all += at.variance[i] / rows->n_rows;
		of_first += i < n ? at.variance[i] / n : 0.0;
	}
	for (int j = 0; j < rows->n_inputs; j++)
		half[j] = of_all / of_first *
		          pound_jackknife_half_width(at.influence + (size_t)j * rows->n_rows, n, &rows->scatter,
		                                     at.group_sums);
}
