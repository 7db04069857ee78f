/* unit_study_check.c - members that are right on their own and wrong together. */
#include <math.h>
#include <string.h>

#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

/* A change of documents_sensitivity that leads to one problem; detail "": none. */
struct change {
	const char *from, *to, *pointer, *detail;
};

static void try_all(const struct change *changes, int n)
{
	for (int i = 0; i < n; i++) {
		char *document = documents_with(documents_sensitivity, changes[i].from, changes[i].to);
		if (*changes[i].detail)
			documents_problem(document, changes[i].pointer, changes[i].detail);
		else
			study_free(documents_study(document));
		free(document);
	}
}

#define F_E "\"/excitation/frequency_hz\""
#define FIRST \
	F_E ", \"name\": \"f_e\",\n   \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, \"max\": 5}"
#define BETWEEN(min, max) ", \"distribution\": {\"type\": \"uniform\", \"min\": " #min ", \"max\": " #max "}"
#define M_2               "\"/oscillators/1/mass_kg\""
#define EPS               "\"/contact/restitution\", \"values\": [0.2, 0.9]"

static void an_input_names_a_real_number_that_matters(void **state)
{
	(void)state;
	static const struct change changes[] = {
	    {F_E, "\"/contact/stiffness_ratio\"", "", ""},
	    {F_E, "\"/contact/gap_m\"", "", ""},
	    {FIRST, "\"/law/target_demand\"" BETWEEN(1, 5), "", ""},
	    {F_E, "\"/law/yield_displacement_m\"", "", ""},
	    {FIRST, "\"/law/hardening_ratio\"" BETWEEN(0, 1), "", ""},
	    {F_E, "\"excitation/frequency_hz\"", "/inputs/0/path",
	     "names nothing in \"scene\", did you mean \"/excitation/frequency_hz\"?"},
	    {F_E, "\"/scene/excitation/frequency_hz\"", "/inputs/0/path",
	     "names nothing in \"scene\", did you mean \"/excitation/frequency_hz\"?"},
	    {F_E, "\"/oscillators/2/mass_kg\"", "/inputs/0/path",
	     "names nothing in \"scene\", did you mean \"/oscillators/0/mass_kg\"?"},
	    {F_E, "\"/oscillators/*/mass_kg\"", "/inputs/0/path",
	     "names nothing in \"scene\", did you mean \"/oscillators/0/mass_kg\"?"},
	    {F_E, "\"f_e\"", "/inputs/0/path",
	     "must be a JSON Pointer into \"scene\", such as \"/contact/restitution\""},
	    {F_E, "\"/excitation\"", "/inputs/0/path", "names several fields, not one"},
	    {F_E, "\"/oscillators/0\"", "/inputs/0/path", "names several fields, not one"},
	    {F_E, "\"/law/corrections\"", "/inputs/0/path",
	     "names a field that is not a real number: only a sweep may vary it"},
	    {F_E, "\"/contact/tension\"", "/inputs/0/path",
	     "names a field that is not a real number: only a sweep may vary it"},
	    {F_E, "\"/law/type\"", "/inputs/0/path",
	     "names a field that is not a real number: only a sweep may vary it"},
	    {F_E, "\"/excitation/signals\"", "/inputs/0/path",
	     "names a field that may not vary: every sample has the same number of signals"},
	    {F_E, "\"/excitation/type\"", "/inputs/0/path",
	     "names a field that may not vary: it decides what the other members mean"},
	    {F_E, "\"/excitation/acceleration_m_s2/3\"", "/inputs/0/path",
	     "names a field that may not vary: a record is what it is"},
	    {F_E, "\"/excitation/duration_s\"", "/inputs/0/path",
	     "names a field that excitation \"kanai_tajimi\" does not use"},
	    {FIRST, "\"/oscillators/0/law/target_demand\"" BETWEEN(1, 5), "/inputs/0/path",
	     "names the law of an oscillator that has none of its own"},
	    {F_E, "\"/oscillators/1/law/yield_displacement_m\"", "/inputs/0/path",
	     "has no effect: the law is linear"},
	    {F_E, M_2, "/inputs/1/path", "names the same field as /inputs/0"},
	    {FIRST, "\"/contact/restitution\"" BETWEEN(0.5, 1), "/sweep/0/path",
	     "names the same field as /inputs/0"},
	    {"\"f_e\"", M_2, "/inputs/1/name", "is the name of /inputs/0 too"},
	    {"\"f_e\"", "\"impulse\"", "/inputs/0/name", "is the name of another column of the samples"},
	    {"\"f_e\"", "\"impulse.variance\"", "/inputs/0/name", "is the name of another column of the samples"},
	    {"\"f_e\"", "\"row\"", "/inputs/0/name", "is the name of another column of the samples"},
	};
	try_all(changes, COUNT(changes));
}

