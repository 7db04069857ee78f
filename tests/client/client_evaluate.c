/* client_evaluate.c - `pound evaluate` of a stub model gives the bytes of `pound design`, the model, `pound indices`. */
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/json/json_writer.h"
#include "tests/support/check.h"
#include "tests/support/latency.h"
#include "tests/support/program.h"
#include "tests/support/stub_model.h"

enum { ROWS = 100, SAMPLES = 5, RUNS = ROWS * SAMPLES, PATH_SIZE = 32 };

static const char STUDY[] =
    "{\"inputs\": [{\"name\": \"x1\", \"distribution\": {\"type\": \"uniform\", \"min\": -3.141592653589793, "
    "\"max\": 3.141592653589793}}, {\"name\": \"x2\", \"distribution\": {\"type\": \"uniform\", \"min\": "
    "-3.141592653589793, \"max\": 3.141592653589793}}, {\"name\": \"x3\", \"distribution\": {\"type\": "
    "\"uniform\", \"min\": -3.141592653589793, \"max\": 3.141592653589793}}], \"design\": {\"rows\": %d}}";

/* Writes a text to a new file; the caller deletes the file. */
static void file_of(const char *text, char path[PATH_SIZE])
{
	strcpy(path, "/tmp/pound-test-XXXXXX");
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void study_file(int rows, char path[PATH_SIZE])
{
	char text[sizeof STUDY + 16];
	snprintf(text, sizeof text, STUDY, rows);
	file_of(text, path);
}

/* Indices of a stub model by files: `pound design`, an output for each line, `pound indices`; the caller frees them. */
static char *by_files(const char *study, enum stub_manner manner, int replicates)
{
	struct program_outcome rows = program_run((const char *const[]){"pound", "design", study, NULL}, NULL);
	program_expect(&rows, 0);
	char *csv = NULL, *end, path[PATH_SIZE], digits[WRITER_NUMBER_SIZE];
	size_t n;
	long run = 0;
	FILE *out = open_memstream(&csv, &n);
	fputs(replicates > 1 ? "y1,y1.variance\n" : "y1\n", out);
	for (char *line = strchr(rows.out, '\n') + 1; *line; line = end + 1) {
		double x[3] = {strtod(line, &end), strtod(end + 1, &end), strtod(end + 1, &end)}, sum = 0,
		       squares = 0;
		double value = stub_model_value(x), of[8] = {value};
		for (int r = 0; r < replicates; r++, run++)
			sum += of[r] = value + (manner == STUB_NOISY ? stub_model_noise(run) : 0);
		for (int r = 0; r < replicates; r++)
			squares += (of[r] - sum / replicates) * (of[r] - sum / replicates);
		writer_digits(sum / replicates, digits);
		fputs(manner == STUB_FAILING && stub_model_fails(x) ? "" : digits, out);
		if (replicates > 1)
			fprintf(out, ",%.17g", squares / (replicates - 1) / replicates);
		fputc('\n', out);
	}
	fclose(out);
	file_of(csv, path);
	struct program_outcome indices =
	    program_run((const char *const[]){"pound", "indices", study, path, NULL}, NULL);
	program_expect(&indices, 0);
	unlink(path);
	free(csv);
	program_free(&rows);
	char *json = strdup(indices.out);
	program_free(&indices);
	return json;
}

/* Fails unless `pound evaluate` gives the bytes `wanted` and its messages contain `said`. */
static void evaluated(const char *url, const char *study, const char *wanted, const char *said,
                      const char *const options[4])
{
	const char *arguments[16] = {"pound", "evaluate", "--model", url, study};
	for (int i = 0; i < 4 && options[i]; i++)
		arguments[5 + i] = options[i];
	struct program_outcome outcome = program_run(arguments, NULL);
	program_expect(&outcome, 0);
	assert_string_equal(outcome.out, wanted);
	if (*said ? !strstr(outcome.err, said) : *outcome.err)
		fail_msg("'%s' was said instead of '%s'", outcome.err, said);
	program_free(&outcome);
}

static void a_model_gives_the_bytes_of_its_outputs_by_files(void **state)
{
	static const struct {
		enum stub_manner manner;
		const char *jobs, *said;
	} cases[] = {
	    {STUB_PLAIN, "1", ""},  {STUB_PLAIN, "8", ""},
	    {STUB_PLAIN, "64", ""}, {STUB_SHUFFLED, "16", ""},
	    {STUB_SHAKY, "8", ""},  {STUB_FAILING, "8", "of 500 runs failed; the first: "},
	};
	char study[PATH_SIZE];
	(void)state;
	study_file(ROWS, study);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct stub_model model = stub_model_start(cases[i].manner);
		char *wanted = by_files(study, cases[i].manner, 1);
		evaluated(model.url, study, wanted, cases[i].said, (const char *const[4]){"--jobs", cases[i].jobs});
		assert_true(cases[i].manner == STUB_SHAKY ? *model.calls > RUNS : *model.calls == RUNS);
		free(wanted);
		stub_model_stop(&model);
	}
	unlink(study);
}

