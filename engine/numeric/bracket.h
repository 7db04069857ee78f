/* bracket.h - a root of a decreasing function of one variable; the caller evaluates the function. */
#ifndef BRACKET_H
#define BRACKET_H

#include <stdbool.h>

/* State of a search; all zeros at the start. */
struct pound_bracket {
	int n;             /* evaluations so far */
	bool closed;       /* bracketed: f[0] and f[1] have opposite signs */
	double x[3], f[3]; /* newest point; other end of the bracket, or previous point; point discarded last */
};

/* The next point to evaluate; false: the bracket is as small as rounding allows, and the function jumps over 0. */
bool pound_bracket_next(struct pound_bracket *b, double x, double f, double *next);

#endif
