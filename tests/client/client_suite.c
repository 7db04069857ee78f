/* client_suite.c - `pound run`, `submit`, `motion` and `design` of a suite whose records are files beside the study. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static const char SUITE[] = "tests/cases/records/suite.json";

/* The result without its last member, "timing". */
static void untimed(char *result)
{
	char *timing = strstr(result, "\"timing\"");
	assert_non_null(timing);
	*timing = 0;
}

static void a_suite_is_read_from_files_beside_the_study(void **state)
{
	(void)state;
	struct program_outcome ran = POUND("run", SUITE);
	program_expect(&ran, 0);
	struct reading *result = reading_open(ran.out, ran.n_out);
	assert_int_equal(reading_count(result, "/suite/records"), 3);
	assert_string_equal(reading_text(result, "/suite/records/0/name"), "nga_west2.AT2");
	assert_string_equal(reading_text(result, "/suite/records/1/name"), "by another network");
	// the two files have the same numbers, one in g, one in cm/s2
	check_near(reading_number(result, "/suite/records/1/pga_m_s2") * 980.665,
	           reading_number(result, "/suite/records/0/pga_m_s2"), 1e-15);
	reading_close(result);
	program_free(&ran);
}

static void a_server_gives_the_same_bytes(void **state)
{
	(void)state;
	struct program_outcome ran = POUND("run", SUITE), sent = POUND("submit", "--wait", SUITE);
	program_expect(&ran, 0);
	program_expect(&sent, 0);
	char *id = strtok(sent.out, "\n");
	struct program_outcome result = POUND("results", id);
	program_expect(&result, 0);
	untimed(ran.out);
	untimed(result.out);
	assert_string_equal(result.out, ran.out);
	program_free(&ran);
	program_free(&sent);
	program_free(&result);
}

static void files_that_the_server_has_are_not_sent_again(void **state)
{
	const struct service *service = *state;
	static const char created[] =
	    "SELECT group_concat(created) FROM (SELECT created FROM record ORDER BY sha256)";
	char *first = NULL;
	for (int k = 0; k < 2; k++) {
		struct program_outcome sent = POUND("submit", "--wait", SUITE);
		program_expect(&sent, 0);
		program_free(&sent);
		char *now = service_text(service, created);
		// a record that is stored again would have a new time
		if (first)
			assert_string_equal(now, first);
		free(first);
		first = now;
	}
	free(first);
	assert_int_equal(service_number(service, "SELECT count(*) FROM record"), 3);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study_record"), 6);
	// the stored document is small: it names the records by their digests
	assert_true(service_number(service, "SELECT max(length(content)) FROM document WHERE name = 'request'") <
	            2000);
}

static void spectra_name_the_records(void **state)
{
	(void)state;
	struct program_outcome motion = POUND("motion", "--format", "csv", "--periods", "0.5", SUITE);
	program_expect(&motion, 0);
	assert_memory_equal(motion.out, "signal,record,factor,period_s,psa_m_s2\n0,0,", 42);
	// every record is scaled to 3 m/s2 at 0.5 s
	int lines = 0;
	for (char *line = strchr(motion.out, '\n') + 1; *line; line = strchr(line, '\n') + 1, lines++) {
		char *last = line;
		for (char *c = line; *c != '\n'; c++)
			last = *c == ',' ? c : last;
		check_near(strtod(last + 1, NULL), 3, 1e-12);
	}
	assert_int_equal(lines, 6);
	program_free(&motion);
	motion = POUND("motion", "--format", "at2", "--signal", "3", SUITE);
	program_expect(&motion, 0);
	assert_non_null(strstr(motion.out, "by another network, record 1 times "));
	program_free(&motion);
}

static void a_file_that_cannot_be_read_is_named(void **state)
{
	(void)state;
	static const char missing[] =
	    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": "
	    "2}], "
	    "\"excitation\": {\"type\": \"suite\", \"records\": [{\"file\": \"no_such.AT2\"}]}}}";
	static const char *const commands[] = {"run", "submit", "motion"};
	for (int k = 0; k < 3; k++) {
		struct program_outcome refused =
		    program_run((const char *const[]){"pound", commands[k], "-", NULL}, missing);
		program_expect(&refused, 2);
		assert_non_null(strstr(
		    refused.err, "/scene/excitation/records/0/file: cannot be read: No such file or directory"));
		assert_string_equal(refused.out, "");
		program_free(&refused);
	}
}

/* A path in a folder, valid until the next call. */
static const char *in(const char *folder, const char *name)
{
	static char path[256];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void from_files_to_a_figure_in_three_commands(void **state)
{
	(void)state;
	char folder[] = "/tmp/pound_suite_XXXXXX";
	assert_non_null(mkdtemp(folder));
	assert_int_equal(rmdir(folder), 0); // `pound example` creates the folder
	for (int again = 0; again < 2; again++) {
		struct program_outcome made = POUND("example", "separation", folder);
		program_expect(&made, again ? 1 : 0); // existing files are not overwritten
		assert_int_equal(strstr(made.err, "separation.json: File exists") != NULL, again);
		assert_string_equal(made.out, "");
		program_free(&made);
	}
	struct program_outcome ran = POUND("run", in(folder, "separation.json"));
	program_expect(&ran, 0);
	FILE *file = fopen(in(folder, "gap.json"), "w");
	assert_non_null(file);
	fputs(ran.out, file);
	fclose(file);
	struct program_outcome plot = POUND("plot", "separation", in(folder, "gap.json"));
	program_expect(&plot, 0);
	assert_memory_equal(plot.out, "<svg ", 5);
	program_free(&plot);

	// same result as with the samples in the document, except for the rounding of g in the files
	struct program_outcome text = POUND("example", "separation");
	program_expect(&text, 0);
	struct program_outcome inside = program_run((const char *const[]){"pound", "run", "-", NULL}, text.out);
	program_expect(&inside, 0);
	struct reading *files = reading_open(ran.out, ran.n_out),
	               *samples = reading_open(inside.out, inside.n_out);
	assert_int_equal(reading_count(files, "/suite/records"), 20);
	assert_string_equal(reading_text(files, "/suite/records/19/name"),
	                    reading_text(samples, "/suite/records/19/name"));
	for (int k = 0; k < 20; k++)
		check_near(reading_number(files, "/cells/0/gap_needed/signals_m/%d", k),
		           reading_number(samples, "/cells/0/gap_needed/signals_m/%d", k), 1e-12);
	reading_close(files);
	reading_close(samples);
	program_free(&ran);
	program_free(&text);
	program_free(&inside);

	// the folder has no other files
	for (int k = 1; k <= 20; k++) {
		char name[32];
		snprintf(name, sizeof name, "record_%02d.AT2", k);
		assert_int_equal(unlink(in(folder, name)), 0);
	}
	assert_int_equal(unlink(in(folder, "separation.json")), 0);
	assert_int_equal(unlink(in(folder, "gap.json")), 0);
	assert_int_equal(rmdir(folder), 0);
}

CHECK_MAIN(cmocka_unit_test(a_suite_is_read_from_files_beside_the_study),
           cmocka_unit_test_setup_teardown(a_server_gives_the_same_bytes, program_setup, service_teardown),
           cmocka_unit_test_setup_teardown(files_that_the_server_has_are_not_sent_again, program_setup,
                                           service_teardown),
           cmocka_unit_test(spectra_name_the_records), cmocka_unit_test(a_file_that_cannot_be_read_is_named),
           cmocka_unit_test(from_files_to_a_figure_in_three_commands))
