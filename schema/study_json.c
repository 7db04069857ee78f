/* study_json.c - the bytes of a study document -> the study.
 *
 * 1. the gate and the parser: text -> tree, or where it is not JSON;
 * 2. the tree is walked beside the rows of fields.c: every member is known, used, once there, of its type, in range;
 * 3. study_check.c looks at what members mean together. */
#include "schema/study_json.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/document.h"
#include "schema/fields.h"
#include "schema/study_check.h"
#include "schema/writer.h"

/* One allocation holds a study and all it points to. */
struct block {
	struct pound_study study;
	struct pound_input inputs[POUND_INPUTS_MAX];
	struct pound_sweep sweeps[POUND_SWEEPS_MAX];
	double numbers[]; /* samples and sweep values; texts stand behind them */
};

struct reader {
	struct problems *problems;
	struct pound_study *study;
	const char *kind, *excitation; /* names; NULL: not known */
	double *number;                /* next free place */
	char *text;                    /* next free place */
	const struct field *swept;     /* by the sweep being read; NULL: its path names no field that varies */
	char pointer[512];             /* of the member being read */
};

enum { SHOWN_SIZE = 80 };

/* Adds a part to the pointer, escaped as RFC 6901 says; the old length for leave(). */
static size_t enter(struct reader *r, const char *name)
{
	size_t length = strlen(r->pointer), at = length;
	if (at + 1 < sizeof r->pointer)
		r->pointer[at++] = '/';
	for (; *name && at + 2 < sizeof r->pointer; name++) {
		bool escaped = *name == '~' || *name == '/';
		r->pointer[at++] = escaped ? '~' : *name;
		if (escaped)
			r->pointer[at++] = *name == '~' ? '0' : '1';
	}
	r->pointer[at] = 0;
	return length;
}

static size_t enter_element(struct reader *r, int i)
{
	char index[16];
	snprintf(index, sizeof index, "%d", i);
	return enter(r, index);
}

static void leave(struct reader *r, size_t length)
{
	r->pointer[length] = 0;
}

/* What came, for a sentence: a number, a short text in quotes without control characters, or what else it is. */
static void shown(const cJSON *node, char text[SHOWN_SIZE])
{
	if (cJSON_IsNumber(node)) {
		writer_digits(node->valuedouble, text);
	} else if (cJSON_IsString(node)) {
		int cut = (int)strnlen(node->valuestring, 40);
		while (cut > 0 && ((unsigned char)node->valuestring[cut] & 0xC0) == 0x80)
			cut--;
		snprintf(text, SHOWN_SIZE, "\"%.*s%s\"", cut, node->valuestring, node->valuestring[cut] ? "..." : "");
		for (char *s = text; *s; s++)
			*s = (unsigned char)*s < 0x20 || *s == 0x7F ? '?' : *s;
	} else {
		snprintf(text, SHOWN_SIZE, "%s",
		         cJSON_IsObject(node)  ? "an object"
		         : cJSON_IsArray(node) ? "an array"
		         : cJSON_IsNull(node)  ? "null"
		         : cJSON_IsTrue(node)  ? "true"
		                               : "false");
	}
}

static void mistyped(struct reader *r, const char *expected, const cJSON *node)
{
	char got[SHOWN_SIZE];
	shown(node, got);
	problems_add(r->problems, r->pointer, "must be %s, got %s", expected, got);
}

/* The nearest of the names that `choice` gives, NULL when none is near. */
static const char *nearest_choice(const char *(*choice)(int row), const char *name)
{
	const char *nearest = NULL;
	int best = 1000;
	for (int row = 0; choice(row); row++) {
		int distance = fields_distance(name, choice(row));
		if (distance < best) {
			best = distance;
			nearest = choice(row);
		}
	}
	return fields_near(best, name) ? nearest : NULL;
}

