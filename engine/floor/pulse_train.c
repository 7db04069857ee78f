/* pulse_train.c - floor spectra of idealized impacts, in closed form. */
#include "engine/floor/pulse_train.h"

#include <math.h>

#include "engine/exact/task.h"
#include "engine/numeric/elementary.h"

enum { LOOK_EVERY = 4096 /* pulses between two checks of the stop flag */ };

static const double PI = 3.14159265358979323846;

/* Spectrum of a single pulse, a line through the origin.
 *
 *   PSA = v1 w exp(-xi pi/2)
 *
 * Source   the paper, Eq. (23)
 * Test     unit_pulse_train
 */
double pound_pulse_train_line(const struct pound_pulse_train *dirac, double omega, double xi)
{
	return dirac->speed * omega * pound_elementary_exp(-0.5 * PI * xi);
}

/* Spectrum of N pulses that all act in phase with the oscillator: the peaks of the train's spectrum at the frequencies 2 n f,
 * where w spacing = 2 n pi, and a curve through these peaks elsewhere.
 *
 *   PSA = v1 w exp(-xi pi/2) (1 - E^N)/(1 - E),   E = exp(-xi w spacing)
 *
 * Source   the paper, Eq. (21); Eq. (20)'s powers read as exp(-xi 2 n pi k)
 * Valid    xi << 1: low by 0.03 % at xi = 0.02, 0.2 % at 0.05
 * Test     unit_pulse_train
 */
double pound_pulse_train_peaks(const struct pound_pulse_train *dirac, double omega, double xi)
{
	double turn = fmin(xi * omega * dirac->spacing, 700), all = fmin(turn * dirac->pulses, 700);
	double decay = 1 - pound_elementary_exp(-turn);
	double sum = decay > 0 ? (1 - pound_elementary_exp(-all)) / decay : dirac->pulses;
	return pound_pulse_train_line(dirac, omega, xi) * sum;
}

/* Angle in [0, pi] from its sine >= 0 and cosine.
 *
 * With d = sin(angle - guess) the arc sine is d + d^3/6 + 3 d^5/40 ...: errors of 0.34 rad, 4e-4, then below rounding.
 */
static double angle(double sine, double cosine)
{
	double guess = 0.5 * PI * (1 - cosine), s, c;
	for (int round = 0; round < 3; round++) {
		pound_elementary_sincos(guess / (2 * PI), &s, &c);
		double d = sine * c - cosine * s;
		guess += d + d * d * d / 6;
	}
	return guess;
}

/* First extremum of free motion from (z, v/w): |z| there, 0 if it is after w_d t = `limit` or below `top`.
 *
 * The velocity is 0 at the polar angle of (z + xi v/w, s v/w), s = sqrt(1 - xi^2), sine taken positive.  `most` is the extremum
 * without decay until then; it needs no angle and excludes most extrema of a train.
 */
static double extremum(double z, double v, double xi, double s, double limit, double top)
{
	double sine = s * v, cosine = z + xi * v, length = sqrt(sine * sine + cosine * cosine);
	if (sine == 0)
		return 0;
	sine = copysign(length, sine);
	double up = fabs(s * v) / length, along = cosine / sine;
	double most = fabs(z * along + (v + xi * z) / s * up);
	if (most < top)
		return 0;
	double turn = angle(up, along);
	if (turn > limit)
		return 0;
	return pound_elementary_exp(-xi * turn / s) * most;
}

/* Spectrum of N equal velocity steps of the floor, one every `spacing`, and of the free motion after the last.
 *
 * The oscillator's relative velocity jumps by v1 at each pulse; its motion between pulses is free.  Amplitudes decay there, so
 * the largest displacement is at the first extremum after a pulse, or at the next pulse.
 *
 * Source   the paper, section 6.1
 * Valid    exact except for rounding; NAN if stopped
 * Test     unit_pulse_train: a_train_of_pulses_gives_the_exact_values
 */
double pound_pulse_train_train(const struct pound_pulse_train *dirac, double omega, double xi)
{
	double s = sqrt(1 - xi * xi), turn = omega * s * dirac->spacing, sine, cosine;
	double decay = pound_elementary_exp(-fmin(xi * omega * dirac->spacing, 700));
	double jump = dirac->speed / omega, z = 0, v = 0, top = 0; // v over w
	pound_elementary_sincos(turn / (2 * PI), &sine, &cosine);
	const int64_t n = (int64_t)dirac->pulses;
	for (int64_t k = 0; k < n; k++) {
		if (k % LOOK_EVERY == 0 && pound_stopped(dirac->stop))
			return NAN;
		v += jump;
		double limit = k + 1 < n ? turn : INFINITY;
		top = fmax(top, extremum(z, v, xi, s, limit, top));
		double z1 = decay * (z * cosine + (v + xi * z) / s * sine);
		v = decay * (v * cosine - (z + xi * v) / s * sine);
		z = z1;
		top = k + 1 < n ? fmax(top, fabs(z)) : top;
	}
	return omega * omega * top;
}
