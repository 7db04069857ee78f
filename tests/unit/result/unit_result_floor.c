/* unit_result_floor.c - results with floor spectra, as JSON and as CSV. */
#include <math.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

enum { N = 9 };

static const char *const names[] = {"pounding",   "impact_only", "free",
                                    "dirac_line", "dirac_train", "dirac_peaks"};

/* A made-up result of study_documents_floor: row r, frequency k has the mean 100 r + k, a peak at k = 4. */
static char *made_up(struct pound_study *study, size_t *length)
{
	static double numbers[POUND_N_SPECTRA][4][N];
	static struct pound_cell cell;
	struct pound_result result = {.n_cells = 1, .cells = &cell};
	for (int r = 0; r < POUND_N_SPECTRA; r++) {
		for (int k = 0; k < N; k++) {
			numbers[r][0][k] = 100 * r + k + (k == 4 ? 10 : 0);
			numbers[r][1][k] = numbers[r][0][k] - 0.5;
			numbers[r][2][k] = k ? numbers[r][0][k] + 0.5 : NAN;
			numbers[r][3][k] = 1e-12 * k;
		}
		result.floor.spectra[r] =
		    (struct pound_floor_spectrum){numbers[r][0], numbers[r][1], numbers[r][2], numbers[r][3]};
	}
	result.floor.frequency_hz = 2;
	result.floor.signals = 3;
	result.floor.signals_failed = 1;
	result.floor.signals_checked = 2;
	const struct timing timing = {1, 1, 1};
	return result_to_json(study, &result, &timing, length);
}

static void every_spectrum_has_a_number_for_every_frequency(void **state)
{
	(void)state;
	size_t length;
	struct pound_study *study = study_documents_study(study_documents_floor);
	char *json = made_up(study, &length);
	struct reading *r = reading_open(json, length);
	assert_string_equal(reading_text(r, "/kind"), "floor_spectrum");
	assert_int_equal(reading_count(r, "/frequencies_hz"), N);
	check_near(reading_number(r, "/frequencies_hz/4"), 5, 1e-14);
	check_near(reading_number(r, "/damping_ratio"), 0.02, 0);
	check_near(reading_number(r, "/runs"), 3, 0);
	check_near(reading_number(r, "/runs_failed"), 1, 0);
	assert_string_equal(reading_text(r, "/note"), "failed runs are left out of the spectra and their "
	                                              "histories may end early; work.failures has the reasons");
	assert_int_equal(reading_count(r, "/spectra"), POUND_N_SPECTRA);
	for (int row = 0; row < POUND_N_SPECTRA; row++) {
		assert_string_equal(reading_text(r, "/spectra/%d/name", row), names[row]);
		assert_int_equal(reading_count(r, "/spectra/%d/mean_m_s2", row), N);
		check_near(reading_number(r, "/spectra/%d/mean_m_s2/3", row), 100 * row + 3, 0);
		check_near(reading_number(r, "/spectra/%d/p16_m_s2/3", row), 100 * row + 2.5, 0);
		assert_true(isnan(reading_number(r, "/spectra/%d/p84_m_s2/0", row)));
	}
	assert_int_equal(reading_count(r, "/peaks"), 1);
	check_near(reading_number(r, "/peaks/0/frequency_ratio"), 2.5, 1e-14);
	check_near(reading_number(r, "/peaks/0/ratio"), 14.0 / 514, 1e-15);
	check_near(reading_number(r, "/accuracy/signals_checked"), 2, 0);
	assert_int_equal(reading_count(r, "/accuracy/spectra"), 3);
	check_near(reading_number(r, "/accuracy/spectra/2/relative_error_max"), 8e-12, 0);
	check_near(reading_number(r, "/accuracy/spectra/2/relative_error/5"), 5e-12, 0);
	reading_close(r);
	free(json);
	study_free(study);
}

static void a_csv_row_for_every_frequency(void **state)
{
	(void)state;
	size_t length, csv_length;
	struct pound_study *study = study_documents_study(study_documents_floor);
	char *json = made_up(study, &length), *csv = result_to_csv(json, length, NULL, &csv_length), *at = csv;
	assert_memory_equal(
	    csv, "frequency_hz,pounding.mean_m_s2,pounding.p16_m_s2,pounding.p84_m_s2,impact_only.mean", 80);
	at = strstr(csv, "\r\n") + 2;
	assert_memory_equal(at, "0.5,0,-0.5,,100,99.5,,200,", 26);
	int lines = 0;
	for (; *at; at = strstr(at, "\r\n") + 2) {
		int commas = 0;
		for (const char *c = at; *c != '\r'; c++)
			commas += *c == ',';
		assert_int_equal(commas, 3 * POUND_N_SPECTRA + 3);
		lines++;
	}
	assert_int_equal(lines, N);
	free(csv);
	free(json);
	study_free(study);
}

static void an_ordinate_has_its_frequency_and_its_correlation_with_the_impulse(void **state)
{
	(void)state;
	char *document = study_documents_with(study_documents_sensitivity,
	                                      "\"outputs\": [\"demand_amplification\", \"impulse\"]",
	                                      "\"outputs\": [\"impulse\", \"floor_spectrum\"], \"spectrum\": "
	                                      "{\"frequencies_hz\": [2.5, 40]}");
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = specimen_run(study);
	size_t length, csv_length;
	const struct timing timing = {1, 1, 1};
	char *json = result_to_json(study, pound_run_result(run), &timing, &length);
	char *csv = result_to_csv(json, length, NULL, &csv_length);
	struct reading *r = reading_open(json, length);
	assert_int_equal(reading_count(r, "/cells/0/outputs"), 3);
	assert_string_equal(reading_text(r, "/cells/0/outputs/2/name"), "floor_spectrum");
	check_near(reading_number(r, "/cells/0/outputs/2/frequency_hz"), 40, 0);
	assert_true(isnan(reading_number(r, "/cells/0/outputs/0/frequency_hz")));
	double correlation = reading_number(r, "/cells/0/outputs/1/impulse_correlation");
	assert_true(correlation >= -1 && correlation <= 1);
	assert_true(reading_number(r, "/work/floors/run") > 0);
	assert_non_null(strstr(csv, "output.frequency_hz,output.damping_ratio,output.impulse_correlation,"));
	reading_close(r);
	free(csv);
	free(json);
	free(document);
	pound_run_free(run);
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(every_spectrum_has_a_number_for_every_frequency),
           cmocka_unit_test(a_csv_row_for_every_frequency),
           cmocka_unit_test(an_ordinate_has_its_frequency_and_its_correlation_with_the_impulse))
