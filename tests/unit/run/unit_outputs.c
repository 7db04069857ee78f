/* unit_outputs.c - outputs that are means over the signals: each against the values of the single signals. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/run/pair_peaks.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/results.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

static const char pair_outputs[] =
    "\"outputs\": [\"peak_displacement_m\", \"peak_displacement_right_m\", \"peak_displacement_free_m\", "
    "\"peak_displacement_free_right_m\", \"pounding_probability\", \"contact_count\", \"contact_time_s\", "
    "\"peak_impulse_n_s\", ";

static const struct {
	const char *output, *measure;
} of_pairs[] = {{"peak_displacement_m", "oscillators/0/displacement_max_m"},
                {"peak_displacement_right_m", "oscillators/1/displacement_max_m"},
                {"peak_displacement_free_m", "oscillators/0/displacement_max_free_m"},
                {"peak_displacement_free_right_m", "oscillators/1/displacement_max_free_m"},
                {"contact_count", "contact_count"},
                {"contact_time_s", "contact_time_s"},
                {"peak_impulse_n_s", "impulse_max_n_s"},
                {"ductility_demand", "oscillators/0/demand"},
                {"ductility_demand_right", "oscillators/1/demand"}};

enum { SIGNALS = 8 };

/* Mean over the signals of one of their measures. */
static double mean_of(struct reading *result, const char *measure)
{
	double sum = 0;
	for (int i = 0; i < SIGNALS; i++)
		sum += reading_number(result, "/signals/%d/%s", i, measure);
	return sum / SIGNALS;
}

/* A pair whose gap is closed by some signals and not by others. */
static void outputs_of_pairs_are_means_of_the_signals(void **state)
{
	static const char *const laws[] = {"linear", "elastoplastic"};
	(void)state;
	for (int law = 0; law < 2; law++) {
		char document[2048];
		snprintf(document, sizeof document,
		         "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"%s\"}, \"oscillators\": "
		         "[{\"mass_kg\": 3, \"frequency_hz\": 1}, {\"frequency_hz\": 1.7}], \"contact\": {\"gap_m\": "
		         "0.02}, \"excitation\": {\"signals\": %d}}, %s\"%s\", \"%s\"]}",
		         laws[law], SIGNALS, pair_outputs, law ? "ductility_demand" : "force_amplification",
		         law ? "ductility_demand_right" : "force_amplification_right");
		struct reading *r = results_of_study(document);
		for (size_t k = 0; k < sizeof of_pairs / sizeof of_pairs[0]; k++) {
			char at[64];
			snprintf(at, sizeof at, "/outputs/%s", of_pairs[k].output);
			if (!law && strstr(at, "ductility"))
				continue;
			const double want = mean_of(r, of_pairs[k].measure);
			assert_true(want > 0);
			// the sums have the same order
			check_near(reading_number(r, "%s", at), want, 0);
		}
		int touched = 0;
		for (int i = 0; i < SIGNALS; i++)
			touched += reading_number(r, "/signals/%d/contact_count", i) > 0;
		assert_true(touched > 0 && touched < SIGNALS);
		check_near(reading_number(r, "/outputs/pounding_probability"), (double)touched / SIGNALS, 0);
		if (!law)
			check_near(reading_number(r, "/outputs/force_amplification_right"),
			           mean_of(r, "oscillators/1/displacement_max_m") /
			               mean_of(r, "oscillators/1/displacement_max_free_m"),
			           2 * DBL_EPSILON);
		reading_close(r);
	}
}

/* Bodies in contact at rest: the right body is run without pounding only if an output reads it. */
static void the_right_body_is_run_where_an_output_reads_it(void **state)
{
	static const char *const outputs[] = {"peak_displacement_m", "peak_displacement_free_right_m"};
	double run[2];
	(void)state;
	for (int k = 0; k < 2; k++) {
		char document[1024];
		snprintf(document, sizeof document,
		         "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, "
		         "{\"frequency_hz\": 1.7}], \"contact\": {}, \"excitation\": {\"signals\": 2}}, \"inputs\": "
		         "[{\"path\": \"/oscillators/1/frequency_hz\", \"name\": \"f\", \"distribution\": {\"type\": "
		         "\"uniform\", \"min\": 1.2, \"max\": 2}}], \"design\": {\"rows\": 16}, \"outputs\": "
		         "[\"%s\"]}",
		         outputs[k]);
		struct reading *r = results_of_study(document);
		run[k] = reading_number(r, "/work/free_runs/run");
		assert_true(reading_number(r, "/cells/0/outputs/0/mean") > 0);
		assert_true(reading_number(r, "/cells/0/outputs/0/accuracy/difference_largest") < 1e-10);
		reading_close(r);
	}
	assert_true(run[0] < run[1]);
}

