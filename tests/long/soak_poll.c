/* A thousand clients that ask once a second, while all workers compute.
 *
 * An answer's time is from before the call that sends the question to when the kernel had the answer for the client
 * (SO_TIMESTAMPNS): the client's own delays do not count, those of the server and of the machine do.  What the study
 * loses is the share of the processors that answers take and what a run costs more meanwhile, so that other programs do
 * not count either; phases with the clients and without them take turns. */
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
	ROUNDS = 15, /* of a phase without the clients and one with them */
};

struct poller {
	int socket;
	double due, sent; /* [s] of the wall clock; sent: 0 while nothing is asked */
};

static struct poller pollers[POLLERS];

static struct {
	struct latencies answers;
	int late, wrong; /* not answered after a second; closed, or not 200 */
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

/* Takes an answer, and the time at which the kernel had it. */
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
	// they are due one after the other, round and round; who still waits at the end is heard
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

/* What threads took: those that answer, which unlike the workers are not nice, and the study's blocks. */
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

static struct cost cost_now(const struct service *service)
{
	return (struct cost){
	    .answers_s = answering_s(service->pid),
	    .wall_s = latency_now(),
	    .runs = (double)service_number(service, "SELECT sum(runs) FROM block"),
	    .runs_s =
	        1e-6 * (double)service_number(service, "SELECT cast(1e6 * sum(cpu_s) AS INTEGER) FROM block")};
}

/* What a phase took, which began with what `before` says. */
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
	double dearer[ROUNDS], seconds = latency_soak_s() / ROUNDS, answers_s = 0, wall_s = 0;
	char *study = service_study(200000, 9, 1), id[17];
	// long ground motions: there is to be work for all the time, however fast a run is
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
		answers_s += with.answers_s;
		wall_s += with.wall_s;
	}
	pollers_close(epoll);
	host_pauses_stop();
	qsort(dearer, ROUNDS, sizeof(double), ascending);
	double there_s = wall_s * (1 - host_pauses_share()) * (double)sysconf(_SC_NPROCESSORS_ONLN);
	double share = answers_s / there_s, slowed = 1 - (1 - share) / dearer[ROUNDS / 2];
	latency_told("answers", &polls.answers);
	latency_there(&polls.answers);
	latency_told("of them while the machine was there", &polls.answers);
	check_report("late %d, wrong %d; the machine was away for %.2f %% of %.0f s", polls.late, polls.wrong,
	             100 * host_pauses_share(), 2 * wall_s);
	// half of the rounds lie between the quartiles: the median's standard error from them
	double error = 1.25 * (dearer[3 * ROUNDS / 4] - dearer[ROUNDS / 4]) / 1.35 / sqrt(ROUNDS);
	check_report(
	    "what the study loses: %.1f +- %.1f %%; answers take %.2f %% of the processors, a run takes %.3f "
	    "times "
	    "the time",
	    100 * slowed, 200 * error, 100 * share, dearer[ROUNDS / 2]);
	double p99 = latency_quantile(&polls.answers, 0.99);
	assert_true(service_wait(service, id, "running", 1));
	assert_int_equal(polls.late + polls.wrong, 0);
	assert_true(p99 <= 20);
	assert_true(share <= 0.05);
	assert_true(slowed - 2 * error <= 0.05);
	free(polls.answers.answers);
	free(study);
}

CHECK_MAIN(cmocka_unit_test_setup_teardown(a_thousand_pollers_are_served_while_all_workers_are_busy,
                                           service_setup, service_teardown))
