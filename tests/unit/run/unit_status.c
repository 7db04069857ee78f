/* unit_status.c - failed runs: what is left out, what is reported, and when a whole study fails.
 *
 * The linker replaces GSL's function by __wrap_gsl_odeiv2_driver_alloc_scaled_new. */
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

/* Steps of 0.01 s are too long for frequencies above 1 / (pi 0.01) = 31.8 Hz. */
#define STEPS_TOO_LONG "\"solver\": {\"method\": \"central_difference\", \"step_s\": 0.01}"
static const char too_long[] = "the steps of the solver are too long for this scene";

// in stiff contact the bodies move out of all bounds; 2 of the 5 motions do not lead to contact
static const char some_signals[] =
    "{\"kind\": \"response\", " STEPS_TOO_LONG ", \"scene\": {"
    "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}],"
    "\"contact\": {\"stiffness_ratio\": 1e4, \"gap_m\": 0.0115}, \"excitation\": {\"signals\": 5}}}";

// in the first cell some samples are above the limit, in the second all
static const char some_rows[] = "{\"kind\": \"sensitivity\", " STEPS_TOO_LONG ", \"scene\": {"
                                "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}],"
                                "\"contact\": {\"stiffness_ratio\": 0.01}, \"excitation\": {\"signals\": 2}},"
                                "\"inputs\": [{\"path\": \"/oscillators/0/frequency_hz\", \"name\": \"f_1\","
                                "\"distribution\": {\"type\": \"uniform\", \"min\": 20, \"max\": 33}},"
                                "{\"path\": \"/contact/restitution\", \"name\": \"eps\","
                                "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}],"
                                "\"sweep\": [{\"path\": \"/oscillators/1/frequency_hz\", \"values\": [3, "
                                "100]}], \"design\": {\"rows\": 40}}";

// a body bounces on a wall without energy loss: 20 contacts per second for 1e5 s, between two samples
static const char chatters[] =
    "{\"kind\": \"response\", \"solver\": {\"method\": \"adaptive\", \"tolerance\": 1e-4}, \"scene\": {"
    "\"oscillators\": [{\"frequency_hz\": 2, \"damping_ratio\": 0}, {\"rigid_wall\": true}],"
    "\"contact\": {\"restitution\": 1, \"gap_m\": 1e-4}, \"excitation\": {\"type\": \"record\","
    "\"time_step_s\": 1e3, \"acceleration_m_s2\": [-1, -1]}}}";

/* Computes a study in one thread.
 *
 * Returns  value   the parsed result, and its bytes in json; NULL: the study failed for the reason in status
 */
static struct reading *computed(const char *document, char **json, enum pound_status *status)
{
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = pound_run_create(study, 1);
	assert_non_null(run);
	*status = specimen_compute(run);
	struct reading *result = NULL;
	if (!*status) {
		static const struct timing timing = {1, 1, 1};
		size_t length;
		*json = result_to_json(study, pound_run_result(run), &timing, &length);
		result = reading_open(*json, length);
		assert_non_null(result);
	}
	pound_run_free(run);
	study_free(study);
	return result;
}

static struct reading *succeeded(const char *document)
{
	char *json;
	enum pound_status status;
	struct reading *result = computed(document, &json, &status);
	assert_int_equal(status, POUND_OK);
	assert_null(strstr(json, ": nan"));
	assert_null(strstr(json, ": -nan"));
	assert_null(strstr(json, ": inf"));
	free(json);
	return result;
}

static enum pound_status failed(const char *document)
{
	char *json;
	enum pound_status status;
	assert_null(computed(document, &json, &status));
	return status;
}

static void outputs_of_a_response_are_of_the_signals_that_have_a_result(void **state)
{
	(void)state;
	struct reading *r = succeeded(some_signals);
	check_near(reading_number(r, "/runs_failed"), 3, 0);
	assert_int_equal(reading_count(r, "/work/failures"), 1);
	check_near(reading_number(r, "/work/failures/0/runs"), 3, 0);
	assert_string_equal(reading_text(r, "/work/failures/0/reason"), too_long);
	int n = 0;
	for (int i = 0; i < 5; i++)
		n += isnan(reading_number(r, "/signals/%d/contact_count", i));
	assert_int_equal(n, 3);
	// the other runs have no contact
	check_near(reading_number(r, "/outputs/force_amplification"), 1, 0);
	check_near(reading_number(r, "/outputs/impulse"), 0, 0);
	assert_string_equal(reading_text(r, "/note"),
	                    "failed runs are left out of the outputs; work.failures has the reasons");
	reading_close(r);
}

