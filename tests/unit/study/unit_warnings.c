/* unit_warnings.c - warnings: valid members of a study that are probably not intended, before and after its run. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

#define SCENE(oscillators, contact, excitation)                                                       \
	"{\"kind\": \"response\", \"scene\": {\"oscillators\": [" oscillators "], \"contact\": {" contact \
	"}, \"excitation\": {" excitation "}}}"
#define ROW(buildings, contact, excitation)                                                       \
	"{\"kind\": \"response\", \"scene\": {\"buildings\": [" buildings "], \"contact\": {" contact \
	"}, \"excitation\": {" excitation "}}}"
#define BODIES  "{\"frequency_hz\": 2}, {\"frequency_hz\": 3}"
#define STOREYS "\"storeys\": 2, \"mass_kg\": 2e5"
#define THREE                                                                           \
	"{" STOREYS ", \"frequency_hz\": 2}, {" STOREYS ", \"frequency_hz\": 3}, {" STOREYS \
	", \"frequency_hz\": 2.5}"
#define SHORT "\"type\": \"white_noise\", \"duration_s\": 2, \"time_step_s\": 0.01, \"signals\": 2"

/* The warning about each study; NULL pointer: none. */
static const struct {
	const char *study, *pointer, *detail;
	bool run; /* known only after the run */
} cases[] = {
    {SCENE(BODIES, "", SHORT), NULL, NULL, false},
    {SCENE("{\"frequency_hz\": 2, \"mass_kg\": 2e5}, {\"frequency_hz\": 3}", "", SHORT),
     "/scene/oscillators/1/mass_kg", "is 1 kg, the default, but another mass is 200000 kg: was it left out?",
     false},
    {SCENE("{\"frequency_hz\": 2}, {\"frequency_hz\": 3, \"mass_kg\": 5e4}", "", SHORT),
     "/scene/oscillators/0/mass_kg", "is 1 kg, the default, but another mass is 50000 kg: was it left out?",
     false},
    {SCENE(BODIES, "", SHORT ", \"peak_m_s2\": 98.0665"), "/scene/excitation/peak_m_s2",
     "has a peak of 98.07 m/s2, 10 g: is its unit m/s2?", false},
    {SCENE(BODIES, "", SHORT ", \"peak_m_s2\": 0.005"), "/scene/excitation/peak_m_s2",
     "has a peak of 0.005 m/s2, 0.0005099 g: is its unit m/s2?", false},
    {SCENE(BODIES, "", "\"type\": \"record\", \"time_step_s\": 0.01, \"acceleration_m_s2\": [0, -40, 1]"),
     "/scene/excitation", "has a peak of 40 m/s2, 4.079 g: is its unit m/s2?", false},
    {SCENE(BODIES, "",
           "\"type\": \"suite\", \"factor\": 20, \"records\": [{\"time_step_s\": 0.01, "
           "\"acceleration_m_s2\": [0, "
           "-2]}]"),
     "/scene/excitation", "has a peak of 40 m/s2, 4.079 g: is its unit m/s2?", false},
    {SCENE("{\"frequency_hz\": 2}, {\"frequency_hz\": 20}", "", SHORT), "/scene/excitation/time_step_s",
     "0.01 s is more than a tenth of the shortest period, 0.05 s: linear interpolation weakens the ground "
     "motion near resonance",
     false},
    {SCENE(BODIES, "\"gap_m\": 5", SHORT), "/scene/contact/gap_m", "no run has a contact", true},
    {ROW(THREE, "\"gap_m\": 0}, \"contacts\": [{\"levels\": [2, 2]}], \"law\": {\"type\": \"linear\"", SHORT),
     "/scene/contacts", "lists no contact between buildings 1 and 2: they pass through each other", false},
    {ROW(THREE, "\"gap_m\": 0", SHORT), NULL, NULL, false},
    // no runs with pounding
    {"{\"kind\": \"separation\", \"scene\": {\"oscillators\": [" BODIES "], \"excitation\": {" SHORT "}}}",
     NULL, NULL, false},
    {"{\"kind\": \"separation\", \"scene\": {\"oscillators\": [" BODIES
     "], \"contact\": {}, \"excitation\": {" SHORT "}}}",
     NULL, NULL, false},
    // a distribution without an upper end: the value that one scene in a thousand exceeds
    {"{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [" BODIES "], \"excitation\": {" SHORT
     "}}, \"inputs\": [{\"path\": \"/oscillators/0/frequency_hz\", \"distribution\": {\"type\": "
     "\"lognormal_cov\", \"mean\": 2, \"coefficient_of_variation\": 0.1}}, {\"path\": \"/contact/gap_m\", "
     "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 0.01}}], \"design\": {\"rows\": 4}}",
     NULL, NULL, false},
    {ROW("{\"frequency_hz\": 2}, {\"frequency_hz\": 3}", "", SHORT), NULL, NULL, false},
    {ROW("{\"frequency_hz\": 2, \"mass_kg\": [2e5, 3e5], \"storeys\": 2}, {\"frequency_hz\": 3}", "", SHORT),
     "/scene/buildings/1/mass_kg", "is 1 kg, the default, but another mass is 200000 kg: was it left out?",
     false},
    {ROW("{\"frequency_hz\": 2, \"storeys\": 8}, {\"frequency_hz\": 20}", "", SHORT),
     "/scene/excitation/time_step_s",
     "0.01 s is more than a tenth of the shortest period, 0.05 s: linear interpolation weakens the ground "
     "motion near resonance",
     false},
    {ROW("{\"frequency_hz\": 2}, {\"frequency_hz\": 3}", "\"gap_m\": 5", SHORT), "/scene/contacts",
     "no run has a contact", true},
    {ROW("{" STOREYS ", \"frequency_hz\": 2, \"height_m\": 3}, {" STOREYS
         ", \"frequency_hz\": 3, \"height_m\": [3, 4]}",
         "\"gap_m\": 0", SHORT),
     "/scene/contacts", "join level 2 of building 0 at 6 m and level 2 of building 1 at 7 m", false},
    {ROW("{" STOREYS ", \"frequency_hz\": 2, \"height_m\": 3}, {" STOREYS
         ", \"frequency_hz\": 3, \"height_m\": 4}",
         "\"gap_m\": 0", SHORT),
     "/scene/contacts", "join level 1 of building 0 at 3 m and level 1 of building 1 at 4 m, and 1 more pair",
     false},
    {ROW("{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 2}, {\"storeys\": 4, \"mass_kg\": 1e5, "
         "\"frequency_hz\": 3, "
         "\"height_m\": [4, 3, 3, 3]}, {\"rigid_wall\": true}",
         "\"gap_m\": 0", SHORT),
     "/scene/contacts",
     "join level 1 of building 0 at 3 m and level 1 of building 1 at 4 m, and 2 more pairs", false},
    {ROW("{" STOREYS ", \"frequency_hz\": 2, \"height_m\": 3}, {" STOREYS
         ", \"frequency_hz\": 3, \"height_m\": 4}",
         "\"gap_m\": 0}, \"contacts\": [{\"levels\": [1, 0.75]}, {\"levels\": [2, 2]}], \"law\": {\"type\": "
         "\"linear\"",
         SHORT),
     "/scene/contacts/1/levels", "join level 2 of building 0 at 6 m and level 2 of building 1 at 8 m", false},
    {ROW("{" STOREYS ", \"frequency_hz\": 2, \"damping\": \"rayleigh\", \"damping_modes\": [1, 4]}, {" STOREYS
         ", \"frequency_hz\": 3}",
         "\"gap_m\": 0", SHORT),
     "/scene/buildings/0/damping_modes", "has mode 4 of a building of 2: the highest mode is used instead",
     false},
    {ROW("{" STOREYS ", \"frequency_hz\": 2}, {" STOREYS ", \"frequency_hz\": 3}",
         "\"gap_m\": 0, \"model\": \"rigid\"", SHORT),
     "/scene/contact/model", "makes velocities jump: accelerations with pounding do not include the impacts",
     false},
    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [" BODIES
     "], \"contact\": {\"model\": \"rigid\"}, \"excitation\": {" SHORT
     "}}, \"outputs\": [\"peak_acceleration_m_s2\"]}",
     "/scene/contact/model", "makes velocities jump: accelerations with pounding do not include the impacts",
     false},
    {ROW("{" STOREYS ", \"frequency_hz\": 2, \"law\": {\"type\": \"elastoplastic\", \"target_demand\": 2}}, "
         "{" STOREYS ", \"frequency_hz\": 3}",
         "\"gap_m\": 0", SHORT),
     "/scene/buildings/0/law/target_demand", "is 2, but demands of building 0 without pounding are ", true},
    // also with a sweep that changes no building
    {"{\"kind\": \"response\", \"scene\": {\"buildings\": [{" STOREYS
     ", \"frequency_hz\": 2, \"law\": {\"type\": \"elastoplastic\", \"target_demand\": 2}}, {" STOREYS
     ", \"frequency_hz\": 3}], \"contact\": {}, \"excitation\": {" SHORT
     "}}, \"sweep\": [{\"path\": \"/contact/gap_m\", \"values\": [0, 0.001]}]}",
     "/scene/buildings/0/law/target_demand", "is 2, but demands of building 0 without pounding are ", true},
    {"{\"kind\": \"sensitivity\", \"scene\": {\"buildings\": [{" STOREYS
     ", \"frequency_hz\": 2, \"law\": {\"type\": \"elastoplastic\"}}, {" STOREYS
     ", \"frequency_hz\": 3}], \"contact\": {}, \"excitation\": {" SHORT
     "}}, \"inputs\": [{\"path\": \"/excitation/peak_m_s2\", \"distribution\": {\"type\": "
     "\"uniform\", \"min\": 1, \"max\": 2}}, {\"path\": \"/contact/gap_m\", "
     "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 0.001}}], \"design\": {\"rows\": 4}}",
     "/scene/buildings/0/law/target_demand",
     "yield drifts of building 0 are set story by story, without a search: demands may be several times "
     "larger or smaller; a response study of this scene reports them",
     false},
    // of a lognormal peak only what few samples exceed counts
    {"{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [" BODIES "], \"excitation\": {" SHORT
     "}}, \"inputs\": [{\"path\": \"/excitation/peak_m_s2\", \"distribution\": {\"type\": "
     "\"lognormal_median\", \"median\": 3, \"dispersion\": 0.4}}, {\"path\": \"/contact/gap_m\", "
     "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 0.01}}], \"design\": {\"rows\": 4}}",
     NULL, NULL, false},
    {"{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [" BODIES "], \"excitation\": {" SHORT
     "}}, \"inputs\": [{\"path\": \"/excitation/peak_m_s2\", \"distribution\": {\"type\": "
     "\"lognormal_median\", \"median\": 30, \"dispersion\": 0.4}}, {\"path\": \"/contact/gap_m\", "
     "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 0.01}}], \"design\": {\"rows\": 4}}",
     "/scene/excitation/peak_m_s2", "has a peak of 76.08 m/s2, 7.758 g: is its unit m/s2?", false},
};

