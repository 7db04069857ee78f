/* service_growth.c - studies that grow until their intervals are narrow, and results of the rows so far, in a real server. */
#include <string.h>

#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/json/json_pointer.h"
#include "server/partial_results.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

enum { SIGNALS = 5, ROW_RUNS = 5 * SIGNALS, SEED = 7 };

/* A study that checks its intervals after 128, 256, 512, 1024 and 2048 rows until they are narrow; the caller frees it. */
static char *growing_study(void)
{
	char *plain = service_study(SERVICE_ROWS, SIGNALS, SEED), rows[32];
	snprintf(rows, sizeof rows, "\"rows\": %d, ", SERVICE_ROWS);
	char *study = study_documents_with(
	    plain, rows, "\"method\": \"sobol\", \"until\": {\"half_width\": 0.15, \"max_runs\": 80000}, ");
	free(plain);
	return study;
}

/* Requests `path` with an id; fails unless the answer has this status. */
static struct answer answer_of(const struct service *service, const char *path, const char *id, int status)
{
	struct answer answer = service_get(service, path, id);
	if (answer.status != status)
		fail_msg("%s: %d instead of %d: %s", path, answer.status, status, answer.body);
	return answer;
}

static double status_number(const struct service *service, const char *id, const char *pointer)
{
	struct answer answer = answer_of(service, "/v1/studies/%s", id, 200);
	struct reading *status = answer_read(&answer);
	double number = reading_number(status, "%s", pointer);
	reading_close(status);
	answer_free(&answer);
	return number;
}

static struct service_bytes uninterrupted(int n_workers)
{
	char *study = growing_study();
	struct service_bytes bytes = service_uninterrupted(study, n_workers);
	free(study);
	return bytes;
}

static const struct service_bytes *reference(void)
{
	static struct service_bytes bytes;
	if (!bytes.result)
		bytes = uninterrupted(1);
	return &bytes;
}

static void a_study_that_grows_has_the_same_bytes_for_any_number_of_workers(void **state)
{
	(void)state;
	struct service_bytes bytes = uninterrupted(4);
	service_bytes_compare(&bytes, reference());
}

static void
a_killed_study_that_grows_goes_on_to_the_same_bytes_without_running_stored_blocks_again(void **state)
{
	static const char kept[] =
	    "SELECT group_concat(number || ' ' || hex(sha256)) FROM block WHERE attempt = 1";
	struct service *service = service_new();
	char *study = growing_study(), id[17];
	(void)state;
	service_start(service, 2);
	service_submit(service, study, id);
	// killed between the second check (256 rows) and the third (512 rows)
	assert_true(service_wait(service, id, "running", 300 * ROW_RUNS));
	service_kill(service);
	char *before = service_text(service, kept);
	service_start(service, 2);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct service_bytes bytes = service_bytes(service, id);
	service_bytes_compare(&bytes, reference());
	char *after = service_text(service, kept);
	assert_string_equal(after, before);
	assert_int_equal(service_number(service, "SELECT max(attempt) FROM block"), 2);
	free(before), free(after), free(study);
	service_stop(service);
	service_free(service);
}

static void the_status_of_a_study_that_grows_has_its_bound_and_then_what_it_took(void **state)
{
	struct service *service = *state;
	char *study = growing_study(), id[17];
	service_submit(service, study, id);
	// 80000 runs allow 2048 rows
	assert_true(status_number(service, id, "/runs_total") == 2048 * ROW_RUNS);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer answer = answer_of(service, "/v1/studies/%s/results", id, 200);
	struct reading *result = answer_read(&answer);
	double runs = reading_number(result, "/stopping/runs");
	assert_true(runs < 2048 * ROW_RUNS && reading_true(result, "/stopping/reached"));
	assert_true(reading_number(result, "/cells/0/runs") == runs);
	assert_true(status_number(service, id, "/runs_total") == runs);
	assert_true(status_number(service, id, "/runs_done") == runs);
	assert_true(status_number(service, id, "/progress") == 1);
	assert_int_equal(service_number(service, "SELECT sum(runs) FROM block"), runs);
	reading_close(result);
	answer_free(&answer);
	free(study);
}

static void samples_of_a_design_that_grew_are_all_of_them_or_an_error(void **state)
{
	// damages the blocks that were added after 512 rows
	static const char added[] =
	    "UPDATE block SET content = zeroblob(length(content)) WHERE "
	    "(SELECT sum(b.runs) FROM block b WHERE b.number <= block.number) > 512 * 5 * 5";
	struct service *service = service_new();
	char *study = growing_study(), id[17];
	(void)state;
	service_start(service, 2);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer answer = answer_of(service, "/v1/studies/%s/samples", id, 200);
	int lines = 0;
	for (const char *at = answer.body; (at = strchr(at, '\n')); at++)
		lines++;
	// a header, and five samples per row
	assert_int_equal(lines, 1 + 5 * 1024);
	answer_free(&answer);
	service_stop(service);
	service_change(service, added);
	service_start(service, 2);
	answer = answer_of(service, "/v1/studies/%s/samples", id, 500);
	assert_non_null(strstr(answer.body, "result-corrupt"));
	answer_free(&answer);
	service_stop(service);
	service_free(service);
	free(study);
}

