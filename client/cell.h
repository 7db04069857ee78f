/* cell.h - lines about a cell of a result that all kinds of tables print. */
#ifndef CELL_H
#define CELL_H

#include "schema/json/json_pointer.h"

/* Prints a line with the swept fields and their values in this cell; nothing without a sweep. */
void cell_sweep(const struct reading *result, int cell);

/* Prints a line that counts its failed runs, if there are any; `at` is the JSON Pointer of the cell in the result. */
void cell_failed(const struct reading *result, const char *at);

/* One number of an output: its member, its printf format with the text before it, and a factor. */
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
