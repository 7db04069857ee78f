/* unit_separation_result.c - separation studies: gaps needed from runs without contact, against runs with contact. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/results.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

enum { SIGNALS = 60, RECORDS = 20 };

/* Brute force: every signal with contact, for every gap and peak acceleration. */
static void the_result_is_what_brute_force_counts(void **state)
{
	static const char *const laws[] = {"linear", "elastoplastic"};
	static const char *const rights[] = {"{\"frequency_hz\": 1.7}", "{\"rigid_wall\": true}"};
	(void)state;
	for (int law = 0; law < 2; law++)
		for (int right = 0; right < 2; right++) {
			char scene[512], document[1024];
			int between = 0;
			snprintf(
			    scene, sizeof scene,
			    "\"law\": {\"type\": \"%s\"}, \"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 1}, %s], "
			    "\"excitation\": {\"signals\": %d}",
			    laws[law], rights[right], SIGNALS);
			snprintf(document, sizeof document,
			         "{\"kind\": \"separation\", \"scene\": {%s}, \"sweep\": [{\"path\": "
			         "\"/excitation/peak_m_s2\", \"values\": [0.5, 1]}]}",
			         scene);
			struct reading *r = results_of_study(document);
			// no run has contact
			check_near(reading_number(r, "/work/pounding_runs/run"), 0, 0);
			assert_true(reading_count(r, "/cells/1/pounding") >= 15);
			for (int cell = 0; cell < 2; cell++)
				for (int g = 0; g < reading_count(r, "/cells/%d/pounding", cell); g += 3) {
					const double gap = reading_number(r, "/cells/%d/pounding/%d/gap_m", cell, g);
					const double p = reading_number(r, "/cells/%d/pounding/%d/probability", cell, g);
					snprintf(document, sizeof document,
					         "{\"kind\": \"response\", \"scene\": {%.*s, \"peak_m_s2\": %g}, \"contact\": "
					         "{\"gap_m\": %.17g}}, \"outputs\": [\"pounding_probability\"]}",
					         (int)strlen(scene) - 1, scene, cell ? 1 : 0.5, gap);
					struct reading *brute = results_of_study(document);
					check_near(reading_number(brute, "/outputs/pounding_probability"), p, 0);
					reading_close(brute);
					between += p > 0 && p < 1;
				}
			assert_true(between > 5);
			reading_close(r);
		}
}

/* Pounding at listed gaps in the same study; the gaps needed do not change. */
static void outputs_with_pounding_are_those_of_a_response(void **state)
{
	static const char scene[] = "\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 1.7}], "
	                            "\"excitation\": {\"signals\": 40}";
	static const char outputs[] = "[\"pounding_probability\", \"peak_impulse_n_s\", \"peak_displacement_m\"]";
	char document[1024];
	(void)state;
	snprintf(document, sizeof document,
	         "{\"kind\": \"separation\", \"scene\": {%s, \"contact\": {}}, \"outputs\": %s, \"sweep\": "
	         "[{\"path\": "
	         "\"/contact/gap_m\", \"values\": [0.01, 0.02, 0.03]}], \"separation\": {\"gaps_m\": [0.01, "
	         "0.02, 0.03]}}",
	         scene, outputs);
	struct reading *r = results_of_study(document);
	for (int cell = 0; cell < 3; cell++) {
		snprintf(
		    document, sizeof document,
		    "{\"kind\": \"response\", \"scene\": {%s, \"contact\": {\"gap_m\": 0.0%d}}, \"outputs\": %s}",
		    scene, cell + 1, outputs);
		struct reading *response = results_of_study(document);
		static const char *const names[] = {"pounding_probability", "peak_impulse_n_s",
		                                    "peak_displacement_m"};
		for (int k = 0; k < 3; k++)
			check_near(reading_number(r, "/cells/%d/outputs/%s", cell, names[k]),
			           reading_number(response, "/outputs/%s", names[k]), 1e-14);
		check_near(reading_number(r, "/cells/%d/outputs/pounding_probability", cell),
		           reading_number(r, "/cells/0/pounding/%d/probability", cell), 0);
		check_near(reading_number(r, "/cells/%d/gap_needed/mean_m", cell),
		           reading_number(r, "/cells/0/gap_needed/mean_m"), 0);
		reading_close(response);
	}
	reading_close(r);
}

