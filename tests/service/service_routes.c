/* Every route and status of a real server.  The server must keep running, and stop cleanly after each test. */
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "schema/http/api.h"
#include "schema/json/json_pointer.h"
#include "tests/support/latency.h"
#include "tests/support/service.h"

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

static void stored_studies_are(const struct service *service, int n)
{
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), n);
}

static void a_posted_study_is_answered_with_201_its_location_and_its_status(void **state)
{
	struct service *service = *state;
	char *study = service_study(4, 2, 1);
	struct answer created = service_post(service, study);
	status_is(&created, 201);
	assert_string_equal(created.type, "application/json");
	char location[64];
	struct reading *status = answer_read(&created);
	snprintf(location, sizeof location, "/v1/studies/%s", reading_text(status, "/id"));
	assert_string_equal(created.location, location);
	assert_string_equal(reading_text(status, "/links/self"), location);
	assert_string_equal(reading_text(status, "/name"), "study 1");
	assert_string_equal(reading_text(status, "/kind"), "sensitivity");
	assert_string_equal(reading_text(status, "/status"), "queued");
	assert_int_equal((int)reading_number(status, "/runs_total"), 4 * 5 * 2);
	assert_int_equal((int)reading_number(status, "/runs_done"), 0);
	assert_int_equal(strlen(reading_text(status, "/created")), strlen("2026-01-01T00:00:00.000Z"));
	assert_true(!reading_text(status, "/started") && !reading_text(status, "/error"));
	reading_close(status);
	answer_free(&created);
	free(study);
}

static void a_finished_study_has_times_in_order_and_all_runs_done(void **state)
{
	struct service *service = *state;
	char id[17];
	char *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer answer = service_get(service, "/v1/studies/%s", id);
	struct reading *status = answer_read(&answer);
	assert_true(strcmp(reading_text(status, "/created"), reading_text(status, "/started")) <= 0);
	assert_true(strcmp(reading_text(status, "/started"), reading_text(status, "/finished")) <= 0);
	check_near(reading_number(status, "/progress"), 1, 0);
	check_near(reading_number(status, "/runs_done"), reading_number(status, "/runs_total"), 0);
	assert_int_equal(service_number(service, "SELECT sum(runs) FROM block"), 4 * 5 * 2);
	reading_close(status);
	answer_free(&answer);
	free(study);
}

static void the_request_comes_back_byte_for_byte(void **state)
{
	struct service *service = *state;
	char id[17];
	char *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	struct answer answer = service_get(service, "/v1/studies/%s/request", id);
	status_is(&answer, 200);
	assert_string_equal(answer.type, "application/json");
	assert_string_equal(answer.body, study);
	answer_free(&answer);
	free(study);
}

static void malformed_json_is_400_with_line_and_column(void **state)
{
	struct service *service = *state;
	struct answer answer = service_post(service, "{\"kind\": \"response\",\n \"scene\": }");
	status_is(&answer, 400);
	struct reading *problem = answer_read(&answer);
	assert_string_equal(answer.type, "application/problem+json");
	assert_non_null(strstr(answer.body, "line 2, column 11"));
	reading_close(problem);
	answer_free(&answer);
	problem_is(service_post(service, ""), 400, "");
	stored_studies_are(service, 0);
}

static void every_fault_of_a_study_is_listed_with_its_pointer(void **state)
{
	struct service *service = *state;
	struct answer answer = service_post(
	    service, "{\"kind\": \"response\", \"scene\": {\"oscilators\": [],"
	             "\"oscillators\": [{\"frequency_hz\": -2}, {\"frequency_hz\": 3, \"mass_kg\": \"one\"}],"
	             "\"contact\": {\"restitution\": 1.4}}}");
	status_is(&answer, 422);
	assert_string_equal(answer.type, "application/problem+json");
	static const char *const pointers[] = {"/scene/oscilators", "/scene/oscillators/0/frequency_hz",
	                                       "/scene/oscillators/1/mass_kg", "/scene/contact/restitution"};
	struct reading *problem = answer_read(&answer);
	int n = reading_count(problem, "/errors");
	for (size_t p = 0; p < sizeof pointers / sizeof pointers[0]; p++) {
		bool listed = false;
		for (int i = 0; i < n; i++)
			listed = listed || !strcmp(reading_text(problem, "/errors/%d/pointer", i), pointers[p]);
		if (!listed)
			fail_msg("%s is not listed: %s", pointers[p], answer.body);
	}
	reading_close(problem);
	answer_free(&answer);
	stored_studies_are(service, 0);
}

