/* indices.h - from the outputs of a design's runs to sensitivity indices and their intervals.
 *
 *   sample values -> one number for each sample of a row (valid_rows.c) -> moments of a row (pick_freeze.c)
 *                 -> their means over all rows or resampled ones (bootstrap.c) -> indices (pick_freeze.c)
 *
 * The unit throughout is a row of the design with all its samples and signals: a row is kept, left out or
 * resampled as a whole.  Nothing here allocates; sums are taken in the order of rows.
 *
 * The values, the rows and a statistic carry a stop flag.  Loops over rows, chunks, resamples and indices check it, and it
 * stays set: the code after an interrupted loop sees it, too, and does not use the incomplete results. */
#ifndef INDICES_H
#define INDICES_H

#include "engine/design/design.h"
#include "engine/numeric/stop.h"

/* One output of one cell: a ratio of means over the signals, for every sample of every row.  NAN in any number of a
 * row: a failed run.  Below, n_samples is pound_values_samples(). */
struct pound_sample_values {
	int n_rows, n_inputs, n_signals;
	bool same_signals;                     /* in every sample of every row: signals are not random */
	const double *numerator, *denominator; /* (n_rows x n_samples x n_signals) each */
	/* outputs computed elsewhere are numerators of one signal, without denominators; this is their variance  (same
	 * shape), NAN: not known.  NULL: outputs computed here */
	const double *variance;
	struct pound_grouping grouping; /* of the rows */
	int order;                      /* row of the orders: the samples of a row ... */
	int n_groups;
	const struct pound_group *groups; /* ... and then A with the columns of each group from B  (n_groups) */
	const struct pound_input
	    *inputs;             /* for their distributions  (n_inputs); NULL: no input counts as discrete */
	const atomic_bool *stop; /* if set, the results must not be used; NULL: never */
};

/* How the sample values were made. */
struct pound_sampling {
	const double *u;    /* the design as probabilities in (0, 1), rows of A and B  (n_rows x 2 x n_inputs) */
	bool random;        /* the excitation is random; outputs computed elsewhere: variances are known */
	bool fresh_signals; /* each sample of a row has its own signals */
	int n_resamples;    /* per interval, at most POUND_RESAMPLES; 0: POUND_RESAMPLES */
	bool quasi_random;  /* the design: rows near in one input are related in the others, too */
	const struct pound_study *ratios; /* study with ratios to report indices for; NULL: none */
	int estimator; /* row of an additional estimator to report indices of; 0: the plain protocol only */
	double *kept;  /* fit factors, from one output of the design to the next: chaos_expansion.c; NULL: none */
};

/* The units that the scatter is estimated from: groups of rows if there are any, else the rows. */
struct pound_scatter {
	struct pound_grouping grouping;
	const int64_t *row; /* design row number of each valid row; NULL: the same number */
};

/* The valid rows, those without a failed run.  y: outputs corrected for the bias of ratios of means over few signals;
 * plain: uncorrected outputs; both centered by their mean over A and B.  deviation: contribution of each signal to an output
 * y, scaled so that the sum of products is the covariance of two outputs over draws of the signals. */
struct pound_rows {
	int n_rows, n_inputs, n_samples, n_signals;
	int order, n_groups;
	const struct pound_group *groups; /* (n_groups) */
	double mean, plain_mean;          /* of A and B */
	double variance_floor;            /* a variance up to this is rounding error */
	double ratio_bias; /* mean over all samples: outputs are ratios of means over few signals */
	int64_t *row;      /* design row number  (n_rows) */
	struct pound_scatter scatter;
	double *y, *plain; /* (n_rows x n_samples) */
	double *deviation; /* (n_rows x n_samples x n_signals); NAN: one signal of unknown variance */
	bool independent;  /* samples of a row have independent noise; one deviation per sample holds it */
	const struct pound_input *inputs; /* of the sample values, as is `stop` */
	const atomic_bool *stop;
};

