/* unit_suite.c - suites of recorded ground motions: which signal is which record, its factor, and the agreement of
 * document, run and result. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/ground/suite.h"
#include "engine/pound.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

static const double PI = 3.14159265358979323846;

/* ---- documents ---- */

#define SCENE \
	"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 2}], "

/* Three records: half sines of 1 s with peaks 1, 2 and 4 m/s2; the second has twice the sample step. */
static char *document(const char *members)
{
	char *text = NULL;
	size_t n;
	FILE *out = open_memstream(&text, &n);
	assert_non_null(out);
	fprintf(out, SCENE "\"excitation\": {\"type\": \"suite\", %s\"records\": [", members);
	for (int k = 0; k < 3; k++) {
		const int steps = k == 1 ? 50 : 100;
		fprintf(out, "%s{\"name\": \"r%d\", \"time_step_s\": %.2f, \"acceleration_m_s2\": [", k ? ", " : "",
		        k, 1.0 / steps);
		for (int i = 0; i <= steps; i++)
			fprintf(out, "%s%.17g", i ? ", " : "", (1 << k) * sin(PI * i / steps));
		fprintf(out, "]%s}", k == 2 ? ", \"reversed\": true, \"factor\": 0.5" : "");
	}
	fputs("]}}}", out);
	fclose(out);
	return text;
}

static struct reading *result_of(const struct pound_study *study)
{
	struct pound_run *run = specimen_run(study);
	size_t length;
	char *json = result_to_json(study, pound_run_result(run), NULL, &length);
	assert_non_null(json);
	struct reading *result = reading_open(json, length);
	assert_non_null(result);
	free(json);
	pound_run_free(run);
	return result;
}

static struct reading *result_with(const char *members)
{
	char *text = document(members);
	struct pound_study *study = study_documents_study(text);
	struct reading *result = result_of(study);
	study_free(study);
	free(text);
	return result;
}

/* ---- factors ---- */

/* For records with peaks of 1, 2 and 4 x 0.5 m/s2, the last one reversed. */
static void factors_are_those_of_their_definition(void **state)
{
	(void)state;
	static const struct {
		const char *members;
		double factor[3];
	} cases[] = {
	    {"", {1, 1, -0.5}},
	    {"\"factor\": 3, ", {3, 3, -1.5}},
	    {"\"scale\": {\"to\": \"none\"}, ", {1, 1, -0.5}},
	    {"\"scale\": {\"to\": \"pga\", \"intensity_m_s2\": 3}, ", {3, 1.5, -0.75}},
	    {"\"factor\": 2, \"scale\": {\"to\": \"pga\", \"intensity_m_s2\": 3}, ", {6, 3, -1.5}},
	    // spectral accelerations have the ratios 1 : 2 : 2 except for the second record's coarser samples, chords of its sine
	    {"\"scale\": {\"to\": \"median_sa\", \"intensity_m_s2\": 3, \"period_s\": 0.5}, ", {NAN, NAN, NAN}},
	};
	for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
		struct reading *result = result_with(cases[c].members);
		assert_int_equal(reading_count(result, "/signals"), 3);
		for (int k = 0; k < 3; k++) {
			const double factor = reading_number(result, "/signals/%d/factor", k);
			check_near(reading_number(result, "/signals/%d/record", k), k, 0);
			if (isfinite(cases[c].factor[k]))
				check_near(factor, cases[c].factor[k], 4 * DBL_EPSILON * fabs(factor));
			// one factor for the whole suite
			else
				check_near(factor, reading_number(result, "/signals/0/factor") * (k == 2 ? -0.5 : 1),
				           2 * DBL_EPSILON * fabs(factor));
		}
		reading_close(result);
	}
}

