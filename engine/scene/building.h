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

void pound_building_storeys(const struct pound_building *building, struct pound_storeys *storeys);
void pound_building_first_mode(const struct pound_building *building, double *frequency, double *damping);

#endif
