/* external_model.h - sensitivity indices of an external model: writes the rows of a design, reads the outputs.
 *
 * Every function returns zero-terminated bytes on the heap, which the caller frees; NULL: out of memory, or see
 * `problems`.  Any thread. */
#ifndef EXTERNAL_MODEL_H
#define EXTERNAL_MODEL_H

#include <stddef.h>

#include "engine/pound.h"
#include "schema/json/problems.h"

/* Rows [first, first + n) of a run's design as CSV, one line per sample of a row; before row 0 a header with the
 * names of the inputs. */
char *model_rows(const struct pound_study *study, const struct pound_run *run, int first, int n,
                 size_t *length);

/* The result, in the form of result_to_json without timing, from the outputs of the model for these lines: CSV
 * with a column for every output and, if known, its variance, NAME.variance. */
char *model_indices(const struct pound_study *study, const char *csv, size_t csv_length,
                    struct problems *problems, size_t *length);

#endif
