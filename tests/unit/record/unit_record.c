/* unit_record.c - files of recorded accelerations: every format and its variants against known values, and refused
 * files.
 *
 * The files of tests/cases/records are made up in the style of the databases of each format: sample i is ((37 i) mod
 * 101 - 50)/1000 of the file's unit. */
#include <math.h>
#include <string.h>

#include "schema/record/record.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

enum { SAMPLES = 43 };

static double sample(int i)
{
	return ((37 * i) % 101 - 50) / 1000.0;
}

/* The bytes of a file, ended by 0; the caller frees them. */
static char *file_of(const char *name, size_t *n)
{
	char path[128];
	snprintf(path, sizeof path, "tests/cases/records/%s", name);
	FILE *file = fopen(path, "rb");
	if (!file)
		fail_msg("%s is not there", path);
	char *text = calloc(1, 1 << 16);
	*n = fread(text, 1, (1 << 16) - 1, file);
	fclose(file);
	return text;
}

static void files_of_every_format_have_their_known_values(void **state)
{
	(void)state;
	static const struct {
		const char *file, *format, *unit, *title;
		double step, factor;
		struct record_choice choice;
	} cases[] = {
	    {"nga_west2.AT2",
	     "peer",
	     "g",
	     "Made-up Valley-01, 1/2/2003, Test Array #6, 230",
	     0.005,
	     9.80665,
	     {0}},
	    {"peer_old.at2", "peer", "g", "MADE-UP VALLEY 1/2/03 0439, TEST ARRAY #9, 180", 0.01, 9.80665, {0}},
	    {"cosmos.V2",
	     "cosmos",
	     "cm/s2",
	     "Made-up Valley Earthquake of Thu Jan 02, 2003 04:39:00.0 UTC",
	     0.02,
	     0.01,
	     {0}},
	    {"three_channels.V2c",
	     "cosmos",
	     "cm/s2",
	     "Made-up Valley Earthquake of Thu Jan 02, 2003 04:39:00.0 UTC",
	     0.005,
	     0.01,
	     {.channel = 2}},
	    {"esm.ASC", "esm", "cm/s2", "MADE_UP_VALLEY, XX-2003-0001, TST, HNE", 0.005, 0.01, {0}},
	    {"two_columns.csv", "columns", "m/s2", "time_s,acceleration_m_s2", 0.005, 1, {0}},
	    {"two_columns.txt", "columns", "g", "made-up record, acceleration [g], t a", 1.0 / 128, 9.80665, {0}},
	    {"semicolons.csv", "columns", "g", "t;a", 0.02, 9.80665, {.unit = "g"}},
	    {"one_column.txt", "columns", "cm/s2", "made-up accelerations in cm/s2", 0.01, 0.01, {.step = 0.01}},
	    {"eight_in_a_line.dat", "columns", "cm/s2", "", 0.004, 0.01, {.step = 0.004, .unit = "gal"}},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		size_t n;
		struct record record;
		struct problems problems;
		char *text = file_of(cases[k].file, &n);
		if (!record_read(text, n, &cases[k].choice, &record, &problems))
			fail_msg("%s: %s: %s", cases[k].file, problems.list[0].pointer, problems.list[0].detail);
		assert_string_equal(record.format, cases[k].format);
		assert_string_equal(record.unit, cases[k].unit);
		assert_int_equal(record.n, SAMPLES);
		assert_true(strstr(record.title, cases[k].title) == record.title);
		check_near(record.step, cases[k].step, 0);
		for (int i = 0; i < SAMPLES; i++)
			check_near(record.acceleration[i], sample(i) * cases[k].factor, 0);
		assert_int_equal(record_recognized(text, n), strcmp(cases[k].format, "columns") != 0);
		record_free(&record);
		free(text);
	}
}

