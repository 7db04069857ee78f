/* study_varied.c - what varies in a study: inputs with their distributions, their ratios, sweeps with their values. */
#include <math.h>
#include <string.h>

#include "schema/reader.h"
#include "schema/study_check.h"
#include "schema/study_json.h"

// the parameters of a discrete distribution: what stands for rows of fields.c
static const struct field list = {.pattern = "/inputs/*/distribution/values",
                                  .type = FIELD_LIST,
                                  .min = 1,
                                  .max = STUDY_VALUES_MAX,
                                  .ends = FIELD_CLOSED,
                                  .unit = "",
                                  .text = "its values, ascending, or their weights"};
static const struct field listed = {.pattern = "/inputs/*/distribution/values/*",
                                    .type = FIELD_REAL,
                                    .min = -INFINITY,
                                    .max = INFINITY,
                                    .ends = FIELD_OPEN,
                                    .unit = "",
                                    .text = "one of them"};

/* Reads a list of numbers; NULL: it is none. */
static const double *read_list(struct reader *r, const cJSON *node, int *n)
{
	*n = reader_elements(r, &list, node);
	const cJSON *number = *n ? node->child : NULL;
	double *numbers = r->number;
	for (int i = 0; i < *n; i++, number = number->next) {
		size_t length = reader_enter_element(r, i);
		reader_number(r, &listed, number, r->number++);
		reader_leave(r, length);
	}
	return *n ? numbers : NULL;
}

