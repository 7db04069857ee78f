/* study.h - a study: the input of the engine.
 *
 * Units are SI: m, kg, s, N, rad/s, unless the name ends in another unit (_hz).  Arrays are row-major; the shape is in the
 * comment of the field. */
#ifndef STUDY_H
#define STUDY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
	POUND_OSCILLATORS = 2,    /* left, right */
	POUND_INPUTS_MAX = 32,    /* inputs of one sensitivity study; sets of them are the bits of an unsigned */
	POUND_ORDINATES_MAX = 64, /* frequencies of a sensitivity study's floor spectrum */
	POUND_OUTPUTS_ASKED_MAX = 24,   /* names in the outputs of one study */
	POUND_OUTPUTS_MAX = 8 + 3 * 64, /* outputs of one study, counting each ordinate and place */
	POUND_SWEEPS_MAX = 8,           /* swept fields of one study */
	POUND_RATIOS_MAX = 3,           /* ratios of inputs of one study */
	POUND_GROUPS_MAX = 8,           /* groups of inputs of one study */
	POUND_SOLVERS = 4,              /* rows of the solvers */
	POUND_CONTACT_MODELS = 10,      /* rows of the contact models */
	POUND_SETTINGS_MAX = 16,        /* settings compared of one solver */
	POUND_BALANCED_SIGNALS = 32,    /* first signals of a response cell that get energy balances */
	POUND_ROWS_MAX = 1 << 20,       /* rows of a design */
	POUND_FACTORIAL_INPUTS_MAX = 5, /* inputs of a full factorial of A and B */
	POUND_SAMPLES_MAX = 2 * POUND_INPUTS_MAX + 2 + POUND_GROUPS_MAX, /* samples of a design row */
	POUND_BUILDINGS_MAX = 8,                                         /* buildings of a row */
	POUND_STOREYS_MAX = 50,                                          /* stories of a building */
	POUND_GAPS_OF_ROW_MAX = 60,   /* contacts of a separation study: three outputs each */
	POUND_CONTACTS_MAX = 400,     /* between the buildings of a row */
	POUND_PLACES_MAX = 64,        /* stories with outputs */
	POUND_GAPS_MAX = 200,         /* gaps to report the pounding probability of */
	POUND_PROBABILITIES_MAX = 20, /* pounding probabilities to report the gap of */
	POUND_STRIPES_MAX = 100,      /* intensities of a fragility curve, points of a hazard curve */
	POUND_PERIODS_MAX = 20,       /* return periods to report the gap of */
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

/* The study in memory.  `type`, `model`, `method` and `outputs[]` are row numbers of the engine's tables;
 * pound_*_name(row) is the name in a study document, NULL past the last row. */

enum pound_kind {
	POUND_KIND_RESPONSE,
	POUND_KIND_SENSITIVITY,
	POUND_KIND_CONVERGENCE,
	POUND_KIND_FLOOR_SPECTRUM,
	POUND_KIND_SEPARATION
};

/* Forms of contact force, by what they require of a solver; p: penetration. */
enum pound_force {
	POUND_FORCE_LINEAR,   /* K p + C p' throughout a contact: scales with the motion */
	POUND_FORCE_STRAIGHT, /* piecewise linear */
	POUND_FORCE_PRODUCT,  /* p times a linear function of p' */
	POUND_FORCE_POWER,    /* p^1.5, with or without a factor of p' */
	POUND_FORCE_IMPACT,   /* velocity jumps */
	POUND_FORCES
};

struct pound_law {
	int type;                  /* row of the laws, pound_law_name */
	double hardening_ratio;    /* second slope over first  [0, 1] */
	double target_demand;      /* mu_d, target max |u| / yield displacement without pounding  >= 1 */
	double yield_displacement; /* [m]  > 0 given by the user, 0: found from target_demand for every signal */
	int corrections; /* of the yield displacement  >= 0; from 2 on, at most in a search for target_demand */
};

