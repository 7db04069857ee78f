/* query.c - status, results and samples of studies on the server; cancelling and deleting studies.
 *
 * JSON and CSV from the server are printed unchanged. */
#include "client/answer.h"
#include "client/follow.h"
#include "client/show.h"
#include "client/table.h"
#include "schema/json/json_pointer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HTTP_CONFLICT = 409 };

// columns of the list of studies, named by the members of the status object
static const struct {
	const char *member;
	enum { TEXT, NUMBER, YES } type; // YES: prints "yes" if true
	bool more;                       // left out of a table with several studies, to keep one line per study
} COLUMNS[] = {
    {"id", TEXT, false},
    {"status", TEXT, false},
    {"progress", NUMBER, false},
    {"runs_done", NUMBER, true},
    {"runs_total", NUMBER, true},
    {"over_estimate", YES, true},
    {"queue_position", NUMBER, true},
    {"expected_start", TEXT, true},
    {"created", TEXT, false},
    {"kind", TEXT, true},
    {"name", TEXT, false},
};

enum { N_COLUMNS = sizeof COLUMNS / sizeof COLUMNS[0] };

/* Prints the status objects of an answer: one, or the list under /studies. */
static enum outcome print_studies(const struct wire_reply *reply, const char *format)
{
	if (strcmp(format, "json") == 0) {
		fwrite(reply->body, 1, reply->n_body, stdout);
		return OUTCOME_OK;
	}
	struct reading *answer = reading_open(reply->body, reply->n_body);
	bool list = reading_has(answer, "/studies"), csv = strcmp(format, "csv") == 0;
	const char *names[N_COLUMNS + 1] = {0};
	int columns[N_COLUMNS], n_columns = 0;
	for (int c = 0; c < N_COLUMNS; c++)
		if (csv || !list || !COLUMNS[c].more) {
			names[n_columns] = COLUMNS[c].member;
			columns[n_columns++] = c;
		}
	struct table *table = table_open(1, names);
	for (int i = 0; i < (list ? reading_count(answer, "/studies") : 1); i++) {
		char study[32] = "";
		if (list)
			snprintf(study, sizeof study, "/studies/%d", i);
		for (int k = 0; k < n_columns; k++) {
			const char *member = COLUMNS[columns[k]].member;
			if (COLUMNS[columns[k]].type == NUMBER)
				table_number(table, reading_number(answer, "%s/%s", study, member));
			else if (COLUMNS[columns[k]].type == YES)
				table_text(table, reading_true(answer, "%s/%s", study, member) ? "yes" : "");
			else
				table_text(table, reading_text(answer, "%s/%s", study, member));
		}
	}
	if (csv)
		table_print_csv(table);
	else
		table_print(table, 0);
	table_close(table);
	if (reading_text(answer, "/next"))
		command_complain("more: --cursor %s", reading_text(answer, "/next"));
	reading_close(answer);
	return OUTCOME_OK;
}

/* A request about the study named on the command line, and the function that prints the reply. */
struct question {
	const char *method, *rest, *type;
	bool failed; /* HTTP 409 may be due to a study that has failed */
	enum outcome (*print)(const struct wire_reply *reply, const struct options *options);
	bool partial; /* an ended study may have an intermediate result */
	bool made;    /* the server may compute before it answers: long timeout */
};

/* Whether an ended study may have an intermediate result. */
static bool has_rows(struct wire *wire, const char *id)
{
	struct wire_reply reply = {0};
	bool has = false;
	char *path = answer_path(wire, id, "");
	if (wire_send(wire, &(struct wire_request){.method = "GET", .path = path}, &reply) == OUTCOME_OK) {
		struct reading *status = reading_open(reply.body, reply.n_body);
		const char *kind = status ? reading_text(status, "/kind") : NULL;
		has = kind && strcmp(kind, "sensitivity") == 0 && reading_number(status, "/runs_done") > 0;
		reading_close(status);
	}
	wire_reply_free(&reply);
	free(path);
	return has;
}

