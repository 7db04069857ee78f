/* given_table.c - tables of given samples as CSV: a header, and a line for each sample. */
#include "schema/external/given_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/study.h"
#include "schema/external/csv_reader.h"

// so that squares of outputs, and products of squares, do not overflow
static const double NUMBER_MOST = 1e60;

/* ---- tables ---- */

int given_column(const struct given_table *table, int n, const char *name)
{
	for (int c = 0; c < n; c++)
		if (strcmp(table->names[c], name) == 0)
			return c;
	return -1;
}

static void header_read(struct given_table *table, struct csv *csv)
{
	const char *newline = memchr(csv->at, '\n', (size_t)(csv->end - csv->at));
	const size_t n = (size_t)((newline ? newline : csv->end) - csv->at);
	size_t n_columns = 1;
	for (size_t i = 0; i < n; i++)
		n_columns += csv->at[i] == ',';
	if (n_columns == 1 && (memchr(csv->at, ';', n) || memchr(csv->at, '\t', n))) {
		csv_complain(csv, NULL, "has no comma; columns must be separated by commas");
		return;
	}
	table->names = calloc(n_columns, sizeof *table->names);
	if (!table->names) {
		csv->problems->status = PROBLEMS_NOMEM;
		return;
	}
	do {
		csv_read(csv);
		char *name = strdup(csv->cell);
		if (!name) {
			csv->problems->status = PROBLEMS_NOMEM;
			return;
		}
		table->names[table->n_columns++] = name;
		const int c = table->n_columns - 1;
		csv_name_check(csv, c, given_column(table, c, table->names[c]));
	} while (!csv->ended);
}

/* Reads one line into a row of the table; faults are noted per column in `faults`  (n_columns). */
static void line_read(struct given_table *table, struct csv *csv, int row, struct csv_fault *faults)
{
	int n = 0;
	do {
		double number;
		csv_read(csv);
		const bool read = csv_number(csv, &number);
		if (n < table->n_columns) {
			table->cells[(size_t)row * table->n_columns + n] = number;
			if (!read)
				csv_fault_note(&faults[n], csv,
				               "must be a decimal number, or empty or nan where it is missing, got \"%.60s\"",
				               csv->cell);
			else if (fabs(number) > NUMBER_MOST)
				csv_fault_note(&faults[n], csv, "must be at most %g in magnitude, got %.60s", NUMBER_MOST,
				               csv->cell);
		}
		n++;
	} while (!csv->ended);
	csv_length_check(csv, n, table->n_columns);
}

/* Removes blank lines at the end. */
static void end_trim(struct csv *csv)
{
	for (const char *end = csv->end; end > csv->at && csv_blank(end - 1, end); end--)
		if (*(end - 1) == '\n')
			csv->end = end;
}

static void lines_read(struct given_table *table, struct csv *csv)
{
	// a line whose only cell is empty is a missing sample
	if (table->n_columns > 1)
		end_trim(csv);
	const int n = csv_lines_left(csv);
	if (n > POUND_ROWS_MAX) {
		problems_add(csv->problems, "", "has %d lines after the header, expected at most %d", n,
		             POUND_ROWS_MAX);
		return;
	}
	table->n_rows = n;
	table->cells = calloc((size_t)n * table->n_columns + 1, sizeof *table->cells);
	struct csv_fault *faults = calloc((size_t)table->n_columns, sizeof *faults);
	if (!table->cells || !faults)
		csv->problems->status = PROBLEMS_NOMEM;
	for (int i = 0; i < n && table->cells && faults; i++) {
		csv->line++;
		line_read(table, csv, i, faults);
	}
	csv_fault_report(&csv->length, NULL, csv->problems);
	for (int c = 0; c < table->n_columns && faults; c++)
		csv_fault_report(&faults[c], table->names[c], csv->problems);
	free(faults);
}

/* Removes a column from a table. */
static void column_drop(struct given_table *table, int column)
{
	const int n = table->n_columns;
	for (int i = 0; i < table->n_rows; i++)
		for (int c = 0, to = 0; c < n; c++)
			if (c != column)
				table->cells[(size_t)i * (n - 1) + to++] = table->cells[(size_t)i * n + c];
	free(table->names[column]);
	memmove(table->names + column, table->names + column + 1,
	        sizeof *table->names * (size_t)(n - column - 1));
	table->n_columns--;
}

/* Reads a table of samples from CSV.
 *
 * Given    role       -         -       of its columns
 *          csv        (length)  -       a header and one line per sample; columns `row` and `sample` are ignored
 * Returns  table      -         -       to be freed by given_table_free, also after errors
 *          problems   -         -       pointers are "line 3, NAME"
 *
 * Test     unit_given_table: what_is_wrong_with_a_table_is_reported_completely
 */
void given_table_read(struct given_table *table, enum given_role role, const char *csv, size_t length,
                      struct problems *problems)
{
	static const char mark[] = "\xEF\xBB\xBF"; // byte order mark, which spreadsheets write
	static const char *const others[] = {"row", "sample"};
	struct csv at = {.at = csv, .end = csv + length, .line = 1, .problems = problems};
	*table = (struct given_table){0};
	problems_init(problems);
	if (length >= 3 && memcmp(csv, mark, 3) == 0)
		at.at += 3;
	if (csv_blank(at.at, at.end)) {
		problems_add(problems, "", "is empty; expected a header and one line per sample");
		return;
	}
	if (!csv_is_text(&at))
		return;
	header_read(table, &at);
	if (problems->status != PROBLEMS_NONE)
		return;
	lines_read(table, &at);
	if (problems->status != PROBLEMS_NONE)
		return;
	for (int k = 0; k < 2; k++) {
		const int column = given_column(table, table->n_columns, others[k]);
		if (column >= 0)
			column_drop(table, column);
	}
	if (table->n_columns == 0)
		problems_add(problems, "line 1", "has no column of %s",
		             role == GIVEN_INPUTS ? "an input" : "an output");
	if (role == GIVEN_INPUTS && table->n_columns > POUND_INPUTS_MAX)
		problems_add(problems, "line 1", "has %d inputs, expected at most %d", table->n_columns,
		             POUND_INPUTS_MAX);
}

void given_table_free(struct given_table *table)
{
	for (int c = 0; c < table->n_columns; c++)
		free(table->names[c]);
	free(table->names);
	free(table->cells);
	*table = (struct given_table){0};
}
