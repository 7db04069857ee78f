/* http.h - requests with their bodies in, replies out; what the routes see of HTTP. */
#ifndef HTTP_H
#define HTTP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BODY_MAX = 1 << 20 }; /* [bytes] of a request */

/* What every request can reach. */
struct server {
	struct store *store;
	struct work *work;
	int n_workers;
};

struct MHD_Connection;

/* Texts live until the reply is made. */
struct request {
	struct server *server;
	struct MHD_Connection *connection;
	const char *method, *path; /* path without arguments, decoded */
	int64_t id;                /* of the study in the path, 0: none */
	char *body;                /* (length) bytes */
	size_t length, capacity;
	bool too_large, no_memory; /* the body was not kept */
	double arrived;            /* [s] monotonic */
};

const char *http_header(const struct request *request, const char *name);   /* NULL: none */
const char *http_argument(const struct request *request, const char *name); /* of ?name=value; NULL: none */

struct reply {
	int status;
	const char *type; /* media type of the body */
	char *body;       /* (length) bytes on the heap, http.c frees them; NULL: none */
	size_t length;
	char allow[64]; /* "": no such header, likewise below */
	char location[64];
	char etag[64];
	int retry_after; /* [s], 0: none */
};

struct http;

struct http *http_start(const char *address, int port, struct server *server); /* NULL: logged */
int http_port(const struct http *http);
void http_stop(struct http *http);

#endif
