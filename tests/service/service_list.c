/* The list of studies: its order, pages and filters. */
#include <string.h>

#include "schema/json/json_pointer.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

static void status_is(struct answer *answer, int status)
{
	if (answer->status != status)
		fail_msg("%d instead of %d: %s", answer->status, status, answer->body);
}

/* Fails unless an answer is a problem with this status and with `words` in its detail; frees the answer. */
static void problem_is(struct answer answer, int status, const char *words)
{
	status_is(&answer, status);
	struct reading *problem = answer_read(&answer);
	assert_string_equal(answer.type, "application/problem+json");
	assert_int_equal((int)reading_number(problem, "/status"), status);
	assert_true(reading_text(problem, "/type") && reading_text(problem, "/title"));
	const char *detail = reading_text(problem, "/detail");
	if (!detail || !strstr(detail, words))
		fail_msg("the detail '%s' does not have '%s'", detail, words);
	reading_close(problem);
	answer_free(&answer);
}

static void the_list_is_newest_first_and_pages_by_cursor(void **state)
{
	enum { N = 5 };
	struct service *service = *state;
	char ids[N][17];
	for (int i = 0; i < N; i++) {
		char *study = service_study(2, 1, i);
		service_submit(service, study, ids[i]);
		free(study);
	}
	char path[128] = "/v1/studies?limit=2";
	int seen = 0;
	while (path[0]) {
		struct answer answer = service_get(service, "%s", path);
		status_is(&answer, 200);
		struct reading *page = answer_read(&answer);
		int n = reading_count(page, "/studies");
		assert_int_equal(n, seen < 4 ? 2 : 1);
		for (int i = 0; i < n; i++, seen++)
			assert_string_equal(reading_text(page, "/studies/%d/id", i), ids[N - 1 - seen]);
		const char *next = reading_text(page, "/next");
		path[0] = '\0';
		if (next)
			snprintf(path, sizeof path, "/v1/studies?limit=2&cursor=%s", next);
		reading_close(page);
		answer_free(&answer);
	}
	assert_int_equal(seen, N);
	for (int i = 0; i < N; i++)
		assert_true(service_wait(service, ids[i], "succeeded", 0));
	struct answer answer = service_get(service, "/v1/studies?status=succeeded");
	struct reading *page = answer_read(&answer);
	assert_int_equal(reading_count(page, "/studies"), N);
	assert_null(reading_text(page, "/next"));
	reading_close(page);
	answer_free(&answer);
	answer = service_get(service, "/v1/studies?status=failed");
	page = answer_read(&answer);
	assert_int_equal(reading_count(page, "/studies"), 0);
	reading_close(page);
	answer_free(&answer);
}

/* Fails unless a list has this study only. */
static void list_is_one(const struct service *service, const char *arguments, const char *id)
{
	struct answer answer = service_get(service, "/v1/studies?%s", arguments);
	status_is(&answer, 200);
	struct reading *page = answer_read(&answer);
	assert_int_equal(reading_count(page, "/studies"), 1);
	assert_string_equal(reading_text(page, "/studies/0/id"), id);
	reading_close(page);
	answer_free(&answer);
}

static void the_list_finds_studies_by_their_names_and_by_what_they_mean(void **state)
{
	struct service *service = *state;
	char ids[2][17], arguments[96];
	char *studies[2];
	for (int i = 0; i < 2; i++) {
		char *plain = service_study(2, 1, i + 1);
		studies[i] = study_documents_with(plain, i ? "study 2" : "study 1", i ? "bridge" : "tower & 100 %");
		service_submit(service, studies[i], ids[i]);
		free(plain);
	}
	list_is_one(service, "name=tow", ids[0]);
	list_is_one(service, "name=%26%20100%20%25", ids[0]);
	list_is_one(service, "name=bri", ids[1]);
	// validate_only gives the hash of a study before it is submitted
	struct answer answer = service_ask(service, &(struct ask){.method = "POST",
	                                                          .path = "/v1/studies?validate_only=true",
	                                                          .headers = {"Content-Type: application/json"},
	                                                          .body = studies[1],
	                                                          .length = strlen(studies[1])});
	struct reading *estimate = answer_read(&answer);
	snprintf(arguments, sizeof arguments, "hash=%s", reading_text(estimate, "/study_hash"));
	list_is_one(service, arguments, ids[1]);
	reading_close(estimate);
	answer_free(&answer);
	assert_true(service_wait(service, ids[1], "succeeded", 0));
	answer = service_get(service, "/v1/studies/%s/results", ids[1]);
	struct reading *result = answer_read(&answer);
	assert_string_equal(reading_text(result, "/study_hash"), arguments + strlen("hash="));
	reading_close(result);
	answer_free(&answer);
	free(studies[0]), free(studies[1]);
}

static void list_arguments_that_make_no_sense_are_400(void **state)
{
	static const char *const arguments[] = {"limit=0",    "limit=101",
	                                        "limit=1x",   "status=new",
	                                        "cursor=1",   "cursor=%27",
	                                        "limit=+",    "limit=99999999999999999999",
	                                        "status=%20", "status=&status=queued",
	                                        "hash=abc",   "hash=0123456789abcdef"};
	struct service *service = *state;
	for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++)
		problem_is(service_get(service, "/v1/studies?%s", arguments[i]), 400,
		           strchr(arguments[i], '&') ? "occurs more than once" : "must be");
	problem_is(service_get(service, "/v1/studies?limit=101"), 400,
	           "limit must be a whole number in [1, 100]");
	problem_is(service_get(service, "/v1/studies/0123456789abcdef/results?format="), 400, "must be");
}

/* Variables of scripts may be empty: empty arguments are ignored. */
static void list_arguments_that_are_empty_are_as_if_they_were_not_there(void **state)
{
	static const char *const arguments[] = {
	    "status=&limit=&cursor=", "status=",    "limit=", "cursor=", "cursor",
	    "limit=&status=queued",   "name=&hash="};
	struct service *service = *state;
	for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++) {
		struct answer answer = service_get(service, "/v1/studies?%s", arguments[i]);
		status_is(&answer, 200);
		answer_free(&answer);
	}
	char *study = service_study(2, 1, 1), id[17];
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer all = service_get(service, "/v1/studies?status=&limit=1&cursor=");
	struct reading *page = answer_read(&all);
	assert_string_equal(reading_text(page, "/studies/0/id"), id);
	reading_close(page);
	answer_free(&all);
	free(study);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(the_list_is_newest_first_and_pages_by_cursor),
           SERVED(the_list_finds_studies_by_their_names_and_by_what_they_mean),
           SERVED(list_arguments_that_make_no_sense_are_400),
           SERVED(list_arguments_that_are_empty_are_as_if_they_were_not_there))
