/* result.h - a result: the output of the engine.  Units and shapes as in study.h; NAN where there is no value. */
#ifndef RESULT_H
#define RESULT_H

#include "engine/study.h"

// one row per quantity of one run of one signal: X(member, name in a result, oscillator or -1)
// clang-format off
#define POUND_MEASURES(X)                                                                 \
	X(displacement_max_1,      "displacement_max_m",      0)                              \
	X(displacement_max_free_1, "displacement_max_free_m", 0)                              \
	X(force_max_1,             "force_max_n",             0)                              \
	X(yield_displacement_1,    "yield_displacement_m",    0)                              \
	X(demand_1,                "demand",                  0)                              \
	X(demand_free_1,           "demand_free",             0)                              \
	X(displacement_max_2,      "displacement_max_m",      1)                              \
	X(displacement_max_free_2, "displacement_max_free_m", 1)                              \
	X(force_max_2,             "force_max_n",             1)                              \
	X(yield_displacement_2,    "yield_displacement_m",    1)                              \
	X(demand_2,                "demand",                  1)                              \
	X(demand_free_2,           "demand_free",             1)                              \
	X(impulse_max,             "impulse_max_n_s",        -1)                              \
	X(contact_count,           "contact_count",          -1)                              \
	X(contact_time,            "contact_time_s",         -1)                              \
	X(end_u1,                  "u1_m",                   -1)                              \
	X(end_v1,                  "v1_m_s",                 -1)                              \
	X(end_u2,                  "u2_m",                   -1)                              \
	X(end_v2,                  "v2_m_s",                 -1)
// clang-format on

/* Quantities of two oscillators run as a row of one-story buildings, if an output reads them; 0 for a wall. */
struct pound_pair_floors {
	double acceleration[POUND_OSCILLATORS]; /* largest absolute acceleration [m/s2] */
	double acceleration_free[POUND_OSCILLATORS];
	double residual[POUND_OSCILLATORS]; /* displacement without spring force, at the end [m] */
	double lost[POUND_OSCILLATORS];     /* energy dissipated by the laws [J] */
	double lost_contact, work_in;       /* dissipated in contacts, and input by the ground [J] */
	double force, approach;             /* largest contact force [N], largest approach speed [m/s] */
};

/* One signal's response.  NAN if the scene has no such value (the yield displacement of a linear law). */
struct pound_response {
#define X(member, name, oscillator) double member;
	POUND_MEASURES(X)
#undef X
	// 0 unless an output reads them
	double gap_needed;    /* largest u_1 - u_2 without contact [m] */
	double relative_free; /* largest |u_1 - u_2| without contact [m] */
	double
	    energy_residual; /* input energy less all energy accounted for, over the largest energy on the way; NAN: not computed */
	struct pound_pair_floors floors;
};

// one row per quantity of one story, and of the floor above it, of a row of buildings: X(member, name in a result)
// clang-format off
#define POUND_STOREY_MEASURES(X)                                                          \
	X(drift_max,             "drift_max_m")                                               \
	X(drift_max_free,        "drift_max_free_m")                                          \
	X(drift_ratio_max,       "drift_ratio_max")                                           \
	X(shear_max,             "shear_max_n")                                               \
	X(yield_drift,           "yield_drift_m")                                             \
	X(demand,                "demand")                                                    \
	X(demand_free,           "demand_free")                                               \
	X(residual_drift,        "residual_drift_m")

#define POUND_FLOOR_MEASURES(X)                                                           \
	X(displacement_max,      "displacement_max_m")                                        \
	X(displacement_max_free, "displacement_max_free_m")                                   \
	X(acceleration_max,      "acceleration_max_m_s2")                                     \
	X(acceleration_max_free, "acceleration_max_free_m_s2")                                \
	X(end_u,                 "u_m")                                                       \
	X(end_v,                 "v_m_s")

// one row per quantity of one contact
#define POUND_CONTACT_MEASURES(X)                                                         \
	X(impulse_max,           "impulse_max_n_s")                                           \
	X(force_max,             "force_max_n")                                               \
	X(contact_count,         "contact_count")                                             \
	X(contact_time,          "contact_time_s")                                            \
	X(first_time,            "first_time_s")                                              \
	X(first_speed,           "first_speed_m_s")
