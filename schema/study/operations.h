/* operations.h - what a study does, counted by operations of which each takes a time.  For the files of schema/study only. */
#ifndef OPERATIONS_H
#define OPERATIONS_H

#include <stdbool.h>

#include "engine/pound.h"

/* What is counted.  Whatever may be shared is counted once: a ground motion, a response without pounding, a run. */
enum operation {
	STUDY,       /* the study itself */
	BEGIN,       /* ground motion, response without pounding, or run */
	GROUND,      /* sample of a ground motion */
	FREE,        /* sample of a response without pounding, */
	YIELD,       /* ... of a body that may yield, */
	FLOW,        /* ... and radian that this turns by, in which it yields and returns */
	MARCH,       /* sample of a run with pounding, */
	TOUCH,       /* ... radian in which the bodies are near each other, */
	SWING,       /* ... times the logarithm of the contact's own frequency, */
	POUNDED,     /* ... and radian that a body turns by which may yield */
	TURN,        /* radian of a sample beyond those that go by maps */
	SHAPE,       /* march of a row, by the cube of the storeys of a building, */
	CHAIN,       /* ... sample of a floor, */
	YIELD_STEP,  /* ... step of one whose story may yield, */
	NEARBY,      /* ... or of all floors while two buildings are near each other, */
	MEET,        /* ... radian of that, by contact and floor, */
	JUMP,        /* ... if velocities jump there, */
	SUSTAINED,   /* ... and times the logarithm of the contact's own frequency while they may stay together */
	ROOT,        /* the same of two oscillators, of a contact that is a power of its overlap, */
	STICK,       /* ... by the logarithm of the restitution coefficient, */
	DASH,        /* ... and radian of the contact's dashpot, */
	REST,        /* march that begins in contact, */
	POWER_FORCE, /* ... where the force is a power of the overlap, */
	BALANCE,     /* ... and step of a floor of a chain, which has an energy balance */
	PAIR_MAPS,   /* sample of both oscillators together without contact, by maps, */
	PAIR,        /* ... or of laws that yield, ... */
	PAIR_TURN,   /* ... and radian of the faster one, */
	START,       /* sample of a march by another solver, */
	NEWMARK,     /* ... step of one, */
	CENTRAL,     /* ... of the other, */
	ADAPT_START, /* sample of a march by the adaptive one, which starts a step there, */
	ADAPT,       /* ... radian of it, by its tolerance, */
	FOLLOW,      /* ... and radian in which the bodies are near each other, by the contact's frequency */
	ROW_STEP,    /* step of a floor of a row by a fixed step, */
	ROW_ADAPT,   /* ... and its radian of the fastest floors by the adaptive solver */
	FLOOR,       /* step of a floor, */
	PART,        /* ... radian in which the bodies are near each other, */
	FLOOR_DRIVEN,  /* ... and of the contact while they may stay together */
	FOLLOWED,      /* the same of a floor of a chain: step, */
	FOLLOWED_NEAR, /* ... and radian in which neighbors are near each other */
	ORDINATE,      /* the same of an oscillator on it, */
	BOUNCE,
	SHAKE,
	PULSE, /* ... and pulse of an idealized train that it gets */
	DRAW,  /* drawn row of a resample, */
	TILE,  /* ... of a tile of its moments, */
	FIT,   /* and sample that polynomials are fitted to */
	CLOCK, /* trial of a convergence study, which is timed */
	OPERATIONS
};

/* numbers of operations */
struct counts {
	double of[OPERATIONS];
};

/* Of a study of a kind that study_separation_like returns. */
void operations_count(const struct pound_study *study, struct counts *c);
struct pound_run_shared
operations_shared(const struct pound_study *study); /* what an item has of which nothing is run twice */
bool operations_chained(const struct pound_study *study,
                        const struct pound_solver *solver); /* its runs are of chains */

#endif