static bool choice_of(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	char expected[256];
	int row = cJSON_IsString(node) ? fields_choice(field->choice, node->valuestring) : -1;
	*value = row;
	if (row >= 0)
		return true;
	fields_expected(field, expected, sizeof expected);
	const char *nearest = cJSON_IsString(node) ? nearest_choice(field->choice, node->valuestring) : NULL;
	if (nearest) {
		char got[SHOWN_SIZE];
		shown(node, got);
		problems_add(r->problems, r->pointer, "must be %s, got %s, did you mean \"%s\"?", expected, got,
		             nearest);
	} else {
		mistyped(r, expected, node);
	}
	return false;
}

/* The value of a real, a count, a choice or a boolean as a number; false: it is none, and the problem is noted. */
static bool number_of(struct reader *r, const struct field *field, const cJSON *node, double *value)
{
	char expected[80] = "true or false";
	if (field->choice)
		return choice_of(r, field, node, value);
	if (field->type == FIELD_BOOL) {
		*value = cJSON_IsTrue(node);
		if (cJSON_IsBool(node))
			return true;
	} else {
		*value = node->valuedouble + 0.0; // -0 is 0
		bool whole = field->type != FIELD_COUNT || floor(*value) == *value;
		if (cJSON_IsNumber(node) && whole && fields_in_range(field, *value))
			return true;
		snprintf(expected, sizeof expected, field->type == FIELD_COUNT ? "a whole number" : "a number");
		if (cJSON_IsNumber(node) && whole)
			fields_range(field, expected, sizeof expected);
	}
	mistyped(r, expected, node);
	return false;
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

/* Characters of a text, -1 when it holds a control character (C0, DEL, C1). */
static int characters(const char *text)
{
	int n = 0;
	for (const unsigned char *s = (const unsigned char *)text; *s; s++) {
		if (*s < 0x20 || *s == 0x7F || (*s == 0xC2 && s[1] < 0xA0))
			return -1;
		n += (*s & 0xC0) != 0x80;
	}
	return n;
}

static void read_text(struct reader *r, const struct field *field, const cJSON *node, const char **at)
{
	char expected[80];
	int n = cJSON_IsString(node) ? characters(node->valuestring) : 0;
	fields_expected(field, expected, sizeof expected);
	if (!cJSON_IsString(node)) {
		mistyped(r, expected, node);
	} else if (n < 0) {
		problems_add(r->problems, r->pointer, "must not hold control characters");
	} else if (n < field->min || n > field->max) {
		problems_add(r->problems, r->pointer, "must be %s, got %d", expected, n);
	} else {
		*at = strcpy(r->text, node->valuestring);
		r->text += strlen(r->text) + 1;
	}
}

static void store(const struct field *field, void *at, double value)
{
	switch (field->type) {
	case FIELD_REAL:
		*(double *)at = value;
		break;
	case FIELD_COUNT:
	case FIELD_CHOICE:
		*(int *)at = (int)value;
		break;
	case FIELD_BOOL:
		*(bool *)at = value != 0;
		break;
	case FIELD_SEED:
		*(uint64_t *)at = (uint64_t)value;
		break;
	case FIELD_TEXT:
	case FIELD_OBJECT:
	case FIELD_LIST:
		break;
	}
}

static void read_value(struct reader *r, const struct field *field, const cJSON *node, char *base);

/* ---- objects ---- */

static const struct field *member_field(const char *pattern, const char *name)
{
	for (int i = 0; i < fields_count; i++)
		if (fields_child(&fields[i], pattern) && strcmp(fields_name(&fields[i]), name) == 0)
			return &fields[i];
	return NULL;
}

static void unknown(struct reader *r, const char *pattern, const char *name)
{
	const struct field *nearest = NULL;
	int best = 1000;
	for (int i = 0; i < fields_count; i++) {
		if (!fields_child(&fields[i], pattern) || !fields_used(&fields[i], r->kind, r->excitation))
			continue;
		int distance = fields_distance(name, fields_name(&fields[i]));
		if (distance < best) {
			best = distance;
			nearest = &fields[i];
		}
	}
	if (nearest && fields_near(best, name))
		problems_add(r->problems, r->pointer, "unknown member, did you mean \"%s\"?", fields_name(nearest));
	else
		problems_add(r->problems, r->pointer, "unknown member");
}

static void unused(struct reader *r, const struct field *field)
{
	if (!fields_used(field, r->kind, NULL))
		problems_add(r->problems, r->pointer, "is not used by kind \"%s\"", r->kind);
	else
		problems_add(r->problems, r->pointer, "is not used by excitation \"%s\"", r->excitation);
}

static bool seen_before(const cJSON *object, const cJSON *member)
{
	for (const cJSON *other = object->child; other != member; other = other->next)
		if (strcmp(other->string, member->string) == 0)
			return true;
	return false;
}

static void require(struct reader *r, const cJSON *node, const char *pattern)
{
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		bool needed = isnan(field->absent) && fields_child(field, pattern) && (r->kind || !field->kinds) &&
		              (r->excitation || !field->types) && fields_used(field, r->kind, r->excitation);
		if (!needed || cJSON_GetObjectItemCaseSensitive(node, fields_name(field)))
			continue;
		char expected[256];
		fields_expected(field, expected, sizeof expected);
		size_t length = enter(r, fields_name(field));
		problems_add(r->problems, r->pointer, "is required: %s", expected);
		leave(r, length);
	}
}

