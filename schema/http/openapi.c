/* openapi.c - the OpenAPI 3.0 document: paths from the rows of api.c, responses from the rows here, the study document from the
 * rows of fields.c (study_schema.c). */
#include <stdio.h>
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/http/api.h"
#include "schema/json/json_writer.h"
#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "schema/study/study_schema.h"

/* Members of response objects.  A type is a JSON type, the name of another object, or [NAME]: an array of such values. */
struct member {
	const char *object, *name, *type;
	const char *note; /* "null": may be null; "absent": may be absent */
	const char *text;
};

// clang-format off
static const struct member members[] = {
	{"Status", "id",          "string",  "",     "16 hexadecimal digits"},
	{"Status", "name",        "string",  "null", "name in the study document"},
	{"Status", "kind",        "string",  "",     "kind of study"},
	{"Status", "status",      "string",  "",     "queued, running, succeeded, failed or cancelled"},
	{"Status", "progress",    "number",  "",     "fraction done, 0 to 1"},
	{"Status", "runs_done",   "integer", "",     "pounding runs computed and stored"},
	{"Status", "runs_total",  "integer", "",     "pounding runs requested"},
	{"Status", "eta_s",       "number",  "null", "estimated time to the end of a running study [s]"},
	{"Status", "cpu_s",       "number",  "",     "CPU time of its stored runs so far [s of one core]"},
	{"Status", "estimated_cpu_s", "number", "null", "CPU time estimated at submission [s of one core]; null: submitted to a version that did not store it"},
	{"Status", "over_estimate", "boolean", "",   "whether cpu_s is three times estimated_cpu_s or more"},
	{"Status", "queue_position", "integer", "null", "place of a queued study in the queue, 1: the next to run"},
	{"Status", "expected_start", "string", "null", "when a queued study is expected to start, by the estimates of those before it, RFC 3339, UTC"},
	{"Status", "created",     "string",  "",     "time of submission, RFC 3339, UTC"},
	{"Status", "started",     "string",  "null", "time of the start of computation, RFC 3339, UTC"},
	{"Status", "finished",    "string",  "null", "time of the end, RFC 3339, UTC"},
	{"Status", "error",       "string",  "null", "why the study failed: poison-study, out-of-memory-or-crash, timeout, cpu-limit, or a sentence with another reason"},
	{"Status", "links",       "Links",   "",     "paths of related resources"},
	{"Links",  "self",        "string",  "",     "path of this object"},
	{"Links",  "request",     "string",  "",     "path of the study document as posted"},
	{"Links",  "results",     "string",  "",     "path of the result"},
	{"Links",  "samples",     "string",  "",     "path of the samples: every row of inputs with its outputs"},
	{"Links",  "cancel",      "string",  "",     "path to POST to cancel the study"},
	{"Page",   "studies",     "[Status]", "",    "newest first"},
	{"Page",   "next",        "string",  "null", "cursor of the next page; null on the last"},
	{"Estimate", "kind",            "string",  "", "kind of study"},
	{"Estimate", "study_hash",      "string",  "", "hash of the study's meaning, as in its result; the list takes it as `hash`"},
	{"Estimate", "runs_total",      "integer", "", "pounding runs requested"},
	{"Estimate", "estimated_cpu_s", "number",  "", "estimated CPU time [s of one core]"},
	{"Estimate", "estimated_cpu_s_high", "number", "", "CPU time that 97 of 100 studies with such contacts do not exceed [s of one core]"},
	{"Estimate", "estimated_bytes", "number",  "", "estimated size in the database [bytes]"},
	{"Estimate", "estimated_memory_bytes", "number", "", "estimated memory while it runs [bytes]"},
	{"Estimate", "warnings", "[Fault]", "absent", "valid but probably unintended settings"},
	{"Figures", "figures",    "[Figure]", "",    "in the order of the table of figures"},
	{"Figure",  "name",       "string",  "",     "name of the figure, the end of its path"},
	{"Figure",  "title",      "string",  "",     "what it shows"},
	{"Figure",  "arguments",  "[string]", "",    "names of the query arguments that it takes"},
	{"Figure",  "table",      "string",  "null", "table of the result with its numbers; null: the CSV of the result"},
	{"Figure",  "link",       "string",  "",     "path of the SVG"},
	{"Examples", "examples",  "[Example]", "",   "by name"},
	{"Example", "name",       "string",  "",     "name of the example, the end of its path"},
	{"Example", "title",      "string",  "",     "what it studies"},
	{"Version", "name",       "string",  "",     "name of the program, poundd"},
	{"Version", "version",    "string",  "",     "version of engine and server"},
	{"Problem", "type",       "string",  "",     "identifier of the type of problem"},
	{"Problem", "title",      "string",  "",     "the type of problem, in words"},
	{"Problem", "status",     "integer", "",     "HTTP status code"},
	{"Problem", "detail",     "string",  "",     "what is wrong with this request"},
	{"Problem", "line",       "integer", "absent", "line of the first error in malformed JSON, from 1"},
	{"Problem", "column",     "integer", "absent", "column of that error, from 1"},
	{"Problem", "errors",     "[Fault]", "absent", "all errors in a study document"},
	{"Problem", "errors_not_listed", "integer", "absent", "number of errors beyond those listed"},
	{"Fault",  "pointer",     "string",  "",     "JSON Pointer into the study document"},
	{"Fault",  "detail",      "string",  "",     "what was expected there and what was found"},
	{"Fault",  "requested",   "number",  "absent", "if the study is too large: the amount requested"},
	{"Fault",  "limit",       "number",  "absent", "and the largest amount allowed"},
	{"Result", "kind",           "string", "",   "kind of study"},
	{"Result", "engine_version", "string", "",   "version of the engine that computed the result"},
	{"Result", "study_hash",     "string", "",   "SHA-256 of the study with all defaults filled in, names left out"},
	{"Result", "timing",         "Timing", "",   "time taken; the only member that may differ between two runs of the same study"},
	{"Timing", "wall_s",      "number",  "",     "elapsed time [s]"},
	{"Timing", "cpu_s",       "number",  "",     "CPU time of all threads [s]"},
	{"Timing", "threads",     "integer", "",     "number of threads used"},
	{"BridgeInfo",    "protocolVersion", "number", "", "version of the protocol, 1.0"},
	{"BridgeInfo",    "models",      "[string]", "", "names of models; a sensitivity study is a model by its id, too"},
	{"BridgeModel",   "support",     "BridgeSupport", "", "which calls it answers"},
	{"BridgeSupport", "Evaluate",    "boolean", "", "true"},
	{"BridgeSupport", "Gradient",    "boolean", "", "false"},
	{"BridgeSupport", "ApplyJacobian", "boolean", "", "false"},
	{"BridgeSupport", "ApplyHessian", "boolean", "", "false"},
	{"BridgeInputs",  "inputSizes",  "[integer]", "", "one vector: the inputs of the study, in its order and units"},
	{"BridgeOutputs", "outputSizes", "[integer]", "", "one vector: every output of every cell, cells in order"},
	{"BridgeOutput",  "output",      "[array]", "", "that vector; means over the signals"},
	{"BridgeFault",   "error",       "BridgeError", "", "what is wrong with the call"},
	{"BridgeError",   "type",        "string", "", "InvalidInput, ModelNotFound, UnsupportedFeature or InvalidOutput"},
	{"BridgeError",   "message",     "string", "", "all errors, each with its JSON Pointer"},
	{"OpenAPI", "openapi",    "string",  "",     "version of OpenAPI"},
};

