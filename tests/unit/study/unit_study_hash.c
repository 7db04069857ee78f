/* unit_study_hash.c - changes that alter the hash of a study, and changes that do not. */
#include <string.h>

#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

static void hash_of(const char *document, char hex[STUDY_HASH_SIZE])
{
	struct pound_study *study = study_documents_study(document);
	assert_true(study_hash(study, hex));
	assert_int_equal(strlen(hex), STUDY_HASH_SIZE - 1);
	study_free(study);
}

static bool same(const char *document, const char *from, const char *to)
{
	char one[STUDY_HASH_SIZE], other[STUDY_HASH_SIZE];
	char *changed = study_documents_with(document, from, to);
	hash_of(document, one);
	hash_of(changed, other);
	free(changed);
	return strcmp(one, other) == 0;
}

static void spelling_order_and_names_do_not_change_it(void **state)
{
	(void)state;
	static const struct {
		const char *from, *to;
	} changes[] = {
	    {"\"name\": \"a study\",", ""},
	    {"\"a study\"", "\"another\""},
	    {"\"f_e\"", "\"frequency\""},
	    {"\"mass_kg\": 3", "\"mass_kg\": 3.0e0"},
	    {"\"mass_kg\": 3", "\"mass_kg\": 0.3E1"},
	    {"\"gap_m\": 0.01", "\"gap_m\": 1e-2"},
	    {"\"gap_m\": 0.01", "\"gap_m\"\t:\r\n0.01"},
	    {"\"kelvin_voigt\"", "\"kelvin\\u005fvoigt\""},
	    {"\"seed\": 42", "\"seed\": \"42\""},
	    {"\"seed\": 42", "\"seed\": \"0042\""},
	    {"\"mass_kg\": 1, \"frequency_hz\": 2", "\"frequency_hz\": 2, \"mass_kg\": 1"},
	    {"\"hardening_ratio\": 0.05, ", ""}, // absent means its default
	    {", \"rigid_wall\": false", ""},
	    {"\"mass_kg\": 1, ", ""},
	    {"\"damping_ratio\": 0.05", "\"damping_ratio\": 0.05000000000000000001"},
	    {",\n \"solver\": {\"method\": \"event\", \"tolerance\": 1e-9}", ""},
	    {"\"min\": 0.5, \"max\": 5", "\"max\": 5, \"min\": 0.5"},
	};
	for (int i = 0; i < COUNT(changes); i++)
		if (!same(study_documents_sensitivity, changes[i].from, changes[i].to))
			fail_msg("%s for %s changes the hash", changes[i].to, changes[i].from);
}

static void any_other_change_changes_it(void **state)
{
	(void)state;
	static const struct {
		const char *from, *to;
	} changes[] = {
	    {"\"elastoplastic\"", "\"origin_oriented\""},
	    {"\"hardening_ratio\": 0.05", "\"hardening_ratio\": 0.051"},
	    {"\"target_demand\": 2", "\"target_demand\": 3"},
	    {"\"target_demand\": 2", "\"yield_displacement_m\": 2"},
	    {"\"corrections\": 1", "\"corrections\": 2"},
	    {"\"mass_kg\": 1", "\"mass_kg\": 1.0000000000000002"},
	    {"\"frequency_hz\": 2,", "\"frequency_hz\": 2.1,"},
	    {"\"damping_ratio\": 0.02", "\"damping_ratio\": 0.03"},
	    {"\"yield_displacement_m\": 0.25", "\"yield_displacement_m\": 0.5"},
	    {"\"stiffness_ratio\": 100", "\"stiffness_ratio\": 1000"},
	    {"\"restitution\": 0.6", "\"restitution\": 0.5"},
	    {"\"gap_m\": 0.01", "\"gap_m\": 0"},
	    {"\"tension\": true", "\"tension\": false"},
	    {"\"tension\": true", "\"tension\": true, \"calibration\": \"exact\""},
	    {"\"stiffness_ratio\": 100", "\"stiffness_n_m\": 100"},
	    {"\"high_pass_ratio\": 0.1", "\"high_pass_ratio\": 0.2"},
	    {"\"signals\": 5", "\"signals\": 6"},
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 0.02"},
	    {"/excitation/frequency_hz", "/excitation/cycles"},
	    {"\"max\": 5", "\"max\": 4"},
	    {"\"type\": \"uniform\"", "\"type\": \"log_uniform\""},
	    {"[0.2, 0.9]", "[0.9, 0.2]"},
	    {"\"lhs\"", "\"random\""},
	    {"\"rows\": 10", "\"rows\": 11"},
	    {"\"seed\": 42", "\"seed\": 43"},
	    {"\"common\"", "\"independent\""},
	    {"\"demand_amplification\", \"impulse\"", "\"impulse\", \"demand_amplification\""},
	    {"\"tolerance\": 1e-9", "\"tolerance\": 1e-8"},
	};
	for (int i = 0; i < COUNT(changes); i++)
		if (same(study_documents_sensitivity, changes[i].from, changes[i].to))
			fail_msg("%s for %s does not change the hash", changes[i].to, changes[i].from);
	assert_false(same(study_documents_convergence, "[0.01, 0.001]", "[0.01]"));
	assert_false(same(study_documents_convergence, "\"history_s\": 2", "\"history_s\": 3"));
	assert_true(same(study_documents_sensitivity, "\"tension\": true", "\"calibration\": \"classic\""));
	assert_true(same(study_documents_convergence, ", \"history_s\": 2", ""));
	assert_false(same(study_documents_response, "\"oscillators\"", "\"contact\": null, \"oscillators\""));
	assert_false(same(study_documents_response, "{\"frequency_hz\": 3.1}", "{\"rigid_wall\": true}"));
}

static void every_sample_of_a_record_counts(void **state)
{
	(void)state;
	char *record = study_documents_with(
	    study_documents_response, "\"oscillators\"",
	    "\"excitation\": {\"type\": \"record\", \"acceleration_m_s2\": [0, 1, 2]}, \"oscillators\"");
	assert_true(same(record, "[0, 1, 2]", "[0,1e0,0.2e1]"));
	assert_false(same(record, "[0, 1, 2]", "[0, 1, 2, 0]"));
	assert_false(same(record, "[0, 1, 2]", "[0, 1, 2.0000000000000004]"));
	free(record);
}

// results of different builds are compared by their hashes: a new value here means that existing hashes become invalid
static void a_hash_stays_what_it_is(void **state)
{
	(void)state;
	char hex[STUDY_HASH_SIZE];
	hash_of(study_documents_response, hex);
	assert_string_equal(hex, "96e2d140f562cc85f018e269b3c41d47c3298d0557221069d9b6687291bc7a86");
}

CHECK_MAIN(cmocka_unit_test(spelling_order_and_names_do_not_change_it),
           cmocka_unit_test(any_other_change_changes_it), cmocka_unit_test(every_sample_of_a_record_counts),
           cmocka_unit_test(a_hash_stays_what_it_is))