static void a_body_over_one_mebibyte_is_413(void **state)
{
	struct service *service = *state;
	size_t limit = 1 << 20;
	char *body = malloc(3 * limit);
	struct ask ask = {.method = "POST",
	                  .path = "/v1/studies",
	                  .headers = {"Content-Type: application/json", "Expect:"},
	                  .body = body};
	assert_non_null(body);
	memset(body, ' ', 3 * limit);
	// spaces are not JSON: a body within the limit is malformed
	ask.length = limit;
	problem_is(service_ask(service, &ask), 400, "");
	ask.length = limit + 1;
	problem_is(service_ask(service, &ask), 413, "1 MiB");
	ask.length = 3 * limit;
	problem_is(service_ask(service, &ask), 413, "1 MiB");
	ask.headers[1] = "Expect: 100-continue";
	problem_is(service_ask(service, &ask), 413, "1 MiB");
	stored_studies_are(service, 0);
	free(body);
}

static void a_study_that_is_not_declared_as_json_is_415(void **state)
{
	static const char *const types[] = {"Content-Type: text/plain",
	                                    "Content-Type: application/x-www-form-urlencoded",
	                                    "Content-Type: application/jsonx", "Content-Type:"};
	struct service *service = *state;
	char *study = service_study(4, 2, 1);
	struct ask ask = {.method = "POST", .path = "/v1/studies", .body = study, .length = strlen(study)};
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
		ask.headers[0] = types[i];
		problem_is(service_ask(service, &ask), 415, "application/json");
	}
	stored_studies_are(service, 0);
	ask.headers[0] = "content-type: Application/JSON; charset=utf-8";
	struct answer answer = service_ask(service, &ask);
	status_is(&answer, 201);
	answer_free(&answer);
	free(study);
}

static void every_route_answers_only_its_methods(void **state)
{
	static const char *const methods[] = {"GET", "POST", "DELETE", "PUT", "PATCH", "OPTIONS", "BREW"};
	struct service *service = *state;
	for (int o = 0; o < API_N_OPERATIONS; o++) {
		char path[128], allow[64];
		const char *form = api_operations[o].path, *id = strstr(form, "{id}"),
		           *hash = strstr(form, "{sha256}");
		long long number;
		snprintf(path, sizeof path, "%.*s%s%s",
		         (int)(id     ? id - form
		               : hash ? hash - form
		                      : (long)strlen(form)),
		         form, id || hash ? "0123456789abcdef" : "", id ? id + 4 : "");
		for (int more = 0; hash && more < 3; more++)
			strcat(path, "0123456789abcdef");
		char *named = strstr(path, "{name}");
		if (named)
			strcpy(named, "swept");
		api_match("GET", path, &number, allow);
		for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
			if (strstr(allow, methods[m]))
				continue;
			struct answer answer = service_ask(service, &(struct ask){.method = methods[m], .path = path});
			assert_string_equal(answer.allow, allow);
			problem_is(answer, 405, "method");
		}
	}
	struct answer answer =
	    service_ask(service, &(struct ask){.method = "PUT", .path = "/v1/studies/0123456789abcdef"});
	assert_string_equal(answer.allow, "GET, HEAD, DELETE");
	answer_free(&answer);
}

static void head_is_get_without_the_body(void **state)
{
	struct service *service = *state;
	struct answer answer = service_ask(service, &(struct ask){.method = "HEAD", .path = "/version"});
	status_is(&answer, 200);
	assert_string_equal(answer.type, "application/json");
	assert_int_equal(answer.length, 0);
	answer_free(&answer);
}

