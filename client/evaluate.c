/* evaluate.c - `pound evaluate`: runs a study's design on a model of a server that speaks the UM-Bridge protocol 1.0.
 *
 * 1. The model's sizes must fit the study.
 * 2. Each sample, or replicate of one, is a run: taken from the journal, or requested from the server, several at a time.
 * 3. Outputs are stored by the number of their run, so the order of the answers does not matter, and written as the CSV that
 *    `pound indices` reads.
 *
 * Source   UM-Bridge, https://um-bridge-benchmarks.readthedocs.io, protocol 1.0 */
#include "client/command.h"
#include "client/document.h"
#include "client/journal.h"
#include "client/model.h"
#include "client/progress_bar.h"
#include "client/show.h"
#include "client/wire.h"
#include "schema/external/external_model.h"
#include "schema/json/json_pointer.h"
#include "schema/json/json_writer.h"
#include "schema/study/study_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
	TRIES = 4,          /* sends of a run before a lost answer is an error */
	PAUSE_MS = 250,     /* before the second send; each later pause is four times as long */
	WAIT_MS = 1000,     /* longest wait for an answer before the progress bar is redrawn */
	VECTORS_MAX = 1000, /* most vectors of a model's inputs or outputs */
	HTTP_OK = 200,
	HTTP_BAD_REQUEST = 400,
	HTTP_FAILED = 500,
	HTTP_BAD_GATEWAY = 502,
	HTTP_GATEWAY_TIMEOUT = 504,
};

/* Sizes of the input or output vectors of a model. */
struct sizes {
	int n, all; /* number of vectors; sum of their sizes */
	int size[VECTORS_MAX];
};

/* A request that was sent, or will be sent again. */
struct job {
	long run; /* -1: none */
	int tries;
	bool sent;
	double due; /* [s] time of the next send */
	char *body;
};

struct evaluation {
	const struct options *options;
	const struct pound_study *study;
	struct pound_run *design;
	const char *url;
	char *name;   /* of the model */
	char *config; /* JSON object; with --seed-member it ends at the value of that member */
	struct sizes inputs, outputs;
	char **names; /* of the outputs  (outputs.all) */
	long n, done; /* runs: rows x samples x replicates */
	int n_samples, n_replicates;
	double *values; /* NAN: failed  (n x outputs.all) */
	bool *known;    /* (n) */
	struct journal *journal;
	long failed;
	char failure[200]; /* reason of the first failed run */
	double began;      /* [s] time of the first request */
	long begun;        /* runs known at that time, from the journal */
};

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* ---- the model ---- */

/* Reports an error reply: its type and message, or its HTTP status. */
static void complain_of(const struct evaluation *e, const struct wire_reply *reply)
{
	struct reading *r = reading_open(reply->body, reply->n_body);
	const char *type = r ? reading_text(r, "/error/type") : NULL,
	           *message = r ? reading_text(r, "/error/message") : NULL;
	if (type)
		command_complain("%s: %s: %s", e->url, type, message ? message : "");
	else
		command_complain("%s: the answer has status %ld: %.200s", e->url, reply->status, reply->body);
	reading_close(r);
}

/* Requests a JSON object.
 *
 * Returns  value    for reading_close; NULL: failed, reported on stderr
 */
static struct reading *ask(const struct evaluation *e, const char *path, const char *body,
                           enum outcome *outcome)
{
	struct wire *wire = wire_open(e->url);
	struct wire_reply reply;
	struct reading *r = NULL;
	const struct wire_request request = {.method = body ? "POST" : "GET",
	                                     .path = path,
	                                     .body = body,
	                                     .n_body = body ? strlen(body) : 0,
	                                     .made = true};
	*outcome = wire_send(wire, &request, &reply);
	if (*outcome != OUTCOME_OK)
		command_complain("%s: %s", e->url, wire_failure(wire));
	else if (reply.status != HTTP_OK) {
		complain_of(e, &reply);
		*outcome = reply.status == HTTP_BAD_REQUEST ? OUTCOME_USAGE : OUTCOME_FAILED;
	} else if (!(r = reading_open(reply.body, reply.n_body))) {
		command_complain("%s: the answer to %s is not JSON", e->url, path);
		*outcome = OUTCOME_FAILED;
	}
	wire_reply_free(&reply);
	wire_close(wire);
	return r;
}

