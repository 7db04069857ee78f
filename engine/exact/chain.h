/* chain.h - interface of the exact solver of rows of shear buildings, accurate to rounding.
 *
 * A chain is all floors of a row of buildings under one ground motion, ordered by building from left to right and from the ground up.
 * Between events every story and every contact is on one branch of its law and the ground acceleration is linear in time. */
#ifndef CHAIN_H
#define CHAIN_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/numeric/stop.h"
#include "engine/pound.h"
#include "engine/scene/contact.h"
#include "engine/scene/law.h"

enum {
	POUND_CHAIN_FLOORS = 400,               /* most floors of a chain */
	POUND_CHAIN_LINKS = 400,                /* most links of a chain */
	POUND_CHAIN_GROUND = -1,                /* the ground, in place of a floor */
	POUND_CHAIN_SCRATCH = 13 << 17,         /* bytes of work space for any chain, 64-byte aligned */
	POUND_CHAIN_SCRATCH_STRAIGHT = 1 << 20, /* ... if every contact force is linear in overlap and rate */
	POUND_CHAIN_ORDER = 21,                 /* highest order of a piece's series */
};

/* a floor and the story below it; u: displacement relative to the ground; d: drift of the story, u less that of the floor below */
struct pound_chain_floor {
	double mass;         /* [kg]  > 0 */
	double dashpot;      /* of the story, per drift rate [N s/m] */
	double mass_damping; /* a0 of the damping force a0 m v; equal for all floors of a building [1/s] */
	struct pound_backbone story; /* not per mass: stiffness [N/m], yield drift [m] */
	const double *modal; /* modal damping: force on this floor per drift rate of each story of its building,
	                                 * opposing it [N s/m]  (stories of the building); NULL: none */
	bool base;           /* lowest floor of its building */
};

/* A contact between a level of a building and a level of its right neighbor.
 *
 * A level's displacement is the weighted sum of two floors' displacements, and a force on the level acts on these floors with
 * the same weights.  The weights of a side add up to 1; both floors of a rigid wall are POUND_CHAIN_GROUND, which does not move.
 * A floor of weight 0 may be any floor of that building. */
struct pound_link {
	int floor[2][2];              /* of the left and the right side */
	double weight[2][2];          /* [0, 1] */
	struct pound_contact_law law; /* in forces [N] */
	double gap;                   /* [m] */
};

/* Optional results, beside impulses, counts, times and the final state; those not requested are NAN. */
enum pound_chain_asked {
	POUND_CHAIN_DRIFTS = 1,
	POUND_CHAIN_DISPLACEMENTS = 2,
	POUND_CHAIN_ACCELERATIONS = 4,
	POUND_CHAIN_FORCES = 8,
	POUND_CHAIN_ENERGY = 16, /* balance and losses; slower, as no whole samples are passed by modal maps */
	POUND_CHAIN_CLOSING =
	    32, /* with displacements: contacts do not act, but closing displacements are recorded; slower, too */
};

/* The motion of an observed floor over a piece: coefficients of powers of s, the fraction of the piece that has passed. */
struct pound_chain_floor_motion {
	double u, v; /* at the start, relative to the ground [m], [m/s] */
	double jump; /* of v at the start, by rigid impacts [m/s] */
	// absolute acceleration, and its contribution from all contacts, or from the observed link if there is one
	// [m/s2]  (order + 1)
	double acceleration[POUND_CHAIN_ORDER + 1], push[POUND_CHAIN_ORDER + 1];
};

enum { POUND_CHAIN_OBSERVED = 2 };

/* The motion of observed floors between two instants without events in between. */
struct pound_chain_piece {
	double time, length;          /* [s] */
	double ground, slope;         /* ground acceleration at the start and its rate [m/s2], [m/s3] */
	double overlap, overlap_rate; /* of the observed link at the start [m], [m/s] */
	int order;
	bool sampled, after_event; /* the piece starts at a sample of the ground motion; after an event */
	bool touching;             /* a contact force acts on the first floor */
	bool time_is_series;       /* elapsed time is not s times length but sum clock[n] s^n [s]  (order + 1) */
	double clock[POUND_CHAIN_ORDER + 1];
	struct pound_chain_floor_motion floors[POUND_CHAIN_OBSERVED];
};

struct pound_chain_observer {
	void (*observe)(void *into, const struct pound_chain_piece *piece);
	void *into;
	int floor; /* the first observed floor */
	int link;  /* the second is the level on its right side; -1: none, the second moves with the ground */
};

