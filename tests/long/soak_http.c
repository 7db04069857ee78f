/* The server under many clients, slow clients and long use; minutes.  make soak, SOAK seconds for each test.
 *
 * Latencies include the other load of this machine; the limits assume that there is none. */
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/token.h"
#include "tests/support/host_pauses.h"
#include "tests/support/latency.h"
#include "tests/support/raw_http.h"

/* ---- slow clients ---- */

#define FRESH_S 0.2 /* time between two requests of other clients */

static int open_files(const struct service *service)
{
	char path[64];
	int n = 0;
	snprintf(path, sizeof path, "/proc/%d/fd", (int)service->pid);
	DIR *files = opendir(path);
	assert_non_null(files);
	while (readdir(files))
		n++;
	closedir(files);
	return n;
}

/* An attacking client sends again, and reconnects if its connection was closed; whether it reconnected. */
static bool pester(const struct service *service, int *s, const char *first, const char *then, bool reads)
{
	const int window = 2048; // receive window of clients that do not read
	ssize_t sent = *s < 0 ? -1 : send(*s, then, strlen(then), MSG_NOSIGNAL | MSG_DONTWAIT);
	char one;
	if (*s >= 0 && ((sent < 0 && errno != EAGAIN) || (reads && recv(*s, &one, 1, MSG_DONTWAIT) == 0))) {
		close(*s);
		*s = -1;
	}
	if (*s >= 0)
		return false;
	*s = raw_open(service);
	if (reads)
		setsockopt(*s, SOL_SOCKET, SO_RCVBUF, &window, sizeof window);
	raw_send(*s, first, strlen(first));
	return true;
}

static void attacked(struct service *service, const char *what, const char *first, const char *then,
                     bool reads)
{
	enum { SLOW = 1000, PERIOD = 3 /* [s] between two bytes of one of them */ };
	static const char fresh[] = "GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
	static int sockets[SLOW];
	static struct raw_answer answer;
	struct latencies latencies = {0};
	int asked = 0, answered = 0, opened = 0, before = open_files(service);
	double start = latency_now(), seconds = latency_soak_s(), settled = start + fmin(10, seconds / 2);
	host_pauses_start();
	for (int i = 0; i < SLOW; i++)
		sockets[i] = -1;
	for (double due = settled; latency_now() < start + seconds;) {
		for (int i = 0; i < SLOW && latency_now() < start + seconds; i++) {
			opened += pester(service, &sockets[i], first, then, reads);
			usleep(1000000 * PERIOD / SLOW);
			double asks = latency_now();
			if (asks < due)
				continue;
			raw_ask(service, fresh, strlen(fresh), 5, &answer);
			asked++;
			answered += answer.status == 200;
			latency_add(&latencies, asks, latency_now());
			due = asks + FRESH_S;
		}
	}
	for (int i = 0; i < SLOW; i++)
		close(sockets[i]);
	host_pauses_stop();
	double closed = latency_now();
	while (open_files(service) > before + 5 && latency_now() < closed + 30)
		usleep(100000);
	check_report(
	    "%s: %d slow clients, %d connections in %.0f s; %d of %d fresh requests answered; files back "
	    "after %.0f "
	    "s; the machine was away for %.2f %%",
	    what, SLOW, opened, seconds, answered, asked, latency_now() - closed, 100 * host_pauses_share());
	latency_report("  fresh requests", &latencies);
	latency_there(&latencies);
	latency_report("  of them while the machine was there", &latencies);
	assert_true(asked > 0 && answered >= 0.99 * asked);
	assert_true(latency_quantile(&latencies, 0.99) <= 1000);
	assert_true(latency_now() < closed + 15);
	free(latencies.answers);
}

static void slow_headers_bodies_and_readers_do_not_keep_others_out(void **state)
{
	struct service *service = *state;
	attacked(service, "slow headers", "GET /livez HTTP/1.1\r\nHost: localhost\r\n", "X-A: b\r\n", false);
	attacked(service, "slow bodies",
	         "POST /v1/studies HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
	         "Content-Length: 100000\r\n\r\n{",
	         " ", false);
	attacked(service, "slow readers", "GET /v1/openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n",
	         "GET /v1/openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n", true);
}

/* ---- long use ---- */

struct asker {
	const struct service *service;
	const char *id;
	int n, errors;
	pthread_t thread;
};

static void *ask_in_thread(void *of)
{
	static const char *const paths[] = {"/livez", "/v1/studies/%s", "/v1/studies?limit=5", "/metrics",
	                                    "/nowhere"};
	struct asker *asker = of;
	char bytes[256], answer[65536];
	int s = raw_open(asker->service);
	for (int i = 0; i < asker->n; i++) {
		char path[64];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-extra-args"
		// mostly the cheap paths
		snprintf(path, sizeof path, paths[i % 100 ? i % 2 : 2 + i / 100 % 3], asker->id);
#pragma GCC diagnostic pop
		raw_send(s, bytes,
		         (size_t)snprintf(bytes, sizeof bytes, "GET %s HTTP/1.1\r\nHost: localhost\r\n\r\n", path));
		if (recv(s, answer, sizeof answer, 0) <= 0) {
			asker->errors++;
			close(s);
			s = raw_open(asker->service);
		}
	}
	close(s);
	return NULL;
}

