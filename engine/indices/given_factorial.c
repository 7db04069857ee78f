/* given_factorial.c - indices of a complete factorial design, by the analysis of variance.
 *
 *   C      combinations of the levels, each with r rows; all equally likely
 *   m_u    mean of the output over all combinations with the same levels of the inputs in the set u
 *   D_u    mean of m_u^2 over the combinations, outputs centered: the closed variance of u, plus noise
 *   t      variance of the noise of the mean of a combination, averaged over the combinations
 *   L_u    number of combinations of the levels of u
 *
 *   E[D_u] = closed variance of u + t (L_u - 1) / C
 *
 * If all variance is noise, C D_all / (C - 1) over t has the F distribution with C - 1 and f degrees of freedom, f those of t.
 *
 * The means are over all combinations, not over drawn samples: without noise the indices are exact.  Every index is a sum of
 * closed variances over the variance of all inputs; its interval is by its derivatives with respect to the means of the
 * combinations (delta method), by the squares of their noise, and by the error of t.
 *
 * With one row for each combination t is not known.  S1 is then a share of the variance with the noise; interactions of the highest
 * order (three inputs or more; two, if there are only two) take the place of the noise, and the interval includes S1 without this
 * correction. */
#include "engine/indices/given_factorial.h"

#include <float.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "engine/indices/indices.h"

// level of the test whether all is noise: a normal deviate of 2, one-sided
static const double NOISE_LEVEL = 0.025;

struct factorial {
	const struct pound_given *given;
	int cells;
	double *mean, *noise; /* of each combination: centered mean, variance of its noise  (cells) each */
	double *derivative;   /* (cells) */
	double *sum;          /* of the combinations of a set's levels  (at most cells) */
	double variance;      /* of the output, without noise if it is known */
	double t, freedom;    /* mean of noise; degrees of freedom that it is estimated from */
};

/* A closed variance with its sign in an index. */
struct term {
	unsigned inputs;
	double sign;
};

size_t pound_factorial_scratch(int n_rows)
{
	return 4 * (size_t)n_rows;
}

bool pound_factorial_noise_known(const struct pound_given *given)
{
	return given->noise_known || given->replicates > 1;
}

static unsigned all_inputs(const struct pound_given *given)
{
	return given->n_inputs < 32 ? (1u << given->n_inputs) - 1u : ~0u;
}

static int levels_of(const struct pound_given *given, unsigned inputs)
{
	int levels = 1;
	for (int j = 0; j < given->n_inputs; j++)
		levels *= inputs >> j & 1 ? given->levels[j] : 1;
	return levels;
}

/* Number of the combination of a set's levels in a combination of all levels. */
static int place_of(const struct pound_given *given, unsigned inputs, int cell)
{
	int place = 0;
	for (int j = given->n_inputs - 1, stride = 1; j >= 0; j--) {
		const int level = cell % given->levels[j];
		cell /= given->levels[j];
		if (inputs >> j & 1) {
			place += level * stride;
			stride *= given->levels[j];
		}
	}
	return place;
}

/* The closed variance of a set, noise included; adds sign * m_u to the derivative of each combination. */
static double closed(const struct factorial *f, struct term term)
{
	const int levels = levels_of(f->given, term.inputs);
	double square = 0.0;
	memset(f->sum, 0, sizeof *f->sum * (size_t)levels);
	for (int c = 0; c < f->cells; c++)
		f->sum[place_of(f->given, term.inputs, c)] += f->mean[c] * levels / f->cells;
	for (int k = 0; k < levels; k++)
		square += f->sum[k] * f->sum[k] / levels;
	for (int c = 0; c < f->cells; c++)
		f->derivative[c] += term.sign * f->sum[place_of(f->given, term.inputs, c)];
	return square;
}

/* An index, the sum of closed variances over the variance, with its interval.  uncorrected: with the noise in it. */
static struct pound_estimate index_of(const struct factorial *f, const struct term *terms, int n,
                                      double *uncorrected)
{
	double part = 0.0, levels = 0.0, square = 0.0;
	memset(f->derivative, 0, sizeof *f->derivative * (size_t)f->cells);
	for (int k = 0; k < n; k++) {
		part += terms[k].sign * closed(f, terms[k]);
		levels += terms[k].sign * (levels_of(f->given, terms[k].inputs) - 1.0);
	}
	const double share = levels / f->cells, value = (part - f->t * share) / f->variance;
	for (int c = 0; c < f->cells; c++) {
		const double derivative = 2.0 * (f->derivative[c] - value * f->mean[c]) / (f->cells * f->variance);
		square += derivative * derivative * f->noise[c];
	}
	const double noise = f->t / f->cells / f->variance,
	             of_noise = (levels - value * (f->cells - 1.0)) * noise,
	             squares = (1.0 - value) * (1.0 - value) * levels + value * value * (f->cells - 1.0 - levels);
	square += f->freedom > 0.0 ? of_noise * of_noise * 2.0 / f->freedom : 0.0;
	// the derivatives are zero at an effect of zero, but the square of its noise is not
	square += 2.0 * squares * noise * noise;
	const double half = POUND_NORMAL_95 * sqrt(square);
	*uncorrected = part / f->variance;
	return (struct pound_estimate){value, value - half, value + half};
}