static void a_running_study_answers_with_the_indices_of_its_whole_rows(void **state)
{
	// long enough for several requests while it runs
	enum { ROWS = 3 * SERVICE_ROWS };
	struct service *service = *state;
	char *study = service_study(ROWS, SIGNALS, SEED), id[17];
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "running", 100 * ROW_RUNS));
	// 404: the first row may not be complete although later ones are
	struct answer answer = service_get(service, "/v1/studies/%s/results?partial=true", id);
	while (answer.status == 404) {
		answer_free(&answer);
		answer = service_get(service, "/v1/studies/%s/results?partial=true", id);
	}
	struct reading *result = answer_read(&answer);
	double rows = reading_number(result, "/partial/rows");
	assert_true(rows > 0 && rows < ROWS);
	assert_true(reading_number(result, "/partial/rows_most") == ROWS);
	assert_true(reading_number(result, "/cells/0/runs") == rows * ROW_RUNS);
	assert_true(reading_number(result, "/cells/0/outputs/0/inputs/0/ST") > 0);
	assert_true(strlen(answer.etag) > 0);
	reading_close(result);
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true&format=csv", id, 200);
	assert_string_equal(answer.type, "text/csv");
	assert_memory_equal(answer.body, "partial.rows,partial.rows_most,", 31);
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true&table=closed", id, 200);
	assert_string_equal(answer.type, "text/csv");
	assert_memory_equal(answer.body, "partial.rows,partial.rows_most,partial.rows_done,output.name,input_1,",
	                    69);
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true&table=stopping", id, 409);
	assert_non_null(strstr(answer.body, "this result has no table \\\"stopping\\\""));
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results?format=json&table=closed", id, 400);
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results", id, 404);
	assert_true(atoi(answer.retry_after) > 0);
	answer_free(&answer);
	assert_true(service_wait(service, id, "succeeded", 0));
	// of a finished study, partial=true gives the result
	struct answer whole = answer_of(service, "/v1/studies/%s/results", id, 200);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 200);
	assert_string_equal(answer.body, whole.body);
	answer_free(&answer);
	answer_free(&whole);
	free(study);
}

static void cancel(const struct service *service, const char *id)
{
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", id);
	struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
}

static void a_cancelled_study_keeps_the_results_of_its_whole_rows(void **state)
{
	// a minute on one core
	enum { SIGNALS_MANY = 500 };
	struct service *service = *state;
	char *study = service_study(SERVICE_ROWS, SIGNALS_MANY, SEED), id[17];
	service_submit(service, study, id);
	struct answer answer = service_get(service, "/v1/studies/%s/results?partial=true", id);
	while (answer.status == 404) {
		answer_free(&answer);
		answer = service_get(service, "/v1/studies/%s/results?partial=true", id);
	}
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	cancel(service, id);
	answer = answer_of(service, "/v1/studies/%s/results", id, 409);
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 200);
	struct reading *result = answer_read(&answer);
	const double rows = reading_number(result, "/partial/rows");
	assert_true(rows > 0 && rows < SERVICE_ROWS);
	assert_true(reading_number(result, "/cells/0/runs") == rows * 5 * SIGNALS_MANY);
	check_report("a study cancelled after %.0f of %d rows: their results are kept", rows, SERVICE_ROWS);
	reading_close(result);
	answer_free(&answer);
	free(study);
}

static double values_asked(const struct service *service)
{
	static const char line[] = "\npound_partial_values_total ";
	struct answer answer = service_get(service, "/metrics");
	const char *at = strstr(answer.body, line);
	assert_non_null(at);
	const double value = strtod(at + strlen(line), NULL);
	answer_free(&answer);
	return value;
}

