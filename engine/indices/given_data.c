/* given_data.c - sensitivity indices from given data.
 *
 * 1. An input is replaced by its rank among the samples, which is uniform whatever the distribution.  An input with few
 *    values, each of which occurs often, is discrete (given_repeats.c).  Rows are shuffled: their order is used for one check only.
 * 2. The samples are checked: inputs must be independent of each other (rank correlation, and chi-square of the table of
 *    two inputs), and samples near in one input may be near in the others by chance only.
 * 3. S1 is from local_regression.c or from the polynomial (given_polynomial.c), whichever has the narrower interval; ST and
 *    S2 are from the polynomial, with an interval that includes the unexplained variance fraction.  Those of a complete factorial
 *    design are by the analysis of variance (given_factorial.c).
 * 4. Conditional means are the polynomial's plus its residual's (conditional_mean.c). */
#include "engine/given.h"

#include <assert.h>
#include <float.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <string.h>

#include "engine/indices/given_factorial.h"
#include "engine/indices/given_polynomial.h"
#include "engine/indices/indices.h"
#include "engine/numeric/random.h"

enum {
	CELLS_MAX = 8,      // per side, of the table of two inputs
	ROWS_PER_CELL = 10, // on average
	LAGS = 10,          // neighbors checked
	PLACES = 2, // u of a sample is stored twice: local_regression.c and conditional_mean.c read A and B
};

// limits of the checks in standard errors: with hundreds (thousands) of normal deviates, 1 % of sample sets fail by chance
static const double DEPENDENT = 4.0, ARRANGED = 5.0, PAIR_MOST = 2.0;
static const double COLLINEAR = 0.99;      // rank correlation
static const double EXPLAINED_LEAST = 0.9; // least R2 for ST to be estimated
// coverage of S1 by the effective rows of the variance, n / kurtosis: engine/indices/statistics.md
static const double ROWS_BEHIND = 50.0, KURTOSIS_MOST = 20.0;

/* ---- the scratch ---- */

/* Rows are shuffled, so that neither the samples of a fold nor the neighbors among equal values depend on the order of the lines. */
struct space {
	double *u;     /* (n_rows x PLACES x n_inputs) */
	double *y;     /* output less its mean  (n_rows) */
	double *noise; /* standard deviation of its noise, 0: not known  (n_rows) */
	int64_t *row;  /* (n_rows) */
	size_t *order; /* (n_rows) */
	size_t *place; /* of each given row, after the shuffle  (n_rows) */
	double *rest;
};

static size_t carve(struct space *s, double *scratch, int n_rows, int n_inputs)
{
	const size_t n = n_rows;
	const struct pound_sample_values shape = {.n_rows = n_rows, .n_inputs = n_inputs, .n_signals = 1};
	const size_t sizes[] = {pound_local_regression_scratch(&shape), pound_conditional_scratch(n_rows),
	                        pound_factorial_scratch(n_rows)};
	const size_t polynomial = pound_polynomial_scratch(n_rows, n_inputs);
	size_t most = 0;
	for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
		most = sizes[k] > most ? sizes[k] : most;
	if (s) {
		s->u = scratch;
		s->y = s->u + n * PLACES * n_inputs;
		s->noise = s->y + n;
		s->row = (int64_t *)(s->noise + n);
		s->order = (size_t *)(s->row + n);
		s->place = s->order + n;
		s->rest = scratch + n * PLACES * n_inputs + 5 * n;
	}
	// the fit is kept at the start, the other steps use the memory behind it
	return n * PLACES * n_inputs + 5 * n + polynomial + most;
}

size_t pound_given_scratch(int n_rows, int n_inputs)
{
	return carve(NULL, NULL, n_rows, n_inputs);
}

