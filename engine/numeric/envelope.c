/* envelope.c - symmetric matrices in envelope (skyline) storage, and their decomposition L D L'. */
#include "engine/numeric/envelope.h"

/* Fills `begin`, with the rows one after another.
 *
 * Given    first   (n)   column of the first entry of each row
 * Returns  value         number of entries
 */
int pound_envelope_lay(struct pound_envelope *e)
{
	int at = 0;
	for (int i = 0; i < e->n; i++) {
		e->begin[i] = at - e->first[i];
		at += i - e->first[i] + 1;
	}
	return at;
}

/* Adds to entries (i, j) and (j, i), which are stored once. */
void pound_envelope_add(struct pound_envelope *e, int i, int j, double value)
{
	e->values[i > j ? e->begin[i] + j : e->begin[j] + i] += value;
}

/* Replaces a matrix by its decomposition L D L'.
 *
 * Returns  value   false: the matrix is not positive definite, and pound_envelope_solve must not be called
 * Source   Jennings 1966, Comput. J. 9, 281-285
 * Test     unit_envelope
 */
bool pound_envelope_decompose(struct pound_envelope *e)
{
	for (int i = 0; i < e->n; i++) {
		double *row = e->values + e->begin[i], diagonal = row[i];
		for (int j = e->first[i]; j < i; j++) {
			const double *other = e->values + e->begin[j];
			double sum = row[j];
			for (int k = e->first[i] > e->first[j] ? e->first[i] : e->first[j]; k < j; k++)
				sum -= row[k] * other[k];
			row[j] = sum; // entry of L D
		}
		for (int j = e->first[i]; j < i; j++) {
			const double entry = row[j] / e->values[e->begin[j] + j];
			diagonal -= entry * row[j];
			row[j] = entry;
		}
		row[i] = diagonal;
		// NAN counts as not positive
		if (!(diagonal > 0))
			return false;
	}
	return true;
}

/* Solves a linear system with a decomposed matrix.
 *
 * Given    x   (n)   right-hand side
 * Returns  x   (n)   solution
 */
void pound_envelope_solve(const struct pound_envelope *e, double *x)
{
	for (int i = 0; i < e->n; i++) {
		const double *row = e->values + e->begin[i];
		double sum = x[i];
		for (int j = e->first[i]; j < i; j++)
			sum -= row[j] * x[j];
		x[i] = sum;
	}
	for (int i = 0; i < e->n; i++)
		x[i] /= e->values[e->begin[i] + i];
	for (int i = e->n - 1; i >= 0; i--) {
		const double *row = e->values + e->begin[i];
		for (int j = e->first[i]; j < i; j++)
			x[j] -= row[j] * x[i];
	}
}
