/* noise.h - ground motions of noise: white or filtered, a trapezoid in time, scaled to a peak. */
#ifndef NOISE_H
#define NOISE_H

#include "engine/ground/kanai_tajimi.h"
#include "engine/numeric/random.h"

/* a signal to be made */
struct pound_noise {
	const struct pound_filter
	    *filter;                /* the signal is its stationary output; NULL: white noise of variance 1 */
	struct pound_stream stream; /* of its normal numbers */
	int n;
	double *a;         /* (n) */
	double rise, fall; /* of the trapezoid, as shares of the time */
	double peak;       /* its largest |a|; 0: as the trapezoid leaves it */
};

/* The same bits for any width of cpu_width.h, and whichever signals are beside.  (n) */
void pound_noise_fill(int width, const struct pound_noise *signals, int n);

/* noise.inl, compiled once for each */
void pound_noise_w8(const struct pound_noise *signals, int n);
void pound_noise_w4(const struct pound_noise *signals, int n);
void pound_noise_w1(const struct pound_noise *signals, int n);
void pound_noise_portable(const struct pound_noise *signals, int n);

#endif
