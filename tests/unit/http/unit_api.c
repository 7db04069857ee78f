/* The table of operations, and the OpenAPI document against the reader of studies. */
#include <math.h>
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/http/api.h"
#include "schema/http/http_head.h"
#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/jsonschema.h"

static const char STUDY[] = "/components/schemas/Study";

static struct reading *document(void)
{
	size_t length;
	char *text = api_document(&length);
	assert_non_null(text);
	struct reading *reading = reading_open(text, length);
	assert_non_null(reading);
	free(text);
	return reading;
}

static void a_path_is_one_of_the_table_to_the_last_character(void **state)
{
	static const struct {
		const char *method, *path, *allow;
		int operation;
		long long id;
	} cases[] = {
	    {"GET", "/v1/studies", "POST, GET, HEAD", API_list, 0},
	    {"HEAD", "/v1/studies", "POST, GET, HEAD", API_list, 0},
	    {"POST", "/v1/studies", "POST, GET, HEAD", API_submit, 0},
	    {"PUT", "/v1/studies", "POST, GET, HEAD", -1, 0},
	    {"get", "/v1/studies", "POST, GET, HEAD", -1, 0},
	    {"GET", "/v1/studies/", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000ff", "GET, HEAD, DELETE", API_status, 255},
	    {"DELETE", "/v1/studies/00000000000000ff", "GET, HEAD, DELETE", API_erase, 255},
	    {"GET", "/v1/studies/00000000000000ff/results", "GET, HEAD", API_results, 255},
	    {"GET", "/v1/studies/00000000000000FF", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000f", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000fff", "", -1, 0},
	    {"GET", "/v1/studies/80000000000000ff", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000ff/", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000ff/figures", "GET, HEAD", API_figures, 255},
	    {"GET", "/v1/studies/00000000000000ff/figures/swept", "GET, HEAD", API_figure, 255},
	    {"GET", "/v1/studies/00000000000000ff/figures/", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000ff/figures/swep", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000ff/figures/swept/", "", -1, 0},
	    {"GET", "/v1/studies/00000000000000ff/figures/swept given", "", -1, 0},
	    {"GET", "/v1/studies/{id}", "", -1, 0},
	    {"GET", "", "", -1, 0},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char allow[64];
		long long id = -1;
		int operation = api_match(cases[i].method, cases[i].path, &id, allow);
		if (operation != cases[i].operation || strcmp(allow, cases[i].allow) != 0 || id != cases[i].id)
			fail_msg("%s %s: operation %d, '%s', id %lld", cases[i].method, cases[i].path, operation, allow,
			         id);
	}
}

static void a_misspelt_choice_has_a_nearest_one(void **state)
{
	const struct api_argument *table = api_argument(API_results, "table", "query");
	char text[512], nearest[API_CHOICE_SIZE];
	(void)state;
	assert_string_equal(api_nearest(table, "inptus", nearest), "inputs");
	assert_string_equal(api_nearest(table, "record", nearest), "records");
	assert_null(api_nearest(table, "elephant", nearest));
	assert_null(api_nearest(api_argument(API_list, "limit", "query"), "x", nearest));
	// the whole list is in the answer
	struct head head = {.fault = API_NO_FAULT};
	head_argument(&head, API_results, "table", "inptus");
	api_expected(table, text, sizeof text);
	assert_non_null(strstr(head.detail, text));
	assert_non_null(strstr(text, " records"));
	assert_non_null(strstr(head.detail, "; did you mean inputs?"));
}

static void an_argument_takes_what_it_says(void **state)
{
	static const struct {
		int operation;
		const char *name, *value;
		bool taken;
	} cases[] = {
	    {API_submit, "validate_only", "true", true},
	    {API_submit, "validate_only", "", false},
	    {API_submit, "validate_only", "TRUE", false},
	    {API_submit, "validate_only", "true false", false},
	    {API_list, "limit", "1", true},
	    {API_list, "limit", "100", true},
	    {API_list, "limit", "0", false},
	    {API_list, "limit", "101", false},
	    {API_list, "limit", "", true},
	    {API_list, "status", "", true},
	    {API_list, "cursor", "", true},
	    {API_list, "cursor", "0123456789abcdef", true},
	    {API_list, "cursor", "0123456789abcdeF", false},
	    {API_list, "cursor", "0123456789abcde", false},
	    {API_list, "cursor", "0123456789abcdef0", false},
	    {API_list, "hash", "0123456789abcdef", false},
	    {API_list, "hash", "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef", true},
	    {API_list, "name", "' OR 1=1 --", true},
	    {API_list, "limit", "1x", false},
	    {API_list, "limit", " 1", false},
	    {API_list, "limit", "+1", false},
	    {API_list, "limit", "99999999999999", false},
	    {API_list, "status", "failed", true},
	    {API_list, "status", "fail", false},
	    {API_results, "format", "npy", false},
	    {API_results, "format", "", false},
	    {API_results, "partial", "", false},
	    {API_samples, "format", "npy", true},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct api_argument *argument = api_argument(cases[i].operation, cases[i].name, "query");
		assert_non_null(argument);
		if (api_takes(argument, cases[i].value) != cases[i].taken)
			fail_msg("%s=%s", cases[i].name, cases[i].value);
		// the default is valid, too
		assert_true(!argument->absent || api_takes(argument, argument->absent));
	}
	struct reading *api = document();
	for (int i = 0; i < 5; i++)
		assert_true(reading_has(api, "/paths/~1v1~1studies/get/parameters/%d/allowEmptyValue", i));
	assert_false(reading_has(api, "/paths/~1v1~1studies/post/parameters/0/allowEmptyValue"));
	reading_close(api);
	assert_null(api_argument(API_live, "limit", "query"));
	assert_null(api_argument(API_list, "Prefer", "query"));
}

static void every_example_of_the_document_is_what_its_schema_says(void **state)
{
	struct reading *api = document();
	struct jsonschema_fault fault;
	const char *name;
	int n = 0;
	(void)state;
	for (int i = 0; examples[i].name; i++) {
		static struct problems problems;
		struct pound_study *whole = study_from_json(examples[i].text, strlen(examples[i].text), &problems);
		if (!whole) // a design only
			continue;
		n++;
		study_free(whole);
		struct reading *study = reading_open(examples[i].text, strlen(examples[i].text));
		if (!jsonschema_takes(api, STUDY, study, "", &fault))
			fail_msg("%s: %s %s", examples[i].name, fault.pointer, fault.text);
		reading_close(study);
	}
	assert_int_equal(
	    n, reading_count(api, "/paths/~1v1~1studies/post/requestBody/content/application~1json/examples"));
	for (int i = 0; (name = reading_member(api, i, "/components/schemas")); i++) {
		char schema[96], example[128];
		snprintf(schema, sizeof schema, "/components/schemas/%s", name);
		snprintf(example, sizeof example, "%s/example", schema);
		if (reading_has(api, "%s", example) && !jsonschema_takes(api, schema, api, example, &fault))
			fail_msg("%s: %s %s", name, fault.pointer, fault.text);
	}
	reading_close(api);
}

static void every_reference_of_the_document_leads_somewhere(void **state)
{
	static const char start[] = "\"$ref\": \"#";
	size_t length;
	char *text = api_document(&length);
	struct reading *api = document();
	int n = 0;
	(void)state;
	for (char *at = strstr(text, start); at; at = strstr(at + 1, start), n++) {
		char path[128];
		snprintf(path, sizeof path, "%.*s", (int)strcspn(at + strlen(start), "\""), at + strlen(start));
		if (!reading_has(api, "%s", path))
			fail_msg("%s is not there", path);
	}
	assert_true(n > 50);
	reading_close(api);
	free(text);
}

/* A study with one member's text replaced, validated by schema and reader. */
static void judged_alike(const struct reading *api, const char *study, const char *what, bool valid)
{
	static struct problems problems;
	struct jsonschema_fault fault = {0};
	struct reading *value = reading_open(study, strlen(study));
	assert_non_null(value);
	bool taken = jsonschema_takes(api, STUDY, value, "", &fault);
	struct pound_study *read = study_from_json(study, strlen(study), &problems);
	if (taken != valid || (read != NULL) != valid)
		fail_msg("%s: the schema says %s (%s %s), the reader %s (%s %s)\n%s", what, taken ? "yes" : "no",
		         fault.pointer, fault.text, read ? "yes" : "no", problems.n ? problems.list[0].pointer : "",
		         problems.n ? problems.list[0].detail : "", study);
	if (read)
		study_free(read);
	reading_close(value);
}

/* Every number of contacts and oscillators, at the ends of its range and beyond. */
static void the_schema_and_the_reader_take_and_refuse_the_same_studies(void **state)
{
	struct reading *api = document();
	int n = 0;
	(void)state;
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		bool plain = !strncmp(field->pattern, "/scene/contact/", 15) ||
		             !strncmp(field->pattern, "/scene/oscillators/*/", 21);
		if (!plain || field->type != FIELD_REAL || strstr(field->pattern, "/law/"))
			continue;
		double inside = isfinite(field->max) ? 0.5 * (field->min + field->max) : field->min + 1;
		const struct {
			double value;
			bool valid;
		} cases[] = {{inside, true},
		             {field->min - 1, isinf(field->min)},
		             {field->min, !(field->ends & FIELD_OPEN_MIN)},
		             {field->max, !(field->ends & FIELD_OPEN_MAX)},
		             {field->max + 1, isinf(field->max)}};
		for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
			char study[512];
			const char *name = fields_name(field);
			if (!isfinite(cases[k].value))
				continue;
			const bool contact = strstr(field->pattern, "contact") != NULL;
			const bool frequency = !strcmp(name, "frequency_hz");
			// a contact model that reads the member, with the other members that this model requires
			char model[128] = "\"gap_m\": 0";
			if (contact) {
				int row = 0;
				while (!pound_contact_reads(row, name))
					row++;
				snprintf(model, sizeof model, "\"model\": \"%s\", %s\"%s\": %.17g", pound_contact_name(row),
				         !strcmp(name, "second_stiffness_ratio") ? "\"yield_overlap_m\": 0.001, " : "", name,
				         cases[k].value);
			}
			snprintf(study, sizeof study,
			         "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{%s\"%s\": %.17g}, "
			         "{\"frequency_hz\": 3}], \"contact\": {%s}}, \"solver\": {\"method\": \"adaptive\"}}",
			         frequency || contact ? "" : "\"frequency_hz\": 2, ", contact ? "frequency_hz" : name,
			         contact ? 2 : cases[k].value, model);
			judged_alike(api, study, field->pattern, cases[k].valid);
			n++;
		}
	}
	printf("%d studies judged alike\n", n);
	assert_true(n >= 20);
	reading_close(api);
}

