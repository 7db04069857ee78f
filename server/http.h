/* http.h - requests with their bodies, and replies: all that the routes see of HTTP. */
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
#include "server/partial_maker.h"
#include "server/partial_results.h"
#include "server/spool.h"
#include "server/store.h"

/* State shared by all requests. */
struct server {
	const struct options *options;
	struct store *store;
	struct work *work;
	struct tokens *tokens; /* NULL: none are required */
	char *document; /* (document_length) bytes, the OpenAPI document: made once, for it takes milliseconds */
	size_t document_length;
	struct answer_cache answers;
	struct partial_results partials;
	struct partial_maker partial_maker;
	struct metrics metrics;
	struct connections connections;
	struct MHD_Daemon *daemon;
	_Atomic double library_reported; /* [s] monotonic, when a message of libmicrohttpd was logged last, ... */
	atomic_int library_unreported;   /* ... and the messages dropped since */
	struct spools spools;
	atomic_bool stopping;
	atomic_int under_way; /* requests whose headers have arrived */
	atomic_int aside;     /* requests in threads of their own, of which ... */
	sem_t turns;          /* ... TURNS (daemon.c) run at a time, and ... */
	struct shares shares; /* ... each client has a limited number */
	atomic_llong bodies;  /* [bytes] of the bodies of requests under way */
	atomic_ullong number; /* of the next request */
};

struct MHD_Connection;

/* The texts are valid until the reply is made. */
struct request {
	struct server *server;
	struct MHD_Connection *connection;
	const char *target, *target_end; /* as received; parsed in place by libmicrohttpd */
	const char *method, *path; /* path without arguments, decoded; NULL: the headers have not all arrived */
	struct head head;
	int operation;                             /* row of api_operations, -1: none */
	long long id;                              /* of the study in the path, 0: none */
	char question[ANSWER_CACHE_QUESTION_SIZE]; /* target and Accept; "": it does not fit */
	char client[SHARE_CLIENT_SIZE];            /* its IP address as text */
	const char *token;                         /* name of the token it was sent with; NULL: none */
	char allow[64];                            /* methods of the path */
	char *body;                                /* (length) bytes */
	size_t length;
	long long taken;             /* [bytes] that its body adds to server->bodies */
	int share;                   /* place in server->shares, when it has a thread of its own */
	bool aside;                  /* it has a thread of its own, ... */
	bool crowded;                /* ... or must be answered without one, for there are too many */
	bool replied;                /* the reply is made: a fault, cached, or by a thread of its own */
	struct reply reply;          /* if replied, until it is sent */
	const atomic_bool *unwanted; /* the client no longer waits for the answer */
	double arrived;              /* [s] monotonic */
	uint64_t number;             /* sent as X-Request-Id */
};

const char *http_argument(const struct request *request,
                          const char *name); /* value of ?name=value or its default; NULL: neither */
bool http_known(const struct request *request, const char *etag); /* a GET whose If-None-Match contains it */

/* value of ?format= and media type */
struct format {
	const char *name, *type;
};

/* Whether the second of two formats is requested: by a table, which only the second has, by ?format=, or by an Accept that
 * names the second and not the first. */
bool http_asks_second(const struct request *request, const struct format formats[2], const char *table);

/* an application/problem+json reply; `problems` may be NULL */
struct reply http_problem(enum api_fault fault, const char *detail, const struct problems *problems);

/* the same for a failure of the store; `absent`: the sentence for STORE_NONE */
struct reply http_refusal(enum store_status status, const char *absent);

/* routes.c: answers a request with a valid head and a complete body */
struct reply routes_answer(struct request *request);
bool routes_kept(const struct request *request, struct reply *reply); /* the answer is cached */
bool routes_slow(const struct request *request);                      /* the answer may take seconds */

#endif