int pound_values_samples(const struct pound_sample_values *shape);  /* of a row */
size_t pound_rows_scratch(const struct pound_sample_values *shape); /* doubles */
void pound_rows_init(struct pound_rows *rows, const struct pound_sample_values *values, double *scratch);
struct pound_scatter pound_rows_scatter(const struct pound_sample_values *values, const int64_t *row);
/* The shape of the sample values, for the valid rows only; mask bit j: column j of a sample is from B. */
struct pound_sample_values pound_rows_shape(const struct pound_rows *rows);
unsigned pound_rows_mask(const struct pound_rows *rows, int sample);
/* The number of values of a discrete input; 0: any other input. */
int pound_rows_levels(const struct pound_rows *rows, int input);
/* Variance over all samples of the plain protocol; y: rows->y or rows->plain. */
double pound_rows_variance(const struct pound_rows *rows, const double *y);
/* Effective number of rows in the variance, and the least number that gives valid intervals: make statistics */
double pound_rows_behind(const struct pound_rows *rows);
enum { POUND_ROWS_BEHIND = 5 };
/* Covariances of a row's outputs over draws of the noise  (n_samples x n_samples) */
void pound_rows_noise(const struct pound_rows *rows, int row, double *noise);

/* One row as estimators see it. */
struct pound_outputs {
	int n_inputs, n_samples;
	const double *y;     /* (n_samples) */
	const double *noise; /* covariances to subtract from products  (n_samples x n_samples); NULL: none */
};

/* An estimator: moments of a row, and the indices as a function of the moments' means over the rows.
 * m: moments;  value: first then total  (2 x n_inputs) */
struct pound_estimator {
	const char *name;
	int order; /* smallest order of the design */
	int (*n_moments)(int n_inputs);
	void (*moments)(const struct pound_outputs *row, double *m);
	void (*indices)(const double *m, int n_inputs, double variance_floor, double *value);
};

const struct pound_estimator *pound_estimator_row(int row); /* NULL past the last */

/* Values that are a function of the means over the rows of some moments of each row. */
struct pound_statistic {
	int n_moments, n_values;
	void (*moments)(const void *subject, int row, double *m);
	void (*values)(const void *subject, const double *mean, double *value);
	const void *subject;
	const atomic_bool *stop; /* of the subject */
};

enum {
	POUND_RESAMPLES = 2000, /* at most */
	POUND_MOMENTS_MAX = 9 * POUND_INPUTS_MAX + 8,
	POUND_VALUES_MAX = POUND_MOMENTS_MAX
};

/* How rows are resampled. */
struct pound_resampling {
	uint64_t seed;
	int n; /* resamples: a multiple of 8, at most POUND_RESAMPLES */
};

/* Whether the noise of few signals is subtracted from the products of outputs. */
enum pound_noise { POUND_NOISE_KEPT, POUND_NOISE_REMOVED };

/* A statistic's values with 95 % intervals: by resampling rows, or by leaving out groups of rows if there are any. */
size_t pound_bootstrap_scratch(int n_rows, int n_moments, int n_values); /* doubles */
void pound_bootstrap_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                               int n_rows, struct pound_resampling resampling, double *scratch,
                               struct pound_estimate *estimates);
void pound_bootstrap_interval(const struct pound_statistic *statistic, int n_rows,
                              struct pound_resampling resampling, double *scratch,
                              struct pound_estimate *estimates);
size_t pound_jackknife_scratch(const struct pound_scatter *scatter, int n_moments); /* doubles */
void pound_jackknife_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                               int n_rows, double *scratch, struct pound_estimate *estimates);
int pound_jackknife_group(const struct pound_scatter *scatter, int row);
double pound_jackknife_student(int freedom); /* 97.5 % quantile of Student's t */
/* Half of the 95 % interval of a mean over rows, with groups or without.  sums: (groups) */
double pound_jackknife_half_width(const double *value, int n_rows, const struct pound_scatter *scatter,
                                  double *sums);
/* Its standard error; quantile: half of the interval over it. */
double pound_jackknife_error(const double *value, int n_rows, const struct pound_scatter *scatter,
                             double *sums, double *quantile);
/* Distance of the upper end of a value's 95 % interval from the value: in standard errors, and over half of the interval that
 * skewness and few effective rows do not widen. */
struct pound_upper {
	double errors, widening;
};

double pound_jackknife_skewed(double quantile, double skewness); /* in standard errors */
/* scratch: (groups) */
void pound_jackknife_upper(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                           int n_rows, double *scratch, struct pound_upper *upper);
/* Effective number of rows in the scatter of a mean: n / 3 for normal values, few if a few rows dominate. */
double pound_jackknife_rows(const double *value, int n_rows);

/* Pick-freeze indices of a model with random signals. */
struct pound_pick_freeze {
	struct pound_estimate first_raw[POUND_INPUTS_MAX],
	    total_raw[POUND_INPUTS_MAX]; /* noise of few signals included */
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX]; /* of the mean over all signals */
	struct pound_upper total_upper[POUND_INPUTS_MAX],
	    total_raw_upper[POUND_INPUTS_MAX];               /* of the intervals of ST, see index_columns.c */
	struct pound_estimate with_signal[POUND_INPUTS_MAX]; /* second-order index of the input and the signal */
	struct pound_estimate signal_total_one;              /* total index of the signal in single runs */
	struct pound_estimate signal_total; /* variance fraction left in the means over signals */
	struct pound_estimate signal_first; /* first-order index of the signal in single runs */
};