/* A step of ground acceleration a to the left, undamped, w_2 = 2 w_1: u_i = |a|/w_i^2 (1 - cos w_i t), so that
 * u_1 - u_2 = |a|/w_1^2 (1 - cos w_1 t - (1 - cos 2 w_1 t)/4), whose extremes are at multiples of pi: 2 |a|/w_1^2. */
static void a_step_of_acceleration_needs_its_closed_form(void **state)
{
	(void)state;
	const double pi = 3.14159265358979323846, w = 2 * pi;
	struct reading *r =
	    results_of_study("{\"kind\": \"separation\", \"scene\": {\"oscillators\": "
	                     "[{\"frequency_hz\": 1, \"damping_ratio\": 0}, "
	                     "{\"frequency_hz\": 2, \"damping_ratio\": 0}], \"excitation\": {\"type\": "
	                     "\"record\", \"time_step_s\": 0.3, "
	                     "\"acceleration_m_s2\": [-0.7, -0.7, -0.7, -0.7, -0.7]}}}");
	check_near(reading_number(r, "/cells/0/gap_needed/largest_m") / (2 * 0.7 / (w * w)), 1, 1e-13);
	// u_1 reaches 2 |a|/w_1^2 and u_2 a quarter of that: the sum of both is 1.25 times the gap needed
	check_near(reading_number(r, "/cells/0/rules/0/over_mean"), 1.25, 1e-12);
	check_near(reading_number(r, "/cells/0/rules/1/over_mean"), sqrt(1 + 1.0 / 16), 1e-12);
	check_near(reading_number(r, "/cells/0/correlation"), 0, 0);
	reading_close(r);
}

/* A cycle of a sin W t with factors 1 to 20, undamped, w_1 = 2 W, w_2 = 3 W.  With x = W t
 *
 *   u_i = -a/(w_i^2 - W^2) (sin x - W/w_i sin (w_i x/W))
 *   u_1 - u_2 = -a/W^2 s ((1 - c)/3 - s^2/6),   s = sin x, c = cos x
 *
 * is largest where 3 c^2 - c - 2 = 0: c = -2/3, s^2 = 5/9; u_1 where c = -1/2, u_2 where s = 1.  Linear interpolation
 * between samples has the fraction (sin(pi/n)/(pi/n))^2 of the sine, and harmonics from n - 1 on, which move no body
 * by more than 4/n^3 of it. */
static void suite_of_sines_check(const char *directions, int each, double width[RECORDS + 1])
{
	enum { N = 200 };
	const double pi = 3.14159265358979323846, step = 0.005, w = 2 * pi / (N * step), near = 4.0 / (N * N * N);
	const double share = sin(pi / N) / (pi / N), a = share * share / (w * w);
	const double one = 25 * sqrt(5) / 162 * a, left = sqrt(3) / 4 * a, right = a / 6,
	             mean = 0.5 * (RECORDS + 1);
	char *document;
	size_t length;
	FILE *out = open_memstream(&document, &length);
	fprintf(out,
	        "{\"kind\": \"separation\", \"scene\": {\"oscillators\": [{\"frequency_hz\": %.17g, "
	        "\"damping_ratio\": 0}, "
	        "{\"frequency_hz\": %.17g, \"damping_ratio\": 0}], \"excitation\": {\"type\": \"suite\", "
	        "\"directions\": \"%s\", \"records\": [",
	        2 / (N * step), 3 / (N * step), directions);
	for (int k = 1; k <= RECORDS; k++) {
		fprintf(out, "%s{\"factor\": %d, \"time_step_s\": %g, \"acceleration_m_s2\": [0", k > 1 ? ", " : "",
		        k, step);
		for (int i = 1; i <= N; i++)
			fprintf(out, ", %.17g", sin(2 * pi * i / N));
		fputs("]}", out);
	}
	fputs("]}}, \"separation\": {\"gaps_m\": [", out);
	for (int k = 0; k <= RECORDS; k++)
		fprintf(out, "%s%.17g", k ? ", " : "", (k + 0.5) * one);
	fputs("], \"probabilities\": [0.5, 0.05]}}", out);
	fclose(out);
	struct reading *r = results_of_study(document);
	free(document);
	const double runs = each * RECORDS;
	for (int j = 0; j < runs; j++)
		check_near(reading_number(r, "/cells/0/gap_needed/signals_m/%d", j) / ((j / each + 1) * one), 1,
		           near);
	check_near(reading_number(r, "/cells/0/gap_needed/runs"), runs, 0);
	check_near(reading_number(r, "/cells/0/gap_needed/independent"), RECORDS, 0);
	check_near(reading_number(r, "/cells/0/gap_needed/mean_m") / (mean * one), 1, near);
	check_near(reading_number(r, "/cells/0/gap_needed/standard_deviation_m") /
	               (sqrt((RECORDS * RECORDS - 1) / 12.0 * runs / (runs - 1)) * one),
	           1, near);
	// at a gap between those needed by records k and k + 1, all records after k pound
	for (int k = 0; k <= RECORDS; k++) {
		check_near(reading_number(r, "/cells/0/pounding/%d/probability", k), (double)(RECORDS - k) / RECORDS,
		           1e-15);
		width[k] = reading_number(r, "/cells/0/pounding/%d/high", k) -
		           reading_number(r, "/cells/0/pounding/%d/low", k);
	}
	check_near(reading_number(r, "/cells/0/gaps/0/gap_m") / (10 * one), 1, near);
	check_near(reading_number(r, "/cells/0/gaps/1/gap_m") / (19 * one), 1, near);
	check_near(reading_number(r, "/cells/0/rules/0/gap_m") / (mean * (left + right)), 1, near);
	check_near(reading_number(r, "/cells/0/rules/1/gap_m") / (mean * hypot(left, right)), 1, near);
	reading_close(r);
}

