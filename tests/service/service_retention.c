/* service_retention.c - how long a server keeps studies and their samples. */
#include <string.h>
#include <unistd.h>

#include "tests/support/service.h"

static const char *const kept[][2] = {
    {"POUNDD_KEEP_DAYS", "30"}, {"POUNDD_KEEP_SAMPLES_DAYS", "7"}, {NULL, NULL}};

static int status_of(const struct service *service, const char *path, const char *id)
{
	struct answer answer = service_get(service, path, id);
	const int status = answer.status;
	answer_free(&answer);
	return status;
}

/* Waits until a query gives 0; fails after 10 s. */
static void zero_await(const struct service *service, const char *sql)
{
	for (int i = 0; service_number(service, sql) != 0; i++) {
		assert_true(i < 1000);
		usleep(10000);
	}
}

/* Finished studies of today, of 8 days ago and of 31 days ago, and one of 31 days ago that still runs. */
static void studies_and_samples_are_deleted_when_their_time_is_up(void **state)
{
	struct service *service = service_new();
	char ids[3][17], running[17], *long_study = service_study(SERVICE_ROWS, 5, 9);
	(void)state;
	service_start(service, 1);
	for (int i = 0; i < 3; i++) {
		char *study = service_study(4, 2, i);
		service_submit(service, study, ids[i]);
		assert_true(service_wait(service, ids[i], "succeeded", 0));
		free(study);
	}
	service_submit(service, long_study, running);
	service_kill(service);
	static const int days[] = {0, 8, 31, 31};
	for (int i = 0; i < 4; i++) {
		char sql[256];
		snprintf(sql, sizeof sql,
		         "UPDATE study SET created = created - %d * 86400000, started = started - %d * 86400000, "
		         "finished = finished - %d * 86400000 WHERE id = (SELECT id FROM study ORDER BY id LIMIT 1 "
		         "OFFSET %d)",
		         days[i], days[i], days[i], i);
		service_change(service, sql);
	}
	// without the options nothing is deleted
	service_start(service, 1);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 4);
	assert_int_equal(status_of(service, "/v1/studies/%s/samples", ids[2]), 200);
	service_stop(service);
	for (int i = 0; kept[i][0]; i++)
		setenv(kept[i][0], kept[i][1], 1);
	service_start(service, 1);
	for (int i = 0; kept[i][0]; i++)
		unsetenv(kept[i][0]);
	zero_await(
	    service,
	    "SELECT count(*) FROM study WHERE finished < (SELECT max(created) FROM study) - 30 * 86400000");
	zero_await(service, "SELECT count(*) FROM block JOIN study ON study = id WHERE finished < "
	                    "(SELECT max(created) FROM study) - 7 * 86400000");
	struct answer none = service_get(service, "/v1/studies/%s", ids[2]);
	assert_int_equal(none.status, 404);
	assert_non_null(strstr(none.body, "there is no such study"));
	answer_free(&none);
	assert_int_equal(
	    service_number(service, "SELECT count(*) FROM document WHERE study NOT IN (SELECT id FROM study)"),
	    0);
	// the result and its figures remain; the deleted samples are not reported as damaged
	assert_int_equal(status_of(service, "/v1/studies/%s/results", ids[1]), 200);
	assert_int_equal(status_of(service, "/v1/studies/%s/figures/indices", ids[1]), 200);
	struct answer gone = service_get(service, "/v1/studies/%s/samples", ids[1]);
	assert_int_equal(gone.status, 409);
	assert_non_null(strstr(gone.body, "the samples of this study are no longer stored"));
	answer_free(&gone);
	assert_int_equal(status_of(service, "/v1/studies/%s/samples", ids[0]), 200);
	assert_true(service_wait(service, running, "succeeded", 0));
	assert_int_equal(status_of(service, "/v1/studies/%s/samples", running), 200);
	service_stop(service);
	free(long_study);
	service_free(service);
}

CHECK_MAIN(cmocka_unit_test(studies_and_samples_are_deleted_when_their_time_is_up))