// clang-format on

/* One signal's response of a story and the floor above it.  NAN as above. */
struct pound_storey_response {
#define X(member, name) double member;
	POUND_STOREY_MEASURES(X)
	POUND_FLOOR_MEASURES(X)
#undef X
	double lost; /* dissipated by the story's law [J]; NAN: no output reads energies */
};

struct pound_contact_response {
#define X(member, name) double member;
	POUND_CONTACT_MEASURES(X)
#undef X
	double speed_max; /* largest approach speed [m/s] */
	double lost;      /* dissipated [J]; NAN as above */
	// without contact, NAN: not requested
	double gap_needed;                    /* largest closing displacement [m] */
	double level_free[POUND_OSCILLATORS]; /* largest displacements of both buildings at its levels [m] */
};

/* One signal's response of a row of buildings. */
struct pound_row_response {
	double energy_residual;
	double work_in;       /* energy input by the ground [J]; NAN as above */
	double impulse_scale; /* mass of building 0 times the frequency of its first mode [kg/s] */
	const struct pound_storey_response *storeys;   /* by pound_row_first  (floors) */
	const struct pound_contact_response *contacts; /* (contacts) */
};

/* A signal of a suite: the record and the scale factor of its samples; < 0: reversed. */
struct pound_suite_signal {
	int record;
	double factor;
};

struct pound_estimate {
	double value, low, high; /* low and high: 95 % interval; NAN: undefined */
};

/* An index of a set of inputs, bit j for input j. */
struct pound_set_index {
	unsigned inputs;
	struct pound_estimate estimate;
};

enum {
	POUND_PAIRS_MAX = POUND_INPUTS_MAX * (POUND_INPUTS_MAX - 1) / 2,
	POUND_CLOSED_MAX = (1 << POUND_FACTORIAL_INPUTS_MAX) - 2, /* sets but the empty and the full */
};

/* Indices of the study's ratios, then of the inputs in no ratio.  These variables are dependent; Shapley effects add up to 1. */
struct pound_ratio_indices {
	int n; /* 0: none requested, or too few rows */
	struct pound_estimate
	    explained; /* share of the output's variance explained by these variables; NAN: unknown */
	struct pound_estimate first[POUND_FACTORIAL_INPUTS_MAX], total[POUND_FACTORIAL_INPUTS_MAX],
	    shapley[POUND_FACTORIAL_INPUTS_MAX]; /* (n) each */
};

/* Indices of the study's groups of inputs, each group as one input. */
struct pound_group_indices {
	int n; /* 0: none requested, or too few rows */
	struct pound_estimate first[POUND_GROUPS_MAX], total[POUND_GROUPS_MAX]; /* (n) each */
};

/* The conditional mean of the output given an input: at every value of a discrete input with up to POUND_CURVE values, else
 * at the quantiles of probability (k + 1/2) / POUND_CURVE; NAN: too few rows. */
enum { POUND_CURVE = 50 };

struct pound_curve {
	struct pound_estimate mean[POUND_CURVE];
};

double pound_conditional_place(int k);                                       /* (k + 1/2) / POUND_CURVE */
int pound_conditional_points(const struct pound_distribution *distribution); /* of such a curve */
double pound_conditional_x(const struct pound_distribution *distribution,
                           int k); /* the input's value at point k */

/* Indices of sets of inputs that the study's design can estimate, sets in ascending order. */
struct pound_set_indices {
	int n_second, n_closed;
	struct pound_set_index second[POUND_PAIRS_MAX]; /* second-order indices  (n_second) */
	struct pound_set_index
	    closed[POUND_CLOSED_MAX]; /* share of the variance that a set explains  (n_closed) */
};

/* Error of the indices of an output by source. */
// clang-format off
#define POUND_ERRORS(X)                                                                   \
	X(SAMPLING,    "sampling")    /* too few rows: the widest half of an interval */      \
	X(EXCITATION,  "excitation")  /* too few signals: effect of their randomness */ \
	X(INTEGRATION, "integration") /* runs that are not exact */                           \
	X(FAILED_ROWS, "failed_rows") /* rows left out, each taken as the most extreme valid row */
// clang-format on

enum pound_error {
#define X(row, name) POUND_ERROR_##row,
	POUND_ERRORS(X)
#undef X
	    POUND_ERROR_NONE /* and their number */
};

