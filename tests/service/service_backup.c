/* Copies of a database made while studies are submitted and run: each is a whole database, and serves. */
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "server/store.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum { COPIES = 20, IDS_MAX = 3 * COPIES + 1 };

static char ids[IDS_MAX][17];
static int n_ids;

static void submit(const struct service *service, int rows)
{
	char *study = service_study(rows, 5, n_ids);
	service_submit(service, study, ids[n_ids++]);
	free(study);
}

/* The results that a copy has, each equal to the server's; how many. */
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
		// what was accepted before is in it
		struct service copy = *service;
		strcpy(copy.database, path);
		assert_int_equal(service_number(&copy, "SELECT count(*) FROM study"), n_ids);
		char *check = service_text(&copy, "PRAGMA integrity_check");
		assert_string_equal(check, "ok");
		free(check);
		results += compare(service, path);
		outcome = program_run(copying, NULL);
		program_expect(&outcome, 1); // it is there
		program_free(&outcome);
	}
	check_report("copies while %d studies were submitted and run: %d, whole %d, with %d results, all of the "
	             "same bytes",
	             n_ids, COPIES, COPIES, results);
	assert_true(results > COPIES);
	// a server on the last copy runs what was not finished in it
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

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(a_copy_made_while_studies_run_is_a_whole_database), SERVED(a_copy_can_be_copied))
