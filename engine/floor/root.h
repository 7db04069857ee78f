/* root.h - values and first roots of polynomials over a step of time 0 .. 1. */
#ifndef ROOT_H
#define ROOT_H

enum { POUND_ROOT_ORDER = 21 }; /* at most */

/* ROOT_CUT: the search had to give up */
enum pound_root { POUND_ROOT_NONE, POUND_ROOT_CUT, POUND_ROOT_FOUND };

/* Value at t of a polynomial, c: (order + 1).  The even and the odd terms apart: half the latency of Horner's rule. */
static inline double pound_root_value(const double *c, int order, double t)
{
	double even = 0, odd = 0, t2 = t * t;
	int n = order;
	if (n % 2 == 0)
		even = c[n--];
	for (; n > 0; n -= 2) {
		odd = odd * t2 + c[n];
		even = even * t2 + c[n - 1];
	}
	return odd * t + even;
}

/* First time at which a guard becomes positive. */
enum pound_root pound_root_first(const double *g, int order, double limit, double *t);

#endif
