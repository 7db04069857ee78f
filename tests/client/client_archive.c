/* client_archive.c - `pound archive` against a poundd started by the test, checked by sha256sum of the system. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static char folder[] = "/tmp/pound-archive-XXXXXX", path[64];

static int setup(void **state)
{
	strcpy(folder + sizeof folder - 7, "XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof path, "%s/kept", folder);
	return program_setup(state);
}

static int teardown(void **state)
{
	char command[64];
	snprintf(command, sizeof command, "rm -r %s", folder);
	return system(command) + service_teardown(state);
}

static struct program_outcome shell(const char *script)
{
	return program_run((const char *const[]){"sh", "-c", script, "sh", path, NULL}, NULL);
}

static void finished(const struct service *service, const char *study, char id[17])
{
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
}

static char *file_of(const char *name, size_t *n)
{
	char file[96];
	snprintf(file, sizeof file, "%s/%s", path, name);
	return program_file(file, n);
}

static void an_archive_has_everything_and_its_checksums_hold(void **state)
{
	struct service *service = *state;
	char id[17], *study = service_study(4, 2, 1);
	finished(service, study, id);
	struct program_outcome archived = POUND("archive", id, path);
	program_expect(&archived, 0);
	assert_string_equal(archived.out, "");
	assert_string_equal(archived.err, "");
	program_free(&archived);
	struct program_outcome listed =
	    shell("ls $1; cd $1 && sha256sum --strict --quiet -c SHA256SUMS && wc -l <SHA256SUMS");
	program_expect(&listed, 0);
	assert_string_equal(listed.out,
	                    "SHA256SUMS\nresult.json\nsamples.csv\nstatus.json\nstudy.json\nversions.json\n5\n");
	program_free(&listed);
	// the files have the bytes of the server
	static const struct {
		const char *name, *rest;
	} files[] = {{"study.json", "request"}, {"result.json", "results"}, {"samples.csv", "samples"}};
	for (int i = 0; i < 3; i++) {
		size_t n;
		char *bytes = file_of(files[i].name, &n);
		struct answer answer = service_get(service, "/v1/studies/%s/%s", id, files[i].rest);
		assert_int_equal(n, answer.length);
		assert_memory_equal(bytes, answer.body, n);
		answer_free(&answer);
		free(bytes);
	}
	size_t n;
	char *text = file_of("versions.json", &n);
	struct reading *versions = reading_open(text, n);
	assert_string_equal(reading_text(versions, "/engine_version"), POUND_VERSION);
	assert_string_equal(reading_text(versions, "/poundd"), POUND_VERSION);
	assert_true(reading_number(versions, "/archive") == 1);
	reading_close(versions);
	free(text);
	// sha256sum finds a changed file
	listed = shell("cd $1 && sed -i 's/0/1/' result.json && sha256sum --quiet -c SHA256SUMS");
	assert_int_equal(listed.status, 1);
	assert_non_null(strstr(listed.out, "result.json: FAILED"));
	program_free(&listed);
	free(study);
}

static void the_study_of_an_archive_gives_its_result_again(void **state)
{
	char id[17], *study = service_study(4, 2, 2);
	size_t n;
	finished(*state, study, id);
	struct program_outcome archived = POUND("archive", "--format", "npy", id, path);
	program_expect(&archived, 0);
	program_free(&archived);
	struct program_outcome again =
	    shell("build=${POUND_BUILD:-build/release}; $build/pound run $1/study.json");
	program_expect(&again, 0);
	char *result = file_of("result.json", &n), *samples = file_of("samples.npy", &n);
	assert_memory_equal(samples, "\x93NUMPY", 6);
	assert_string_equal(service_timeless(again.out), service_timeless(result));
	program_free(&again);
	free(result), free(samples), free(study);
}

static void a_study_without_samples_is_archived_without_them(void **state)
{
	char id[17];
	finished(*state,
	         "{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	         "{\"frequency_hz\": 3}]}}",
	         id);
	struct program_outcome archived = POUND("archive", id, path);
	program_expect(&archived, 0);
	assert_non_null(
	    strstr(archived.err, "archived without samples: samples exist only for sensitivity studies"));
	program_free(&archived);
	struct program_outcome listed = shell("ls $1 | grep -c . ; cd $1 && sha256sum --quiet -c SHA256SUMS");
	program_expect(&listed, 0);
	assert_string_equal(listed.out, "5\n");
	program_free(&listed);
}

static void what_cannot_be_archived_leaves_nothing_behind(void **state)
{
	char id[17], *study = service_study(SERVICE_ROWS, 5, 3);
	struct service *service = *state;
	service_submit(service, study, id);
	struct program_outcome outcome = POUND("archive", id, path);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "not finished"));
	program_free(&outcome);
	outcome = POUND("cancel", id);
	program_free(&outcome);
	outcome = POUND("archive", id, path);
	program_expect(&outcome, 3);
	program_free(&outcome);
	outcome = POUND("archive", "0123456789abcdef", path);
	program_expect(&outcome, 1);
	program_free(&outcome);
	free(study);
	study = service_study(4, 2, 1);
	finished(service, study, id);
	char nowhere[80];
	snprintf(nowhere, sizeof nowhere, "%s/kept", path);
	outcome = POUND("archive", id, nowhere);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "No such file"));
	program_free(&outcome);
	// damaged samples stop the archive, which leaves no files
	service_stop(service);
	service_change(service, "UPDATE block SET content = zeroblob(length(content))");
	service_start(service, 1);
	char url[64];
	snprintf(url, sizeof url, "http://127.0.0.1:%d", service->port);
	outcome = POUND("archive", "--url", url, id, path);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "damaged"));
	program_free(&outcome);
	outcome = shell("ls -A $(dirname $1)");
	assert_string_equal(outcome.out, "");
	program_free(&outcome);
	// an existing folder is not changed
	assert_int_equal(mkdir(path, 0700), 0);
	outcome = POUND("archive", "--url", url, id, path);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "exists already"));
	program_free(&outcome);
	free(study);
}

#define SERVED(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

CHECK_MAIN(SERVED(an_archive_has_everything_and_its_checksums_hold),
           SERVED(the_study_of_an_archive_gives_its_result_again),
           SERVED(a_study_without_samples_is_archived_without_them),
           SERVED(what_cannot_be_archived_leaves_nothing_behind))
