/* counts.h - which contacts count: those that did more to the bodies than roundings do.
 *
 * The exact solver and the others ask this where a contact ends.  What does not count is left out of the
 * number of contacts, of their time and of what the first of them was; forces and impulses stay as they are. */
#ifndef COUNTS_H
#define COUNTS_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "engine/pound.h"

/* Roundings that velocities may be off by, of what they are made of.  An acceleration has half of one in each of its two
 * factors, in their product and in its sums: 4 times eps at most with those of w^2 and 2 xi w in a stiffness and a damping.
 * A contact without losses turns the speed round that they give, which makes its impulse twice that, and the speed that the
 * bodies part with is it once more: 12, and the next power of two is taken. */
static const double POUND_COUNTS_ROUNDINGS = 16;

/* what a body's motion is made of where a contact ends */
struct pound_counts_body {
	double u, v;              /* [m], [m/s] */
	double stiffness, offset; /* of the branch it is on, per mass [1/s2], [m/s2] */
	double damping;           /* c/m [1/s] */
	double ground;            /* what the ground gives it [m/s2] */
};

struct pound_counts {
	struct pound_counts_body body[POUND_OSCILLATORS];
	double time; /* since the start [s] */
	double
	    blur; /* of who has the overlap as the difference of two displacements: the speed that its terms would give [m/s] */
	double
	    steps; /* that the contact took, each with a rounding of its own; the march's only in the bodies: one a sample */
	double changed; /* relative speed by the contact's impulse, and that with which the bodies part  [m/s] */
};

/* Velocity that could be made of the magnitudes of all terms of a body's acceleration, in the time that it takes the body to
 * forget them or in all that has gone by: a velocity has no more than its roundings, and they fade with exp(-c t/2). */
static inline double pound_counts_speed(const struct pound_counts_body *b, double time)
{
	const double memory = b->damping * time > 2 ? 2 / b->damping : time;
	const double terms =
	    fabs(b->stiffness * b->u) + fabs(b->offset) + b->damping * fabs(b->v) + fabs(b->ground);
	return fabs(b->v) + terms * memory;
}

/* what roundings are measured by, so far; 0, 0 at the start */
struct pound_counts_scale {
	double most;  /* largest speed that a sum gave [m/s] */
	double speed; /* largest sum of the bodies' speeds for which it was taken [m/s] */
};

/* Whether a contact counts whatever its sum is: the sum was taken for bodies as fast as these, and the contact changed their speeds
 * by 2^-12 of it, a billion roundings. */
static inline bool pound_contact_plain(double changed, double speed, const struct pound_counts_scale *scale)
{
	return speed <= scale->speed && changed > 0x1p-12 * scale->most;
}

/* Whether a contact that has ended counts.
 *
 * Returns  scale  with this contact
 *
 *   (1 + m1/m2) I/m1 + |q| > 16 eps (1 + steps) max sum_i (|v_i| + (|k u| + |r0| + c |v| + |a|)_i min(t, 2/c_i))
 *
 * with the impulse I and the rate q of the overlap at the end, the maximum over the contacts so far that were not plain.  Bodies
 * that roundings bring together have little of both.  Those that only graze have a small impulse but part as fast as they came,
 * and those that are pressed may end at rest but have an impulse, to which every step adds the roundings of the bodies.
 *
 * Valid    Also after the motion has died away: what is left of it is nothing beside what it was.
 * Test     unit_counts
 */
static inline bool pound_contact_counts(const struct pound_counts *c, struct pound_counts_scale *scale)
{
	const double speed = fabs(c->body[0].v) + fabs(c->body[1].v);
	if (pound_contact_plain(c->changed, speed, scale))
		return true;
	double most = c->blur;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		most += pound_counts_speed(&c->body[i], c->time);
	scale->most = scale->most < most ? most : scale->most;
	scale->speed = scale->speed < speed ? speed : scale->speed;
	return c->changed > POUND_COUNTS_ROUNDINGS * DBL_EPSILON * (1 + c->steps) * scale->most;
}

#endif