size_t pound_noise_correction_scratch(const struct pound_sample_values *shape); /* doubles */
void pound_noise_correction_estimates(const struct pound_rows *rows, struct pound_resampling resampling,
                                      double *scratch, struct pound_pick_freeze *result);

#define POUND_NORMAL_95 1.959963984540054 /* 97.5 % quantile of the normal distribution */

/* fewest rows for local_regression.c and chaos_expansion.c; with fewer, pick-freeze alone has the smaller error */
enum { POUND_ROWS_MIN = 30 };
size_t pound_local_regression_scratch(const struct pound_sample_values *shape); /* doubles */
void pound_local_regression_fit(const double *y, int n, int reach, double *fit);
void pound_local_regression_first(const struct pound_rows *rows, const double *x, enum pound_noise noise,
                                  double *scratch, struct pound_estimate *first);
/* Effective rows of the intervals, pound_jackknife_rows; scratch as left by pound_local_regression_first.  (n_inputs) */
void pound_local_regression_behind(const struct pound_rows *rows, double *scratch, double *behind);
/* Half widths of the intervals from the first n of these rows alone, with the neighbors of all; scratch likewise.
 * half: (n_inputs) */
void pound_local_regression_first_rows(const struct pound_rows *rows, int n, double *scratch, double *half);

/* Closed variances: Var E[Y | X_u] for sets u of inputs. */
enum {
	POUND_CLOSED_COLUMNS_MAX = 2 + 2 * POUND_INPUTS_MAX + POUND_PAIRS_MAX + 2 * POUND_GROUPS_MAX,
	POUND_CLOSED_PAIRS_MAX = POUND_SAMPLES_MAX * (POUND_SAMPLES_MAX - 1) / 2,
};

struct pound_closed_pair {
	int p, q;      /* samples of a row */
	int column;    /* of the set of inputs that p and q share */
	double weight; /* one over the number of pairs of the column */
};

struct pound_closed {
	int n_inputs, n_samples;
	int n_groups;
	unsigned group[POUND_GROUPS_MAX]; /* sets of inputs  (n_groups) */
	int n_columns;
	unsigned set[POUND_CLOSED_COLUMNS_MAX]; /* bit j: input j; ascending, empty set first, full set last */
	bool known[POUND_CLOSED_COLUMNS_MAX];   /* the design has a pair for it */
	/* the total effect of the other inputs is reported: estimate from squared differences, not from products */
	bool difference[POUND_CLOSED_COLUMNS_MAX];
	int n_pairs;
	struct pound_closed_pair pair[POUND_CLOSED_PAIRS_MAX];
};

/* What the noise of few signals adds to the half widths of the indices; NAN: not known.  `plain`: of totals without a polynomial. */
struct pound_noise_ranges {
	struct pound_range first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX], plain[POUND_INPUTS_MAX];
};

/* Influence of a row on an index: a linear combination of its estimates (pound_closed_row), plus a constant. */
enum { POUND_INFLUENCE_MAX = 5 };
struct pound_influence {
	int n, column[POUND_INFLUENCE_MAX];
	double weight[POUND_INFLUENCE_MAX]; /* (n) */
};

struct pound_closed_results {
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX], shapley[POUND_INPUTS_MAX];
	double first_rows[POUND_INPUTS_MAX],
	    total_rows[POUND_INPUTS_MAX];     /* effective, of the intervals: pound_jackknife_rows */
	double total_error[POUND_INPUTS_MAX]; /* standard error */
	struct pound_influence first_influence[POUND_INPUTS_MAX], total_influence[POUND_INPUTS_MAX];
	double variance;                 /* the denominator of closed indices, before its control variates */
	struct pound_noise_ranges noise; /* of chaos_expansion.c */
	struct pound_set_indices sets;
	struct pound_group_indices groups;
};

void pound_closed_init(struct pound_closed *closed, const struct pound_sample_values *shape);
/* A control variate of a row's outputs. */
struct pound_control_variate {
	const double *g;    /* its values  (n_samples); NULL: none */
	double mean;        /* subtracted from y and g */
	const double *part; /* closed variances of g  (n_columns); zeros if g is NULL */
};

