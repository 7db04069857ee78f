/* given_table.h - given samples without a design: a table of inputs and one of outputs as CSV, and their indices as JSON.
 *
 * Tables own their memory.  Any thread. */
#ifndef GIVEN_TABLE_H
#define GIVEN_TABLE_H

#include <stddef.h>

#include "schema/json/problems.h"

enum given_role { GIVEN_INPUTS, GIVEN_OUTPUTS };

struct given_table {
	int n_columns, n_rows;
	char **names;  /* (n_columns) */
	double *cells; /* NAN: missing  (n_rows x n_columns) */
};

/* Reads a table from CSV and adds its errors to problems.  Free the table in any case. */
void given_table_read(struct given_table *table, enum given_role role, const char *csv, size_t length,
                      struct problems *problems);
void given_table_free(struct given_table *table);
/* The column with a name among the first n; -1: none. */
int given_column(const struct given_table *table, int n, const char *name);

/* The indices of the outputs, as JSON on the heap; NULL: failed, see the problems of each table, enum given_role. */
char *given_indices(const struct given_table *x, const struct given_table *y, struct problems problems[2],
                    size_t *length);

#endif
