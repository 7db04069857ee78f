/* simulation.inl - the state of one simulation in memory, between its steps in the lanes.
 *
 * Its numbers are stored in rows of one cache line; whole rows of a batch are transposed into vectors, one lane per
 * simulation, and back.  next_step.inl has the operations on one simulation at a time.
 *
 * Included by exact.inl, first. */

#include <float.h>
#include <stdalign.h>

#include "engine/exact/counts.h"
#include "engine/exact/task.h"

enum {
	POUND_MAPS = 4,          /* free-motion maps a body keeps */
	POUND_PEAKS = 4,         /* noted samples that may contain a body's largest displacement */
	POUND_OTHERS = 3,        /* further tasks that share a simulation: shared_start.inl */
	POUND_MAP_ORDERS = 18,   /* terms of a map's series; 0.945^18/18! = 6e-17 */
	POUND_MAP_LONGER = 26,   /* ... of a long sample's; 2^26/26! = 2e-19 */
	POUND_CONTACT_MAPS = 3,  /* pairs of branches whose substep map and doubled maps a simulation keeps */
	POUND_DOUBLED_MAPS = 12, /* maps over many substeps */
	POUND_CONTACT_INPUTS =
	    8 /* base u, v; overlap p, q; forcing of base and overlap; their growth over the map's length */
};

/* Rows of a simulation: T is double in memory and a vector in lanes; every row has eight. */
#define POUND_ROWS(T)                                                                                                                 \
	/* STATE: displacement, velocity, largest |u| (DBL_MAX: not requested) of each body; overlap and its rate */                      \
	T u[2], v[2], top[2], p, q;                                                                                                       \
	/* STEP: length of the next step; ground acceleration at its start and its slope; impulse of this contact; \
	 * contact time without whole substeps; time left in the interval: a remainder and whole substeps; \
	 * step factor <= 1, below 1 after an unsure search */                      \
	T dt, ground, slope, impulse, contact_time, remainder, substeps, pace;                                                            \
	/* LEFT, RIGHT: a body and its current branch; step_gap is the sample step (left) or the gap (right) */                           \
	struct {                                                                                                                          \
		T stiffness, damping, offset, drive, low, high, direction, step_gap;                                                          \
	} body[2];                                                                                                                        \
	/* PAIR: the contact; both: 1 + mass ratio; release: C/K; length of a contact substep, and of the longest step without contact */ \
	T contact_stiffness, contact_damping, mass_ratio, both, gap, release, substep, reach;                                             \
	/* MAP_LEFT, MAP_RIGHT: map of a body over one sample, and error bounds of its cubic (struct pound_map) */                        \
	struct {                                                                                                                          \
		T uu, uv, ua, ud, va, eu, ev, ef;                                                                                             \
	} map[2];                                                                                                                         \
	/* CONTACT: constants of a substep: forcing, side of the base body; whole substeps in contact so far; \
	 * applications of the map until another one is chosen; substeps per sample interval */                           \
	T base_force, gap_force, base_drive, gap_drive, side, substeps_done, rounds, substeps_per_sample;                                 \
	/* WORK: energy put in; energy dissipated or stored less that, and its rounding error; the largest energy so far */               \
	T work_in, work_gap, work_low, work_top, right_mass, work_spare[3];

struct state_rows {
	POUND_ROWS(double)
};

/* offsets of the rows, in doubles */
enum {
	ROW_STATE = 0,
	ROW_STEP = 8,
	ROW_LEFT = 16,
	ROW_RIGHT = 24,
	ROW_PAIR = 32,
	ROW_MAP_LEFT = 40,
	ROW_MAP_RIGHT = 48,
	ROW_CONTACT = 56,
	ROW_WORK = 64,
	ROWS_END = 72,
};

/* range of the rows that are constant while the bodies stay on their branches, in doubles */
enum {
	ROWS_CONSTANT = ROW_LEFT,
	ROWS_CONSTANT_END = ROW_CONTACT,
};

/* exact displacement of one body after one sample, from (u, v) and a forcing that grows from a to a + d: a row MAP */
struct pound_map {
	alignas(64) double uu;
	double uv, ua, ud, va; /* the velocity follows from these: free_map_of in free_motion.inl */
	double eu, ev, ef;     /* the cubic's error is at most eu |u| + ev |v| + ef (|a| + |d|) */
};