static void replicates_give_the_mean_and_its_variance_and_every_run_has_a_seed_of_its_own(void **state)
{
	struct stub_model model = stub_model_start(STUB_NOISY);
	char study[PATH_SIZE];
	(void)state;
	study_file(ROWS, study);
	char *wanted = by_files(study, STUB_NOISY, 4);
	struct program_outcome outcome = program_run(
	    (const char *const[]){"pound", "evaluate", "--model", model.url, "--replicates", "4", "--seed-member",
	                          "seed", "--config", "{\"fidelity\": [1, {\"a\": 2}]}", study, NULL},
	    NULL);
	program_expect(&outcome, 0);
	assert_int_equal(*model.calls, 4 * RUNS);
	assert_string_equal(outcome.out, wanted);
	program_free(&outcome);
	free(wanted);
	stub_model_stop(&model);
	unlink(study);
}

static int lines_of(const char *path)
{
	size_t n = 0;
	int lines = 0;
	char *text = program_file(path, &n);
	for (size_t i = 0; i < n; i++)
		lines += text[i] == '\n';
	free(text);
	return lines;
}

static void an_evaluation_that_is_killed_goes_on_and_gives_the_same_bytes(void **state)
{
	const int kills = check_count(20, 100);
	struct stub_model model = stub_model_start(STUB_SHUFFLED);
	char study[PATH_SIZE], journal[PATH_SIZE], extra = '7';
	int doubled = 0;
	(void)state;
	study_file(ROWS, study);
	char *wanted = by_files(study, STUB_SHUFFLED, 1);
	file_of("", journal);
	const char *const arguments[] = {"pound", "evaluate", "--model", model.url, "--journal",
	                                 journal, "--jobs",   "8",       study,     NULL};
	for (int k = 0; k < kills; k++) {
		const int until = lines_of(journal) + 1 + k % 7;
		pid_t pid = program_start(arguments, "/dev/null", "/dev/null");
		while (lines_of(journal) < until && lines_of(journal) < 1 + RUNS && kill(pid, 0) == 0)
			usleep(200);
		kill(pid, SIGKILL);
		program_end(pid);
		// a last line that was cut while it was written
		if (k % 3 == 0) {
			FILE *file = fopen(journal, "a");
			fwrite(&extra, 1, 1, file);
			fclose(file);
		}
	}
	const int before = lines_of(journal);
	assert_true(before > kills / 2 && before < RUNS);
	evaluated(model.url, study, wanted, "", (const char *const[4]){"--journal", journal, "--jobs", "8"});
	assert_int_equal(lines_of(journal), 1 + RUNS);
	doubled = *model.calls - RUNS;
	assert_true(doubled <= 8 * kills); // the calls in progress at the kills
	// with a complete journal the model is not called
	evaluated(model.url, study, wanted, "", (const char *const[4]){"--journal", journal});
	assert_int_equal(*model.calls, RUNS + doubled);
	check_report("%d kills: 0 runs lost, %d made twice, the same bytes", kills, doubled);
	free(wanted);
	unlink(journal);
	unlink(study);
	stub_model_stop(&model);
}

