/* legendre.h - polynomials of several inputs, orthonormal for independent uniform inputs.
 *
 * A term is a product of Legendre polynomials, one of each input, of total degree up to a bound.  Terms are numbered
 * with the degree in the last input running fastest; term 0 is 1.  Points are processed in chunks, for speed. */
#ifndef LEGENDRE_H
#define LEGENDRE_H

#include <stdbool.h>

enum { POUND_LEGENDRE_DEGREE_MAX = 6, POUND_LEGENDRE_CHUNK = 256 };

/* Up to POUND_LEGENDRE_CHUNK points and the values of the one-dimensional polynomials there. */
struct pound_legendre {
	int n_inputs, degree; /* largest degree passed to any function */
	int n;                /* points */
	double up[2 * POUND_LEGENDRE_DEGREE_MAX], down[2 * POUND_LEGENDRE_DEGREE_MAX]; /* of the recurrence */
	double *column;  /* (n_inputs x (degree + 1) x POUND_LEGENDRE_CHUNK) */
	double *product; /* (n_inputs x POUND_LEGENDRE_CHUNK), scratch */
};

/* Sets all but the points and the memory. */
void pound_legendre_init(struct pound_legendre *chunk, int n_inputs, int degree);
int pound_legendre_terms(int n_inputs, int degree); /* number of terms of total degree up to `degree` */
void pound_legendre_point(const struct pound_legendre *chunk, int point, int input, double u);
void pound_legendre_project(const struct pound_legendre *chunk, int degree, const double *value,
                            double *sums);
void pound_legendre_expand(const struct pound_legendre *chunk, int degree, const double *coefficients,
                           double *value);
void pound_legendre_gram(int n_inputs, int degree, const double *sums, double *gram);

/* Least squares: gram x = b, x overwrites b  (n); the factor overwrites the upper triangle of gram  (n x n). */
void pound_legendre_factor(double *gram, int n);
void pound_legendre_solve(const double *factor, int n, double *b);

/* The next term's degrees; false after the last. */
bool pound_legendre_next(int n_inputs, int degree, int *degrees);

#endif
