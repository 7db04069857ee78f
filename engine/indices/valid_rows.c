/* valid_rows.c - from the runs' values to the valid rows: one output per sample, and its noise, the scatter over other draws
 * of the signals. */
#include "engine/indices/indices.h"

#include <float.h>
#include <math.h>

/* Ratio of means over the signals, its bias, and the contribution of each signal to its deviation.
 *
 * Given    numerator, denominator   (n_signals)
 * Returns  value       Y            mean numerator / mean denominator
 *          bias        -            of Y, by the jackknife: (R - 1) (mean of leave-one-out ratios - Y); NAN: one signal
 *          deviation   (n_signals)  residuals U_r - Y u_r over the mean of u, each over (1 - h_r)^1/2, h_r = u_r / sum of u, and
 *                                   times (1 - 1/R)^1/2
 *
 * Y is close to signals with much weight (leverage h): their residuals are too small by (1 - h)^1/2.  Without this factor
 * the noise of responses with pounding would be underestimated; jackknife pseudo-values, over 1 - h, overestimate it: with two
 * signals so much that total indices are off by a third.  With equal denominators all these agree, and nothing is biased.
 *
 * Source   model.md 5: a ratio of means, same signals in numerator and denominator; Quenouille 1956, Biometrika 43, 353-360, for
 *          the jackknife; MacKinnon and White 1985, J. Econometrics 29, 305-325 (HC2): Y is a regression through 0
 * Test     unit_valid_rows: the_variance_of_a_ratio_of_means_is_that_of_its_residuals
 */
static double ratio_of_means(const double *numerator, const double *denominator, int n_signals,
                             double *deviation, double *bias)
{
	double above = 0.0, below = 0.0, sum = 0.0;
	bool even = true;
	for (int r = 0; r < n_signals; r++) {
		above += numerator[r];
		below += denominator[r];
		even &= denominator[r] == denominator[0];
	}
	const double y = above / below, others = n_signals - 1.0;
	for (int r = 0; r < n_signals; r++) {
		const double residual = numerator[r] - y * denominator[r], rest = below - denominator[r];
		sum += residual / rest;
		// exactly 1 for equal denominators; the order of operations avoids overflow
		deviation[r] =
		    residual * n_signals / below * (even ? 1.0 : sqrt(others / n_signals * (below / rest)));
	}
	*bias = n_signals == 1 ? NAN : even ? 0.0 : -others / n_signals * sum;
	return isfinite(below) ? y : NAN;
}

/* Scales deviations so that their products add up to covariances of means over n_signals. */
static void deviations_scale(double *deviation, int n_signals)
{
	const double scale = sqrt(1.0 / ((n_signals - 1.0) * n_signals));
	for (int r = 0; r < n_signals; r++)
		deviation[r] = n_signals > 1 ? deviation[r] * scale : NAN;
}

/* Covariances of a row's outputs over draws of their noise; all NAN if unknown.
 *
 * Returns  noise    (n_samples x n_samples)
 *
 * Test     unit_valid_rows: the_variance_of_a_ratio_of_means_is_that_of_its_residuals
 */
void pound_rows_noise(const struct pound_rows *rows, int row, double *noise)
{
	const int n_samples = rows->n_samples, n_signals = rows->n_signals;
	const double *deviation = rows->deviation + (size_t)row * n_samples * n_signals;
	for (int p = 0; p < n_samples; p++)
		for (int q = p; q < n_samples; q++) {
			double products = 0.0;
			for (int r = 0; r < n_signals; r++)
				products += deviation[p * n_signals + r] * deviation[q * n_signals + r];
			noise[p * n_samples + q] = noise[q * n_samples + p] =
			    rows->independent && p != q ? 0.0 : products;
		}
}

/* Variance of the outputs over all samples of the plain protocol.
 *
 * Given    y         (n_rows x n_samples)     rows->y, bias-corrected, or rows->plain
 *
 * Test     unit_plain_indices: the_noise_share_is_that_of_the_signals_mean
 */
double pound_rows_variance(const struct pound_rows *rows, const double *y)
{
	const int used = rows->n_inputs + 2;
	const double all = (double)rows->n_rows * used;
	double sum = 0.0, squares = 0.0;
	for (int i = 0; i < rows->n_rows; i++, y += rows->n_samples)
		for (int p = 0; p < used; p++) {
			sum += y[p];
			squares += y[p] * y[p];
		}
	return squares / all - sum / all * (sum / all);
}

/* Given    input     -       of the rows
 * Returns  value     -       the number of values of a discrete input, up to POUND_CURVE; 0: any other
 *
 * Test     unit_valid_rows: an_input_of_few_values_has_as_many_levels
 */
int pound_rows_levels(const struct pound_rows *rows, int input)
{
	return rows->inputs ? pound_conditional_levels(&rows->inputs[input].distribution) : 0;
}

/* Subtracts the mean over A and B from all outputs.  The first output is the origin of the sums, so that equal outputs become 0.
 *
 * Returns  value  the mean
 */
static double centre(const struct pound_rows *rows, double *y)
{
	const int n_samples = rows->n_samples;
	const double start = y[0];
	double sum = 0.0;
	for (int i = 0; i < rows->n_rows; i++)
		sum += (y[i * n_samples] - start) + (y[i * n_samples + 1] - start);
	const double mean = start + sum / (2.0 * rows->n_rows);
	for (size_t k = 0; k < (size_t)rows->n_rows * n_samples; k++)
		y[k] -= mean;
	return mean;
}

int pound_values_samples(const struct pound_sample_values *shape)
{
	return pound_order_samples(shape->order, shape->n_inputs) + shape->n_groups;
}