/* A permutation of the rows, always the same for the same number (Fisher and Yates). */
static void shuffle(const struct space *s, int n)
{
	const struct pound_stream stream = {.what = POUND_STREAM_SHUFFLE};
	for (int i = 0; i < n; i++)
		s->place[i] = (size_t)i;
	for (int i = n - 1; i > 0; i--) {
		const uint32_t k = pound_random_below(stream, (uint32_t)i, (uint32_t)i + 1u);
		const size_t place = s->place[i];
		s->place[i] = s->place[k];
		s->place[k] = place;
	}
}

/* Probabilities of the samples: ranks in (0, 1), mid-ranks for ties. */
static void places_fill(const struct pound_given *given, const struct space *s)
{
	const int n = given->n_rows, d = given->n_inputs;
	for (int j = 0; j < d; j++) {
		gsl_sort_index(s->order, given->x + j, (size_t)d, (size_t)n);
		for (int first = 0, end; first < n; first = end) {
			const double x = given->x[s->order[first] * (size_t)d + j];
			for (end = first; end < n && given->x[s->order[end] * (size_t)d + j] == x;)
				end++;
			for (int k = first; k < end; k++)
				for (int matrix = 0; matrix < PLACES; matrix++)
					s->u[(s->place[s->order[k]] * PLACES + matrix) * (size_t)d + j] = 0.5 * (first + end) / n;
		}
	}
}

/* ---- the checks ---- */

static double rank_of(const struct space *s, int n_inputs, size_t row, int input)
{
	return s->u[row * PLACES * (size_t)n_inputs + input] - 0.5;
}

/* Correlation of the ranks of two inputs (Spearman's). */
static double correlation(const struct space *s, int n, int d, int i, int j)
{
	double ii = 0.0, jj = 0.0, ij = 0.0;
	for (int k = 0; k < n; k++) {
		const double p = rank_of(s, d, k, i), q = rank_of(s, d, k, j);
		ii += p * p;
		jj += q * q;
		ij += p * q;
	}
	return ij / sqrt(ii * jj);
}

/* Whether the table of two inputs' ranks is filled unevenly.
 *
 * Given    correlated  variance of a count over that of independent rows
 * Returns  value       Pearson's chi-square exceeds DEPENDENT standard normal deviates
 *
 * Source   Wilson and Hilferty 1931, Proc. Natl. Acad. Sci. 17, 684: (chi2 / f)^(1/3) is normal with mean 1 - 2/(9 f) and
 *          variance 2/(9 f); here chi2 / f is compared with the cube of the limit
 */
static bool uneven(const struct space *s, int n, int d, const int pair[2], double correlated)
{
	int side = 2, table[CELLS_MAX][CELLS_MAX] = {0}, across[CELLS_MAX] = {0}, down[CELLS_MAX] = {0}, rows = 0,
	    columns = 0;
	while (side < CELLS_MAX && (side + 1) * (side + 1) * ROWS_PER_CELL <= n)
		side++;
	for (int k = 0; k < n; k++) {
		const int p = (int)((rank_of(s, d, k, pair[0]) + 0.5) * side),
		          q = (int)((rank_of(s, d, k, pair[1]) + 0.5) * side);
		table[p][q]++;
		across[p]++;
		down[q]++;
	}
	double chi = 0.0;
	for (int p = 0; p < side; p++) {
		rows += across[p] > 0;
		columns += down[p] > 0;
		for (int q = 0; q < side; q++) {
			const double expected = (double)across[p] * down[q] / n;
			if (expected > 0.0)
				chi += (table[p][q] - expected) * (table[p][q] - expected) / expected;
		}
	}
	const double freedom = (rows - 1.0) * (columns - 1.0);
	if (freedom < 1.0)
		return false;
	const double v = 2.0 / (9.0 * freedom), root = 1.0 - v + DEPENDENT * sqrt(v);
	return chi / correlated / freedom > root * root * root;
}

/* Sum of the products of an input's ranks at samples `lag` apart in the order. */
static double lagged(const struct space *s, int n, int d, int j, int lag)
{
	double sum = 0.0;
	for (int k = 0; k + lag < n; k++)
		sum += rank_of(s, d, s->order[k], j) * rank_of(s, d, s->order[k + lag], j);
	return sum;
}

