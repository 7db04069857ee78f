/* demand.h - the search for the yield displacement that gives a target demand, one response after the other. */
#ifndef DEMAND_H
#define DEMAND_H

#include "engine/numeric/bracket.h"

/* Filled with zeros it is a search that has not begun. */
struct pound_demand {
	struct pound_bracket
	    bracket;       /* logarithm of the demand over its target, by that of the yield displacement */
	int response;      /* the nearest to the target */
	double yield, off; /* its yield displacement, and relative difference from the target */
};

/* The next yield displacement; false: there is none, as the target is reached or the demand jumps over it. */
bool pound_demand_next(struct pound_demand *demand, int response, double yield, double share, double *next);

/* Whether a search has found its target. */
bool pound_demand_reached(const struct pound_demand *demand);

#endif
