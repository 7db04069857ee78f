/* statistics_packages.c - the default estimators of other packages, after their published formulas.
 *
 * a, b, c: outputs at A, B and A with column j from B; all centered by the mean of every output, as in both packages. */
#include <stddef.h>

#include "tests/long/statistics.h"

static double output(const double *y, int n_samples, int row, int sample)
{
	return y[(size_t)row * n_samples + sample];
}

/* The mean over the samples that a package uses. */
static double grand_mean(const double *y, int n, int d, int n_samples)
{
	double sum = 0.0;
	for (int i = 0; i < n; i++)
		for (int p = 0; p < d + 2; p++)
			sum += output(y, n_samples, i, p);
	return sum / ((double)n * (d + 2));
}

/* S_j = mean(b (c - a)) / v,  T_j = mean((a - c)^2) / (2 v),  v the variance of a and b together
 *
 * Source   SALib 1.4, SALib.analyze.sobol: outputs standardized, first_order, total_order;
 *          Saltelli et al. 2010, Comput. Phys. Commun. 181, 259-270, table 2 (b) and (f)
 */
static void salib(const double *y, int n, int d, int n_samples, double *value)
{
	const double mean = grand_mean(y, n, d, n_samples);
	double sum = 0.0, squares = 0.0;
	for (int i = 0; i < n; i++)
		for (int p = 0; p < 2; p++) {
			double x = output(y, n_samples, i, p) - mean;
			sum += x / (2 * n);
			squares += x * x / (2 * n);
		}
	const double v = squares - sum * sum;
	for (int j = 0; j < d; j++) {
		value[j] = value[d + j] = 0.0;
		for (int i = 0; i < n; i++) {
			double a = output(y, n_samples, i, 0) - mean, b = output(y, n_samples, i, 1) - mean;
			double change = output(y, n_samples, i, 2 + j) - mean - a;
			value[j] += b * change / (n * v);
			value[d + j] += 0.5 * change * change / (n * v);
		}
	}
}

/* S_j = (sum(b c) / (n - 1) - mean(a) mean(b)) / v,  T_j = (v + mean(a)^2 - sum(a c) / (n - 1)) / v,  v the variance
 * of a only, over n - 1
 *
 * Source   OpenTURNS 1.20, SaltelliSensitivityAlgorithm, the default of its sensitivity analysis;
 *          Saltelli 2002, Comput. Phys. Commun. 145, 280-297
 */
static void openturns(const double *y, int n, int d, int n_samples, double *value)
{
	const double mean = grand_mean(y, n, d, n_samples);
	double mean_a = 0.0, mean_b = 0.0, squares = 0.0;
	for (int i = 0; i < n; i++) {
		double a = output(y, n_samples, i, 0) - mean;
		mean_a += a / n;
		mean_b += (output(y, n_samples, i, 1) - mean) / n;
		squares += a * a;
	}
	const double v = (squares - n * mean_a * mean_a) / (n - 1);
	for (int j = 0; j < d; j++) {
		double ac = 0.0, bc = 0.0;
		for (int i = 0; i < n; i++) {
			double c = output(y, n_samples, i, 2 + j) - mean;
			ac += (output(y, n_samples, i, 0) - mean) * c / (n - 1);
			bc += (output(y, n_samples, i, 1) - mean) * c / (n - 1);
		}
		value[j] = (bc - mean_a * mean_b) / v;
		value[d + j] = (v + mean_a * mean_a - ac) / v;
	}
}

const struct statistics_package statistics_packages[] = {
    {"SALib", salib},
    {"OpenTURNS", openturns},
    {NULL, NULL},
};
