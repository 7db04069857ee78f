/* What poundd answers: a table of method, path and function.
 *
 * A study goes to the store as the bytes that came, after it was read once to see that it is one; a result comes from
 * the store as the bytes that go. */
#include "server/routes.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "engine/pound.h"
#include "schema/problems.h"
#include "schema/result_json.h"
#include "schema/study_json.h"
#include "schema/writer.h"
#include "server/store.h"
#include "server/work.h"

enum {
	LIST_LIMIT = 20, /* studies on a page, unless asked otherwise */
	LIST_LIMIT_MAX = 100,
	RETRY_AFTER = 1,      /* [s] */
	RETRY_AFTER_MAX = 60, /* [s] */
};

/* [s] of one core for a sample interval of one run: `make run` takes 3.5 s for 30,000 runs of 1,020 on average */
static const double INTERVAL_CPU_S = 1.2e-7;

static const struct {
	int status;
	const char *type, *title;
} faults[] = {
#define X(name, status, type, title) [ROUTES_##name] = {status, type, title},
    ROUTES_FAULTS(X)
#undef X
};

static struct reply fault_reply(enum routes_fault fault, const char *detail, const struct problems *problems)
{
	struct problem_head head = {.status = faults[fault].status,
	                            .type = faults[fault].type,
	                            .title = faults[fault].title,
	                            .detail = detail};
	struct reply reply = {.status = head.status, .type = "application/problem+json"};
	reply.body = problem_to_json(&head, problems, &reply.length);
	reply.retry_after = fault == ROUTES_UNAVAILABLE ? RETRY_AFTER : 0;
	return reply;
}

/* The reply that says what is wrong with a request.
 *
 * Given    fault    which of the kinds above
 *          detail   a sentence about this request
 * Returns  value    application/problem+json; its body is allocated
 */
struct reply routes_problem(enum routes_fault fault, const char *detail)
{
	return fault_reply(fault, detail, NULL);
}

static struct reply no_study(void)
{
	return routes_problem(ROUTES_NOT_FOUND, "there is no such study");
}

static struct reply unavailable(void)
{
	return routes_problem(ROUTES_UNAVAILABLE, "the database does not answer; please try again");
}

/* 200 and what was written. */
static struct reply written(struct writer *writer)
{
	struct reply reply = {.status = 200, .type = "application/json"};
	reply.body = writer_take(writer, &reply.length);
	return reply.body ? reply : routes_problem(ROUTES_UNAVAILABLE, "out of memory");
}

/* Studies being written, one after the other. */
struct page {
	struct writer writer;
	int n_workers;
	int room;  /* studies to write yet */
	bool more; /* one came when there was no room */
	// of the one written last
	int64_t last;    /* its id */
	char status[16]; /* its status */
	char etag[64];
	double eta_s; /* [s] NAN: unknown */
};

static void status_object(void *to, const struct store_study *study)
{
	static const char *const links[] = {"request", "results", "samples", "cancel"};
	struct page *page = to;
	struct writer *w = &page->writer;
	char id[17], link[64];
	if (page->room-- <= 0) {
		page->more = true;
		return;
	}
	bool succeeded = !strcmp(study->status, "succeeded");
	bool running = !strcmp(study->status, "running");
	int64_t runs_done = succeeded ? study->runs : study->runs_done;
	int64_t runs_left = study->runs - runs_done;
	page->last = study->id;
	page->eta_s = running && runs_done > 0
	                  ? study->cpu_s / (double)runs_done * (double)runs_left / page->n_workers
	                  : NAN;
	snprintf(id, sizeof id, "%016" PRIx64, (uint64_t)study->id);
	snprintf(page->status, sizeof page->status, "%s", study->status);
	snprintf(page->etag, sizeof page->etag, "\"%s-%" PRId64 "\"", study->status, runs_done);
	writer_object(w, NULL, WRITER_LINES);
	writer_text(w, "id", id);
	writer_text(w, "name", study->name);
	writer_text(w, "kind", study->kind);
	writer_text(w, "status", study->status);
	writer_number(w, "progress", (double)runs_done / (double)study->runs);
	writer_whole(w, "runs_done", runs_done);
	writer_whole(w, "runs_total", study->runs);
	writer_number(w, "eta_s", page->eta_s);
	writer_text(w, "created", study->created);
	writer_text(w, "started", study->started);
	writer_text(w, "finished", study->finished);
	writer_text(w, "error", study->error);
	writer_object(w, "links", WRITER_LINE);
	snprintf(link, sizeof link, "/v1/studies/%s", id);
	writer_text(w, "self", link);
	for (size_t i = 0; i < sizeof links / sizeof links[0]; i++) {
		snprintf(link, sizeof link, "/v1/studies/%s/%s", id, links[i]);
		writer_text(w, links[i], link);
	}
	writer_end(w);
	writer_end(w);
}