const char *pound_error_name(int row);
/* The error certainly larger than the sum of all others.  Unknown errors (NAN) count as 0; excitation_low is the least that the
 * noise of few signals adds to the widest interval. */
enum pound_error pound_accuracy_dominant(const double errors[POUND_ERROR_NONE], double excitation_low);
/* Whether the widest interval exceeds the other errors, but its bounds do not show whether few rows or few signals cause it. */
bool pound_accuracy_undecided(const double errors[POUND_ERROR_NONE], double excitation_low);

/* A number known by its bounds; NAN: unknown. */
struct pound_range {
	double low, high;
};

enum { POUND_LEVELS = 4 }; /* n/8, n/4, n/2, n rows */

struct pound_accuracy {
	int64_t runs_checked;     /* runs compared with a run on half the sample step */
	int64_t runs_unchecked;   /* one of the two runs has no value */
	double difference_median; /* relative, of the output of one run; NAN: none */
	double difference_largest;
	double variance_share; /* variance of these differences over the output's variance */
	struct {
		double first_change, total_change; /* caused by the differences, upper bound */
		double first_dropped,
		    total_dropped; /* by rows left out, if like the row that changes the index most; NAN: unknown */
		/* by the noise of few signals, as part of the half widths of all rows; NAN: unknown */
		struct pound_range first_noise, total_noise;
		double first_half[POUND_LEVELS], total_half[POUND_LEVELS]; /* half widths of intervals; NAN: none */
	} inputs[POUND_INPUTS_MAX];                                    /* (n_inputs) */
	int rows[POUND_LEVELS];                                        /* used for the half widths; 0: too few */
	struct pound_estimate slope;     /* of log half width over log rows; NAN: undefined */
	double rows_to_halve;            /* to halve the half widths, at most; NAN: undefined */
	double errors[POUND_ERROR_NONE]; /* of the worst index, at most 1; NAN: unknown */
	double excitation_low; /* at least, in the widest interval, as EXCITATION is at most; NAN: unknown */
};

/* Index columns, one row each: X(enumerator, name in a result).  The raw columns come from the plain protocol and include
 * the noise of few signals; the pick-freeze columns are corrected for it; S1 and ST have the smallest standard error from
 * the same runs.  S2_excitation is the second-order index of the input and one signal; Shapley effects add up to 1. */
// clang-format off
#define POUND_INDICES(X)                                                                  \
	X(POUND_S1,             "S1")                                                         \
	X(POUND_ST,             "ST")                                                         \
	X(POUND_S1_PICK_FREEZE, "S1_pick_freeze")                                             \
	X(POUND_ST_PICK_FREEZE, "ST_pick_freeze")                                             \
	X(POUND_S1_RAW,         "S1_raw")                                                     \
	X(POUND_ST_RAW,         "ST_raw")                                                     \
	X(POUND_S2_EXCITATION,  "S2_excitation")                                              \
	X(POUND_SHAPLEY,        "shapley")

/* Columns of the estimator that a study names, by its formula and corrected for the noise of few signals:
 * X(enumerator, name in a result, %s is the estimator's name). */
#define POUND_NAMED(X)                                                                    \
	X(POUND_NAMED_S1,           "S1_%s")                                                  \
	X(POUND_NAMED_ST,           "ST_%s")                                                  \
	X(POUND_NAMED_S1_CORRECTED, "S1_%s_corrected")                                        \
	X(POUND_NAMED_ST_CORRECTED, "ST_%s_corrected")

/* The excitation's randomness as an additional input: X(enumerator, name in a result).  First-order and total index in
 * single runs, and the total index (variance fraction) that remains in the means over the study's signals. */
#define POUND_SHARES(X)                                                                   \
	X(POUND_SHARE_FIRST_ONE, "S1_one_signal")                                             \
	X(POUND_SHARE_TOTAL_ONE, "ST_one_signal")                                             \
	X(POUND_SHARE_TOTAL,     "ST_mean_of_signals")

