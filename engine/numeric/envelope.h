/* envelope.h - symmetric matrices of which each row is stored from its first entry on, and their decomposition L D L'. */
#ifndef ENVELOPE_H
#define ENVELOPE_H

#include <stdbool.h>

/* Entry (i, j) with first[i] <= j <= i is values[begin[i] + j]; the memory is the caller's. */
struct pound_envelope {
	int n;
	int *first, *begin; /* (n) */
	double *values;     /* (pound_envelope_lay) */
};

int pound_envelope_lay(struct pound_envelope *e);
void pound_envelope_add(struct pound_envelope *e, int i, int j, double value);
bool pound_envelope_decompose(struct pound_envelope *e);
void pound_envelope_solve(const struct pound_envelope *e, double *x);

#endif