static void rows_with_a_failed_run_are_dropped_whole_and_a_cell_without_one_says_so(void **state)
{
	(void)state;
	struct reading *r = succeeded(some_rows);
	double runs = reading_number(r, "/cells/0/runs"), first = reading_number(r, "/cells/0/runs_failed");
	// f_1 is above the limit in one of ten samples of A and of B
	check_near(runs, 40 * 4 * 2, 0);
	assert_true(first > 0 && first < runs / 4);
	double dropped = reading_number(r, "/cells/0/rows_dropped");
	// a value of A is in sample A and in A with the other column from B, and likewise for B: two samples, two signals
	assert_true(dropped >= first / 8 && dropped <= first / 4);
	assert_true(isfinite(reading_number(r, "/cells/0/outputs/0/mean")));
	assert_true(isfinite(reading_number(r, "/cells/0/outputs/0/inputs/1/ST")));
	// the largest effect that seven of forty rows can have
	double bound = reading_number(r, "/cells/0/outputs/0/accuracy/errors/failed_rows");
	assert_true(bound > 0 && bound <= 1);
	check_near(fmax(reading_number(r, "/cells/0/outputs/0/accuracy/inputs/0/S1_failed_rows"), bound), bound,
	           0);
	check_near(reading_number(r, "/cells/1/runs_failed"), runs, 0);
	check_near(reading_number(r, "/cells/1/rows_dropped"), 40, 0);
	assert_true(isnan(reading_number(r, "/cells/1/outputs/0/mean")));
	assert_true(isnan(reading_number(r, "/cells/1/outputs/0/inputs/1/ST")));
	assert_string_equal(reading_text(r, "/cells/1/outputs/0/note"),
	                    "all rows of the design failed, so there are no indices");
	check_near(reading_number(r, "/work/failures/0/runs"), first + runs, 0);
	assert_string_equal(reading_text(r, "/work/failures/0/reason"), too_long);
	reading_close(r);
}

static void a_cell_without_a_run_has_no_outputs_and_the_others_have(void **state)
{
	(void)state;
	char *document = study_documents_with(
	    some_signals, "\"scene\"",
	    "\"sweep\": [{\"path\": \"/oscillators/0/frequency_hz\", \"values\": [2, 50]}], \"scene\"");
	struct reading *r = succeeded(document);
	check_near(reading_number(r, "/cells/0/outputs/force_amplification"), 1, 0);
	assert_true(reading_has(r, "/cells/1/outputs/force_amplification"));
	assert_true(isnan(reading_number(r, "/cells/1/outputs/force_amplification")));
	assert_string_equal(reading_text(r, "/cells/1/note"),
	                    "no run has a result, so there are no outputs; work.failures has the reasons");
	check_near(reading_number(r, "/work/failures/0/runs"), 3 + 5, 0);
	assert_true(reading_has(r, "/accuracy/energy_residual"));
	reading_close(r);
	free(document);
}

static void outputs_in_terms_of_no_motion_have_no_value_and_a_note(void **state)
{
	(void)state;
	static const char still[] = "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": "
	                            "2}, {\"frequency_hz\": 3}], "
	                            "\"excitation\": {\"type\": \"record\", \"acceleration_m_s2\": [0, %s, 0]}}}";
	for (int moves = 0; moves < 2; moves++) {
		char document[300];
		snprintf(document, sizeof document, still, moves ? "1" : "0");
		struct reading *r = succeeded(document);
		assert_int_equal(isnan(reading_number(r, "/outputs/impulse")) != 0, !moves);
		assert_int_equal(reading_has(r, "/note"), !moves);
		reading_close(r);
	}
}

static void a_study_without_a_result_ends_with_the_reason_of_its_runs(void **state)
{
	(void)state;
	char *all_rows = study_documents_with(some_rows, "[3, 100]", "[99, 100]");
	char *all_signals = study_documents_with(some_signals, "0.0115", "0.001");
	char *tolerance = study_documents_with(chatters, "1e-4}", "1e-300}");
	assert_int_equal(failed(all_rows), POUND_UNSTABLE);
	assert_int_equal(failed(all_signals), POUND_UNSTABLE);
	assert_int_equal(failed(tolerance), POUND_TOLERANCE);
	assert_int_equal(failed(chatters), POUND_CHATTER);
	free(all_rows), free(all_signals), free(tolerance);
	assert_string_equal(pound_status_error(POUND_UNSTABLE),
	                    "all runs failed: the steps of the solver are too long for this scene");
	assert_string_equal(pound_status_error(POUND_CHATTER),
	                    "all runs failed: more events in one sample interval than allowed");
	assert_string_equal(pound_status_error(POUND_NOMEM), "out of memory");
}

/* The ground presses a body on a wall, in a contact without energy loss: its oscillation never ends, and the stiffer
 * the contact, the more steps it needs. */
