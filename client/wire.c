/* wire.c - HTTP through libcurl; no other file of the client includes it. */
#include "client/wire.h"

#include "engine/pound.h"

#include <curl/curl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	CONNECT_S = 10, /* timeout for connecting */
	SILENCE_S = 60, /* timeout without a received byte */
	MADE_S = 3600,  /* the same while the server may compute; keepalive finds a lost machine earlier */
};

struct wire {
	CURL *curl;
	const char *url;
	size_t n_url; /* length of url without trailing slashes */
	char *direct; /* hosts that are reached without a proxy */
	bool in_time; /* timeout_s (0: no limit) limits the whole request, in place of SILENCE_S and MADE_S */
	int timeout_s;
	FILE *body; /* receives the body of the reply */
	struct curl_slist *headers;
	char failure[CURL_ERROR_SIZE];
};

/* Prepares a connection, which the first request opens.  A proxy in the environment is used, except for localhost.
 *
 * Memory   allocates; wire_close frees
 */
struct wire *wire_open(const char *url)
{
	struct wire *wire = command_sure(calloc(1, sizeof *wire));
	const char *direct = getenv("no_proxy");
	if (!direct)
		direct = getenv("NO_PROXY");
	wire->curl = command_sure(curl_global_init(CURL_GLOBAL_DEFAULT) == 0 ? curl_easy_init() : NULL);
	// libcurl accepts "*", for any host, only as the whole list
	bool any = direct && strcmp(direct, "*") == 0;
	wire->direct = command_text(any ? "*" : "localhost,127.0.0.1,::1,%s", direct ? direct : "");
	wire->url = url;
	wire->n_url = strlen(url);
	while (wire->n_url && url[wire->n_url - 1] == '/')
		wire->n_url--;
	return wire;
}

/* Closes the connection and frees everything. */
void wire_close(struct wire *wire)
{
	curl_easy_cleanup(wire->curl);
	curl_global_cleanup();
	free(wire->direct);
	free(wire);
}

static size_t take_body(char *bytes, size_t size, size_t n, void *into)
{
	return fwrite(bytes, size, n, into) * size;
}

static char *header(CURL *curl, const char *name)
{
	struct curl_header *found;
	if (curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &found) != CURLHE_OK)
		return command_sure(strdup(""));
	return command_sure(strndup(found->value, strcspn(found->value, ";")));
}

static void options_set(struct wire *wire, const struct wire_request *request, const char *url)
{
	CURL *curl = wire->curl;
	curl_easy_reset(curl);
	curl_easy_setopt(curl, CURLOPT_URL, url);
	curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
	curl_easy_setopt(curl, CURLOPT_NOPROXY, wire->direct);
	curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, wire->failure);
	curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
	curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
	if (wire->in_time)
		curl_easy_setopt(curl, CURLOPT_TIMEOUT, (long)wire->timeout_s);
	else {
		curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
		curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, request->made ? (long)MADE_S : (long)SILENCE_S);
	}
	curl_easy_setopt(curl, CURLOPT_TCP_KEEPALIVE, 1L);
	curl_easy_setopt(curl, CURLOPT_TCP_KEEPIDLE, SILENCE_S / 2L);
	curl_easy_setopt(curl, CURLOPT_TCP_KEEPINTVL, SILENCE_S / 12L);
	curl_easy_setopt(curl, CURLOPT_USERAGENT, "pound/" POUND_VERSION);
	curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, take_body);
	curl_easy_setopt(curl, CURLOPT_WRITEDATA, wire->body);
	curl_easy_setopt(curl, CURLOPT_HTTPHEADER, wire->headers);
	const char *token = getenv("POUND_TOKEN");
	if (token) {
		curl_easy_setopt(curl, CURLOPT_HTTPAUTH, (long)CURLAUTH_BEARER);
		curl_easy_setopt(curl, CURLOPT_XOAUTH2_BEARER, token);
	}
	if (strcmp(request->method, "HEAD") == 0)
		curl_easy_setopt(curl, CURLOPT_NOBODY, 1L);
	else if (request->body || strcmp(request->method, "POST") == 0) {
		curl_easy_setopt(curl, CURLOPT_POST, 1L);
		curl_easy_setopt(curl, CURLOPT_POSTFIELDS, request->body ? request->body : "");
		curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)request->n_body);
	}
	curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, request->method);
}

/* Whether a request failed before any connection because the URL is malformed or has an unsupported scheme. */
static bool no_url(CURL *curl, CURLcode code)
{
	long connections = 0;
	curl_easy_getinfo(curl, CURLINFO_NUM_CONNECTS, &connections);
	return connections == 0 && (code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL);
}

/* Prepares the handle for a request; the wire owns the headers and the body stream until request_end. */
static void request_begin(struct wire *wire, const struct wire_request *request, struct wire_reply *reply)
{
	*reply = (struct wire_reply){0};
	wire->failure[0] = '\0';
	wire->body = command_sure(open_memstream(&reply->body, &reply->n_body));
	char *url = command_text("%.*s%s", (int)wire->n_url, wire->url, request->path);
	char *accept = command_text("Accept: %s", request->accept ? request->accept : "*/*");
	wire->headers = curl_slist_append(NULL, accept);
	char *type = command_text("Content-Type:%s%s", request->body ? " " : "",
	                          !request->body  ? ""
	                          : request->type ? request->type
	                                          : "application/json");
	wire->headers = curl_slist_append(wire->headers, type);
	free(type);
	// no pause for "100 Continue" before a long body
	wire->headers = curl_slist_append(wire->headers, "Expect:");
	options_set(wire, request, url);
	free(accept);
	free(url);
}

