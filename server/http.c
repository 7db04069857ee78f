/* HTTP by libmicrohttpd: a few threads, each with its connections; a route answers in the thread of its connection.
 *
 * 1. The target and the headers are judged before a byte of the body is read.  A refusal of a request with a body is sent
 *    at once and the connection closed; what the client still sends is read for a while (deadlines.h), for a closed
 *    socket with unread bytes is reset, and the reset overtakes our answer.
 * 2. The body is collected, up to its limit.
 * 3. A route answers, or the connection is suspended until the study changes, and then the route is asked again.  What
 *    takes long is answered in a thread of its own, while the connection is suspended, or given up when the client has gone
 *    or the server stops.
 * 4. What is long is put into a file without a name, by that thread, so that no client who reads slowly keeps it in memory
 *    and no other client waits for it. */
#include "server/http.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/param.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <microhttpd.h>

#include "server/listen.h"
#include "server/log.h"
#include "server/store.h"
#include "server/token.h"

enum {
	THREADS = 4,
	TURNS = 2,                /* of them that take long, at a time */
	TURN_TICK_NS = 50000000,  /* [ns] until who waits for one is asked whether he is still wanted */
	GONE = 499,               /* told of a request whose client has gone */
	ASIDE_NICENESS = 5,       /* between other answers and the workers */
	CONNECTIONS_MAX = 4096,   /* of libmicrohttpd: beyond it clients hang unanswered */
	CONNECTIONS_MIN = 8,      /* of which each thread has a share */
	DRAINING_MAX = 256,       /* clients who go on sending after their answer */
	PROBES = 64,              /* connections that are answered probes, when no more are served */
	BODIES_MAX = 64 << 20,    /* [bytes] being received or read at a time */
	SPOOLED_MAX = 256,        /* answers in files */
	SPOOLED_PART = 64 * 1024, /* [bytes] read of one at a time */
	FILES_BESIDE = 48,        /* descriptors that are no connections: 33, and what is open for a moment */
	OF_ADDRESS_MAX = 64,      /* connections of one address, unless it is loopback */
	POOL = 32 * 1024,         /* [bytes] of a connection: twice HEAD_BYTES_MAX, for what is made of a head */
	SEND_S = 60,              /* [s] for an answer to arrive, besides */
	SEND_RATE = 16 * 1024,    /* [bytes/s] that a client takes at least */
	STOP_S = 5,               /* [s] for requests under way when the server stops */
	STOP_TICK_NS = 10000000,  /* [ns] */
};

static const double STOP_ASIDE_S = 0.3; /* [s] for answers that are given up */

/* An argument of the request's target, or what stands for an absent or an empty one. */
const char *http_argument(const struct request *request, const char *name)
{
	const char *value = MHD_lookup_connection_value(request->connection, MHD_GET_ARGUMENT_KIND, name);
	return value && *value ? value : api_argument(request->operation, name, "query")->absent;
}

bool http_known(const struct request *request, const char *etag)
{
	return !strcmp(api_operations[request->operation].method, "GET") &&
	       head_has_etag(request->head.etags.value, etag);
}

static double wait_until(const struct request *request)
{
	int seconds = head_wait(request->head.prefer.value), most = request->server->options->wait_max;
	return request->arrived + (seconds < most ? seconds : most);
}

/* The reply that says what is wrong with a request.
 *
 * Given    fault      its kind
 *          detail     a sentence about this request
 *          problems   more, listed in it; NULL: none
 * Returns  value      application/problem+json; its body is allocated
 */
struct reply http_problem(enum api_fault fault, const char *detail, const struct problems *problems)
{
	struct reply reply = {.status = api_faults[fault].status, .type = "application/problem+json"};
	reply.body = api_problem(fault, detail, problems, &reply.length);
	reply.retry_after = fault == API_UNAVAILABLE || fault == API_TOO_MANY;
	return reply;
}

static struct connection *connection_of(struct MHD_Connection *connection)
{
	return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
}

/* Closes a connection unless this is called again within so many seconds. */
static void allow(struct MHD_Connection *connection, double seconds)
{
	connection_of(connection)->deadline = connection_now() + seconds;
}

