/* study_varied.c - reads what varies in a study: inputs with their distributions, ratios and groups of inputs, sweeps. */
#include <math.h>
#include <string.h>

#include "schema/study/field_types.h"
#include "schema/study/reader.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

/* Reads a list of a discrete distribution: its values, or their weights. */
static int read_list(struct reader *r, const char *pattern, const cJSON *node, const double **numbers)
{
	const struct field *list = fields_find(pattern);
	return reader_numbers(r, list, list + 1, node, numbers); // its element is the next row
}

/* Refuses a parameter that a distribution does not have, and suggests a related distribution with it: lognormal_cov for lognormal. */
static void refuse_parameter(struct reader *r, int type, const char *parameter)
{
	const char *name = pound_distribution_name(type), *related = NULL;
	for (int row = 0; pound_distribution_name(row); row++)
		for (int k = 0; pound_distribution_parameter(row, k); k++)
			if (strncmp(pound_distribution_name(row), name, strlen(name)) == 0 &&
			    strcmp(pound_distribution_parameter(row, k), parameter) == 0)
				related = pound_distribution_name(row);
	problems_add(r->problems, r->pointer,
	             related ? "is not used by distribution \"%s\"; \"%s\" has it"
	                     : "is not used by distribution \"%s\"",
	             name, related);
}

static void read_parameter(struct reader *r, struct pound_distribution *distribution, const cJSON *member,
                           int *n_weights)
{
	const bool lists = pound_distribution_lists_values(distribution->type);
	int k = 0;
	const char *name = pound_distribution_parameter(distribution->type, k);
	while (name && strcmp(name, member->string) != 0)
		name = pound_distribution_parameter(distribution->type, ++k);
	if (lists && strcmp(member->string, "values") == 0)
		distribution->n_values = read_list(r, "/inputs/*/distribution/values", member, &distribution->values);
	else if (lists && strcmp(member->string, "weights") == 0)
		*n_weights = read_list(r, "/inputs/*/distribution/weights", member, &distribution->weights);
	else if (!name)
		refuse_parameter(r, distribution->type, member->string);
	else if (!cJSON_IsNumber(member))
		reader_mistyped(r, "a number", member);
	else if (fabs(member->valuedouble) > POUND_PARAMETER_MAX)
		reader_mistyped(r, "a number between -1e100 and 1e100", member);
	else
		distribution->p[k] = member->valuedouble + 0.0;
}

static void require_parameter(struct reader *r, const cJSON *node, const char *name, const char *what)
{
	if (cJSON_GetObjectItemCaseSensitive(node, name))
		return;
	size_t length = reader_enter(r, name);
	problems_add(r->problems, r->pointer, "is required: %s", what);
	reader_leave(r, length);
}

