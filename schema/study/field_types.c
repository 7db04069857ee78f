/* field_types.c - functions that read, store, write and describe each type of field, and the table of types. */
#include "schema/study/field_types.h"
#include "schema/study/near_name.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "schema/study/reader.h"
#include "schema/study/study_schema.h"

/* ---- numbers ---- */

/* Reads and stores a value of any type that has a function `number`. */
static void read_number(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	double value;
	if (field_types[field->type].number(r, field, node, &value))
		field_types[field->type].store(base + field->offset, value);
}

/* A number in the range of its field; misfit: NULL, or the expected type if the value has another type. */
static bool number_in_range(struct reader *r, const struct field *field, const cJSON *node,
                            const char *misfit, double *value)
{
	char range[80];
	*value = node->valuedouble + 0.0; // -0 is 0
	if (!misfit && fields_in_range(field, *value))
		return true;
	fields_range(field, range, sizeof range);
	reader_mistyped(r, misfit ? misfit : range, node);
	return false;
}

static bool real_number(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	return number_in_range(r, field, node, cJSON_IsNumber(node) ? NULL : "a number", value);
}

static bool count_number(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	const bool whole = cJSON_IsNumber(node) && floor(node->valuedouble) == node->valuedouble;
	return number_in_range(r, field, node, whole ? NULL : "a whole number", value);
}

/* "auto" is stored as 0. */
static bool auto_number(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	*value = 0.0;
	if (cJSON_IsString(node) && strcmp(node->valuestring, "auto") == 0)
		return true;
	if (!cJSON_IsString(node))
		return count_number(r, field, node, value);
	reader_mistyped(r, "a whole number or \"auto\"", node);
	return false;
}

static void real_store(void *at, double value)
{
	*(double *)at = value;
}

static void int_store(void *at, double value)
{
	*(int *)at = (int)value;
}

static void real_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	(void)field;
	writer_number(w, name, *(const double *)at);
}

static void count_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	(void)field;
	writer_whole(w, name, *(const int *)at);
}

static void number_expected(const struct field *field, const char *what, char *text, size_t size)
{
	char range[80] = "";
	if (!isinf(field->min))
		fields_range(field, range, sizeof range);
	snprintf(text, size, "%s%s%s%s%s", what,
	         *range == 'a' ? " of "
	         : *range      ? " "
	                       : "",
	         range, *field->unit ? " " : "", field->unit);
}

static void real_expected(const struct field *field, char *text, size_t size)
{
	number_expected(field, "a number", text, size);
}

static void count_expected(const struct field *field, char *text, size_t size)
{
	number_expected(field, "a whole number", text, size);
}

static void number_openapi(struct writer *w, const struct field *field, const char *type)
{
	writer_text(w, "type", type);
	if (isfinite(field->min)) {
		writer_number(w, "minimum", field->min);
		writer_bool(w, "exclusiveMinimum", field->ends & FIELD_OPEN_MIN);
	}
	if (isfinite(field->max)) {
		writer_number(w, "maximum", field->max);
		writer_bool(w, "exclusiveMaximum", field->ends & FIELD_OPEN_MAX);
	}
}

static void auto_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	if (*(const int *)at == 0)
		writer_text(w, name, "auto");
	else
		count_write(w, field, name, at);
}

static void auto_expected(const struct field *field, char *text, size_t size)
{
	count_expected(field, text, size);
	const size_t n = strlen(text);
	snprintf(text + n, size - n, ", or \"auto\"");
}

static void real_openapi(struct writer *w, const struct field *field)
{
	number_openapi(w, field, "number");
}

static void count_openapi(struct writer *w, const struct field *field)
{
	number_openapi(w, field, "integer");
}

static void auto_openapi(struct writer *w, const struct field *field)
{
	writer_array(w, "oneOf", WRITER_LINES);
	writer_object(w, NULL, WRITER_LINE);
	count_openapi(w, field);
	writer_end(w);
	writer_json(w, NULL, "{\"type\": \"string\", \"enum\": [\"auto\"]}");
	writer_end(w);
}

