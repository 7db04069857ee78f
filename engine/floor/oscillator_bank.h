/* oscillator_bank.h - oscillators of many frequencies driven by one floor, in vector lanes over the frequencies. */
#ifndef OSCILLATOR_BANK_H
#define OSCILLATOR_BANK_H

#include "engine/floor/segment_powers.h"

enum {
	POUND_SPECTRUM_GROUP = 8, /* frequencies that share the length of their steps, whatever the lane count */
	POUND_SPECTRUM_SCRATCH = 1 << 16, /* bytes of work space, 64-byte aligned */
};

/* Oscillators z'' + 2 xi w z' + w^2 z = -a, one set for each drive a; arrays in whole groups, 64-byte aligned. */
struct pound_bank {
	int n_groups;
	int n_drives;   /* 1: the floor only */
	double damping; /* xi  [0, 1) */
	double radians; /* largest w * segment, at most 1.5 */
	const struct pound_segment_powers *powers;
	const double *omega;                       /* [rad/s]  > 0 */
	double *z[POUND_DRIVES], *v[POUND_DRIVES]; /* current [m], [m/s] */
	double *top[POUND_DRIVES];                 /* largest |z| so far [m] */
};

/* What all pieces of a stretch have in common. */
struct pound_bank_input {
	const struct pound_floor_stretch *stretch;
	double time_step; /* of the ground motion [s] */
	double damping;   /* of the left body, c/m [1/s] */
};

bool pound_oscillator_bank_lanes(int lanes, const struct pound_bank *bank,
                                 const struct pound_bank_input *input, void *scratch);

/* oscillator_bank.inl, compiled for each lane count */
void pound_oscillator_bank_w8(const struct pound_bank *bank, const struct pound_bank_input *input,
                              void *scratch);
void pound_oscillator_bank_w4(const struct pound_bank *bank, const struct pound_bank_input *input,
                              void *scratch);
void pound_oscillator_bank_w1(const struct pound_bank *bank, const struct pound_bank_input *input,
                              void *scratch);
void pound_oscillator_bank_portable(const struct pound_bank *bank, const struct pound_bank_input *input,
                                    void *scratch);

#endif