static void unknown_paths_and_studies_are_404(void **state)
{
	static const char *const paths[] = {
	    "/index.html",
	    "/v1",
	    "/v1/studies/",
	    "/v1/studies/1",
	    "/v1/studies/0123456789abcde",
	    "/v1/studies/0123456789ABCDEF",
	    "/v1/studies/0123456789abcdef0",
	    "/v1/studies/ffffffffffffffff",
	    "/v1/studies/0123456789abcdef",
	    "/v1/studies/0123456789abcdef/",
	    "/v1/studies/0123456789abcdef/request",
	    "/v1/studies/0123456789abcdef/results",
	    "/v1/studies/0123456789abcdef/samples",
	    "/v1/studies/0123456789abcdef/result",
	    "/v1/studies/0123456789abcdef/request/more",
	    "/v1/studies/'%20OR%20'1'='1",
	    "/../../etc/passwd",
	    "/%2e%2e/%2e%2e/etc/passwd",
	};
	struct service *service = *state;
	for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++)
		problem_is(service_get(service, "%s", paths[i]), 404, "no such");
	problem_is(
	    service_ask(service, &(struct ask){.method = "POST", .path = "/v1/studies/0123456789abcdef/cancel"}),
	    404, "no such study");
	problem_is(
	    service_ask(service, &(struct ask){.method = "DELETE", .path = "/v1/studies/0123456789abcdef"}), 404,
	    "no such study");
}

static void validate_only_reports_the_cost_and_stores_nothing(void **state)
{
	struct service *service = *state;
	char *study = service_study(4, 2, 1);
	struct ask ask = {.method = "POST",
	                  .path = "/v1/studies?validate_only=true",
	                  .headers = {"Content-Type: application/json"},
	                  .body = study,
	                  .length = strlen(study)};
	struct answer answer = service_ask(service, &ask);
	status_is(&answer, 200);
	struct reading *cost = answer_read(&answer);
	assert_int_equal((int)reading_number(cost, "/runs_total"), 4 * 5 * 2);
	assert_true(reading_number(cost, "/estimated_cpu_s") > 0);
	assert_true(reading_number(cost, "/estimated_bytes") > 0);
	reading_close(cost);
	answer_free(&answer);
	ask.body = "{\"kind\": \"response\"}";
	ask.length = strlen(ask.body);
	problem_is(service_ask(service, &ask), 422, "");
	ask.path = "/v1/studies?validate_only=maybe";
	problem_is(service_ask(service, &ask), 400, "validate_only");
	stored_studies_are(service, 0);
	free(study);
}

static void results_are_404_with_retry_after_until_they_are_there(void **state)
{
	struct service *service = *state;
	char first[17], second[17];
	char *study = service_study(SERVICE_ROWS, 5, 1);
	char *short_study = service_study(2, 1, 1);
	service_submit(service, study, first);
	service_submit(service, short_study, second);
	static const char *const documents[] = {"results", "samples"};
	for (int i = 0; i < 2; i++) {
		struct answer answer = service_get(service, "/v1/studies/%s/%s", second, documents[i]);
		assert_true(atoi(answer.retry_after) >= 1);
		problem_is(answer, 404, "not finished");
	}
	assert_true(service_wait(service, second, "succeeded", 0));
	for (int i = 0; i < 2; i++) {
		struct answer answer = service_get(service, "/v1/studies/%s/%s", second, documents[i]);
		status_is(&answer, 200);
		answer_free(&answer);
	}
	free(study);
	free(short_study);
}

static struct answer finished(struct service *service, const char *document, const char *accept, char id[17])
{
	char path[64], header[64];
	char *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	free(study);
	assert_true(service_wait(service, id, "succeeded", 0));
	snprintf(path, sizeof path, "/v1/studies/%s/%s", id, document);
	snprintf(header, sizeof header, "Accept: %s", accept);
	return service_ask(service, &(struct ask){.method = "GET", .path = path, .headers = {header}});
}

