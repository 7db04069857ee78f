/* unit_study_spectrum.c - floor spectra in study documents: frequencies, limits, an output for each ordinate. */
#include <math.h>
#include <string.h>

#include "schema/study/study_json.h"
#include "schema/study/study_spectrum.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define ORDINATES "\"outputs\": [\"impulse\", \"floor_spectrum\"]"

/* The sensitivity document with ordinates at what `frequencies` says. */
static char *document_with(const char *frequencies)
{
	char outputs[600];
	snprintf(outputs, sizeof outputs, ORDINATES "%s%s%s",
	         *frequencies ? ", \"spectrum\": {\"frequencies_hz\": " : "", frequencies,
	         *frequencies ? "}" : "");
	return documents_with(documents_sensitivity, "\"outputs\": [\"demand_amplification\", \"impulse\"]",
	                      outputs);
}

static void frequencies_are_a_list_or_a_range(void **state)
{
	(void)state;
	struct pound_study *study = documents_study(documents_floor);
	assert_int_equal(study->spectrum.n, 9);
	check_near(pound_spectrum_frequency(&study->spectrum, 4), 5, 1e-14);
	check_near(study->spectrum.damping_ratio, 0.02, 0);
	assert_int_equal(study->spectrum.pulses, 15);
	assert_int_equal(study->n_outputs, 0);
	study_free(study);
	char *listed =
	    documents_with(documents_floor, "{\"min\": 0.5, \"max\": 50, \"count\": 9}", "[7.5, 3, 1e1]");
	study = documents_study(listed);
	assert_int_equal(study->spectrum.n, 3);
	check_near(pound_spectrum_frequency(&study->spectrum, 0), 7.5, 0);
	check_near(pound_spectrum_frequency(&study->spectrum, 2), 10, 0);
	study_free(study);
	free(listed);
}

static void absent_frequencies_are_two_hundred(void **state)
{
	(void)state;
	struct pound_study *study = documents_study("{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": "
	                                            "[{\"frequency_hz\": 2}, {\"rigid_wall\": true}]}}");
	assert_int_equal(study->spectrum.n, 200);
	check_near(pound_spectrum_frequency(&study->spectrum, 0), 0.1, 0);
	check_near(pound_spectrum_frequency(&study->spectrum, 199), 100, 0);
	check_near(study->spectrum.damping_ratio, 0.05, 0);
	assert_int_equal(study->spectrum.pulses, 0);
	assert_false(study->spectrum.histories);
	study_free(study);
}

static void every_frequency_is_an_output(void **state)
{
	(void)state;
	char name[STUDY_OUTPUT_SIZE], *document = document_with("[0.5, 2.25, 16]");
	struct pound_study *study = documents_study(document);
	assert_int_equal(study->n_outputs, 4);
	assert_string_equal(study_output_name(study, 0, name), "impulse");
	assert_string_equal(study_output_name(study, 1, name), "floor_spectrum.0.5_hz");
	assert_string_equal(study_output_name(study, 2, name), "floor_spectrum.2.25_hz");
	assert_string_equal(study_output_name(study, 3, name), "floor_spectrum.16_hz");
	assert_int_equal(pound_study_ordinate(study, 0), -1);
	assert_int_equal(pound_study_ordinate(study, 3), 2);
	study_free(study);
	free(document);
}

static void an_output_and_its_spectrum_need_each_other(void **state)
{
	(void)state;
	char *document = document_with("");
	documents_problem(document, "/spectrum/frequencies_hz",
	                  "is required: at most 64 frequencies of the floor spectrum");
	free(document);
	document = documents_with(documents_sensitivity, "\"outputs\": [",
	                          "\"spectrum\": {\"frequencies_hz\": [1]}, \"outputs\": [");
	documents_problem(document, "/spectrum", "is not used without output \"floor_spectrum\"");
	free(document);
	document =
	    documents_with(documents_response, "\"scene\"", "\"outputs\": [\"floor_spectrum\"], \"scene\"");
	documents_problem(
	    document, "/outputs",
	    "\"floor_spectrum\" is an output of sensitivity studies; kind \"floor_spectrum\" has whole spectra");
	free(document);
}

static void a_spectrum_has_its_limits(void **state)
{
	(void)state;
	char *document = document_with("{\"min\": 1, \"max\": 10, \"count\": 65}");
	documents_problem(document, "/spectrum/frequencies_hz",
	                  "must be at most 64 in a sensitivity study, got 65");
	free(document);
	document = document_with("[1, 20000]");
	documents_problem(document, "/spectrum/frequencies_hz",
	                  "must be at most 100 over the sample step, 10000 Hz, got 20000");
	// the longest step of all cells, whatever else is wrong
	char *swept = documents_with(document, "\"/contact/restitution\", \"values\": [0.2, 0.9]",
	                             "\"/excitation/time_step_s\", \"values\": [0.001, 0.02]");
	documents_problem(swept, "/spectrum/frequencies_hz",
	                  "must be at most 100 over the sample step, 5000 Hz, got 20000");
	free(swept);
	struct problems problems;
	char *both = documents_with(document, "\"stiffness_ratio\": 100", "\"stiffness_ratio\": -1");
	documents_refused(both, &problems);
	assert_int_equal(problems.n, 2);
	assert_true(problems_at(&problems, "/spectrum/frequencies_hz"));
	free(both);
	free(document);
	document = documents_with(documents_floor, "\"signals\": 3", "\"signals\": 10000");
	char *many = documents_with(document, "\"count\": 9", "\"count\": 501");
	documents_problem(many, "/spectrum/frequencies_hz",
	                  "asks for 5010000 frequencies of all signals, at most 5000000");
	free(many);
	char *told = documents_with(document, "\"histories\": false", "\"histories\": true");
	documents_problem(told, "/histories", "asks for 2010000 samples of all signals, at most 2000000");
	free(told);
	free(document);
}

static void an_input_does_not_take_the_name_of_an_ordinate(void **state)
{
	(void)state;
	char *document = document_with("[0.5]");
	char *named = documents_with(document, "\"f_e\"", "\"floor_spectrum.0.5_hz\"");
	documents_problem(named, "/inputs/0/name", "is the name of another column of the samples");
	free(named);
	free(document);
}

static void only_what_is_asked_counts_for_the_hash(void **state)
{
	(void)state;
	char range[STUDY_HASH_SIZE], list[STUDY_HASH_SIZE], other[STUDY_HASH_SIZE];
	char *listed = documents_with(documents_floor, "{\"min\": 0.5, \"max\": 50, \"count\": 9}", "[0.5, 50]");
	char *ranged = documents_with(documents_floor, "\"count\": 9", "\"count\": 2");
	struct pound_study *studies[] = {documents_study(listed), documents_study(ranged),
	                                 documents_study(documents_floor)};
	assert_true(study_hash(studies[0], list) && study_hash(studies[1], range) &&
	            study_hash(studies[2], other));
	assert_string_equal(list, range);
	assert_string_not_equal(list, other);
	for (int i = 0; i < 3; i++)
		study_free(studies[i]);
	free(listed);
	free(ranged);
}

CHECK_MAIN(cmocka_unit_test(frequencies_are_a_list_or_a_range),
           cmocka_unit_test(absent_frequencies_are_two_hundred),
           cmocka_unit_test(every_frequency_is_an_output),
           cmocka_unit_test(an_output_and_its_spectrum_need_each_other),
           cmocka_unit_test(a_spectrum_has_its_limits),
           cmocka_unit_test(an_input_does_not_take_the_name_of_an_ordinate),
           cmocka_unit_test(only_what_is_asked_counts_for_the_hash))
