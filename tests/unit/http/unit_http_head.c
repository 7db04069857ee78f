/* The head of a request: requests that are refused before they are processed. */
#include "schema/http/http_head.h"

#include <limits.h>
#include <string.h>

#include "tests/support/check.h"

/* A head from "Name: value" lines. */
static struct head judged(const char *target, const char *const *lines, bool needs_host)
{
	struct head head;
	head_target(&head, target);
	for (; *lines; lines++) {
		const char *colon = strchr(*lines, ':');
		const char *value = colon + 1 + strspn(colon + 1, " ");
		head_header(&head, *lines, (size_t)(colon - *lines), value, strlen(value));
	}
	head_end(&head, needs_host, "pound.example,other.example");
	return head;
}

static void a_target_is_visible_ascii_and_its_escapes_are_whole(void **state)
{
	static const struct {
		const char *target;
		bool refused;
	} cases[] = {
	    {"/livez", false},     {"/a%20b?c=%2F", false}, {"*", false},
	    {"/%00", true},        {"/livez%00x", true},    {"/%", true},
	    {"/%4", true},         {"/%4g", true},          {"/a b", true},
	    {"/\x7f", true},       {"/\xc3\xa4", true},     {"/?a=%00", true},
	    {"http://h/p", false}, {"/%2500", false},       {"/\x01", true},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct head head = judged(cases[i].target, (const char *const[]){"Host: localhost", NULL}, true);
		if ((head.fault == API_BAD_REQUEST) != cases[i].refused)
			fail_msg("%s", cases[i].target);
	}
}

static void a_target_has_so_many_bytes_and_arguments(void **state)
{
	char target[HEAD_TARGET_MAX + 2];
	struct head head;
	(void)state;
	memset(target, 'a', sizeof target);
	target[HEAD_TARGET_MAX + 1] = '\0';
	target[8] = '?';
	assert_int_equal(head_target(&head, target), 8);
	assert_int_equal(head.fault, API_TARGET_LONG);
	target[HEAD_TARGET_MAX] = '\0';
	assert_int_equal(head_target(&head, target), HEAD_TARGET_MAX);
	assert_int_equal(head.fault, API_NO_FAULT);
	memset(target + 9, '&', HEAD_ARGUMENTS_MAX - 1);
	assert_int_equal(head_target(&head, target), HEAD_TARGET_MAX);
	assert_int_equal(head.fault, API_NO_FAULT);
	target[100] = '&';
	assert_int_equal(head_target(&head, target), 8);
	assert_int_equal(head.fault, API_BAD_REQUEST);
	assert_true(head.close);
}

static void a_head_has_no_byte_but_those_of_its_lines(void **state)
{
#define CASE(text, n, fault)            \
	{                                   \
		text, sizeof text - 1, n, fault \
	}
	static const struct {
		const char *bytes; // from the end of the version on
		size_t n;
		int n_lines;
		enum api_fault fault;
	} cases[] = {
	    CASE("\0\0\0\0", 0, API_NO_FAULT),
	    CASE("\0\0A\0 b\0\0C\0d\0\0\0\0", 2, API_NO_FAULT),
	    CASE("\0\0A\0 b\0c\0\0\0\0", 1, API_BAD_REQUEST),    // A: b NUL c
	    CASE("\0\0A\0 b\0\0\0\0\0", 1, API_BAD_REQUEST),     // A: b NUL
	    CASE("\0\0A\0 b\0\0 c\0\0\0\0", 1, API_BAD_REQUEST), // folded
	    CASE("\0A\0 b\0\0", 1, API_BAD_REQUEST),             // LF without CR
	    CASE("\0\0\0 x\0\0", 0, API_BAD_REQUEST),            // a line without a name
	};
#undef CASE
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct head head;
		head_target(&head, "/");
		head_bytes(&head, cases[i].bytes, cases[i].n, cases[i].n_lines);
		if (head.fault != cases[i].fault || head.close != (head.fault != API_NO_FAULT))
			fail_msg("case %zu: fault %d", i, head.fault);
	}
}

