/* envelope.h - symmetric matrices in envelope (skyline) storage: each row from its first entry to the diagonal. */
#ifndef ENVELOPE_H
#define ENVELOPE_H

#include <stdbool.h>

/* Entry (i, j) with first[i] <= j <= i is values[begin[i] + j].  The caller owns the memory. */
struct pound_envelope {
	int n;
	int *first, *begin; /* (n) */
	double *values;     /* (value of pound_envelope_lay) */
};

int pound_envelope_lay(struct pound_envelope *e);
void pound_envelope_add(struct pound_envelope *e, int i, int j, double value);
bool pound_envelope_decompose(struct pound_envelope *e);
void pound_envelope_solve(const struct pound_envelope *e, double *x);

#endif
