/* given_polynomial.h - a polynomial of samples that were drawn elsewhere, and the shares of the variance that its terms have. */
#ifndef GIVEN_POLYNOMIAL_H
#define GIVEN_POLYNOMIAL_H

#include "engine/result.h"

enum {
	POUND_POLYNOMIAL_DEGREE_MAX = 6,
	POUND_POLYNOMIAL_TERMS_MAX = 300,
	POUND_POLYNOMIAL_VALUES_MAX = 2 * POUND_INPUTS_MAX + POUND_PAIRS_MAX,
};

/* Polynomials of one input after the other, orthonormal over the samples: p_k, of degree k up to `most`, by the recurrence
 *   h[k+1] p_{k+1} = (u - 1/2 - a[k]) p_k - h[k] p_{k-1} */
struct pound_polynomial_axis {
	int most;
	double a[POUND_POLYNOMIAL_DEGREE_MAX], h[POUND_POLYNOMIAL_DEGREE_MAX + 1];
};

struct pound_polynomial {
	int n_rows, n_inputs;
	const double *u; /* (n_rows x 2 x n_inputs), of which the first of each pair of rows counts */
	struct pound_polynomial_axis axis[POUND_INPUTS_MAX];
	int degree;                                    /* the largest that there are samples for */
	int terms_of[POUND_POLYNOMIAL_DEGREE_MAX + 1]; /* terms up to each degree, lower ones first */
	unsigned char exponent[POUND_POLYNOMIAL_TERMS_MAX][POUND_INPUTS_MAX];
	// the fit
	double explained;           /* cross-validated R2 */
	int chosen;                 /* degree of the best */
	const double *coefficients; /* (terms_of[chosen]) */
	const double *fit;          /* of each sample, by the fit that has not seen it, less the mean  (n_rows) */
	// first-order and total indices of the inputs, and second-order ones of the pairs in order, with sampling errors alone
	struct pound_estimate value[POUND_POLYNOMIAL_VALUES_MAX];
};

size_t pound_polynomial_scratch(int n_rows, int n_inputs); /* doubles */
void pound_polynomial_fit(struct pound_polynomial *p, const double *y, double *scratch);
/* The part of the fit in one input alone, where its probability is u. */
double pound_polynomial_effect(const struct pound_polynomial *p, int input, double u);

#endif
