/* Malformed and unusual requests: framing, headers, targets, methods; paths to files; slow clients and many clients. */
#include <dirent.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/faults.h"
#include "tests/support/latency.h"
#include "tests/support/program.h"
#include "tests/support/raw_http.h"

#define HOST   "Host: localhost\r\n"
#define POST   "POST /v1/studies HTTP/1.1\r\n" HOST "Content-Type: application/json\r\n"
#define GET    "GET /livez HTTP/1.1\r\n" HOST

// a request smuggled behind an invalid one: it must not be answered
#define HIDDEN "GET /version HTTP/1.1\r\n" HOST "\r\n"

/* `may`: a second accepted status; 0: the connection is closed or stays open without an answer. */
static const struct {
	const char *bytes;
	int status, may;
	bool closes;
	int answers; /* number of answers, at most */
} CASES[] = {
    // framing
    {POST "Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}" HIDDEN, 400, 400, true, 1},
    {POST "Content-Length: 2\r\nContent-Length: 60\r\n\r\n{}" HIDDEN, 400, 400, true, 1},
    {POST "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {POST "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n0\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {POST "Transfer-Encoding: gzip\r\n\r\n" HIDDEN, 411, 411, true, 1},
    {POST "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n" HIDDEN, 411, 411, true, 1},
    {POST "transfer-encoding: identity\r\n\r\n" HIDDEN, 411, 411, true, 1},
    {POST "Transfer-Encoding: chunked\r\nTransfer-Encoding: gzip\r\n\r\n0\r\n\r\n" HIDDEN, 411, 411, true, 1},
    {POST "Transfer-Encoding : chunked\r\n\r\n0\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {POST "Transfer-Encoding: chunked\r\n\r\nfffffffffffffffff\r\n" HIDDEN, 411, 411, true, 1},
    // libmicrohttpd may write the header of these answers twice
    {POST "Content-Length: -1\r\n\r\n" HIDDEN, 400, 400, true, 2},
    {POST "Content-Length: +2\r\n\r\n{}" HIDDEN, 400, 400, true, 2},
    {POST "Content-Length: 0x2\r\n\r\n{}" HIDDEN, 400, 400, true, 2},
    {POST "Content-Length: 2, 2\r\n\r\n{}" HIDDEN, 400, 400, true, 2},
    {POST "Content-Length: 2x\r\n\r\n{}" HIDDEN, 400, 400, true, 2},
    {POST "Content-Length: \r\n\r\n" HIDDEN, 400, 400, true, 2},
    {POST "Content-Length: 99999999999999999999999\r\n\r\n" HIDDEN, 413, 413, true, 2},
    {POST "Content-Length: 9223372036854775808\r\n\r\n" HIDDEN, 413, 413, true, 1},
    {POST "Content-Length: 9000000000\r\n\r\n" HIDDEN, 413, 413, true, 1},
    {POST "Content-Length: 1048577\r\nExpect: 100-continue\r\n\r\n", 413, 413, true, 1},
    {POST "Content-Length: 2\r\nContent-Encoding: gzip\r\n\r\n{}" HIDDEN, 415, 415, true, 1},
    // headers
    {GET "Host: localhost\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {"GET /livez HTTP/1.1\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {"GET /livez HTTP/1.1\r\nHost: evil.example\r\n\r\n", 421, 421, false, 1},
    {"GET /livez HTTP/1.1\r\nHost: localhost.evil.example:8437\r\n\r\n", 421, 421, false, 1},
    {"GET /livez HTTP/1.1\r\nHost:\r\n\r\n", 421, 421, false, 1},
    {"GET /livez HTTP/1.1\r\nHost: 10.1.2.3:80\r\n\r\n", 200, 200, false, 1},
    {"GET /livez HTTP/1.0\r\n\r\n", 200, 200, true, 1},
    {GET ": nameless\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {GET "X: folded\r\n into two lines\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {"GET /livez HTTP/1.1\nHost: localhost\n\n" HIDDEN, 400, 400, true, 1},
    {GET "Authorization: Bearer a\r\nAuthorization: Bearer b\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {GET "X Y: blank in a name\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {GET "X\x01: control\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {GET "X: \x01\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {GET "X: \x7f\r\n\r\n" HIDDEN, 400, 400, true, 1},
    {GET "no colon\r\n\r\n", 400, 400, true, 1},
    {GET "Expect: 200-ok\r\n\r\n", 200, 417, false, 1},
    // trailing white space is not part of a value
    {"GET /livez HTTP/1.1\r\nHost: localhost \t\r\n\r\n", 200, 200, false, 1},
    {POST "Content-Length: 2\r\nContent-Encoding: identity \r\n\r\n{}", 422, 422, false, 1},
    {"POST /v1/studies HTTP/1.1\r\n" HOST
     "Content-Type: application/json\t; charset=utf-8 \r\nContent-Length: 2\r\n\r\n{}",
     422, 422, false, 1},
    {POST "Transfer-Encoding: chunked \r\n\r\n2\r\n{}\r\n0\r\n\r\n" HIDDEN, 411, 411, true, 1},
    // targets
    {"GET /livez%00 HTTP/1.1\r\n" HOST "\r\n", 400, 404, false, 1},
    {"GET /livez%00x HTTP/1.1\r\n" HOST "\r\n", 400, 404, false, 1},
    {"GET /v1/studies?status=queued%00x HTTP/1.1\r\n" HOST "\r\n", 400, 404, false, 1},
    {"GET /livez% HTTP/1.1\r\n" HOST "\r\n", 400, 404, false, 1},
    {"GET /livez%2 HTTP/1.1\r\n" HOST "\r\n", 400, 404, false, 1},
    {"GET /livez%gg HTTP/1.1\r\n" HOST "\r\n", 400, 404, false, 1},
    {"GET /li vez HTTP/1.1\r\n" HOST "\r\n", 400, 400, true, 1},
    {"GET /liv\x01z HTTP/1.1\r\n" HOST "\r\n", 400, 400, true, 1},
    {"GET /liv\xc3\xa4z HTTP/1.1\r\n" HOST "\r\n", 400, 400, true, 1},
    {"GET http://localhost/livez HTTP/1.1\r\n" HOST "\r\n", 404, 400, false, 1},
    {"GET livez HTTP/1.1\r\n" HOST "\r\n", 404, 400, false, 1},
    {"OPTIONS * HTTP/1.1\r\n" HOST "\r\n", 404, 405, false, 1},
    {"GET  /livez HTTP/1.1\r\n" HOST "\r\n", 400, 400, true, 1},
    // methods and versions
    {"get /livez HTTP/1.1\r\n" HOST "\r\n", 405, 405, false, 1},
    {"BREW /livez HTTP/1.1\r\n" HOST "\r\n", 405, 405, false, 1},
    {"PUT /livez HTTP/1.1\r\n" HOST "Content-Length: 2\r\n\r\n{}", 405, 405, true, 1},
    {"TRACE /livez HTTP/1.1\r\n" HOST "\r\n", 405, 405, false, 1},
    {"CONNECT localhost:80 HTTP/1.1\r\n" HOST "\r\n", 404, 405, false, 1},
    {"GET /livez HTTP/2.0\r\n" HOST "\r\n", 505, 400, true, 1},
    {"GET /livez HTTP/0.9\r\n" HOST "\r\n", 400, 505, true, 1},
    {"GET /livez\r\n", 400, 505, true, 1},
    {"GET \r\n\r\n", 400, 505, true, 1},
    {"GET\r\n\r\n", 400, 0, true, 1},
    {"GET /livez HTTX/1.1\r\n" HOST "\r\n", 400, 505, true, 1},
    {"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505, 400, true, 1},
    {"\x16\x03\x01\x02\x01\x01\xfc\x03\x03\r\n\r\n", 400, 0, true, 1},
    {"\r\n\r\n" GET "\r\n", 200, 400, false, 1},
    // two requests in one packet are both answered, in order
    {GET "\r\n" HIDDEN, 200, 200, false, 2},
    {POST "Content-Length: 2\r\n\r\n{}" HIDDEN, 422, 422, false, 2},
};

static void a_request_of_doubtful_shape_has_one_answer_and_hides_no_other(void **state)
{
	struct service *service = *state;
	int n = (int)(sizeof CASES / sizeof CASES[0]), closed = 0;
	for (int i = 0; i < n; i++) {
		static struct raw_answer answer;
		raw_ask(service, CASES[i].bytes, strlen(CASES[i].bytes), CASES[i].closes ? 5 : 0.1, &answer);
		bool status = answer.status == CASES[i].status || answer.status == CASES[i].may;
		bool hidden = CASES[i].answers == 1 && strstr(answer.text, "\"version\"") && answer.status != 200;
		if (!status || answer.n > CASES[i].answers || hidden || answer.reset ||
		    (CASES[i].closes && !answer.closed))
			fail_msg("%.120s...: status %d, %d answers%s%s\n%s", CASES[i].bytes, answer.status, answer.n,
			         answer.closed ? ", closed" : "", answer.reset ? ", reset" : "", answer.text);
		closed += answer.closed;
	}
	check_report("%d requests, %d connections closed by the server, 0 hidden ones answered", n, closed);
}

static void a_nul_in_a_head_is_refused(void **state)
{
#define CASE(text)            \
	{                         \
		text, sizeof text - 1 \
	}
	static const struct {
		const char *bytes;
		size_t n;
	} cases[] = {
	    CASE("GET /livez\0x HTTP/1.1\r\n" HOST "\r\n"),
	    CASE("GET /livez\0 HTTP/1.1\r\n" HOST "\r\n"),
	    CASE("GET\0x /livez HTTP/1.1\r\n" HOST "\r\n"),
	    CASE("GET /livez HTTP/1.1\0\r\n" HOST "\r\n"),
	    CASE(GET "X: a\0b\r\n\r\n"),
	    CASE(GET "X: a\0\r\n\r\n"),
	    CASE(GET "X: a\0\r\nY: b\r\n\r\n"),
	    CASE(GET "X\0: a\r\n\r\n"),
	    CASE(GET "\0: a\r\n\r\n"),
	    CASE(POST "Content-Length: 2\0\r\n\r\n{}"),
	    CASE(POST "Transfer-Encoding: chunked\0\r\n\r\n2\r\n{}\r\n0\r\n\r\n"),
	};
#undef CASE
	struct service *service = *state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		static struct raw_answer answer;
		raw_ask(service, cases[i].bytes, cases[i].n, 5, &answer);
		if (answer.status != 400 || !answer.closed || answer.n != 1)
			fail_msg("case %zu: %s", i, answer.text);
	}
}

/* Sends a request in which `part` is repeated n times. */
static void ask_long(const struct service *service, const char *head, const char *part, int n,
                     const char *tail, struct raw_answer *answer)
{
	char *bytes = malloc(strlen(head) + (size_t)n * strlen(part) + strlen(tail) + 1),
	     *end = stpcpy(bytes, head);
	for (int i = 0; i < n; i++)
		end = stpcpy(end, part);
	end = stpcpy(end, tail);
	raw_ask(service, bytes, (size_t)(end - bytes), 5, answer);
	free(bytes);
}

static void a_head_over_a_limit_has_one_answer_that_says_so(void **state)
{
#define TAIL " HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n"
#define LAST "Connection: close\r\n\r\n"
	static const struct {
		const char *head, *part, *tail;
		int n, status; // n: repetitions of `part`
	} cases[] = {
	    {"GET /v1/studies?", "&", TAIL, 15, 200},
	    {"GET /v1/studies?", "&", TAIL, 16, 400},
	    {"GET /v1/studies?", "a=b&", TAIL, 500, 400},
	    {"GET /v1/studies?", "&", TAIL, 8000, 414},
	    {"GET /", "x", TAIL, 4095, 404},
	    {"GET /", "x", TAIL, 4096, 414},
	    {"GET /", "x", TAIL, 20000, 414},
	    {GET, "X:\r\n", LAST, 62, 200},
	    {GET, "X:\r\n", LAST, 63, 431},
	    {GET, "X:\r\n", LAST, 5000, 431},
	    {GET "X: ", "x", "\r\n" LAST, 16000, 200},
	    {GET "X: ", "x", "\r\n" LAST, 16400, 431},
	    {GET "X: ", "x", "\r\n" LAST, 100000, 431},
	    {POST "Transfer-Encoding: chunked\r\n\r\n2;", "x", "\r\n{}\r\n0\r\n\r\n", 100000, 411},
	};
	struct service *service = *state;
	static struct raw_answer answer;
	int n = 0;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		ask_long(service, cases[i].head, cases[i].part, cases[i].n, cases[i].tail, &answer);
		if (answer.status != cases[i].status || answer.n != 1 || !answer.closed || answer.reset)
			fail_msg("%s %d times: %s", cases[i].part, cases[i].n, answer.text);
	}
	// at no length does libmicrohttpd have memory for the request header but none for the answer
	for (int length = 31000; length < 33000; length += 25, n++) {
		ask_long(service, GET "X: ", "x", length, "\r\n" LAST, &answer);
		if (answer.status != 431 || answer.n != 1)
			fail_msg("%d bytes: %s", length, answer.text);
	}
	check_report("%d heads of 31000 to 33000 bytes: all 431", n);
#undef TAIL
#undef LAST
}

/* Escapes, double escapes and other spellings of ../ before the names of files. */
static void no_path_leads_to_a_file(void **state)
{
	static const char *const ups[] = {"../",           "..%2f",           "%2e%2e/", "%2e%2e%2f",
	                                  "..%5c",         "%252e%252e%252f", "....//",  "..;/",
	                                  "%c0%ae%c0%ae/", "./../",           "..%252f", "/..//../",
	                                  "..%00/",        "%2e./",           "..\\",    "%uff0e%uff0e/"};
	static const char *const files[] = {"etc/passwd",        "etc/shadow", "proc/self/environ",
	                                    "proc/self/cmdline", "studies.db", "studies.db-wal",
	                                    "root/.ssh/id_rsa"};
	static const char *const starts[] = {"/", "/v1/studies/"};
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	int n = 0;
	(void)state;
	service_start(service, 1);
	long opened = faults->files_opened;
	assert_true(opened > 0);
	for (size_t u = 0; u < sizeof ups / sizeof ups[0]; u++)
		for (size_t f = 0; f < sizeof files / sizeof files[0]; f++)
			for (size_t s = 0; s < 2; s++, n++) {
				char bytes[512];
				static struct raw_answer answer;
				snprintf(bytes, sizeof bytes, "GET %s%s%s%s HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
				         starts[s], ups[u], ups[u], files[f]);
				raw_ask(service, bytes, strlen(bytes), 5, &answer);
				if (answer.status != 404 && answer.status != 400)
					fail_msg("%s: %d %s", bytes, answer.status, answer.text);
			}
	check_report("%d paths, all 404 or 400; files opened meanwhile: %ld", n, faults->files_opened - opened);
	assert_true(n >= 200);
	assert_int_equal(faults->files_opened, opened);
	service_stop(service);
	faults_free(faults);
	service_free(service);
}

static void a_body_that_is_too_large_is_refused_before_it_is_read_and_without_a_reset(void **state)
{
	static const char head[] = POST "Content-Length: 67108864\r\n\r\n";
	enum { SIZE = 64 << 20, TRIES = 5 };
	struct service *service = *state;
	char *bytes = calloc(1, SIZE + sizeof head);
	assert_non_null(bytes);
	memcpy(bytes, head, strlen(head));
	for (int i = 0; i < TRIES; i++) {
		static struct raw_answer answer;
		// a client that reads nothing until it has sent the whole body
		raw_ask(service, bytes, strlen(head) + SIZE, 5, &answer);
		if (answer.status != 413 || answer.reset || answer.n != 1)
			fail_msg("%d%s: %s", answer.status, answer.reset ? " reset" : "", answer.text);
		// a client that sends only the header
		raw_ask(service, bytes, strlen(head), 2, &answer);
		assert_int_equal(answer.status, 413);
	}
	free(bytes);
}

static void what_is_answered_cannot_be_framed_guessed_or_kept(void **state)
{
	static const char *const headers[] = {
	    "X-Content-Type-Options: nosniff",
	    "Content-Security-Policy: default-src 'none'; frame-ancestors 'none'", "Referrer-Policy: no-referrer",
	    "Cache-Control: no-store", "X-Request-Id: "};
	static const char *const requests[] = {GET "\r\n", "GET /nowhere HTTP/1.1\r\n" HOST "\r\n",
	                                       "PUT /livez HTTP/1.1\r\n" HOST "\r\n",
	                                       POST "Content-Length: 2\r\n\r\n{}"};
	struct service *service = *state;
	for (size_t r = 0; r < sizeof requests / sizeof requests[0]; r++) {
		static struct raw_answer answer;
		raw_ask(service, requests[r], strlen(requests[r]), 0.1, &answer);
		for (size_t h = 0; h < sizeof headers / sizeof headers[0]; h++)
			if (!strstr(answer.text, headers[h]))
				fail_msg("%s is not in\n%s", headers[h], answer.text);
		assert_null(strstr(answer.text, "Access-Control-"));
		assert_null(strstr(answer.text, "Server:"));
	}
}

static void an_answer_and_its_line_of_the_log_have_one_number(void **state)
{
	struct service *service = *state;
	static struct raw_answer answer;
	char line[1024], id[17] = "";
	raw_ask(service, GET "\r\n", strlen(GET "\r\n"), 0.1, &answer);
	const char *header = strstr(answer.text, "X-Request-Id: ");
	assert_non_null(header);
	snprintf(id, sizeof id, "%s", header + strlen("X-Request-Id: "));
	service_stop(service);
	FILE *log = fopen(service->log, "r");
	assert_non_null(log);
	bool found = false;
	while (fgets(line, sizeof line, log))
		found |= strstr(line, id) && strstr(line, " GET /livez 200 ");
	fclose(log);
	assert_true(found);
}

static void who_is_slow_is_closed_and_others_are_served_meanwhile(void **state)
{
	static const char *const settings[][2] = {
	    {"POUNDD_HEADER_TIMEOUT", "1"}, {"POUNDD_BODY_TIMEOUT", "1"}, {"POUNDD_IDLE_TIMEOUT", "1"}, {NULL}};
	static const struct {
		const char *first, *then;
	} clients[] = {
	    {"", "G"},                                 // nothing, then single letters
	    {"GET /livez HTTP/1.1\r\n", "X-Y: a\r\n"}, // single header fields
	    {POST "Content-Length: 100000\r\n\r\n", " "},
	    {GET "\r\n", ""}, // a complete request, then silence
	};
	enum { KINDS = sizeof clients / sizeof clients[0], EACH = 40, N = KINDS * EACH };
	(void)state;
	struct service *service = service_with(settings, 1);
	int sockets[N], answered = 0, closed = 0;
	static struct raw_answer answer;
	for (int i = 0; i < N; i++) {
		sockets[i] = raw_open(service);
		raw_send(sockets[i], clients[i % KINDS].first, strlen(clients[i % KINDS].first));
	}
	// the deadlines are absolute: further bytes do not extend them
	for (int round = 0; round < 20; round++) {
		for (int i = 0; i < N; i++)
			raw_send(sockets[i], clients[i % KINDS].then, strlen(clients[i % KINDS].then));
		raw_ask(service, GET "\r\n", strlen(GET "\r\n"), 0.1, &answer);
		answered += answer.status == 200;
	}
	for (int i = 0; i < N; i++) {
		raw_receive(sockets[i], 5, &answer);
		closed += answer.closed;
		close(sockets[i]);
	}
	check_report("%d slow clients, %d closed; %d of 20 others answered", N, closed, answered);
	assert_int_equal(closed, N);
	assert_int_equal(answered, 20);
	service_stop(service);
	service_free(service);
}

/* Number of deleted files that a server has open. */
static int files_unnamed(const struct service *service)
{
	char path[64], name[512];
	snprintf(path, sizeof path, "/proc/%d/fd", (int)service->pid);
	DIR *folder = opendir(path);
	assert_non_null(folder);
	int n = 0;
	for (struct dirent *file; (file = readdir(folder));) {
		ssize_t length = readlinkat(dirfd(folder), file->d_name, name, sizeof name - 1);
		name[length > 0 ? length : 0] = '\0';
		n += strstr(name, "(deleted)") != NULL;
	}
	closedir(folder);
	return n;
}

static int files_unnamed_become(const struct service *service, int wanted)
{
	int n = -1;
	for (int tick = 0; tick < 1200 && (n = files_unnamed(service)) != wanted; tick++)
		nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
	return n;
}

static void long_answers_wait_for_slow_readers_in_files_without_names(void **state)
{
	enum { SIGNALS = 4, READERS = 4 };
	struct service *service = *state;
	char id[17], get[256];
	service_histories(service, SIGNALS, id);
	const int before = files_unnamed(service);
	struct answer whole = service_get(service, "/v1/studies/%s/samples", id);
	assert_int_equal(whole.status, 200);
	assert_true(whole.length > 8 << 20); // more than socket buffers hold
	assert_int_equal(files_unnamed_become(service, before), before);
	int sockets[READERS];
	snprintf(get, sizeof get, "GET /v1/studies/%s/samples HTTP/1.1\r\n" HOST "\r\n", id);
	for (int i = 0; i < READERS; i++) {
		sockets[i] = raw_open(service);
		raw_send(sockets[i], get, strlen(get));
	}
	assert_int_equal(files_unnamed_become(service, before + READERS), before + READERS);
	struct answer again = service_get(service, "/v1/studies/%s/samples", id);
	assert_int_equal(again.length, whole.length);
	assert_memory_equal(again.body, whole.body, whole.length);
	for (int i = 0; i < READERS; i++)
		close(sockets[i]);
	assert_int_equal(files_unnamed_become(service, before), before);
	check_report("%d readers of %zu bytes", READERS, whole.length);
	answer_free(&whole);
	answer_free(&again);
}

/* A client that requests a long result in a loop. */
struct loop {
	const struct service *service;
	const char *method, *path;
	atomic_bool *ends;
	size_t length;
	int n;
	pthread_t thread;
};

static void *loop_run(void *of)
{
	struct loop *loop = of;
	while (!*loop->ends) {
		struct answer answer =
		    service_ask(loop->service, &(struct ask){.method = loop->method, .path = loop->path});
		assert_int_equal(answer.status, 200);
		loop->length = answer.length;
		loop->n++;
		answer_free(&answer);
	}
	return NULL;
}

static void a_long_result_holds_nobody_up(void **state)
{
	enum { CLIENTS = 8, ASKED = 200 };
	static const char *const methods[] = {"HEAD", "GET"};
	static const char probe[] = "GET /livez HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n";
	struct service *service = *state;
	char document[512], id[17], path[64];
	snprintf(document, sizeof document,
	         "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	         "{\"frequency_hz\": 3}], "
	         "\"excitation\": {\"frequency_hz\": 5, \"cycles\": 2, \"signals\": %d}}, "
	         "\"sweep\": [{\"path\": \"/contact/restitution\", \"values\": [0.4, 0.8]}]}",
	         check_soaks() ? 58000 : 5000);
	service_submit(service, document, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	snprintf(path, sizeof path, "/v1/studies/%s/results", id);
	const int64_t length =
	    service_number(service, "SELECT length(content) FROM document WHERE name = 'result'");
	for (int m = 0; m < 2; m++) {
		struct loop loops[CLIENTS];
		struct latencies latencies = {0};
		atomic_bool ends = false;
		int n = 0;
		for (int i = 0; i < CLIENTS; i++) {
			loops[i] = (struct loop){.service = service, .method = methods[m], .path = path, .ends = &ends};
			assert_int_equal(pthread_create(&loops[i].thread, NULL, loop_run, &loops[i]), 0);
		}
		for (int i = 0; i < ASKED; i++) {
			static struct raw_answer answer;
			double asked = latency_now();
			raw_ask(service, probe, strlen(probe), 5, &answer);
			assert_int_equal(answer.status, 200);
			latency_add(&latencies, asked, latency_now());
			nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
		}
		ends = true;
		for (int i = 0; i < CLIENTS; i++) {
			pthread_join(loops[i].thread, NULL);
			n += loops[i].n;
			assert_int_equal(loops[i].length, m ? (size_t)length : 0);
		}
		const double p99 = latency_quantile(&latencies, 0.99);
		check_report("%d clients who loop %s of a result of %.1f MB, %d answers: /livez p99 %.1f ms", CLIENTS,
		             methods[m], 1e-6 * (double)length, n, p99);
		if (check_soaks())
			assert_true(p99 <= 20);
		free(latencies.answers);
	}
	static struct raw_answer answer;
	snprintf(document, sizeof document, "HEAD %s HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n", path);
	raw_ask(service, document, strlen(document), 5, &answer);
	snprintf(path, sizeof path, "Content-Length: %lld\r\n", (long long)length);
	assert_non_null(strstr(answer.text, path));
}

static void more_connections_than_the_limit_get_503(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_CONNECTIONS_MAX", "3"}, {NULL}};
	enum { N = 6 };
	(void)state;
	struct service *service = service_with(settings, 1);
	int sockets[N], served = 0, refused = 0;
	for (int i = 0; i < N; i++) {
		static struct raw_answer answer;
		const char *request = i % 2 ? HIDDEN : POST "Content-Length: 2\r\n\r\n{}";
		sockets[i] = raw_open(service);
		raw_send(sockets[i], request, strlen(request));
		raw_receive(sockets[i], 0.2, &answer);
		served += answer.status == (i % 2 ? 200 : 422);
		// a refused connection is closed and occupies no slot
		refused += answer.status == 503 && strstr(answer.text, "Retry-After: ") && answer.closed;
	}
	assert_int_equal(served, 3);
	assert_int_equal(refused, 3);
	for (int i = 0; i < N; i++)
		close(sockets[i]);
	// after they are closed, new connections are served
	static struct raw_answer answer;
	for (int i = 0; i < 100 && answer.status != 200; i++)
		raw_ask(service, GET "\r\n", strlen(GET "\r\n"), 0.05, &answer);
	assert_int_equal(answer.status, 200);
	service_stop(service);
	service_free(service);
}

/* A service limited to n open files (soft and hard limit). */
static struct service *with_files(int n)
{
	const char *build = getenv("POUND_BUILD");
	char limit[64], program[256], out[128];
	struct service *service = service_new();
	snprintf(limit, sizeof limit, "ulimit -n %d && exec \"$0\" \"$@\"", n);
	snprintf(program, sizeof program, "%s/poundd", build ? build : "build/release");
	snprintf(out, sizeof out, "%s/out", service->directory);
	service->pid =
	    program_start((const char *const[]){"sh", "-c", limit, program, "--port", "0", "--database",
	                                        service->database, "--workers", "1", NULL},
	                  out, service->log);
	for (int i = 0; i < 1000 && service->port == 0; i++) {
		char *line = program_file(out, NULL);
		if (!line || sscanf(line, "listening on http://127.0.0.1:%d\n", &service->port) != 1)
			usleep(10000);
		free(line);
	}
	assert_int_not_equal(service->port, 0);
	return service;
}

/* CPU time of a server [s] */
static double cpu_of(const struct service *service)
{
	clockid_t clock;
	struct timespec cpu;
	assert_int_equal(clock_getcpuclockid(service->pid, &clock), 0);
	assert_int_equal(clock_gettime(clock, &cpu), 0);
	return (double)cpu.tv_sec + 1e-9 * (double)cpu.tv_nsec;
}

/* Number of occurrences of a word in a server's log. */
static int logged(const struct service *service, const char *word)
{
	int n = 0;
	char *log = program_file(service->log, NULL);
	assert_non_null(log);
	for (const char *at = log; (at = strstr(at, word)); at++)
		n++;
	free(log);
	return n;
}

static void with_few_descriptors_fewer_are_served_and_nothing_spins(void **state)
{
	enum { N = 120, FILES = 64 };
	static struct raw_answer answer;
	int sockets[N], served = 0, refused = 0;
	struct service *service = with_files(FILES);
	(void)state;
	assert_int_equal(logged(service, "the limit of open files (ulimit -n) is 64"), 1);
	for (int i = 0; i < N; i++)
		sockets[i] = raw_open(service);
	double before = cpu_of(service);
	usleep(1000000);
	double cpu = cpu_of(service) - before;
	int lines = logged(service, "Error accepting");
	for (int i = 0; i < N; i++)
		close(sockets[i]);
	check_report("%d idle connections with %d descriptors: %.2f s of a core in 1 s, %d lines of the log", N,
	             FILES, cpu, lines);
	assert_true(cpu < 0.5);
	assert_int_equal(lines, 0);
	for (int i = 0; i < 100 && answer.status != 200; i++)
		raw_ask(service, GET "\r\n", strlen(GET "\r\n"), 0.05, &answer);
	assert_int_equal(answer.status, 200);
	// connections are served up to the limit, the next one gets 503
	for (int i = 0; i < N && refused == 0; i++, served++) {
		sockets[i] = raw_open(service);
		raw_send(sockets[i], GET "\r\n", strlen(GET "\r\n"));
		answer.status = 0;
		for (int tries = 0; answer.status == 0 && tries < 50; tries++)
			raw_receive(sockets[i], 0.2, &answer);
		assert_true(answer.status == 200 || answer.status == 503);
		refused += answer.status == 503;
	}
	assert_true(served > 8 && refused == 1);
	for (int i = 0; i < served; i++)
		close(sockets[i]);
	service_stop(service);
	service_free(service);
}

static void what_the_library_reports_again_and_again_is_logged_once_a_second(void **state)
{
	enum { N = 60 };
	struct rlimit before, few;
	int sockets[N];
	struct service *service = *state;
	// lowered after the start, so the server does not know the new limit
	assert_int_equal(prlimit(service->pid, RLIMIT_NOFILE, NULL, &before), 0);
	few = (struct rlimit){30, before.rlim_max};
	assert_int_equal(prlimit(service->pid, RLIMIT_NOFILE, &few, NULL), 0);
	struct timespec start, end;
	clock_gettime(CLOCK_MONOTONIC, &start);
	for (int i = 0; i < N; i++)
		sockets[i] = raw_open(service);
	usleep(1500000);
	assert_int_equal(prlimit(service->pid, RLIMIT_NOFILE, &before, NULL), 0);
	int lines = logged(service, "Error accepting");
	clock_gettime(CLOCK_MONOTONIC, &end);
	for (int i = 0; i < N; i++)
		close(sockets[i]);
	// one line for each second begun, and one more
	assert_true(lines >= 1 && lines <= end.tv_sec - start.tv_sec + 2);
	assert_true(logged(service, " earlier messages omitted") >= 1);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(a_request_of_doubtful_shape_has_one_answer_and_hides_no_other),
           SERVED(a_nul_in_a_head_is_refused), SERVED(a_head_over_a_limit_has_one_answer_that_says_so),
           cmocka_unit_test(no_path_leads_to_a_file),
           SERVED(a_body_that_is_too_large_is_refused_before_it_is_read_and_without_a_reset),
           SERVED(what_is_answered_cannot_be_framed_guessed_or_kept),
           SERVED(an_answer_and_its_line_of_the_log_have_one_number),
           cmocka_unit_test(who_is_slow_is_closed_and_others_are_served_meanwhile),
           SERVED(a_long_result_holds_nobody_up),
           SERVED(long_answers_wait_for_slow_readers_in_files_without_names),
           cmocka_unit_test(more_connections_than_the_limit_get_503),
           cmocka_unit_test(with_few_descriptors_fewer_are_served_and_nothing_spins),
           SERVED(what_the_library_reports_again_and_again_is_logged_once_a_second))
