/* Entity tags, and clients that wait for a study to change. */
#include <pthread.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/raw_http.h"

static struct answer conditional(const struct service *service, const char *path, const char *tags,
                                 const char *prefer)
{
	char header[256], preference[64];
	snprintf(header, sizeof header, "If-None-Match: %s", tags);
	snprintf(preference, sizeof preference, "Prefer: %s", prefer ? prefer : "");
	return service_ask(
	    service,
	    &(struct ask){.method = "GET", .path = path, .headers = {header, prefer ? preference : NULL}});
}

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void finished_study(const struct service *service, char id[17])
{
	char *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
}

static void every_form_of_a_known_tag_is_304_on_every_document(void **state)
{
	static const char *const documents[] = {
	    "", "/request", "/results", "/results?format=csv", "/samples", "/samples?format=npy"};
	static const struct {
		const char *form;
		int status;
	} forms[] = {{"%s", 304},        {"W/%s", 304},  {"\"x\", %s", 304}, {"*", 304},
	             {"%s, \"x\"", 304}, {"\"x\"", 200}, {"W/\"x\"", 200},   {"x%s", 200}};
	struct service *service = *state;
	char id[17], path[64], tags[160];
	finished_study(service, id);
	for (size_t d = 0; d < sizeof documents / sizeof documents[0]; d++) {
		snprintf(path, sizeof path, "/v1/studies/%s%s", id, documents[d]);
		struct answer first = service_get(service, "%s", path);
		assert_int_equal(first.status, 200);
		assert_int_equal(first.etag[0], '"');
		for (size_t f = 0; f < sizeof forms / sizeof forms[0]; f++) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
			snprintf(tags, sizeof tags, forms[f].form, first.etag);
#pragma GCC diagnostic pop
			struct answer answer = conditional(service, path, tags, NULL);
			if (answer.status != forms[f].status || (answer.status == 304 && answer.length > 0))
				fail_msg("%s with %s: %d", path, tags, answer.status);
			assert_string_equal(answer.etag, first.etag);
			answer_free(&answer);
		}
		answer_free(&first);
	}
	struct answer api = service_get(service, "/v1/openapi.json");
	struct answer same = conditional(service, "/v1/openapi.json", api.etag, NULL);
	assert_int_equal(same.status, 304);
	answer_free(&same);
	answer_free(&api);
}

/* Sends a raw request with If-None-Match; fails unless there is exactly one answer. */
static void asked(const struct service *service, const char *method, const char *path, const char *tags,
                  struct raw_answer *answer)
{
	char bytes[256];
	snprintf(bytes, sizeof bytes,
	         "%s %s HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nIf-None-Match: %s\r\n\r\n", method,
	         path, tags);
	raw_ask(service, bytes, strlen(bytes), 10, answer);
	assert_true(answer->closed);
	assert_int_equal(answer->n, 1);
}

static void a_304_has_no_body_and_no_other_length_than_that_of_the_200(void **state)
{
	static const char *const documents[] = {
	    "", "/request", "/results", "/results?format=csv", "/samples", "/samples?format=npy"};
	static const char length[] = "\r\nContent-Length: ";
	static struct raw_answer whole, known;
	struct service *service = *state;
	char id[17], path[64];
	finished_study(service, id);
	for (size_t d = 0; d <= sizeof documents / sizeof documents[0]; d++) {
		snprintf(path, sizeof path, "/v1/studies/%s%s", id, documents[d ? d - 1 : 0]);
		if (d == 0)
			strcpy(path, "/v1/openapi.json");
		asked(service, "HEAD", path, "\"x\"", &whole);
		asked(service, "GET", path, "*", &known);
		assert_int_equal(whole.status, 200);
		assert_int_equal(known.status, 304);
		const char *status = strstr(known.text, length), *right = strstr(whole.text, length);
		if (status && atoi(status + strlen(length)) != atoi(right + strlen(length)))
			fail_msg("%s: %s\n%s", path, whole.text, known.text);
		assert_null(strstr(known.text, "\r\nContent-Type:"));
		assert_null(strstr(known.text, "\r\nTransfer-Encoding:"));
		assert_string_equal(strstr(known.text, "\r\n\r\n"), "\r\n\r\n");
	}
}

