/* unit_separation.c - statistics of the gap needed, against tables, closed forms and repeated sampling. */
#include <math.h>
#include <stdlib.h>

#include "engine/numeric/random.h"
#include "engine/separation/separation.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"

static const double PI = 3.14159265358979323846;

/* gaps 1, 2, ... n from n independent runs */
static struct pound_needed whole(double *gap, int n)
{
	for (int k = 0; k < n; k++)
		gap[k] = 1 + (k * 7) % n; // n is no multiple of 7
	return (struct pound_needed){.n_clusters = n, .size = 1, .gap = gap};
}

static void pounding_is_counted_run_by_run(void **state)
{
	(void)state;
	const double gap[] = {1, 2, NAN, 3, NAN, NAN};
	const struct pound_needed needed = {.n_clusters = 3, .size = 2, .gap = gap};
	const struct pound_needed_count count = pound_needed_count(&needed, 1.5),
	                                at = pound_needed_count(&needed, 2);
	assert_int_equal(count.pounding, 2);
	assert_int_equal(count.runs, 3);
	assert_int_equal(count.clusters, 2);
	// at a gap equal to the gap needed the bodies touch without contact force
	assert_int_equal(at.pounding, 1);
	// counts from sorted gaps by bisection
	double sorted[6];
	struct pound_needed single = {.n_clusters = 6, .size = 1, .gap = gap};
	for (int k = 0; k < 8; k++) {
		single.sorted = NULL;
		const struct pound_needed_count all = pound_needed_count(&single, 0.5 * k);
		single.sorted = sorted;
		single.n_sorted = pound_needed_sort(&single, sorted);
		const struct pound_needed_count found = pound_needed_count(&single, 0.5 * k);
		assert_int_equal(found.pounding, all.pounding);
		assert_int_equal(found.runs, all.runs);
		assert_int_equal(found.clusters, all.clusters);
	}
	const double none[] = {NAN};
	assert_true(isnan(
	    pound_needed_probability(&(struct pound_needed){.n_clusters = 1, .size = 1, .gap = none}, 0).value));
}

/* Clopper-Pearson: at each limit a tail of the binomial sum is 0.025; without pounding in n runs the upper limit is
 * 1 - 0.025^(1/n). */
static void the_band_is_the_exact_binomial_one(void **state)
{
	(void)state;
	double gap[100];
	for (int n = 1; n <= 100; n += 3) {
		if (n % 7 == 0)
			continue;
		const struct pound_needed needed = whole(gap, n);
		for (int k = 0; k <= n; k++) {
			const struct pound_estimate p = pound_needed_probability(&needed, n - k + 0.5);
			double above = 0, below = 0, term_low = 1, term_high = 1;
			check_near(p.value, (double)k / n, 1e-15);
			// binomial terms from logarithms
			const double low = p.low, high = p.high;
			for (int j = 0; j <= n; j++) {
				const double c = lgamma(n + 1.0) - lgamma(j + 1.0) - lgamma(n - j + 1.0);
				term_low = low > 0 ? exp(c + j * log(low) + (n - j) * log1p(-low)) : j == 0;
				term_high = high < 1 ? exp(c + j * log(high) + (n - j) * log1p(-high)) : j == n;
				above += j >= k ? term_low : 0;
				below += j <= k ? term_high : 0;
			}
			check_near(k > 0 ? above : 0.025, 0.025, 1e-11);
			check_near(k < n ? below : 0.025, 0.025, 1e-11);
			assert_true(k > 0 ? low > 0 : low == 0);
			assert_true(k < n ? high < 1 : high == 1);
		}
	}
}

/* If every run occurs twice, the interval is the same as from half as many runs, but for a factor. */
static void clusters_of_equal_runs_count_once(void **state)
{
	(void)state;
	double gap[40], twice[80];
	const struct pound_needed needed = whole(gap, 40), pairs = {.n_clusters = 40, .size = 2, .gap = twice};
	for (int k = 0; k < 80; k++)
		twice[k] = gap[k / 2];
	const struct pound_estimate one = pound_needed_probability(&needed, 30.5),
	                            two = pound_needed_probability(&pairs, 30.5);
	check_near(two.value, one.value, 1e-15);
	// n_eff is (clusters - 1) times a squared ratio of two quantiles of t near 1
	const double width = (two.high - two.low) / (one.high - one.low);
	assert_true(width > 1 && width < 1.06);
	// without scatter a cluster counts as one run
	check_near(pound_needed_probability(&pairs, 40).high, pound_needed_probability(&needed, 40).high, 1e-15);
}