/* Whether neighbors in one input (the order) are correlated in input j.  Ranks of random samples have no correlation at any
 * lag; with dependent inputs the correlation is nearly the same at all small lags.  An input with a rare value is not checked if a
 * single pair of rows with it changes a correlation by more than PAIR_MOST standard errors. */
static bool arranged(const struct space *s, int n, int d, int j)
{
	const double limit = ARRANGED * sqrt((1.0 + 1.0 / LAGS) / n);
	double square = 0.0, further = 0.0, largest = 0.0;
	for (int k = 0; k < n; k++) {
		const double rank = rank_of(s, d, k, j);
		square += rank * rank;
		largest = fmax(largest, rank * rank);
	}
	if (largest * sqrt(n) > PAIR_MOST * square)
		return false;
	for (int lag = LAGS + 1; lag <= 2 * LAGS; lag++)
		further += lagged(s, n, d, j, lag) / LAGS;
	for (int lag = 1; lag <= LAGS; lag++)
		if (fabs(lagged(s, n, d, j, lag) - further) > limit * square)
			return true;
	return false;
}

static bool arranged_by_any(const struct pound_given *given, const struct space *s)
{
	const int n = given->n_rows, d = given->n_inputs;
	for (int i = 0; i < d; i++) {
		// a discrete input uses means at its values, not neighbors
		if (pound_conditional_levels(&given->inputs[i].distribution) > 0)
			continue;
		gsl_sort_index(s->order, s->u + i, (size_t)d * PLACES, (size_t)n);
		for (int j = 0; j < d; j++)
			if (j != i && arranged(s, n, d, j))
				return true;
	}
	return false;
}

/* Variance of a mean product of an input's ranks with those of a similar input, over that of independent rows; 1 if successive
 * rows are not correlated.
 *
 * Source   Bartlett 1946, J. R. Stat. Soc. Suppl. 8, 27: 1 + 2 sum of products of autocorrelations
 */
static double correlated(const struct space *s, int n, int d, int j)
{
	double square = 0.0, sum = 1.0;
	for (int k = 0; k < n; k++) {
		s->order[k] = s->place[k];
		square += rank_of(s, d, k, j) * rank_of(s, d, k, j);
	}
	if (lagged(s, n, d, j, 1) <= ARRANGED / sqrt(n) * square)
		return 1.0;
	// every lag up to 32, then one of a block that grows with the lag: slowly varying columns are correlated over many lags
	for (int lag = 1, block; lag < n / 2; lag += block) {
		const double r = lagged(s, n, d, j, lag) / square;
		block = 1 + lag / 32;
		if (r < 2.0 / sqrt(n))
			break;
		sum += 2.0 * r * r * block;
	}
	return sum;
}

/* Checks the samples.
 *
 * Given    given      -                      all members
 * Returns  checks     -
 *          scratch    (pound_given_scratch)  for pound_given_estimate
 *
 * Only pairs of inputs are checked; a dependence among three inputs that are pairwise independent is not found.
 *
 * Test     unit_given_data: independent_samples_pass_and_others_are_named
 */
