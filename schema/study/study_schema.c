/* study_schema.c - a study document as Schema Objects of OpenAPI: objects, lists, and the description of each field.
 *
 * Source   OpenAPI Specification 3.0.3, Schema Object */
#include "schema/study/study_schema.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/study/field_types.h"

/* The parameters of all distributions; the type of a distribution decides which of them it has. */
static void parameters(struct writer *w)
{
	const char *seen[16], *parameter;
	int n = 0;
	for (int row = 0; pound_distribution_name(row); row++)
		for (int k = 0; (parameter = pound_distribution_parameter(row, k)); k++) {
			int i = 0;
			while (i < n && strcmp(seen[i], parameter) != 0)
				i++;
			if (i < n || n == 16)
				continue;
			seen[n++] = parameter;
			writer_object(w, parameter, WRITER_LINE);
			writer_text(w, "type", "number");
			writer_number(w, "minimum", -POUND_PARAMETER_MAX);
			writer_number(w, "maximum", POUND_PARAMETER_MAX);
			writer_end(w);
		}
}

/* Rules for the parameters of each distribution, as text. */
static void rules(char *text, size_t size)
{
	const char *rule;
	size_t n = 0;
	for (int row = 0; pound_distribution_name(row); row++)
		for (int k = 0; (rule = pound_distribution_rule(row, k)) && n < size; k++)
			n += (size_t)snprintf(text + n, size - n, "; %s: %s", pound_distribution_name(row), rule);
}

/* The default of a field, if it has one.  A default of 0 outside the valid range means that the value is determined otherwise, such
 * as the yield displacement. */
static void absent(struct writer *w, const struct field *field)
{
	bool found_otherwise = field->ends & FIELD_OPEN_MIN && field->absent == field->min;
	bool element = strchr(fields_name(field), '*') != NULL;
	if (field_types[field->type].store && !isnan(field->absent) && !found_otherwise && !element)
		field_write(w, field, "default", field->absent);
}

static void property(struct writer *w, const char *name, const struct field *field)
{
	char text[2048];
	writer_object(w, name, WRITER_LINES);
	snprintf(text, sizeof text, "%s%s%s%s%s%s", field->text, *field->unit ? " [" : "", field->unit,
	         *field->unit ? "]" : "", field->kinds ? "; only of kind" : "", field->kinds ? field->kinds : "");
	size_t n = strlen(text);
	snprintf(text + n, sizeof text - n, "%s%s", field->types ? "; only of excitation" : "",
	         field->types ? field->types : "");
	if (!strcmp(field->pattern, "/inputs/*/distribution"))
		rules(text + strlen(text), sizeof text - strlen(text));
	writer_text(w, "description", text);
	field_types[field->type].openapi(w, field);
	if (!strcmp(field->pattern, "/scene/contact"))
		writer_bool(w, "nullable", true);
	absent(w, field);
	writer_end(w);
}

/* Whether a member is required in every study that has the object at the pattern. */
static bool required(const struct field *field, const char *pattern)
{
	return fields_child(field, pattern) && isnan(field->absent) && !field->types && !field->instead &&
	       field->kinds == fields_find(*pattern ? pattern : "/kind")->kinds;
}

void study_schema_members(struct writer *w, const char *pattern)
{
	bool distribution = !strcmp(pattern, "/inputs/*/distribution");
	bool oscillator = !strcmp(pattern, "/scene/oscillators/*"), scene = !strcmp(pattern, "/scene");
	bool building = !strcmp(pattern, "/scene/buildings/*");
	int n = 0;
	writer_text(w, "type", "object");
	writer_bool(w, "additionalProperties", false);
	writer_object(w, "properties", WRITER_LINES);
	for (int i = 0; i < fields_count; i++)
		if (fields_child(&fields[i], pattern) && *fields_name(&fields[i]) != '*')
			property(w, fields_name(&fields[i]), &fields[i]);
	if (distribution)
		parameters(w);
	writer_end(w);
	if (oscillator) {
		writer_json(w, "anyOf", "[{\"required\": [\"frequency_hz\"]}, {\"required\": [\"rigid_wall\"]}]");
		return;
	}
	if (building)
		writer_json(
		    w, "anyOf",
		    "[{\"required\": [\"frequency_hz\"]}, {\"required\": [\"stiffness_n_m\"]}, {\"required\": "
		    "[\"rigid_wall\"]}]");
	if (scene)
		writer_json(w, "oneOf", "[{\"required\": [\"oscillators\"]}, {\"required\": [\"buildings\"]}]");
	for (int i = 0; i < fields_count; i++) {
		if (!required(&fields[i], pattern))
			continue;
		if (n++ == 0)
			writer_array(w, "required", WRITER_LINE);
		writer_text(w, NULL, fields_name(&fields[i]));
	}
	if (n)
		writer_end(w);
}

static void elements(struct writer *w, const struct field *field)
{
	char pattern[128];
	snprintf(pattern, sizeof pattern, "%s/*", field->pattern);
	const struct field *element = fields_find(pattern);
	writer_text(w, "type", "array");
	writer_number(w, "minItems", field->min);
	writer_number(w, "maxItems", field->max);
	if (element)
		property(w, "items", element);
	else
		writer_json(w, "items", "{}");
}

/* A list; a list that may also be a range is one of an array or an object with the members of the range. */
void study_schema_list(struct writer *w, const struct field *field)
{
	bool range = false;
	for (int i = 0; i < fields_count; i++)
		range |= fields_child(&fields[i], field->pattern) && *fields_name(&fields[i]) != '*';
	if (!range) {
		elements(w, field);
		return;
	}
	writer_array(w, "oneOf", WRITER_LINES);
	writer_object(w, NULL, WRITER_LINES);
	elements(w, field);
	writer_end(w);
	writer_object(w, NULL, WRITER_LINES);
	study_schema_members(w, field->pattern);
	writer_end(w);
	writer_end(w);
}
