/* motion_spectrum.h - the response spectrum of a ground motion. */
#ifndef MOTION_SPECTRUM_H
#define MOTION_SPECTRUM_H

#include "engine/pound.h"
#include "schema/record/record.h"

enum { PERIODS_MAX = 100 };

/* periods of oscillators on the ground with 5 % damping */
struct periods {
	int n;
	double period[PERIODS_MAX]; /* [s]  (n) */
};

/* Damping ratio of the oscillators. */
extern const double motion_spectrum_damping;

/* Reads periods from a comma-separated list; NULL is an empty list.  false: invalid list. */
bool motion_spectrum_periods(const char *list, struct periods *periods);
extern const char motion_spectrum_expected[]; /* description of a valid list */

/* Pseudo-accelerations omega^2 max |u| of the oscillators, exact for linear interpolation of the motion  [m/s2]  (n) */
enum pound_status motion_spectrum(const struct record *motion, const struct periods *periods, double *psa);

/* The same for the band-limited interpolation of the motion at twice its sampling rate (engine/ground/interpolation.c). */
enum pound_status motion_spectrum_finer(const struct record *motion, const struct periods *periods,
                                        double *psa);

#endif