/* A row: outputs of a place are those of its story and floor; outputs of contacts are the largest or the sum over all. */
static void outputs_of_rows_are_means_of_the_signals(void **state)
{
	static const struct {
		const char *output, *measure;
	} of_rows[] = {
	    {"peak_displacement_m", "buildings/1/floors/0/displacement_max_m"},
	    {"peak_displacement_free_m", "buildings/1/floors/0/displacement_max_free_m"},
	    {"peak_drift_m", "buildings/1/storeys/0/drift_max_m"},
	    {"peak_drift_free_m", "buildings/1/storeys/0/drift_max_free_m"},
	    {"peak_drift_ratio", "buildings/1/storeys/0/drift_ratio_max"},
	    {"peak_shear_n", "buildings/1/storeys/0/shear_max_n"},
	    {"residual_drift_m", NULL},
	    {"peak_acceleration_m_s2", "buildings/1/floors/0/acceleration_max_m_s2"},
	    {"peak_acceleration_free_m_s2", "buildings/1/floors/0/acceleration_max_free_m_s2"},
	    {"ductility_demand", "buildings/1/storeys/0/demand"},
	};
	char document[2048];
	int n =
	    snprintf(document, sizeof document,
	             "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"elastoplastic\"}, "
	             "\"buildings\": [{\"storeys\": 2, \"mass_kg\": 1e5, \"frequency_hz\": 1}, {\"storeys\": 2, "
	             "\"mass_kg\": 1e5, \"frequency_hz\": 1.7}], \"contact\": {\"gap_m\": 0.02}, "
	             "\"excitation\": {\"signals\": %d}}, \"places\": [{\"building\": 1, \"storey\": 1}], "
	             "\"outputs\": [\"peak_contact_force_n\", \"peak_impulse_n_s\", \"contact_count\", "
	             "\"contact_time_s\", \"pounding_probability\"",
	             SIGNALS);
	(void)state;
	for (size_t k = 0; k < sizeof of_rows / sizeof of_rows[0]; k++)
		n += snprintf(document + n, sizeof document - (size_t)n, ", \"%s\"", of_rows[k].output);
	snprintf(document + n, sizeof document - (size_t)n, "]}");
	struct reading *r = results_of_study(document);
	double force = 0, impulse = 0, count = 0, time = 0, touched = 0, residual = 0;
	for (int i = 0; i < SIGNALS; i++) {
		double contacts = 0, most[2] = {0}, times = 0;
		for (int c = 0; c < 2; c++) {
			most[0] = fmax(most[0], reading_number(r, "/signals/%d/contacts/%d/force_max_n", i, c));
			most[1] = fmax(most[1], reading_number(r, "/signals/%d/contacts/%d/impulse_max_n_s", i, c));
			contacts += reading_number(r, "/signals/%d/contacts/%d/contact_count", i, c);
			times += reading_number(r, "/signals/%d/contacts/%d/contact_time_s", i, c);
		}
		force += most[0], impulse += most[1], count += contacts, time += times;
		touched += contacts > 0;
		residual += fabs(reading_number(r, "/signals/%d/buildings/1/storeys/0/residual_drift_m", i));
	}
	assert_true(touched > 0);
	check_near(reading_number(r, "/outputs/peak_contact_force_n"), force / SIGNALS, 0);
	check_near(reading_number(r, "/outputs/peak_impulse_n_s"), impulse / SIGNALS, 0);
	check_near(reading_number(r, "/outputs/contact_count"), count / SIGNALS, 0);
	check_near(reading_number(r, "/outputs/contact_time_s"), time / SIGNALS, 0);
	check_near(reading_number(r, "/outputs/pounding_probability"), touched / SIGNALS, 0);
	for (size_t k = 0; k < sizeof of_rows / sizeof of_rows[0]; k++) {
		const double want = of_rows[k].measure ? mean_of(r, of_rows[k].measure) : residual / SIGNALS;
		assert_true(want > 0);
		check_near(reading_number(r, "/outputs/%s.building_1.storey_1", of_rows[k].output), want, 0);
	}
	reading_close(r);
}