static const char swings[] =
    "{\"kind\": \"%s\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"rigid_wall\": true}], "
    "\"contact\": {\"stiffness_ratio\": %s, \"restitution\": 1}, \"excitation\": {\"type\": \"record\", "
    "\"acceleration_m_s2\": [0, -0.05, -0.1, -0.15, -0.2, -0.25]}}%s}";

static const char swings_varied[] =
    ", \"inputs\": [{\"path\": \"/oscillators/0/mass_kg\", \"name\": \"m\", \"distribution\": {\"type\": "
    "\"uniform\", \"min\": 1, \"max\": 2}}, {\"path\": \"/oscillators/0/frequency_hz\", \"name\": \"f\", "
    "\"distribution\": {\"type\": \"uniform\", \"min\": 1, \"max\": 2}}], \"design\": {\"rows\": 2}, "
    "\"sweep\": [{\"path\": \"/contact/stiffness_ratio\", \"values\": [%s]}], "
    "\"outputs\": [\"impulse\", \"floor_spectrum\"]";

static const char swings_spectrum[] = ", \"spectrum\": {\"frequencies_hz\": [1, 5]}";

static void a_run_whose_floor_cannot_be_followed_has_failed_for_a_named_reason(void **state)
{
	(void)state;
	char document[1600], more[900];
	snprintf(document, sizeof document, swings, "response", "1e20", "");
	struct reading *r = succeeded(document); // the exact solver can follow it
	check_near(reading_number(r, "/runs_failed"), 0, 0);
	reading_close(r);
	snprintf(document, sizeof document, swings, "floor_spectrum", "1e20", swings_spectrum);
	assert_int_equal(failed(document), POUND_CHATTER);
	for (int some = 0; some < 2; some++) {
		int n = snprintf(more, sizeof more, swings_varied, some ? "100, 1e20" : "1e20");
		snprintf(more + n, sizeof more - (size_t)n, "%s", swings_spectrum);
		snprintf(document, sizeof document, swings, "sensitivity", "100", more);
		if (!some) {
			assert_int_equal(failed(document), POUND_CHATTER);
			continue;
		}
		r = succeeded(document);
		check_near(reading_number(r, "/cells/0/runs_failed"), 0, 0);
		check_near(reading_number(r, "/cells/1/runs_failed"), 2 * 4, 0);
		assert_int_equal(reading_count(r, "/work/failures"), 1);
		check_near(reading_number(r, "/work/failures/0/runs"), 2 * 4, 0);
		assert_string_equal(reading_text(r, "/work/failures/0/reason"),
		                    "more events in one sample interval than allowed");
		reading_close(r);
	}
}

static void contact_of_more_cells_than_a_double_counts_ends_by_its_name(void **state)
{
	(void)state;
	static const char *const stiffnesses[] = {"1e33", "1e36", "1e60", "1e300"};
	for (int i = 0; i < 4; i++) {
		char document[400];
		snprintf(document, sizeof document,
		         "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
		         "{\"frequency_hz\": "
		         "3.1}], \"contact\": {\"stiffness_ratio\": %s}, \"excitation\": {\"signals\": 1}}}",
		         stiffnesses[i]);
		assert_int_equal(failed(document), POUND_CHATTER);
	}
}

static void a_body_that_never_moves_has_no_demand_but_has_not_failed(void **state)
{
	(void)state;
	struct reading *r = succeeded(
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"elastoplastic\"}, \"oscillators\": "
	    "[{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], \"excitation\": {\"type\": \"record\", "
	    "\"acceleration_m_s2\": [0, 0]}}}");
	check_near(reading_number(r, "/runs_failed"), 0, 0);
	assert_int_equal(reading_count(r, "/work/failures"), 0);
	assert_true(isnan(reading_number(r, "/outputs/demand_amplification")));
	reading_close(r);
}

static void run_stop(void *run)
{
	pound_run_stop(run);
}

static void a_run_that_takes_hours_is_stopped(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_bouncing(&specimen);
	for (int method = 0; pound_solver_name(method); method++) {
		specimen.study.solver = (struct pound_solver){.method = method, .step = 1e-7, .tolerance = 1e-12};
		struct pound_run *run = pound_run_create(&specimen.study, 1);
		assert_non_null(run);
		pthread_t thread = specimen_later(run_stop, run);
		assert_int_equal(specimen_compute(run), POUND_STOPPED);
		pthread_join(thread, NULL);
		pound_run_free(run);
	}
	specimen_free(&specimen);
}

gsl_odeiv2_driver *__real_gsl_odeiv2_driver_alloc_scaled_new(const gsl_odeiv2_system *,
                                                             const gsl_odeiv2_step_type *, double, double,
                                                             double, double, double, const double[]);
