/* The answers of poundd: a function for each row of api_operations.
 *
 * A study is stored as the bytes received, after it was parsed once to check it; a result is sent as the bytes
 * stored. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/figure/figure.h"
#include "schema/json/json_pointer.h"
#include "schema/json/json_writer.h"
#include "schema/json/problems.h"
#include "schema/result/result_json.h"
#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "schema/study/study_status.h"
#include "server/bridge.h"
#include "server/http.h"
#include "server/motion_reply.h"
#include "server/pages.h"
#include "server/records.h"
#include "server/store.h"
#include "server/stored_run.h"
#include "server/token.h"
#include "server/workers.h"

enum {
	RETRY_AFTER = 1,        /* [s] */
	RETRY_AFTER_MAX = 60,   /* [s] */
	RESULT_HEAD = 4096,     /* [bytes] at the start of a result, with its version and rows */
	TABLE_LONG = 64 * 1024, /* [bytes] of a result from which making a table takes milliseconds */
};

static struct reply problem(enum api_fault fault, const char *detail)
{
	return http_problem(fault, detail, NULL);
}

static struct reply no_memory(void)
{
	return problem(API_UNAVAILABLE, "out of memory");
}

/* 200 with a body, or 503 when there was no memory for it (NULL). */
static struct reply made(const char *type, char *body, size_t length)
{
	return body ? (struct reply){.status = 200, .type = type, .body = body, .length = length} : no_memory();
}

static struct reply written(struct writer *writer)
{
	size_t length;
	char *body = writer_take(writer, &length);
	return made("application/json", body, length);
}

static struct reply refusal(enum store_status status)
{
	return http_refusal(status, "there is no such study");
}

/* A list of studies that is being written. */
struct page {
	struct writer writer;
	int n_workers;
	int room;  /* studies that still fit */
	bool more; /* at least one study did not fit */
	// of the study written last
	int64_t id;
	char status[16], etag[64];
	double eta_s; /* [s] NAN: unknown */
};

static void write_status(void *to, const struct study_status *study)
{
	struct page *page = to;
	page->more = page->room-- <= 0;
	if (page->more)
		return;
	page->id = study->id, page->eta_s = study_status_eta(study, page->n_workers);
	snprintf(page->status, sizeof page->status, "%s", study->status);
	snprintf(page->etag, sizeof page->etag, "\"%s-%" PRId64 "%s\"", study->status,
	         study->runs_done + study->queue_position,
	         study_status_over(study->cpu_s, study->cpu_s_estimated) ? "-over" : "");
	study_status_write(&page->writer, study, page->n_workers);
}

static void page_init(struct page *page, const struct request *request, int room)
{
	*page = (struct page){.n_workers = request->server->options->workers, .room = room, .eta_s = NAN};
	writer_init(&page->writer);
}

/* The reply when the store failed or has no such study; discards what was written. */
static struct reply page_drop(struct page *page, enum store_status status)
{
	free(page->writer.text);
	return refusal(status);
}

/* The status object of the request's study as the reply; `page` has its id, status and remaining time. */
static struct reply look(const struct request *request, struct page *page)
{
	page_init(page, request, 1);
	enum store_status found = store_study(request->server->store, request->id, write_status, page);
	if (found != STORE_OK)
		return page_drop(page, found);
	struct reply reply = written(&page->writer);
	memcpy(reply.etag, page->etag, sizeof reply.etag);
	return reply;
}

static struct reply status(struct request *request)
{
	// read before the study, so that a waiting client misses no change
	unsigned changes = store_changes(request->server->store, request->id);
	struct page page;
	struct reply reply = look(request, &page);
	reply.waits = true;
	reply.changes = changes;
	return reply;
}

static struct reply invalid(const struct problems *problems)
{
	char place[64];
	snprintf(place, sizeof place, "line %d, column %d", problems->line, problems->column);
	return problems->status == PROBLEMS_NOMEM ? no_memory()
	       : problems->status == PROBLEMS_MALFORMED
	           ? http_problem(API_MALFORMED, place, problems)
	           : http_problem(API_INVALID, "the study is invalid; the list `errors` says why", problems);
}

