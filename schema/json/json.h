/* json.h - JSON text -> cJSON tree, after the strict check.  For the files of schema/ only. */
#ifndef JSON_H
#define JSON_H

#include <stddef.h>

#include <cjson/cJSON.h>

#include "schema/json/json_strict.h"
#include "schema/json/json_writer.h"

/* The tree, to be freed by cJSON_Delete.  NULL: not JSON if fault->line > 0, out of memory if fault->line is 0. */
cJSON *json_parse(const char *text, size_t length, struct json_fault *fault);

/* Callback that may write child k of an array or object itself; false: json_write copies it. */
typedef bool json_replace(void *with, const cJSON *parent, const cJSON *child, int k);

/* Writes a value; numbers read back to the same doubles, unlike with cJSON_Print; replace may be NULL. */
void json_write(struct writer *writer, const char *name, const cJSON *value, json_replace *replace,
                void *with);

#endif