static void results_come_as_json_or_csv(void **state)
{
	struct service *service = *state;
	char id[17];
	struct answer by_accept = finished(service, "results", "text/csv", id);
	struct answer by_name = service_get(service, "/v1/studies/%s/results?format=csv", id);
	struct answer json = service_get(service, "/v1/studies/%s/results", id);
	status_is(&by_accept, 200);
	assert_string_equal(by_accept.type, "text/csv");
	assert_string_equal(by_name.type, "text/csv");
	assert_string_equal(by_accept.body, by_name.body);
	assert_string_equal(json.type, "application/json");
	struct reading *result = answer_read(&json);
	assert_string_equal(reading_text(result, "/cells/0/outputs/0/name"), "force_amplification");
	assert_int_equal(reading_count(result, "/cells/0/outputs/0/inputs"), 3);
	assert_int_equal((int)reading_number(result, "/timing/threads"), 2);
	assert_true(reading_number(result, "/timing/cpu_s") > 0);
	reading_close(result);
	answer_free(&json);
	answer_free(&by_name);
	answer_free(&by_accept);
	problem_is(service_get(service, "/v1/studies/%s/results?format=xml", id), 400, "format must be");
}

/* Requests a path N times on one connection after the other; reports the number of answers per second. */
static void rate(const struct service *service, const char *path)
{
	enum { N = 1000 };
	struct answer first = service_get(service, "%s", path);
	status_is(&first, 200);
	double start = latency_now();
	for (int i = 0; i < N; i++) {
		struct answer answer = service_get(service, "%s", path);
		assert_int_equal(answer.length, first.length);
		assert_memory_equal(answer.body, first.body, first.length);
		answer_free(&answer);
	}
	double a_second = N / (latency_now() - start);
	check_report("%.*s of %zu bytes: %.0f a second", (int)strcspn(path + 12, "0123456789?") + 12, path,
	             first.length, a_second);
	if (check_soaks())
		assert_true(a_second >= 2000);
	answer_free(&first);
}

static void an_answer_is_kept_until_what_it_is_about_changes(void **state)
{
	struct service *service = *state;
	char id[17], other[17], path[80];
	struct answer csv = finished(service, "results", "text/csv", id);
	struct answer page = service_get(service, "/v1/studies?limit=100");
	char *study = service_study(2, 1, 1);
	assert_null(strstr(page.body, "\"next\": \""));
	snprintf(path, sizeof path, "/v1/studies/%s/results?format=csv", id);
	rate(service, path);
	rate(service, "/v1/studies?limit=100");
	// the same path is answered in the requested media type
	struct answer json = service_get(service, "/v1/studies/%s/results", id);
	struct answer again = service_ask(
	    service, &(struct ask){.method = "GET", .path = strtok(path, "?"), .headers = {"Accept: text/csv"}});
	assert_string_equal(json.type, "application/json");
	assert_string_equal(again.type, "text/csv");
	assert_string_equal(again.body, csv.body);
	answer_free(&json);
	answer_free(&again);
	// the list changes when a study is added, ends and is deleted
	service_submit(service, study, other);
	again = service_get(service, "/v1/studies?limit=100");
	assert_non_null(strstr(again.body, other));
	answer_free(&again);
	assert_true(service_wait(service, other, "succeeded", 0));
	again = service_get(service, "/v1/studies?limit=100");
	assert_null(strstr(again.body, "queued"));
	assert_null(strstr(again.body, "running"));
	answer_free(&again);
	*strrchr(path, '/') = '\0';
	struct answer gone = service_ask(service, &(struct ask){.method = "DELETE", .path = path});
	assert_int_equal(gone.status, 204);
	answer_free(&gone);
	again = service_get(service, "/v1/studies?limit=100");
	assert_null(strstr(again.body, id));
	answer_free(&again);
	problem_is(service_get(service, "/v1/studies/%s/results?format=csv", id), 404, "no such study");
	problem_is(service_get(service, "/v1/studies/%s", id), 404, "no such study");
	answer_free(&csv);
	answer_free(&page);
	free(study);
}

static void samples_come_as_csv_or_npy_with_a_row_per_run(void **state)
{
	struct service *service = *state;
	char id[17];
	struct answer csv = finished(service, "samples", "*/*", id);
	int lines = 0;
	status_is(&csv, 200);
	assert_string_equal(csv.type, "text/csv");
	for (size_t i = 0; i < csv.length; i++)
		lines += csv.body[i] == '\n';
	assert_int_equal(lines, 1 + 4 * 5);
	answer_free(&csv);
	struct answer npy = service_get(service, "/v1/studies/%s/samples?format=npy", id);
	status_is(&npy, 200);
	assert_string_equal(npy.type, "application/octet-stream");
	assert_true(npy.length > 6 && !memcmp(npy.body, "\x93NUMPY", 6));
	answer_free(&npy);
	problem_is(service_get(service, "/v1/studies/%s/samples?format=json", id), 400, "format must be");
}

