/* record.h - reads files of recorded ground accelerations: PEER NGA, COSMOS, ESM, columns of numbers.
 *
 * A file is read completely or refused with the line and column of the error; nothing is resampled, filtered or corrected.
 * Texts must be zero-terminated.  Reentrant. */
#ifndef RECORD_H
#define RECORD_H

#include <stddef.h>

#include "schema/json/problems.h"

enum { RECORD_TITLE = 200 };

/* Information that the user gives in addition to the file. */
struct record_choice {
	const char *unit; /* for a file that names none: a name of record_unit_name; NULL: not given */
	double step;      /* for a file without times [s]; 0: not given */
	int channel;      /* for a file with more than one acceleration, from 1; 0: not given */
};

struct record {
	const char *format;       /* name in the table of formats */
	const char *unit;         /* unit in the file, a name of record_unit_name */
	char title[RECORD_TITLE]; /* event, station and component from the file; "": none */
	int n;                    /* samples >= 2 */
	double step;              /* between samples [s]  > 0 */
	double *acceleration;     /* [m/s2]  (n), on the heap */
};

/* Names of formats and units, and a description of each format in one line; names are NULL after the last row. */
const char *record_format_name(int row);
const char *record_format_text(int row);
const char *record_unit_name(int row);

/* Whether the first lines of a text identify a PEER NGA, COSMOS or ESM file. */
bool record_recognized(const char *text, size_t length);

/* Reads a file.  false: failed, see `problems`, with line and column. */
bool record_read(const char *text, size_t length, const struct record_choice *choice, struct record *record,
                 struct problems *problems);
void record_free(struct record *record);

/* A record as a PEER file, in g with all digits; on the heap, zero-terminated; NULL: out of memory. */
char *record_to_peer(const struct record *record, size_t *length);

#endif