struct pound_sample_values pound_rows_shape(const struct pound_rows *rows)
{
	return (struct pound_sample_values){.n_rows = rows->n_rows,
	                                    .n_inputs = rows->n_inputs,
	                                    .n_signals = rows->n_signals,
	                                    .order = rows->order,
	                                    .n_groups = rows->n_groups,
	                                    .groups = rows->groups};
}

unsigned pound_rows_mask(const struct pound_rows *rows, int sample)
{
	const int ungrouped = rows->n_samples - rows->n_groups;
	return sample < ungrouped ? pound_order_mask(rows->n_inputs, sample)
	                          : rows->groups[sample - ungrouped].inputs;
}

size_t pound_rows_scratch(const struct pound_sample_values *shape)
{
	const size_t samples = (size_t)shape->n_rows * pound_values_samples(shape);
	return samples * (2 + shape->n_signals) + shape->n_rows;
}

/* Writes one row's outputs and deviations behind the last valid row; returns whether all are finite. */
static bool row_fill(struct pound_rows *rows, const struct pound_sample_values *values, int row,
                     double *largest, double *bias)
{
	const int n_samples = rows->n_samples, n_signals = rows->n_signals;
	double *y = rows->y + (size_t)rows->n_rows * n_samples, row_largest = 0.0;
	double *plain = rows->plain + (size_t)rows->n_rows * n_samples;
	double *deviation = rows->deviation + (size_t)rows->n_rows * n_samples * n_signals, biases = 0.0;
	for (int p = 0; p < n_samples; p++, deviation += n_signals) {
		size_t sample = (size_t)row * n_samples + p;
		double one = NAN;
		if (values->variance) {
			plain[p] = values->numerator[sample];
			*deviation = sqrt(values->variance[sample]);
		} else {
			plain[p] = ratio_of_means(values->numerator + sample * n_signals,
			                          values->denominator + sample * n_signals, n_signals, deviation, &one);
			deviations_scale(deviation, n_signals);
			// given records: the mean over them is the output itself, without bias or noise
			for (int r = 0; r < n_signals && values->same_signals; r++)
				deviation[r] = one = NAN;
		}
		y[p] = values->variance || values->same_signals || n_signals == 1 ? plain[p] : plain[p] - one;
		row_largest = isfinite(y[p]) ? fmax(row_largest, fmax(fabs(y[p]), fabs(plain[p]))) : INFINITY;
		biases += one;
	}
	if (!isfinite(row_largest))
		return false;
	*largest = fmax(*largest, row_largest);
	*bias += biases / n_samples;
	return true;
}

/* The groups of the rows, at most as many as the rows fill.
 *
 * Given    row       (valid rows)    number in the design; the returned struct points to it
 */
struct pound_scatter pound_rows_scatter(const struct pound_sample_values *values, const int64_t *row)
{
	struct pound_scatter scatter = {values->grouping, row};
	const int groups = scatter.grouping.n ? (values->n_rows - 1) / scatter.grouping.run + 1 : 0;
	scatter.grouping.n = groups < scatter.grouping.n ? groups : scatter.grouping.n;
	return scatter;
}

/* The valid rows: all samples have an output.
 *
 * Given    values      (n_rows x n_samples x n_signals)   numerators and denominators; a known variance: one signal
 * Returns  rows        -                                  outputs, centered, and their noise
 * Memory   scratch     (pound_rows_scratch)               held by rows
 *
 * A row with a failed run is left out as a whole, as is a row with an undefined ratio of means or an undefined
 * leave-one-out ratio.
 *
 * Test     unit_valid_rows
 */
void pound_rows_init(struct pound_rows *rows, const struct pound_sample_values *values, double *scratch)
{
	const int n_samples = pound_values_samples(values);
	*rows = (struct pound_rows){.n_inputs = values->n_inputs,
	                            .n_samples = n_samples,
	                            .n_signals = values->n_signals,
	                            .order = values->order,
	                            .n_groups = values->n_groups,
	                            .groups = values->groups,
	                            .independent = values->variance,
	                            .inputs = values->inputs,
	                            .stop = values->stop,
	                            .y = scratch};
	rows->plain = rows->y + (size_t)values->n_rows * n_samples;
	rows->deviation = rows->plain + (size_t)values->n_rows * n_samples;
	rows->row = (int64_t *)(rows->deviation + (size_t)values->n_rows * n_samples * values->n_signals);
	rows->scatter = pound_rows_scatter(values, rows->row);
	double largest = 0.0, bias = 0.0;
	for (int i = 0; i < values->n_rows && !pound_stopped(values->stop); i++)
		if (row_fill(rows, values, i, &largest, &bias))
			rows->row[rows->n_rows++] = i;
	rows->mean = centre(rows, rows->y);
	rows->plain_mean = centre(rows, rows->plain);
	rows->ratio_bias = bias / rows->n_rows;
	// bound on the rounding error of a sum of n_signals numbers and a quotient
	double rounding = (values->n_signals + 2) * DBL_EPSILON * largest;
	rows->variance_floor = rounding * rounding;
}

/* Effective number of rows in the variance: (sum v)^2 / sum v^2, v the sum of squares of a row. */
double pound_rows_behind(const struct pound_rows *rows)
{
	double sum = 0.0, squares = 0.0;
	for (int i = 0; i < rows->n_rows; i++) {
		const double *y = rows->y + (size_t)i * rows->n_samples;
		double v = 0.0;
		for (int p = 0; p < rows->n_samples; p++)
			v += y[p] * y[p];
		sum += v;
		squares += v * v;
	}
	return sum * sum / squares;
}
