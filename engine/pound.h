/* pound.h - what the engine takes (a study) and what it gives back (a result).
 *
 * The only engine header other folders include.  Units are SI: m, kg, s, N, rad/s; a name that ends in a unit
 * (_hz) is the exception it states.  Arrays are row-major, the shape stands behind the field.
 * Any function may run in any thread; two threads may run blocks of one run at once with different worker numbers. */
#ifndef POUND_H
#define POUND_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define POUND_VERSION "0.15.0"

enum {
	POUND_OSCILLATORS = 2,                        /* left, right */
	POUND_INPUTS_MAX = 16,                        /* inputs of one sensitivity study */
	POUND_ORDINATES_MAX = 64,                     /* frequencies of a sensitivity study's floor spectrum */
	POUND_OUTPUTS_ASKED_MAX = 8,                  /* names in the outputs of one study */
	POUND_OUTPUTS_MAX = 8 + POUND_ORDINATES_MAX,  /* outputs of one study, each ordinate one of its own */
	POUND_SWEEPS_MAX = 8,                         /* swept fields of one study */
	POUND_RATIOS_MAX = 3,                         /* ratios of inputs of one study */
	POUND_SOLVERS = 4,                            /* rows of the solvers */
	POUND_SETTINGS_MAX = 16,                      /* of one solver that are compared */
	POUND_ROWS_MAX = 1 << 20,                     /* rows of a design */
	POUND_FACTORIAL_INPUTS_MAX = 5,               /* inputs whose every mixture of A and B is run */
	POUND_SAMPLES_MAX = 2 * POUND_INPUTS_MAX + 2, /* of a row of the design */
};

// why a run has no result
// clang-format off
#define POUND_FAILURES(X)                                                                 \
	X(POUND_CHATTER,   -3, "more events in one sample interval than allowed")             \
	X(POUND_UNSTABLE,  -4, "the steps of the solver are too long for this scene")         \
	X(POUND_TOLERANCE, -5, "the tolerance of the solver is out of its reach")             \
	X(POUND_OVERFLOW,  -6, "the motion left the range of the numbers")

#define POUND_STATUS(X)                                                                   \
	X(POUND_OK,         0, "ok")                                                          \
	X(POUND_NOMEM,     -1, "out of memory")                                               \
	X(POUND_STOPPED,   -2, "stopped by the caller")                                       \
	POUND_FAILURES(X)
// clang-format on

enum pound_status {
#define X(name, value, text) name = value,
	POUND_STATUS(X)
#undef X
};

enum pound_failure {
#define X(name, value, text) name##_RUNS = POUND_CHATTER - (value),
	POUND_FAILURES(X)
#undef X
	    POUND_N_FAILURES
};

/* The study: one in-memory form.  `type`, `model`, `method` and `outputs[]` are row numbers of the engine's tables;
 * pound_*_name(row) is the name in a study document, NULL past the last row. */

enum pound_kind {
	POUND_KIND_RESPONSE,
	POUND_KIND_SENSITIVITY,
	POUND_KIND_CONVERGENCE,
	POUND_KIND_FLOOR_SPECTRUM
};

struct pound_law {
	int type;                  /* row of the laws, pound_law_name */
	double hardening_ratio;    /* second slope over first  [0, 1] */
	double target_demand;      /* mu_d, wanted max |u| / yield displacement without pounding  >= 1 */
	double yield_displacement; /* [m]  > 0 given by the user, 0: found from target_demand for every signal */
	int corrections;           /* times the yield displacement is corrected  >= 0 */
};

struct pound_oscillator {
	double mass;          /* [kg]  > 0 */
	double frequency_hz;  /* undamped, of the initial stiffness  > 0 */
	double damping_ratio; /* fraction of critical  [0, 1) */
	bool rigid_wall;      /* follows the ground for ever; only the right one may be */
	bool has_law;         /* law below instead of the scene's */
	struct pound_law law;
};

struct pound_contact {
	bool present;           /* false: no pounding at all */
	int model;              /* row of the contact models, pound_contact_name */
	double stiffness_ratio; /* contact stiffness over the larger oscillator stiffness  > 0 */
	double restitution;     /* [0, 1] */
	double gap;             /* clear distance at rest [m]  >= 0 */
	bool tension;           /* the dashpot may pull just before separation */
};

