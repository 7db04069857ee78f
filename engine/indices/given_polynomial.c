/* given_polynomial.c - a polynomial fitted to given data, its degree chosen by cross-validation, and the variance fractions of
 * its terms.
 *
 * 1. For each input, polynomials that are orthonormal over its samples (Stieltjes' recurrence); a term is a product of
 *    these.  Terms are sorted by degree, so that the terms, normal equations and factor of a lower degree are the leading
 *    part of the ones of a higher degree.
 * 2. The samples are dealt to folds; each fold is predicted by fits to the others, of every degree.  The degree that
 *    predicts best is chosen; its R2 of the predictions is the cross-validated R2.
 * 3. For independent inputs the squared coefficients add up to the variance and contribute to the indices of the term's
 *    inputs; a square is too large by the coefficient's own variance, which is subtracted.
 * 4. Intervals are Student's, from the fits without one fold each.  Each fit's indices are those of the distribution of its own
 *    samples: most of the error of a polynomial that fits well is that of the moments of the samples. */
#include "engine/indices/given_polynomial.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/indices/indices.h"
#include "engine/indices/legendre.h"

enum {
	FOLDS = 20,
	DEGREE_MAX = POUND_POLYNOMIAL_DEGREE_MAX,
	TERMS_MAX = POUND_POLYNOMIAL_TERMS_MAX,
	ROWS_PER_TERM = 2, // with fewer no degree predicts well, as cross-validation would show
	VALUES_MAX = POUND_POLYNOMIAL_VALUES_MAX,
};

/* ---- the terms ---- */

static double place(const struct pound_polynomial *p, int row, int input)
{
	return p->u[(size_t)row * 2 * p->n_inputs + input];
}

/* Values of an input's polynomials, one per degree  (axis->most + 1) */
static void axis_values(const struct pound_polynomial_axis *axis, double u, double *value)
{
	const double x = u - 0.5;
	value[0] = 1.0;
	for (int k = 0; k < axis->most; k++)
		value[k + 1] =
		    ((x - axis->a[k]) * value[k] - (k > 0 ? axis->h[k] * value[k - 1] : 0.0)) / axis->h[k + 1];
}

/* Stieltjes' recurrence, up to the degree that the number of distinct values allows.
 *
 * Source   Gautschi 2004, Orthogonal Polynomials, 2.2.3
 * Test     unit_given_data: an_input_of_few_values_is_discrete
 */
static void axis_fill(struct pound_polynomial *p, int input)
{
	struct pound_polynomial_axis *axis = &p->axis[input];
	*axis = (struct pound_polynomial_axis){.most = 0};
	for (int k = 0; k < DEGREE_MAX; k++) {
		double value[DEGREE_MAX + 1], a = 0.0, square = 0.0, size = 0.0;
		for (int i = 0; i < p->n_rows; i++) {
			axis_values(axis, place(p, i, input), value);
			a += (place(p, i, input) - 0.5) * value[k] * value[k] / p->n_rows;
		}
		for (int i = 0; i < p->n_rows; i++) {
			axis_values(axis, place(p, i, input), value);
			const double moved = (place(p, i, input) - 0.5) * value[k],
			             next = moved - a * value[k] - (k > 0 ? axis->h[k] * value[k - 1] : 0.0);
			square += next * next / p->n_rows;
			size += moved * moved / p->n_rows;
		}
		// near 1 for uniform samples; rounding error if the degree reaches the number of distinct values
		if (!(square > 1e-12 * size))
			return;
		axis->a[k] = a;
		axis->h[k + 1] = sqrt(square);
		axis->most = k + 1;
	}
}

/* Adds the terms of a degree, recursively over the exponents from `input` on; false: more than `most` terms. */
static bool terms_add(struct pound_polynomial *p, unsigned char *exponent, int input, int left, int *n,
                      int most)
{
	if (input == p->n_inputs) {
		if (left > 0)
			return true;
		if (*n == most)
			return false;
		memcpy(p->exponent[(*n)++], exponent, POUND_INPUTS_MAX);
		return true;
	}
	bool room = true;
	for (int e = left < p->axis[input].most ? left : p->axis[input].most; e >= 0 && room; e--) {
		exponent[input] = (unsigned char)e;
		room = terms_add(p, exponent, input + 1, left - e, n, most);
	}
	exponent[input] = 0;
	return room;
}