/* ---- numbers per storey ---- */

static void each_expected(const struct field *field, char *text, size_t size)
{
	char number[160];
	real_expected(field, number, sizeof number);
	snprintf(text, size, "%s, or an array of one for each story", number);
}

/* Reads one number for all storeys, or an array of one for each. */
static void each_read(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_each *each = (struct pound_each *)(void *)(base + field->offset);
	char expected[256];
	const int n = cJSON_GetArraySize(node), most = r->storeys ? r->storeys : POUND_STOREYS_MAX;
	each_expected(field, expected, sizeof expected);
	if (!cJSON_IsArray(node)) {
		each->n = real_number(r, field, node, &each->values[0]);
		return;
	}
	if (n != r->storeys && (r->storeys || n == 0 || n > most)) {
		problems_add(r->problems, r->pointer, "must have %d elements, one for each story, has %d", most, n);
		return;
	}
	const cJSON *element;
	each->n = 0;
	cJSON_ArrayForEach(element, node)
	{
		size_t length = reader_enter_element(r, each->n);
		real_number(r, field, element, &each->values[each->n++]);
		reader_leave(r, length);
	}
}

static void each_store(void *at, double value)
{
	struct pound_each *each = at;
	each->n = value > 0;
	each->values[0] = value;
}

/* Equal numbers are written as one number: the study is the same. */
static void each_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	const struct pound_each *each = at;
	int same = 1;
	while (same < each->n && each->values[same] == each->values[0])
		same++;
	if (same >= each->n) {
		writer_number(w, name, each->n ? each->values[0] : NAN);
		return;
	}
	(void)field;
	writer_array(w, name, WRITER_LINE);
	for (int i = 0; i < each->n; i++)
		writer_number(w, NULL, each->values[i]);
	writer_end(w);
}

static void each_openapi(struct writer *w, const struct field *field)
{
	writer_array(w, "oneOf", WRITER_LINES);
	writer_object(w, NULL, WRITER_LINE);
	real_openapi(w, field);
	writer_end(w);
	writer_object(w, NULL, WRITER_LINES);
	writer_text(w, "type", "array");
	writer_number(w, "minItems", 1);
	writer_number(w, "maxItems", POUND_STOREYS_MAX);
	writer_object(w, "items", WRITER_LINE);
	real_openapi(w, field);
	writer_end(w);
	writer_end(w);
	writer_end(w);
}

/* ---- choices: names of the rows of a table ---- */

/* Names used elsewhere for our choices: {other name, our name}; used only where the other name is not a choice itself. */
static const char *const synonyms[][2] = {
    {"bilinear", "elastoplastic"},
    {"elastic", "linear"},
    {"sine", "harmonic"},
    {"sinusoidal", "harmonic"},
    {"accelerogram", "record"},
    {"records", "suite"},
    {"monte_carlo", "random"},
    {"latin_hypercube", "lhs"},
    {"exact", "event"},
    {"hertz_mindlin", "hertz"},
    {"gaussian", "normal"},
    {"log_normal", "lognormal"},
    {"pounding", "response"},
    {"sobol_indices", "sensitivity"},
};

/* The choice that was probably meant by a name; NULL: not known. */
static const char *nearest_choice(const char *(*choice)(int row), const char *name)
{
	struct near_name_search search = near_name_begin(name);
	for (size_t k = 0; k < sizeof synonyms / sizeof synonyms[0]; k++)
		for (int row = 0; choice(row); row++)
			if (strcmp(name, synonyms[k][0]) == 0 && strcmp(choice(row), synonyms[k][1]) == 0)
				return choice(row);
	for (int row = 0; choice(row); row++)
		near_name_try(&search, choice(row));
	return near_name_found(&search);
}

static void choice_expected(const struct field *field, char *text, size_t size)
{
	size_t n = 0;
	for (int row = 0; field->choice(row) && n < size; row++)
		n += (size_t)snprintf(text + n, size - n, "%s\"%s\"",
		                      row                ? ", "
		                      : field->choice(1) ? "one of "
		                                         : "",
		                      field->choice(row));
}