struct pound_excitation {
	int type;               /* row of the excitations, pound_excitation_name */
	double frequency_hz;    /* filter (Kanai-Tajimi) or sine  > 0 */
	double damping_ratio;   /* of the filter  > 0 */
	double high_pass_ratio; /* high-pass corner over filter frequency  > 0 */
	double cycles;          /* duration times filter frequency  > 0 */
	double duration;        /* [s]  > 0 (white_noise, harmonic) */
	double rise, fall;      /* fractions of the duration, rise + fall <= 1 */
	double time_step;       /* between samples [s]  > 0 */
	double peak;            /* largest |a_g| of the samples [m/s2]  > 0 */
	int signals;            /* random signals of each scene  >= 1; 1 for harmonic and record */
	int n_record;           /* samples of the record, 0 for the other types */
	const double *record;   /* ground acceleration [m/s2]  (n_record), not owned */
};

struct pound_scene {
	struct pound_law law;
	struct pound_oscillator oscillators[POUND_OSCILLATORS];
	struct pound_contact contact;
	struct pound_excitation excitation;
};

struct pound_distribution {
	int type;              /* row of the distributions, pound_distribution_name */
	double p[4];           /* parameters in the order of pound_distribution_parameter(type, k) */
	int n_values;          /* of a discrete one  >= 1 */
	const double *values;  /* ascending  (n_values), not owned */
	const double *weights; /* of the values, > 0; their sum may be any  (n_values), not owned; NULL: alike */
};

/* what a varied field of the scene holds; a varied value is a double whatever it holds */
enum pound_field_type { POUND_FIELD_REAL, POUND_FIELD_COUNT, POUND_FIELD_CHOICE, POUND_FIELD_BOOL };

struct pound_field {
	enum pound_field_type type;
	size_t offset; /* of the field in struct pound_scene */
};

struct pound_input {
	const char *path; /* JSON Pointer into the scene */
	const char *name; /* for people */
	struct pound_field field;
	struct pound_distribution distribution;
};

/* The quotient of two inputs, as a variable whose indexes are wanted besides. */
struct pound_ratio {
	const char *name;  /* for people */
	const char *of[2]; /* paths of the inputs above and below */
};

struct pound_sweep {
	const char *path;
	struct pound_field field;
	int n_values;
	const double *values; /* (n_values) */
};

/* A design that grows until every interval of S1 and ST is narrow. */
struct pound_until {
	double half_width; /* that each is to have at most; 0: the design does not grow */
	int max_runs;      /* pounding runs at most */
};

struct pound_design {
	int method; /* row of the designs, pound_design_name */
	int rows;   /* n, rows of the matrices A and B  >= 2; of a design that grows, to begin with */
	uint64_t seed;
	bool common_signals; /* a row's samples share their noise; false: new noise for each sample */
	int randomisations;  /* of a quasi-random design, independent of each other; 0: as many as is best */
	int resamples;       /* behind an interval, of a design without groups of rows; 0: 2000 */
	struct pound_until until;
	int order;     /* row of the orders, pound_order_name: which samples a row has at least */
	int estimator; /* row of the estimators, pound_estimator_name; 0: only those of every study */
};

struct pound_solver {
	int method;       /* row of the solvers, pound_solver_name */
	double tolerance; /* relative; the event solver is exact and does not need it */
	double step;      /* longest [s]  > 0; a sample interval is cut into as few equal steps as that allows */
};

struct pound_settings {
	int n;
	double values[POUND_SETTINGS_MAX]; /* steps [s] or tolerances, each smaller than the one before  (n) */
};

/* the solvers that a convergence study compares with the event solver */
struct pound_convergence {
	struct pound_settings settings[POUND_SOLVERS]; /* by row of the solvers; none for a solver without */
	double history;                                /* displacements are compared for so long [s]  > 0 */
};

/* the oscillators on the left floor */
struct pound_spectrum {
	int n; /* frequencies; 0: no spectrum is asked */
	const double
	    *frequencies_hz; /* (n); NULL: n from min_hz to max_hz, each the same multiple of the one before */
	double min_hz, max_hz;
	double damping_ratio; /* [0, 1) */
	int pulses;           /* of the idealised train; 0: as many as there are contacts */
	bool histories;       /* the floor's history is wanted too */
};

