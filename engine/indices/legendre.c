/* legendre.c - sums, expansions and products of orthonormal polynomials of several inputs. */
#include "engine/indices/legendre.h"

#include "engine/pound.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum { CHUNK = POUND_LEGENDRE_CHUNK, DEGREE_MAX = 2 * POUND_LEGENDRE_DEGREE_MAX };

/* Number of terms of total degree up to `degree`: binomial (n_inputs + degree) over degree. */
int pound_legendre_terms(int n_inputs, int degree)
{
	int64_t terms = 1;
	for (int k = 1; k <= degree; k++)
		terms = terms * (n_inputs + k) / k;
	return (int)terms;
}

static double *column(const struct pound_legendre *chunk, int input, int degree)
{
	return chunk->column + ((size_t)input * (chunk->degree + 1) + degree) * CHUNK;
}

/* An empty chunk.  The polynomials L_k(u) = sqrt(2 k + 1) P_k(2 u - 1) follow from
 *
 *   L_(k+1) = up_k (2 u - 1) L_k - down_k L_(k-1),   up_k = sqrt((2k+1) (2k+3)) / (k+1),
 *   down_k = k sqrt((2k+3) / (2k-1)) / (k+1)
 *
 * Test     unit_legendre: sums_of_terms_are_those_of_their_values
 */
void pound_legendre_init(struct pound_legendre *chunk, int n_inputs, int degree)
{
	assert(n_inputs >= 1 && degree <= DEGREE_MAX);
	*chunk = (struct pound_legendre){.n_inputs = n_inputs, .degree = degree};
	for (int k = 0; k < degree; k++) {
		chunk->up[k] = sqrt((2.0 * k + 1.0) * (2.0 * k + 3.0)) / (k + 1.0);
		chunk->down[k] = k == 0 ? 0.0 : k * sqrt((2.0 * k + 3.0) / (2.0 * k - 1.0)) / (k + 1.0);
	}
}

/* Sets one input of one point. */
void pound_legendre_point(const struct pound_legendre *chunk, int point, int input, double u)
{
	double *l = column(chunk, input, 0) + point, z = 2.0 * u - 1.0, before = 0.0, here = 1.0;
	for (int k = 0; k < chunk->degree; k++, l += CHUNK) {
		*l = here;
		double next = chunk->up[k] * z * here - chunk->down[k] * before;
		before = here;
		here = next;
	}
	*l = here;
}

typedef double pair __attribute__((vector_size(16), may_alias, aligned(8)));

/* Scalar product in four partial sums. */
static double dot(const double *x, const double *y, int n)
{
	pair sum[2] = {{0}};
	double rest = 0.0;
	int i = 0;
	for (; i + 3 < n; i += 4) {
		sum[0] += *(const pair *)(x + i) * *(const pair *)(y + i);
		sum[1] += *(const pair *)(x + i + 2) * *(const pair *)(y + i + 2);
	}
	for (; i < n; i++)
		rest += x[i] * y[i];
	sum[0] += sum[1];
	return sum[0][0] + sum[0][1] + rest;
}

/* The partial product times the next input's polynomial; degree 0 returns the product itself. */
static const double *times(const struct pound_legendre *chunk, int input, int degree, const double *product)
{
	if (degree == 0)
		return product;
	double *next = chunk->product + (size_t)input * CHUNK;
	const double *l = column(chunk, input, degree);
	for (int i = 0; i < chunk->n; i++)
		next[i] = product[i] * l[i];
	return next;
}

static double *project_from(const struct pound_legendre *chunk, int input, int degree, const double *product,
                            double *sums)
{
	for (int k = 0; k <= degree; k++)
		if (input == chunk->n_inputs - 1)
			*sums++ += dot(product, column(chunk, input, k), chunk->n);
		else
			sums = project_from(chunk, input + 1, degree - k, times(chunk, input, k, product), sums);
	return sums;
}

/* Adds to the sums over the points of value times term.
 *
 * Given    value     (POUND_LEGENDRE_CHUNK)     of each point
 * Returns  sums      (terms of degree)          += sum over the points of value times term
 *
 * Test     unit_legendre: terms_are_orthonormal
 */
