/* json_writer.h - writes JSON and CSV text into one growing buffer.
 *
 *   struct writer w;
 *   writer_init(&w);
 *   writer_object(&w, NULL, WRITER_LINES);
 *   writer_text(&w, "id", id);
 *   writer_number(&w, "progress", 0.5);
 *   writer_end(&w);
 *   char *body = writer_take(&w, &length);
 *
 * `name` is the member's name, NULL for an array element and for the document itself.  A number reads back to the
 * same double; NaN and infinities become null.  Only writer_take reports that memory ran out.  No globals; the programs
 * must stay in the C locale, for the decimal point. */
#ifndef JSON_WRITER_H
#define JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum writer_layout {
	WRITER_LINES, /* one member or element per line */
	WRITER_LINE,  /* the whole object or array on one line */
};

enum { WRITER_DEPTH_MAX = 32, WRITER_NUMBER_SIZE = 32 };

struct writer {
	char *text;
	size_t length, capacity;
	bool failed; /* out of memory: further text is discarded */
	int depth;   /* open objects and arrays */
	int line;    /* depth from which everything is on one line */
	bool object[WRITER_DEPTH_MAX], empty[WRITER_DEPTH_MAX];
};

void writer_init(struct writer *writer);
char *writer_take(struct writer *writer, size_t *length); /* the text, on the heap; NULL: out of memory */

void writer_object(struct writer *writer, const char *name, enum writer_layout layout);
void writer_array(struct writer *writer, const char *name, enum writer_layout layout);
void writer_end(struct writer *writer); /* of the innermost object or array, or the document */

void writer_text(struct writer *writer, const char *name, const char *text); /* NULL: null */
void writer_number(struct writer *writer, const char *name, double value);
void writer_whole(struct writer *writer, const char *name, int64_t value);
void writer_seed(struct writer *writer, const char *name, uint64_t seed); /* a string from 2^53 on */
void writer_bool(struct writer *writer, const char *name, bool value);

/* The shortest of 15, 16 or 17 digits that reads back to the same double; "null" if not finite. */
int writer_digits(double value, char digits[WRITER_NUMBER_SIZE]);

void writer_json(struct writer *writer, const char *name, const char *document); /* copies JSON */
void writer_raw(struct writer *writer, const char *bytes, size_t length);

/* A text cell of CSV: quoted if needed, and never a formula in a spreadsheet (text that starts with = + - @). */
void writer_cell(struct writer *writer, const char *text);

#endif
