/* csv_reader.h - reads CSV of users cell by cell, and reports errors by line and column. */
#ifndef CSV_READER_H
#define CSV_READER_H

#include <stdbool.h>

#include "schema/json/problems.h"

enum {
	CSV_CELL_SIZE = 512, /* room for the longest name of an input, 100 characters of 4 bytes */
	CSV_LINES_SHOWN = 3, /* line numbers listed per fault */
};

/* A fault that many lines may have: it is reported once, with the first line numbers. */
struct csv_fault {
	int n, lines[CSV_LINES_SHOWN]; /* number of lines with it; the first of these */
	char what[200];                /* message for the first line */
};

struct csv {
	const char *at, *end;
	int line;                 /* of the current cell, from 1 */
	bool ended;               /* the current cell is the last of its line */
	char cell[CSV_CELL_SIZE]; /* without quotes and the spaces around it */
	bool cut;                 /* the cell was truncated */
	struct csv_fault length;  /* lines whose number of cells differs from the header's */
	struct problems *problems;
};

/* Whether the text is UTF-8; if not, adds a problem with the first invalid line. */
bool csv_is_text(struct csv *csv);

/* Reads the next cell: up to a comma, the end of the line or the end of the text. */
void csv_read(struct csv *csv);

/* The number in the current cell, NAN if the cell marks a failed run; false: neither, or not a finite double. */
bool csv_number(const struct csv *csv, double *value);

int csv_lines_left(const struct csv *csv); /* from the current position on, blank lines included */
bool csv_blank(const char *at, const char *end);

/* The length of NAME in a column's name NAME.variance, or NAME.replicateK with K from 1 without leading zeros; 0: another name,
 * and replicate 0. */
size_t csv_variance_stem(const char *name);
size_t csv_replicate_stem(const char *name, int *replicate);

/* Adds a problem of the current line; `column` may be NULL. */
void csv_complain(const struct csv *csv, const char *column, const char *what);
void csv_name_check(const struct csv *csv, int c, int same);

/* Notes a fault of the current line, to be reported once for all lines. */
void csv_fault_note(struct csv_fault *fault, const struct csv *csv, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Notes a line whose number of cells is not the header's. */
void csv_length_check(struct csv *csv, int n, int expected);
void csv_fault_report(const struct csv_fault *fault, const char *column, struct problems *problems);

#endif
