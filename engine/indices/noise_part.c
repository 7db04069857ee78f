/* noise_part.c - what the noise of few signals adds to the intervals of the indices, from runs whose signals are known.
 *
 * 1. The R signals of a row are divided into four sets of m = R/4 (what remains is not used).  The influence h of a row on an index
 *    is a quadratic form of its outputs, corrected for noise, so that it can be estimated from any two sets alone: h_12, h_34, ...
 * 2. Two pairs without a common set have independent noise.  With the means P_k and half differences D_k of the three such
 *    couples of pairs, the variance of h by noise, given the row, is
 *
 *      N = mean of D_k^2 - variance of P_k        unbiased for any distribution of the noise: h^2 - mean of h_12 h_34
 *
 * 3. The mean of N over the rows has an error from its scatter.  From four sets to R signals the variance, A / R + B / (R (R - 1))
 *    by signal_split.c, changes by a factor between the factor of A and the factor of B.
 *
 * Weights, fits and the variance in the denominator are taken as given.  Signals of different rows are independent. */
#include "engine/indices/indices.h"

#include <math.h>

enum { SETS = 4, PAIRS = 6, COUPLES = 3 };

// pairs 2 k and 2 k + 1 have no set in common
static const int pairs[PAIRS][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {0, 3}, {1, 2}};

struct pound_noise_part pound_noise_part_init(const struct pound_rows *rows,
                                              const struct pound_closed *closed, enum pound_noise noise,
                                              const struct pound_closed_results *results)
{
	return (struct pound_noise_part){.rows = rows,
	                                 .closed = closed,
	                                 .results = results,
	                                 .known = noise == POUND_NOISE_REMOVED && rows->n_signals >= SETS &&
	                                          !rows->independent};
}

/* Deviations of the means of the sets from the output, in each sample.
 *
 * Returns  of        (n_samples x SETS)
 */
static void sets_fill(const struct pound_rows *rows, int row, double *of)
{
	const int n_signals = rows->n_signals, m = n_signals / SETS;
	// deviations are scaled for sums of products: valid_rows.c
	const double scale = sqrt(n_signals * (n_signals - 1.0)) / m;
	const double *deviation = rows->deviation + (size_t)row * rows->n_samples * n_signals;
	for (int p = 0; p < rows->n_samples; p++, deviation += n_signals)
		for (int s = 0; s < SETS; s++) {
			of[p * SETS + s] = 0.0;
			for (int r = s * m; r < (s + 1) * m; r++)
				of[p * SETS + s] += scale * deviation[r];
		}
}

static double influence(const struct pound_influence *of, const double *estimate)
{
	double sum = 0.0;
	for (int k = 0; k < of->n; k++)
		sum += of->weight[k] * estimate[of->column[k]];
	return sum;
}

/* Influence of a row on the total index T of an input without a control variate, over the variance V of the closed indices:
 *
 *   (C - C_(all but j) - T C) / V
 */
static double influence_plain(const struct pound_noise_part *part, int input, const double *estimate)
{
	const struct pound_closed *closed = part->closed;
	const double total = part->results->total[input].value, *all = estimate + closed->n_columns - 1;
	for (int k = 0; k < closed->n_columns; k++)
		if (closed->set[k] == (pound_inputs_all(closed->n_inputs) ^ 1u << input))
			return (*all - estimate[k] - total * *all) / part->results->variance;
	return NAN;
}

/* The influences of a row on all indices, from one pair of sets.
 *
 * Given    of        (n_samples x SETS)      deviations of the sets
 * Returns  value     (3 x n_inputs)
 */