static void terms_fill(struct pound_polynomial *p)
{
	const int samples = p->n_rows - p->n_rows / FOLDS - 1;
	const int most = samples / ROWS_PER_TERM < TERMS_MAX ? samples / ROWS_PER_TERM : TERMS_MAX;
	int n = 0;
	p->degree = -1;
	for (int degree = 0; degree <= DEGREE_MAX; degree++) {
		unsigned char exponent[POUND_INPUTS_MAX] = {0};
		if (!terms_add(p, exponent, 0, degree, &n, most))
			break;
		p->terms_of[degree] = n;
		p->degree = degree;
	}
}

/* All terms of one sample. */
static void terms_values(const struct pound_polynomial *p, int row, double *term)
{
	double value[POUND_INPUTS_MAX][DEGREE_MAX + 1];
	for (int j = 0; j < p->n_inputs; j++)
		axis_values(&p->axis[j], place(p, row, j), value[j]);
	for (int t = 0; t < p->terms_of[p->degree]; t++) {
		term[t] = 1.0;
		for (int j = 0; j < p->n_inputs; j++)
			term[t] *= value[j][p->exponent[t][j]];
	}
}

/* ---- the fits ---- */

/* Layout of the scratch memory; sums: of each fold, then of all samples. */
struct space {
	double *gram;    /* upper triangles  ((FOLDS + 1) x terms x terms) */
	double *product; /* sums of term times output  ((FOLDS + 1) x terms) */
	double *factor;  /* (terms x terms) */
	double *
	    coefficients; /* of the fits without a fold each, then of all, for each degree  ((FOLDS + 1) x (degree + 1) x terms) */
	double *fit;             /* (n_rows) */
	double noise[FOLDS + 1]; /* sum of the noise variances */
	int n[FOLDS + 1];
};

static size_t carve(struct space *s, double *scratch, int n_rows, int terms)
{
	const size_t n = terms;
	if (s) {
		s->gram = scratch;
		s->product = s->gram + (FOLDS + 1) * n * n;
		s->factor = s->product + (FOLDS + 1) * n;
		s->coefficients = s->factor + n * n;
		s->fit = s->coefficients + (FOLDS + 1) * (DEGREE_MAX + 1) * n;
	}
	return (FOLDS + 2) * n * n + (FOLDS + 1) * (DEGREE_MAX + 2) * n + (size_t)n_rows;
}

/* Upper bound of the number of terms with n_rows samples. */
static int terms_most(int n_rows)
{
	return n_rows / ROWS_PER_TERM < TERMS_MAX ? n_rows / ROWS_PER_TERM : TERMS_MAX;
}

size_t pound_polynomial_scratch(int n_rows, int n_inputs)
{
	(void)n_inputs;
	return carve(NULL, NULL, n_rows, terms_most(n_rows));
}

static double *coefficients_of(const struct pound_polynomial *p, const struct space *s, int fold, int degree)
{
	return s->coefficients +
	       ((size_t)fold * (DEGREE_MAX + 1) + (size_t)degree) * (size_t)p->terms_of[p->degree];
}