/* The largest drift ratio of each signal is that of another story: its mean is above those of all places. */
static void the_largest_drift_ratio_is_that_of_all_places(void **state)
{
	static const char document[] =
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"elastoplastic\"}, \"buildings\": "
	    "[{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 1, \"height_m\": [4, 3, 2]}, {\"storeys\": 2, "
	    "\"mass_kg\": 1e5, \"frequency_hz\": 1.7}], \"contact\": {\"gap_m\": 0.02}, \"excitation\": "
	    "{\"signals\": "
	    "8}}, \"outputs\": [\"peak_drift_ratio\", \"largest_drift_ratio\"]}";
	double sum = 0, mean_most = 0;
	(void)state;
	struct reading *r = results_of_study(document);
	for (int i = 0; i < 8; i++) {
		double most = 0;
		for (int s = 0; s < 3; s++) {
			const double ratio =
			    reading_number(r, "/signals/%d/buildings/0/storeys/%d/drift_max_m", i, s) / (4 - s);
			check_near(reading_number(r, "/signals/%d/buildings/0/storeys/%d/drift_ratio_max", i, s), ratio,
			           0);
			most = fmax(most, ratio);
		}
		sum += most;
	}
	for (int s = 1; s <= 3; s++)
		mean_most = fmax(mean_most, reading_number(r, "/outputs/peak_drift_ratio.building_0.storey_%d", s));
	check_near(reading_number(r, "/outputs/largest_drift_ratio"), sum / 8, 0);
	assert_true(sum / 8 > mean_most);
	reading_close(r);
}

#define TWO_HEIGHTS                                                                                          \
	"\"scene\": {\"buildings\": [{\"storeys\": 2, \"mass_kg\": 1e5, \"frequency_hz\": 1}, {\"storeys\": 2, " \
	"\"mass_kg\": 1e5, \"frequency_hz\": 1.7}], \"contact\": {\"gap_m\": 0.02}, \"excitation\": "            \
	"{\"signals\": 2}}, "                                                                                    \
	"\"outputs\": [\"peak_drift_ratio\", \"largest_drift_ratio\", \"peak_drift_m\"]"

/* Half the height of a story doubles its drift ratio and no drift. */
static void a_varied_height_divides_drifts(void **state)
{
	(void)state;
	struct reading *r =
	    results_of_study("{\"kind\": \"response\", \"sweep\": [{\"path\": \"/buildings/0/height_m\", "
	                     "\"values\": [3, 1.5]}], " TWO_HEIGHTS "}");
	static const struct {
		const char *output;
		double times;
	} all[] = {{"peak_drift_ratio.building_0.storey_1", 2},
	           {"peak_drift_ratio.building_0.storey_2", 2},
	           {"largest_drift_ratio", 2},
	           {"peak_drift_m.building_0.storey_1", 1}};
	for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
		const double high = reading_number(r, "/cells/0/outputs/%s", all[k].output);
		assert_true(high > 0);
		check_near(reading_number(r, "/cells/1/outputs/%s", all[k].output), all[k].times * high, 0);
	}
	reading_close(r);
	r = results_of_study("{\"kind\": \"sensitivity\", \"design\": {\"rows\": 8}, \"inputs\": [{\"path\": "
	                     "\"/buildings/0/height_m\", "
	                     "\"distribution\": {\"type\": \"uniform\", \"min\": 2, \"max\": 4}}, {\"path\": "
	                     "\"/buildings/1/height_m/0\", "
	                     "\"distribution\": {\"type\": \"uniform\", \"min\": 2, \"max\": 4}}], " TWO_HEIGHTS
	                     "}");
	assert_true(reading_number(r, "/cells/0/outputs/0/inputs/%d/ST", 0) > 0.1);
	check_near(reading_number(r, "/cells/0/outputs/0/inputs/%d/ST", 1), 0, 0);
	reading_close(r);
}

