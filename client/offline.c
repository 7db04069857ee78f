/* offline.c - in place of wire.c in a build without libcurl (make client CURL=0): every request fails. */
#include "client/wire.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static const char FAILURE[] = "this build of pound has no libcurl, so it cannot reach a server";

struct wire {
	const char *url;
};

struct wire_jobs {
	struct wire wire;
};

struct wire *wire_open(const char *url)
{
	struct wire *wire = command_sure(calloc(1, sizeof *wire));
	wire->url = url;
	return wire;
}

void wire_close(struct wire *wire)
{
	free(wire);
}

enum outcome wire_send(struct wire *wire, const struct wire_request *request, struct wire_reply *reply)
{
	(void)wire;
	(void)request;
	*reply = (struct wire_reply){.type = command_sure(strdup(""))};
	return OUTCOME_USAGE;
}

const char *wire_url(const struct wire *wire)
{
	return wire->url;
}

const char *wire_failure(const struct wire *wire)
{
	(void)wire;
	return FAILURE;
}

void wire_reply_free(struct wire_reply *reply)
{
	free(reply->body);
	free(reply->type);
	*reply = (struct wire_reply){0};
}

char *wire_escape(struct wire *wire, const char *text)
{
	(void)wire;
	return command_sure(strdup(text));
}

struct wire_jobs *wire_jobs_open(const char *url, int n, int timeout_s)
{
	(void)n;
	(void)timeout_s;
	struct wire_jobs *jobs = command_sure(calloc(1, sizeof *jobs));
	jobs->wire.url = url;
	return jobs;
}

void wire_jobs_close(struct wire_jobs *jobs)
{
	free(jobs);
}

void wire_jobs_send(struct wire_jobs *jobs, int job, const struct wire_request *request)
{
	(void)jobs;
	(void)job;
	(void)request;
	assert(!"a model was asked for its sizes before, in vain");
}

int wire_jobs_receive(struct wire_jobs *jobs, int wait_ms, enum outcome *outcome, struct wire_reply *reply)
{
	(void)jobs;
	(void)wait_ms;
	(void)outcome;
	(void)reply;
	return -1;
}

const char *wire_jobs_failure(const struct wire_jobs *jobs, int job)
{
	(void)jobs;
	(void)job;
	return FAILURE;
}