struct pound_oscillator {
	double mass;          /* [kg]  > 0 */
	double frequency_hz;  /* undamped, of the initial stiffness  > 0 */
	double damping_ratio; /* fraction of critical  [0, 1) */
	bool rigid_wall;      /* moves with the ground; only the right body may */
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
	// each read by some models only, pound_contact_reads
	int calibration;  /* of the dashpot by the restitution: row of the calibrations, pound_calibration_name */
	double stiffness; /* [N/m]  > 0; 0: by stiffness_ratio */
	double hertz_stiffness;        /* [N/m^1.5]  > 0; 0: from the linear stiffness and reference_speed */
	double reference_speed;        /* at which both springs have the same largest overlap [m/s]  > 0 */
	double second_stiffness_ratio; /* stiffness beyond the yield overlap over the initial one  [0, 1] */
	double yield_overlap;          /* [m]  > 0 */
	double
	    speed_floor; /* lower bound of the approach speed in a dashpot's divisor, or for an impact to count [m/s]  > 0 */
};

/* A number for every story, from the ground up. */
struct pound_each {
	int n; /* 0: none; 1: the same for all; else one per story */
	double values[POUND_STOREYS_MAX];
};

/* A shear building: floor masses, each on a story with lateral stiffness. */
struct pound_building {
	int storeys;                 /* [1, POUND_STOREYS_MAX] */
	struct pound_each mass;      /* of the floors [kg]  > 0 */
	struct pound_each stiffness; /* of the stories [N/m]  > 0; n = 0: by frequency_hz and profile */
	double frequency_hz;         /* of the first mode  > 0; 0: the stiffness is given */
	struct pound_each profile;   /* relative stiffness of the stories  > 0 */
	struct pound_each height;    /* of the stories [m]  > 0 */
	int damping;                 /* row of the damping forms, pound_damping_name */
	struct pound_each
	    damping_ratio;    /* fraction of critical; one per story if the damping form takes it  [0, 1) */
	int damping_modes[2]; /* of Rayleigh damping, ascending, from 1 */
	bool rigid_wall;      /* moves with the ground; only the last building may */
	bool has_law;         /* law below instead of the scene's */
	struct pound_law law; /* of every story; its yield displacement is yield_drift */
	struct pound_each
	    yield_drift; /* [m]  > 0 given by the user, n = 0: found from target_demand for every signal */
};

/* A contact between a building of a row and its right neighbor. */
struct pound_row_contact {
	int left_building; /* index */
	double levels[2];  /* left, right: 2 is floor 2, (2, 3) between floors 2 and 3  > 0 */
	struct pound_contact contact;
	unsigned char
	    own[sizeof(struct pound_contact)]; /* 1: this byte of `contact` is its own, 0: the scene's */
};

/* A story of a building, and the floor above it. */
struct pound_storey_place {
	int building; /* index */
	int storey;   /* from 1 */
};

/* A recorded ground motion of a suite. */
struct pound_record {
	const char *name; /* display name; NULL: none */
	int n;            /* samples  >= 2 */
	double time_step; /* between samples [s]  > 0 */
	const double *a;  /* ground acceleration [m/s2]  (n), not owned */
	double factor;    /* of the samples  > 0 */
	bool reversed;    /* sign reversed */
};

/* Intensity measure that the records of a suite are scaled to. */
enum pound_scale_to { POUND_SCALE_NONE, POUND_SCALE_PGA, POUND_SCALE_SA, POUND_SCALE_MEDIAN_SA };

struct pound_scale {
	int to;               /* enum pound_scale_to, pound_scale_name */
	double intensity;     /* [m/s2]  > 0 */
	double period;        /* of the oscillator of the spectral acceleration [s]  > 0 */
	double damping_ratio; /* of that oscillator  [0, 1) */
};