static void a_suite_of_sines_needs_its_closed_forms(void **state)
{
	(void)state;
	double one[RECORDS + 1], both[RECORDS + 1];
	suite_of_sines_check("one", 1, one);
	suite_of_sines_check("both", 2, both);
	// both directions need the same gap, so the second adds no information
	for (int k = 0; k <= RECORDS; k++)
		assert_true(both[k] >= one[k] * (1 - 1e-12));
}

/* With uncertain structures the runs are samples A and B of the design, and the gap needed has indices. */
static void with_inputs_the_runs_are_those_of_the_design(void **state)
{
	(void)state;
	static const char head[] = "\"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": "
	                           "1.7}], \"excitation\": {\"signals\": "
	                           "2}}, \"inputs\": [{\"path\": \"/oscillators/1/frequency_hz\", \"name\": "
	                           "\"f\", \"distribution\": {\"type\": "
	                           "\"uniform\", \"min\": 1.2, \"max\": 2}}], \"design\": {\"rows\": 64}";
	char document[1024];
	snprintf(document, sizeof document,
	         "{\"kind\": \"separation\", %s, \"separation\": {\"gaps_m\": [0.01, 0.02]}}", head);
	struct reading *r = results_of_study(document);
	snprintf(document, sizeof document, "{\"kind\": \"sensitivity\", %s, \"outputs\": [\"gap_needed_m\"]}",
	         head);
	struct reading *indices = results_of_study(document);
	check_near(reading_number(r, "/cells/0/gap_needed/runs"), 64 * 2 * 2, 0);
	check_near(reading_number(r, "/cells/0/gap_needed/independent"), 64, 0);
	// the mean over A and B is the same in both results
	check_near(reading_number(r, "/cells/0/gap_needed/mean_m") /
	               reading_number(indices, "/cells/0/outputs/0/mean"),
	           1, 1e-13);
	check_near(reading_number(r, "/cells/0/outputs/0/inputs/0/ST_raw"),
	           reading_number(indices, "/cells/0/outputs/0/inputs/0/ST_raw"), 0);
	const double p = reading_number(r, "/cells/0/pounding/1/probability");
	assert_true(p > 0 && p < 1 && fmod(p * 256, 1) == 0);
	reading_close(r);
	reading_close(indices);
}

