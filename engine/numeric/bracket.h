/* bracket.h - a root of a falling function of one variable, one evaluation after the other. */
#ifndef BRACKET_H
#define BRACKET_H

#include <stdbool.h>

/* Filled with zeros it is a search that has not begun. */
struct pound_bracket {
	int n;             /* evaluations so far */
	bool closed;       /* the function has both signs at the first two points */
	double x[3], f[3]; /* the newest point, the other end or the point before, the point that was left last */
};

/* The next point to evaluate; false: no number lies between both ends, and the function jumps over 0. */
bool pound_bracket_next(struct pound_bracket *b, double x, double f, double *next);

#endif
