/* pick_freeze.c - estimators of first-order and total indices by name, each a function of means over the rows.
 *
 * In the formulas a, b, c, e are the outputs of a row at A, B, A with column j from B, and B with column j from A, centered
 * by the grand mean of all rows (against cancellation); a capital is a mean over rows; mu = (A + B) / 2;
 * v = mean((a^2 + b^2) / 2) - mu^2; w is the variance over the samples A, B, C of all rows.  If given, the covariance of
 * the noise of two outputs is subtracted from their product, so that every formula estimates the indices for
 * infinitely many signals.
 *
 * A value is NAN where its variance is not above variance_floor.  Nothing is clipped to [0, 1]. */
#include "engine/indices/indices.h"

#include <math.h>

static double ratio(double numerator, double variance, double variance_floor)
{
	return variance > variance_floor ? numerator / variance : NAN;
}

/* The product of two outputs of a row, corrected for noise. */
static double product(const struct pound_outputs *row, int p, int q)
{
	return row->y[p] * row->y[q] - (row->noise ? row->noise[p * row->n_samples + q] : 0.0);
}

enum { LEAN_A, LEAN_B, LEAN_PAIR, LEAN_ALL, LEAN_FIRST, LEAN_STEP = 3 };

static int lean_count(int n_inputs)
{
	return LEAN_FIRST + LEAN_STEP * n_inputs;
}

/* Moments for Saltelli's and Jansen's formulas: differences, so that an input without effect adds exact zeros. */
static void lean_moments(const struct pound_outputs *row, double *m)
{
	const int d = row->n_inputs, n = row->n_samples;
	const double a = row->y[0], b = row->y[1], *c = row->y + 2, *noise = row->noise;
	double all = a * a + b * b - (noise ? noise[0] + noise[n + 1] : 0.0);
	m[LEAN_A] = a;
	m[LEAN_B] = b;
	m[LEAN_PAIR] = 0.5 * all;
	for (int j = 0; j < d; j++) {
		double *k = m + LEAN_FIRST + LEAN_STEP * j, change = c[j] - a;
		k[0] = change;
		k[1] = b * change;
		k[2] = 0.5 * change * change;
		all += c[j] * c[j];
		if (noise) {
			const int p = 2 + j;
			k[1] -= noise[n + p] - noise[1];
			k[2] -= 0.5 * (noise[0] + noise[p * n + p] - 2.0 * noise[p]);
			all -= noise[p * n + p];
		}
	}
	m[LEAN_ALL] = all / (d + 2);
}

/* First-order index by Saltelli's formula, centered, and total index by Jansen's.
 *
 *   S_j = mean((b - mu) (c - a)) / v          T_j = mean((a - c)^2) / (2 w)
 *
 * The total is divided by the variance over all samples, not over A and B only: for five test functions this
 * reduces its error by 2-9 % (n = 1000, Latin hypercube) at no extra runs.
 *
 * Source   Saltelli, Annoni, Azzini, Campolongo, Ratto, Tarantola 2010, Comput. Phys. Commun. 181, 259-270,
 *          table 2 (b) and (f); Jansen 1999, Comput. Phys. Commun. 117, 35-43
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void saltelli_2010(const double *m, int n_inputs, double variance_floor, double *value)
{
	double mu = 0.5 * (m[LEAN_A] + m[LEAN_B]), grand = (n_inputs + 1) * m[LEAN_A] + m[LEAN_B];
	for (int j = 0; j < n_inputs; j++)
		grand += m[LEAN_FIRST + LEAN_STEP * j];
	grand /= n_inputs + 2;
	double v = m[LEAN_PAIR] - mu * mu, w = m[LEAN_ALL] - grand * grand;
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + LEAN_FIRST + LEAN_STEP * j;
		value[j] = ratio(k[1] - mu * k[0], v, variance_floor);
		value[n_inputs + j] = ratio(k[2], w, variance_floor);
	}
}

enum { A, B, AA, BB, AB, SHARED };
enum { C, CC, AC, BC, FULL_STEP };
enum { E = FULL_STEP, EE, AE, BE, CE, DOUBLE_STEP };

static int full_count(int n_inputs)
{
	return SHARED + FULL_STEP * n_inputs;
}

static int double_count(int n_inputs)
{
	return SHARED + DOUBLE_STEP * n_inputs;
}

static void shared_moments(const struct pound_outputs *row, double *m)
{
	m[A] = row->y[0], m[B] = row->y[1];
	m[AA] = product(row, 0, 0), m[BB] = product(row, 1, 1), m[AB] = product(row, 0, 1);
}

static void mixed_moments(const struct pound_outputs *row, int j, double *k)
{
	const int c = POUND_SAMPLE_MIXED + j;
	k[C] = row->y[c], k[CC] = product(row, c, c), k[AC] = product(row, 0, c), k[BC] = product(row, 1, c);
}

/* All means and products for formulas in the pairs (a, b), (a, c), (b, c). */
static void full_moments(const struct pound_outputs *row, double *m)
{
	shared_moments(row, m);
	for (int j = 0; j < row->n_inputs; j++)
		mixed_moments(row, j, m + SHARED + FULL_STEP * j);
}