struct pound_study {
	enum pound_kind kind;
	const char *name; /* NULL: none */
	bool elsewhere;   /* the design's samples are run by a model of the user's own; there need be no scene */
	struct pound_scene scene;
	int n_inputs;
	struct pound_input *inputs; /* (n_inputs) */
	int n_ratios;
	struct pound_ratio ratios[POUND_RATIOS_MAX]; /* (n_ratios) */
	int n_sweeps;
	struct pound_sweep *sweeps; /* (n_sweeps); the cells are their product, the last sweep fastest */
	struct pound_design design;
	int n_outputs;
	int outputs
	    [POUND_OUTPUTS_MAX]; /* rows of the outputs, pound_output_name; floor_spectrum once a frequency */
	char **output_names;     /* elsewhere, in their place: any number of names  (n_outputs), not owned */
	struct pound_solver solver;
	struct pound_convergence convergence;
	struct pound_spectrum spectrum;
};

double pound_spectrum_frequency(const struct pound_spectrum *spectrum, int k); /* [Hz] */

/* The tables' names, NULL past the last row. */
const char *pound_law_name(int row);
const char *pound_contact_name(int row);
const char *pound_excitation_name(int row);
const char *pound_distribution_name(int row);
const char *pound_distribution_parameter(int row, int k); /* "min", "max", ...; NULL past the last */
const char *pound_distribution_rule(int row, int k); /* "min must be less than max"; NULL past the last */
bool pound_distribution_lists_values(int row);       /* its parameters are values and weights instead */
const char *pound_design_name(int row);
bool pound_design_quasi_random(int row);
const char *pound_order_name(int row);
const char *pound_estimator_name(int row);
const char *pound_solver_name(int row);
bool pound_solver_takes_tolerance(int row);
bool pound_solver_takes_step(int row);
const char *pound_output_name(int row);
const char *pound_output_needs(int row);  /* from the scene, in words */
bool pound_output_has_ordinates(int row); /* stands once for each frequency of the spectrum */
int pound_study_ordinate(const struct pound_study *study, int output); /* number of its frequency; -1: none */

/* Rows of a study's design at its look-th look at the intervals, from 0; one that does not grow has all of them always.
 * 0: max_runs does not allow the first look. */
int pound_design_rows(const struct pound_study *study, int look);
int pound_design_rows_least(const struct pound_study *study);   /* at the first, of any that grows */
int pound_design_rows_most(const struct pound_study *study);    /* at the last look */
int64_t pound_design_row_runs(const struct pound_study *study); /* pounding runs of a row, in all cells */

/* The trials of a convergence study: the event solver, the second opinion, every setting; and the solver of one. */
int pound_convergence_trials(const struct pound_study *study);
struct pound_solver pound_convergence_solver(const struct pound_study *study, int trial);
/* The observed order of a solver over all its settings, NAN with fewer than two that tell. */
struct pound_trial;
double pound_convergence_order(const struct pound_trial *trials, int n_trials, int method);

/* Samples of a row of the study's design: A, B, A with column j from B for every j, ... (engine/order.h). */
int pound_design_samples(const struct pound_study *study);
int pound_design_order(const struct pound_study *study);
unsigned pound_order_mask(int n_inputs, int sample); /* bit j: column j of the sample is from B */

/* The input of a path, -1: none; how many variables ratios and the inputs in none are, and which inputs those are
 * (rest may be NULL); whether an input of this distribution may be in a ratio. */
int pound_ratio_input(const struct pound_study *study, const char *path);
int pound_ratio_variables(const struct pound_study *study, int *rest);
bool pound_ratio_takes(const struct pound_distribution *distribution);

#define POUND_PARAMETER_MAX 1e100 /* of a distribution: products of two stay finite */
/* Whether its parameters break rule k; one that is NAN, not known, breaks none. */
bool pound_distribution_breaks(const struct pound_distribution *distribution, int k);
double pound_distribution_quantile(const struct pound_distribution *distribution, double u); /* u in [0, 1] */
int pound_distribution_level(const struct pound_distribution *distribution,
                             double u); /* of its list of values */
double pound_distribution_below(const struct pound_distribution *distribution, int k); /* that level */
/* The ends of the interval that holds every value; infinite for a normal. */
void pound_distribution_support(const struct pound_distribution *distribution, double *low, double *high);

