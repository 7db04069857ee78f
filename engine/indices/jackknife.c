/* jackknife.c - 95 % intervals from groups of rows that are independent of each other: batches of Latin hypercubes, or
 * independently scrambled Sobol' sequences.
 *
 * 1. The statistic of all rows, theta, and of all but group k, theta_k, give M pseudo-values M theta - (M - 1) theta_k.
 * 2. The pseudo-values scatter like M independent numbers with the mean theta.
 * 3. The interval is theta +- Student's quantile for M - 1 degrees of freedom times the standard error of the pseudo-values.
 *
 * Rows within a group may be dependent: the interval shows the small error of a Sobol' sequence or Latin hypercube.
 * Tukey 1958, Ann. Math. Stat. 29, 614; L'Ecuyer, Nakayama, Owen, Tuffin 2023, Winter Simulation Conference. */
#include "engine/indices/indices.h"
#include "engine/numeric/elementary.h"

#include <math.h>
#include <string.h>

/* ---- Student's t distribution ---- */

/* Probability that |t| is less than sqrt(freedom) tan(theta), from the angle's sine and cosine.
 *
 *   even   sin theta (1 + 1/2 cos^2 + (1 3)/(2 4) cos^4 + ... )                                  freedom / 2 terms
 *   odd    2/pi (theta + sin theta (cos + 2/3 cos^3 + (2 4)/(3 5) cos^5 + ...))         (freedom - 1) / 2 terms
 *
 * Source   Abramowitz, Stegun 1964, 26.7.3 and 26.7.4
 */
static double student_within(int freedom, double turn, double sine, double cosine)
{
	const bool odd = freedom % 2;
	double term = odd ? cosine : 1, sum = 0;
	for (int k = odd ? 3 : 2; k <= freedom; k += 2) {
		sum += term;
		term *= cosine * cosine * (k - 1) / k;
	}
	// turn is the angle over 2 pi, so 2/pi times the angle is 4 turn
	return odd ? 4 * turn + 2 / M_PI * sine * sum : sine * sum;
}

/* 97.5 % quantile of Student's t, the half width of a 95 % interval in standard errors.
 *
 * Given    freedom     -       degrees of freedom  >= 1
 * Returns  value       t       by bisection of the angle whose tangent is t / sqrt(freedom)
 *
 * Test     unit_jackknife: student_quantiles_are_those_of_the_tables
 */
double pound_jackknife_student(int freedom)
{
	if (freedom > 1 << 14)
		return POUND_NORMAL_95; // relative error below 1.5e-4
	double low = 0, high = 0.25, sine = 1, cosine = 0;
	for (double turn = 0.125; low < turn && turn < high; turn = low + 0.5 * (high - low)) {
		pound_elementary_sincos(turn, &sine, &cosine);
		*(student_within(freedom, turn, sine, cosine) < 0.95 ? &low : &high) = turn;
	}
	pound_elementary_sincos(high, &sine, &cosine);
	return sqrt(freedom) * sine / cosine;
}

/* The quantile as a function of one over the degrees of freedom.
 *
 * Source   many degrees: Abramowitz, Stegun 1964, 26.7.5; the error is below 1e-4 from 20 on
 */
static double student_of(double over_freedom)
{
	const double most = 0.05, z = POUND_NORMAL_95, q = over_freedom;
	if (q >= most)
		return pound_jackknife_student((int)fmax(2, floor(1 / q + 0.5)));
	return z + q * z * (z * z + 1) / 4 + q * q * z * (5 * z * z * z * z + 16 * z * z + 3) / 96;
}

/* ---- pseudo-values ---- */

/* The group of a valid row. */
int pound_jackknife_group(const struct pound_scatter *scatter, int row)
{
	int64_t number = scatter->row ? scatter->row[row] : row;
	return (int)(number / scatter->grouping.run % scatter->grouping.n);
}

