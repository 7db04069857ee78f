/* Figures of the server and of the command line: same bytes, media types, security policy; reports. */
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "schema/figure/figure.h"
#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/raw_http.h"
#include "tests/support/study_documents.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static void submit(const char *example, char id[32])
{
	struct program_outcome document = POUND("example", example);
	struct program_outcome printed =
	    program_run((const char *const[]){"pound", "submit", "-", "--wait", NULL}, document.out);
	program_expect(&printed, 0);
	snprintf(id, 32, "%.16s", printed.out);
	program_free(&printed);
	program_free(&document);
}

/* Writes the output of a command to a new file. */
static void keep(struct program_outcome *outcome, char path[32])
{
	program_expect(outcome, 0);
	strcpy(path, "/tmp/pound-test-XXXXXX");
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	fwrite(outcome->out, 1, outcome->n_out, file);
	fclose(file);
	program_free(outcome);
}

/* Fails unless `signal=2` gives a figure of signal 2 and an unknown signal a 400. */
static void expect_one_signal(const struct service *service, const char *link)
{
	struct answer answer = service_get(service, "%s?signal=2", link);
	assert_int_equal(answer.status, 200);
	assert_non_null(strstr(answer.body, "ground motion 2"));
	answer_free(&answer);
	answer = service_get(service, "%s?signal=99", link);
	assert_int_equal(answer.status, 400);
	assert_non_null(strstr(answer.body, "no sample of signal 99"));
	answer_free(&answer);
}

/* Fails unless each figure that a study lists is drawn alike by the server and by the command line; returns their
 * number. */
static int figures_of(const struct service *service, const char *id, const char *result, const char *samples)
{
	struct answer answer = service_get(service, "/v1/studies/%s/figures", id);
	struct reading *list = answer_read(&answer);
	int n = reading_count(list, "/figures");
	for (int i = 0; i < n; i++) {
		const char *name = reading_text(list, "/figures/%d/name", i);
		struct answer figure = service_get(service, "%s", reading_text(list, "/figures/%d/link", i));
		assert_int_equal(figure.status, 200);
		assert_string_equal(figure.type, "image/svg+xml");
		assert_true(*figure.etag);
		bool sampled = figure_row(name)->sampled;
		struct program_outcome served = POUND("plot", name, id);
		struct program_outcome here = POUND("plot", name, sampled ? samples : result);
		program_expect(&served, 0);
		program_expect(&here, 0);
		assert_string_equal(served.out, figure.body);
		if (sampled)
			expect_one_signal(service, reading_text(list, "/figures/%d/link", i));
		// a figure from a file of samples lacks the study's name
		if (!sampled)
			assert_string_equal(here.out, figure.body);
		program_free(&served);
		program_free(&here);
		answer_free(&figure);
	}
	reading_close(list);
	answer_free(&answer);
	return n;
}

static void a_figure_of_a_file_has_the_bytes_of_the_server(void **state)
{
	static const struct {
		const char *example;
		int figures;
		bool sampled; /* one of the figures is drawn from samples */
	} cases[] = {{"sensitivity_small", 1, false}, {"until", 4, false},          {"floor_spectrum", 3, true},
	             {"response_sweep", 2, true},     {"unequal_heights", 3, true}, {"convergence", 1, false}};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char id[32], result[32], samples[32];
		submit(cases[i].example, id);
		struct program_outcome printed = POUND("results", id);
		keep(&printed, result);
		printed = cases[i].sampled ? POUND("samples", id) : POUND("results", id);
		keep(&printed, samples);
		assert_int_equal(figures_of(*state, id, result, samples), cases[i].figures);
		unlink(result);
		unlink(samples);
	}
}

static void a_figure_by_itself_may_style_itself_and_nothing_else(void **state)
{
	char id[32], request[200];
	struct raw_answer answer;
	submit("sensitivity_small", id);
	snprintf(request, sizeof request,
	         "GET /v1/studies/%s/figures/indices HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
	         id);
	raw_ask(*state, request, strlen(request), 5, &answer);
	assert_int_equal(answer.status, 200);
	assert_non_null(strstr(answer.text,
	                       "\r\nContent-Security-Policy: default-src 'none'; style-src 'unsafe-inline'; "
	                       "frame-ancestors 'none'; sandbox\r\n"));
	assert_non_null(strstr(answer.text, "\r\nX-Content-Type-Options: nosniff\r\n"));
}