static void a_journal_is_of_one_evaluation(void **state)
{
	struct stub_model model = stub_model_start(STUB_PLAIN);
	char study[PATH_SIZE], other[PATH_SIZE], journal[PATH_SIZE];
	(void)state;
	study_file(ROWS, study);
	study_file(ROWS + 1, other);
	file_of("", journal);
	const char *const wrong[][3] = {
	    {other, NULL, NULL}, {study, "--config", "{\"a\": 1}"}, {study, "--seed-member", "seed"}};
	struct program_outcome outcome = program_run(
	    (const char *const[]){"pound", "evaluate", "--model", model.url, "--journal", journal, study, NULL},
	    NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
	for (int i = 0; i < 3; i++) {
		outcome = program_run((const char *const[]){"pound", "evaluate", "--model", model.url, "--journal",
		                                            journal, wrong[i][0], wrong[i][1], wrong[i][2], NULL},
		                      NULL);
		program_expect(&outcome, 2);
		assert_non_null(strstr(outcome.err, "is the journal of another evaluation"));
		program_free(&outcome);
	}
	FILE *file = fopen(journal, "a");
	fputs("7,8,9\n", file);
	fclose(file);
	outcome = program_run(
	    (const char *const[]){"pound", "evaluate", "--model", model.url, "--journal", journal, study, NULL},
	    NULL);
	program_expect(&outcome, 2);
	assert_non_null(strstr(outcome.err, "line 502: is not a run with 1 outputs"));
	program_free(&outcome);
	assert_int_equal(*model.calls, RUNS);
	unlink(journal);
	unlink(other);
	unlink(study);
	stub_model_stop(&model);
}

static void what_is_wrong_ends_the_command_with_its_status(void **state)
{
	static const struct {
		enum stub_manner manner;
		const char *options[4], *said;
		int status;
	} cases[] = {
	    {STUB_PLAIN, {"--name", "backward"}, "ModelNotFound: there is forward alone", 2},
	    {STUB_PLAIN, {"--outputs", "a,b"}, "--outputs has 2 names, the model has 1 outputs", 2},
	    {STUB_PLAIN, {"--outputs", "x2"}, "'x2' cannot be the name of an output", 2},
	    {STUB_PLAIN, {"--config", "[1]"}, "--config must be a JSON object", 2},
	    {STUB_PLAIN, {"--config", "{\"s\": 1}", "--seed-member", "s"}, "has a member 's' already", 2},
	    {STUB_PLAIN, {"--replicates", "3"}, "--replicates needs --seed-member", 2},
	    {STUB_PLAIN, {"--jobs", "0"}, "--jobs must be a whole number", 2},
	    {STUB_PLAIN, {"--journal", "/nowhere/journal"}, "cannot open '/nowhere/journal'", 1},
	    {STUB_WIDE, {NULL}, "does not have the sizes of the model", 2},
	    {STUB_REFUSING, {NULL}, "the answer has status 401: who are you?", 1},
	    {STUB_DEAD, {"--jobs", "1"}, "the answer has status 503: busy", 4},
	    {STUB_SILENT, {"--timeout", "1", "--jobs", "1"}, "Operation timed out", 4},
	};
	char study[PATH_SIZE], few[PATH_SIZE];
	(void)state;
	study_file(ROWS, study);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct stub_model model = stub_model_start(cases[i].manner);
		const char *arguments[16] = {"pound", "evaluate", "--model", model.url, study};
		for (int k = 0; k < 4; k++)
			arguments[5 + k] = cases[i].options[k];
		struct program_outcome outcome = program_run(arguments, NULL);
		if (outcome.status != cases[i].status || !strstr(outcome.err, cases[i].said))
			fail_msg("%s: %d %s", cases[i].said, outcome.status, outcome.err);
		if (cases[i].manner == STUB_DEAD || cases[i].manner == STUB_SILENT)
			assert_int_equal(*model.calls, 4);
		program_free(&outcome);
		stub_model_stop(&model);
	}
	file_of("{\"inputs\": [{\"name\": \"x1\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": "
	        "1}}]}",
	        few);
	struct stub_model model = stub_model_start(STUB_PLAIN);
	struct program_outcome outcome =
	    program_run((const char *const[]){"pound", "evaluate", "--model", model.url, few, NULL}, NULL);
	program_expect(&outcome, 2);
	assert_non_null(strstr(outcome.err, "the model takes 3 inputs, the study has 1"));
	program_free(&outcome);
	stub_model_stop(&model);
	outcome =
	    program_run((const char *const[]){"pound", "evaluate", "--model", model.url, study, NULL}, NULL);
	program_expect(&outcome, 4);
	program_free(&outcome);
	outcome = program_run((const char *const[]){"pound", "evaluate", study, NULL}, NULL);
	program_expect(&outcome, 2);
	assert_non_null(strstr(outcome.err, "--model is missing"));
	program_free(&outcome);
	unlink(few);
	unlink(study);
}