struct pound_excitation {
	int type;               /* row of the excitations, pound_excitation_name */
	double frequency_hz;    /* filter (Kanai-Tajimi) or sine  > 0 */
	double damping_ratio;   /* of the filter  > 0 */
	double high_pass_ratio; /* high-pass corner over filter frequency  > 0 */
	double cycles;          /* duration times filter frequency  > 0 */
	double duration;        /* [s]  > 0 (white_noise, harmonic) */
	double rise, fall;      /* fractions of the duration, rise + fall <= 1 */
	double time_step;       /* between samples [s]  > 0; of a suite: the longest of its records */
	double peak;            /* largest |a_g| of the samples [m/s2]  > 0 */
	int signals;            /* of each scene  >= 1; 1 for harmonic and record */
	double factor;          /* scale factor of a record or suite; < 0: also reversed */
	int n_record;           /* samples of the record, 0 for the other types */
	const double *record;   /* ground acceleration [m/s2]  (n_record), not owned */
	int number;             /* index in the suite, of a record that is a signal of a suite */
	// of a suite
	int n_records;
	const struct pound_record *records; /* (n_records), not owned */
	bool both;                          /* each record is two signals: as recorded, and reversed */
	int draw;                           /* signals drawn from these with replacement; 0: each once */
	struct pound_scale scale;
};

struct pound_scene {
	struct pound_law law;
	struct pound_oscillator oscillators[POUND_OSCILLATORS];
	struct pound_contact contact;
	struct pound_excitation excitation;
	int n_buildings;                    /* in a row, >= 2; 0: two oscillators */
	struct pound_building *buildings;   /* from left to right  (n_buildings), not owned */
	int n_contacts;                     /* 0: equal floor numbers touch, in every gap */
	struct pound_row_contact *contacts; /* (n_contacts), not owned */
	int n_places;
	struct pound_storey_place *places; /* of a row: stories with outputs  (n_places), not owned */
};

struct pound_distribution {
	int type;              /* row of the distributions, pound_distribution_name */
	double p[4];           /* parameters in the order of pound_distribution_parameter(type, k) */
	int n_values;          /* of a discrete or empirical distribution  >= 1 */
	const double *values;  /* ascending  (n_values), not owned */
	const double *weights; /* of the values, > 0, not normalized  (n_values), not owned; NULL: equal */
};

/* type of a varied field of the scene; a varied value is always passed as a double */
enum pound_field_type {
	POUND_FIELD_REAL,
	POUND_FIELD_COUNT,
	POUND_FIELD_CHOICE,
	POUND_FIELD_BOOL,
	POUND_FIELD_EACH
};

/* the array that holds a field */
enum pound_part { POUND_PART_SCENE, POUND_PART_BUILDINGS, POUND_PART_CONTACTS };

struct pound_field {
	enum pound_field_type type;
	size_t offset; /* in struct pound_scene, or from the first building or contact of its row [bytes] */
	enum pound_part part; /* the base of the offset */
	int storey;           /* for POUND_FIELD_EACH: from 1; 0: all */
};

struct pound_input {
	const char *path; /* JSON Pointer into the scene */
	const char *name; /* display name */
	struct pound_field field;
	struct pound_distribution distribution;
};

/* The ratio of two inputs, as a variable whose indices are reported as well. */
struct pound_ratio {
	const char *name;  /* display name */
	const char *of[2]; /* paths of numerator and denominator */
};

/* Inputs to report indices for as one group. */
struct pound_group {
	const char *name; /* display name */
	int n;
	const char *of[POUND_INPUTS_MAX]; /* paths of the inputs  (n) */
	unsigned inputs;                  /* bit j: input j */
};

struct pound_sweep {
	const char *path;
	struct pound_field field;
	int n_values;
	const double *values; /* (n_values) */
};

/* The stopping criterion of a growing design: X(enumerator, name). */
#define POUND_GOALS(X)                                                       \
	X(POUND_GOAL_WIDTH, "width") /* every interval of S1 and ST is narrow */ \
	X(POUND_GOAL_ORDER,                                                      \
	  "order") /* the order of the inputs by ST is certain: intervals that overlap are narrow */

#define X(name, text) name,
enum pound_goal { POUND_GOALS(X) POUND_N_GOALS };
#undef X

/* A design that grows until intervals are narrow. */
struct pound_until {
	double half_width; /* upper bound for each; 0: the design does not grow */
	int max_runs;      /* pounding runs at most */
	int goal;          /* enum pound_goal: the intervals that count */
	int output;        /* 0: all outputs count; else 1 + the row of the one that counts */
};

