/* record_text.h - reads lines and numbers of a record's file.  For the files of schema/record only. */
#ifndef RECORD_TEXT_H
#define RECORD_TEXT_H

#include "schema/record/record.h"

struct record_line {
	const char *text; /* without line end and trailing blanks; not zero-terminated */
	int length;
	int number; /* from 1 */
};

struct record_text {
	const char *at, *end;
	struct record_line line; /* the current one */
	const struct record_choice *choice;
	struct problems *problems;
};

/* Moves to the next line; false: there is none. */
bool record_text_next(struct record_text *text);
/* Moves back before the current line, so that it is read again. */
void record_text_back(struct record_text *text);

/* Adds a problem at a column, from 1, of the current line; 0: of the whole line; < 0: of the whole file. */
void record_text_complain(struct record_text *text, int column, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Position of a phrase in the current line, ignoring case; -1: none. */
int record_text_find(const struct record_text *text, const char *phrase);
bool record_text_begins(const struct record_text *text, const char *phrase); /* leading blanks are ignored */
/* The number at a position of the current line, after blanks, `=` and `:`; false: there is none. */
bool record_text_value(const struct record_text *text, int at, double *value);
bool record_text_blank(const struct record_text *text);
/* Appends the current line, from a position on, to a title, without blanks at its ends. */
void record_text_title(const struct record_text *text, int from, char title[RECORD_TITLE]);

/* Reads one number of a line; returns its length, with following blanks and separator; 0: no number.
 *
 *   [+-] digits [. digits] [E|D [+-] digits]     Fortran writes D for E and may leave no blank before a sign
 */
int record_number(const char *at, const char *end, double *value);

/* Appends the numbers of the following lines to the record until it has `expected` samples.
 *
 * Returns  value   false: a problem was added
 */
bool record_text_samples(struct record_text *text, int width, int expected, struct record *record);

/* Allocates n samples in total; false: a problem was added. */
bool record_reserve(struct record_text *text, struct record *record, int n);
/* Checks number of samples and step, stores the step and allocates the samples; false: a problem was added. */
bool record_sized(struct record_text *text, double n, double step, struct record *record);

/* The factor to m/s2 of the unit at the start of a text, and its name; 0: no unit. */
double record_unit(const char *text, const char **name);
/* The same of the unit that the user gives; 0: a problem was added. */
double record_unit_chosen(struct record_text *text, const char **name);
/* Multiplies all samples. */
void record_scale(struct record *record, double factor);

/* The formats: whether the first lines identify a format, and its reader. */
bool record_peer_recognized(struct record_text *text);
bool record_peer_read(struct record_text *text, struct record *record);
bool record_cosmos_recognized(struct record_text *text);
bool record_cosmos_read(struct record_text *text, struct record *record);
bool record_esm_recognized(struct record_text *text);
bool record_esm_read(struct record_text *text, struct record *record);
bool record_columns_recognized(struct record_text *text);
bool record_columns_read(struct record_text *text, struct record *record);

#endif