/* Linear bodies: gaps are proportional to the intensity, so a curve over ln x is the distribution of the gaps over ln g. */
static void a_swept_intensity_has_fragility_curves_and_rates(void **state)
{
	(void)state;
	struct reading *r = results_of_study(
	    "{\"kind\": \"separation\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": "
	    "1.7}], "
	    "\"excitation\": {\"signals\": 100}}, \"sweep\": [{\"path\": \"/oscillators/0/damping_ratio\", "
	    "\"values\": "
	    "[0.05, 0.02]}, {\"path\": \"/excitation/peak_m_s2\", \"values\": [0.5, 1, 2, 4]}], \"separation\": "
	    "{\"gaps_m\": [0.02, 0.04], \"intensity\": \"/excitation/peak_m_s2\", \"hazard\": {\"intensities\": "
	    "[0.1, 5], "
	    "\"annual_rates\": [0.1, 0.00004]}, \"return_periods_years\": [475]}}");
	assert_int_equal(reading_count(r, "/fragility"), 2);
	for (int set = 0; set < 2; set++) {
		const double median = reading_number(r, "/fragility/%d/curves/0/median", set);
		const double twice = reading_number(r, "/fragility/%d/curves/1/median", set);
		// successive intensities differ by a factor of 2: at twice the gap the counts shift by one intensity, except
		// at the ends
		assert_true(twice / median > 1.9 && twice / median < 2.1);
		const double low = reading_number(r, "/fragility/%d/curves/0/median_low", set),
		             high = reading_number(r, "/fragility/%d/curves/0/median_high", set);
		assert_true(low < median && median < high && high / low < 1.5);
		const double rate = reading_number(r, "/fragility/%d/curves/0/annual_rate", set);
		assert_true(rate > reading_number(r, "/fragility/%d/curves/1/annual_rate", set));
		const double gap = reading_number(r, "/fragility/%d/return_periods/0/gap_m", set);
		assert_true(gap > 0.005 && gap < 0.2);
		assert_true(reading_number(r, "/fragility/%d/return_periods/0/low_m", set) <= gap);
	}
	// less damping, larger gaps: weaker motions lead to pounding
	assert_true(reading_number(r, "/fragility/1/curves/0/median") <
	            reading_number(r, "/fragility/0/curves/0/median"));
	check_near(reading_number(r, "/fragility/1/sweep/~1oscillators~10~1damping_ratio"), 0.02, 0);
	reading_close(r);
}

/* One-story buildings equal oscillators, run once together without contact; a wall is to the right of the last. */
static void each_gap_of_a_row_is_that_of_its_pair(void **state)
{
	static const char *const laws[] = {"linear", "elastoplastic"};
	static const char *const members[] = {"gap_needed/mean_m",    "gap_needed/standard_deviation_m",
	                                      "gap_needed/largest_m", "displacement_left_m",
	                                      "displacement_right_m", "correlation",
	                                      "rules/0/gap_m",        "rules/1/gap_m",
	                                      "rules/2/gap_m",        "gaps/1/gap_m",
	                                      "gaps/1/low_m",         "pounding/1/probability",
	                                      "pounding/1/high",      "rules/2/probability"};
	static const char rest[] =
	    "\"excitation\": {\"signals\": 40}}, \"sweep\": [{\"path\": "
	    "\"/excitation/peak_m_s2\", \"values\": [0.5, 1]}], \"separation\": {\"gaps_m\": [0, "
	    "0.013, 0.03], \"intensity\": \"/excitation/peak_m_s2\"}}";
	static const char *const bodies[] = {"\"mass_kg\": 3, \"frequency_hz\": 1",
	                                     "\"mass_kg\": 2, \"frequency_hz\": 1.7, \"damping_ratio\": 0.02",
	                                     "\"rigid_wall\": true"};
	double most = 0;
	char document[2048];
	(void)state;
	for (int law = 0; law < 2; law++) {
		snprintf(document, sizeof document,
		         "{\"kind\": \"separation\", \"scene\": {\"law\": {\"type\": \"%s\"}, \"buildings\": "
		         "[{\"storeys\": 1, %s}, {\"storeys\": 1, %s}, {%s}], %s",
		         laws[law], bodies[0], bodies[1], bodies[2], rest);
		struct reading *row = results_of_study(document);
		check_near(reading_number(row, "/work/pounding_runs/run"), 0, 0);
		check_near(reading_number(row, "/work/free_pair_runs/run"), 80, 0);
		assert_int_equal(reading_count(row, "/fragility"), 2);
		for (int contact = 0; contact < 2; contact++) {
			snprintf(document, sizeof document,
			         "{\"kind\": \"separation\", \"scene\": {\"law\": {\"type\": \"%s\"}, \"oscillators\": "
			         "[{%s}, {%s}], %s",
			         laws[law], bodies[contact], bodies[contact + 1], rest);
			struct reading *pair = results_of_study(document);
			check_near(reading_number(row, "/cells/0/contacts/%d/left_building", contact), contact, 0);
			for (int cell = 0; cell < 2; cell++)
				for (size_t k = 0; k < sizeof members / sizeof members[0]; k++) {
					const double of = reading_number(row, "/cells/%d/contacts/%d/%s", cell, contact,
					                                 members[k]),
					             wanted = reading_number(pair, "/cells/%d/%s", cell, members[k]);
					check_near(of, wanted, 1e-12 * fabs(wanted));
					most = wanted ? fmax(most, fabs(of / wanted - 1)) : most;
				}
			for (int k = 0; k < 40; k++)
				check_near(reading_number(row, "/cells/1/contacts/%d/gap_needed/signals_m/%d", contact, k),
				           reading_number(pair, "/cells/1/gap_needed/signals_m/%d", k), 1e-13);
			check_near(reading_number(row, "/fragility/%d/contact", contact), contact, 0);
			if (!isnan(reading_number(pair, "/fragility/0/curves/1/median")))
				check_near(reading_number(row, "/fragility/%d/curves/1/median", contact),
				           reading_number(pair, "/fragility/0/curves/1/median"), 1e-9);
			reading_close(pair);
		}
		reading_close(row);
	}
	printf("# gaps of one-story rows as those of pairs to %.1e\n", most);
}

