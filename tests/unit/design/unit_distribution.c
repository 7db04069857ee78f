/* unit_distribution.c - quantiles against closed forms and against distribution functions defined here. */
#include "engine/pound.h"
#include "tests/support/check.h"

#include <float.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

static int row_named(const char *name)
{
	int row = 0;
	while (strcmp(pound_distribution_name(row), name))
		row++;
	return row;
}

/* The message of the first rule that a distribution violates. */
static const char *first_broken(const struct pound_distribution *distribution)
{
	for (int k = 0; pound_distribution_rule(distribution->type, k); k++)
		if (pound_distribution_breaks(distribution, k))
			return pound_distribution_rule(distribution->type, k);
	return "";
}

static double quantile(const char *name, const double *p, double u)
{
	struct pound_distribution distribution = {.type = row_named(name)};
	memcpy(distribution.p, p, sizeof distribution.p);
	assert_string_equal(first_broken(&distribution), "");
	return pound_distribution_quantile(&distribution, u);
}

/* P(X < x) of each distribution, from its definition. */
static double uniform_cdf(const double *p, double x)
{
	return (x - p[0]) / (p[1] - p[0]);
}
static double log_uniform_cdf(const double *p, double x)
{
	return log(x / p[0]) / log(p[1] / p[0]);
}
static double reciprocal_cdf(const double *p, double x)
{
	return x < 1.0 ? 0.5 - (1.0 / x - 1.0) / (p[0] - 1.0) / 2.0 : 0.5 + (x - 1.0) / (p[0] - 1.0) / 2.0;
}
static double normal_cdf(const double *p, double x)
{
	return 0.5 * erfc(-(x - p[0]) / p[1] / sqrt(2.0));
}
static double truncated_cdf(const double *p, double x)
{
	double low = normal_cdf(p, p[2]), high = normal_cdf(p, p[3]);
	return (normal_cdf(p, x) - low) / (high - low);
}
static double lognormal_cdf(const double *p, double x)
{
	return normal_cdf(p, log(x));
}
static double triangular_cdf(const double *p, double x)
{
	double width = p[2] - p[0];
	return x < p[1] ? (x - p[0]) * (x - p[0]) / (width * (p[1] - p[0]))
	                : 1.0 - (p[2] - x) * (p[2] - x) / (width * (p[2] - p[1]));
}
static double beta_cdf(const double *p, double x)
{
	return gsl_cdf_beta_P((x - p[2]) / (p[3] - p[2]), p[0], p[1]);
}

static double normal_cov_cdf(const double *p, double x)
{
	return 0.5 * erfc(-(x - p[0]) / (fabs(p[0]) * p[1]) / sqrt(2.0));
}
static double lognormal_cov_cdf(const double *p, double x)
{
	double s = sqrt(log(1.0 + p[1] * p[1]));
	return 0.5 * erfc(-(log(x / p[0]) / s + 0.5 * s) / sqrt(2.0));
}
static double lognormal_median_cdf(const double *p, double x)
{
	return 0.5 * erfc(-log(x / p[0]) / p[1] / sqrt(2.0));
}
static double gumbel_cdf(const double *p, double x)
{
	return exp(-exp(-(x - p[0]) / p[1]));
}
static double gamma_cdf(const double *p, double x)
{
	return gsl_cdf_gamma_P(x, p[0], p[1]);
}
static double weibull_cdf(const double *p, double x)
{
	return 1.0 - exp(-pow(x / p[0], p[1]));
}

