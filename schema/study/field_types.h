/* field_types.h - types of fields: one row per type with the functions that read, store, write and describe its values.
 *
 * For the files of schema/ only.  Constant; any thread. */
#ifndef FIELD_TYPES_H
#define FIELD_TYPES_H

#include <cjson/cJSON.h>

#include "engine/pound.h"
#include "schema/json/json_writer.h"
#include "schema/study/fields.h"

struct reader;

struct field_type_row {
	/* From JSON into the object at `base`, from which the field's offset counts; adds problems.  NULL: each field of the type
	 * has its own function (study_json.c). */
	void (*read)(struct reader *r, const struct field *field, const cJSON *node, char *base);

	/* From JSON to a number, for list elements, inputs and sweeps; false: invalid, and a problem is added.  NULL: values of
	 * this type are not numbers. */
	bool (*number)(struct reader *r, const struct field *field, const cJSON *node, double *value);

	void (*store)(void *at, double value); /* stores a number; NULL: the type has no defaults */
	void (*write)(struct writer *w, const struct field *field, const char *name, const void *at);
	const char *(*word)(const struct field *field, double value);         /* NULL: values have no names */
	void (*expected)(const struct field *field, char *text, size_t size); /* text that follows "must be" */
	void (*openapi)(struct writer *w, const struct field *field);         /* members of its Schema Object */
	enum pound_field_type varied; /* the engine's type; used if `number` is not NULL */
};

extern const struct field_type_row field_types[];

/* Writes a number as a document writes a value of the field: 0.5, "linear", true. */
void field_write(struct writer *w, const struct field *field, const char *name, double value);

#endif