static void drop_body(struct server *server, struct reply *reply)
{
	if (!reply->lasts)
		free(reply->body);
	if (reply->file)
		spool_close(&server->spools, reply->file);
	reply->body = NULL;
	reply->file = 0;
	reply->length = 0;
}

/* Never called: of an answer without a body. */
static ssize_t no_bytes(void *of, uint64_t at, char *bytes, size_t n)
{
	(void)of;
	(void)at;
	(void)bytes;
	(void)n;
	return MHD_CONTENT_READER_END_OF_STREAM;
}

/* an answer's body in a file without a name */
struct spooled {
	struct spools *spools;
	int file;
};

static ssize_t read_spooled(void *of, uint64_t at, char *bytes, size_t n)
{
	const struct spooled *spooled = of;
	ssize_t got = pread(spooled->file, bytes, n, (off_t)at);
	return got > 0 ? got : MHD_CONTENT_READER_END_WITH_ERROR;
}

static void close_spooled(void *of)
{
	struct spooled *spooled = of;
	spool_close(spooled->spools, spooled->file);
	free(spooled);
}

/* A response that is read from a reply's file, which is not there any more when it has been sent; NULL: no memory. */
static struct MHD_Response *response_spooled(struct spools *spools, struct reply *reply)
{
	struct spooled *spooled = malloc(sizeof *spooled);
	struct MHD_Response *response = NULL;
	if (spooled) {
		*spooled = (struct spooled){spools, reply->file};
		reply->file = 0;
		response = MHD_create_response_from_callback(reply->length, SPOOLED_PART, read_spooled, spooled,
		                                             close_spooled);
	}
	if (spooled && !response)
		close_spooled(spooled);
	return response;
}

/* What libmicrohttpd sends for a reply, which has its body then; NULL: out of memory.
 *
 * It writes the body's length into a 304, too, which must be that of the 200 (RFC 9110 section 8.6): so a 304 keeps its
 * body, which is not sent.  Where that was not made, it leaves the length out, but must close the connection. */
static struct MHD_Response *response_of(const struct request *request, struct reply *reply)
{
	struct MHD_Response *response;
	if (reply->status == 304 && reply->file) {
		spool_close(&request->server->spools, reply->file);
		reply->file = 0;
	}
	if (reply->file)
		return response_spooled(&request->server->spools, reply);
	if (!reply->body && !reply->file && reply->length)
		return MHD_create_response_from_callback(reply->length, 1, no_bytes, NULL, NULL);
	if (reply->status != 304 || reply->body)
		return MHD_create_response_from_buffer(reply->length, reply->body,
		                                       reply->body && !reply->lasts ? MHD_RESPMEM_MUST_FREE
		                                                                    : MHD_RESPMEM_PERSISTENT);
	response = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, 1, no_bytes, NULL, NULL);
	if (response)
		MHD_set_response_options(response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);
	return response;
}

/* Counts and logs a reply of so many bytes.  Who has gone is counted as others count it: it is no failure of the server's. */
static void answered(const struct request *request, const struct reply *reply, size_t n)
{
	const double seconds = connection_now() - request->arrived;
	const int told = reply->gone ? GONE : reply->status;
	metrics_answered(&request->server->metrics, request->operation, told, seconds);
	// a path may be longer than a line
	log_line("%016llx %.20s %.400s %d %zu bytes %.1f ms", (unsigned long long)request->number,
	         request->method, request->path, told, n, 1e3 * seconds);
}

