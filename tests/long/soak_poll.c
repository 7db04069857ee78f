/* A thousand clients that poll once a second, and a hundred open browser pages, while all workers compute.
 *
 * The latency of an answer is from before the send call until the kernel had the answer for the client
 * (SO_TIMESTAMPNS): the client's own delays are excluded, those of the server and of the machine included.  The
 * slowdown of the study is the share of the processors that answers take and the additional time of a run, so that
 * other programs do not count; phases with and without clients alternate. */
#include <dirent.h>
#include <math.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/host_pauses.h"
#include "tests/support/latency.h"
#include "tests/support/raw_http.h"

enum {
	POLLERS = 1000,
	ROUNDS = 15, /* of one phase without clients and one with clients */
};

struct poller {
	int socket;
	double due, sent; /* [s] wall clock; sent: 0 while no answer is awaited */
};

static struct poller pollers[POLLERS];

static struct {
	struct latencies answers;
	int late, wrong; /* no answer within a second; closed, or not 200 */
} polls;

static int pollers_open(const struct service *service)
{
	const int on = 1;
	int epoll = epoll_create1(EPOLL_CLOEXEC);
	for (int i = 0; i < POLLERS; i++) {
		pollers[i] = (struct poller){.socket = raw_open(service)};
		struct epoll_event event = {.events = EPOLLIN, .data.u32 = (uint32_t)i};
		assert_int_equal(setsockopt(pollers[i].socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on), 0);
		assert_int_equal(epoll_ctl(epoll, EPOLL_CTL_ADD, pollers[i].socket, &event), 0);
	}
	return epoll;
}

static void pollers_close(int epoll)
{
	for (int i = 0; i < POLLERS; i++)
		close(pollers[i].socket);
	close(epoll);
}

/* Receives an answer, and the time at which the kernel had it. */
static void hear(struct poller *poller)
{
	char answer[16384], about[256];
	struct iovec to = {answer, sizeof answer};
	struct msghdr message = {
	    .msg_iov = &to, .msg_iovlen = 1, .msg_control = about, .msg_controllen = sizeof about};
	ssize_t came = recvmsg(poller->socket, &message, 0);
	double at = latency_now();
	for (struct cmsghdr *c = CMSG_FIRSTHDR(&message); c; c = CMSG_NXTHDR(&message, c))
		if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMPNS) {
			struct timespec time;
			memcpy(&time, CMSG_DATA(c), sizeof time);
			at = (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
		}
	polls.wrong += came <= 0 || poller->sent == 0 || strncmp(answer, "HTTP/1.1 200", 12) != 0;
	latency_add(&polls.answers, poller->sent, at);
	poller->sent = 0;
}

static void poll_all(int epoll, const char *id, double seconds)
{
	static struct epoll_event events[POLLERS];
	char bytes[160];
	size_t n =
	    (size_t)snprintf(bytes, sizeof bytes, "GET /v1/studies/%s HTTP/1.1\r\nHost: localhost\r\n\r\n", id);
	double start = latency_now();
	int asked = 0;
	for (int i = 0; i < POLLERS; i++)
		pollers[i].due = start + (double)i / POLLERS;
	// they are due in rotation; answers still awaited at the end are received
	for (int next = 0;
	     latency_now() < start + seconds || (asked > 0 && latency_now() < start + seconds + 5);) {
		for (double t = latency_now(); t < start + seconds && pollers[next].due <= t;
		     next = (next + 1) % POLLERS) {
			struct poller *poller = &pollers[next];
			poller->due += 1;
			polls.late += poller->sent > 0;
			if (poller->sent > 0)
				continue;
			poller->sent = latency_now();
			raw_send(poller->socket, bytes, n);
			asked++;
		}
		int ready = epoll_wait(epoll, events, POLLERS, 1);
		for (int e = 0; e < ready; e++, asked--)
			hear(&pollers[events[e].data.u32]);
	}
	polls.late += asked;
}

/* Time used by threads: those that answer or commit, which unlike the workers have nice 0, and the study's blocks. */
struct cost {
	double answers_s, wall_s; /* [s] */
	double runs, runs_s;      /* number, [s] */
};