/* Queues a study for a client, if there is room for one more. */
static struct reply queue(struct request *request, const struct pound_study *study, const struct cost *cost)
{
	struct store *store = request->server->store;
	const struct options *options = request->server->options;
	const char *key = request->head.key.lines ? request->head.key.value : NULL, *client = request->token;
	char hash[STUDY_HASH_SIZE], own_key[TOKEN_NAME_SIZE + HEAD_TEXT_SIZE];
	int64_t id;
	// two clients may choose the same key
	snprintf(own_key, sizeof own_key, "%s %s", client ? client : "", key ? key : "");
	if (!study_hash(study, hash))
		return no_memory();
	const char *records[STUDY_RECORDS_MAX];
	const struct store_study row = {.kind = study_kind_name(study->kind),
	                                .name = study->name,
	                                .runs = cost->runs,
	                                .cpu_s = cost->cpu_s,
	                                .memory = (int64_t)cost->memory,
	                                .hash = hash,
	                                .key = key ? own_key : NULL,
	                                .client = client,
	                                .records = records,
	                                .n_records = records_named(study, records),
	                                .queue_max = options->queue_max,
	                                .own_max = client ? options->queue_token_max : 0};
	enum store_status submitted = store_submit(store, &row, request->body, request->length, &id);
	if (submitted != STORE_OK && submitted != STORE_REPEATED)
		return refusal(submitted);
	struct page page;
	request->id = id;
	struct reply reply = look(request, &page);
	work_wake(request->server->work);
	reply.status = reply.status == 200 ? 201 : reply.status;
	snprintf(reply.location, sizeof reply.location, "/v1/studies/%016" PRIx64, (uint64_t)id);
	return reply;
}

static struct reply submit(struct request *request)
{
	struct problems problems;
	struct pound_study *study =
	    records_study(request->server->store, request->body, request->length, &problems);
	if (!study)
		return invalid(&problems);
	const struct options *options = request->server->options;
	const struct cost most = options_study_most(options);
	struct cost cost = cost_of(study, options->workers);
	struct reply reply;
	size_t length;
	const bool tried = cost_tried(&cost) && !request->crowded && cost_allowed(&cost, &most, &problems);
	if (tried && request->aside)
		cost_try(&cost, study, request->unwanted);
	if (tried && !request->aside)
		reply = (struct reply){.later = true};
	else if (!cost_allowed(&cost, &most, &problems))
		reply = http_problem(API_TOO_COSTLY, "the study exceeds limits of this server, listed in `errors`",
		                     &problems);
	else if (!strcmp(http_argument(request, "validate_only"), "true")) {
		char *body = cost_to_json(&cost, study, &length);
		reply = made("application/json", body, length);
	} else
		reply = queue(request, study, &cost);
	study_free(study);
	return reply;
}

