/* A request, from its head to its answer; usually a route answers in the thread of the connection (server/daemon.c).
 *
 * 1. The target and the headers are checked before a byte of the body is read.  A refusal of a request with a body is sent
 *    at once and the connection closed; what the client still sends is read for a while (deadlines.h), because closing a
 *    socket with unread bytes sends a reset, which can overtake our answer.
 * 2. The body is collected, up to its limit.
 * 3. A route answers, or the connection is suspended until the study changes, and then the route is called again.  A slow
 *    answer is made in a thread of its own while the connection is suspended; it is abandoned when the client disconnects
 *    or the server stops.
 * 4. That thread writes a long answer to an unnamed temporary file, so that a slow reader keeps none in memory and no other
 *    client waits for it. */
#include "server/http_calls.h"

#include <arpa/inet.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "server/log.h"
#include "server/store.h"
#include "server/token.h"

enum {
	TURN_TICK_NS = 50000000,  /* [ns] between checks whether a waiting answer is still wanted */
	GONE = 499,               /* logged status of a request whose client has disconnected */
	ASIDE_NICENESS = 5,       /* between the other answers and the workers */
	BODIES_MAX = 64 << 20,    /* [bytes] being received or read at a time */
	SPOOLED_PART = 64 * 1024, /* [bytes] read from a spooled answer at a time */
	SEND_S = 60,              /* [s] for an answer to arrive, plus its length by SEND_RATE */
	SEND_RATE = 16 * 1024,    /* [bytes/s] a client must receive at least */
};

/* A query parameter of the request, or its default when it is absent or empty. */
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

bool http_asks_second(const struct request *request, const struct format formats[2], const char *table)
{
	const char *name = http_argument(request, "format"), *accept = request->head.accept.value;
	return table  ? true
	       : name ? !strcmp(name, formats[1].name)
	              : head_names(accept, formats[1].type) && !head_names(accept, formats[0].type);
}

static double wait_until(const struct request *request)
{
	int seconds = head_wait(request->head.prefer.value), most = request->server->options->wait_max;
	return request->arrived + (seconds < most ? seconds : most);
}

/* An error reply.
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

/* The answer to a failure of the store; `absent`: the sentence for a record that does not exist. */
struct reply http_refusal(enum store_status status, const char *absent)
{
	static const struct {
		enum api_fault fault;
		const char *detail;
	} refusals[] = {
	    [STORE_NONE] = {API_NOT_FOUND, NULL},
	    [STORE_CORRUPT] = {API_CORRUPT, "the stored bytes are damaged"},
	    [STORE_FAILED] = {API_UNAVAILABLE, "the database cannot be used now; please try again"},
	    [STORE_CLASH] = {API_KEY_REUSED, "this Idempotency-Key was used before with another body"},
	    [STORE_FULL] = {API_UNAVAILABLE, "the disk has no room for new studies"},
	    [STORE_REPLACED] =
	        {API_UNAVAILABLE,
	         "the database file was removed or replaced: nothing is accepted until the server is "
	         "restarted"},
	    [STORE_CROWDED] = {API_UNAVAILABLE, "the queue is full"},
	    [STORE_UNRECORDED] = {API_UNAVAILABLE,
	                          "a record named by the study was deleted meanwhile: PUT it again"},
	    [STORE_CLIENT_CROWDED] = {API_TOO_MANY, "the queue has no room for more studies of this token"},
	};
	return http_problem(refusals[status].fault, status == STORE_NONE ? absent : refusals[status].detail,
	                    NULL);
}

static struct connection *connection_of(struct MHD_Connection *connection)
{
	return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
}

/* Sets the deadline of a connection: it is closed unless this is called again in time. */
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

/* Never called: for an answer whose body is not sent. */
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

/* A response that is read from a reply's file, which is closed and so deleted once sent; NULL: no memory. */
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

/* The response of libmicrohttpd for a reply, whose body it takes over; NULL: out of memory.
 *
 * libmicrohttpd writes Content-Length into a 304 too, where it must equal the length of the 200 (RFC 9110 section 8.6): so a
 * 304 keeps its body, which is not sent.  If no body was made, the header is omitted, but the connection must be closed. */
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

/* Counts and logs a reply of n bytes.  A client that has disconnected counts as status 499, as in nginx: no server error. */
static void answered(const struct request *request, const struct reply *reply, size_t n)
{
	const double seconds = connection_now() - request->arrived;
	const int status = reply->gone ? GONE : reply->status;
	metrics_answered(&request->server->metrics, request->operation, status, seconds);
	// a path may be longer than a line
	log_line("%016llx %.20s %.400s %d %zu bytes %.1f ms", (unsigned long long)request->number,
	         request->method, request->path, status, n, 1e3 * seconds);
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
		head_refuse(&request->head, API_BAD_REQUEST, false, "query parameter %.60s occurs more than once",
		            name);
	head_argument(&request->head, request->operation, name, value ? value : "");
	return MHD_YES;
}

