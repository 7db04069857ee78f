/* Shares: limits for many connections of one client, and how others are served meanwhile. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/latency.h"
#include "tests/support/raw_http.h"

#define HOST "Host: localhost\r\n"

static const char MANY_LONG[] =
    "too many slow answers are being prepared, for this client or in all; please try again";

static void pause_ms(int ms)
{
	nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L}, NULL);
}

static void finished_study(const struct service *service, char id[17])
{
	char *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
}

static void open_many(const struct service *service, const char *bytes, int *sockets, int n)
{
	for (int i = 0; i < n; i++) {
		sockets[i] = raw_open(service);
		raw_send(sockets[i], bytes, strlen(bytes));
	}
}

static void close_many(const int *sockets, int n)
{
	for (int i = 0; i < n; i++)
		close(sockets[i]);
}

/* Number of connections answered with a status and a text within `seconds`; fails on any other answer. */
static int answered(const int *sockets, int n, int status, const char *detail, double seconds)
{
	int counted = 0;
	static struct raw_answer answer;
	double end = latency_now() + seconds;
	for (int i = 0; i < n; i++) {
		double left = end - latency_now();
		raw_receive(sockets[i], left > 0.02 ? left : 0.02, &answer);
		if (answer.status == status && strstr(answer.text, detail))
			counted++;
		else if (answer.status != 0)
			fail_msg("%d: %s", answer.status, answer.text);
	}
	return counted;
}

static void who_asks_for_more_than_a_share_is_refused(void **state)
{
	enum { N = 40, SHARE = 16 };
	struct service *service = *state;
	int sockets[N];
	char long_id[17], id[17], get[128];
	service_histories(service, 20, long_id); // its samples take seconds
	finished_study(service, id);
	snprintf(get, sizeof get, "GET /v1/studies/%s/samples HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
	         long_id);
	open_many(service, get, sockets, N);
	int refused = answered(sockets, N, 503, MANY_LONG, 1);
	// short answers do not wait in that queue
	double start = latency_now();
	struct answer csv = service_get(service, "/v1/studies/%s/results?format=csv", id);
	assert_int_equal(csv.status, 200);
	answer_free(&csv);
	double s = latency_now() - start;
	close_many(sockets, N);
	check_report(
	    "%d at once for samples that take seconds: %d refused with 503; another's table after %.0f ms", N,
	    refused, 1e3 * s);
	assert_int_equal(refused, N - SHARE);
	if (check_soaks())
		assert_true(s < 0.1);
}

static void long_answers_of_all_clients_are_64_at_a_time(void **state)
{
	enum { CLIENTS = 5, SHARE = 16, N = CLIENTS * SHARE, MOST = 64 };
	struct service *service = service_new();
	int sockets[N];
	char path[128], id[17], get[256];
	(void)state;
	service_start(service, 2);
	service_histories(service, 20, id);
	service_stop(service);
	snprintf(path, sizeof path, "%s/tokens", service->directory);
	FILE *tokens = fopen(path, "w");
	for (int c = 0; c < CLIENTS; c++)
		fprintf(tokens, "%032d\n", c);
	fchmod(fileno(tokens), 0600);
	fclose(tokens);
	setenv("POUNDD_TOKEN_FILE", path, 1);
	service_start(service, 2);
	unsetenv("POUNDD_TOKEN_FILE");
	for (int c = 0; c < CLIENTS; c++) {
		snprintf(get, sizeof get,
		         "GET /v1/studies/%s/samples HTTP/1.1\r\n" HOST "Authorization: Bearer %032d\r\n\r\n", id, c);
		open_many(service, get, sockets + c * SHARE, SHARE);
	}
	assert_int_equal(answered(sockets, N, 503, MANY_LONG, 1), N - MOST);
	close_many(sockets, N);
	unlink(path);
	service_free(service);
}

static void connections_of_one_address_are_64_on_a_server_that_others_reach(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_LISTEN", "0.0.0.0"}, {"POUNDD_INSECURE", "1"}, {NULL}};
	enum { N = 80, MOST = 64 };
	int sockets[N], closed = 0;
	static struct raw_answer answer;
	struct service *service = service_with(settings, 1);
	(void)state;
	pause_ms(100); // until the earlier connections are closed
	open_many(service, "GET /livez HTTP/1.1\r\n", sockets, N);
	for (int i = 0; i < N; i++) {
		raw_receive(sockets[i], i ? 0.02 : 1, &answer);
		closed += answer.closed;
	}
	close_many(sockets, N);
	assert_int_equal(closed, N - MOST);
	service_stop(service);
	service_free(service);
}

static void more_than_half_of_the_connections_do_not_wait_and_who_hangs_up_frees_his_place(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_CONNECTIONS_MAX", "20"}, {NULL}};
	enum { N = 16, MOST = 10 };
	int sockets[N];
	char id[17], wait[160];
	(void)state;
	struct service *service = service_with(settings, 1);
	finished_study(service, id);
	snprintf(wait, sizeof wait,
	         "GET /v1/studies/%s HTTP/1.1\r\n" HOST "If-None-Match: *\r\nPrefer: wait=30\r\n\r\n", id);
	open_many(service, wait, sockets, N);
	assert_int_equal(answered(sockets, N, 304, "", 0.5), N - MOST);
	close_many(sockets, N);
	int free_again = 0;
	// a slot soon becomes free: then a request waits instead of being answered at once
	for (int try = 0; try < 100 && !free_again; try++) {
		pause_ms(50);
		open_many(service, wait, sockets, 1);
		free_again = answered(sockets, 1, 304, "", 0.05) == 0;
		close_many(sockets, 1);
	}
	assert_true(free_again);
	service_stop(service);
	service_free(service);
}

