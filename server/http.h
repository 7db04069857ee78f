/* http.h - requests with their bodies in, replies out; what the routes see of HTTP. */
#ifndef HTTP_H
#define HTTP_H

#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "schema/http/api.h"
#include "schema/http/http_head.h"
#include "server/answer_cache.h"
#include "server/deadlines.h"
#include "server/fair_share.h"
#include "server/metrics.h"
#include "server/options.h"
#include "server/partial_results.h"
#include "server/spool.h"
#include "server/store.h"

/* What every request can reach. */
struct server {
	const struct options *options;
	struct store *store;
	struct work *work;
	struct tokens *tokens; /* NULL: there are none */
	char *document; /* (document_length) bytes, the OpenAPI document: made once, it takes milliseconds */
	size_t document_length;
	struct answer_cache answers;
	struct partial_results partials;
	struct metrics metrics;
	struct connections connections;
	struct MHD_Daemon *daemon;
	_Atomic double
	    library_reported;          /* [s] monotonic, when a line of libmicrohttpd's was reported last, ... */
	atomic_int library_unreported; /* ... and how many were not since */
	struct spools spools;
	atomic_bool stopping;
	atomic_int under_way; /* requests whose headers are here */
	atomic_int aside;     /* those in threads of their own, of which ... */
	sem_t turns;          /* ... a few have their turn at a time, and ... */
	struct shares shares; /* ... each client a share */
	atomic_llong bodies;  /* [bytes] of the requests under way */
	atomic_ullong number; /* of the next request */
};

struct MHD_Connection;

/* Texts live until the reply is made. */
struct request {
	struct server *server;
	struct MHD_Connection *connection;
	const char *target, *target_end; /* as received; parsed in place by libmicrohttpd */
	const char *method, *path;       /* path without arguments, decoded; NULL: the headers are not all here */
	struct head head;
	int operation;                             /* row of api_operations, -1: none */
	long long id;                              /* of the study in the path, 0: none */
	char question[ANSWER_CACHE_QUESTION_SIZE]; /* target and Accept; "": it does not fit */
	char client[SHARE_CLIENT_SIZE];            /* its address in digits */
	const char *token;                         /* name of the one it was sent with; NULL: there are none */
	char allow[64];                            /* methods of the path */
	char *body;                                /* (length) bytes */
	size_t length;
	long long taken;             /* [bytes] of bodies that its own counts for */
	int share;                   /* of its client, when it is in a thread of its own */
	bool aside;                  /* it is in a thread of its own, ... */
	bool crowded;                /* ... or is to do without, for there are too many */
	bool replied;                /* the reply is there, kept or made by a thread of its own */
	struct reply reply;          /* if so, until it is sent */
	const atomic_bool *unwanted; /* nobody waits for it any more */
	double arrived;              /* [s] monotonic */
	uint64_t number;             /* sent as X-Request-Id */
};

const char *http_argument(const struct request *request,
                          const char *name); /* of ?name=value; NULL: what is absent */
bool http_known(const struct request *request,
                const char *etag); /* a GET with an If-None-Match that has it */

/* an application/problem+json reply; `problems` may be NULL */
struct format {
	const char *name, *type;
};

/* Whether the second of two formats is asked for: by a table that only that has, by ?format=, or by an Accept that names it
 * and not the first. */
bool http_asks_second(const struct request *request, const struct format formats[2], const char *table);

struct reply http_problem(enum api_fault fault, const char *detail, const struct problems *problems);

/* the same of a status of the store, which has none of what is absent: a sentence */
struct reply http_refusal(enum store_status status, const char *absent);

/* routes.c: answers a request whose head is right and whose body is read */
struct reply routes_answer(struct request *request);
bool routes_kept(const struct request *request, struct reply *reply); /* the answer is there already */
bool routes_slow(const struct request *request);                      /* it may take seconds */

#endif