static void read_lists(struct reader *r, struct pound_distribution *distribution, const cJSON *node,
                       const cJSON *type)
{
	int n_weights = 0, before = r->problems->n;
	const cJSON *member;
	cJSON_ArrayForEach(member, node)
	{
		if (member == type)
			continue;
		size_t length = reader_enter(r, member->string);
		if (reader_seen(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else if (strcmp(member->string, "values") == 0)
			distribution->values = read_list(r, member, &distribution->n_values);
		else if (strcmp(member->string, "weights") == 0)
			distribution->weights = read_list(r, member, &n_weights);
		else
			problems_add(r->problems, r->pointer, "is not used by distribution \"%s\"",
			             pound_distribution_name(distribution->type));
		reader_leave(r, length);
	}
	if (!cJSON_GetObjectItemCaseSensitive(node, "values")) {
		size_t length = reader_enter(r, "values");
		problems_add(r->problems, r->pointer, "is required: an array of numbers, ascending");
		reader_leave(r, length);
	}
	if (r->problems->n == before && distribution->weights && n_weights != distribution->n_values)
		problems_add(r->problems, r->pointer, "there must be as many weights as values, %d, not %d",
		             distribution->n_values, n_weights);
	const char *fault = r->problems->n == before ? pound_distribution_fault(distribution) : NULL;
	if (fault)
		problems_add(r->problems, r->pointer, "%s", fault);
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
		reader_mistyped(r, "a number", member);
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
		size_t length = reader_enter(r, member->string);
		if (reader_seen(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else
			read_parameter(r, distribution, member);
		reader_leave(r, length);
	}
	for (int k = 0; pound_distribution_parameter(distribution->type, k); k++) {
		const char *name = pound_distribution_parameter(distribution->type, k);
		if (cJSON_GetObjectItemCaseSensitive(node, name))
			continue;
		size_t length = reader_enter(r, name);
		problems_add(r->problems, r->pointer, "is required: a number");
		reader_leave(r, length);
	}
	const char *fault = r->problems->n == before ? pound_distribution_fault(distribution) : NULL;
	if (fault)
		problems_add(r->problems, r->pointer, "%s", fault);
}

/* Reads a distribution; the engine's table says which members it has.
 *
 * Test     unit_study_json: members_are_known_once_and_used
 */
void reader_distribution(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_distribution *distribution = &((struct pound_input *)base)->distribution;
	const cJSON *type = cJSON_GetObjectItemCaseSensitive(node, "type");
	if (!cJSON_IsObject(node)) {
		reader_mistyped(r, "an object", node);
	} else if (!type) {
		reader_require(r, node, field->pattern);
	} else {
		int before = r->problems->n;
		size_t length = reader_enter(r, "type");
		reader_value(r, fields_find("/inputs/*/distribution/type"), type, base);
		reader_leave(r, length);
		if (r->problems->n == before)
			(pound_distribution_lists_values(distribution->type) ? read_lists : read_parameters)(
			    r, distribution, node, type);
	}
}

/* The field of the scene that a path names if it may vary, else NULL. */
static const struct field *varying(const char *path)
{
	int oscillator;
	const struct field *field = path ? fields_scene(path, &oscillator) : NULL;
	return field && !field->fixed && field->type < FIELD_SEED ? field : NULL;
}

/* Reads the inputs; what their paths mean in this scene is for study_check.c.
 *
 * Test     unit_study_json: what_a_document_says_is_in_the_study
 */
void reader_inputs(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	int n = reader_elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	r->study->n_inputs = n;
	for (int j = 0; j < n; j++, element = element->next) {
		struct pound_input *input = &r->study->inputs[j];
		size_t length = reader_enter_element(r, j);
		reader_object(r, "/inputs/*", element, (char *)input);
		input->name = input->name ? input->name : input->path;
		if (varying(input->path))
			input->field = study_check_field(input->path);
		reader_leave(r, length);
	}
}

/* Reads the ratios; whether their paths name inputs is for study_check.c.
 *
 * Test     unit_study_json: what_a_document_says_is_in_the_study
 */
void reader_ratios(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	int n = reader_elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	r->study->n_ratios = n;
	for (int k = 0; k < n; k++, element = element->next) {
		size_t length = reader_enter_element(r, k);
		reader_object(r, "/ratios/*", element, (char *)&r->study->ratios[k]);
		reader_leave(r, length);
	}
}

/* Reads the two paths of the ratio in hand. */
void reader_ratio(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	int n = reader_elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	for (int side = 0; side < n; side++, element = element->next) {
		size_t length = reader_enter_element(r, side);
		reader_text(r, fields_find("/ratios/*/of/*"), element, &((struct pound_ratio *)base)->of[side]);
		reader_leave(r, length);
	}
}

/* Reads the sweeps; their paths come first, as they say what the values are.
 *
 * Test     unit_study_check: a_sweep_takes_values_as_the_field_does
 */
void reader_sweeps(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	int n = reader_elements(r, field, node);
	const cJSON *element = n ? node->child : NULL;
	r->study->n_sweeps = n;
	for (int s = 0; s < n; s++, element = element->next) {
		struct pound_sweep *sweep = &r->study->sweeps[s];
		const cJSON *path = cJSON_GetObjectItemCaseSensitive(element, "path");
		r->swept = varying(cJSON_GetStringValue(path));
		size_t length = reader_enter_element(r, s);
		reader_object(r, "/sweep/*", element, (char *)sweep);
		if (r->swept)
			sweep->field = study_check_field(cJSON_GetStringValue(path));
		reader_leave(r, length);
	}
}

/* Reads the values of the sweep in hand, each as the swept field itself is read.
 *
 * Test     unit_study_check: a_sweep_takes_values_as_the_field_does
 */
void reader_values(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_sweep *sweep = (struct pound_sweep *)base;
	int n =
	    r->swept ? reader_elements(r, field, node) : 0; // else the path is the problem, told by study_check.c
	const cJSON *element = n ? node->child : NULL;
	sweep->values = r->number;
	sweep->n_values = n;
	for (int i = 0; i < n; i++, element = element->next) {
		size_t length = reader_enter_element(r, i);
		if (reader_number(r, r->swept, element, r->number++))
			for (int k = i - 1; k >= 0; k--)
				if (sweep->values[k] == sweep->values[i]) {
					problems_add(r->problems, r->pointer, "is the same as value %d", k);
					break;
				}
		reader_leave(r, length);
	}
}