static enum outcome ask(const struct options *options, const struct question *question)
{
	struct wire *wire = wire_open(options->url);
	struct wire_reply reply;
	enum outcome outcome = answer_about(
	    wire,
	    (struct wire_request){.method = question->method, .accept = question->type, .made = question->made},
	    options->argument, question->rest, &reply);
	if (outcome == OUTCOME_OK)
		outcome = question->print(&reply, options);
	else if (reply.status == HTTP_CONFLICT) {
		outcome = question->failed && follow_failed(wire, options->argument) ? OUTCOME_STUDY_FAILED
		                                                                     : OUTCOME_FAILED;
		if (question->partial && outcome == OUTCOME_STUDY_FAILED && has_rows(wire, options->argument))
			command_complain("results of the rows that are complete: pound results --partial %s",
			                 options->argument);
	}
	wire_reply_free(&reply);
	wire_close(wire);
	return outcome;
}

static enum outcome print_status(const struct wire_reply *reply, const struct options *options)
{
	return print_studies(reply, options->format);
}

static enum outcome print_nothing(const struct wire_reply *reply, const struct options *options)
{
	(void)reply, (void)options;
	return OUTCOME_OK;
}

static enum outcome print_bytes(const struct wire_reply *reply, const struct options *options)
{
	(void)options;
	fwrite(reply->body, 1, reply->n_body, stdout);
	return OUTCOME_OK;
}

static enum outcome print_result(const struct wire_reply *reply, const struct options *options)
{
	return show_result(reply->body, reply->n_body, options);
}

/* `pound status ID` */
enum outcome query_status(const struct options *options)
{
	return ask(options, &(struct question){"GET", "", NULL, false, print_status, false, false});
}

/* `pound cancel ID`: prints the new status of the study. */
enum outcome query_cancel(const struct options *options)
{
	return ask(options, &(struct question){"POST", "/cancel", NULL, false, print_status, false, false});
}

/* `pound delete ID`: prints nothing. */
enum outcome query_delete(const struct options *options)
{
	return ask(options, &(struct question){"DELETE", "", NULL, false, print_nothing, false, false});
}

/* `pound wait ID`: prints the last status, however the study ended. */
enum outcome query_wait(const struct options *options)
{
	struct wire *wire = wire_open(options->url);
	struct wire_reply last;
	enum outcome outcome = follow_study(wire, options->argument, &last);
	if (outcome == OUTCOME_OK || outcome == OUTCOME_STUDY_FAILED)
		print_studies(&last, options->format);
	wire_reply_free(&last);
	wire_close(wire);
	return outcome;
}

/* `pound list`: prints one page of the list. */
enum outcome query_list(const struct options *options)
{
	struct wire *wire = wire_open(options->url);
	struct wire_reply reply;
	const char *const arguments[][2] = {{"status", options->status},
	                                    {"name", options->name},
	                                    {"hash", options->hash},
	                                    {"cursor", options->cursor}};
	char *path = command_text("/v1/studies?limit=%.0d", options->limit);
	for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++) {
		if (!arguments[i][1])
			continue;
		char *value = wire_escape(wire, arguments[i][1]), *before = path;
		path = command_text("%s&%s=%s", before, arguments[i][0], value);
		free(before);
		free(value);
	}
	enum outcome outcome =
	    answer_take(wire, &(struct wire_request){.method = "GET", .path = path}, "list", &reply);
	if (outcome == OUTCOME_OK)
		outcome = print_studies(&reply, options->format);
	wire_reply_free(&reply);
	free(path);
	wire_close(wire);
	return outcome;
}

// media type for each format; a table is made from JSON
static const struct {
	const char *format, *type;
} TYPES[] = {
    {"json", "application/json"},
    {"csv", "text/csv"},
    {"npy", "application/octet-stream"},
};

static const char *type_of(const char *format)
{
	size_t i = 0;
	while (strcmp(format, TYPES[i].format) != 0)
		i++;
	return TYPES[i].type;
}

/* `pound results ID`: prints the reply unchanged, or as a table.
 *
 * Returns  value   OUTCOME_STUDY_FAILED: the study failed or was canceled; OUTCOME_FAILED: it has no result yet
 */
enum outcome query_results(const struct options *options)
{
	// without --table the server makes the CSV; with --table this program does, as in `pound run'
	bool csv = strcmp(options->format, "csv") == 0 && !options->table;
	return ask(options,
	           &(struct question){"GET", options->partial ? "/results?partial=true" : "/results",
	                              type_of(csv ? "csv" : "json"), true, csv ? print_bytes : print_result,
	                              !options->partial, options->partial});
}

/* `pound samples ID`: prints the reply unchanged. */
enum outcome query_samples(const struct options *options)
{
	return ask(options, &(struct question){"GET", "/samples", type_of(options->format), true, print_bytes,
	                                       false, true});
}