static void what_a_page_of_another_origin_sends_is_foreign(void **state)
{
	static const struct {
		const char *lines[4];
		bool foreign;
	} cases[] = {
	    {{"Host: localhost:8437"}, false},
	    {{"Host: localhost:8437", "Origin: http://localhost:8437", "Sec-Fetch-Site: same-origin"}, false},
	    {{"Host: pound.example", "Origin: https://Pound.Example"}, false},
	    {{"Host: localhost:8437", "Sec-Fetch-Site: none"}, false},
	    {{"Host: localhost:8437", "Origin: http://localhost:3000"}, true},
	    {{"Host: localhost:8437", "Origin: http://localhost"}, true},
	    {{"Host: localhost:8437", "Origin: http://localhost:84370"}, true},
	    {{"Host: localhost:8437", "Origin: http://evil.example"}, true},
	    {{"Host: localhost:8437", "Origin: null"}, true},
	    {{"Host: localhost:8437", "Origin:"}, true},
	    {{"Host: localhost:8437", "Origin: http://localhost:8437", "Origin: http://evil.example"}, true},
	    {{"Host: localhost:8437", "Sec-Fetch-Site: cross-site"}, true},
	    {{"Host: localhost:8437", "Sec-Fetch-Site: same-site"}, true},
	    {{"Host: localhost:8437", "Origin: http://localhost:8437", "Sec-Fetch-Site: cross-site"}, true},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct head head = judged("/", cases[i].lines, true);
		assert_int_equal(head.fault, API_NO_FAULT);
		head_origin(&head);
		if ((head.fault == API_FOREIGN) != cases[i].foreign)
			fail_msg("case %zu", i);
	}
}

