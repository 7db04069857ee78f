/* json_writer.c - writes JSON and CSV text into one growing buffer. */
#include "schema/json/json_writer.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_strict.h"

enum { CAPACITY_FIRST = 4096 };

void writer_init(struct writer *writer)
{
	*writer = (struct writer){.line = WRITER_DEPTH_MAX};
}

/* Appends bytes as they are.
 *
 * Given    bytes     (length)  -       must not be in the writer's own buffer
 * Memory   grows the buffer by doubling; if memory runs out, these and all later bytes are discarded
 *
 * Test     unit_json_writer: out_of_memory_shows_only_at_the_end
 */
void writer_raw(struct writer *writer, const char *bytes, size_t length)
{
	if (!writer->failed && writer->capacity - writer->length < length + 1) {
		size_t capacity = writer->capacity ? writer->capacity : CAPACITY_FIRST;
		while (capacity - writer->length < length + 1)
			capacity *= 2;
		char *grown = realloc(writer->text, capacity);
		if (grown) {
			writer->text = grown;
			writer->capacity = capacity;
		}
		writer->failed = !grown;
	}
	if (writer->failed)
		return;
	memcpy(writer->text + writer->length, bytes, length);
	writer->length += length;
}

/* Transfers the text to the caller.
 *
 * Returns  value     (length)  -       the text, zero-terminated; NULL: out of memory
 * Memory   the caller frees the text; the writer is empty again
 *
 * Test     unit_json_writer: a_document_comes_out_as_it_was_put_in
 */
char *writer_take(struct writer *writer, size_t *length)
{
	assert(writer->depth == 0);
	writer_raw(writer, "", 1);
	char *text = writer->text;
	*length = writer->length - 1;
	if (writer->failed) {
		free(text);
		text = NULL;
		*length = 0;
	}
	writer_init(writer);
	return text;
}

static void put(struct writer *writer, const char *text)
{
	writer_raw(writer, text, strlen(text));
}

static void break_line(struct writer *writer)
{
	static const char indent[] = "                                ";
	put(writer, "\n");
	writer_raw(writer, indent, 2 * (size_t)writer->depth);
}

/* Number of bytes of the character at the start of a text; 0: needs an escape or is not UTF-8. */
static size_t plain(const char *text, size_t length)
{
	if ((unsigned char)*text < 0x20 || *text == '"' || *text == '\\')
		return 0;
	return json_strict_character(text, length);
}

/* Writes a string.  Bytes that are not UTF-8 become the replacement character, so the output is JSON for any input. */
static void quote(struct writer *writer, const char *text)
{
	const char *end = text + strlen(text);
	put(writer, "\"");
	for (const char *s = text; s < end; s++) {
		const char *start = s;
		for (size_t n; s < end && (n = plain(s, (size_t)(end - s))) > 0; s += n)
			;
		writer_raw(writer, start, (size_t)(s - start));
		if (s == end)
			break;
		char escaped[8];
		if (*s == '"' || *s == '\\')
			snprintf(escaped, sizeof escaped, "\\%c", *s);
		else if (*s == '\n' || *s == '\t')
			snprintf(escaped, sizeof escaped, "\\%c", *s == '\n' ? 'n' : 't');
		else
			snprintf(escaped, sizeof escaped, "\\u%04x", (unsigned char)*s < 0x20 ? (unsigned)*s : 0xFFFD);
		put(writer, escaped);
	}
	put(writer, "\"");
}

/* Writes the text before a value: comma, line break, name. */
static void lead(struct writer *writer, const char *name)
{
	if (writer->depth == 0)
		return;
	int top = writer->depth - 1;
	assert(writer->object[top] == (name != NULL));
	bool one_line = writer->depth >= writer->line;
	if (!writer->empty[top])
		put(writer, one_line ? ", " : ",");
	if (!one_line)
		break_line(writer);
	writer->empty[top] = false;
	if (name) {
		quote(writer, name);
		put(writer, ": ");
	}
}

static void begin(struct writer *writer, const char *name, enum writer_layout layout, bool object)
{
	lead(writer, name);
	put(writer, object ? "{" : "[");
	assert(writer->depth < WRITER_DEPTH_MAX);
	writer->object[writer->depth] = object;
	writer->empty[writer->depth] = true;
	writer->depth++;
	if (layout == WRITER_LINE && writer->line > writer->depth)
		writer->line = writer->depth;
}