static enum MHD_Result send_reply(const struct request *request, struct reply *reply)
{
	struct server *server = request->server;
	char retry_after[16], number[17];
	snprintf(retry_after, sizeof retry_after, "%d", reply->retry_after);
	snprintf(number, sizeof number, "%016llx", (unsigned long long)request->number);
	const struct {
		const char *name, *value;
	} headers[] = {
	    {"Content-Type", reply->status == 304 ? NULL : reply->type},
	    {"Connection", server->stopping ? "close" : NULL},
	    {"Allow", reply->status == 405 ? request->allow : NULL},
	    {"Location", reply->location[0] ? reply->location : NULL},
	    {"ETag", reply->etag[0] ? reply->etag : NULL},
	    {"Retry-After", reply->retry_after ? retry_after : NULL},
	    {"WWW-Authenticate", reply->status == 401 ? "Bearer" : NULL},
	    {"Vary", reply->etag[0] ? "Accept, Authorization" : NULL},
	    {"Cache-Control", reply->etag[0] ? "private, no-cache" : "no-store"},
	    {"X-Request-Id", number},
	    {"X-Content-Type-Options", "nosniff"},
	    {"Content-Security-Policy",
	     reply->policy ? reply->policy : "default-src 'none'; frame-ancestors 'none'"},
	    {"Referrer-Policy", "no-referrer"},
	};
	const size_t sent = reply->status == 304 ? 0 : reply->length;
	struct MHD_Response *response = response_of(request, reply);
	if (!response) {
		drop_body(server, reply);
		return MHD_NO;
	}
	for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
		if (headers[i].value)
			MHD_add_response_header(response, headers[i].name, headers[i].value);
	allow(request->connection, SEND_S + (double)sent / SEND_RATE);
	answered(request, reply, sent);
	enum MHD_Result queued = MHD_queue_response(request->connection, (unsigned)reply->status, response);
	MHD_destroy_response(response);
	return queued;
}

static enum MHD_Result take_header(void *of, enum MHD_ValueKind kind, const char *name, size_t n_name,
                                   const char *value, size_t n_value)
{
	(void)kind;
	head_header(of, name, n_name, value ? value : "", n_value);
	return MHD_YES;
}

static enum MHD_Result take_argument(void *of, enum MHD_ValueKind kind, const char *name, const char *value)
{
	struct request *request = of;
	if (value != MHD_lookup_connection_value(request->connection, kind, name)) // which finds the first
		head_refuse(&request->head, API_BAD_REQUEST, false, "%.60s is given twice", name);
	head_argument(&request->head, request->operation, name, value ? value : "");
	return MHD_YES;
}

/* Whether there is something to do for a request, by its head: else that has a fault. */
static void judge(struct request *request, bool needs_host)
{
	struct server *server = request->server;
	struct head *head = &request->head;
	const struct api_operation *operation =
	    request->operation < 0 ? NULL : &api_operations[request->operation];
	MHD_get_connection_values_n(request->connection, MHD_HEADER_KIND, take_header, head);
	head_end(head, needs_host, server->options->host);
	if (server->tokens)
		request->token = tokens_name(server->tokens, head->authorization.value);
	const struct connection *connection = connection_of(request->connection);
	if (!connection->served && !(connection->probed && operation && operation->open))
		head_refuse(head, API_UNAVAILABLE, true, "the server has as many connections as it takes");
	if (server->tokens && !request->token && !(operation && operation->open))
		head_refuse(head, API_UNAUTHORIZED, false,
		            "this needs the header Authorization: Bearer, and a token of this server");
	if (!request->allow[0])
		head_refuse(head, API_NOT_FOUND, false,
		            "there is no such path; see /v1/openapi.json (study ids are 16 hexadecimal digits)");
	if (!operation)
		head_refuse(head, API_NOT_ALLOWED, false, "this path does not support this method");
	else if (operation->takes_study && !head->json)
		head_refuse(head, API_NOT_JSON, false, "Content-Type must be application/json");
	else if (operation->takes_study)
		head_key(head);
	if (operation && strcmp(operation->method, "GET") != 0)
		head_origin(head);
	if (head->fault == API_NO_FAULT)
		MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, take_argument, request);
	if (head->fault != API_NO_FAULT || head->length == 0)
		return;
	request->taken = (long long)head->length;
	if (atomic_fetch_add(&server->bodies, request->taken) + request->taken > BODIES_MAX)
		head_refuse(head, API_UNAVAILABLE, true, "too many request bodies are being sent");
}

