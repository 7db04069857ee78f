/* unit_yield.c - yield displacements for a target demand: the search by corrections, and a table of how often it
 * reaches the target.
 *
 * The paper's ground motion; oscillators of 0.5 to 5 Hz, target demands of 1.5 to 6. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

static const double frequencies[] = {0.5, 0.7, 1, 1.4, 2, 2.5, 3, 4, 5}, targets[] = {1.5, 2, 3, 4, 6};
enum { FREQUENCIES = 9, TARGETS = 5, SIGNALS = 20, ALL = FREQUENCIES * TARGETS * SIGNALS };

/* Number of searches, by law, whose demand jumps at the target.  The demand is continuous if the law's force depends
 * continuously on its history; otherwise a small change of the yield displacement may change the direction of
 * unloading. */
static const int jumps_known[SPECIMEN_LAWS] = {0};

/* relative difference from the target demand at which a search ends, plus the rounding of a demand's quotients */
static const double reached = 1e-6 + 8 * DBL_EPSILON;

/* results for the left bodies of all scenes of a law */
struct seen {
	int near, percent; /* within 1e-6, beyond 1 % */
	double evaluations;
	int64_t searches, jumps, missed;
};

/* A response study of one body; the right body is a rigid wall. */
static struct pound_study *study_of(const char *law, int corrections, double frequency, double target)
{
	char document[600];
	snprintf(document, sizeof document,
	         "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"%s\", \"corrections\": %d, "
	         "\"target_demand\": %g}, \"oscillators\": [{\"frequency_hz\": %g}, {\"rigid_wall\": true}], "
	         "\"contact\": null, \"excitation\": {\"frequency_hz\": 2.5, \"signals\": %d}}}",
	         law, corrections, target, frequency, SIGNALS);
	return study_documents_study(document);
}

static void scene_add(struct seen *seen, const char *law, int corrections, double frequency, double target)
{
	struct pound_study *study = study_of(law, corrections, frequency, target);
	struct pound_run *run = specimen_run(study);
	const struct pound_result *result = pound_run_result(run);
	int64_t missed = 0;
	for (int signal = 0; signal < SIGNALS; signal++) {
		double off = fabs(result->cells[0].signals[signal].demand_free_1 / target - 1);
		seen->near += off <= reached;
		seen->percent += off > 0.01;
		missed += off > reached;
	}
	seen->searches += result->work.yield_searches;
	seen->jumps += result->work.yield_jumps;
	seen->missed += result->work.yield_missed;
	seen->evaluations += (double)result->work.yield_runs.asked / ALL;
	if (corrections >= 2)
		assert_int_equal(result->work.yield_jumps + result->work.yield_missed, missed);
	else
		assert_int_equal(result->work.yield_searches, 0);
	pound_run_free(run);
	study_free(study);
}

static struct seen seen_of(const char *law, int corrections)
{
	struct seen seen = {0};
	for (int k = 0; k < FREQUENCIES * TARGETS; k++)
		scene_add(&seen, law, corrections, frequencies[k / TARGETS], targets[k % TARGETS]);
	return seen;
}

/* A continuous demand takes every value from 0 (a body that never yields) upwards, so every target has a yield
 * displacement.  Bisection would halve the bracket, initially a factor of about 2, 40 times until a demand that
 * changes by its millionth power is within 1e-6. */
static void a_search_ends_at_the_target_demand(void **state)
{
	(void)state;
	static const int corrections[] = {1, 2, 10, 50, 100};
	puts("| law | corrections | within 1e-6 | beyond 1 % | jumps | used up | responses each |");
	puts("| --- | --- | --- | --- | --- | --- | --- |");
	for (int law = 1; law < SPECIMEN_LAWS; law++)
		for (int k = 0; k < 5; k++) {
			const struct seen seen = seen_of(specimen_laws[law], corrections[k]);
			printf("| %s | %d | %.1f %% | %.1f %% | %lld | %lld | %.1f |\n", specimen_laws[law],
			       corrections[k], 100.0 * seen.near / ALL, 100.0 * seen.percent / ALL, (long long)seen.jumps,
			       (long long)seen.missed, seen.evaluations);
			assert_int_equal(seen.searches, corrections[k] >= 2 ? ALL : 0);
			if (corrections[k] >= 50) {
				assert_int_equal(seen.jumps, jumps_known[law]);
				assert_int_equal(seen.near + seen.jumps, ALL);
			}
		}
}

