/* demand.c - search for the yield displacement that gives a target demand, one response per step.
 *
 * The demand falls to 0 as the yield displacement grows and becomes arbitrarily large as it decreases; on logarithmic scales
 * its slope is -1 where the body does not yield.  It is continuous where the law's force depends continuously on the history;
 * elsewhere the search may report a jump. */
#include "engine/run/demand.h"

#include <math.h>

#include "engine/numeric/elementary.h"

/* Relative tolerance of the target demand. */
static const double REACHED = 1e-6;

bool pound_demand_reached(const struct pound_demand *demand)
{
	return demand->off <= REACHED;
}

/* Takes a response.
 *
 * Given    response  its number, stored if it is the nearest
 *          share     its demand over the target, > 0
 * Returns  demand    the nearest response so far
 * Source   model.md 3 of the project's design pages
 * Test     unit_yield
 */
bool pound_demand_next(struct pound_demand *demand, int response, double yield, double share, double *next)
{
	const double off = fabs(share - 1);
	double x;
	if (demand->bracket.n == 0 || off < demand->off) {
		demand->response = response;
		demand->yield = yield;
		demand->off = off;
	}
	if (pound_demand_reached(demand) ||
	    !pound_bracket_next(&demand->bracket, pound_elementary_log(yield), pound_elementary_log(share), &x))
		return false;
	*next = pound_elementary_exp(x);
	return true;
}
