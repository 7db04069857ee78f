/* um_bridge.c - a sensitivity study as a model of the UM-Bridge protocol 1.0.
 *
 * 1. The body names the model: "pound", with a study in the body or else the paper's, or the id of a stored study.
 * 2. The sensitivity study becomes a response study of its scene with the given values of the inputs; sweeps remain.
 * 3. The outputs of all cells are one vector; all problems are one message.
 *
 * Source   UM-Bridge, https://um-bridge-benchmarks.readthedocs.io, protocol 1.0 */
#include "schema/external/um_bridge.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/json/json.h"
#include "schema/json/json_writer.h"
#include "schema/study/fields.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

static const char MODEL[] = "pound", STUDY_ABSENT[] = "paper_linear";

struct um_bridge {
	enum um_bridge_call call;
	enum um_bridge_error error;
	struct problems problems; /* status PROBLEMS_NOMEM: no memory */
	cJSON *body;              /* NULL: none, or not JSON */
	const char *name;         /* of the model; NULL: none */
	const char *place;        /* pointer to the study in the body; "": not in the body */
	struct pound_study *study;
	int n_inputs; /* of the sensitivity study; study->n_inputs is 0 */
	double *outputs;
	int n_outputs; /* of all cells */
};

static const struct {
	int status;
	const char *type;
} errors[] = {
#define X(name, status, type) [UM_BRIDGE_ERROR_##name] = {status, type},
    UM_BRIDGE_ERRORS(X)
#undef X
};

/* ---- problems ---- */

/* Adds the problems of a part of the request, with the pointer to that part before their pointers. */
static void refuse_at(struct um_bridge *b, enum um_bridge_error error, const char *place,
                      const struct problems *problems)
{
	char pointer[sizeof problems->list[0].pointer + 32];
	for (int i = 0; i < problems->n; i++) {
		snprintf(pointer, sizeof pointer, "%s%s", place, problems->list[i].pointer);
		problems_add(&b->problems, pointer, "%s", problems->list[i].detail);
	}
	b->problems.n_more += problems->n_more;
	b->error = error;
	if (problems->status == PROBLEMS_NOMEM)
		b->problems.status = PROBLEMS_NOMEM;
}

void um_bridge_refuse(struct um_bridge *b, enum um_bridge_error error, const struct problems *problems)
{
	refuse_at(b, error, b->place, problems);
}

