/* operations.h - counts the operations of a study; each operation has a known cost.  For the files of schema/study only. */
#ifndef OPERATIONS_H
#define OPERATIONS_H

#include <stdbool.h>

#include "engine/pound.h"

/* Operations.  Shared work is counted once: a ground motion, a response without pounding, a run. */
enum operation {
	STUDY,      /* the study itself */
	BEGIN,      /* ground motion, response without pounding, or run */
	GROUND,     /* sample of a ground motion */
	FREE,       /* sample of a response without pounding, */
	YIELD,      /* ... the same of a body that may yield, */
	FLOW,       /* ... radian of its vibration: it yields and unloads in each cycle */
	MARCH,      /* sample of a run with pounding, */
	TOUCH,      /* ... radian in which the bodies are near each other, */
	SWING,      /* ... the same by the logarithm of the contact's frequency, */
	POUNDED,    /* ... radian of the vibration of a body that may yield */
	TURN,       /* radian per sample above the limit for precomputed maps */
	SHAPE,      /* run of a row of buildings, times the cube of a building's number of storeys, */
	CHAIN,      /* ... sample of a floor, */
	YIELD_STEP, /* ... step of a floor whose story may yield, */
	NEARBY,     /* ... step of any floor while two buildings are near each other, */
	MEET,       /* ... radian of that time, times contacts and floors, */
	JUMP,       /* ... the same if the contact makes velocities jump, */
	SUSTAINED,  /* ... the same by the logarithm of the contact's frequency while contact may be sustained, */
	ROOT,       /* MEET of a contact whose force is a power of the overlap, */
	STICK,      /* SUSTAINED times minus the logarithm of the coefficient of restitution, */
	DASH,       /* radian of the contact's dashpot while bodies are near each other, */
	REST,       /* run with sustained contact, */
	POWER_FORCE,   /* ... the same if the force is a power of the overlap, */
	BALANCE,       /* step of a floor of a row, which has an energy balance */
	PAIR_MAPS,     /* sample of both oscillators together without contact, by maps, */
	PAIR,          /* ... the same if a law may yield or a step is too long for maps, */
	PAIR_TURN,     /* ... radian of the faster oscillator, */
	START,         /* sample of a run by a fixed-step solver, */
	NEWMARK,       /* ... step of Newmark's method, */
	CENTRAL,       /* ... step of central differences, */
	ADAPT_START,   /* sample of a run by the adaptive solver, which starts a step at each, */
	ADAPT,         /* ... radian, times a power of the tolerance, */
	FOLLOW,        /* ... radian in which the bodies are near each other, by the contact's frequency */
	ROW_STEP,      /* step of a floor of a row by a fixed-step solver, */
	ROW_ADAPT,     /* ... radian of the fastest mode, times floors, by the adaptive solver */
	FLOOR,         /* step of a floor whose spectra are computed, */
	PART,          /* ... radian in which the bodies are near each other, */
	FLOOR_DRIVEN,  /* ... radian of the contact while sustained contact is possible */
	FOLLOWED,      /* the same of a floor of a row: step, */
	FOLLOWED_NEAR, /* ... radian in which neighbors are near each other */
	ORDINATE,      /* FLOOR, PART and FLOOR_DRIVEN of one oscillator on the floor: this, BOUNCE and SHAKE */
	BOUNCE,
	SHAKE,
	PULSE, /* pulse of an idealized train that acts on the oscillator */
	DRAW,  /* row drawn for a bootstrap resample, */
	TILE,  /* ... the same for each tile of moments, */
	FIT,   /* sample to which polynomials are fitted */
	CLOCK, /* timed trial of a convergence study */
	OPERATIONS
};

/* number of each operation */
struct counts {
	double of[OPERATIONS];
};

/* A separation study must be replaced by study_separation_like first. */
void operations_count(const struct pound_study *study, struct counts *c);
struct pound_run_shared
operations_shared(const struct pound_study *study); /* distinct motions and runs of an item */
bool operations_chained(const struct pound_study *study,
                        const struct pound_solver *solver); /* run by the solver for rows of buildings */

#endif
