/* distribution.c - the distributions of inputs by name, each defined by its quantile function; of a discrete distribution
 * this is a step function.
 *
 * A quantile takes u in [0, 1]; u = 0 and u = 1 give the ends of the support, exactly if these are parameters. */
#include "engine/pound.h"

#include <assert.h>
#include <float.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>

enum { RULES_MAX = 3 };

/* A condition on the parameters of a distribution.  A parameter that is NAN breaks no rule. */
struct rule {
	const char *text;
	bool (*broken)(const struct pound_distribution *d);
};

struct distribution {
	const char *name;
	const char *parameters[5]; /* names, up to the first NULL */
	struct rule rules[RULES_MAX + 1];
	double (*quantile)(const double *p, double u);
	double (*listed)(const struct pound_distribution *d,
	                 double u); /* in place of `quantile`, if the study lists the values */
};

static double within(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

// whether a lower limit is not below the upper one: parameters 0 and 1, 2 and 3, or 0 and 2
static bool no_range(const struct pound_distribution *d)
{
	return d->p[0] >= d->p[1];
}

static bool no_range_last(const struct pound_distribution *d)
{
	return d->p[2] >= d->p[3];
}

static bool no_range_outer(const struct pound_distribution *d)
{
	return d->p[0] >= d->p[2];
}

static double uniform(const double *p, double u)
{
	return within((1.0 - u) * p[0] + u * p[1], p[0], p[1]);
}

static bool first_not_positive(const struct pound_distribution *d)
{
	return d->p[0] <= 0.0;
}

static double log_uniform(const double *p, double u)
{
	return within(pow(p[0], 1.0 - u) * pow(p[1], u), p[0], p[1]);
}

static bool max_not_over_one(const struct pound_distribution *d)
{
	return d->p[0] <= 1.0;
}

/* Quantile of a ratio that has the same distribution as its inverse and is uniform above 1.
 *
 * Given    p         (1)       -       max, the largest ratio M  > 1
 *          u         -         -       probability [0, 1]
 * Returns  value     r         -       [1/M, M]
 *
 *   pdf  1 / (2 (M-1)) on [1, M],   1 / (2 (M-1) r^2) on [1/M, 1]
 *
 * Source   mass ratio of the pounding study, M = 6
 * Test     unit_distribution: mass_ratio_quantiles_and_moments_are_those_of_the_closed_form
 */
static double reciprocal_uniform(const double *p, double u)
{
	double larger = p[0] - 2.0 * (p[0] - 1.0) * fmin(u, 1.0 - u);
	return u < 0.5 ? 1.0 / larger : larger;
}

static bool no_deviation(const struct pound_distribution *d)
{
	return d->p[1] <= 0.0;
}

static double normal(const double *p, double u)
{
	return p[0] + p[1] * gsl_cdf_ugaussian_Pinv(u);
}

static bool too_far_out(const struct pound_distribution *d)
{
	double a = (d->p[2] - d->p[0]) / d->p[1], b = (d->p[3] - d->p[0]) / d->p[1];
	if (!(d->p[1] > 0.0 && a < b))
		return false;
	double kept = a < 0.0 ? gsl_cdf_ugaussian_P(b) - gsl_cdf_ugaussian_P(a)
	                      : gsl_cdf_ugaussian_Q(a) - gsl_cdf_ugaussian_Q(b);
	// a smaller probability has too few digits in double precision
	return kept <= DBL_MIN / DBL_EPSILON;
}

/* Quantile of a normal variable truncated to [min, max].
 *
 * Given    p         (4)       -       mean, standard deviation, min, max
 *          u         -         -       probability [0, 1]
 * Returns  value     x         -       [min, max]
 *
 * With a, b the standardized bounds, P(z) = (1-u) P(a) + u P(b) and likewise for Q = 1 - P.  The smaller of P and Q is
 * inverted: it keeps its digits, so both tails are as accurate as the middle.
 *
 * Test     unit_distribution: every_quantile_inverts_its_distribution_function
 */
static double truncated_normal(const double *p, double u)
{
	double a = (p[2] - p[0]) / p[1], b = (p[3] - p[0]) / p[1];
	double lower = (1.0 - u) * gsl_cdf_ugaussian_P(a) + u * gsl_cdf_ugaussian_P(b);
	double upper = (1.0 - u) * gsl_cdf_ugaussian_Q(a) + u * gsl_cdf_ugaussian_Q(b);
	double z = lower < upper ? gsl_cdf_ugaussian_Pinv(lower) : gsl_cdf_ugaussian_Qinv(upper);
	if (u == 0.0 || u == 1.0)
		return u == 0.0 ? p[2] : p[3];
	return within(p[0] + p[1] * z, p[2], p[3]);
}

static double lognormal(const double *p, double u)
{
	return exp(normal(p, u));
}

static bool first_zero(const struct pound_distribution *d)
{
	return d->p[0] == 0.0;
}

static bool second_not_positive(const struct pound_distribution *d)
{
	return d->p[1] <= 0.0;
}

static double normal_cov(const double *p, double u)
{
	return normal((const double[]){p[0], fabs(p[0]) * p[1]}, u);
}

/* Quantile of a lognormal variable with a given mean and coefficient of variation V.
 *
 *   s^2 = log(1 + V^2),  log-mean log(mean) - s^2 / 2
 *
 * Test     unit_distribution: other_parameters_of_a_distribution_are_its_moments
 */
static double lognormal_cov(const double *p, double u)
{
	const double variance = log1p(p[1] * p[1]);
	return exp(normal((const double[]){log(p[0]) - 0.5 * variance, sqrt(variance)}, u));
}

static double lognormal_median(const double *p, double u)
{
	return p[0] * exp(p[1] * gsl_cdf_ugaussian_Pinv(u));
}

/* Gumbel distribution of largest values: P(x) = exp(-exp(-(x - location) / scale)). */
static double gumbel(const double *p, double u)
{
	return p[0] - p[1] * log(-log(u));
}

/* P(x) = 1 - exp(-(x / scale)^shape). */
static double weibull(const double *p, double u)
{
	return p[0] * pow(-log1p(-u), 1.0 / p[1]);
}

static bool mode_outside(const struct pound_distribution *d)
{
	return d->p[0] < d->p[2] && (d->p[1] < d->p[0] || d->p[1] > d->p[2]);
}

static double triangular(const double *p, double u)
{
	double width = p[2] - p[0];
	double c = (p[1] - p[0]) / width;
	return u < c ? p[0] + width * sqrt(u * c) : p[2] - width * sqrt((1.0 - u) * (1.0 - c));
}

enum { BETA_MAX = 10000 }; // largest exponent for which GSL's continued fraction always converges

static bool alpha_outside(const struct pound_distribution *d)
{
	return d->p[0] <= 0.0 || d->p[0] > BETA_MAX;
}

static bool beta_outside(const struct pound_distribution *d)
{
	return d->p[1] <= 0.0 || d->p[1] > BETA_MAX;
}

/* A distribution on (0, most) with two parameters: P, Q = 1 - P, and the density. */
struct standard {
	double (*below)(double x, double a, double b), (*above)(double x, double a, double b),
	    (*density)(double x, double a, double b);
	double a, b, most;
};

/* Quantile of a standard distribution.
 *
 * Given    start     -         -       first x of the iteration
 *          p, q      -         -       probability (0, 1) and its complement
 * Returns  value     x         -       (0, most)
 *
 * Newton's method for log P, or log Q if that is smaller, as a function of log x, which is nearly linear for small x
 * (P ~ x^a); a bracket limits the steps.  GSL's inverses call the error handler if their iterations do not converge; this one
 * always ends.
 *
 * Valid    beta: full relative accuracy for x <= 1/2; for larger x compute 1 - x with (b, a, q, p)
 * Test     unit_distribution: beta_quantiles_end_for_any_allowed_exponents, gamma_quantiles_end_for_any_allowed_shape
 */
static double inverse(const struct standard *s, double start, double p, double q)
{
	double low = DBL_MIN, high = s->most, x = start;
	for (int k = 0; k < 100; k++) {
		double tail = p < q ? s->below(x, s->a, s->b) : s->above(x, s->a, s->b);
		double excess = p < q ? log(tail / p) : log(q / tail); // > 0: x is too large
		if (excess > 0.0)
			high = x;
		else
			low = x;
		double next = x * exp(-excess * tail / (x * s->density(x, s->a, s->b)));
		if (!(next > low && next < high))
			next = sqrt(low) * sqrt(high);
		if (fabs(next - x) <= 4.0 * DBL_EPSILON * x)
			return next;
		x = next;
	}
	return x;
}

/* Quantile of the standard beta distribution with exponents a and b. */
static double beta_standard(double a, double b, double p, double q)
{
	const struct standard s = {gsl_cdf_beta_P, gsl_cdf_beta_Q, gsl_ran_beta_pdf, a, b, 1.0};
	return inverse(&s, a / (a + b), p, q);
}

enum { SHAPE_MAX = 10000 };
static const double SHAPE_MIN = 0.1; // with a smaller shape, quantiles near u = 0 underflow

static bool shape_outside(const struct pound_distribution *d)
{
	return d->p[0] < SHAPE_MIN || d->p[0] > SHAPE_MAX;
}

/* Quantile of a gamma distribution of shape a.
 *
 * The bracket ends at a + sqrt(2 c (a + c)) + c, c = 745: from there on Q(a, x) < exp(-(x - a)^2 / (2 x)) < 5e-324, which is 0
 * in double precision.
 */
static double gamma_quantile(const double *p, double u)
{
	const double c = 745.0, most = p[0] + sqrt(2.0 * c * (p[0] + c)) + c;
	const struct standard s = {gsl_cdf_gamma_P, gsl_cdf_gamma_Q, gsl_ran_gamma_pdf, p[0], 1.0, most};
	return u == 0.0 ? 0.0 : u == 1.0 ? INFINITY : p[1] * inverse(&s, p[0], u, 1.0 - u);
}

static double beta(const double *p, double u)
{
	if (u == 0.0 || u == 1.0)
		return u == 0.0 ? p[2] : p[3];
	double width = p[3] - p[2];
	double x = u < gsl_cdf_beta_P(0.5, p[0], p[1]) ? p[2] + width * beta_standard(p[0], p[1], u, 1.0 - u)
	                                               : p[3] - width * beta_standard(p[1], p[0], 1.0 - u, u);
	return within(x, p[2], p[3]);
}

static bool not_ascending(const struct pound_distribution *d)
{
	for (int k = 1; k < d->n_values; k++)
		if (d->values[k] <= d->values[k - 1])
			return true;
	return false;
}

/* Sum of the weights of the first n values. */
static double weight_of(const struct pound_distribution *d, int n)
{
	double sum = 0.0;
	for (int k = 0; k < n; k++)
		sum += d->weights ? d->weights[k] : 1.0;
	return sum;
}

/* Index of the value of a discrete variable at a probability.
 *
 * Returns  value     k         -       the smallest with w_0 + ... + w_k >= u (w_0 + ... + w_(n-1))
 *
 * Test     unit_distribution: a_discrete_quantile_is_a_staircase_with_its_edges_at_the_cumulated_weights
 */
int pound_distribution_level(const struct pound_distribution *distribution, double u)
{
	const double total = weight_of(distribution, distribution->n_values);
	double below = 0.0;
	int k = 0;
	for (; k < distribution->n_values - 1; k++) {
		below += distribution->weights ? distribution->weights[k] : 1.0;
		if (u * total <= below)
			break;
	}
	return k;
}

static double discrete(const struct pound_distribution *d, double u)
{
	return d->values[pound_distribution_level(d, u)];
}

static bool descends(const struct pound_distribution *d)
{
	bool does = false;
	for (int k = 1; k < d->n_values; k++)
		does |= d->values[k] < d->values[k - 1];
	return does;
}

static bool is_one_value(const struct pound_distribution *d)
{
	return d->n_values == 1 || (d->n_values > 1 && d->values[0] == d->values[d->n_values - 1]);
}

static bool has_weights(const struct pound_distribution *d)
{
	return d->weights;
}

/* Quantile of a sample: linear between its values, the first one for u = 0 and the last one for u = 1.
 *
 * Source   type 7 of Hyndman and Fan 1996, Am. Stat. 50, 361; the default of R and NumPy, and GSL's
 * Test     unit_distribution: an_empirical_quantile_is_linear_between_the_values
 */
static double empirical(const struct pound_distribution *d, double u)
{
	return gsl_stats_quantile_from_sorted_data(d->values, 1, (size_t)d->n_values, u);
}

/* Probability that a discrete variable has a value before number k. */
double pound_distribution_below(const struct pound_distribution *distribution, int k)
{
	return weight_of(distribution, k) / weight_of(distribution, distribution->n_values);
}

// clang-format off
#define MIN_MAX    "min must be less than max"
#define DEVIATION  "standard_deviation must be greater than 0"
#define COV        "coefficient_of_variation"

static const struct distribution distributions[] = {
	{"uniform",            {"min", "max"},                               {{MIN_MAX, no_range}}, uniform, NULL},
	{"log_uniform",        {"min", "max"},                               {{"min must be greater than 0", first_not_positive},
	                                                                      {MIN_MAX, no_range}}, log_uniform, NULL},
	{"reciprocal_uniform", {"max"},                                      {{"max must be greater than 1", max_not_over_one}},
	                                                                     reciprocal_uniform, NULL},
	{"normal",             {"mean", "standard_deviation"},               {{DEVIATION, no_deviation}}, normal, NULL},
	{"truncated_normal",   {"mean", "standard_deviation", "min", "max"}, {{DEVIATION, no_deviation}, {MIN_MAX, no_range_last},
	                        {"min and max must not be too many standard deviations from the mean", too_far_out}}, truncated_normal, NULL},
	{"lognormal",          {"log_mean", "log_standard_deviation"},       {{"log_" DEVIATION, no_deviation}}, lognormal, NULL},
	{"triangular",         {"min", "mode", "max"},                       {{MIN_MAX, no_range_outer},
	                                                                      {"mode must lie between min and max", mode_outside}},
	                                                                     triangular, NULL},
	{"beta",               {"alpha", "beta", "min", "max"},              {{"alpha must be in (0, 10000]", alpha_outside},
	                        {"beta must be in (0, 10000]", beta_outside}, {MIN_MAX, no_range_last}}, beta, NULL},
	{"discrete",           {NULL},                                       {{"every value must be greater than the one before",
	                                                                       not_ascending}}, NULL, discrete},
	{"normal_cov",         {"mean", COV},                                {{"mean must not be 0", first_zero},
	                                                                      {COV " must be greater than 0", second_not_positive}}, normal_cov, NULL},
	{"lognormal_cov",      {"mean", COV},                                {{"mean must be greater than 0", first_not_positive},
	                                                                      {COV " must be greater than 0", second_not_positive}}, lognormal_cov, NULL},
	{"lognormal_median",   {"median", "dispersion"},                     {{"median must be greater than 0", first_not_positive},
	                                                                      {"dispersion must be greater than 0", second_not_positive}}, lognormal_median, NULL},
	{"gumbel",             {"location", "scale"},                        {{"scale must be greater than 0", second_not_positive}}, gumbel, NULL},
	{"gamma",              {"shape", "scale"},                           {{"shape must be in [0.1, 10000]", shape_outside},
	                                                                      {"scale must be greater than 0", second_not_positive}}, gamma_quantile, NULL},
	{"weibull",            {"scale", "shape"},                           {{"scale must be greater than 0", first_not_positive},
	                                                                      {"shape must be greater than 0", second_not_positive}}, weibull, NULL},
	{"empirical",          {NULL},                                       {{"no value may be less than the one before", descends},
	                                                                      {"there must be two different values", is_one_value},
	                                                                      {"an empirical distribution has no weights", has_weights}}, NULL, empirical},
};
// clang-format on

enum { DISTRIBUTIONS = sizeof distributions / sizeof distributions[0] };

const char *pound_distribution_name(int row)
{
	return row >= 0 && row < DISTRIBUTIONS ? distributions[row].name : NULL;
}

const char *pound_distribution_parameter(int row, int k)
{
	assert(row >= 0 && row < DISTRIBUTIONS && k >= 0 && k <= 4);
	return distributions[row].parameters[k];
}

/* Whether a distribution is given by a list of values, not by parameters. */
bool pound_distribution_lists_values(int row)
{
	return distributions[row].listed;
}

bool pound_distribution_steps(int row)
{
	return distributions[row].listed == discrete;
}

const char *pound_distribution_rule(int row, int k)
{
	assert(row >= 0 && row < DISTRIBUTIONS && k >= 0 && k <= RULES_MAX);
	return distributions[row].rules[k].text;
}

bool pound_distribution_breaks(const struct pound_distribution *distribution, int k)
{
	assert(pound_distribution_rule(distribution->type, k));
	return distributions[distribution->type].rules[k].broken(distribution);
}

/* Quantile of a distribution.
 *
 * Given    distribution  -     -             breaks no rule
 *          u             -     -             probability [0, 1]
 * Returns  value         -     the input's   u = 0 and u = 1: the ends of the support (infinite for a normal)
 *
 * Test     unit_distribution: every_quantile_inverts_its_distribution_function
 */
double pound_distribution_quantile(const struct pound_distribution *distribution, double u)
{
	assert(u >= 0.0 && u <= 1.0);
	const struct distribution *row = &distributions[distribution->type];
	return row->quantile ? row->quantile(distribution->p, u) : row->listed(distribution, u);
}

void pound_distribution_support(const struct pound_distribution *distribution, double *low, double *high)
{
	*low = pound_distribution_quantile(distribution, 0.0);
	*high = pound_distribution_quantile(distribution, 1.0);
}