/* A response with the yield displacement of a search, given as a number, equals the result of the search. */
static void a_yield_displacement_that_was_found_gives_the_same_response(void **state)
{
	(void)state;
	for (int law = 1; law < SPECIMEN_LAWS; law++) {
		struct pound_study *study = study_of(specimen_laws[law], 50, 1.4, 3);
		struct pound_run *run = specimen_run(study), *again;
		const struct pound_response *found = pound_run_result(run)->cells[0].signals;
		for (int signal = 0; signal < 3; signal++) {
			study->scene.law.yield_displacement = found[signal].yield_displacement_1;
			again = specimen_run(study);
			const struct pound_response *given = &pound_run_result(again)->cells[0].signals[signal];
			assert_true(given->displacement_max_free_1 == found[signal].displacement_max_free_1);
			check_near(given->demand_free_1, 3, 3 * reached);
			pound_run_free(again);
		}
		pound_run_free(run);
		study_free(study);
	}
}

/* The search for a right body is the same if no output needs its response. */
static void what_is_asked_of_a_body_does_not_change_its_yield_displacement(void **state)
{
	(void)state;
	static const char document[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"law\": {\"type\": \"elastoplastic\", \"corrections\": "
	    "30}, "
	    "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}], \"contact\": {\"gap_m\": %s}, "
	    "\"excitation\": {\"signals\": 3}}, \"outputs\": [\"impulse\"], \"design\": {\"rows\": 2}, "
	    "\"inputs\": "
	    "[{\"path\": \"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, "
	    "\"max\": "
	    "0.6}}]}";
	double mean[2];
	for (int may_miss = 0; may_miss < 2; may_miss++) {
		char filled[700];
		// the gap is negligible relative to the motion, but the solver must determine whether the bodies meet
		snprintf(filled, sizeof filled, document, may_miss ? "1e-300" : "0");
		struct pound_study *study = study_documents_study(filled);
		struct pound_run *run = specimen_run(study);
		mean[may_miss] = pound_run_sample_output(run, 0, 0, 0, 0).mean;
		assert_int_equal(pound_run_result(run)->work.yield_missed, 0);
		pound_run_free(run);
		study_free(study);
	}
	check_near(mean[1], mean[0], 64 * 0x1p-52 * mean[0]); // steps to the gap round differently
}

static void a_body_that_never_moves_is_not_searched_for(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"elastoplastic\", \"corrections\": 9}, "
	    "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], \"excitation\": {\"type\": "
	    "\"record\", "
	    "\"acceleration_m_s2\": [0, 0]}}}");
	struct pound_run *run = specimen_run(study);
	const struct pound_result *result = pound_run_result(run);
	assert_int_equal(result->work.yield_searches, 0);
	assert_int_equal(result->cells[0].runs_failed, 0);
	assert_true(isnan(result->cells[0].signals[0].demand_free_1));
	pound_run_free(run);
	study_free(study);
}

/* The result document of a study with a number of corrections. */
static struct reading *result_of(int corrections)
{
	struct pound_study *study = study_of("nonlinear_elastic", corrections, 1.4, 3);
	struct pound_run *run = specimen_run(study);
	size_t length;
	char *json = result_to_json(study, pound_run_result(run), NULL, &length);
	struct reading *reading = reading_open(json, length);
	assert_non_null(reading);
	free(json);
	pound_run_free(run);
	study_free(study);
	return reading;
}

static void a_result_says_how_searches_end(void **state)
{
	(void)state;
	for (int corrections = 0; corrections <= 50; corrections += corrections < 3 ? 1 : 47) {
		struct reading *r = result_of(corrections);
		assert_int_equal(reading_has(r, "/work/yield_searches"), corrections >= 2);
		if (corrections >= 2) {
			check_near(reading_number(r, "/work/yield_searches/searches"), SIGNALS, 0);
			check_near(reading_number(r, "/work/yield_searches/jumps"), 0, 0);
			double missed = reading_number(r, "/work/yield_searches/corrections_used_up");
			assert_true(corrections == 50 ? missed == 0 : missed > SIGNALS / 2.0);
			assert_int_equal(reading_has(r, "/work/yield_searches/note"), missed > 0);
		}
		reading_close(r);
	}
}

CHECK_MAIN(cmocka_unit_test(a_search_ends_at_the_target_demand),
           cmocka_unit_test(a_yield_displacement_that_was_found_gives_the_same_response),
           cmocka_unit_test(what_is_asked_of_a_body_does_not_change_its_yield_displacement),
           cmocka_unit_test(a_body_that_never_moves_is_not_searched_for),
           cmocka_unit_test(a_result_says_how_searches_end))
