/* building.h - a shear building as masses, springs and dashpots of its storeys. */
#ifndef BUILDING_H
#define BUILDING_H

#include "engine/study.h"

/* Storeys from the ground up, each with the floor above it. */
struct pound_storeys {
	int n;
	double mass[POUND_STOREYS_MAX];      /* [kg] */
	double stiffness[POUND_STOREYS_MAX]; /* initial [N/m] */
	double dashpot[POUND_STOREYS_MAX];   /* [N s/m] */
	double mass_damping;                 /* mass-proportional damping of every floor [1/s] */
	double frequency;                    /* of the first mode [rad/s] */
	bool modal;                          /* damping is given per mode, not by dashpots */
};

/* A mode of vibration of a building with its initial stiffness. */
struct pound_building_mode {
	double frequency;     /* undamped [rad/s] */
	double mass_ratio;    /* effective modal mass over the mass of the building; all modes add up to 1 */
	double damping_ratio; /* from the diagonal term of modal damping */
};

void pound_building_storeys(const struct pound_building *building, struct pound_storeys *storeys);
/* from the lowest frequency to the highest  (building->storeys) */
void pound_building_modes(const struct pound_building *building,
                          struct pound_building_mode modes[static POUND_STOREYS_MAX]);

#endif
