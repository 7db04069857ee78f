/* estimator.c - estimators of first-order and total indexes by name, each a function of means over the rows.
 *
 * In the formulas a, b, c are the outputs of a row at A, B and A with column j from B, centred by the grand mean of
 * all rows (so that cancellation costs nothing); a capital is a mean over rows; mu = (A + B) / 2;
 * v = mean((a^2 + b^2) / 2) - mu^2; w is the variance over all samples of all rows.
 * A value is NAN where its variance is not above variance_floor.  Nothing is clipped to [0, 1]. */
#include "engine/indices.h"

#include <math.h>

static double ratio(double numerator, double variance, double variance_floor)
{
	return variance > variance_floor ? numerator / variance : NAN;
}

enum { LEAN_A, LEAN_B, LEAN_PAIR, LEAN_ALL, LEAN_FIRST, LEAN_STEP = 3 };

static int lean_count(int n_inputs)
{
	return LEAN_FIRST + LEAN_STEP * n_inputs;
}

/* What Saltelli's and Jansen's formulas need: differences, so that an input without effect adds exact zeros. */
static void lean_moments(const double *y, int n_inputs, double *m)
{
	const double a = y[0], b = y[1], *c = y + 2;
	double all = a * a + b * b;
	m[LEAN_A] = a;
	m[LEAN_B] = b;
	m[LEAN_PAIR] = 0.5 * all;
	for (int j = 0; j < n_inputs; j++) {
		double *k = m + LEAN_FIRST + LEAN_STEP * j, change = c[j] - a;
		k[0] = change;
		k[1] = b * change;
		k[2] = 0.5 * change * change;
		all += c[j] * c[j];
	}
	m[LEAN_ALL] = all / (n_inputs + 2);
}

/* First-order index by Saltelli's formula, centred, and total index by Jansen's.
 *
 *   S_j = mean((b - mu) (c - a)) / v          T_j = mean((a - c)^2) / (2 w)
 *
 * The total is divided by the variance over all samples, not over A and B only: over five test functions its
 * error is 2-9 % smaller (n = 1000, Latin hypercube), and the runs are there.
 *
 * Source   Saltelli, Annoni, Azzini, Campolongo, Ratto, Tarantola 2010, Comput. Phys. Commun. 181, 259-270,
 *          table 2 (b) and (f); Jansen 1999, Comput. Phys. Commun. 117, 35-43
 * Test     unit_estimator: every_estimator_gives_its_golden_values
 */
static void saltelli(const double *m, int n_inputs, double variance_floor, double *value)
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

enum { FULL_A, FULL_B, FULL_AA, FULL_BB, FULL_AB, FULL_FIRST, FULL_STEP = 4 };

static int full_count(int n_inputs)
{
	return FULL_FIRST + FULL_STEP * n_inputs;
}

/* All means and products that any formula over the pairs (a, b), (a, c), (b, c) can need. */
static void full_moments(const double *y, int n_inputs, double *m)
{
	const double a = y[0], b = y[1], *c = y + 2;
	m[FULL_A] = a, m[FULL_B] = b;
	m[FULL_AA] = a * a, m[FULL_BB] = b * b, m[FULL_AB] = a * b;
	for (int j = 0; j < n_inputs; j++) {
		double *k = m + FULL_FIRST + FULL_STEP * j;
		k[0] = c[j], k[1] = c[j] * c[j], k[2] = a * c[j], k[3] = b * c[j];
	}
}

/* Both indexes from squared differences.
 *
 *   S_j = 1 - mean((b - c)^2) / (2 v)          T_j = mean((a - c)^2) / (2 v)
 *
 * Source   Jansen 1999, Comput. Phys. Commun. 117, 35-43
 * Test     unit_estimator: every_estimator_gives_its_golden_values
 */
static void jansen(const double *m, int n_inputs, double variance_floor, double *value)
{
	double mu = 0.5 * (m[FULL_A] + m[FULL_B]), v = 0.5 * (m[FULL_AA] + m[FULL_BB]) - mu * mu;
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + FULL_FIRST + FULL_STEP * j;
		value[j] = 1.0 - ratio(0.5 * (m[FULL_BB] + k[1] - 2.0 * k[3]), v, variance_floor);
		value[n_inputs + j] = ratio(0.5 * (m[FULL_AA] + k[1] - 2.0 * k[2]), v, variance_floor);
	}
}

/* Both indexes as covariance over variance, mean and variance from the two samples compared.
 *
 *   S_j = (mean(b c) - q^2) / (mean((b^2 + c^2) / 2) - q^2),  q = mean((b + c) / 2)          T_j = 1 - same of a, c
 *
 * Source   Janon, Klein, Lagnoux, Nodet, Prieur 2014, ESAIM: Probab. Stat. 18, 342-364, equation 6
 * Test     unit_estimator: every_estimator_gives_its_golden_values
 */
static void janon(const double *m, int n_inputs, double variance_floor, double *value)
{
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + FULL_FIRST + FULL_STEP * j;
		double q = 0.5 * (m[FULL_B] + k[0]), r = 0.5 * (m[FULL_A] + k[0]);
		value[j] = ratio(k[3] - q * q, 0.5 * (m[FULL_BB] + k[1]) - q * q, variance_floor);
		value[n_inputs + j] = 1.0 - ratio(k[2] - r * r, 0.5 * (m[FULL_AA] + k[1]) - r * r, variance_floor);
	}
}

/* Both indexes as correlation coefficients:  S_j = corr(b, c)          T_j = 1 - corr(a, c)
 *
 * Source   Martinez 2011, as in Baudin, Boumhaout, Delage, Iooss, Martinez 2016, SAMO 2016
 * Test     unit_estimator: every_estimator_gives_its_golden_values
 */
static void martinez(const double *m, int n_inputs, double variance_floor, double *value)
{
	double va = m[FULL_AA] - m[FULL_A] * m[FULL_A], vb = m[FULL_BB] - m[FULL_B] * m[FULL_B];
	for (int j = 0; j < n_inputs; j++) {
		const double *k = m + FULL_FIRST + FULL_STEP * j;
		double vc = fmax(k[1] - k[0] * k[0], 0.0);
		value[j] = ratio(k[3] - m[FULL_B] * k[0], sqrt(fmax(vb, 0.0) * vc), variance_floor);
		value[n_inputs + j] = 1.0 - ratio(k[2] - m[FULL_A] * k[0], sqrt(fmax(va, 0.0) * vc), variance_floor);
	}
}

static const struct pound_estimator estimators[] = {
    {"saltelli", lean_count, lean_moments, saltelli},
    {"jansen", full_count, full_moments, jansen},
    {"janon", full_count, full_moments, janon},
    {"martinez", full_count, full_moments, martinez},
};

enum { ESTIMATORS = sizeof estimators / sizeof estimators[0] };

const struct pound_estimator *pound_estimator_row(int row)
{
	return row >= 0 && row < ESTIMATORS ? &estimators[row] : NULL;
}
