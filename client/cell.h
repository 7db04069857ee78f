/* cell.h - what tables of all kinds say about a cell of a result. */
#ifndef CELL_H
#define CELL_H

#include "schema/json/json_pointer.h"

/* A line of the swept fields and their values in this cell; nothing where nothing is swept. */
void cell_sweep(const struct reading *result, int cell);

/* A line that counts its runs without a result, if there are any; `at` is the JSON Pointer of the cell in the result. */
void cell_failed(const struct reading *result, const char *at);

/* One number of an output: its member, how it is written after those before it, and what it is written times. */
struct measure {
	const char *member, *format;
	double times;
};

/* "impulse at 2 Hz, building 1, story 2: mean 0.9, variance 0.1", for the caller to free; a number without a value is left out.
 *
 * Given    at        the output's JSON Pointer
 *          measures  ends with a NULL member
 */
char *cell_output(const struct reading *result, const char *at, const struct measure measures[]);

#endif