static void what_leaves_a_request_s_end_in_doubt_is_refused(void **state)
{
	static const struct {
		const char *lines[4];
		enum api_fault fault;
		bool close;
	} cases[] = {
	    {{"Host: localhost", "Content-Length: 5"}, API_NO_FAULT, false},
	    {{"Host: localhost", "Transfer-Encoding: chunked"}, API_NO_LENGTH, true},
	    {{"Host: localhost", "transfer-encoding: CHUNKED"}, API_NO_LENGTH, true},
	    {{"Host: localhost", "Content-Length: 5", "content-length: 5"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "Content-Length: 5", "Content-Length: 6"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "Content-Length: 5", "Transfer-Encoding: chunked"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "Transfer-Encoding: gzip"}, API_NO_LENGTH, true},
	    {{"Host: localhost", "Transfer-Encoding: chunked", "Transfer-Encoding: chunked"},
	     API_NO_LENGTH,
	     true},
	    {{"Host: localhost", "Authorization: a", "Authorization: b"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "Transfer-Encoding : chunked"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", ": nameless"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "X\x01Y: a"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "X: a\x01z"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "X: tab\tis a blank, \xc3\xa4 is text"}, API_NO_FAULT, false},
	    {{"Host: localhost", "Host: localhost"}, API_BAD_REQUEST, true},
	    {{"Host: localhost", "Content-Type: text/plain", "Content-Type: application/json"},
	     API_BAD_REQUEST,
	     true},
	    {{"X: no host"}, API_BAD_REQUEST, true},
	    {{"Host: evil.example"}, API_MISDIRECTED, false},
	    {{"Host: localhost", "Content-Length: 1048576"}, API_NO_FAULT, false},
	    {{"Host: localhost", "Content-Length: 1048577"}, API_TOO_LARGE, false},
	    {{"Host: localhost", "Content-Length: 99999999999999999999999"}, API_TOO_LARGE, false},
	    {{"Host: localhost", "Content-Encoding: gzip"}, API_NOT_JSON, false},
	    {{"Host: localhost", "Content-Encoding: Identity"}, API_NO_FAULT, false},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct head head = judged("/", cases[i].lines, true);
		if (head.fault != cases[i].fault || head.close != cases[i].close)
			fail_msg("case %zu: fault %d, close %d", i, head.fault, head.close);
	}
	assert_int_equal(judged("/", (const char *const[]){"X: no host", NULL}, false).fault, API_NO_FAULT);
}

static void white_space_behind_a_value_is_no_part_of_it(void **state)
{
	const char *const lines[] = {
	    "Host: localhost \t",          "Content-Type: application/json\t; charset=utf-8\t",
	    "Content-Encoding: identity ", "Authorization: Bearer x ",
	    "Idempotency-Key: a b  ",      "Prefer: wait=2\t",
	    "Accept: text/csv ",           NULL};
	(void)state;
	struct head head = judged("/", lines, true);
	assert_int_equal(head.fault, API_NO_FAULT);
	assert_true(head.json);
	assert_string_equal(head.host, "localhost");
	assert_string_equal(head.authorization.value, "Bearer x");
	assert_string_equal(head.key.value, "a b");
	assert_string_equal(head.prefer.value, "wait=2");
	assert_string_equal(head.accept.value, "text/csv");
	assert_int_equal(head.key.lines, 1);
	assert_string_equal(judged("/", (const char *const[]){"Accept:  \t ", NULL}, false).accept.value, "");
}

static void what_does_not_fit_is_left_out_whole(void **state)
{
	char line[HEAD_TEXT_SIZE + 64];
	struct head head;
	(void)state;
	static const char last[] = ",text/csv;q=0.5";
	int whole = 0;
	// a last element that is longer by a byte every time, and would be text/csv;q=0 once
	for (int before = HEAD_TEXT_SIZE - 24; before < HEAD_TEXT_SIZE; before++) {
		memset(line, 'x', sizeof line);
		strcpy(line + before, last);
		head_target(&head, "/");
		head_header(&head, "Accept", 6, "a/b", 3);
		head_header(&head, "Accept", 6, line, strlen(line));
		const char *end = strstr(head.accept.value, ",t");
		whole += end && !strcmp(end, last);
		assert_true(!end || !strcmp(end, last));
		assert_memory_equal(head.accept.value, "a/b", 3);
	}
	assert_in_range(whole, 1, 23);
	// and no other one with it, be it full
	memset(line, 'x', sizeof line);
	strcpy(line + HEAD_TEXT_SIZE - 1 - strlen(",text/csv"), ",text/csv");
	head_target(&head, "/");
	head_header(&head, "Accept", 6, line, strlen(line));
	head_header(&head, "Accept", 6, "a/b", 3);
	assert_string_equal(head.accept.value, line);
	memset(line, 'x', sizeof line);
	line[HEAD_TEXT_SIZE] = '\0';
	head_header(&head, "Authorization", 13, line, strlen(line));
	// never one that a proxy did not see
	head_header(&head, "Authorization", 13, "Bearer y", 8);
	assert_string_equal(head.authorization.value, "");
	head_header(&head, "Idempotency-Key", 15, line, HEAD_TEXT_SIZE - 1);
	assert_int_equal(strlen(head.key.value), HEAD_TEXT_SIZE - 1);
}

static void a_host_is_an_address_localhost_or_a_name_that_was_given(void **state)
{
	static const char *const ours[] = {"localhost",       "LOCALHOST:1",  "127.0.0.1",      "127.0.0.1:8437",
	                                   "[::1]",           "[::1]:8437",   "192.168.1.7:80", "pound.example",
	                                   "POUND.example:1", "other.example"};
	static const char *const others[] = {"",
	                                     "evil.example",
	                                     "localhost.evil.example",
	                                     "localhost:80x",
	                                     "localhost:80:80",
	                                     "::1",
	                                     "[::1",
	                                     "[::1]x",
	                                     "[localhost]",
	                                     "[pound.example]",
	                                     "pound.exampl",
	                                     "pound.example,other.example",
	                                     "127.0.0.1.evil.example",
	                                     "127.1",
	                                     "2130706433",
	                                     "user@localhost",
	                                     "localhost/",
	                                     ","};
	(void)state;
	for (size_t i = 0; i < sizeof ours / sizeof ours[0]; i++)
		if (!head_has_host(ours[i], "pound.example,other.example"))
			fail_msg("%s", ours[i]);
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		if (head_has_host(others[i], "pound.example,other.example"))
			fail_msg("%s", others[i]);
	assert_false(head_has_host("pound.example", NULL));
	assert_false(head_has_host("", ",,"));
}

static void a_tag_is_found_in_every_form_of_a_list(void **state)
{
	static const char *const known[] = {"*",
	                                    " * ",
	                                    "\"a,b\"",
	                                    "W/\"a,b\"",
	                                    "\"x\", \"a,b\"",
	                                    "\"x\",\"a,b\",\"y\"",
	                                    ",, \"a,b\" ,",
	                                    "\"\", W/\"x\", W/\"a,b\""};
	static const char *const unknown[] = {
	    "",          "\"a\"", "a,b",     "\"a,b",    "**",  "\"x\" \"a,b\"",  "w/\"a,b\"",
	    "\"a,b\"\"", "W/a,b", "\"A,B\"", "*, \"x\"", "\"x", "\"x\"; \"a,b\"", "W/W/\"a,b\""};
	(void)state;
	for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
		if (!head_has_etag(known[i], "\"a,b\""))
			fail_msg("%s", known[i]);
	for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++)
		if (strcmp(unknown[i], "\"a,b\"\"") != 0 && head_has_etag(unknown[i], "\"a,b\""))
			fail_msg("%s", unknown[i]);
}

static void the_seconds_to_wait_are_found_among_other_preferences(void **state)
{
	static const struct {
		const char *prefer;
		int seconds;
	} cases[] = {
	    {"wait=10", 10},
	    {"WAIT = 10", 10},
	    {"respond-async, wait=10", 10},
	    {"wait=\"7\"", 7},
	    {"wait", 0},
	    {"wait=", 0},
	    {"wait=-1", 0},
	    {"wait=x", 0},
	    {"await=3", 0},
	    {"", 0},
	    {"wait=9999999", 9999999},
	    {"wait=99999999999", INT_MAX},
	    {"wait=99999999999999999999", INT_MAX},
	    {"wait=00000000007", 7},
	    {"wait=5; foo=bar", 5},
	    {"return=minimal,wait=2", 2},
	    {"waiting=3", 0},
	    {"a=\"x, wait=3\", wait=4", 4},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		if (head_wait(cases[i].prefer) != cases[i].seconds)
			fail_msg("%s: %d", cases[i].prefer, head_wait(cases[i].prefer));
}

static void an_accept_names_the_types_in_its_list(void **state)
{
	static const struct {
		const char *accept;
		bool csv, json;
	} cases[] = {
	    {"", false, false},
	    {"*/*", false, false},
	    {"text/*", false, false},
	    {"text/csv", true, false},
	    {"TEXT/CSV;Q=0.5", true, false},
	    {"text/csv;q=0.9, application/json;q=0.1", true, true},
	    {",, text/csv ,", true, false},
	    {"text/csv;header=present, image/gif", true, false},
	    {"image/gif;x=\"a, text/csv\", application/json", false, true},
	    {"image/gif;x=\"\\\", text/csv\"", false, false},
	    {"image/gif;x=\"open, text/csv", false, false},
	    {"text/csvx", false, false},
	    {"text/cs", false, false},
	    {"text", false, false},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		if (head_names(cases[i].accept, "text/csv") != cases[i].csv ||
		    head_names(cases[i].accept, "application/json") != cases[i].json)
			fail_msg("%s", cases[i].accept);
}

static void a_key_is_one_text_of_1_to_200_characters(void **state)
{
	static const struct {
		const char *unit; /* so many of it are a key */
		int n;
		bool refused;
	} cases[] = {
	    {"", 1, true},
	    {"k", 1, false},
	    {"k", 200, false},
	    {"k", 201, true},
	    {"\xc3\xa9", 200, false},
	    {"\xc3\xa9", 201, true},
	    {"\xf0\x9f\x8f\xa2", 200, false},
	    {"\xf0\x9f\x8f\xa2", 201, true},
	    {"k", 5000, true},
	    {"\xe9", 1, true},
	    {"\xc3", 1, true},
	    {"\xed\xa0\x80", 1, true},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char line[5100] = "Idempotency-Key: ";
		for (int k = 0; k < cases[i].n; k++)
			strcat(line, cases[i].unit);
		struct head head = judged("/", (const char *const[]){"Host: localhost", line, NULL}, true);
		head_key(&head);
		if ((head.fault == API_BAD_REQUEST) != cases[i].refused || head.close)
			fail_msg("case %zu: %d %s", i, head.fault, head.detail);
	}
	struct head none = judged("/", (const char *const[]){"Host: localhost", NULL}, true);
	head_key(&none);
	assert_int_equal(none.fault, API_NO_FAULT);
	struct head two = judged(
	    "/", (const char *const[]){"Host: localhost", "Idempotency-Key: a", "idempotency-key: a", NULL},
	    true);
	head_key(&two);
	assert_int_equal(two.fault, API_BAD_REQUEST);
}

static void the_first_fault_is_reported_in_visible_ascii(void **state)
{
	struct head head = judged("/", (const char *const[]){"Host: localhost", NULL}, true);
	(void)state;
	head_refuse(&head, API_BAD_REQUEST, false, "%s is not an argument", "\xff\n\xc2\x9b");
	head_refuse(&head, API_NOT_FOUND, true, "there is no such path");
	assert_int_equal(head.fault, API_BAD_REQUEST);
	assert_string_equal(head.detail, "???? is not an argument");
	assert_true(head.close);
}

static void the_lines_of_one_name_are_one_list(void **state)
{
	const char *const lines[] = {
	    "Host: localhost", "If-None-Match: \"x\"", "if-none-match: W/\"a,b\"", "Prefer: respond-async",
	    "Prefer: wait=2",  "Accept: text/csv",     "Accept: */*;q=0.5",        NULL};
	(void)state;
	struct head head = judged("/", lines, true);
	assert_true(head_has_etag(head.etags.value, "\"x\""));
	assert_true(head_has_etag(head.etags.value, "\"a,b\""));
	assert_false(head_has_etag(head.etags.value, "\"a\""));
	assert_int_equal(head_wait(head.prefer.value), 2);
	assert_string_equal(head.accept.value, "text/csv,*/*;q=0.5");
	head = judged("/", (const char *const[]){"Host: localhost", "If-None-Match: *", NULL}, true);
	assert_true(head_has_etag(head.etags.value, "\"x\""));
}

CHECK_MAIN(cmocka_unit_test(an_accept_names_the_types_in_its_list),
           cmocka_unit_test(a_key_is_one_text_of_1_to_200_characters),
           cmocka_unit_test(the_first_fault_is_reported_in_visible_ascii),
           cmocka_unit_test(the_lines_of_one_name_are_one_list),
           cmocka_unit_test(a_target_is_visible_ascii_and_its_escapes_are_whole),
           cmocka_unit_test(a_target_has_so_many_bytes_and_arguments),
           cmocka_unit_test(a_head_has_no_byte_but_those_of_its_lines),
           cmocka_unit_test(what_a_page_of_another_origin_sends_is_foreign),
           cmocka_unit_test(what_leaves_a_request_s_end_in_doubt_is_refused),
           cmocka_unit_test(white_space_behind_a_value_is_no_part_of_it),
           cmocka_unit_test(what_does_not_fit_is_left_out_whole),
           cmocka_unit_test(a_host_is_an_address_localhost_or_a_name_that_was_given),
           cmocka_unit_test(a_tag_is_found_in_every_form_of_a_list),
           cmocka_unit_test(the_seconds_to_wait_are_found_among_other_preferences))