/* objects with further members that depend on the kind of study */
static const char open_objects[] = " Result Timing OpenAPI ";

static const struct {
	const char *object, *text;
} samples[] = {
	{"Status", "{\"id\": \"0019c5a0b1c2d3e4\", \"name\": \"two towers\", \"kind\": \"sensitivity\", \"status\": \"running\", "
	           "\"progress\": 0.25, \"runs_done\": 7500, \"runs_total\": 30000, \"eta_s\": 2.5, "
	           "\"cpu_s\": 0.9, \"estimated_cpu_s\": 3.5, \"over_estimate\": false, "
	           "\"queue_position\": null, \"expected_start\": null, "
	           "\"created\": \"2026-01-01T00:00:00.000Z\", \"started\": \"2026-01-01T00:00:00.010Z\", \"finished\": null, "
	           "\"error\": null, \"links\": {\"self\": \"/v1/studies/0019c5a0b1c2d3e4\", "
	           "\"request\": \"/v1/studies/0019c5a0b1c2d3e4/request\", \"results\": \"/v1/studies/0019c5a0b1c2d3e4/results\", "
	           "\"samples\": \"/v1/studies/0019c5a0b1c2d3e4/samples\", \"cancel\": \"/v1/studies/0019c5a0b1c2d3e4/cancel\"}}"},
	{"Estimate", "{\"kind\": \"sensitivity\", \"study_hash\": \"0f343b0931126a20f133d67c2b018a3b5d1b0e2f7c7c2e6c9b0a4d3e5f60718a\", \"runs_total\": 30000, \"estimated_cpu_s\": 3.5, \"estimated_cpu_s_high\": 10.5, \"estimated_bytes\": 960000, \"estimated_memory_bytes\": 24000000}"},
	{"Problem", "{\"type\": \"invalid-study\", \"title\": \"Invalid Study\", \"status\": 422, "
	            "\"detail\": \"the study has errors, see the list\", \"errors\": "
	            "[{\"pointer\": \"/scene/contact/gap_m\", \"detail\": \"must be at least 0, got -0.1\"}]}"},
};
// clang-format on