static void long_use(const struct service *service, int requests, int studies, int aborted, const char *id)
{
	enum { ASKERS = 4 };
	struct asker askers[ASKERS];
	char last[17];
	char *study = service_study(2, 1, 1);
	for (int i = 0; i < ASKERS; i++) {
		askers[i] = (struct asker){.service = service, .id = id, .n = requests / ASKERS};
		assert_int_equal(pthread_create(&askers[i].thread, NULL, ask_in_thread, &askers[i]), 0);
	}
	for (int i = 0; i < studies; i++)
		service_submit(service, study, last);
	for (int i = 0; i < aborted; i++) {
		static const char bytes[] = "GET /v1/openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n";
		int s = raw_open(service);
		raw_send(s, bytes, strlen(bytes));
		char one;
		recv(s, &one, 1, 0);
		close(s); // the answer is not read further
	}
	assert_true(studies == 0 || service_wait(service, last, "succeeded", 0));
	for (int i = 0; i < ASKERS; i++) {
		pthread_join(askers[i].thread, NULL);
		assert_int_equal(askers[i].errors, 0);
	}
	free(study);
}

static void a_million_requests_and_a_thousand_studies_leave_nothing_behind(void **state)
{
	struct service *service = *state;
	char id[17], wal[128];
	struct stat about = {0};
	char *study = service_study(2, 1, 1);
	// SOAK=60 is a million requests
	int requests = (int)(1e6 * fmin(1, latency_soak_s() / 60)), studies = requests / 1000,
	    aborted = requests / 1000;
	service_submit(service, study, id);
	free(study);
	// first fill SQLite's page cache
	long_use(service, requests / 4, 700, aborted / 4, id);
	double resident = service_resident_mb(service);
	int files = open_files(service);
	long_use(service, requests, studies, aborted, id);
	double after = service_resident_mb(service);
	double end = latency_now() + 15;
	while (open_files(service) > files && latency_now() < end)
		usleep(100000);
	snprintf(wal, sizeof wal, "%s-wal", service->database);
	stat(wal, &about);
	check_report(
	    "%d requests, %d studies, %d downloads aborted: resident %.1f MB before, %.1f after (%+.1f %%), "
	    "files %d and "
	    "%d, WAL %.1f MiB",
	    requests, studies, aborted, resident, after, 100 * (after / resident - 1), files, open_files(service),
	    (double)about.st_size / (1 << 20));
	assert_true(after <= 1.05 * resident + 1);
	assert_true(open_files(service) <= files);
	assert_true(about.st_size <= 64 << 20);
}

/* ---- what the latency reveals ---- */

enum { TIMINGS = 100000 };

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Mean, and variance of the mean, without the slowest tenth, which other programs cause. */
static void trimmed(double *seconds, double *mean, double *variance)
{
	int n = TIMINGS * 9 / 10;
	double sum = 0, squares = 0;
	qsort(seconds, TIMINGS, sizeof(double), ascending);
	for (int i = 0; i < n; i++)
		sum += seconds[i];
	*mean = sum / n;
	for (int i = 0; i < n; i++)
		squares += (seconds[i] - *mean) * (seconds[i] - *mean);
	*variance = squares / n / (n - 1);
}

static void the_time_a_wrong_token_takes_does_not_show_how_wrong_it_is(void **state)
{
	static const char right[] = "0123456789abcdef0123456789abcdef";
	static double seconds[2][TIMINGS];
	char path[] = "/tmp/pound-token-XXXXXX", wrong[2][64];
	int file = mkstemp(path);
	(void)state;
	assert_true(write(file, right, strlen(right)) > 0);
	close(file);
	struct tokens *tokens = tokens_open(path);
	assert_non_null(tokens);
	unlink(path);
	for (int w = 0; w < 2; w++) {
		snprintf(wrong[w], sizeof wrong[w], "Bearer %s", right);
		wrong[w][7 + (w ? 31 : 0)] = 'x'; // at the first character, and at the last
	}
	unsigned random = 1;
	for (int n[2] = {0}; n[0] < TIMINGS || n[1] < TIMINGS;) {
		// in random order, so that the branch predictor cannot learn a pattern
		int w = rand_r(&random) >> 4 & 1;
		char sent[64]; // the same address for both
		memcpy(sent, wrong[w], sizeof sent);
		double start = latency_now();
		const char *name = tokens_name(tokens, sent);
		double took = latency_now() - start;
		assert_null(name);
		if (n[w] < TIMINGS)
			seconds[w][n[w]++] = took;
	}
	double mean[2], variance[2];
	for (int w = 0; w < 2; w++)
		trimmed(seconds[w], &mean[w], &variance[w]);
	double t = (mean[1] - mean[0]) / sqrt(variance[0] + variance[1]);
	check_report("wrong at the first character %.1f ns, at the last %.1f ns: t = %.2f", 1e9 * mean[0],
	             1e9 * mean[1], t);
	assert_true(fabs(t) < 2.58); // p > 0.01
	free(tokens);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(cmocka_unit_test(the_time_a_wrong_token_takes_does_not_show_how_wrong_it_is),
           SERVED(slow_headers_bodies_and_readers_do_not_keep_others_out),
           SERVED(a_million_requests_and_a_thousand_studies_leave_nothing_behind))
