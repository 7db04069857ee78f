/* `pound record`: files of recorded ground motions. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/program.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)
#define FILES      "tests/cases/records/"

static void files_are_shown_with_their_measures(void **state)
{
	(void)state;
	struct program_outcome shown =
	    POUND("record", "--format", "json", "--periods", "0.1,1", FILES "nga_west2.AT2", FILES "esm.ASC");
	program_expect(&shown, 0);
	assert_string_equal(shown.err, "");
	struct reading *records = reading_open(shown.out, strlen(shown.out));
	assert_int_equal(reading_count(records, "/records"), 2);
	assert_string_equal(reading_text(records, "/records/0/format"), "peer");
	assert_string_equal(reading_text(records, "/records/1/unit"), "cm/s2");
	// the files have the same numbers in g and in cm/s2, so spectra have the ratio of the units
	for (int k = 0; k < 2; k++) {
		const double psa = reading_number(records, "/records/0/spectrum/%d/psa_m_s2", k);
		check_near(reading_number(records, "/records/1/spectrum/%d/psa_m_s2", k) * 980.665, psa, 1e-12 * psa);
	}
	check_near(reading_number(records, "/records/0/pga_m_s2"), 0.05 * 9.80665, 0);
	reading_close(records);
	program_free(&shown);
}

/* The file begins with its largest acceleration, a jump from 0.  An oscillator much stiffer than the motion overshoots
 * the jump by the fraction exp(-pi xi/sqrt(1 - xi^2)). */
static void a_short_period_has_the_peak_of_a_jump(void **state)
{
	(void)state;
	const double pi = 3.14159265358979323846, period = 1e-4, slope = 0.087 / 0.005;
	struct program_outcome shown =
	    POUND("record", "--format", "csv", "--periods", "0.0001", FILES "two_columns.csv");
	program_expect(&shown, 0);
	double psa;
	assert_int_equal(sscanf(strchr(shown.out, '\n') + 1, "%*[^,],%*[^,],%lf", &psa), 1);
	// tolerance: change of the acceleration in half a period
	check_near(psa, 0.05 * (1 + exp(-pi * 0.05 / sqrt(1 - 0.05 * 0.05))), slope * period / 2);
	program_free(&shown);
}

static void what_is_no_record_is_refused(void **state)
{
	(void)state;
	struct program_outcome refused = POUND("record", FILES "uneven.csv", FILES "esm.ASC");
	program_expect(&refused, 2);
	assert_non_null(strstr(refused.err, "uneven.csv"));
	assert_non_null(strstr(refused.err, "line 9, column 1"));
	program_free(&refused);
	refused = POUND("record", FILES "nothing.AT2");
	program_expect(&refused, 1);
	program_free(&refused);
	refused = POUND("record", "--periods", "0", FILES "esm.ASC");
	program_expect(&refused, 2);
	program_free(&refused);
	// a record where a study is expected
	refused = POUND("run", FILES "esm.ASC");
	program_expect(&refused, 2);
	assert_non_null(strstr(refused.err, "`pound record' shows it"));
	program_free(&refused);
}

static void good_files_are_shown_beside_all_bad_ones(void **state)
{
	static const char *const formats[] = {"table", "csv", "json"};
	(void)state;
	for (int k = 0; k < 3; k++) {
		struct program_outcome shown =
		    POUND("record", "--format", formats[k], "--periods", "1", FILES "uneven.csv", FILES "esm.ASC",
		          FILES "cut_off.AT2", FILES "nga_west2.AT2", FILES "velocity.VT2");
		program_expect(&shown, 2);
		assert_non_null(strstr(shown.out, "esm.ASC"));
		assert_non_null(strstr(shown.out, "west2.AT2"));
		assert_null(strstr(shown.out, "uneven"));
		assert_null(strstr(shown.out, "cut_off"));
		assert_non_null(strstr(shown.err, "line 9, column 1"));
		assert_non_null(strstr(shown.err, "cut_off.AT2: 1 error"));
		assert_non_null(strstr(shown.err, "line 12: the header"));
		assert_non_null(strstr(shown.err, "velocity.VT2: 1 error"));
		assert_non_null(strstr(shown.err, "3 of 5 files are not shown"));
		program_free(&shown);
	}
	struct program_outcome none = POUND("record", FILES "uneven.csv", FILES "nothing.AT2");
	program_expect(&none, 1);
	assert_string_equal(none.out, "");
	program_free(&none);
}

static void motions_of_a_study_are_written_in_every_form(void **state)
{
	(void)state;
	struct program_outcome example = POUND("example", "response"), motion;
	motion = program_run(
	    (const char *const[]){"pound", "motion", "--signal", "0", "--format", "at2", "-", NULL}, example.out);
	program_expect(&motion, 0);
	assert_non_null(strstr(motion.out, "ACCELERATION TIME SERIES IN UNITS OF G\nNPTS="));
	program_free(&motion);
	motion = program_run((const char *const[]){"pound", "motion", "-", NULL}, example.out);
	program_expect(&motion, 0);
	assert_memory_equal(motion.out, "signal,time_s,acceleration_m_s2\r\n0,0,", 37);
	program_free(&motion);
	motion = program_run(
	    (const char *const[]){"pound", "motion", "--periods", "0.5,1", "--signal", "0", "-", NULL},
	    example.out);
	program_expect(&motion, 0);
	assert_memory_equal(motion.out, "signal,period_s,psa_m_s2\n0,0.5,", 31);
	program_free(&motion);
	motion =
	    program_run((const char *const[]){"pound", "motion", "--signal", "100000", "-", NULL}, example.out);
	program_expect(&motion, 2);
	assert_non_null(strstr(motion.err, "--signal must be a whole number from 0 to"));
	program_free(&motion);
	program_free(&example);
}

CHECK_MAIN(cmocka_unit_test(files_are_shown_with_their_measures),
           cmocka_unit_test(a_short_period_has_the_peak_of_a_jump),
           cmocka_unit_test(what_is_no_record_is_refused),
           cmocka_unit_test(good_files_are_shown_beside_all_bad_ones),
           cmocka_unit_test(motions_of_a_study_are_written_in_every_form))
