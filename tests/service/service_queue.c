/* The queue: many studies, cancelled and deleted studies, limits of time, CPU and disk. */
#include <dirent.h>
#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/service.h"

/* a study that runs long enough for requests in the meantime */
enum { ROWS = SERVICE_ROWS, SIGNALS = 5 };

static double seconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int ask_status(const struct service *service, const char *method, const char *id, const char *rest)
{
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s%s", id, rest);
	struct answer answer = service_ask(service, &(struct ask){.method = method, .path = path});
	int status = answer.status;
	answer_free(&answer);
	return status;
}

static void two_hundred_queued_studies_all_finish(void **state)
{
	enum { N = 200 };
	struct service *service = *state;
	char last[17];
	for (int i = 0; i < N; i++) {
		char *study = service_study(2, 1, i);
		service_submit(service, study, last);
		free(study);
	}
	// the oldest study runs first, so few are left when the newest is done
	assert_true(service_wait(service, last, "succeeded", 0));
	service_stop(service);
	service_start(service, 2);
	assert_true(service_wait(service, last, "succeeded", 0));
	char *study = service_study(2, 1, N);
	service_submit(service, study, last);
	assert_true(service_wait(service, last, "succeeded", 0));
	free(study);
	service_stop(service);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'succeeded'"), N + 1);
	assert_int_equal(service_number(service, "SELECT count(*) FROM document WHERE name = 'result'"), N + 1);
}

/* Submits a study, waits until a fraction of its runs is done, and ends it by a request. */
static void ended_by(struct service *service, double part, const char *method, const char *rest, int status,
                     char id[17])
{
	char *study = service_study(ROWS, SIGNALS, 1);
	service_submit(service, study, id);
	free(study);
	assert_true(part == 0 || service_wait(service, id, "running", part * ROWS * SIGNALS * 5));
	assert_int_equal(ask_status(service, method, id, rest), status);
}

