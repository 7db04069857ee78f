/* chain.h - the response of rows of shear buildings, event by event, to rounding.
 *
 * A chain is all floors of a row of buildings, side by side from left to right and from the ground up, under one ground motion.
 * Between events every story and every contact is on a branch of its law and the ground motion is a straight line. */
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
	POUND_CHAIN_FLOORS = 400,               /* of a chain, at most */
	POUND_CHAIN_LINKS = 400,                /* of a chain, at most */
	POUND_CHAIN_GROUND = -1,                /* in place of a floor */
	POUND_CHAIN_SCRATCH = 13 << 17,         /* bytes of work space of any chain, 64-byte aligned */
	POUND_CHAIN_SCRATCH_STRAIGHT = 1 << 20, /* ... of one without contacts of products and powers */
	POUND_CHAIN_ORDER = 21,                 /* of the longest series of a piece */
};

/* a floor and the story below it; u is its displacement relative to the ground, d = u - u of the floor below its drift */
struct pound_chain_floor {
	double mass;         /* [kg]  > 0 */
	double dashpot;      /* of the story, per rate of its drift [N s/m] */
	double mass_damping; /* a0, times mass and velocity; the same for all floors of a building [1/s] */
	struct pound_backbone story; /* in forces: stiffness [N/m], yield displacement: a drift [m] */
	const double *modal; /* force on this floor, against the rates of the drifts of its building's stories
	                                 * [N s/m]  (stories of the building); NULL: none */
	bool base;           /* the lowest story: a building begins */
};

/* A contact between a level of a building and one of its right neighbor.
 *
 * A level's displacement is the sum of the weights times the displacements of two floors, and a force on it acts on these with
 * the same weights.  The weights of a side add up to 1; a floor POUND_CHAIN_GROUND does not move: a wall has it twice.
 * A weight 0 goes with any floor of that building. */
struct pound_link {
	int floor[2][2];              /* of the left and the right side */
	double weight[2][2];          /* [0, 1] */
	struct pound_contact_law law; /* in forces [N] */
	double gap;                   /* [m] */
};

/* What of a chain is wanted beside impulses, counts, times and the end: what is not is NAN in the result. */
enum pound_chain_asked {
	POUND_CHAIN_DRIFTS = 1,
	POUND_CHAIN_DISPLACEMENTS = 2,
	POUND_CHAIN_ACCELERATIONS = 4,
	POUND_CHAIN_FORCES = 8,
	POUND_CHAIN_ENERGY =
	    16, /* balance and losses; no whole samples are passed at once: such a run takes longer */
	POUND_CHAIN_CLOSING =
	    32, /* with displacements: no contact acts, but how far its sides close is followed; likewise */
};

/* The motion of an observed floor over a piece, by the share s of it that is gone: coefficients of powers of s. */
struct pound_chain_floor_motion {
	double u, v; /* at the start, relative to the ground [m], [m/s] */
	double jump; /* of v, just before: rigid impacts [m/s] */
	// absolute acceleration, and the part of it that contacts give, or the observed link alone where there is one
	// [m/s2]  (order + 1)
	double acceleration[POUND_CHAIN_ORDER + 1], push[POUND_CHAIN_ORDER + 1];
};

enum { POUND_CHAIN_OBSERVED = 2 };

/* The motion of observed floors between two instants: nothing happens to the chain between them. */
struct pound_chain_piece {
	double time, length;          /* [s] */
	double ground, slope;         /* acceleration of the ground at the start and its growth [m/s2], [m/s3] */
	double overlap, overlap_rate; /* of the observed link at the start [m], [m/s] */
	int order;
	bool sampled, after_event; /* it starts at a sample of the ground motion, behind an event */
	bool touching;             /* a contact has a force on the first floor */
	bool time_is_series; /* time is no multiple of s, but sum clock[n] s^n since the start [s]  (order + 1) */
	double clock[POUND_CHAIN_ORDER + 1];
	struct pound_chain_floor_motion floors[POUND_CHAIN_OBSERVED];
};

struct pound_chain_observer {
	void (*observe)(void *into, const struct pound_chain_piece *piece);
	void *into;
	int floor; /* the first that is observed */
	int link; /* the other one is the level at its right side; -1: none, the other one moves with the ground */
};

/* A contact that is over, as far as it counts; of rigid ones an impact. */
struct pound_chain_contact {
	int link;
	double begin, end;     /* [s] */
	double speed, impulse; /* of approach where it began [m/s]; of its force [N s] */
};

struct pound_chain_recorder {
	void (*record)(void *into, const struct pound_chain_contact *contact);
	void *into;
};

struct pound_chain_task {
	const double *ground; /* acceleration at the samples, linear between  [m/s2]  (n_samples) */
	int n_samples;        /* >= 2 */
	double time_step;     /* [s] */
	int n_floors, n_links;
	const struct pound_chain_floor *floors;      /* (n_floors) */
	const struct pound_link *links;              /* (n_links); NULL: none */
	unsigned asked;                              /* of enum pound_chain_asked */
	const struct pound_chain_observer *observer; /* NULL: none */
	const struct pound_chain_recorder *recorder; /* NULL: none */
};

enum pound_floor_measure {
	POUND_FLOOR_DRIFT_MAX,        /* largest |d| [m] */
	POUND_FLOOR_DISPLACEMENT_MAX, /* largest |u| [m] */
	POUND_FLOOR_ACCELERATION_MAX, /* largest |u'' + ground|, on both sides of events [m/s2] */
	POUND_FLOOR_SHEAR_MAX,        /* largest spring force of the story below [N]; goes with the drift */
	POUND_FLOOR_RESIDUAL,         /* drift at which the story's force is 0 on the way back from the end [m] */
	POUND_FLOOR_END_U,            /* [m] */
	POUND_FLOOR_END_V,            /* [m/s] */
	POUND_FLOOR_LOST, /* work on the story's spring less what it gives back on the way to force 0 [J] */
	POUND_FLOOR_MEASURES
};

enum pound_link_measure {
	POUND_LINK_IMPULSE_MAX, /* largest integral of the force over one contact [N s] */
	POUND_LINK_FORCE_MAX,   /* largest force that pushes [N] */
	POUND_LINK_CONTACTS,    /* a whole number */
	POUND_LINK_TIME,        /* in contact [s] */
	POUND_LINK_FIRST_TIME,  /* of the first contact; 0: none [s] */
	POUND_LINK_FIRST_SPEED, /* of approach there; 0: none [m/s] */
	POUND_LINK_SPEED_MAX,   /* largest one of all contacts [m/s] */
	POUND_LINK_LOST,        /* work on the contact; one still open at the end counts with what it holds [J] */
	POUND_LINK_CLOSING_MAX, /* largest displacement of the left side less that of the right one, 0 at rest [m] */
	POUND_LINK_LEFT_MAX,    /* largest magnitude of the left side's displacement [m] */
	POUND_LINK_RIGHT_MAX, /* of the right side's */
	POUND_LINK_MEASURES
};

/* Rows of measures; the memory is the caller's. */
struct pound_chain_result {
	enum pound_status status;
	double *floors; /* (n_floors x POUND_FLOOR_MEASURES) */
	double *links;  /* (n_links x POUND_LINK_MEASURES) */
	// |kinetic + absorbed - put in| over the most along the way of what was put in and of kinetic energy; NAN: not asked
	double energy_residual;
	double
	    work_in; /* by the ground: -sum of masses times its acceleration times velocities [J]; NAN: not asked */
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
