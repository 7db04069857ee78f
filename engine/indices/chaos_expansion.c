/* chaos_expansion.c - closed indices with a polynomial chaos expansion as control variate.
 *
 * 1. The rows, or their groups, are dealt to five folds; for each fold a polynomial g of the inputs is fitted to the outputs of
 *    all samples of the rows outside the fold (least squares, orthonormal Legendre terms: polynomial chaos expansion).
 * 2. The closed variances of g follow exactly from its coefficients.  A row's estimate is the exact value of g plus the
 *    pick-freeze estimate of the output less the same estimate of g, with the fit that excludes the row (closed_indices.c).
 * 3. Likewise the conditional mean is the sum of the means of g and of the output less g (conditional_mean.c). */
#include "engine/indices/indices.h"
#include "engine/indices/legendre.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum {
	FOLDS = 5,
	TERMS_MAX = 300,              // the work of a fit grows with the cube of its terms
	SAMPLES_PER_TERM = 5,         // with fewer the polynomial overfits
	CHUNK = POUND_LEGENDRE_CHUNK, // also holds the points of a curve
};

/* Degree of the polynomial for a number of samples: 6 for 4 inputs and 1000 rows of 6 samples. */
int pound_chaos_expansion_degree(int n_rows, int n_inputs, int n_samples)
{
	double samples = (double)n_rows * n_samples * (FOLDS - 1) / FOLDS;
	int degree = 0;
	while (degree < POUND_LEGENDRE_DEGREE_MAX) {
		int terms = pound_legendre_terms(n_inputs, degree + 1);
		if (terms > TERMS_MAX || terms * SAMPLES_PER_TERM > samples)
			break;
		degree++;
	}
	return degree;
}

/* The fits, and the layout of the scratch memory. */
struct fits {
	const struct pound_rows *rows;
	const double *u; /* (n x 2 x n_inputs) */
	int degree, terms, squares;
	unsigned mask[POUND_SAMPLES_MAX]; /* of a sample: columns from B */
	struct pound_legendre chunk;
	double *value;        /* of the points of a chunk  (CHUNK) */
	double *sums;         /* of the terms up to twice the degree, of each fold  (FOLDS x squares) */
	double *products;     /* sums of term times output, of each fold  (FOLDS x terms) */
	double *others;       /* sums of all folds but one  (squares) */
	double *gram;         /* Gram matrix, overwritten by its factor  (terms x terms) */
	double *kept;         /* pound_chaos_expansion_kept_size; NULL: not kept */
	double *coefficients; /* of the fit without each fold  (FOLDS x terms) */
	double *fit;          /* out-of-fold prediction g of every sample  (n_rows x n_samples) */
	struct pound_closed closed;
	double *estimates;    /* (n_rows x 2 x closed.n_columns) */
	double *rest;         /* for closed_indices.c and conditional_mean.c */
	double *sorted;       /* row numbers sorted by fold, as doubles  (n_rows) */
	int first[FOLDS + 1]; /* first entry of each fold in `sorted` */
};

static size_t carve(struct fits *f, double *scratch, const struct pound_sample_values *shape)
{
	const int n_rows = shape->n_rows, n_inputs = shape->n_inputs;
	pound_closed_init(&f->closed, shape);
	f->degree = pound_chaos_expansion_degree(n_rows, n_inputs, f->closed.n_samples);
	f->terms = pound_legendre_terms(n_inputs, f->degree);
	f->squares = pound_legendre_terms(n_inputs, 2 * f->degree);
	pound_legendre_init(&f->chunk, n_inputs, 2 * f->degree);
	const size_t rest = pound_closed_scratch(&f->closed, n_rows), smooth = pound_conditional_scratch(n_rows);
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
	    {&f->fit, (size_t)n_rows * f->closed.n_samples},
	    {&f->estimates, (size_t)n_rows * 2 * f->closed.n_columns},
	    {&f->rest, rest > smooth ? rest : smooth},
	    {&f->sorted, n_rows},
	};
	size_t total = 0;
	for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
		if (scratch)
			*parts[k].at = scratch + total;
		total += parts[k].n;
	}
	return total;
}

