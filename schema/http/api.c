/* api.c - the HTTP interface of poundd: operations, their arguments and errors. */
#include "schema/http/api.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/figure.h"
#include "schema/result/result_json.h"
#include "schema/study/fields.h"
#include "schema/study/near_name.h"
#include "schema/study/study_json.h"

const struct api_fault_row api_faults[] = {
#define X(name, status, type, title) [API_##name] = {status, type, title},
    API_FAULTS(X)
#undef X
};

#define F(name) (1u << API_##name)
const unsigned api_faults_of_all = F(BAD_REQUEST) | F(UNAUTHORIZED) | F(NO_LENGTH) | F(TOO_LARGE) |
                                   F(TARGET_LONG) | F(MISDIRECTED) | F(HEAD_LARGE) | F(UNAVAILABLE);

// clang-format off
#define BODY   (F(MALFORMED) | F(NOT_JSON) | F(INVALID) | F(TOO_COSTLY) | F(KEY_REUSED) | F(TOO_MANY) | F(FOREIGN))
#define STORED (F(NOT_FOUND) | F(CORRUPT))
#define BRIDGED (F(FOREIGN) | F(CORRUPT))
#define TABLE(name) " " #name
#define TABLES RESULT_TABLES(TABLE) " "
#define NAMES FIGURES(TABLE) " "

const struct api_operation api_operations[] = {
	[API_submit]  = {"POST", "/v1/studies", "submit",
	                 "submits a study; the answer is sent when the study is on disk", " 201=Status 200=Estimate ", .faults = BODY, .takes_study = true},
	[API_list]    = {"GET", "/v1/studies", "list", "lists studies, newest first", " 200=Page ", .faults = 0},
	[API_status]  = {"GET", "/v1/studies/{id}", "status", "status and progress of a study", " 200=Status 304 ", .faults = F(NOT_FOUND)},
	[API_erase]   = {"DELETE", "/v1/studies/{id}", "erase",
	                 "deletes a study; one that has not ended is canceled first", " 204 ", .faults = F(NOT_FOUND) | F(FOREIGN)},
	[API_posted]  = {"GET", "/v1/studies/{id}/request", "posted",
	                 "the study document as posted", " 200=Study 304 ", .faults = STORED},
	[API_results] = {"GET", "/v1/studies/{id}/results", "results",
	                 "the result of a study", " 200=Result 304 ", .media = " text/csv ", .faults = STORED | F(NOT_READY) | F(CONFLICT)},
	[API_samples] = {"GET", "/v1/studies/{id}/samples", "samples",
	                 "all rows of inputs with their outputs, enough to recompute the raw indices", " 200 304 ",
	                 .media = " text/csv application/octet-stream ", .faults = STORED | F(NOT_READY) | F(CONFLICT)},
	[API_motions] = {"GET", "/v1/studies/{id}/motions", "motions",
	                 "the ground motions of a study, computed again, or their response spectra", " 200 304 ",
	                 .media = " text/csv application/octet-stream text/plain ", .faults = STORED | F(CONFLICT)},
	[API_figures] = {"GET", "/v1/studies/{id}/figures", "figures",
	                 "the figures available for the result", " 200=Figures 304 ", .faults = STORED | F(NOT_READY) | F(CONFLICT)},
	[API_figure]  = {"GET", "/v1/studies/{id}/figures/{name}", "figure",
	                 "a figure of the result", " 200 304 ", .media = " image/svg+xml ", .faults = STORED | F(NOT_READY) | F(CONFLICT)},
	[API_cancel]  = {"POST", "/v1/studies/{id}/cancel", "cancel",
	                 "cancels a queued or running study", " 200=Status ", .faults = F(NOT_FOUND) | F(CONFLICT) | F(FOREIGN)},
	[API_records_put] = {"PUT", "/v1/records/{sha256}", "records_put",
	                    "stores a file of a recorded ground motion, until the last study that names it is deleted; without one for an hour", " 201 204 ", .faults = F(FOREIGN)},
	[API_records_get] = {"GET", "/v1/records/{sha256}", "records_get", "a stored file of a recorded ground motion", " 200 304 ", .media = " application/octet-stream ", .faults = STORED},
	[API_live]    = {"GET", "/livez", "live", "liveness: the process answers", " 200=Version ", .open = true},
	[API_ready]   = {"GET", "/readyz", "ready", "readiness: the server accepts studies", " 200=Version ", .open = true},
	[API_metrics] = {"GET", "/metrics", "metrics", "counters and gauges in the Prometheus text format", " 200 ", .media = " text/plain "},
	[API_version] = {"GET", "/version", "version", "name and version of the server", " 200=Version ", .faults = 0},
	[API_bridge_info]    = {"GET", "/Info", "bridge_info", "UM-Bridge: protocol and models", " 200=BridgeInfo ", .faults = 0},
	[API_bridge_model]   = {"POST", "/ModelInfo", "bridge_model", "UM-Bridge: what a model supports", " 200=BridgeModel 400=BridgeFault ", .faults = BRIDGED},
	[API_bridge_inputs]  = {"POST", "/InputSizes", "bridge_inputs", "UM-Bridge: sizes of a model's input vectors", " 200=BridgeInputs 400=BridgeFault ", .faults = BRIDGED},
	[API_bridge_outputs] = {"POST", "/OutputSizes", "bridge_outputs", "UM-Bridge: sizes of a model's output vectors", " 200=BridgeOutputs 400=BridgeFault ", .faults = BRIDGED},
	[API_bridge_evaluate]  = {"POST", "/Evaluate", "bridge_evaluate", "UM-Bridge: outputs of a model", " 200=BridgeOutput 400=BridgeFault 500=BridgeFault ", .faults = BRIDGED},
	[API_bridge_gradient]  = {"POST", "/Gradient", "bridge_gradient", "UM-Bridge: not supported", " 400=BridgeFault ", .faults = BRIDGED},
	[API_bridge_jacobian]  = {"POST", "/ApplyJacobian", "bridge_jacobian", "UM-Bridge: not supported", " 400=BridgeFault ", .faults = BRIDGED},
	[API_bridge_hessian]   = {"POST", "/ApplyHessian", "bridge_hessian", "UM-Bridge: not supported", " 400=BridgeFault ", .faults = BRIDGED},
	[API_example_list] = {"GET", "/v1/examples", "example_list", "names and titles of the example studies", " 200=Examples 304 ", .faults = 0},
	[API_example] = {"GET", "/v1/examples/{name}", "example", "an example study document", " 200=Study 304 ", .faults = F(NOT_FOUND)},
	[API_home]    = {"GET", "/", "home", "the page that lists studies, for browsers", " 200 304 ", .media = " text/html ", .open = true},
	[API_new]     = {"GET", "/new", "new", "the page that makes a study", " 200 304 ", .media = " text/html ", .open = true},
	[API_study]   = {"GET", "/studies/{id}", "study", "the page of a study", " 200 304 ", .media = " text/html ", .open = true},
	[API_style]   = {"GET", "/page.css", "style", "style sheet of the pages", " 200 304 ", .media = " text/css ", .open = true},
	[API_script]  = {"GET", "/page.js", "script", "script of the pages", " 200 304 ", .media = " text/javascript ", .open = true},
	[API_icon]    = {"GET", "/icon.svg", "icon", "icon of the pages", " 200 304 ", .media = " image/svg+xml ", .open = true},
	[API_openapi] = {"GET", "/v1/openapi.json", "openapi", "this document", " 200=OpenAPI 304 ", .faults = 0},
};