struct pound_design {
	int method; /* row of the designs, pound_design_name */
	int rows;   /* n, rows of the matrices A and B  >= 2; of a growing design: initially */
	uint64_t seed;
	int row;             /* row number whose noise the first row uses, to rerun one row alone; 0: no shift */
	bool common_signals; /* a row's samples share their noise; false: new noise for each sample */
	int randomisations;  /* independent, of a quasi-random design; 0: chosen automatically */
	int resamples;       /* bootstrap resamples, of a design without groups of rows; 0: 2000 */
	struct pound_until until;
	bool
	    split; /* a pilot chooses the signals per row (pound_study_split); until then the study has the smallest
	               number, and the rows for it */
	int runs;      /* of a split design that does not grow: budget of pounding runs, pilot included */
	int order;     /* row of the orders, pound_order_name: samples that a row has at least */
	int estimator; /* row of the estimators, pound_estimator_name; 0: no additional one */
};

struct pound_solver {
	int method;       /* row of the solvers, pound_solver_name */
	double tolerance; /* relative; the event solver is exact and does not need it */
	double step; /* upper bound [s]  > 0; a sample interval is divided into the fewest equal steps below it */
};

struct pound_settings {
	int n;
	double values[POUND_SETTINGS_MAX]; /* steps [s] or tolerances, each smaller than the one before  (n) */
};

/* the solvers that a convergence study compares with the event solver */
struct pound_convergence {
	struct pound_settings settings[POUND_SOLVERS]; /* by row of the solvers; n = 0: solver not compared */
	double history; /* duration over which displacements are compared [s]  > 0 */
};

/* the oscillators on the left floor */
struct pound_spectrum {
	int n; /* frequencies; 0: no spectrum requested */
	const double
	    *frequencies_hz; /* (n); NULL: n from min_hz to max_hz, equally spaced on a logarithmic axis */
	double min_hz, max_hz;
	double damping_ratio;            /* [0, 1) */
	int pulses;                      /* of the idealized pulse train; 0: the number of contacts */
	bool histories;                  /* histories requested, too */
	struct pound_storey_place place; /* the floor, in a row of buildings */
};

/* Requests of a separation study: how wide a gap has to be. */
struct pound_separation {
	int n_gaps;         /* 0: round values up to the largest gap that a run needs */
	const double *gaps; /* to report the pounding probability of [m]  ascending  (n_gaps) */
	int n_probabilities;
	const double *probabilities; /* of pounding, to report the gap of  (0, 1)  (n_probabilities) */
	const char *intensity;       /* path of a sweep: the intensity of fragility curves; NULL: none */
	int stripes;                 /* index of that sweep; -1: none */
	int n_intensities, n_rates;  /* of the hazard curve, equal; 0: none */
	const double *intensities;   /* > 0, ascending  (n_intensities) */
	const double *rates;         /* of exceedance, > 0, descending [1/a]  (n_rates) */
	int n_periods;
	const double *periods; /* return periods to report the gap of [a]  (n_periods) */
	int n_own;             /* number of first outputs, read from the runs without contact */
};

struct pound_study {
	enum pound_kind kind;
	const char *name; /* NULL: none */
	bool elsewhere;   /* the user's own model runs the design's samples; the scene may be missing */
	int replicates;   /* elsewhere: values per sample; 0: one, a mean with or without known variance */
	struct pound_scene scene;
	int n_inputs;
	struct pound_input *inputs; /* (n_inputs) */
	int n_ratios;
	struct pound_ratio ratios[POUND_RATIOS_MAX]; /* (n_ratios) */
	int n_groups;
	struct pound_group groups[POUND_GROUPS_MAX]; /* (n_groups) */
	int n_sweeps;
	struct pound_sweep *sweeps; /* (n_sweeps); the cells are their Cartesian product, last sweep fastest */
	struct pound_design design;
	int n_outputs;
	int outputs
	    [POUND_OUTPUTS_MAX]; /* rows of the outputs, pound_output_name; floor_spectrum once per frequency */
	char **output_names;     /* elsewhere: names instead of outputs[]  (n_outputs), not owned */
	struct pound_solver solver;
	struct pound_convergence convergence;
	struct pound_spectrum spectrum;
	bool unbalanced; /* a response study without energy balances */
	struct pound_separation separation;
};