/* Deals the rows to the folds; a group stays together, so that no fit uses rows that depend on the rows it predicts. */
static void folds_fill(struct fits *f)
{
	const struct pound_scatter *scatter = &f->rows->scatter;
	int n = 0;
	for (int fold = 0; fold < FOLDS; fold++) {
		f->first[fold] = n;
		for (int i = 0; i < f->rows->n_rows; i++)
			if ((scatter->grouping.n ? pound_jackknife_group(scatter, i) : i) % FOLDS == fold)
				f->sorted[n++] = i;
	}
	f->first[FOLDS] = n;
}

static int rows_in(const struct fits *f, int fold)
{
	return f->first[fold + 1] - f->first[fold];
}

/* Row k of a fold. */
static int row_in(const struct fits *f, int fold, int k)
{
	return (int)f->sorted[f->first[fold] + k];
}

/* Enters the next samples of a fold's rows, from sample number `first` on; returns how many. */
static int chunk_enter(struct fits *f, int fold, int first)
{
	const int d = f->rows->n_inputs, n_samples = f->rows->n_samples;
	const int n = rows_in(f, fold) * n_samples - first;
	f->chunk.n = n < CHUNK ? n : CHUNK;
	for (int i = 0; i < f->chunk.n; i++) {
		int row = row_in(f, fold, (first + i) / n_samples), sample = (first + i) % n_samples;
		const double *a = f->u + (size_t)f->rows->row[row] * 2 * d;
		const unsigned from_b = f->mask[sample];
		for (int j = 0; j < d; j++)
			pound_legendre_point(&f->chunk, i, j, a[from_b >> j & 1 ? d + j : j]);
	}
	return f->chunk.n;
}

static double *sample_of(const struct fits *f, double *values, int fold, int number)
{
	const int n_samples = f->rows->n_samples;
	return values + (size_t)row_in(f, fold, number / n_samples) * n_samples + number % n_samples;
}