enum { CHOICES_SHOWN = 20 }; // more names make a problem unreadable

/* The row of a choice, -1: invalid, and a problem with the names, if they are few, and the nearest one is added. */
static bool choice_number(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	char expected[FIELDS_EXPECTED_SIZE];
	int row = cJSON_IsString(node) ? fields_choice(field->choice, node->valuestring) : -1;
	*value = row;
	if (row >= 0)
		return true;
	int n = 0;
	while (field->choice(n))
		n++;
	if (n > CHOICES_SHOWN)
		snprintf(expected, sizeof expected,
		         "one of the %d names that schema/study.md and /v1/openapi.json list", n);
	else
		choice_expected(field, expected, sizeof expected);
	const char *nearest = cJSON_IsString(node) ? nearest_choice(field->choice, node->valuestring) : NULL;
	if (nearest)
		reader_misspelt(r, expected, node, nearest);
	else
		reader_mistyped(r, expected, node);
	return false;
}

static const char *choice_word(const struct field *field, double value)
{
	return field->choice((int)value);
}

static void choice_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	writer_text(w, name, field->choice(*(const int *)at));
}

static void alternative_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	writer_text(w, name, field->choice(*(const bool *)at));
}

static void choice_openapi(struct writer *w, const struct field *field)
{
	writer_text(w, "type", "string");
	writer_array(w, "enum", WRITER_LINE);
	for (int row = 0; field->choice(row); row++)
		writer_text(w, NULL, field->choice(row));
	writer_end(w);
}

/* ---- true or false ---- */

static void bool_expected(const struct field *field, char *text, size_t size)
{
	(void)field;
	snprintf(text, size, "true or false");
}

static bool bool_number(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	(void)field;
	*value = cJSON_IsTrue(node);
	if (!cJSON_IsBool(node))
		reader_mistyped(r, "true or false", node);
	return cJSON_IsBool(node);
}

static void bool_store(void *at, double value)
{
	*(bool *)at = value != 0;
}

static void bool_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	(void)field;
	writer_bool(w, name, *(const bool *)at);
}

static const char *bool_word(const struct field *field, double value)
{
	(void)field;
	return value != 0.0 ? "true" : "false";
}

static void bool_openapi(struct writer *w, const struct field *field)
{
	(void)field;
	writer_text(w, "type", "boolean");
}

/* ---- seeds ---- */

static void seed_expected(const struct field *field, char *text, size_t size)
{
	(void)field;
	snprintf(text, size, "a whole number below 2^53, or the digits of one below 2^64 as a string");
}

static bool seed_of(const cJSON *node, uint64_t *seed)
{
	if (cJSON_IsNumber(node)) {
		double value = node->valuedouble;
		*seed = value >= 0 && value < 0x1p53 ? (uint64_t)value : 0;
		return (double)*seed == value;
	}
	*seed = 0;
	if (!cJSON_IsString(node) || !*node->valuestring)
		return false;
	for (const char *s = node->valuestring; *s; s++) {
		uint64_t digit = (uint64_t)(*s - '0');
		if (*s < '0' || *s > '9' || *seed > (UINT64_MAX - digit) / 10)
			return false;
		*seed = *seed * 10 + digit;
	}
	return true;
}

/* A seed: a number that every JSON reader represents exactly, or the digits of a larger one as a string. */
static void seed_read(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	char expected[80];
	seed_expected(field, expected, sizeof expected);
	if (!seed_of(node, (uint64_t *)(void *)(base + field->offset)))
		reader_mistyped(r, expected, node);
}

static void seed_store(void *at, double value)
{
	*(uint64_t *)at = (uint64_t)value;
}

static void seed_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	(void)field;
	writer_seed(w, name, *(const uint64_t *)at);
}

