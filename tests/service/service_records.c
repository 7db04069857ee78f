/* service_records.c - files of recorded ground motions in the store: stored once, for as long as a study names them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "schema/study/study_json.h"
#include "tests/support/faults.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

static const char FILE_NAME[] = "tests/cases/records/esm.ASC";

/* A file of a record, and its SHA-256. */
struct stored {
	char *bytes;
	size_t n;
	char sha256[STUDY_HASH_SIZE], path[96];
};

static const struct stored *stored(void)
{
	static struct stored of;
	if (!of.bytes) {
		of.bytes = program_file(FILE_NAME, &of.n);
		assert_non_null(of.bytes);
		study_digest(of.bytes, of.n, of.sha256);
		snprintf(of.path, sizeof of.path, "/v1/records/%s", of.sha256);
	}
	return &of;
}

static int put(const struct service *service)
{
	struct answer answer = service_ask(service, &(struct ask){.method = "PUT",
	                                                          .path = stored()->path,
	                                                          .body = stored()->bytes,
	                                                          .length = stored()->n});
	const int status = answer.status;
	answer_free(&answer);
	return status;
}

/* Whether the server has the record; fails if its bytes differ. */
static bool is_there(const struct service *service)
{
	struct answer answer = service_get(service, "%s", stored()->path);
	const bool there = answer.status == 200;
	assert_true(there || answer.status == 404);
	assert_true(there || strstr(answer.body, "there is no such record"));
	if (there) {
		assert_int_equal(answer.length, stored()->n);
		assert_memory_equal(answer.body, stored()->bytes, stored()->n);
	}
	answer_free(&answer);
	return there;
}

