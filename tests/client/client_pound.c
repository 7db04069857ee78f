/* The command line without a server: usage, examples, exit statuses of errors. */
#include <netinet/in.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static const char *const COMMANDS[] = {"run",     "design", "indices", "submit", "status",  "wait", "results",
                                       "samples", "list",   "cancel",  "delete", "example", "plot", "report"};

enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0] };

static void help_names_every_command(void **state)
{
	(void)state;
	struct program_outcome help = POUND("--help");
	program_expect(&help, 0);
	assert_string_equal(help.err, "");
	for (int i = 0; i < N_COMMANDS; i++) {
		char line[32];
		snprintf(line, sizeof line, "\n  %s ", COMMANDS[i]);
		assert_non_null(strstr(help.out, line));
	}
	program_free(&help);
}

static void every_command_has_help_of_its_own(void **state)
{
	(void)state;
	for (int i = 0; i < N_COMMANDS; i++) {
		char usage[48];
		struct program_outcome help = POUND(COMMANDS[i], "--help");
		program_expect(&help, 0);
		snprintf(usage, sizeof usage, "Usage: pound %s ", COMMANDS[i]);
		assert_non_null(strstr(help.out, usage));
		program_free(&help);
	}
}

static void version_is_one_line(void **state)
{
	(void)state;
	struct program_outcome version = POUND("--version");
	program_expect(&version, 0);
	assert_memory_equal(version.out, "pound ", 6);
	assert_ptr_equal(strchr(version.out, '\n'), version.out + version.n_out - 1);
	program_free(&version);
}

static void wrong_usage_ends_with_2_and_prints_no_data(void **state)
{
	static const char *const calls[][5] = {
	    {"pound"},
	    {"pound", "fly"},
	    {"pound", "run"},
	    {"pound", "run", "a.json", "b.json"},
	    {"pound", "run", "--wait", "a.json"},
	    {"pound", "run", "--threads=0", "a.json"},
	    {"pound", "run", "--threads=two", "a.json"},
	    {"pound", "run", "--format=xml", "a.json"},
	    {"pound", "run", "--launchers=2", "a.json"},
	    {"pound", "run", "--worker-host=localhost", "a.json"},
	    {"pound", "run", "--worker-listen=127.0.0.1:0", "a.json"},
	    {"pound", "run", "--worker-token-file=token", "a.json"},
	    {"pound", "run", "--launcher=true", "--launchers=257", "a.json"},
	    {"pound", "results", "--format=npy", "1"},
	    {"pound", "list", "everything"},
	    {"pound", "list", "--limit=101"},
	    {"pound", "status"},
	    {"pound", "list", "--url=http://a b"},
	    {"pound", "list", "--url=gopher://127.0.0.1"},
	    {"pound", "example", "no_such_example"},
	};
	(void)state;
	for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
		struct program_outcome outcome = program_run(calls[i], NULL);
		program_expect(&outcome, 2);
		assert_string_equal(outcome.out, "");
		assert_true(outcome.n_err > 0);
		program_free(&outcome);
	}
}

static void a_study_that_cannot_be_read_ends_with_1(void **state)
{
	(void)state;
	static const char *const commands[] = {"run", "submit"};
	for (int i = 0; i < 2; i++) {
		struct program_outcome outcome = POUND(commands[i], "/nonexistent/study.json");
		program_expect(&outcome, 1);
		assert_non_null(strstr(outcome.err, "/nonexistent/study.json: No such file"));
		program_free(&outcome);
		outcome = POUND(commands[i], "/");
		program_expect(&outcome, 1);
		program_free(&outcome);
	}
}

/* A port without a listener, reserved by a bound socket. */
static int silent_port(int *port)
{
	struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t n = sizeof address;
	int held = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_int_equal(bind(held, (struct sockaddr *)&address, n), 0);
	assert_int_equal(getsockname(held, (struct sockaddr *)&address, &n), 0);
	*port = ntohs(address.sin_port);
	return held;
}

static void a_server_that_is_not_there_ends_with_4(void **state)
{
	static const char *const commands[] = {"status", "wait", "results", "samples", "cancel", "delete"};
	char url[64];
	int port, held = silent_port(&port);
	(void)state;
	snprintf(url, sizeof url, "http://127.0.0.1:%d", port);
	for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
		struct program_outcome outcome = POUND(commands[i], "--url", url, "0123456789abcdef");
		program_expect(&outcome, 4);
		assert_non_null(strstr(outcome.err, url));
		program_free(&outcome);
	}
	struct program_outcome list = POUND("list", "--url", url);
	program_expect(&list, 4);
	program_free(&list);
	// the server is contacted before the document is checked
	struct program_outcome submit =
	    program_run((const char *const[]){"pound", "submit", "--wait", "--url", url, "-", NULL}, "{}");
	program_expect(&submit, 4);
	program_free(&submit);
	// the address from the environment; the option overrides it
	setenv("POUND_URL", url, 1);
	list = POUND("list");
	program_expect(&list, 4);
	program_free(&list);
	list = POUND("list", "--url", "http://a b");
	program_expect(&list, 2);
	program_free(&list);
	unsetenv("POUND_URL");
	close(held);
}

static void every_example_is_printed_whole(void **state)
{
	(void)state;
	struct program_outcome names = POUND("example", "--names");
	program_expect(&names, 0);
	int n = 0;
	for (char *name = strtok(names.out, "\n"); name; name = strtok(NULL, "\n"), n++) {
		char path[256];
		size_t length;
		snprintf(path, sizeof path, "schema/examples/%s.json", name);
		char *file = program_file(path, &length);
		assert_non_null(file);
		struct program_outcome printed = POUND("example", name);
		program_expect(&printed, 0);
		assert_int_equal(printed.n_out, length);
		assert_memory_equal(printed.out, file, length);
		program_free(&printed);
		free(file);
	}
	assert_true(n >= 3);
	program_free(&names);
}

static void the_example_without_a_name_is_the_paper_s_study(void **state)
{
	(void)state;
	struct program_outcome unnamed = POUND("example"), paper = POUND("example", "paper");
	program_expect(&unnamed, 0);
	assert_string_equal(unnamed.out, paper.out);
	program_free(&unnamed);
	program_free(&paper);
}

static void output_that_cannot_be_written_ends_with_1(void **state)
{
	(void)state;
	struct program_outcome outcome = program_run(
	    (const char *const[]){"sh", "-c", "exec \"$POUND_BUILD/pound\" example >/dev/full", NULL}, NULL);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "No space left"));
	program_free(&outcome);
}

CHECK_MAIN(cmocka_unit_test(help_names_every_command), cmocka_unit_test(every_command_has_help_of_its_own),
           cmocka_unit_test(version_is_one_line),
           cmocka_unit_test(wrong_usage_ends_with_2_and_prints_no_data),
           cmocka_unit_test(a_study_that_cannot_be_read_ends_with_1),
           cmocka_unit_test(a_server_that_is_not_there_ends_with_4),
           cmocka_unit_test(every_example_is_printed_whole),
           cmocka_unit_test(the_example_without_a_name_is_the_paper_s_study),
           cmocka_unit_test(output_that_cannot_be_written_ends_with_1))
