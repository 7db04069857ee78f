/* kinematics.h - where a motion is. */
#ifndef KINEMATICS_H
#define KINEMATICS_H

#include "engine/numeric/lanes.h"

struct kinematics {
	vd u, v; /* a displacement, and its rate */
};

#endif