static struct reading *estimate_of(const struct pound_study *study)
{
	const struct cost cost = cost_of(study, 1);
	size_t length;
	char *json = cost_to_json(&cost, study, &length);
	struct reading *read = reading_open(json, length);
	assert_non_null(read);
	free(json);
	return read;
}

static struct reading *result_of(const struct pound_study *study)
{
	struct pound_run *run = specimen_run(study);
	size_t length;
	char *json = result_to_json(study, pound_run_result(run), NULL, &length);
	struct reading *read = reading_open(json, length);
	assert_non_null(read);
	free(json);
	pound_run_free(run);
	return read;
}

static void what_was_probably_not_meant_is_said_before_and_after_the_run(void **state)
{
	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct pound_study *study = study_documents_study(cases[k].study);
		struct reading *read[] = {estimate_of(study), result_of(study)};
		for (int j = 0; j < 2; j++) {
			if (!cases[k].pointer || (j == 0 && cases[k].run)) {
				assert_false(reading_has(read[j], "/warnings"));
				continue;
			}
			if (!reading_has(read[j], "/warnings/0"))
				fail_msg("nothing is said of %s", cases[k].study);
			assert_int_equal(reading_count(read[j], "/warnings"), 1);
			assert_string_equal(reading_text(read[j], "/warnings/0/pointer"), cases[k].pointer);
			const char *detail = reading_text(read[j], "/warnings/0/detail");
			if (cases[k].run)
				assert_memory_equal(detail, cases[k].detail, strlen(cases[k].detail));
			else
				assert_string_equal(detail, cases[k].detail);
		}
		reading_close(read[0]);
		reading_close(read[1]);
		study_free(study);
	}
}