/* Reads the members of an object; false: it is none. */
static bool read_object(struct reader *r, const char *pattern, const cJSON *node, char *base)
{
	if (!cJSON_IsObject(node)) {
		mistyped(r, "an object", node);
		return false;
	}
	const cJSON *member;
	cJSON_ArrayForEach(member, node)
	{
		size_t length = enter(r, member->string);
		const struct field *field = member_field(pattern, member->string);
		if (seen_before(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else if (!field)
			unknown(r, pattern, member->string);
		else if (!fields_used(field, r->kind, r->excitation))
			unused(r, field);
		else
			read_value(r, field, member, base);
		leave(r, length);
	}
	require(r, node, pattern);
	return true;
}

static void read_law(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	if (!read_object(r, field->pattern, node, base) ||
	    !cJSON_GetObjectItemCaseSensitive(node, "yield_displacement_m") ||
	    !cJSON_GetObjectItemCaseSensitive(node, "target_demand"))
		return;
	size_t length = enter(r, "target_demand");
	problems_add(r->problems, r->pointer, "is not used when yield_displacement_m is given");
	leave(r, length);
}

static void read_own_law(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	((struct pound_study *)base)->scene.oscillators[0].has_law =
	    true; // base is that of the oscillator in hand
	read_law(r, field, node, base);
}

static void read_contact(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	r->study->scene.contact.present = !cJSON_IsNull(node);
	if (!cJSON_IsNull(node))
		read_object(r, field->pattern, node, base);
}

static void read_parameter(struct reader *r, struct pound_distribution *distribution, const cJSON *member)
{
	int k = 0;
	const char *name = pound_distribution_parameter(distribution->type, k);
	while (name && strcmp(name, member->string) != 0)
		name = pound_distribution_parameter(distribution->type, ++k);
	if (!name)
		problems_add(r->problems, r->pointer, "is not used by distribution \"%s\"",
		             pound_distribution_name(distribution->type));
	else if (!cJSON_IsNumber(member))
		mistyped(r, "a number", member);
	else
		distribution->p[k] = member->valuedouble + 0.0;
}

static void read_parameters(struct reader *r, struct pound_distribution *distribution, const cJSON *node,
                            const cJSON *type)
{
	const cJSON *member;
	int before = r->problems->n;
	cJSON_ArrayForEach(member, node)
	{
		if (member == type)
			continue;
		size_t length = enter(r, member->string);
		if (seen_before(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else
			read_parameter(r, distribution, member);
		leave(r, length);
	}
	for (int k = 0; pound_distribution_parameter(distribution->type, k); k++) {
		const char *name = pound_distribution_parameter(distribution->type, k);
		if (cJSON_GetObjectItemCaseSensitive(node, name))
			continue;
		size_t length = enter(r, name);
		problems_add(r->problems, r->pointer, "is required: a number");
		leave(r, length);
	}
	const char *fault = r->problems->n == before ? pound_distribution_fault(distribution) : NULL;
	if (fault)
		problems_add(r->problems, r->pointer, "%s", fault);
}

/* The engine's table of distributions says which members there are. */
static void read_distribution(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_distribution *distribution = &((struct pound_input *)base)->distribution;
	const cJSON *type = cJSON_GetObjectItemCaseSensitive(node, "type");
	if (!cJSON_IsObject(node)) {
		mistyped(r, "an object", node);
	} else if (!type) {
		require(r, node, field->pattern);
	} else {
		int before = r->problems->n;
		size_t length = enter(r, "type");
		read_value(r, fields_find("/inputs/*/distribution/type"), type, base);
		leave(r, length);
		if (r->problems->n == before)
			read_parameters(r, distribution, node, type);
	}
}

/* ---- lists ---- */

/* The number of elements to read, 0 when it is no list or too long; any wrong number is a problem. */
static int elements(struct reader *r, const struct field *field, const cJSON *node)
{
	char expected[80];
	fields_expected(field, expected, sizeof expected);
	if (!cJSON_IsArray(node)) {
		mistyped(r, expected, node);
		return 0;
	}
	int n = cJSON_GetArraySize(node);
	if (n < field->min || n > field->max)
		problems_add(r->problems, r->pointer, "must be %s, got %d", expected, n);
	return n <= field->max ? n : 0;
}

static void read_oscillator(struct reader *r, const cJSON *node, int i)
{
	struct pound_oscillator *oscillator = &r->study->scene.oscillators[i];
	// rows are told for the first oscillator
	char *base = (char *)r->study + (size_t)i * sizeof *oscillator;
	const cJSON *wall = cJSON_GetObjectItemCaseSensitive(node, "rigid_wall");
	if (!cJSON_IsTrue(wall)) {
		read_object(r, "/scene/oscillators/*", node, base);
		return;
	}
	oscillator->rigid_wall = true;
	const cJSON *member;
	cJSON_ArrayForEach(member, node)
	{
		size_t length = enter(r, member->string);
		if (seen_before(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else if (member != wall && !member_field("/scene/oscillators/*", member->string))
			unknown(r, "/scene/oscillators/*", member->string);
		else if (member != wall)
			problems_add(r->problems, r->pointer, "is not used by a rigid wall");
		else if (i == 0)
			problems_add(r->problems, r->pointer,
			             "only the right oscillator, the second, may be a rigid wall");
		leave(r, length);
	}
}

static void read_oscillators(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	int n = elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	for (int i = 0; i < n; i++, element = element->next) {
		size_t length = enter_element(r, i);
		read_oscillator(r, element, i);
		leave(r, length);
	}
}

static void read_record(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	const struct field *sample = fields_find("/scene/excitation/acceleration_m_s2/*");
	int n = elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	double *samples = r->number;
	for (int i = 0; i < n; i++, element = element->next) {
		size_t length = enter_element(r, i);
		number_of(r, sample, element, r->number++);
		leave(r, length);
	}
	r->study->scene.excitation.record = samples;
	r->study->scene.excitation.n_record = n;
}

/* The field of the scene that a path names if it may vary, else NULL. */
static const struct field *varying(const char *path)
{
	int oscillator;
	const struct field *field = path ? fields_scene(path, &oscillator) : NULL;
	return field && !field->fixed && field->type < FIELD_SEED ? field : NULL;
}

static void read_inputs(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	int n = elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	r->study->n_inputs = n;
	for (int j = 0; j < n; j++, element = element->next) {
		struct pound_input *input = &r->study->inputs[j];
		size_t length = enter_element(r, j);
		read_object(r, "/inputs/*", element, (char *)input);
		input->name = input->name ? input->name : input->path;
		if (varying(input->path))
			input->field = study_check_field(input->path);
		leave(r, length);
	}
}

static void read_sweeps(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	int n = elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	r->study->n_sweeps = n;
	for (int s = 0; s < n; s++, element = element->next) {
		struct pound_sweep *sweep = &r->study->sweeps[s];
		const cJSON *path = cJSON_GetObjectItemCaseSensitive(element, "path");
		r->swept = varying(cJSON_GetStringValue(path));
		size_t length = enter_element(r, s);
		read_object(r, "/sweep/*", element, (char *)sweep);
		if (r->swept)
			sweep->field = study_check_field(cJSON_GetStringValue(path));
		leave(r, length);
	}
}

static void read_values(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_sweep *sweep = (struct pound_sweep *)base;
	int n = r->swept ? elements(r, field, node) : 0; // else the path is the problem, told by study_check.c
	const cJSON *element = n ? node->child : NULL;
	sweep->values = r->number;
	sweep->n_values = n;
	for (int i = 0; i < n; i++, element = element->next) {
		size_t length = enter_element(r, i);
		if (number_of(r, r->swept, element, r->number++))
			for (int k = i - 1; k >= 0; k--)
				if (sweep->values[k] == sweep->values[i]) {
					problems_add(r->problems, r->pointer, "is the same as value %d", k);
					break;
				}
		leave(r, length);
	}
}

static void read_outputs(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	const struct field *output = fields_find("/outputs/*");
	int n = elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	r->study->n_outputs = n;
	for (int o = 0; o < n; o++, element = element->next) {
		double row;
		size_t length = enter_element(r, o);
		if (choice_of(r, output, element, &row))
			for (int k = 0; k < o; k++)
				if (r->study->outputs[k] == (int)row)
					problems_add(r->problems, r->pointer, "is asked twice");
		r->study->outputs[o] = (int)row;
		leave(r, length);
	}
}

/* ---- any value ---- */

static const struct {
	const char *pattern;
	void (*read)(struct reader *r, const struct field *field, const cJSON *node, char *base);
} readers[] = {
    {"/scene/law", read_law},
    {"/scene/oscillators", read_oscillators},
    {"/scene/oscillators/*/law", read_own_law},
    {"/scene/contact", read_contact},
    {"/scene/excitation/acceleration_m_s2", read_record},
    {"/inputs", read_inputs},
    {"/inputs/*/distribution", read_distribution},
    {"/sweep", read_sweeps},
    {"/sweep/*/values", read_values},
    {"/outputs", read_outputs},
};

static void read_value(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	for (size_t i = 0; i < sizeof readers / sizeof readers[0]; i++)
		if (strcmp(readers[i].pattern, field->pattern) == 0) {
			readers[i].read(r, field, node, base);
			return;
		}
	double value;
	char *at = base + field->offset;
	if (field->type == FIELD_OBJECT) {
		read_object(r, field->pattern, node, base);
	} else if (field->type == FIELD_TEXT) {
		read_text(r, field, node, (const char **)(void *)at);
	} else if (field->type == FIELD_SEED) {
		char expected[80];
		fields_expected(field, expected, sizeof expected);
		if (!seed_of(node, (uint64_t *)(void *)at))
			mistyped(r, expected, node);
	} else if (number_of(r, field, node, &value)) {
		store(field, at, value);
	}
}

/* ---- the document ---- */

/* Fills a study with what absent members mean; what its excitation does not use is 0. */
static void defaults(struct pound_study *study, const char *excitation)
{
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		if (strncmp(field->pattern, "/inputs/", 8) == 0 || strncmp(field->pattern, "/sweep/", 7) == 0)
			continue;
		bool absent = !isnan(field->absent) && fields_used(field, NULL, excitation);
		int copies = strncmp(field->pattern, "/scene/oscillators/*/", 21) == 0 ? POUND_OSCILLATORS : 1;
		for (int k = 0; k < copies; k++)
			store(field, (char *)study + field->offset + (size_t)k * sizeof study->scene.oscillators[0],
			      absent ? field->absent : 0.0);
	}
	study->scene.contact.present = true;
	if (study->scene.excitation.signals == 0)
		study->scene.excitation.signals = 1;
}

/* Kind and excitation decide which members there are, so they are looked up before anything is read. */
static void foresee(struct reader *r, const cJSON *document)
{
	const cJSON *kind = cJSON_GetObjectItemCaseSensitive(document, "kind");
	const cJSON *scene = cJSON_GetObjectItemCaseSensitive(document, "scene");
	const cJSON *excitation = cJSON_GetObjectItemCaseSensitive(scene, "excitation");
	const cJSON *type = cJSON_GetObjectItemCaseSensitive(excitation, "type");
	r->kind =
	    cJSON_IsString(kind) ? study_kind_name(fields_choice(study_kind_name, kind->valuestring)) : NULL;
	if (cJSON_IsString(type))
		r->excitation = pound_excitation_name(fields_choice(pound_excitation_name, type->valuestring));
	else if (!type)
		r->excitation = pound_excitation_name((int)fields_find("/scene/excitation/type")->absent);
}

static void outputs_default(struct pound_study *study)
{
	for (int k = 0; fields_outputs_absent[k]; k++) {
		int output = fields_choice(pound_output_name, fields_outputs_absent[k]);
		if (study_check_applies(study, output))
			study->outputs[study->n_outputs++] = output;
	}
}

static struct pound_study *block_create(size_t length)
{
	// an element takes two characters at least, and a text is never longer than its spelling
	size_t numbers = length / 2 + 1;
	struct block *block = calloc(1, sizeof *block + numbers * sizeof(double) + length + 1);
	if (!block)
		return NULL;
	block->study.inputs = block->inputs;
	block->study.sweeps = block->sweeps;
	return &block->study;
}

/* Reads a study document.
 *
 * Given    text      (length)  bytes   need not end with a zero
 * Returns  value     -         -       the study; NULL: problems->status says why
 *          problems  -         -       all that is wrong, in the order of the document, then what members mean together
 * Memory   allocates one block for study_free, about 5 bytes per byte of text
 *
 * Test     unit_study_json
 */
struct pound_study *study_from_json(const char *text, size_t length, struct problems *problems)
{
	struct gate_fault fault;
	problems_init(problems);
	cJSON *document = document_parse(text, length, &fault);
	if (!document && fault.line) {
		problems_add(problems, "", "%s", fault.detail);
		problems->status = PROBLEMS_MALFORMED;
		problems->line = fault.line;
		problems->column = fault.column;
		return NULL;
	}
	struct pound_study *study = document ? block_create(length) : NULL;
	if (!study) {
		problems->status = PROBLEMS_NOMEM;
		cJSON_Delete(document);
		return NULL;
	}
	struct reader r = {.problems = problems, .study = study, .number = ((struct block *)study)->numbers};
	r.text = (char *)(r.number + length / 2 + 1);
	foresee(&r, document);
	defaults(study, r.excitation);
	read_object(&r, "", document, (char *)study);
	cJSON_Delete(document);
	study_check(study, problems);
	if (problems->n) {
		study_free(study);
		return NULL;
	}
	if (study->n_outputs == 0)
		outputs_default(study);
	return study;
}

void study_free(struct pound_study *study)
{
	free(study);
}