/* How long a request takes is bounded by the values that it makes indices of; the result of all rows is made aside, once. */
static void the_first_results_so_far_of_a_large_study_are_made_of_few_rows(void **state)
{
	enum {
		CELLS = 24,
		OUTPUTS = 3,
		SAMPLES = 6,
		OF_ROW = CELLS * OUTPUTS * SAMPLES,
		ROWS = 2000,
		MORE = 100
	};
	struct service *service = *state;
	// the campaign of the paper, with one signal for each run: some 4 s on two cores
	char *study = study_documents_with(example_text("paper"), "\"rows\": 1000, \"seed\": 42",
	                                   "\"rows\": 2000, \"seed\": 42"),
	     *short_runs = study_documents_with(study, "\"peak_m_s2\": 1, \"signals\": 5",
	                                        "\"peak_m_s2\": 1, \"signals\": 1"),
	     id[17];
	service_submit(service, short_runs, id);
	const int quick = POUND_VALUES_QUICK / OF_ROW;
	while (status_number(service, id, "/progress") < 0.1)
		;
	struct answer answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 200);
	struct reading *result = answer_read(&answer);
	const double rows = reading_number(result, "/partial/rows"),
	             done = reading_number(result, "/partial/rows_done");
	assert_int_equal((int)rows, quick);
	assert_true(done > rows);
	assert_non_null(strstr(reading_text(result, "/partial/note"), "ask again"));
	assert_int_equal((int)values_asked(service), quick * OF_ROW);
	assert_true(quick * OF_ROW <= POUND_VALUES_QUICK);
	reading_close(result);
	double later = rows;
	while (later == rows) {
		answer_free(&answer);
		answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 200);
		result = answer_read(&answer);
		later = reading_number(result, "/partial/rows");
		if (later > rows)
			assert_true(later >= done && later == reading_number(result, "/partial/rows_done"));
		reading_close(result);
	}
	assert_true(later > rows); // not NaN: the study has not ended
	assert_int_equal((int)values_asked(service), quick * OF_ROW);
	answer_free(&answer);
	// the kept result may still be fresh, but the study goes on no more: it has to have all rows
	while (status_number(service, id, "/progress") * ROWS < later + MORE)
		;
	cancel(service, id);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 200);
	result = answer_read(&answer);
	const double last = reading_number(result, "/partial/rows");
	assert_true(last > later && last == reading_number(result, "/partial/rows_done"));
	reading_close(result);
	answer_free(&answer);
	check_report(
	    "the first results so far have %.0f of %.0f complete rows, later ones %.0f, the last ones %.0f", rows,
	    done, later, last);
	free(short_runs);
	free(study);
}

static void results_so_far_come_at_once_when_asked_for_again(void **state)
{
	(void)state;
	static char text[] = "a result";
	struct partial_results results = {.lock = PTHREAD_MUTEX_INITIALIZER};
	struct partial_result made = {.id = 7, .rows = 5, .body = text, .length = strlen(text)}, copy;
	assert_false(partial_results_take(&results, 7, &copy));
	assert_null(copy.body);
	partial_results_give(&results, &made, 10.0);
	assert_false(partial_results_take(&results, 8, &copy));
	assert_null(copy.body);
	assert_true(partial_results_take(&results, 7, &copy));
	assert_string_equal(copy.body, text);
	assert_int_equal(copy.length, strlen(text));
	assert_int_equal(copy.rows, 5);
	free(copy.body);
	// one of fewer rows does not replace it
	made.rows = 4;
	partial_results_give(&results, &made, 0.0);
	assert_true(partial_results_take(&results, 7, &copy));
	assert_int_equal(copy.rows, 5);
	free(copy.body);
	// a later result of the study does; here it is not fresh any more
	made.rows = 6;
	partial_results_give(&results, &made, -1.0);
	assert_false(partial_results_take(&results, 7, &copy));
	assert_int_equal(copy.rows, 6);
	free(copy.body);
	// the result that expires first is replaced
	for (int k = 0; k <= PARTIAL_RESULTS; k++) {
		made.id = 100 + k;
		partial_results_give(&results, &made, 10.0 + k);
	}
	assert_false(partial_results_take(&results, 100, &copy));
	assert_null(copy.body);
	for (int k = 1; k <= PARTIAL_RESULTS; k++) {
		assert_true(partial_results_take(&results, 100 + k, &copy));
		free(copy.body);
	}
	partial_results_free(&results);
}

static void a_study_without_a_row_has_no_results_yet(void **state)
{
	struct service *service = *state;
	// a row of half a million runs is not complete while the requests below are answered
	char *study = service_study(16, 100000, SEED), id[17];
	service_submit(service, study, id);
	struct answer answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 404);
	assert_true(atoi(answer.retry_after) > 0);
	assert_non_null(strstr(answer.body, "no row of the design is complete yet"));
	answer_free(&answer);
	answer = answer_of(service, "/v1/studies/%s/results?partial=perhaps", id, 400);
	answer_free(&answer);
	cancel(service, id);
	answer = answer_of(service, "/v1/studies/%s/results?partial=true", id, 409);
	answer_free(&answer);
	free(study);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(
    cmocka_unit_test(a_study_that_grows_has_the_same_bytes_for_any_number_of_workers),
    cmocka_unit_test(a_killed_study_that_grows_goes_on_to_the_same_bytes_without_running_stored_blocks_again),
    SERVED(the_status_of_a_study_that_grows_has_its_bound_and_then_what_it_took),
    cmocka_unit_test(samples_of_a_design_that_grew_are_all_of_them_or_an_error),
    SERVED(a_running_study_answers_with_the_indices_of_its_whole_rows),
    SERVED(a_cancelled_study_keeps_the_results_of_its_whole_rows),
    SERVED(the_first_results_so_far_of_a_large_study_are_made_of_few_rows),
    cmocka_unit_test(results_so_far_come_at_once_when_asked_for_again),
    SERVED(a_study_without_a_row_has_no_results_yet))