/* Brute force: with one contact only, a signal pounds exactly if it needs more than the gap. */
static void each_gap_of_a_row_is_what_brute_force_counts(void **state)
{
	static const char *const laws[] = {"linear", "elastoplastic"};
	static const char *const contacts[] = {"{\"levels\": [1, 0.8]}", "{\"levels\": [3, 2]}",
	                                       "{\"left_building\": 1, \"levels\": [2, 2]}"};
	static const double gaps[] = {0.01, 0.02, 0.03, 0.04};
	static const char buildings[] =
	    "\"buildings\": [{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 2}, {\"storeys\": 2, "
	    "\"mass_kg\": "
	    "2e5, \"frequency_hz\": 1}, {\"rigid_wall\": true}], \"excitation\": {\"signals\": 25}";
	int between = 0;
	char document[1024];
	(void)state;
	for (int law = 0; law < 2; law++) {
		snprintf(
		    document, sizeof document,
		    "{\"kind\": \"separation\", \"scene\": {\"law\": {\"type\": \"%s\"}, %s, \"contacts\": [%s, %s, "
		    "%s]}, \"separation\": {\"gaps_m\": [0.01, 0.02, 0.03, 0.04]}}",
		    laws[law], buildings, contacts[0], contacts[1], contacts[2]);
		struct reading *r = results_of_study(document);
		for (int contact = 0; contact < 3; contact++)
			for (int g = 0; g < 4; g++) {
				const double p =
				    reading_number(r, "/cells/0/contacts/%d/pounding/%d/probability", contact, g);
				snprintf(document, sizeof document,
				         "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"%s\"}, %s, "
				         "\"contacts\": [%s], "
				         "\"contact\": {\"gap_m\": %.17g}}, \"outputs\": [\"pounding_probability\"]}",
				         laws[law], buildings, contacts[contact], gaps[g]);
				struct reading *brute = results_of_study(document);
				check_near(reading_number(brute, "/outputs/pounding_probability"), p, 0);
				reading_close(brute);
				between += p > 0 && p < 1;
			}
		reading_close(r);
	}
	assert_true(between > 5);
}