/* Reports an error in the arguments or the model. */
#define MISTAKEN(...) (command_complain(__VA_ARGS__), OUTCOME_USAGE)

static enum outcome find_model(struct evaluation *e)
{
	enum outcome outcome;
	struct reading *r = ask(e, "/Info", NULL, &outcome);
	const char *wanted = e->options->evaluate.name;
	if (!r)
		return outcome;
	const int n = reading_count(r, "/models");
	if (reading_number(r, "/protocolVersion") != 1.0)
		outcome = MISTAKEN("%s: is not a UM-Bridge 1.0 server", e->url);
	else if (n == 0 && !wanted)
		outcome = MISTAKEN("%s: has no model", e->url);
	else
		// a server may have models that it does not list
		e->name = command_sure(strdup(wanted ? wanted : reading_text(r, "/models/0")));
	reading_close(r);
	return outcome;
}

/* The beginning of every request: the members for the name and configuration of the model, without the closing brace. */
static char *request_head(const struct evaluation *e, long run)
{
	struct writer w;
	size_t n;
	char *name, *head;
	writer_init(&w);
	writer_text(&w, NULL, e->name);
	name = command_sure(writer_take(&w, &n));
	name[strcspn(name, "\n")] = '\0';
	if (e->options->evaluate.seed_member)
		head = command_text("{\"name\": %s, \"config\": %s%ld}", name, e->config, run);
	else
		head = command_text("{\"name\": %s, \"config\": %s", name, e->config);
	free(name);
	return head;
}

static enum outcome read_sizes(const struct evaluation *e, const char *path, const char *member,
                               struct sizes *sizes)
{
	enum outcome outcome;
	char *head = request_head(e, 0), *body = command_text("%s}", head), pointer[64];
	struct reading *r = ask(e, path, body, &outcome);
	free(body);
	free(head);
	if (!r)
		return outcome;
	sizes->n = reading_count(r, "/%s", member);
	if (sizes->n < 1 || sizes->n > VECTORS_MAX)
		outcome = MISTAKEN("%s: %s has %d vectors, expected 1 to %d", e->url, path, sizes->n, VECTORS_MAX);
	for (int i = 0; i < sizes->n && outcome == OUTCOME_OK; i++) {
		snprintf(pointer, sizeof pointer, "/%s/%d", member, i);
		const double size = reading_number(r, "%s", pointer);
		if (!(size >= 0 && size <= 1e6 && size == floor(size)))
			outcome = MISTAKEN("%s: %s: %s is not a size", e->url, path, pointer);
		else
			sizes->all += sizes->size[i] = (int)size;
	}
	reading_close(r);
	return outcome;
}

/* Checks that the configuration is a JSON object; with --seed-member, opens that member at its end. */
static enum outcome take_config(struct evaluation *e)
{
	const char *text = e->options->evaluate.config ? e->options->evaluate.config : "{}",
	           *seed = e->options->evaluate.seed_member;
	struct reading *r = reading_open(text, strlen(text));
	enum outcome outcome = OUTCOME_OK;
	if (!r || reading_type(r, "%s", "") != 'o')
		outcome = MISTAKEN("--config must be a JSON object, got '%.200s'", text);
	else if (!seed)
		e->config = command_sure(strdup(text));
	else if (reading_has(r, "/%s", seed))
		outcome = MISTAKEN("--seed-member: the configuration has a member '%s' already", seed);
	else {
		struct writer w;
		size_t n;
		writer_init(&w);
		writer_text(&w, NULL, seed);
		char *name = command_sure(writer_take(&w, &n));
		e->config = command_text("%.*s%s%.*s: ", (int)(strrchr(text, '}') - text), text,
		                         reading_count(r, "%s", "") ? ", " : "", (int)strcspn(name, "\n"), name);
		free(name);
	}
	reading_close(r);
	return outcome;
}

