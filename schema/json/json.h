/* json.h - JSON text -> cJSON tree, after the strict check.  For the files of schema/ only. */
#ifndef JSON_H
#define JSON_H

#include <stddef.h>

#include <cjson/cJSON.h>

#include "schema/json/json_strict.h"
#include "schema/json/json_writer.h"

/* The tree for cJSON_Delete.  NULL: fault->line > 0 says what is not JSON, 0 that memory ran out. */
cJSON *json_parse(const char *text, size_t length, struct json_fault *fault);

/* Writes element k of an array, or a member, in another way; false: it is to be written as it is. */
typedef bool json_replace(void *with, const cJSON *parent, const cJSON *child, int k);

/* Writes a value so that its numbers read back to the same doubles, which cJSON_Print does not; replace may be NULL. */
void json_write(struct writer *writer, const char *name, const cJSON *value, json_replace *replace,
                void *with);

#endif