static void object(struct writer *w, const char *name)
{
	writer_object(w, name, WRITER_LINES);
}

static void reference(struct writer *w, const char *schema)
{
	char path[64];
	snprintf(path, sizeof path, "#/components/schemas/%s", schema);
	writer_text(w, "$ref", path);
}

/* ---- responses ---- */

static void member(struct writer *w, const struct member *of)
{
	bool array = *of->type == '[', another = of->type[array] <= 'Z';
	char type[32];
	snprintf(type, sizeof type, "%.*s", (int)strcspn(of->type + array, "]"), of->type + array);
	object(w, of->name);
	writer_text(w, "description", of->text);
	if (array) {
		writer_text(w, "type", "array");
		object(w, "items");
	}
	if (another && !array) {
		// siblings of a $ref are ignored, so a description needs allOf
		writer_array(w, "allOf", WRITER_LINE);
		writer_object(w, NULL, WRITER_LINE);
		reference(w, type);
		writer_end(w);
		writer_end(w);
	} else if (another)
		reference(w, type);
	else
		writer_text(w, "type", type);
	if (!strcmp(type, "array"))
		writer_json(w, "items", "{\"type\": \"number\"}");
	if (array)
		writer_end(w);
	if (!strcmp(of->note, "null"))
		writer_bool(w, "nullable", true);
	writer_end(w);
}

static void answered(struct writer *w, const char *name, const struct member *first, const struct member *end)
{
	object(w, name);
	writer_text(w, "type", "object");
	writer_bool(w, "additionalProperties", fields_listed(open_objects, name));
	object(w, "properties");
	for (const struct member *of = first; of < end; of++)
		member(w, of);
	writer_end(w);
	writer_array(w, "required", WRITER_LINE);
	for (const struct member *of = first; of < end; of++)
		if (strcmp(of->note, "absent") != 0)
			writer_text(w, NULL, of->name);
	writer_end(w);
	for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++)
		if (!strcmp(samples[i].object, name))
			writer_json(w, "example", samples[i].text);
	writer_end(w);
}

static void schemas(struct writer *w)
{
	const struct member *end = members + sizeof members / sizeof members[0];
	object(w, "schemas");
	object(w, "Study");
	writer_text(
	    w, "description",
	    "A study document. Which members it may have depends on its kind, its excitation and its solver; "
	    "validate_only reports all errors at once.");
	study_schema_members(w, "");
	writer_end(w);
	for (const struct member *first = members, *next; first < end; first = next) {
		for (next = first; next < end && !strcmp(next->object, first->object);)
			next++;
		answered(w, first->object, first, next);
	}
	writer_end(w);
}

/* ---- paths ---- */