#define REFUSE(b, kind, pointer, ...) \
	(problems_add(&(b)->problems, pointer, __VA_ARGS__), (void)((b)->error = UM_BRIDGE_ERROR_##kind))

static bool refused(const struct um_bridge *b)
{
	return b->problems.status != PROBLEMS_NONE;
}

/* ---- the request ---- */

/* The configuration of the call; NULL: none. */
static const cJSON *config_of(const struct um_bridge *b)
{
	const cJSON *config = cJSON_GetObjectItemCaseSensitive(b->body, "config");
	return cJSON_IsNull(config) ? NULL : config;
}

static void check_config(struct um_bridge *b)
{
	const cJSON *config = config_of(b), *member;
	if (config && !cJSON_IsObject(config)) {
		REFUSE(b, INPUT, "/config", "must be an object");
		return;
	}
	cJSON_ArrayForEach(member, config)
	{
		char pointer[160];
		snprintf(pointer, sizeof pointer, "/config/%s", member->string);
		if (!fields_listed(" study row signals ", member->string) || strchr(member->string, ' '))
			REFUSE(b, INPUT, pointer, "unknown member; expected study, row or signals");
		else if (!strcmp(member->string, "study") && um_bridge_id(b))
			REFUSE(b, INPUT, pointer, "is not used: the model is a stored study");
	}
}

/* Reads name and configuration of a call.
 *
 * Given    body      (length)  -   JSON of the request; ignored for UM_BRIDGE_INFO
 * Returns  value     -         -   to be freed by um_bridge_close; NULL: out of memory
 * Test     service_bridge: every_error_of_the_protocol_has_its_type_status_and_message
 */
struct um_bridge *um_bridge_open(enum um_bridge_call call, const char *body, size_t length)
{
	struct json_fault fault;
	struct um_bridge *b = calloc(1, sizeof *b);
	if (!b)
		return NULL;
	*b = (struct um_bridge){.call = call, .error = UM_BRIDGE_NO_ERROR, .place = ""};
	problems_init(&b->problems);
	if (call == UM_BRIDGE_INFO)
		return b;
	b->body = json_parse(body ? body : "", length, &fault);
	b->name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(b->body, "name"));
	if (!b->body && !fault.line)
		b->problems.status = PROBLEMS_NOMEM;
	else if (!b->body)
		REFUSE(b, INPUT, "", "the body is not JSON: line %d, column %d: %s", fault.line, fault.column,
		       fault.detail);
	else if (!b->name || (strcmp(b->name, MODEL) != 0 && !um_bridge_id(b)))
		REFUSE(b, MODEL, "/name", "must be \"%s\" or the id of a sensitivity study, 16 hexadecimal digits",
		       MODEL);
	else
		check_config(b);
	return b;
}

void um_bridge_close(struct um_bridge *b)
{
	cJSON_Delete(b->body);
	free(b->outputs);
	if (b->study)
		study_free(b->study);
	free(b);
}

long long um_bridge_id(const struct um_bridge *b)
{
	if (!b->name || strlen(b->name) != 16 || strspn(b->name, "0123456789abcdef") != 16)
		return 0;
	long long id = (long long)strtoull(b->name, NULL, 16);
	return id > 0 ? id : 0;
}

/* ---- the study ---- */

/* A whole number of the configuration, or its default. */
static int whole(struct um_bridge *b, const char *name, int absent, int min, int max)
{
	char pointer[32];
	const cJSON *node = cJSON_GetObjectItemCaseSensitive(config_of(b), name);
	const char *excitation = pound_excitation_name(b->study->scene.excitation.type);
	snprintf(pointer, sizeof pointer, "/config/%s", name);
	if (!node)
		return absent;
	if (!fields_used(fields_find("/scene/excitation/signals"), NULL, excitation, NULL))
		REFUSE(b, INPUT, pointer, "is not used by excitation \"%s\"", excitation);
	else if (!cJSON_IsNumber(node) || node->valuedouble != floor(node->valuedouble) ||
	         node->valuedouble < min || node->valuedouble > max)
		REFUSE(b, INPUT, pointer, "must be a whole number in [%d, %d]", min, max);
	else
		return (int)node->valuedouble;
	return absent;
}

/* Turns a sensitivity study into a response study with the same scene, sweeps and outputs. */
static void respond(struct um_bridge *b)
{
	struct pound_study *study = b->study;
	char pointer[64];
	snprintf(pointer, sizeof pointer, "%s/outputs", b->place);
	for (int o = 0; o < study->n_outputs; o++)
		if (pound_output_has_ordinates(study->outputs[o])) {
			REFUSE(b, INPUT, pointer,
			       "output \"%s\" is not available from a model, only in a sensitivity study",
			       pound_output_name(study->outputs[o]));
			return;
		}
	b->n_inputs = study->n_inputs;
	study->kind = POUND_KIND_RESPONSE;
	study->unbalanced = true; // energy balances take four fifths of the time and are not part of the response
	study->n_inputs = study->n_ratios = study->n_groups = study->spectrum.n = 0;
	study->design.until.half_width = 0;
	study->design.row = whole(b, "row", 0, 0, POUND_ROWS_MAX - 1);
	const struct field *signals = fields_find("/scene/excitation/signals");
	study->scene.excitation.signals =
	    whole(b, "signals", study->scene.excitation.signals, (int)signals->min, (int)signals->max);
}

/* Reads the model's study from a document. */
static void study_read(struct um_bridge *b, const char *text, size_t length)
{
	const enum um_bridge_error error = *b->place ? UM_BRIDGE_ERROR_INPUT : UM_BRIDGE_ERROR_MODEL;
	char pointer[64];
	snprintf(pointer, sizeof pointer, "%s/kind", b->place);
	struct problems *problems = malloc(sizeof *problems);
	if (!problems) {
		b->problems.status = PROBLEMS_NOMEM;
		return;
	}
	b->study = study_from_json(text, length, problems);
	if (!b->study)
		refuse_at(b, error, b->place, problems);
	else if (b->study->kind != POUND_KIND_SENSITIVITY) {
		problems_add(&b->problems, pointer,
		             "must be \"sensitivity\": a model takes its inputs from a sensitivity study");
		b->error = error;
	} else
		respond(b);
	free(problems);
}

void um_bridge_stored(struct um_bridge *b, const char *document, size_t length)
{
	if (document)
		study_read(b, document, length);
	else
		REFUSE(b, MODEL, "/name", "there is no study %s", b->name);
}

/* The study of the model "pound": from the configuration, or else the paper's. */
static void study_given(struct um_bridge *b)
{
	const cJSON *given = cJSON_GetObjectItemCaseSensitive(config_of(b), "study");
	const char *absent = example_text(STUDY_ABSENT);
	char *text = NULL;
	size_t length = strlen(absent);
	b->place = given ? "/config/study" : "";
	if (given) {
		struct writer w;
		writer_init(&w);
		w.line = 0; // one line: indentation can make a malicious document 20 times as long
		json_write(&w, NULL, given, NULL, NULL);
		text = writer_take(&w, &length);
	}
	if (given && !text)
		b->problems.status = PROBLEMS_NOMEM;
	else
		study_read(b, given ? text : absent, length);
	free(text);
}

/* ---- input ---- */

static void assign(struct um_bridge *b, const struct pound_input *input, int j, const cJSON *number)
{
	char pointer[32], range[64];
	struct field_place place;
	const struct field *field = fields_scene(input->path, &place);
	snprintf(pointer, sizeof pointer, "/input/0/%d", j);
	fields_range(field, range, sizeof range);
	if (!cJSON_IsNumber(number))
		REFUSE(b, INPUT, pointer, "%s must be a number", input->name);
	else if (!fields_in_range(field, number->valuedouble))
		REFUSE(b, INPUT, pointer, "%s must be %s%s%s, got %.15g", input->name, range, *field->unit ? " " : "",
		       field->unit, number->valuedouble);
	else
		pound_scene_assign(&b->study->scene, input->field, number->valuedouble + 0.0);
}

/* Puts the values of the inputs into the scene and checks the resulting study. */
static void assign_all(struct um_bridge *b)
{
	const cJSON *vectors = cJSON_GetObjectItemCaseSensitive(b->body, "input");
	const cJSON *vector = cJSON_GetArrayItem(vectors, 0);
	struct problems *problems = malloc(sizeof *problems);
	if (!problems)
		b->problems.status = PROBLEMS_NOMEM;
	else if (!cJSON_IsArray(vectors) || cJSON_GetArraySize(vectors) != 1 || !cJSON_IsArray(vector))
		REFUSE(b, INPUT, "/input", "must have one vector, of %d numbers", b->n_inputs);
	else if (cJSON_GetArraySize(vector) != b->n_inputs)
		REFUSE(b, INPUT, "/input/0", "must have %d numbers, has %d", b->n_inputs, cJSON_GetArraySize(vector));
	else
		for (int j = 0; j < b->n_inputs; j++)
			assign(b, &b->study->inputs[j], j, cJSON_GetArrayItem(vector, j));
	if (!refused(b)) {
		problems_init(problems);
		study_check(b->study, problems);
		if (problems->n)
			um_bridge_refuse(b, UM_BRIDGE_ERROR_INPUT, problems);
	}
	free(problems);
}

/* The study that computes a call's outputs.
 *
 * Returns  value     -    a response study; NULL: the call is refused, or needs no run
 * Test     service_bridge: evaluate_gives_the_numbers_of_the_response_study
 */
const struct pound_study *um_bridge_study(struct um_bridge *b)
{
	const bool named = b->body && b->problems.status != PROBLEMS_NOMEM && b->error != UM_BRIDGE_ERROR_MODEL;
	if (named && !b->study && !um_bridge_id(b))
		study_given(b);
	if (named && b->call == UM_BRIDGE_DERIVATIVE && !refused(b))
		REFUSE(b, FEATURE, "", "this model supports Evaluate, and no derivatives");
	// also after problems of the configuration, so that problems of the input are reported with them
	if (b->n_inputs && b->call == UM_BRIDGE_EVALUATE)
		assign_all(b);
	return refused(b) || b->call != UM_BRIDGE_EVALUATE ? NULL : b->study;
}

/* ---- output ---- */

/* Whether an output exists in a cell, and so in the vector of outputs. */
static bool applies(const struct pound_study *study, int cell, int output)
{
	struct pound_scene scene;
	study_cell(study, cell, &scene);
	return pound_output_applies(study->outputs[output], &scene);
}

static int outputs_count(const struct pound_study *study)
{
	int n = 0;
	for (int cell = 0; cell < study_cells(study); cell++)
		for (int o = 0; o < study->n_outputs; o++)
			n += applies(study, cell, o);
	return n;
}

static void check_runs(struct um_bridge *b, const struct pound_result *result)
{
	static const enum pound_status failures[] = {
#define X(name, value, text) name,
	    POUND_FAILURES(X)
#undef X
	};
	for (int kind = 0; kind < POUND_N_FAILURES; kind++)
		if (result->work.failed[kind])
			REFUSE(b, OUTPUT, "", "%lld run%s failed: %s", (long long)result->work.failed[kind],
			       result->work.failed[kind] == 1 ? "" : "s", pound_status_text(failures[kind]));
}

/* Takes the outputs of the study that was run.
 *
 * A failed run is an error although the mean of the other runs exists: a sampler would mistake that mean for the model's output.
 */
void um_bridge_result(struct um_bridge *b, const struct pound_result *result)
{
	int n = outputs_count(b->study);
	check_runs(b, result);
	b->outputs = refused(b) ? NULL : malloc(sizeof *b->outputs * (size_t)n);
	if (!refused(b) && !b->outputs)
		b->problems.status = PROBLEMS_NOMEM;
	for (int cell = 0; cell < result->n_cells && b->outputs; cell++)
		for (int o = 0; o < b->study->n_outputs; o++) {
			if (!applies(b->study, cell, o))
				continue;
			const double value = result->cells[cell].outputs[o];
			b->outputs[b->n_outputs++] = value;
			if (!isfinite(value))
				REFUSE(b, OUTPUT, "", "%s of cell %d has no value: the response in its denominator is 0",
				       pound_output_name(b->study->outputs[o]), cell);
		}
}

/* ---- the response ---- */

/* {"error": {"type": ..., "message": ...}}, with all problems in one message. */
static void write_error(struct writer *w, const struct um_bridge *b)
{
	struct writer text;
	char line[sizeof b->problems.list[0] + 8];
	size_t n;
	writer_init(&text);
	for (int i = 0; i < b->problems.n; i++) {
		const struct problem *problem = &b->problems.list[i];
		snprintf(line, sizeof line, "%s%s%s%s", i ? "; " : "", problem->pointer,
		         *problem->pointer ? ": " : "", problem->detail);
		writer_raw(&text, line, strlen(line));
	}
	snprintf(line, sizeof line, "; and %d more", b->problems.n_more);
	writer_raw(&text, line, b->problems.n_more ? strlen(line) : 0);
	char *message = writer_take(&text, &n);
	writer_object(w, "error", WRITER_LINE);
	writer_text(w, "type", errors[b->error].type);
	writer_text(w, "message", message);
	writer_end(w);
	w->failed |= !message;
	free(message);
}

static void write_sizes(struct writer *w, const char *name, int size)
{
	writer_array(w, name, WRITER_LINE);
	writer_whole(w, NULL, size);
	writer_end(w);
}

static void write_outputs(struct writer *w, const struct um_bridge *b)
{
	writer_array(w, "output", WRITER_LINE);
	writer_array(w, NULL, WRITER_LINE);
	for (int i = 0; i < b->n_outputs; i++)
		writer_number(w, NULL, b->outputs[i]);
	writer_end(w);
	writer_end(w);
}

/* The response to a call, after um_bridge_study, and after um_bridge_result or um_bridge_refuse if there is a study to run.
 *
 * Returns  value     (length)  bytes   JSON; NULL: out of memory
 *          status    -         -       HTTP status
 * Memory   allocates; the caller frees
 * Test     service_bridge
 */
char *um_bridge_answer(struct um_bridge *b, int *status, size_t *length)
{
	struct writer w;
	if (b->problems.status == PROBLEMS_NOMEM)
		return NULL;
	*status = refused(b) ? errors[b->error].status : 200;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINE);
	if (refused(b))
		write_error(&w, b);
	else
		switch (b->call) {
		case UM_BRIDGE_INFO:
			writer_json(&w, "protocolVersion", "1.0");
			writer_array(&w, "models", WRITER_LINE);
			writer_text(&w, NULL, MODEL);
			writer_end(&w);
			break;
		case UM_BRIDGE_MODEL_INFO:
			writer_json(&w, "support",
			            "{\"Evaluate\": true, \"Gradient\": false, \"ApplyJacobian\": false, "
			            "\"ApplyHessian\": false}");
			break;
		case UM_BRIDGE_INPUT_SIZES:
			write_sizes(&w, "inputSizes", b->n_inputs);
			break;
		case UM_BRIDGE_OUTPUT_SIZES:
			write_sizes(&w, "outputSizes", outputs_count(b->study));
			break;
		case UM_BRIDGE_EVALUATE:
			write_outputs(&w, b);
			break;
		case UM_BRIDGE_DERIVATIVE:
			assert(refused(b));
		}
	writer_end(&w);
	return writer_take(&w, length);
}
