/* signal_split.c - variance components of an index from n rows of R signals, estimated from a pilot of few rows with six signals
 * each.
 *
 * 1. Indices are quotients of means of quadratic forms of a row's outputs, corrected for the noise of R signals: these forms are
 *    U-statistics over pairs of different signals.  Their variance, for any distribution of the signals, is
 *
 *      (rows + signals / R + pairs / (R (R - 1))) / n
 *
 *    rows: variance of the rows' means over all signals;  signals: 4 times the variance of the first-order part in one signal;
 *    pairs: 2 times the variance of the part in two signals.  (For T with D = c - a: rows = Var(delta^2 / 2), signals =
 *    E(delta^2 eta^2), pairs = E(eta^4) / 2, where delta is the mean and eta^2 the variance of D given the row.)
 * 2. The intervals of every index with pairs, triples and all six of the pilot's signals give three equations.  They are
 *    solved by nonnegative least squares of relative errors.
 * 3. The jackknife leaves a bias of order 1 / (R (R - 1)) in a ratio of means of R signals: with E(Y_R) = Y + b / R + c / R^2,
 *    R Y_R - (R - 1) Y_(R - 1) is Y - c / (R (R - 1)).  It is estimated as the mean of an index's form over all 15 pairs less
 *    the form of all six signals; for outputs that are plain means both are equal.
 *
 * Source   Hoeffding 1948, Ann. Math. Stat. 19, 293-325, variance of a U-statistic of degree 2 */
#include "engine/indices/signal_split.h"

#include <math.h>
#include <string.h>

enum { N = POUND_SPLIT_SIGNALS, PARTS = 3, SETS = 3 };

/* Partitions of a pilot's signals into sets of equal size: the size and the number of sets. */
static const struct {
	int size, n;
} sets[SETS] = {{2, 3}, {3, 2}, {6, 1}};

static double pairs_of(int n_signals)
{
	return 1.0 / ((double)n_signals * (n_signals - 1));
}

/* Test     unit_signal_split: the_variance_of_an_index_follows_its_three_parts */
double pound_split_variance(const struct pound_split_parts *parts, int n_signals)
{
	return parts->rows + parts->signals / n_signals + parts->pairs * pairs_of(n_signals);
}

double pound_split_bias(const struct pound_split_parts *parts, int n_signals)
{
	return parts->bias * pairs_of(n_signals);
}

/* The values of selected signals.
 *
 * Returns  into    (rows x samples x n) numerators, then denominators
 */
static struct pound_sample_values chosen(const struct pound_sample_values *values, const int *signal, int n,
                                         double *into)
{
	const size_t samples = (size_t)values->n_rows * pound_values_samples(values);
	struct pound_sample_values part = *values;
	part.n_signals = n;
	part.numerator = into;
	part.denominator = into + samples * n;
	for (size_t k = 0; k < samples; k++)
		for (int r = 0; r < n; r++) {
			into[k * n + r] = values->numerator[k * values->n_signals + signal[r]];
			into[(samples + k) * n + r] = values->denominator[k * values->n_signals + signal[r]];
		}
	return part;
}

/* Adds the row means whose quotients are the corrected pick-freeze indices: numerators of S1, then of ST, then the variance.
 *
 * Given    centre  -                     subtracted from all outputs: a mean over the same signals would add its own noise
 * Returns  form    (2 x n_inputs + 1)
 */
static void forms_add(const struct pound_rows *rows, double centre, double weight, double *form)
{
	const int d = rows->n_inputs, n = rows->n_samples;
	const double shift = rows->mean - centre;
	double noise[POUND_SAMPLES_MAX * POUND_SAMPLES_MAX];
	weight /= rows->n_rows;
	for (int i = 0; i < rows->n_rows; i++) {
		const double *y = rows->y + (size_t)i * n, a = y[0] + shift, b = y[1] + shift;
		pound_rows_noise(rows, i, noise);
		for (int j = 0; j < d; j++) {
			const int p = POUND_SAMPLE_MIXED + j;
			const double change = y[p] - y[0];
			form[j] += weight * (b * change - (noise[n + p] - noise[1]));
			form[d + j] += weight * 0.5 * (change * change - (noise[p * n + p] + noise[0] - 2.0 * noise[p]));
		}
		form[2 * d] += weight * 0.5 * (a * a + b * b - noise[0] - noise[n + 1]);
	}
}

/* Solves m x = b, positive definite, for the unknowns in the mask by elimination, others 0; false: an unknown is < 0. */
static bool solved(const double m[PARTS][PARTS], const double b[PARTS], unsigned mask, double x[PARTS])
{
	double a[PARTS][PARTS + 1];
	for (int i = 0; i < PARTS; i++) {
		for (int j = 0; j < PARTS; j++)
			a[i][j] = mask >> i & mask >> j & 1 ? m[i][j] : i == j;
		a[i][PARTS] = mask >> i & 1 ? b[i] : 0.0;
	}
	for (int k = 0; k < PARTS; k++)
		for (int i = k + 1; i < PARTS; i++)
			for (int j = PARTS; j >= k; j--)
				a[i][j] -= a[i][k] / a[k][k] * a[k][j];
	bool positive = true;
	for (int i = PARTS - 1; i >= 0; i--) {
		x[i] = a[i][PARTS];
		for (int j = i + 1; j < PARTS; j++)
			x[i] -= a[i][j] * x[j];
		x[i] /= a[i][i];
		positive &= x[i] >= 0.0;
	}
	return positive;
}

/* Nonnegative least squares fit of the parts to the variances with sets of 2, 3 and 6 signals, by relative errors: the best
 * feasible one of all choices of nonzero parts. */