/* Notes on the indices of an output: X(enumerator, sentence). */
#define POUND_NOTES(X)                                                                    \
	X(POUND_NOTE_NO_ROWS,                                                                 \
	  "all rows of the design failed, so there are no indices")                       \
	X(POUND_NOTE_ONE_ROW,                                                                 \
	  "only one row of the design has a value; indices need at least two")                 \
	X(POUND_NOTE_CONSTANT,                                                                \
	  "the output is the same for every row, so it has no indices")                       \
	X(POUND_NOTE_NOT_RANDOM,                                                              \
	  "the excitation is not random, so there is no noise to correct for")                \
	X(POUND_NOTE_ONE_SIGNAL,                                                              \
	  "the noise of one signal cannot be estimated, so all indices describe the response to single ground motions and include this noise; for indices of the mean response use 2 signals or more, or \"auto\"")          \
	X(POUND_NOTE_SHARED_SIGNAL,                                                           \
	  "the samples of a row share one signal: besides the raw indices only S1 can be estimated; for all others, and for indices of the mean response, use 2 signals or more, or \"auto\"") \
	X(POUND_NOTE_NO_VARIANCE,                                                             \
	  "no variance of the output is given, so all indices include the noise of the model") \
	X(POUND_NOTE_SHARED_NOISE,                                                            \
	  "the samples of a row share their noise in an unknown way: besides the raw indices only S1 can be estimated; for the others use independent noise for each sample") \
	X(POUND_NOTE_NOISE_INSIDE,                                                            \
	  "S1 is a share of the variance including the noise")                               \
	X(POUND_NOTE_NO_NEIGHBORS,                                                            \
	  "S1 is then estimated from neighboring rows, which needs at least 30 rows and a design other than sobol") \
	X(POUND_NOTE_FRESH_SIGNALS,                                                           \
	  "S2_excitation and S1_one_signal need samples that share their signals (design.signals = common)") \
	X(POUND_NOTE_FEW_ROWS,                                                                \
	  "with fewer than 30 rows S1 and ST equal S1_pick_freeze and ST_pick_freeze")          \
	X(POUND_NOTE_NOISE,                                                                   \
	  "without the noise the variance may be 0, so all indices except the raw ones are missing or unreliable") \
	X(POUND_NOTE_NO_INTERVAL,                                                             \
	  "too few rows for an interval of every index; indices without one are unreliable")    \
	X(POUND_NOTE_ABOVE_TOTAL,                                                             \
	  "the interval of a first-order index lies above the interval of its total index, which is impossible: use more rows or signals") \
	X(POUND_NOTE_FEW_DECIDE,                                                              \
	  "few rows hold most of the variance, so intervals are too narrow")
// clang-format on

#define X(name, text) name,
enum pound_index { POUND_INDICES(X) POUND_N_INDICES };
enum pound_share { POUND_SHARES(X) POUND_N_SHARES };
enum pound_note { POUND_NOTES(X) POUND_N_NOTES };
enum pound_named { POUND_NAMED(X) POUND_N_NAMED };
#undef X

struct pound_indices {
	double mean, variance; /* of the output over the rows of A and B */
	double noise_share; /* fraction of the variance over all samples due to the excitation; NAN: one signal */
	double ratio_bias;  /* mean bias of the outputs as ratios of means over few signals; NAN: one signal */
	unsigned notes;     /* bits 1 << enum pound_note */
	double
	    rows_needed; /* for valid intervals, if few rows hold most of the variance; NAN: the rows suffice */
	struct pound_estimate share[POUND_N_SHARES];
	struct pound_estimate *index[POUND_N_INDICES]; /* (n_inputs) each */
	struct pound_estimate
	    *named[POUND_N_NAMED]; /* of the study's estimator, if it has one  (n_inputs) each */
	struct pound_set_indices sets;
	struct pound_ratio_indices ratios;
	struct pound_group_indices groups;
	struct pound_curve *curves;                /* (n_inputs); NULL: not requested */
	struct pound_estimate impulse_correlation; /* of an ordinate with the largest impulse; NAN: no ordinate */
	struct pound_accuracy accuracy;
};

/* relative error over the signals; NAN: the scene has no such value, or no signal gave one */
struct pound_deviation {
	double mean, largest;
};

