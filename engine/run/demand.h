/* demand.h - search for the yield displacement that gives a target demand, one response per step. */
#ifndef DEMAND_H
#define DEMAND_H

#include "engine/numeric/bracket.h"

/* Zero-initialized: a search that has not begun. */
struct pound_demand {
	struct pound_bracket
	    bracket;       /* logarithm of demand / target, as a function of the log of the yield displacement */
	int response;      /* the nearest to the target */
	double yield, off; /* its yield displacement, and relative difference from the target */
};

/* The next yield displacement; false: none, because the target is reached or the demand jumps over it. */
bool pound_demand_next(struct pound_demand *demand, int response, double yield, double share, double *next);

/* Whether a search has found its target. */
bool pound_demand_reached(const struct pound_demand *demand);

#endif
