/* noise.h - random ground motions: white or filtered noise, times a trapezoid in time, scaled to a peak. */
#ifndef NOISE_H
#define NOISE_H

#include "engine/ground/kanai_tajimi.h"
#include "engine/numeric/random.h"

/* a signal to compute */
struct pound_noise {
	const struct pound_filter
	    *filter; /* of which the noise is the stationary output; NULL: white noise of variance 1 */
	struct pound_stream stream; /* of its normal numbers */
	int n;
	double *a;         /* (n) */
	double rise, fall; /* of the trapezoid, as fractions of the duration */
	double peak;       /* largest |a| of the signal [m/s2]; 0: the signal is not scaled */
};

/* The same bits for any width of cpu_width.h and for any other signals in the call.  (n) */
void pound_noise_fill(int width, const struct pound_noise *signals, int n);

/* noise.inl, compiled once for each width */
void pound_noise_w8(const struct pound_noise *signals, int n);
void pound_noise_w4(const struct pound_noise *signals, int n);
void pound_noise_w1(const struct pound_noise *signals, int n);
void pound_noise_portable(const struct pound_noise *signals, int n);

#endif
