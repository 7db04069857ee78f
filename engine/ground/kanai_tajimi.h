/* kanai_tajimi.h - the Kanai-Tajimi filter with its high pass, as an exact recurrence from sample to sample. */
#ifndef KANAI_TAJIMI_H
#define KANAI_TAJIMI_H

enum { FILTER_STATES = 4 };

/* State before the first sample:  x = start (z_0, z_1, z_2, z_3)  with four normal numbers; then one, z, for each sample:
 *
 *   x_0 += x_1 - pole_3 x_0 + zero_3 z     x_1 += x_2 - pole_2 x_0 + zero_2 z
 *   x_2 += x_3 - pole_1 x_0 + zero_1 z     x_3 += - pole_0 x_0 + zero_0 z
 *
 * with the old x_0 on the right; the sample is the new x_0.  With z the shift operator and d = z - 1, the transfer function
 * is  z sum of zero_j d^j  over  d^4 + sum of pole_j d^j. */
struct pound_filter {
	double pole[FILTER_STATES];
	double zero[FILTER_STATES];
	double start[FILTER_STATES][FILTER_STATES]; /* lower triangular, zeros above the diagonal */
};

/* theta: 2 pi * filter frequency * sample step; for white noise of intensity 1 per sample step */
void pound_filter_init(struct pound_filter *f, double theta, double damping_ratio, double high_pass_ratio);

#endif
