/* The JSON Schema subset of OpenAPI 3.0: type, nullable, enum, ranges, lengths, pattern, items, properties, required,
 * additionalProperties, allOf, anyOf, oneOf, $ref.  Written from the specification, independent of our schemas. */
#include "tests/support/jsonschema.h"

#include <math.h>
#include <regex.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = 512 };

struct place {
	const struct reading *document, *value;
	const char *schema, *pointer;
	struct jsonschema_fault *fault;
};

static bool wrong(const struct place *at, const char *format, ...)
{
	va_list values;
	va_start(values, format);
	snprintf(at->fault->pointer, sizeof at->fault->pointer, "%.255s", at->pointer);
	vsnprintf(at->fault->text, sizeof at->fault->text, format, values);
	va_end(values);
	return false;
}

/* Escapes a member name as a segment of a JSON Pointer. */
static void step(char *pointer, const char *name)
{
	size_t n = strlen(pointer);
	pointer[n++] = '/';
	for (; *name && n < PATH_SIZE - 3; name++) {
		pointer[n++] = *name == '~' || *name == '/' ? '~' : *name;
		if (*name == '~' || *name == '/')
			pointer[n++] = *name == '~' ? '0' : '1';
	}
	pointer[n] = '\0';
}

static int characters(const char *text)
{
	int n = 0;
	for (; *text; text++)
		n += ((unsigned char)*text & 0xc0) != 0x80;
	return n;
}

static bool of_type(const struct place *at, char type)
{
	const char *wanted = reading_text(at->document, "%s/type", at->schema);
	if (!wanted)
		return true;
	double number = reading_number(at->value, "%s", at->pointer);
	bool is = *wanted == 'i' ? type == 'n' && number == floor(number) : *wanted == type;
	return is || wrong(at, "is not of type %s", wanted);
}

static bool in_enum(const struct place *at)
{
	const char *text = reading_text(at->value, "%s", at->pointer);
	int n = reading_count(at->document, "%s/enum", at->schema);
	for (int i = 0; i < n; i++)
		if (text && !strcmp(text, reading_text(at->document, "%s/enum/%d", at->schema, i)))
			return true;
	return n == 0 || wrong(at, "is not one of the enum");
}

static bool in_range(const struct place *at, double value, const char *least, const char *most)
{
	double min = reading_number(at->document, "%s/%s", at->schema, least);
	double max = reading_number(at->document, "%s/%s", at->schema, most);
	bool above =
	    !(value < min) && !(value == min && reading_true(at->document, "%s/exclusiveMinimum", at->schema));
	bool below =
	    !(value > max) && !(value == max && reading_true(at->document, "%s/exclusiveMaximum", at->schema));
	return (above && below) || wrong(at, "%g is not in [%g, %g]", value, min, max);
}

static bool matches(const struct place *at, const char *text)
{
	const char *pattern = reading_text(at->document, "%s/pattern", at->schema);
	regex_t regex;
	if (!pattern)
		return true;
	if (regcomp(&regex, pattern, REG_EXTENDED | REG_NOSUB) != 0)
		return wrong(at, "the pattern %s is none", pattern);
	bool found = regexec(&regex, text, 0, NULL, 0) == 0;
	regfree(&regex);
	return found || wrong(at, "does not match %s", pattern);
}

static bool elements(const struct place *at)
{
	int n = reading_count(at->value, "%s", at->pointer);
	if (!in_range(at, n, "minItems", "maxItems"))
		return false;
	char schema[PATH_SIZE];
	snprintf(schema, sizeof schema, "%s/items", at->schema);
	for (int i = 0; i < n && reading_has(at->document, "%s", schema); i++) {
		char pointer[PATH_SIZE];
		snprintf(pointer, sizeof pointer, "%s/%d", at->pointer, i);
		if (!jsonschema_takes(at->document, schema, at->value, pointer, at->fault))
			return false;
	}
	return true;
}

static bool members(const struct place *at)
{
	const char *name;
	bool closed = reading_type(at->document, "%s/additionalProperties", at->schema) == 'b' &&
	              !reading_true(at->document, "%s/additionalProperties", at->schema);
	for (int i = 0; (name = reading_text(at->document, "%s/required/%d", at->schema, i)); i++)
		if (!reading_has(at->value, "%s/%s", at->pointer, name))
			return wrong(at, "has no %s", name);
	for (int i = 0; (name = reading_member(at->value, i, "%s", at->pointer)); i++) {
		char schema[PATH_SIZE], pointer[PATH_SIZE];
		snprintf(schema, sizeof schema, "%s/properties", at->schema);
		snprintf(pointer, sizeof pointer, "%s", at->pointer);
		step(schema, name);
		step(pointer, name);
		if (!reading_has(at->document, "%s", schema)) {
			if (closed)
				return wrong(at, "has %s, which is no property", name);
		} else if (!jsonschema_takes(at->document, schema, at->value, pointer, at->fault))
			return false;
	}
	return true;
}

/* Whether the value is valid for one (oneOf), at least one (anyOf) or all (allOf) schemas of a list. */
static bool of_list(const struct place *at, const char *list)
{
	char schema[PATH_SIZE];
	int n = reading_count(at->document, "%s/%s", at->schema, list), taken = 0;
	for (int i = 0; i < n; i++) {
		snprintf(schema, sizeof schema, "%s/%s/%d", at->schema, list, i);
		taken += jsonschema_takes(at->document, schema, at->value, at->pointer, at->fault);
	}
	bool enough = *list == 'o' ? taken == 1 : list[1] == 'n' ? taken >= 1 : taken == n;
	return n == 0 || enough || wrong(at, "%d of %d schemas of %s take it", taken, n, list);
}

bool jsonschema_takes(const struct reading *document, const char *schema, const struct reading *value,
                      const char *pointer, struct jsonschema_fault *fault)
{
	const struct place at = {document, value, schema, pointer, fault};
	const char *reference = reading_text(document, "%s/$ref", schema);
	char type = reading_type(value, "%s", pointer);
	if (!type)
		return wrong(&at, "is not there");
	if (reference)
		return jsonschema_takes(document, reference + 1, value, pointer, fault);
	if (type == '0')
		return reading_true(document, "%s/nullable", schema) || reading_count(document, "%s", schema) == 0 ||
		       wrong(&at, "is null");
	const char *text = reading_text(value, "%s", pointer);
	return of_type(&at, type) && in_enum(&at) &&
	       (type != 'n' || in_range(&at, reading_number(value, "%s", pointer), "minimum", "maximum")) &&
	       (type != 's' ||
	        (in_range(&at, characters(text), "minLength", "maxLength") && matches(&at, text))) &&
	       (type != 'a' || elements(&at)) && (type != 'o' || members(&at)) && of_list(&at, "allOf") &&
	       of_list(&at, "anyOf") && of_list(&at, "oneOf");
}
