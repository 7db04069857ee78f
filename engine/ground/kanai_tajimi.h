/* kanai_tajimi.h - the Kanai-Tajimi filter with its high pass, as an exact recurrence from sample to sample. */
#ifndef KANAI_TAJIMI_H
#define KANAI_TAJIMI_H

#include "engine/numeric/random.h"

enum { FILTER_STATES = 4 };

/* x_0 = start z_0,  x_k = transition x_k-1 + step z_k,  a_k = output x_k,  z_k: four normals of draw k */
struct pound_filter {
	double transition[FILTER_STATES][FILTER_STATES];
	double step[FILTER_STATES][FILTER_STATES];  /* lower triangle, zeros above */
	double start[FILTER_STATES][FILTER_STATES]; /* lower triangle, zeros above */
	double output[2];                           /* of the first two states */
};

/* theta: 2 pi filter frequency * sample step; white noise of intensity 1 per sample step */
void pound_filter_init(struct pound_filter *f, double theta, double damping_ratio, double high_pass_ratio);

/* a signal to be made: the stationary output of a filter of its own */
struct pound_filtered {
	struct pound_filter filter;
	struct pound_stream noise;
	int n;
	double *a; /* (n) */
};

/* The same bits for any width of cpu_width.h, and whichever signals are beside.  (n) */
void pound_filtered_noise_fill(int width, const struct pound_filtered *signals, int n);

/* filtered_noise.inl, compiled once for each */
void pound_filtered_noise_w8(const struct pound_filtered *signals, int n);
void pound_filtered_noise_w4(const struct pound_filtered *signals, int n);
void pound_filtered_noise_w1(const struct pound_filtered *signals, int n);
void pound_filtered_noise_portable(const struct pound_filtered *signals, int n);

#endif
