/* Studies submitted as fast as they are accepted, until the queue is full; and one beyond all limits. */
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/latency.h"
#include "tests/support/raw_http.h"

enum { SUBMITTERS = 16, QUEUE_MAX = 10000 };

static struct submitter {
	const struct service *service;
	const char *study;
	double until;               /* [s] wall clock, or until a study is refused */
	struct latencies latencies; /* of accepted studies */
	int refused;                /* 503 with Retry-After */
	pthread_t thread;
} submitters[SUBMITTERS];

static void *submit_in_thread(void *of)
{
	struct submitter *submitter = of;
	char *bytes = NULL, answer[16384];
	int n = asprintf(&bytes,
	                 "POST /v1/studies HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
	                 "Content-Length: %zu\r\n\r\n%s",
	                 strlen(submitter->study), submitter->study);
	int s = raw_open(submitter->service);
	for (double start = latency_now(); start < submitter->until && !submitter->refused;
	     start = latency_now()) {
		raw_send(s, bytes, (size_t)n);
		ssize_t came = recv(s, answer, sizeof answer - 1, 0);
		answer[came > 0 ? came : 0] = '\0';
		if (!strncmp(answer, "HTTP/1.1 201", 12))
			latency_add(&submitter->latencies, start, latency_now());
		submitter->refused += !strncmp(answer, "HTTP/1.1 503", 12) && strstr(answer, "Retry-After: ");
	}
	close(s);
	free(bytes);
	return NULL;
}

/* Sixteen clients submit until a time, or until each was refused; returns the number of refusals. */
static int submit_all(const struct service *service, int rows, double until, struct latencies *all)
{
	char *study = service_study(rows, 1, 1);
	int refused = 0;
	for (int i = 0; i < SUBMITTERS; i++) {
		submitters[i] = (struct submitter){.service = service, .study = study, .until = until};
		assert_int_equal(pthread_create(&submitters[i].thread, NULL, submit_in_thread, &submitters[i]), 0);
	}
	for (int i = 0; i < SUBMITTERS; i++) {
		struct latencies *own = &submitters[i].latencies;
		pthread_join(submitters[i].thread, NULL);
		for (int k = 0; k < own->n; k++)
			latency_add(all, own->answers[k].asked, own->answers[k].came);
		free(own->answers);
		refused += submitters[i].refused;
	}
	free(study);
	return refused;
}

static void a_hundred_studies_a_second_are_accepted_from_sixteen_clients(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_QUEUE_MAX", "1000000"}, {NULL}};
	struct latencies all = {0};
	(void)state;
	struct service *service = service_with(settings, 2);
	double seconds = fmin(latency_soak_s(), 20);
	assert_int_equal(submit_all(service, 2, latency_now() + seconds, &all), 0);
	service_kill(service);
	int64_t kept = service_number(service, "SELECT count(*) FROM study");
	check_report("%d studies accepted from %d clients in %.0f s: %.0f a second; %d kept after kill -9", all.n,
	             SUBMITTERS, seconds, all.n / seconds, (int)kept);
	latency_report("  their answers", &all);
	assert_true(all.n >= 100 * seconds);
	assert_true(kept >= all.n && kept <= all.n + SUBMITTERS); // studies whose answer was still on its way
	free(all.answers);
	service_free(service);
}

static void ten_thousand_queued_studies_are_all_it_takes_until_it_has_run_some(void **state)
{
	struct service *service = *state;
	struct latencies all = {0};
	char *large = service_study(60000, 9, 1), *small = service_study(2, 1, 1), id[17], path[64];
	service_submit(service, large, id);
	assert_true(service_wait(service, id, "running", 0));
	// they arrive faster than they run, though short ones run before the large one
	assert_int_equal(submit_all(service, 1000, INFINITY, &all), SUBMITTERS);
	const int64_t queued = service_number(service, "SELECT count(*) FROM study WHERE status = 'queued'");
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), all.n + 1);
	// concurrent submissions may all check before one is added; a few studies have run since the first was refused
	assert_true(queued > QUEUE_MAX - QUEUE_MAX / 100 && queued < QUEUE_MAX + SUBMITTERS);
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", id);
	double start = latency_now();
	struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
	assert_int_equal(answer.status, 200);
	int refused = 0;
	for (answer_free(&answer); (answer = service_post(service, small)).status == 503; refused++) {
		assert_true(atoi(answer.retry_after) >= 1);
		sleep((unsigned)atoi(answer.retry_after));
		answer_free(&answer);
	}
	assert_int_equal(answer.status, 201);
	check_report("%d studies queued, then each of %d clients got 503; accepted again %.1f s after the "
	             "first could "
	             "run, got 503 %d times before",
	             (int)queued, SUBMITTERS, latency_now() - start, refused);
	answer_free(&answer);
	service_kill(service);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), all.n + 2);
	free(all.answers);
	free(large);
	free(small);
}

static void a_study_of_a_trillion_runs_is_refused_in_no_time_and_no_memory(void **state)
{
	// 10 samples per row for 8 inputs, 10^6 rows, 10^5 signals
	static const char *const paths[] = {
	    "contact/restitution",        "contact/stiffness_ratio",    "contact/gap_m",
	    "oscillators/0/frequency_hz", "oscillators/1/frequency_hz", "oscillators/0/mass_kg",
	    "oscillators/1/mass_kg",      "oscillators/0/damping_ratio"};
	char study[2048],
	    *end = stpcpy(study, "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": "
	                         "[{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], "
	                         "\"excitation\": {\"signals\": 100000}}, \"design\": {\"rows\": 1000000}, "
	                         "\"inputs\": [");
	for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++)
		end += sprintf(
		    end,
		    "%s{\"path\": \"/%s\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.1, \"max\": 0.9}}",
		    i ? ", " : "", paths[i]);
	strcpy(end, "]}");
	struct service *service = *state;
	struct latencies all = {0};
	double before = service_resident_mb(service);
	for (int i = 0; i < 1000; i++) {
		double start = latency_now();
		struct answer answer = service_post(service, study);
		latency_add(&all, start, latency_now());
		assert_int_equal(answer.status, 422);
		if (!strstr(answer.body, "1000000000000 pounding runs"))
			fail_msg("not refused for its runs: %s", answer.body);
		answer_free(&answer);
	}
	latency_report("a study of 1e12 runs refused", &all);
	double grown = service_resident_mb(service) - before;
	check_report("  resident memory grew by %.1f MB", grown);
	assert_true(latency_quantile(&all, 0.99) < 50);
	assert_true(grown < 8);
	free(all.answers);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(cmocka_unit_test(a_hundred_studies_a_second_are_accepted_from_sixteen_clients),
           SERVED(a_study_of_a_trillion_runs_is_refused_in_no_time_and_no_memory),
           SERVED(ten_thousand_queued_studies_are_all_it_takes_until_it_has_run_some))
