/* What poundd answers: a function for each row of api_operations.
 *
 * A study goes to the store as the bytes that came, after it was read once to see that it is one; a result comes from
 * the store as the bytes that go. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "engine/pound.h"
#include "schema/cost.h"
#include "schema/problems.h"
#include "schema/result_json.h"
#include "schema/study_json.h"
#include "schema/writer.h"
#include "server/cache.h"
#include "server/connection.h"
#include "server/http.h"
#include "server/store.h"
#include "server/work.h"

enum {
	RETRY_AFTER = 1,      /* [s] */
	RETRY_AFTER_MAX = 60, /* [s] */
	KEY_MAX = 200,        /* characters of an Idempotency-Key */
	MIB = 1 << 20,
};

static struct reply problem(enum api_fault fault, const char *detail)
{
	return http_problem(fault, detail, NULL);
}

static struct reply no_study(void)
{
	return problem(API_NOT_FOUND, "there is no such study");
}

static struct reply no_memory(void)
{
	return problem(API_UNAVAILABLE, "out of memory");
}

static struct reply unavailable(void)
{
	return problem(API_UNAVAILABLE, "the database does not answer; please try again");
}

static struct reply full(void)
{
	return problem(API_UNAVAILABLE, "the disk has no room for new studies");
}

/* 200 and what was written. */
static struct reply written(struct writer *writer)
{
	struct reply reply = {.status = 200, .type = "application/json"};
	reply.body = writer_take(writer, &reply.length);
	return reply.body ? reply : no_memory();
}

/* The reply, or 304 when the client has it. */
static struct reply unless_known(const struct request *request, struct reply reply)
{
	if (reply.status != 200 || !http_known(request, reply.etag))
		return reply;
	free(reply.body);
	reply.status = 304;
	reply.body = NULL;
	reply.length = 0;
	return reply;
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
	*page = (struct page){.n_workers = request->server->options->workers, .room = room, .eta_s = NAN};
	writer_init(&page->writer);
}

/* What was written so far is not wanted; it may be half an object. */
static void page_drop(struct page *page)
{
	free(page->writer.text);
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

/* The status object, from the cache when nothing has changed since it was put there. */
static struct reply look_again(const struct request *request, unsigned changes)
{
	struct page page;
	struct cached told;
	struct reply reply = {.status = 200, .type = "application/json"};
	if (cache_find(request->server->cache, request->id, changes, &told)) {
		reply.body = malloc(told.length);
		reply.length = told.length;
		memcpy(reply.etag, told.etag, sizeof reply.etag);
		if (!reply.body)
			return no_memory();
		memcpy(reply.body, told.body, told.length);
		return reply;
	}
	reply = look(request, &page);
	if (reply.status != 200 || reply.length > CACHE_BODY_MAX)
		return reply;
	told.id = request->id;
	told.changes = changes;
	told.length = reply.length;
	memcpy(told.etag, reply.etag, sizeof told.etag);
	memcpy(told.body, reply.body, reply.length);
	cache_keep(request->server->cache, &told);
	return reply;
}

static struct reply status(struct request *request)
{
	unsigned changes = store_changes(request->server->store, request->id);
	struct reply reply = unless_known(request, look_again(request, changes));
	reply.changes = changes;
	if (reply.status == 304 && http_waits(request))
		reply.status = REPLY_WAIT;
	return reply;
}

static struct reply estimate(const struct pound_study *study, const struct cost *cost)
{
	struct writer w;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "kind", study_kind_name(study->kind));
	writer_whole(&w, "runs_total", cost->runs);
	writer_number(&w, "estimated_cpu_s", cost->cpu_s);
	writer_number(&w, "estimated_bytes", ceil(cost->bytes));
	writer_end(&w);
	return written(&w);
}