static void a_sweep_takes_values_as_the_field_does(void **state)
{
	(void)state;
	static const struct change changes[] = {
	    {EPS, "\"/law/corrections\", \"values\": [0, 1, 3]", "", ""},
	    {EPS, "\"/law/corrections\", \"values\": [0, 1.5]", "/sweep/0/values/1",
	     "must be a whole number, got 1.5"},
	    {EPS, "\"/contact/tension\", \"values\": [true, false]", "", ""},
	    {EPS, "\"/contact/tension\", \"values\": [1]", "/sweep/0/values/0", "must be true or false, got 1"},
	    {EPS, "\"/contact/model\", \"values\": [\"kelvin_voigt\"]", "", ""},
	    {EPS, "\"/law/type\", \"values\": [\"linear\", \"elastoplastic\"]", "", ""},
	    {EPS, "\"/law/type\", \"values\": [\"elastoplastic\", \"plastic\"]", "/sweep/0/values/1",
	     "must be one of \"linear\", \"elastoplastic\", \"nonlinear_elastic\", \"origin_oriented\", got "
	     "\"plastic\""},
	    {EPS, "\"/law/type\", \"values\": [\"elastoplastic\", \"elastoplastic\"]", "/sweep/0/values/1",
	     "is the same as value 0"},
	    {EPS, "\"/oscillators/0/mass_kg\", \"values\": [1, 0]", "/sweep/0/values/1",
	     "must be greater than 0, got 0"},
	    {EPS, "\"/excitation/signals\", \"values\": [1, 2]", "/sweep/0/path",
	     "names a field that may not vary: every sample has the same number of signals"},
	    {EPS, "\"/oscillators/1/rigid_wall\", \"values\": [true]", "/sweep/0/path",
	     "names a field that may not vary: it decides what the other members mean"},
	    {EPS, "\"/oscillators/1/mass_kg\", \"values\": [1]", "/sweep/0/path",
	     "names the same field as /inputs/1"},
	};
	try_all(changes, COUNT(changes));
}

static void inputs_stay_in_the_range_of_their_fields(void **state)
{
	(void)state;
	static const struct change changes[] = {
	    {"\"min\": 0.5, \"max\": 5", "\"min\": 0, \"max\": 5", "/inputs/0/distribution",
	     "gives values from 0 to 5, but /excitation/frequency_hz must be greater than 0"},
	    {"{\"type\": \"uniform\", \"min\": 0.5, \"max\": 5}",
	     "{\"type\": \"normal\", \"mean\": 3, \"standard_deviation\": 0.1}", "/inputs/0/distribution",
	     "gives values from -inf to inf, but /excitation/frequency_hz must be greater than 0"},
	    // 0 is no value of a lognormal, and no parameter of it
	    {"{\"type\": \"reciprocal_uniform\", \"max\": 6}",
	     "{\"type\": \"lognormal\", \"log_mean\": 0, \"log_standard_deviation\": 1}", "", ""},
	    {"{\"type\": \"reciprocal_uniform\", \"max\": 6}",
	     "{\"type\": \"truncated_normal\", \"mean\": 0, \"standard_deviation\": 1, \"min\": 0.1, \"max\": 9}",
	     "", ""},
	    {M_2 ", \"distribution\": {\"type\": \"reciprocal_uniform\", \"max\": 6}",
	     "\"/oscillators/1/damping_ratio\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": "
	     "1}",
	     "/inputs/1/distribution",
	     "gives values from 0 to 1, but /oscillators/1/damping_ratio must be in [0, 1)"},
	    {M_2 ", \"distribution\": {\"type\": \"reciprocal_uniform\", \"max\": 6}",
	     "\"/contact/gap_m\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 0.01}", "", ""},
	};
	try_all(changes, COUNT(changes));
}

