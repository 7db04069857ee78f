/* field_types.h - what a field can be: a row for each type, with how it is read, stored, written and described.
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
	/* From JSON into the object at `base`, to which the field's offset belongs; what is wrong is noted.  NULL: each field of
	 * the type has its own function (study_json.c). */
	void (*read)(struct reader *r, const struct field *field, const cJSON *node, char *base);

	/* From JSON to a number, which list elements, inputs and sweeps have; false: it is none, which is noted.  NULL: the
	 * value is no number. */
	bool (*number)(struct reader *r, const struct field *field, const cJSON *node, double *value);

	void (*store)(void *at, double value); /* a number; NULL: no default can be given */
	void (*write)(struct writer *w, const struct field *field, const char *name, const void *at);
	const char *(*word)(const struct field *field, double value);         /* NULL: values are no words */
	void (*expected)(const struct field *field, char *text, size_t size); /* behind "must be" */
	void (*openapi)(struct writer *w, const struct field *field);         /* members of its Schema Object */
	enum pound_field_type varied; /* to the engine; if it has a number */
};

extern const struct field_type_row field_types[];

/* A number as a document has it: 0.5, "linear", true. */
void field_write(struct writer *w, const struct field *field, const char *name, double value);

#endif