static void page_init(struct page *page, const struct request *request, int room)
{
	*page = (struct page){.n_workers = request->server->n_workers, .room = room, .eta_s = NAN};
	writer_init(&page->writer);
}

static void page_drop(struct page *page)
{
	size_t length;
	free(writer_take(&page->writer, &length));
}

/* The status object of the request's study, and what is known of it besides. */
static struct reply look(const struct request *request, struct page *page)
{
	page_init(page, request, 1);
	enum store_status found = store_study(request->server->store, request->id, status_object, page);
	if (found != STORE_OK) {
		page_drop(page);
		return found == STORE_NONE ? no_study() : unavailable();
	}
	struct reply reply = written(&page->writer);
	memcpy(reply.etag, page->etag, sizeof reply.etag);
	return reply;
}

static struct reply status(struct request *request)
{
	struct page page;
	struct reply reply = look(request, &page);
	const char *known = http_header(request, "If-None-Match");
	if (reply.status != 200 || !known || strcmp(known, reply.etag) != 0)
		return reply;
	free(reply.body);
	reply.status = 304;
	reply.body = NULL;
	reply.length = 0;
	return reply;
}

static struct reply estimate(const struct pound_study *study)
{
	struct writer w;
	double runs = (double)study_runs(study);
	double intervals = study_steps(study);
	// what is stored of a run: its part of two means for each output, or all its measures
	size_t bytes = study->kind == POUND_KIND_SENSITIVITY ? 2 * (size_t)study->n_outputs * sizeof(double)
	                                                     : sizeof(struct pound_response);
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "kind", study_kind_name(study->kind));
	writer_number(&w, "runs_total", runs);
	writer_number(&w, "estimated_cpu_s", runs * intervals * INTERVAL_CPU_S);
	writer_number(&w, "estimated_bytes", runs * (double)bytes);
	writer_end(&w);
	return written(&w);
}

static struct reply invalid(const struct problems *problems)
{
	char place[64];
	switch (problems->status) {
	case PROBLEMS_MALFORMED:
		snprintf(place, sizeof place, "line %d, column %d", problems->line, problems->column);
		return fault_reply(ROUTES_MALFORMED, place, problems);
	case PROBLEMS_INVALID:
		return fault_reply(ROUTES_INVALID, "the study has faults, listed in errors", problems);
	case PROBLEMS_NOMEM:
	case PROBLEMS_NONE:
		break;
	}
	return routes_problem(ROUTES_UNAVAILABLE, "out of memory");
}

static struct reply queue(struct request *request, const struct pound_study *study)
{
	struct store_study row = {
	    .kind = study_kind_name(study->kind), .name = study->name, .runs = study_runs(study)};
	char hash[STUDY_HASH_SIZE];
	if (!study_hash(study, hash))
		return routes_problem(ROUTES_UNAVAILABLE, "out of memory");
	if (store_submit(request->server->store, &row, hash, request->body, request->length, &request->id) !=
	    STORE_OK)
		return unavailable();
	struct page page;
	struct reply reply = look(request, &page);
	work_wake(request->server->work);
	reply.status = reply.status == 200 ? 201 : reply.status;
	snprintf(reply.location, sizeof reply.location, "/v1/studies/%016" PRIx64, (uint64_t)request->id);
	return reply;
}

static struct reply submit(struct request *request)
{
	const char *only = http_argument(request, "validate_only");
	if (only && strcmp(only, "true") != 0 && strcmp(only, "false") != 0)
		return routes_problem(ROUTES_BAD_REQUEST, "validate_only must be true or false");
	struct problems problems;
	struct pound_study *study = study_from_json(request->body, request->length, &problems);
	if (!study)
		return invalid(&problems);
	struct reply reply = only && !strcmp(only, "true") ? estimate(study) : queue(request, study);
	study_free(study);
	return reply;
}

/* A whole number of the path's arguments in [min, max]; false: it is something else. */
static bool whole(const struct request *request, const char *name, int min, int max, int *value)
{
	const char *text = http_argument(request, name);
	char *rest;
	if (!text)
		return true;
	long number = strtol(text, &rest, 10);
	*value = (int)number;
	return rest != text && !*rest && number >= min && number <= max;
}

/* 16 hexadecimal digits at `text`: the id they stand for, else -1. */
static int64_t id_at(const char *text)
{
	if (strspn(text, "0123456789abcdef") < 16)
		return -1;
	char digits[17] = {0};
	memcpy(digits, text, 16);
	int64_t id = (int64_t)strtoull(digits, NULL, 16);
	return id < 0 ? -1 : id;
}

