/* Answers that poundd never gives, from a server with scripted answers: pound must end and give a reason. */
#include <netinet/in.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

enum { ANSWERS_MAX = 4 };

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)
#define JSON(status, body) \
	"HTTP/1.1 " status "\r\nContent-Type: application/json\r\nConnection: close\r\n\r\n" body

struct script {
	const char *answers
	    [ANSWERS_MAX]; /* one per connection, then the last one repeats; "": closed without an answer */
	const char *arguments[6];
	int status;         /* exit status of pound */
	const char *said;   /* text required on stdout or stderr */
	const char *unsaid; /* text that must not appear; NULL: any text may */
};

static const struct script SCRIPTS[] = {
    {{"HTTP/1.1 500 Oops\r\nContent-Type: text/html\r\nContent-Length: 6\r\n\r\n<p>no\n"},
     {"list"},
     1,
     "HTTP status 500",
     "<p>"},
    {{"HTTP/1.1 503 Busy\r\nContent-Type: application/problem+json\r\nRetry-After: 7\r\nConnection: "
      "close\r\n\r\n"
      "{\"status\": 503, \"detail\": \"the queue is full\"}"},
     {"submit", "-"},
     1,
     "the queue is full\npound: try again in 7 s",
     NULL},
    {{"good day\r\n"}, {"list"}, 4, "no answer from", "good day"},
    {{""}, {"list"}, 4, "no answer from", NULL},
    {{"HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n{\"status\""},
     {"results", "1"},
     4,
     "no answer from",
     "{"},
    {{JSON("201 Created", "{}")}, {"submit", "-"}, 1, "no id", NULL},
    {{JSON("200 OK", "{\"status\": ")}, {"wait", "1"}, 1, "not a status", NULL},
    {{JSON("200 OK", "[]")}, {"wait", "1"}, 1, "not a status", NULL},
    {{JSON("200 OK", "{\"kind\": \"tea\"}")}, {"results", "--format=table", "1"}, 1, "kind 'tea'", NULL},
    {{JSON("200 OK", "tea")}, {"results", "--format=table", "1"}, 1, "kind '?'", NULL},
    {{JSON("200 OK", "{\"status\": \"running\", \"name\": \"\\u001b[2J\\u009b\"}")},
     {"status", "--format=table", "1"},
     0,
     "?[2J??",
     "\033"},
    {{JSON("200 OK", "{\"kind\": \"sensitivity\", \"cells\": [{\"runs\": 90, \"runs_failed\": 2, "
                     "\"rows_dropped\": 1}]}")},
     {"results", "--format=table", "1"},
     0,
     "sensitivity study: 90 runs, 2 failed, so 1 row is left out",
     NULL},
    {{JSON("200 OK", "{\"status\": \"running\", \"id\": \"7\", \"runs_done\": 3}")},
     {"status", "--format=csv", "7"},
     0,
     "id,status,progress,runs_done,runs_total,over_estimate,queue_position,expected_start,created,kind,"
     "name\n7,running,,3,",
     NULL},
    // one line per study; a long name is shortened in the middle
    {{JSON("200 OK",
           "{\"studies\": [{\"id\": \"0123456789abcdef\", \"status\": \"succeeded\", \"progress\": 1, "
           "\"runs_done\": 90, \"created\": \"2026-01-02T03:04:05Z\", \"name\": \"one long name of a study, "
           "its second part\"}]}")},
     {"list", "--format=table"},
     0,
     "2026-01-02T03:04:05Z  one long...ond part\n",
     "runs_done"},
    {{JSON("404 Not Found", "{\"detail\": \"\\u001b]0;title\"}")}, {"status", "1"}, 1, "?]0;title", "\033"},
    {{JSON("200 OK", "{\"status\": \"failed\", \"error\": \"too few rows\"}")},
     {"wait", "1"},
     3,
     "the study is failed: too few rows",
     NULL},
    // a server that stops answering for a while during `pound wait`
    {{JSON("200 OK", "{\"status\": \"running\"}"), "", JSON("503 Busy", "{}"),
      JSON("200 OK", "{\"status\": \"succeeded\"}")},
     {"wait", "1"},
     0,
     "succeeded",
     "no answer"},
};

/* Reads one request up to the end of its header, with the part of a body that arrives with it. */
static void swallow(int connection)
{
	char bytes[4096] = "";
	size_t n = 0;
	while (n < sizeof bytes - 1 && !strstr(bytes, "\r\n\r\n")) {
		ssize_t k = read(connection, bytes + n, sizeof bytes - 1 - n);
		if (k <= 0)
			return;
		n += (size_t)k;
		bytes[n] = '\0';
	}
}