void pound_legendre_project(const struct pound_legendre *chunk, int degree, const double *value, double *sums)
{
	assert(degree <= chunk->degree);
	project_from(chunk, 0, degree, value, sums);
}

static const double *expand_from(const struct pound_legendre *chunk, int input, int degree,
                                 const double *product, const double *coefficients, double *value)
{
	for (int k = 0; k <= degree; k++)
		if (input == chunk->n_inputs - 1) {
			const double *l = column(chunk, input, k), factor = *coefficients++;
			for (int i = 0; i < chunk->n; i++)
				value[i] += factor * (product[i] * l[i]);
		} else {
			const double *next = times(chunk, input, k, product);
			coefficients = expand_from(chunk, input + 1, degree - k, next, coefficients, value);
		}
	return coefficients;
}

/* Values of a sum of terms at the points.
 *
 * Given    coefficients   (terms of degree)
 * Returns  value          (POUND_LEGENDRE_CHUNK)
 *
 * Test     unit_legendre: an_expansion_is_the_sum_of_its_terms
 */
void pound_legendre_expand(const struct pound_legendre *chunk, int degree, const double *coefficients,
                           double *value)
{
	double one[CHUNK];
	assert(degree <= chunk->degree);
	for (int i = 0; i < chunk->n; i++) {
		one[i] = 1.0;
		value[i] = 0.0;
	}
	expand_from(chunk, 0, degree, one, coefficients, value);
}

bool pound_legendre_next(int n_inputs, int degree, int *degrees)
{
	int total = 0;
	for (int j = 0; j < n_inputs; j++)
		total += degrees[j];
	for (int j = n_inputs - 1; j >= 0; j--) {
		if (total < degree) {
			degrees[j]++;
			return true;
		}
		total -= degrees[j];
		degrees[j] = 0;
	}
	return false;
}

/* Coefficients that turn products of terms into sums of terms. */
struct linearisation {
	int n_inputs;
	/* L_a L_b = sum over c of weight[a][b][c] L_c */
	double weight[POUND_LEGENDRE_DEGREE_MAX + 1][POUND_LEGENDRE_DEGREE_MAX + 1][DEGREE_MAX + 1];
	/* place[j][r][c]: number of terms before the terms of degree c in input j, if degree r is left for inputs j and later */
	int place[POUND_INPUTS_MAX][DEGREE_MAX + 1][DEGREE_MAX + 1];
};

/* The product of two Legendre polynomials as a sum of Legendre polynomials.
 *
 *   P_a P_b = sum over r of A_r A_(a-r) A_(b-r) / A_(a+b-r) (2 c + 1) / (2 a + 2 b - 2 r + 1) P_c,   c = a + b - 2 r,
 *   A_r = 1 3 5 .. (2 r - 1) / r!
 *
 * Source   Adams 1878, Proc. R. Soc. Lond. 27, 63-71
 * Test     unit_legendre: the_gram_matrix_is_that_of_the_terms_values
 */
static void linearisation_init(struct linearisation *l, int n_inputs, int degree)
{
	double a_of[DEGREE_MAX + 1] = {1.0};
	for (int r = 1; r <= 2 * degree; r++)
		a_of[r] = a_of[r - 1] * (2.0 * r - 1.0) / r;
	memset(l, 0, sizeof *l);
	l->n_inputs = n_inputs;
	for (int a = 0; a <= degree; a++)
		for (int b = 0; b <= degree; b++)
			for (int r = 0; r <= a && r <= b; r++) {
				int c = a + b - 2 * r;
				double adams = a_of[r] * a_of[a - r] * a_of[b - r] / a_of[a + b - r] * (2.0 * c + 1.0) /
				               (2.0 * (a + b - r) + 1.0);
				l->weight[a][b][c] = adams * sqrt((2.0 * a + 1.0) * (2.0 * b + 1.0) / (2.0 * c + 1.0));
			}
	for (int j = 0; j < n_inputs; j++)
		for (int left = 0; left <= 2 * degree; left++)
			for (int c = 0; c < left; c++)
				l->place[j][left][c + 1] =
				    l->place[j][left][c] + pound_legendre_terms(n_inputs - 1 - j, left - c);
}

