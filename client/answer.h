/* answer.h - requests to the server, with common reporting of failures. */
#ifndef ANSWER_H
#define ANSWER_H

#include "client/wire.h"

/* Sends a request about `subject` (a file, an id) and checks the answer; the caller frees `reply` in any case. */
enum outcome answer_take(struct wire *wire, const struct wire_request *request, const char *subject,
                         struct wire_reply *reply);

/* The same for /v1/studies/{id}{rest}. */
enum outcome answer_about(struct wire *wire, struct wire_request request, const char *id, const char *rest,
                          struct wire_reply *reply);

/* The outcome of a request after wire_send; failures are reported on stderr:
 * OUTCOME_UNREACHED, OUTCOME_USAGE (the study or the URL is invalid) or OUTCOME_FAILED. */
enum outcome answer_judge(const struct wire *wire, enum outcome sent, const char *subject,
                          const struct wire_reply *reply);

/* "/v1/studies/{id}{rest}" on the heap. */
char *answer_path(struct wire *wire, const char *id, const char *rest);

#endif
