/* json.h - JSON text -> cJSON tree, after the strict check.  For the files of schema/ only. */
#ifndef JSON_H
#define JSON_H

#include <stddef.h>

#include <cjson/cJSON.h>

#include "schema/json/json_strict.h"

/* The tree for cJSON_Delete.  NULL: fault->line > 0 says what is not JSON, 0 that memory ran out. */
cJSON *json_parse(const char *text, size_t length, struct json_fault *fault);

#endif
