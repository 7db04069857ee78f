/* motion_spectrum.h - the response spectrum of a ground motion. */
#ifndef MOTION_SPECTRUM_H
#define MOTION_SPECTRUM_H

#include "engine/pound.h"
#include "schema/record/record.h"

enum { PERIODS_MAX = 100 };

/* oscillators on the ground, of 5 % damping */
struct periods {
	int n;
	double period[PERIODS_MAX]; /* [s]  (n) */
};

/* Damping ratio of the oscillators. */
extern const double motion_spectrum_damping;

/* Periods from a list between commas; NULL is an empty list.  false: it is not such a list. */
bool motion_spectrum_periods(const char *list, struct periods *periods);
extern const char motion_spectrum_expected[]; /* what a list is */

/* Pseudo-accelerations omega^2 max |u| of the oscillators, exact for the motion as it is  [m/s2]  (n) */
enum pound_status motion_spectrum(const struct record *motion, const struct periods *periods, double *psa);

/* The same on the motion's band-limited interpolation at twice its rate (engine/ground/interpolation.c). */
enum pound_status motion_spectrum_finer(const struct record *motion, const struct periods *periods,
                                        double *psa);

#endif
