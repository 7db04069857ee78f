/* unit_study_json.c - members of a study document are read into the study; errors are tested by unit_study_cases.c. */
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

static void absent_settings_are_some_and_empty_ones_none(void **state)
{
	(void)state;
	struct pound_study *s = study_documents_study(study_documents_convergence);
	assert_int_equal(pound_convergence_trials(s), 2 + 2 + 1 + 1);
	assert_int_equal(s->convergence.settings[1].n, 2);
	check_near(s->convergence.settings[1].values[1], 0.001, 0);
	assert_int_equal(study_runs(s), 12);
	study_free(s);
	char *document = study_documents_with(study_documents_response, "response", "convergence");
	s = study_documents_study(document);
	free(document);
	for (int row = 0; row < POUND_SOLVERS; row++)
		assert_true(row ? s->convergence.settings[row].n >= 4 : s->convergence.settings[row].n == 0);
	check_near(s->convergence.history, 2, 0);
	study_free(s);
	document = study_documents_with(study_documents_convergence, "[0.01, 0.001]", "[]");
	s = study_documents_study(document);
	assert_int_equal(s->convergence.settings[1].n, 0);
	study_free(s);
	free(document);
}

static void what_a_document_says_is_in_the_study(void **state)
{
	(void)state;
	struct pound_study *s = study_documents_study(study_documents_sensitivity);
	const struct pound_scene *scene = &s->scene;
	assert_int_equal(s->kind, POUND_KIND_SENSITIVITY);
	assert_string_equal(s->name, "a study");
	assert_string_equal(pound_law_name(scene->law.type), "elastoplastic");
	check_near(scene->law.hardening_ratio, 0.05, 0);
	check_near(scene->law.target_demand, 2, 0);
	check_near(scene->law.yield_displacement, 0, 0);
	assert_int_equal(scene->law.corrections, 1);
	assert_false(scene->oscillators[0].has_law);
	assert_true(scene->oscillators[1].has_law);
	check_near(scene->oscillators[0].frequency_hz, 2, 0);
	check_near(scene->oscillators[1].mass, 3, 0);
	check_near(scene->oscillators[1].damping_ratio, 0.02, 0);
	check_near(scene->oscillators[1].law.hardening_ratio, 0.1, 0);
	check_near(scene->oscillators[1].law.yield_displacement, 0.25, 0);
	assert_int_equal(scene->oscillators[1].law.corrections, 2);
	assert_true(scene->contact.present && scene->contact.tension);
	check_near(scene->contact.gap, 0.01, 0);
	check_near(scene->excitation.cycles, 20, 0);
	check_near(scene->excitation.duration, 0, 0);
	assert_int_equal(scene->excitation.signals, 5);
	assert_int_equal(s->n_inputs, 2);
	assert_string_equal(s->inputs[0].name, "f_e");
	assert_string_equal(s->inputs[1].name, "/oscillators/1/mass_kg");
	assert_int_equal(s->inputs[1].field.offset, offsetof(struct pound_scene, oscillators[1].mass));
	check_near(s->inputs[0].distribution.p[1], 5, 0);
	assert_int_equal(s->n_sweeps, 1);
	assert_int_equal(s->sweeps[0].field.offset, offsetof(struct pound_scene, contact.restitution));
	assert_int_equal(s->sweeps[0].n_values, 2);
	check_near(s->sweeps[0].values[1], 0.9, 0);
	assert_int_equal(s->design.rows, 10);
	assert_int_equal(s->design.seed, 42);
	assert_true(s->design.common_signals);
	assert_int_equal(s->n_outputs, 2);
	assert_string_equal(pound_output_name(s->outputs[1]), "impulse");
	check_near(s->solver.tolerance, 1e-9, 0);
	study_free(s);
}

static void absent_members_have_the_defaults_of_the_contract(void **state)
{
	(void)state;
	struct pound_study *s = study_documents_study(study_documents_response);
	const struct pound_excitation *e = &s->scene.excitation;
	assert_null(s->name);
	assert_string_equal(pound_law_name(s->scene.law.type), "linear");
	check_near(s->scene.law.hardening_ratio, 0.05, 0);
	check_near(s->scene.law.target_demand, 2, 0);
	assert_int_equal(s->scene.law.corrections, 1);
	for (int i = 0; i < 2; i++) {
		check_near(s->scene.oscillators[i].mass, 1, 0);
		check_near(s->scene.oscillators[i].damping_ratio, 0.05, 0);
		assert_false(s->scene.oscillators[i].rigid_wall || s->scene.oscillators[i].has_law);
	}
	assert_true(s->scene.contact.present && s->scene.contact.tension);
	check_near(s->scene.contact.stiffness_ratio, 100, 0);
	check_near(s->scene.contact.restitution, 0.6, 0);
	check_near(s->scene.contact.gap, 0, 0);
	assert_string_equal(pound_excitation_name(e->type), "kanai_tajimi");
	check_near(e->frequency_hz, 2.5, 0);
	check_near(e->damping_ratio, 0.6, 0);
	check_near(e->high_pass_ratio, 0.1, 0);
	check_near(e->cycles, 20, 0);
	check_near(e->rise, 0.15, 0);
	check_near(e->fall, 0.25, 0);
	check_near(e->time_step, 0.01, 0);
	check_near(e->peak, 1, 0);
	assert_int_equal(e->signals, 5);
	assert_int_equal(s->design.rows, 1000);
	assert_int_equal(s->design.seed, 42);
	assert_true(s->design.common_signals);
	assert_int_equal(s->n_outputs, 2);
	assert_string_equal(pound_output_name(s->outputs[0]), "force_amplification");
	assert_string_equal(pound_output_name(s->outputs[1]), "impulse");
	study_free(s);
}