/* Sums of the moments of each group's rows, and the group's number of rows  (n x (n_moments + 1)). */
static void sums_fill(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                      int n_rows, double *sums)
{
	const int n_moments = statistic->n_moments, width = n_moments + 1;
	memset(sums, 0, sizeof *sums * (size_t)scatter->grouping.n * (size_t)width);
	for (int i = 0; i < n_rows && !pound_stopped(statistic->stop); i++) {
		double m[POUND_MOMENTS_MAX] = {0},
		       *sum = sums + (size_t)pound_jackknife_group(scatter, i) * (size_t)width;
		statistic->moments(statistic->subject, i, m);
		for (int k = 0; k < n_moments; k++)
			sum[k] += m[k];
		sum[n_moments]++;
	}
}

/* At most pound_bootstrap_scratch for the same number of rows. */
size_t pound_jackknife_scratch(const struct pound_scatter *scatter, int n_moments)
{
	return (size_t)scatter->grouping.n * (size_t)(n_moments + 1);
}

/* Running means and sums of squared deviations of the groups' pseudo-values. */
struct pseudo {
	int n;
	double mean[POUND_VALUES_MAX], squares[POUND_VALUES_MAX];
};

static void pseudo_add(struct pseudo *pseudo, int groups, const double *all, const double *without,
                       int n_values)
{
	pseudo->n++;
	for (int v = 0; v < n_values; v++) {
		double value = groups * all[v] - (groups - 1) * without[v], step = value - pseudo->mean[v];
		pseudo->mean[v] += step / pseudo->n;
		pseudo->squares[v] += step * (value - pseudo->mean[v]);
	}
}

/* A statistic's values, with 95 % intervals from the groups of rows.
 *
 * Given    statistic  -               moments of a row, and n_values numbers from their means
 *          scatter    -               the groups; empty groups do not count
 * Returns  estimates  (n_values)      low and high are NAN with fewer than two groups, or if the value is undefined
 *                                     without one of the groups
 * Memory   scratch    (pound_jackknife_scratch)
 *
 * Source   uses pooled moments, not the mean of the groups' own values, which is biased for small groups
 * Test     unit_jackknife: the_interval_of_a_mean_is_students, a_ratio_has_the_interval_of_its_pseudo_values
 */
void pound_jackknife_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                               int n_rows, double *scratch, struct pound_estimate *estimates)
{
	const int n_moments = statistic->n_moments, n_values = statistic->n_values, width = n_moments + 1;
	const int n = scatter->grouping.n;
	double sum[POUND_MOMENTS_MAX + 1] = {0}, mean[POUND_MOMENTS_MAX];
	double all[POUND_VALUES_MAX], without[POUND_VALUES_MAX];
	struct pseudo pseudo = {0};
	int groups = 0;
	sums_fill(statistic, scatter, n_rows, scratch);
	for (int g = 0; g < n; g++) {
		const double *of = scratch + (size_t)g * (size_t)width;
		for (int k = 0; k < width; k++)
			sum[k] += of[k];
		groups += of[n_moments] > 0;
	}
	for (int k = 0; k < n_moments; k++)
		mean[k] = sum[k] / n_rows;
	statistic->values(statistic->subject, mean, all);
	for (int g = 0; g < n && groups > 1 && !pound_stopped(statistic->stop); g++) {
		const double *of = scratch + (size_t)g * (size_t)width;
		if (!(of[n_moments] > 0))
			continue;
		for (int k = 0; k < n_moments; k++)
			mean[k] = (sum[k] - of[k]) / (n_rows - of[n_moments]);
		statistic->values(statistic->subject, mean, without);
		pseudo_add(&pseudo, groups, all, without, n_values);
	}
	const double student = groups > 1 ? pound_jackknife_student(groups - 1) : NAN;
	for (int v = 0; v < n_values; v++) {
		double half = student * sqrt(pseudo.squares[v] / (groups - 1.0) / groups);
		estimates[v] = (struct pound_estimate){all[v], all[v] - half, all[v] + half};
	}
}