void pound_given_check(const struct pound_given *given, double *scratch, struct pound_given_checks *checks)
{
	const int n = given->n_rows, d = given->n_inputs;
	struct space s;
	bool dependent = false, monotonic = false, collinear = false, serial = false,
	     noisy = !given->noise_known && given->replicates < 2;
	double variance[POUND_INPUTS_MAX];
	carve(&s, scratch, n, d);
	shuffle(&s, n);
	places_fill(given, &s);
	*checks = (struct pound_given_checks){.pair = {-1, -1}};
	// the order of the lines of a design or of a sorted table says nothing
	for (int j = 0; j < d; j++) {
		variance[j] = given->sorted || given->replicates ? 1.0 : correlated(&s, n, d, j);
		serial |= variance[j] > 1.0;
	}
	for (int i = 0; i < d; i++)
		for (int j = i + 1; j < d; j++) {
			const double r = correlation(&s, n, d, i, j), more = sqrt(variance[i] * variance[j]);
			const bool correlates = fabs(r) * sqrt((n - 1.0) / more) > DEPENDENT,
			           depends = correlates || uneven(&s, n, d, (const int[]){i, j}, more),
			           stronger = fabs(r) > fabs(checks->correlation);
			// the most correlated of the dependent pairs, or without one of all pairs
			if (checks->pair[0] < 0 || (depends && !dependent) || (depends == dependent && stronger)) {
				checks->pair[0] = i, checks->pair[1] = j;
				checks->correlation = r;
			}
			dependent |= depends;
			monotonic |= correlates;
			collinear |= fabs(r) > COLLINEAR;
		}
	const bool said[POUND_GIVEN_N_SAMPLES_NOTES] = {
	    [POUND_GIVEN_NOISE] = noisy,
	    [POUND_GIVEN_DEPENDENT] = dependent,
	    [POUND_GIVEN_NOT_MONOTONIC] = dependent && !monotonic,
	    [POUND_GIVEN_COLLINEAR] = collinear,
	    [POUND_GIVEN_ARRANGED] = given->replicates == 0 && arranged_by_any(given, &s),
	    [POUND_GIVEN_SERIAL] = serial,
	    [POUND_GIVEN_REPLICATES] = given->joined,
	    [POUND_GIVEN_POOLED] = given->pooled,
	    [POUND_GIVEN_FACTORIAL] = given->replicates > 0,
	    [POUND_GIVEN_UNBALANCED] = given->unbalanced,
	    [POUND_GIVEN_ONE_INPUT] = given->replicates > 0 && d == 1,
	};
	for (int k = 0; k < POUND_GIVEN_N_SAMPLES_NOTES; k++)
		checks->notes |= (unsigned)said[k] << k;
}

/* ---- the indices ---- */

static const struct pound_estimate UNKNOWN = {NAN, NAN, NAN};

static double width(struct pound_estimate e)
{
	return e.high - e.low;
}

/* From an index of the fit to the index of the output, which is larger by at most the unexplained fraction. */
static struct pound_estimate widened(struct pound_estimate e, double explained)
{
	e.high += fmax(0.0, 1.0 - explained);
	return e;
}

static void rows_init(struct pound_rows *rows, const struct pound_given *given, const struct space *s)
{
	*rows = (struct pound_rows){.n_rows = given->n_rows,
	                            .n_inputs = given->n_inputs,
	                            .n_samples = 1,
	                            .n_signals = 1,
	                            .row = s->row,
	                            .scatter = {{0, 0}, s->row},
	                            .y = s->y,
	                            .plain = s->y,
	                            .deviation = s->noise,
	                            .inputs = given->inputs};
}

/* The outputs less their mean, summed relative to the first output, so that equal outputs become zeros. */
static bool centre(const struct pound_given *given, const struct pound_given_output *output,
                   const struct space *s, struct pound_given_indices *indices)
{
	const int n = given->n_rows;
	const double *y = output->y;
	double sum = 0.0, squares = 0.0, noise = 0.0, largest = 0.0;
	for (int i = 0; i < n; i++) {
		sum += y[i] - y[0];
		largest = fmax(largest, fabs(y[i]));
		s->row[i] = i;
		s->noise[s->place[i]] = output->noise ? sqrt(output->noise[i]) : 0.0;
		noise += output->noise ? output->noise[i] / n : NAN;
	}
	indices->mean = y[0] + sum / n;
	for (int i = 0; i < n; i++) {
		const double off = y[i] - indices->mean;
		s->y[s->place[i]] = off;
		squares += off * off;
	}
	const double rounding = 3.0 * DBL_EPSILON * largest;
	indices->variance = squares / (n - 1.0);
	indices->noise_share = noise / indices->variance;
	return squares / n > rounding * rounding;
}