static void seed_openapi(struct writer *w, const struct field *field)
{
	(void)field;
	writer_json(w, "oneOf",
	            "[{\"type\": \"integer\", \"minimum\": 0, \"maximum\": 9007199254740991}, "
	            "{\"type\": \"string\", \"pattern\": \"^[0-9]{1,20}$\"}]");
}

/* ---- texts ---- */

static void text_expected(const struct field *field, char *text, size_t size)
{
	char length[64];
	fields_span(field, length, sizeof length);
	snprintf(text, size, "a string of %s characters", length);
}

static void text_read(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	reader_text(r, field, node, (const char **)(void *)(base + field->offset));
}

static void text_write(struct writer *w, const struct field *field, const char *name, const void *at)
{
	(void)field;
	writer_text(w, name, *(const char *const *)at);
}

static void text_openapi(struct writer *w, const struct field *field)
{
	writer_text(w, "type", "string");
	writer_number(w, "minLength", field->min);
	writer_number(w, "maxLength", field->max);
}

/* ---- objects and lists ---- */

static void object_read(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	reader_object(r, field->pattern, node, base);
}

static void object_expected(const struct field *field, char *text, size_t size)
{
	char type[128];
	snprintf(type, sizeof type, "%s/type", field->pattern);
	const struct field *choice = fields_find(type);
	if (choice && choice->type == FIELD_CHOICE)
		snprintf(text, size, "an object such as {\"type\": \"%s\"}", choice->choice(0));
	else
		snprintf(text, size, "an object");
}

static void object_openapi(struct writer *w, const struct field *field)
{
	study_schema_members(w, field->pattern);
}

static void list_expected(const struct field *field, char *text, size_t size)
{
	char length[64];
	fields_span(field, length, sizeof length);
	snprintf(text, size, "an array of %s elements", length);
}

// clang-format off
const struct field_type_row field_types[] = {
	[FIELD_REAL]   = {read_number, real_number, real_store, real_write, NULL, real_expected, real_openapi,
	                  POUND_FIELD_REAL},
	[FIELD_EACH]   = {each_read, real_number, each_store, each_write, NULL, each_expected, each_openapi,
	                  POUND_FIELD_EACH},
	[FIELD_COUNT]  = {read_number, count_number, int_store, count_write, NULL, count_expected, count_openapi,
	                  POUND_FIELD_COUNT},
	[FIELD_COUNT_OR_AUTO] = {read_number, auto_number, int_store, auto_write, NULL, auto_expected, auto_openapi,
	                  POUND_FIELD_COUNT},
	[FIELD_CHOICE] = {read_number, choice_number, int_store, choice_write, choice_word, choice_expected, choice_openapi,
	                  POUND_FIELD_CHOICE},
	[FIELD_ALTERNATIVE] = {read_number, choice_number, bool_store, alternative_write, choice_word, choice_expected,
	                  choice_openapi, POUND_FIELD_BOOL},
	[FIELD_BOOL]   = {read_number, bool_number, bool_store, bool_write, bool_word, bool_expected, bool_openapi,
	                  POUND_FIELD_BOOL},
	[FIELD_SEED]   = {seed_read, NULL, seed_store, seed_write, NULL, seed_expected, seed_openapi, 0},
	[FIELD_TEXT]   = {text_read, NULL, NULL, text_write, NULL, text_expected, text_openapi, 0},
	[FIELD_OBJECT] = {object_read, NULL, NULL, NULL, NULL, object_expected, object_openapi, 0},
	[FIELD_LIST]   = {NULL, NULL, NULL, NULL, NULL, list_expected, study_schema_list, 0},
};
// clang-format on

static_assert(sizeof field_types / sizeof field_types[0] == FIELD_N_TYPES, "a row for each type");

/* Writes a number as a document writes a value of the field.
 *
 * Test     unit_result_json: a_swept_law_stands_by_its_name
 */
void field_write(struct writer *w, const struct field *field, const char *name, double value)
{
	union {
		double real;
		uint64_t seed;
		int row;
		bool truth;
		struct pound_each each;
	} memory;
	field_types[field->type].store(&memory, value);
	field_types[field->type].write(w, field, name, &memory);
}