void writer_object(struct writer *writer, const char *name, enum writer_layout layout)
{
	begin(writer, name, layout, true);
}

void writer_array(struct writer *writer, const char *name, enum writer_layout layout)
{
	begin(writer, name, layout, false);
}

void writer_end(struct writer *writer)
{
	assert(writer->depth > 0);
	bool one_line = writer->depth >= writer->line;
	if (writer->line == writer->depth)
		writer->line = WRITER_DEPTH_MAX;
	writer->depth--;
	if (!one_line && !writer->empty[writer->depth])
		break_line(writer);
	put(writer, writer->object[writer->depth] ? "}" : "]");
	if (writer->depth == 0)
		put(writer, "\n");
}

void writer_text(struct writer *writer, const char *name, const char *text)
{
	lead(writer, name);
	if (text)
		quote(writer, text);
	else
		put(writer, "null");
}

/* The shortest decimal of a number that reads back to the same double.
 *
 * Given    value     -         -       any double
 * Returns  digits    (32)      -       its text; "null" for NaN and infinities
 *          value     -         -       the text's length
 *
 * A double preserves any 15 digits, and 17 digits preserve any double; so the first of 15, 16, 17 that reads back is used.
 *
 * Test     unit_json_writer: a_million_random_numbers_read_back_to_the_same_bits
 */
int writer_digits(double value, char digits[WRITER_NUMBER_SIZE])
{
	if (!isfinite(value))
		return snprintf(digits, WRITER_NUMBER_SIZE, "null");
	for (int precision = 15;; precision++) {
		int length = snprintf(digits, WRITER_NUMBER_SIZE, "%.*g", precision, value);
		if (precision == 17 || strtod(digits, NULL) == value)
			return length;
	}
}

void writer_number(struct writer *writer, const char *name, double value)
{
	char digits[WRITER_NUMBER_SIZE];
	lead(writer, name);
	writer_raw(writer, digits, (size_t)writer_digits(value, digits));
}

void writer_whole(struct writer *writer, const char *name, int64_t value)
{
	char digits[WRITER_NUMBER_SIZE];
	lead(writer, name);
	writer_raw(writer, digits, (size_t)snprintf(digits, sizeof digits, "%lld", (long long)value));
}

/* A seed: a number if every JSON reader represents it exactly, else a string of its digits.
 *
 * Test     unit_json_writer: a_seed_past_2_to_the_53_is_text
 */
void writer_seed(struct writer *writer, const char *name, uint64_t seed)
{
	char digits[WRITER_NUMBER_SIZE];
	if (seed < UINT64_C(1) << 53) {
		writer_whole(writer, name, (int64_t)seed);
		return;
	}
	snprintf(digits, sizeof digits, "%llu", (unsigned long long)seed);
	writer_text(writer, name, digits);
}

void writer_bool(struct writer *writer, const char *name, bool value)
{
	lead(writer, name);
	put(writer, value ? "true" : "false");
}

/* A value that is JSON already, copied without its trailing white space.
 *
 * Test     unit_api: every_example_of_the_document_is_what_its_schema_says
 */
void writer_json(struct writer *writer, const char *name, const char *document)
{
	size_t n = strlen(document);
	while (n > 0 && strchr(" \n", document[n - 1]))
		n--;
	lead(writer, name);
	writer_raw(writer, document, n);
}

/* A text cell of CSV (RFC 4180).  Spreadsheets treat a cell that starts with = + - @, a tab or a carriage return
 * as a formula; a leading apostrophe makes it text.
 *
 * Test     unit_json_writer: a_cell_is_never_a_formula
 */
void writer_cell(struct writer *writer, const char *text)
{
	bool formula = *text && strchr("=+-@\t\r", *text);
	bool quoted = text[strcspn(text, ",\"\r\n")] != 0;
	put(writer, quoted ? "\"" : "");
	put(writer, formula ? "'" : "");
	for (const char *s = text; *s; s++) {
		writer_raw(writer, s, 1);
		if (*s == '"')
			put(writer, "\"");
	}
	put(writer, quoted ? "\"" : "");
}