#define SCENE(excitation) \
	"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], \
\"excitation\": " excitation "}}"

static void what_an_excitation_does_not_use_is_zero(void **state)
{
	(void)state;
	struct pound_study *s =
	    study_documents_study(SCENE("{\"type\": \"record\", \"acceleration_m_s2\": [0, 1e0, -0.5]}"));
	assert_int_equal(s->scene.excitation.n_record, 3);
	assert_int_equal(s->scene.excitation.signals, 1);
	check_near(s->scene.excitation.record[2], -0.5, 0);
	study_free(s);
	s = study_documents_study(SCENE("{\"type\": \"harmonic\", \"duration_s\": 3}"));
	assert_int_equal(s->scene.excitation.signals, 1);
	check_near(s->scene.excitation.duration, 3, 0);
	check_near(s->scene.excitation.rise, 0, 0);
	study_free(s);
}

static void a_rigid_wall_has_no_frequency(void **state)
{
	(void)state;
	char *wall =
	    study_documents_with(study_documents_response, "{\"frequency_hz\": 3.1}", "{\"rigid_wall\": true}");
	struct pound_study *study = study_documents_study(wall);
	assert_true(study->scene.oscillators[1].rigid_wall);
	check_near(study->scene.oscillators[1].frequency_hz, 0, 0);
	study_free(study);
	free(wall);
}

static void no_contact_is_null(void **state)
{
	(void)state;
	char *document = study_documents_with(study_documents_response, "\"oscillators\"",
	                                      "\"contact\": null, \"oscillators\"");
	struct pound_study *study = study_documents_study(document);
	assert_false(study->scene.contact.present);
	assert_int_equal(study->n_outputs, 1);
	assert_string_equal(pound_output_name(study->outputs[0]), "force_amplification");
	study_free(study);
	free(document);
}

static void broken_json_is_reported_by_line_and_column(void **state)
{
	(void)state;
	struct problems problems;
	study_documents_refused("{\"kind\": \"response\",\n \"scene\": {\"law\": {\"hardening_ratio\": 01}}}",
	                        &problems);
	assert_int_equal(problems.status, PROBLEMS_MALFORMED);
	assert_int_equal(problems.line, 2);
	assert_int_equal(problems.column, 39);
	assert_string_equal(problems.list[0].detail, "a number must not have leading zeros");
}

static void the_text_need_not_end_with_a_zero(void **state)
{
	(void)state;
	struct problems problems;
	size_t length = strlen(study_documents_response);
	char *exact = malloc(length);
	assert_non_null(exact);
	memcpy(exact, study_documents_response, length);
	struct pound_study *study = study_from_json(exact, length, &problems);
	free(exact);
	assert_non_null(study);
	study_free(study);
}

/* The end of the JSON value that begins at `text`, which is valid. */
static const char *value_end(const char *text)
{
	int depth = 0;
	bool quoted = false;
	for (;; text++) {
		if (quoted) {
			text += *text == '\\';
			quoted = *text != '"';
		} else if (depth == 0 && strchr(",]} \n", *text)) {
			return text;
		} else {
			quoted = *text == '"';
			depth += (*text == '{' || *text == '[') - (*text == '}' || *text == ']');
		}
		if (depth == 0 && !quoted && strchr("]}\"", *text))
			return text + 1;
	}
}

/* Reads a document with part of its text replaced: a study or problems, never both. */
static void replaced_read(const char *document, const char *from, const char *to, const char *value)
{
	char *text = malloc(strlen(document) + 32);
	const int n = sprintf(text, "%.*s%s%s", (int)(from - document), document, value, to);
	struct problems problems;
	struct pound_study *study = study_from_json(text, (size_t)n, &problems);
	assert_true(!study == (problems.n > 0));
	if (study)
		study_free(study);
	free(text);
}

/* Every value of every example, replaced by a value of each type. */
static void a_value_of_any_type_in_any_place_is_read_or_refused(void **state)
{
	static const char *const values[] = {"[1]",    "[]",    "{}",   "{\"a\": 1}", "1",
	                                     "-1e300", "\"x\"", "true", "null"};
	glob_t examples;
	int n = 0;
	(void)state;
	assert_int_equal(glob("schema/examples/*.json", 0, NULL, &examples), 0);
	for (size_t e = 0; e < examples.gl_pathc; e++) {
		static char document[1 << 16];
		FILE *file = fopen(examples.gl_pathv[e], "r");
		assert_non_null(file);
		document[fread(document, 1, sizeof document - 1, file)] = '\0';
		fclose(file);
		for (const char *c = document; *c; c++) {
			if (*c == '"') { // a name, or a string in a list: neither begins a value below
				c = value_end(c);
				c += strspn(c, " \n");
			}
			if (*c != ':' && *c != '[')
				continue;
			const char *from = c + 1 + strspn(c + 1, " \n");
			for (size_t k = 0; k < COUNT(values) && *from != ']'; k++, n++)
				replaced_read(document, from, value_end(from), values[k]);
		}
	}
	check_report("%d documents", n);
	assert_true(n > 10000);
	globfree(&examples);
}

CHECK_MAIN(cmocka_unit_test(absent_settings_are_some_and_empty_ones_none),
           cmocka_unit_test(what_a_document_says_is_in_the_study),
           cmocka_unit_test(absent_members_have_the_defaults_of_the_contract),
           cmocka_unit_test(what_an_excitation_does_not_use_is_zero),
           cmocka_unit_test(a_rigid_wall_has_no_frequency), cmocka_unit_test(no_contact_is_null),
           cmocka_unit_test(broken_json_is_reported_by_line_and_column),
           cmocka_unit_test(the_text_need_not_end_with_a_zero),
           cmocka_unit_test(a_value_of_any_type_in_any_place_is_read_or_refused))