/* Keeps more of the body, or drops it when there is a fault; no more comes than its declared length. */
static void collect(struct request *request, const char *bytes, size_t n)
{
	if (!request->body && !(request->body = malloc(request->head.length)))
		head_refuse(&request->head, API_UNAVAILABLE, false, "out of memory");
	if (request->head.fault != API_NO_FAULT)
		return;
	memcpy(request->body + request->length, bytes, n);
	request->length += n;
}

/* Called by libmicrohttpd with the target as it came, before it is decoded: makes the request. */
static void *begin(void *of, const char *target, struct MHD_Connection *connection)
{
	struct server *server = of;
	struct request *request = calloc(1, sizeof *request);
	if (!request)
		return NULL;
	*request = (struct request){.server = server, .connection = connection, .operation = -1};
	request->number = server->number++;
	request->target = target ? target : "";
	request->target_end = request->target + strlen(request->target);
	snprintf(request->question, sizeof request->question, "%s", request->target);
	size_t n = head_target(&request->head, request->target);
	// arguments that are not to be taken apart end where they begin; this is libmicrohttpd's memory, and it looks next
	if (request->target[n] == '?')
		((char *)request->target)[n + 1] = '\0';
	return request;
}

/* Sends a refusal by the socket itself, past libmicrohttpd: for a head that may have left it no room for an answer. */
static enum MHD_Result refuse_head(struct request *request)
{
	char text[512];
	head_refuse(&request->head, API_HEAD_LARGE, true,
	            "the request line and the headers have at most %d bytes", HEAD_BYTES_MAX);
	const enum api_fault fault = request->head.fault;
	struct reply reply = http_problem(fault, request->head.detail, NULL);
	int n =
	    snprintf(text, sizeof text,
	             "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\nConnection: close\r\n\r\n%.*s",
	             reply.status, api_faults[fault].title, reply.type, reply.length, (int)reply.length,
	             reply.body ? reply.body : "");
	connection_of(request->connection)->lingers = true;
	// a socket that has just been read from has room for one line; who has gone need not be told
	if (send(connection_of(request->connection)->fd, text, (size_t)n, MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
		reply.gone = true;
	answered(request, &reply, reply.length);
	drop_body(request->server, &reply);
	return MHD_NO;
}

/* Ends what the answer depends on, begun with the target: by the Accept, or by nothing when both are too long. */
static void question_end(struct request *request)
{
	size_t n = (size_t)(request->target_end - request->target), room = sizeof request->question;
	const struct head_text *accept = &request->head.accept;
	if (n >= room || snprintf(request->question + n, room - n, " %s", accept->value) >= (int)(room - n))
		request->question[0] = '\0';
}

/* Whose share a request is of that has no token. */
static void client_name(struct request *request)
{
	const struct sockaddr *address =
	    MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr;
	const void *bytes = address->sa_family == AF_INET6
	                        ? (const void *)&((const struct sockaddr_in6 *)(const void *)address)->sin6_addr
	                        : (const void *)&((const struct sockaddr_in *)(const void *)address)->sin_addr;
	inet_ntop(address->sa_family, bytes, request->client, sizeof request->client);
}

/* The headers are here: judges them. */
static enum MHD_Result head_came(struct request *request, const char *method, const char *path,
                                 const char *version)
{
	struct server *server = request->server;
	if (!connection_of(request->connection))
		return MHD_NO;
	server->under_way++;
	client_name(request);
	request->method = method;
	request->path = path;
	request->arrived = connection_now();
	request->operation = api_match(method, path, &request->id, request->allow);
	request->unwanted = &connection_of(request->connection)->unwanted;
	allow(request->connection, server->options->body_timeout);
	const size_t n =
	    MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE)->header_size;
	if (n > HEAD_BYTES_MAX)
		return refuse_head(request);
	// one NUL each ends the method and the target, where they are in the head
	if (request->target != method + strlen(method) + 1 || version != request->target_end + 1)
		head_refuse(&request->head, API_BAD_REQUEST, true,
		            "a request line is a method, a target and a version with one blank between them");
	else
		head_bytes(&request->head, version + strlen(version),
		           n - (size_t)(version + strlen(version) - method),
		           MHD_get_connection_values(request->connection, MHD_HEADER_KIND, NULL, NULL));
	judge(request, strcmp(version, "HTTP/1.0") != 0);
	question_end(request);
	// without a body, the refusal can wait for the next call, and the connection be kept
	if (request->head.fault == API_NO_FAULT || !(request->head.has_body || request->head.close))
		return MHD_YES;
	connection_of(request->connection)->lingers = true;
	struct reply reply = http_problem(request->head.fault, request->head.detail, NULL);
	return send_reply(request, &reply);
}

/* Goes on with a suspended request, whose reply is made. */
static void go_on(struct request *request)
{
	struct server *server = request->server;
	request->replied = true;
	share_give(&server->shares, request->share);
	connection_of(request->connection)->answering = false;
	MHD_resume_connection(request->connection); // which may end it
	server->aside--;
}

/* Waits for a turn; false: nobody waits for the answer any more. */
static bool take_turn(const struct request *request)
{
	bool had = false;
	while (!had && !*request->unwanted) {
		struct timespec until;
		clock_gettime(CLOCK_MONOTONIC, &until);
		until.tv_nsec += TURN_TICK_NS;
		until.tv_sec += until.tv_nsec / 1000000000;
		until.tv_nsec %= 1000000000;
		had = sem_clockwait(&request->server->turns, CLOCK_MONOTONIC, &until) == 0;
	}
	return had;
}

/* Makes the reply to a suspended request, when it is its turn; none of use when nobody waits for it any more. */
static void *answer_aside(void *of)
{
	struct request *request = of;
	struct server *server = request->server;
	struct reply *reply = &request->reply;
	setpriority(PRIO_PROCESS, (id_t)gettid(), ASIDE_NICENESS);
	if (take_turn(request)) {
		*reply = routes_answer(request);
		spool_reply(&server->spools, reply);
		sem_post(&server->turns);
	}
	if (*request->unwanted && reply->status != 200) {
		drop_body(server, reply);
		*reply = http_problem(
		    API_UNAVAILABLE,
		    server->stopping ? "the server stops" : "the client has closed its side of the connection", NULL);
		reply->gone = !server->stopping;
	}
	go_on(request);
	return NULL;
}

/* Gives a request to a thread of its own, if its client has not too many there. */
static void put_aside(struct request *request)
{
	pthread_t thread;
	request->share = share_take(&request->server->shares, request->token ? request->token : request->client);
	if (request->share < 0) {
		request->reply = http_problem(
		    API_UNAVAILABLE, "as many answers that take long are being made as this client, or all, may have",
		    NULL);
		request->replied = true;
		return;
	}
	request->server->aside++;
	connection_of(request->connection)->answering = true;
	MHD_suspend_connection(request->connection);
	if (pthread_create(&thread, NULL, answer_aside, request) == 0) {
		pthread_detach(thread);
		return;
	}
	request->reply = http_problem(API_UNAVAILABLE, "no thread can be had for this", NULL);
	go_on(request);
}

/* Called by libmicrohttpd with the headers, then with each part of the body, then without bytes for the answer. */
static enum MHD_Result answer(void *of, struct MHD_Connection *connection, const char *path,
                              const char *method, const char *version, const char *bytes, size_t *n,
                              void **kept)
{
	struct request *request = *kept;
	struct server *server = of;
	if (!request)
		return MHD_NO;
	if (!request->method)
		return head_came(request, method, path, version);
	if (*n) {
		collect(request, bytes, *n);
		*n = 0;
		return MHD_YES;
	}
	allow(connection, INFINITY);
	if (server->stopping && !request->replied)
		head_refuse(&request->head, API_UNAVAILABLE, false, "the server stops");
	if (request->head.fault == API_NO_FAULT && !request->replied)
		request->replied = routes_kept(request, &request->reply);
	if (request->head.fault == API_NO_FAULT && !request->replied && routes_slow(request)) {
		put_aside(request);
		if (!request->replied)
			return MHD_YES;
	}
	struct reply reply = request->head.fault != API_NO_FAULT
	                         ? http_problem(request->head.fault, request->head.detail, NULL)
	                     : request->replied ? request->reply
	                                        : routes_answer(request);
	request->reply.body = NULL; // they go with the reply
	request->reply.file = 0;
	if (reply.status == 200 && reply.etag[0] && http_known(request, reply.etag))
		reply.status = 304;
	// of more who wait than may, the last wait for nothing
	struct connections *all = &server->connections;
	reply.gone |= reply.waits && connection_of(connection)->unwanted;
	if (reply.status != 304 || !reply.waits || connection_now() >= wait_until(request) ||
	    connection_of(connection)->unwanted || all->n_waiting >= all->most_waiting)
		return send_reply(request, &reply);
	drop_body(server, &reply);
	request->replied = false;
	MHD_suspend_connection(connection);
	connection_wait(all, connection_of(connection), connection, request->id, reply.changes,
	                wait_until(request));
	return MHD_YES;
}

static void resume(void *connection)
{
	MHD_resume_connection(connection);
}

static void completed(void *of, struct MHD_Connection *connection, void **kept,
                      enum MHD_RequestTerminationCode why)
{
	struct server *server = of;
	struct request *request = *kept;
	(void)why;
	if (!request)
		return;
	if (connection_of(connection))
		allow(connection, server->options->idle_timeout);
	if (request->method)
		server->under_way--;
	server->bodies -= request->taken;
	free(request->body);
	drop_body(server, &request->reply);
	free(request);
	*kept = NULL;
}

static void notice(void *of, struct MHD_Connection *connection, void **context,
                   enum MHD_ConnectionNotificationCode code)
{
	struct server *server = of;
	int fd = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
	if (code == MHD_CONNECTION_NOTIFY_STARTED)
		*context = connection_opened(&server->connections, fd, server->options->header_timeout);
	else if (*context)
		connection_closed(&server->connections, *context);
}

/* Who comes while the server stops is hung up on: else the clients who keep coming would keep it up. */
static enum MHD_Result welcome(void *of, const struct sockaddr *address, socklen_t n)
{
	const struct server *server = of;
	(void)address;
	(void)n;
	return server->stopping ? MHD_NO : MHD_YES;
}

/* Called by libmicrohttpd for what it has to say, which may be a hundred thousand times a second: reported once a second. */
static void log_library(void *of, const char *format, va_list values)
{
	struct server *server = of;
	const double now = connection_now();
	double told = server->library_told;
	char text[256];
	if (now < told + 1 || !atomic_compare_exchange_strong(&server->library_told, &told, now)) {
		server->library_untold++;
		return;
	}
	vsnprintf(text, sizeof text, format, values);
	text[strcspn(text, "\n")] = '\0';
	log_line("http: %s (and %d lines before that were not reported)", text,
	         atomic_exchange(&server->library_untold, 0));
}

/* Shares out the descriptors there may be, as many as are needed or allowed: a connection without one would keep a thread
 * that accepts it busy.
 *
 * Returns  value   connections that libmicrohttpd may have, 0: too few, logged; of them all but a few are served, and the
 *                  others told so
 */
static int share_files(struct server *server, int wanted)
{
	struct connections *connections = &server->connections;
	struct rlimit files = {RLIM_INFINITY, RLIM_INFINITY};
	const rlim_t most = CONNECTIONS_MAX + DRAINING_MAX + SPOOLED_MAX + FILES_BESIDE;
	if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < most) {
		struct rlimit more = {MIN(files.rlim_max, most), files.rlim_max};
		if (setrlimit(RLIMIT_NOFILE, &more) == 0)
			files = more;
	}
	const int left = (int)MIN(files.rlim_cur, most) - FILES_BESIDE;
	connections->most_draining = MIN(left / 4, DRAINING_MAX);
	server->spools.most = MIN(left / 8, SPOOLED_MAX);
	const int all = MIN(left - connections->most_draining - server->spools.most, CONNECTIONS_MAX);
	connections->most = MIN(wanted, all - 1 - all / 64);
	connections->most_probed = MIN(connections->most + PROBES, all - 1 - all / 64);
	connections->most_waiting = (connections->most + 1) / 2;
	if (all < CONNECTIONS_MIN)
		log_line("only %d files may be open, which is too few: ulimit -n", (int)files.rlim_cur);
	else if (connections->most < wanted)
		log_line("only %d files may be open (ulimit -n): %d connections are served at a time, not %d",
		         (int)files.rlim_cur, connections->most, wanted);
	return all < CONNECTIONS_MIN ? 0 : all;
}