/* ---- names of outputs ---- */

static bool is_reserved(const struct evaluation *e, const char *name)
{
	const size_t n = strlen(name), suffix = strlen(".variance");
	bool is = n == 0 || strcmp(name, "row") == 0 || strcmp(name, "sample") == 0 ||
	          (n >= suffix && strcmp(name + n - suffix, ".variance") == 0);
	for (int j = 0; j < e->study->n_inputs; j++)
		is |= strcmp(e->study->inputs[j].name, name) == 0;
	return is;
}

static enum outcome name_outputs(struct evaluation *e)
{
	const char *given = e->options->evaluate.outputs;
	int n = 0;
	e->names = command_sure(calloc((size_t)e->outputs.all + 1, sizeof *e->names));
	for (int o = 0; o < e->outputs.all && !given; o++)
		e->names[o] = command_text("y%d", o + 1);
	for (const char *at = given, *end; at; at = *end ? end + 1 : NULL, n++) {
		end = at + strcspn(at, ",");
		if (n < e->outputs.all)
			e->names[n] = command_text("%.*s", (int)(end - at), at);
	}
	if (given && n != e->outputs.all)
		return MISTAKEN("--outputs has %d names, the model has %d outputs", n, e->outputs.all);
	for (int o = 0; o < e->outputs.all; o++) {
		if (is_reserved(e, e->names[o]))
			return MISTAKEN("--outputs: '%s' cannot be the name of an output", e->names[o]);
		for (int other = 0; other < o; other++)
			if (strcmp(e->names[o], e->names[other]) == 0)
				return MISTAKEN("--outputs: '%s' occurs twice", e->names[o]);
	}
	return OUTCOME_OK;
}

/* ---- runs ---- */

/* The request body of a run: the inputs of its sample, split into the model's vectors. */
static char *run_body(const struct evaluation *e, long run)
{
	struct writer w;
	size_t n;
	double x[POUND_INPUTS_MAX];
	const long sample = run / e->n_replicates;
	pound_run_sample_inputs(e->design, (int)(sample / e->n_samples), (int)(sample % e->n_samples), x);
	writer_init(&w);
	writer_array(&w, NULL, WRITER_LINE);
	for (int v = 0, j = 0; v < e->inputs.n; v++) {
		writer_array(&w, NULL, WRITER_LINE);
		for (int i = 0; i < e->inputs.size[v]; i++)
			writer_number(&w, NULL, x[j++]);
		writer_end(&w);
	}
	writer_end(&w);
	char *input = command_sure(writer_take(&w, &n)), *head = request_head(e, run);
	char *body = command_text("%s, \"input\": %s}", head, input);
	free(head);
	free(input);
	return body;
}

static void note(struct evaluation *e, long run, const double *values)
{
	bool is = run < e->n && !e->known[run];
	if (!is)
		return;
	memcpy(e->values + run * e->outputs.all, values, sizeof *values * (size_t)e->outputs.all);
	e->known[run] = true;
	e->done++;
	for (int o = 0; o < e->outputs.all; o++)
		is &= isfinite(values[o]) != 0;
	e->failed += !is;
}

static void note_from_journal(void *to, long run, const double *values)
{
	note(to, run, values);
}

/* Reads the outputs of an answer.
 *
 * Returns  values   all NAN if the run failed
 *          value    false: the vectors do not have the model's sizes; reported on stderr
 */