static void pair_fill(const struct pound_noise_part *part, int row, const double *of, const int pair[2],
                      const struct pound_control_variate *control, double *value)
{
	const struct pound_rows *rows = part->rows;
	const int n = rows->n_samples, d = rows->n_inputs;
	double y[POUND_SAMPLES_MAX], difference[POUND_SAMPLES_MAX], noise[POUND_SAMPLES_MAX * POUND_SAMPLES_MAX];
	double estimate[2 * POUND_CLOSED_COLUMNS_MAX];
	static const double zeros[POUND_CLOSED_COLUMNS_MAX];
	for (int p = 0; p < n; p++) {
		const double first = of[p * SETS + pair[0]], second = of[p * SETS + pair[1]];
		y[p] = rows->y[(size_t)row * n + p] + 0.5 * (first + second);
		difference[p] = 0.5 * (first - second);
	}
	for (int p = 0; p < n; p++)
		for (int q = 0; q < n; q++)
			noise[p * n + q] = difference[p] * difference[q];
	pound_closed_row(part->closed, y, control, noise, estimate);
	for (int j = 0; j < d; j++) {
		value[j] = influence(&part->results->first_influence[j], estimate);
		value[d + j] = influence(&part->results->total_influence[j], estimate);
	}
	pound_closed_row(part->closed, y, &(struct pound_control_variate){.part = zeros}, noise, estimate);
	for (int j = 0; j < d; j++)
		value[2 * d + j] = influence_plain(part, j, estimate);
}

/* Adds a row to the sums over the rows of N and N^2.
 *
 * Given    control   -       of the row
 */
void pound_noise_part_add(struct pound_noise_part *part, int row, const struct pound_control_variate *control)
{
	const int n_indices = 3 * part->rows->n_inputs;
	double of[POUND_SAMPLES_MAX * SETS], value[PAIRS][POUND_NOISE_INDICES];
	sets_fill(part->rows, row, of);
	for (int k = 0; k < PAIRS; k++)
		pair_fill(part, row, of, pairs[k], control, value[k]);
	for (int i = 0; i < n_indices; i++) {
		double mean = 0.0, differences = 0.0, variance = 0.0, middle[COUPLES];
		for (int k = 0; k < COUPLES; k++) {
			const double difference = 0.5 * (value[2 * k][i] - value[2 * k + 1][i]);
			middle[k] = 0.5 * (value[2 * k][i] + value[2 * k + 1][i]);
			mean += middle[k] / COUPLES;
			differences += difference * difference / COUPLES;
		}
		for (int k = 0; k < COUPLES; k++)
			variance += (middle[k] - mean) * (middle[k] - mean) / COUPLES;
		part->sum[i] += differences - variance;
		part->squares[i] += (differences - variance) * (differences - variance);
	}
}

/* The share of a half width that has the mean N over n rows, between the ends of the 95 % interval of N. */
static struct pound_range range_of(const struct pound_rows *rows, double sum, double squares)
{
	const int n = rows->n_rows, n_signals = rows->n_signals, m = n_signals / SETS;
	const double by_signals = (double)SETS * m / n_signals;
	const double by_pairs = SETS * (SETS - 1.0) * m * m / ((double)n_signals * (n_signals - 1));
	const double mean = sum / n,
	             half = POUND_NORMAL_95 * sqrt(fmax(0.0, squares / n - mean * mean) / (n - 1));
	const double quantile =
	    rows->scatter.grouping.n ? pound_jackknife_student(rows->scatter.grouping.n - 1) : POUND_NORMAL_95;
	return (struct pound_range){quantile * sqrt(fmax(0.0, mean - half) / n * fmin(by_signals, by_pairs)),
	                            quantile * sqrt(fmax(0.0, mean + half) / n * fmax(by_signals, by_pairs))};
}

/* What noise adds to the half widths.
 *
 * Given    part      -                all rows added
 * Returns  ranges    (n_inputs) each  NAN: fewer than four signals
 *
 * Test     unit_noise_part
 */
void pound_noise_part_ranges(const struct pound_noise_part *part, struct pound_noise_ranges *ranges)
{
	const int d = part->rows->n_inputs;
	struct pound_range *const into[] = {ranges->first, ranges->total, ranges->plain};
	for (int k = 0; k < 3; k++)
		for (int j = 0; j < d; j++)
			into[k][j] = part->known && !isnan(part->results->total[j].value)
			                 ? range_of(part->rows, part->sum[k * d + j], part->squares[k * d + j])
			                 : (struct pound_range){NAN, NAN};
}
