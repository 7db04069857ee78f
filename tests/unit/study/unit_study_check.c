/* unit_study_check.c - members that are valid separately and invalid together, where cases of unit_study_cases.c do
 * not suffice: limits as numbers, documents too long for a line, pairs of faults. */
#include <math.h>
#include <string.h>

#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

#define EPS          "\"/contact/restitution\", \"values\": [0.2, 0.9]"

static void absent_outputs_are_all_that_apply_in_a_cell(void **state)
{
	(void)state;
	char *swept = study_documents_with(study_documents_sensitivity, EPS,
	                                   "\"/law/type\", \"values\": [\"linear\", \"origin_oriented\"]");
	char *both = study_documents_with(swept, ",\n \"outputs\": [\"demand_amplification\", \"impulse\"]", "");
	struct pound_study *study = study_documents_study(both);
	assert_int_equal(study->n_outputs, 3); // all that apply in some cell
	study_free(study);
	free(both);
	free(swept);
}

static void what_is_too_large_is_reported_with_its_limit(void **state)
{
	(void)state;
	char *many = study_documents_with(study_documents_sensitivity, "\"rows\": 10", "\"rows\": 200000");
	char *document =
	    study_documents_with(many, "\"time_step_s\": 0.01", "\"time_step_s\": 3e-4"); // 133,334 samples
	struct problems problems;
	assert_null(study_from_json(document, strlen(document), &problems));
	check_near(problems.list[0].limit, 1e12, 0);
	check_near(problems.list[0].requested, 1.0666720e12, 1e8);
	free(document);
	free(many);
}

static void cells_are_the_product_of_the_sweeps_the_last_one_fastest(void **state)
{
	(void)state;
	char *document = study_documents_with(
	    study_documents_sensitivity, EPS "}",
	    "\"/contact/gap_m\", \"values\": [0, 1, 2]}, {\"path\": \"/law/type\", \"values\": "
	    "[\"elastoplastic\", \"origin_oriented\"]}");
	struct pound_study *study = study_documents_study(document);
	assert_int_equal(study_cells(study), 6);
	assert_int_equal(study_runs(study), 6 * 10 * 4 * 5);
	check_near(study_samples(study), 4001, 0); // 20 cycles at 0.5 Hz, 0.01 s
	for (int cell = 0; cell < 6; cell++) {
		struct pound_scene scene;
		study_cell(study, cell, &scene);
		check_near(scene.contact.gap, cell / 2, 0);
		assert_string_equal(pound_law_name(scene.law.type), cell % 2 ? "origin_oriented" : "elastoplastic");
	}
	study_free(study);
	free(document);
}

static void too_many_cells_are_refused_before_they_are_counted_out(void **state)
{
	(void)state;
	char list[8 * 2000], *at = list;
	for (int i = 0; i < 1001; i++)
		at += sprintf(at, "%s%d", i ? "," : "", i + 1);
	char *swept = malloc(10 * sizeof list);
	assert_non_null(swept);
	at = swept + sprintf(swept, "{\"frequency_hz\": 3.1}]}, \"sweep\": [");
	static const char *const paths[] = {"/oscillators/0/mass_kg",
	                                    "/oscillators/1/mass_kg",
	                                    "/oscillators/0/frequency_hz",
	                                    "/oscillators/1/frequency_hz",
	                                    "/contact/gap_m",
	                                    "/contact/stiffness_ratio",
	                                    "/excitation/peak_m_s2",
	                                    "/excitation/high_pass_ratio"};
	for (int s = 0; s < 8; s++)
		at += sprintf(at, "%s{\"path\": \"%s\", \"values\": [%s]}", s ? "," : "", paths[s], list);
	strcpy(at, "]");
	char *document = study_documents_with(study_documents_response, "{\"frequency_hz\": 3.1}]}", swept);
	study_documents_problem(document, "/sweep", "needs 1.00802805607006e+24 cells; the limit is 10000");
	free(document);
	free(swept);
}