/* A record scaled to a spectral acceleration produces it: the left oscillator has the period and the damping of the scale. */
static void a_scaled_record_has_its_spectral_acceleration(void **state)
{
	(void)state;
	const double w = 2 * PI, sa = 3;
	struct reading
	    *each = result_with(
	        "\"scale\": {\"to\": \"sa\", \"intensity_m_s2\": 3, \"period_s\": 1, \"damping_ratio\": 0.05}, "),
	    *middle = result_with("\"scale\": {\"to\": \"median_sa\", \"intensity_m_s2\": 3, \"period_s\": 1}, ");
	int below = 0, equal = 0;
	for (int k = 0; k < 3; k++) {
		static const char at[] = "/signals/%d/oscillators/0/displacement_max_free_m";
		// rounding errors of some hundred steps
		check_near(w * w * reading_number(each, at, k), sa, 1e-12 * sa);
		const double of_suite = w * w * reading_number(middle, at, k);
		equal += fabs(of_suite - sa) <= 1e-12 * sa;
		below += of_suite < sa * (1 - 1e-12);
	}
	assert_int_equal(equal, 1);
	assert_int_equal(below, 1);
	reading_close(each);
	reading_close(middle);
}

static void factors_come_back_in_the_result(void **state)
{
	(void)state;
	struct reading *result =
	    result_with("\"directions\": \"both\", \"scale\": {\"to\": \"pga\", \"intensity_m_s2\": 3}, ");
	assert_string_equal(reading_text(result, "/suite/scale"), "pga");
	assert_int_equal(reading_count(result, "/suite/records"), 3);
	assert_int_equal(reading_count(result, "/signals"), 6);
	for (int k = 0; k < 3; k++) {
		const double peak = 1 << k, factor = k == 2 ? 0.5 : 1,
		             scaled = reading_number(result, "/suite/records/%d/factor", k);
		check_near(reading_number(result, "/suite/records/%d/pga_m_s2", k), peak, 0);
		check_near(reading_number(result, "/suite/records/%d/reference_m_s2", k), factor * peak, 0);
		check_near(scaled, 3 / peak, 2 * DBL_EPSILON * scaled);
		// as recorded, then reversed; the third is reversed from the start
		check_near(reading_number(result, "/signals/%d/factor", 2 * k), k == 2 ? -scaled : scaled, 0);
		check_near(reading_number(result, "/signals/%d/factor", 2 * k + 1), k == 2 ? scaled : -scaled, 0);
		// linear oscillators without contact: the reversed motion has equal peaks
		for (int i = 0; i < 2; i++)
			check_near(
			    reading_number(result, "/signals/%d/oscillators/%d/displacement_max_free_m", 2 * k, i),
			    reading_number(result, "/signals/%d/oscillators/%d/displacement_max_free_m", 2 * k + 1, i),
			    0);
	}
	reading_close(result);
}

/* ---- draws ---- */

static void a_drawn_record_is_any_with_the_same_probability(void **state)
{
	(void)state;
	enum { DRAWS = 60000, ALL = 6 };
	char *text = document("\"directions\": \"both\", \"draw\": 5, ");
	struct pound_study *study = study_documents_study(text);
	int count[ALL] = {0};
	assert_int_equal(study->scene.excitation.signals, 5);
	for (int i = 0; i < DRAWS; i++) {
		const struct pound_stream stream = {.seed = 42, .row = (uint32_t)i / 5, .signal = (uint32_t)i % 5};
		const struct pound_suite_signal got = pound_suite_signal(&study->scene.excitation, NULL, stream);
		count[2 * got.record + (got.factor < 0)]++;
	}
	// five standard deviations of a binomial count
	for (int k = 0; k < ALL; k++)
		check_near(count[k], DRAWS / ALL, 5 * sqrt(DRAWS / ALL * (1 - 1.0 / ALL)));
	study_free(study);
	free(text);
}

/* ---- motions, files ---- */

static void a_signal_is_its_record_times_its_factor(void **state)
{
	(void)state;
	char *text = document("\"factor\": 0.3, \"directions\": \"both\", ");
	struct pound_study *study = study_documents_study(text);
	struct pound_run *run = pound_run_create(study, 1);
	assert_non_null(run);
	for (int signal = 0; signal < 6; signal++) {
		const struct pound_place place = {.signal = signal};
		const struct pound_suite_signal of = pound_run_motion_record(run, &place);
		const struct pound_record *record = &study->scene.excitation.records[of.record];
		double step, a[101];
		assert_int_equal(of.record, signal / 2);
		assert_int_equal(pound_run_motion_samples(run, &place, &step), record->n);
		check_near(step, record->time_step, 0);
		pound_run_motion(run, &place, a);
		for (int i = 0; i < record->n; i++)
			check_near(a[i], of.factor * record->a[i], 0);
	}
	pound_run_free(run);
	study_free(study);
	free(text);
}