static void a_ground_motion_is_shaped_and_sampled_sensibly(void **state)
{
	(void)state;
	static const struct change changes[] = {
	    {"\"rise\": 0.15, \"fall\": 0.25", "\"rise\": 0.5, \"fall\": 0.5", "", ""},
	    {"\"rise\": 0.15, \"fall\": 0.25", "\"rise\": 0.7, \"fall\": 0.4", "/scene/excitation/fall",
	     "rise + fall must be at most 1, got 1.1"},
	    {EPS, "\"/excitation/rise\", \"values\": [0, 0.8]", "/scene/excitation/fall",
	     "rise + fall must be at most 1, got 1.05"},
	    // 20 cycles at 5 Hz last 4 s, at 0.5 Hz 40 s
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 4", "", ""},
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 5", "/scene/excitation/time_step_s",
	     "the ground motion must last one time step at least, not 0.8 of one"},
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 4.01e-6", "/sweep",
	     "asks for 7.98e+07 samples of ground motion at once (cells x samples of a row x samples of a "
	     "motion), at most "
	     "50000000"},
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 3e-6", "/scene/excitation/time_step_s",
	     "a ground motion may have at most 10000000 samples, this asks for 1.33e+07"},
	    {"\"min\": 0.5, \"max\": 5", "\"min\": 1e-300, \"max\": 5", "/scene/excitation/time_step_s",
	     "a ground motion may have at most 10000000 samples, this asks for 2e+303"},
	};
	try_all(changes, COUNT(changes));
}

static void an_output_applies_in_one_cell_at_least(void **state)
{
	(void)state;
	static const struct change changes[] = {
	    {"\"impulse\"]", "\"force_amplification\"]", "/outputs/1",
	     "does not apply to this scene: it needs a linear law of the left oscillator"},
	    {"\"elastoplastic\"", "\"linear\"", "/outputs/0",
	     "does not apply to this scene: it needs a nonlinear law of the left oscillator"},
	    {EPS "}],\n \"design\"",
	     "\"/law/type\", \"values\": [\"linear\", \"origin_oriented\"]}],\n \"design\"", "", ""},
	};
	try_all(changes, COUNT(changes));
	char *swept = documents_with(documents_sensitivity, EPS,
	                             "\"/law/type\", \"values\": [\"linear\", \"origin_oriented\"]");
	char *both = documents_with(swept, "\"impulse\"]", "\"force_amplification\"]");
	study_free(documents_study(both));
	free(both);
	both = documents_with(swept, ",\n \"outputs\": [\"demand_amplification\", \"impulse\"]", "");
	struct pound_study *study = documents_study(both);
	assert_int_equal(study->n_outputs, 3); // all that apply somewhere
	study_free(study);
	free(both);
	free(swept);
}

static void without_a_contact_nothing_of_it_varies(void **state)
{
	(void)state;
	struct problems problems;
	char *document = documents_with(documents_sensitivity,
	                                "\"contact\": {\"model\": \"kelvin_voigt\", \"stiffness_ratio\": 100, "
	                                "\"restitution\": 0.6, \"gap_m\": 0.01,\n   \"tension\": true}",
	                                "\"contact\": null");
	documents_refused(document, &problems);
	assert_int_equal(problems.n, 1);
	assert_string_equal(problems.list[0].pointer, "/sweep/0/path");
	assert_string_equal(problems.list[0].detail, "has no effect: there is no contact in this scene");
	free(document);
}

static void the_law_of_nobody_and_the_fields_of_a_wall_do_not_vary(void **state)
{
	(void)state;
	char *document =
	    documents_with(documents_response, "{\"frequency_hz\": 3.1}]}",
	                   "{\"rigid_wall\": true}]}, \"sweep\": [{\"path\": \"/oscillators/1/mass_kg\", "
	                   "\"values\": [1]}]");
	documents_problem(document, "/sweep/0/path", "names a field of a rigid wall, which has none");
	free(document);
	document =
	    documents_with(documents_response, "{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}]}",
	                   "{\"frequency_hz\": 2, \"law\": {}}, {\"rigid_wall\": true}]}, \"sweep\": [{\"path\": "
	                   "\"/law/type\", \"values\": [\"linear\"]}]");
	documents_problem(document, "/sweep/0/path", "has no effect: no oscillator follows the scene's law");
	free(document);
}

