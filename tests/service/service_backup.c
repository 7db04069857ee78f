/* Copies of a database made while studies are submitted and run: each is a complete database that a server can use.
 * Databases removed, replaced or restored under a server. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "server/store.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum { COPIES = 20, IDS_MAX = 3 * COPIES + 60 };

static char ids[IDS_MAX][17];
static int n_ids;

static void submit(const struct service *service, int rows)
{
	char *study = service_study(rows, 5, n_ids);
	service_submit(service, study, ids[n_ids++]);
	free(study);
}

/* Number of results in a copy; fails unless each equals the server's. */
static int compare(const struct service *service, const char *path)
{
	int n = 0;
	struct store *store = store_open(path);
	assert_non_null(store);
	for (int i = 0; i < n_ids; i++) {
		char *result;
		size_t length;
		enum store_status status =
		    store_document(store, (int64_t)strtoull(ids[i], NULL, 16), "result", &result, &length);
		assert_true(status == STORE_OK || status == STORE_NONE);
		if (status != STORE_OK)
			continue;
		struct answer answer = service_get(service, "/v1/studies/%s/results", ids[i]);
		assert_int_equal(answer.status, 200);
		assert_int_equal(answer.length, length);
		assert_memory_equal(answer.body, result, length);
		answer_free(&answer);
		free(result);
		n++;
	}
	store_close(store);
	return n;
}

static void a_copy_made_while_studies_run_is_a_whole_database(void **state)
{
	struct service *service = *state;
	int results = 0;
	char path[128];
	for (int k = 0; k < COPIES; k++) {
		submit(service, 2);
		submit(service, 60);
		submit(service, 2);
		snprintf(path, sizeof path, "%s/copy-%d.db", service->directory, k);
		const char *const copying[] = {"poundd", "--database", service->database, "--backup", path, NULL};
		struct program_outcome outcome = program_run(copying, NULL);
		program_expect(&outcome, 0);
		program_free(&outcome);
		// studies accepted before the copy are in it
		struct service copy = *service;
		strcpy(copy.database, path);
		assert_int_equal(service_number(&copy, "SELECT count(*) FROM study"), n_ids);
		char *check = service_text(&copy, "PRAGMA integrity_check");
		assert_string_equal(check, "ok");
		free(check);
		results += compare(service, path);
		outcome = program_run(copying, NULL);
		program_expect(&outcome, 1); // the file exists
		program_free(&outcome);
	}
	check_report("copies while %d studies were submitted and run: %d, whole %d, with %d results, all of the "
	             "same bytes",
	             n_ids, COPIES, COPIES, results);
	assert_true(results > COPIES);
	// a server on the last copy runs its unfinished studies
	service_stop(service);
	strcpy(service->database, path);
	service_start(service, 2);
	for (int i = 0; i < n_ids; i++)
		assert_true(service_wait(service, ids[i], "succeeded", 0));
}

static void copy(const char *path, const char *to, int status)
{
	struct program_outcome outcome =
	    program_run((const char *const[]){"poundd", "--database", path, "--backup", to, NULL}, NULL);
	program_expect(&outcome, status);
	program_free(&outcome);
}

static void a_copy_can_be_copied(void **state)
{
	struct service *service = *state;
	char first[128], second[128];
	snprintf(first, sizeof first, "%s/first.db", service->directory);
	snprintf(second, sizeof second, "%s/second.db", service->directory);
	submit(service, 2);
	copy(service->database, first, 0);
	copy(first, second, 0);
	struct service last = *service;
	strcpy(last.database, second);
	assert_int_equal(service_number(&last, "SELECT count(*) FROM study"),
	                 service_number(service, "SELECT count(*) FROM study"));
}

static const char REPLACED[] =
    "the database file was removed or replaced: nothing is accepted until the server is restarted";

/* Fails unless a POST, a DELETE and /readyz are answered with 503. */
static void nothing_is_accepted(const struct service *service, const char *why)
{
	char *study = service_study(2, 1, 99), path[64];
	struct answer answer = service_post(service, study);
	assert_int_equal(answer.status, 503);
	assert_non_null(strstr(answer.body, why));
	answer_free(&answer);
	answer = service_get(service, "/readyz");
	assert_int_equal(answer.status, 503);
	answer_free(&answer);
	snprintf(path, sizeof path, "/v1/studies/%s", ids[0]);
	answer = service_ask(service, &(struct ask){.method = "DELETE", .path = path});
	// 404: an earlier call may have deleted the study in the renamed file
	assert_true(answer.status == 503 || answer.status == 404);
	answer_free(&answer);
	free(study);
}

