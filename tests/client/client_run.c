/* `pound run`: same bytes for any number of threads and by a server, same error messages, a clean stop. */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static struct program_outcome run_threads(const char *document, const char *threads)
{
	struct program_outcome outcome =
	    program_run((const char *const[]){"pound", "run", "--threads", threads, "-", NULL}, document);
	program_expect(&outcome, 0);
	assert_string_equal(outcome.err, "");
	service_timeless(outcome.out);
	return outcome;
}

static struct program_outcome run_on_server(const char *document)
{
	struct program_outcome id =
	    program_run((const char *const[]){"pound", "submit", "--wait", "-", NULL}, document);
	program_expect(&id, 0);
	assert_string_equal(id.err, "");
	id.out[strcspn(id.out, "\n")] = '\0';
	struct program_outcome result = POUND("results", id.out);
	program_expect(&result, 0);
	service_timeless(result.out);
	program_free(&id);
	return result;
}

/* Writes an example to a new file; the caller deletes the file. */
static void example_file(const char *name, char path[32])
{
	strcpy(path, "/tmp/pound-test-XXXXXX");
	struct program_outcome document = POUND("example", name);
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	fputs(document.out, file);
	fclose(file);
	program_free(&document);
}

/* Whether an example takes too long for this test; such an example is only validated. */
static bool is_long(const char *name)
{
	return strncmp(name, "paper", 5) == 0;
}

static void every_quick_example_gives_the_same_bytes_by_1_2_and_4_threads_and_by_the_server(void **state)
{
	static const char *const threads[] = {"2", "4"};
	struct program_outcome names = POUND("example", "--names");
	int n_run = 0;
	(void)state;
	for (char *name = strtok(names.out, "\n"); name; name = strtok(NULL, "\n")) {
		if (is_long(name))
			continue;
		struct program_outcome document = POUND("example", name);
		if (!strstr(document.out, "\"scene\"")) { // a study of an external model
			program_free(&document);
			continue;
		}
		struct program_outcome one = run_threads(document.out, "1");
		for (int i = 0; i < 2; i++) {
			struct program_outcome other = run_threads(document.out, threads[i]);
			assert_string_equal(other.out, one.out);
			program_free(&other);
		}
		struct program_outcome served = run_on_server(document.out);
		assert_string_equal(served.out, one.out);
		program_free(&served);
		program_free(&one);
		program_free(&document);
		n_run++;
	}
	assert_true(n_run >= 2);
	program_free(&names);
}

// invalid documents, and words that the list of their problems must contain
static const struct {
	const char *text;
	const char *words[4];
} BAD[] = {
    {"{\"kind\": \"response\",\n  \"scene\" {}}", {"line 2, column 11"}},
    {"", {"line 1, column 1"}},
    {"[]", {"object"}},
    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": -1}, {\"frequency_hz\": 2}],"
     " \"contact\": {\"restitution\": 1.4, \"gap\": 0}}}",
     {"/scene/oscillators/0/frequency_hz: ", "/scene/contact/restitution: must be in [0, 1], got 1.4",
      "gap_m"}},
    {"{\"kind\": \"sensitivty\"}", {"sensitivity", "/scene"}},
};

static void a_bad_study_gets_the_same_list_from_run_and_from_the_server(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
		struct program_outcome run =
		    program_run((const char *const[]){"pound", "run", "-", NULL}, BAD[i].text);
		struct program_outcome submit =
		    program_run((const char *const[]){"pound", "submit", "-", NULL}, BAD[i].text);
		program_expect(&run, 2);
		program_expect(&submit, 2);
		assert_string_equal(run.out, "");
		assert_string_equal(submit.out, "");
		assert_string_equal(run.err, submit.err);
		for (int w = 0; w < 4 && BAD[i].words[w]; w++)
			if (!strstr(run.err, BAD[i].words[w])) {
				print_error("'%s' is not in\n%s", BAD[i].words[w], run.err);
				fail();
			}
		program_free(&run);
		program_free(&submit);
	}
}

static int count(const char *text, const char *part)
{
	int n = 0;
	for (; (text = strstr(text, part)); text += strlen(part))
		n++;
	return n;
}

static void a_table_of_responses_has_each_value_of_a_sweep(void **state)
{
	(void)state;
	struct program_outcome document = POUND("example", "gap");
	struct program_outcome table =
	    program_run((const char *const[]){"pound", "run", "--format", "table", "-", NULL}, document.out);
	program_expect(&table, 0);
	assert_int_equal(count(document.out, "[0, 0.001, 0.002, 0.004, 0.008]"), 1);
	assert_int_equal(count(table.out, "/contact/gap_m = "), 5);
	assert_int_equal(count(table.out, " left  "), 5);
	assert_int_equal(count(table.out, "\nimpulse "), 5);
	assert_non_null(strstr(table.out, "/contact/gap_m = 0.008"));
	program_free(&table);
	program_free(&document);
}