static const struct {
	const char *name;
	double p[4];
	double (*cdf)(const double *p, double x);
} laws[] = {
    {"uniform", {0.5, 5.0}, uniform_cdf},
    {"uniform", {-3.0, -1.0}, uniform_cdf},
    {"log_uniform", {1e-3, 20.0}, log_uniform_cdf},
    {"reciprocal_uniform", {6.0}, reciprocal_cdf},
    {"reciprocal_uniform", {1.25}, reciprocal_cdf},
    {"normal", {2.0, 0.5}, normal_cdf},
    {"truncated_normal", {2.0, 0.5, 1.0, 4.0}, truncated_cdf},
    {"truncated_normal", {0.0, 1.0, -6.0, -2.0}, truncated_cdf},
    {"lognormal", {-1.0, 0.3}, lognormal_cdf},
    {"triangular", {-1.0, 0.5, 3.0}, triangular_cdf},
    {"triangular", {0.0, 0.0, 1.0}, triangular_cdf},
    {"triangular", {0.0, 1.0, 1.0}, triangular_cdf},
    {"beta", {2.0, 3.5, 0.0, 1.0}, beta_cdf},
    {"beta", {0.3, 0.7, 0.0, 3.0}, beta_cdf},
    {"beta", {400.0, 20.0, 0.0, 1.0}, beta_cdf},
    {"normal_cov", {2.0, 0.25}, normal_cov_cdf},
    {"normal_cov", {-2.0, 0.25}, normal_cov_cdf},
    {"lognormal_cov", {3.0, 0.4}, lognormal_cov_cdf},
    {"lognormal_median", {0.05, 0.6}, lognormal_median_cdf},
    {"gumbel", {0.3, 0.1}, gumbel_cdf},
    {"gamma", {0.5, 2.0}, gamma_cdf},
    {"gamma", {12.0, 0.1}, gamma_cdf},
    {"weibull", {0.2, 1.7}, weibull_cdf},
};

static void every_quantile_inverts_its_distribution_function(void **state)
{
	(void)state;
	for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++)
		for (int i = 1; i < 2000; i++) {
			double u = i / 2000.0;
			double x = quantile(laws[k].name, laws[k].p, u);
			// P changes by x P'(x) eps for an error of eps in x; none of these distributions exceeds x P' = 30
			check_near(laws[k].cdf(laws[k].p, x), u, 100.0 * DBL_EPSILON);
		}
}

static void quantiles_rise_with_the_probability(void **state)
{
	(void)state;
	for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
		double below = quantile(laws[k].name, laws[k].p, 0.0);
		for (double u = 0x1p-40; u < 1.0; u = u < 0.01 ? 2.0 * u : u + 0.01) {
			double x = quantile(laws[k].name, laws[k].p, u);
			assert_true(x > below);
			below = x;
		}
		assert_true(quantile(laws[k].name, laws[k].p, 1.0) > below);
	}
}

static void mass_ratio_quantiles_and_moments_are_those_of_the_closed_form(void **state)
{
	(void)state;
	// statistics_golden.json, mass_ratio
	static const double u[] = {0.0, 0.05, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0};
	static const double r[] = {1.0 / 6.0, 2.0 / 11.0, 0.2, 2.0 / 7.0, 0.5, 1.0, 2.0, 3.5, 5.0, 6.0};
	const double six[4] = {6.0};
	for (int k = 0; k < 10; k++)
		check_near(quantile("reciprocal_uniform", six, u[k]), r[k], 1e-14);

	gsl_integration_glfixed_table *gauss = gsl_integration_glfixed_table_alloc(64);
	double mean = 0.0, inverse = 0.0, square = 0.0, log_square = 0.0;
	for (int half = 0; half < 2; half++)
		for (size_t k = 0; k < 64; k++) {
			double v, w;
			gsl_integration_glfixed_point(0.5 * half, 0.5 * half + 0.5, k, &v, &w, gauss);
			double x = quantile("reciprocal_uniform", six, v);
			mean += w * x, inverse += w / x, square += w * x * x, log_square += w * log(x) * log(x);
		}
	gsl_integration_glfixed_table_free(gauss);
	check_near(mean, 1.75 + log(6.0) / 10.0, 1e-13);
	check_near(inverse, 1.75 + log(6.0) / 10.0, 1e-13);
	check_near(square, 7.25, 1e-12);
	check_near(square - mean * mean, 3.528280166, 1e-9); // nine decimals are known
	check_near(log_square, 1.5522596685347494, 1e-13);
}

static void beta_quantiles_with_closed_forms_are_met(void **state)
{
	(void)state;
	static const double arcsine[4] = {0.5, 0.5, 0.0, 1.0}, power[4] = {7.0, 1.0, 0.0, 1.0};
	static const double mirrored[4] = {1.0, 7.0, 0.0, 1.0}, small[4] = {0.02, 1.0, 0.0, 1.0};
	for (double u = 1e-6; u < 1.0; u *= 1.5) {
		double s = sin(1.5707963267948966 * u);
		// GSL's distribution function has an error of some 1e-14; dx/x = dP / (x P'), at most dP / alpha
		check_near(quantile("beta", arcsine, u), s * s, 1e-13);
		check_near(quantile("beta", power, u), pow(u, 1.0 / 7.0), 1e-13);
		check_near(quantile("beta", mirrored, u), -expm1(log1p(-u) / 7.0), 1e-13);
		check_near(quantile("beta", small, u), pow(u, 50.0), 1e-12);
	}
}

