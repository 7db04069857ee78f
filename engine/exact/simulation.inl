/* simulation.inl - one simulation of the march as it stays_in_contact between its turns in the lanes.
 *
 * Its numbers are stored in rows of a cache line each, columns of which become vectors: a batch of simulations is carried
 * into lanes and out by whole rows.  next_step.inl has what is done to one at a time.
 *
 * Included by exact.inl, first. */

#include <float.h>
#include <stdalign.h>

#include "engine/exact/counts.h"
#include "engine/exact/task.h"

enum {
	POUND_MAPS = 4,          /* free-motion maps a body keeps */
	POUND_PEAKS = 4,         /* samples that may hold its largest displacement */
	POUND_OTHERS = 3,        /* other tasks that go along with a simulation: shared_start.inl */
	POUND_MAP_ORDERS = 18,   /* of a map's series; 0.945^18/18! = 6e-17 */
	POUND_MAP_LONGER = 26,   /* of a long sample's; 2^26/26! = 2e-19 */
	POUND_CONTACT_MAPS = 3,  /* pairs of branches whose substep map and doubled maps a simulation keeps */
	POUND_DOUBLED_MAPS = 12, /* maps over many substeps */
	POUND_CONTACT_INPUTS =
	    8 /* base u, v, overlap p, q, forcing of either, and its growth over the map's length */
};

/* Rows of a simulation: T is double at rest, and a vector in lanes; every row has eight. */
#define POUND_ROWS(T)                                                                                                                                 \
	/* STATE: displacement, velocity, largest |u| (DBL_MAX: not wanted) of each body; overlap and its rate */                                         \
	T u[2], v[2], top[2], p, q;                                                                                                                       \
	/* STEP: the next step; the ground at its start and its growth; this contact's impulse, all contacts' time but for whole substeps; what is left \
	 * of the interval: a part, and whole substeps; <= 1: steps are shorter where a search was unsure */ \
	T dt, ground, slope, impulse, contact_time, remainder, substeps, pace;                                                                            \
	/* LEFT, RIGHT: a body and the branch it is on, and behind the left the sample step, behind the right the gap */                                  \
	struct {                                                                                                                                          \
		T stiffness, damping, offset, drive, low, high, direction, step_gap;                                                                          \
	} body[2];                                                                                                                                        \
	/* PAIR: the contact; lengths of a substep of it, and of the longest step without */                                                              \
	T contact_stiffness, contact_damping, mass_ratio, both, gap, release, substep, reach;                                                             \
	/* MAP_LEFT, MAP_RIGHT: a body over one sample, and what bounds the error of its cubic */                                                         \
	struct {                                                                                                                                          \
		T uu, uv, ua, ud, va, eu, ev, ef;                                                                                                             \
	} map[2];                                                                                                                                         \
	/* PRESS: a substep of contact: forcing, which body is the base; whole substeps that all contacts had; how often the map goes on \
	 * until another is asked for; substeps of an interval */                \
	T base_force, gap_force, base_drive, gap_drive, side, substeps_done, rounds, substeps_per_sample;                                                 \
	/* WORK: energy put in, what is found of it less that, and the rounding of the latter; the most there was of it */                                \
	T work_in, work_gap, work_low, work_top, right_mass, work_spare[3];

struct state_rows {
	POUND_ROWS(double)
};

/* where the rows begin, in doubles */
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

/* what does not change while the bodies stay on their branches, in doubles */
enum {
	ROWS_CONSTANT = ROW_LEFT,
	ROWS_CONSTANT_END = ROW_CONTACT,
};

/* exact displacement of one body after one sample, from (u, v) and a forcing a at the start that grows by d: a row MAP */
struct pound_map {
	alignas(64) double uu;
	double uv, ua, ud, va; /* the velocity follows: see free_motion.inl */
	double eu, ev, ef;     /* the cubic's error is at most eu |u| + ev |v| + ef (|a| + |d|) */
};

