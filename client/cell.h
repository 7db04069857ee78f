/* cell.h - what tables of all kinds say about a cell of a result. */
#ifndef CELL_H
#define CELL_H

#include "schema/json/json_pointer.h"

/* A line of the swept fields and their values in this cell; nothing where nothing is swept. */
void cell_sweep(const struct reading *result, int cell);

/* A line that counts its runs without a result, if there are any; `at` is the JSON Pointer of the cell in the result. */
void cell_failed(const struct reading *result, const char *at);

#endif
