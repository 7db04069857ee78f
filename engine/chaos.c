/* chaos.c - first-order and total indexes with a polynomial of the inputs as control variate.
 *
 * 1. The rows fall into five folds; for each, a polynomial g of the inputs is fitted to the outputs of all samples of
 *    the rows outside it (least squares, orthonormal Legendre terms, "polynomial chaos").
 * 2. The index of g is known exactly from its coefficients.  A row's estimate is that of g plus what pick-freeze says
 *    of the output less what it says of g, g being of the fit that has not seen the row.
 * 3. The index is the ratio of the means of these; the interval is from the scatter of the rows. */
#include "engine/indices.h"
#include "engine/legendre.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
	FOLDS = 5,
	TERMS_MAX = 300,      // a fit's work grows with the cube of its terms
	SAMPLES_PER_TERM = 5, // fewer and the polynomial follows the noise of the fit
	CHUNK = POUND_LEGENDRE_CHUNK,
};

// columns of a row's estimates: the variance, the first-order parts, the total parts
enum { VARIANCE, FIRST };

/* Degree of the polynomial for a number of samples: 6 for 4 inputs and 1000 rows. */
int pound_chaos_degree(int n_rows, int n_inputs)
{
	double samples = (double)n_rows * (n_inputs + 2) * (FOLDS - 1) / FOLDS;
	int degree = 0;
	while (degree < POUND_LEGENDRE_DEGREE_MAX) {
		int terms = pound_legendre_terms(n_inputs, degree + 1);
		if (terms > TERMS_MAX || terms * SAMPLES_PER_TERM > samples)
			break;
		degree++;
	}
	return degree;
}

/* The fits: where everything lies in the scratch. */
struct fits {
	const struct pound_rows *rows;
	const double *u; /* (n x 2 x n_inputs) */
	int degree, terms, squares;
	struct pound_legendre chunk;
	double *value;        /* of the points of a chunk  (CHUNK) */
	double *sums;         /* of the terms of twice the degree, of each fold  (FOLDS x squares) */
	double *products;     /* of term and output, of each fold  (FOLDS x terms) */
	double *others;       /* sums of all folds but one  (squares) */
	double *gram;         /* (terms x terms) */
	double *coefficients; /* of each fold's fit to the other folds  (FOLDS x terms) */
	double *fit;          /* g at every sample, by the fit that has not seen it  (n_rows x n_samples) */
	double *estimates;    /* (n_rows x (1 + 2 n_inputs)) */
	double *groups;       /* their sums  (groups, at most n_rows, x (2 + 2 n_inputs)) */
};

static size_t carve(struct fits *f, double *scratch, int n_rows, int n_inputs)
{
	f->degree = pound_chaos_degree(n_rows, n_inputs);
	f->terms = pound_legendre_terms(n_inputs, f->degree);
	f->squares = pound_legendre_terms(n_inputs, 2 * f->degree);
	pound_legendre_init(&f->chunk, n_inputs, 2 * f->degree);
	const struct {
		double **at;
		size_t n;
	} parts[] = {
	    {&f->chunk.column, (size_t)n_inputs * (2 * f->degree + 1) * CHUNK},
	    {&f->chunk.product, (size_t)n_inputs * CHUNK},
	    {&f->value, CHUNK},
	    {&f->sums, (size_t)FOLDS * f->squares},
	    {&f->products, (size_t)FOLDS * f->terms},
	    {&f->others, f->squares},
	    {&f->gram, (size_t)f->terms * f->terms},
	    {&f->coefficients, (size_t)FOLDS * f->terms},
	    {&f->fit, (size_t)n_rows * (n_inputs + 2)},
	    {&f->estimates, (size_t)n_rows * (FIRST + 2 * n_inputs)},
	    {&f->groups, (size_t)n_rows * (FIRST + 2 * n_inputs + 1)},
	};
	size_t total = 0;
	for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
		if (scratch)
			*parts[k].at = scratch + total;
		total += parts[k].n;
	}
	return total;
}

