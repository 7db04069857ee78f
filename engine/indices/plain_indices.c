/* plain_indices.c - the variance-based sensitivity indices of one output of one cell, by the plain protocol: pick-freeze
 * estimators, intervals by resampling rows. */
#include "engine/indices/indices.h"

#include <math.h>

/* An estimator as a statistic of the rows. */
struct subject {
	const struct pound_estimator *estimator;
	const struct pound_rows *rows;
	bool corrected;
};

static void subject_moments(const void *given, int row, double *m)
{
	const struct subject *s = given;
	const int n_samples = s->rows->n_samples;
	double noise[POUND_SAMPLES_MAX * POUND_SAMPLES_MAX];
	if (s->corrected)
		pound_rows_noise(s->rows, row, noise);
	const struct pound_outputs outputs = {.n_inputs = s->rows->n_inputs,
	                                      .n_samples = n_samples,
	                                      .y = (s->corrected ? s->rows->y : s->rows->plain) +
	                                           (size_t)row * n_samples,
	                                      .noise = s->corrected ? noise : NULL};
	s->estimator->moments(&outputs, m);
}

static void subject_values(const void *given, const double *mean, double *value)
{
	const struct subject *s = given;
	s->estimator->indices(mean, s->rows->n_inputs, s->rows->variance_floor, value);
}

/* Mean, variance and noise share of the outputs; returns whether there are indices to estimate.
 *
 * Given    rows      -      outputs and their noise
 * Returns  indices   -      mean, variance, noise share
 *          value     -      the outputs vary by more than rounding
 *
 * The variance is taken over A and B; the noise share, for less scatter, over all samples: mean variance of an output
 * over draws of its signals, divided by the variance of the outputs.
 *
 * Test     unit_plain_indices: the_noise_share_is_that_of_the_signals_mean
 */
bool pound_plain_summary(const struct pound_rows *rows, struct pound_indices *indices)
{
	const int d = rows->n_inputs, n_signals = rows->n_signals;
	double mean = 0.0, square = 0.0, noise = 0.0;
	for (int i = 0; i < rows->n_rows && !pound_stopped(rows->stop); i++) {
		const double *y = rows->plain + (size_t)i * rows->n_samples;
		const double *deviation = rows->deviation + (size_t)i * rows->n_samples * n_signals;
		mean += 0.5 * (y[0] + y[1]);
		square += 0.5 * (y[0] * y[0] + y[1] * y[1]);
		for (int k = 0; k < (d + 2) * n_signals; k++)
			noise += deviation[k] * deviation[k];
	}
	const double n = rows->n_rows, all = n * (d + 2);
	const double variance = pound_rows_variance(rows, rows->plain);
	indices->mean = rows->plain_mean + mean / n;
	indices->variance = square / n - mean / n * (mean / n);
	indices->ratio_bias = isfinite(rows->ratio_bias) ? rows->ratio_bias : NAN;
	bool varies = rows->n_rows > 1 && variance > rows->variance_floor;
	indices->noise_share = varies ? noise / all / variance : NAN;
	return varies;
}

size_t pound_plain_estimates_scratch(const struct pound_sample_values *shape,
                                     const struct pound_estimator *estimator)
{
	return pound_bootstrap_scratch(shape->n_rows, estimator->n_moments(shape->n_inputs), 2 * shape->n_inputs);
}

/* First-order and total indices by an estimator, with 95 % intervals.
 *
 * Given    rows       -      outputs and their noise; a design of the estimator's order at least
 *          noise      -      kept or removed
 *          resampling -      of the rows
 * Returns  estimates  (2 x n_inputs)                   first, then total
 * Memory   scratch    (pound_plain_estimates_scratch)
 *
 * Test     unit_plain_indices: golden_values_come_out_of_sample_values
 */
void pound_plain_estimates(const struct pound_rows *rows, const struct pound_estimator *estimator,
                           enum pound_noise noise, struct pound_resampling resampling, double *scratch,
                           struct pound_estimate *estimates)
{
	const struct subject subject = {estimator, rows, noise == POUND_NOISE_REMOVED};
	const struct pound_statistic statistic = {estimator->n_moments(rows->n_inputs),
	                                          2 * rows->n_inputs,
	                                          subject_moments,
	                                          subject_values,
	                                          &subject,
	                                          rows->stop};
	pound_bootstrap_estimates(&statistic, &rows->scatter, rows->n_rows, resampling, scratch, estimates);
}

size_t pound_plain_scratch(const struct pound_sample_values *shape)
{
	return pound_rows_scratch(shape) + pound_plain_estimates_scratch(shape, pound_estimator_row(0));
}

/* First-order and total sensitivity indices of one output, with 95 % intervals.
 *
 * Given    values    (n_rows x n_samples x n_signals)         of each run; n_rows <= 2^20
 *          resampling -                                      of the rows
 * Returns  value     number of failed rows: a run has no output
 *          indices   mean, variance (of A and B, divided by their number), noise share, raw indices (n_inputs)
 * Memory   scratch   (pound_plain_scratch)
 *
 * A constant output (its deviation is within rounding of the ratio of means) has undefined indices: NAN.
 *
 * Source   pick_freeze.c, bootstrap.c
 * Test     unit_plain_indices
 */
int pound_plain_indices(const struct pound_sample_values *values, struct pound_resampling resampling,
                        double *scratch, struct pound_indices *indices)
{
	const int d = values->n_inputs;
	struct pound_rows rows;
	struct pound_estimate estimates[2 * POUND_INPUTS_MAX];
	pound_rows_init(&rows, values, scratch);
	for (int k = 0; k < 2 * d; k++)
		estimates[k] = (struct pound_estimate){NAN, NAN, NAN};
	if (pound_plain_summary(&rows, indices))
		pound_plain_estimates(&rows, pound_estimator_row(0), POUND_NOISE_KEPT, resampling,
		                      scratch + pound_rows_scratch(values), estimates);
	for (int j = 0; j < d; j++) {
		indices->index[POUND_S1_RAW][j] = estimates[j];
		indices->index[POUND_ST_RAW][j] = estimates[d + j];
	}
	return values->n_rows - rows.n_rows;
}