/* Completes the reply, possibly a partial one; after a failure wire->failure has the reason. */
static enum outcome request_end(struct wire *wire, CURLcode code, struct wire_reply *reply)
{
	fclose(wire->body);
	wire->body = NULL;
	curl_easy_getinfo(wire->curl, CURLINFO_RESPONSE_CODE, &reply->status);
	reply->type = header(wire->curl, "Content-Type");
	char *retry = header(wire->curl, "Retry-After");
	reply->retry_after_s = atol(retry);
	free(retry);
	curl_slist_free_all(wire->headers);
	wire->headers = NULL;
	if (code != CURLE_OK && !wire->failure[0])
		snprintf(wire->failure, sizeof wire->failure, "%s", curl_easy_strerror(code));
	return code == CURLE_OK ? OUTCOME_OK : no_url(wire->curl, code) ? OUTCOME_USAGE : OUTCOME_UNREACHED;
}

/* Sends one request and receives the whole reply.
 *
 * Returns  value   OUTCOME_OK, OUTCOME_UNREACHED, or OUTCOME_USAGE for an invalid URL
 * Memory   reply is allocated also after a failure; wire_reply_free frees it
 */
enum outcome wire_send(struct wire *wire, const struct wire_request *request, struct wire_reply *reply)
{
	request_begin(wire, request, reply);
	return request_end(wire, curl_easy_perform(wire->curl), reply);
}

/* The URL of the server as the user gave it. */
const char *wire_url(const struct wire *wire)
{
	return wire->url;
}

/* Why the last wire_send got no reply, in the words of libcurl. */
const char *wire_failure(const struct wire *wire)
{
	return wire->failure;
}

/* Frees the contents of a reply and leaves it empty. */
void wire_reply_free(struct wire_reply *reply)
{
	free(reply->body);
	free(reply->type);
	*reply = (struct wire_reply){0};
}

/* Percent-encodes everything but letters, digits and -._~ */
char *wire_escape(struct wire *wire, const char *text)
{
	char *escaped = command_sure(curl_easy_escape(wire->curl, text, 0)),
	     *copy = command_sure(strdup(escaped));
	curl_free(escaped);
	return copy;
}

struct wire_jobs {
	CURLM *curl;
	int n;
	struct wire **wires;        /* (n) */
	struct wire_reply *replies; /* being received  (n) */
};

/* Prepares n simultaneous requests; their connections are kept open for later requests.
 *
 * Memory   allocates; wire_jobs_close frees
 */
struct wire_jobs *wire_jobs_open(const char *url, int n, int timeout_s)
{
	struct wire_jobs *jobs = command_sure(calloc(1, sizeof *jobs));
	*jobs = (struct wire_jobs){.n = n,
	                           .wires = command_sure(calloc((size_t)n, sizeof *jobs->wires)),
	                           .replies = command_sure(calloc((size_t)n, sizeof *jobs->replies))};
	for (int job = 0; job < n; job++) {
		jobs->wires[job] = wire_open(url);
		jobs->wires[job]->in_time = true;
		jobs->wires[job]->timeout_s = timeout_s;
	}
	jobs->curl = command_sure(curl_multi_init());
	curl_multi_setopt(jobs->curl, CURLMOPT_MAXCONNECTS, (long)n);
	return jobs;
}

/* Aborts all transfers and frees the jobs. */
void wire_jobs_close(struct wire_jobs *jobs)
{
	for (int job = 0; job < jobs->n; job++) {
		struct wire *wire = jobs->wires[job];
		curl_multi_remove_handle(jobs->curl, wire->curl);
		if (wire->body)
			fclose(wire->body);
		curl_slist_free_all(wire->headers);
		wire_reply_free(&jobs->replies[job]);
	}
	curl_multi_cleanup(jobs->curl);
	for (int job = 0; job < jobs->n; job++)
		wire_close(jobs->wires[job]);
	free(jobs->replies);
	free(jobs->wires);
	free(jobs);
}

void wire_jobs_send(struct wire_jobs *jobs, int job, const struct wire_request *request)
{
	struct wire *wire = jobs->wires[job];
	request_begin(wire, request, &jobs->replies[job]);
	curl_easy_setopt(wire->curl, CURLOPT_PRIVATE, &jobs->wires[job]);
	curl_multi_add_handle(jobs->curl, wire->curl);
}

/* Drives the transfers until one has ended.
 *
 * Returns  value    number of the job; -1: no transfer ended within wait_ms
 *          outcome  of this job, as returned by wire_send
 *          reply    of this job; wire_reply_free frees it
 */
int wire_jobs_receive(struct wire_jobs *jobs, int wait_ms, enum outcome *outcome, struct wire_reply *reply)
{
	int running, left;
	curl_multi_perform(jobs->curl, &running);
	CURLMsg *ended = curl_multi_info_read(jobs->curl, &left);
	if (!ended) {
		curl_multi_poll(jobs->curl, NULL, 0, wait_ms, NULL);
		curl_multi_perform(jobs->curl, &running);
		ended = curl_multi_info_read(jobs->curl, &left);
	}
	if (!ended)
		return -1;
	struct wire **wire;
	const CURLcode code = ended->data.result;
	curl_easy_getinfo(ended->easy_handle, CURLINFO_PRIVATE, &wire);
	const int job = (int)(wire - jobs->wires);
	curl_multi_remove_handle(jobs->curl, (*wire)->curl);
	*outcome = request_end(*wire, code, &jobs->replies[job]);
	*reply = jobs->replies[job];
	jobs->replies[job] = (struct wire_reply){0};
	return job;
}

const char *wire_jobs_failure(const struct wire_jobs *jobs, int job)
{
	return wire_failure(jobs->wires[job]);
}
