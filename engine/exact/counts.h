/* counts.h - which contacts count: those whose effect on the velocities exceeds rounding errors.
 *
 * All solvers check this when a contact ends.  A contact that does not count is excluded from the number of
 * contacts, the contact time and the first contact; forces and impulses are unaffected. */
#ifndef COUNTS_H
#define COUNTS_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "engine/pound.h"

/* Rounding errors of velocities, in units of eps times the magnitudes of their terms.  An acceleration has half an eps in each of
 * two factors, in their product and in its sums: at most 4 eps, with those of w^2 and 2 xi w in a stiffness and a damping.
 * A contact without losses reverses a speed of that size, so its impulse is twice as large, and the separation speed
 * adds it once more: 12, rounded up to a power of two. */
static const double POUND_COUNTS_ROUNDINGS = 16;

/* terms of a body's motion at the end of a contact */
struct pound_counts_body {
	double u, v;              /* [m], [m/s] */
	double stiffness, offset; /* of the branch it is on, per mass [1/s2], [m/s2] */
	double damping;           /* c/m [1/s] */
	double ground;            /* acceleration from the ground motion [m/s2] */
};

struct pound_counts {
	struct pound_counts_body body[POUND_OSCILLATORS];
	double time; /* since the start [s] */
	double
	    blur; /* speed scale of rounding, for solvers that compute the overlap as a difference of two displacements [m/s] */
	double
	    steps; /* steps of the contact, each with its own rounding; for the exact solver, samples: it rounds only the bodies' motion */
	double changed; /* relative speed by the contact's impulse, plus the separation speed  [m/s] */
};

/* Velocity scale of rounding: |v| plus the magnitudes of all terms of the acceleration times the decay time 2/c, or the time since
 * the start if that is shorter: rounding errors of a velocity decay with exp(-c t/2). */
static inline double pound_counts_speed(const struct pound_counts_body *b, double time)
{
	const double memory = b->damping * time > 2 ? 2 / b->damping : time;
	const double terms =
	    fabs(b->stiffness * b->u) + fabs(b->offset) + b->damping * fabs(b->v) + fabs(b->ground);
	return fabs(b->v) + terms * memory;
}

/* the largest velocity scale so far; 0, 0 at the start */
struct pound_counts_scale {
	double most;  /* largest speed that a sum gave [m/s] */
	double speed; /* largest sum of the bodies' speeds for which it was taken [m/s] */
};

/* Quick check that a contact counts without a new sum: the scale covers bodies as fast as these, and the contact changed their
 * speeds by 2^-12 of it, a billion rounding errors. */
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
 * with the impulse I and the rate q of the overlap at the end; the maximum is over the contacts so far without the quick check.  If
 * rounding brings bodies together, both terms are small.  Grazing bodies have a small impulse but separate as fast as they
 * approached; bodies in sustained contact may end at rest but have an impulse, to which every step adds rounding errors.
 *
 * Valid    Also after the motion has decayed: the scale keeps the largest value.
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