/* S1 by local regression, or by the polynomial if its interval is narrower. */
static void first_fill(const struct pound_rows *rows, const struct space *s, const struct pound_polynomial *p,
                       bool neighbors, struct pound_given_indices *indices)
{
	const bool heavy = indices->notes >> POUND_GIVEN_FEW_DECIDE & 1;
	struct pound_estimate local[POUND_INPUTS_MAX];
	const bool fits = p && indices->explained >= EXPLAINED_LEAST;
	pound_local_regression_first(rows, s->u, POUND_NOISE_REMOVED, s->rest, local);
	for (int j = 0; j < rows->n_inputs; j++) {
		// a discrete input uses means at its values, not neighbors
		const bool known = neighbors || pound_rows_levels(rows, j) > 0;
		const struct pound_estimate fitted = fits ? widened(p->value[j], indices->explained) : UNKNOWN;
		// folds are too few for the tails: not its narrower intervals
		const bool wider = heavy || !(width(fitted) < width(local[j]));
		indices->first[j] = known && wider ? local[j] : fitted;
		indices->notes |= !known && !fits ? 1u << POUND_GIVEN_FIRST_UNKNOWN : 0u;
	}
}

/* ST and S2 by the polynomial; undefined if its R2 is too small, or few samples decide: samples that lack the decisive ones fit
 * best, and their ST is too small. */
static void others_fill(const struct pound_given *given, const struct pound_polynomial *p,
                        struct pound_given_indices *indices)
{
	const int d = given->n_inputs;
	const bool explained = p && indices->explained >= EXPLAINED_LEAST;
	const bool fits = explained && !(indices->notes >> POUND_GIVEN_FEW_DECIDE & 1);
	for (int j = 0; j < d; j++)
		indices->total[j] = fits ? widened(p->value[d + j], indices->explained) : UNKNOWN;
	indices->n_second = 0;
	for (int i = 0; i < d && fits; i++)
		for (int j = i + 1; j < d; j++, indices->n_second++)
			indices->second[indices->n_second] = (struct pound_set_index){
			    1u << i | 1u << j, widened(p->value[2 * d + indices->n_second], indices->explained)};
	if (p && !explained)
		indices->notes |= 1u << POUND_GIVEN_UNEXPLAINED | (unsigned)!given->noise_known
		                                                      << POUND_GIVEN_NOISE_LIMITS;
}

/* Conditional means: of the polynomial plus of its residual. */
static void curves_fill(const struct pound_rows *rows, const struct space *s,
                        const struct pound_polynomial *p, struct pound_given_indices *indices)
{
	struct pound_rows centred = *rows;
	struct pound_conditional of = {.rows = &centred, .u = s->u, .y = s->y};
	centred.mean = indices->mean;
	for (int i = 0; i < rows->n_rows && p; i++)
		s->y[i] -= p->fit[i];
	for (int j = 0; j < rows->n_inputs; j++) {
		const struct pound_distribution *distribution = &rows->inputs[j].distribution;
		const int levels = pound_conditional_levels(distribution);
		for (int k = 0; k < POUND_CURVE; k++) {
			const double at = k >= levels ? pound_conditional_place(k)
			                              : 0.5 * (pound_distribution_below(distribution, k) +
			                                       pound_distribution_below(distribution, k + 1));
			of.trend[k] = p ? pound_polynomial_effect(p, j, at) : 0.0;
		}
		pound_conditional_mean(&of, j, s->rest, &indices->curves[j]);
	}
}

/* No index, with a note why. */
static void nothing_fill(enum pound_given_note why, int n_inputs, struct pound_given_indices *indices)
{
	indices->notes = 1u << why;
	for (int j = 0; j < n_inputs; j++) {
		indices->first[j] = indices->total[j] = UNKNOWN;
		for (int k = 0; k < POUND_CURVE; k++)
			indices->curves[j].mean[k] = UNKNOWN;
	}
}