/* rows of a contact map, each a linear form of the inputs; error bounds are linear forms of magnitudes */
enum {
	CONTACT_U, /* increments of the base's displacement and velocity, of the overlap and its rate */
	CONTACT_V,
	CONTACT_P,
	CONTACT_Q,
	CONTACT_IMPULSE,
	CONTACT_ERROR, /* substep: error of the cubics of the base's displacement and of the overlap */
	DOUBLED_ERROR =
	    CONTACT_ERROR, /* doubled map: error of the common motion's cubic, of other magnitudes (contact_map.inl) */
	DOUBLED_CURVATURE, /* doubled map: curvature of the closing acceleration g (doubled_bounds) */
	CONTACT_SPLIT,     /* not a form: constants, by the enum below */
	CONTACT_MAP_ROWS,
};

/* constants that split the motion into the common motion of both bodies and the overlap's own: doubled_bounds */
enum {
	SPLIT_DAMPING,
	SPLIT_STIFFNESS,  /* closing acceleration per common velocity and per common displacement */
	SPLIT_BASE,       /* displacement of the base beyond the common one, per overlap */
	SPLIT_RESIDUAL,   /* doubled map: error of the common motion's cubic per residual overlap e */
	SPLIT_OMEGA,      /* frequency of the contact [rad/s] */
	SPLIT_TWO_ZETA,   /* its damping over omega */
	SPLIT_PHASE_LEAD, /* amplitude of the force over the overlap's, where contact ends at zero force; else 1 */
	SPLIT_SUBSTEPS,   /* length of the map */
};

struct pound_contact_map {
	alignas(64) double row[CONTACT_MAP_ROWS][POUND_CONTACT_INPUTS];
	double closing
	    [POUND_CONTACT_INPUTS]; /* doubled map: increment of the closing acceleration g over its length (doubled_bounds) */
};

/* A sample passed in free motion that may contain a body's largest displacement: state at its start, branch, and a bound of |u|.
 * Usually a later displacement exceeds the bound, so noted samples are examined only at the end. */
struct pound_peak {
	int64_t next;
	double u, v, stiffness, offset, bound;
};

/* forms of a contact map for the energy balance */
struct pound_contact_work {
	double mean_base[POUND_CONTACT_INPUTS];    /* mean displacement of the base: a linear form */
	double mean_overlap[POUND_CONTACT_INPUTS]; /* mean overlap: a linear form */
	double loss
	    [POUND_CONTACT_INPUTS]
	    [POUND_CONTACT_INPUTS]; /* loss in the dashpots: a quadratic form of the inputs, the overlap off its equilibrium */
};

/* maps over many substeps of contact, and their forms for the energy balance if that is requested */
struct pound_doubled_maps {
	struct pound_contact_map map[POUND_DOUBLED_MAPS];
	struct pound_contact_work work[POUND_DOUBLED_MAPS + 1]; /* the last one belongs to the substep map */
};

/* contact maps for a pair of branches; made, has_doubled: whether the substep map and the doubled maps are filled */
struct pound_contact_maps {
	struct pound_contact_map substep;
	bool made, has_doubled;
	struct pound_doubled_maps *doubled; /* stored elsewhere, to keep frequently used data close together */
};

/* Data shared by simulations of one scene whose laws have one branch: constants are loaded and maps made once. */
struct pound_common {
	struct state_rows x; /* only its constant rows are used */
	struct pound_contact_maps maps;
	int members;
};

/* next kind of step of a simulation, each with its queue */
enum pound_stage {
	STAGE_FREE_SINGLE,   /* whole samples of the left body without contact */
	STAGE_FREE_PAIR,     /* whole samples of both bodies without contact */
	STAGE_CONTACT,       /* whole substeps of contact */
	STAGE_SUSTAINED,     /* many substeps of contact at once */
	STAGE_STEP_SINGLE,   /* power series step up to an event: left body */
	STAGE_STEP_PAIR,     /* ... both bodies, likely to meet in the step */
	STAGE_STEP_CLEAR,    /* ... both bodies, unlikely to meet: such a batch rarely needs a root search */
	STAGE_STEP_CONTACT,  /* ... both bodies in contact */
	STAGE_FINISH_SINGLE, /* remainder of a sample after an event, likely without another one: left body */
	STAGE_FINISH_PAIR,   /* ... both bodies */
	STAGES,
	STAGE_END = STAGES,
	STAGE_CHATTER,
};

