/* print_report.c - a result as one HTML page, from files or from the server. */
#include "client/answer.h"
#include "client/document.h"
#include "schema/figure/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What a page is made of, each on the heap; NULL: not known. */
struct parts {
	char *result, *study, *samples;
	size_t n_result, n_study, n_samples;
};

static enum outcome page_print(const struct parts *parts, const char *name)
{
	size_t n;
	const struct figure_source source = {.json = parts->result,
	                                     .length = parts->n_result,
	                                     .samples = parts->samples,
	                                     .n_samples = parts->n_samples};
	char *page = report_html(&source, parts->study, parts->n_study, &n);
	if (page)
		fwrite(page, 1, n, stdout);
	else
		command_complain("%s: this is no result of a study", name);
	free(page);
	return page ? OUTCOME_OK : OUTCOME_FAILED;
}

static void parts_free(struct parts *parts)
{
	free(parts->result);
	free(parts->study);
	free(parts->samples);
}

static enum outcome report_files(const struct options *options)
{
	struct parts parts = {0};
	parts.result = document_read(options->argument, &parts.n_result);
	if (parts.result && options->second)
		parts.study = document_read(options->second, &parts.n_study);
	bool read = parts.result && (parts.study || !options->second);
	enum outcome outcome = read ? page_print(&parts, document_name(options->argument)) : OUTCOME_FAILED;
	parts_free(&parts);
	return outcome;
}

/* One document of a study; the bytes go to *text. */
static enum outcome fetch(struct wire *wire, const struct options *options, const char *rest,
                          const char *type, char **text, size_t *n)
{
	struct wire_reply reply;
	enum outcome outcome =
	    answer_about(wire, (struct wire_request){.method = "GET", .accept = type, .made = true},
	                 options->argument, rest, &reply);
	if (outcome == OUTCOME_OK) {
		*text = reply.body;
		*n = reply.n_body;
		reply.body = NULL;
	}
	wire_reply_free(&reply);
	return outcome;
}

/* Whether the figures of a study need its samples. */
static bool is_sampled(struct wire *wire, const struct options *options)
{
	char *list = NULL;
	size_t n;
	bool sampled = false;
	if (fetch(wire, options, "/figures", NULL, &list, &n) != OUTCOME_OK)
		return false;
	struct reading *reading = reading_open(list, n);
	for (int i = 0; reading && i < reading_count(reading, "/figures"); i++)
		sampled = sampled || figure_row(reading_text(reading, "/figures/%d/name", i))->sampled;
	reading_close(reading);
	free(list);
	return sampled;
}

static enum outcome report_fetched(const struct options *options)
{
	struct wire *wire = wire_open(options->url);
	struct parts parts = {0};
	enum outcome outcome = fetch(wire, options, options->partial ? "/results?partial=true" : "/results",
	                             "application/json", &parts.result, &parts.n_result);
	if (outcome == OUTCOME_OK)
		outcome = fetch(wire, options, "/request", NULL, &parts.study, &parts.n_study);
	if (outcome == OUTCOME_OK && !options->partial && is_sampled(wire, options))
		outcome = fetch(wire, options, "/samples", "text/csv", &parts.samples, &parts.n_samples);
	if (outcome == OUTCOME_OK)
		outcome = page_print(&parts, options->argument);
	parts_free(&parts);
	wire_close(wire);
	return outcome;
}

/* `pound report RESULT|ID [STUDY.json]` prints the page.
 *
 * Test     client_figure: a_report_is_one_page_that_needs_nothing_else
 */
enum outcome report_print(const struct options *options)
{
	return command_is_id(options->argument) ? report_fetched(options) : report_files(options);
}