/* The law an oscillator follows: its own or the scene's. */
const struct pound_law *pound_scene_law(const struct pound_scene *scene, int oscillator);
void pound_scene_assign(struct pound_scene *scene, struct pound_field field, double value);
double pound_scene_field(const struct pound_scene *scene, struct pound_field field);

/* Whether an output is defined for a scene (force amplification: linear left oscillator, ...). */
bool pound_output_applies(int row, const struct pound_scene *scene);

/* The result. */

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

/* One signal's response.  NAN where the scene has no such value (the yield displacement of a linear law). */
struct pound_response {
#define X(member, name, oscillator) double member;
	POUND_MEASURES(X)
#undef X
	double energy_residual; /* energy put in and not found again, over the most there was along the way */
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
	POUND_CLOSED_MAX = (1 << POUND_FACTORIAL_INPUTS_MAX) - 2, /* sets but none and all */
};

/* Indexes of the study's ratios and then of the inputs in none, which depend on each other; Shapley effects add up to 1. */
struct pound_ratio_indices {
	int n; /* 0: none were asked, or too few rows */
	struct pound_estimate
	    explained; /* share of the output's variance, by these variables; NAN: cannot be told */
	struct pound_estimate first[POUND_FACTORIAL_INPUTS_MAX], total[POUND_FACTORIAL_INPUTS_MAX],
	    shapley[POUND_FACTORIAL_INPUTS_MAX]; /* (n) each */
};

/* The mean output given an input: at every value of a discrete one of up to POUND_CURVE, of any other where its
 * probability is (k + 1/2) / POUND_CURVE; NAN: too few rows. */
enum { POUND_CURVE = 50 };

struct pound_curve {
	struct pound_estimate mean[POUND_CURVE];
};

double pound_conditional_place(int k);                                       /* that probability */
int pound_conditional_points(const struct pound_distribution *distribution); /* of such a curve */
double pound_conditional_x(const struct pound_distribution *distribution,
                           int k); /* the input's value at point k */

/* Those that the design of the study tells, sets in ascending order. */
struct pound_set_indices {
	int n_second, n_closed;
	struct pound_set_index second[POUND_PAIRS_MAX]; /* second-order indexes  (n_second) */
	struct pound_set_index
	    closed[POUND_CLOSED_MAX]; /* share of the variance that a set explains  (n_closed) */
};

/* What the indexes of an output may be off by, and for want of what. */
// clang-format off
#define POUND_ERRORS(X)                                                                   \
	X(SAMPLING,    "sampling")    /* too few rows: the widest half of an interval */      \
	X(EXCITATION,  "excitation")  /* too few signals: what their randomness adds or takes */ \
	X(INTEGRATION, "integration") /* runs that are not exact */                           \
	X(FAILED_ROWS, "failed_rows") /* rows left out, as if like the most extreme other */
// clang-format on

enum pound_error {
#define X(row, name) POUND_ERROR_##row,
	POUND_ERRORS(X)
#undef X
	    POUND_ERROR_NONE /* and how many there are */
};

const char *pound_error_name(int row);
/* The one larger than all others together; unknown ones (NAN) count as 0. */
enum pound_error pound_accuracy_dominant(const double errors[POUND_ERROR_NONE]);

enum { POUND_LEVELS = 4 }; /* n/8, n/4, n/2, n rows */

struct pound_accuracy {
	int64_t runs_checked;     /* runs compared with the same on half the sample step */
	int64_t runs_unchecked;   /* without a value in one of the two */
	double difference_median; /* of the output of one run, relative; NAN: none */
	double difference_largest;
	double variance_share; /* of such differences in the output's variance */
	struct {
		double first_change, total_change; /* by the differences, at most */
		double first_dropped,
		    total_dropped; /* by rows left out, if like the one that moves it most; NAN: unknown */
		double first_half[POUND_LEVELS], total_half[POUND_LEVELS]; /* half widths of intervals; NAN: none */
	} inputs[POUND_INPUTS_MAX];                                    /* (n_inputs) */
	int rows[POUND_LEVELS];                                        /* behind the half widths; 0: too few */
	double slope;                    /* of log half width over log rows; NAN: undefined */
	double rows_to_halve;            /* the half widths; NAN: undefined, or out of reach */
	double errors[POUND_ERROR_NONE]; /* of the worst index, at most 1; NAN: unknown */
};

