/* http.h - requests with their bodies in, replies out; what the routes see of HTTP. */
#ifndef HTTP_H
#define HTTP_H

#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "schema/api.h"
#include "schema/head.h"
#include "server/connection.h"
#include "server/metrics.h"
#include "server/options.h"

struct reply {
	int status;
	const char *type; /* media type of the body */
	char *body;       /* (length) bytes on the heap, http.c frees them unless ...; NULL: none */
	bool lasts;       /* ... it lasts as long as the server */
	size_t length;
	const char *policy; /* Content-Security-Policy; NULL: nothing may be loaded */
	char location[64];  /* "": no such header, likewise below */
	char etag[64];
	int retry_after;  /* [s], 0: none */
	bool gone;        /* the client had gone before it was made */
	bool waits;       /* who knows it already may wait for another, when the study has changed */
	unsigned changes; /* of the study, before it was looked at */
};

enum { HTTP_TOLD = 61 }; /* status objects kept; a prime, so that ids fall everywhere */

struct told {
	int64_t id;
	unsigned changes;   /* of the study before it was looked at */
	struct reply reply; /* body NULL: none */
};

enum { HTTP_COMPLAINTS = 16 };

/* What libmicrohttpd logs, by its format: told once a second at most. */
struct complaint {
	const char *format;
	double told; /* [s] monotonic, the last time */
	int n_since; /* that were not told */
};

/* What every request can reach. */
struct server {
	const struct options *options;
	struct store *store;
	struct work *work;
	struct tokens *tokens; /* NULL: there are none */
	char *document; /* (document_length) bytes, the OpenAPI document: made once, it takes milliseconds */
	size_t document_length;
	pthread_mutex_t told_lock;
	struct told told[HTTP_TOLD]; /* each where the remainder of its id is */
	struct metrics metrics;
	struct connections connections;
	struct MHD_Daemon *daemon;
	pthread_mutex_t complaints_lock;
	struct complaint complaints[HTTP_COMPLAINTS]; /* the latest */
	int spooled_most;                             /* answers in files that there may be */
	atomic_int spooled;                           /* and are */
	atomic_bool stopping;
	atomic_int under_way; /* requests whose headers are here */
	atomic_int aside;     /* those in threads of their own, of which ... */
	sem_t turns;          /* ... a few have their turn at a time */
	atomic_ullong number; /* of the next request */
};

struct MHD_Connection;

/* Texts live until the reply is made. */
struct request {
	struct server *server;
	struct MHD_Connection *connection;
	const char *method, *path; /* path without arguments, decoded; NULL: the headers are not all here */
	struct head head;
	int operation;     /* row of api_operations, -1: none */
	long long id;      /* of the study in the path, 0: none */
	const char *token; /* name of the one it was sent with; NULL: there are none */
	char allow[64];    /* methods of the path */
	char *body;        /* (length) bytes */
	size_t length;
	bool aside;                  /* it was given to a thread of its own ... */
	bool replied;                /* ... which has made the reply */
	struct reply reply;          /* if so, until it is sent */
	const atomic_bool *unwanted; /* nobody waits for it any more */
	double arrived;              /* [s] monotonic */
	uint64_t number;             /* told as X-Request-Id */
};

const char *http_argument(const struct request *request,
                          const char *name); /* of ?name=value; NULL: what is absent */
bool http_known(const struct request *request,
                const char *etag); /* a GET with an If-None-Match that has it */

/* an application/problem+json reply; `problems` may be NULL */
struct reply http_problem(enum api_fault fault, const char *detail, const struct problems *problems);

bool http_start(struct server *server); /* false: logged */
int http_port(const struct server *server);
void http_stop(struct server *server); /* what is under way is answered, who waits is told 503 */

/* routes.c: answers a request whose head is right and whose body is read */
struct reply routes_answer(struct request *request);
bool routes_slow(const struct request *request); /* it may take seconds */

#endif
