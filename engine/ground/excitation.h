/* excitation.h - samples of a ground acceleration at times 0, dt, ..., (n - 1) dt; linear between them. */
#ifndef EXCITATION_H
#define EXCITATION_H

#include "engine/numeric/random.h"
#include "engine/pound.h"

/* a ground motion to compute */
struct pound_signal {
	const struct pound_excitation *excitation;
	struct pound_stream noise; /* random stream of this signal; unused by harmonic and record */
	double *a;                 /* [m/s2] (pound_excitation_samples) */
};

enum { POUND_SIGNALS_MAX = 64 }; /* most filtered signals computed at a time */

int pound_excitation_samples(const struct pound_excitation *e); /* n >= 2 */
void pound_signals_fill(const struct pound_signal *signals, int n);

double pound_excitation_largest(int n, const double *a);             /* largest |a| */
double pound_excitation_frequency(const struct pound_excitation *e); /* [Hz], 0: no frequency parameter */
bool pound_excitation_random(const struct pound_excitation *e);

/* Interpolates a record to 2n - 1 samples at half the time step, as a band-limited signal. */
void pound_interpolation_twice(int n, const double *a, double *twice);

#endif