/* Order statistics of n = 20 that contain the median with 95 %: the 6th and the 15th, as in every textbook. */
static void the_gap_for_a_probability_has_the_interval_of_order_statistics(void **state)
{
	(void)state;
	double gap[20], sorted[20];
	const struct pound_needed needed = whole(gap, 20);
	const int64_t n = pound_needed_sort(&needed, sorted);
	assert_int_equal(n, 20);
	struct pound_estimate g = pound_needed_gap(&needed, sorted, n, 0.5);
	check_near(g.value, 10, 0);
	check_near(g.low, 6, 0);
	check_near(g.high, 15, 0);
	// 5 % of 20 runs is one run; no order statistic is an upper limit of the quantile with 97.5 %
	g = pound_needed_gap(&needed, sorted, n, 0.05);
	check_near(g.value, 19, 0);
	assert_true(isnan(g.high) && g.low >= 15 && g.low <= 18);
	// coverage of the 0.9 quantile of 60 uniform gaps, over 2,000 samples
	int covered = 0;
	uint64_t stream = 7;
	for (int round = 0; round < 2000; round++) {
		double u[60], s[60];
		for (int k = 0; k < 60; k++)
			u[k] = specimen_uniform(&stream, 0, 1);
		const struct pound_needed of = {.n_clusters = 60, .size = 1, .gap = u};
		g = pound_needed_gap(&of, s, pound_needed_sort(&of, s), 0.1);
		covered += g.low <= 0.9 && !(g.high < 0.9);
	}
	// at least 95 %, less 3 standard errors of 0.5 %
	assert_true(covered >= 0.935 * 2000);
}

/* Variances and covariance of oscillators under the same white noise by the Lyapunov equation A P + P A' + b b' = 0,
 * solved as linear equations. */
static void white_noise(const double w[2], const double xi[2], double *left, double *right, double *both)
{
	double a[4][4] = {{0}}, m[16][17] = {{0}};
	for (int i = 0; i < 2; i++) {
		a[2 * i][2 * i + 1] = 1;
		a[2 * i + 1][2 * i] = -w[i] * w[i];
		a[2 * i + 1][2 * i + 1] = -2 * xi[i] * w[i];
	}
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++) {
			for (int k = 0; k < 4; k++) {
				m[4 * i + j][4 * k + j] += a[i][k];
				m[4 * i + j][4 * i + k] += a[j][k];
			}
			m[4 * i + j][16] = i % 2 && j % 2 ? -1 : 0;
		}
	for (int c = 0; c < 16; c++) {
		int pivot = c;
		for (int r = c; r < 16; r++)
			pivot = fabs(m[r][c]) > fabs(m[pivot][c]) ? r : pivot;
		for (int k = 0; k < 17; k++) {
			const double t = m[c][k];
			m[c][k] = m[pivot][k], m[pivot][k] = t;
		}
		for (int r = 0; r < 16; r++)
			for (int k = 16; k >= c && r != c; k--)
				m[r][k] -= m[c][k] * m[r][c] / m[c][c];
	}
	*left = m[0][16] / m[0][0], *right = m[10][16] / m[10][10], *both = m[2][16] / m[2][2];
}

