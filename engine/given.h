/* given.h - sensitivity indices from given data: samples drawn elsewhere, one output value each, no design.
 *
 *   inputs -> check, once -> indices of each output
 *
 * Nothing is allocated; any thread. */
#ifndef GIVEN_H
#define GIVEN_H

#include "engine/result.h"

enum { POUND_GIVEN_ROWS_MIN = 64 };

/* Samples of independent draws of the inputs. */
struct pound_given {
	int n_rows, n_inputs;       /* [POUND_GIVEN_ROWS_MIN, POUND_ROWS_MAX], [1, POUND_INPUTS_MAX] */
	const double *x;            /* finite; each input has at least two distinct values  (n_rows x n_inputs) */
	struct pound_input *inputs; /* empirical distributions of x, by pound_given_inputs  (n_inputs) */
};

/* Notes on the samples: X(enumerator, sentence). */
// clang-format off
#define POUND_GIVEN_SAMPLES_NOTES(X)                                                  \
	X(POUND_GIVEN_NOISE,                                                              \
	  "given data cannot separate the noise of an output from interactions of its inputs: S1 is a share of the variance with the noise") \
	X(POUND_GIVEN_DEPENDENT,                                                          \
	  "the inputs are not independent: S1 includes what an input explains through the inputs that it depends on, and ST and S2 cannot be estimated") \
	X(POUND_GIVEN_ARRANGED,                                                           \
	  "samples that are near in one input have a pattern in another, as points of a Sobol' or Halton sequence or rows of `pound design' have: S1 needs a polynomial that fits; for rows of `pound design' use `pound indices STUDY.json Y.csv'") \
	X(POUND_GIVEN_SERIAL,                                                             \
	  "successive samples are correlated, as in a Markov chain: intervals are too narrow")

/* Notes on the indices of an output. */
#define POUND_GIVEN_NOTES(X)                                                          \
	X(POUND_GIVEN_CONSTANT,                                                           \
	  "the output is the same for every sample, so it has no indices")                \
	X(POUND_GIVEN_UNEXPLAINED,                                                        \
	  "ST and S2 cannot be estimated: the cross-validated R2 of the polynomial is below 0.9; use more samples, or run your model on the rows of `pound design'") \
	X(POUND_GIVEN_FIRST_UNKNOWN,                                                      \
	  "S1 cannot be estimated: no polynomial fits, and the samples are not random")   \
	X(POUND_GIVEN_FEW_DECIDE,                                                         \
	  "fewer than 5 samples dominate the variance, so intervals may be too narrow: use more samples")
// clang-format on

#define X(name, text) name,
enum pound_given_samples_note { POUND_GIVEN_SAMPLES_NOTES(X) POUND_GIVEN_N_SAMPLES_NOTES };
enum pound_given_note { POUND_GIVEN_NOTES(X) POUND_GIVEN_N_NOTES };
#undef X

struct pound_given_checks {
	int pair[2];        /* inputs that depend most on each other; -1: there is one input */
	double correlation; /* of the pair's ranks (Spearman) */
	unsigned notes;     /* bits 1 << enum pound_given_samples_note */
};

struct pound_given_indices {
	double mean, variance;
	double explained;  /* cross-validated R2 of the polynomial; NAN: none was fitted */
	int degree, terms; /* of the polynomial */
	unsigned notes;    /* bits 1 << enum pound_given_note */
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX]; /* (n_inputs) each */
	int n_second;                                                           /* 0: cannot be estimated */
	struct pound_set_index second[POUND_PAIRS_MAX];                         /* (n_second) */
	struct pound_curve curves[POUND_INPUTS_MAX];                            /* (n_inputs) */
};

/* Sets the distributions of the inputs; values: their memory  (2 x n_inputs x n_rows); order: scratch  (n_rows) */
void pound_given_inputs(struct pound_given *given, double *values, size_t *order);

size_t pound_given_scratch(int n_rows, int n_inputs); /* doubles */
void pound_given_check(const struct pound_given *given, double *scratch, struct pound_given_checks *checks);
/* y: (n_rows), finite; scratch: as pound_given_check left it */
void pound_given_estimate(const struct pound_given *given, const struct pound_given_checks *checks,
                          const double *y, double *scratch, struct pound_given_indices *indices);

#endif