/* libmicrohttpd on that socket, with at most n connections. */
static struct MHD_Daemon *serving(struct server *server, const union listen_address *address, int fd, int n)
{
	return MHD_start_daemon(MHD_USE_AUTO_INTERNAL_THREAD | MHD_USE_ERROR_LOG | MHD_ALLOW_SUSPEND_RESUME, 0,
	                        welcome, server, answer, server, MHD_OPTION_EXTERNAL_LOGGER, log_library, server,
	                        MHD_OPTION_LISTEN_SOCKET, fd, MHD_OPTION_NOTIFY_COMPLETED, completed, server,
	                        MHD_OPTION_NOTIFY_CONNECTION, notice, server, MHD_OPTION_URI_LOG_CALLBACK, begin,
	                        server, MHD_OPTION_THREAD_POOL_SIZE, (unsigned)THREADS,
	                        MHD_OPTION_CONNECTION_LIMIT, (unsigned)n, MHD_OPTION_PER_IP_CONNECTION_LIMIT,
	                        listen_is_loopback(address) ? 0u : (unsigned)OF_ADDRESS_MAX,
	                        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)POOL, MHD_OPTION_END);
}

/* Starts to answer requests, at the address and the port of the options.
 *
 * Given    server   whose options, store, work and tokens are set; it must outlive the service
 * Returns  value    for http_stop; false when it cannot or must not listen there, logged
 * Test     service_security: an_address_that_is_not_loopback_needs_tokens_or_insecure
 *          service_http: with_few_descriptors_fewer_are_served_and_nothing_spins
 */