static void sums_fill(const struct pound_polynomial *p, const double *y, struct space *s)
{
	const size_t n = p->terms_of[p->degree];
	double term[TERMS_MAX];
	memset(s->gram, 0, sizeof *s->gram * (FOLDS + 1) * n * n);
	memset(s->product, 0, sizeof *s->product * (FOLDS + 1) * n);
	memset(s->noise, 0, sizeof s->noise);
	memset(s->n, 0, sizeof s->n);
	for (int i = 0; i < p->n_rows; i++) {
		const int fold = i % FOLDS;
		double *gram = s->gram + (size_t)fold * n * n, *product = s->product + (size_t)fold * n;
		terms_values(p, i, term);
		for (size_t k = 0; k < n; k++) {
			for (size_t l = k; l < n; l++)
				gram[k * n + l] += term[k] * term[l];
			product[k] += term[k] * y[i];
		}
		s->noise[fold] += p->noise[i] * p->noise[i];
		s->n[fold]++;
	}
	for (int fold = 0; fold < FOLDS; fold++) {
		for (size_t k = 0; k < n * n; k++)
			s->gram[FOLDS * n * n + k] += s->gram[(size_t)fold * n * n + k];
		for (size_t k = 0; k < n; k++)
			s->product[FOLDS * n + k] += s->product[(size_t)fold * n + k];
		s->noise[FOLDS] += s->noise[fold];
		s->n[FOLDS] += s->n[fold];
	}
}

/* Factor of the normal equations without a fold (FOLDS: with all samples). */
static void factor_fill(const struct pound_polynomial *p, const struct space *s, int fold)
{
	const size_t n = p->terms_of[p->degree];
	const double *all = s->gram + FOLDS * n * n, *of = s->gram + (size_t)fold * n * n;
	for (size_t k = 0; k < n * n; k++)
		s->factor[k] = all[k] - (fold < FOLDS ? of[k] : 0.0);
	pound_legendre_factor(s->factor, (int)n);
}

/* Forward and back substitution with the leading n x n part of a factor. */
static void solve_forward(const double *factor, int stride, int n, double *b)
{
	for (int i = 0; i < n; i++) {
		const double *row = factor + (size_t)i * stride;
		b[i] *= row[i];
		for (int k = i + 1; k < n; k++)
			b[k] -= b[i] * row[k];
	}
}

static void solve_back(const double *factor, int stride, int n, double *b)
{
	for (int i = n - 1; i >= 0; i--) {
		const double *row = factor + (size_t)i * stride;
		for (int k = i + 1; k < n; k++)
			b[i] -= row[k] * b[k];
		b[i] *= row[i];
	}
}

/* Coefficients of the fits of every degree without a fold. */
static void coefficients_fill(const struct pound_polynomial *p, const struct space *s, int fold)
{
	const int n = p->terms_of[p->degree];
	double forward[TERMS_MAX];
	factor_fill(p, s, fold);
	for (int k = 0; k < n; k++)
		forward[k] =
		    s->product[(size_t)FOLDS * n + k] - (fold < FOLDS ? s->product[(size_t)fold * n + k] : 0.0);
	solve_forward(s->factor, n, n, forward);
	for (int degree = 0; degree <= p->degree; degree++) {
		double *coefficients = coefficients_of(p, s, fold, degree);
		memcpy(coefficients, forward, sizeof *forward * (size_t)p->terms_of[degree]);
		solve_back(s->factor, n, p->terms_of[degree], coefficients);
	}
}

/* Sum of squared out-of-fold prediction errors for each degree. */
static void errors_fill(const struct pound_polynomial *p, const double *y, const struct space *s,
                        double *error)
{
	double term[TERMS_MAX];
	memset(error, 0, sizeof *error * (DEGREE_MAX + 1));
	for (int i = 0; i < p->n_rows; i++) {
		terms_values(p, i, term);
		for (int degree = 0; degree <= p->degree; degree++) {
			const double *coefficients = coefficients_of(p, s, i % FOLDS, degree);
			double fit = 0.0;
			for (int t = 0; t < p->terms_of[degree]; t++)
				fit += coefficients[t] * term[t];
			error[degree] += (y[i] - fit) * (y[i] - fit);
		}
	}
}

static void predictions_fill(const struct pound_polynomial *p, const struct space *s)
{
	double term[TERMS_MAX];
	for (int i = 0; i < p->n_rows; i++) {
		const double *coefficients = coefficients_of(p, s, i % FOLDS, p->chosen);
		terms_values(p, i, term);
		s->fit[i] = 0.0;
		for (int t = 0; t < p->terms_of[p->chosen]; t++)
			s->fit[i] += coefficients[t] * term[t];
	}
}

/* ---- the indices ---- */