static void a_database_that_is_replaced_under_a_server_is_not_written_to(void **state)
{
	static const char *const ends[] = {"", "-lock"};
	struct service *service = *state;
	char name[128], aside[160];
	n_ids = 0;
	submit(service, 2);
	assert_true(service_wait(service, ids[0], "succeeded", 0));
	for (int i = 0; i < 2; i++) {
		snprintf(name, sizeof name, "%s%s", service->database, ends[i]);
		snprintf(aside, sizeof aside, "%s-aside", name);
		assert_int_equal(rename(name, aside), 0); // removed
		nothing_is_accepted(service, REPLACED);
		FILE *other = fopen(name, "w"); // replaced
		fclose(other);
		nothing_is_accepted(service, REPLACED);
		assert_int_equal(rename(aside, name), 0); // put back
		submit(service, 2);
		assert_true(service_wait(service, ids[n_ids - 1], "succeeded", 0));
	}
	check_report("database and lock removed, then replaced under a server: 4 of 4 studies refused with 503; "
	             "put back: accepted");
	char *log = program_file(service->log, NULL);
	assert_non_null(strstr(log, "was removed or replaced while the server runs"));
	free(log);
}

static void a_second_server_after_the_lock_is_removed_is_alone(void **state)
{
	struct service *service = *state, second = *service;
	char name[128];
	n_ids = 0;
	submit(service, 2);
	snprintf(name, sizeof name, "%s-lock", service->database);
	assert_int_equal(unlink(name), 0);
	snprintf(second.log, sizeof second.log, "%s/second", service->directory);
	second.pid = 0;
	service_start(&second, 1);
	nothing_is_accepted(service, REPLACED);
	submit(&second, 2);
	service_kill(service);
	assert_true(service_wait(&second, ids[n_ids - 1], "succeeded", 0));
	service_stop(&second);
	unlink(second.log);
}

/* Overwrites a file with the content of another. */
static void overwrite(const char *from, const char *to)
{
	size_t n;
	char *bytes = program_file(from, &n);
	FILE *file = fopen(to, "w");
	assert_non_null(bytes);
	assert_int_equal(fwrite(bytes, 1, n, file), n);
	fclose(file);
	free(bytes);
}

static void restore(const struct service *service, const char *from, int status)
{
	struct program_outcome outcome = program_run(
	    (const char *const[]){"poundd", "--database", service->database, "--restore", from, NULL}, NULL);
	program_expect(&outcome, status);
	program_free(&outcome);
}

static void a_wal_is_not_applied_to_another_database(void **state)
{
	struct service *service = *state;
	char backup[128], line[128], wal[128];
	n_ids = 0;
	snprintf(backup, sizeof backup, "%s/backup.db", service->directory);
	snprintf(wal, sizeof wal, "%s-wal", service->database);
	copy(service->database, backup, 0);
	for (int i = 0; i < 20; i++)
		submit(service, 2);
	service_kill(service);
	assert_int_equal(access(wal, F_OK), 0);
	// a restore by hand: another file of that name beside the old WAL
	unlink(service->database);
	overwrite(backup, service->database);
	assert_int_not_equal(service_run(service, 1), 0);
	char *log = program_file(service->log, NULL);
	snprintf(line, sizeof line, "-wal does not belong to");
	assert_non_null(strstr(log, line));
	free(log);
	assert_int_equal(access(wal, F_OK), 0); // the refused start has removed nothing
	restore(service, backup, 0);
	service_start(service, 1);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 0);
	// inconsistent pages are found at the start after a kill
	submit(service, 200);
	assert_true(service_wait(service, ids[n_ids - 1], "succeeded", 0));
	service_stop(service);
	service_start(service, 1);
	submit(service, 2);
	service_kill(service);
	FILE *file = fopen(service->database, "r+");
	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	for (long at = ftell(file) - 4096; at >= 2 * 4096; at -= 4096) {
		fseek(file, at, SEEK_SET);
		fputs("no page of a database", file);
	}
	fclose(file);
	assert_int_not_equal(service_run(service, 1), 0);
	log = program_file(service->log, NULL);
	assert_non_null(strstr(log, "the database is damaged"));
	free(log);
}

static void a_copy_is_restored_in_the_place_of_a_database_and_its_wal(void **state)
{
	struct service *service = *state;
	char backup[128], path[128];
	n_ids = 0;
	submit(service, 2);
	assert_true(service_wait(service, ids[0], "succeeded", 0));
	snprintf(backup, sizeof backup, "%s/backup.db", service->directory);
	copy(service->database, backup, 0);
	submit(service, 2);
	restore(service, backup, 1); // the database is in use
	service_kill(service);
	restore(service, "/nonexistent", 1);
	overwrite("/bin/true", (snprintf(path, sizeof path, "%s/true.db", service->directory), path));
	restore(service, path, 1); // not a database
	unlink(path);
	restore(service, backup, 0);
	service_start(service, 1);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 1);
	assert_true(service_wait(service, ids[0], "succeeded", 0));
	service_stop(service);
	// the former database is complete, with the content of its WAL
	strcat(service->database, "-replaced");
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 2);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(a_copy_made_while_studies_run_is_a_whole_database), SERVED(a_copy_can_be_copied),
           SERVED(a_database_that_is_replaced_under_a_server_is_not_written_to),
           SERVED(a_second_server_after_the_lock_is_removed_is_alone),
           SERVED(a_wal_is_not_applied_to_another_database),
           SERVED(a_copy_is_restored_in_the_place_of_a_database_and_its_wal))
