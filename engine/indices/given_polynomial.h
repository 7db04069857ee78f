/* given_polynomial.h - a polynomial fitted to given data, and the variance fractions of its terms. */
#ifndef GIVEN_POLYNOMIAL_H
#define GIVEN_POLYNOMIAL_H

#include "engine/result.h"

enum {
	POUND_POLYNOMIAL_DEGREE_MAX = 6,
	POUND_POLYNOMIAL_TERMS_MAX = 300,
	POUND_POLYNOMIAL_VALUES_MAX = 2 * POUND_INPUTS_MAX + POUND_PAIRS_MAX,
};

/* Polynomials of one input, orthonormal over the samples: p_k, of degree k up to `most`, by the recurrence
 *   h[k+1] p_{k+1} = (u - 1/2 - a[k]) p_k - h[k] p_{k-1} */
struct pound_polynomial_axis {
	int most;
	double a[POUND_POLYNOMIAL_DEGREE_MAX], h[POUND_POLYNOMIAL_DEGREE_MAX + 1];
};

struct pound_polynomial {
	int n_rows, n_inputs;
	const double *u;     /* (n_rows x 2 x n_inputs), only the first of each pair of rows is read */
	const double *noise; /* standard deviations of the noise of the outputs, 0: not known  (n_rows) */
	struct pound_polynomial_axis axis[POUND_INPUTS_MAX];
	int degree;                                    /* the largest that the samples allow */
	int terms_of[POUND_POLYNOMIAL_DEGREE_MAX + 1]; /* terms up to each degree, lower ones first */
	unsigned char exponent[POUND_POLYNOMIAL_TERMS_MAX][POUND_INPUTS_MAX];
	// the fit
	double explained;           /* cross-validated R2 */
	int chosen;                 /* best degree */
	const double *coefficients; /* (terms_of[chosen]) */
	const double *fit;          /* out-of-fold prediction of each sample, less the mean  (n_rows) */
	// first-order and total indices of the inputs, then second-order indices of the pairs in order, with sampling errors only
	struct pound_estimate value[POUND_POLYNOMIAL_VALUES_MAX];
};

size_t pound_polynomial_scratch(int n_rows, int n_inputs); /* doubles */
void pound_polynomial_fit(struct pound_polynomial *p, const double *y, double *scratch);
/* The main effect of one input in the fit, at probability u. */
double pound_polynomial_effect(const struct pound_polynomial *p, int input, double u);

#endif