void pound_closed_row(const struct pound_closed *closed, const double *y,
                      const struct pound_control_variate *control, const double *noise, double *estimate);
size_t pound_closed_scratch(const struct pound_closed *closed, int n_rows); /* doubles */
void pound_closed_indices(const struct pound_closed *closed, const double *estimates,
                          const struct pound_rows *rows, double *scratch,
                          struct pound_closed_results *results);

/* Sums over rows for the noise ranges of `results`. */
enum { POUND_NOISE_INDICES = 3 * POUND_INPUTS_MAX };
struct pound_noise_part {
	const struct pound_rows *rows;
	const struct pound_closed *closed;
	const struct pound_closed_results *results;
	bool known; /* the noise is removed from the indices, and there are enough signals */
	double sum[POUND_NOISE_INDICES], squares[POUND_NOISE_INDICES];
};

struct pound_noise_part pound_noise_part_init(const struct pound_rows *rows,
                                              const struct pound_closed *closed, enum pound_noise noise,
                                              const struct pound_closed_results *results);
void pound_noise_part_add(struct pound_noise_part *part, int row,
                          const struct pound_control_variate *control);
void pound_noise_part_ranges(const struct pound_noise_part *part, struct pound_noise_ranges *ranges);

int pound_chaos_expansion_degree(int n_rows, int n_inputs, int n_samples);
size_t pound_chaos_expansion_scratch(const struct pound_sample_values *shape);   /* doubles */
size_t pound_chaos_expansion_kept_size(const struct pound_sample_values *shape); /* doubles */
void pound_chaos_expansion_indices(const struct pound_rows *rows, const struct pound_sampling *sampling,
                                   enum pound_noise noise, double *scratch,
                                   struct pound_closed_results *results, struct pound_curve *curves);
/* From the first n of these rows alone, with the polynomials of all; scratch as left by pound_chaos_expansion_indices. */
void pound_chaos_expansion_first_rows(const struct pound_rows *rows, int n, double *scratch,
                                      struct pound_closed_results *results);

/* Data for the conditional mean of the output given an input. */
struct pound_conditional {
	const struct pound_rows *rows;
	const double *u;           /* the design as probabilities  (n x 2 x n_inputs) */
	const double *y;           /* centered outputs less a trend  (n_rows x n_samples) */
	double trend[POUND_CURVE]; /* conditional mean of the trend, at the places of the curve */
};

/* The number of values of a discrete input, if at most POUND_CURVE; 0: any other input. */
int pound_conditional_levels(const struct pound_distribution *distribution);
size_t pound_conditional_scratch(int n_rows); /* doubles */
void pound_conditional_mean(const struct pound_conditional *given, int input, double *scratch,
                            struct pound_curve *curve);

size_t pound_ratio_scratch(const struct pound_sample_values *shape,
                           const struct pound_study *study); /* doubles */
void pound_ratio_indices(const struct pound_rows *rows, const double *u, const struct pound_study *study,
                         double noise, double *scratch, struct pound_ratio_indices *results);

/* The plain protocol: mean, variance, noise share and raw indices. */
size_t pound_plain_scratch(const struct pound_sample_values *shape); /* doubles */
int pound_plain_indices(const struct pound_sample_values *values, struct pound_resampling resampling,
                        double *scratch, struct pound_indices *indices); /* number of failed rows */
/* first then total  (2 x n_inputs);  scratch: (pound_plain_estimates_scratch) */
size_t pound_plain_estimates_scratch(const struct pound_sample_values *shape,
                                     const struct pound_estimator *estimator); /* doubles */
void pound_plain_estimates(const struct pound_rows *rows, const struct pound_estimator *estimator,
                           enum pound_noise noise, struct pound_resampling resampling, double *scratch,
                           struct pound_estimate *estimates);
bool pound_plain_summary(const struct pound_rows *rows, struct pound_indices *indices);

/* Fills first_dropped and total_dropped. */
void pound_failed_rows_changes(const struct pound_rows *rows, int dropped, struct pound_accuracy *accuracy);

/* All indices, shares and notes, and of the accuracy the half widths and the possible effect of failed rows.  sampling: as in the
 * later call; NULL: only the columns that every study has. */
size_t pound_index_columns_scratch(const struct pound_sample_values *shape,
                                   const struct pound_sampling *sampling); /* doubles */
int pound_index_columns_indices(const struct pound_sample_values *values,
                                const struct pound_sampling *sampling, uint64_t seed, double *scratch,
                                struct pound_indices *indices); /* number of failed rows */

#endif
