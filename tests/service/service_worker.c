/* `poundd --launcher' and `--worker-listen': results have the same bytes whichever process runs the blocks, also when
 * workers or the server are killed.
 *
 * A finished block is a row of the table `block`, whose key is study and number: a lost block has no row; the runs of a
 * doubled block count twice in the study's `runs_done`. */
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/json/json_pointer.h"
#include "tests/support/groups.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum {
	SIGNALS = 5,
	SEED = 3,
	ROWS = 4 * SERVICE_ROWS, /* of the disturbed study: half a second on one core */
	RUNS = ROWS * 5 * SIGNALS,
	LONG_ROWS = 20 * SERVICE_ROWS,
	SHORT_ROWS = 20,
	GONE_MS = 5000,   /* limit for workers to exit after their server */
	CANCEL_MS = 1000, /* limit for a short study submitted after a cancelled one */
	SOON_MS = 2000,   /* limit for a short study submitted while a long one runs */
};

static struct {
	char pids[64];      /* file of the workers' process ids */
	char launcher[256]; /* command of a worker with one thread; writes its process id to `pids` */
	char *study;
	struct service_bytes reference;
} world;

static int setup(void **state)
{
	(void)state;
	strcpy(world.pids, "/tmp/pound-test-pids-XXXXXX");
	int file = mkstemp(world.pids);
	assert_true(file >= 0);
	close(file);
	const char *build = getenv("POUND_BUILD");
	snprintf(world.launcher, sizeof world.launcher, "echo $$ >>%s; exec %s/pound-worker --threads 1",
	         world.pids, build ? build : "build/release");
	world.study = service_study(ROWS, SIGNALS, SEED);
	world.reference = service_uninterrupted(world.study, 1);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	unlink(world.pids);
	free(world.study);
	free(world.reference.result);
	free(world.reference.samples);
	return 0;
}

/* Starts a server with worker groups; forgets the workers of earlier servers. */
static void start(struct service *service, const char *launcher, const char *launchers)
{
	assert_int_equal(truncate(world.pids, 0), 0);
	setenv("POUNDD_LAUNCHER", launcher, 1);
	setenv("POUNDD_LAUNCHERS", launchers, 1);
	service_start(service, 1);
	unsetenv("POUNDD_LAUNCHER");
	unsetenv("POUNDD_LAUNCHERS");
}

/* Value of a metric in /metrics. */
static double metric(const struct service *service, const char *name)
{
	char line[64];
	struct answer answer = service_get(service, "/metrics");
	snprintf(line, sizeof line, "\n%s ", name);
	const char *at = strstr(answer.body, line);
	assert_non_null(at);
	const double value = strtod(at + strlen(line), NULL);
	answer_free(&answer);
	return value;
}

static void wait_groups(const struct service *service, int n)
{
	while (metric(service, "pound_worker_groups") < n)
		usleep(2000);
}

/* Fails unless the study succeeds with the bytes of the reference and counts each block once. */
static void check_same(const struct service *service, const char *id)
{
	assert_true(service_wait(service, id, "succeeded", 0));
	struct service_bytes bytes = service_bytes(service, id);
	service_bytes_compare(&bytes, &world.reference);
	assert_int_equal(service_number(service, "SELECT sum(runs) FROM block"), RUNS);
	assert_int_equal(service_number(service, "SELECT runs_done FROM study"), RUNS);
}

/* Whether the study is running. */
static bool runs(const struct service *service)
{
	return service_number(service, "SELECT count(*) FROM study WHERE status = 'running'") == 1;
}

static bool logged(const struct service *service, const char *text)
{
	size_t n;
	char *log = program_file(service->log, &n);
	const bool found = log && strstr(log, text);
	free(log);
	return found;
}

static void workers_run_blocks_into_the_database(void **state)
{
	struct service *service = service_new();
	char id[17];
	(void)state;
	start(service, world.launcher, "2");
	assert_true(metric(service, "pound_worker_groups") == 0); // no workers without a study
	service_submit(service, world.study, id);
	check_same(service, id);
	const double n = metric(service, "pound_worker_blocks_total");
	check_report("blocks %d, of them run by 2 worker groups %d; same bytes",
	             (int)service_number(service, "SELECT count(*) FROM block"), (int)n);
	assert_true(n > 0);
	assert_true(logged(service, "worker group 1: connected, 1 thread"));
	service_stop(service);
	groups_gone(world.pids, GONE_MS);
	service_free(service);
}