static struct reply list(struct request *request)
{
	static const char *const states[] = {"queued", "running", "succeeded", "failed", "cancelled"};
	const char *wanted = http_argument(request, "status");
	const char *cursor = http_argument(request, "cursor");
	int64_t before = cursor && strlen(cursor) == 16 ? id_at(cursor) : -1;
	int limit = LIST_LIMIT;
	bool known = !wanted;
	for (size_t i = 0; i < sizeof states / sizeof states[0]; i++)
		known = known || !strcmp(wanted, states[i]);
	if (!known)
		return routes_problem(ROUTES_BAD_REQUEST,
		                      "status must be queued, running, succeeded, failed or cancelled");
	if (!whole(request, "limit", 1, LIST_LIMIT_MAX, &limit))
		return routes_problem(ROUTES_BAD_REQUEST, "limit must be a whole number in [1, 100]");
	if (cursor && before < 0)
		return routes_problem(ROUTES_BAD_REQUEST, "cursor must be the 'next' of an earlier page");

	struct page page;
	char next[17];
	page_init(&page, request, limit);
	writer_object(&page.writer, NULL, WRITER_LINES);
	writer_array(&page.writer, "studies", WRITER_LINES);
	// one more than fits, to see whether there is a next page
	if (store_list(request->server->store, wanted, cursor ? before : INT64_MAX, limit + 1, status_object,
	               &page) == STORE_FAILED) {
		page_drop(&page);
		return unavailable();
	}
	snprintf(next, sizeof next, "%016" PRIx64, (uint64_t)page.last);
	writer_end(&page.writer);
	writer_text(&page.writer, "next", page.more ? next : NULL);
	writer_end(&page.writer);
	return written(&page.writer);
}

/* Why a study has no results: not yet, or never. */
static struct reply not_ready(struct request *request)
{
	struct page page;
	struct reply reply = look(request, &page);
	if (reply.status != 200)
		return reply;
	free(reply.body);
	if (!strcmp(page.status, "failed") || !strcmp(page.status, "cancelled"))
		return routes_problem(ROUTES_CONFLICT, "the study failed or was cancelled: it has no results");
	reply = routes_problem(ROUTES_NOT_READY, "the study is not finished yet");
	reply.retry_after = (int)fmin(fmax(ceil(page.eta_s), RETRY_AFTER), RETRY_AFTER_MAX);
	return reply;
}

/* A stored document as it is; its status when that is not 200. */
static struct reply document(struct request *request, const char *name)
{
	struct reply reply = {.status = 200, .type = "application/json"};
	enum store_status found =
	    store_document(request->server->store, request->id, name, &reply.body, &reply.length);
	return found == STORE_OK        ? reply
	       : found == STORE_NONE    ? not_ready(request)
	       : found == STORE_CORRUPT ? routes_problem(ROUTES_CORRUPT, "the stored bytes are damaged")
	                                : unavailable();
}

static struct reply posted(struct request *request)
{
	return document(request, "request");
}

struct format {
	const char *name, *type;
};

/* The format asked for by ?format= or Accept, the first one when neither says; NULL: an unknown one. */
static const struct format *format(const struct request *request, const struct format formats[2])
{
	const char *name = http_argument(request, "format");
	const char *accept = http_header(request, "Accept");
	for (int i = 0; name && i < 2; i++)
		if (!strcmp(name, formats[i].name))
			return &formats[i];
	if (name)
		return NULL;
	for (int i = 0; accept && i < 2; i++)
		if (strcasestr(accept, formats[i].type))
			return &formats[i];
	return &formats[0];
}

static struct reply results(struct request *request)
{
	static const struct format formats[] = {{"json", "application/json"}, {"csv", "text/csv"}};
	const struct format *wanted = format(request, formats);
	if (!wanted)
		return routes_problem(ROUTES_BAD_REQUEST, "format must be json or csv");
	struct reply json = document(request, "result");
	if (json.status != 200 || wanted == &formats[0])
		return json;
	struct reply reply = {.status = 200, .type = wanted->type};
	reply.body = result_to_csv(json.body, json.length, &reply.length);
	free(json.body);
	return reply.body ? reply : routes_problem(ROUTES_UNAVAILABLE, "out of memory");
}