/* Arguments of the list, and of its page, whose script passes them to the list. */
#define LISTED(operation) \
	{operation, "status",          "query",  " queued running succeeded failed cancelled ", 0, 0, NULL, .text = "only studies with this status", .blank = true}, \
	{operation, "limit",           "query",  NULL, 1, 100, "20", .text = "number of studies per page", .blank = true}, \
	{operation, "cursor",          "query",  NULL, 0, 0, NULL, .text = "member `next` of the previous page", .digits = 16, .blank = true}, \
	{operation, "name",            "query",  NULL, 0, 0, NULL, .text = "only studies with this text in their name; case matters", .blank = true}, \
	{operation, "hash",            "query",  NULL, 0, 0, NULL, .text = "only studies with this study_hash: the same study, whatever its name and form", .digits = 64, .blank = true}

const struct api_argument api_arguments[] = {
	{NULL,      "id",              "path",   NULL, 0, 0, NULL, .text = "id of the study: 16 hexadecimal digits", .digits = 16},
	{"records_put", "sha256",      "path",   NULL, 0, 0, NULL, .text = "SHA-256 of the body: 64 hexadecimal digits", .digits = 64},
	{"records_get", "sha256",         "path",   NULL, 0, 0, NULL, .text = "SHA-256 of the file: 64 hexadecimal digits", .digits = 64},
	{"records_get", "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"submit",  "validate_only",   "query",  " true false ", 0, 0, "false", .text = "true: checks the study and estimates its cost; nothing is stored"},
	{"submit",  "Idempotency-Key", "header", NULL, 0, 0, NULL, .text = "1 to 200 characters of UTF-8; repeating a request with the same key and body returns the first study"},
	LISTED("list"),
	{"status",  "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"status",  "Prefer",          "header", NULL, 0, 0, NULL, .text = "wait=N: with If-None-Match, waits for a change up to N seconds or the limit of the server"},
	{"posted",  "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"results", "partial",         "query",  " true false ", 0, 0, "false", .text = "true: if there is no result yet, or the study failed or was cancelled, use the rows completed so far"},
	{"results", "format",          "query",  " json csv ", 0, 0, NULL, .text = "format of the answer; takes precedence over Accept"},
	{"results", "table",           "query",  TABLES, 0, 0, NULL, .text = "which table of a result, as CSV (default: the first of its kind, such as inputs)"},
	{"results", "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"samples", "format",          "query",  " csv npy ", 0, 0, NULL, .text = "format of the answer; takes precedence over Accept"},
	{"samples", "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"motions", "format",          "query",  " csv npy at2 ", 0, 0, NULL, .text = "format of the answer; takes precedence over Accept; at2: one signal as a PEER file"},
	{"motions", "cell",            "query",  NULL, 0, STUDY_CELLS_MAX - 1, "0", .text = "cell of the sweeps"},
	{"motions", "row",             "query",  NULL, 1, POUND_ROWS_MAX, "1", .text = "row of the design"},
	{"motions", "signal",          "query",  NULL, 0, POUND_ROWS_MAX, NULL, .text = "one signal (default: all; format at2: the first)"},
	{"motions", "periods",         "query",  NULL, 0, 0, NULL, .text = "response spectra instead, as CSV: up to 100 periods in seconds between commas, of oscillators with 5 % damping"},
	{"motions", "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"figures", "partial",         "query",  " true false ", 0, 0, "false", .text = "true: if there is no result yet, or the study failed or was cancelled, use the rows completed so far"},
	{"figures", "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"figure",  "name",            "path",   NAMES, 0, 0, NULL, .text = "name of the figure"},
	{"figure",  "partial",         "query",  " true false ", 0, 0, "false", .text = "true: if there is no result yet, or the study failed or was cancelled, use the rows completed so far"},
	{"figure",  "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
#define X(name, values, lowest, highest, meaning) {"figure", #name, "query", values, lowest, highest, NULL, .text = meaning},
	FIGURE_ARGUMENTS(X)
#undef X
	{"example", "name",            "path",   NULL, 0, 0, NULL, .text = "name of the example"},
	{"example_list", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"example", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	LISTED("home"),
	{"home", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"new", "from", "query", NULL, 0, 0, NULL, .text = "id of a study whose document is the start", .digits = 16},
	{"new", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
#define X(name, values, lowest, highest, meaning) {"study", #name, "query", values, lowest, highest, NULL, .text = meaning},
	FIGURE_ARGUMENTS(X)
#undef X
	{"study", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"style", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"script", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"icon", "If-None-Match", "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
	{"openapi", "If-None-Match",   "header", NULL, 0, 0, NULL, .text = "a previous ETag; the answer is 304 if nothing has changed"},
};
// clang-format on
const int api_arguments_count = sizeof api_arguments / sizeof api_arguments[0];

const struct api_argument *api_argument(int operation, const char *name, const char *place)
{
	for (int i = 0; i < api_arguments_count; i++) {
		const struct api_argument *argument = &api_arguments[i];
		if (argument->operation && !strcmp(argument->operation, api_operations[operation].name) &&
		    !strcmp(argument->name, name) && !strcmp(argument->place, place))
			return argument;
	}
	return NULL;
}

void api_names(int operation, const char *place, char *text, size_t size)
{
	size_t n = 0;
	*text = '\0';
	for (int i = 0; i < api_arguments_count && n < size; i++) {
		const struct api_argument *argument = &api_arguments[i];
		if (argument->operation && !strcmp(argument->operation, api_operations[operation].name) &&
		    !strcmp(argument->place, place))
			n += (size_t)snprintf(text + n, size - n, "%s%s", n ? ", " : "", argument->name);
	}
}

void api_expected(const struct api_argument *argument, char *text, size_t size)
{
	if (argument->max > 0)
		snprintf(text, size, "a whole number in [%d, %d]", argument->min, argument->max);
	else if (argument->digits > 0)
		snprintf(text, size, "%d hexadecimal digits", argument->digits);
	else if (argument->choices)
		snprintf(text, size, "one of%.*s", (int)strlen(argument->choices) - 1, argument->choices);
	else
		snprintf(text, size, "%s", argument->text);
}

/* Whether the value of an argument is valid.
 *
 * Test     unit_api: an_argument_takes_what_it_says
 */
bool api_takes(const struct api_argument *argument, const char *value)
{
	char *rest;
	if (!*value)
		return argument->blank;
	if (argument->choices)
		return !strchr(value, ' ') && fields_listed(argument->choices, value);
	if (argument->digits > 0)
		return strlen(value) == (size_t)argument->digits &&
		       strspn(value, "0123456789abcdef") == strlen(value);
	if (argument->max == 0)
		return true;
	long number = strtol(value, &rest, 10);
	return *value >= '0' && *value <= '9' && !*rest && number >= argument->min && number <= argument->max;
}

/* Test     unit_api: a_misspelt_choice_has_a_nearest_one */
const char *api_nearest(const struct api_argument *argument, const char *value, char nearest[API_CHOICE_SIZE])
{
	int best = 1000;
	for (const char *at = argument->choices; at && at[1]; at += 1 + strcspn(at + 1, " ")) {
		char choice[API_CHOICE_SIZE];
		snprintf(choice, sizeof choice, "%.*s", (int)strcspn(at + 1, " "), at + 1);
		const int distance = near_name_distance(value, choice);
		if (distance < best) {
			best = distance;
			memcpy(nearest, choice, sizeof choice);
		}
	}
	return near_name(best, value) ? nearest : NULL;
}

/* The id in the 16 hexadecimal digits at `text`; -1: invalid. */
static long long id_at(const char *text)
{
	char digits[17] = {0};
	if (strspn(text, "0123456789abcdef") < 16)
		return -1;
	memcpy(digits, text, 16);
	long long id = (long long)strtoull(digits, NULL, 16);
	return id < 0 ? -1 : id;
}

/* Whether a path matches an operation's path, and the id in it. */
static bool matches(const char *path, int operation, long long *id)
{
	const char *form = api_operations[operation].path;
	size_t head = strcspn(form, "{");
	if (form[head] && !strncmp(path, form, head) && !strncmp(form + head, "{id}", 4)) {
		if ((*id = id_at(path + head)) < 0)
			return false;
		path += head + 16;
		form += head + strlen("{id}");
		head = strcspn(form, "{");
	}
	if (!form[head])
		return !strcmp(path, form);
	char name[16];
	snprintf(name, sizeof name, "%.*s", (int)strcspn(form + head + 1, "}"), form + head + 1);
	return !strncmp(path, form, head) && api_takes(api_argument(operation, name, "path"), path + head);
}

/* Finds the operation of a request.
 *
 * Given    method   as received; HEAD counts as GET
 *          path     decoded, without arguments
 * Returns  id       of the study in the path, 0: none
 *          allow    methods of the path, for the header Allow; "": no such path
 *          value    row of api_operations, -1: none
 * Test     unit_api: a_path_is_one_of_the_table_to_the_last_character
 */
int api_match(const char *method, const char *path, long long *id, char allow[64])
{
	int found = -1;
	if (!strcmp(method, "HEAD"))
		method = "GET";
	*id = 0;
	*allow = '\0';
	for (int i = 0; i < API_N_OPERATIONS; i++) {
		const struct api_operation *operation = &api_operations[i];
		long long here = 0;
		if (!matches(path, i, &here))
			continue;
		*id = here;
		if (!strcmp(method, operation->method))
			found = i;
		strcat(strcat(allow, *allow ? ", " : ""), operation->method);
		strcat(allow, !strcmp(operation->method, "GET") ? ", HEAD" : "");
	}
	return found;
}

/* The body of an error response.
 *
 * Given    fault      kind of error
 *          detail     a sentence about this request
 *          problems   listed in it; NULL: none
 * Returns  value      (length) bytes of application/problem+json; NULL: out of memory
 * Memory   allocates; the caller frees
 */
char *api_problem(enum api_fault fault, const char *detail, const struct problems *problems, size_t *length)
{
	const struct problem_head head = {.status = api_faults[fault].status,
	                                  .type = api_faults[fault].type,
	                                  .title = api_faults[fault].title,
	                                  .detail = detail};
	return problem_to_json(&head, problems, length);
}