bool http_start(struct server *server)
{
	const struct options *options = server->options;
	union listen_address address;
	if (!listen_address(options->listen, options->port, &address)) {
		log_line("cannot listen on %s: not an IP address", options->listen);
		return false;
	}
	if (!listen_is_loopback(&address) && !server->tokens && !options->insecure) {
		log_line("cannot listen on %s: others reach it, so it needs --token-file, or --insecure",
		         options->listen);
		return false;
	}
	sem_init(&server->turns, 0, TURNS);
	pthread_mutex_init(&server->shares.lock, NULL);
	server->number = (unsigned long long)time(NULL) << 32;
	server->connections.store = server->spools.store = server->store;
	server->connections.resume = resume;
	const int n = share_files(server, options->connections_max);
	if (n == 0)
		return false;
	if (!connections_start(&server->connections))
		return false;
	int fd = listen_open(&address);
	server->daemon = fd >= 0 ? serving(server, &address, fd, n) : NULL;
	if (server->daemon)
		return true;
	log_line("cannot listen on %s port %d: %s", options->listen, options->port, strerror(errno));
	connections_stop(&server->connections);
	return false;
}

/* The port listened on. */
int http_port(const struct server *server)
{
	return MHD_get_daemon_info(server->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

/* Stops answering.  Who waits for a study is told 503; requests under way have a few seconds to end, and answers that
 * take long, which are given up, less.
 *
 * Returns  value   false: one of these was not given up in time, and nothing that it may use may be given up but by the end
 *                  of the program
 */
bool http_stop(struct server *server)
{
	const double now = connection_now(), until = now + STOP_S, aside_until = now + STOP_ASIDE_S;
	server->stopping = true;
	server->connections.released = true;
	while ((server->aside > 0 && connection_now() < aside_until) ||
	       (server->under_way > server->aside && connection_now() < until))
		nanosleep(&(struct timespec){.tv_nsec = STOP_TICK_NS}, NULL);
	// a suspended connection must not be stopped
	if (server->aside > 0)
		return false;
	MHD_stop_daemon(server->daemon);
	connections_stop(&server->connections);
	return true;
}