/* A value from a study of one signal; `part` follows the output's name. */
static double number_at(const char *scene, const char *law, double gap, int seed, const char *output,
                        const char *part)
{
	char document[1024];
	snprintf(document, sizeof document,
	         "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"%s\"}, %s, \"contact\": {\"gap_m\": "
	         "%.17g}, \"excitation\": {\"signals\": 1}}, \"design\": {\"seed\": %d}, \"outputs\": [\"%s\"]}",
	         law, scene, gap, seed, output);
	struct reading *r = results_of_study(document);
	const double value = reading_number(r, "/outputs/%s%s", output, part);
	reading_close(r);
	return value;
}

static double number_of(const char *scene, const char *law, double gap, int seed, const char *output)
{
	return number_at(scene, law, gap, seed, output, "");
}

/* Brute force: the bodies touch if the gap is smaller than needed by 1e-9, and not if it is larger by 1e-9. */
static void the_gap_needed_decides_which_signals_pound(void **state)
{
	static const char *const scenes[] = {
	    "\"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 1}, {\"frequency_hz\": 1.7}]",
	    "\"oscillators\": [{\"frequency_hz\": 2.5, \"damping_ratio\": 0}, {\"frequency_hz\": 0.6}]",
	    "\"oscillators\": [{\"frequency_hz\": 0.8}, {\"rigid_wall\": true}]",
	    "\"oscillators\": [{\"frequency_hz\": 60}, {\"frequency_hz\": 400, \"damping_ratio\": 0.5}]"};
	(void)state;
	for (int law = 0; law < SPECIMEN_LAWS; law++)
		for (int k = 0; k < 4; k++)
			for (int seed = 1; seed <= 4; seed++) {
				const double gap = number_of(scenes[k], specimen_laws[law], 0, seed, "gap_needed_m");
				assert_true(gap > 0);
				check_near(
				    number_of(scenes[k], specimen_laws[law], gap * (1 - 1e-9), seed, "pounding_probability"),
				    1, 0);
				check_near(
				    number_of(scenes[k], specimen_laws[law], gap * (1 + 1e-9), seed, "pounding_probability"),
				    0, 0);
			}
}

/* For rows: some contact closes exactly if it needs more than its gap.  One-story buildings need the same as oscillators. */
static void the_gap_needed_decides_which_signals_pound_in_rows(void **state)
{
	static const char *const laws[] = {"linear", "elastoplastic", "origin_oriented"};
	static const struct {
		const char *scene;
		int contacts;
	} rows[] = {
	    {"\"buildings\": [{\"storeys\": 1, \"mass_kg\": 3, \"frequency_hz\": 1}, {\"storeys\": 1, "
	     "\"mass_kg\": 1, "
	     "\"frequency_hz\": 1.7}]",
	     1},
	    {"\"buildings\": [{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 2}, {\"storeys\": 2, "
	     "\"mass_kg\": 2e5, "
	     "\"frequency_hz\": 1}, {\"rigid_wall\": true}], \"contacts\": [{\"levels\": [1, 0.8]}, {\"levels\": "
	     "[3, 2]}, "
	     "{\"left_building\": 1, \"levels\": [2, 2]}]",
	     3},
	};
	static const char pair[] =
	    "\"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 1}, {\"frequency_hz\": 1.7}]";
	(void)state;
	for (int law = 0; law < 3; law++)
		for (int k = 0; k < 2; k++)
			for (int seed = 1; seed <= 3; seed++) {
				double most = 0, one;
				for (int c = 0; c < rows[k].contacts; c++) {
					char at[32];
					snprintf(at, sizeof at, ".contact_%d", c);
					one = number_at(rows[k].scene, laws[law], 0, seed, "gap_needed_m", at);
					assert_true(one > 0);
					most = fmax(most, one);
				}
				if (k == 0)
					check_near(most / number_of(pair, laws[law], 0, seed, "gap_needed_m"), 1, 1e-11);
				check_near(
				    number_of(rows[k].scene, laws[law], most * (1 - 1e-9), seed, "pounding_probability"), 1,
				    0);
				check_near(
				    number_of(rows[k].scene, laws[law], most * (1 + 1e-9), seed, "pounding_probability"), 0,
				    0);
			}
}