/* Every limit that a study would go over. */
static void check_cost(const struct options *options, const struct cost *cost, struct problems *problems)
{
	const struct {
		double asked, most;
		const char *what, *option;
	} limits[] = {
	    {(double)cost->runs, options->runs_max, "pounding runs", "runs-max"},
	    {cost->cpu_s, options->cpu_max, "estimated seconds of one core", "cpu-max"},
	    {cost->bytes / MIB, options->result_max, "estimated MiB in the database", "result-max"},
	};
	problems_init(problems);
	for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
		if (limits[i].asked > limits[i].most)
			problems_add(problems, "", "asks for %.6g %s, this server takes at most %.6g (--%s)",
			             limits[i].asked, limits[i].what, limits[i].most, limits[i].option);
}

static struct reply invalid(const struct problems *problems)
{
	char place[64];
	switch (problems->status) {
	case PROBLEMS_MALFORMED:
		snprintf(place, sizeof place, "line %d, column %d", problems->line, problems->column);
		return http_problem(API_MALFORMED, place, problems);
	case PROBLEMS_INVALID:
		return http_problem(API_INVALID, "the study has faults, listed in errors", problems);
	case PROBLEMS_NOMEM:
	case PROBLEMS_NONE:
		break;
	}
	return no_memory();
}

/* Whether the queue has room for one more study of a client; the reply when it has not. */
static bool roomy(const struct request *request, struct reply *reply)
{
	struct store *store = request->server->store;
	const struct options *options = request->server->options;
	int64_t all, own = 0;
	if (store_count(store, "queued", NULL, &all) == STORE_FAILED ||
	    (request->token && store_count(store, "queued", request->token, &own) == STORE_FAILED))
		*reply = unavailable();
	else if (all >= options->queue_max)
		*reply = problem(API_UNAVAILABLE, "as many studies are queued as this server takes");
	else if (own >= options->queue_token_max)
		*reply = problem(API_TOO_MANY, "as many studies are queued as this server takes from one token");
	else
		return true;
	return false;
}

static struct reply queue(struct request *request, const struct pound_study *study)
{
	struct server *server = request->server;
	const char *key = http_header(request, "Idempotency-Key");
	char hash[STUDY_HASH_SIZE], own_key[KEY_MAX + 32];
	// two clients may choose the same key
	snprintf(own_key, sizeof own_key, "%s %s", request->token ? request->token : "", key ? key : "");
	struct store_study row = {.kind = study_kind_name(study->kind),
	                          .name = study->name,
	                          .runs = study_runs(study),
	                          .key = key ? own_key : NULL,
	                          .client = request->token};
	int64_t id;
	struct reply reply;
	if (key && (!*key || strlen(key) > KEY_MAX))
		return problem(API_BAD_REQUEST, "an Idempotency-Key has 1 to 200 characters");
	if (!study_hash(study, hash))
		return no_memory();
	if (!roomy(request, &reply))
		return reply;
	enum store_status submitted =
	    store_submit(server->store, &row, hash, request->body, request->length, &id);
	if (submitted == STORE_CLASH)
		return problem(API_KEY_REUSED, "this Idempotency-Key came with another body before");
	if (submitted == STORE_FULL)
		return full();
	if (submitted != STORE_OK && submitted != STORE_REPEATED)
		return unavailable();
	struct page page;
	request->id = id;
	reply = look(request, &page);
	work_wake(server->work);
	reply.status = reply.status == 200 ? 201 : reply.status;
	snprintf(reply.location, sizeof reply.location, "/v1/studies/%016" PRIx64, (uint64_t)id);
	return reply;
}

static struct reply submit(struct request *request)
{
	struct problems problems;
	struct pound_study *study = study_from_json(request->body, request->length, &problems);
	if (!study)
		return invalid(&problems);
	const struct cost cost = cost_of(study);
	check_cost(request->server->options, &cost, &problems);
	struct reply reply =
	    problems.n ? http_problem(API_TOO_COSTLY, "the study is over limits of this server, listed in errors",
	                              &problems)
	    : !strcmp(http_argument(request, "validate_only"), "true") ? estimate(study, &cost)
	                                                               : queue(request, study);
	study_free(study);
	return reply;
}