static void a_probe_is_answered_when_no_more_connections_are_served(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_CONNECTIONS_MAX", "4"}, {NULL}};
	enum { N = 8 };
	int sockets[N];
	char id[17];
	(void)state;
	struct service *service = service_with(settings, 1);
	finished_study(service, id);
	pause_ms(100); // until the earlier connections are closed
	open_many(service, "GET /livez HTTP/1.1\r\n", sockets, N);
	static const char probe[] = "GET /livez HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
	                  list[] = "GET /v1/studies HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n";
	static struct raw_answer answer;
	raw_ask(service, probe, strlen(probe), 5, &answer);
	assert_int_equal(answer.status, 200);
	raw_ask(service, list, strlen(list), 5, &answer);
	assert_int_equal(answer.status, 503);
	assert_non_null(strstr(answer.text, "Retry-After: "));
	assert_non_null(strstr(answer.text, "all connections of the server are in use"));
	close_many(sockets, N);
	service_stop(service);
	service_free(service);
}

static void bodies_have_a_budget_and_their_memory_is_given_back(void **state)
{
	enum { N = 100, MOST = 64, HALF = 512 * 1024 };
	static const char head[] = "POST /v1/studies HTTP/1.1\r\n" HOST
	                           "Content-Type: application/json\r\nContent-Length: 1048576\r\n\r\n";
	struct service *service = *state;
	int sockets[N];
	char *half = malloc(HALF), id[17];
	memset(half, ' ', HALF);
	finished_study(service, id);
	const double before = service_resident_mb(service);
	for (int i = 0; i < N; i++) {
		open_many(service, head, &sockets[i], 1);
		raw_send(sockets[i], half, HALF);
	}
	assert_int_equal(answered(sockets, N, 503, "too many request bodies are being sent", 2), N - MOST);
	const double during = service_resident_mb(service);
	close_many(sockets, N);
	double after = during;
	for (int i = 0; i < 100 && after > before + 4; i++) {
		pause_ms(50);
		after = service_resident_mb(service);
	}
	check_report(
	    "%d bodies of 1 MiB at once: %d refused; resident before, then and after %.0f, %.0f, %.0f MB", N,
	    N - MOST, before, during, after);
	if (SERVICE_MEMORY)
		assert_true(after <= before + 8);
	free(half);
}

/* A thousand connections of one client: unfinished bodies and headers, waiting polls, requests for samples. */
static void another_s_status_is_counted_whatever_a_thousand_connections_do(void **state)
{
	enum { EACH = 250, KINDS = 4, ASKED = 200 };
	static int sockets[KINDS * EACH];
	struct service *service = *state;
	struct latencies latencies = {0};
	char long_id[17], id[17], bytes[KINDS][256];
	service_histories(service, 20, long_id);
	finished_study(service, id);
	snprintf(bytes[0], sizeof bytes[0], "GET /v1/studies/%s/samples HTTP/1.1\r\n" HOST "\r\n", long_id);
	snprintf(bytes[1], sizeof bytes[1],
	         "GET /v1/studies/%s HTTP/1.1\r\n" HOST "If-None-Match: *\r\nPrefer: wait=30\r\n\r\n", id);
	snprintf(bytes[2], sizeof bytes[2],
	         "POST /v1/studies HTTP/1.1\r\n" HOST
	         "Content-Type: application/json\r\nContent-Length: 1048576\r\n\r\n{");
	snprintf(bytes[3], sizeof bytes[3], "GET /v1/studies HTTP/1.1\r\n" HOST);
	for (int k = 0; k < KINDS; k++)
		open_many(service, bytes[k], sockets + k * EACH, EACH);
	for (int i = 0; i < ASKED; i++) {
		double asked = latency_now();
		struct answer answer = service_get(service, "/v1/studies/%s", id);
		assert_int_equal(answer.status, 200);
		answer_free(&answer);
		latency_add(&latencies, asked, latency_now());
		// connections of each kind send more
		for (int k = 0; k < KINDS; k++)
			raw_send(sockets[k * EACH + i % EACH], k == 2 ? "{" : bytes[k], k == 2 ? 1 : strlen(bytes[k]));
	}
	const double p99 = latency_quantile(&latencies, 0.99);
	check_report("a thousand connections of one client: another's status p99 %.1f ms", p99);
	if (check_soaks())
		assert_true(p99 <= 50);
	close_many(sockets, KINDS * EACH);
	free(latencies.answers);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(who_asks_for_more_than_a_share_is_refused),
           cmocka_unit_test(long_answers_of_all_clients_are_64_at_a_time),
           cmocka_unit_test(connections_of_one_address_are_64_on_a_server_that_others_reach),
           cmocka_unit_test(more_than_half_of_the_connections_do_not_wait_and_who_hangs_up_frees_his_place),
           cmocka_unit_test(a_probe_is_answered_when_no_more_connections_are_served),
           SERVED(bodies_have_a_budget_and_their_memory_is_given_back),
           SERVED(another_s_status_is_counted_whatever_a_thousand_connections_do))
