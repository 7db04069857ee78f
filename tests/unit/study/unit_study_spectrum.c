/* unit_study_spectrum.c - floor spectra in study documents: frequencies, limits, an output for each ordinate. */
#include <math.h>
#include <string.h>

#include "schema/study/study_json.h"
#include "schema/study/study_spectrum.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define ORDINATES "\"outputs\": [\"impulse\", \"floor_spectrum\"]"

/* The sensitivity document with ordinates at these `frequencies`. */
static char *document_with(const char *frequencies)
{
	char outputs[600];
	snprintf(outputs, sizeof outputs, ORDINATES "%s%s%s",
	         *frequencies ? ", \"spectrum\": {\"frequencies_hz\": " : "", frequencies,
	         *frequencies ? "}" : "");
	return study_documents_with(study_documents_sensitivity,
	                            "\"outputs\": [\"demand_amplification\", \"impulse\"]", outputs);
}

static void frequencies_are_a_list_or_a_range(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(study_documents_floor);
	assert_int_equal(study->spectrum.n, 9);
	check_near(pound_spectrum_frequency(&study->spectrum, 4), 5, 1e-14);
	check_near(study->spectrum.damping_ratio, 0.02, 0);
	assert_int_equal(study->spectrum.pulses, 15);
	assert_int_equal(study->n_outputs, 0);
	study_free(study);
	char *listed = study_documents_with(study_documents_floor, "{\"min\": 0.5, \"max\": 50, \"count\": 9}",
	                                    "[7.5, 3, 1e1]");
	study = study_documents_study(listed);
	assert_int_equal(study->spectrum.n, 3);
	check_near(pound_spectrum_frequency(&study->spectrum, 0), 7.5, 0);
	check_near(pound_spectrum_frequency(&study->spectrum, 2), 10, 0);
	study_free(study);
	free(listed);
}

static void absent_frequencies_are_two_hundred(void **state)
{
	(void)state;
	struct pound_study *study =
	    study_documents_study("{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": "
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
	struct pound_study *study = study_documents_study(document);
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

static void only_what_is_asked_counts_for_the_hash(void **state)
{
	(void)state;
	char range[STUDY_HASH_SIZE], list[STUDY_HASH_SIZE], other[STUDY_HASH_SIZE];
	char *listed =
	    study_documents_with(study_documents_floor, "{\"min\": 0.5, \"max\": 50, \"count\": 9}", "[0.5, 50]");
	char *ranged = study_documents_with(study_documents_floor, "\"count\": 9", "\"count\": 2");
	struct pound_study *studies[] = {study_documents_study(listed), study_documents_study(ranged),
	                                 study_documents_study(study_documents_floor)};
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
           cmocka_unit_test(only_what_is_asked_counts_for_the_hash))
