/* cost.h - what a study will take, before any of it is run.  Any thread. */
#ifndef COST_H
#define COST_H

#include <stdint.h>

#include "engine/pound.h"

struct cost {
	int64_t runs; /* pounding runs asked for, before anything is shared */
	double cpu_s; /* of one core, all in all [s] */
	double bytes; /* in the database: blocks and result */
};

struct cost cost_of(const struct pound_study *study);

#endif
