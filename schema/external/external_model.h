/* external_model.h - sensitivity indices of a model that is run elsewhere: the rows of a design out, the outputs in.
 *
 * Every function returns bytes on the heap for the caller to free, zero-terminated too; NULL: out of memory, or what
 * `problems` says.  Any thread. */
#ifndef EXTERNAL_MODEL_H
#define EXTERNAL_MODEL_H

#include <stddef.h>

#include "engine/pound.h"
#include "schema/json/problems.h"

/* Rows [first, first + n) of a run's design as CSV, a line for every sample of a row; before row 0 a header of the
 * inputs' names. */
char *model_rows(const struct pound_study *study, const struct pound_run *run, int first, int n,
                 size_t *length);

/* The result, as result_to_json writes it but without timing, of the outputs that a model gave for those lines: CSV
 * with a column for every output and, where it is known, NAME.variance. */
char *model_indices(const struct pound_study *study, const char *csv, size_t csv_length,
                    struct problems *problems, size_t *length);

#endif
