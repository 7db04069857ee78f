/* answer.c - from an HTTP status to an exit status and a sentence. */
#include "client/answer.h"

#include "client/document.h"
#include "schema/json/json_pointer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HTTP_BAD_REQUEST = 400, HTTP_INVALID = 422 };

/* Says what a reply other than a success means for the user. */
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

/* Turns what came of a request into an exit status, and says what went wrong. */
enum outcome answer_judge(const struct wire *wire, enum outcome sent, const char *subject,
                          const struct wire_reply *reply)
{
	if (sent != OUTCOME_OK) {
		command_complain("no answer from %s: %s", wire_url(wire), wire_failure(wire));
		return sent;
	}
	return reply->status >= 200 && reply->status < 300 ? OUTCOME_OK : refusal(subject, reply);
}

/* Sends a request and judges the answer; the reply is to be freed whatever came. */
enum outcome answer_take(struct wire *wire, const struct wire_request *request, const char *subject,
                         struct wire_reply *reply)
{
	return answer_judge(wire, wire_send(wire, request, reply), subject, reply);
}

/* An id of the user's stays one segment of the path, whatever is in it. */
char *answer_path(struct wire *wire, const char *id, const char *rest)
{
	char *escaped = wire_escape(wire, id), *path = command_text("/v1/studies/%s%s", escaped, rest);
	free(escaped);
	return path;
}

/* Sends a request to /v1/studies/{id}{rest} and checks the answer. */
enum outcome answer_about(struct wire *wire, struct wire_request request, const char *id, const char *rest,
                          struct wire_reply *reply)
{
	char *path = answer_path(wire, id, rest);
	request.path = path;
	enum outcome outcome = answer_take(wire, &request, id, reply);
	free(path);
	return outcome;
}
