/* law.h - constitutive laws as linear branches and the edges between them.
 *
 * An integrator sees only the current branch: the restoring force per mass is stiffness * u + offset, until u leaves
 * [low, high] or, if direction is not 0, the velocity becomes opposite to direction.  At such an edge it requests the next. */
#ifndef LAW_H
#define LAW_H

#include <stdbool.h>

struct pound_backbone {
	int law;          /* row of the laws */
	double stiffness; /* initial, per mass [1/s2]  > 0 */
	double hardening; /* second slope over first */
	double yield;     /* yield displacement [m]  > 0; not read by linear laws */
};

struct pound_branch {
	double stiffness; /* [1/s2] */
	double offset;    /* force per mass at u = 0 [m/s2] */
	double low, high; /* [m]  -DBL_MAX, DBL_MAX: no edge there */
	double direction; /* +1, -1: ends when the velocity turns against it; 0: does not */
};

enum pound_edge { POUND_EDGE_LOW, POUND_EDGE_HIGH, POUND_EDGE_REVERSAL };

/* state of an oscillator on its law */
struct pound_law_state {
	int number;       /* number of the branch within the law */
	double memory[2]; /* what the law remembers [m] */
	struct pound_branch branch;
};

bool pound_law_linear(int law);
void pound_law_start(const struct pound_backbone *backbone, struct pound_law_state *at);
void pound_law_leave(const struct pound_backbone *backbone, struct pound_law_state *at, enum pound_edge edge,
                     double u);
double pound_law_envelope(const struct pound_backbone *backbone, double u);
double pound_law_residual(const struct pound_backbone *backbone, const struct pound_law_state *at, double u);
double pound_law_given_back(const struct pound_backbone *backbone, const struct pound_law_state *at,
                            double u);

#endif