/* Effective number of rows in the scatter of a mean over rows.
 *
 * Given    value      (n_rows)        of each row
 * Returns  value      -               (sum e^2)^2 / sum e^4, e the deviations from the mean: n over their kurtosis; n if all are equal
 *
 * Test     unit_jackknife: few_rows_are_behind_a_rare_event
 */
double pound_jackknife_rows(const double *value, int n_rows)
{
	double mean = 0, squares = 0, fourths = 0;
	for (int i = 0; i < n_rows; i++)
		mean += value[i] / n_rows;
	for (int i = 0; i < n_rows; i++) {
		const double square = (value[i] - mean) * (value[i] - mean);
		squares += square;
		fourths += square * square;
	}
	return fourths > 0 ? squares * squares / fourths : n_rows;
}

/* Standard error of a mean over rows, and half of its 95 % interval in standard errors.
 *
 * Given    value      (n_rows)        of each row
 *          scatter    -               groups: Student's t over the sums of their rows; none: the normal law over rows
 * Returns  value      -               the standard error, NAN for fewer than two rows or groups
 *          quantile   -               half of the interval over it
 *
 * The estimate of a variance from G values of kurtosis k has the relative variance 2 / (G - 1) + (k - 3) / G.  Equating it to 2
 * over the degrees of freedom gives, with m effective rows in the scatter, 1 / (1 / (G - 1) + (1/m - 3/n) / 2) degrees of freedom
 * (Satterthwaite 1946, Biometrics Bull. 2, 110-114).
 *
 * Memory   sums       (groups)
 *
 * Test     unit_jackknife: the_interval_of_a_mean_is_students
 */
double pound_jackknife_error(const double *value, int n_rows, const struct pound_scatter *scatter,
                             double *sums, double *quantile)
{
	const int n = scatter->grouping.n;
	double mean = 0, squares = 0;
	for (int i = 0; i < n_rows; i++)
		mean += value[i] / n_rows;
	const double behind = pound_jackknife_rows(value, n_rows),
	             tail = 0.5 * fmax(0, 1 / behind - 3.0 / n_rows);
	if (n == 0) {
		for (int i = 0; i < n_rows; i++)
			squares += (value[i] - mean) * (value[i] - mean);
		*quantile = student_of(tail);
		return sqrt(squares / (n_rows - 1.0) / n_rows);
	}
	for (int g = 0; g < n; g++)
		sums[g] = NAN; // no row yet
	for (int i = 0; i < n_rows; i++) {
		double *sum = &sums[pound_jackknife_group(scatter, i)];
		*sum = (isnan(*sum) ? 0 : *sum) + (value[i] - mean);
	}
	int groups = 0;
	for (int g = 0; g < n; g++)
		if (!isnan(sums[g])) {
			squares += sums[g] * sums[g];
			groups++;
		}
	*quantile = groups > 1 ? student_of(1 / (groups - 1.0) + tail) : NAN;
	return sqrt(squares * groups / (groups - 1.0)) / n_rows;
}

double pound_jackknife_half_width(const double *value, int n_rows, const struct pound_scatter *scatter,
                                  double *sums)
{
	double quantile;
	const double error = pound_jackknife_error(value, n_rows, scatter, sums, &quantile);
	return quantile * error;
}

/* ---- the upper end of a skewed value's interval ---- */

/* Cube root of x, |x| <= 8, by Newton's iteration from above: the same bits with every C library. */
static double cube_root(double x)
{
	const double size = fabs(x);
	double root = 2, next = 2;
	do {
		root = next;
		next = (2 * root + size / (root * root)) / 3;
	} while (next < root);
	return copysign(root, x);
}