/* Columns of indexes, one row each: X(enumerator, name in a result).  The raw ones are the plain protocol's and hold the
 * noise of few signals; the pick-freeze ones are the same without it; S1 and ST are the sharpest from the same runs.
 * S2_excitation is the second-order index of the input and one signal; Shapley effects add up to 1. */
// clang-format off
#define POUND_INDEXES(X)                                                                  \
	X(POUND_S1,             "S1")                                                         \
	X(POUND_ST,             "ST")                                                         \
	X(POUND_S1_PICK_FREEZE, "S1_pick_freeze")                                             \
	X(POUND_ST_PICK_FREEZE, "ST_pick_freeze")                                             \
	X(POUND_S1_RAW,         "S1_raw")                                                     \
	X(POUND_ST_RAW,         "ST_raw")                                                     \
	X(POUND_S2_EXCITATION,  "S2_excitation")                                              \
	X(POUND_SHAPLEY,        "shapley")

/* Columns of the estimator that a study names, as its formula gives them and without the noise of few signals:
 * X(enumerator, name in a result, with %s for the estimator's). */
#define POUND_NAMED(X)                                                                    \
	X(POUND_NAMED_S1,           "S1_%s")                                                  \
	X(POUND_NAMED_ST,           "ST_%s")                                                  \
	X(POUND_NAMED_S1_CORRECTED, "S1_%s_corrected")                                        \
	X(POUND_NAMED_ST_CORRECTED, "ST_%s_corrected")

/* The excitation's randomness as an input of its own: X(enumerator, name in a result).  Of single runs the first-order
 * and the total index, and the total index, or share, that is left in the means over the study's signals. */
#define POUND_SHARES(X)                                                                   \
	X(POUND_SHARE_FIRST_ONE, "S1_one_signal")                                             \
	X(POUND_SHARE_TOTAL_ONE, "ST_one_signal")                                             \
	X(POUND_SHARE_TOTAL,     "ST_mean_of_signals")

/* What there is to say about the indexes of an output: X(enumerator, sentence). */
#define POUND_NOTES(X)                                                                    \
	X(POUND_NOTE_NO_ROWS,                                                                 \
	  "no row of the design gave a value, so there are no indexes")                       \
	X(POUND_NOTE_ONE_ROW,                                                                 \
	  "one row of the design gave a value, which is too few for indexes")                 \
	X(POUND_NOTE_CONSTANT,                                                                \
	  "the output is the same for every row, so it has no indexes")                       \
	X(POUND_NOTE_NOT_RANDOM,                                                              \
	  "the excitation is not random, so there is no noise to correct for")                \
	X(POUND_NOTE_ONE_SIGNAL,                                                              \
	  "with one signal its noise cannot be told apart, so it is in every index")          \
	X(POUND_NOTE_NO_VARIANCE,                                                             \
	  "no variance of the output is given, so whatever noise the model has is in every index") \
	X(POUND_NOTE_SHARED_NOISE,                                                            \
	  "variances do not tell how the samples of a row share their noise, so it is in every index") \
	X(POUND_NOTE_FRESH_SIGNALS,                                                           \
	  "samples that do not share their signals do not show S2_excitation and S1_one_signal") \
	X(POUND_NOTE_FEW_ROWS,                                                                \
	  "with fewer than 30 rows S1 and ST are S1_pick_freeze and ST_pick_freeze")          \
	X(POUND_NOTE_NOISE,                                                                   \
	  "the signals' noise is about as large as the variance, so corrected indexes are missing or far off") \
	X(POUND_NOTE_NO_INTERVAL,                                                             \
	  "too few rows for the interval of every index: those without one may be far off")    \
	X(POUND_NOTE_FEW_DECIDE,                                                              \
	  "one row makes a fifth of the variance or more, so intervals may be too narrow")
// clang-format on

#define X(name, text) name,
enum pound_index { POUND_INDEXES(X) POUND_N_INDEXES };
enum pound_share { POUND_SHARES(X) POUND_N_SHARES };
enum pound_note { POUND_NOTES(X) POUND_N_NOTES };
enum pound_named { POUND_NAMED(X) POUND_N_NAMED };
#undef X