/* Enters the next samples of a fold's rows, in order, from sample number `first`; says how many. */
static int chunk_enter(struct fits *f, int fold, int first)
{
	const int d = f->rows->n_inputs, n_samples = d + 2;
	const int n = (f->rows->n_rows - fold + FOLDS - 1) / FOLDS * n_samples - first;
	f->chunk.n = n < CHUNK ? n : CHUNK;
	for (int i = 0; i < f->chunk.n; i++) {
		int row = fold + (first + i) / n_samples * FOLDS, sample = (first + i) % n_samples;
		const double *a = f->u + (size_t)f->rows->row[row] * 2 * d;
		for (int j = 0; j < d; j++)
			pound_legendre_point(&f->chunk, i, j, a[sample == 1 || sample == 2 + j ? d + j : j]);
	}
	return f->chunk.n;
}

static double *sample_of(const struct fits *f, double *values, int fold, int number)
{
	const int n_samples = f->rows->n_inputs + 2;
	return values + (size_t)(fold + number / n_samples * FOLDS) * n_samples + number % n_samples;
}

static void sums_fill(struct fits *f)
{
	double one[CHUNK];
	memset(f->sums, 0, sizeof *f->sums * FOLDS * f->squares);
	memset(f->products, 0, sizeof *f->products * FOLDS * f->terms);
	for (int i = 0; i < CHUNK; i++)
		one[i] = 1.0;
	for (int fold = 0; fold < FOLDS; fold++)
		for (int first = 0; chunk_enter(f, fold, first) > 0; first += CHUNK) {
			for (int i = 0; i < f->chunk.n; i++)
				f->value[i] = *sample_of(f, f->rows->y, fold, first + i);
			pound_legendre_project(&f->chunk, 2 * f->degree, one, f->sums + (size_t)fold * f->squares);
			pound_legendre_project(&f->chunk, f->degree, f->value, f->products + (size_t)fold * f->terms);
		}
}

/* Adds up the sums of all folds but one. */
static void sums_others(const double *sums, int n, int fold, double *others)
{
	for (int k = 0; k < n; k++) {
		others[k] = 0.0;
		for (int g = 0; g < FOLDS; g++)
			others[k] += g == fold ? 0.0 : sums[(size_t)g * n + k];
	}
}

typedef double pair __attribute__((vector_size(16), may_alias, aligned(8)));

/* x -= factor y */
static void subtract(double *x, double factor, const double *y, int n)
{
	int k = 0;
	for (; k + 1 < n; k += 2)
		*(pair *)(x + k) -= factor * *(const pair *)(y + k);
	if (k < n)
		x[k] -= factor * y[k];
}

/* Solves gram x = b by Cholesky's method; the upper triangle of gram is overwritten, b becomes x.
 * A term that the points do not tell apart from those before it gets the coefficient 0. */
static void solve(double *gram, int n, double *b)
{
	double largest = 0.0;
	for (int i = 0; i < n; i++)
		largest = fmax(largest, gram[(size_t)i * n + i]);
	for (int i = 0; i < n; i++) {
		double *row = gram + (size_t)i * n;
		double inverse = row[i] > n * DBL_EPSILON * largest ? 1.0 / sqrt(row[i]) : 0.0;
		for (int k = i; k < n; k++)
			row[k] *= inverse;
		b[i] *= inverse;
		for (int r = i + 1; r < n; r++) {
			subtract(gram + (size_t)r * n + r, row[r], row + r, n - r);
			b[r] -= row[r] * b[i];
		}
		row[i] = inverse;
	}
	for (int i = n - 1; i >= 0; i--) {
		const double *row = gram + (size_t)i * n;
		for (int k = i + 1; k < n; k++)
			b[i] -= row[k] * b[k];
		b[i] *= row[i];
	}
}

