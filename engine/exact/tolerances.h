/* tolerances.h - tolerances and constants shared by all integrators that step from event to event.
 *
 * No code, only numbers: the exact solver, a floor's pieces and the oscillators on it read them. */
#ifndef TOLERANCES_H
#define TOLERANCES_H

#include <float.h>
#include <math.h>

/* A motion below this is set to rest while the ground does not move [m].  The stiffest contacts have overlaps of a rounding error of
 * the motion, and the rounding errors of these are then the smallest normal numbers.  Below, bounds prove nothing, and
 * every operation takes a hundred times as long.  The ground's largest acceleration is near 1 m/s2 (request.c). */
static const double POUND_AT_REST = DBL_MIN / (DBL_EPSILON * DBL_EPSILON);

/* An acceleration below this fraction of the magnitudes of its terms is rounding error, and its sign is meaningless. */
static const double POUND_UNDECIDED = 4 * DBL_EPSILON;

/* How far the inner control points of the cubic through both ends of an interval h must stay inside a limit, over h^4 max
 * |u''''|, for the motion to stay inside it: it misses the cubic by at most e = 1/24 t^2 (1 - t)^2 <= 1/384 (Hermite), and
 * inner points pulled in by e' lower the cubic by 3 t (1 - t) e' >= e for e' = e(1/2)/(3/4) = 1/288. */
static const double POUND_CUBIC_ERROR = 1.0 / 288;

/* Largest x at which a series of n terms x^n/n! ends in rounding, (n! 2^-54)^(1/n); the last ends every search: there are no
 * more than 23. */
static const double POUND_TERMS_REACH[] = {0,        5.548e-17, 1.053e-08, 6.928e-06, 0.000191, 0.00146,
                                           0.005844, 0.01609,   0.03496,   0.06477,   0.1072,   0.1633,
                                           0.2336,   0.3182,    0.417,     0.5295,    0.6552,   0.7934,
                                           0.9437,   1.105,     1.277,     1.459,     1.651,    INFINITY};

/* After an unsure search the next step is shorter by this factor, and later steps are longer again: the deciding quantity
 * may be far below the rounding error of a whole step. */
static const double POUND_STEP_SHORTER = 0x1p-8, POUND_STEP_SHORTEST = 0x1p-400, POUND_STEP_LONGER = 0x1p4;

enum { POUND_STEPS_LIMIT = 1 << 19 }; /* of a simulation in one sample interval: more is chatter */

/* Gauss-Legendre nodes and weights on [0, 1], exact to degree 23: a step's powers are products of series whose terms
 * have died away to rounding there.  Abramowitz and Stegun 1964, Table 25.4. */
enum { POUND_GAUSS = 12 };

static const double POUND_GAUSS_NODE[POUND_GAUSS / 2] = {0.125233408511468915, 0.367831498998180194,
                                                         0.587317954286617447, 0.769902674194304687,
                                                         0.904117256370474857, 0.981560634246719251};
static const double POUND_GAUSS_WEIGHT[POUND_GAUSS / 2] = {0.249147045813402785, 0.233492536538354809,
                                                           0.203167426723065922, 0.160078328543346226,
                                                           0.106939325995318431, 0.047175336386511827};

/* 1/(n + 1): factor from coefficient n of a series to coefficient n + 1 of its integral. */
static const double POUND_SHARE[] = {1.0 / 1,  1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,
                                     1.0 / 7,  1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11, 1.0 / 12,
                                     1.0 / 13, 1.0 / 14, 1.0 / 15, 1.0 / 16, 1.0 / 17, 1.0 / 18,
                                     1.0 / 19, 1.0 / 20, 1.0 / 21, 1.0 / 22, 1.0 / 23, 1.0 / 24};

/* 1/n!: factor from derivative n to coefficient n. */
static const double POUND_FACTOR[] = {1 / 1.0,
                                      1 / 1.0,
                                      1 / 2.0,
                                      1 / 6.0,
                                      1 / 24.0,
                                      1 / 120.0,
                                      1 / 720.0,
                                      1 / 5040.0,
                                      1 / 40320.0,
                                      1 / 362880.0,
                                      1 / 3628800.0,
                                      1 / 39916800.0,
                                      1 / 479001600.0,
                                      1 / 6227020800.0,
                                      1 / 87178291200.0,
                                      1 / 1307674368000.0,
                                      1 / 20922789888000.0,
                                      1 / 355687428096000.0,
                                      1 / 6402373705728000.0,
                                      1 / 121645100408832000.0,
                                      1 / 2432902008176640000.0,
                                      1 / 51090942171709440000.0,
                                      1 / 1124000727777607680000.0,
                                      1 / 25852016738884976640000.0,
                                      1 / 620448401733239439360000.0};

#endif