struct pound_indices {
	double mean, variance; /* of the output over the rows of A and B */
	double noise_share;    /* of the variance over all samples, due to the excitation; NAN: one signal */
	double ratio_bias;     /* of the outputs as ratios of means of few signals, on average; NAN: one signal */
	unsigned notes;        /* bits 1 << enum pound_note */
	struct pound_estimate share[POUND_N_SHARES];
	struct pound_estimate *index[POUND_N_INDEXES]; /* (n_inputs) each */
	struct pound_estimate
	    *named[POUND_N_NAMED]; /* of the study's estimator, if it has one  (n_inputs) each */
	struct pound_set_indices sets;
	struct pound_ratio_indices ratios;
	struct pound_curve *curves;                /* (n_inputs); NULL: not wanted */
	struct pound_estimate impulse_correlation; /* of an ordinate with the largest impulse; NAN: no ordinate */
	struct pound_accuracy accuracy;
};

/* over the signals, relative; NAN: the scene has no such value, or no signal gave one */
struct pound_deviation {
	double mean, largest;
};

/* One setting of one solver against the event solver; an error is that of the left body. */
struct pound_trial {
	struct pound_solver solver;                           /* step: the one that was taken */
	int runs_failed;                                      /* signals without a result */
	struct pound_deviation displacement, demand, impulse; /* of the largest ones */
	struct pound_deviation
	    history;  /* largest difference of displacements in the first seconds over the largest */
	double order; /* slope of log mean history error over log setting, from the trial before; NAN: none */
	double cpu;   /* of a run [s]; NAN: there is no clock */
};

struct pound_cell {
	double sweep[POUND_SWEEPS_MAX];    /* the value of each sweep, (n_sweeps) used */
	int64_t runs, runs_failed;         /* pounding runs asked, and those among them without a result */
	int rows_dropped;                  /* rows of the design left out because one of their runs failed */
	int n_signals;                     /* response: signals */
	struct pound_response *signals;    /* response: (n_signals) */
	double outputs[POUND_OUTPUTS_MAX]; /* response: ratio of means of each asked output */
	struct pound_indices *indices;     /* sensitivity: (n_outputs) */
};

/* What was asked by the samples of the design and what was run after nothing is run twice. */
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
	int64_t never_touching; /* pounding runs not made: the free responses never close the gap */
	int64_t moving_alike;   /* pounding runs not made: equal oscillators never touch with force */
	int64_t yield_given;    /* linear responses not made: the yield displacement they would give is known */
	int64_t linear_unasked; /* linear responses of the right oscillator not made: no output needs them */
	int64_t nonlinear_unasked;        /* its nonlinear ones likewise */
	int64_t contacts;                 /* contacts in the runs made */
	int64_t failed[POUND_N_FAILURES]; /* pounding runs asked that have no result */
};

/* One look at the intervals of a design that grows: the widest one of an S1 or ST. */
struct pound_look {
	int rows;
	double half_width; /* infinite: an index has no interval */
	int cell, output, input;
	enum pound_index index;
};

/* Spectra of the left floor, one row each: X(row, name in a result).  The first ones are integrated. */
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

/* Pseudo-accelerations over the signals [m/s2], NAN: no signal has one  (n frequencies each) */
struct pound_floor_spectrum {
	double *mean, *p16, *p84;
	double *error; /* largest relative difference from the same on half the sample step, of integrated rows */
};

struct pound_floor_result {
	struct pound_floor_spectrum spectra[POUND_N_SPECTRA];
	int signals, signals_failed, signals_checked;
	double impulse_mean; /* mean of the largest impulses [N s] */
	double pulses_mean;  /* mean number of pulses of the idealised train */
};

struct pound_result {
	int rows;                 /* of the design, in this result */
	int n_looks;              /* 0: the design does not grow */
	struct pound_look *looks; /* (n_looks) */
	int n_cells;
	struct pound_cell *cells; /* (n_cells) */
	int n_trials;
	struct pound_trial
	    *trials; /* convergence: the event solver, the second opinion, the settings  (n_trials) */
	struct pound_floor_result floor; /* floor_spectrum */
	struct pound_work work;
};

