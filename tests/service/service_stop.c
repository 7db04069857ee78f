/* How the server ends: SIGTERM when idle, while computing and under load; a second SIGTERM; SIGHUP; messages to systemd.
 *
 * The time of each stop is reported; `make soak` checks it. */
#include <curl/curl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/raw_http.h"

enum { ROWS = SERVICE_ROWS, SIGNALS = 5, CLIENTS = 50, WAITERS = 300, IDS_MAX = 65536 };

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Sends SIGTERM; returns the time until the server has exited with status 0 [s]. */
static double stop_s(struct service *service)
{
	double start = now_s();
	service_stop(service);
	return now_s() - start;
}

static void judge(const char *what, double s, double s_max)
{
	check_report("SIGTERM %s: ended with 0 after %.2f s", what, s);
	if (check_soaks())
		assert_true(s <= s_max);
}

static void an_idle_server_and_one_at_work_end_when_they_are_stopped(void **state)
{
	struct service *service = *state;
	char *study = service_study(ROWS, SIGNALS, 1), id[17];
	judge("at rest", stop_s(service), 2);
	service_start(service, 2);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "running", 1));
	judge("at work", stop_s(service), 30);
	// the WAL was copied into the database file and removed
	char wal[128];
	snprintf(wal, sizeof wal, "%s-wal", service->database);
	assert_int_not_equal(access(wal, F_OK), 0);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'queued'"), 1);
	free(study);
}

static void a_second_signal_ends_it_at_once_and_nothing_is_lost(void **state)
{
	struct service *service = *state;
	char *study = service_study(ROWS, SIGNALS, 1), id[17];
	int status;
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "running", 1));
	kill(service->pid, SIGTERM);
	kill(service->pid, SIGTERM);
	assert_int_equal(waitpid(service->pid, &status, 0), service->pid);
	service->pid = 0;
	// the server may exit before the second signal arrives
	assert_true((WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) ||
	            (WIFEXITED(status) && WEXITSTATUS(status) == 0));
	service_start(service, 2);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
}

static void a_terminal_that_hangs_up_does_not_end_it(void **state)
{
	struct service *service = *state;
	kill(service->pid, SIGHUP);
	// exit status 0 shows that SIGHUP did not end the process
	check_report("SIGHUP, and then SIGTERM: ended with 0 after %.2f s", stop_s(service));
}

/* Short documents of which one block takes 15 s or more. */
#define STOREYS "\"storeys\": 50, \"mass_kg\": 1e5"
#define LONG \
	"\"excitation\": {\"signals\": 1, \"frequency_hz\": 2, \"cycles\": 1000, \"time_step_s\": 0.002}}}"
static const struct {
	const char *what, *document;
} lengthy[] = {
    {"a million pulses and 600 frequencies",
     "{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": "
     "[{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], "
     "\"excitation\": {\"signals\": 1}}, "
     "\"spectrum\": {\"frequencies_hz\": {\"count\": 600}, \"pulses\": 1000000}}"},
    {"three buildings of 50 storeys",
     "{\"kind\": \"response\", \"scene\": {\"buildings\": ["
     "{" STOREYS ", \"frequency_hz\": 0.5}, {" STOREYS ", \"frequency_hz\": 0.9}, {" STOREYS
     ", \"frequency_hz\": 0.6}], " LONG},
    {"buildings in contacts of p^1.5",
     "{\"kind\": \"response\", \"scene\": {\"contact\": {\"model\": \"viscoelastic\", "
     "\"stiffness_ratio\": 1e4}, \"buildings\": ["
     "{" STOREYS ", \"frequency_hz\": 0.5}, {" STOREYS ", \"frequency_hz\": 0.9}], " LONG},
};