static void what_cannot_be_read_is_refused_by_line_and_column(void **state)
{
	(void)state;
	static const struct {
		const char *file, *place, *detail;
		struct record_choice choice;
	} refused[] = {
	    {"velocity.VT2", "line 3, column 1", "this is a velocity series (.VT2)", {0}},
	    {"esm_velocity.ASC", "line 17, column 7", "the unit must be cm/s^2", {0}},
	    {"counts.V0", "line", "raw counts (V0)", {0}},
	    {"three_channels.V2c", "", "the file has 3 channels with accelerations: choose one, 1 to 3", {0}},
	    {"three_channels.V2c", "", "no channel 4: the file has 3", {.channel = 4}},
	    {"cut_off.AT2", "line 12", "the header announces 43 samples, but the file ends after 40", {0}},
	    {"uneven.csv", "line 9, column 1", "expected 0.035 s, got 0.039 s", {0}},
	    {"decimal_comma.csv", "line 2, column 2", "decimal numbers need a point", {0}},
	    {"eight_in_a_line.dat", "line 1", "has 8 numbers; expected a time", {0}},
	    {"semicolons.csv", "", "does not name the unit", {0}},
	    {"semicolons.csv", "", "looks like times with the given step", {.step = 0.02, .unit = "g"}},
	    {"semicolons.csv", "", "the unit must be g, cm/s2 or m/s2, got `knots'", {.unit = "knots"}},
	    {"two_columns.csv", "", "the header has the unit m/s2, but g was given", {.unit = "g"}},
	    {"one_column.txt", "line 2", "has 1 number; expected a time", {0}},
	};
	for (size_t k = 0; k < sizeof refused / sizeof refused[0]; k++) {
		size_t n;
		struct record record;
		struct problems problems;
		char *text = file_of(refused[k].file, &n);
		assert_false(record_read(text, n, &refused[k].choice, &record, &problems));
		assert_null(record.acceleration);
		if (!strstr(problems.list[0].detail, refused[k].detail) ||
		    strncmp(problems.list[0].pointer, refused[k].place, strlen(refused[k].place)) != 0)
			fail_msg("%s: %s: %s", refused[k].file, problems.list[0].pointer, problems.list[0].detail);
		free(text);
	}
}

static void texts_in_place_of_records_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *place, *detail;
	} refused[] = {
	    {"", "", "the file has no numbers"},
	    {"{\"kind\": \"response\"}", "", "the file has no numbers"},
	    {"0 1\n0.1 x\n", "line 2, column 5", "expected a number, got `x'"},
	    {"0 1\n0.1 2 3\n", "line 2", "has 3 numbers where the first line has 2"},
	    {"0 1\n", "", "must be a whole number in [2"},
	    {"0 1\n0 2\n", "line 2, column 1", "must increase"},
	    {"0 1e400\n1 0\n", "line 1, column 3", "expected a number"},
	    {"0 nan\n1 0\n", "line 1, column 3", "expected a number"},
	    {"x\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 1e9, DT= .01\n", "line 3", "number of samples"},
	    {"x\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 2, DT= -.01\n1 2\n", "line 3", "time step"},
	    {"x\nACCELERATION TIME SERIES IN UNITS OF FURLONGS\n", "line 2", "the unit must be"},
	    {"x\nACCELERATION TIME SERIES IN UNITS OF G\n1 2\n", "", "needs a line with NPTS and DT"},
	    {"x\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 2, DT= .01\n1 2\n3\n", "line 5", "more samples"},
	    {"A: 1\nB: 2\nC: 3\n0.1\n", "", "no valid line SAMPLING_INTERVAL_S"},
	};
	for (size_t k = 0; k < sizeof refused / sizeof refused[0]; k++) {
		struct record record;
		struct problems problems;
		const struct record_choice choice = {.unit = "g"};
		assert_false(record_read(refused[k].text, strlen(refused[k].text), &choice, &record, &problems));
		if (!strstr(problems.list[0].detail, refused[k].detail) ||
		    strncmp(problems.list[0].pointer, refused[k].place, strlen(refused[k].place)) != 0)
			fail_msg("%s: %s: %s", refused[k].text, problems.list[0].pointer, problems.list[0].detail);
	}
}

CHECK_MAIN(cmocka_unit_test(files_of_every_format_have_their_known_values),
           cmocka_unit_test(what_cannot_be_read_is_refused_by_line_and_column),
           cmocka_unit_test(texts_in_place_of_records_are_refused))