static void beta_quantiles_end_for_any_allowed_exponents(void **state)
{
	(void)state;
	for (double a = 0.01; a <= 1e4; a *= 10.0)
		for (double b = 0.01; b <= 1e4; b *= 10.0)
			for (double u = 0x1p-33; u < 1.0; u = u < 0.1 ? 32.0 * u : u + 0.1) {
				double p[4] = {a, b, 0.0, 1.0};
				double x = quantile("beta", p, u);
				assert_true(x >= 0.0 && x <= 1.0);
				// near an end one rounding of x changes P by P'(x) eps
				double below = x > 4.0 * DBL_MIN ? gsl_cdf_beta_P(nextafter(x, 0.0), a, b) : 0.0;
				double above = gsl_cdf_beta_P(nextafter(x, 1.0), a, b);
				assert_true(below <= u + 1e-11 && above >= u - 1e-11);
			}
}

/* Mean of a power of a variable, by Gauss quadrature over the normal deviate at which the quantile is taken. */
static double moment(const char *name, const double *p, int power)
{
	gsl_integration_glfixed_table *gauss = gsl_integration_glfixed_table_alloc(200);
	double sum = 0.0;
	for (size_t k = 0; k < 200; k++) {
		double z, w;
		gsl_integration_glfixed_point(-8.0, 8.0, k, &z, &w, gauss);
		sum += w * gsl_ran_ugaussian_pdf(z) * pow(quantile(name, p, gsl_cdf_ugaussian_P(z)), power);
	}
	gsl_integration_glfixed_table_free(gauss);
	return sum;
}

static void other_parameters_of_a_distribution_are_its_moments(void **state)
{
	(void)state;
	const struct {
		const char *name;
		double p[4], mean, cov;
	} cases[] = {
	    {"normal_cov", {2.0, 0.25}, 2.0, 0.25},
	    {"lognormal_cov", {3.0, 0.4}, 3.0, 0.4},
	    {"lognormal_median", {0.05, 0.6}, 0.05 * exp(0.18), sqrt(exp(0.36) - 1.0)},
	    {"gumbel",
	     {0.3, 0.1},
	     0.3 + 0.1 * 0.57721566490153286,
	     0.1 * 1.2825498301618641 / 0.35772156649015329},
	    {"gamma", {4.0, 0.5}, 2.0, 0.5},
	    {"weibull", {0.2, 2.0}, 0.2 * 0.88622692545275801, 0.52272320087706049},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		const double mean = moment(cases[k].name, cases[k].p, 1),
		             square = moment(cases[k].name, cases[k].p, 2);
		// the neglected probability beyond 8 deviations is 1e-15, times the values of a lognormal there; near 8, 1 -
		// P has one digit
		check_near(mean, cases[k].mean, 1e-9 * cases[k].mean);
		check_near(sqrt(square / (mean * mean) - 1.0), cases[k].cov, 1e-8);
	}
}

static void gamma_quantiles_end_for_any_allowed_shape(void **state)
{
	(void)state;
	for (double a = 0.1; a <= 1e4; a *= sqrt(10.0))
		for (double u = 0x1p-50; u < 1.0; u = u < 0.1   ? 32.0 * u
		                                      : u < 0.8 ? u + 0.1
		                                                : 1.0 - 0.1 * (1.0 - u)) {
			double p[4] = {fmin(a, 1e4), 1.0}, x = quantile("gamma", p, u);
			assert_true(x > 0.0 && x < INFINITY);
			check_near(gsl_cdf_gamma_P(x, p[0], 1.0), u, 1e-11);
		}
}

static void an_empirical_quantile_is_linear_between_the_values(void **state)
{
	(void)state;
	static const double values[] = {-1, 2, 2, 5, 7}, u[] = {0, 0.125, 0.25, 0.4, 0.5, 0.625, 0.75, 0.875, 1},
	                    x[] = {-1, 0.5, 2, 2, 2, 3.5, 5, 6, 7};
	struct pound_distribution d = {.type = row_named("empirical"), .n_values = 5, .values = values};
	for (int k = 0; k < 9; k++)
		check_near(pound_distribution_quantile(&d, u[k]), x[k], 4 * DBL_EPSILON);
	assert_string_equal(first_broken(&d), "");
	d.weights = values;
	assert_string_equal(first_broken(&d), "an empirical distribution has no weights");
	d = (struct pound_distribution){.type = d.type, .n_values = 2, .values = values + 1};
	assert_string_equal(first_broken(&d), "there must be two different values");
	static const double falling[] = {1, 3, 2};
	d = (struct pound_distribution){.type = d.type, .n_values = 3, .values = falling};
	assert_string_equal(first_broken(&d), "no value may be less than the one before");
}

