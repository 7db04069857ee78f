/* reader.c - the reader's position in a study document, and how single values and lists are read. */
#include "schema/study/reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json_writer.h"
#include "schema/study/field_types.h"

enum { SHOWN_SIZE = 80 };

/* Enters a member: appends its name, escaped as in RFC 6901, to the pointer.
 *
 * Returns  value     -         bytes   previous length of the pointer, for reader_leave
 *
 * Test     unit_study_cases
 */
size_t reader_enter(struct reader *r, const char *name)
{
	size_t length = strlen(r->pointer), at = length;
	if (at + 1 < sizeof r->pointer)
		r->pointer[at++] = '/';
	for (; *name && at + 2 < sizeof r->pointer; name++) {
		bool escaped = *name == '~' || *name == '/';
		r->pointer[at++] = escaped ? '~' : *name;
		if (escaped)
			r->pointer[at++] = *name == '~' ? '0' : '1';
	}
	r->pointer[at] = 0;
	return length;
}

size_t reader_enter_element(struct reader *r, int i)
{
	char index[16];
	snprintf(index, sizeof index, "%d", i);
	return reader_enter(r, index);
}

void reader_leave(struct reader *r, size_t length)
{
	r->pointer[length] = 0;
}

/* A value as text for a message: a number, a shortened string in quotes without control characters, or its type. */
static void shown(const cJSON *node, char text[SHOWN_SIZE])
{
	if (cJSON_IsNumber(node)) {
		writer_digits(node->valuedouble, text);
	} else if (cJSON_IsString(node)) {
		int cut = (int)strnlen(node->valuestring, 40);
		while (cut > 0 && ((unsigned char)node->valuestring[cut] & 0xC0) == 0x80)
			cut--;
		snprintf(text, SHOWN_SIZE, "\"%.*s%s\"", cut, node->valuestring, node->valuestring[cut] ? "..." : "");
		for (char *s = text; *s; s++)
			*s = (unsigned char)*s < 0x20 || *s == 0x7F ? '?' : *s;
	} else {
		snprintf(text, SHOWN_SIZE, "%s",
		         cJSON_IsObject(node)  ? "an object"
		         : cJSON_IsArray(node) ? "an array"
		         : cJSON_IsNull(node)  ? "null"
		         : cJSON_IsTrue(node)  ? "true"
		                               : "false");
	}
}

/* Adds a problem with the expected and the given value.
 *
 * Test     unit_study_cases
 */
void reader_mistyped(struct reader *r, const char *expected, const cJSON *node)
{
	char got[SHOWN_SIZE];
	shown(node, got);
	problems_add(r->problems, r->pointer, "must be %s, got %s", expected, got);
}

/* The same, with the type and range of a field as the expected value; NULL: the whole document. */
void reader_mistyped_field(struct reader *r, const struct field *field, const cJSON *node)
{
	char expected[256] = "an object";
	if (field)
		fields_expected(field, expected, sizeof expected);
	reader_mistyped(r, expected, node);
}

/* The same, with the choice that was probably meant. */
void reader_misspelt(struct reader *r, const char *expected, const cJSON *node, const char *nearest)
{
	char got[SHOWN_SIZE];
	shown(node, got);
	problems_add(r->problems, r->pointer, "must be %s, got %s, did you mean \"%s\"?", expected, got, nearest);
}

/* Number of characters of a string, -1 if it contains a control character (C0, DEL, C1). */
static int characters(const char *text)
{
	int n = 0;
	for (const unsigned char *s = (const unsigned char *)text; *s; s++) {
		if (*s < 0x20 || *s == 0x7F || (*s == 0xC2 && s[1] < 0xA0))
			return -1;
		n += (*s & 0xC0) != 0x80;
	}
	return n;
}

/* Reads a string into the study's own memory.
 *
 * Test     unit_study_cases
 */
void reader_text(struct reader *r, const struct field *field, const cJSON *node, const char **at)
{
	char length[80];
	fields_span(field, length, sizeof length);
	int n = cJSON_IsString(node) ? characters(node->valuestring) : 0;
	if (!cJSON_IsString(node)) {
		reader_mistyped_field(r, field, node);
	} else if (n < 0) {
		problems_add(r->problems, r->pointer, "must not contain control characters");
	} else if (n < field->min || n > field->max) {
		problems_add(r->problems, r->pointer, "must have %s characters, has %d", length, n);
	} else {
		*at = strcpy(r->text, node->valuestring);
		r->text += strlen(r->text) + 1;
	}
}

/* The number of elements to read, 0 if it is no list or too long; adds a problem for a wrong number of elements. */
int reader_elements(struct reader *r, const struct field *field, const cJSON *node)
{
	if (!cJSON_IsArray(node)) {
		reader_mistyped_field(r, field, node);
		return 0;
	}
	char length[80];
	fields_span(field, length, sizeof length);
	int n = cJSON_GetArraySize(node);
	if (n < field->min || n > field->max)
		problems_add(r->problems, r->pointer, "must have %s elements, has %d", length, n);
	return n <= field->max ? n : 0;
}

/* Reads every element of a list, with r->pointer at the element. */
int reader_each(struct reader *r, const struct field *field, const cJSON *node,
                void (*read)(struct reader *r, const cJSON *element, int i))
{
	int n = reader_elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	for (int i = 0; i < n; i++, element = element->next) {
		size_t length = reader_enter_element(r, i);
		read(r, element, i);
		reader_leave(r, length);
	}
	return n;
}

/* Reads a list of numbers.
 *
 * Returns  numbers   (value)   -       in the study's own memory; NAN: invalid, and a problem is added
 *
 * Test     unit_study_cases
 */
int reader_numbers(struct reader *r, const struct field *field, const struct field *element,
                   const cJSON *node, const double **numbers)
{
	int n = reader_elements(r, field, node);
	const cJSON *at = n ? node->child : NULL;
	*numbers = r->number;
	for (int i = 0; i < n; i++, at = at->next, r->number++) {
		size_t length = reader_enter_element(r, i);
		if (!field_types[element->type].number(r, element, at, r->number))
			*r->number = NAN;
		reader_leave(r, length);
	}
	return n;
}

void reader_distinct(struct reader *r, const double *numbers, int n, const char *what)
{
	for (int i = 1; i < n; i++)
		for (int k = i - 1; k >= 0; k--)
			if (numbers[k] == numbers[i]) {
				size_t length = reader_enter_element(r, i);
				problems_add(r->problems, r->pointer, "is the same as %s %d", what, k);
				reader_leave(r, length);
				break;
			}
}
