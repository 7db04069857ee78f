/* indices.h - from the outputs of a design's runs to sensitivity indexes and their intervals.
 *
 *   sample values -> one number for each sample of a row (rows.c) -> moments of a row (estimator.c)
 *                 -> their means over all rows or resampled ones (interval.c) -> indexes (estimator.c)
 *
 * A row of the design with all its samples and signals is the unit throughout: it is kept or dropped, and
 * resampled, as a whole.  Nothing here allocates; sums are taken in the order of rows. */
#ifndef INDICES_H
#define INDICES_H

#include "engine/design.h"
#include "engine/pound.h"

/* One output of one cell: a ratio of means over the signals, of every sample (0: A, 1: B, 2 + j: A with column j
 * from B).  NAN in any number of a row: a failed run. */
struct pound_sample_values {
	int n_rows, n_inputs, n_signals;
	const double *numerator, *denominator; /* (n_rows x (n_inputs + 2) x n_signals) each */
	/* outputs computed elsewhere are numerators of one signal, without denominators; their variances  (as these), NAN:
	 * not known; NULL: computed here */
	const double *variance;
	struct pound_grouping grouping; /* of the rows */
};

/* How they came about. */
struct pound_sampling {
	const double *u;    /* the design as probabilities in (0, 1), rows of A and B  (n_rows x 2 x n_inputs) */
	bool random;        /* the excitation; of outputs computed elsewhere: their variances are known */
	bool fresh_signals; /* each sample of a row has its own */
	bool quasi_random;  /* the design: rows that are near in one input are not near by chance in the others */
};

/* What the scatter of rows is told from: their groups if they have some, else the rows themselves. */
struct pound_scatter {
	struct pound_grouping grouping;
	const int64_t *row; /* number in the design of each row that counts; NULL: its own */
};

/* The rows without a failed run.  y: outputs, centred by the mean of A and B; noise: their covariances over draws of
 * the signals, for the pairs of samples that estimators multiply, with c the sample with column j from B. */
struct pound_rows {
	int n_rows, n_inputs, n_signals;
	double mean, variance_floor; /* a variance up to the floor is rounding */
	int64_t *row;                /* which row of the design  (n_rows) */
	struct pound_scatter scatter;
	double *y;     /* (n_rows x (n_inputs + 2)) */
	double *noise; /* (n_rows x pound_rows_noises); NAN: one signal */
};

enum {
	POUND_NOISE_AA,
	POUND_NOISE_BB,
	POUND_NOISE_AB,
	POUND_NOISE_MIXED, /* from here the covariances cc, ac, bc of every j */
	POUND_NOISE_STEP = 3,
};

int pound_rows_noises(int n_inputs);
size_t pound_rows_scratch(int n_rows, int n_inputs, int n_signals); /* doubles */
void pound_rows_init(struct pound_rows *rows, const struct pound_sample_values *values, double *scratch);

/* An estimator: what it adds up over the rows, and the indexes as a function of the means of that.
 * y: the outputs of a row's samples  (n_inputs + 2);  m: moments;  value: first then total  (2 x n_inputs) */
struct pound_estimator {
	const char *name;
	int (*n_moments)(int n_inputs);
	void (*moments)(const double *y, int n_inputs, double *m);
	void (*indices)(const double *m, int n_inputs, double variance_floor, double *value);
};

const struct pound_estimator *pound_estimator_row(int row); /* NULL past the last */

/* Numbers that are a function of the means over the rows of some moments of each row. */
struct pound_statistic {
	int n_moments, n_values;
	void (*moments)(const void *subject, int row, double *m);
	void (*values)(const void *subject, const double *mean, double *value);
	const void *subject;
};

enum {
	POUND_RESAMPLES = 2000, /* at most */
	POUND_MOMENTS_MAX = 5 * POUND_INPUTS_MAX + 8,
	POUND_VALUES_MAX = POUND_MOMENTS_MAX
};

/* A statistic's values with 95 % intervals: by resampling rows, or by leaving out groups where there are some. */
size_t pound_interval_scratch(int n_rows, int n_moments, int n_values); /* doubles */
void pound_interval_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                              int n_rows, uint64_t seed, int n_resamples, double *scratch,
                              struct pound_estimate *estimates);
void pound_interval_bootstrap(const struct pound_statistic *statistic, int n_rows, uint64_t seed,
                              int n_resamples, double *scratch, struct pound_estimate *estimates);
size_t pound_jackknife_scratch(const struct pound_scatter *scatter, int n_moments); /* doubles */
void pound_jackknife_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                               int n_rows, double *scratch, struct pound_estimate *estimates);
double pound_jackknife_student(int freedom); /* 97.5 % quantile of Student's law */
/* Half of the 95 % interval of a mean over rows, with groups or without.  sums: (groups) */
double pound_jackknife_half_width(const double *value, int n_rows, const struct pound_scatter *scatter,
                                  double *sums);

/* Pick-freeze indexes of a model with random signals. */
struct pound_pick_freeze {
	struct pound_estimate first_raw[POUND_INPUTS_MAX],
	    total_raw[POUND_INPUTS_MAX]; /* noise of few signals included */
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX]; /* of the mean over all signals */
	struct pound_estimate with_signal[POUND_INPUTS_MAX]; /* second-order index of the input and the signal */
	struct pound_estimate signal_total_one;              /* total index of the signal in single runs */
	struct pound_estimate signal_total; /* share of the randomness left in the means over signals */
	struct pound_estimate signal_first; /* first-order index of the signal in single runs */
};

size_t pound_correction_scratch(int n_rows, int n_inputs); /* doubles */
void pound_correction_estimates(const struct pound_rows *rows, uint64_t seed, double *scratch,
                                struct pound_pick_freeze *result);

#define POUND_NORMAL_95 1.959963984540054 /* 97.5 % quantile of the normal law */

/* rows for local.c and chaos.c; with fewer, pick-freeze alone has the smaller error */
enum { POUND_ROWS_MIN = 30 };
size_t pound_local_scratch(int n_rows); /* doubles */
void pound_local_fit(const double *y, int n, int reach, double *fit);
void pound_local_first(const struct pound_rows *rows, const double *x, bool corrected, double *scratch,
                       struct pound_estimate *first);

int pound_chaos_degree(int n_rows, int n_inputs);
size_t pound_chaos_scratch(int n_rows, int n_inputs); /* doubles */
void pound_chaos_indices(const struct pound_rows *rows, const double *u, bool corrected, double *scratch,
                         struct pound_estimate *first, struct pound_estimate *total);

/* The plain protocol: mean, variance, noise share and the raw indexes. */
size_t pound_sobol_scratch(int n_rows, int n_inputs, int n_signals); /* doubles */
int pound_sobol_indices(const struct pound_sample_values *values, uint64_t seed, int n_resamples,
                        double *scratch, struct pound_indices *indices); /* rows dropped */
bool pound_sobol_summary(const struct pound_rows *rows, struct pound_indices *indices);

/* All indexes, shares and notes. */
size_t pound_variants_scratch(int n_rows, int n_inputs, int n_signals); /* doubles */
int pound_variants_indices(const struct pound_sample_values *values, const struct pound_sampling *sampling,
                           uint64_t seed, double *scratch, struct pound_indices *indices); /* rows dropped */

#endif
