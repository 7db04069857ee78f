/* record_text.h - the text of a record's file by lines and numbers, for the files of schema/record only. */
#ifndef RECORD_TEXT_H
#define RECORD_TEXT_H

#include "schema/record/record.h"

struct record_line {
	const char *text; /* without its end; not ended by 0 */
	int length;
	int number; /* from 1 */
};

struct record_text {
	const char *at, *end;
	struct record_line line; /* the current one */
	const struct record_choice *choice;
	struct problems *problems;
};

/* Makes the next line the current one; false: there is none. */
bool record_text_next(struct record_text *text);
/* Goes back to the start of the current line, to be taken again. */
void record_text_back(struct record_text *text);

/* Reports what is wrong at a column, from 1, of the current line; 0: with the whole line; < 0: with the whole file. */
void record_text_complain(struct record_text *text, int column, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Where a phrase begins in the current line, whatever the case of its letters; -1: it is not there. */
int record_text_find(const struct record_text *text, const char *phrase);
bool record_text_begins(const struct record_text *text, const char *phrase); /* after blanks */
/* The number at or behind a place of the current line, past blanks, `=` and `:`; false: there is none. */
bool record_text_value(const struct record_text *text, int at, double *value);
bool record_text_blank(const struct record_text *text);
/* Appends the current line to a title, without blanks at its ends. */
void record_text_title(const struct record_text *text, int from, char title[RECORD_TITLE]);

/* One number of a line: its value, and the length that it takes with the blanks and the separator behind it; 0: none.
 *
 *   [+-] digits [. digits] [E|D [+-] digits]     Fortran writes D for E and may leave no blank before a sign
 */
int record_number(const char *at, const char *end, double *value);

/* Appends the numbers of the lines from the next one on to the record until it has `expected` samples.
 *
 * Returns  value   false: reported
 */
bool record_text_samples(struct record_text *text, int width, int expected, struct record *record);

/* Makes room for n samples in all; false: reported. */
bool record_reserve(struct record_text *text, struct record *record, int n);
/* Takes the file's number of samples and step; false: reported. */
bool record_sized(struct record_text *text, double n, double step, struct record *record);

/* The factor to m/s2 of the unit that starts a text, and its name; 0: it is none. */
double record_unit(const char *text, const char **name);
/* The same of the unit that the reader of the file knows; 0: reported. */
double record_unit_chosen(struct record_text *text, const char **name);
/* Multiplies all samples. */
void record_scale(struct record *record, double factor);

/* The formats: whether the first lines are those of one, and the reader. */
bool record_peer_recognized(struct record_text *text);
bool record_peer_read(struct record_text *text, struct record *record);
bool record_cosmos_recognized(struct record_text *text);
bool record_cosmos_read(struct record_text *text, struct record *record);
bool record_esm_recognized(struct record_text *text);
bool record_esm_read(struct record_text *text, struct record *record);
bool record_columns_recognized(struct record_text *text);
bool record_columns_read(struct record_text *text, struct record *record);

#endif