static void the_form_that_alone_is_named_comes_or_the_first(void **state)
{
	static const struct {
		const char *document, *accept, *type;
	} cases[] = {
	    {"results", "text/csv;q=0.9", "text/csv"},
	    {"results", "text/csv, */*;q=0.5", "text/csv"},
	    {"results", "text/csv, application/json", "application/json"},
	    {"results", "text/*", "application/json"},
	    {"results", "image/png", "application/json"},
	    {"results", "text/csv ", "text/csv"},
	    {"samples", "application/octet-stream", "application/octet-stream"},
	    {"samples", "application/octet-stream, text/csv", "text/csv"},
	    {"samples", "*/*", "text/csv"},
	};
	struct service *service = *state;
	char id[17], path[64], header[96];
	struct answer answer = finished(service, "results", "text/html, */*;q=0.8", id);
	assert_string_equal(answer.type, "application/json");
	answer_free(&answer);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		snprintf(path, sizeof path, "/v1/studies/%s/%s", id, cases[i].document);
		snprintf(header, sizeof header, "Accept: %s", cases[i].accept);
		answer = service_ask(service, &(struct ask){.method = "GET", .path = path, .headers = {header}});
		status_is(&answer, 200);
		if (strcmp(answer.type, cases[i].type) != 0)
			fail_msg("%s, %s: %s", path, header, answer.type);
		answer_free(&answer);
	}
}

struct asker {
	pthread_t thread;
	const struct service *service;
	const char *id, *what;
	struct answer answer;
	atomic_int *left;
};

static void *ask_for(void *of)
{
	struct asker *asker = of;
	asker->answer = service_get(asker->service, "/v1/studies/%s/%s", asker->id, asker->what);
	--*asker->left;
	return NULL;
}

static void ask_at_once(struct asker *askers, int n, struct asker asker)
{
	for (int i = 0; i < n; i++) {
		askers[i] = asker;
		assert_int_equal(pthread_create(&askers[i].thread, NULL, ask_for, &askers[i]), 0);
	}
}

/* Waits for all answers; fails unless they are equal. */
static void join_askers(struct asker *askers, int n)
{
	for (int i = 0; i < n; i++) {
		pthread_join(askers[i].thread, NULL);
		status_is(&askers[i].answer, 200);
		assert_string_equal(askers[i].answer.body, askers[0].answer.body);
	}
	for (int i = 0; i < n; i++)
		answer_free(&askers[i].answer);
}

static void samples_asked_for_by_many_at_once_are_the_same_for_all(void **state)
{
	enum { ASKERS = 12 };
	struct service *service = *state;
	struct asker askers[ASKERS];
	atomic_int left = ASKERS;
	char id[17], *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	ask_at_once(askers, ASKERS,
	            (struct asker){.service = service, .id = id, .what = "samples", .left = &left});
	join_askers(askers, ASKERS);
	free(study);
}

static void others_are_answered_while_large_results_become_csv(void **state)
{
	static const char study[] = "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": "
	                            "2}, {\"frequency_hz\": 3.1}], "
	                            "\"excitation\": {\"type\": \"white_noise\", \"duration_s\": 0.1, "
	                            "\"time_step_s\": 0.02, \"signals\": 4000}}}";
	enum { ASKERS = 12 };
	struct service *service = *state;
	struct asker askers[ASKERS];
	atomic_int left = ASKERS;
	int others = 0;
	char id[17];
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	ask_at_once(askers, ASKERS,
	            (struct asker){.service = service, .id = id, .what = "results?format=csv", .left = &left});
	while (left > 0) {
		struct answer answer = service_get(service, "/livez");
		status_is(&answer, 200);
		answer_free(&answer);
		others++;
	}
	join_askers(askers, ASKERS);
	// if others waited for the results, only a few would be answered per result
	check_report("%d results of 4,000 signals as CSV: %d others were answered meanwhile", ASKERS, others);
	assert_true(others > 5 * ASKERS);
}