static void it_ends_soon_whatever_runs_and_so_does_a_cancelled_study(void **state)
{
	static const char *const settings[][2] = {{NULL}};
	char *study = service_study(2, 1, 1), id[17], next[17], path[64];
	(void)state;
	for (size_t i = 0; i < sizeof lengthy / sizeof lengthy[0]; i++) {
		struct service *service = service_with(settings, 1);
		service_submit(service, lengthy[i].document, id);
		service_submit(service, study, next);
		assert_true(service_wait(service, id, "running", 0));
		snprintf(path, sizeof path, "/v1/studies/%s/cancel", id);
		double start = now_s();
		struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
		assert_int_equal(answer.status, 200);
		answer_free(&answer);
		assert_true(service_wait(service, next, "succeeded", 0));
		double after = now_s() - start;
		check_report("the study behind a cancelled one of %s ended %.2f s later", lengthy[i].what, after);
		assert_true(after < (check_soaks() ? 0.5 : 5));
		service_submit(service, lengthy[i].document, id);
		assert_true(service_wait(service, id, "running", 0));
		double s = stop_s(service);
		check_report("SIGTERM while %s run: ended with 0 after %.2f s", lengthy[i].what, s);
		assert_true(s < (check_soaks() ? 0.5 : 5));
		// the interrupted study is queued for the next start
		assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'queued'"), 1);
		service_free(service);
	}
	free(study);
}

static struct {
	const struct service *service;
	pthread_mutex_t lock;
	char ids[IDS_MAX][17];
	atomic_int n, answered, unanswered, seed;
} load = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* Submits studies until the server no longer answers. */
static void *client(void *unused)
{
	for (bool there = true; there;) {
		char *study = service_study(2, 1, load.seed++);
		struct answer answer =
		    service_ask(load.service, &(struct ask){.method = "POST",
		                                            .path = "/v1/studies",
		                                            .headers = {"Content-Type: application/json"},
		                                            .body = study,
		                                            .length = strlen(study),
		                                            .may_fail = true});
		there = answer.status != 0;
		load.answered += there;
		load.unanswered += !there;
		// every answer is complete
		if (there) {
			struct reading *body = answer_read(&answer);
			assert_true(answer.status == 201 || answer.status == 503);
			reading_close(body);
		}
		if (answer.status == 201) {
			pthread_mutex_lock(&load.lock);
			if (load.n < IDS_MAX)
				strcpy(load.ids[load.n++], answer.location + strlen("/v1/studies/"));
			pthread_mutex_unlock(&load.lock);
		}
		answer_free(&answer);
		free(study);
	}
	return unused;
}

/* Starts clients that wait for a change of a finished study, so that only the end of the server ends their wait. */
static void waiters_start(const struct service *service, const char *id, int sockets[WAITERS])
{
	char bytes[256];
	struct answer now = service_get(service, "/v1/studies/%s", id);
	size_t n = (size_t)snprintf(bytes, sizeof bytes,
	                            "GET /v1/studies/%s HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: %s\r\n"
	                            "Prefer: wait=30\r\n\r\n",
	                            id, now.etag);
	for (int i = 0; i < WAITERS; i++) {
		sockets[i] = raw_open(service);
		raw_send(sockets[i], bytes, n);
	}
	answer_free(&now);
}

/* Whether a text has a header and a body of the length in Content-Length. */
static bool is_whole(const char *text)
{
	const char *length = strstr(text, "Content-Length: "), *body = strstr(text, "\r\n\r\n");
	return length && body && strlen(body + 4) == strtoul(length + strlen("Content-Length: "), NULL, 10);
}

/* Counts waiting clients that got a complete 503, and those whose connection was closed without a byte. */
static void waiters_end(int sockets[WAITERS], int *answered, int *closed)
{
	for (int i = 0; i < WAITERS; i++) {
		static struct raw_answer answer;
		raw_receive(sockets[i], 5, &answer);
		close(sockets[i]);
		assert_true(answer.closed);
		if (answer.status != 0 && (answer.status != 503 || answer.n != 1 || !is_whole(answer.text)))
			fail_msg("a waiting client got\n%s", answer.text);
		assert_true(answer.status != 0 || !answer.text[0]);
		*answered += answer.status != 0;
		*closed += answer.status == 0;
	}
}

