/* record.h - recorded ground accelerations as the files that databases give: PEER NGA, COSMOS, ESM, columns of numbers.
 *
 * A file is read whole or refused with the line and column of what is wrong; nothing is resampled, filtered or corrected.
 * A text has a 0 behind its last byte.  Reentrant. */
#ifndef RECORD_H
#define RECORD_H

#include <stddef.h>

#include "schema/json/problems.h"

enum { RECORD_TITLE = 200 };

/* What the reader of a file knows in addition to the file. */
struct record_choice {
	const char *unit; /* of a file that names none: a name of record_unit_name; NULL: not known */
	double step;      /* of a file without times [s]; 0: not known */
	int channel;      /* of a file with more than one acceleration, from 1; 0: not chosen */
};

struct record {
	const char *format;       /* name of a row of the formats */
	const char *unit;         /* of the file, name of record_unit_name */
	char title[RECORD_TITLE]; /* what the file says of event, station and component; "": nothing */
	int n;                    /* samples >= 2 */
	double step;              /* between samples [s]  > 0 */
	double *acceleration;     /* [m/s2]  (n), on the heap */
};

/* Names of formats and units, and one line about each; NULL past the last row. */
const char *record_format_name(int row);
const char *record_format_text(int row);
const char *record_unit_name(int row);

/* Whether a text is a file of records of one of the named formats, by its first lines: PEER NGA, COSMOS, ESM. */
bool record_recognized(const char *text, size_t length);

/* Reads a file.  false: `problems` says why, with line and column. */
bool record_read(const char *text, size_t length, const struct record_choice *choice, struct record *record,
                 struct problems *problems);
void record_free(struct record *record);

/* A record as a PEER file, in g with all digits; on the heap and ended by 0, NULL: out of memory. */
char *record_to_peer(const struct record *record, size_t *length);

#endif
