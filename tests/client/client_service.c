/* Every subcommand that needs a server, against a poundd started by the test. */
#include <string.h>

#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

/* Submits an example, with or without waiting for its end; `id` is the id of the study. */
static void submit(const char *example, bool wait, char id[32])
{
	struct program_outcome document = POUND("example", example);
	struct program_outcome printed = program_run(
	    (const char *const[]){"pound", "submit", "-", wait ? "--wait" : NULL, NULL}, document.out);
	program_expect(&printed, 0);
	assert_string_equal(printed.err, "");
	printed.out[strcspn(printed.out, "\n")] = '\0';
	assert_int_equal(printed.n_out, strlen(printed.out) + 1);
	snprintf(id, 32, "%s", printed.out);
	program_free(&printed);
	program_free(&document);
}

static void expect_words(struct program_outcome outcome, int status, const char *const words[])
{
	program_expect(&outcome, status);
	for (int i = 0; words[i]; i++)
		if (!strstr(outcome.out, words[i]) && !strstr(outcome.err, words[i])) {
			print_error("'%s' is not in\n%s%s", words[i], outcome.out, outcome.err);
			fail();
		}
	program_free(&outcome);
}

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void a_study_that_has_succeeded_has_status_results_and_samples(void **state)
{
	char id[32];
	(void)state;
	submit("sensitivity_small", true, id);
	expect_words(POUND("status", id), 0, WORDS("\"status\": \"succeeded\"", "\"progress\": 1"));
	expect_words(POUND("status", "--format", "table", id), 0, WORDS("runs_total", "succeeded", id));
	expect_words(POUND("wait", id), 0, WORDS("\"status\": \"succeeded\""));
	expect_words(POUND("results", id), 0, WORDS("\"kind\": \"sensitivity\"", "\"ST_high\""));
	expect_words(POUND("results", "--format", "table", id), 0, WORDS("  ST  0.329 +-0.374", "variance"));
	expect_words(POUND("results", "--format", "csv", id), 0, WORDS("ST_high"));
	expect_words(POUND("results", "--partial", "--format", "csv", "--table", "inputs", id), 0,
	             WORDS("S1,S1_low,S1_high"));
	expect_words(POUND("results", "--format", "csv", "--table", "stopping", id), 1, WORDS("has no table"));
	expect_words(POUND("samples", id), 0, WORDS(".variance", "row"));
	struct program_outcome npy = POUND("samples", "--format", "npy", id);
	program_expect(&npy, 0);
	assert_memory_equal(npy.out, "\x93NUMPY", 6);
	program_free(&npy);
	expect_words(POUND("cancel", id), 1, WORDS(id, "finished"));
	// a study without samples gives the reason
	submit("rigid_wall", true, id);
	expect_words(POUND("samples", id), 1, WORDS("samples exist only for sensitivity studies"));
	// samples of a response study are its contacts
	submit("response", true, id);
	expect_words(POUND("samples", id), 0, WORDS("signal,time_s,duration_s,cell,contact", "impulse_n_s"));
	expect_words(POUND("plot", "timeline", id), 0, WORDS("<svg", "Contacts in time"));
}

static void a_cancelled_study_ends_wait_and_results_with_3(void **state)
{
	char id[32];
	(void)state;
	submit("paper", false, id);
	expect_words(POUND("results", id), 1, WORDS(id, "not finished", "try again in"));
	expect_words(POUND("cancel", id), 0, WORDS("\"status\": \"cancelled\""));
	expect_words(POUND("wait", id), 3, WORDS("the study is cancelled"));
	expect_words(POUND("results", id), 3, WORDS(id));
	expect_words(POUND("samples", id), 3, WORDS(id));
	expect_words(POUND("delete", id), 0, WORDS(""));
}

static void results_of_a_cancelled_study_name_the_partial_ones(void **state)
{
	char id[32];
	bool ran = false;
	(void)state;
	submit("paper", false, id);
	while (!ran) {
		struct program_outcome status = POUND("status", id);
		struct reading *reading = reading_open(status.out, status.n_out);
		ran = reading_number(reading, "/runs_done") > 0;
		reading_close(reading);
		program_free(&status);
	}
	expect_words(POUND("cancel", id), 0, WORDS("\"status\": \"cancelled\""));
	expect_words(POUND("results", id), 3, WORDS("pound results --partial", id));
}

static void a_deleted_study_is_gone_for_every_command(void **state)
{
	static const char *const commands[] = {"status", "wait", "results", "samples", "cancel", "delete"};
	char id[32];
	(void)state;
	submit("response", true, id);
	struct program_outcome deleted = POUND("delete", id);
	program_expect(&deleted, 0);
	assert_string_equal(deleted.out, "");
	assert_string_equal(deleted.err, "");
	program_free(&deleted);
	for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
		expect_words(POUND(commands[i], id), 1, WORDS(id, "no such study"));
}

static void an_id_of_the_user_s_invention_is_no_path(void **state)
{
	(void)state;
	expect_words(POUND("status", "../../livez"), 1, WORDS("../../livez"));
	expect_words(POUND("status", "?limit=1"), 1, WORDS("?limit=1"));
	expect_words(POUND("status", ""), 1, WORDS(""));
}

static void list_goes_page_by_page_from_the_newest(void **state)
{
	char first[32], second[32], next[64];
	(void)state;
	submit("response", true, first);
	submit("response", true, second);
	struct program_outcome page = POUND("list", "--limit", "1", "--status", "succeeded", "--format", "table");
	program_expect(&page, 0);
	assert_non_null(strstr(page.out, second));
	assert_null(strstr(page.out, first));
	assert_int_equal(sscanf(page.err, "pound: more: --cursor %63s", next), 1);
	program_free(&page);
	page = POUND("list", "--limit", "1", "--cursor", next, "--format", "csv");
	program_expect(&page, 0);
	assert_non_null(strstr(page.out, first));
	assert_null(strstr(page.out, second));
	program_free(&page);
	expect_words(POUND("list"), 0, WORDS("\"studies\": [", first, second));
	expect_words(POUND("list", "--status", "asleep"), 2, WORDS("status must be"));
	expect_words(POUND("list", "--hash", "1f"), 2, WORDS("hash must be 64 hexadecimal digits"));
	expect_words(POUND("list", "--name", "no such & name"), 0, WORDS("\"studies\": []"));
}

#define SERVED(name) cmocka_unit_test_setup_teardown(name, program_setup, service_teardown)

CHECK_MAIN(SERVED(a_study_that_has_succeeded_has_status_results_and_samples),
           SERVED(a_cancelled_study_ends_wait_and_results_with_3),
           SERVED(results_of_a_cancelled_study_name_the_partial_ones),
           SERVED(a_deleted_study_is_gone_for_every_command),
           SERVED(an_id_of_the_user_s_invention_is_no_path), SERVED(list_goes_page_by_page_from_the_newest))