static void both_refuse_what_is_misspelt_mistyped_or_missing(void **state)
{
	static const struct {
		const char *study;
		bool valid;
	} cases[] = {
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	     "3}]}}",
	     true},
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"rigid_wall\": "
	     "true}]}}",
	     true},
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	     "3}], \"contact\": null}}",
	     true},
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {}]}}", false},
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}]}}", false},
	    {"{\"kind\": \"reply\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	     "3}]}}",
	     false},
	    {"{\"kind\": \"response\", \"scen\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	     "3}]}}",
	     false},
	    {"{\"kind\": \"response\"}", false},
	    {"{\"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}]}}", false},
	    {"[]", false},
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": \"2\"}, "
	     "{\"frequency_hz\": 3}]}}",
	     false},
	    {"{\"kind\": \"response\", \"design\": {\"seed\": \"18446744073709551615\"}, \"scene\": "
	     "{\"oscillators\": "
	     "[{\"frequency_hz\": 2}, {\"frequency_hz\": 3}]}}",
	     true},
	    {"{\"kind\": \"response\", \"design\": {\"seed\": -1}, \"scene\": {\"oscillators\": "
	     "[{\"frequency_hz\": 2}, "
	     "{\"frequency_hz\": 3}]}}",
	     false},
	    {"{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"linier\"}, \"oscillators\": "
	     "[{\"frequency_hz\": 2}, "
	     "{\"frequency_hz\": 3}]}}",
	     false},
	};
	struct reading *api = document();
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		judged_alike(api, cases[i].study, "case", cases[i].valid);
	reading_close(api);
}

CHECK_MAIN(cmocka_unit_test(a_path_is_one_of_the_table_to_the_last_character),
           cmocka_unit_test(a_misspelt_choice_has_a_nearest_one),
           cmocka_unit_test(an_argument_takes_what_it_says),
           cmocka_unit_test(every_example_of_the_document_is_what_its_schema_says),
           cmocka_unit_test(every_reference_of_the_document_leads_somewhere),
           cmocka_unit_test(the_schema_and_the_reader_take_and_refuse_the_same_studies),
           cmocka_unit_test(both_refuse_what_is_misspelt_mistyped_or_missing))