/* The same plus the sample B with column j from A. */
static void double_moments(const struct pound_outputs *row, double *m)
{
	const unsigned all = pound_inputs_all(row->n_inputs);
	shared_moments(row, m);
	for (int j = 0; j < row->n_inputs; j++) {
		const int c = POUND_SAMPLE_MIXED + j, e = pound_order_sample(row->n_inputs, all ^ 1u << j);
		double *k = m + SHARED + DOUBLE_STEP * j;
		mixed_moments(row, j, k);
		k[E] = row->y[e], k[EE] = product(row, e, e), k[AE] = product(row, 0, e), k[BE] = product(row, 1, e);
		k[CE] = product(row, c, e);
	}
}

static double mean_of_both(const double *m)
{
	return 0.5 * (m[A] + m[B]);
}

static double variance_of_both(const double *m)
{
	return 0.5 * (m[AA] + m[BB]) - mean_of_both(m) * mean_of_both(m);
}

/* Both indices from squared differences.
 *
 *   S_j = 1 - mean((b - c)^2) / (2 v)          T_j = mean((a - c)^2) / (2 v)
 *
 * Source   Jansen 1999, Comput. Phys. Commun. 117, 35-43
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void jansen(const double *m, int n_inputs, double variance_floor, double *value)
{
	const double v = variance_of_both(m);
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + SHARED + FULL_STEP * j;
		value[j] = 1.0 - ratio(0.5 * (m[BB] + k[CC] - 2.0 * k[BC]), v, variance_floor);
		value[n_inputs + j] = ratio(0.5 * (m[AA] + k[CC] - 2.0 * k[AC]), v, variance_floor);
	}
}

/* Both indices as covariance over variance, mean and variance from the two samples compared.
 *
 *   S_j = (mean(b c) - q^2) / (mean((b^2 + c^2) / 2) - q^2),  q = mean((b + c) / 2)          T_j = 1 - same of a, c
 *
 * Source   Janon, Klein, Lagnoux, Nodet, Prieur 2014, ESAIM: Probab. Stat. 18, 342-364, equation 6
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void janon(const double *m, int n_inputs, double variance_floor, double *value)
{
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + SHARED + FULL_STEP * j;
		double q = 0.5 * (m[B] + k[C]), r = 0.5 * (m[A] + k[C]);
		value[j] = ratio(k[BC] - q * q, 0.5 * (m[BB] + k[CC]) - q * q, variance_floor);
		value[n_inputs + j] = 1.0 - ratio(k[AC] - r * r, 0.5 * (m[AA] + k[CC]) - r * r, variance_floor);
	}
}

/* Both indices as correlation coefficients:  S_j = corr(b, c)          T_j = 1 - corr(a, c)
 *
 * Source   Martinez 2011, as in Baudin, Boumhaout, Delage, Iooss, Martinez 2016, SAMO 2016
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void martinez(const double *m, int n_inputs, double variance_floor, double *value)
{
	double va = m[AA] - m[A] * m[A], vb = m[BB] - m[B] * m[B];
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + SHARED + FULL_STEP * j;
		double vc = fmax(k[CC] - k[C] * k[C], 0.0);
		value[j] = ratio(k[BC] - m[B] * k[C], sqrt(fmax(vb, 0.0) * vc), variance_floor);
		value[n_inputs + j] = 1.0 - ratio(k[AC] - m[A] * k[C], sqrt(fmax(va, 0.0) * vc), variance_floor);
	}
}

/* Both indices as covariances of differences.
 *
 *   S_j = mean((b - mu) (c - a)) / v          T_j = mean((a - mu) (a - c)) / v
 *
 * Source   Sobol', Tarantola, Gatelli, Kucherenko, Mauntz 2007, Reliab. Eng. Syst. Saf. 92, 957-960
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void sobol_2007(const double *m, int n_inputs, double variance_floor, double *value)
{
	const double mu = mean_of_both(m), v = variance_of_both(m);
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + SHARED + FULL_STEP * j, change = k[C] - m[A];
		value[j] = ratio(k[BC] - m[AB] - mu * change, v, variance_floor);
		value[n_inputs + j] = ratio(m[AA] - k[AC] + mu * change, v, variance_floor);
	}
}

/* Both indices from products: the mean of a b (S_j) and the squared mean (T_j) in place of the product of means.
 *
 *   S_j = (mean(b c) - mean(a b)) / v          T_j = 1 - (mean(a c) - mu^2) / v
 *
 * Source   Saltelli 2002, Comput. Phys. Commun. 145, 280-297; Homma, Saltelli 1996, Reliab. Eng. Syst. Saf. 52, 1-17
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void saltelli_2002(const double *m, int n_inputs, double variance_floor, double *value)
{
	const double mu = mean_of_both(m), v = variance_of_both(m);
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + SHARED + FULL_STEP * j;
		value[j] = ratio(k[BC] - m[AB], v, variance_floor);
		value[n_inputs + j] = 1.0 - ratio(k[AC] - mu * mu, v, variance_floor);
	}
}

/* Both indices from the four samples A, B, C, E, in a formula symmetric in them.
 *
 *   S_j = 2 mean((e - b) (a - c)) / V          T_j = mean((b - e)^2 + (a - c)^2) / V          V = mean((a - b)^2 + (e - c)^2)
 *
 * Source   Azzini, Mara, Rosati 2020, SN Appl. Sci. 2, 1988
 * Test     unit_pick_freeze: every_estimator_gives_its_golden_values
 */