static bool outputs_read(struct evaluation *e, const struct wire_reply *reply, double *values)
{
	struct reading *r = reading_open(reply->body, reply->n_body);
	const char *type = r ? reading_text(r, "/error/type") : NULL,
	           *message = r ? reading_text(r, "/error/message") : NULL;
	bool failed = reply->status != HTTP_OK || !r,
	     fits = failed || reading_count(r, "/output") == e->outputs.n;
	for (int v = 0, o = 0; v < e->outputs.n; v++) {
		fits = fits && (failed || reading_count(r, "/output/%d", v) == e->outputs.size[v]);
		for (int i = 0; i < e->outputs.size[v]; i++, o++)
			values[o] = failed || !fits ? NAN : reading_number(r, "/output/%d/%d", v, i);
	}
	if (!fits)
		command_complain("%s: the output of a run does not have the sizes of the model", e->url);
	if (failed && !e->failure[0])
		snprintf(e->failure, sizeof e->failure, "%s: %s", type ? type : "status",
		         message ? message
		         : r     ? "no reason was given"
		                 : "the answer is not JSON");
	reading_close(r);
	return fits;
}

/* Whether a reply is the result or failure of a run, not an error of a proxy or of a server without this model. */
static bool is_of_run(const struct wire_reply *reply)
{
	if (reply->status != HTTP_BAD_REQUEST)
		return reply->status == HTTP_OK || reply->status == HTTP_FAILED;
	struct reading *r = reading_open(reply->body, reply->n_body);
	const char *type = r ? reading_text(r, "/error/type") : NULL;
	const bool is = type && strcmp(type, "InvalidInput") == 0;
	reading_close(r);
	return is;
}

/* Takes the reply to a job's run.
 *
 * Returns  value   OUTCOME_OK: the run has ended, or will be sent again
 */
static enum outcome job_end(struct evaluation *e, struct job *job, enum outcome outcome,
                            const struct wire_reply *reply, const char *failure)
{
	const bool lost = outcome == OUTCOME_UNREACHED ||
	                  (reply->status >= HTTP_BAD_GATEWAY && reply->status <= HTTP_GATEWAY_TIMEOUT);
	job->sent = false;
	if (lost && job->tries < TRIES) {
		const double pause = 1e-3 * PAUSE_MS * (1 << 2 * (job->tries - 1));
		job->due = now() + fmax(pause, (double)reply->retry_after_s);
		return OUTCOME_OK;
	}
	if (outcome != OUTCOME_OK) {
		command_complain("%s: %s", e->url, failure);
		return outcome;
	}
	if (!is_of_run(reply)) {
		complain_of(e, reply);
		return lost ? OUTCOME_UNREACHED : reply->status == HTTP_BAD_REQUEST ? OUTCOME_USAGE : OUTCOME_FAILED;
	}
	double *values = command_sure(calloc((size_t)e->outputs.all, sizeof *values));
	if (!outputs_read(e, reply, values))
		outcome = OUTCOME_USAGE;
	else if (!journal_add(e->journal, job->run, values))
		outcome = OUTCOME_FAILED;
	else
		note(e, job->run, values);
	free(values);
	free(job->body);
	*job = (struct job){.run = -1};
	return outcome;
}

/* Assigns a run to every idle job, and sends the requests that are due. */
static void jobs_begin(struct evaluation *e, struct wire_jobs *wires, struct job *jobs, long *next)
{
	const double time = now();
	for (int j = 0; j < e->options->evaluate.jobs; j++) {
		struct job *job = &jobs[j];
		while (job->run < 0 && *next < e->n && e->known[*next])
			++*next;
		if (job->run < 0 && *next < e->n)
			*job = (struct job){.run = *next, .body = run_body(e, (*next)++)};
		if (job->run < 0 || job->sent || time < job->due)
			continue;
		job->sent = true;
		job->tries++;
		wire_jobs_send(
		    wires, j,
		    &(struct wire_request){
		        .method = "POST", .path = "/Evaluate", .body = job->body, .n_body = strlen(job->body)});
	}
}