/* features that the steps of a simulation need; code for absent ones is skipped */
enum {
	TRAIT_EDGED = 1,      /* a law has more than one branch */
	TRAIT_RIGHT = 2,      /* the right body's largest displacement is requested */
	TRAIT_FORCED = 4,     /* contact ends at zero force */
	TRAIT_ACCOUNTED = 8,  /* the energy balance is requested */
	TRAIT_ALIKE = 16,     /* identical bodies: touching without overlap, they move together */
	TRAIT_OWN = 32,       /* does not share its constants (struct pound_common) */
	TRAIT_SHARED = 64,    /* runs several tasks: an edge reached by one is not an edge of all */
	TRAIT_OBSERVED = 128, /* it has an observer: observer.inl */
};

/* Features of a batch; code for absent ones is skipped. */
struct scope {
	bool paired;   /* two bodies */
	bool touching; /* all lanes are in contact; false: none is */
	bool edged;    /* some law has more than one branch */
	bool right;    /* some lane needs the right body's largest displacement */
	bool forced;   /* some lane's contact ends at zero force */
	bool seldom; /* some lane needs the energy balance, is observed, or has identical bodies (TRAIT_ALIKE) */
	bool common; /* all lanes have the same constants */
	bool observed; /* some lane in free motion has an observer */
};

/* a further task that a simulation runs */
struct pound_member {
	const struct pound_task *task;
	struct pound_task_result *result;
};

struct simulation {
	alignas(64) struct state_rows x;
	// read or written in every batch: two cache lines
	alignas(64) const double *ground; /* the task's samples */
	int64_t next, last;               /* sample at the end of this interval, and last sample of the signal */
	double per_step;                  /* 1 over the sample step */
	double impulse_max, contacts;
	double counted_time, counted_substeps;   /* contact_time and substeps_done of the contacts that count */
	struct pound_contact_maps *contact_maps; /* for the current pair of branches; NULL: not found yet */
	const struct pound_contact_map *contact_map; /* for the next substeps */
	struct pound_common *common;                 /* shared data; NULL: none */
	unsigned traits;                             /* see enum above */
	int steps;                                   /* series steps and contact batches in this interval */
	int n_doubled, doubled, doubled_limit; /* doubled maps: number, index in use, largest index to try */
	int base;           /* the heavier body: contact is integrated in its motion and the overlap */
	bool touching;      /* the contact's force acts */
	bool released;      /* the force fell to zero first: the bodies still overlap */
	bool fresh;         /* the force has just passed zero */
	bool paired;        /* the right body moves, or contact is possible */
	bool has_free_maps; /* samples are short enough for maps, and no energy balance is requested */
	bool has_contact;
	// rarely read
	const struct pound_task *task;
	struct pound_task_result *result;
	struct pound_counts_scale counts_scale;
	double unobserved;          /* time since the last reported instant, without whole contact substeps [s] */
	double unobserved_substeps; /* number of these substeps */
	struct pound_member others[POUND_OTHERS];
	int n_others;
	enum pound_stage stage; /* its next stage, while in waiting[] (scheduler.inl) */
	double doubled_substeps[POUND_DOUBLED_MAPS];
	double doubled_ratio; /* ratio of lengths of successive doubled maps; 0: too few substeps for any */
	struct pound_law_state at[2];
	int peaks[2], looked; /* noted samples; body being examined at the end, POUND_OSCILLATORS: none yet */
	int map_next[2], contact_map_next;
	// keys of the maps below: stiffnesses of their branches; < 0: unused
	double map_of[2][POUND_MAPS], contact_map_of[2][POUND_CONTACT_MAPS];
	// simulation_start clears nothing from here on: entries are filled together with their keys
	struct pound_peak peak[2][POUND_PEAKS];
	struct pound_map maps[2][POUND_MAPS];
	struct pound_contact_maps own_maps[POUND_CONTACT_MAPS];
};
