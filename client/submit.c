/* submit.c - a study document to the server; its id comes back at once, its end when asked for. */
#include "client/answer.h"
#include "client/document.h"
#include "client/follow.h"
#include "schema/json/json_pointer.h"

#include <stdio.h>
#include <stdlib.h>

/* Follows a study that was just accepted, its id already printed. */
static enum outcome follow(struct wire *wire, const char *id)
{
	struct wire_reply last;
	fflush(stdout);
	enum outcome outcome = follow_study(wire, id, &last);
	wire_reply_free(&last);
	return outcome;
}

/* `pound submit STUDY.json`: prints the id of the study.
 *
 * Returns  value   OUTCOME_USAGE for an invalid study, every error on stderr
 */
enum outcome submit_study(const struct options *options)
{
	size_t n;
	enum outcome outcome;
	char *document = document_whole(options->argument, &n, &outcome);
	if (!document)
		return outcome;
	struct wire *wire = wire_open(options->url);
	struct wire_reply reply;
	outcome = answer_take(
	    wire, &(struct wire_request){.method = "POST", .path = "/v1/studies", .body = document, .n_body = n},
	    document_name(options->argument), &reply);
	struct reading *status = outcome == OUTCOME_OK ? reading_open(reply.body, reply.n_body) : NULL;
	const char *id = status ? reading_text(status, "/id") : NULL;
	if (id) {
		puts(id);
		if (options->wait)
			outcome = follow(wire, id);
	} else if (outcome == OUTCOME_USAGE) {
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