static void a_server_that_ends_under_load_keeps_all_that_it_accepted(void **state)
{
	struct service *service = *state;
	int n = check_count(3, 50), answered = 0, closed = 0;
	double longest = 0;
	char *study = service_study(2, 1, 0), id[17];
	curl_global_init(CURL_GLOBAL_DEFAULT);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	for (int k = 0; k < n; k++) {
		pthread_t clients[CLIENTS];
		int before = load.n, sockets[WAITERS];
		load.service = service;
		waiters_start(service, id, sockets);
		for (int i = 0; i < CLIENTS; i++)
			assert_int_equal(pthread_create(&clients[i], NULL, client, NULL), 0);
		while (load.n < before + CLIENTS)
			usleep(1000);
		double s = stop_s(service);
		longest = s > longest ? s : longest;
		for (int i = 0; i < CLIENTS; i++)
			pthread_join(clients[i], NULL);
		waiters_end(sockets, &answered, &closed);
		service_start(service, 2);
	}
	for (int i = 0; i < load.n; i++)
		assert_true(service_wait(service, load.ids[i], "succeeded", 0));
	check_report("%d stops under %d clients who submit and %d who wait: studies accepted %d, lost 0; the "
	             "port was closed for "
	             "%d requests; waiting clients got 503 %d times, and closed without a byte %d times",
	             n, CLIENTS, WAITERS, load.n, load.unanswered, answered, closed);
	judge("under load, the longest of them", longest, 30);
	assert_true(load.n >= n * CLIENTS);
	assert_true(answered > n * WAITERS / 2);
	free(study);
}

/* A history of nearly two million lines would take seconds; its client gets 503 when the server stops. */
static void a_history_that_is_being_computed_ends_with_the_server(void **state)
{
	struct service *service = *state;
	static struct raw_answer answer;
	char id[17], bytes[128];
	service_histories(service, 20, id);
	int socket = raw_open(service);
	raw_send(socket, bytes,
	         (size_t)snprintf(bytes, sizeof bytes,
	                          "GET /v1/studies/%s/samples HTTP/1.1\r\nHost: localhost\r\n\r\n", id));
	usleep(100000);
	judge("while a history is computed", stop_s(service), 2);
	raw_receive(socket, 5, &answer);
	close(socket);
	assert_int_equal(answer.status, 503);
	assert_true(is_whole(answer.text));
}

static void twenty_more_servers_on_one_database_are_refused(void **state)
{
	enum { OTHERS = 20 };
	struct service *service = *state;
	pid_t others[OTHERS];
	for (int i = 0; i < OTHERS; i++)
		if ((others[i] = fork()) == 0)
			_exit(service_run(service, 1));
	for (int i = 0; i < OTHERS; i++) {
		int status;
		assert_int_equal(waitpid(others[i], &status, 0), others[i]);
		assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
	}
	char *study = service_study(2, 1, 1), id[17];
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
}

/* Fails unless the next message to systemd is `want`. */
static void expect_notice(int end, const char *want)
{
	char text[64];
	ssize_t n = recv(end, text, sizeof text - 1, 0);
	assert_true(n > 0);
	text[n] = '\0';
	assert_string_equal(text, want);
}

static void systemd_is_notified_when_it_is_ready_alive_and_stopping(void **state)
{
	struct service *service = service_new();
	struct sockaddr_un at = {.sun_family = AF_UNIX};
	int end = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	(void)state;
	assert_true(end >= 0);
	snprintf(at.sun_path, sizeof at.sun_path, "%s/notify", service->directory);
	assert_int_equal(bind(end, (struct sockaddr *)&at, sizeof at), 0);
	setenv("NOTIFY_SOCKET", at.sun_path, 1);
	setenv("WATCHDOG_USEC", "100000", 1);
	service_start(service, 1);
	unsetenv("NOTIFY_SOCKET");
	unsetenv("WATCHDOG_USEC");
	expect_notice(end, "READY=1");
	expect_notice(end, "WATCHDOG=1");
	expect_notice(end, "WATCHDOG=1");
	service_stop(service);
	// more watchdog messages may come before the last one
	char last[64] = "";
	for (ssize_t n; (n = recv(end, last, sizeof last - 1, MSG_DONTWAIT)) > 0;)
		last[n] = '\0';
	assert_string_equal(last, "STOPPING=1");
	close(end);
	service_free(service);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(cmocka_unit_test(systemd_is_notified_when_it_is_ready_alive_and_stopping),
           SERVED(an_idle_server_and_one_at_work_end_when_they_are_stopped),
           cmocka_unit_test(it_ends_soon_whatever_runs_and_so_does_a_cancelled_study),
           SERVED(a_terminal_that_hangs_up_does_not_end_it),
           SERVED(a_second_signal_ends_it_at_once_and_nothing_is_lost),
           SERVED(a_server_that_ends_under_load_keeps_all_that_it_accepted),
           SERVED(a_history_that_is_being_computed_ends_with_the_server),
           SERVED(twenty_more_servers_on_one_database_are_refused))