static void the_correlation_is_that_of_white_noise(void **state)
{
	static const double ratios[] = {0.3, 0.8, 0.95, 1, 1.05, 1.7, 4}, dampings[] = {0.01, 0.05, 0.2, 0.7};
	(void)state;
	for (int r = 0; r < 7; r++)
		for (int i = 0; i < 4; i++)
			for (int j = 0; j < 4; j++) {
				const double w[2] = {2 * PI, 2 * PI * ratios[r]}, xi[2] = {dampings[i], dampings[j]};
				double left, right, both;
				white_noise(w, xi, &left, &right, &both);
				const double rho = pound_rule_correlation(w, xi);
				check_near(rho, both / sqrt(left * right), 1e-10);
				// hence the variance of the closing displacement is that of the double difference combination
				const double gap = pound_rule_gap(2, (const double[2]){sqrt(left), sqrt(right)}, rho);
				check_near(gap * gap / (left + right), (left + right - 2 * both) / (left + right), 1e-9);
			}
	check_near(pound_rule_correlation((const double[2]){1, 0}, (const double[2]){0.05, 0}), 0, 0);
}

static void rules_are_ordered_and_meet_at_their_limits(void **state)
{
	(void)state;
	const double u[2] = {3, 4};
	check_near(pound_rule_gap(0, u, 0.5), 7, 0);
	check_near(pound_rule_gap(1, u, 0.5), 5, 0);
	check_near(pound_rule_gap(2, u, 0), 5, 0);
	check_near(pound_rule_gap(2, u, 1), 1, 0);
	check_near(pound_rule_gap(2, u, -1), 7, 0);
}

enum { LEVELS = 6, RECORDS = 60 };

/* Capacities of records as intensities, lognormal; a record at its capacity needs a gap of 1, otherwise in proportion. */
static void stripes_make(struct pound_stripes *stripes, struct pound_needed needed[LEVELS], double *gaps,
                         uint64_t *stream, bool scaled)
{
	static const double intensity[LEVELS] = {0.4, 0.7, 1, 1.4, 2, 3};
	double capacity[RECORDS];
	for (int i = 0; i < LEVELS; i++) {
		for (int r = 0; r < RECORDS; r++) {
			if (i == 0 || !scaled)
				capacity[r] = 1.2 * exp(0.5 * sqrt(-2 * log(specimen_uniform(stream, 1e-12, 1))) *
				                        cos(2 * PI * specimen_uniform(stream, 0, 1)));
			gaps[i * RECORDS + r] = intensity[i] / capacity[r];
		}
		needed[i] = (struct pound_needed){.n_clusters = RECORDS, .size = 1, .gap = gaps + i * RECORDS};
	}
	*stripes = (struct pound_stripes){LEVELS, intensity, needed};
}

static void a_fragility_curve_is_found_again_its_intervals_cover(void **state)
{
	(void)state;
	for (int scaled = 0; scaled < 2; scaled++) {
		uint64_t stream = 11;
		int covered[2] = {0}, fits = 0;
		double median = 0, dispersion = 0;
		for (int round = 0; round < 400; round++) {
			double gaps[LEVELS * RECORDS];
			struct pound_needed needed[LEVELS];
			struct pound_stripes stripes;
			stripes_make(&stripes, needed, gaps, &stream, scaled);
			const struct pound_fragility fit = pound_fragility_fit(&stripes, 1);
			assert_true(fit.median.value > 0);
			fits++;
			median += log(fit.median.value), dispersion += fit.dispersion.value;
			covered[0] += fit.median.low <= 1.2 && fit.median.high >= 1.2;
			covered[1] += fit.dispersion.low <= 0.5 && fit.dispersion.high >= 0.5;
		}
		check_near(exp(median / fits), 1.2, 0.02);
		check_near(dispersion / fits, 0.5, 0.03);
		// 95 %, less 3 standard errors of 1.1 % and an allowance for few records
		assert_true(covered[0] > 0.9 * fits && covered[1] > 0.88 * fits);
	}
}

static struct pound_needed of_ten(const double *gap)
{
	return (struct pound_needed){.n_clusters = 10, .size = 1, .gap = gap};
}