static void a_figure_of_a_running_study_is_of_the_rows_so_far(void **state)
{
	char id[17];
	char *study = service_study(SERVICE_ROWS, 5, 1);
	service_submit(*state, study, id);
	free(study);
	assert_true(service_wait(*state, id, "running", 2000));
	struct answer answer = service_get(*state, "/v1/studies/%s/figures/indices", id);
	assert_int_equal(answer.status, 404);
	answer_free(&answer);
	// on a busy machine the first rows may not be stored yet
	answer = service_get(*state, "/v1/studies/%s/figures/indices?partial=true", id);
	for (int tries = 0; answer.status == 404 && tries < 200; tries++) {
		answer_free(&answer);
		nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
		answer = service_get(*state, "/v1/studies/%s/figures/indices?partial=true", id);
	}
	assert_int_equal(answer.status, 200);
	assert_non_null(strstr(answer.body, "INTERMEDIATE RESULT, "));
	answer_free(&answer);
	answer = service_get(*state, "/v1/studies/%s/figures?partial=true", id);
	assert_int_equal(answer.status, 200);
	assert_non_null(strstr(answer.body, "\"indices\""));
	answer_free(&answer);
}

static void wrong_choices_end_with_2_and_what_is_not_there_with_1(void **state)
{
	char id[32];
	(void)state;
	static const struct {
		const char *figure, *option, *words;
		int status;
	} cases[] = {
	    {"indices", "--width=10", "width must be a whole number in [320, 2400]", 2},
	    {"indices", "--cell=1", "cell must be a whole number in [0, 0]", 2},
	    {"indices", "--axis=hz", "takes no argument", 2},
	    {"indices", "--output=no", "no output", 2},
	    {"errors", "--width=400", "kind \"convergence\", not \"sensitivity\"; it has: indices", 1},
	};
	char result[32];
	submit("sensitivity_small", id);
	struct program_outcome printed = POUND("results", id);
	keep(&printed, result);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		for (int served = 0; served < 2; served++) {
			struct program_outcome outcome =
			    POUND("plot", cases[i].figure, cases[i].option, served ? id : result);
			program_expect(&outcome, cases[i].status);
			assert_string_equal(outcome.out, "");
			if (!strstr(outcome.err, cases[i].words))
				fail_msg("%s %s: %s", cases[i].figure, cases[i].option, outcome.err);
			program_free(&outcome);
		}
	unlink(result);
	struct program_outcome outcome = POUND("plot", "nothing", id);
	program_expect(&outcome, 1);
	program_free(&outcome);
	outcome = POUND("plot", "indices", "/nowhere");
	program_expect(&outcome, 1);
	program_free(&outcome);
	outcome = POUND("plot", "indices");
	program_expect(&outcome, 2);
	program_free(&outcome);
	outcome = POUND("plot", "--names");
	program_expect(&outcome, 0);
	for (const struct figure_row *row = figure_rows; row->name; row++)
		assert_non_null(strstr(outcome.out, row->text));
	program_free(&outcome);
}

static void a_report_is_one_page_that_needs_nothing_else(void **state)
{
	char id[32], result[32], study[32];
	(void)state;
	submit("floor_spectrum", id);
	struct program_outcome served = POUND("report", id), printed = POUND("results", id);
	program_expect(&served, 0);
	// the study, the spectra, and a history from the samples stored by the server
	assert_non_null(strstr(served.out, "Floor response spectra"));
	assert_non_null(strstr(served.out, "Motion and impacts"));
	assert_non_null(strstr(served.out, "&quot;histories&quot;: true"));
	keep(&printed, result);
	printed = POUND("example", "floor_spectrum");
	keep(&printed, study);
	struct program_outcome here = POUND("report", result, study), alone = POUND("report", result);
	program_expect(&here, 0);
	program_expect(&alone, 0);
	assert_non_null(strstr(here.out, "&quot;histories&quot;: true"));
	assert_non_null(strstr(alone.out, "It was not given"));
	struct program_outcome wrong = POUND("report", study);
	program_expect(&wrong, 1);
	assert_non_null(strstr(wrong.err, "not the result of a study"));
	program_free(&wrong);
	wrong = POUND("report", "0000000000000000");
	program_expect(&wrong, 1);
	program_free(&wrong);
	program_free(&alone);
	program_free(&here);
	program_free(&served);
	unlink(result);
	unlink(study);
}