static void means_fill(struct factorial *f, const struct pound_given_output *output)
{
	const int n = f->given->n_rows, r = f->given->replicates;
	double grand = 0.0;
	memset(f->mean, 0, sizeof *f->mean * (size_t)f->cells);
	memset(f->noise, 0, sizeof *f->noise * (size_t)f->cells);
	for (int i = 0; i < n; i++)
		grand += (output->y[i] - output->y[0]) / n;
	for (int i = 0; i < n; i++)
		f->mean[f->given->cell[i]] += (output->y[i] - output->y[0] - grand) / r;
	for (int i = 0; i < n; i++) {
		const double off = output->y[i] - output->y[0] - grand - f->mean[f->given->cell[i]];
		if (r > 1)
			f->noise[f->given->cell[i]] += off * off / (r - 1.0) / r;
		else
			f->noise[f->given->cell[i]] = output->noise ? output->noise[i] : 0.0;
	}
	for (int c = 0; c < f->cells; c++)
		f->t += f->noise[c] / f->cells;
	f->freedom = (double)f->cells * (r > 1 ? r - 1 : 1);
}

/* Whether the variance of the means may be that of their noise alone, by an F test. */
static bool noise_alone(const struct factorial *f, double all)
{
	const double between = all * f->cells / (f->cells - 1.0);
	return f->t > 0.0 && gsl_cdf_fdist_Q(between / f->t, f->cells - 1.0, f->freedom) > NOISE_LEVEL;
}

/* Takes the mean square of the interactions of the highest order as the noise. */
static void interactions_take(struct factorial *f)
{
	const int d = f->given->n_inputs;
	double rest = f->variance, freedom = f->cells - 1.0, own[POUND_INPUTS_MAX];
	for (int i = 0; i < d; i++) {
		own[i] = closed(f, (struct term){1u << i, 0.0});
		rest -= own[i];
		freedom -= f->given->levels[i] - 1.0;
	}
	for (int i = 0; i < d && d > 2; i++)
		for (int j = i + 1; j < d; j++) {
			rest -= closed(f, (struct term){1u << i | 1u << j, 0.0}) - own[i] - own[j];
			freedom -= (f->given->levels[i] - 1.0) * (f->given->levels[j] - 1.0);
		}
	f->freedom = freedom;
	f->t = freedom > 0.0 ? fmax(0.0, rest) * f->cells / freedom : 0.0;
	for (int c = 0; c < f->cells; c++)
		f->noise[c] = f->t;
}

static void first_fill(const struct factorial *f, struct pound_given_indices *indices)
{
	const bool known = pound_factorial_noise_known(f->given);
	for (int j = 0; j < f->given->n_inputs; j++) {
		double uncorrected;
		struct pound_estimate *first = &indices->first[j];
		*first = index_of(f, &(struct term){1u << j, 1.0}, 1, &uncorrected);
		first->high = known ? first->high : fmax(first->high, uncorrected);
	}
}

/* Total and second-order indices. */
static void others_fill(const struct factorial *f, struct pound_given_indices *indices)
{
	const int d = f->given->n_inputs;
	const unsigned all = all_inputs(f->given);
	double uncorrected;
	indices->n_second = 0;
	for (int i = 0; i < d; i++) {
		const struct term total[] = {{all, 1.0}, {all & ~(1u << i), -1.0}};
		indices->total[i] = index_of(f, total, 2, &uncorrected);
		for (int j = i + 1; j < d; j++) {
			const struct term second[] = {{1u << i | 1u << j, 1.0}, {1u << i, -1.0}, {1u << j, -1.0}};
			indices->second[indices->n_second++] =
			    (struct pound_set_index){second[0].inputs, index_of(f, second, 3, &uncorrected)};
		}
	}
}

/* The indices of a complete factorial design.
 *
 * Given    given      replicates > 0
 *          output     -
 * Returns  indices    variance, noise_share, both of the means of the combinations; first; total and second if the noise is known
 *          value      whether the variance of the means is larger than that of their noise alone would be
 * Memory   scratch    (pound_factorial_scratch)
 *
 * Valid    The distribution of the inputs is the design's: its levels, equally likely.  Normal noise of each row for the intervals
 * Source   Searle, Casella, McCulloch 1992, Variance Components, chapter 4, for the expected mean squares
 * Test     unit_given_repeats: a_factorial_design_has_the_indices_of_its_levels
 */
bool pound_factorial_indices(const struct pound_given *given, const struct pound_given_output *output,
                             double *scratch, struct pound_given_indices *indices)
{
	const int cells = given->n_rows / given->replicates;
	const bool known = pound_factorial_noise_known(given);
	struct factorial f = {.given = given,
	                      .cells = cells,
	                      .mean = scratch,
	                      .noise = scratch + cells,
	                      .derivative = scratch + 2 * (size_t)cells,
	                      .sum = scratch + 3 * (size_t)cells};
	double all = 0.0;
	means_fill(&f, output);
	for (int c = 0; c < cells; c++)
		all += f.mean[c] * f.mean[c] / cells;
	f.variance = all - f.t * (cells - 1.0) / cells;
	indices->variance = all * cells / (cells - 1.0);
	indices->noise_share = known ? f.t * (cells - 1.0) / cells / all : NAN;
	if (noise_alone(&f, all))
		return false;
	if (!known)
		interactions_take(&f);
	first_fill(&f, indices);
	if (known)
		others_fill(&f, indices);
	return true;
}
