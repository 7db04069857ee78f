/* HTTP by libmicrohttpd: a few threads, each with its connections; a route answers in the thread of its connection. */
#include "server/http.h"

#include <arpa/inet.h>
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <microhttpd.h>

#include "server/log.h"
#include "server/routes.h"

enum {
	THREADS = 4,
	CONNECTIONS_MAX = 4096,
	HEADERS_MAX = 32 * 1024, /* [bytes] request line and headers */
	IDLE_MAX = 60,           /* [s] without a byte */
	BACKLOG = 1024,
	DROPPED_MAX = 16 * BODY_MAX, /* [bytes] of a body that is too large and read all the same */
};

struct http {
	struct MHD_Daemon *daemon;
};

static double monotonic(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A header of the request. */
const char *http_header(const struct request *request, const char *name)
{
	return MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, name);
}

/* An argument of the request's path; "" for ?name without a value. */
const char *http_argument(const struct request *request, const char *name)
{
	const char *value = NULL;
	size_t length = 0;
	bool there = MHD_lookup_connection_value_n(request->connection, MHD_GET_ARGUMENT_KIND, name, strlen(name),
	                                           &value, &length) == MHD_YES;
	return !there ? NULL : value ? value : "";
}

static enum MHD_Result send_reply(const struct request *request, const struct reply *reply)
{
	char retry_after[16];
	snprintf(retry_after, sizeof retry_after, "%d", reply->retry_after);
	const struct {
		const char *name, *value;
	} headers[] = {
	    {"Content-Type", reply->type},
	    {"Allow", reply->allow[0] ? reply->allow : NULL},
	    {"Location", reply->location[0] ? reply->location : NULL},
	    {"ETag", reply->etag[0] ? reply->etag : NULL},
	    {"Retry-After", reply->retry_after ? retry_after : NULL},
	    {"X-Content-Type-Options", "nosniff"},
	};
	struct MHD_Response *response = MHD_create_response_from_buffer(
	    reply->length, reply->body, reply->body ? MHD_RESPMEM_MUST_FREE : MHD_RESPMEM_PERSISTENT);
	if (!response) {
		free(reply->body);
		return MHD_NO;
	}
	for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
		if (headers[i].value)
			MHD_add_response_header(response, headers[i].name, headers[i].value);
	enum MHD_Result queued = MHD_queue_response(request->connection, (unsigned)reply->status, response);
	MHD_destroy_response(response);
	log_line("%s %s %d %zu bytes %.1f ms", request->method, request->path, reply->status, reply->length,
	         1e3 * (monotonic() - request->arrived));
	return queued;
}

/* Whether the headers alone say that the body will not be kept. */
static bool declared_too_large(const struct request *request)
{
	const char *length = http_header(request, "Content-Length");
	return length && strtoull(length, NULL, 10) > BODY_MAX;
}

/* Whether a body that is too large is refused unread.  A client that is sending all the same would find its connection
 * reset, and not our answer, so a body that is not very large is read to its end. */
static bool refused_unread(const struct request *request)
{
	return http_header(request, "Expect") ||
	       strtoull(http_header(request, "Content-Length"), NULL, 10) > DROPPED_MAX;
}

/* Keeps more of the body, or drops it when it is over the limit. */
static void collect(struct request *request, const char *bytes, size_t n)
{
	request->too_large = request->too_large || request->length + n > BODY_MAX;
	if (request->too_large || request->no_memory)
		return;
	if (request->length + n > request->capacity) {
		size_t capacity = 2 * request->capacity + n;
		char *body = realloc(request->body, capacity);
		if (!body) {
			request->no_memory = true;
			return;
		}
		request->body = body;
		request->capacity = capacity;
	}
	memcpy(request->body + request->length, bytes, n);
	request->length += n;
}

/* Called by libmicrohttpd with the headers, then with each part of the body, then without bytes for the answer. */
static enum MHD_Result answer(void *of, struct MHD_Connection *connection, const char *path,
                              const char *method, const char *version, const char *bytes, size_t *n,
                              void **kept)
{
	struct request *request = *kept;
	struct reply reply;
	(void)version;
	if (!request) {
		*kept = request = calloc(1, sizeof *request);
		if (!request)
			return MHD_NO;
		*request = (struct request){
		    .server = of, .connection = connection, .method = method, .path = path, .arrived = monotonic()};
		request->too_large = declared_too_large(request);
		if (!request->too_large || !refused_unread(request))
			return MHD_YES;
	} else if (*n) {
		collect(request, bytes, *n);
		*n = 0;
		return MHD_YES;
	}
	if (request->too_large)
		reply = routes_problem(ROUTES_TOO_LARGE, "a study document has at most 1 MiB");
	else if (request->no_memory)
		reply = routes_problem(ROUTES_UNAVAILABLE, "out of memory");
	else
		reply = routes_answer(request);
	return send_reply(request, &reply);
}

static void completed(void *of, struct MHD_Connection *connection, void **kept,
                      enum MHD_RequestTerminationCode why)
{
	struct request *request = *kept;
	(void)of, (void)connection, (void)why;
	if (request)
		free(request->body);
	free(request);
	*kept = NULL;
}

static void log_library(void *of, const char *format, va_list values)
{
	char text[256];
	(void)of;
	vsnprintf(text, sizeof text, format, values);
	text[strcspn(text, "\n")] = '\0';
	log_line("http: %s", text);
}

/* Starts to answer requests.
 *
 * Given    address   to listen on, IPv4 or IPv6 in digits
 *          port      0: any that is free, http_port tells it
 *          server    must outlive the service
 * Returns  value     for http_stop; NULL when it cannot listen there, logged
 */
struct http *http_start(const char *address, int port, struct server *server)
{
	struct sockaddr_in6 v6 = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port)};
	struct sockaddr_in v4 = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
	bool is_v6 = inet_pton(AF_INET6, address, &v6.sin6_addr) == 1;
	struct http *http = calloc(1, sizeof *http);
	if (!http || (!is_v6 && inet_pton(AF_INET, address, &v4.sin_addr) != 1)) {
		log_line("cannot listen on %s: not an IP address", address);
		free(http);
		return NULL;
	}
	http->daemon = MHD_start_daemon(
	    MHD_USE_AUTO_INTERNAL_THREAD | MHD_USE_ERROR_LOG | MHD_USE_ITC | (is_v6 ? MHD_USE_IPv6 : 0), 0, NULL,
	    NULL, answer, server, MHD_OPTION_EXTERNAL_LOGGER, log_library, NULL, MHD_OPTION_SOCK_ADDR,
	    is_v6 ? (struct sockaddr *)&v6 : (struct sockaddr *)&v4, MHD_OPTION_NOTIFY_COMPLETED, completed, NULL,
	    MHD_OPTION_THREAD_POOL_SIZE, (unsigned)THREADS, MHD_OPTION_CONNECTION_LIMIT,
	    (unsigned)CONNECTIONS_MAX, MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)HEADERS_MAX,
	    MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE_MAX, MHD_OPTION_LISTEN_BACKLOG_SIZE, (unsigned)BACKLOG,
	    MHD_OPTION_LISTENING_ADDRESS_REUSE, 1u, MHD_OPTION_END);
	if (!http->daemon) {
		log_line("cannot listen on %s port %d: %s", address, port, strerror(errno));
		free(http);
		return NULL;
	}
	return http;
}

/* The port listened on. */
int http_port(const struct http *http)
{
	return MHD_get_daemon_info(http->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

/* Stops answering; requests under way are ended. */
void http_stop(struct http *http)
{
	MHD_stop_daemon(http->daemon);
	free(http);
}