static void argument(struct writer *w, const struct api_argument *of)
{
	char text[256];
	object(w, NULL);
	writer_text(w, "name", of->name);
	writer_text(w, "in", of->place);
	writer_bool(w, "required", !strcmp(of->place, "path"));
	writer_text(w, "description", of->text);
	if (of->blank)
		writer_bool(w, "allowEmptyValue", true);
	object(w, "schema");
	writer_text(w, "type", of->max ? "integer" : "string");
	if (of->max) {
		writer_whole(w, "minimum", of->min);
		writer_whole(w, "maximum", of->max);
	}
	if (of->digits > 0) {
		snprintf(text, sizeof text, "^[0-9a-f]{%d}$", of->digits);
		writer_text(w, "pattern", text);
	}
	if (of->choices) {
		writer_array(w, "enum", WRITER_LINE);
		snprintf(text, sizeof text, "%s", of->choices);
		for (char *rest, *name = strtok_r(text, " ", &rest); name; name = strtok_r(NULL, " ", &rest))
			writer_text(w, NULL, name);
		writer_end(w);
	}
	if (of->absent && of->max)
		writer_json(w, "default", of->absent);
	else if (of->absent)
		writer_text(w, "default", of->absent);
	writer_end(w);
	writer_end(w);
}

static void arguments(struct writer *w, const struct api_operation *operation)
{
	writer_array(w, "parameters", WRITER_LINES);
	for (int i = 0; i < api_arguments_count; i++) {
		const struct api_argument *of = &api_arguments[i];
		if (of->operation ? !strcmp(of->operation, operation->name) : strstr(operation->path, "{id}") != NULL)
			argument(w, of);
	}
	writer_end(w);
}

/* Whether an example is a complete study, not only a design. */
static bool is_study(const char *text)
{
	struct problems problems;
	struct pound_study *study = study_from_json(text, strlen(text), &problems);
	if (study)
		study_free(study);
	return study != NULL;
}

static void body(struct writer *w)
{
	object(w, "requestBody");
	writer_bool(w, "required", true);
	object(w, "content");
	object(w, "application/json");
	object(w, "schema");
	reference(w, "Study");
	writer_end(w);
	object(w, "examples");
	for (int i = 0; examples[i].name; i++) {
		if (!is_study(examples[i].text))
			continue;
		object(w, examples[i].name);
		writer_text(w, "summary", examples[i].title);
		writer_json(w, "value", examples[i].text);
		writer_end(w);
	}
	writer_end(w);
	writer_end(w);
	writer_end(w);
	writer_end(w);
}

static void media(struct writer *w, const char *type, const char *schema)
{
	object(w, type);
	object(w, "schema");
	if (schema)
		reference(w, schema);
	else
		writer_text(w, "type", "string");
	writer_end(w);
	writer_end(w);
}

static void header(struct writer *w, const char *name, bool required, const char *text)
{
	object(w, name);
	writer_text(w, "description", text);
	writer_bool(w, "required", required);
	writer_json(w, "schema", "{\"type\": \"string\"}");
	writer_end(w);
}

/* Headers of a successful response: Location of a new study, and ETag if the operation supports If-None-Match. */
static void success_headers(struct writer *w, const struct api_operation *operation, const char *answer,
                            const char *schema)
{
	bool made = !strcmp(answer, "201"), status = schema && !strcmp(schema, "Status");
	bool tagged = status || strstr(operation->answers, "304");
	if (!tagged)
		return;
	object(w, "headers");
	if (made)
		header(w, "Location", true, "path of the study");
	header(w, "ETag", true, "entity tag of the body, for If-None-Match");
	writer_end(w);
}

/* A successful response such as "200=Page" or "304". */
static void success(struct writer *w, const struct api_operation *operation, char *answer)
{
	char types[128], *object_name = strchr(answer, '=');
	if (object_name)
		*object_name++ = '\0';
	object(w, answer);
	writer_text(w, "description", !strcmp(answer, "304") ? "not modified" : operation->text);
	success_headers(w, operation, answer, object_name);
	if (*answer == '2' && (object_name || operation->media)) {
		object(w, "content");
		if (object_name)
			media(w, "application/json", object_name);
		snprintf(types, sizeof types, "%s", operation->media ? operation->media : "");
		for (char *rest, *type = strtok_r(types, " ", &rest); type; type = strtok_r(NULL, " ", &rest))
			media(w, type, NULL);
		writer_end(w);
	}
	writer_end(w);
}