/* Milliseconds until the next repeated send, at most WAIT_MS. */
static int until_due(const struct evaluation *e, const struct job *jobs)
{
	double wait = 1e-3 * WAIT_MS, time = now();
	for (int j = 0; j < e->options->evaluate.jobs; j++)
		if (jobs[j].run >= 0 && !jobs[j].sent)
			wait = fmin(wait, fmax(jobs[j].due - time, 0));
	return (int)ceil(1e3 * wait);
}

static enum outcome run_all(struct evaluation *e)
{
	const int n = e->options->evaluate.jobs;
	struct wire_jobs *wires = wire_jobs_open(e->url, n, e->options->evaluate.timeout);
	struct job *jobs = command_sure(calloc((size_t)n, sizeof *jobs));
	enum outcome outcome = OUTCOME_OK;
	long next = 0;
	double drawn = 0;
	for (int j = 0; j < n; j++)
		jobs[j].run = -1;
	e->began = now();
	e->begun = e->done;
	while (e->done < e->n && outcome == OUTCOME_OK) {
		struct wire_reply reply;
		enum outcome sent;
		jobs_begin(e, wires, jobs, &next);
		const int job = wire_jobs_receive(wires, until_due(e, jobs), &sent, &reply);
		if (job >= 0) {
			outcome = job_end(e, &jobs[job], sent, &reply, wire_jobs_failure(wires, job));
			wire_reply_free(&reply);
		}
		const double time = now(), each = (time - e->began) / (double)(e->done - e->begun);
		if (time > drawn + 0.1)
			bar_draw((double)e->done, (double)e->n, isfinite(each) ? each * (double)(e->n - e->done) : -1);
		drawn = time > drawn + 0.1 ? time : drawn;
	}
	bar_clear();
	for (int j = 0; j < n; j++)
		free(jobs[j].body);
	free(jobs);
	wire_jobs_close(wires);
	return outcome;
}

/* ---- the outputs as CSV ---- */

static void put_value(struct writer *w, double value, char end)
{
	char digits[WRITER_NUMBER_SIZE];
	if (isfinite(value))
		writer_raw(w, digits, (size_t)writer_digits(value, digits));
	writer_raw(w, &end, 1);
}

/* Mean over the replicates of a sample, and the variance of this mean; NAN: a replicate failed. */
static void replicates_mean(const struct evaluation *e, long sample, int output, double *mean,
                            double *variance)
{
	const int n = e->n_replicates;
	const double *value = e->values + sample * n * e->outputs.all + output;
	double sum = 0, squares = 0;
	for (int r = 0; r < n; r++)
		sum += value[r * e->outputs.all];
	*mean = sum / n;
	for (int r = 0; r < n; r++) {
		const double deviation = value[r * e->outputs.all] - *mean;
		squares += deviation * deviation;
	}
	*variance = squares / (n - 1) / n;
}

static char *outputs_csv(const struct evaluation *e, size_t *length)
{
	const int last = e->outputs.all - 1;
	const bool replicated = e->n_replicates > 1;
	struct writer w;
	writer_init(&w);
	for (int o = 0; o <= last; o++) {
		char *variance = command_text("%s.variance", e->names[o]);
		writer_cell(&w, e->names[o]);
		if (replicated) {
			writer_raw(&w, ",", 1);
			writer_cell(&w, variance);
		}
		writer_raw(&w, o < last ? "," : "\n", 1);
		free(variance);
	}
	for (long sample = 0; sample < e->n / e->n_replicates; sample++)
		for (int o = 0; o <= last; o++) {
			double mean = e->values[sample * e->outputs.all + o], variance = NAN;
			if (replicated)
				replicates_mean(e, sample, o, &mean, &variance);
			put_value(&w, mean, o < last || replicated ? ',' : '\n');
			if (replicated)
				put_value(&w, variance, o < last ? ',' : '\n');
		}
	return command_sure(writer_take(&w, length));
}

