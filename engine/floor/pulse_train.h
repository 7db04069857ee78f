/* pulse_train.h - floor spectra of idealized impacts: one or several equal velocity steps of the floor. */
#ifndef PULSE_TRAIN_H
#define PULSE_TRAIN_H

#include <stdatomic.h>

/* equal steps of the floor's velocity, one every `spacing` */
struct pound_pulse_train {
	double speed;            /* impulse over the floor's mass [m/s] */
	double spacing;          /* half a period of the floor [s]  > 0 */
	double pulses;           /* whole number, N */
	const atomic_bool *stop; /* polled throughout; NULL: none */
};

/* pseudo-accelerations at one frequency omega > 0 and damping xi in [0, 1)  [m/s2] */
double pound_pulse_train_line(const struct pound_pulse_train *dirac, double omega, double xi);
double pound_pulse_train_train(const struct pound_pulse_train *dirac, double omega, double xi);
double pound_pulse_train_peaks(const struct pound_pulse_train *dirac, double omega, double xi);

#endif