/* One study being computed; owns all its memory.  The study must outlive it.
 *
 *   create -> block 0 .. blocks-1 (any order, any thread) -> reduce 0 .. reductions-1 (likewise) -> grow -> result
 *             block blocks .. <- more blocks ---------------------------------------------------------'
 *
 * Of a model that is run elsewhere there are no blocks: create -> sample_inputs ... sample_assign ... -> reduce -> result.
 *
 * A finished block is pound_run_block_size() doubles at pound_run_block_values(); restoring them stands for
 * running the block, so a caller can store blocks and go on after a restart with the same bytes. */
struct pound_run;

struct pound_run *pound_run_create(const struct pound_study *study, int n_workers); /* NULL: out of memory */
/* the same, or NULL soon after the flag is set: a design of a million rows takes seconds to draw */
struct pound_run *pound_run_create_by(const struct pound_study *study, int n_workers,
                                      const atomic_bool *stop);
void pound_run_free(struct pound_run *run);
int pound_run_blocks(const struct pound_run *run);      /* to run before the next reductions */
int pound_run_blocks_most(const struct pound_run *run); /* of a design that grows: if it grows to the end */
int64_t pound_run_block_runs(const struct pound_run *run, int block); /* pounding runs asked, for progress */
enum pound_status pound_run_block(struct pound_run *run, int block, int worker);
size_t pound_run_block_size(const struct pound_run *run, int block); /* doubles */
const double *pound_run_block_values(const struct pound_run *run, int block);
void pound_run_block_restore(struct pound_run *run, int block, const double *values);
int pound_run_reductions(const struct pound_run *run);
enum pound_status pound_run_reduce(struct pound_run *run, int reduction, int worker);
const struct pound_result *
pound_run_result(struct pound_run *run); /* after the last reduction; owned by run */
/* After the last reduction: whether the design grows, as an interval is not narrow enough.  Then there are more blocks, and
 * all reductions are to be made again; else the result is there. */
bool pound_run_grow(struct pound_run *run);
/* Intermediate results: how many rows at the start of the design have all their blocks done  (pound_run_blocks_most); and
 * the reductions, and so the result, of so many rows. */
int pound_run_rows_done(const struct pound_run *run, const bool *done);
void pound_run_rows_take(struct pound_run *run, int rows);
int pound_run_rows(const struct pound_run *run); /* that the reductions are of */
/* Seconds of CPU time of the calling thread, for the times of a convergence study; before the first block. */
void pound_run_clock(struct pound_run *run, double (*cpu)(void));
/* Blocks and reductions return POUND_STOPPED soon: they look for that every few milliseconds. */
void pound_run_stop(struct pound_run *run);
/* A flag of the caller's, which outlives the run, does that when it is set, and pound_run_stop no more. */
void pound_run_stop_by(struct pound_run *run, const atomic_bool *stop);
bool pound_run_stopped(const struct pound_run *run);

/* The sample behind row `row` and design block `sample` (0: A, 1: B, 2 + j: A with column j from B, ...), after all
 * blocks: the input values, and of each output in a cell the ratio of means and the variance of that mean
 * over its signals divided by their number (NAN: failed run, or a variance of one signal). */
int pound_run_samples(const struct pound_run *run); /* of a row */
void pound_run_sample_inputs(const struct pound_run *run, int row, int sample, double *x);
void pound_run_sample_output(const struct pound_run *run, int cell, int row, int sample, int output,
                             double *mean, double *variance);

/* Gives an output of a sample that was computed elsewhere, before the reductions: its value, and the variance of that
 * value over the model's randomness (NAN: not known).  A value that is not finite: a failed run. */
void pound_run_sample_assign(struct pound_run *run, int row, int sample, int output, double value,
                             double variance);

/* The left floor at one time, with pounding. */
struct pound_instant {
	double time, u, v;   /* [s]; relative to the ground [m], [m/s] */
	double acceleration; /* absolute [m/s2] */
	double force;        /* of the contact, > 0 pushes the left body away [N] */
};

/* The history of one signal of a study of spectra: at its samples, and on both sides of every event.  Runs it once more, in
 * the work space of worker 0. */
typedef void pound_run_take(void *into, int signal, const struct pound_instant *instant);
enum pound_status pound_run_history(struct pound_run *run, int signal, pound_run_take *take, void *into);

const char *pound_status_text(enum pound_status status);
const char *pound_status_error(enum pound_status status); /* why a study has no result */

#endif