/* documents_sensitivity has an elastoplastic left oscillator that follows the scene's law and a linear right one. */
static void what_a_law_does_not_use_does_not_vary(void **state)
{
	(void)state;
	static const char linear[] = "has no effect: the law is linear",
	                  given[] = "has no effect: yield_displacement_m is given";
	static const struct change changes[] = {
	    {EPS, "\"/law/hardening_ratio\", \"values\": [0, 0.1]", "", ""},
	    {EPS, "\"/oscillators/1/law/hardening_ratio\", \"values\": [0, 0.1]", "/sweep/0/path", linear},
	    {EPS, "\"/oscillators/1/law/corrections\", \"values\": [0, 1]", "/sweep/0/path", linear},
	    {EPS, "\"/oscillators/1/law/type\", \"values\": [\"elastoplastic\"]", "", ""},
	    // the type that stands in the scene is never taken
	    {EPS "}",
	     "\"/law/type\", \"values\": [\"linear\"]}, {\"path\": \"/law/hardening_ratio\", \"values\": [0]}",
	     "/sweep/1/path", linear},
	    {EPS "}",
	     "\"/oscillators/1/law/hardening_ratio\", \"values\": [0]}, "
	     "{\"path\": \"/oscillators/1/law/type\", \"values\": [\"linear\", \"elastoplastic\"]}",
	     "", ""},
	    {"\"law\": {\"type\": \"linear\", \"hardening_ratio\": 0.1, \"yield_displacement_m\": 0.25, "
	     "\"corrections\": 2}}],",
	     "\"law\": {\"type\": \"origin_oriented\", \"yield_displacement_m\": 0.25}}],", "", ""},
	    {EPS "}",
	     "\"/law/corrections\", \"values\": [0]}, {\"path\": \"/law/yield_displacement_m\", \"values\": [1]}",
	     "/sweep/0/path", given},
	    {FIRST "},\n  {\"path\": \"/oscillators/1/mass_kg\"",
	     "\"/law/target_demand\"" BETWEEN(1, 5) "},\n  {\"path\": \"/law/yield_displacement_m\"",
	     "/inputs/0/path", given},
	};
	try_all(changes, COUNT(changes));
	char *own = documents_with(documents_sensitivity, "{\"type\": \"linear\", \"hardening_ratio\": 0.1,",
	                           "{\"type\": \"origin_oriented\", \"hardening_ratio\": 0.1,");
	char *both = documents_with(own, EPS, "\"/oscillators/1/law/corrections\", \"values\": [0, 1]");
	documents_problem(both, "/sweep/0/path", given);
	free(both), free(own);
}

static void what_is_too_large_is_told_with_its_limit(void **state)
{
	(void)state;
	static const struct change changes[] = {
	    // 2 cells x 4 samples x 5 signals for each row
	    {"\"rows\": 10", "\"rows\": 250000", "", ""},
	    {"\"rows\": 10", "\"rows\": 250001", "/design/rows",
	     "asks for 10000040 pounding runs, a study may have at most 10000000"},
	    {"\"cycles\": 20", "\"cycles\": 20000, \"time_step_s\": 0.008", "/scene/excitation/time_step_s",
	     "duplicate member"},
	};
	try_all(changes, COUNT(changes));
	char *many = documents_with(documents_sensitivity, "\"rows\": 10", "\"rows\": 200000");
	char *document =
	    documents_with(many, "\"time_step_s\": 0.01", "\"time_step_s\": 3e-4"); // 133,334 samples
	documents_problem(document, "/design/rows",
	                  "asks for 1.07e+12 samples of ground motion in all runs, at most 1e+12");
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
	char *document =
	    documents_with(documents_sensitivity, EPS "}",
	                   "\"/contact/gap_m\", \"values\": [0, 1, 2]}, {\"path\": \"/law/type\", \"values\": "
	                   "[\"elastoplastic\", \"origin_oriented\"]}");
	struct pound_study *study = documents_study(document);
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
	char *document = documents_with(documents_response, "{\"frequency_hz\": 3.1}]}", swept);
	documents_problem(document, "/sweep",
	                  "asks for 1.00802805607006e+24 cells, a study may have at most 10000");
	free(document);
	free(swept);
}

