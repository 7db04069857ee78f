/* A full disk: a tmpfs of 8 MiB; skipped unless root can mount it.  service_queue has a test without root, in which the
 * size of the server's files is limited. */
#include <fcntl.h>
#include <string.h>
#include <sys/mount.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum { ROWS = SERVICE_ROWS, SIGNALS = 5, SEED = 7, RUNS = ROWS * 5 * SIGNALS };

static char log_path[64];

/* A service whose directory is a small disk; its log is elsewhere. */
static int small_disk(void **state)
{
	struct service *service = service_new();
	strcpy(log_path, "/tmp/poundd-log-XXXXXX");
	close(mkstemp(log_path));
	strcpy(service->log, log_path);
	*state = service;
	if (mount("tmpfs", service->directory, "tmpfs", 0, "size=8m") != 0) {
		unlink(log_path);
		service_free(service);
		*state = NULL;
	}
	return 0;
}

static int large_disk(void **state)
{
	struct service *service = *state;
	if (!service)
		return 0;
	if (service->pid)
		service_kill(service);
	assert_int_equal(umount(service->directory), 0);
	unlink(log_path);
	service_free(service);
	return 0;
}

/* Fills the disk. */
static void fill(const struct service *service)
{
	static const char zeros[4096];
	char path[96];
	snprintf(path, sizeof path, "%s/filler", service->directory);
	int file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
	assert_true(file >= 0);
	for (size_t n = sizeof zeros; n > 0; n /= 2)
		while (write(file, zeros, n) == (ssize_t)n)
			;
	close(file);
}

static void empty(const struct service *service)
{
	char path[96];
	snprintf(path, sizeof path, "%s/filler", service->directory);
	assert_int_equal(unlink(path), 0);
}

static int status_of(const struct service *service, const char *method, const char *format, const char *id)
{
	char path[96];
	snprintf(path, sizeof path, format, id);
	struct answer answer = service_ask(service, &(struct ask){.method = method, .path = path});
	int status = answer.status;
	answer_free(&answer);
	return status;
}

/* Fails unless requests that only read are answered; returns their number. */
static int read_all(const struct service *service, const char *done, const char *running)
{
	static const char *const paths[] = {"/v1/studies/%s", "/v1/studies/%s/request", "/v1/studies/%s/results",
	                                    "/v1/studies/%s/samples"};
	int n = 0;
	for (int i = 0; i < 4; i++, n++)
		assert_int_equal(status_of(service, "GET", paths[i], done), 200);
	assert_int_equal(status_of(service, "GET", paths[0], running), 200);
	assert_int_equal(status_of(service, "GET", "/v1/studies", ""), 200);
	assert_int_equal(status_of(service, "GET", "/livez", ""), 200);
	return n + 3;
}

static void refuse(const struct service *service, const char *study)
{
	struct answer answer = service_post(service, study);
	assert_int_equal(answer.status, 503);
	assert_non_null(strstr(answer.body, "the disk has no room for new studies"));
	assert_true(atoi(answer.retry_after) >= 1);
	answer_free(&answer);
	assert_int_equal(status_of(service, "GET", "/readyz", ""), 503);
}

/* Waits until the server's log reports the full disk. */
static void await_full(void)
{
	for (char *text = NULL;;) {
		free(text);
		text = program_file(log_path, NULL);
		if (strstr(text, "full")) {
			free(text);
			return;
		}
		usleep(5000);
	}
}

static char *undisturbed(const char *study)
{
	struct service *service = service_new();
	char id[17];
	service_start(service, 2);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer answer = service_get(service, "/v1/studies/%s/results", id);
	service_stop(service);
	service_free(service);
	return service_timeless(answer.body);
}

static void a_full_disk_refuses_studies_answers_questions_and_is_survived(void **state)
{
	struct service *service = *state;
	if (!service) {
		check_report("needs root, for a disk of its own");
		skip();
	}
	char *small = service_study(20, 1, 1), *large = service_study(ROWS, SIGNALS, SEED);
	char done[17], running[17];
	int reads = 0;
	service_start(service, 2);
	service_submit(service, small, done);
	assert_true(service_wait(service, done, "succeeded", 0));
	service_submit(service, large, running);
	assert_true(service_wait(service, running, "running", 1));
	fill(service);
	refuse(service, small);
	await_full();
	reads += read_all(service, done, running);
	// a server that starts on a full disk answers, too
	service_kill(service);
	fill(service);
	service_start(service, 2);
	refuse(service, small);
	reads += read_all(service, done, running);
	// a study can be deleted on a full disk
	assert_int_equal(status_of(service, "DELETE", "/v1/studies/%s", done), 204);
	fill(service);
	refuse(service, small);
	assert_int_equal(status_of(service, "GET", "/v1/studies/%s", running), 200);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE finished IS NULL"), 1);
	empty(service);
	assert_true(service_wait(service, running, "succeeded", 0));
	assert_int_equal(status_of(service, "GET", "/readyz", ""), 200);
	service_submit(service, small, done);
	assert_true(service_wait(service, done, "succeeded", 0));
	struct answer answer = service_get(service, "/v1/studies/%s/results", running);
	char *want = undisturbed(large);
	assert_string_equal(service_timeless(answer.body), want);
	char *check = service_text(service, "PRAGMA integrity_check");
	assert_string_equal(check, "ok");
	check_report(
	    "full disk: studies refused 3 of 3, questions answered %d of %d, a kill and a removal meanwhile; the "
	    "study that ran goes on when there is room, to the same bytes",
	    reads, reads);
	answer_free(&answer);
	free(check);
	free(want);
	free(small);
	free(large);
}

/* Posts studies that need about 0.1 MiB each until one is refused; returns the number of accepted studies. */
static int fill_by_studies(const struct service *service, char (*ids)[17], int most)
{
	static const char study[] = "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": "
	                            "2}, {\"frequency_hz\": 3}], "
	                            "\"excitation\": {\"frequency_hz\": 5, \"cycles\": 2, \"signals\": 100}}}";
	int n = 0;
	for (int status = 201; status == 201 && n < most;) {
		struct answer answer = service_post(service, study);
		status = answer.status;
		if (status == 201) {
			memcpy(ids[n], answer.location + strlen("/v1/studies/"), 17);
			assert_true(service_wait(service, ids[n++], "succeeded", 0));
		}
		answer_free(&answer);
	}
	return n;
}

static void studies_that_are_deleted_make_room(void **state)
{
	enum { MOST = 300 };
	static char ids[MOST][17];
	struct service *service = *state;
	if (!service) {
		check_report("needs root, for a disk of its own");
		skip();
	}
	service_start(service, 1);
	const int first = fill_by_studies(service, ids, MOST);
	assert_true(first > 2 && first < MOST);
	assert_int_equal(status_of(service, "GET", "/readyz", ""), 503);
	for (int i = 0; i < first; i++)
		assert_int_equal(status_of(service, "DELETE", "/v1/studies/%s", ids[i]), 204);
	assert_int_equal(status_of(service, "GET", "/readyz", ""), 200);
	const int second = fill_by_studies(service, ids, MOST);
	check_report("a disk of 8 MiB: %d studies until 503, and after all were deleted %d more", first, second);
	assert_true(second >= first - 1);
	assert_int_equal(status_of(service, "GET", "/v1/studies/%s/results", ids[second - 1]), 200);
}

CHECK_MAIN(cmocka_unit_test_setup_teardown(studies_that_are_deleted_make_room, small_disk, large_disk),
           cmocka_unit_test_setup_teardown(a_full_disk_refuses_studies_answers_questions_and_is_survived,
                                           small_disk, large_disk))