/* A study under one record, named by its SHA-256: a response, or with rows > 0 a sensitivity study; the caller frees it. */
static char *naming(int rows)
{
	char *text = NULL, design[400] = "";
	if (rows)
		snprintf(design, sizeof design,
		         ", \"inputs\": [{\"path\": \"/oscillators/0/frequency_hz\", \"distribution\": {\"type\": "
		         "\"uniform\", \"min\": 1, \"max\": 3}}, {\"path\": \"/contact/restitution\", "
		         "\"distribution\": {\"type\": \"uniform\", \"min\": 0.2, \"max\": 1}}], \"design\": "
		         "{\"rows\": %d}",
		         rows);
	assert_true(
	    asprintf(&text,
	             "{\"kind\": \"%s\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	             "{\"frequency_hz\": 3.1}], \"contact\": {\"gap_m\": 0.0001}, \"excitation\": {\"type\": "
	             "\"suite\", \"directions\": \"both\", \"records\": [{\"name\": \"a record\", "
	             "\"sha256\": \"%s\"}]}}%s}",
	             rows ? "sensitivity" : "response", stored()->sha256, design) > 0);
	return text;
}

static int erase(const struct service *service, const char *id, bool may_fail)
{
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s", id);
	struct answer answer =
	    service_ask(service, &(struct ask){.method = "DELETE", .path = path, .may_fail = may_fail});
	const int status = answer.status;
	answer_free(&answer);
	return status;
}

static void a_record_lives_while_a_study_names_it(void **state)
{
	struct service *service = *state;
	char *study = naming(0), ids[2][17];
	struct answer answer = service_post(service, study);
	assert_int_equal(answer.status, 422); // the record is not stored yet
	assert_non_null(strstr(answer.body, "/scene/excitation/records/0/sha256"));
	assert_non_null(strstr(answer.body, "is not stored here: PUT /v1/records/"));
	answer_free(&answer);
	assert_false(is_there(service));
	assert_int_equal(put(service), 201);
	assert_int_equal(put(service), 204);
	assert_true(is_there(service));
	for (int k = 0; k < 2; k++) {
		service_submit(service, study, ids[k]);
		assert_true(service_wait(service, ids[k], "succeeded", 0));
	}
	assert_int_equal(service_number(service, "SELECT count(*) FROM record"), 1);
	// a record that a study names does not expire; the posted document is returned unchanged
	service_stop(service);
	service_change(service, "UPDATE record SET created = 0");
	service_start(service, 2);
	answer = service_get(service, "/v1/studies/%s/request", ids[0]);
	assert_string_equal(answer.body, study);
	answer_free(&answer);
	assert_int_equal(erase(service, ids[0], false), 204);
	assert_true(is_there(service));
	assert_int_equal(erase(service, ids[1], false), 204);
	assert_false(is_there(service));
	assert_int_equal(service_number(service, "SELECT count(*) FROM record"), 0);
	free(study);
}

static void a_record_that_no_study_names_is_deleted_after_an_hour(void **state)
{
	struct service *service = *state;
	assert_int_equal(put(service), 201);
	service_stop(service);
	service_start(service, 1);
	assert_true(is_there(service));
	service_stop(service);
	service_change(service, "UPDATE record SET created = created - 3600000");
	service_start(service, 1);
	for (int k = 0; k < 3000 && is_there(service); k++)
		usleep(10000);
	assert_false(is_there(service));
}

static char *beside(const void *with, const struct study_source *of, size_t *length, char why[STUDY_WHY_SIZE])
{
	(void)with;
	(void)of;
	snprintf(why, STUDY_WHY_SIZE, "cannot be read");
	return program_file(FILE_NAME, length);
}

/* A study killed half way against the same study, not interrupted, with the samples of the record in its document. */
static void a_study_that_names_records_gives_the_bytes_of_its_samples(void **state)
{
	struct service *service = *state;
	char *study = naming(2 * SERVICE_ROWS), ids[2][17];
	const int runs = 2 * SERVICE_ROWS * 4 * 2;
	const struct study_files files = {.read = beside};
	const struct study_document document = {.text = study, .length = strlen(study), .files = &files};
	struct problems problems;
	struct pound_study *read = study_from_document(&document, &problems);
	size_t n;
	assert_non_null(read);
	char *samples = study_inline(&document, read, &n);
	study_free(read);
	assert_int_equal(put(service), 201);
	service_submit(service, study, ids[0]);
	service_wait(service, ids[0], "running", 0.3 * runs);
	service_kill(service);
	service_start(service, 2);
	service_submit(service, samples, ids[1]);
	for (int k = 0; k < 2; k++)
		assert_true(service_wait(service, ids[k], "succeeded", 0));
	struct service_bytes bytes[] = {service_bytes(service, ids[0]), service_bytes(service, ids[1])};
	assert_int_equal(erase(service, ids[0], false), 204); // deletes its record, too
	assert_false(is_there(service));
	service_bytes_compare(&bytes[0], &bytes[1]);
	free(bytes[1].result);
	free(bytes[1].samples);
	free(samples);
	free(study);
}

/* A record longer than the limit of other bodies, and the motions of its study, equal to those of the command line. */
static void a_long_record_is_stored_and_its_motions_are_given_back(void **state)
{
	enum { SAMPLES = 100000 };
	static char bytes[SAMPLES * 20];
	struct service *service = *state;
	char path[96], sha256[STUDY_HASH_SIZE], study[512], id[17];
	size_t n = 0, length;
	for (int k = 0; k < SAMPLES; k++)
		n += (size_t)snprintf(bytes + n, sizeof bytes - n, "%.3f %.6f\n", k * 0.005, 0.001 * (k * 7 % 1013));
	assert_true(n > 1 << 20);
	study_digest(bytes, n, sha256);
	snprintf(path, sizeof path, "/v1/records/%s", sha256);
	struct answer answer =
	    service_ask(service, &(struct ask){.method = "PUT", .path = path, .body = bytes, .length = n});
	assert_int_equal(answer.status, 201);
	answer_free(&answer);
	snprintf(study, sizeof study,
	         "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"rigid_wall\": "
	         "true}], \"contact\": null, \"excitation\": {\"type\": \"suite\", \"directions\": \"both\", "
	         "\"records\": [{\"sha256\": \"%s\", \"unit\": \"m/s2\"}]}}}",
	         sha256);
	service_submit(service, study, id);
	answer = service_get(service, "/v1/studies/%s/motions?format=npy&signal=1", id);
	assert_int_equal(answer.status, 200);
	assert_true(answer.length > 20 * SAMPLES && answer.length < 20 * SAMPLES + 1000);
	double last[2]; // time and acceleration of the last sample, of the reversed record
	memcpy(last, answer.body + answer.length - sizeof last, sizeof last);
	check_near(last[0], (SAMPLES - 1) * 0.005, 1e-9);
	check_near(last[1], -0.001 * ((SAMPLES - 1) * 7 % 1013), 1e-15);
	answer_free(&answer);
	answer = service_get(service, "/v1/studies/%s/motions?periods=0.5", id);
	assert_int_equal(answer.status, 200);
	assert_memory_equal(answer.body, "signal,record,factor,period_s,psa_m_s2\n0,0,1,0.5,", 48);
	length = answer.length;
	assert_true(length > 60 && length < 200);
	answer_free(&answer);
}

static void a_server_killed_anywhere_keeps_a_record_with_its_study(void **state)
{
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	char *study = naming(0), id[17];
	int kills = 0;
	bool spared = false;
	(void)state;
	for (int at = 1; !spared; at++) {
		service_start(service, 1);
		assert_int_equal(put(service), 201);
		faults->disk_kills_in = at;
		struct answer posted = service_post_keyed(service, study, NULL);
		snprintf(id, sizeof id, "%.16s",
		         posted.status == 201 ? posted.location + strlen("/v1/studies/") : "");
		answer_free(&posted);
		const int erased = *id ? erase(service, id, true) : 0;
		spared = atomic_exchange(&faults->disk_kills_in, 0) > 0;
		service_kill(service);
		kills += !spared;
		service_start(service, 1);
		const bool there = is_there(service);
		// every study has its record; answers before the kill remain valid
		assert_int_equal(service_number(service, "SELECT count(*) FROM study_record"),
		                 service_number(service, "SELECT count(*) FROM study"));
		assert_int_equal(service_number(service, "SELECT count(*) FROM study_record WHERE record NOT IN "
		                                         "(SELECT sha256 FROM record)"),
		                 0);
		if (*id && erased != 204)
			assert_true(there || service_number(service, "SELECT count(*) FROM study") == 0);
		if (erased == 204)
			assert_false(there);
		if (!*id)
			assert_true(there);
		service_stop(service);
		service_erase(service);
	}
	check_report("a server killed at %d places between a record and the end of its study", kills);
	assert_true(kills > 0);
	faults_free(faults);
	free(study);
	service_free(service);
}

CHECK_MAIN(cmocka_unit_test_setup_teardown(a_record_lives_while_a_study_names_it, service_setup,
                                           service_teardown),
           cmocka_unit_test_setup_teardown(a_record_that_no_study_names_is_deleted_after_an_hour,
                                           service_setup, service_teardown),
           cmocka_unit_test_setup_teardown(a_study_that_names_records_gives_the_bytes_of_its_samples,
                                           service_setup, service_teardown),
           cmocka_unit_test_setup_teardown(a_long_record_is_stored_and_its_motions_are_given_back,
                                           service_setup, service_teardown),
           cmocka_unit_test(a_server_killed_anywhere_keeps_a_record_with_its_study))
