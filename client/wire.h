/* wire.h - one HTTP exchange with the server: request in; status, headers and body out.
 *
 * Only wire.c includes libcurl.  One `struct wire` is used by one thread. */
#ifndef WIRE_H
#define WIRE_H

#include "client/command.h"

#include <stddef.h>

struct wire; /* a connection that is kept between requests */

struct wire_request {
	const char *method;
	const char *path;   /* from the root, with its query */
	const char *accept; /* media type wanted; NULL: any */
	const char *body;   /* n_body bytes; NULL: none */
	size_t n_body;
	const char *type; /* media type of the body; NULL: JSON */
	bool made;        /* the server computes the answer, which may take minutes, before its first byte */
};

struct wire_reply {
	long status; /* HTTP status */
	char *body;  /* (n_body), plus a NUL that is not counted */
	size_t n_body;
	char *type;         /* media type of the body without its parameters; "": none */
	long retry_after_s; /* 0: unknown */
};

/* Connects when the first request is sent; `url` is kept, not copied. */
struct wire *wire_open(const char *url);
void wire_close(struct wire *wire);

/* OUTCOME_OK when the server answered, with any status; otherwise wire_failure has the reason. */
enum outcome wire_send(struct wire *wire, const struct wire_request *request, struct wire_reply *reply);
const char *wire_url(const struct wire *wire);
const char *wire_failure(const struct wire *wire);
void wire_reply_free(struct wire_reply *reply);

/* `text` percent-encoded for a path or a query; the caller frees it. */
char *wire_escape(struct wire *wire, const char *text);

/* Several requests to one server at a time, each by a job: a number from 0. */
struct wire_jobs;

/* `timeout_s` of one request, 0: none; `url` is kept, not copied. */
struct wire_jobs *wire_jobs_open(const char *url, int n, int timeout_s);
void wire_jobs_close(struct wire_jobs *jobs);

/* Begins a request by an idle job; its texts must stay valid until its reply has arrived. */
void wire_jobs_send(struct wire_jobs *jobs, int job, const struct wire_request *request);

/* A job whose request has ended, with or without a reply, as in wire_send; -1: no job within wait_ms. */
int wire_jobs_receive(struct wire_jobs *jobs, int wait_ms, enum outcome *outcome, struct wire_reply *reply);
const char *wire_jobs_failure(const struct wire_jobs *jobs, int job);

#endif
