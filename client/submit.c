/* submit.c - sends a study document to the server; prints its id at once, and waits for its end if requested. */
#include "client/answer.h"
#include "client/document.h"
#include "client/follow.h"
#include "schema/json/json_pointer.h"

#include <stdio.h>
#include <stdlib.h>

/* Follows a study that was just accepted; flushes its printed id first. */
static enum outcome follow(struct wire *wire, const char *id)
{
	struct wire_reply last;
	fflush(stdout);
	enum outcome outcome = follow_study(wire, id, &last);
	wire_reply_free(&last);
	return outcome;
}

/* Sends the files that a study names, except files that the server already has; each file once.
 *
 * Test     client_suite: files_that_the_server_has_are_not_sent_again
 */
static enum outcome files_send(struct wire *wire, const char *path, const struct pound_study *study)
{
	enum outcome outcome = OUTCOME_OK;
	for (int k = 0; k < study->scene.excitation.n_records && outcome == OUTCOME_OK; k++) {
		const struct study_source *of = study_source_of(study, k);
		if (!of)
			continue;
		char *place = command_text("/v1/records/%s", of->sha256);
		struct wire_reply reply;
		size_t n;
		outcome = wire_send(wire, &(struct wire_request){.method = "HEAD", .path = place}, &reply);
		const bool lacks = outcome == OUTCOME_OK && reply.status == 404;
		if (!lacks && (outcome != OUTCOME_OK || reply.status != 200))
			outcome = answer_judge(wire, outcome, of->file, &reply);
		wire_reply_free(&reply);
		char *bytes = lacks ? document_file(path, of, &n) : NULL;
		if (lacks && !bytes)
			outcome = OUTCOME_FAILED;
		if (bytes) {
			const struct wire_request put = {.method = "PUT",
			                                 .path = place,
			                                 .body = bytes,
			                                 .n_body = n,
			                                 .type = "application/octet-stream"};
			outcome = answer_take(wire, &put, of->file, &reply);
			wire_reply_free(&reply);
		}
		free(bytes);
		free(place);
	}
	return outcome;
}

/* `pound submit STUDY.json`: prints the id of the study.
 *
 * Returns  value   OUTCOME_USAGE: the study is invalid; all errors are on stderr
 */
enum outcome submit_study(const struct options *options)
{
	size_t n;
	enum outcome outcome;
	struct pound_study *study;
	char *document = document_hashed(options->argument, &n, &outcome, &study);
	if (!document)
		return outcome;
	struct wire *wire = wire_open(options->url);
	struct wire_reply reply = {0};
	outcome = study ? files_send(wire, options->argument, study) : OUTCOME_OK;
	if (study)
		study_free(study);
	const bool sent = outcome == OUTCOME_OK;
	if (sent)
		outcome = answer_take(
		    wire,
		    &(struct wire_request){.method = "POST", .path = "/v1/studies", .body = document, .n_body = n},
		    document_name(options->argument), &reply);
	struct reading *status = outcome == OUTCOME_OK ? reading_open(reply.body, reply.n_body) : NULL;
	const char *id = status ? reading_text(status, "/id") : NULL;
	if (id) {
		puts(id);
		if (options->wait)
			outcome = follow(wire, id);
	} else if (sent && outcome == OUTCOME_USAGE) {
		document_hint(document, n);
	} else if (outcome == OUTCOME_OK) {
		command_complain("the server's answer has no id");
		outcome = OUTCOME_FAILED;
	}
	reading_close(status);
	wire_reply_free(&reply);
	wire_close(wire);
	free(document);
	return outcome;
}