static void fits_fill(struct fits *f)
{
	sums_fill(f);
	for (int fold = 0; fold < FOLDS; fold++) {
		double *coefficients = f->coefficients + (size_t)fold * f->terms;
		sums_others(f->sums, f->squares, fold, f->others);
		pound_legendre_gram(f->rows->n_inputs, f->degree, f->others, f->gram);
		sums_others(f->products, f->terms, fold, coefficients);
		solve(f->gram, f->terms, coefficients);
		for (int first = 0; chunk_enter(f, fold, first) > 0; first += CHUNK) {
			pound_legendre_expand(&f->chunk, f->degree, coefficients, f->value);
			for (int i = 0; i < f->chunk.n; i++)
				*sample_of(f, f->fit, fold, first + i) = f->value[i];
		}
	}
}

/* Variance of a fitted polynomial, of its part in each input alone, and of all parts that contain the input. */
struct parts {
	double all, first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX];
};

static struct parts parts_of(const struct fits *f, int fold)
{
	const int d = f->rows->n_inputs;
	const double *coefficients = f->coefficients + (size_t)fold * f->terms;
	struct parts parts = {0};
	int degrees[POUND_INPUTS_MAX] = {0};
	for (int k = 1; pound_legendre_next(d, f->degree, degrees); k++) {
		double square = coefficients[k] * coefficients[k];
		int inputs = 0, last = 0;
		for (int j = 0; j < d; j++)
			if (degrees[j] > 0) {
				parts.total[j] += square;
				inputs++;
				last = j;
			}
		parts.all += square;
		if (inputs == 1)
			parts.first[last] += square;
	}
	return parts;
}

/* A row's estimates of the variance and of each input's first-order and total part of it.
 *
 *   variance    G + mean over samples of y^2 - g^2                     y, g less the fit's mean, G the variance of g
 *   first       G_j + y_B y_C - g_B g_C
 *   total       G'_j + ((y_A - y_C)^2 - (g_A - g_C)^2) / 2
 *
 * with the products of outputs less their noise if that is to be corrected for.
 */
static void row_estimate(const struct fits *f, const struct parts *parts, double mean, int row,
                         bool corrected, double *estimate)
{
	const int d = f->rows->n_inputs;
	const double *y = f->rows->y + (size_t)row * (d + 2), *g = f->fit + (size_t)row * (d + 2);
	const double *noise = f->rows->noise + (size_t)row * pound_rows_noises(d);
	const double aa = noise[POUND_NOISE_AA], bb = noise[POUND_NOISE_BB];
	double squares = corrected ? -aa - bb : 0.0;
	for (int p = 0; p < d + 2; p++)
		squares += (y[p] - g[p]) * (y[p] + g[p] - 2.0 * mean);
	for (int j = 0; j < d; j++) {
		const double *e = noise + POUND_NOISE_MIXED + POUND_NOISE_STEP * j, cc = e[0], ac = e[1], bc = e[2];
		const double y_change = y[0] - y[2 + j], g_change = g[0] - g[2 + j];
		double first = (y[1] - mean) * (y[2 + j] - mean) - (g[1] - mean) * (g[2 + j] - mean);
		double total = y_change * y_change - g_change * g_change;
		if (corrected) {
			squares -= cc;
			first -= bc;
			total -= aa + cc - 2.0 * ac;
		}
		estimate[FIRST + j] = parts->first[j] + first;
		estimate[FIRST + d + j] = parts->total[j] + 0.5 * total;
	}
	estimate[VARIANCE] = parts->all + squares / (d + 2);
}

static void moments_fill(const void *subject, int row, double *m)
{
	const struct fits *f = subject;
	const int width = FIRST + 2 * f->rows->n_inputs;
	memcpy(m, f->estimates + (size_t)row * width, sizeof *m * (size_t)width);
}

static void values_fill(const void *subject, const double *mean, double *value)
{
	const struct fits *f = subject;
	for (int k = 0; k < 2 * f->rows->n_inputs; k++)
		value[k] = mean[VARIANCE] > f->rows->variance_floor ? mean[FIRST + k] / mean[VARIANCE] : NAN;
}