static void no_fault_hides_another(void **state)
{
	(void)state;
	static const char document[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	    "3}]},"
	    " \"inputs\": ["
	    "{\"path\": \"/contact/restitution\", \"name\": \"a\", \"distribution\": {\"type\": \"discrete\","
	    " \"values\": [0.5, 0.2, \"x\", 2e100], \"weights\": [1, 0], \"min\": 1}},"
	    "{\"path\": \"/contact/restitution\", \"name\": \"a\", \"distribution\": {\"type\": \"beta\", "
	    "\"alpha\": 0,"
	    " \"beta\": 20000, \"min\": 1, \"max\": 0}},"
	    "{\"path\": \"/oscillators/0/frequency_hz\", \"name\": \"b\", \"distribution\": {\"type\":"
	    " \"truncated_normal\", \"standard_deviation\": -1, \"min\": 3, \"max\": 1}}],"
	    " \"ratios\": [{\"name\": \"b\", \"of\": [\"/contact/restitution\", \"/no\"]},"
	    " {\"name\": \"q\", \"of\": [\"/oscillators/0/frequency_hz\", \"/oscillators/0/frequency_hz\"]},"
	    " {\"name\": \"q\", \"of\": [3]}],"
	    " \"outputs\": [\"impulse\", \"floor_spectrum\"],"
	    " \"spectrum\": {\"frequencies_hz\": {\"min\": 5, \"max\": 1, \"count\": 1}}}";
	static const struct {
		const char *pointer, *detail;
	} told[] = {
	    {"/inputs/0/distribution/values/2", "must be a number, got \"x\""},
	    {"/inputs/0/distribution/values/3", "must be in [-1e+100, 1e+100], got 2e+100"},
	    {"/inputs/0/distribution/weights/1", "must be in (0, 1e+100], got 0"},
	    {"/inputs/0/distribution/min", "is not used by distribution \"discrete\""},
	    {"/inputs/0/distribution", "there must be as many weights as values, 4, not 2"},
	    {"/inputs/0/distribution", "every value must be greater than the one before"},
	    {"/inputs/1/path", "names the same field as /inputs/0"},
	    {"/inputs/1/name", "is the name of /inputs/0 too"},
	    {"/inputs/1/distribution", "alpha must be in (0, 10000]"},
	    {"/inputs/1/distribution", "beta must be in (0, 10000]"},
	    {"/inputs/1/distribution", "min must be less than max"},
	    {"/inputs/2/distribution/mean", "is required: a number"},
	    {"/inputs/2/distribution", "standard_deviation must be greater than 0"},
	    {"/inputs/2/distribution", "min must be less than max"},
	    {"/ratios/0/name", "is the name of /inputs/2 too"},
	    {"/ratios/0/of/1", "is the path of no input of this study"},
	    {"/ratios/1/of/1", "an input that is above in one ratio may be in no other place"},
	    {"/ratios/2/name", "is the name of /ratios/1 too"},
	    {"/ratios/2/of", "must be an array of 2 elements, got one of 1"},
	    {"/ratios/2/of/0", "must be a text of 1 to 200 characters, got 3"},
	    {"/spectrum/frequencies_hz/count", "must be in [2, 10000], got 1"},
	    {"/spectrum/frequencies_hz", "min must be less than max, got 5 and 1"},
	};
	struct problems problems;
	documents_refused(document, &problems);
	for (int k = 0; k < COUNT(told); k++) {
		int i = 0;
		while (i < problems.n && (strcmp(problems.list[i].pointer, told[k].pointer) != 0 ||
		                          strcmp(problems.list[i].detail, told[k].detail) != 0))
			i++;
		if (i == problems.n)
			fail_msg("not told: %s: %s", told[k].pointer, told[k].detail);
	}
	for (int i = COUNT(told); i < problems.n; i++)
		print_error("%s: %s\n", problems.list[i].pointer, problems.list[i].detail);
	assert_int_equal(problems.n, COUNT(told));
}

static void an_unknown_kind_hides_nothing_in_what_is_there(void **state)
{
	(void)state;
	struct problems problems;
	documents_refused("{\"kind\": \"sensitivty\", \"scene\": {\"oscillators\": [{}, {\"frequency_hz\": 2}]},"
	                  " \"inputs\": [{\"name\": 3}], \"design\": {\"until\": {}}}",
	                  &problems);
	static const char *const pointers[] = {"/kind",
	                                       "/scene/oscillators/0/frequency_hz",
	                                       "/inputs/0/name",
	                                       "/inputs/0/path",
	                                       "/inputs/0/distribution",
	                                       "/design/until/half_width"};
	assert_int_equal(problems.n, COUNT(pointers));
	for (int k = 0; k < COUNT(pointers); k++)
		assert_string_equal(problems.list[k].pointer, pointers[k]);
}

static void an_absent_name_may_not_be_that_of_another_input(void **state)
{
	(void)state;
	static const struct change changes[] = {{"\"name\": \"f_e\"", "\"name\": \"/oscillators/1/mass_kg\"",
	                                         "/inputs/1/name", "is the name of /inputs/0 too"}};
	try_all(changes, COUNT(changes));
}

static void every_fault_is_told_whatever_else_is_wrong(void **state)
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
	    {"\"restitution\": 0.6", "\"restitution\": 2", "/scene/contact/restitution", ""},
	    {"\"mass_kg\": 1,", "\"mass_kg\": \"heavy\",", "/scene/oscillators/0/mass_kg", ""},
	    {"\"rise\": 0.1", "\"rise\": 0.9", "/scene/excitation/fall", ""},
	    {"\"time_step_s\": 0.01", "\"time_step_s\": 1e-12", "/scene/excitation/time_step_s", ""},
	    {"[\"impulse\"]", "[\"demand_amplification\"]", "/outputs/0", ""},
	    {"\"rows\": 16", "\"rows\": 1000000", "/design/rows", ""},
	    {"\"seed\": 1", "\"seed\": -1", "/design/seed", ""},
	    {"\"name\": \"g\"", "\"name\": \"row\"", "/inputs/0/name", ""},
	    {"\"min\": 0,", "\"min\": -1,", "/inputs/0/distribution", ""},
	    {"\"max\": 6", "\"max\": 0", "/inputs/1/distribution", ""},
	    {"[0.05, 0.1]", "[0.05, 3]", "/sweep/0/values/1", ""},
	    {"\"event\"", "\"best\"", "/solver/method", ""},
	};
	study_free(documents_study(whole));
	for (int i = 0; i < COUNT(faults); i++)
		for (int j = 0; j < COUNT(faults); j++) {
			struct problems problems;
			char *one = documents_with(whole, faults[i].from, faults[i].to),
			     *both = j == i ? documents_with(one, "\"kind\"", "\"kind\"")
			                    : documents_with(one, faults[j].from, faults[j].to);
			documents_refused(both, &problems);
			// cells of a sweep that is not known are not looked at
			const bool swept = (i == 10 || j == 10) && (i == 4 || j == 4 || i == 5 || j == 5);
			if (!swept &&
			    (!problems_at(&problems, faults[i].pointer) || !problems_at(&problems, faults[j].pointer)))
				fail_msg("%s beside %s is not told", faults[i].pointer, faults[j].pointer);
			free(one), free(both);
		}
}

CHECK_MAIN(cmocka_unit_test(every_fault_is_told_whatever_else_is_wrong),
           cmocka_unit_test(an_unknown_kind_hides_nothing_in_what_is_there),
           cmocka_unit_test(no_fault_hides_another),
           cmocka_unit_test(an_absent_name_may_not_be_that_of_another_input),
           cmocka_unit_test(an_input_names_a_real_number_that_matters),
           cmocka_unit_test(a_sweep_takes_values_as_the_field_does),
           cmocka_unit_test(inputs_stay_in_the_range_of_their_fields),
           cmocka_unit_test(a_ground_motion_is_shaped_and_sampled_sensibly),
           cmocka_unit_test(an_output_applies_in_one_cell_at_least),
           cmocka_unit_test(without_a_contact_nothing_of_it_varies),
           cmocka_unit_test(the_law_of_nobody_and_the_fields_of_a_wall_do_not_vary),
           cmocka_unit_test(what_a_law_does_not_use_does_not_vary),
           cmocka_unit_test(what_is_too_large_is_told_with_its_limit),
           cmocka_unit_test(cells_are_the_product_of_the_sweeps_the_last_one_fastest),
           cmocka_unit_test(too_many_cells_are_refused_before_they_are_counted_out))