/* A largest displacement at a level is that of its floor in separate runs; pounding at listed gaps in the same study. */
static void levels_of_a_row_are_its_floors(void **state)
{
	static const char scene[] = "\"buildings\": [{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 2}, "
	                            "{\"storeys\": 2, \"mass_kg\": 2e5, \"frequency_hz\": 1}], \"excitation\": "
	                            "{\"signals\": 10}";
	static const char *const outputs[] = {"pounding_probability", "peak_impulse_n_s"};
	char document[1024];
	(void)state;
	snprintf(document, sizeof document,
	         "{\"kind\": \"separation\", \"scene\": {%s}, \"outputs\": [\"pounding_probability\", "
	         "\"peak_impulse_n_s\"], \"sweep\": [{\"path\": \"/contact/gap_m\", \"values\": [0.01, 0.02]}]}",
	         scene);
	struct reading *r = results_of_study(document);
	for (int cell = 0; cell < 2; cell++) {
		snprintf(
		    document, sizeof document,
		    "{\"kind\": \"response\", \"scene\": {%s, \"contact\": {\"gap_m\": 0.0%d}}, \"outputs\": "
		    "[\"peak_displacement_free_m\", \"pounding_probability\", \"peak_impulse_n_s\"], \"places\": "
		    "[{\"building\": 0, \"storey\": 1}, {\"building\": 0, \"storey\": 2}, {\"building\": 1, "
		    "\"storey\": 1}, {\"building\": 1, \"storey\": 2}]}",
		    scene, cell + 1);
		struct reading *response = results_of_study(document);
		for (int k = 0; k < 4; k++) {
			const double floor = reading_number(
			    response, "/outputs/peak_displacement_free_m.building_%d.storey_%d", k / 2, k % 2 + 1);
			check_near(reading_number(r, "/cells/%d/contacts/%d/displacement_%s_m", cell, k % 2,
			                          k / 2 ? "right" : "left"),
			           floor, 1e-11 * floor);
		}
		for (int k = 0; k < 2; k++)
			check_near(reading_number(r, "/cells/%d/outputs/%s", cell, outputs[k]),
			           reading_number(response, "/outputs/%s", outputs[k]),
			           1e-13 * reading_number(response, "/outputs/%s", outputs[k]));
		reading_close(response);
	}
	check_near(reading_number(r, "/cells/0/contacts/1/gap_needed/mean_m"),
	           reading_number(r, "/cells/1/contacts/1/gap_needed/mean_m"), 0);
	reading_close(r);
}

/* Yielding bodies are run once, both together: the largest displacements equal those of separate runs. */
static void bodies_that_yield_are_run_once(void **state)
{
	static const char *const laws[] = {
	    "{\"type\": \"elastoplastic\", \"yield_displacement_m\": 0.01}",
	    "{\"type\": \"elastoplastic\", \"target_demand\": 2, \"corrections\": 0}"};
	static const char *const names[] = {"displacement_left_m", "displacement_right_m"},
	                         *const outputs[] = {"peak_displacement_free_m",
	                                             "peak_displacement_free_right_m"};
	char scene[512], document[1024];
	(void)state;
	for (int law = 0; law < 2; law++) {
		snprintf(
		    scene, sizeof scene,
		    "\"scene\": {\"law\": %s, \"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 1.7}], "
		    "\"contact\": null, \"excitation\": {\"signals\": 30}}",
		    laws[law]);
		snprintf(document, sizeof document, "{\"kind\": \"separation\", %s}", scene);
		struct reading *r = results_of_study(document);
		snprintf(document, sizeof document, "{\"kind\": \"response\", %s, \"outputs\": [\"%s\", \"%s\"]}",
		         scene, outputs[0], outputs[1]);
		struct reading *alone = results_of_study(document);
		check_near(reading_number(r, "/work/yield_runs/run"), 0, 0);
		check_near(reading_number(r, "/work/free_pair_runs/run"), 30, 0);
		for (int k = 0; k < 2; k++) {
			const double wanted = reading_number(alone, "/outputs/%s", outputs[k]);
			check_near(reading_number(r, "/cells/0/%s", names[k]), wanted, 1e-12 * wanted);
		}
		reading_close(r);
		reading_close(alone);
	}
}

CHECK_MAIN(cmocka_unit_test(the_result_is_what_brute_force_counts),
           cmocka_unit_test(outputs_with_pounding_are_those_of_a_response),
           cmocka_unit_test(a_step_of_acceleration_needs_its_closed_form),
           cmocka_unit_test(a_suite_of_sines_needs_its_closed_forms),
           cmocka_unit_test(with_inputs_the_runs_are_those_of_the_design),
           cmocka_unit_test(a_swept_intensity_has_fragility_curves_and_rates),
           cmocka_unit_test(each_gap_of_a_row_is_that_of_its_pair),
           cmocka_unit_test(each_gap_of_a_row_is_what_brute_force_counts),
           cmocka_unit_test(levels_of_a_row_are_its_floors), cmocka_unit_test(bodies_that_yield_are_run_once))