/* With the bodies exchanged, the gap closes when it opened before. */
static void the_relative_displacement_is_the_larger_of_both_directions(void **state)
{
	static const char here[] = "\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 1.7}]",
	                  exchanged[] = "\"oscillators\": [{\"frequency_hz\": 1.7}, {\"frequency_hz\": 1}]";
	int opening = 0;
	(void)state;
	for (int seed = 1; seed <= 8; seed++) {
		const double closing[] = {number_of(here, "elastoplastic", 0, seed, "gap_needed_m"),
		                          number_of(exchanged, "elastoplastic", 0, seed, "gap_needed_m")};
		const double most = number_of(here, "elastoplastic", 0, seed, "peak_relative_displacement_free_m");
		check_near(most / fmax(closing[0], closing[1]), 1, 1e-13);
		opening += closing[1] > closing[0];
	}
	assert_true(opening > 0 && opening < 8);
}

/* Maps from sample to sample against the exact solver and its observer, with 1 to 6 ground motions of the same bodies. */
static void linear_bodies_have_the_peaks_that_an_observer_finds(void **state)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	enum { SAMPLES = 400, MOTIONS = 6 };
	(void)state;
	struct pound_pairs pairs = {0};
	for (int number = 0; number < 60; number++) {
		static double grounds[MOTIONS][SAMPLES];
		uint64_t stream = (uint64_t)number + 1;
		struct pound_task task = {.n_samples = SAMPLES, .time_step = 0.02};
		for (int i = 0; i < POUND_OSCILLATORS; i++) {
			const double w = exp(specimen_uniform(&stream, log(0.5), log(40)));
			task.bodies[i] = (struct pound_task_body){.backbone = {.stiffness = w * w},
			                                          .damping = 2 * w * specimen_uniform(&stream, 0, 0.3),
			                                          .drive = 1};
		}
		double peak[MOTIONS][2];
		const int n = 1 + number % MOTIONS;
		for (int j = 0; j < n; j++) {
			task.ground = grounds[j];
			for (int k = 0; k < SAMPLES; k++)
				grounds[j][k] = specimen_uniform(&stream, -1, 1);
			assert_true(pound_pairs_add(&pairs, &task, peak[j]));
		}
		pound_pairs_finish(&pairs);
		for (int j = 0; j < n; j++) {
			struct pound_task_result result;
			struct pound_pair_peaks peaks;
			task.ground = grounds[j];
			pound_pair_peaks_start(&peaks, &task);
			assert_true(pound_exact_lanes(0, &task, &result, 1, scratch, NULL));
			for (int k = 0; k < 2; k++)
				check_near(peak[j][k], peaks.peak[k], 1e-12 * (peaks.peak[0] + peaks.peak[1]));
		}
	}
	// a sample that is long relative to a period needs the solver
	struct pound_task stiff = {.time_step = 1, .bodies = {{.backbone = {.stiffness = 4}}, {.drive = 1}}};
	double peak[2];
	assert_false(pound_pairs_add(&pairs, &stiff, peak));
}

/* Two free masses that meet after 10 cm and separate for good. */
static void bodies_that_meet_have_closed_their_gap(void **state)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	(void)state;
	struct pound_task task = specimen_impact(0.5, true, 100);
	struct pound_task_result result;
	struct pound_pair_peaks peaks;
	pound_pair_peaks_start(&peaks, &task);
	assert_true(pound_exact_lanes(0, &task, &result, 1, scratch, NULL));
	assert_int_equal(result.contacts, 1);
	check_near(peaks.peak[0], 0.1, 1e-13);
}

CHECK_MAIN(cmocka_unit_test(the_gap_needed_decides_which_signals_pound),
           cmocka_unit_test(the_gap_needed_decides_which_signals_pound_in_rows),
           cmocka_unit_test(the_relative_displacement_is_the_larger_of_both_directions),
           cmocka_unit_test(linear_bodies_have_the_peaks_that_an_observer_finds),
           cmocka_unit_test(bodies_that_meet_have_closed_their_gap),
           cmocka_unit_test(outputs_of_pairs_are_means_of_the_signals),
           cmocka_unit_test(the_right_body_is_run_where_an_output_reads_it),
           cmocka_unit_test(outputs_of_rows_are_means_of_the_signals),
           cmocka_unit_test(the_largest_drift_ratio_is_that_of_all_places),
           cmocka_unit_test(a_varied_height_divides_drifts))
