/* The server under many clients, slow clients and long use; minutes.  make soak, SOAK seconds for each test.
 *
 * Latencies are of this machine, whatever else it does; what is asserted is meant for one that is quiet. */
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "schema/reading.h"
#include "server/token.h"
#include "tests/raw.h"

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static double soak_s(void)
{
	const char *seconds = getenv("SOAK");
	return seconds ? atof(seconds) : 60;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct latencies {
	double *seconds; /* (n) */
	int n, room;
};

static void add(struct latencies *l, double seconds)
{
	if (l->n == l->room) {
		l->room = 2 * l->room + 1000;
		l->seconds = realloc(l->seconds, (size_t)l->room * sizeof(double));
		assert_non_null(l->seconds);
	}
	l->seconds[l->n++] = seconds;
}

/* The value that a part of them is below [ms]. */
static double quantile(struct latencies *l, double part)
{
	qsort(l->seconds, (size_t)l->n, sizeof(double), ascending);
	return 1e3 * l->seconds[(int)fmin(part * l->n, l->n - 1)];
}

/* Processor time of the threads that answer requests, which unlike the workers are not nice [s]. */
static double answering_s(pid_t pid)
{
	char path[64], line[512];
	double sum = 0;
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	assert_non_null(tasks);
	for (struct dirent *task = readdir(tasks); task; task = readdir(tasks)) {
		snprintf(path, sizeof path, "/proc/%d/task/%.16s/stat", (int)pid, task->d_name);
		FILE *file = task->d_name[0] == '.' ? NULL : fopen(path, "r"); // task/../stat is the whole process
		long user, system, nice;
		if (file && fgets(line, sizeof line, file) &&
		    sscanf(strrchr(line, ')'),
		           ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %ld %ld %*d %*d %*d %ld", &user, &system,
		           &nice) == 3 &&
		    nice == 0)
			sum += (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
		if (file)
			fclose(file);
	}
	closedir(tasks);
	return sum;
}

static double number_of(const struct service *service, const char *id, const char *member)
{
	struct answer answer = service_get(service, "/v1/studies/%s", id);
	struct reading *status = answer_read(&answer);
	double value = reading_number(status, "/%s", member);
	reading_close(status);
	answer_free(&answer);
	return value;
}

/* A study that keeps all workers busy for longer than any of these tests. */
static void busy(const struct service *service, char id[17])
{
	char *study = service_study(60000, 9, 1);
	service_submit(service, study, id);
	free(study);
	assert_true(service_wait(service, id, "running", 1));
}

/* ---- many clients that ask once a second ---- */

enum { POLLERS = 1000 };

struct poller {
	int socket;
	double due, sent; /* sent: 0 while nothing is asked */
};

static void poll_all(const struct service *service, const char *id, double seconds,
                     struct latencies *latencies, int *errors)
{
	static struct poller pollers[POLLERS];
	static struct epoll_event events[POLLERS];
	char bytes[160], answer[16384];
	int n = snprintf(bytes, sizeof bytes, "GET /v1/studies/%s HTTP/1.1\r\nHost: localhost\r\n\r\n", id);
	int epoll = epoll_create1(EPOLL_CLOEXEC);
	double start = now();
	for (int i = 0; i < POLLERS; i++) {
		pollers[i] = (struct poller){.socket = raw_open(service), .due = start + (double)i / POLLERS};
		struct epoll_event event = {.events = EPOLLIN, .data.u32 = (uint32_t)i};
		assert_int_equal(epoll_ctl(epoll, EPOLL_CTL_ADD, pollers[i].socket, &event), 0);
	}
	int next = 0; // they are due one after the other, round and round
	for (double t = now(); t < start + seconds; t = now()) {
		while (pollers[next].due <= t) {
			if (pollers[next].sent > 0)
				++*errors; // not answered within a second
			raw_send(pollers[next].socket, bytes, (size_t)n);
			pollers[next].sent = t;
			pollers[next].due += 1;
			next = (next + 1) % POLLERS;
		}
		int ready = epoll_wait(epoll, events, POLLERS, 1);
		t = now();
		for (int e = 0; e < ready; e++) {
			struct poller *poller = &pollers[events[e].data.u32];
			ssize_t came = recv(poller->socket, answer, sizeof answer, 0);
			*errors += came <= 0 || strncmp(answer, "HTTP/1.1 200", 12) != 0;
			add(latencies, t - poller->sent);
			poller->sent = 0;
		}
	}
	for (int i = 0; i < POLLERS; i++)
		close(pollers[i].socket);
	close(epoll);
}

static void a_thousand_pollers_are_served_while_all_workers_are_busy(void **state)
{
	struct service *service = *state;
	struct latencies latencies = {0};
	int errors = 0;
	char id[17];
	double seconds = soak_s(), rates[2], wall[2], cpu = 0;
	busy(service, id);
	// the study alone, then with the pollers
	for (int with = 0; with < 2; with++) {
		double runs = number_of(service, id, "runs_done"), start = now();
		cpu = answering_s(service->pid);
		if (with)
			poll_all(service, id, seconds, &latencies, &errors);
		else
			usleep((useconds_t)(1e6 * seconds));
		wall[with] = now() - start;
		cpu = answering_s(service->pid) - cpu;
		rates[with] = (number_of(service, id, "runs_done") - runs) / wall[with];
	}
	printf("%d polls of %d clients in %.0f s: %d errors, p50 %.2f ms, p99 %.2f ms, most %.1f ms\n",
	       latencies.n, POLLERS, wall[1], errors, quantile(&latencies, 0.5), quantile(&latencies, 0.99),
	       quantile(&latencies, 1));
	double share = cpu / wall[1] / (double)sysconf(_SC_NPROCESSORS_ONLN);
	printf("study: %.0f runs/s alone, %.0f with them (%+.1f %%); answers took %.2f %% of the processors\n",
	       rates[0], rates[1], 100 * (rates[1] / rates[0] - 1), 100 * share);
	assert_int_equal(errors, 0);
	assert_true(quantile(&latencies, 0.99) <= 20);
	// what the study loses, whatever else this machine does
	assert_true(share <= 0.05);
	free(latencies.seconds);
}

/* ---- studies as fast as they are taken ---- */

enum { SUBMITTERS = 16 };

struct submitter {
	const struct service *service;
	const char *study;
	double until;
	struct latencies latencies;
	pthread_t thread;
};

static void *submit_in_thread(void *of)
{
	struct submitter *submitter = of;
	char *bytes = NULL, answer[16384];
	int n = asprintf(&bytes,
	                 "POST /v1/studies HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
	                 "Content-Length: %zu\r\n\r\n%s",
	                 strlen(submitter->study), submitter->study);
	int s = raw_open(submitter->service);
	for (double start = now(); start < submitter->until; start = now()) {
		raw_send(s, bytes, (size_t)n);
		ssize_t came = recv(s, answer, sizeof answer, 0);
		if (came > 12 && !strncmp(answer, "HTTP/1.1 201", 12))
			add(&submitter->latencies, now() - start);
	}
	close(s);
	free(bytes);
	return NULL;
}

static void a_hundred_studies_a_second_are_accepted_from_sixteen_clients(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_QUEUE_MAX", "1000000"}, {NULL}};
	static struct submitter submitters[SUBMITTERS];
	struct latencies all = {0};
	(void)state;
	struct service *service = service_with(settings, 2);
	char *study = service_study(2, 1, 1);
	double seconds = fmin(soak_s(), 20), until = now() + seconds;
	for (int i = 0; i < SUBMITTERS; i++) {
		submitters[i] = (struct submitter){.service = service, .study = study, .until = until};
		assert_int_equal(pthread_create(&submitters[i].thread, NULL, submit_in_thread, &submitters[i]), 0);
	}
	for (int i = 0; i < SUBMITTERS; i++) {
		pthread_join(submitters[i].thread, NULL);
		for (int k = 0; k < submitters[i].latencies.n; k++)
			add(&all, submitters[i].latencies.seconds[k]);
		free(submitters[i].latencies.seconds);
	}
	service_kill(service);
	int64_t kept = service_number(service, "SELECT count(*) FROM study");
	printf("%d accepted in %.0f s: %.0f a second, p50 %.1f ms, p99 %.1f ms; %d kept\n", all.n, seconds,
	       all.n / seconds, quantile(&all, 0.5), quantile(&all, 0.99), (int)kept);
	assert_true(all.n >= 100 * seconds);
	assert_true(kept >= all.n && kept <= all.n + SUBMITTERS); // those whose answer was still on its way
	free(all.seconds);
	free(study);
	service_free(service);
}

/* ---- slow clients ---- */

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

static void attacked(struct service *service, const char *what, const char *first, const char *then,
                     bool reads)
{
	enum { SLOW = 1000, PERIOD = 3 /* [s] between two bytes of one of them */ };
	static int sockets[SLOW];
	static struct raw_answer answer;
	struct latencies latencies = {0};
	int asked = 0, answered = 0, opened = 0, before = open_files(service);
	double start = now(), seconds = soak_s(), settled = start + 10, fresh = start;
	for (int i = 0; i < SLOW; i++)
		sockets[i] = -1;
	for (int i = 0; now() < start + seconds; i = (i + 1) % SLOW) {
		// one that was closed comes again
		ssize_t sent =
		    sockets[i] < 0 ? -1 : send(sockets[i], then, strlen(then), MSG_NOSIGNAL | MSG_DONTWAIT);
		char one;
		if (sockets[i] >= 0 &&
		    ((sent < 0 && errno != EAGAIN) || (reads && recv(sockets[i], &one, 1, MSG_DONTWAIT) == 0))) {
			close(sockets[i]);
			sockets[i] = -1;
		}
		if (sockets[i] < 0) {
			sockets[i] = raw_open(service);
			raw_send(sockets[i], first, strlen(first));
			opened++;
		}
		if (now() >= fresh) {
			double t = now();
			raw_ask(service, "GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", 61, 1,
			        &answer);
			if (t > settled) {
				asked++;
				answered += answer.status == 200;
				add(&latencies, now() - t);
			}
			fresh += 1;
		}
		usleep(1000000 * PERIOD / SLOW);
	}
	for (int i = 0; i < SLOW; i++)
		close(sockets[i]);
	double closed = now();
	while (open_files(service) > before + 5 && now() < closed + 30)
		usleep(100000);
	printf("%s: %d slow clients, %d connections in %.0f s; %d of %d fresh requests answered, p99 %.1f ms; "
	       "files back "
	       "after %.0f s\n",
	       what, SLOW, opened, seconds, answered, asked, asked ? quantile(&latencies, 0.99) : 0,
	       now() - closed);
	assert_true(answered >= 0.99 * asked);
	assert_true(asked == 0 || quantile(&latencies, 0.99) <= 1000);
	assert_true(now() < closed + 15);
	free(latencies.seconds);
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

static double resident_mb(const struct service *service)
{
	char path[64];
	long pages = 0;
	snprintf(path, sizeof path, "/proc/%d/statm", (int)service->pid);
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	assert_int_equal(fscanf(file, "%*d %ld", &pages), 1);
	fclose(file);
	return 1e-6 * (double)pages * (double)sysconf(_SC_PAGESIZE);
}

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
		// mostly the cheap ones
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
		close(s); // the rest is not read
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
	int requests = (int)(1e6 * fmin(1, soak_s() / 60)), studies = requests / 1000, aborted = requests / 1000;
	service_submit(service, study, id);
	free(study);
	// warm: SQLite's pages
	long_use(service, requests / 4, 700, aborted / 4, id);
	double resident = resident_mb(service);
	int files = open_files(service);
	long_use(service, requests, studies, aborted, id);
	double after = resident_mb(service);
	double end = now() + 15;
	while (open_files(service) > files && now() < end)
		usleep(100000);
	snprintf(wal, sizeof wal, "%s-wal", service->database);
	stat(wal, &about);
	printf("%d requests, %d studies, %d downloads aborted: resident %.1f MB before, %.1f after (%+.1f %%), "
	       "files %d and "
	       "%d, WAL %.1f MiB\n",
	       requests, studies, aborted, resident, after, 100 * (after / resident - 1), files,
	       open_files(service), (double)about.st_size / (1 << 20));
	assert_true(after <= 1.05 * resident + 1);
	assert_true(open_files(service) <= files);
	assert_true(about.st_size <= 64 << 20);
}

/* ---- what the time of an answer tells ---- */

enum { TIMINGS = 100000 };

/* Mean and variance of the mean of what is not among the slowest tenth, which other programs make. */
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

static void the_time_a_wrong_token_takes_does_not_tell_how_wrong_it_is(void **state)
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
		// by chance, so that neither has a rhythm that the processor could learn
		int w = rand_r(&random) >> 4 & 1;
		char sent[64]; // the same place for both
		memcpy(sent, wrong[w], sizeof sent);
		double start = now();
		const char *name = tokens_name(tokens, sent);
		double took = now() - start;
		assert_null(name);
		if (n[w] < TIMINGS)
			seconds[w][n[w]++] = took;
	}
	double mean[2], variance[2];
	for (int w = 0; w < 2; w++)
		trimmed(seconds[w], &mean[w], &variance[w]);
	double t = (mean[1] - mean[0]) / sqrt(variance[0] + variance[1]);
	printf("wrong at the first character %.1f ns, at the last %.1f ns: t = %.2f\n", 1e9 * mean[0],
	       1e9 * mean[1], t);
	assert_true(fabs(t) < 2.58); // p > 0.01
	free(tokens);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(cmocka_unit_test(the_time_a_wrong_token_takes_does_not_tell_how_wrong_it_is),
           SERVED(a_thousand_pollers_are_served_while_all_workers_are_busy),
           cmocka_unit_test(a_hundred_studies_a_second_are_accepted_from_sixteen_clients),
           SERVED(slow_headers_bodies_and_readers_do_not_keep_others_out),
           SERVED(a_million_requests_and_a_thousand_studies_leave_nothing_behind))