static void azzini_rosati(const double *m, int n_inputs, double variance_floor, double *value)
{
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + SHARED + DOUBLE_STEP * j;
		double v = m[AA] + m[BB] - 2.0 * m[AB] + k[EE] + k[CC] - 2.0 * k[CE];
		double first = (k[AE] - k[CE]) - (m[AB] - k[BC]);
		double total = (m[BB] + k[EE] - 2.0 * k[BE]) + (m[AA] + k[CC] - 2.0 * k[AC]);
		value[j] = ratio(2.0 * first, v, variance_floor);
		value[n_inputs + j] = ratio(total, v, variance_floor);
	}
}

static const struct pound_estimator estimators[] = {
    {"saltelli_2010", POUND_ORDER_TOTAL, lean_count, lean_moments, saltelli_2010},
    {"jansen", POUND_ORDER_TOTAL, full_count, full_moments, jansen},
    {"janon", POUND_ORDER_TOTAL, full_count, full_moments, janon},
    {"martinez", POUND_ORDER_TOTAL, full_count, full_moments, martinez},
    {"sobol_2007", POUND_ORDER_TOTAL, full_count, full_moments, sobol_2007},
    {"saltelli_2002", POUND_ORDER_TOTAL, full_count, full_moments, saltelli_2002},
    {"azzini_rosati", POUND_ORDER_SECOND, double_count, double_moments, azzini_rosati},
};

enum { ESTIMATORS = sizeof estimators / sizeof estimators[0] };

const struct pound_estimator *pound_estimator_row(int row)
{
	return row >= 0 && row < ESTIMATORS ? &estimators[row] : NULL;
}

const char *pound_estimator_name(int row)
{
	return row >= 0 && row < ESTIMATORS ? estimators[row].name : NULL;
}

int pound_estimator_order(int row)
{
	return estimators[row].order;
}
