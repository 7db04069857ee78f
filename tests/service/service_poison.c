/* A study that makes the server crash fails after three crashes, or ten kills, and the others finish.
 *
 * A child process runs the server's store and workers; the parent starts it again after a crash, as systemd would.
 * Blocks of the study with seed POISON crash instead of running: the linker replaces pound_run_block by
 * __wrap_pound_run_block. */
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/pound.h"
#include "server/store.h"
#include "server/workers.h"
#include "tests/support/service.h"

enum { POISON = 666, STUDIES = 11, POISON_AT = 4 };

static _Atomic(const struct pound_run *) poisoned;
static int crash_signal; /* 0: none */

struct pound_run *__real_pound_run_create_by(const struct pound_study *study, int n_workers,
                                             const atomic_bool *stop);
struct pound_run *__wrap_pound_run_create_by(const struct pound_study *study, int n_workers,
                                             const atomic_bool *stop);
enum pound_status __real_pound_run_block(struct pound_run *run, int block, int worker);
enum pound_status __wrap_pound_run_block(struct pound_run *run, int block, int worker);

struct pound_run *__wrap_pound_run_create_by(const struct pound_study *study, int n_workers,
                                             const atomic_bool *stop)
{
	struct pound_run *run = __real_pound_run_create_by(study, n_workers, stop);
	if (study->design.seed == POISON)
		poisoned = run;
	return run;
}

enum pound_status __wrap_pound_run_block(struct pound_run *run, int block, int worker)
{
	if (run == poisoned && crash_signal)
		raise(crash_signal);
	return __real_pound_run_block(run, block, worker);
}

static void submit(struct store *store, int seed)
{
	const struct store_study study = {.kind = "sensitivity", .runs = 10, .hash = "hash"};
	char *document = service_study(2, 1, seed);
	int64_t id;
	assert_int_equal(store_submit(store, &study, document, strlen(document), &id), STORE_OK);
	free(document);
}

/* The server: runs the queued studies and exits, unless it crashes. */
static void serve(const char *path)
{
	const struct rlimit none = {0, 0};
	setrlimit(RLIMIT_CORE, &none);
	// remove the signal handlers of the test framework
	for (int i = 1; i < SIGRTMIN; i++)
		signal(i, SIG_DFL);
	struct store *store = store_open(path);
	struct work *work = store ? work_start(store, 2, 3600, 3600, INT64_MAX, &(const struct launch){0}) : NULL;
	int64_t queued = 1, running = 1;
	while (work && queued + running > 0) {
		store_count(store, "queued", &queued);
		store_count(store, "running", &running);
		usleep(1000);
	}
	if (work)
		work_stop(work, true);
	if (store)
		store_close(store);
	_exit(work ? 0 : 1);
}

/* Runs the server until it exits with 0, at most 20 times; returns the number of crashes. */
static int crashes_of(const struct service *service, const int signals[], int n)
{
	int crashes = 0, status = 0;
	do {
		crash_signal = crashes < n ? signals[crashes] : SIGABRT;
		pid_t pid = fork();
		if (pid == 0)
			serve(service->database);
		assert_int_equal(waitpid(pid, &status, 0), pid);
		crashes += status != 0;
	} while (status != 0 && crashes < 20);
	return crashes;
}

static void a_study_that_crashes_the_server_three_times_fails_and_the_others_finish(void **state)
{
	static const int signals[] = {SIGABRT, SIGSEGV, SIGFPE};
	struct service *service = service_new();
	struct store *store = store_open(service->database);
	(void)state;
	assert_non_null(store);
	for (int i = 0; i < STUDIES; i++)
		submit(store, i == POISON_AT ? POISON : i);
	store_close(store);
	int crashes = crashes_of(service, signals, 3);
	char *error = service_text(service, "SELECT error FROM study WHERE status = 'failed'");
	int64_t succeeded = service_number(service, "SELECT count(*) FROM study WHERE status = 'succeeded'");
	check_report("a poisonous study among %d: crashes %d, succeeded %lld, failed: %s", STUDIES, crashes,
	             (long long)succeeded, error);
	assert_int_equal(crashes, 3);
	assert_int_equal(succeeded, STUDIES - 1);
	assert_int_equal(strncmp(error, "poison-study: ", 14), 0);
	assert_int_equal(service_number(service, "SELECT id FROM study WHERE status = 'failed'"),
	                 service_number(service, "SELECT id FROM study ORDER BY id LIMIT 1 OFFSET 4"));
	free(error);
	service_free(service);
}

static void a_study_of_which_ten_servers_are_killed_fails_and_the_others_finish(void **state)
{
	static const int signals[] = {SIGKILL, SIGKILL, SIGKILL, SIGKILL, SIGKILL, SIGKILL,
	                              SIGKILL, SIGKILL, SIGKILL, SIGKILL, SIGKILL, SIGKILL};
	struct service *service = service_new();
	struct store *store = store_open(service->database);
	(void)state;
	assert_non_null(store);
	for (int i = 0; i < STUDIES; i++)
		submit(store, i == POISON_AT ? POISON : i);
	// an orderly stop does not count as a kill
	struct store_claimed claimed;
	for (int i = 0; i < 20; i++) {
		assert_int_equal(store_claim(store, INT64_MAX, "", &claimed), STORE_OK);
		store_close(store);
		store = store_open(service->database);
		assert_non_null(store);
	}
	store_close(store);
	int kills = crashes_of(service, signals, 12);
	char *error = service_text(service, "SELECT error FROM study WHERE status = 'failed'");
	check_report("a study among %d of which servers are killed: %d, failed: %s", STUDIES, kills, error);
	assert_int_equal(kills, 10);
	assert_int_equal(strncmp(error, "out-of-memory-or-crash: ", 24), 0);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'succeeded'"),
	                 STUDIES - 1);
	free(error);
	service_free(service);
}

static void a_study_that_crashes_the_server_twice_and_then_runs_has_succeeded(void **state)
{
	static const int signals[] = {SIGABRT, SIGABRT, 0};
	struct service *service = service_new();
	struct store *store = store_open(service->database);
	(void)state;
	assert_non_null(store);
	submit(store, POISON);
	store_close(store);
	assert_int_equal(crashes_of(service, signals, 3), 2);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'succeeded'"), 1);
	assert_int_equal(service_number(service, "SELECT attempt FROM study"), 3);
	service_free(service);
}

CHECK_MAIN(cmocka_unit_test(a_study_that_crashes_the_server_three_times_fails_and_the_others_finish),
           cmocka_unit_test(a_study_of_which_ten_servers_are_killed_fails_and_the_others_finish),
           cmocka_unit_test(a_study_that_crashes_the_server_twice_and_then_runs_has_succeeded))
