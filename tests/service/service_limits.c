/* The limits of a server, each with the status and the text in the table of server/server.md. */
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "tests/support/program.h"
#include "tests/support/raw_http.h"

enum { LONG = 20000 };

#define HOST "Host: localhost\r\n"
#define JSON "Content-Type: application/json\r\n"
#define HASH "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"
#define POST "POST /v1/studies HTTP/1.1\r\n" HOST JSON

/* requests that exceed one limit; `again` is repeated `times` between `first` and `rest` */
static const struct {
	const char *first, *again, *rest;
	int times;
	int status;
	const char *detail;
} heads[] = {
    {"GET /v1/studies?status=", "a", " HTTP/1.1\r\n" HOST "\r\n", 4096, 414,
     "the request target may have at most 4096 bytes"},
    {"GET /v1/studies?limit=1", "&a=1", " HTTP/1.1\r\n" HOST "\r\n", 16, 400,
     "the request target may have at most 16 query parameters"},
    {"GET /livez HTTP/1.1\r\n" HOST, "X-A: 1\r\n", "\r\n", 64, 431, "a request may have at most 64 headers"},
    {"GET /livez HTTP/1.1\r\n" HOST "X-A: ", "a", "\r\n\r\n", 17000, 431,
     "request line and headers together may have at most 16384 bytes"},
    {POST "Transfer-Encoding: chunked\r\n", "", "\r\n2\r\n{}\r\n0\r\n\r\n", 0, 411,
     "a body needs a Content-Length; Transfer-Encoding is not supported"},
    {POST "Content-Length: 1048577\r\n", "", "\r\n", 0, 413, "a body may have at most 1 MiB"},
    {"PUT /v1/records/" HASH " HTTP/1.1\r\n" HOST "Content-Length: 8388609\r\n", "", "\r\n", 0, 413,
     "the file of a record may have at most 8 MiB"},
    {POST "Content-Length: 2\r\nIdempotency-Key: ", "k", "\r\n\r\n{}", 201, 400,
     "an Idempotency-Key must have 1 to 200 characters"},
    {POST "Content-Length: 2\r\nOrigin: http://", "e", ".example\r\n\r\n{}", 1, 403,
     "pages of another origin must not change anything here"},
};

/* Fails unless the page's table of limits has a row with this status and text. */
static void is_listed(const char *page, int status, const char *detail)
{
	char cells[256];
	snprintf(cells, sizeof cells, "| %d | %s |", status, detail);
	if (!strstr(page, cells))
		fail_msg("server/server.md has no row with %s", cells);
}

static void each_limit_is_answered_with_its_status_and_the_words_of_the_page(void **state)
{
	static struct raw_answer answer;
	static char bytes[LONG];
	char *page = program_file("server/server.md", NULL);
	assert_non_null(page);
	for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++) {
		size_t n = (size_t)snprintf(bytes, sizeof bytes, "%s", heads[i].first);
		for (int k = 0; k < heads[i].times; k++)
			n += (size_t)snprintf(bytes + n, sizeof bytes - n, "%s", heads[i].again);
		n += (size_t)snprintf(bytes + n, sizeof bytes - n, "%s", heads[i].rest);
		assert_true(n < sizeof bytes);
		raw_ask(*state, bytes, n, 2, &answer);
		if (answer.status != heads[i].status || !strstr(answer.text, heads[i].detail))
			fail_msg("%.40s ...: %d, not %d: %s\n%s", heads[i].first, answer.status, heads[i].status,
			         heads[i].detail, answer.text);
		assert_int_equal(answer.n, 1);
		is_listed(page, heads[i].status, heads[i].detail);
	}
	check_report("%zu limits of a request, each with its status and words", sizeof heads / sizeof heads[0]);
	free(page);
}

static void a_full_queue_is_answered_with_its_status_and_the_words_of_the_page(void **state)
{
	struct service *service = service_with((const char *const[][2]){{"POUNDD_QUEUE_MAX", "1"}, {NULL}}, 1);
	char *study = service_study(20 * SERVICE_ROWS, 10, 1), *page = program_file("server/server.md", NULL);
	struct answer answer = {0};
	(void)state;
	for (int i = 0; i < 8 && answer.status != 503; i++) {
		answer_free(&answer);
		answer = service_post(service, study);
	}
	assert_int_equal(answer.status, 503);
	assert_true(atoi(answer.retry_after) > 0);
	assert_non_null(strstr(answer.body, "the queue is full"));
	is_listed(page, 503, "the queue is full");
	answer_free(&answer);
	free(study);
	free(page);
	service_free(service);
}

/* The concatenated sources of the tests of servers, with adjacent string literals joined. */
static char *tests_of_servers(void)
{
	static const char *const patterns[] = {"tests/service/*.c", "tests/long/soak_*.c"};
	char *all = calloc(1, 1), *to;
	size_t n = 0;
	for (int p = 0; p < 2; p++) {
		glob_t found;
		assert_int_equal(glob(patterns[p], 0, NULL, &found), 0);
		for (size_t i = 0; i < found.gl_pathc; i++) {
			size_t length;
			char *text = program_file(found.gl_pathv[i], &length);
			all = realloc(all, n + length + 1);
			to = all + n;
			for (const char *from = text; *from;) {
				const size_t blank = *from == '"' ? strspn(from + 1, " \t\n") : 0;
				if (blank && memchr(from + 1, '\n', blank) && from[1 + blank] == '"')
					from += blank + 2;
				else
					*to++ = *from++;
			}
			*to = '\0';
			n = (size_t)(to - all);
			free(text);
		}
		globfree(&found);
	}
	return all;
}

/* The first function of the tests whose name contains a text; NULL: none. */
static const char *function_of(const char *tests, const char *name)
{
	static const char start[] = "\nstatic void ";
	for (const char *at = tests; (at = strstr(at, start)); at++) {
		const char *own = at + strlen(start), *found = strstr(own, name);
		if (found && found < own + strcspn(own, "("))
			return own;
	}
	return NULL;
}

/* Every row of the table names a test, and its text occurs in the tests. */
static void every_limit_of_the_page_has_a_test(void **state)
{
	char *page = program_file("server/server.md", NULL), *tests = tests_of_servers();
	char *table = strstr(page, "| limit | value | status | detail | by |\n");
	int n = 0;
	(void)state;
	assert_non_null(table);
	*strstr(table, "\n\n") = '\0';
	for (char *row = strchr(strchr(table, '\n') + 1, '\n'); row; row = strchr(row + 1, '\n')) {
		char status[8] = "", detail[200] = "", by[80] = "";
		if (sscanf(row, "\n| %*[^|]| %*[^|]| %7[^ ] | %199[^|]| `T=%79[a-z0-9_]` |", status, detail, by) != 3)
			fail_msg("not a row of limits: %.200s", row);
		detail[strlen(detail) - 1] = '\0';
		if (!function_of(tests, by))
			fail_msg("there is no test with %s in its name", by);
		// some rows describe the answer instead of quoting it
		const bool quoted = atoi(status) >= 400 && !strstr(detail, "...") && strcmp(detail, "the same") != 0;
		if (quoted && !strstr(tests, detail))
			fail_msg("no test has the words: %s", detail);
		n++;
	}
	check_report("%d limits of the page, each with a test", n);
	assert_true(n > 20);
	free(tests);
	free(page);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(each_limit_is_answered_with_its_status_and_the_words_of_the_page),
           cmocka_unit_test(a_full_queue_is_answered_with_its_status_and_the_words_of_the_page),
           cmocka_unit_test(every_limit_of_the_page_has_a_test))
