/* given.h - sensitivity indices from given data: samples drawn elsewhere, no design.
 *
 *   rows -> samples: replicates are joined -> check, once -> indices of each output
 *
 * Nothing is allocated; any thread. */
#ifndef GIVEN_H
#define GIVEN_H

#include "engine/result.h"

enum { POUND_GIVEN_ROWS_MIN = 64 };

/* Samples of independent draws of the inputs, or a complete factorial design. */
struct pound_given {
	int n_rows, n_inputs;       /* [POUND_GIVEN_ROWS_MIN, POUND_ROWS_MAX], [1, POUND_INPUTS_MAX] */
	const double *x;            /* finite; each input has at least two distinct values  (n_rows x n_inputs) */
	bool joined;                /* samples are means of replicates, by pound_given_join */
	bool pooled;                /* the noise is the spread of samples with the same inputs */
	bool noise_known;           /* the noise variance of every sample's output is known */
	bool sorted;                /* the rows are sorted by a column: their order says nothing */
	struct pound_input *inputs; /* empirical distributions of x, by pound_given_inputs  (n_inputs) */
	/* of a complete factorial design, by pound_given_inputs: all combinations of the levels, equally often */
	int replicates;               /* rows of each combination; 0: not a factorial design */
	int levels[POUND_INPUTS_MAX]; /* (n_inputs) */
	bool unbalanced;              /* almost one: lines are missing or repeated */
	int *cell;                    /* combination of each row, the last input's level fastest  (n_rows) */
};

/* Notes on the samples: X(enumerator, sentence). */
// clang-format off
#define POUND_GIVEN_SAMPLES_NOTES(X)                                                  \
	X(POUND_GIVEN_NOISE,                                                              \
	  "given data cannot separate the noise of an output from interactions of its inputs: S1 is a share of the variance with the noise") \
	X(POUND_GIVEN_DEPENDENT,                                                          \
	  "the inputs are not independent: S1 includes what an input explains through the inputs that it depends on, and ST and S2 cannot be estimated") \
	X(POUND_GIVEN_NOT_MONOTONIC,                                                      \
	  "the dependence of the inputs is not monotonic, so their rank correlation is small") \
	X(POUND_GIVEN_COLLINEAR,                                                          \
	  "the rank correlation of two inputs is nearly 1 or -1: these samples cannot separate their effects") \
	X(POUND_GIVEN_ARRANGED,                                                           \
	  "samples that are near in one input have a pattern in another, as points of a Sobol' or Halton sequence, an incomplete grid or rows of `pound design' have: S1 needs a polynomial that fits; for rows of `pound design' use `pound indices STUDY.json Y.csv'") \
	X(POUND_GIVEN_SERIAL,                                                             \
	  "successive samples are correlated: if they are of a Markov chain or a time series, intervals are too narrow; if their lines were sorted, intervals are valid") \
	X(POUND_GIVEN_REPLICATES,                                                         \
	  "rows with the same values of all inputs are replicates of one sample: their mean counts once, however many they are") \
	X(POUND_GIVEN_POOLED,                                                             \
	  "the spread of the output among samples with the same inputs is its noise, and the indices are those of the mean without noise") \
	X(POUND_GIVEN_FACTORIAL,                                                          \
	  "the samples are a complete factorial design: indices are those of its levels, all equally likely") \
	X(POUND_GIVEN_UNBALANCED,                                                         \
	  "the samples are almost a factorial design, but the combinations of its levels do not all have the same number of lines: they are analyzed as samples drawn at random; add or leave out lines to have the analysis of a factorial design") \
	X(POUND_GIVEN_ONE_INPUT,                                                          \
	  "of one input alone with equally frequent values, S1 is 1 by construction: all variance that is not noise is due to it; noise_share has the fraction of the noise")

/* Notes on the indices of an output. */
#define POUND_GIVEN_NOTES(X)                                                          \
	X(POUND_GIVEN_CONSTANT,                                                           \
	  "the output is the same for every sample, so it has no indices")                \
	X(POUND_GIVEN_ALL_NOISE,                                                          \
	  "the variance of the output may be that of its noise alone, so indices cannot be estimated: use more replicates") \
	X(POUND_GIVEN_UNEXPLAINED,                                                        \
	  "ST and S2 cannot be estimated: the cross-validated R2 of the polynomial is below 0.9; use more samples, or run your model on the rows of `pound design'") \
	X(POUND_GIVEN_NOISE_LIMITS,                                                       \
	  "noise or missing inputs may be the cause, which more samples do not remove: give replicates, or add these inputs") \
	X(POUND_GIVEN_FIRST_UNKNOWN,                                                      \
	  "S1 cannot be estimated: no polynomial fits, and the samples are not random")   \
	X(POUND_GIVEN_FEW_DECIDE,                                                         \
	  "few samples hold most of the variance: intervals may be too narrow, and ST and S2 are left out, because a polynomial fits such samples best where the decisive ones are missing; use more samples") \
	X(POUND_GIVEN_LOGARITHM,                                                          \
	  "all values of the output are positive: indices of its logarithm need fewer samples")
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
	double mean,
	    variance; /* of the samples; of a factorial design with replicates: of the means of its combinations */
	double noise_share; /* fraction of the variance due to the noise; NAN: not known */
	double explained;   /* cross-validated R2 of the polynomial; NAN: none was fitted */
	int degree, terms;  /* of the polynomial */
	unsigned notes;     /* bits 1 << enum pound_given_note */
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX]; /* (n_inputs) each */
	int n_second;                                                           /* 0: cannot be estimated */
	struct pound_set_index second[POUND_PAIRS_MAX];                         /* (n_second) */
	struct pound_curve curves[POUND_INPUTS_MAX];                            /* (n_inputs) */
};

/* Joins rows with the same values of all inputs, if they are replicates.  sample: of each row  (n_rows); table: scratch
 * (pound_given_join_slots); value: number of samples */
int pound_given_join_slots(int n_rows);
int pound_given_join(int n_rows, int n_inputs, const double *x, int *table, int *sample);

/* Numbers the different points of the inputs.  point: of each row  (n_rows); table: as above; value: number of points */
int pound_given_points(int n_rows, int n_inputs, const double *x, int *table, int *point);

/* Sets the distributions of the inputs, and finds a factorial design; values: their memory  (2 x n_inputs x n_rows);
 * cell: memory  (n_rows); order: scratch  (n_rows) */
void pound_given_inputs(struct pound_given *given, double *values, int *cell, size_t *order);

size_t pound_given_scratch(int n_rows, int n_inputs); /* doubles */
void pound_given_check(const struct pound_given *given, double *scratch, struct pound_given_checks *checks);
/* An output: its values, finite, and if known the variance of their noise  (n_rows) each */
struct pound_given_output {
	const double *y, *noise; /* noise: NULL unless given->noise_known */
};
/* scratch: as pound_given_check left it */
void pound_given_estimate(const struct pound_given *given, const struct pound_given_checks *checks,
                          const struct pound_given_output *output, double *scratch,
                          struct pound_given_indices *indices);

#endif