/* rows of a map of contact, each a linear form of the inputs; the bounds of their magnitudes */
enum {
	CONTACT_U, /* what is added to the base's displacement and velocity, the overlap and its rate */
	CONTACT_V,
	CONTACT_P,
	CONTACT_Q,
	CONTACT_IMPULSE,
	CONTACT_ERROR, /* of a substep: of the cubics of the base's displacement and of the overlap */
	DOUBLED_ERROR =
	    CONTACT_ERROR, /* of a doubled map, by other magnitudes (contact_map.inl): of the cubic of the common motion */
	DOUBLED_CURVATURE, /* of a doubled map: of what presses the bodies on each other, off its straight line */
	CONTACT_SPLIT,     /* not a form but the enum below */
	CONTACT_MAP_ROWS,
};

/* how a map splits the motion into that of both bodies and the contact's own */
enum {
	SPLIT_DAMPING,
	SPLIT_STIFFNESS, /* what presses: times the common velocity and displacement */
	SPLIT_BASE,      /* displacement of the base, beyond the common one, by the overlap */
	SPLIT_RESIDUAL, /* of a doubled map: how far the overlap's own motion takes the common one off a slow enclosure */
	SPLIT_OMEGA,      /* of the contact [rad/s] */
	SPLIT_TWO_ZETA,   /* its damping over omega */
	SPLIT_PHASE_LEAD, /* how much more than the overlap the force swings, where contact ends with it */
	SPLIT_SUBSTEPS,
};

struct pound_contact_map {
	alignas(64) double row[CONTACT_MAP_ROWS][POUND_CONTACT_INPUTS];
	double closing
	    [POUND_CONTACT_INPUTS]; /* of a doubled map: what is added to what presses the bodies on each other */
};

/* A sample that a body flew over, and inside of which it may have had its largest displacement: how it started, on which
 * branch, and how far it cannot have gone.  Larger ones come more often than not, so it is looked into at the end. */
struct pound_peak {
	int64_t next;
	double u, v, stiffness, offset, bound;
};

/* what an account of energy needs beside a map of contact */
struct pound_contact_work {
	double mean_base[POUND_CONTACT_INPUTS];    /* of the base's displacement: a linear form */
	double mean_overlap[POUND_CONTACT_INPUTS]; /* of the overlap: another */
	double loss
	    [POUND_CONTACT_INPUTS]
	    [POUND_CONTACT_INPUTS]; /* in the dashpots: a quadratic form, of the overlap off its equilibrium */
};

/* maps over many substeps of contact, and where energy is accounted for, what that needs of all of these */
struct pound_doubled_maps {
	struct pound_contact_map map[POUND_DOUBLED_MAPS];
	struct pound_contact_work work[POUND_DOUBLED_MAPS + 1]; /* the last: of a substep */
};

/* contact on a pair of branches: over a substep, and whether that and its doubled maps are filled */
struct pound_contact_maps {
	struct pound_contact_map substep;
	bool made, has_doubled;
	struct pound_doubled_maps *doubled; /* elsewhere: what is used often is to stay close together */
};

/* What simulations of one scene have in common, where their laws have one branch: constants and maps are read and made once. */
struct pound_common {
	struct state_rows x; /* of its constants alone */
	struct pound_contact_maps maps;
	int members;
};

/* what a simulation does next */
enum pound_stage {
	STAGE_FREE_SINGLE,  /* whole samples of the left body */
	STAGE_FREE_PAIR,    /* whole samples of both */
	STAGE_CONTACT,      /* whole substeps of contact */
	STAGE_SUSTAINED,    /* many substeps of it at once */
	STAGE_STEP_SINGLE,  /* a step up to an event, by power series: of the left body */
	STAGE_STEP_PAIR,    /* of both, who likely meet */
	STAGE_STEP_CLEAR,   /* of both, who likely do not: what a batch looks for alike takes less */
	STAGE_STEP_CONTACT, /* of both in contact */
	STAGE_FINISH_SINGLE, /* what is left of a sample behind an event, where likely nothing happens: of the left body */
	STAGE_FINISH_PAIR, /* of both */
	STAGES,
	STAGE_END = STAGES,
	STAGE_CHATTER,
};