static int n_values(const struct pound_polynomial *p)
{
	return 2 * p->n_inputs + p->n_inputs * (p->n_inputs - 1) / 2;
}

/* An input's polynomials p_k as sums of polynomials q_l that are orthonormal over the samples without a fold:
 *   p_k = sum over l <= k of factor[k][l] q_l,  the Cholesky factor of the means of p_k p_l over these samples */
struct axis_change {
	double factor[DEGREE_MAX + 1][DEGREE_MAX + 1];
};

static void change_fill(const struct pound_polynomial *p, const struct space *s, int fold, int input,
                        struct axis_change *change)
{
	const size_t n = p->terms_of[p->degree];
	const double *all = s->gram + FOLDS * n * n, *of = s->gram + (size_t)fold * n * n;
	size_t term[DEGREE_MAX + 1] = {0}; // the terms of this input alone
	int most = 0;
	for (size_t t = 1; t < n; t++) {
		int elsewhere = 0;
		for (int j = 0; j < p->n_inputs; j++)
			elsewhere += j == input ? 0 : p->exponent[t][j];
		if (elsewhere == 0) {
			most = p->exponent[t][input];
			term[most] = t;
		}
	}
	memset(change, 0, sizeof *change);
	for (int k = 0; k <= most; k++)
		for (int l = 0; l <= k; l++) {
			const size_t at = term[l] * n + term[k]; // upper triangle
			double sum = (all[at] - of[at]) / (s->n[FOLDS] - s->n[fold]);
			for (int m = 0; m < l; m++)
				sum -= change->factor[k][m] * change->factor[l][m];
			change->factor[k][l] = l < k ? sum / change->factor[l][l] : sqrt(fmax(sum, DBL_MIN));
		}
}

/* Coefficients of the fit without a fold, for polynomials that are orthonormal over its samples, so that the indices are those of the
 * distribution of these samples. */
static void coefficients_change(const struct pound_polynomial *p, const struct space *s, int fold,
                                double *changed)
{
	const int used = p->terms_of[p->chosen], d = p->n_inputs;
	const double *coefficients = coefficients_of(p, s, fold, p->chosen);
	struct axis_change change[POUND_INPUTS_MAX];
	memcpy(changed, coefficients, sizeof *changed * (size_t)used);
	if (fold == FOLDS)
		return;
	for (int j = 0; j < d; j++)
		change_fill(p, s, fold, j, &change[j]);
	memset(changed, 0, sizeof *changed * (size_t)used);
	for (int from = 0; from < used; from++)
		for (int to = 0; to <= from; to++) {
			double factor = coefficients[from];
			for (int j = 0; j < d && factor != 0.0; j++)
				factor *= change[j].factor[p->exponent[from][j]][p->exponent[to][j]];
			changed[to] += factor;
		}
}

/* First-order, total and second-order indices of the fit without a fold.
 *
 * Given    noise       variance of an output about the fit
 * Returns  value       (n_values)
 *
 * The variance is the sum of the squared coefficients and the variance about the fit: its error has much in common with the
 * error of the coefficients, unlike the error of the variance of the samples.
 */
static void values_of(const struct pound_polynomial *p, const struct space *s, int fold, double noise,
                      double *value)
{
	const int n = p->terms_of[p->degree], used = p->terms_of[p->chosen], d = p->n_inputs;
	const double count = s->n[FOLDS] - (fold < FOLDS ? s->n[fold] : 0),
	             of_noise = (s->noise[FOLDS] - (fold < FOLDS ? s->noise[fold] : 0.0)) / count;
	double coefficients[TERMS_MAX], variance = fmax(0.0, noise - of_noise);
	coefficients_change(p, s, fold, coefficients);
	memset(value, 0, sizeof *value * (size_t)n_values(p));
	factor_fill(p, s, fold);
	for (int t = 1; t < used; t++) {
		double unit[TERMS_MAX] = {0}, own = 0.0;
		int first = -1, last = -1, inputs = 0;
		unit[t] = 1.0;
		solve_forward(s->factor, n, used, unit);
		for (int k = t; k < used; k++)
			own += unit[k] * unit[k];
		const double part = coefficients[t] * coefficients[t] - noise * own;
		variance += part;
		for (int j = 0; j < d; j++) {
			if (p->exponent[t][j] == 0)
				continue;
			value[d + j] += part;
			first = first < 0 ? j : first;
			last = j;
			inputs++;
		}
		if (inputs == 1)
			value[first] += part;
		// pairs (0, 1), (0, 2) ... (1, 2) ...
		if (inputs == 2)
			value[2 * d + first * (2 * d - first - 1) / 2 + last - first - 1] += part;
	}
	for (int v = 0; v < n_values(p); v++)
		value[v] /= variance;
}