static struct reply list(struct request *request)
{
	const char *cursor = http_argument(request, "cursor");
	const int limit = atoi(http_argument(request, "limit"));
	const struct store_filter filter = {.status = http_argument(request, "status"),
	                                    .name = http_argument(request, "name"),
	                                    .hash = http_argument(request, "hash"),
	                                    .before = cursor ? strtoll(cursor, NULL, 16) : INT64_MAX,
	                                    // one more than fits, to see whether there is a next page
	                                    .limit = limit + 1};
	struct page page;
	char next[17];
	page_init(&page, request, limit);
	writer_object(&page.writer, NULL, WRITER_LINES);
	writer_array(&page.writer, "studies", WRITER_LINES);
	if (store_list(request->server->store, &filter, write_status, &page) == STORE_FAILED)
		return page_drop(&page, STORE_FAILED);
	snprintf(next, sizeof next, "%016" PRIx64, (uint64_t)page.id);
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

/* Why a stored document cannot be replied. */
static struct reply unread(struct request *request, enum store_status found)
{
	return found == STORE_NONE ? not_ready(request) : refusal(found);
}

/* A stored document, unchanged. */
static struct reply document(struct request *request, const char *name)
{
	char *content;
	size_t length;
	enum store_status found = store_document(request->server->store, request->id, name, &content, &length);
	return found == STORE_OK ? made("application/json", content, length) : unread(request, found);
}

/* A stored document, unchanged, a long one in a file if possible; for a HEAD, or a client that has it, only its length. */
static struct reply document_whole(struct request *request, const char *name, bool known)
{
	struct server *server = request->server;
	struct reply reply = {.status = 200, .type = "application/json"};
	enum store_status found = store_length(server->store, request->id, name, &reply.length);
	if (found != STORE_OK)
		return unread(request, found);
	if (known || !strcmp(request->method, "HEAD"))
		return reply;
	const int file = reply.length >= SPOOL_LONG ? spool_open(&server->spools, reply.length) : -1;
	if (file < 0)
		return document(request, name);
	found = store_document_to(server->store, request->id, name, file);
	if (found == STORE_OK) {
		reply.file = file;
		return reply;
	}
	spool_close(&server->spools, file);
	return unread(request, found);
}

static struct reply posted(struct request *request)
{
	static const char etag[] = "\"request\"";
	struct reply reply = document_whole(request, "request", http_known(request, etag));
	strcpy(reply.etag, reply.status == 200 ? etag : "");
	return reply;
}

static const struct format result_formats[] = {{"json", "application/json"}, {"csv", "text/csv"}};

/* Whether the second of two formats is requested, and the reply without its body.  A result never changes, so its ETag is made
 * of format and version; the ETag of a partial result also has its rows. */
static bool second(const struct request *request, const struct format formats[2], const char *table, int rows,
                   struct reply *reply)
{
	bool is = http_asks_second(request, formats, table);
	*reply = (struct reply){.status = 200, .type = formats[is].type};
	snprintf(reply->etag, sizeof reply->etag, rows ? "\"%s-%s-%d\"" : "\"%s-%s\"",
	         table ? table : formats[is].name, POUND_VERSION, rows);
	return is;
}

/* The reply when a run cannot be opened: temporarily, or because its document is missing, damaged or not for this version. */
static struct reply unopened(struct request *request, const struct stored_run *opened, const char *error)
{
	if (opened->passing)
		return problem(API_UNAVAILABLE, error);
	struct reply reply = document(request, "request");
	if (reply.status != 200)
		return reply;
	free(reply.body);
	return problem(API_CONFLICT, error);
}

/* Opens the run of a study to compute an answer from; it stops when the client no longer waits, and that reply is not sent.
 * Returns NULL, or why it cannot be opened; call stored_run_close in either case. */
static const char *answer_open(const struct request *request, struct stored_run *opened)
{
	return stored_run_open(request->server->store, request->id, 1, request->unwanted, opened);
}

/* The partial result of the completely stored rows; retry_after [s] is for a study without any. */
static struct reply so_far(struct request *request, int retry_after, bool ended, int *rows)
{
	struct server *server = request->server;
	struct partial_result last;
	struct partial_source source;
	struct reply reply;
	// after the end of a study, only a result of all its complete rows will do
	if (partial_results_take(&server->partials, request->id, &last) && (!ended || last.ended)) {
		*rows = last.rows;
		return made("application/json", last.body, last.length);
	}
	const char *error = partial_source_open(server, request->id, request->unwanted, &source);
	source.ended = ended;
	if (!error && source.rows_done > 0) {
		const enum pound_status status =
		    partial_maker_soon(&server->partial_maker, &source, request->id, &last);
		const bool passing = !status || status == POUND_NOMEM || status == POUND_STOPPED;
		*rows = last.rows;
		reply = last.body ? made("application/json", last.body, last.length)
		        : passing ? no_memory()
		                  : problem(API_CONFLICT, "all runs so far failed, so there is no result yet");
		last.body = NULL;
	} else if (error)
		reply = unopened(request, &source.opened, error);
	else {
		reply = problem(API_NOT_READY, pound_study_sampled(source.study)
		                                   ? "no row of the design is complete yet"
		                                   : "this study is not finished; only sensitivity "
		                                     "studies have partial results");
		reply.retry_after = retry_after;
	}
	free(last.body);
	partial_source_close(&source);
	return reply;
}

/* One table of a result as CSV. */
static void tabulate(struct reply *reply, const struct reply *json, const char *table)
{
	char detail[80];
	reply->body = result_to_csv(json->body, json->length, table, &reply->length);
	if (!table || !reply->body || reply->length > 0)
		return;
	free(reply->body);
	snprintf(detail, sizeof detail, "this result has no table \"%s\"", table);
	*reply = problem(API_CONFLICT, detail);
}

/* Replaces the refusal of a missing result by the partial result, if the request asks for it and there is one; `rows` are its
 * rows, 0: not partial. */
static struct reply or_so_far(struct request *request, struct reply json, int *rows)
{
	*rows = 0;
	const bool ended = json.status == 409, waits = json.status == 404 && json.retry_after > 0;
	if ((!ended && !waits) || strcmp(http_argument(request, "partial"), "true") != 0)
		return json;
	struct reply reply = so_far(request, json.retry_after, ended, rows);
	if (ended && reply.status == 404) {
		free(reply.body);
		return json;
	}
	free(json.body);
	return reply;
}

/* The result as JSON. */
static struct reply result(struct request *request, int *rows)
{
	return or_so_far(request, document(request, "result"), rows);
}

static struct reply results(struct request *request)
{
	const char *table = http_argument(request, "table"), *format = http_argument(request, "format");
	if (table && format && strcmp(format, "csv") != 0)
		return problem(API_BAD_REQUEST, "a table is CSV: format must be csv or absent");
	struct reply reply;
	int rows = 0;
	const bool csv = second(request, result_formats, table, rows, &reply);
	struct reply json =
	    csv ? result(request, &rows)
	        : or_so_far(request, document_whole(request, "result", http_known(request, reply.etag)), &rows);
	if (json.status != 200)
		return json;
	if (rows > 0)
		second(request, result_formats, table, rows, &reply);
	if (csv) {
		tabulate(&reply, &json, table);
		free(json.body);
		return reply.body ? reply : no_memory();
	}
	reply.body = json.body;
	reply.file = json.file;
	reply.length = json.length;
	return reply;
}

/* Whether a finished study has samples, without opening its run: for clients that have them already. */
static bool sampled(const struct request *request, bool ours)
{
	struct problems problems;
	char *text;
	size_t length;
	if (store_document(request->server->store, request->id, "request", &text, &length) != STORE_OK)
		return false;
	struct pound_study *study = records_study(request->server->store, text, length, &problems);
	// any version can compute histories again
	bool has = study && samples_exist(study) && (ours || !pound_study_sampled(study));
	if (study)
		study_free(study);
	free(text);
	return has;
}

static struct reply samples(struct request *request)
{
	static const struct format formats[] = {{"csv", "text/csv"}, {"npy", "application/octet-stream"}};
	// a stored result implies that all blocks are stored; its start has the version and the rows, also of a grown design
	char head[RESULT_HEAD];
	struct reply reply;
	enum store_status found = store_start(request->server->store, request->id, "result", head, sizeof head);
	if (found != STORE_OK)
		return unread(request, found);
	const bool ours = strstr(head, "\n  \"engine_version\": \"" POUND_VERSION "\",");
	const char *at = strstr(head, "\"rows\": ");
	const int rows = at ? atoi(at + strlen("\"rows\": ")) : 0;
	bool npy = second(request, formats, NULL, 0, &reply);
	if (http_known(request, reply.etag) && sampled(request, ours))
		return reply;
	struct stored_run opened;
	const char *error = answer_open(request, &opened);
	if (error)
		reply = unopened(request, &opened, error);
	else if (pound_study_sampled(opened.study) && !ours)
		reply =
		    problem(API_CONFLICT, "another version of poundd computed the study, so this one cannot read its "
		                          "samples: submit it again");
	else if (pound_study_sampled(opened.study)) {
		pound_run_rows_take(opened.run, rows);
		const int left = stored_run_left(&opened);
		if (left == 0)
			reply.body = (npy ? samples_to_npy : samples_to_csv)(opened.study, opened.run, &reply.length);
		else
			reply = left == pound_run_blocks(opened.run) && !opened.leftovers
			            ? problem(API_CONFLICT, "the samples of this study are no longer stored")
			            : problem(API_CORRUPT, "stored blocks are damaged");
	} else if (histories_exist(opened.study))
		reply.body =
		    (npy ? histories_to_npy : histories_to_csv)(opened.study, opened.run, -1, &reply.length, &error);
	else
		reply = problem(API_CONFLICT, "samples exist only for sensitivity studies, spectra with histories, "
		                              "and small studies of responses (contacts)");
	stored_run_close(&opened);
	return reply.body ? reply : error ? problem(API_CONFLICT, error) : no_memory();
}

static struct reply motions(struct request *request)
{
	struct stored_run opened;
	const char *error = answer_open(request, &opened);
	struct reply reply = error ? unopened(request, &opened, error) : motions_of(request, &opened);
	stored_run_close(&opened);
	return reply;
}

/* The ETag of a figure: the version, and the rows of a partial result. */
static void tag(struct reply *reply, int rows)
{
	snprintf(reply->etag, sizeof reply->etag, rows ? "\"%s-%d\"" : "\"%s\"", POUND_VERSION, rows);
}

static struct reply figures(struct request *request)
{
	char base[64];
	int rows;
	struct reply json = result(request, &rows);
	if (json.status != 200)
		return json;
	snprintf(base, sizeof base, "/v1/studies/%016" PRIx64, (uint64_t)request->id);
	const struct figure_source source = {
	    .json = json.body, .length = json.length, .samples = !rows && sampled(request, true) ? "" : NULL};
	size_t length;
	char *body = figure_list(&source, base, &length);
	free(json.body);
	struct reply reply = made("application/json", body, length);
	if (body)
		tag(&reply, rows);
	return reply;
}

/* The history of the chosen signal as CSV, computed again; NULL: there is none, or it failed, with a reason if known. */
static char *history(const struct request *request, size_t *length, const char **reason)
{
	struct stored_run opened;
	const char *error = answer_open(request, &opened), *chosen = http_argument(request, "signal");
	const int signal = chosen ? (int)fmin(fmax(strtod(chosen, NULL), 0), POUND_ROWS_MAX) : 0;
	char *csv = NULL;
	if (!error && histories_exist(opened.study))
		csv = histories_to_csv(opened.study, opened.run, signal, length, reason);
	stored_run_close(&opened);
	return csv;
}

static struct reply figure(struct request *request)
{
	static const enum api_fault faults[] = {[FIGURE_ABSENT] = API_CONFLICT,
	                                        [FIGURE_UNKNOWN] = API_NOT_FOUND,
	                                        [FIGURE_CHOICE] = API_BAD_REQUEST,
	                                        [FIGURE_RESULT] = API_CORRUPT,
	                                        [FIGURE_NOMEM] = API_UNAVAILABLE};
	const struct figure_choice choice = {
#define X(name, values, lowest, highest, text) .name = http_argument(request, #name),
	    FIGURE_ARGUMENTS(X)
#undef X
	};
	const char *name = strrchr(request->path, '/') + 1, *reason = NULL;
	struct figure drawn;
	int rows;
	struct reply json = result(request, &rows);
	if (json.status != 200)
		return json;
	struct figure_source source = {.json = json.body, .length = json.length};
	source.samples = figure_row(name)->sampled ? history(request, &source.n_samples, &reason) : NULL;
	enum figure_status status = figure_draw(name, &source, &choice, &drawn);
	free((char *)source.samples);
	free(json.body);
	if (status != FIGURE_DRAWN)
		return problem(faults[status], reason ? reason : drawn.detail);
	struct reply reply = made("image/svg+xml", drawn.svg, drawn.length);
	// the SVG has inline style; opened as a page of its own it may do nothing else
	reply.policy = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'; sandbox";
	tag(&reply, rows);
	return reply;
}

static struct reply cancel(struct request *request)
{
	enum store_status cancelled = store_cancel(request->server->store, request->id);
	if (cancelled == STORE_FAILED || cancelled == STORE_REPLACED)
		return refusal(cancelled);
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
		return refusal(deleted);
	work_drop(request->server->work, request->id);
	return (struct reply){.status = 204};
}

static struct reply version(struct request *request)
{
	static char text[] = "{\"name\": \"poundd\", \"version\": \"" POUND_VERSION "\"}\n";
	(void)request;
	return (struct reply){
	    .status = 200, .type = "application/json", .body = text, .length = sizeof text - 1, .lasts = true};
}

static struct reply live(struct request *request)
{
	return version(request);
}

static struct reply ready(struct request *request)
{
	enum store_status ready = store_ready(request->server->store);
	return ready == STORE_OK ? version(request) : refusal(ready);
}

static struct reply metrics(struct request *request)
{
	size_t length;
	char *body = metrics_text(request->server, &length);
	return made("text/plain; version=0.0.4; charset=utf-8", body, length);
}

static struct reply openapi(struct request *request)
{
	return (struct reply){.status = 200,
	                      .type = "application/json",
	                      .body = request->server->document,
	                      .length = request->server->document_length,
	                      .lasts = true,
	                      .etag = "\"" POUND_VERSION "\""};
}

static struct reply example_list(struct request *request)
{
	(void)request;
	struct reply reply = pages_example_list();
	return reply.body ? reply : no_memory();
}

static struct reply example(struct request *request)
{
	struct reply reply = pages_example(strrchr(request->path, '/') + 1);
	return reply.body ? reply : problem(API_NOT_FOUND, "no such example; /v1/examples lists them");
}

#define PAGE(name)                                    \
	static struct reply name(struct request *request) \
	{                                                 \
		return pages_file(request->operation);        \
	}
PAGE(home)
PAGE(new)
PAGE(study)
PAGE(style)
PAGE(script)
PAGE(icon)
#undef PAGE

/* Whether an answer is slow: made from all blocks of a study or by parsing its result, or a long document. */
bool routes_slow(const struct request *request)
{
	size_t length = 0;
	if (request->operation == API_samples || request->operation == API_motions ||
	    request->operation == API_figures || request->operation == API_figure ||
	    request->operation == API_bridge_evaluate)
		return true;
	// records of 20,000,000 samples take seconds to read
	if (request->operation == API_submit)
		return memmem(request->body, request->length, "\"sha256\"", strlen("\"sha256\""));
	if (request->operation != API_results && request->operation != API_posted)
		return false;
	const bool result = request->operation == API_results;
	const bool there =
	    store_length(request->server->store, request->id, result ? "result" : "request", &length) == STORE_OK;
	if (result && !there)
		return !strcmp(http_argument(request, "partial"), "true");
	if (result && http_asks_second(request, result_formats, http_argument(request, "table")))
		return length >= TABLE_LONG;
	return strcmp(request->method, "HEAD") != 0 && length >= SPOOL_LONG;
}

/* Whether an answer depends on the store alone. */
static bool is_of_store(const struct request *request)
{
	return !strcmp(api_operations[request->operation].method, "GET") &&
	       (request->id || request->operation == API_list);
}

bool routes_kept(const struct request *request, struct reply *reply)
{
	struct server *server = request->server;
	return is_of_store(request) && answer_cache_take(&server->answers, request->question,
	                                                 store_changes(server->store, request->id), reply);
}

/* Answers a request.
 *
 * Given    request   with a head and arguments valid for its operation, and a complete body
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
	struct server *server = request->server;
	unsigned changes = store_changes(server->store, request->id);
	struct reply reply = answers[request->operation](request);
	if (is_of_store(request))
		answer_cache_give(&server->answers, request->question, changes, &reply);
	return reply;
}
