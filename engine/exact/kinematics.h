/* kinematics.h - displacement and velocity of a motion, in lanes. */
#ifndef KINEMATICS_H
#define KINEMATICS_H

#include "engine/numeric/lanes.h"

struct kinematics {
	vd u, v; /* displacement and velocity */
};

#endif