static void killed_workers_lose_no_block_and_double_none(void **state)
{
	const int n = check_count(20, 500);
	int midway = 0, noticed = 0;
	double blocks = 0;
	(void)state;
	srand(1);
	for (int i = 0; i < n; i++) {
		pid_t pids[GROUPS_PIDS_MAX];
		char id[17];
		struct service *service = service_new();
		start(service, world.launcher, "2");
		service_submit(service, world.study, id);
		groups_wait(world.pids, 2, pids);
		service_wait(service, id, "running", rand() % RUNS);
		assert_int_equal(kill(pids[rand() % 2], SIGKILL), 0);
		midway += runs(service);
		check_same(service, id);
		noticed += logged(service, "the connection ended");
		blocks += metric(service, "pound_worker_blocks_total");
		service_stop(service);
		service_free(service);
	}
	check_report(
	    "workers killed: %d, %d of them while the study ran, noticed %d; blocks run by workers %d; lost 0, "
	    "doubled 0, results that differ 0",
	    n, midway, noticed, (int)blocks);
	assert_true(midway > n / 2 && noticed > 0 && blocks > 0);
}

static void a_killed_server_goes_on_and_its_workers_end(void **state)
{
	const int n = check_count(20, 500);
	int kills = 0, studies = 0, resumed = 0;
	double gone_most = 0;
	(void)state;
	srand(2);
	while (kills < n) {
		struct service *service = service_new();
		char id[17];
		int64_t done = 0;
		start(service, world.launcher, "2");
		service_submit(service, world.study, id);
		for (bool running = true; running && kills < n; kills++) {
			// about four kills per study, some at its very start
			service_wait(service, id, "running", (double)(done - RUNS / 8 + rand() % (RUNS / 2)));
			service_kill(service);
			const double gone = groups_gone(world.pids, GONE_MS);
			gone_most = gone > gone_most ? gone : gone_most;
			running = service_number(service, "SELECT count(*) FROM study WHERE status = 'succeeded'") == 0;
			done = service_number(service, "SELECT ifnull(sum(runs), 0) FROM block");
			resumed += running && done > 0;
			start(service, world.launcher, "2");
		}
		check_same(service, id);
		studies++;
		service_stop(service);
		service_free(service);
	}
	check_report("servers killed: %d, of them with blocks to go on with %d; studies finished %d; workers "
	             "were gone after "
	             "%.2f s at most; blocks lost 0, doubled 0, results that differ 0",
	             kills, resumed, studies, gone_most);
	assert_true(resumed > n / 2);
}

