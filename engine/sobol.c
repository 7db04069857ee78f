/* sobol.c - variance-based sensitivity indexes of one output of one cell.
 *
 * 1. A sample's output is the ratio of means over its signals; rows with a failed run are left out, whole.
 * 2. The outputs are centred and made into moments of the rows.
 * 3. Indexes from the means of the moments, intervals by resampling rows. */
#include "engine/indices.h"

#include <float.h>
#include <math.h>

/* Ratio of means over signals, with the variance of that ratio.
 *
 * Given    numerator, denominator   (n_signals)
 * Returns  value     Y              mean numerator / mean denominator
 *          variance                 of Y over draws of its n_signals signals; NAN for one signal
 *
 *   z_r = Y + (U_r - Y u_r) / mean(u)          variance = mean square deviation of z over (n_signals - 1)
 *
 * The mean of the z_r is Y itself: its linearisation at the means, signal by signal.
 *
 * Source   delta method; model.md 5, the ratio of means uses the same signals above and below
 * Test     unit_sobol: the_variance_of_a_ratio_of_means_is_that_of_its_linearisation
 */
double pound_sobol_ratio(const double *numerator, const double *denominator, int n_signals, double *variance)
{
	double above = 0.0, below = 0.0, squares = 0.0;
	for (int r = 0; r < n_signals; r++) {
		above += numerator[r];
		below += denominator[r];
	}
	double y = above / below, scale = n_signals / below;
	for (int r = 0; r < n_signals; r++) {
		double deviation = (numerator[r] - y * denominator[r]) * scale;
		squares += deviation * deviation;
	}
	*variance = n_signals > 1 ? squares / (n_signals - 1) / n_signals : NAN;
	return y;
}

/* The rows that have an output at every sample. */
struct outputs {
	int n_rows, n_samples;
	double *y;       /* centred by `centre`  (n_rows x n_samples) */
	double centre;   /* mean over A and B */
	double largest;  /* largest |output| */
	double variance; /* over all samples of all rows */
	double noise;    /* mean over all samples of the variance of their output over signals */
};

static struct outputs outputs_of(const struct pound_sample_values *values, double *y)
{
	struct outputs o = {.n_samples = values->n_inputs + 2, .y = y};
	const int n_signals = values->n_signals;
	for (int i = 0; i < values->n_rows; i++) {
		double *row = y + (size_t)o.n_rows * o.n_samples, noise = 0.0, largest = 0.0;
		for (int p = 0; p < o.n_samples; p++) {
			size_t first = ((size_t)i * o.n_samples + p) * n_signals;
			double variance;
			row[p] = pound_sobol_ratio(values->numerator + first, values->denominator + first, n_signals,
			                           &variance);
			noise += variance;
			largest = isfinite(row[p]) ? fmax(largest, fabs(row[p])) : INFINITY;
		}
		if (!isfinite(largest))
			continue;
		o.noise += noise;
		o.largest = fmax(o.largest, largest);
		o.n_rows++;
	}
	o.noise /= (double)o.n_rows * o.n_samples;
	return o;
}

/* Takes the mean of A and B off all outputs.  The first output goes first, so that equal ones become exact zeros. */
static void outputs_centre(struct outputs *o)
{
	const size_t n = (size_t)o->n_rows * o->n_samples;
	const double start = o->y[0];
	double pair = 0.0, sum = 0.0, squares = 0.0;
	for (int i = 0; i < o->n_rows; i++) {
		const double *row = o->y + (size_t)i * o->n_samples;
		pair += (row[0] - start) + (row[1] - start);
	}
	o->centre = start + pair / (2.0 * o->n_rows);
	for (size_t k = 0; k < n; k++) {
		o->y[k] -= o->centre;
		sum += o->y[k];
		squares += o->y[k] * o->y[k];
	}
	o->variance = squares / n - sum / n * (sum / n);
}

/* An estimator as a statistic of the means of its moments. */
struct subject {
	const struct pound_estimator *estimator;
	int n_inputs;
	double variance_floor;
};

static void subject_values(const void *given, const double *mean, double *value)
{
	const struct subject *s = given;
	s->estimator->indices(mean, s->n_inputs, s->variance_floor, value);
}