// a step of one period of a 1 Hz oscillator is unstable
#define UNSTABLE(values)                                                                                 \
	"{\"kind\": \"response\", \"solver\": {\"method\": \"central_difference\", \"step_s\": 1},"          \
	" \"sweep\": [{\"path\": \"/oscillators/0/frequency_hz\", \"values\": " values "}],"                 \
	" \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 0.1}], \"contact\": null," \
	" \"excitation\": {\"type\": \"record\", \"time_step_s\": 1,"                                        \
	" \"acceleration_m_s2\": [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1]}}}"

static void a_table_says_how_many_responses_failed_and_why(void **state)
{
	(void)state;
	struct program_outcome table = program_run(
	    (const char *const[]){"pound", "run", "--format", "table", "-", NULL}, UNSTABLE("[0.1, 1]"));
	program_expect(&table, 0);
	assert_non_null(strstr(table.out, "\n1 of 1 runs failed\n"));
	assert_non_null(strstr(table.out, "1 run failed: the steps of the solver are too long for this scene\n"));
	program_free(&table);
}

static void a_study_without_any_result_ends_with_3_and_says_why(void **state)
{
	(void)state;
	struct program_outcome run =
	    program_run((const char *const[]){"pound", "run", "-", NULL}, UNSTABLE("[1, 2]"));
	program_expect(&run, 3);
	assert_string_equal(run.out, "");
	assert_string_equal(run.err, "pound: the study failed: all runs failed: "
	                             "the steps of the solver are too long for this scene\n");
	program_free(&run);
	struct program_outcome submit =
	    program_run((const char *const[]){"pound", "submit", "--wait", "-", NULL}, UNSTABLE("[1, 2]"));
	program_expect(&submit, 3);
	submit.out[strcspn(submit.out, "\n")] = '\0';
	struct program_outcome ended = POUND("status", submit.out);
	program_expect(&ended, 0);
	assert_non_null(strstr(ended.out, "\"status\": \"failed\""));
	assert_non_null(strstr(ended.out, "all runs failed: the steps of the solver are too long"));
	program_free(&ended);
	program_free(&submit);
}

/* Waits until a process has a handler for a signal of its own. */
static bool catches(pid_t pid, int number)
{
	char path[48], line[256];
	snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
	for (int tries = 0; tries < 10000; tries++) {
		unsigned long long caught = 0;
		FILE *file = fopen(path, "r");
		while (file && fgets(line, sizeof line, file))
			sscanf(line, "SigCgt: %llx", &caught);
		if (file)
			fclose(file);
		if (caught >> (number - 1) & 1)
			return true;
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
	}
	return false;
}

static void ctrl_c_stops_a_run_without_a_result(void **state)
{
	static const int signals[] = {SIGINT, SIGTERM};
	char study[32], out[48], err[48];
	(void)state;
	example_file("paper", study);
	snprintf(out, sizeof out, "%s.out", study);
	snprintf(err, sizeof err, "%s.err", study);
	for (int i = 0; i < 2; i++) {
		size_t n;
		pid_t pid = program_start((const char *const[]){"pound", "run", study, NULL}, out, err);
		assert_true(catches(pid, signals[i]));
		kill(pid, signals[i]);
		assert_int_equal(program_end(pid), 1);
		free(program_file(out, &n));
		assert_int_equal(n, 0);
		char *said = program_file(err, &n);
		assert_string_equal(said, "pound: stopped by the caller\n");
		free(said);
		unlink(out);
		unlink(err);
	}
	unlink(study);
}

/* Number of threads of a process; 0: the process has ended. */
static int threads_of(pid_t pid)
{
	char path[48];
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	int n = 0;
	for (struct dirent *task; tasks && (task = readdir(tasks));)
		n += task->d_name[0] != '.';
	if (tasks)
		closedir(tasks);
	return n;
}

static void a_file_that_cannot_be_written_is_reported_before_the_study_runs(void **state)
{
	(void)state;
	static const char *const files[][2] = {{"/nonexistent/x.csv", "No such file or directory"},
	                                       {"/tmp", "Is a directory"}};
	for (int i = 0; i < 2; i++) {
		struct program_outcome refused =
		    program_run((const char *const[]){"pound", "run", "--samples", files[i][0],
		                                      "schema/examples/sensitivity_small.json", NULL},
		                "");
		program_expect(&refused, 1);
		assert_string_equal(refused.out, "");
		assert_non_null(strstr(refused.err, files[i][1]));
		program_free(&refused);
	}
}

