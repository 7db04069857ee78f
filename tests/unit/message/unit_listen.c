/* Addresses to listen at, and the token that admits a connection. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "schema/message/listen.h"
#include "tests/support/check.h"

// as long as real tokens
#define TOKEN_16 "0123456789abcdef"
#define TOKEN    TOKEN_16 TOKEN_16 TOKEN_16 TOKEN_16

static void an_address_and_its_port_are_read_and_nothing_else_is(void **state)
{
	static const struct {
		const char *text;
		int family, port; /* 0: refused */
	} cases[] = {
	    {"127.0.0.1:8438", AF_INET, 8438},
	    {"0.0.0.0:0", AF_INET, 0},
	    {"[::]:8438", AF_INET6, 8438},
	    {"[::1]:65535", AF_INET6, 65535},
	    {"[fe80::1:2]:1", AF_INET6, 1},
	    {"127.0.0.1", 0, 0},
	    {"127.0.0.1:", 0, 0},
	    {"127.0.0.1:65536", 0, 0},
	    {"127.0.0.1:-1", 0, 0},
	    {"127.0.0.1: 80", 0, 0},
	    {"127.0.0.1:80x", 0, 0},
	    {"127.0.0.1:99999999999999999999", 0, 0},
	    {":8438", 0, 0},
	    {"::1:8438", 0, 0}, // ambiguous: the last number may be a port
	    {"[127.0.0.1]:80", 0, 0},
	    {"[::1:80", 0, 0},
	    {"[]:80", 0, 0},
	    {"[:80", 0, 0},
	    {"localhost:80", 0, 0},
	    {"", 0, 0},
	    {"[0000:0000:0000:0000:0000:0000:0000:0000:0000:0000]:80", 0, 0},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		union listen_address address = {0};
		const bool read = listen_address_and_port(cases[i].text, &address);
		if (read != (cases[i].family != 0))
			fail_msg("'%s' is %s", cases[i].text, read ? "read" : "refused");
		if (!read)
			continue;
		assert_int_equal(address.any.sa_family, cases[i].family);
		assert_int_equal(ntohs(address.ip6.sin6_port), cases[i].port);
	}
}

/* Whether a connection that sends these bytes and then ends is admitted. */
static bool let_in(const char *bytes, size_t n)
{
	int ends[2];
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
	assert_int_equal(send(ends[0], bytes, n, 0), n);
	shutdown(ends[0], SHUT_WR);
	const enum listen_entry entry = listen_entry(ends[1], TOKEN);
	assert_int_equal(entry == LISTEN_NO_TOKEN, n < MESSAGE_TOKEN_SIZE);
	close(ends[0]);
	close(ends[1]);
	return entry == LISTEN_TOKEN;
}

static void only_the_whole_token_lets_a_connection_in(void **state)
{
	char bytes[] = TOKEN "and what comes after it";
	(void)state;
	assert_true(let_in(bytes, strlen(bytes)));
	for (size_t n = 0; n <= MESSAGE_TOKEN_SIZE; n++)
		assert_int_equal(let_in(bytes, n), n == MESSAGE_TOKEN_SIZE);
	for (int i = 0; i < MESSAGE_TOKEN_SIZE; i++) {
		bytes[i] ^= 1;
		assert_false(let_in(bytes, strlen(bytes)));
		bytes[i] ^= 1;
	}
}

/* A client that sends a byte now and then blocks no longer than one that sends nothing. */
static void a_token_in_drops_comes_too_late(void **state)
{
	int ends[2];
	struct timespec start, end;
	(void)state;
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
	const pid_t child = fork();
	for (int i = 0; child == 0 && i < MESSAGE_TOKEN_SIZE; i++) {
		usleep(100000);
		if (send(ends[0], TOKEN + i, 1, MSG_NOSIGNAL) != 1)
			_exit(1);
	}
	if (child == 0)
		_exit(0);
	close(ends[0]);
	clock_gettime(CLOCK_MONOTONIC, &start);
	assert_int_equal(listen_entry(ends[1], TOKEN), LISTEN_NO_TOKEN);
	clock_gettime(CLOCK_MONOTONIC, &end);
	assert_true(end.tv_sec - start.tv_sec <= 4); // the token takes 6.4 s
	close(ends[1]);
	waitpid(child, NULL, 0);
}

static void a_token_file_that_cannot_be_used_is_refused_with_the_reason(void **state)
{
	static const struct {
		const char *text;
		mode_t mode;
		const char *fault; /* NULL: accepted */
	} cases[] = {
	    {TOKEN, 0600, NULL},
	    {TOKEN "\n", 0400, NULL},
	    {TOKEN "\r\n", 0600, NULL},
	    {TOKEN "\n", 0640, "chmod 600"},
	    {TOKEN "\n", 0604, "chmod 600"},
	    {TOKEN "0", 0600, "64 hexadecimal digits"},
	    {TOKEN "\n" TOKEN "\n", 0600, "64 hexadecimal digits"},
	    {TOKEN_16 TOKEN_16, 0600, "64 hexadecimal digits"},
	    {TOKEN_16 TOKEN_16 TOKEN_16 "0123456789abcdeg", 0600, "64 hexadecimal digits"},
	    {"", 0600, "64 hexadecimal digits"},
	};
	char path[] = "/tmp/pound-test-token-XXXXXX", token[MESSAGE_TOKEN_SIZE + 1];
	(void)state;
	close(mkstemp(path));
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		unlink(path);
		FILE *file = fopen(path, "w");
		assert_non_null(file);
		fputs(cases[i].text, file);
		assert_int_equal(fchmod(fileno(file), cases[i].mode), 0);
		assert_int_equal(fclose(file), 0);
		const char *fault = listen_token(path, token);
		if (!fault != !cases[i].fault || (fault && !strstr(fault, cases[i].fault)))
			fail_msg("case %d: '%s'", (int)i, fault ? fault : "no fault");
		if (!fault)
			assert_string_equal(token, TOKEN);
	}
	unlink(path);
	assert_string_equal(listen_token(path, token), "No such file or directory");
	assert_string_equal(listen_token("/tmp", token), "is not a file");
	assert_int_equal(mkfifo(path, 0600), 0);
	assert_string_equal(listen_token(path, token), "is not a file");
	unlink(path);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(an_address_and_its_port_are_read_and_nothing_else_is),
	    cmocka_unit_test(only_the_whole_token_lets_a_connection_in),
	    cmocka_unit_test(a_token_in_drops_comes_too_late),
	    cmocka_unit_test(a_token_file_that_cannot_be_used_is_refused_with_the_reason)};
	(void)argc;
	return check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
}
