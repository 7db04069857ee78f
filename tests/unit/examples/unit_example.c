/* unit_example.c - the built-in study documents: complete, valid, and accepted by the engine. */
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/json/json_pointer.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

static void every_example_is_a_valid_study(void **state)
{
	(void)state;
	int n = 0;
	for (; example_name(n); n++) {
		const char *text = example_text(example_name(n));
		struct problems problems;
		struct pound_study *study = strstr(text, "\"scene\"")
		                                ? study_documents_study(text)
		                                : study_design_from_json(text, strlen(text), &problems);
		assert_non_null(study);
		assert_non_null(study->name);
		study_free(study);
	}
	assert_true(n >= 8);
	assert_null(example_text("no such example"));
}

static void the_title_of_an_example_is_its_name_in_the_document(void **state)
{
	(void)state;
	for (int i = 0; example_name(i); i++) {
		const char *document = example_text(example_name(i));
		struct reading *reading = reading_open(document, strlen(document));
		assert_string_equal(example_title(i), reading_text(reading, "/name"));
		assert_true(strlen(example_title(i)) <= 90);
		reading_close(reading);
	}
}

static void the_paper_s_study_asks_for_what_the_paper_ran(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(example_text("paper_linear"));
	assert_int_equal(study_runs(study), 30000);
	assert_int_equal(study->design.rows, 1000);
	assert_int_equal(study->scene.excitation.signals, 5);
	assert_false(study->design.common_signals);
	check_near(study->scene.oscillators[0].frequency_hz, 2, 0);
	study_free(study);
	study = study_documents_study(example_text("paper"));
	assert_int_equal(study_cells(study), 24);
	assert_int_equal(study_runs(study), 24 * 30000);
	study_free(study);
}

/* the lossless stiffest contact may instead end with the status of chatter: extremes.md */
static void every_extreme_of_the_example_has_a_result_that_balances(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(example_text("extremes"));
	struct pound_run *run = specimen_run(study);
	const struct pound_result *result = pound_run_result(run);
	int64_t chattered = 0;
	for (int c = 0; c < result->n_cells; c++) {
		const struct pound_cell *cell = &result->cells[c];
		struct pound_scene scene;
		study_cell(study, c, &scene);
		if (cell->runs_failed && scene.contact.restitution == 1 && scene.contact.stiffness_ratio == 1e8) {
			chattered += cell->runs_failed;
			continue;
		}
		assert_int_equal(cell->runs_failed, 0);
		check_near(cell->signals[0].energy_residual, 0, 1e-10);
		// a gap of 1 m is never closed
		const bool meet = scene.contact.gap < 1;
		assert_int_equal(cell->signals[0].contact_count > 0, meet);
		for (int o = 0; o < study->n_outputs; o++) {
			const bool impulse = !strcmp(pound_output_name(study->outputs[o]), "impulse");
			if (pound_output_applies(study->outputs[o], &scene))
				assert_int_equal(cell->outputs[o] > 0, meet || !impulse);
		}
	}
	assert_int_equal(result->work.failed[POUND_CHATTER_RUNS], chattered);
	pound_run_free(run);
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(every_example_is_a_valid_study),
           cmocka_unit_test(the_title_of_an_example_is_its_name_in_the_document),
           cmocka_unit_test(every_extreme_of_the_example_has_a_result_that_balances),
           cmocka_unit_test(the_paper_s_study_asks_for_what_the_paper_ran))