/* A record of a suite gives the same results as the same excitation of type record. */
static void a_record_of_a_suite_gives_what_it_gives_alone(void **state)
{
	(void)state;
#define BESIDE  SCENE "\"contact\": {\"gap_m\": 0.001}, \"excitation\": "
#define SAMPLES "\"time_step_s\": 0.1, \"acceleration_m_s2\": [0, 1, -2, 1.5, 0.5, -1, 0]"
	static const char one[] = BESIDE "{\"type\": \"record\", " SAMPLES "}}}",
	                  suite[] = BESIDE "{\"type\": \"suite\", \"records\": [{" SAMPLES "}]}}}";
	struct pound_study *studies[] = {study_documents_study(one), study_documents_study(suite)};
	struct reading *results[] = {result_of(studies[0]), result_of(studies[1])};
	static const char *const numbers[] = {
	    "/signals/0/oscillators/0/displacement_max_m", "/signals/0/oscillators/1/force_max_n",
	    "/signals/0/impulse_max_n_s", "/signals/0/end/u1_m", "/signals/0/end/v2_m_s"};
	for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
		const double want = reading_number(results[0], numbers[k]);
		assert_true(want != 0);
		check_near(reading_number(results[1], numbers[k]), want, 0);
	}
	for (int k = 0; k < 2; k++) {
		reading_close(results[k]);
		study_free(studies[k]);
	}
}

static char *record_file(const void *with, const struct study_source *of, size_t *length,
                         char why[STUDY_WHY_SIZE])
{
	const char *name = of->file ? of->file : of->sha256;
	char path[256];
	snprintf(path, sizeof path, "%s/%s", (const char *)with, name);
	snprintf(why, STUDY_WHY_SIZE, "cannot be read");
	return program_file(path, length);
}

static void files_and_their_samples_are_the_same_study(void **state)
{
	(void)state;
	static const char text[] = SCENE "\"excitation\": {\"type\": \"suite\", \"records\": ["
	                                 "{\"file\": \"nga_west2.AT2\", \"factor\": 0.1}, {\"time_step_s\": 0.3, "
	                                 "\"acceleration_m_s2\": [0.1, 0.3]}, "
	                                 "{\"file\": \"three_channels.V2c\", \"channel\": 2, \"reversed\": true, "
	                                 "\"name\": \"\\u00e9 \\\"\"}]}}}";
	const struct study_files files = {.read = record_file, .with = "tests/cases/records"};
	const struct study_document document = {.text = text, .length = strlen(text), .files = &files};
	struct problems problems;
	assert_true(study_names_files(text, strlen(text)));
	struct pound_study *study = study_from_document(&document, &problems);
	if (!study)
		fail_msg("%s: %s", problems.list[0].pointer, problems.list[0].detail);
	size_t length;
	char *whole = study_inline(&document, study, &length), hash[2][STUDY_HASH_SIZE];
	assert_non_null(whole);
	assert_false(study_names_files(whole, length));
	struct pound_study *again = study_from_json(whole, length, &problems);
	assert_non_null(again);
	assert_true(study_hash(study, hash[0]) && study_hash(again, hash[1]));
	assert_string_equal(hash[0], hash[1]);
	for (int k = 0; k < 3; k++) {
		const struct pound_record *a = &study->scene.excitation.records[k],
		                          *b = &again->scene.excitation.records[k];
		assert_int_equal(a->n, b->n);
		assert_memory_equal(a->a, b->a, sizeof *a->a * (size_t)a->n);
		assert_true(a->time_step == b->time_step && a->factor == b->factor && a->reversed == b->reversed);
	}
	assert_string_equal(again->scene.excitation.records[2].name, "\u00e9 \"");
	study_free(study);
	study_free(again);
	free(whole);
	// refused without a reader of files
	assert_null(study_from_json(text, strlen(text), &problems));
	assert_int_equal(problems.n, 2);
	assert_string_equal(problems.list[0].pointer, "/scene/excitation/records/0/file");
}

