/* fixed_step.h - common to the fixed-step integrators: branches of laws and contacts at the end of a step. */
#ifndef FIXED_STEP_H
#define FIXED_STEP_H

#include <math.h>
#include <stdbool.h>

#include "engine/scene/contact.h"
#include "engine/scene/law.h"

enum { POUND_FIXED_ROUNDS = 16 }; /* Newton iterations of a step; without contact two or three are enough */

/* Relative change of an overlap that ends the iteration of a nonlinear force; each Newton iteration doubles the digits. */
static const double POUND_FIXED_SETTLED = 1e-10;

/* A velocity that exceeds the bound from the work of the ground motion this many times is a numerical instability. */
static const double POUND_FIXED_UNSTABLE = 10;

int pound_fixed_steps(double time_step, double step);

/* Updates the branch of a law whose displacement changes monotonically, through every branch boundary on the way. */
static inline void pound_fixed_follow(const struct pound_backbone *backbone, struct pound_law_state *at,
                                      double from, double to)
{
	if (at->branch.direction * (to - from) < 0)
		pound_law_leave(backbone, at, POUND_EDGE_REVERSAL, from);
	for (;;)
		if (to > at->branch.high)
			pound_law_leave(backbone, at, POUND_EDGE_HIGH, at->branch.high);
		else if (to < at->branch.low)
			pound_law_leave(backbone, at, POUND_EDGE_LOW, at->branch.low);
		else
			return;
}

/* Spring force of a law on its branch. */
static inline double pound_fixed_restoring(const struct pound_law_state *at, double u)
{
	return at->branch.stiffness * u + at->branch.offset;
}

static inline bool pound_fixed_same_law(const struct pound_law_state *a, const struct pound_law_state *b)
{
	return a->branch.stiffness == b->branch.stiffness && a->branch.offset == b->branch.offset;
}

static inline bool pound_fixed_same_touch(const struct pound_touch *a, const struct pound_touch *b)
{
	return a->branch == b->branch && a->on.offset == b->on.offset;
}

/* The branch of a contact at the end of a step.
 *
 * Given    was, touching   branch at the start of the step; used only if the contact was touching
 *          from, to   m    overlap at the start and the end of the step
 *          rate       m/s  overlap rate at the start
 */
static inline struct pound_touch pound_fixed_touch(const struct pound_contact_law *law,
                                                   const struct pound_touch *was, bool touching, double from,
                                                   double to, double rate)
{
	struct pound_touch touch = *was;
	if (!touching) {
		pound_contact_begin(law, &touch, rate);
		from = 0;
	}
	if (to > 0)
		pound_contact_follow(law, &touch, from, to);
	return touch;
}

/* Whether a contact acts at the end of a step: bodies overlap, and the force does not pull unless the law allows tension. */
static inline bool pound_fixed_touches(const struct pound_contact_law *law, const struct pound_touch *touch,
                                       double overlap, double rate)
{
	return overlap > 0 && (law->tension || pound_contact_force_on(&touch->on, overlap, rate) > 0);
}

/* Linearized contact force at the end of a step: still + slope d + rate q1, with d the change of the overlap in the step and q1
 * the overlap rate at the end. */
struct pound_fixed_force {
	double still, slope, rate;
};

/* Linearized force of a branch.
 *
 * Given    p    m   overlap at the start of the step
 *          p1   m   overlap at which a nonlinear force is replaced by its tangent
 */
static inline struct pound_fixed_force pound_fixed_force_over(const struct pound_touch_branch *on, double p,
                                                              double p1)
{
	if (on->form == POUND_TOUCH_STRAIGHT) {
		const struct pound_touch_line line = pound_contact_line(on, p);
		return (struct pound_fixed_force){line.still, line.slope, line.rate};
	}
	const struct pound_touch_line line = pound_contact_line(on, p1);
	return (struct pound_fixed_force){line.still + line.slope * (p - p1), line.slope, line.rate};
}

#endif
