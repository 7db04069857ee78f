/* print_report.c - a result as one HTML page, from files or from the server. */
#include "client/answer.h"
#include "client/document.h"
#include "schema/figure/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The documents that a page shows, allocated; NULL: not available. */
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
		command_complain("%s: this is not the result of a study: `pound run STUDY.json` prints one", name);
	free(page);
	return page ? OUTCOME_OK : OUTCOME_FAILED;
}

static void parts_free(struct parts *parts)
{
	free(parts->result);
	free(parts->study);
	free(parts->samples);
}

/* Checks by the study hash that the document belongs to the result. */
static enum outcome expect_study_of(const struct parts *parts, const struct options *options)
{
	struct reading *result = reading_open(parts->result, parts->n_result);
	const char *hash = result ? reading_text(result, "/study_hash") : NULL;
	const char *version = result ? reading_text(result, "/engine_version") : NULL;
	char own[STUDY_HASH_SIZE];
	enum outcome outcome = OUTCOME_OK;
	struct pound_study *study = NULL;
	if (version && !hash) {
		command_complain("%s: this result has no study document", document_name(options->argument));
		outcome = OUTCOME_USAGE;
	} else if (hash && (study = document_study(options->second, parts->study, parts->n_study, &outcome))) {
		command_sure(study_hash(study, own) ? own : NULL);
		study_free(study);
		if (strcmp(own, hash) != 0) {
			command_complain("%s is not the study of %s: its hash is %.12s, the result's study_hash is %.12s",
			                 document_name(options->second), document_name(options->argument), own, hash);
			if (version && strcmp(version, POUND_VERSION) != 0)
				command_complain("the result was computed by pound %s, this is %s", version, POUND_VERSION);
			outcome = OUTCOME_USAGE;
		}
	}
	reading_close(result);
	return outcome;
}

static enum outcome report_files(const struct options *options)
{
	struct parts parts = {0};
	enum outcome outcome = OUTCOME_FAILED;
	parts.result = document_read(options->argument, &parts.n_result);
	if (parts.result && options->second)
		parts.study = document_read(options->second, &parts.n_study);
	if (parts.result && (parts.study || !options->second))
		outcome = parts.study ? expect_study_of(&parts, options) : OUTCOME_OK;
	if (outcome == OUTCOME_OK)
		outcome = page_print(&parts, document_name(options->argument));
	parts_free(&parts);
	return outcome;
}

/* Fetches one document of a study into *text. */
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
 * Test     client_figure: a_report_is_one_page_that_needs_nothing_else, a_report_has_no_other_study
 */
enum outcome report_print(const struct options *options)
{
	if (!command_is_id(options->argument))
		return report_files(options);
	if (!options->second)
		return report_fetched(options);
	command_complain("the server has the document of study %s: leave out %s", options->argument,
	                 options->second);
	return OUTCOME_USAGE;
}