static void keep_text(const char *text, char path[32])
{
	strcpy(path, "/tmp/pound-test-XXXXXX");
	FILE *file = fdopen(mkstemp(path), "w");
	assert_true(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Fails unless a report of these files is refused with a message that contains `words`, without output. */
static void expect_refused(const char *result, const char *study, const char *words)
{
	struct program_outcome outcome = POUND("report", result, study);
	program_expect(&outcome, 2);
	assert_string_equal(outcome.out, "");
	if (!strstr(outcome.err, words))
		fail_msg("%s", outcome.err);
	program_free(&outcome);
}

static void a_report_has_no_other_study(void **state)
{
	static const char design[] =
	    "{\"inputs\": [{\"name\": \"a\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}},"
	    " {\"name\": \"b\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}],"
	    " \"design\": {\"rows\": 30}}";
	char result[32], study[32], other[32], renamed[32], own[32], faulty[32];
	(void)state;
	struct program_outcome document = POUND("example", "response"), printed;
	keep_text(document.out, study);
	printed = POUND("run", study);
	keep(&printed, result);
	char *text = study_documents_with(document.out, "\"seed\": ", "\"seed\":\n 1");
	keep_text(text, other);
	free(text);
	text = study_documents_with(document.out, "\"name\": \"", "\"name\":\n\"My ");
	keep_text(text, renamed);
	free(text);
	keep_text(design, own);
	keep_text("{\"kind\": \"sensitivty\"}", faulty);
	expect_refused(result, other, "is not the study of");
	expect_refused(result, own, "is not the study of");
	expect_refused(result, faulty, "got \"sensitivty\"");
	expect_refused("0000000000000000", study, "leave out");
	// a document with another name or layout is the same study
	printed = POUND("report", result, renamed);
	program_expect(&printed, 0);
	assert_non_null(strstr(printed.out, "&quot;My "));
	program_free(&printed);
	program_free(&document);
	unlink(result), unlink(study), unlink(other), unlink(renamed), unlink(own), unlink(faulty);
}

/* Fails unless the commands of a page make the figure that is stored with the page. */
static void figure_of_a_page(const char *page, const char *commands, const char *example, const char *figure,
                             const char *path)
{
	char *text = program_file(page, NULL), *golden = program_file(path, NULL), result[32];
	assert_non_null(text);
	assert_non_null(golden);
	assert_non_null(strstr(text, commands));
	struct program_outcome study = POUND("example", example);
	struct program_outcome run = program_run((const char *const[]){"pound", "run", "-", NULL}, study.out);
	keep(&run, result);
	struct program_outcome made = POUND("plot", figure, result);
	program_expect(&made, 0);
	assert_string_equal(made.out, golden);
	program_free(&made);
	program_free(&study);
	unlink(result);
	free(golden);
	free(text);
}

static void the_first_figure_of_the_readme_is_what_its_command_makes(void **state)
{
	(void)state;
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
	skip(); // 720,000 runs are too slow
#endif
	figure_of_a_page("README.md",
	                 "build/release/pound example paper | build/release/pound run - >campaign.json\n"
	                 "build/release/pound plot swept campaign.json >campaign.svg\n",
	                 "paper", "swept", "schema/figure/campaign.svg");
}

static void the_figure_of_a_row_is_what_its_command_makes(void **state)
{
	(void)state;
	figure_of_a_page("schema/figure/figures.md",
	                 "build/release/pound example unequal_heights | build/release/pound run - >row.json\n"
	                 "build/release/pound plot heights row.json >heights.svg\n",
	                 "unequal_heights", "heights", "schema/figure/heights.svg");
}

#define SERVED(name) cmocka_unit_test_setup_teardown(name, program_setup, service_teardown)

CHECK_MAIN(SERVED(a_figure_of_a_file_has_the_bytes_of_the_server),
           SERVED(a_figure_by_itself_may_style_itself_and_nothing_else),
           SERVED(a_figure_of_a_running_study_is_of_the_rows_so_far),
           SERVED(a_report_is_one_page_that_needs_nothing_else),
           cmocka_unit_test(a_report_has_no_other_study),
           cmocka_unit_test(the_first_figure_of_the_readme_is_what_its_command_makes),
           cmocka_unit_test(the_figure_of_a_row_is_what_its_command_makes),
           SERVED(wrong_choices_end_with_2_and_what_is_not_there_with_1))