gsl_odeiv2_driver *__wrap_gsl_odeiv2_driver_alloc_scaled_new(const gsl_odeiv2_system *,
                                                             const gsl_odeiv2_step_type *, double, double,
                                                             double, double, double, const double[]);

static int until_starved = -1; /* allocations by GSL until one fails */

gsl_odeiv2_driver *__wrap_gsl_odeiv2_driver_alloc_scaled_new(const gsl_odeiv2_system *system,
                                                             const gsl_odeiv2_step_type *type, double start,
                                                             double absolute, double relative, double y,
                                                             double rate, const double scale[])
{
	if (until_starved-- == 0)
		return NULL;
	return __real_gsl_odeiv2_driver_alloc_scaled_new(system, type, start, absolute, relative, y, rate, scale);
}

static void want_of_memory_is_no_failed_run_and_the_block_may_be_tried_again(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(
	    "{\"kind\": \"convergence\", \"convergence\": {\"adaptive\": {\"tolerances\": [1e-4]}}, \"scene\": {"
	    "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}], \"excitation\": {"
	    "\"type\": \"record\", \"time_step_s\": 0.01, \"acceleration_m_s2\": [1, -1, 2, -2, 1, 0, 0, 0]}}}");
	struct pound_run *once = specimen_run(study), *again = pound_run_create(study, 1);
	assert_non_null(again);
	int starved = 0;
	for (int block = 0; block < pound_run_blocks(again); block++)
		for (int before = 0;; before++, starved++) {
			until_starved = before;
			enum pound_status status = pound_run_block(again, block, 0);
			if (status == POUND_OK)
				break;
			assert_int_equal(status, POUND_NOMEM);
		}
	until_starved = -1;
	// the second opinion and the adaptive solver, whose motions and histories need two each
	assert_true(starved > 2 * 2 * 2);
	for (int block = 0; block < pound_run_blocks(again); block++) {
		// run times are not compared: the test has no clock
		size_t size = sizeof(double) * pound_run_block_size(again, block);
		assert_memory_equal(pound_run_block_values(again, block), pound_run_block_values(once, block), size);
	}
	pound_run_free(once);
	pound_run_free(again);
	study_free(study);
}

/* In each cell only the first signals have an energy balance; the responses to the others show that they have none. */
static void the_first_signals_of_each_cell_have_energy_balances(void **state)
{
	(void)state;
	static const char pair[] =
	    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	    "{\"frequency_hz\": 3.1}], \"excitation\": {\"cycles\": 4, \"signals\": 40}}, \"sweep\": "
	    "[{\"path\": \"/contact/restitution\", \"values\": [0.5, 0.6]}]}";
	static const char row[] =
	    "{\"kind\": \"response\", \"scene\": {\"buildings\": [{\"storeys\": 2, \"frequency_hz\": 2}, "
	    "{\"frequency_hz\": 3.1}], \"excitation\": {\"cycles\": 4, \"signals\": 33}}}";
	struct reading *r = succeeded(pair);
	check_near(reading_number(r, "/accuracy/energy_responses"), 2 * POUND_BALANCED_SIGNALS, 0);
	assert_true(reading_number(r, "/accuracy/energy_residual") < 1e-12);
	assert_true(reading_number(r, "/cells/1/signals/39/contact_count") > 0);
	reading_close(r);
	r = succeeded(row);
	check_near(reading_number(r, "/accuracy/energy_responses"), POUND_BALANCED_SIGNALS, 0);
	assert_true(reading_number(r, "/accuracy/energy_residual") < 1e-12);
	assert_true(reading_number(r, "/signals/32/contacts/0/contact_count") > 0);
	reading_close(r);
}

CHECK_MAIN(cmocka_unit_test(the_first_signals_of_each_cell_have_energy_balances),
           cmocka_unit_test(outputs_of_a_response_are_of_the_signals_that_have_a_result),
           cmocka_unit_test(rows_with_a_failed_run_are_dropped_whole_and_a_cell_without_one_says_so),
           cmocka_unit_test(a_cell_without_a_run_has_no_outputs_and_the_others_have),
           cmocka_unit_test(outputs_in_terms_of_no_motion_have_no_value_and_a_note),
           cmocka_unit_test(a_study_without_a_result_ends_with_the_reason_of_its_runs),
           cmocka_unit_test(a_run_whose_floor_cannot_be_followed_has_failed_for_a_named_reason),
           cmocka_unit_test(contact_of_more_cells_than_a_double_counts_ends_by_its_name),
           cmocka_unit_test(a_body_that_never_moves_has_no_demand_but_has_not_failed),
           cmocka_unit_test(a_run_that_takes_hours_is_stopped),
           cmocka_unit_test(want_of_memory_is_no_failed_run_and_the_block_may_be_tried_again))
