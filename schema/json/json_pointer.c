/* json_pointer.c - reads values of a JSON document by JSON Pointer (RFC 6901). */
#include "schema/json/json_pointer.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json.h"

enum { POINTER_SIZE = 512 };

/* The cJSON tree as an opaque type. */
struct reading {
	cJSON tree;
};

/* Parses a document for reading.
 *
 * Given    text      (length)  bytes   not necessarily zero-terminated
 * Returns  value     -         -       NULL: not strict JSON, or out of memory
 * Memory   allocates; reading_close frees
 *
 * Test     unit_json_pointer: values_stand_where_their_pointers_say
 */
struct reading *reading_open(const char *text, size_t length)
{
	struct json_fault fault;
	return (struct reading *)json_parse(text, length, &fault);
}

void reading_close(struct reading *reading)
{
	cJSON_Delete((cJSON *)reading);
}

const char *json_pointer_token(const char *at, char *token)
{
	for (at++; *at && *at != '/'; at++) {
		bool escaped = *at == '~' && (at[1] == '0' || at[1] == '1');
		*token++ = escaped ? (at[1] == '0' ? '~' : '/') : *at;
		at += escaped;
	}
	*token = 0;
	return at;
}

static const cJSON *element(const cJSON *array, const char *index)
{
	if (!*index || index[strspn(index, "0123456789")] || (*index == '0' && index[1]) || strlen(index) > 9)
		return NULL;
	return cJSON_GetArrayItem(array, atoi(index));
}

static const cJSON *find(const struct reading *reading, const char *format, va_list arguments)
{
	char pointer[POINTER_SIZE], name[POINTER_SIZE];
	const cJSON *node = &reading->tree;
	if (vsnprintf(pointer, sizeof pointer, format, arguments) >= (int)sizeof pointer)
		return NULL;
	for (const char *at = pointer; node && *at;) {
		if (*at != '/')
			return NULL;
		at = json_pointer_token(at, name);
		node = cJSON_IsArray(node)    ? element(node, name)
		       : cJSON_IsObject(node) ? cJSON_GetObjectItemCaseSensitive(node, name)
		                              : NULL;
	}
	return node;
}

const char *reading_text(const struct reading *reading, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	return cJSON_GetStringValue(node);
}

double reading_number(const struct reading *reading, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	return cJSON_IsNumber(node) ? node->valuedouble : NAN;
}

bool reading_true(const struct reading *reading, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	return cJSON_IsTrue(node);
}

bool reading_has(const struct reading *reading, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	return node != NULL;
}

char reading_type(const struct reading *reading, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	return !node                  ? 0
	       : cJSON_IsObject(node) ? 'o'
	       : cJSON_IsArray(node)  ? 'a'
	       : cJSON_IsString(node) ? 's'
	       : cJSON_IsNumber(node) ? 'n'
	       : cJSON_IsBool(node)   ? 'b'
	                              : '0';
}

int reading_count(const struct reading *reading, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	return node ? cJSON_GetArraySize(node) : 0;
}

const char *reading_member(const struct reading *reading, int index, const char *pointer, ...)
{
	va_list arguments;
	va_start(arguments, pointer);
	const cJSON *node = find(reading, pointer, arguments);
	va_end(arguments);
	const cJSON *member = cJSON_IsObject(node) ? cJSON_GetArrayItem(node, index) : NULL;
	return member ? member->string : NULL;
}