static void a_truncated_normal_keeps_its_digits_far_in_the_tail(void **state)
{
	(void)state;
	const double p[4] = {0.0, 1.0, 20.0, 25.0};
	for (double u = 0.01; u < 1.0; u += 0.01) {
		double x = quantile("truncated_normal", p, u);
		double share = (gsl_cdf_ugaussian_Q(x) - gsl_cdf_ugaussian_Q(25.0)) /
		               (gsl_cdf_ugaussian_Q(20.0) - gsl_cdf_ugaussian_Q(25.0));
		// Q changes by x^2 times the relative change of x: 625 roundings
		check_near(share, 1.0 - u, 625.0 * 4.0 * DBL_EPSILON);
	}
}

static void the_support_is_given_by_the_parameters(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		double p[4], low, high;
	} cases[] = {
	    {"uniform", {0.1, 0.7}, 0.1, 0.7},
	    {"log_uniform", {0.1, 0.7}, 0.1, 0.7},
	    {"reciprocal_uniform", {3.3}, 1.0 / 3.3, 3.3},
	    {"normal", {1.0, 2.0}, -INFINITY, INFINITY},
	    {"truncated_normal", {1.0, 2.0, 0.1, 0.7}, 0.1, 0.7},
	    {"lognormal", {1.0, 2.0}, 0.0, INFINITY},
	    {"triangular", {0.1, 0.3, 0.7}, 0.1, 0.7},
	    {"beta", {2.0, 3.0, 0.1, 0.7}, 0.1, 0.7},
	    {"normal_cov", {1.0, 2.0}, -INFINITY, INFINITY},
	    {"lognormal_cov", {1.0, 2.0}, 0.0, INFINITY},
	    {"lognormal_median", {1.0, 2.0}, 0.0, INFINITY},
	    {"gumbel", {1.0, 2.0}, -INFINITY, INFINITY},
	    {"gamma", {2.0, 3.0}, 0.0, INFINITY},
	    {"weibull", {2.0, 3.0}, 0.0, INFINITY},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct pound_distribution distribution = {.type = row_named(cases[k].name)};
		memcpy(distribution.p, cases[k].p, sizeof distribution.p);
		double low, high;
		pound_distribution_support(&distribution, &low, &high);
		assert_true(low == cases[k].low && high == cases[k].high);
		for (double u = 0x1p-50; u < 1.0; u *= 1.01) {
			double x = pound_distribution_quantile(&distribution, u);
			double mirrored = pound_distribution_quantile(&distribution, 1.0 - u);
			assert_true(x >= low && x <= high && mirrored >= low && mirrored <= high);
		}
	}
	// discrete and empirical distributions have their own support
	assert_null(pound_distribution_name((int)(sizeof cases / sizeof cases[0]) + 2));
}

static void a_discrete_quantile_is_a_staircase_with_its_edges_at_the_cumulated_weights(void **state)
{
	(void)state;
	static const double values[] = {-1, 2, 5}, weights[] = {2, 1, 5}; // edges at 1/4 and 3/8
	const struct pound_distribution weighted = {
	    .type = row_named("discrete"), .n_values = 3, .values = values, .weights = weights};
	static const double u[] = {0, 0.1, 0.25, 0.2500001, 0.375, 0.3750001, 0.9, 1},
	                    x[] = {-1, -1, -1, 2, 2, 5, 5, 5};
	for (int k = 0; k < 8; k++)
		check_near(pound_distribution_quantile(&weighted, u[k]), x[k], 0);
	// equal weights: n values have n equal intervals, exactly as many of the rows of a Latin hypercube
	double many[16];
	for (int k = 0; k < 16; k++)
		many[k] = k;
	const struct pound_distribution alike = {.type = row_named("discrete"), .n_values = 16, .values = many};
	for (int i = 0; i < 160; i++)
		check_near(pound_distribution_quantile(&alike, (i + 0.5) / 160), i / 10, 0);
	double low, high;
	pound_distribution_support(&weighted, &low, &high);
	check_near(low, -1, 0);
	check_near(high, 5, 0);
}