/* Whether the variance may be that of the noise alone: within twice its standard error. */
static bool noise_alone(const struct pound_given_indices *indices, int n_rows)
{
	const double share =
	    indices->noise_share; // sqrt(2 / n): relative standard error of a variance of noise alone
	return share > 0.0 && 1.0 - share < 2.0 * share * sqrt(2.0 / n_rows);
}

/* Whether so few rows hold most of the variance that intervals may be too narrow. */
static bool few_decide(const struct space *s, int n)
{
	double squares = 0.0, fourths = 0.0;
	for (int i = 0; i < n; i++) {
		const double square = s->y[i] * s->y[i];
		squares += square;
		fourths += square * square;
	}
	return squares * squares < fmin(ROWS_BEHIND, n / KURTOSIS_MOST) * fourths;
}

static bool positive(const double *y, int n)
{
	for (int i = 0; i < n; i++)
		if (!(y[i] > 0.0))
			return false;
	return true;
}

/* The indices of an output that the samples can estimate.
 *
 * Given    given      -
 *          checks     -                      of given
 *          output     -
 *          scratch    (pound_given_scratch)  as pound_given_check left it
 * Returns  indices    -                      NAN, with a note, for indices that cannot be estimated
 *
 * Valid    Independent draws, or one Latin hypercube, of independent inputs; dependent inputs: only S1 and conditional means; a
 *          complete factorial design
 * Test     unit_given_data, unit_given_repeats
 */
void pound_given_estimate(const struct pound_given *given, const struct pound_given_checks *checks,
                          const struct pound_given_output *output, double *scratch,
                          struct pound_given_indices *indices)
{
	const bool independent = !(checks->notes >> POUND_GIVEN_DEPENDENT & 1),
	           neighbors = !(checks->notes >> POUND_GIVEN_ARRANGED & 1), factorial = given->replicates > 0,
	           by_factorial = factorial && pound_factorial_noise_known(given);
	struct space s;
	struct pound_rows rows;
	struct pound_polynomial fitted = {.n_rows = given->n_rows, .n_inputs = given->n_inputs};
	carve(&s, scratch, given->n_rows, given->n_inputs);
	rows_init(&rows, given, &s);
	*indices = (struct pound_given_indices){.explained = NAN};
	if (!centre(given, output, &s, indices)) {
		nothing_fill(POUND_GIVEN_CONSTANT, given->n_inputs, indices);
		return;
	}
	if (noise_alone(indices, given->n_rows) ||
	    (by_factorial && !pound_factorial_indices(given, output, s.rest, indices))) {
		nothing_fill(POUND_GIVEN_ALL_NOISE, given->n_inputs, indices);
		return;
	}
	if (independent && !by_factorial) {
		fitted.u = s.u;
		fitted.noise = s.noise;
		pound_polynomial_fit(&fitted, s.y, s.rest);
		s.rest += pound_polynomial_scratch(given->n_rows, given->n_inputs);
		indices->explained = fitted.explained;
		indices->degree = fitted.chosen;
		indices->terms = fitted.terms_of[fitted.chosen];
	}
	const struct pound_polynomial *p = independent && !by_factorial ? &fitted : NULL;
	if (!factorial && few_decide(&s, given->n_rows))
		indices->notes |= 1u << POUND_GIVEN_FEW_DECIDE | (unsigned)positive(output->y, given->n_rows)
		                                                     << POUND_GIVEN_LOGARITHM;
	if (!by_factorial)
		others_fill(given, p, indices);
	if (!factorial) {
		first_fill(&rows, &s, p, neighbors, indices);
	} else if (!by_factorial)
		pound_factorial_indices(given, output, s.rest, indices);
	curves_fill(&rows, &s, p, indices);
}
