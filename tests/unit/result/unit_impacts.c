/* unit_impacts.c - every contact of a response, against the totals of the response. */
#include <math.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

enum { CELLS = 40, CONTACTS = 200 };

/* Totals of the contacts of one signal. */
struct known {
	int n;
	double first, speed, impulse, time, end;
};

static struct known known[CELLS][CONTACTS];

static void impact_take(void *into, const struct pound_impact *impact)
{
	struct known *k = &known[impact->cell][impact->contact];
	assert_true(impact->cell < CELLS && impact->contact < CONTACTS);
	assert_true(impact->impulse > 0 && impact->speed >= 0 && impact->end >= impact->begin);
	// contacts of one pair of levels do not overlap in time
	assert_true(k->n == 0 || impact->begin >= k->end);
	if (k->n++ == 0) {
		k->first = impact->begin;
		k->speed = impact->speed;
	}
	k->impulse = fmax(k->impulse, impact->impulse);
	k->time += impact->end - impact->begin;
	k->end = impact->end;
	(*(int *)into)++;
}

/* Two oscillators are also simulated as a pair: their contacts equal those of the chain to rounding. */
static void check_pair(const struct known *k, const struct pound_response *r)
{
	assert_int_equal(k->n, (int)r->contact_count);
	check_near(k->impulse, r->impulse_max, 1e-9 * r->impulse_max);
	check_near(k->time, r->contact_time, 1e-9 * r->contact_time);
}

static void check_row(const struct known *k, const struct pound_contact_response *r)
{
	assert_int_equal(k->n, (int)r->contact_count);
	check_near(k->impulse, r->impulse_max, 0);
	if (k->n > 0) {
		check_near(k->first, r->first_time, 0);
		check_near(k->speed, r->first_speed, 0);
	}
	check_near(k->time, r->contact_time, 1e-12 * r->contact_time);
}

static void contacts_are_those_that_the_response_counts(void **state)
{
	(void)state;
	static const char *const names[] = {"response",     "response_sweep",  "contact_models",
	                                    "row_of_three", "unequal_heights", "rigid_wall_response"};
	for (size_t e = 0; e < sizeof names / sizeof names[0]; e++) {
		struct pound_study *study = study_documents_study(example_text(names[e]));
		struct pound_run *run = specimen_run(study);
		const struct pound_result *result = pound_run_result(run);
		int n = 0;
		assert_true(samples_exist(study));
		assert_true(result->n_cells <= CELLS);
		for (int signal = 0; signal < study->scene.excitation.signals; signal++) {
			memset(known, 0, sizeof known);
			assert_int_equal(pound_run_impacts(run, signal, impact_take, &n), POUND_OK);
			for (int c = 0; c < result->n_cells; c++) {
				const struct pound_cell *cell = &result->cells[c];
				for (int k = 0; cell->rows && k < pound_row_contacts(&study->scene); k++)
					check_row(&known[c][k], &cell->rows[signal].contacts[k]);
				if (!cell->rows)
					check_pair(&known[c][0], &cell->signals[signal]);
			}
		}
		check_report("%s: %d contacts", names[e], n);
		assert_true(n > 0);
		pound_run_free(run);
		study_free(study);
	}
}

static void a_line_of_csv_for_every_contact(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(example_text("row_of_three"));
	struct pound_run *run = specimen_run(study);
	size_t length;
	const char *reason;
	int n = 0, lines = 0;
	char *csv = histories_to_csv(study, run, 0, &length, &reason), *at = csv;
	static const char head[] = "signal,time_s,duration_s,cell,contact,left_building,left_level,right_level,"
	                           "approach_speed_m_s,impulse_n_s\r\n";
	assert_memory_equal(csv, head, sizeof head - 1);
	memset(known, 0, sizeof known);
	assert_int_equal(pound_run_impacts(run, 0, impact_take, &n), POUND_OK);
	for (at = strchr(at, '\n') + 1; *at; at = strchr(at, '\n') + 1) {
		assert_memory_equal(at, "0,", 2);
		lines++;
	}
	assert_int_equal(lines, n);
	free(csv);
	pound_run_stop(run);
	assert_null(histories_to_csv(study, run, 0, &length, &reason));
	pound_run_free(run);
	study_free(study);
}

static void what_has_no_contacts_to_list_has_no_samples(void **state)
{
	(void)state;
	static const char *const changes[][2] = {
	    {"\"contact\": {\"model\": \"kelvin_voigt\", \"stiffness_ratio\": 100, \"restitution\": 0.6, "
	     "\"gap_m\": 0, \"tension\": true}",
	     "\"contact\": null"},
	    {"\"signals\": 5", "\"signals\": 1000"},
	    {"\"seed\": 42}", "\"seed\": 42}, \"solver\": {\"method\": \"adaptive\"}"}};
	for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
		char *document = study_documents_with(example_text("response"), changes[k][0], changes[k][1]);
		struct pound_study *study = study_documents_study(document);
		assert_false(samples_exist(study));
		study_free(study);
		free(document);
	}
}

CHECK_MAIN(cmocka_unit_test(contacts_are_those_that_the_response_counts),
           cmocka_unit_test(a_line_of_csv_for_every_contact),
           cmocka_unit_test(what_has_no_contacts_to_list_has_no_samples))