static void answer_all(int listener, const char *const answers[ANSWERS_MAX])
{
	signal(SIGPIPE, SIG_IGN);
	for (int i = 0;;) {
		int connection = accept(listener, NULL, NULL);
		swallow(connection);
		const char *answer = answers[i];
		for (size_t sent = 0, n = strlen(answer); sent < n;) {
			ssize_t k = write(connection, answer + sent, n - sent);
			if (k <= 0)
				break;
			sent += (size_t)k;
		}
		// the client may still be writing its body: read it before the connection is closed
		shutdown(connection, SHUT_WR);
		char rest[256];
		while (read(connection, rest, sizeof rest) > 0)
			;
		close(connection);
		if (i + 1 < ANSWERS_MAX && answers[i + 1])
			i++;
	}
}

/* Starts a server that gives these answers; sets POUND_URL to its address. */
static pid_t stand_in(const char *const answers[ANSWERS_MAX])
{
	struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t n = sizeof address;
	int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_int_equal(bind(listener, (struct sockaddr *)&address, n), 0);
	assert_int_equal(listen(listener, 16), 0);
	assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &n), 0);
	pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0)
		answer_all(listener, answers);
	close(listener);
	char url[64];
	snprintf(url, sizeof url, "http://127.0.0.1:%d", ntohs(address.sin_port));
	setenv("POUND_URL", url, 1);
	return pid;
}

static void stand_down(pid_t pid)
{
	kill(pid, SIGKILL);
	waitpid(pid, NULL, 0);
}

static void every_strange_answer_ends_as_it_should(void **state)
{
	(void)state;
	for (size_t s = 0; s < sizeof SCRIPTS / sizeof SCRIPTS[0]; s++) {
		const struct script *script = &SCRIPTS[s];
		pid_t pid = stand_in(script->answers);
		const char *arguments[8] = {"pound"};
		for (int i = 0; script->arguments[i]; i++)
			arguments[i + 1] = script->arguments[i];
		struct program_outcome outcome = program_run(arguments, "{}");
		stand_down(pid);
		char said[4096];
		snprintf(said, sizeof said, "%s%s", outcome.out, outcome.err);
		if (outcome.status != script->status || !strstr(said, script->said) ||
		    (script->unsaid && strstr(said, script->unsaid))) {
			print_error("pound %s, script %d: status %d instead of %d, said:\n%s", arguments[1], (int)s,
			            outcome.status, script->status, said);
			fail();
		}
		program_free(&outcome);
	}
}

static void a_bar_of_strange_numbers_stays_within_its_ends(void **state)
{
	static const char *const answers[ANSWERS_MAX] = {
	    JSON("200 OK",
	         "{\"status\": \"running\", \"runs_done\": 5000, \"runs_total\": 10, \"eta_s\": -1e300}"),
	    JSON("200 OK", "{\"status\": \"running\", \"runs_done\": -3e300, \"runs_total\": 1e300}"),
	    JSON("200 OK", "{\"status\": \"running\", \"runs_done\": \"many\", \"eta_s\": 1e300}"),
	    JSON("200 OK", "{\"status\": \"succeeded\"}"),
	};
	(void)state;
	pid_t pid = stand_in(answers);
	char *bar = program_drawn((const char *const[]){"pound", "wait", "1", NULL}, 120);
	assert_non_null(strstr(bar, "[########################################] 100 %  5,000 / 10 runs\r"));
	assert_non_null(strstr(bar, "[----------------------------------------]   0 %  0 / 0 runs\r"));
	free(bar);
	stand_down(pid);
}

/* A server that is reachable only through a proxy; exit status 4 if a variable of the environment excludes the proxy. */
static void a_proxy_is_asked_but_where_the_environment_says_otherwise(void **state)
{
	static const struct {
		const char *name, *value;
		int status;
	} environments[] = {
	    {"no_proxy", "example.org", 0},   {"NO_PROXY", "example.org", 0}, {"no_proxy", "pound.invalid", 4},
	    {"NO_PROXY", "pound.invalid", 4}, {"no_proxy", "*", 4},           {"NO_PROXY", "*", 4}};
	static const char *const answers[ANSWERS_MAX] = {JSON("200 OK", "{\"status\": \"succeeded\"}")};
	(void)state;
	for (size_t e = 0; e < sizeof environments / sizeof environments[0]; e++) {
		pid_t pid = stand_in(answers);
		setenv("http_proxy", getenv("POUND_URL"), 1);
		setenv("POUND_URL", "http://pound.invalid", 1); // a name without a host (RFC 2606)
		setenv(environments[e].name, environments[e].value, 1);
		struct program_outcome outcome = POUND("status", "1");
		program_expect(&outcome, environments[e].status);
		program_free(&outcome);
		unsetenv(environments[e].name);
		unsetenv("http_proxy");
		stand_down(pid);
	}
}

CHECK_MAIN(cmocka_unit_test(every_strange_answer_ends_as_it_should),
           cmocka_unit_test(a_bar_of_strange_numbers_stays_within_its_ends),
           cmocka_unit_test(a_proxy_is_asked_but_where_the_environment_says_otherwise))