static void a_connection_goes_on_after_a_304(void **state)
{
	static struct raw_answer answer;
	struct service *service = *state;
	char id[17], bytes[512];
	finished_study(service, id);
	snprintf(bytes, sizeof bytes,
	         "GET /v1/studies/%s HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: *\r\n\r\n"
	         "GET /v1/studies/%s/results HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: *\r\n\r\n"
	         "GET /version HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
	         id, id);
	raw_ask(service, bytes, strlen(bytes), 10, &answer);
	assert_true(answer.closed);
	assert_int_equal(answer.n, 3);
	assert_non_null(strstr(answer.text, "\"version\": "));
}

/* Samples that do not exist are a 409, never a 304. */
static void a_study_without_samples_is_409_whatever_tag_is_sent(void **state)
{
	static const char *const studies[] = {
	    "{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	    "{\"frequency_hz\": 3}], \"excitation\": {\"cycles\": 1, \"signals\": 1}}, "
	    "\"spectrum\": {\"frequencies_hz\": [1]}}"};
	struct service *service = *state;
	char id[17], path[64];
	finished_study(service, id);
	struct answer has = service_get(service, "/v1/studies/%s/samples", id);
	for (size_t i = 0; i < sizeof studies / sizeof studies[0]; i++) {
		service_submit(service, studies[i], id);
		assert_true(service_wait(service, id, "succeeded", 0));
		snprintf(path, sizeof path, "/v1/studies/%s/samples", id);
		const char *const tags[] = {"\"x\"", "*", has.etag};
		for (int t = 0; t < 3; t++) {
			struct answer answer = conditional(service, path, tags[t], NULL);
			if (answer.status != 409)
				fail_msg("%s with %s: %d", path, tags[t], answer.status);
			answer_free(&answer);
		}
	}
	service_histories(service, 1, id);
	snprintf(path, sizeof path, "/v1/studies/%s/samples", id);
	struct answer answer = conditional(service, path, has.etag, NULL);
	assert_int_equal(answer.status, 304);
	answer_free(&answer);
	answer_free(&has);
}

static void formats_of_one_result_have_tags_of_their_own(void **state)
{
	struct service *service = *state;
	char id[17];
	finished_study(service, id);
	struct answer json = service_get(service, "/v1/studies/%s/results", id);
	struct answer csv = service_get(service, "/v1/studies/%s/results?format=csv", id);
	assert_string_not_equal(json.etag, csv.etag);
	answer_free(&json);
	answer_free(&csv);
}

static void waiting_without_a_change_gets_304_when_the_time_is_over(void **state)
{
	struct service *service = *state;
	char id[17], path[64];
	finished_study(service, id);
	snprintf(path, sizeof path, "/v1/studies/%s", id);
	struct answer first = service_get(service, "%s", path);
	double start = now();
	struct answer answer = conditional(service, path, first.etag, "wait=1");
	assert_int_equal(answer.status, 304);
	assert_true(now() - start > 0.99);
	answer_free(&answer);
	// all Prefer headers of a request are read
	char tags[96];
	snprintf(tags, sizeof tags, "If-None-Match: %s", first.etag);
	start = now();
	answer =
	    service_ask(service, &(struct ask){.method = "GET",
	                                       .path = path,
	                                       .headers = {tags, "Prefer: respond-async", "Prefer: wait=1"}});
	assert_int_equal(answer.status, 304);
	assert_true(now() - start > 0.99);
	answer_free(&answer);
	// an unknown tag or no tag is answered at once with 200
	answer = conditional(service, path, "\"x\"", "wait=30");
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	answer =
	    service_ask(service, &(struct ask){.method = "GET", .path = path, .headers = {"Prefer: wait=30"}});
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	answer_free(&first);
}

static void more_seconds_than_there_are_are_the_most_there_are(void **state)
{
	static const char *const most[][2] = {{"POUNDD_WAIT_MAX", "1"}, {NULL}};
	static const char *const waits[] = {"wait=999999", "wait=9999999", "wait=99999999999999999999"};
	struct service *service = service_with(most, 1);
	char id[17], path[64];
	(void)state;
	finished_study(service, id);
	snprintf(path, sizeof path, "/v1/studies/%s", id);
	for (size_t i = 0; i < sizeof waits / sizeof waits[0]; i++) {
		double start = now();
		struct answer answer = conditional(service, path, "*", waits[i]);
		assert_int_equal(answer.status, 304);
		if (now() - start < 0.99)
			fail_msg("%s: %.3f s", waits[i], now() - start);
		answer_free(&answer);
	}
	service_free(service);
}

/* Submits a study behind as many long ones as run at a time, so that it stays queued until the test acts. */
static void queued_study(const struct service *service, char first[17], char second[17], char tag[64])
{
	enum { OPEN = 4 };
	char *study = service_study(20 * SERVICE_ROWS, 5, 1), *other = service_study(2, 1, 2);
	for (int i = 0; i < OPEN; i++) {
		service_submit(service, study, first);
		assert_true(service_wait(service, first, "running", 0));
	}
	service_submit(service, other, second);
	struct answer answer = service_get(service, "/v1/studies/%s", second);
	snprintf(tag, 64, "%s", answer.etag);
	answer_free(&answer);
	free(study);
	free(other);
}

enum { WAITERS = 50 };

struct waiter {
	const struct service *service;
	char path[64], tag[64];
	struct answer answer;
	double answered;
	pthread_t thread;
};

static void *wait_in_thread(void *of)
{
	struct waiter *waiter = of;
	waiter->answer = conditional(waiter->service, waiter->path, waiter->tag, "wait=30");
	waiter->answered = now();
	return NULL;
}

static void waiters_start(struct waiter waiters[WAITERS], const struct service *service, const char *id,
                          const char *tag)
{
	for (int i = 0; i < WAITERS; i++) {
		waiters[i] = (struct waiter){.service = service};
		snprintf(waiters[i].path, sizeof waiters[i].path, "/v1/studies/%s", id);
		snprintf(waiters[i].tag, sizeof waiters[i].tag, "%s", tag);
		assert_int_equal(pthread_create(&waiters[i].thread, NULL, wait_in_thread, &waiters[i]), 0);
	}
	// the metric shows when all of them wait: an open connection may not have sent its request yet
	static const char metric[] = "\npound_http_waiting ";
	double waiting = 0;
	while (waiting < WAITERS) {
		struct answer answer = service_get(service, "/metrics");
		waiting = atof(strstr(answer.body, metric) + strlen(metric));
		answer_free(&answer);
	}
}

static void a_waiting_client_is_answered_at_a_change(void **state)
{
	struct service *service = *state;
	static struct waiter waiters[WAITERS];
	char first[17], second[17], tag[64], path[64];
	queued_study(service, first, second, tag);
	waiters_start(waiters, service, second, tag);
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", second);
	struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	double changed = now(), latest = 0;
	for (int i = 0; i < WAITERS; i++) {
		pthread_join(waiters[i].thread, NULL);
		assert_int_equal(waiters[i].answer.status, 200);
		assert_non_null(strstr(waiters[i].answer.body, "\"cancelled\""));
		latest = waiters[i].answered - changed > latest ? waiters[i].answered - changed : latest;
		answer_free(&waiters[i].answer);
	}
	check_report("%d clients learned of a change, the last after %.0f ms", WAITERS, 1e3 * latest);
}

static void a_study_can_be_followed_to_its_end_by_waiting_alone(void **state)
{
	struct service *service = *state;
	char id[17], path[64], tag[64] = "\"none\"";
	char *study = service_study(SERVICE_ROWS, 5, 1);
	int changes = 0;
	double done = -1;
	service_submit(service, study, id);
	free(study);
	snprintf(path, sizeof path, "/v1/studies/%s", id);
	for (bool over = false; !over; changes++) {
		struct answer answer = conditional(service, path, tag, "wait=30");
		assert_int_equal(answer.status, 200);
		assert_string_not_equal(answer.etag, tag);
		struct reading *status = answer_read(&answer);
		assert_true(reading_number(status, "/runs_done") >= done);
		done = reading_number(status, "/runs_done");
		over = reading_text(status, "/finished") != NULL;
		snprintf(tag, sizeof tag, "%s", answer.etag);
		reading_close(status);
		answer_free(&answer);
	}
	assert_true(changes >= 3);
}

static void a_server_that_stops_answers_waiting_clients(void **state)
{
	struct service *service = *state;
	static struct waiter waiters[WAITERS];
	char first[17], second[17], tag[64];
	queued_study(service, first, second, tag);
	waiters_start(waiters, service, second, tag);
	service_stop(service);
	for (int i = 0; i < WAITERS; i++) {
		pthread_join(waiters[i].thread, NULL);
		assert_int_equal(waiters[i].answer.status, 503);
		assert_true(atoi(waiters[i].answer.retry_after) >= 1);
		answer_free(&waiters[i].answer);
	}
}

static void a_client_that_waits_and_goes_away_is_no_harm(void **state)
{
	struct service *service = *state;
	char first[17], second[17], tag[64], bytes[256];
	queued_study(service, first, second, tag);
	snprintf(bytes, sizeof bytes,
	         "GET /v1/studies/%s HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: %s\r\nPrefer: wait=1\r\n\r\n",
	         second, tag);
	for (int i = 0; i < 100; i++) {
		int s = raw_open(service);
		raw_send(s, bytes, strlen(bytes));
		close(s);
	}
	struct answer answer = service_get(service, "/livez");
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	service_stop(service);
}

/* Number of requests for samples answered with a status, as /metrics counts them. */
static int answered(const struct service *service, int status)
{
	char line[128];
	struct answer metrics = service_get(service, "/metrics");
	snprintf(line, sizeof line, "path=\"/v1/studies/{id}/samples\",code=\"%d\"} ", status);
	const char *found = strstr(metrics.body, line);
	int n = found ? atoi(found + strlen(line)) : 0;
	answer_free(&metrics);
	return n;
}

/* Two long answers are computed at a time; answers for clients that have disconnected must not delay other clients. */
static void ask_behind_who_has_gone(const struct service *service, const char *id)
{
	enum { GONE = 8 };
	char bytes[128];
	double before = now();
	struct answer whole = service_get(service, "/v1/studies/%s/samples", id);
	double one = now() - before;
	assert_int_equal(whole.status, 200);
	snprintf(bytes, sizeof bytes, "GET /v1/studies/%s/samples HTTP/1.1\r\nHost: localhost\r\n\r\n", id);
	int gone[GONE];
	for (int i = 0; i < GONE; i++) {
		gone[i] = raw_open(service);
		raw_send(gone[i], bytes, strlen(bytes));
	}
	usleep(50000);
	for (int i = 0; i < GONE; i++)
		close(gone[i]);
	before = now();
	struct answer again = service_get(service, "/v1/studies/%s/samples", id);
	double took = now() - before;
	check_report("an answer of %.2f s: behind those for %d clients who had gone, after %.2f s", one, GONE,
	             took);
	assert_true(took < 3 * one); // after the answers for all GONE clients: (GONE / 2 + 1) * one
	// some of the requests may not have been read
	assert_in_range(answered(service, 499), 1, GONE);
	assert_int_equal(answered(service, 200), 2);
	assert_int_equal(answered(service, 503), 0);
	assert_int_equal(again.status, 200);
	assert_int_equal(again.length, whole.length);
	assert_memory_equal(again.body, whole.body, whole.length);
	answer_free(&whole);
	answer_free(&again);
}

static void histories_for_a_client_who_has_gone_are_given_up(void **state)
{
	char id[17];
	service_histories(*state, SERVICE_ROWS / 60, id);
	ask_behind_who_has_gone(*state, id);
}

static void samples_for_a_client_who_has_gone_are_given_up(void **state)
{
	char *study = service_study(30 * SERVICE_ROWS, 1, 1), id[17];
	service_submit(*state, study, id);
	assert_true(service_wait(*state, id, "succeeded", 0));
	ask_behind_who_has_gone(*state, id);
	free(study);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(every_form_of_a_known_tag_is_304_on_every_document),
           SERVED(a_304_has_no_body_and_no_other_length_than_that_of_the_200),
           SERVED(a_connection_goes_on_after_a_304),
           SERVED(a_study_without_samples_is_409_whatever_tag_is_sent),
           SERVED(formats_of_one_result_have_tags_of_their_own),
           SERVED(waiting_without_a_change_gets_304_when_the_time_is_over),
           cmocka_unit_test(more_seconds_than_there_are_are_the_most_there_are),
           SERVED(a_waiting_client_is_answered_at_a_change),
           SERVED(a_study_can_be_followed_to_its_end_by_waiting_alone),
           SERVED(a_server_that_stops_answers_waiting_clients),
           SERVED(a_client_that_waits_and_goes_away_is_no_harm),
           SERVED(histories_for_a_client_who_has_gone_are_given_up),
           SERVED(samples_for_a_client_who_has_gone_are_given_up))