static struct reply samples(struct request *request)
{
	static const struct format formats[] = {{"csv", "text/csv"}, {"npy", "application/octet-stream"}};
	const struct format *wanted = format(request, formats);
	if (!wanted)
		return routes_problem(ROUTES_BAD_REQUEST, "format must be csv or npy");
	// a result says that all blocks are there
	struct reply reply = document(request, "result");
	if (reply.status != 200)
		return reply;
	free(reply.body);
	struct work_run opened;
	const char *error = work_open(request->server->store, request->id, 1, &opened);
	reply = (struct reply){.status = 200, .type = wanted->type};
	bool sampled = !error && opened.study->kind == POUND_KIND_SENSITIVITY;
	if (sampled && opened.n_left == 0)
		reply.body = (wanted == &formats[0] ? samples_to_csv : samples_to_npy)(opened.study, opened.run,
		                                                                       &reply.length);
	if (error)
		reply = routes_problem(ROUTES_UNAVAILABLE, error);
	else if (!sampled)
		reply = routes_problem(ROUTES_CONFLICT, "only a sensitivity study has samples");
	else if (opened.n_left > 0)
		reply = routes_problem(ROUTES_CORRUPT, "stored blocks are damaged or of another version");
	else if (!reply.body)
		reply = routes_problem(ROUTES_UNAVAILABLE, "out of memory");
	work_close(&opened);
	return reply;
}

static struct reply cancel(struct request *request)
{
	enum store_status cancelled = store_cancel(request->server->store, request->id);
	if (cancelled == STORE_FAILED)
		return unavailable();
	if (cancelled == STORE_OK)
		work_drop(request->server->work, request->id);
	struct page page;
	struct reply reply = look(request, &page);
	if (reply.status != 200 || !strcmp(page.status, "cancelled"))
		return reply;
	free(reply.body);
	return routes_problem(ROUTES_CONFLICT, "the study is finished");
}

static struct reply delete (struct request *request)
{
	enum store_status deleted = store_delete(request->server->store, request->id);
	if (deleted != STORE_OK)
		return deleted == STORE_NONE ? no_study() : unavailable();
	work_drop(request->server->work, request->id);
	return (struct reply){.status = 204};
}

static struct reply live(struct request *request)
{
	struct writer w;
	(void)request;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINE);
	writer_text(&w, "name", "poundd");
	writer_text(&w, "version", POUND_VERSION);
	writer_end(&w);
	return written(&w);
}

static struct reply ready(struct request *request)
{
	struct page page;
	struct reply one = look(request, &page);
	free(one.body);
	// no study has the id 0, and to say so the database must answer
	return one.status == 404 ? live(request) : unavailable();
}

static const struct route {
	const char *method, *path; /* {id} stands for 16 hexadecimal digits */
	bool takes_json;
	struct reply (*answer)(struct request *request);
} routes[] = {
    {"POST", "/v1/studies", true, submit},
    {"GET", "/v1/studies", false, list},
    {"GET", "/v1/studies/{id}", false, status},
    {"DELETE", "/v1/studies/{id}", false, delete},
    {"GET", "/v1/studies/{id}/request", false, posted},
    {"GET", "/v1/studies/{id}/results", false, results},
    {"GET", "/v1/studies/{id}/samples", false, samples},
    {"POST", "/v1/studies/{id}/cancel", false, cancel},
    {"GET", "/livez", false, live},
    {"GET", "/readyz", false, ready},
    {"GET", "/version", false, live},
};

/* Whether a path is of a form, and the id in it. */
static bool matches(const char *path, const char *form, int64_t *id)
{
	size_t head = strcspn(form, "{");
	if (!form[head])
		return !strcmp(path, form);
	if (strncmp(path, form, head) != 0 || (*id = id_at(path + head)) < 0)
		return false;
	return !strcmp(path + head + 16, form + head + strlen("{id}"));
}

static bool is_json(const char *type)
{
	static const char json[] = "application/json";
	size_t n = sizeof json - 1;
	return type && !strncasecmp(type, json, n) && (type[n] == '\0' || type[n] == ';' || type[n] == ' ');
}

/* Answers a request whose body has been read.
 *
 * Given    request
 * Returns  value     the reply; its body is allocated
 * Test     service_routes: every_route_answers_only_its_methods
 */
struct reply routes_answer(struct request *request)
{
	const char *method = strcmp(request->method, "HEAD") != 0 ? request->method : "GET";
	char allow[64] = "";
	for (size_t i = 0; i < sizeof routes / sizeof routes[0]; i++) {
		const struct route *route = &routes[i];
		if (!matches(request->path, route->path, &request->id))
			continue;
		if (!strcmp(method, route->method)) {
			if (route->takes_json && !is_json(http_header(request, "Content-Type")))
				return routes_problem(ROUTES_NOT_JSON, "Content-Type must be application/json");
			return route->answer(request);
		}
		strcat(strcat(allow, allow[0] ? ", " : ""), route->method);
		strcat(allow, !strcmp(route->method, "GET") ? ", HEAD" : "");
	}
	if (!allow[0])
		return routes_problem(ROUTES_NOT_FOUND, "there is no such path");
	struct reply reply = routes_problem(ROUTES_NOT_ALLOWED, "this path does not take that method");
	memcpy(reply.allow, allow, sizeof reply.allow);
	return reply;
}