/* A split design: rows and pounding runs of its pilot, and the study with the given number of signals per row, which is no
 * longer split. */
enum { POUND_SPLIT_LEAST = 2, POUND_SPLIT_PILOT_LEAST = 32 /* rows */ };
int pound_study_pilot_rows(const struct pound_study *study);
int64_t pound_study_pilot_runs(const struct pound_study *study);
void pound_study_split(const struct pound_study *study, int signals, struct pound_study *as_split);

bool pound_study_sampled(const struct pound_study *study); /* it has a design */
bool pound_study_pounds(const struct pound_study *study);  /* its outputs need runs with contact */
int pound_study_gaps(const struct pound_study *study); /* of a separation study: contacts of its row, or 1 */

/* One-line descriptions of the tables' rows. */
const char *pound_law_text(int row);
const char *pound_contact_text(int row);
const char *pound_damping_text(int row);
const char *pound_excitation_text(int row);
const char *pound_solver_text(int row);
const char *pound_output_text(int row);
const char *pound_rule_text(int row);

double pound_spectrum_frequency(const struct pound_spectrum *spectrum, int k); /* [Hz] */

/* The tables' names, NULL past the last row. */
const char *pound_law_name(int row);
const char *pound_contact_name(int row);
enum pound_force pound_contact_force(int row);
bool pound_force_scales(enum pound_force force); /* twice the motion, twice the force */
const char *pound_calibration_name(int row);
bool pound_contact_reads(int row, const char *member);              /* reads this member of /scene/contact */
bool pound_contact_takes_zero(const struct pound_contact *contact); /* restitution 0 has a dashpot */
const char *pound_damping_name(int row);
bool pound_damping_takes_modes(int row); /* the damping ratio applies to two modes */
bool pound_damping_takes_each(int row);  /* every story may have its own damping ratio */
const char *pound_excitation_name(int row);
const char *pound_scale_name(int row);
int pound_suite_signals(const struct pound_excitation *suite); /* records times directions */
void pound_suite_samples(const struct pound_excitation *suite, int *least, int *most); /* of its records */
const char *pound_rule_name(int row);
const char *pound_distribution_name(int row);
const char *pound_distribution_parameter(int row, int k); /* "min", "max", ...; NULL past the last */
const char *pound_distribution_rule(int row, int k); /* "min must be less than max"; NULL past the last */
bool pound_distribution_lists_values(int row);       /* parameters are values and weights instead */
bool pound_distribution_steps(int row);              /* discrete: takes only these values */
const char *pound_design_name(int row);
bool pound_design_quasi_random(int row);
const char *pound_order_name(int row);
const char *pound_estimator_name(int row);
int pound_estimator_order(int row); /* row of the orders: samples that a row of its design has at least */
const char *pound_solver_name(int row);
bool pound_solver_takes_tolerance(int row);
bool pound_solver_takes_step(int row);
bool pound_solver_takes_force(int row, enum pound_force force);     /* can integrate it */
bool pound_solver_takes_row_force(int row, enum pound_force force); /* ... of rows of buildings */
bool pound_row_takes_solver(const struct pound_study *study,
                            int solver); /* provides all that the study's outputs read */
bool pound_solver_is_observed(int row);  /* outputs may observe the whole motion */
bool pound_solver_is_portable(int row);  /* the same bytes on every processor */
const char *pound_output_name(int row);
const char *pound_output_needs(int row, const struct pound_scene *scene); /* of the scene, in words */
bool pound_output_observes(int row,
                           const struct pound_scene *scene); /* reads more than every solver provides */
bool pound_output_has_ordinates(int row); /* has a value for each frequency of the spectrum */
bool pound_output_has_places(int row, const struct pound_scene *scene); /* one value per place */
bool pound_output_has_contacts(int row, const struct pound_scene *scene);
int pound_study_contact(const struct pound_study *study, int output);  /* index of its contact; -1: none */
int pound_study_ordinate(const struct pound_study *study, int output); /* index of its frequency; -1: none */
int pound_study_place(const struct pound_study *study, int output);    /* index of its place; -1: none */

