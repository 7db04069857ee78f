/* largest.h - the largest |a| of samples, compiled at the lane width of the including file. */
#ifndef LARGEST_H
#define LARGEST_H

#include <math.h>

/* Largest |a|; n = 0: 0.  (n) */
static inline double ground_largest(int n, const double *a)
{
	// PARTS independent maxima: in a single one each comparison waits for the previous one
	enum { PARTS = 32 };
	double most[PARTS] = {0};
	int i = 0;
	for (; i + PARTS <= n; i += PARTS)
		for (int k = 0; k < PARTS; k++)
			most[k] = fabs(a[i + k]) > most[k] ? fabs(a[i + k]) : most[k];
	for (int k = 0; k < PARTS; k++)
		most[0] = most[k] > most[0] ? most[k] : most[0];
	for (; i < n; i++)
		most[0] = fabs(a[i]) > most[0] ? fabs(a[i]) : most[0];
	return most[0];
}

#endif