static void ctrl_c_stops_histories_that_are_being_written(void **state)
{
	char study[32], err[48], histories[48];
	(void)state;
	int file = mkstemp(strcpy(study, "/tmp/pound.XXXXXX"));
	// spectra of 300 signals at one frequency are quick, their histories take seconds
	dprintf(file, "{\"kind\": \"floor_spectrum\", \"histories\": true, \"spectrum\": {\"frequencies_hz\": "
	              "[3]}, \"scene\": {"
	              "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}],"
	              "\"excitation\": {\"signals\": 300}}}");
	close(file);
	snprintf(err, sizeof err, "%s.err", study);
	snprintf(histories, sizeof histories, "%s.csv", study);
	pid_t pid = program_start(
	    (const char *const[]){"pound", "run", "--threads", "2", "--samples", histories, study, NULL},
	    "/dev/null", err);
	// wait until both worker threads have started and ended; a sanitizer adds a thread
	const struct timespec moment = {.tv_nsec = 1000000};
	for (int now = 1, most = 1; most < 3 || now > most - 2; nanosleep(&moment, NULL)) {
		now = threads_of(pid);
		most = now > most ? now : most;
	}
	nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
	kill(pid, SIGINT);
	assert_int_equal(program_end(pid), 1);
	size_t n;
	char *said = program_file(err, &n);
	assert_non_null(strstr(said, "stopped by the caller"));
	assert_null(program_file(histories, &n));
	free(said);
	unlink(err);
	unlink(study);
}

static void the_bar_keeps_within_its_terminal_and_clears_its_line(void **state)
{
	static const int widths[] = {120, 60, 20};
	char study[32];
	(void)state;
	example_file("sensitivity_small", study);
	for (int i = 0; i < 3; i++) {
		char *bar = program_drawn((const char *const[]){"pound", "run", study, NULL}, widths[i]);
		size_t n = strlen(bar);
		assert_non_null(strstr(bar, "100 %"));
		assert_true(n > 4 && strcmp(bar + n - 4, "\r\033[K") == 0);
		for (char *line = strtok(bar, "\r"); line; line = strtok(NULL, "\r"))
			// the escape sequence has three bytes and no width
			assert_true(strncmp(line, "\033[K", 3) == 0 && strlen(line) - 3 < (size_t)widths[i]);
		free(bar);
	}
	unlink(study);
}

static void a_paper_study_is_valid_and_its_cost_is_reported(void **state)
{
	struct program_outcome names = POUND("example", "--names");
	int n = 0;
	for (char *name = strtok(names.out, "\n"); name; name = strtok(NULL, "\n")) {
		if (!is_long(name))
			continue;
		struct program_outcome document = POUND("example", name);
		struct answer estimate =
		    service_ask(*state, &(struct ask){.method = "POST",
		                                      .path = "/v1/studies?validate_only=true",
		                                      .headers = {"Content-Type: application/json"},
		                                      .body = document.out,
		                                      .length = document.n_out});
		assert_int_equal(estimate.status, 200);
		assert_non_null(strstr(estimate.body, "\"estimated_cpu_s\": "));
		answer_free(&estimate);
		program_free(&document);
		n++;
	}
	assert_true(n >= 2);
	program_free(&names);
}

#define SERVED(name) cmocka_unit_test_setup_teardown(name, program_setup, service_teardown)

CHECK_MAIN(SERVED(every_quick_example_gives_the_same_bytes_by_1_2_and_4_threads_and_by_the_server),
           SERVED(a_bad_study_gets_the_same_list_from_run_and_from_the_server),
           cmocka_unit_test(a_table_of_responses_has_each_value_of_a_sweep),
           cmocka_unit_test(a_table_says_how_many_responses_failed_and_why),
           SERVED(a_study_without_any_result_ends_with_3_and_says_why),
           cmocka_unit_test(ctrl_c_stops_a_run_without_a_result),
           cmocka_unit_test(a_file_that_cannot_be_written_is_reported_before_the_study_runs),
           cmocka_unit_test(ctrl_c_stops_histories_that_are_being_written),
           cmocka_unit_test(the_bar_keeps_within_its_terminal_and_clears_its_line),
           SERVED(a_paper_study_is_valid_and_its_cost_is_reported))