static void a_cancelled_study_leaves_its_workers(void **state)
{
	struct service *service = service_new();
	char *large = service_study(LONG_ROWS, SIGNALS, SEED), long_id[17], id[17];
	(void)state;
	start(service, world.launcher, "2");
	service_submit(service, large, long_id);
	wait_groups(service, 2);
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", long_id);
	struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	// the same workers stop the cancelled blocks and run the next study
	const double start_s = groups_now();
	char *small = service_study(SHORT_ROWS, SIGNALS, SEED);
	service_submit(service, small, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	const double took = groups_now() - start_s;
	check_report("a study after one that was cancelled ended after %.2f s", took);
	assert_true(!check_soaks() || took < 1e-3 * CANCEL_MS);
	assert_true(metric(service, "pound_worker_groups") == 2);
	assert_false(logged(service, "the connection"));
	service_stop(service);
	groups_gone(world.pids, GONE_MS);
	service_free(service);
	free(large);
	free(small);
}

static void a_short_study_ends_soon_behind_a_long_one(void **state)
{
	struct service *service = service_new();
	char *large = service_study(LONG_ROWS, SIGNALS, SEED), *small = service_study(SHORT_ROWS, SIGNALS, SEED),
	     long_id[17], id[17];
	(void)state;
	start(service, world.launcher, "2");
	service_submit(service, large, long_id);
	wait_groups(service, 2);
	usleep(200000);
	const double start_s = groups_now();
	service_submit(service, small, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	const double took = groups_now() - start_s;
	check_report("a short study behind a long one ended after %.2f s", took);
	assert_true(!check_soaks() || took < 1e-3 * SOON_MS);
	assert_true(runs(service));
	service_stop(service);
	service_free(service);
	free(large);
	free(small);
}

static void a_stopped_server_ends_its_workers_and_goes_on(void **state)
{
	struct service *service = service_new();
	char id[17];
	(void)state;
	start(service, world.launcher, "2");
	service_submit(service, world.study, id);
	wait_groups(service, 2);
	const double start_s = groups_now();
	service_stop(service);
	const double stopped = groups_now() - start_s, gone = groups_gone(world.pids, GONE_MS);
	start(service, world.launcher, "1");
	check_same(service, id);
	service_stop(service);
	service_free(service);
	check_report("a server with two groups stopped after %.2f s, its workers were gone %.2f s later", stopped,
	             gone);
}

/* Other threads run the blocks of a stopped worker, and the study ends without it. */
static void a_study_does_not_wait_for_a_worker_that_hangs(void **state)
{
	struct service *service = service_new();
	pid_t pids[GROUPS_PIDS_MAX];
	char id[17], other[17];
	(void)state;
	start(service, world.launcher, "1");
	service_submit(service, world.study, id);
	groups_wait(world.pids, 1, pids);
	while (metric(service, "pound_worker_blocks_total") == 0 && runs(service))
		usleep(2000);
	assert_int_equal(kill(pids[0], SIGSTOP), 0);
	assert_true(runs(service));
	const double start_s = groups_now();
	check_same(service, id);
	check_report("a worker that was stopped with blocks: the study ended after %.1f s, same bytes",
	             groups_now() - start_s);
	// the continued worker and its old blocks do not disturb the next study
	assert_int_equal(kill(pids[0], SIGCONT), 0);
	service_submit(service, world.study, other);
	assert_true(service_wait(service, other, "succeeded", 0));
	service_stop(service);
	service_free(service);
}

/* A launcher in bash whose first message has version 9.9.9. */
static const char stranger[] =
    "exec bash -c 'IFS=: read -r host port token <<<$POUND_WORKER; exec 3<>/dev/tcp/$host/$port; "
    "printf "
    "\"$"
    "token\\1\\0\\0\\0\\1\\0\\0\\0\\0\\0\\0\\0\\5\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0009"
    ".9.9\" >&3; "
    "cat <&3'";

static void a_worker_of_another_version_is_refused(void **state)
{
	struct service *service = service_new();
	char id[17];
	(void)state;
	start(service, stranger, "1");
	service_submit(service, world.study, id);
	check_same(service, id);
	assert_true(logged(service, "refused: pound-worker has version 9.9.9, this program " POUND_VERSION));
	assert_true(metric(service, "pound_worker_blocks_total") == 0);
	service_stop(service);
	service_free(service);
}

static void launchers_that_fail_or_wait_delay_nothing(void **state)
{
	static const char *const launchers[] = {"false", "sleep 99", "/nonexistent/pound-worker"};
	(void)state;
	for (size_t i = 0; i < sizeof launchers / sizeof launchers[0]; i++) {
		struct service *service = service_new();
		char id[17];
		start(service, launchers[i], "2");
		service_submit(service, world.study, id);
		check_same(service, id);
		assert_true(metric(service, "pound_worker_groups") == 0);
		const double start_s = groups_now();
		service_stop(service);
		assert_true(groups_now() - start_s < 1e-3 * GONE_MS);
		service_free(service);
	}
}

static void options_of_workers_that_do_not_fit_are_an_error(void **state)
{
	static const char *const options[][2] = {
	    {"--launchers=2", "--launchers and --worker-host need --launcher"},
	    {"--worker-host=node1", "--launchers and --worker-host need --launcher"},
	    {"--worker-listen=127.0.0.1:0", "--worker-listen and --worker-token-file need each other"},
	    {"--worker-token-file=token", "--worker-listen and --worker-token-file need each other"}};
	(void)state;
	for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
		struct program_outcome outcome =
		    program_run((const char *const[]){"poundd", options[i][0], "--port=0", NULL}, NULL);
		program_expect(&outcome, 1);
		assert_non_null(strstr(outcome.err, options[i][1]));
		program_free(&outcome);
	}
}

/* Starts a server that listens for workers at an address. */
static void start_listening(struct service *service, const char *at, const char *token)
{
	setenv("POUNDD_WORKER_LISTEN", at, 1);
	setenv("POUNDD_WORKER_TOKEN_FILE", token, 1);
	service_start(service, 1);
	unsetenv("POUNDD_WORKER_LISTEN");
	unsetenv("POUNDD_WORKER_TOKEN_FILE");
}

static void workers_that_others_start_outlive_servers_and_may_leave_at_any_time(void **state)
{
	enum { WORKERS = 2 };
	const int n = check_count(10, 500);
	char token[] = "/tmp/pound-test-token-XXXXXX", at[32];
	pid_t workers[WORKERS] = {0};
	int left = 0, kills = 0, studies = 0;
	double blocks = 0;
	(void)state;
	const int file = mkstemp(token);
	for (int i = 0; i < 64; i++)
		assert_int_equal(write(file, "c", 1), 1);
	close(file);
	snprintf(at, sizeof at, "127.0.0.1:%d", groups_port());
	const char *const worker[] = {"pound-worker", "--threads", "1", "--connect", at,
	                              "--token-file", token,       NULL};
	char *study = service_study(LONG_ROWS, SIGNALS, SEED);
	struct service_bytes reference = service_uninterrupted(study, 1);
	srand(3);
	while (kills < n) {
		struct service *service = service_new();
		char id[17];
		start_listening(service, at, token);
		service_submit(service, study, id);
		for (bool running = true; running && kills < n; kills++) {
			const int i = rand() % WORKERS;
			for (int k = 0; k < WORKERS; k++)
				workers[k] = workers[k] ? workers[k] : program_start(worker, "/dev/null", "/dev/null");
			wait_groups(service, WORKERS); // workers of the killed server connect again
			usleep((useconds_t)(rand() % 300000));
			left += runs(service);
			assert_int_equal(kill(workers[i], rand() % 2 ? SIGKILL : SIGTERM), 0);
			program_end(workers[i]);
			workers[i] = 0;
			usleep((useconds_t)(rand() % 50000));
			blocks += metric(service, "pound_worker_blocks_total");
			service_kill(service);
			running = service_number(service, "SELECT count(*) FROM study WHERE status = 'succeeded'") == 0;
			start_listening(service, at, token);
		}
		assert_true(service_wait(service, id, "succeeded", 0));
		struct service_bytes bytes = service_bytes(service, id);
		service_bytes_compare(&bytes, &reference);
		assert_int_equal(service_number(service, "SELECT sum(runs) FROM block"), LONG_ROWS * 5 * SIGNALS);
		assert_int_equal(service_number(service, "SELECT runs_done FROM study"), LONG_ROWS * 5 * SIGNALS);
		blocks += metric(service, "pound_worker_blocks_total");
		studies++;
		service_stop(service);
		service_free(service);
	}
	for (int i = 0; i < WORKERS; i++)
		if (workers[i] && kill(workers[i], SIGTERM) == 0)
			assert_int_equal(program_end(workers[i]), 128 + SIGTERM);
	check_report(
	    "servers killed beside workers that others start: %d, workers ended while a study ran %d, blocks "
	    "that workers "
	    "ran %d; studies finished %d; blocks lost 0, doubled 0, results that differ 0",
	    kills, left, (int)blocks, studies);
	assert_true(blocks > 0 && left > n / 2);
	free(reference.result);
	free(reference.samples);
	free(study);
	unlink(token);
}

/* CPU time of a server's process so far [s]. */
static double own_cpu(const struct service *service)
{
	char path[64], text[1024] = "";
	unsigned long user = 0, kernel = 0;
	snprintf(path, sizeof path, "/proc/%d/stat", (int)service->pid);
	FILE *stat = fopen(path, "r");
	assert_non_null(stat);
	assert_non_null(fgets(text, sizeof text, stat));
	fclose(stat);
	assert_int_equal(
	    sscanf(strrchr(text, ')'), ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user, &kernel),
	    2);
	return (double)(user + kernel) / (double)sysconf(_SC_CLK_TCK);
}

static void cpu_time_of_worker_groups_counts_toward_the_cpu_limit(void **state)
{
	struct service *service = service_new();
	char id[17], *large = service_study(100000, 9, 1);
	(void)state;
	// accepted without the CPU limit of the next start
	service_start(service, 1);
	service_submit(service, large, id);
	service_stop(service);
	setenv("POUNDD_CPU_MAX", "1", 1);
	start(service, world.launcher, "3");
	unsetenv("POUNDD_CPU_MAX");
	assert_true(service_wait(service, id, "failed", 0));
	const double own = own_cpu(service);
	struct answer answer = service_get(service, "/v1/studies/%s", id);
	struct reading *status = answer_read(&answer);
	const double all = reading_number(status, "/cpu_s");
	assert_int_equal(strncmp(reading_text(status, "/error"), "cpu-limit: ", strlen("cpu-limit: ")), 0);
	check_report("failed as cpu-limit of 3 s after %.2f s, of which the server took %.2f", all, own);
	// sanitizers add CPU time to the server
	assert_true(all >= 3 && (!SERVICE_MEMORY || own < 0.9 * all));
	reading_close(status);
	answer_free(&answer);
	service_stop(service);
	groups_gone(world.pids, GONE_MS);
	service_free(service);
	free(large);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(cpu_time_of_worker_groups_counts_toward_the_cpu_limit),
	    cmocka_unit_test(workers_run_blocks_into_the_database),
	    cmocka_unit_test(killed_workers_lose_no_block_and_double_none),
	    cmocka_unit_test(a_killed_server_goes_on_and_its_workers_end),
	    cmocka_unit_test(a_cancelled_study_leaves_its_workers),
	    cmocka_unit_test(a_short_study_ends_soon_behind_a_long_one),
	    cmocka_unit_test(a_stopped_server_ends_its_workers_and_goes_on),
	    cmocka_unit_test(a_study_does_not_wait_for_a_worker_that_hangs),
	    cmocka_unit_test(a_worker_of_another_version_is_refused),
	    cmocka_unit_test(launchers_that_fail_or_wait_delay_nothing),
	    cmocka_unit_test(options_of_workers_that_do_not_fit_are_an_error),
	    cmocka_unit_test(workers_that_others_start_outlive_servers_and_may_leave_at_any_time)};
	(void)argc;
	setup(NULL);
	int failed = check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
	teardown(NULL);
	return failed;
}