/* The ratios with intervals from the groups of rows. */
static void groups_fill(const struct fits *f, struct pound_estimate *first, struct pound_estimate *total)
{
	const int d = f->rows->n_inputs;
	const struct pound_statistic statistic = {FIRST + 2 * d, 2 * d, moments_fill, values_fill, f};
	struct pound_estimate estimates[2 * POUND_INPUTS_MAX];
	pound_jackknife_estimates(&statistic, &f->rows->scatter, f->rows->n_rows, f->groups, estimates);
	memcpy(first, estimates, sizeof *first * (size_t)d);
	memcpy(total, estimates + d, sizeof *total * (size_t)d);
}

/* Ratio of the means of two columns of the rows' estimates, with the interval of its linearisation. */
static struct pound_estimate ratio_interval(const double *estimates, int n, int width, int column,
                                            double variance_floor)
{
	double above = 0.0, below = 0.0, squares = 0.0;
	for (int i = 0; i < n; i++) {
		above += estimates[(size_t)i * width + column] / n;
		below += estimates[(size_t)i * width + VARIANCE] / n;
	}
	if (!(below > variance_floor))
		return (struct pound_estimate){NAN, NAN, NAN};
	const double ratio = above / below;
	for (int i = 0; i < n; i++) {
		const double *row = estimates + (size_t)i * width;
		double influence = (row[column] - ratio * row[VARIANCE]) / below;
		squares += influence * influence;
	}
	double half_width = POUND_NORMAL_95 * sqrt(squares / (n - 1.0) / n);
	return (struct pound_estimate){ratio, ratio - half_width, ratio + half_width};
}

size_t pound_chaos_scratch(int n_rows, int n_inputs)
{
	struct fits fits;
	return carve(&fits, NULL, n_rows, n_inputs);
}

/* First-order and total indexes with a cross-fitted polynomial as control variate.
 *
 * Given    rows       -                      outputs and their noise
 *          u          (n x 2 x n_inputs)     the design as probabilities in (0, 1), rows of A and B
 *          corrected  -                      for the noise of few signals (NAN for one signal)
 * Returns  first      (n_inputs)             with 95 % intervals from the scatter of the rows, or of their groups
 *          total      (n_inputs)             likewise
 * Memory   scratch    (pound_chaos_scratch)  for all rows of the design
 *
 * An input without effect has a total near 0, not exactly 0 as without the control variate.
 *
 * Valid    Latin hypercube, random and quasi-random designs
 * Source   control variates with estimated coefficients, cross-fitted: Chernozhukov et al. 2018, Econom. J. 21, C1-C68;
 *          Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964-979, for the indexes of the polynomial
 * Test     unit_chaos
 */
void pound_chaos_indices(const struct pound_rows *rows, const double *u, bool corrected, double *scratch,
                         struct pound_estimate *first, struct pound_estimate *total)
{
	const int n = rows->n_rows, d = rows->n_inputs, width = FIRST + 2 * d;
	struct fits fits = {.rows = rows, .u = u};
	carve(&fits, scratch, n, d);
	fits_fill(&fits);
	for (int fold = 0; fold < FOLDS; fold++) {
		const struct parts parts = parts_of(&fits, fold);
		for (int row = fold; row < n; row += FOLDS)
			row_estimate(&fits, &parts, fits.coefficients[(size_t)fold * fits.terms], row, corrected,
			             fits.estimates + (size_t)row * width);
	}
	if (rows->scatter.grouping.n)
		groups_fill(&fits, first, total);
	for (int j = 0; j < d && !rows->scatter.grouping.n; j++) {
		first[j] = ratio_interval(fits.estimates, n, width, FIRST + j, rows->variance_floor);
		total[j] = ratio_interval(fits.estimates, n, width, FIRST + d + j, rows->variance_floor);
	}
}
