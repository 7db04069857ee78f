/* jsonschema.h - validates a value against a schema of an OpenAPI 3.0 document: the part of JSON Schema used there. */
#ifndef JSONSCHEMA_H
#define JSONSCHEMA_H

#include <stdbool.h>

#include "schema/json/json_pointer.h"

struct jsonschema_fault {
	char pointer[256]; /* into the value */
	char text[128];
};

/* Whether `value` at `pointer` is valid by the schema at the JSON Pointer `schema` of `document`. */
bool jsonschema_takes(const struct reading *document, const char *schema, const struct reading *value,
                      const char *pointer, struct jsonschema_fault *fault);

#endif