static void spectra_without_histories_have_no_samples_and_the_server_lives_on(void **state)
{
	struct service *service = *state;
	char id[17];
	service_submit(service,
	               "{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	               "{\"frequency_hz\": 3}]}}",
	               id);
	assert_true(service_wait(service, id, "succeeded", 0));
	problem_is(service_get(service, "/v1/studies/%s/samples", id), 409,
	           "samples exist only for sensitivity studies");
}

static void an_unchanged_status_is_304_to_its_etag(void **state)
{
	struct service *service = *state;
	char id[17], path[64], known[128];
	char *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	free(study);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer answer = service_get(service, "/v1/studies/%s", id);
	snprintf(path, sizeof path, "/v1/studies/%s", id);
	snprintf(known, sizeof known, "If-None-Match: %s", answer.etag);
	answer_free(&answer);
	answer = service_ask(service, &(struct ask){.method = "GET", .path = path, .headers = {known}});
	status_is(&answer, 304);
	assert_int_equal(answer.length, 0);
	answer_free(&answer);
	answer = service_ask(service,
	                     &(struct ask){.method = "GET", .path = path, .headers = {"If-None-Match: \"old\""}});
	status_is(&answer, 200);
	answer_free(&answer);
}

static void a_live_and_ready_server_says_so_and_its_version(void **state)
{
	struct service *service = *state;
	static const char *const paths[] = {"/livez", "/readyz", "/version"};
	for (int i = 0; i < 3; i++) {
		struct answer answer = service_get(service, "%s", paths[i]);
		status_is(&answer, 200);
		reading_close(answer_read(&answer));
		answer_free(&answer);
	}
}

static void a_path_with_a_newline_is_one_line_of_the_log(void **state)
{
	struct service *service = *state;
	char line[1024], path[2048];
	bool found = false, cut = false;
	problem_is(service_get(service, "/first%%0Asecond%%1b%%9b%%c2%%9b"), 404, "no such path");
	snprintf(path, sizeof path, "/long%02000d", 0);
	problem_is(service_ask(service, &(struct ask){.method = "GET", .path = path}), 404, "no such path");
	service_stop(service);
	FILE *log = fopen(service->log, "r");
	assert_non_null(log);
	while (fgets(line, sizeof line, log)) {
		found = found || strstr(line, "/first?second???? 404");
		cut = cut || (strstr(line, "/long000") && strstr(line, "0 404 "));
	}
	fclose(log);
	assert_true(found && cut);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(a_posted_study_is_answered_with_201_its_location_and_its_status),
           SERVED(a_finished_study_has_times_in_order_and_all_runs_done),
           SERVED(the_request_comes_back_byte_for_byte), SERVED(malformed_json_is_400_with_line_and_column),
           SERVED(every_fault_of_a_study_is_listed_with_its_pointer), SERVED(a_body_over_one_mebibyte_is_413),
           SERVED(a_study_that_is_not_declared_as_json_is_415), SERVED(every_route_answers_only_its_methods),
           SERVED(head_is_get_without_the_body), SERVED(unknown_paths_and_studies_are_404),
           SERVED(validate_only_reports_the_cost_and_stores_nothing),
           SERVED(results_are_404_with_retry_after_until_they_are_there), SERVED(results_come_as_json_or_csv),
           SERVED(an_answer_is_kept_until_what_it_is_about_changes),
           SERVED(samples_come_as_csv_or_npy_with_a_row_per_run),
           SERVED(the_form_that_alone_is_named_comes_or_the_first),
           SERVED(samples_asked_for_by_many_at_once_are_the_same_for_all),
           SERVED(others_are_answered_while_large_results_become_csv),
           SERVED(spectra_without_histories_have_no_samples_and_the_server_lives_on),
           SERVED(an_unchanged_status_is_304_to_its_etag),
           SERVED(a_live_and_ready_server_says_so_and_its_version),
           SERVED(a_path_with_a_newline_is_one_line_of_the_log))
