/* service_spectra.c - floor spectra and their histories through HTTP and `pound`: the bytes of a run without a server. */
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/program.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

static char *document_text(void)
{
	return study_documents_with(study_documents_floor, "\"histories\": false", "\"histories\": true");
}

/* Runs a document by `pound run`; samples: the file for its samples, NULL: none. */
static struct program_outcome run(const char *document, const char *samples)
{
	struct program_outcome outcome = program_run(
	    (const char *const[]){"pound", "run", "-", samples ? "--samples" : NULL, samples, NULL}, document);
	program_expect(&outcome, 0);
	return outcome;
}

static char *file_read(const char *path, size_t *length)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	char *bytes = malloc(1 << 24);
	*length = fread(bytes, 1, 1 << 24, file);
	fclose(file);
	return bytes;
}

static void spectra_come_as_json_and_csv(void **state)
{
	struct service *service = *state;
	char id[17];
	service_submit(service, study_documents_floor, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer json = service_get(service, "/v1/studies/%s/results", id);
	assert_int_equal(json.status, 200);
	struct program_outcome local = run(study_documents_floor, NULL);
	struct reading *r = reading_open(json.body, strlen(json.body));
	assert_int_equal(reading_count(r, "/spectra/0/mean_m_s2"), 9);
	reading_close(r);
	assert_string_equal(service_timeless(json.body), service_timeless(local.out));
	answer_free(&json);
	program_free(&local);
	struct answer csv = service_get(service, "/v1/studies/%s/results?format=csv", id);
	assert_int_equal(csv.status, 200);
	assert_memory_equal(csv.body, "frequency_hz,pounding.mean_m_s2,", 32);
	answer_free(&csv);
	struct answer none = service_get(service, "/v1/studies/%s/samples", id);
	assert_int_equal(none.status, 409); // the study does not request histories
	answer_free(&none);
}

static void histories_are_those_of_a_run_without_a_server(void **state)
{
	struct service *service = *state;
	char id[17], csv_path[120], npy_path[120], *document = document_text();
	size_t length;
	snprintf(csv_path, sizeof csv_path, "%s/h.csv", service->directory);
	snprintf(npy_path, sizeof npy_path, "%s/h.npy", service->directory);
	service_submit(service, document, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct program_outcome outcome = run(document, csv_path);
	program_free(&outcome);
	outcome = run(document, npy_path);
	program_free(&outcome);
	struct answer csv = service_get(service, "/v1/studies/%s/samples", id);
	char *local = file_read(csv_path, &length);
	assert_int_equal(csv.status, 200);
	assert_int_equal(csv.length, length);
	assert_memory_equal(csv.body, local, length);
	free(local);
	answer_free(&csv);
	struct answer npy = service_get(service, "/v1/studies/%s/samples?format=npy", id);
	local = file_read(npy_path, &length);
	assert_int_equal(npy.length, length);
	assert_memory_equal(npy.body, local, length);
	free(local);
	answer_free(&npy);
	unlink(csv_path);
	unlink(npy_path);
	free(document);
}

static void a_run_without_samples_says_so_before_it_begins(void **state)
{
	(void)state;
	struct program_outcome outcome =
	    program_run((const char *const[]){"pound", "run", "-", "--samples", "/nowhere/x.csv", NULL},
	                study_documents_floor);
	program_expect(&outcome, 2);
	assert_string_equal(outcome.out, "");
	assert_non_null(strstr(outcome.err, "\"histories\": true"));
	program_free(&outcome);
}

static void the_table_of_spectra_has_its_peaks(void **state)
{
	(void)state;
	struct program_outcome outcome = program_run(
	    (const char *const[]){"pound", "run", "--format", "table", "-", NULL}, study_documents_floor);
	program_expect(&outcome, 0);
	assert_non_null(strstr(outcome.out, "dirac_train"));
	assert_non_null(strstr(outcome.out, "peaks of the spectrum"));
	assert_non_null(strstr(outcome.out, "floor histories, for spectra"));
	program_free(&outcome);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(spectra_come_as_json_and_csv), SERVED(histories_are_those_of_a_run_without_a_server),
           cmocka_unit_test(a_run_without_samples_says_so_before_it_begins),
           cmocka_unit_test(the_table_of_spectra_has_its_peaks))