static void a_study_can_be_cancelled_at_any_moment(void **state)
{
	struct service *service = *state;
	char id[17];
	for (int i = 0; i < 6; i++) {
		ended_by(service, 0.1 * i, "POST", "/cancel", 200, id);
		assert_int_equal(ask_status(service, "POST", id, "/cancel"), 200);
		assert_int_equal(ask_status(service, "GET", id, "/results"), 409);
		assert_int_equal(ask_status(service, "GET", id, "/samples"), 409);
		assert_int_equal(ask_status(service, "GET", id, "/request"), 200);
		struct answer answer = service_get(service, "/v1/studies/%s", id);
		struct reading *status = answer_read(&answer);
		assert_string_equal(reading_text(status, "/status"), "cancelled");
		assert_non_null(reading_text(status, "/finished"));
		reading_close(status);
		answer_free(&answer);
	}
	char *study = service_study(2, 1, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	assert_int_equal(ask_status(service, "POST", id, "/cancel"), 409);
	free(study);
}

/* Submits a study of one long run (about 1e5 impacts per second) and waits until it runs. */
static void submit_long(struct service *service, char id[17])
{
	enum { SAMPLES = 300000 };
	static const char start[] =
	    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1, "
	    "\"damping_ratio\": 0}, {\"rigid_wall\": true}], \"contact\": {\"stiffness_ratio\": 1e10, "
	    "\"restitution\": 1}, \"excitation\": {\"type\": \"record\", \"acceleration_m_s2\": [-1";
	char *study = malloc(sizeof start + 3 * SAMPLES + 8), *end = stpcpy(study, start);
	for (int t = 1; t < SAMPLES; t++)
		end = stpcpy(end, ",-1");
	strcpy(end, "]}}}");
	service_submit(service, study, id);
	free(study);
	assert_true(service_wait(service, id, "running", 0));
}

static void one_run_of_many_minutes_is_cancelled_and_holds_no_server_that_is_to_end(void **state)
{
	struct service *service = *state;
	char ids[2][17], small_id[17], *small = service_study(2, 1, 1);
	for (int worker = 0; worker < 2; worker++)
		submit_long(service, ids[worker]);
	for (int worker = 0; worker < 2; worker++)
		assert_int_equal(ask_status(service, "POST", ids[worker], "/cancel"), 200);
	service_submit(service, small, small_id);
	assert_true(service_wait(service, small_id, "succeeded", 0));
	for (int worker = 0; worker < 2; worker++)
		submit_long(service, ids[worker]);
	service_stop(service);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'queued'"), 2);
	free(small);
}

static void a_queued_study_has_its_place_in_the_queue(void **state)
{
	enum { LONG = 2, STUDIES = 8 }; // LONG: one for each worker
	struct service *service = *state;
	char id[17];
	for (int i = 0; i < STUDIES; i++) {
		char *study = service_study(2, 1, i + 1);
		if (i < LONG)
			submit_long(service, id);
		else
			service_submit(service, study, id);
		free(study);
	}
	struct answer answer = service_get(service, "/v1/studies?limit=%d", STUDIES);
	struct reading *page = answer_read(&answer);
	int queued = 0;
	// the list is newest first, the oldest queued study runs next
	for (int i = STUDIES - 1; i >= 0; i--)
		if (!strcmp(reading_text(page, "/studies/%d/status", i), "queued")) {
			check_near(reading_number(page, "/studies/%d/queue_position", i), ++queued, 0);
			// no study is expected to start before it was created
			assert_int_equal(strlen(reading_text(page, "/studies/%d/expected_start", i)),
			                 strlen("2026-01-01T00:00:00Z"));
			assert_true(strncmp(reading_text(page, "/studies/%d/expected_start", i),
			                    reading_text(page, "/studies/%d/created", i),
			                    strlen("2026-01-01T00:00:00")) >= 0);
		} else {
			assert_true(isnan(reading_number(page, "/studies/%d/queue_position", i)));
			assert_null(reading_text(page, "/studies/%d/expected_start", i));
		}
	assert_true(queued > 0 && queued < STUDIES);
	reading_close(page);
	answer_free(&answer);
}

/* Fails unless a study fails with this reason (the start of its error text). */
static void failed_as(const struct service *service, const char *id, const char *reason)
{
	assert_true(service_wait(service, id, "failed", 0));
	struct answer answer = service_get(service, "/v1/studies/%s", id);
	struct reading *status = answer_read(&answer);
	assert_int_equal(strncmp(reading_text(status, "/error"), reason, strlen(reason)), 0);
	reading_close(status);
	answer_free(&answer);
}

static void a_study_that_runs_for_too_long_has_failed(void **state)
{
	(void)state;
	const char *const settings[][2] = {{"POUNDD_TIME_MAX", "1"}, {NULL}};
	struct service *service = service_with(settings, 2);
	char ids[2][17], small_id[17], *small = service_study(2, 1, 1);
	// all workers are busy with a run that exceeds the time limit
	for (int worker = 0; worker < 2; worker++)
		submit_long(service, ids[worker]);
	service_submit(service, small, small_id);
	for (int worker = 0; worker < 2; worker++) {
		failed_as(service, ids[worker], "timeout: ");
	}
	assert_true(service_wait(service, small_id, "succeeded", 0));
	free(small);
	service_free(service);
}

static void a_study_that_takes_far_more_than_the_cpu_limit_has_failed(void **state)
{
	(void)state;
	struct service *service = service_with((const char *const[][2]){{NULL}}, 1);
	char id[17], small_id[17], *large = service_study(100000, 9, 1), *small = service_study(2, 1, 1);
	// accepted without the CPU limit of the next start, like a study whose estimate is too low
	service_submit(service, large, id);
	service_stop(service);
	setenv("POUNDD_CPU_MAX", "1", 1);
	service_start(service, 1);
	unsetenv("POUNDD_CPU_MAX");
	service_submit(service, small, small_id);
	failed_as(service, id, "cpu-limit: ");
	assert_true(service_wait(service, small_id, "succeeded", 0));
	free(large);
	free(small);
	service_free(service);
}

static void a_cancelled_study_has_times_in_order_though_the_clock_went_back(void **state)
{
	struct service *service = *state;
	char *study = service_study(ROWS, SIGNALS, 1), id[17];
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "running", 1));
	service_stop(service);
	service_change(service, "UPDATE study SET started = created + 7200000");
	service_start(service, 2);
	assert_int_equal(ask_status(service, "POST", id, "/cancel"), 200);
	assert_int_equal(service_number(service, "SELECT finished >= started FROM study"), 1);
	free(study);
}

static void a_study_can_be_deleted_at_any_moment(void **state)
{
	struct service *service = *state;
	char id[17];
	for (int i = 0; i < 6; i++) {
		ended_by(service, 0.1 * i, "DELETE", "", 204, id);
		assert_int_equal(ask_status(service, "GET", id, ""), 404);
		assert_int_equal(ask_status(service, "DELETE", id, ""), 404);
	}
	char *study = service_study(2, 1, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	assert_int_equal(ask_status(service, "DELETE", id, ""), 204);
	free(study);
	service_stop(service);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 0);
	assert_int_equal(service_number(service, "SELECT count(*) FROM document"), 0);
	assert_int_equal(service_number(service, "SELECT count(*) FROM block"), 0);
}

