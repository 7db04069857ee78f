/* follow.c - polls the status at growing intervals, and survives a restart of the server. */
#include "client/follow.h"

#include "client/answer.h"
#include "client/progress_bar.h"
#include "schema/json/json_pointer.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
	HTTP_OK = 200,
	HTTP_UNAVAILABLE = 503,
	PAUSE_MS_MIN = 50,
	PAUSE_MS_MAX = 1000,
	PATIENCE_MS = 20000, /* how long to retry when a server that has answered does not answer any more */
};

static void pause_ms(int ms)
{
	nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L}, NULL);
}

/* Whether a study has ended; then sets the outcome. */
static bool ended(const struct reading *status, enum outcome *outcome)
{
	static const struct {
		const char *state;
		enum outcome outcome;
	} ENDS[] = {
	    {"succeeded", OUTCOME_OK},
	    {"failed", OUTCOME_STUDY_FAILED},
	    {"cancelled", OUTCOME_STUDY_FAILED},
	};
	const char *state = reading_text(status, "/status");
	for (size_t i = 0; state && i < sizeof ENDS / sizeof ENDS[0]; i++)
		if (strcmp(state, ENDS[i].state) == 0) {
			*outcome = ENDS[i].outcome;
			return true;
		}
	return false;
}

/* Reports why a study has no result. */
static void complain(const char *id, const struct reading *status)
{
	const char *state = reading_text(status, "/status"), *error = reading_text(status, "/error");
	command_complain("%s: the study is %s%s%s", id, state ? state : "?", error ? ": " : "",
	                 error ? error : "");
}

/* Handles one reply with the status of a study.  Returns true when waiting is over: the study ended, or the reply is an error. */
static bool look(const struct wire *wire, enum outcome sent, const char *id, const struct wire_reply *reply,
                 enum outcome *outcome)
{
	struct reading *status = NULL;
	bool over = true;
	*outcome = sent;
	if (sent != OUTCOME_OK || reply->status != HTTP_OK) {
		bar_clear();
		*outcome = answer_judge(wire, sent, id, reply);
	} else if (!(status = reading_open(reply->body, reply->n_body)) || !reading_text(status, "/status")) {
		bar_clear();
		command_complain("%s: the answer is not a status", id);
		*outcome = OUTCOME_FAILED;
	} else if ((over = ended(status, outcome))) {
		bar_clear();
		if (*outcome != OUTCOME_OK)
			complain(id, status);
	} else
		bar_draw(reading_number(status, "/runs_done"), reading_number(status, "/runs_total"),
		         reading_number(status, "/eta_s"));
	reading_close(status);
	return over;
}

/* Polls a study until it has ended.
 *
 * Memory   last holds the last reply, also after a failure; the caller frees it
 */
enum outcome follow_study(struct wire *wire, const char *id, struct wire_reply *last)
{
	char *path = answer_path(wire, id, "");
	const struct wire_request request = {.method = "GET", .path = path};
	enum outcome outcome = OUTCOME_OK;
	// no retries until the server has answered once
	int wait_ms = PAUSE_MS_MIN, host_pauses_ms = PATIENCE_MS;
	*last = (struct wire_reply){0};
	for (bool over = false; !over;) {
		wire_reply_free(last);
		enum outcome sent = wire_send(wire, &request, last);
		bool away = sent == OUTCOME_UNREACHED || last->status == HTTP_UNAVAILABLE;
		if (away && host_pauses_ms < PATIENCE_MS)
			host_pauses_ms += wait_ms;
		else {
			host_pauses_ms = 0;
			over = look(wire, sent, id, last, &outcome);
		}
		if (!over)
			pause_ms(wait_ms);
		wait_ms = wait_ms * 3 / 2 < PAUSE_MS_MAX ? wait_ms * 3 / 2 : PAUSE_MS_MAX;
	}
	free(path);
	return outcome;
}

bool follow_failed(struct wire *wire, const char *id)
{
	char *path = answer_path(wire, id, "");
	struct wire_reply reply = {0};
	enum outcome outcome = OUTCOME_OK;
	if (wire_send(wire, &(struct wire_request){.method = "GET", .path = path}, &reply) == OUTCOME_OK) {
		struct reading *status = reading_open(reply.body, reply.n_body);
		ended(status, &outcome);
		reading_close(status);
	}
	wire_reply_free(&reply);
	free(path);
	return outcome == OUTCOME_STUDY_FAILED;
}