/* Distance of the upper end of an interval from the value, in standard errors.
 *
 *   symbol     meaning                                                      source
 *   t          (value - true value) / standard error
 *   g          skewness of the value: of the rows, over the root of n       the rows
 *   q          97.5 % quantile of t without skewness                        Student's t
 *
 * To order g, P(t <= x) = Phi(x) + g (2 x^2 + 1) / 6 phi(x).  The cubic x + g x^2 / 3 + g^2 x^3 / 27 + g / 6 of t has no skewness
 * to this order and rises everywhere.  It is -q at x = -h:
 *
 *   h = (3 / g) (1 - cbrt(1 - g (q + g / 6)))        h = q + g (2 q^2 + 1) / 6 + ... for small g
 *
 * Source   Hall 1992, J. R. Stat. Soc. B 54, 221-228
 * Test     unit_jackknife: the_upper_end_is_the_root_of_halls_cubic
 */
double pound_jackknife_skewed(double q, double g)
{
	const double least = 1e-6; // below, the relative difference of h and q is below 1e-5
	return g > least ? 3 / g * (1 - cube_root(1 - g * (q + g / 6))) : q;
}

static int groups_with_rows(const struct pound_scatter *scatter, int n_rows, double *seen)
{
	int groups = 0;
	for (int g = 0; g < scatter->grouping.n; g++)
		seen[g] = 0;
	for (int i = 0; i < n_rows && scatter->grouping.n; i++) {
		double *of = &seen[pound_jackknife_group(scatter, i)];
		groups += *of == 0;
		*of = 1;
	}
	return groups;
}

/* How far the upper ends of the intervals of a statistic's values are from the values, by the skewness and the effective rows of the
 * values' scatter over the rows.
 *
 * Given    statistic  -               moments of a row, and n_values numbers from their means
 *          scatter    -               groups of the rows, for the degrees of freedom; skewness and effective rows are those of rows
 * Returns  upper      (n_values)      NAN without scatter, or if the value is undefined without one of the rows
 * Memory   scratch    (groups)
 *
 * Test     unit_jackknife: the_upper_end_of_a_skewed_mean_holds
 */
void pound_jackknife_upper(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                           int n_rows, double *scratch, struct pound_upper *upper)
{
	const int n_moments = statistic->n_moments, n_values = statistic->n_values;
	const double groups = groups_with_rows(scatter, n_rows, scratch);
	double mean[POUND_MOMENTS_MAX] = {0}, all[POUND_VALUES_MAX], without[POUND_VALUES_MAX];
	double squares[POUND_VALUES_MAX] = {0}, cubes[POUND_VALUES_MAX] = {0}, fourths[POUND_VALUES_MAX] = {0};
	for (int i = 0; i < n_rows && !pound_stopped(statistic->stop); i++) {
		double m[POUND_MOMENTS_MAX] = {0};
		statistic->moments(statistic->subject, i, m);
		for (int k = 0; k < n_moments; k++)
			mean[k] += m[k] / n_rows;
	}
	statistic->values(statistic->subject, mean, all);
	for (int i = 0; i < n_rows && !pound_stopped(statistic->stop); i++) {
		double m[POUND_MOMENTS_MAX] = {0};
		statistic->moments(statistic->subject, i, m);
		for (int k = 0; k < n_moments; k++)
			m[k] = mean[k] + (mean[k] - m[k]) / (n_rows - 1);
		statistic->values(statistic->subject, m, without);
		for (int v = 0; v < n_values; v++) {
			const double e = all[v] - without[v];
			squares[v] += e * e;
			cubes[v] += e * e * e;
			fourths[v] += e * e * e * e;
		}
	}
	for (int v = 0; v < n_values; v++) {
		const double s = squares[v], tail = 0.5 * fmax(0, fourths[v] / (s * s) - 3.0 / n_rows);
		const double freedom = scatter->grouping.n ? 1 / (groups - 1) : 0;
		const double errors = pound_jackknife_skewed(student_of(freedom + tail), cubes[v] / (s * sqrt(s)));
		upper[v] = (struct pound_upper){NAN, NAN};
		if (s > 0 && fourths[v] > 0 && freedom < 1)
			upper[v] = (struct pound_upper){errors, errors / student_of(freedom)};
	}
}