/* Checks the head of a request; afterwards head.fault says whether it is refused. */
static void judge(struct request *request, bool needs_host)
{
	struct server *server = request->server;
	struct head *head = &request->head;
	const struct api_operation *operation =
	    request->operation < 0 ? NULL : &api_operations[request->operation];
	MHD_get_connection_values_n(request->connection, MHD_HEADER_KIND, take_header, head);
	head->of_record = request->operation == API_records_put;
	head_end(head, needs_host, server->options->host);
	if (server->tokens)
		request->token = tokens_name(server->tokens, head->authorization.value);
	const struct connection *connection = connection_of(request->connection);
	if (!connection->served && !(connection->probed && operation && operation->open))
		head_refuse(head, API_UNAVAILABLE, true, "all connections of the server are in use");
	if (server->tokens && !request->token && !(operation && operation->open))
		head_refuse(head, API_UNAUTHORIZED, false,
		            "expected the header Authorization: Bearer with a valid token of this server");
	if (!request->allow[0])
		head_refuse(head, API_NOT_FOUND, false,
		            "no such path; see /v1/openapi.json (study ids are 16 hexadecimal digits)");
	if (!operation)
		head_refuse(head, API_NOT_ALLOWED, false,
		            "this path does not support this method; the header Allow lists those it supports");
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

/* Appends to the body, or discards it after a fault; libmicrohttpd passes at most the declared length. */
static void collect(struct request *request, const char *bytes, size_t n)
{
	if (!request->body && !(request->body = malloc(request->head.length)))
		head_refuse(&request->head, API_UNAVAILABLE, false, "out of memory");
	if (request->head.fault != API_NO_FAULT)
		return;
	memcpy(request->body + request->length, bytes, n);
	request->length += n;
}

/* Called with the target as received, before it is decoded: creates the request. */
void *http_begin(void *of, const char *target, struct MHD_Connection *connection)
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
	// an invalid query is cut off before libmicrohttpd, which owns this memory, parses it next
	if (request->target[n] == '?')
		((char *)request->target)[n + 1] = '\0';
	return request;
}