/* Reads the parameters of a distribution of known type, and adds a problem for every rule that they break. */
static void read_parameters(struct reader *r, struct pound_distribution *distribution, const cJSON *node,
                            const cJSON *type)
{
	const cJSON *member;
	const char *text;
	int n_weights = 0;
	for (int k = 0; pound_distribution_parameter(distribution->type, k); k++)
		distribution->p[k] = NAN;
	cJSON_ArrayForEach(member, node)
	{
		if (member == type)
			continue;
		size_t length = reader_enter(r, member->string);
		if (reader_seen(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else
			read_parameter(r, distribution, member, &n_weights);
		reader_leave(r, length);
	}
	for (int k = 0; (text = pound_distribution_parameter(distribution->type, k)); k++)
		require_parameter(r, node, text, "a number");
	if (pound_distribution_lists_values(distribution->type))
		require_parameter(r, node, "values", "an array of numbers, ascending");
	if (n_weights && distribution->n_values && n_weights != distribution->n_values)
		problems_add(r->problems, r->pointer, "must have as many weights as values: %d, has %d",
		             distribution->n_values, n_weights);
	for (int k = 0; (text = pound_distribution_rule(distribution->type, k)); k++)
		if (pound_distribution_breaks(distribution, k))
			problems_add(r->problems, r->pointer, "%s", text);
}

/* Reads a distribution; the engine's table of distributions decides which members it has.
 *
 * Test     unit_study_cases
 */
void reader_distribution(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_distribution *distribution = &((struct pound_input *)base)->distribution;
	const cJSON *type = cJSON_GetObjectItemCaseSensitive(node, "type");
	if (!cJSON_IsObject(node)) {
		reader_mistyped_field(r, field, node);
	} else if (!type) {
		reader_require(r, node, field->pattern);
	} else {
		int before = r->problems->n;
		size_t length = reader_enter(r, "type");
		reader_value(r, fields_find("/inputs/*/distribution/type"), type, base);
		reader_leave(r, length);
		if (r->problems->n == before)
			read_parameters(r, distribution, node, type);
	}
}

/* The field of the scene that a path names; NULL: none, or it may not vary. */
static const struct field *varying(const char *path)
{
	struct field_place place;
	const struct field *field = path ? fields_scene(path, &place) : NULL;
	return field && fields_vary(field, false) ? field : NULL;
}

static void read_input(struct reader *r, const cJSON *element, int j)
{
	struct pound_input *input = &r->study->inputs[j];
	reader_object(r, "/inputs/*", element, (char *)input);
	input->name = input->name ? input->name : input->path;
	if (varying(input->path))
		input->field = study_check_field(input->path);
}

/* Reads the inputs; study_check.c checks their paths.
 *
 * Test     unit_study_json: what_a_document_says_is_in_the_study
 */
void reader_inputs(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	r->study->n_inputs = reader_each(r, field, node, read_input);
}

static void read_ratio(struct reader *r, const cJSON *element, int k)
{
	reader_object(r, "/ratios/*", element, (char *)&r->study->ratios[k]);
}

/* Reads the ratios; study_check.c checks that their paths name inputs.
 *
 * Test     unit_study_json: what_a_document_says_is_in_the_study
 */
void reader_ratios(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	r->study->n_ratios = reader_each(r, field, node, read_ratio);
}

/* Reads the two paths of the current ratio. */
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

static void read_group(struct reader *r, const cJSON *element, int k)
{
	reader_object(r, "/groups/*", element, (char *)&r->study->groups[k]);
}

/* Reads the groups of inputs; reader_groups_find finds their inputs.
 *
 * Test     unit_study_json: what_a_document_says_is_in_the_study
 */
void reader_groups(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	r->study->n_groups = reader_each(r, field, node, read_group);
}

/* Reads the paths of the current group. */
void reader_group(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_group *group = (struct pound_group *)base;
	group->n = reader_elements(r, field, node);
	const cJSON *element = group->n ? node->child : NULL;
	for (int k = 0; k < group->n; k++, element = element->next) {
		size_t length = reader_enter_element(r, k);
		reader_text(r, fields_find("/groups/*/of/*"), element, &group->of[k]);
		reader_leave(r, length);
	}
}

/* Finds the inputs of the groups after all inputs were read; study_check.c reports paths that name no input. */
void reader_groups_find(struct pound_study *study)
{
	for (int g = 0; g < study->n_groups; g++)
		for (int k = 0; k < study->groups[g].n; k++) {
			const char *of = study->groups[g].of[k];
			const int input = of ? pound_study_input(study, of) : -1;
			study->groups[g].inputs |= input >= 0 ? 1u << input : 0u;
		}
}

static void read_sweep(struct reader *r, const cJSON *element, int s)
{
	struct pound_sweep *sweep = &r->study->sweeps[s];
	const cJSON *path = cJSON_GetObjectItemCaseSensitive(element, "path");
	r->swept = varying(cJSON_GetStringValue(path));
	reader_object(r, "/sweep/*", element, (char *)sweep);
	if (r->swept)
		sweep->field = study_check_field(cJSON_GetStringValue(path));
}

/* Reads the sweeps, the path of each before its values, as the path decides their type.
 *
 * Test     unit_study_cases
 */
void reader_sweeps(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	r->study->n_sweeps = reader_each(r, field, node, read_sweep);
}

/* Reads the values of the current sweep, each by the row of the swept field.
 *
 * Test     unit_study_cases
 */
void reader_values(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_sweep *sweep = (struct pound_sweep *)base;
	if (!r->swept)
		return; // the path is invalid: reported by study_check.c
	sweep->n_values = reader_numbers(r, field, r->swept, node, &sweep->values);
	reader_distinct(r, sweep->values, sweep->n_values, "value");
}