static double answering_s(pid_t pid)
{
	char path[64], line[512];
	double sum = 0;
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	assert_non_null(tasks);
	for (struct dirent *task = readdir(tasks); task; task = readdir(tasks)) {
		snprintf(path, sizeof path, "/proc/%d/task/%.16s/stat", (int)pid, task->d_name);
		FILE *file = task->d_name[0] == '.' ? NULL : fopen(path, "r"); // task/../stat: whole process
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

static struct cost cost_now(const struct service *service)
{
	return (struct cost){
	    .answers_s = answering_s(service->pid),
	    .wall_s = latency_now(),
	    .runs = (double)service_number(service, "SELECT sum(runs) FROM block"),
	    .runs_s =
	        1e-6 * (double)service_number(service, "SELECT cast(1e6 * sum(cpu_s) AS INTEGER) FROM block")};
}

/* The cost of a phase that began at the totals `before`. */
static struct cost cost_since(const struct service *service, const struct cost *before)
{
	struct cost now = cost_now(service);
	return (struct cost){now.answers_s - before->answers_s, now.wall_s - before->wall_s,
	                     now.runs - before->runs, now.runs_s - before->runs_s};
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void a_thousand_pollers_are_served_while_all_workers_are_busy(void **state)
{
	struct service *service = *state;
	double dearer[ROUNDS], seconds = latency_soak_s() / ROUNDS, answers_s = 0, wall_s = 0, commits_s = 0;
	char *study = service_study(200000, 9, 1), id[17];
	// long ground motions: the study must last for the whole test, however fast a run is
	char *cycles = strstr(study, "\"cycles\": 10");
	assert_non_null(cycles);
	memcpy(cycles, "\"cycles\": 99", 12);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "running", 1));
	int epoll = pollers_open(service);
	host_pauses_start();
	for (int round = 0; round < ROUNDS; round++) {
		struct cost start = cost_now(service);
		usleep((useconds_t)(1e6 * seconds));
		struct cost without = cost_since(service, &start);
		start = cost_now(service);
		poll_all(epoll, id, seconds);
		struct cost with = cost_since(service, &start);
		dearer[round] = with.runs_s / with.runs / (without.runs_s / without.runs);
		// blocks are committed by such threads, too, with or without clients
		const double commits = without.answers_s / without.wall_s * with.wall_s;
		commits_s += commits;
		answers_s += with.answers_s - commits;
		wall_s += with.wall_s;
	}
	pollers_close(epoll);
	host_pauses_stop();
	qsort(dearer, ROUNDS, sizeof(double), ascending);
	double there_s = wall_s * (1 - host_pauses_share()) * (double)sysconf(_SC_NPROCESSORS_ONLN);
	double share = answers_s / there_s, slowed = 1 - (1 - share) / dearer[ROUNDS / 2];
	latency_report("answers", &polls.answers);
	latency_there(&polls.answers);
	latency_report("of them while the machine was there", &polls.answers);
	check_report("late %d, wrong %d; the machine was away for %.2f %% of %.0f s", polls.late, polls.wrong,
	             100 * host_pauses_share(), 2 * wall_s);
	// half of the rounds lie between the quartiles, from which follows the standard error of the median
	double error = 1.25 * (dearer[3 * ROUNDS / 4] - dearer[ROUNDS / 4]) / 1.35 / sqrt(ROUNDS);
	check_report("what the study loses: %.1f +- %.1f %%; answers take %.2f %% of the processors, commits "
	             "%.2f %%, a run "
	             "takes %.3f times the time",
	             100 * slowed, 200 * error, 100 * share, 100 * commits_s / there_s, dearer[ROUNDS / 2]);
	double p99 = latency_quantile(&polls.answers, 0.99);
	assert_true(service_wait(service, id, "running", 1));
	assert_int_equal(polls.late + polls.wrong, 0);
	assert_true(p99 <= 20);
	assert_true(share <= 0.05);
	assert_true(slowed - 2 * error <= 0.05);
	free(polls.answers.answers);
	free(study);
}

enum { PAGES = 100 };

/* CPU time of the threads that answer and of the thread that watches waiting requests, without the study's own. */
static double pages_s(pid_t pid)
{
	char path[64], name[32];
	double sum = 0;
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	assert_non_null(tasks);
	for (struct dirent *task = readdir(tasks); task; task = readdir(tasks)) {
		snprintf(path, sizeof path, "/proc/%d/task/%.16s/comm", (int)pid, task->d_name);
		FILE *file = task->d_name[0] == '.' ? NULL : fopen(path, "r");
		bool counts = file && fgets(name, sizeof name, file) &&
		              (strcmp(name, "MHD-worker\n") == 0 || strcmp(name, "connections\n") == 0);
		if (file)
			fclose(file);
		if (!counts)
			continue;
		snprintf(path, sizeof path, "/proc/%d/task/%.16s/schedstat", (int)pid, task->d_name);
		file = fopen(path, "r");
		double ns = 0;
		assert_true(file && fscanf(file, "%lf", &ns) == 1);
		fclose(file);
		sum += 1e-9 * ns;
	}
	closedir(tasks);
	return sum;
}

/* A page with the requests of client/page/page.js: a study's page waits for a change, then pauses for 1 s; the list
 * pauses 3 s. */
struct page {
	int socket;
	double due; /* [s] wall clock; 0 while an answer is awaited */
	char tag[80];
};

static void page_ask(struct page *page, const char *id)
{
	char bytes[320];
	int n = id ? snprintf(bytes, sizeof bytes, "GET /v1/studies/%s HTTP/1.1\r\nHost: localhost\r\n%s%s%s\r\n",
	                      id, *page->tag ? "Prefer: wait=25\r\nIf-None-Match: " : "", page->tag,
	                      *page->tag ? "\r\n" : "")
	           : snprintf(bytes, sizeof bytes, "GET /v1/studies? HTTP/1.1\r\nHost: localhost\r\n\r\n");
	raw_send(page->socket, bytes, (size_t)n);
	page->due = 0;
}

/* Reads an answer, possibly in several segments; returns its status. */
static int page_read(struct page *page, double pause)
{
	static char answer[1 << 16];
	size_t n = 0, length = 0;
	for (char *end = NULL; !end || n < (size_t)(end + 4 - answer) + length;) {
		ssize_t came = recv(page->socket, answer + n, sizeof answer - 1 - n, 0);
		if (came <= 0)
			return 0;
		answer[n += (size_t)came] = 0;
		if (!end && (end = strstr(answer, "\r\n\r\n"))) {
			const char *text = strstr(answer, "Content-Length: ");
			length = text ? strtoul(text + 16, NULL, 10) : 0;
		}
	}
	const char *tag = strstr(answer, "ETag: ");
	if (tag)
		snprintf(page->tag, sizeof page->tag, "%.*s", (int)strcspn(tag + 6, "\r"), tag + 6);
	page->due = latency_now() + pause;
	return atoi(answer + 9);
}

/* Opens 100 pages for some time; id NULL: pages of the list.  Returns the fraction of a core that answering them takes. */
static double pages_cost(const struct service *service, const char *id, double seconds)
{
	static struct page pages[PAGES];
	struct epoll_event events[PAGES];
	int epoll = epoll_create1(EPOLL_CLOEXEC), answers = 0, wrong = 0;
	double start = latency_now(), pause = id ? 1 : 3;
	for (int i = 0; i < PAGES; i++) {
		pages[i] = (struct page){.socket = raw_open(service), .due = start + pause * i / PAGES};
		struct epoll_event event = {.events = EPOLLIN, .data.u32 = (uint32_t)i};
		assert_int_equal(epoll_ctl(epoll, EPOLL_CTL_ADD, pages[i].socket, &event), 0);
	}
	double before = 0, counted = 0; // from the second round on: each page is opened once
	for (double now = start; now < start + pause + seconds; now = latency_now()) {
		if (counted == 0 && now >= start + pause) {
			before = pages_s(service->pid);
			counted = now;
			answers = 0;
		}
		for (int i = 0; i < PAGES; i++)
			if (pages[i].due > 0 && pages[i].due <= now)
				page_ask(&pages[i], id);
		int ready = epoll_wait(epoll, events, PAGES, 2);
		for (int e = 0; e < ready; e++, answers++) {
			int status = page_read(&pages[events[e].data.u32], pause);
			wrong += status != 200 && (status != 304 || !id);
		}
	}
	double wall = latency_now() - counted, share = (pages_s(service->pid) - before) / wall;
	check_report("%d pages of %s: %.0f answers a second, %.2f %% of a core, %.0f us an answer", PAGES,
	             id ? "a study" : "the list", answers / wall, 100 * share, 1e6 * share * wall / answers);
	assert_int_equal(wrong, 0);
	assert_true(answers > PAGES * wall / pause / 2);
	for (int i = 0; i < PAGES; i++)
		close(pages[i].socket);
	close(epoll);
	return share;
}

static void a_hundred_open_pages_take_two_percent_of_a_core_while_a_study_runs(void **state)
{
	struct service *service = *state;
	char *study = service_study(200000, 9, 1), id[17];
	for (int i = 0; i < 30; i++) // more than one page of the list
		service_submit(service, study, id);
	double of_list = pages_cost(service, NULL, latency_soak_s() / 2);
	char *first =
	    service_text(service, "SELECT printf('%016x', id) FROM study WHERE status = 'running' LIMIT 1");
	double of_study = pages_cost(service, first, latency_soak_s() / 2);
	assert_true(service_wait(service, first, "running", 1));
	assert_true(of_study <= 0.02);
	assert_true(of_list <= 0.02);
	free(first);
	free(study);
}

CHECK_MAIN(cmocka_unit_test_setup_teardown(a_thousand_pollers_are_served_while_all_workers_are_busy,
                                           service_setup, service_teardown),
           cmocka_unit_test_setup_teardown(a_hundred_open_pages_take_two_percent_of_a_core_while_a_study_runs,
                                           service_setup, service_teardown))
