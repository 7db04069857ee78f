/* csv_reader.h - CSV from outside, cell by cell; what is wrong with it, by line and column. */
#ifndef CSV_READER_H
#define CSV_READER_H

#include <stdbool.h>

#include "schema/json/problems.h"

enum {
	CSV_CELL_SIZE = 512, /* room for the longest name of an input, 100 characters of 4 bytes */
	CSV_LINES_SHOWN = 3, /* of those with one fault */
};

/* A fault that many lines may have: it is reported once, with the first of them. */
struct csv_fault {
	int n, lines[CSV_LINES_SHOWN]; /* how many lines have it; the first ones */
	char what[200];                /* of the first of all */
};

struct csv {
	const char *at, *end;
	int line;                 /* of the current cell, from 1 */
	bool ended;               /* the current cell is the last of its line */
	char cell[CSV_CELL_SIZE]; /* without quotes and the spaces around it */
	bool cut;                 /* it was longer */
	struct csv_fault length;  /* a line has another number of cells than the header */
	struct problems *problems;
};

/* Whether the text is UTF-8; if not, its first line that is not is reported. */
bool csv_is_text(struct csv *csv);

/* The next cell of a line: up to a comma, the end of the line or that of the text. */
void csv_read(struct csv *csv);

/* The number in the current cell, NAN for the mark of a failed run; false: it is neither, or no double holds it. */
bool csv_number(const struct csv *csv, double *value);

int csv_lines_left(const struct csv *csv); /* from here on, blank ones too */
bool csv_blank(const char *at, const char *end);

/* Reports a fault of the current line; `column` may be NULL. */
void csv_complain(const struct csv *csv, const char *column, const char *what);
void csv_name_check(const struct csv *csv, int c, int same);

/* Keeps a fault of the current line, to be reported with those of the other lines. */
void csv_fault_note(struct csv_fault *fault, const struct csv *csv, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void csv_fault_report(const struct csv_fault *fault, const char *column, struct problems *problems);

#endif