/* Errors of one setting of one solver against the event solver, at the left body or the top of the left building. */
struct pound_trial {
	struct pound_solver solver;                           /* step: as used */
	int runs_failed;                                      /* signals without a result */
	struct pound_deviation displacement, demand, impulse; /* of the peak values */
	struct pound_deviation
	    history;  /* largest displacement difference in the first seconds over the largest displacement */
	double order; /* slope of log mean history error over log setting, from the trial before; NAN: none */
	double cpu;   /* CPU time of a run [s]; NAN: no clock */
};

enum { POUND_RULES = 3 };

/* The gap that a rule requires. */
struct pound_rule {
	double gap;                        /* [m] */
	double over;                       /* gap over the mean gap needed */
	struct pound_estimate probability; /* of pounding with this gap */
};

/* How wide a gap of a scene has to be, from its runs; with a design, from the runs of matrices A and B. */
struct pound_needs {
	int64_t runs;                           /* with a result */
	int clusters;                           /* mutually independent clusters of runs */
	double mean, deviation, largest;        /* of the gap needed [m] */
	double displacement[POUND_OSCILLATORS]; /* mean peaks without contact, left and right [m] */
	double correlation; /* of both sides in white noise, from frequencies and damping (of first modes) */
	struct pound_rule rules[POUND_RULES];
	struct pound_estimate *probability; /* of pounding with each gap of the result  (n_gaps) */
	struct pound_estimate *gap;         /* for each probability of the study [m]  (n_probabilities) */
	double *needed;                     /* without a design: by each run, NAN: failed [m]  (n_signals) */
};

/* The fragility curve of a gap: lognormal over the intensity. */
struct pound_fragility {
	struct pound_estimate median, dispersion; /* NAN: the counts define none */
	struct pound_estimate rate;               /* mean annual rate of pounding [1/a]; NAN: no hazard curve */
};

/* The fragility curves of cells that differ only in intensity. */
struct pound_stripe_set {
	int cell;                          /* the first of these cells */
	int contact;                       /* index in a row of buildings, else 0 */
	struct pound_fragility *curves;    /* for each gap of the result  (n_gaps) */
	struct pound_estimate *return_gap; /* for each return period [m]  (n_periods) */
	double beyond;                     /* annual rate of earthquakes above the largest intensity */
};

struct pound_separation_result {
	int n_gaps;
	double gaps[POUND_GAPS_MAX]; /* [m] */
	struct pound_needs *needs;   /* for each cell and contact  (n_cells x pound_study_gaps) */
	int n_sets;
	struct pound_stripe_set *sets; /* (n_sets) */
};

struct pound_cell {
	double sweep[POUND_SWEEPS_MAX];     /* the value of each sweep, (n_sweeps) used */
	int64_t runs, runs_failed;          /* pounding runs requested, and failed ones among them */
	int rows_dropped;                   /* rows of the design left out because one of their runs failed */
	int n_signals;                      /* response: number of signals */
	struct pound_response *signals;     /* response: (n_signals) */
	struct pound_row_response *rows;    /* response of a row of buildings: instead of signals  (n_signals) */
	struct pound_suite_signal *records; /* response under a suite: the record of each signal  (n_signals) */
	double outputs[POUND_OUTPUTS_MAX];  /* without a design: ratio of means of each output */
	struct pound_indices *indices;      /* sensitivity: (n_outputs) */
};

/* Work requested by the samples of the design, and work done: equal tasks are run once. */
// clang-format off
#define POUND_STAGES(X)                                                                   \
	X(signals,    "ground motions")                                                       \
	X(free_runs,  "linear responses without pounding")                                    \
	X(yield_runs, "nonlinear responses without pounding")                                 \
	X(pounding_runs, "responses with pounding")                                           \
	X(floors,     "floor histories, for spectra")                                         \
	X(checks,     "responses again on half the sample step")
// clang-format on

struct pound_stage_work {
	int64_t asked, run;
};