static void moments_fill(const struct outputs *o, const struct subject *s, struct pound_moments *moments)
{
	const int tiles = pound_interval_tiles(moments->n_moments);
	for (int i = 0; i < o->n_rows; i++) {
		double m[POUND_MOMENTS_MAX] = {0};
		s->estimator->moments(o->y + (size_t)i * o->n_samples, s->n_inputs, m);
		for (int t = 0; t < tiles; t++) {
			double *tile = pound_interval_moment(moments, i, t);
			for (int k = 0; k < POUND_TILE; k++)
				tile[k] = m[t * POUND_TILE + k];
		}
	}
}

/* Mean, variance and noise share of the outputs; says whether there are indexes to estimate. */
static bool outputs_summary(const struct outputs *o, int n_signals, double variance_floor,
                            struct pound_indices *indices)
{
	double mean = 0.0, square = 0.0;
	for (int i = 0; i < o->n_rows; i++) {
		const double *row = o->y + (size_t)i * o->n_samples;
		mean += 0.5 * (row[0] + row[1]);
		square += 0.5 * (row[0] * row[0] + row[1] * row[1]);
	}
	mean /= o->n_rows, square /= o->n_rows;
	indices->mean = o->centre + mean;
	indices->variance = square - mean * mean;
	bool varies = o->n_rows > 1 && o->variance > variance_floor;
	indices->noise_share = varies && n_signals > 1 ? o->noise / o->variance : NAN;
	return varies;
}

/* The doubles up to the next cache line. */
static double *aligned(double *scratch)
{
	return (double *)(((uintptr_t)scratch + 63) / 64 * 64);
}

size_t pound_sobol_scratch(int n_rows, int n_inputs, int n_signals)
{
	(void)n_signals;
	int tiles = pound_interval_tiles(pound_estimator_row(0)->n_moments(n_inputs));
	return (size_t)n_rows * (n_inputs + 2) + (size_t)tiles * n_rows * POUND_TILE +
	       (size_t)2 * n_inputs * POUND_RESAMPLES + POUND_TILE;
}

/* First-order and total sensitivity indexes of one output, with 95 % intervals.
 *
 * Given    values    (n_rows x (n_inputs + 2) x n_signals)   of each run; n_rows <= 2^20
 *          seed      -                                       of the resamples
 * Returns  value     rows dropped: one of their runs has no output
 *          indices   mean, variance (of A and B, divided by their number), noise share, first, total (n_inputs)
 * Memory   scratch   (pound_sobol_scratch)
 *
 * A constant output (its deviation within the rounding of the ratio of means) has undefined indexes: NAN.
 *
 * Source   estimator.c, interval.c
 * Test     unit_sobol
 */
int pound_sobol_indices(const struct pound_sample_values *values, uint64_t seed, double *scratch,
                        struct pound_indices *indices)
{
	const int d = values->n_inputs;
	struct outputs outputs = outputs_of(values, scratch);
	outputs_centre(&outputs);
	double rounding = (values->n_signals + 2) * DBL_EPSILON * outputs.largest;
	struct subject subject = {pound_estimator_row(0), d, rounding * rounding};
	struct pound_estimate estimates[2 * POUND_INPUTS_MAX];
	for (int k = 0; k < 2 * d; k++)
		estimates[k] = (struct pound_estimate){NAN, NAN, NAN};
	if (outputs_summary(&outputs, values->n_signals, subject.variance_floor, indices)) {
		struct pound_moments moments = {outputs.n_rows, subject.estimator->n_moments(d),
		                                aligned(scratch + (size_t)values->n_rows * (d + 2))};
		struct pound_statistic statistic = {2 * d, subject_values, &subject};
		double mean[POUND_MOMENTS_MAX], value[2 * POUND_INPUTS_MAX];
		int tiles = pound_interval_tiles(moments.n_moments);
		moments_fill(&outputs, &subject, &moments);
		pound_interval_means(&moments, mean);
		subject_values(&subject, mean, value);
		pound_interval_bootstrap(&moments, &statistic, seed,
		                         moments.tiles + (size_t)tiles * moments.n_rows * POUND_TILE, estimates);
		for (int k = 0; k < 2 * d; k++)
			estimates[k].value = value[k];
	}
	for (int j = 0; j < d; j++) {
		indices->first[j] = estimates[j];
		indices->total[j] = estimates[d + j];
	}
	return values->n_rows - outputs.n_rows;
}