/* For a row: the law of one building, and of neither story of the other. */
static void a_yield_drift_that_is_never_reached_is_named(void **state)
{
	(void)state;
	static const char text[] = ROW(
	    "{\"frequency_hz\": 2}, {\"frequency_hz\": 3, \"storeys\": 2, \"law\": {\"type\": \"elastoplastic\", "
	    "\"yield_displacement_m\": 10}}",
	    "", SHORT);
	struct pound_study *study = study_documents_study(text);
	struct reading *result = result_of(study);
	assert_int_equal(reading_count(result, "/warnings"), 1);
	assert_string_equal(reading_text(result, "/warnings/0/pointer"),
	                    "/scene/buildings/1/law/yield_displacement_m");
	assert_memory_equal(reading_text(result, "/warnings/0/detail"), "is never reached by building 1", 30);
	reading_close(result);
	study_free(study);
}

/* A yield displacement above all displacements of the left body, but not of the right one. */
static void a_yield_displacement_that_is_never_reached_is_named(void **state)
{
	(void)state;
	static const char text[] =
	    SCENE("{\"frequency_hz\": 2, \"law\": {\"type\": \"elastoplastic\", \"yield_displacement_m\": 10}}, "
	          "{\"frequency_hz\": 3, \"law\": {\"type\": \"elastoplastic\", \"yield_displacement_m\": 1e-4}}",
	          "", SHORT);
	struct pound_study *study = study_documents_study(text);
	struct reading *result = result_of(study);
	assert_int_equal(reading_count(result, "/warnings"), 1);
	assert_string_equal(reading_text(result, "/warnings/0/pointer"),
	                    "/scene/oscillators/0/law/yield_displacement_m");
	assert_memory_equal(reading_text(result, "/warnings/0/detail"), "is never reached by oscillator 0", 32);
	reading_close(result);
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(a_yield_drift_that_is_never_reached_is_named),
           cmocka_unit_test(what_was_probably_not_meant_is_said_before_and_after_the_run),
           cmocka_unit_test(a_yield_displacement_that_is_never_reached_is_named))
