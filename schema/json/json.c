/* json.c - JSON text -> cJSON tree, after the strict check, and cJSON tree -> JSON text. */
#include "schema/json/json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CJSON_NUMBER_MAX = 63 }; // cJSON 1.7 truncates a number to 63 characters

/* Shortens numbers that are too long for cJSON to fewer digits of the same double, padded with spaces. */
static void shorten_numbers(char *text)
{
	for (char *s = text; *s;) {
		if (*s == '"') {
			for (s++; *s != '"'; s++)
				s += *s == '\\';
			s++;
			continue;
		}
		size_t length = strspn(s, "-+.0123456789eE");
		if (length > CJSON_NUMBER_MAX) {
			char digits[WRITER_NUMBER_SIZE];
			int n = writer_digits(strtod(s, NULL), digits);
			memset(s, ' ', length);
			memcpy(s, digits, (size_t)n);
		}
		s += length ? length : 1;
	}
}

/* Parses a document.
 *
 * Given    text      (length)  bytes   not necessarily zero-terminated
 * Returns  value     -         -       the tree; NULL: not JSON (fault->line > 0) or no memory (fault->line = 0)
 * Memory   allocates, at most about 40 bytes per byte of text; free with cJSON_Delete
 *
 * Test     unit_json_pointer: a_number_of_400_characters_keeps_its_value
 */
cJSON *json_parse(const char *text, size_t length, struct json_fault *fault)
{
	*fault = (struct json_fault){0};
	if (!json_strict_check(text, length, fault))
		return NULL;
	char *copy = malloc(length + 1);
	if (!copy)
		return NULL;
	memcpy(copy, text, length);
	copy[length] = 0;
	shorten_numbers(copy);
	cJSON *tree = cJSON_ParseWithLengthOpts(copy, length + 1, NULL, true);
	free(copy);
	return tree;
}

_Static_assert((int)WRITER_DEPTH_MAX >= (int)JSON_DEPTH_MAX, "what was read can be written");

/* Values without nested objects or arrays are written on one line. */
static enum writer_layout layout_of(const cJSON *value)
{
	const cJSON *child;
	cJSON_ArrayForEach(child, value) if (cJSON_IsObject(child) || cJSON_IsArray(child)) return WRITER_LINES;
	return WRITER_LINE;
}

/* Writes a value of a tree.
 *
 * Test     service_bridge: every_error_of_the_protocol_has_its_type_status_and_message; unit_suite
 */
void json_write(struct writer *w, const char *name, const cJSON *value, json_replace *replace, void *with)
{
	if (cJSON_IsObject(value) || cJSON_IsArray(value)) {
		int k = 0;
		(cJSON_IsObject(value) ? writer_object : writer_array)(w, name, layout_of(value));
		for (const cJSON *child = value->child; child; child = child->next, k++)
			if (!replace || !replace(with, value, child, k))
				json_write(w, child->string, child, replace, with);
		writer_end(w);
	} else if (cJSON_IsNumber(value))
		writer_number(w, name, value->valuedouble);
	else if (cJSON_IsBool(value))
		writer_bool(w, name, cJSON_IsTrue(value));
	else
		writer_text(w, name, value->valuestring); // null has no valuestring, and is written as null
}