/* Sum over the points of the product of two terms, from the sums of single terms. */
static double product_sum(const struct linearisation *l, int input, int left, const int *p, const int *q,
                          const double *sums)
{
	if (input == l->n_inputs)
		return *sums;
	const int a = p[input], b = q[input], *place = l->place[input][left];
	if (a == 0 || b == 0)
		return product_sum(l, input + 1, left - a - b, p, q, sums + place[a + b]);
	double sum = 0.0;
	for (int c = a > b ? a - b : b - a; c <= a + b; c += 2)
		sum += l->weight[a][b][c] * product_sum(l, input + 1, left - c, p, q, sums + place[c]);
	return sum;
}

/* Sums of products of terms over points, from the sums of terms of twice the degree.
 *
 * Given    sums     (terms of 2 degree)             sum over the points of each term
 * Returns  gram     (terms of degree, squared)      upper triangle: sum over the points of the products of two terms
 *
 * For 4 inputs and degree 6 this takes 1820 sums over the points instead of 22155.
 *
 * Test     unit_legendre: the_gram_matrix_is_that_of_the_terms_values
 */
void pound_legendre_gram(int n_inputs, int degree, const double *sums, double *gram)
{
	const int terms = pound_legendre_terms(n_inputs, degree);
	struct linearisation l;
	int p[POUND_INPUTS_MAX] = {0};
	linearisation_init(&l, n_inputs, degree);
	for (int row = 0; row < terms; row++, pound_legendre_next(n_inputs, degree, p)) {
		int q[POUND_INPUTS_MAX];
		memcpy(q, p, sizeof q);
		for (int k = row; k < terms; k++, pound_legendre_next(n_inputs, degree, q))
			gram[(size_t)row * terms + k] = product_sum(&l, 0, 2 * degree, p, q, sums);
	}
}

/* x -= factor y */
static void subtract(double *x, double factor, const double *y, int n)
{
	int k = 0;
	for (; k + 1 < n; k += 2)
		*(pair *)(x + k) -= factor * *(const pair *)(y + k);
	if (k < n)
		x[k] -= factor * y[k];
}

/* Cholesky factor of a Gram matrix, in the upper triangle, with the inverse diagonal.
 *
 * A term that is linearly dependent on earlier terms at the points has the inverse diagonal 0.
 */
void pound_legendre_factor(double *gram, int n)
{
	double largest = 0.0;
	for (int i = 0; i < n; i++)
		largest = fmax(largest, gram[(size_t)i * n + i]);
	for (int i = 0; i < n; i++) {
		double *row = gram + (size_t)i * n;
		double inverse = row[i] > n * DBL_EPSILON * largest ? 1.0 / sqrt(row[i]) : 0.0;
		for (int k = i; k < n; k++)
			row[k] *= inverse;
		for (int r = i + 1; r < n; r++)
			subtract(gram + (size_t)r * n + r, row[r], row + r, n - r);
		row[i] = inverse;
	}
}

/* Solves gram x = b; x overwrites b.
 *
 * Given    factor    of gram, by pound_legendre_factor
 *
 * A term that is linearly dependent on earlier terms at the points gets the coefficient 0.
 *
 * Test     unit_chaos_expansion: a_polynomial_within_the_degree_is_met_exactly
 */
void pound_legendre_solve(const double *factor, int n, double *b)
{
	for (int i = 0; i < n; i++) {
		const double *row = factor + (size_t)i * n;
		b[i] *= row[i];
		subtract(b + i + 1, b[i], row + i + 1, n - i - 1);
	}
	for (int i = n - 1; i >= 0; i--) {
		const double *row = factor + (size_t)i * n;
		for (int k = i + 1; k < n; k++)
			b[i] -= row[k] * b[k];
		b[i] *= row[i];
	}
}