/* Sends a refusal directly to the socket: a head that is too large may leave libmicrohttpd no memory for an answer. */
static enum MHD_Result refuse_head(struct request *request)
{
	char text[512];
	head_refuse(&request->head, API_HEAD_LARGE, true,
	            "request line and headers together may have at most %d bytes", HEAD_BYTES_MAX);
	const enum api_fault fault = request->head.fault;
	struct reply reply = http_problem(fault, request->head.detail, NULL);
	int n =
	    snprintf(text, sizeof text,
	             "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\nConnection: close\r\n\r\n%.*s",
	             reply.status, api_faults[fault].title, reply.type, reply.length, (int)reply.length,
	             reply.body ? reply.body : "");
	connection_of(request->connection)->lingers = true;
	// the send buffer has room for so few bytes; a client that has disconnected needs no answer
	if (send(connection_of(request->connection)->fd, text, (size_t)n, MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
		reply.gone = true;
	answered(request, &reply, reply.length);
	drop_body(request->server, &reply);
	return MHD_NO;
}

/* Completes the cache key, which begins with the target, by the Accept header; empty when both are too long. */
static void question_end(struct request *request)
{
	size_t n = (size_t)(request->target_end - request->target), room = sizeof request->question;
	const struct head_text *accept = &request->head.accept;
	if (n >= room || snprintf(request->question + n, room - n, " %s", accept->value) >= (int)(room - n))
		request->question[0] = '\0';
}

/* The name that counts slow answers of a client without a token: its IP address. */
static void client_name(struct request *request)
{
	const struct sockaddr *address =
	    MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr;
	const void *bytes = address->sa_family == AF_INET6
	                        ? (const void *)&((const struct sockaddr_in6 *)(const void *)address)->sin6_addr
	                        : (const void *)&((const struct sockaddr_in *)(const void *)address)->sin_addr;
	inet_ntop(address->sa_family, bytes, request->client, sizeof request->client);
}

/* Called when the headers have arrived: checks them. */
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
	// libmicrohttpd ends the method and the target by one NUL each, in place of single spaces
	if (request->target != method + strlen(method) + 1 || version != request->target_end + 1)
		head_refuse(&request->head, API_BAD_REQUEST, true,
		            "a request line must be method, target and version, separated by one space");
	else
		head_bytes(&request->head, version + strlen(version),
		           n - (size_t)(version + strlen(version) - method),
		           MHD_get_connection_values(request->connection, MHD_HEADER_KIND, NULL, NULL));
	judge(request, strcmp(version, "HTTP/1.0") != 0);
	question_end(request);
	// without a body, the refusal is sent at the next call, and the connection kept
	if (request->head.fault == API_NO_FAULT || !(request->head.has_body || request->head.close))
		return MHD_YES;
	connection_of(request->connection)->lingers = true;
	struct reply reply = http_problem(request->head.fault, request->head.detail, NULL);
	return send_reply(request, &reply);
}

/* Resumes a suspended request, whose reply is made. */
static void go_on(struct request *request)
{
	struct server *server = request->server;
	request->replied = true;
	share_give(&server->shares, request->share);
	connection_of(request->connection)->answering = false;
	MHD_resume_connection(request->connection); // which may end it
	server->aside--;
}

/* Whether a new thread would have its turn at once. */
static bool slot_free(struct server *server)
{
	int n = 0;
	return sem_getvalue(&server->turns, &n) == 0 && n > 0;
}

/* Waits for a turn; false: the client no longer waits for the answer. */
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

/* Makes the reply to a suspended request, at its turn; an error when the client no longer waits for it. */
static void *answer_aside(void *of)
{
	struct request *request = of;
	struct server *server = request->server;
	struct reply *reply = &request->reply;
	// partial_maker_soon bounds the time of a partial result
	if (request->operation != API_results || strcmp(http_argument(request, "partial"), "true") != 0)
		setpriority(PRIO_PROCESS, (id_t)gettid(), ASIDE_NICENESS);
	if (take_turn(request)) {
		*reply = routes_answer(request);
		spool_reply(&server->spools, reply);
		sem_post(&server->turns);
	}
	if (*request->unwanted && reply->status / 100 != 2) {
		drop_body(server, reply);
		*reply = http_problem(API_UNAVAILABLE,
		                      server->stopping ? "the server is stopping"
		                                       : "the client has closed its side of the connection",
		                      NULL);
		reply->gone = !server->stopping;
	}
	go_on(request);
	return NULL;
}

/* Moves a request to a thread of its own, which owns it from then on; false: too many slow answers, of its client or in all. */
static bool put_aside(struct request *request)
{
	pthread_t thread;
	request->share = share_take(&request->server->shares, request->token ? request->token : request->client);
	if (request->share < 0)
		return false;
	request->aside = true;
	request->server->aside++;
	connection_of(request->connection)->answering = true;
	MHD_suspend_connection(request->connection);
	if (pthread_create(&thread, NULL, answer_aside, request) == 0) {
		pthread_detach(thread);
		return true;
	}
	request->reply =
	    http_problem(API_UNAVAILABLE, "no thread could be started for this request; please try again", NULL);
	go_on(request);
	return true;
}

/* Called with the headers, then with each part of the body, then without bytes for the answer. */
enum MHD_Result http_answer(void *of, struct MHD_Connection *connection, const char *path, const char *method,
                            const char *version, const char *bytes, size_t *n, void **kept)
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
		head_refuse(&request->head, API_UNAVAILABLE, false, "the server is stopping");
	if (request->head.fault == API_NO_FAULT && !request->replied)
		request->replied = routes_kept(request, &request->reply);
	if (request->head.fault != API_NO_FAULT) {
		request->reply = http_problem(request->head.fault, request->head.detail, NULL);
		request->replied = true;
	}
	if (!request->replied && routes_slow(request)) {
		if (put_aside(request))
			return MHD_YES;
		request->reply = http_problem(
		    API_UNAVAILABLE,
		    "too many slow answers are being prepared, for this client or in all; please try again", NULL);
		request->replied = true;
	}
	struct reply reply = request->replied ? request->reply : routes_answer(request);
	if (reply.later && slot_free(server) && put_aside(request))
		return MHD_YES;
	if (reply.later) {
		request->crowded = true;
		reply = routes_answer(request);
	}
	request->reply.body = NULL; // they go with the reply
	request->reply.file = 0;
	if (reply.status == 200 && reply.etag[0] && http_known(request, reply.etag))
		reply.status = 304;
	// above the limit of waiting requests, further ones are answered at once
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

void http_resume(void *connection)
{
	MHD_resume_connection(connection);
}

/* Called when a request has been answered, or will not be. */
void http_completed(void *of, struct MHD_Connection *connection, void **kept,
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