static struct reply list(struct request *request)
{
	const char *cursor = http_argument(request, "cursor");
	int limit = atoi(http_argument(request, "limit"));
	int64_t before = cursor ? (int64_t)strtoull(cursor, NULL, 16) : INT64_MAX;
	if (cursor && (strlen(cursor) != 16 || strspn(cursor, "0123456789abcdef") != 16 || before < 0))
		return problem(API_BAD_REQUEST, "cursor must be the next of an earlier page");

	struct page page;
	char next[17];
	page_init(&page, request, limit);
	writer_object(&page.writer, NULL, WRITER_LINES);
	writer_array(&page.writer, "studies", WRITER_LINES);
	// one more than fits, to see whether there is a next page
	if (store_list(request->server->store, http_argument(request, "status"), before, limit + 1, status_object,
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
		return problem(API_CONFLICT, "the study failed or was cancelled: it has no results");
	reply = problem(API_NOT_READY, "the study is not finished yet");
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
	       : found == STORE_CORRUPT ? problem(API_CORRUPT, "the stored bytes are damaged")
	                                : unavailable();
}

static struct reply posted(struct request *request)
{
	struct reply reply = document(request, "request");
	if (reply.status == 200)
		strcpy(reply.etag, "\"request\"");
	return unless_known(request, reply);
}

/* Whether the second of two formats is asked for, by ?format= or Accept; a result never changes, so that format and
 * version are its tag. */
static bool second(const struct request *request, const char *const types[2], const char *const names[2],
                   struct reply *reply)
{
	const char *name = http_argument(request, "format"), *accept = http_header(request, "Accept");
	bool is = name ? !strcmp(name, names[1])
	               : accept && strcasestr(accept, types[1]) && !strcasestr(accept, types[0]);
	*reply = (struct reply){.status = 200, .type = types[is]};
	snprintf(reply->etag, sizeof reply->etag, "\"%s-%s\"", names[is], POUND_VERSION);
	return is;
}

/* The result of the rows that are stored whole; `unready`, which says that there is none yet, while there is no row. */
static struct reply so_far(struct request *request, struct reply unready, int *rows)
{
	struct work_run opened;
	struct reply reply = {.status = 200};
	const char *error = work_open(request->server->store, request->id, 1, &opened);
	bool sampled = !error && opened.study->kind == POUND_KIND_SENSITIVITY;
	*rows = sampled ? pound_run_rows_done(opened.run, opened.stored) : 0;
	if (*rows > 0) {
		enum pound_status status = POUND_OK;
		pound_run_rows_take(opened.run, *rows);
		for (int k = 0; k < pound_run_reductions(opened.run) && !status; k++)
			status = pound_run_reduce(opened.run, k, 0);
		if (!status)
			reply.body = result_to_json(opened.study, pound_run_result(opened.run), NULL, &reply.length);
		free(unready.body);
		unready = status == POUND_NOMEM || (!status && !reply.body) ? no_memory()
		          : status ? problem(API_CONFLICT, "none of the runs so far has a result")
		                   : reply;
	}
	work_close(&opened);
	return unready;
}

static struct reply results(struct request *request)
{
	static const char *const types[] = {"application/json", "text/csv"}, *const names[] = {"json", "csv"};
	struct reply reply, json = document(request, "result");
	int rows = 0;
	if (json.status == 404 && json.retry_after > 0 && !strcmp(http_argument(request, "partial"), "true"))
		json = so_far(request, json, &rows);
	if (json.status != 200)
		return json;
	bool csv = second(request, types, names, &reply);
	if (rows > 0)
		snprintf(reply.etag, sizeof reply.etag, "\"%s-%s-%d\"", names[csv], POUND_VERSION, rows);
	reply.body = csv ? result_to_csv(json.body, json.length, &reply.length) : json.body;
	if (csv)
		free(json.body);
	else
		reply.length = json.length;
	return reply.body ? unless_known(request, reply) : no_memory();
}

static struct reply samples(struct request *request)
{
	static const char *const types[] = {"text/csv", "application/octet-stream"}, *const names[] = {"csv",
	                                                                                               "npy"};
	// a result says that all blocks are there
	struct reply reply = document(request, "result");
	if (reply.status != 200)
		return reply;
	free(reply.body);
	bool npy = second(request, types, names, &reply);
	reply = unless_known(request, reply);
	if (reply.status != 200)
		return reply;
	struct work_run opened;
	const char *error = work_open(request->server->store, request->id, 1, &opened);
	bool sampled = !error && opened.study->kind == POUND_KIND_SENSITIVITY;
	bool told = !error && opened.study->spectrum.histories;
	if (sampled)
		work_finished(&opened);
	if (told)
		reply.body = (npy ? histories_to_npy : histories_to_csv)(opened.study, opened.run, &reply.length);
	else if (sampled && opened.n_left == 0)
		reply.body = (npy ? samples_to_npy : samples_to_csv)(opened.study, opened.run, &reply.length);
	if (error)
		reply = problem(API_UNAVAILABLE, error);
	else if (!sampled && !told)
		reply =
		    problem(API_CONFLICT, "only a sensitivity study has samples, and floor spectra with histories");
	else if (sampled && opened.n_left > 0)
		reply = problem(API_CORRUPT, "stored blocks are damaged or of another version");
	else if (!reply.body)
		reply = no_memory();
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
	return problem(API_CONFLICT, "the study is finished");
}

static struct reply erase(struct request *request)
{
	enum store_status deleted = store_delete(request->server->store, request->id);
	if (deleted != STORE_OK)
		return deleted == STORE_NONE ? no_study() : unavailable();
	work_drop(request->server->work, request->id);
	return (struct reply){.status = 204};
}

static struct reply version(struct request *request)
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

static struct reply live(struct request *request)
{
	return version(request);
}

static struct reply ready(struct request *request)
{
	enum store_status ready = store_ready(request->server->store);
	return ready == STORE_OK ? version(request) : ready == STORE_FULL ? full() : unavailable();
}

static struct reply metrics(struct request *request)
{
	static const char *const states[] = {"queued", "running", "succeeded", "failed", "cancelled"};
	enum { STATES = sizeof states / sizeof states[0], ALL = STATES + 2 };
	struct server *server = request->server;
	struct metrics_value values[ALL] = {
	    [STATES] = {"pound_http_connections", "gauge", NULL, "Open connections.",
	                connections_open(server->connections)},
	    [STATES + 1] = {"pound_http_connections_late_total", "counter", NULL,
	                    "Connections closed for being too slow.", connections_late(server->connections)}};
	char labels[STATES][32];
	for (int i = 0; i < STATES; i++) {
		int64_t n;
		if (store_count(server->store, states[i], NULL, &n) == STORE_FAILED)
			return unavailable();
		snprintf(labels[i], sizeof labels[i], "status=\"%s\"", states[i]);
		values[i] = (struct metrics_value){"pound_studies", "gauge", labels[i],
		                                   i ? NULL : "Studies, by status.", (double)n};
	}
	struct reply reply = {.status = 200, .type = "text/plain; version=0.0.4; charset=utf-8"};
	reply.body = metrics_text(&server->metrics, values, ALL, &reply.length);
	return reply.body ? reply : no_memory();
}

static struct reply openapi(struct request *request)
{
	struct reply reply = {.status = 200, .type = "application/json", .etag = "\"" POUND_VERSION "\""};
	reply.body = api_document(&reply.length);
	return reply.body ? unless_known(request, reply) : no_memory();
}

/* Answers a request.
 *
 * Given    request   whose head and arguments are those of its operation, and whose body is read
 * Returns  value     the reply; its body is allocated
 * Test     service_routes: every_route_answers_only_its_methods
 */
struct reply routes_answer(struct request *request)
{
	static struct reply (*const answers[])(struct request *) = {
#define X(operation) [API_##operation] = operation,
	    API_OPERATIONS(X)
#undef X
	};
	return answers[request->operation](request);
}
