/* place.h - where a motion is. */
#ifndef PLACE_H
#define PLACE_H

#include "engine/numeric/lanes.h"

struct place {
	vd u, v; /* a displacement, and its rate */
};

#endif