/* A contact that has ended and counts (counts.h); for rigid contacts, one impact. */
struct pound_chain_contact {
	int link;
	double begin, end;     /* [s] */
	double speed, impulse; /* approach speed at the start [m/s]; impulse of the force [N s] */
};

struct pound_chain_recorder {
	void (*record)(void *into, const struct pound_chain_contact *contact);
	void *into;
};

struct pound_chain_task {
	const double *ground; /* acceleration at the samples, linear in between  [m/s2]  (n_samples) */
	int n_samples;        /* >= 2 */
	double time_step;     /* [s] */
	int n_floors, n_links;
	const struct pound_chain_floor *floors;      /* (n_floors) */
	const struct pound_link *links;              /* (n_links); NULL: none */
	unsigned asked;                              /* bits of enum pound_chain_asked */
	const struct pound_chain_observer *observer; /* NULL: none */
	const struct pound_chain_recorder *recorder; /* NULL: none */
};

enum pound_floor_measure {
	POUND_FLOOR_DRIFT_MAX,        /* largest |d| [m] */
	POUND_FLOOR_DISPLACEMENT_MAX, /* largest |u| [m] */
	POUND_FLOOR_ACCELERATION_MAX, /* largest |u'' + ground|, on both sides of events [m/s2] */
	POUND_FLOOR_SHEAR_MAX,        /* largest spring force of the story below [N]; with POUND_CHAIN_DRIFTS */
	POUND_FLOOR_RESIDUAL,         /* drift at which the final story force unloads to 0 [m] */
	POUND_FLOOR_END_U,            /* final displacement [m] */
	POUND_FLOOR_END_V,            /* final velocity [m/s] */
	POUND_FLOOR_LOST, /* work on the story's spring less the energy recovered on unloading to 0 [J] */
	POUND_FLOOR_MEASURES
};

enum pound_link_measure {
	POUND_LINK_IMPULSE_MAX, /* largest integral of the force over one contact [N s] */
	POUND_LINK_FORCE_MAX,   /* largest compressive force [N] */
	POUND_LINK_CONTACTS,    /* number of contacts */
	POUND_LINK_TIME,        /* total time in contact [s] */
	POUND_LINK_FIRST_TIME,  /* start of the first contact; 0: none [s] */
	POUND_LINK_FIRST_SPEED, /* approach speed of the first contact; 0: none [m/s] */
	POUND_LINK_SPEED_MAX,   /* largest approach speed of all contacts [m/s] */
	POUND_LINK_LOST, /* work on the contact, including the stored energy of one still open at the end [J] */
	POUND_LINK_CLOSING_MAX, /* largest displacement of the left side less the right side's, at least 0 [m] */
	POUND_LINK_LEFT_MAX,    /* largest |displacement| of the left side [m] */
	POUND_LINK_RIGHT_MAX,   /* ... of the right side [m] */
	POUND_LINK_MEASURES
};

/* Rows of measures; the memory is the caller's. */
struct pound_chain_result {
	enum pound_status status;
	double *floors; /* (n_floors x POUND_FLOOR_MEASURES) */
	double *links;  /* (n_links x POUND_LINK_MEASURES) */
	// |kinetic + absorbed - input| energy over the largest input or kinetic energy of the motion; NAN: not requested
	double energy_residual;
	double
	    work_in; /* energy input: -int sum of mass times ground acceleration times velocity dt [J]; NAN: not requested */
};

size_t pound_chain_scratch(enum pound_force force);

bool pound_chain_lanes(int lanes, const struct pound_chain_task *tasks, struct pound_chain_result *results,
                       int n, void *scratch, const atomic_bool *stop);

/* chain.inl, compiled once for each */
void pound_chain_w8(const struct pound_chain_task *tasks, struct pound_chain_result *results, int n,
                    void *scratch, const atomic_bool *stop);
void pound_chain_w4(const struct pound_chain_task *tasks, struct pound_chain_result *results, int n,
                    void *scratch, const atomic_bool *stop);
void pound_chain_w1(const struct pound_chain_task *tasks, struct pound_chain_result *results, int n,
                    void *scratch, const atomic_bool *stop);
void pound_chain_portable(const struct pound_chain_task *tasks, struct pound_chain_result *results, int n,
                          void *scratch, const atomic_bool *stop);

#endif