/* The operation's own response object for an error status, if it has one (UM-Bridge). */
static void failed_as(struct writer *w, const struct api_operation *operation, const char *status)
{
	char answer[12], schema[32] = "";
	snprintf(answer, sizeof answer, " %s=", status);
	const char *found = strstr(operation->answers, answer);
	if (found && sscanf(found + strlen(answer), "%31[A-Za-z]", schema) == 1)
		media(w, "application/json", schema);
}

static void failures(struct writer *w, const struct api_operation *operation)
{
	unsigned faults = api_faults_of_all | operation->faults;
	for (int first = 0; first < API_NO_FAULT; first++) {
		char status[8], text[256] = "";
		bool listed = first > 0 && api_faults[first - 1].status == api_faults[first].status;
		for (int i = first; !listed && i < API_NO_FAULT && api_faults[i].status == api_faults[first].status;
		     i++)
			if ((faults >> i & 1) && !(operation->open && i == API_UNAUTHORIZED))
				strcat(strcat(text, *text ? ", or " : ""), api_faults[i].title);
		if (!*text)
			continue;
		snprintf(status, sizeof status, "%d", api_faults[first].status);
		object(w, status);
		writer_text(w, "description", text);
		const bool always = first == API_UNAVAILABLE || first == API_TOO_MANY;
		const bool waits =
		    api_faults[first].status == api_faults[API_NOT_READY].status && (faults >> API_NOT_READY & 1);
		if (always || waits || first == API_UNAUTHORIZED) {
			object(w, "headers");
			if (first == API_UNAUTHORIZED)
				header(w, "WWW-Authenticate", true, "Bearer");
			else
				header(w, "Retry-After", always,
				       always ? "seconds to wait" : "seconds to wait, if the answer is not ready yet");
			writer_end(w);
		}
		object(w, "content");
		media(w, "application/problem+json", "Problem");
		failed_as(w, operation, status);
		writer_end(w);
		writer_end(w);
	}
}

static void operations(struct writer *w)
{
	char answers[64], method[8];
	object(w, "paths");
	for (int i = 0; i < API_N_OPERATIONS; i++) {
		const struct api_operation *operation = &api_operations[i];
		if (i == 0 || strcmp(operation->path, api_operations[i - 1].path) != 0)
			object(w, operation->path);
		snprintf(method, sizeof method, "%s", operation->method);
		for (char *c = method; *c; c++)
			*c |= 0x20; // lower case
		object(w, method);
		writer_text(w, "operationId", operation->name);
		writer_text(w, "summary", operation->text);
		writer_json(w, "security", operation->open ? "[]" : "[{}, {\"bearer\": []}]");
		arguments(w, operation);
		if (operation->takes_study)
			body(w);
		object(w, "responses");
		snprintf(answers, sizeof answers, "%s", operation->answers);
		for (char *rest, *one = strtok_r(answers, " ", &rest); one; one = strtok_r(NULL, " ", &rest))
			if (*one < '4')
				success(w, operation, one);
		failures(w, operation);
		writer_end(w);
		writer_end(w);
		if (i + 1 == API_N_OPERATIONS || strcmp(operation->path, api_operations[i + 1].path) != 0)
			writer_end(w);
	}
	writer_end(w);
}

/* Writes the document that describes the interface of poundd.
 *
 * Returns  value     (length)  -       JSON, OpenAPI 3.0; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Source   OpenAPI Specification 3.0.3
 * Test     unit_api: the_schema_and_the_reader_take_and_refuse_the_same_studies, service_openapi
 */
char *api_document(size_t *length)
{
	struct writer w;
	writer_init(&w);
	object(&w, NULL);
	writer_text(&w, "openapi", "3.0.3");
	object(&w, "info");
	writer_text(&w, "title", "poundd");
	writer_text(&w, "version", POUND_VERSION);
	writer_text(&w, "description",
	            "Earthquake-induced pounding between two oscillators: responses, floor spectra and "
	            "sensitivity indices. Requests that the HTTP "
	            "parser itself refuses (400, 414, 431, 505) get an answer without a problem object.");
	writer_end(&w);
	operations(&w);
	object(&w, "components");
	schemas(&w);
	writer_json(&w, "securitySchemes", "{\"bearer\": {\"type\": \"http\", \"scheme\": \"bearer\"}}");
	writer_end(&w);
	writer_end(&w);
	return writer_take(&w, length);
}
