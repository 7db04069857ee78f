/* study_schema.h - a study document as Schema Objects of OpenAPI 3.0.3, from the rows of fields.c. */
#ifndef STUDY_SCHEMA_H
#define STUDY_SCHEMA_H

#include "schema/json/json_writer.h"
#include "schema/study/fields.h"

/* Writes the type, properties and required members of the object at a pattern ("" is the study). */
void study_schema_members(struct writer *w, const char *pattern);

void study_schema_list(struct writer *w, const struct field *field);

#endif