/* For two intensities the curve passes through both points. */
static void two_points_are_on_the_curve_and_counts_without_one_have_none(void **state)
{
	(void)state;
	const double intensity[2] = {1, 2}, weak[] = {2, 0, 0, 0, 0, 0, 0, 0, 0, 0},
	             strong[] = {2, 2, 2, 2, 2, 2, 2, 0, 0, 0}, all[] = {2, 2, 2, 2, 2, 2, 2, 2, 2, 2};
	const struct pound_needed needed[] = {of_ten(weak), of_ten(strong)},
	                          steep[] = {of_ten(weak), of_ten(all)},
	                          falling[] = {of_ten(strong), of_ten(weak)};
	struct pound_stripes stripes = {2, intensity, needed};
	const struct pound_fragility fit = pound_fragility_fit(&stripes, 1);
	check_near(0.5 * erfc(-log(1 / fit.median.value) / fit.dispersion.value / sqrt(2)), 0.1, 1e-9);
	check_near(0.5 * erfc(-log(2 / fit.median.value) / fit.dispersion.value / sqrt(2)), 0.7, 1e-9);
	stripes.needed = steep;
	assert_true(isnan(pound_fragility_fit(&stripes, 1).median.value));
	assert_true(isnan(pound_fragility_fit(&stripes, 3).median.value)); // no pounding
	stripes.needed = falling;
	assert_true(isnan(pound_fragility_fit(&stripes, 1).median.value));
}

/* lambda = 0.01 x^-2; every run at intensity x needs a gap x: at a gap between two intensities the probability of pounding
 * rises from 0 at the lower to 1 at the higher one, linearly in ln x. */
static void the_rate_over_a_power_law_is_its_closed_form(void **state)
{
	(void)state;
	enum { N = 41 };
	double x[N], weights[N], gap[N], scratch[N], lambda[N];
	struct pound_needed needed[N];
	for (int i = 0; i < N; i++) {
		x[i] = 0.1 * pow(100, (double)i / (N - 1));
		gap[i] = x[i];
		lambda[i] = 0.01 * pow(x[i], -2);
		needed[i] = (struct pound_needed){.n_clusters = 1, .size = 1, .gap = &gap[i]};
	}
	const struct pound_stripes stripes = {N, x, needed};
	// points of the hazard curve differ from the intensities of the runs
	const double points[] = {0.05, 0.3, 20}, rates[] = {0.01 / 0.0025, 0.01 / 0.09, 0.01 / 400};
	const struct pound_hazard hazard = {3, points, rates};
	const double beyond = pound_hazard_weights(&hazard, &stripes, weights);
	check_near(beyond, lambda[N - 1], 1e-15);
	double sum = beyond;
	for (int i = 0; i < N; i++)
		sum += weights[i];
	check_near(sum / rates[0], 1, 1e-14); // every earthquake counts once
	for (int i = 1; i < N; i++) {
		// P rises from 0 to 1 between x_(i-1) and x_i: integral of s/L (-d lambda) + lambda_i
		const double length = log(x[i] / x[i - 1]), l0 = lambda[i - 1], l1 = lambda[i];
		const double rises = (l0 - l1) / (2 * length) - l1;
		check_near(pound_hazard_rate(&stripes, weights, beyond, 0.5 * (x[i - 1] + x[i])).value / (l1 + rises),
		           1, 1e-11);
	}
	const struct pound_estimate g = pound_hazard_gap(&stripes, weights, beyond, 0.01, scratch);
	// the smallest gap needed by any run for which the rate is at most the target
	assert_true(pound_hazard_rate(&stripes, weights, beyond, g.value).value <= 0.01);
	assert_true(pound_hazard_rate(&stripes, weights, beyond, g.value * 0.99).value > 0.01);
	assert_true(isnan(pound_hazard_gap(&stripes, weights, beyond, 0.5 * beyond, scratch).value));
}

CHECK_MAIN(cmocka_unit_test(pounding_is_counted_run_by_run),
           cmocka_unit_test(the_band_is_the_exact_binomial_one),
           cmocka_unit_test(clusters_of_equal_runs_count_once),
           cmocka_unit_test(the_gap_for_a_probability_has_the_interval_of_order_statistics),
           cmocka_unit_test(the_correlation_is_that_of_white_noise),
           cmocka_unit_test(rules_are_ordered_and_meet_at_their_limits),
           cmocka_unit_test(a_fragility_curve_is_found_again_its_intervals_cover),
           cmocka_unit_test(two_points_are_on_the_curve_and_counts_without_one_have_none),
           cmocka_unit_test(the_rate_over_a_power_law_is_its_closed_form))