static void lists_that_make_no_distribution_are_reported_in_words(void **state)
{
	(void)state;
	static const struct {
		double values[2], weights[2];
		const char *fault;
	} cases[] = {
	    {{1, 1}, {1, 1}, "every value must be greater than the one before"},
	    {{2, 1}, {1, 1}, "every value must be greater than the one before"},
	    {{1, 2}, {1, 1}, ""},
	    {{1, NAN}, {1, 1}, ""}, // with NAN no rule is known to be violated
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		const struct pound_distribution d = {.type = row_named("discrete"),
		                                     .n_values = 2,
		                                     .values = cases[k].values,
		                                     .weights = cases[k].weights};
		assert_string_equal(first_broken(&d), cases[k].fault);
	}
}

static void parameters_that_make_no_distribution_are_reported_in_words(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		double p[4];
		const char *fault;
	} cases[] = {
	    {"uniform", {1.0, 1.0}, "min must be less than max"},
	    {"uniform", {NAN, 1.0}, ""},
	    {"truncated_normal", {0.0, NAN, 1.0, 0.0}, "min must be less than max"},
	    {"log_uniform", {0.0, 1.0}, "min must be greater than 0"},
	    {"log_uniform", {2.0, 1.0}, "min must be less than max"},
	    {"reciprocal_uniform", {1.0}, "max must be greater than 1"},
	    {"normal", {0.0, 0.0}, "standard_deviation must be greater than 0"},
	    {"truncated_normal", {0.0, -1.0, 0.0, 1.0}, "standard_deviation must be greater than 0"},
	    {"truncated_normal", {0.0, 1.0, 1.0, 0.0}, "min must be less than max"},
	    {"truncated_normal",
	     {0.0, 1.0, 50.0, 60.0},
	     "min and max must not be too many standard deviations from the mean"},
	    {"lognormal", {0.0, 0.0}, "log_standard_deviation must be greater than 0"},
	    {"triangular", {0.0, 2.0, 1.0}, "mode must lie between min and max"},
	    {"triangular", {1.0, 1.0, 1.0}, "min must be less than max"},
	    {"beta", {0.0, 1.0, 0.0, 1.0}, "alpha must be in (0, 10000]"},
	    {"beta", {1.0, 1e5, 0.0, 1.0}, "beta must be in (0, 10000]"},
	    {"beta", {1.0, 1.0, 1.0, 0.0}, "min must be less than max"},
	    {"normal_cov", {0.0, 1.0}, "mean must not be 0"},
	    {"normal_cov", {1.0, 0.0}, "coefficient_of_variation must be greater than 0"},
	    {"lognormal_cov", {-1.0, 1.0}, "mean must be greater than 0"},
	    {"lognormal_median", {1.0, 0.0}, "dispersion must be greater than 0"},
	    {"gumbel", {1.0, 0.0}, "scale must be greater than 0"},
	    {"gamma", {0.01, 1.0}, "shape must be in [0.1, 10000]"},
	    {"weibull", {1.0, -1.0}, "shape must be greater than 0"},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct pound_distribution distribution = {.type = row_named(cases[k].name)};
		memcpy(distribution.p, cases[k].p, sizeof distribution.p);
		assert_string_equal(first_broken(&distribution), cases[k].fault);
	}
}

CHECK_MAIN(cmocka_unit_test(a_discrete_quantile_is_a_staircase_with_its_edges_at_the_cumulated_weights),
           cmocka_unit_test(lists_that_make_no_distribution_are_reported_in_words),
           cmocka_unit_test(every_quantile_inverts_its_distribution_function),
           cmocka_unit_test(quantiles_rise_with_the_probability),
           cmocka_unit_test(mass_ratio_quantiles_and_moments_are_those_of_the_closed_form),
           cmocka_unit_test(beta_quantiles_with_closed_forms_are_met),
           cmocka_unit_test(beta_quantiles_end_for_any_allowed_exponents),
           cmocka_unit_test(other_parameters_of_a_distribution_are_its_moments),
           cmocka_unit_test(gamma_quantiles_end_for_any_allowed_shape),
           cmocka_unit_test(an_empirical_quantile_is_linear_between_the_values),
           cmocka_unit_test(a_truncated_normal_keeps_its_digits_far_in_the_tail),
           cmocka_unit_test(the_support_is_given_by_the_parameters),
           cmocka_unit_test(parameters_that_make_no_distribution_are_reported_in_words))
