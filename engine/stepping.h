/* stepping.h - what those who follow a motion from step to step have in common.
 *
 * No code, only numbers: the march, the trace and the spectra's oscillators read them. */
#ifndef STEPPING_H
#define STEPPING_H

/* How far the inner control points of the cubic through both ends of an interval h must stay inside a limit, over h^4 max
 * |u''''|, for the motion to stay inside it: it misses the cubic by at most e = 1/24 t^2 (1 - t)^2 <= 1/384 (Hermite), and
 * inner points pulled in by e' lower the cubic by 3 t (1 - t) e' >= e for e' = e(1/2)/(3/4) = 1/288. */
static const double POUND_CUBIC_ERROR = 1.0 / 288;

/* A step that a search was unsure of is followed by one this much shorter, and then by longer ones again: what decides
 * may be far below the rounding of a whole step. */
static const double POUND_STEP_SHORTER = 0x1p-8, POUND_STEP_SHORTEST = 0x1p-400, POUND_STEP_LONGER = 0x1p4;

#endif