/* A change of a document that leads to a problem at a pointer. */
struct change {
	const char *from, *to, *pointer;
};

static void every_fault_is_reported_whatever_else_is_wrong(void **state)
{
	(void)state;
	static const char whole[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"law\": {\"type\": \"linear\"}, \"oscillators\": "
	    "[{\"mass_kg\": 1, \"frequency_hz\": 2}, {\"frequency_hz\": 3}], \"contact\": {\"restitution\": "
	    "0.6}, "
	    "\"excitation\": {\"rise\": 0.1, \"fall\": 0.2, \"time_step_s\": 0.01, \"signals\": 2}}, "
	    "\"inputs\": [{\"path\": \"/contact/gap_m\", \"name\": \"g\", \"distribution\": {\"type\": "
	    "\"uniform\", \"min\": 0, \"max\": 1}}, {\"path\": \"/oscillators/1/mass_kg\", \"name\": \"m\", "
	    "\"distribution\": {\"type\": \"uniform\", \"min\": 1, \"max\": 6}}], "
	    "\"sweep\": [{\"path\": \"/oscillators/0/damping_ratio\", \"values\": [0.05, 0.1]}], "
	    "\"design\": {\"rows\": 16, \"seed\": 1}, \"outputs\": [\"impulse\"], \"solver\": {\"method\": "
	    "\"event\"}}";
	static const struct change faults[] = {
	    {"\"restitution\": 0.6", "\"restitution\": 2", "/scene/contact/restitution"},
	    {"\"mass_kg\": 1,", "\"mass_kg\": \"heavy\",", "/scene/oscillators/0/mass_kg"},
	    {"\"rise\": 0.1", "\"rise\": 0.9", "/scene/excitation/fall"},
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 1e-12", "/scene/excitation/time_step_s"},
	    {"[\"impulse\"]", "[\"demand_amplification\"]", "/outputs/0"},
	    {"\"rows\": 16", "\"rows\": 1000000", "/design/rows"},
	    {"\"seed\": 1", "\"seed\": -1", "/design/seed"},
	    {"\"name\": \"g\"", "\"name\": \"row\"", "/inputs/0/name"},
	    {"\"min\": 0,", "\"min\": -1,", "/inputs/0/distribution"},
	    {"\"max\": 6", "\"max\": 0", "/inputs/1/distribution"},
	    {"[0.05, 0.1]", "[0.05, 3]", "/sweep/0/values/1"},
	    {"\"event\"", "\"best\"", "/solver/method"},
	};
	study_free(study_documents_study(whole));
	for (int i = 0; i < COUNT(faults); i++)
		for (int j = 0; j < COUNT(faults); j++) {
			struct problems problems;
			char *one = study_documents_with(whole, faults[i].from, faults[i].to),
			     *both = j == i ? study_documents_with(one, "\"kind\"", "\"kind\"")
			                    : study_documents_with(one, faults[j].from, faults[j].to);
			study_documents_refused(both, &problems);
			// cells of an invalid sweep are not checked
			const bool swept = (i == 10 || j == 10) && (i == 4 || j == 4 || i == 5 || j == 5);
			if (!swept &&
			    (!problems_at(&problems, faults[i].pointer) || !problems_at(&problems, faults[j].pointer)))
				fail_msg("%s beside %s is not reported", faults[i].pointer, faults[j].pointer);
			free(one), free(both);
		}
}

CHECK_MAIN(cmocka_unit_test(every_fault_is_reported_whatever_else_is_wrong),
           cmocka_unit_test(absent_outputs_are_all_that_apply_in_a_cell),
           cmocka_unit_test(what_is_too_large_is_reported_with_its_limit),
           cmocka_unit_test(cells_are_the_product_of_the_sweeps_the_last_one_fastest),
           cmocka_unit_test(too_many_cells_are_refused_before_they_are_counted_out))
