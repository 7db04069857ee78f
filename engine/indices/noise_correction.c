/* noise_correction.c - indices of a model with random signals: raw, corrected to infinitely many signals, and the variance
 * fraction due to the signals.
 *
 * An output is a mean over R signals.  The expected product of two outputs p, q of a row is the product of their means
 * over all signals plus the covariance caused by the R signals; noise_pq, an unbiased estimate of this covariance,
 * follows from the row alone.  Every product p q is therefore replaced by p q - noise_pq, whether the samples of a
 * row share their signals or not (the mean of noise_pq is then 0).  If an output is a ratio of two such means, its bias
 * is removed from p and q (valid_rows.c); raw indices use the uncorrected outputs. */
#include "engine/indices/indices.h"

#include <math.h>

// means of A and B; (a^2 + b^2) / 2, and the mean square of all samples
enum { A, B, PAIR, ALL, OF_SAMPLES };
// raw moments, then corrected ones; noise covariance of A and B, mean noise variance of all samples
enum { CORRECTED = OF_SAMPLES, NOISE_AB = 2 * OF_SAMPLES, NOISE_ALL, FIRST_INPUT };
// for every input: c - a, b (c - a), (c - a)^2 / 2
enum { CHANGE, PRODUCT, SQUARE, OF_INPUT };
// raw moments, then corrected ones; noise covariance of B and c - a
enum { INPUT_CORRECTED = OF_INPUT, NOISE_PRODUCT = 2 * OF_INPUT, PER_INPUT };
// values of the inputs, n_inputs each, then the values of the signals
enum { FIRST_RAW, TOTAL_RAW, FIRST, TOTAL, WITH_SIGNAL, BLOCKS };
enum { SIGNAL_TOTAL_ONE, SIGNAL_TOTAL, SIGNAL_FIRST, SINGLES };

/* Given    y      outputs of one row
 * Returns  m      OF_SAMPLES moments;  input: OF_INPUT moments of the first input, the next input's at + PER_INPUT */
static void outputs_moments(const double *y, int n_inputs, double *m, double *input)
{
	const double a = y[0], b = y[1];
	double all = a * a + b * b;
	m[A] = a;
	m[B] = b;
	m[PAIR] = 0.5 * all;
	for (int j = 0; j < n_inputs; j++, input += PER_INPUT) {
		const double c = y[POUND_SAMPLE_MIXED + j], change = c - a;
		input[CHANGE] = change;
		input[PRODUCT] = b * change;
		input[SQUARE] = 0.5 * change * change;
		all += c * c;
	}
	m[ALL] = all / (n_inputs + 2);
}

static void moments_fill(const void *subject, int row, double *m)
{
	const struct pound_rows *rows = subject;
	const int d = rows->n_inputs, n_samples = rows->n_samples;
	const size_t at = (size_t)row * n_samples;
	double noise[POUND_SAMPLES_MAX * POUND_SAMPLES_MAX];
	pound_rows_noise(rows, row, noise);
	outputs_moments(rows->plain + at, d, m, m + FIRST_INPUT);
	outputs_moments(rows->y + at, d, m + CORRECTED, m + FIRST_INPUT + INPUT_CORRECTED);
	const double *noise_a = noise, *noise_b = noise + n_samples, aa = noise_a[0], bb = noise_b[1];
	double all = aa + bb;
	m[CORRECTED + PAIR] -= 0.5 * all;
	m[NOISE_AB] = noise_a[1];
	for (int j = 0; j < d; j++) {
		const int p = POUND_SAMPLE_MIXED + j;
		const double cc = noise[p * n_samples + p], ac = noise_a[p], bc = noise_b[p];
		double *k = m + FIRST_INPUT + PER_INPUT * j;
		k[NOISE_PRODUCT] = bc - m[NOISE_AB];
		k[INPUT_CORRECTED + PRODUCT] -= k[NOISE_PRODUCT];
		// noise variance of the difference c - a: exactly 0 for an input without effect
		k[INPUT_CORRECTED + SQUARE] -= 0.5 * (aa + cc - 2.0 * ac);
		all += cc;
	}
	m[NOISE_ALL] = all / (d + 2);
	m[CORRECTED + ALL] -= m[NOISE_ALL];
}

static double ratio(double numerator, double variance, double variance_floor)
{
	return variance > variance_floor ? numerator / variance : NAN;
}

/* Mean of all samples.
 *
 * Given    m, input  as from outputs_moments() */
static double mean_of_all(const double *m, const double *input, int n_inputs)
{
	double sum = (n_inputs + 1) * m[A] + m[B];
	for (int j = 0; j < n_inputs; j++)
		sum += input[PER_INPUT * j + CHANGE];
	return sum / (n_inputs + 2);
}

