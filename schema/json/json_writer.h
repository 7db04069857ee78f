/* json_writer.h - JSON and CSV text, built in one growing buffer.
 *
 *   struct writer w;
 *   writer_init(&w);
 *   writer_object(&w, NULL, WRITER_LINES);
 *   writer_text(&w, "id", id);
 *   writer_number(&w, "progress", 0.5);
 *   writer_end(&w);
 *   char *body = writer_take(&w, &length);
 *
 * `name` is the member's name, NULL for an array's element and the document itself.  A number reads back to the
 * same double; NaN and the infinities are null.  Out of memory shows only in writer_take.  No globals; numbers as in
 * the C locale, which no program here leaves. */
#ifndef JSON_WRITER_H
#define JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum writer_layout {
	WRITER_LINES, /* one member or element a line */
	WRITER_LINE,  /* all that is inside on one line */
};

enum { WRITER_DEPTH_MAX = 32, WRITER_NUMBER_SIZE = 32 };

struct writer {
	char *text;
	size_t length, capacity;
	bool failed; /* out of memory: what follows is dropped */
	int depth;   /* open objects and arrays */
	int line;    /* depth from which all is on one line */
	bool object[WRITER_DEPTH_MAX], empty[WRITER_DEPTH_MAX];
};

void writer_init(struct writer *writer);
char *writer_take(struct writer *writer, size_t *length); /* the bytes, for free; NULL: out of memory */

void writer_object(struct writer *writer, const char *name, enum writer_layout layout);
void writer_array(struct writer *writer, const char *name, enum writer_layout layout);
void writer_end(struct writer *writer); /* of the innermost object or array; a newline after the document */

void writer_text(struct writer *writer, const char *name, const char *text); /* NULL: null */
void writer_number(struct writer *writer, const char *name, double value);
void writer_whole(struct writer *writer, const char *name, int64_t value);
void writer_seed(struct writer *writer, const char *name, uint64_t seed); /* text from 2^53 on */
void writer_bool(struct writer *writer, const char *name, bool value);

/* The shortest of 15, 16 or 17 digits that reads back to the same double; "null" when not finite. */
int writer_digits(double value, char digits[WRITER_NUMBER_SIZE]);

void writer_json(struct writer *writer, const char *name, const char *document); /* JSON as it is */
void writer_raw(struct writer *writer, const char *bytes, size_t length);

/* A text cell of CSV: quoted where needed, and harmless to a spreadsheet (= + - @ in front). */
void writer_cell(struct writer *writer, const char *text);

#endif
