/* unit_pilot.c - studies with signals "auto": the split found by a pilot is used by the study, does not depend on the
 * number of workers, and is the best of the predicted ones. */
#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* The paper's study with few runs, at a frequency where its noise is large. */
static struct pound_study *auto_study(const char *design)
{
	char *all = study_documents_with(example_text("paper_linear"), "\"signals\": 5", "\"signals\": \"auto\"");
	char *slow = study_documents_with(all, "\"frequency_hz\": 2, \"damping_ratio\": 0.05}",
	                                  "\"frequency_hz\": 0.5, \"damping_ratio\": 0.05}");
	char *document = study_documents_with(slow, "\"rows\": 1000,", design);
	struct pound_study *study = study_documents_study(document);
	free(all);
	free(slow);
	free(document);
	return study;
}

static struct pound_run *run_of(const struct pound_study *study, int n_workers)
{
	struct pound_run *run = pound_run_create(study, n_workers);
	assert_non_null(run);
	int block = 0;
	do {
		for (; block < pound_run_blocks(run); block++)
			assert_int_equal(pound_run_block(run, block, block % n_workers), POUND_OK);
		for (int k = 0; k < pound_run_reductions(run); k++)
			assert_int_equal(pound_run_reduce(run, k, k % n_workers), POUND_OK);
	} while (pound_run_grow(run));
	return run;
}

static void check_same(const struct pound_result *got, const struct pound_result *want, int n_outputs)
{
	assert_int_equal(got->rows, want->rows);
	for (int o = 0; o < n_outputs; o++)
		for (int k = 0; k < POUND_N_INDICES; k++)
			assert_memory_equal(got->cells[0].indices[o].index[k], want->cells[0].indices[o].index[k],
			                    sizeof(struct pound_estimate) * 4);
}

static void a_split_study_is_the_study_with_that_split(void **state)
{
	(void)state;
	static const char *const designs[] = {"\"runs\": 9000,",
	                                      "\"until\": {\"half_width\": 0.4, \"max_runs\": 12000},",
	                                      "\"runs\": 9000, \"method\": \"sobol\","};
	for (size_t k = 0; k < sizeof designs / sizeof designs[0]; k++) {
		struct pound_study *study, plain;
		if (k < 2)
			study = auto_study(designs[k]);
		else {
			study = auto_study(designs[0]);
			while (strcmp(pound_design_name(study->design.method), "sobol"))
				study->design.method++;
			study->design.randomisations = 8;
		}
		struct pound_run *one = run_of(study, 1), *three = run_of(study, 3);
		const struct pound_split *split = &pound_run_result(one)->split;
		assert_memory_equal(split, &pound_run_result(three)->split, sizeof *split);
		check_same(pound_run_result(three), pound_run_result(one), study->n_outputs);
		pound_study_split(study, split->signals, &plain);
		plain.design.rows = split->rows;
		struct pound_run *written = run_of(&plain, 1);
		check_same(pound_run_result(written), pound_run_result(one), study->n_outputs);
		assert_int_equal(pound_run_result(written)->split.signals, 0);
		// no more runs than allowed
		const int64_t allowed = k == 1 ? 12000 : 9000;
		assert_true(pound_run_result(one)->cells[0].runs + split->pilot_runs <= allowed);
		check_report("%s %d signals, %d rows", designs[k], split->signals, pound_run_result(one)->rows);
		pound_run_free(one);
		pound_run_free(three);
		pound_run_free(written);
		study_free(study);
	}
}

static void the_split_is_the_best_of_those_foreseen(void **state)
{
	(void)state;
	struct pound_study *study = auto_study("\"runs\": 9000,");
	struct pound_run *run = pound_run_create(study, 1);
	const struct pound_split *split = &pound_run_result(run)->split;
	double least = INFINITY;
	assert_true(split->n_choices > 3);
	for (int k = 0; k < split->n_choices; k++)
		least = fmin(least, split->choices[k].half_width);
	for (int k = 0; k < split->n_choices; k++)
		if (split->choices[k].signals == split->signals)
			check_near(split->choices[k].half_width, least, 0.0);
	check_near(split->decided_by.half_width, least, 0.0);
	// at 0.5 Hz most of the variance is noise: two signals are not enough
	assert_true(split->signals > 2);
	assert_int_equal(split->pilot_rows, 32);
	assert_int_equal(split->pilot_runs, 32 * 6 * 6);
	pound_run_free(run);
	study_free(study);
}

static void a_pilot_ends_when_it_is_stopped(void **state)
{
	(void)state;
	struct pound_study *study = auto_study("\"runs\": 9000,");
	const atomic_bool stop = true;
	assert_null(pound_run_create_by(study, 1, &stop));
	study_free(study);
}

static void a_result_says_why_its_rows_have_so_many_signals(void **state)
{
	(void)state;
	struct pound_study *study = auto_study("\"runs\": 3000,");
	struct pound_run *run = run_of(study, 1);
	size_t length;
	char *json = result_to_json(study, pound_run_result(run), NULL, &length);
	assert_non_null(json);
	static const char *const said[] = {"\"stopping\": {", "\"pilot\": {",
	                                   "\"between_rows\":", "\"choices\": [",
	                                   "the widest interval is predicted to be the narrowest for these runs"};
	for (size_t k = 0; k < sizeof said / sizeof said[0]; k++)
		assert_non_null(strstr(json, said[k]));
	free(json);
	pound_run_free(run);
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(a_split_study_is_the_study_with_that_split),
           cmocka_unit_test(the_split_is_the_best_of_those_foreseen),
           cmocka_unit_test(a_pilot_ends_when_it_is_stopped),
           cmocka_unit_test(a_result_says_why_its_rows_have_so_many_signals))