/* Rows of a study's design at interim analysis `look`, from 0; a design that does not grow always has all rows.
 * 0: max_runs does not allow the first one. */
int pound_design_rows(const struct pound_study *study, int look);
int pound_design_rows_least(const struct pound_study *study);   /* of any growing design, at its first look */
int pound_design_rows_most(const struct pound_study *study);    /* at the last look */
int64_t pound_design_row_runs(const struct pound_study *study); /* pounding runs of a row, in all cells */

/* The trials of a convergence study: the event solver, the reference check, every setting; and the solver of a trial. */
int pound_convergence_trials(const struct pound_study *study);
struct pound_solver pound_convergence_solver(const struct pound_study *study, int trial);
/* The observed order of a solver over all its settings; NAN with fewer than two errors above rounding. */
struct pound_trial;
double pound_convergence_order(const struct pound_trial *trials, int n_trials, int method);

/* Samples of a row of the study's design: A, B, A with column j from B for every j, ... (engine/design/row_samples.h), then A
 * with the columns of each group from B. */
int pound_design_samples(const struct pound_study *study);
int pound_design_order(const struct pound_study *study);
unsigned pound_inputs_all(int n); /* the set of n inputs  [1, POUND_INPUTS_MAX] */
unsigned pound_design_mask(const struct pound_study *study,
                           int sample); /* bit j: column j of the sample is from B */

/* The input with a path (elsewhere: a name), -1: none; the number of variables, ratios plus remaining inputs, and the indices of the
 * remaining inputs (rest may be NULL); whether an input of this distribution may be in a ratio. */
int pound_study_input(const struct pound_study *study, const char *path);
int pound_ratio_variables(const struct pound_study *study, int *rest);
bool pound_ratio_takes(const struct pound_distribution *distribution);

#define POUND_PARAMETER_MAX 1e100 /* largest parameter of a distribution: products of two stay finite */
/* Whether the parameters break rule k; an unknown parameter (NAN) breaks none. */
bool pound_distribution_breaks(const struct pound_distribution *distribution, int k);
double pound_distribution_quantile(const struct pound_distribution *distribution, double u); /* u in [0, 1] */
int pound_distribution_level(const struct pound_distribution *distribution,
                             double u); /* index in its list of values */
double pound_distribution_below(const struct pound_distribution *distribution, int k); /* P(level < k) */
/* The ends of the support; infinite for a normal distribution. */
void pound_distribution_support(const struct pound_distribution *distribution, double *low, double *high);

/* The law of an oscillator: its own or the scene's. */
const struct pound_law *pound_scene_law(const struct pound_scene *scene, int oscillator);
double pound_each_of(const struct pound_each *each, int i); /* of story i, from 0 */
void pound_scene_assign(struct pound_scene *scene, struct pound_field field, double value);
double pound_scene_field(const struct pound_scene *scene, struct pound_field field);
bool pound_field_alike(struct pound_field a, struct pound_field b);    /* identical */
bool pound_field_overlaps(struct pound_field a, struct pound_field b); /* share a story */

/* A row of buildings as floors, ordered from left to right and from the ground up, and contacts. */
int pound_row_floors(const struct pound_scene *scene);
int pound_row_first(const struct pound_scene *scene, int building);   /* index of its first floor */
int pound_row_storeys(const struct pound_scene *scene, int building); /* 0 for a rigid wall */
int pound_row_contacts(const struct pound_scene *scene);
void pound_row_contact_of(const struct pound_scene *scene, int k, struct pound_row_contact *contact);
size_t pound_row_bytes(const struct pound_scene *scene);
void pound_row_own(struct pound_scene *scene, void *memory);
int pound_row_measures(
    const struct pound_study *study); /* doubles of a response, in the cell with the most stories */
const struct pound_law *pound_row_law(const struct pound_scene *scene, int building);

/* Whether an output is defined for a scene (force amplification: linear left oscillator, ...). */
bool pound_output_applies(int row, const struct pound_scene *scene);

#endif