/* ---- the command ---- */

static enum outcome show_indices(const struct evaluation *e)
{
	struct problems problems;
	size_t n_csv, n;
	char *csv = outputs_csv(e, &n_csv);
	char *json = model_indices(e->study, csv, n_csv, &problems, &n);
	if (e->failed)
		command_complain("%ld of %ld runs failed%s%s", e->failed, e->n, e->failure[0] ? "; the first: " : "",
		                 e->failure);
	const enum outcome outcome =
	    json ? show_result(json, n, e->options) : document_reject(e->options->argument, &problems);
	free(json);
	free(csv);
	return outcome;
}

/* First line of a journal: identifies design, model and settings. */
static char *journal_head(const struct evaluation *e)
{
	char hash[STUDY_HASH_SIZE] = "";
	command_sure(study_hash(e->study, hash) ? hash : NULL);
	return command_text("pound evaluate 1, design %s, model %s, config %s, outputs %d, replicates %d", hash,
	                    e->name, e->config, e->outputs.all, e->n_replicates);
}

static enum outcome evaluate(struct evaluation *e)
{
	enum outcome outcome = take_config(e);
	if (outcome == OUTCOME_OK)
		outcome = find_model(e);
	if (outcome == OUTCOME_OK)
		outcome = read_sizes(e, "/InputSizes", "inputSizes", &e->inputs);
	if (outcome == OUTCOME_OK)
		outcome = read_sizes(e, "/OutputSizes", "outputSizes", &e->outputs);
	if (outcome == OUTCOME_OK && e->inputs.all != e->study->n_inputs)
		outcome = MISTAKEN("%s: the model takes %d inputs, the study has %d", e->url, e->inputs.all,
		                   e->study->n_inputs);
	if (outcome == OUTCOME_OK && e->outputs.all == 0)
		outcome = MISTAKEN("%s: the model has no outputs", e->url);
	if (outcome == OUTCOME_OK)
		outcome = name_outputs(e);
	if (outcome != OUTCOME_OK)
		return outcome;
	e->values = command_sure(calloc((size_t)e->n * (size_t)e->outputs.all, sizeof *e->values));
	e->known = command_sure(calloc((size_t)e->n, sizeof *e->known));
	char *head = journal_head(e);
	e->journal =
	    journal_open(e->options->evaluate.journal, head, e->outputs.all, note_from_journal, e, &outcome);
	free(head);
	if (e->journal)
		outcome = run_all(e);
	return outcome == OUTCOME_OK ? show_indices(e) : outcome;
}

/* `pound evaluate --model URL STUDY.json`: the sensitivity indices of a model on a UM-Bridge server.
 *
 * Test     client_evaluate
 */
enum outcome evaluate_model(const struct options *options)
{
	enum outcome outcome;
	struct pound_study *study = model_study(options->argument, &outcome);
	if (!study)
		return outcome;
	struct evaluation *e = command_sure(calloc(1, sizeof *e));
	study->n_outputs = 0; // the run is only used for its design
	*e = (struct evaluation){.options = options,
	                         .study = study,
	                         .url = options->evaluate.model,
	                         .n_replicates = options->evaluate.replicates ? options->evaluate.replicates : 1,
	                         .design = command_sure(pound_run_create(study, 1))};
	e->n_samples = pound_run_samples(e->design);
	e->n = (long)pound_run_rows(e->design) * e->n_samples * e->n_replicates;
	outcome = study->n_sweeps
	              ? MISTAKEN("/sweep: a study of an external model has one cell, so it cannot have a sweep")
	              : evaluate(e);
	if (e->journal)
		journal_close(e->journal);
	for (int o = 0; e->names && o < e->outputs.all; o++)
		free(e->names[o]);
	free(e->names);
	free(e->values);
	free(e->known);
	free(e->config);
	free(e->name);
	pound_run_free(e->design);
	study_free(study);
	free(e);
	return outcome;
}
