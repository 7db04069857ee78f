/* json.c - JSON text -> cJSON tree, after the strict check. */
#include "schema/json/json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_writer.h"

enum { CJSON_NUMBER_MAX = 63 }; // cJSON 1.7 copies a number into 64 bytes and cuts the rest off

/* Rewrites the numbers that are too long for cJSON as the same double in fewer digits, padded with spaces. */
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
 * Given    text      (length)  bytes   need not end with a zero
 * Returns  value     -         -       the tree; NULL: not JSON (fault->line > 0) or no memory (fault->line = 0)
 * Memory   allocates, about 40 bytes per byte of text at worst; for cJSON_Delete
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
