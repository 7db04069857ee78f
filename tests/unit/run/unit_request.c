/* unit_request.c - the responses that a study needs: every response of every run is computed, found to equal an
 * earlier one, or left out for a reason that is counted. */
#include <string.h>

#include "engine/pound.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

/* A law in a document, and the number of nonlinear responses without pounding that it needs. */
struct law {
	const char *text;
	int nonlinear;
	bool given;
	bool searched; /* all responses, the last too, report the distance of the demand from its target */
};

// the yield displacement takes corrections + 1 responses, the last of which is the result; fewer if the search ends
// sooner, which no search of four responses does
static const struct law laws[] = {
    {"{\"type\": \"linear\"}", 0, false, false},
    {"{\"type\": \"elastoplastic\"}", 2, false, false},
    {"{\"type\": \"origin_oriented\", \"corrections\": 3}", 4, false, true},
    {"{\"type\": \"nonlinear_elastic\", \"corrections\": 0}", 1, false, false},
    {"{\"type\": \"elastoplastic\", \"yield_displacement_m\": 0.001}", 1, true, false},
};

enum { LAWS = sizeof laws / sizeof laws[0] };

// contacts, and whether the bodies may miss each other
static const struct {
	const char *text;
	bool may_miss;
} contacts[] = {{"{}", false}, {"{\"gap_m\": 0.001}", true}, {"null", true}};

enum { CONTACTS = sizeof contacts / sizeof contacts[0] };

static struct pound_work work_of(const char *document)
{
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = specimen_run(study);
	struct pound_work work = pound_run_result(run)->work;
	pound_run_free(run);
	study_free(study);
	return work;
}

static void expect(const struct pound_work *work, const struct law *left, const struct law *right,
                   bool right_asked)
{
	int64_t runs = work->pounding_runs.asked;
	assert_int_equal(work->free_runs.asked + work->yield_given + work->linear_unasked, 2 * runs);
	assert_int_equal(work->yield_given, runs * (left->given + right->given));
	assert_int_equal(work->linear_unasked, right_asked || right->nonlinear ? 0 : runs);
	assert_int_equal(work->yield_runs.asked + work->nonlinear_unasked,
	                 runs * (left->nonlinear + right->nonlinear));
	assert_int_equal(work->nonlinear_unasked, right_asked || !right->nonlinear || right->searched ? 0 : runs);
	assert_true(work->pounding_runs.run + work->never_touching + work->moving_alike <= runs);
}

static void every_response_is_asked_for_or_left_out_for_a_reason(void **state)
{
	(void)state;
	static const char scene[] =
	    "\"scene\": {\"oscillators\": [{\"frequency_hz\": 2, \"law\": %s}, {\"frequency_hz\": 3.1, \"law\": "
	    "%s}],"
	    " \"contact\": %s, \"excitation\": {\"type\": \"white_noise\", \"duration_s\": 1, \"signals\": 2}}";
	static const char sampled[] =
	    "{\"kind\": \"sensitivity\", \"design\": {\"rows\": 4}, %s, \"inputs\": [{\"path\": "
	    "\"/oscillators/1/mass_kg\", \"distribution\": {\"type\": \"reciprocal_uniform\", \"max\": 6}}]}";
	for (int k = 0; k < LAWS * LAWS * CONTACTS; k++) {
		const struct law *left = &laws[k % LAWS], *right = &laws[k / LAWS % LAWS];
		int c = k / LAWS / LAWS;
		char within[600], document[1000];
		snprintf(within, sizeof within, scene, left->text, right->text, contacts[c].text);
		snprintf(document, sizeof document, "{\"kind\": \"response\", %s}", within);
		struct pound_work response = work_of(document);
		assert_int_equal(response.pounding_runs.asked, 2);
		expect(&response, left, right, true);
		snprintf(document, sizeof document, sampled, within);
		struct pound_work sensitivity = work_of(document);
		assert_int_equal(sensitivity.pounding_runs.asked, 4 * 3 * 2);
		expect(&sensitivity, left, right, contacts[c].may_miss);
	}
}

static void a_wall_has_no_response_of_its_own(void **state)
{
	(void)state;
	struct pound_work work = work_of(
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"elastoplastic\"}, \"oscillators\": "
	    "[{\"frequency_hz\": 2}, {\"rigid_wall\": true}], \"excitation\": {\"signals\": 3}}}");
	assert_int_equal(work.free_runs.asked, 3);
	assert_int_equal(work.yield_runs.asked, 2 * 3);
	assert_int_equal(work.linear_unasked + work.nonlinear_unasked + work.yield_given, 0);
}

static void rows_of_one_ground_motion_share_it_and_the_responses_without_pounding(void **state)
{
	(void)state;
	enum { ROWS = 40, SAMPLES = 4 };
	static const char *const excitations[] = {
	    "{\"type\": \"record\", \"acceleration_m_s2\": [0, 1, -1, 0.5, 0]}",
	    "{\"type\": \"harmonic\", \"frequency_hz\": 2, \"duration_s\": 1}"};
	for (int k = 0; k < 2; k++) {
		char document[600];
		snprintf(
		    document, sizeof document,
		    "{\"kind\": \"sensitivity\", \"design\": {\"rows\": %d}, \"scene\": {\"oscillators\": "
		    "[{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}], \"excitation\": %s}, \"inputs\": [{\"path\": "
		    "\"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}, "
		    "{\"path\": \"/contact/stiffness_ratio\", \"distribution\": {\"type\": \"uniform\", \"min\": 50, "
		    "\"max\": 200}}]}",
		    ROWS, excitations[k]);
		struct pound_study *study = study_documents_study(document);
		struct pound_run *run = specimen_run(study);
		const int blocks = pound_run_blocks(run);
		const struct pound_work *work = &pound_run_result(run)->work;
		assert_true(blocks < ROWS);
		assert_int_equal(work->signals.asked, ROWS * SAMPLES);
		assert_int_equal(work->signals.run, blocks);
		assert_int_equal(work->free_runs.run, blocks);
		assert_int_equal(work->pounding_runs.run, ROWS * SAMPLES);
		pound_run_free(run);
		study_free(study);
	}
}

CHECK_MAIN(cmocka_unit_test(every_response_is_asked_for_or_left_out_for_a_reason),
           cmocka_unit_test(rows_of_one_ground_motion_share_it_and_the_responses_without_pounding),
           cmocka_unit_test(a_wall_has_no_response_of_its_own))
