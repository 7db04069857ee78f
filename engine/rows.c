/* rows.c - from the runs' values to the rows the statistics are about: one output for each sample, and how it would
 * scatter if other signals had been drawn. */
#include "engine/indices.h"

#include <float.h>
#include <math.h>

/* Ratio of means over the signals, and what each signal adds to its deviation.
 *
 * Given    numerator, denominator   (n_signals)
 * Returns  value       Y            mean numerator / mean denominator
 *          deviation   (n_signals)  z_r - Y of the pseudo-values z_r = Y + (U_r - Y u_r) / mean(u); their mean is 0
 *
 * Source   delta method; model.md 5: a ratio of means, with the same signals above and below
 * Test     unit_rows: the_variance_of_a_ratio_of_means_is_that_of_its_linearisation
 */
static double ratio_of_means(const double *numerator, const double *denominator, int n_signals,
                             double *deviation)
{
	double above = 0.0, below = 0.0;
	for (int r = 0; r < n_signals; r++) {
		above += numerator[r];
		below += denominator[r];
	}
	double y = above / below, scale = n_signals / below;
	for (int r = 0; r < n_signals; r++)
		deviation[r] = (numerator[r] - y * denominator[r]) * scale;
	return isfinite(below) ? y : NAN;
}

/* Covariance, over draws of the signals, of two outputs that are means over n_signals shared (or fresh) signals. */
static double covariance(const double *p, const double *q, int n_signals)
{
	double products = 0.0;
	for (int r = 0; r < n_signals; r++)
		products += p[r] * q[r];
	return products / (n_signals - 1.0) / n_signals;
}

int pound_rows_noises(int n_inputs)
{
	return POUND_NOISE_MIXED + POUND_NOISE_STEP * n_inputs;
}

/* Covariances of a row's outputs, for the pairs of samples that estimators multiply; NAN for one signal. */
static void noise_fill(const double *deviation, int n_inputs, int n_signals, double *noise)
{
	const double *a = deviation, *b = deviation + n_signals;
	if (n_signals < 2) {
		for (int k = 0; k < pound_rows_noises(n_inputs); k++)
			noise[k] = NAN;
		return;
	}
	noise[POUND_NOISE_AA] = covariance(a, a, n_signals);
	noise[POUND_NOISE_BB] = covariance(b, b, n_signals);
	noise[POUND_NOISE_AB] = covariance(a, b, n_signals);
	for (int j = 0; j < n_inputs; j++) {
		const double *c = deviation + (size_t)(2 + j) * n_signals;
		double *k = noise + POUND_NOISE_MIXED + POUND_NOISE_STEP * j;
		k[0] = covariance(c, c, n_signals);
		k[1] = covariance(a, c, n_signals);
		k[2] = covariance(b, c, n_signals);
	}
}

/* The same of outputs whose variances are known and that owe nothing to each other's noise. */
static void noise_known(const double *variance, int n_inputs, double *noise)
{
	for (int k = 0; k < pound_rows_noises(n_inputs); k++)
		noise[k] = isnan(variance[0]) ? NAN : 0.0;
	noise[POUND_NOISE_AA] = variance[0];
	noise[POUND_NOISE_BB] = variance[1];
	for (int j = 0; j < n_inputs; j++)
		noise[POUND_NOISE_MIXED + POUND_NOISE_STEP * j] = variance[2 + j];
}

/* Takes the mean of A and B off all outputs.  The first output goes first, so that equal ones become exact zeros. */
static void centre(struct pound_rows *rows)
{
	const int n_samples = rows->n_inputs + 2;
	const double start = rows->y[0];
	double sum = 0.0;
	for (int i = 0; i < rows->n_rows; i++) {
		const double *y = rows->y + (size_t)i * n_samples;
		sum += (y[0] - start) + (y[1] - start);
	}
	rows->mean = start + sum / (2.0 * rows->n_rows);
	for (size_t k = 0; k < (size_t)rows->n_rows * n_samples; k++)
		rows->y[k] -= rows->mean;
}

size_t pound_rows_scratch(int n_rows, int n_inputs, int n_signals)
{
	return (size_t)n_rows * (n_inputs + 2 + pound_rows_noises(n_inputs) + 1) +
	       (size_t)(n_inputs + 2) * n_signals;
}

/* The rows that have an output at every sample.
 *
 * Given    values      (n_rows x (n_inputs + 2) x n_signals)   numerators and denominators
 * Returns  rows        -                                       outputs, centred, and their noise
 * Memory   scratch     (pound_rows_scratch)                    held by rows
 *
 * A row with a failed run, or a denominator without a mean, is left out whole.
 *
 * Test     unit_rows
 */
void pound_rows_init(struct pound_rows *rows, const struct pound_sample_values *values, double *scratch)
{
	const int d = values->n_inputs, n_samples = d + 2, n_signals = values->n_signals;
	const int n_noises = pound_rows_noises(d);
	*rows = (struct pound_rows){.n_inputs = d, .n_signals = n_signals, .y = scratch};
	const struct pound_grouping *grouping = &values->grouping;
	const int groups = grouping->n ? (values->n_rows + grouping->run - 1) / grouping->run : 0;
	rows->scatter.grouping = *grouping;
	rows->scatter.grouping.n = groups < grouping->n ? groups : grouping->n;
	rows->noise = rows->y + (size_t)values->n_rows * n_samples;
	rows->row = (int64_t *)(rows->noise + (size_t)values->n_rows * n_noises);
	rows->scatter.row = rows->row;
	double *deviation = (double *)(rows->row + values->n_rows), largest = 0.0;
	for (int i = 0; i < values->n_rows; i++) {
		double *y = rows->y + (size_t)rows->n_rows * n_samples, row_largest = 0.0;
		for (int p = 0; p < n_samples; p++) {
			size_t at = ((size_t)i * n_samples + p) * n_signals;
			y[p] = values->variance ? values->numerator[at]
			                        : ratio_of_means(values->numerator + at, values->denominator + at,
			                                         n_signals, deviation + (size_t)p * n_signals);
			row_largest = isfinite(y[p]) ? fmax(row_largest, fabs(y[p])) : INFINITY;
		}
		if (!isfinite(row_largest))
			continue;
		double *noise = rows->noise + (size_t)rows->n_rows * n_noises;
		if (values->variance)
			noise_known(values->variance + (size_t)i * n_samples, d, noise);
		else
			noise_fill(deviation, d, n_signals, noise);
		largest = fmax(largest, row_largest);
		rows->row[rows->n_rows++] = i;
	}
	centre(rows);
	// a sum of n_signals numbers and a quotient round to no more than this
	double rounding = (n_signals + 2) * DBL_EPSILON * largest;
	rows->variance_floor = rounding * rounding;
}
