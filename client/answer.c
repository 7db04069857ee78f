/* answer.c - from an HTTP status to an exit status and a sentence. */
#include "client/answer.h"

#include "client/document.h"
#include "schema/json/json_pointer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HTTP_BAD_REQUEST = 400, HTTP_INVALID = 422 };

/* Reports an error reply and returns its exit status. */
static enum outcome refusal(const char *subject, const struct wire_reply *reply)
{
	struct reading *problem = strstr(reply->type, "json") ? reading_open(reply->body, reply->n_body) : NULL;
	if (problem)
		document_complain(subject, problem);
	else
		command_complain("%s: the server answered with HTTP status %ld", subject, reply->status);
	if (reply->retry_after_s > 0)
		command_complain("try again in %ld s", reply->retry_after_s);
	reading_close(problem);
	return reply->status == HTTP_BAD_REQUEST || reply->status == HTTP_INVALID ? OUTCOME_USAGE
	                                                                          : OUTCOME_FAILED;
}

/* Converts the outcome of a request into an exit status; reports a failure on stderr. */
enum outcome answer_judge(const struct wire *wire, enum outcome sent, const char *subject,
                          const struct wire_reply *reply)
{
	if (sent != OUTCOME_OK) {
		command_complain("no answer from %s: %s", wire_url(wire), wire_failure(wire));
		return sent;
	}
	return reply->status >= 200 && reply->status < 300 ? OUTCOME_OK : refusal(subject, reply);
}

/* Sends a request and checks the reply.  The caller frees the reply, also after a failure. */
enum outcome answer_take(struct wire *wire, const struct wire_request *request, const char *subject,
                         struct wire_reply *reply)
{
	return answer_judge(wire, wire_send(wire, request, reply), subject, reply);
}

/* Escapes the id that the user gave, so that it stays one segment of the path. */
char *answer_path(struct wire *wire, const char *id, const char *rest)
{
	char *escaped = wire_escape(wire, id), *path = command_text("/v1/studies/%s%s", escaped, rest);
	free(escaped);
	return path;
}

/* Sends a request to /v1/studies/{id}{rest} and checks the reply. */
enum outcome answer_about(struct wire *wire, struct wire_request request, const char *id, const char *rest,
                          struct wire_reply *reply)
{
	char *path = answer_path(wire, id, rest);
	request.path = path;
	enum outcome outcome = answer_take(wire, &request, id, reply);
	free(path);
	return outcome;
}