static void rows_take_little_time_of_the_client(void **state)
{
	enum { MANY = 1200 };
	struct stub_model model = stub_model_start(STUB_PLAIN);
	struct rusage before, after;
	char study[PATH_SIZE];
	(void)state;
	study_file(MANY, study);
	char *wanted = by_files(study, STUB_PLAIN, 1);
	struct program_outcome alone =
	    program_run((const char *const[]){"pound", "example", "--names", NULL}, NULL);
	program_free(&alone);
	getrusage(RUSAGE_CHILDREN, &before);
	const double began = latency_now();
	evaluated(model.url, study, wanted, "", (const char *const[4]){NULL});
	const double seconds = latency_now() - began;
	getrusage(RUSAGE_CHILDREN, &after);
	const double cpu = (double)(after.ru_utime.tv_sec - before.ru_utime.tv_sec) +
	                   (double)(after.ru_stime.tv_sec - before.ru_stime.tv_sec) +
	                   1e-6 * (double)(after.ru_utime.tv_usec - before.ru_utime.tv_usec) +
	                   1e-6 * (double)(after.ru_stime.tv_usec - before.ru_stime.tv_usec);
	check_report(
	    "%d runs of a stub model by 8 jobs: %.0f a second, %.3f ms of the client's CPU each, indices "
	    "included",
	    SAMPLES * MANY, SAMPLES * MANY / seconds, 1e3 * cpu / (SAMPLES * MANY));
	free(wanted);
	stub_model_stop(&model);
	unlink(study);
}

/* The server of UM-Bridge's Python package, from a checkout in UMBRIDGE_DIR; skipped without one. */
static void a_model_in_python_gives_the_same_bytes(void **state)
{
	static const char text[] = "import math, sys, umbridge\n"
	                           "class Ishigami(umbridge.Model):\n"
	                           "    def __init__(self): super().__init__('forward')\n"
	                           "    def get_input_sizes(self, config): return [3]\n"
	                           "    def get_output_sizes(self, config): return [1]\n"
	                           "    def supports_evaluate(self): return True\n"
	                           "    def __call__(self, parameters, config):\n"
	                           "        x, y, z = parameters[0]\n"
	                           "        return [[math.sin(x) + 7.0 * math.sin(y) * math.sin(y) + 0.1 * "
	                           "math.pow(z, 4) * math.sin(x)]]\n"
	                           "umbridge.serve_models([Ishigami()], int(sys.argv[1]))\n";
	const char *folder = getenv("UMBRIDGE_DIR");
	char study[PATH_SIZE], script[PATH_SIZE], port[8], url[64];
	(void)state;
	if (!folder)
		skip();
	// a free port: that of a stub model that has ended
	struct stub_model free_port = stub_model_start(STUB_PLAIN);
	strcpy(url, free_port.url);
	snprintf(port, sizeof port, "%s", strrchr(url, ':') + 1);
	stub_model_stop(&free_port);
	study_file(ROWS, study);
	file_of(text, script);
	setenv("PYTHONPATH", folder, 1);
	pid_t server = program_start((const char *const[]){"/usr/bin/python3", script, port, NULL}, "/dev/null",
	                             "/dev/null");
	char *wanted = by_files(study, STUB_PLAIN, 1);
	int status = 4;
	for (int i = 0; i < 100 && status == 4; i++) {
		struct program_outcome outcome =
		    program_run((const char *const[]){"pound", "evaluate", "--model", url, study, NULL}, NULL);
		status = outcome.status;
		if (status == 0)
			assert_string_equal(outcome.out, wanted);
		program_free(&outcome);
		usleep(100000);
	}
	assert_int_equal(status, 0);
	kill(server, SIGKILL);
	program_end(server);
	unsetenv("PYTHONPATH");
	free(wanted);
	unlink(script);
	unlink(study);
	check_report("the package umbridge: the same bytes");
}

CHECK_MAIN(cmocka_unit_test(a_model_gives_the_bytes_of_its_outputs_by_files),
           cmocka_unit_test(replicates_give_the_mean_and_its_variance_and_every_run_has_a_seed_of_its_own),
           cmocka_unit_test(an_evaluation_that_is_killed_goes_on_and_gives_the_same_bytes),
           cmocka_unit_test(a_journal_is_of_one_evaluation),
           cmocka_unit_test(what_is_wrong_ends_the_command_with_its_status),
           cmocka_unit_test(rows_take_little_time_of_the_client),
           cmocka_unit_test(a_model_in_python_gives_the_same_bytes))