static void short_studies_end_soon_behind_a_long_one(void **state)
{
	enum { SHORT = 3, LONG_ROWS = 6 * SERVICE_ROWS };
	struct service *service = *state;
	char long_id[17], ids[SHORT][17], *long_study = service_study(LONG_ROWS, SIGNALS, 1);
	struct service_bytes bytes;
	service_submit(service, long_study, long_id);
	assert_true(service_wait(service, long_id, "running", 1));
	double start = seconds();
	for (int i = 0; i < SHORT; i++) {
		char *study = service_study(10, SIGNALS, i);
		service_submit(service, study, ids[i]);
		free(study);
	}
	for (int i = 0; i < SHORT; i++)
		assert_true(service_wait(service, ids[i], "succeeded", 0));
	double short_s = seconds() - start;
	struct answer answer = service_get(service, "/v1/studies/%s", long_id);
	struct reading *status = answer_read(&answer);
	assert_string_equal(reading_text(status, "/status"), "running");
	reading_close(status);
	answer_free(&answer);
	assert_true(service_wait(service, long_id, "succeeded", 0));
	check_report("three short studies behind a long one of %.1f s end after %.2f s", seconds() - start,
	             short_s);
	// the order in which blocks of different studies run changes no byte
	for (int i = 0; i <= SHORT; i++) {
		char *study = i < SHORT ? service_study(10, SIGNALS, i) : strdup(long_study);
		struct service_bytes alone = service_uninterrupted(study, 1);
		bytes = service_bytes(service, i < SHORT ? ids[i] : long_id);
		service_bytes_compare(&bytes, &alone);
		free(alone.result);
		free(alone.samples);
		free(study);
	}
	free(long_study);
}

/* Number of threads of a process with a higher nice value than its first thread (worker threads) and at least `least`
 * seconds of CPU time. */
static int nice_threads(pid_t pid, double least)
{
	char path[64], line[512];
	int n = 0, first = getpriority(PRIO_PROCESS, (id_t)pid);
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	assert_non_null(tasks);
	for (struct dirent *task = readdir(tasks); task; task = readdir(tasks)) {
		snprintf(path, sizeof path, "/proc/%d/task/%.16s/stat", (int)pid, task->d_name);
		FILE *file = fopen(path, "r");
		if (!file || !fgets(line, sizeof line, file)) // `.` and `..`
			continue;
		fclose(file);
		long user, nice;
		const char *fields = strrchr(line, ')');
		assert_int_equal(sscanf(fields,
		                        ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %ld %*d %*d %*d %*d %ld",
		                        &user, &nice),
		                 2);
		n += nice > first && (double)user / (double)sysconf(_SC_CLK_TCK) >= least;
	}
	closedir(tasks);
	return n;
}

static void all_workers_run_the_blocks_of_one_study(void **state)
{
	struct service *service = *state;
	char id[17];
	char *study = service_study(ROWS, SIGNALS, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
	struct answer answer = service_get(service, "/v1/studies/%s/results", id);
	struct reading *result = answer_read(&answer);
	// an equal share is a half; a worker that ran only the last block has less than a tenth
	assert_int_equal(nice_threads(service->pid, 0.1 * reading_number(result, "/timing/cpu_s")), 2);
	reading_close(result);
	answer_free(&answer);
}

/* Limits the size of files that the server writes; reads are not affected. */
static void limit_files(const struct service *service, rlim_t bytes)
{
	const struct rlimit limit = {.rlim_cur = bytes, .rlim_max = RLIM_INFINITY};
	assert_int_equal(prlimit(service->pid, RLIMIT_FSIZE, &limit, NULL), 0);
}

static void a_full_disk_refuses_studies_and_holds_those_that_run_until_it_is_free(void **state)
{
	struct service *service = *state;
	char id[17];
	char *study = service_study(ROWS, SIGNALS, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "running", 1));
	limit_files(service, 1);
	struct answer refused = service_post(service, study);
	assert_int_equal(refused.status, 503);
	assert_true(atoi(refused.retry_after) >= 1);
	assert_int_equal(ask_status(service, "GET", id, ""), 200);
	assert_int_equal(ask_status(service, "GET", id, "/request"), 200);
	limit_files(service, RLIM_INFINITY);
	assert_true(service_wait(service, id, "succeeded", 0));
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 1);
	answer_free(&refused);
	free(study);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(two_hundred_queued_studies_all_finish), SERVED(a_study_can_be_cancelled_at_any_moment),
           SERVED(a_queued_study_has_its_place_in_the_queue),
           SERVED(one_run_of_many_minutes_is_cancelled_and_holds_no_server_that_is_to_end),
           cmocka_unit_test(a_study_that_runs_for_too_long_has_failed),
           cmocka_unit_test(a_study_that_takes_far_more_than_the_cpu_limit_has_failed),
           SERVED(a_cancelled_study_has_times_in_order_though_the_clock_went_back),
           SERVED(a_study_can_be_deleted_at_any_moment), SERVED(all_workers_run_the_blocks_of_one_study),
           SERVED(short_studies_end_soon_behind_a_long_one),
           SERVED(a_full_disk_refuses_studies_and_holds_those_that_run_until_it_is_free))
