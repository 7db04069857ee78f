/* unit_outputs.c - outputs that are means over the signals: each against the numbers of the single signals. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
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

static struct reading *result_of(const char *document)
{
	static const struct timing timing = {1, 1, 1};
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = pound_run_create(study, 1);
	size_t length;
	assert_non_null(run);
	assert_int_equal(specimen_compute(run), POUND_OK);
	char *json = result_to_json(study, pound_run_result(run), &timing, &length);
	struct reading *result = reading_open(json, length);
	assert_non_null(result);
	free(json);
	pound_run_free(run);
	study_free(study);
	return result;
}

/* Mean over the signals of a number of theirs. */
static double mean_of(struct reading *result, const char *measure)
{
	double sum = 0;
	for (int i = 0; i < SIGNALS; i++)
		sum += reading_number(result, "/signals/%d/%s", i, measure);
	return sum / SIGNALS;
}

/* A pair of which some signals close the gap, others do not. */
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
		struct reading *r = result_of(document);
		for (size_t k = 0; k < sizeof of_pairs / sizeof of_pairs[0]; k++) {
			char at[64];
			snprintf(at, sizeof at, "/outputs/%s", of_pairs[k].output);
			if (!law && strstr(at, "ductility"))
				continue;
			const double want = mean_of(r, of_pairs[k].measure);
			assert_true(want > 0);
			// the sums are in the same order
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

/* Bodies that touch at rest: the right one's response without pounding is run only where an output reads it. */
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
		struct reading *r = result_of(document);
		run[k] = reading_number(r, "/work/free_runs/run");
		assert_true(reading_number(r, "/cells/0/outputs/0/mean") > 0);
		assert_true(reading_number(r, "/cells/0/outputs/0/accuracy/difference_largest") < 1e-10);
		reading_close(r);
	}
	assert_true(run[0] < run[1]);
}

/* A row: outputs of a place are those of its story and floor, outputs of contacts are the largest or the sum of all. */
static void outputs_of_rows_are_means_of_the_signals(void **state)
{
	static const struct {
		const char *output, *measure;
	} of_rows[] = {
	    {"peak_displacement_m", "buildings/1/floors/0/displacement_max_m"},
	    {"peak_displacement_free_m", "buildings/1/floors/0/displacement_max_free_m"},
	    {"peak_drift_m", "buildings/1/storeys/0/drift_max_m"},
	    {"peak_drift_free_m", "buildings/1/storeys/0/drift_max_free_m"},
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
	struct reading *r = result_of(document);
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

CHECK_MAIN(cmocka_unit_test(outputs_of_pairs_are_means_of_the_signals),
           cmocka_unit_test(the_right_body_is_run_where_an_output_reads_it),
           cmocka_unit_test(outputs_of_rows_are_means_of_the_signals))