static void parts_fit(const double variance[SETS], struct pound_split_parts *parts)
{
	double m[PARTS][PARTS] = {{0}}, b[PARTS] = {0}, most = -1.0;
	for (int k = 0; k < SETS; k++) {
		const double of[PARTS] = {1.0 / variance[k], 1.0 / variance[k] / sets[k].size,
		                          1.0 / variance[k] * pairs_of(sets[k].size)};
		for (int i = 0; i < PARTS; i++) {
			b[i] += of[i];
			for (int j = 0; j < PARTS; j++)
				m[i][j] += of[i] * of[j];
		}
	}
	for (unsigned mask = 1; mask < 1u << PARTS; mask++) {
		double x[PARTS];
		if (!solved(m, b, mask, x))
			continue;
		// the residual sum of squares is the sum of squares of the data less b x
		const double explained = b[0] * x[0] + b[1] * x[1] + b[2] * x[2];
		if (explained > most) {
			most = explained;
			parts->rows = x[0];
			parts->signals = x[1];
			parts->pairs = x[2];
		}
	}
}

/* Adds, for sets of one size, the mean over the sets of the variance of all index numerators, times the number of rows; the
 * caller divides by the squared variance estimated from all signals. */
static void variances_add(const struct pound_sample_values *values, const struct pound_sampling *sampling,
                          uint64_t seed, int k, double *scratch, double *variance)
{
	const int d = values->n_inputs, n = sets[k].n;
	double *rest = scratch + 2 * (size_t)values->n_rows * pound_values_samples(values) * N;
	struct pound_estimate columns[POUND_N_INDICES][POUND_INPUTS_MAX];
	static const enum pound_index asked[] = {POUND_S1, POUND_ST};
	for (int s = 0; s < n && !pound_stopped(values->stop); s++) {
		int signal[N];
		double form[2 * POUND_INPUTS_MAX + 1] = {0};
		struct pound_indices indices = {0};
		struct pound_rows rows;
		for (int r = 0; r < sets[k].size; r++)
			signal[r] = s * sets[k].size + r;
		for (int c = 0; c < POUND_N_INDICES; c++)
			indices.index[c] = columns[c];
		const struct pound_sample_values part = chosen(values, signal, sets[k].size, scratch);
		pound_rows_init(&rows, &part, rest);
		forms_add(&rows, rows.mean, 1.0, form);
		const int kept = rows.n_rows;
		pound_index_columns_indices(&part, sampling, seed, rest, &indices);
		for (int c = 0; c < 2; c++)
			for (int j = 0; j < d; j++) {
				const struct pound_estimate *e = &columns[asked[c]][j];
				const double error = (e->high - e->low) / (2.0 * POUND_NORMAL_95) * form[2 * d];
				variance[c * d + j] += error * error * kept / n;
			}
	}
}

/* Doubles of scratch of pound_split_estimate. */
size_t pound_split_scratch(const struct pound_sample_values *shape)
{
	return 2 * (size_t)shape->n_rows * pound_values_samples(shape) * N +
	       pound_index_columns_scratch(shape, NULL);
}

/* Variance components of all S1 and ST.
 *
 * Given    values    (n_rows x n_samples x 6)   of a pilot, 30 rows or more
 *          sampling  -                          its design; ratios and estimators are ignored
 *          seed      -                          of the resamples
 * Returns  parts     (2 x n_inputs)             of every S1, then of every ST; NAN: no variance is left after noise correction
 * Memory   scratch   (pound_split_scratch)
 *
 * Test     unit_signal_split
 */
void pound_split_estimate(const struct pound_sample_values *values, const struct pound_sampling *sampling,
                          uint64_t seed, double *scratch, struct pound_split_parts *parts)
{
	const int d = values->n_inputs;
	static const int every[N] = {0, 1, 2, 3, 4, 5};
	double *rest = scratch + 2 * (size_t)values->n_rows * pound_values_samples(values) * N;
	double all[2 * POUND_INPUTS_MAX + 1] = {0}, pairs[2 * POUND_INPUTS_MAX + 1] = {0};
	double variance[SETS][2 * POUND_INPUTS_MAX] = {{0}};
	struct pound_rows rows;
	const struct pound_sample_values whole = chosen(values, every, N, scratch);
	pound_rows_init(&rows, &whole, rest);
	const double centre = rows.mean, floor = rows.variance_floor;
	forms_add(&rows, centre, 1.0, all);
	for (int p = 0; p < N; p++)
		for (int q = 0; q < p; q++) {
			const struct pound_sample_values part = chosen(values, (const int[]){q, p}, 2, scratch);
			pound_rows_init(&rows, &part, rest);
			forms_add(&rows, centre, 2.0 / (N * (N - 1)), pairs);
		}
	for (int k = 0; k < SETS; k++)
		variances_add(values, sampling, seed, k, scratch, variance[k]);
	for (int i = 0; i < 2 * d; i++) {
		const double v = all[2 * d];
		double of[SETS];
		parts[i] = (struct pound_split_parts){NAN, NAN, NAN, NAN};
		for (int k = 0; k < SETS; k++)
			of[k] = variance[k][i] / (v * v);
		if (!(v > floor) || !(of[0] > 0.0 && of[1] > 0.0 && of[2] > 0.0))
			continue;
		parts_fit(of, &parts[i]);
		// over the larger variance: the variance of few rows with two signals may be near 0
		parts[i].bias =
		    (pairs[i] - all[i] / v * pairs[2 * d]) / fmax(v, pairs[2 * d]) / (pairs_of(2) - pairs_of(N));
	}
}