/* what a step must look after for a simulation; otherwise it is left out */
enum {
	TRAIT_EDGED = 1,     /* a law has more than one branch */
	TRAIT_RIGHT = 2,     /* the right body's largest displacement is wanted */
	TRAIT_FORCED = 4,    /* contact ends when its force does */
	TRAIT_ACCOUNTED = 8, /* the energy balance is kept */
	TRAIT_ALIKE = 16,  /* touching without overlap the bodies go the same way, on the branches they are on */
	TRAIT_OWN = 32,    /* its constants are not those of others */
	TRAIT_SHARED = 64, /* there are others that go along: what an edge decides is not for all of them */
	TRAIT_OBSERVED = 128, /* it has an observer: observer.inl */
};

/* What is true of the lanes of a batch; what is not is neither looked into nor computed. */
struct scope {
	bool paired;   /* they have two bodies */
	bool touching; /* all are in contact, or none is */
	bool edged;    /* a lane has a law of more than one branch */
	bool right;    /* a lane's largest displacement of the right body is wanted */
	bool forced;   /* a lane's contact ends when its force does */
	bool
	    seldom; /* a lane's energy is accounted for, it is observed, or nothing presses its bodies on each other */
	bool common;   /* all have the same constants */
	bool observed; /* a lane in free motion has an observer */
};

/* a task that a simulation is the run of as well */
struct pound_member {
	const struct pound_task *task;
	struct pound_task_result *result;
};

struct simulation {
	alignas(64) struct state_rows x;
	// what is read or written at every turn: two cache lines
	alignas(64) const double *ground; /* of the task */
	int64_t next, last;               /* sample at the end of this interval, and the last of the signal */
	double per_step;
	double impulse_max, contacts;
	double counted_time,
	    counted_substeps; /* of contacts that count, as contact_time and pressed in the rows */
	struct pound_contact_maps
	    *contact_maps; /* of the branches that the bodies are on; NULL: to be looked for */
	const struct pound_contact_map *contact_map; /* of the next substeps */
	struct pound_common *common;                 /* with others; NULL: nothing */
	unsigned traits;                             /* see enum above */
	int steps;                                   /* and turns in the queues of contact, in this interval */
	int n_doubled, doubled, doubled_limit;       /* there are, in use, the longest to try */
	int base;           /* the heavier body, whose motion and the overlap describe contact */
	bool touching;      /* the contact's force acts */
	bool released;      /* force gone before the overlap: bodies still overlap */
	bool fresh;         /* the force has just passed zero */
	bool paired;        /* the right body moves, or there is something to touch */
	bool has_free_maps; /* samples are short enough for maps, and no balance is kept */
	bool has_contact;
	// and what is read seldom
	const struct pound_task *task;
	struct pound_task_result *result;
	struct pound_counts_scale counts_scale;
	double unobserved; /* time since the last instant that its observer got, but for some substeps [s] */
	double unobserved_substeps; /* how many */
	struct pound_member others[POUND_OTHERS];
	int n_others;
	enum pound_stage stage; /* what it does next, while it waits for room */
	double doubled_substeps[POUND_DOUBLED_MAPS];
	double doubled_ratio; /* of a doubled map to the shorter one; 0: few substeps, and no doubled maps */
	struct pound_law_state at[2];
	int peaks[2], looked; /* samples to look into, and the body that is: POUND_OSCILLATORS: neither yet */
	int map_next[2], contact_map_next;
	// stiffnesses of the branches that the maps below belong to; < 0: none
	double map_of[2][POUND_MAPS], contact_map_of[2][POUND_CONTACT_MAPS];
	// from here on a start clears nothing: what is there is filled with its key
	struct pound_peak peak[2][POUND_PEAKS];
	struct pound_map maps[2][POUND_MAPS];
	struct pound_contact_maps own_maps[POUND_CONTACT_MAPS];
};