static void a_file_is_known_by_its_hash(void **state)
{
	(void)state;
	static const char text[] = SCENE "\"excitation\": {\"type\": \"suite\", \"records\": ["
	                                 "{\"file\": \"esm.ASC\", \"reversed\": true}, "
	                                 "{\"time_step_s\": 0.3, \"acceleration_m_s2\": [0.1, 0.3]}]}}}",
	                  hash[] = "e9995d64fa82210428f6e1ce07f0c3c94da3e0a92533dd012e675c04a252638b";
	const struct study_files files = {.read = record_file, .with = "tests/cases/records"};
	const struct study_document document = {.text = text, .length = strlen(text), .files = &files};
	struct problems problems;
	struct pound_study *study = study_from_document(&document, &problems);
	assert_non_null(study);
	assert_string_equal(study_source_of(study, 0)->file, "esm.ASC");
	assert_string_equal(study_source_of(study, 0)->sha256, hash);
	assert_null(study_source_of(study, 1));
	size_t length;
	char *named = study_name_hashes(&document, study, &length);
	assert_non_null(named);
	struct reading *read = reading_open(named, length);
	assert_string_equal(reading_text(read, "/scene/excitation/records/0/sha256"), hash);
	assert_string_equal(reading_text(read, "/scene/excitation/records/0/file"), "esm.ASC");
	assert_int_equal(reading_count(read, "/scene/excitation/records/1/acceleration_m_s2"), 2);
	assert_null(reading_text(read, "/scene/excitation/records/1/sha256"));
	reading_close(read);
	study_free(study);
	// with its hash it is the same study; with another hash it is refused
	study = study_from_document(&(struct study_document){.text = named, .length = length, .files = &files},
	                            &problems);
	assert_non_null(study);
	study_free(study);
	*strstr(named, hash) ^= 1;
	assert_null(study_from_document(
	    &(struct study_document){.text = named, .length = length, .files = &files}, &problems));
	assert_string_equal(problems.list[0].pointer, "/scene/excitation/records/0/sha256");
	free(named);
}

/* Oscillators at the frequency of a sine with 10 samples per cycle: interpolation multiplies the sine by sinc^2. */
static void the_cost_of_linear_interpolation_is_that_of_its_closed_form(void **state)
{
	(void)state;
	enum { CYCLES = 60, PER_CYCLE = 10 };
	char *text = NULL;
	size_t n;
	FILE *out = open_memstream(&text, &n);
	assert_non_null(out);
	fputs(
	    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, "
	    "{\"rigid_wall\": true}], \"excitation\": {\"type\": \"suite\", \"records\": [{\"time_step_s\": 0.1, "
	    "\"acceleration_m_s2\": [",
	    out);
	for (int i = 0; i <= CYCLES * PER_CYCLE; i++)
		fprintf(out, "%s%.17g", i ? ", " : "", sin(2 * PI * i / PER_CYCLE));
	fputs("]}]}}}", out);
	fclose(out);
	struct pound_study *study = study_documents_study(text);
	struct reading *result = result_of(study);
	const double want = cos(PI / 20) * cos(PI / 20) - 1;
	// the images of the sine at 9 and 19 times its frequency move the oscillator by 2e-5 of its amplitude
	check_near(reading_number(result, "/suite/records/0/interpolation_difference"), want, 1e-4);
	reading_close(result);
	study_free(study);
	free(text);
}

CHECK_MAIN(cmocka_unit_test(the_cost_of_linear_interpolation_is_that_of_its_closed_form),
           cmocka_unit_test(factors_are_those_of_their_definition),
           cmocka_unit_test(a_scaled_record_has_its_spectral_acceleration),
           cmocka_unit_test(factors_come_back_in_the_result),
           cmocka_unit_test(a_drawn_record_is_any_with_the_same_probability),
           cmocka_unit_test(a_signal_is_its_record_times_its_factor),
           cmocka_unit_test(a_record_of_a_suite_gives_what_it_gives_alone),
           cmocka_unit_test(a_file_is_known_by_its_hash),
           cmocka_unit_test(files_and_their_samples_are_the_same_study))
