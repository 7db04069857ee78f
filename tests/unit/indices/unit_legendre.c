/* unit_legendre.c - polynomials of several inputs against closed forms and against each other. */
#include "engine/indices/legendre.h"
#include "tests/support/check.h"

#include <gsl/gsl_sf_legendre.h>
#include <math.h>
#include <string.h>

enum { D = 3, DEGREE = 4, POINTS = 200, CHUNK = POUND_LEGENDRE_CHUNK };

/* Points that fill the cube, with all polynomials up to twice the degree. */
static struct pound_legendre points(int n_inputs, double (*u)[D])
{
	struct pound_legendre chunk;
	pound_legendre_init(&chunk, n_inputs, 2 * DEGREE);
	chunk.n = POINTS;
	chunk.column = malloc(sizeof(double) * n_inputs * (2 * DEGREE + 2) * CHUNK);
	chunk.product = chunk.column + n_inputs * (2 * DEGREE + 1) * CHUNK;
	for (int i = 0; i < POINTS; i++)
		for (int j = 0; j < n_inputs; j++) {
			u[i][j] = fmod(0.5 + (i + 1) * sqrt(2.0 + 3.0 * j), 1.0);
			pound_legendre_point(&chunk, i, j, u[i][j]);
		}
	return chunk;
}

static double term(const int *degrees, const double *u)
{
	double value = 1.0;
	for (int j = 0; j < D; j++)
		value *= sqrt(2.0 * degrees[j] + 1.0) * gsl_sf_legendre_Pl(degrees[j], 2.0 * u[j] - 1.0);
	return value;
}

static void terms_are_enumerated_once_each_with_the_last_input_fastest(void **state)
{
	(void)state;
	assert_int_equal(pound_legendre_terms(4, 6), 210);
	assert_int_equal(pound_legendre_terms(4, 12), 1820);
	assert_int_equal(pound_legendre_terms(0, 5), 1);
	int degrees[2] = {0};
	static const int want[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {2, 0}};
	for (int k = 0; k < 6; k++) {
		assert_memory_equal(degrees, want[k], sizeof degrees);
		assert_true(pound_legendre_next(2, 2, degrees) == (k < 5));
	}
}

static void sums_of_terms_are_those_of_their_values(void **state)
{
	(void)state;
	double u[POINTS][D], value[CHUNK], sums[200] = {0};
	struct pound_legendre chunk = points(D, u);
	for (int i = 0; i < POINTS; i++)
		value[i] = 1.0 + u[i][0];
	pound_legendre_project(&chunk, DEGREE, value, sums);
	int degrees[D] = {0};
	for (int k = 0; k < pound_legendre_terms(D, DEGREE); k++, pound_legendre_next(D, DEGREE, degrees)) {
		double want = 0.0;
		for (int i = 0; i < POINTS; i++)
			want += value[i] * term(degrees, u[i]);
		check_near(sums[k], want, 1e-11); // 200 terms of up to 3^4
	}
	free(chunk.column);
}

static void an_expansion_is_the_sum_of_its_terms(void **state)
{
	(void)state;
	double u[POINTS][D], coefficients[35], value[CHUNK];
	struct pound_legendre chunk = points(D, u);
	for (int k = 0; k < 35; k++)
		coefficients[k] = cos(3.0 * k);
	pound_legendre_expand(&chunk, DEGREE, coefficients, value);
	for (int i = 0; i < POINTS; i++) {
		double want = 0.0;
		int degrees[D] = {0};
		for (int k = 0; k < 35; k++, pound_legendre_next(D, DEGREE, degrees))
			want += coefficients[k] * term(degrees, u[i]);
		check_near(value[i], want, 1e-12);
	}
	free(chunk.column);
}

static void the_gram_matrix_is_that_of_the_terms_values(void **state)
{
	(void)state;
	double u[POINTS][D], one[CHUNK], sums[200] = {0}, gram[35 * 35];
	struct pound_legendre chunk = points(D, u);
	for (int i = 0; i < POINTS; i++)
		one[i] = 1.0;
	pound_legendre_project(&chunk, 2 * DEGREE, one, sums);
	pound_legendre_gram(D, DEGREE, sums, gram);
	int p[D] = {0};
	for (int row = 0; row < 35; row++, pound_legendre_next(D, DEGREE, p)) {
		int q[D] = {0};
		for (int k = 0; k <= row; k++, pound_legendre_next(D, DEGREE, q)) {
			double want = 0.0;
			for (int i = 0; i < POINTS; i++)
				want += term(p, u[i]) * term(q, u[i]);
			check_near(gram[k * 35 + row], want, 1e-10);
		}
	}
	free(chunk.column);
}

static void terms_are_orthonormal(void **state)
{
	(void)state;
	// sums of single terms over the whole cube: 1 for term 0, 0 for all others
	double sums[200] = {1.0}, gram[35 * 35];
	pound_legendre_gram(D, DEGREE, sums, gram);
	for (int row = 0; row < 35; row++)
		for (int k = 0; k <= row; k++)
			check_near(gram[k * 35 + row], row == k, 1e-14);
}

CHECK_MAIN(cmocka_unit_test(terms_are_enumerated_once_each_with_the_last_input_fastest),
           cmocka_unit_test(sums_of_terms_are_those_of_their_values),
           cmocka_unit_test(an_expansion_is_the_sum_of_its_terms),
           cmocka_unit_test(the_gram_matrix_is_that_of_the_terms_values),
           cmocka_unit_test(terms_are_orthonormal))