static void values_fill(struct pound_polynomial *p, const struct space *s, double noise)
{
	double all[VALUES_MAX], without[FOLDS][VALUES_MAX];
	values_of(p, s, FOLDS, noise, all);
	for (int fold = 0; fold < FOLDS; fold++)
		values_of(p, s, fold, noise, without[fold]);
	for (int v = 0; v < n_values(p); v++) {
		double mean = 0.0, squares = 0.0;
		for (int fold = 0; fold < FOLDS; fold++)
			mean += without[fold][v] / FOLDS;
		for (int fold = 0; fold < FOLDS; fold++)
			squares += (without[fold][v] - mean) * (without[fold][v] - mean);
		const double half = pound_jackknife_student(FOLDS - 1) * sqrt((FOLDS - 1.0) / FOLDS * squares);
		p->value[v] = (struct pound_estimate){all[v], all[v] - half, all[v] + half};
	}
}

/* ---- all together ---- */

/* Fits the polynomial that predicts best, and computes its indices.
 *
 * Given    p           n_rows, n_inputs, u, noise    u in (0, 1); rows in no order
 *          y           (n_rows)                      less their mean
 * Returns  p           all other members
 * Memory   scratch     (pound_polynomial_scratch)    held by p
 *
 * For independent inputs an index of the output is at least the fit's index, and larger by at most the unexplained fraction:
 *
 *   y = g + h, h orthogonal to all terms;   T_j(y) = T_j(g) + T_j(h),   0 <= T_j(h) <= 1 - R2,   and so for S_j and S_jk
 *
 * Valid    Independent inputs for the indices; any inputs for the predictions
 * Source   Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964-979, for the indices of a polynomial
 * Test     unit_given_data
 */
void pound_polynomial_fit(struct pound_polynomial *p, const double *y, double *scratch)
{
	struct space s;
	double error[DEGREE_MAX + 1];
	for (int j = 0; j < p->n_inputs; j++)
		axis_fill(p, j);
	terms_fill(p);
	carve(&s, scratch, p->n_rows, p->terms_of[p->degree]);
	sums_fill(p, y, &s);
	for (int fold = 0; fold <= FOLDS; fold++)
		coefficients_fill(p, &s, fold);
	errors_fill(p, y, &s, error);
	p->chosen = 0;
	for (int degree = 1; degree <= p->degree; degree++)
		if (error[degree] < error[p->chosen])
			p->chosen = degree;
	// without the noise, which no polynomial predicts
	p->explained = 1.0 - fmax(0.0, error[p->chosen] - s.noise[FOLDS]) / (error[0] - s.noise[FOLDS]);
	p->coefficients = coefficients_of(p, &s, FOLDS, p->chosen);
	p->fit = s.fit;
	predictions_fill(p, &s);
	values_fill(p, &s, error[p->chosen] / p->n_rows);
}

double pound_polynomial_effect(const struct pound_polynomial *p, int input, double u)
{
	double value[DEGREE_MAX + 1], effect = 0.0;
	axis_values(&p->axis[input], u, value);
	for (int t = 0; t < p->terms_of[p->chosen]; t++) {
		int elsewhere = 0;
		for (int j = 0; j < p->n_inputs; j++)
			elsewhere += j == input ? 0 : p->exponent[t][j];
		effect += elsewhere ? 0.0 : p->coefficients[t] * value[p->exponent[t][input]];
	}
	return effect;
}
