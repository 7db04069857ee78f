/* fixed_step.h - what the integrators of one step for all have in common: where laws and contacts are when a step ends. */
#ifndef FIXED_STEP_H
#define FIXED_STEP_H

#include <math.h>
#include <stdbool.h>

#include "engine/scene/contact.h"
#include "engine/scene/law.h"

enum { POUND_FIXED_ROUNDS = 16 }; /* of a step's iteration; laws alone take two or three */

/* Change of an overlap in a round, over the overlap, that ends the iteration of a power's force: Newton's rounds double the digits. */
static const double POUND_FIXED_SETTLED = 1e-10;

/* No response has a velocity above what the ground motion can give; one this many times larger is the integrator's. */
static const double POUND_FIXED_UNSTABLE = 10;

int pound_fixed_steps(double time_step, double step);

/* Takes a law along the straight way from one displacement to another. */
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

/* The branch of a contact where a step ends that led from one overlap to another.
 *
 * Given    was        its branch before, where it was touching
 *          rate       of the overlap before [m/s]
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

static inline bool pound_fixed_touches(const struct pound_contact_law *law, const struct pound_touch *touch,
                                       double overlap, double rate)
{
	return overlap > 0 && (law->tension || pound_contact_force_on(&touch->on, overlap, rate) > 0);
}

/* Newmark's force of a contact over the change d of its overlap p: still + slope d + rate q1 */
struct pound_fixed_force {
	double still, slope, rate;
};

/* The line or the tangent, at an overlap p1, of the force of a branch. */
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