static void values_fill(const void *subject, const double *m, double *value)
{
	const struct pound_rows *rows = subject;
	const int d = rows->n_inputs, r = rows->n_signals;
	const double floor = rows->variance_floor, *corrected = m + CORRECTED;
	const double mu = 0.5 * (m[A] + m[B]), mean = mean_of_all(m, m + FIRST_INPUT, d);
	const double pair = m[PAIR] - mu * mu, all = m[ALL] - mean * mean;
	const double grand = mean_of_all(corrected, m + FIRST_INPUT + INPUT_CORRECTED, d);
	const double pair_corrected = corrected[PAIR] - grand * (corrected[A] + corrected[B]) + grand * grand;
	const double all_corrected = corrected[ALL] - grand * grand;
	const double noise = m[NOISE_ALL], one_signal = all_corrected + r * noise;
	for (int j = 0; j < d; j++) {
		const double *k = m + FIRST_INPUT + PER_INPUT * j, *fair = k + INPUT_CORRECTED;
		value[FIRST_RAW * d + j] = ratio(k[PRODUCT] - mu * k[CHANGE], pair, floor);
		value[TOTAL_RAW * d + j] = ratio(k[SQUARE], all, floor);
		value[FIRST * d + j] = ratio(fair[PRODUCT] - grand * fair[CHANGE], pair_corrected, floor);
		value[TOTAL * d + j] = ratio(fair[SQUARE], all_corrected, floor);
		value[WITH_SIGNAL * d + j] = ratio(r * k[NOISE_PRODUCT], one_signal, floor);
	}
	double *single = value + BLOCKS * d;
	single[SIGNAL_TOTAL_ONE] = ratio(r * noise, one_signal, floor);
	single[SIGNAL_TOTAL] = ratio(noise, all, floor);
	single[SIGNAL_FIRST] = ratio(r * m[NOISE_AB], one_signal, floor);
}

size_t pound_noise_correction_scratch(const struct pound_sample_values *shape)
{
	const int n_inputs = shape->n_inputs;
	return pound_bootstrap_scratch(shape->n_rows, FIRST_INPUT + PER_INPUT * n_inputs,
	                               BLOCKS * n_inputs + SINGLES);
}

/* Pick-freeze indices, raw and corrected for the noise of few signals, and the indices of the signals.
 *
 * Given    rows       -      outputs and their noise
 *          resampling -      of the rows
 * Returns  result     -      with 95 % intervals; corrected and signal indices are NAN for one signal
 * Memory   scratch    (pound_noise_correction_scratch)
 *
 *   raw         S_j = mean((b - mu) (c - a)) / v                  T_j = mean((a - c)^2) / (2 w)
 *   corrected   S_j = (P_BC - P_AB) / v',  v' = (P_AA + P_BB) / 2     T_j = (P_AA + P_CC - 2 P_AC) / (2 w')
 *   where       P_pq = mean((p - g) (q - g) - noise_pq),  g the mean and w, w' the variances over all samples
 *   signals     N = R mean(noise_pp):  T_w(1) = N / (w' + N),  T_w(R) = (N / R) / w,
 *               S_w(1) = R mean(noise_AB) / (w' + N),  S_jw = R mean(noise_BC - noise_AB) / (w' + N)
 *
 * T_w(1) is the total index of the signal as an additional input in single runs, S_w(1) its first-order index, S_jw the
 * second-order index of signal and input j; S_w(1) and S_jw are 0 by construction if samples do not share signals.
 * T_w(R) is the variance fraction of the randomness that remains in the means over R signals.
 *
 * Source   within-row covariances: valid_rows.c; for outputs that are plain means they are the U-statistics over pairs of
 *          different signals
 * Test     unit_noise_correction: the_golden_row_set_is_met
 */
void pound_noise_correction_estimates(const struct pound_rows *rows, struct pound_resampling resampling,
                                      double *scratch, struct pound_pick_freeze *result)
{
	const int d = rows->n_inputs;
	const struct pound_statistic statistic = {
	    FIRST_INPUT + PER_INPUT * d, BLOCKS * d + SINGLES, moments_fill, values_fill, rows, rows->stop};
	struct pound_estimate estimates[POUND_VALUES_MAX];
	struct pound_upper upper[POUND_VALUES_MAX];
	pound_bootstrap_estimates(&statistic, &rows->scatter, rows->n_rows, resampling, scratch, estimates);
	pound_jackknife_upper(&statistic, &rows->scatter, rows->n_rows, scratch, upper);
	for (int j = 0; j < d; j++) {
		result->first_raw[j] = estimates[FIRST_RAW * d + j];
		result->total_raw[j] = estimates[TOTAL_RAW * d + j];
		result->first[j] = estimates[FIRST * d + j];
		result->total[j] = estimates[TOTAL * d + j];
		result->total_upper[j] = upper[TOTAL * d + j];
		result->total_raw_upper[j] = upper[TOTAL_RAW * d + j];
		result->with_signal[j] = estimates[WITH_SIGNAL * d + j];
	}
	result->signal_total_one = estimates[BLOCKS * d + SIGNAL_TOTAL_ONE];
	result->signal_total = estimates[BLOCKS * d + SIGNAL_TOTAL];
	result->signal_first = estimates[BLOCKS * d + SIGNAL_FIRST];
}