static void sums_fill(struct fits *f, bool design_known)
{
	const atomic_bool *stop = f->rows->stop;
	double one[CHUNK];
	memset(f->sums, 0, sizeof *f->sums * FOLDS * f->squares);
	memset(f->products, 0, sizeof *f->products * FOLDS * f->terms);
	for (int i = 0; i < CHUNK; i++)
		one[i] = 1.0;
	for (int fold = 0; fold < FOLDS; fold++)
		for (int first = 0; !pound_stopped(stop) && chunk_enter(f, fold, first) > 0; first += CHUNK) {
			for (int i = 0; i < f->chunk.n; i++)
				f->value[i] = *sample_of(f, f->rows->y, fold, first + i);
			if (!design_known)
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

/* ---- factors shared by the outputs of one design ---- */

/* Factor of a fold's Gram matrix.  Before the first factor are the numbers of rows of the folds, after the last one the row
 * numbers, by fold: the factors are valid for these rows only. */
static double *kept_factor(const struct fits *f, int fold)
{
	return f->kept + FOLDS + (size_t)fold * f->terms * f->terms;
}

static bool kept_is_of(const struct fits *f)
{
	bool same = f->kept;
	for (int fold = 0; fold < FOLDS && same; fold++)
		same = f->kept[fold] == rows_in(f, fold);
	for (int i = 0; i < f->rows->n_rows && same; i++)
		same = kept_factor(f, FOLDS)[i] == f->rows->row[(int)f->sorted[i]];
	return same;
}

static void kept_fill(const struct fits *f)
{
	for (int fold = 0; fold < FOLDS; fold++)
		f->kept[fold] = rows_in(f, fold);
	for (int i = 0; i < f->rows->n_rows; i++)
		kept_factor(f, FOLDS)[i] = f->rows->row[(int)f->sorted[i]];
}

size_t pound_chaos_expansion_kept_size(const struct pound_sample_values *shape)
{
	const int n_samples = pound_values_samples(shape);
	const int degree = pound_chaos_expansion_degree(shape->n_rows, shape->n_inputs, n_samples);
	const size_t terms = (size_t)pound_legendre_terms(shape->n_inputs, degree);
	return FOLDS + FOLDS * terms * terms + (size_t)shape->n_rows;
}

/* ---- the fits ---- */

static void fits_fill(struct fits *f)
{
	const bool design_known = kept_is_of(f);
	const atomic_bool *stop = f->rows->stop;
	f->chunk.degree = design_known ? f->degree : 2 * f->degree;
	sums_fill(f, design_known);
	f->chunk.degree = f->degree;
	for (int fold = 0; fold < FOLDS && !pound_stopped(stop); fold++) {
		double *coefficients = f->coefficients + (size_t)fold * f->terms;
		double *gram = f->kept ? kept_factor(f, fold) : f->gram;
		if (!design_known) {
			sums_others(f->sums, f->squares, fold, f->others);
			pound_legendre_gram(f->rows->n_inputs, f->degree, f->others, gram);
			pound_legendre_factor(gram, f->terms);
		}
		sums_others(f->products, f->terms, fold, coefficients);
		pound_legendre_solve(gram, f->terms, coefficients);
		for (int first = 0; !pound_stopped(stop) && chunk_enter(f, fold, first) > 0; first += CHUNK) {
			pound_legendre_expand(&f->chunk, f->degree, coefficients, f->value);
			for (int i = 0; i < f->chunk.n; i++)
				*sample_of(f, f->fit, fold, first + i) = f->value[i];
		}
	}
	if (f->kept && !design_known && !pound_stopped(stop))
		kept_fill(f);
}

/* Shrinks each fit toward its mean by the regression coefficient of the outputs on the out-of-fold predictions, so that an
 * overfitted polynomial does not make the indices worse than without it.
 *
 *   share = sum (y - b_0) (g - b_0) / sum (g - b_0)^2,  b_0: the fit's own mean
 *
 * Test     unit_chaos_expansion: a_polynomial_that_cannot_follow_does_no_harm
 */
static void fits_shrink(struct fits *f)
{
	const int n_samples = f->rows->n_samples;
	double product = 0.0, square = 0.0;
	for (int fold = 0; fold < FOLDS && !pound_stopped(f->rows->stop); fold++) {
		const double mean = f->coefficients[(size_t)fold * f->terms];
		for (int k = 0; k < rows_in(f, fold) * n_samples; k++) {
			const double g = *sample_of(f, f->fit, fold, k) - mean;
			product += (*sample_of(f, f->rows->y, fold, k) - mean) * g;
			square += g * g;
		}
	}
	const double share = square > 0.0 ? fmin(fmax(product / square, 0.0), 1.0) : 0.0;
	for (int fold = 0; fold < FOLDS && !pound_stopped(f->rows->stop); fold++) {
		double *coefficients = f->coefficients + (size_t)fold * f->terms;
		for (int term = 1; term < f->terms; term++)
			coefficients[term] *= share;
		for (int k = 0; k < rows_in(f, fold) * n_samples; k++) {
			double *g = sample_of(f, f->fit, fold, k);
			*g = coefficients[0] + share * (*g - coefficients[0]);
		}
	}
}

/* Closed variances of a fitted polynomial: for each set, the sum of squared coefficients of all terms in inputs of the set. */
static void parts_fill(const struct fits *f, int fold, double *part)
{
	const struct pound_closed *closed = &f->closed;
	const double *coefficients = f->coefficients + (size_t)fold * f->terms;
	int degrees[POUND_INPUTS_MAX] = {0};
	for (int k = 0; k < closed->n_columns; k++)
		part[k] = 0.0;
	for (int term = 1; pound_legendre_next(closed->n_inputs, f->degree, degrees); term++) {
		unsigned inputs = 0;
		for (int j = 0; j < closed->n_inputs; j++)
			inputs |= (unsigned)(degrees[j] > 0) << j;
		for (int k = 0; k < closed->n_columns; k++)
			part[k] += inputs & ~closed->set[k] ? 0.0 : coefficients[term] * coefficients[term];
	}
}

static void estimates_fill(const struct fits *f, bool corrected)
{
	const int n_samples = f->rows->n_samples;
	double part[POUND_CLOSED_COLUMNS_MAX], noise[POUND_SAMPLES_MAX * POUND_SAMPLES_MAX];
	for (int fold = 0; fold < FOLDS; fold++) {
		parts_fill(f, fold, part);
		for (int k = 0; k < rows_in(f, fold) && !pound_stopped(f->rows->stop); k++) {
			const int row = row_in(f, fold, k);
			const size_t first = (size_t)row * n_samples;
			if (corrected)
				pound_rows_noise(f->rows, row, noise);
			const struct pound_control_variate control = {f->fit + first,
			                                              f->coefficients[(size_t)fold * f->terms], part};
			pound_closed_row(&f->closed, f->rows->y + first, &control, corrected ? noise : NULL,
			                 f->estimates + (size_t)row * 2 * f->closed.n_columns);
		}
	}
}

/* What the noise of few signals adds to the half widths of the indices. */
static void noise_fill(const struct fits *f, enum pound_noise noise, struct pound_closed_results *results)
{
	double part[POUND_CLOSED_COLUMNS_MAX];
	struct pound_noise_part sums = pound_noise_part_init(f->rows, &f->closed, noise, results);
	for (int fold = 0; fold < FOLDS && sums.known; fold++) {
		parts_fill(f, fold, part);
		for (int k = 0; k < rows_in(f, fold) && !pound_stopped(f->rows->stop); k++) {
			const int row = row_in(f, fold, k);
			const struct pound_control_variate control = {f->fit + (size_t)row * f->rows->n_samples,
			                                              f->coefficients[(size_t)fold * f->terms], part};
			pound_noise_part_add(&sums, row, &control);
		}
	}
	pound_noise_part_ranges(&sums, &results->noise);
}

enum { GAUSS = 4 }; // points of the Gauss-Legendre rule: exact up to degree 7

static const double gauss_place[GAUSS] = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                          0.9305681557970263};
static const double gauss_weight[GAUSS] = {0.17392742256872692, 0.32607257743127307, 0.32607257743127307,
                                           0.17392742256872692};

/* Probabilities at which an input's curve is evaluated: its places, or for a discrete input the Gauss points within each
 * value's probability interval, for the mean over the interval; returns how many. */
static int places_fill(const struct pound_rows *rows, int input, double *place)
{
	static_assert(GAUSS * POUND_CURVE <= CHUNK, "a chunk holds the points of every value");
	const int levels = pound_rows_levels(rows, input);
	for (int k = 0; k < levels; k++) {
		const struct pound_distribution *distribution = &rows->inputs[input].distribution;
		const double low = pound_distribution_below(distribution, k),
		             high = pound_distribution_below(distribution, k + 1);
		for (int i = 0; i < GAUSS; i++)
			place[k * GAUSS + i] = low + gauss_place[i] * (high - low);
	}
	for (int k = 0; k < POUND_CURVE && levels == 0; k++)
		place[k] = pound_conditional_place(k);
	return levels > 0 ? levels * GAUSS : POUND_CURVE;
}

/* The conditional mean of the fits given one input, at the points of a curve; outputs are centered. */
static void trend_fill(struct fits *f, int input, double *trend)
{
	const int d = f->closed.n_inputs;
	int degrees[POUND_INPUTS_MAX] = {0};
	double *coefficients = f->others; // at least as long
	for (int term = 0; term < f->terms; term++, pound_legendre_next(d, f->degree, degrees)) {
		int elsewhere = 0;
		for (int j = 0; j < d; j++)
			elsewhere += j == input ? 0 : degrees[j];
		coefficients[term] = 0.0;
		for (int fold = 0; fold < FOLDS && elsewhere == 0; fold++)
			coefficients[term] += f->coefficients[(size_t)fold * f->terms + term] / FOLDS;
	}
	double place[CHUNK];
	f->chunk.n = places_fill(f->rows, input, place);
	for (int k = 0; k < f->chunk.n; k++)
		for (int j = 0; j < d; j++)
			pound_legendre_point(&f->chunk, k, j, place[k]);
	pound_legendre_expand(&f->chunk, f->degree, coefficients, f->value);
	const int levels = pound_rows_levels(f->rows, input);
	for (int k = 0; k < POUND_CURVE; k++) {
		trend[k] = levels > 0 ? 0.0 : f->value[k];
		for (int i = 0; i < GAUSS && k < levels; i++)
			trend[k] += gauss_weight[i] * f->value[k * GAUSS + i];
	}
}

/* Conditional means; the fits are overwritten by the residuals. */
static void curves_fill(struct fits *f, struct pound_curve *curves)
{
	struct pound_conditional given = {.rows = f->rows, .u = f->u, .y = f->fit};
	for (size_t k = 0; k < (size_t)f->rows->n_rows * (size_t)f->rows->n_samples; k++)
		f->fit[k] = f->rows->y[k] - f->fit[k];
	for (int j = 0; j < f->rows->n_inputs && !pound_stopped(f->rows->stop); j++) {
		trend_fill(f, j, given.trend);
		pound_conditional_mean(&given, j, f->rest, &curves[j]);
	}
}

size_t pound_chaos_expansion_scratch(const struct pound_sample_values *shape)
{
	struct fits fits;
	return carve(&fits, NULL, shape);
}

/* All indices and conditional means with a cross-fitted polynomial as control variate.
 *
 * Given    rows       -                      outputs and their noise
 *          sampling   -                      u, and kept  (pound_chaos_expansion_kept_size): zeros, or as left by a call for another output of the design,
 *                                            possibly with other rows; NULL: not kept
 *          noise      -                      kept or removed (NAN for one signal)
 * Returns  results    -                      with 95 % intervals from the scatter of the rows, or of their groups
 *          curves     (n_inputs)             conditional means given each input; NULL: not requested
 * Memory   scratch    (pound_chaos_expansion_scratch)  for all rows of the design
 *
 * An input without effect has a total near 0, not exactly 0 as without the control variate.
 *
 * Valid    Latin hypercube, random and quasi-random designs
 * Source   control variates with estimated coefficients, cross-fitted: Chernozhukov et al. 2018, Econom. J. 21, C1-C68;
 *          Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964-979, for the indices of the polynomial
 * Test     unit_chaos_expansion
 */
void pound_chaos_expansion_indices(const struct pound_rows *rows, const struct pound_sampling *sampling,
                                   enum pound_noise noise, double *scratch,
                                   struct pound_closed_results *results, struct pound_curve *curves)
{
	struct fits fits = {.rows = rows, .u = sampling->u, .kept = sampling->kept};
	const struct pound_sample_values shape = pound_rows_shape(rows);
	carve(&fits, scratch, &shape);
	for (int sample = 0; sample < rows->n_samples; sample++)
		fits.mask[sample] = pound_rows_mask(rows, sample);
	folds_fill(&fits);
	fits_fill(&fits);
	fits_shrink(&fits);
	estimates_fill(&fits, noise == POUND_NOISE_REMOVED);
	pound_closed_indices(&fits.closed, fits.estimates, rows, fits.rest, results);
	noise_fill(&fits, noise, results);
	if (curves)
		curves_fill(&fits, curves);
}

/* Indices from the estimates of the first rows alone, with the polynomials of all rows.
 *
 * Given    n          number of first rows
 *          scratch    as pound_chaos_expansion_indices left it
 * Returns  results    -
 *
 * Test     unit_error_budget: half_widths_of_all_rows_are_those_of_the_indices
 */
void pound_chaos_expansion_first_rows(const struct pound_rows *rows, int n, double *scratch,
                                      struct pound_closed_results *results)
{
	struct fits fits = {.rows = rows};
	struct pound_rows part = *rows;
	const struct pound_sample_values shape = pound_rows_shape(rows);
	carve(&fits, scratch, &shape);
	part.n_rows = n;
	pound_closed_indices(&fits.closed, fits.estimates, &part, fits.rest, results);
}