struct pound_work {
#define X(member, text) struct pound_stage_work member;
	POUND_STAGES(X)
#undef X
	struct pound_stage_work free_pair_runs; /* both bodies together without pounding, checks included */
	struct pound_stage_work chain_runs;     /* both bodies as one-story buildings, checks included */
	int64_t never_touching;    /* pounding runs skipped: the free responses never close the gap */
	int64_t moving_alike;      /* pounding runs skipped: equal oscillators never touch with force */
	int64_t yield_given;       /* linear responses skipped: the yield displacement is already known */
	int64_t linear_unasked;    /* linear responses of the right oscillator skipped: no output needs them */
	int64_t nonlinear_unasked; /* nonlinear ones likewise */
	int64_t contacts;          /* contacts in the runs done */
	int64_t yield_searches;    /* for the yield displacement of a target demand, 2 corrections or more */
	int64_t yield_jumps;       /* of these, ended off the target: the demand jumps over it */
	int64_t yield_missed;      /* ended off the target: the corrections were used up */
	int64_t failed[POUND_N_FAILURES]; /* failed pounding runs among those requested */
};

/* One interim analysis of a growing design: the widest interval of an S1 or ST. */
struct pound_look {
	int rows;
	double half_width; /* infinite: an index has no interval */
	int cell, output, input;
	enum pound_index index;
};

/* Spectra of the left floor, one row each: X(row, name in a result).  The first three are integrated. */
// clang-format off
#define POUND_SPECTRA(X)                                                                  \
	X(POUNDING,    "pounding")    /* of its absolute acceleration */                      \
	X(IMPACT_ONLY, "impact_only") /* of the contact force over its mass */                \
	X(FREE,        "free")        /* without pounding */                                  \
	X(DIRAC_LINE,  "dirac_line")  /* of one pulse of the largest impulse: Eq. (23) */     \
	X(DIRAC_TRAIN, "dirac_train") /* of one such pulse every half period */               \
	X(DIRAC_PEAKS, "dirac_peaks") /* its peaks: Eq. (21) */
// clang-format on

enum pound_spectrum_row {
#define X(row, name) POUND_SPECTRUM_##row,
	POUND_SPECTRA(X)
#undef X
	    POUND_N_SPECTRA,
	POUND_N_INTEGRATED = POUND_SPECTRUM_FREE + 1
};

/* Statistics of the pseudo-acceleration over the signals [m/s2], NAN: no signal has a value  (n frequencies each) */
struct pound_floor_spectrum {
	double *mean, *p16, *p84;
	double *error; /* largest relative difference from runs on half the sample step, of integrated rows */
};

struct pound_floor_result {
	struct pound_floor_spectrum spectra[POUND_N_SPECTRA];
	double frequency_hz; /* first frequency of the floor's body or building, without pounding */
	int signals, signals_failed, signals_checked;
	double impulse_mean; /* mean of the largest impulses [N s] */
	double pulses_mean;  /* mean number of pulses of the idealized train */
};

/* The number of signals per row and its reason: the candidate numbers, and the index that decided. */
enum { POUND_SPLITS = 12 };

struct pound_split_choice {
	int signals, rows;
	double half_width, bias; /* predicted for the worst index; the half width includes the bias */
	int64_t runs;            /* without the pilot's */
};

struct pound_split {
	int signals;    /* of each row; 0: given by the study */
	int rows;       /* of the design; of a growing design, initially */
	int pilot_rows; /* of six signals each */
	int64_t pilot_runs;
	int n_choices;
	struct pound_split_choice choices[POUND_SPLITS];
	struct pound_look decided_by; /* half width and rows as predicted; negative: no variance in the pilot */
	double between, within,
	    pairs; /* variance components of the deciding index, per row: rows + signals / R + pairs / (R (R - 1)) */
};

struct pound_result {
	struct pound_split split;
	int rows;                 /* of the design, in this result */
	int rows_done;            /* of an intermediate result: complete when it was made; 0: as many as in it */
	int n_looks;              /* 0: the design does not grow */
	struct pound_look *looks; /* (n_looks) */
	const double *
	    references; /* reference intensity of each record of a suite, the divisor of the target [m/s2]  (n_records);
	                             NULL: not scaled */
	const double *
	    differences; /* of each record of a suite: largest displacement of a body over the largest on the record's band-limited
	                              interpolation at twice its rate, less 1; the largest over all bodies  (n_records); NULL: no records */
	int n_cells;
	struct pound_cell *cells; /* (n_cells) */
	int n_trials;
	struct pound_trial
	    *trials; /* convergence: the event solver, the second opinion, the settings  (n_trials) */
	struct pound_floor_result floor; /* floor_spectrum */
	struct pound_separation_result separation;
	struct pound_work work;
};

#endif
