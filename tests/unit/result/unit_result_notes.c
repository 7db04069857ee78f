/* unit_result_notes.c - notes on estimates agree with the numbers, and every estimate that needs a note has one. */
#include <math.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/result/result_notes.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

/* The note on one estimate; NULL: there is none.  Free it with reading_close. */
static struct reading *noted(struct pound_estimate estimate, struct result_notes_source source)
{
	struct result_notes notes;
	result_notes_init(&notes);
	struct writer w;
	size_t length;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINE);
	result_notes_add(&notes, "ST", &estimate, source);
	result_notes_write(&w, &notes);
	writer_end(&w);
	char *json = writer_take(&w, &length);
	struct reading *r = reading_open(json, length);
	free(json);
	return r;
}

static void a_sentence_is_said_where_it_is_true_and_nowhere_else(void **state)
{
	(void)state;
	static const char small[] = "ST: below 0 by sampling error", above[] = "ST: above 1 by sampling error",
	                  whole[] = "ST: outside [0, 1] with its whole interval",
	                  none[] = "ST: outside [0, 1], and too few rows for an interval (use more rows)",
	                  outside[] = "ST: outside its own interval as there are too few rows",
	                  outside_lost[] =
	                      "ST: outside its own interval as the variance corrected for the signals' noise",
	                  far[] = "ST: far outside [0, 1] as there are too few rows",
	                  far_lost[] = "ST: far outside [0, 1] as the variance corrected for the signals' noise";
	static const struct {
		struct pound_estimate estimate;
		const char *plain, *lost; /* beginning of the note; NULL: there is none */
		bool large;               /* noted even if only large errors need notes */
	} cases[] = {
	    // exact, and exact except for rounding
	    {{0, 0, 0}, NULL, NULL, false},
	    {{1, 1, 1}, NULL, NULL, false},
	    {{-1e-16, -1e-16, -1e-16}, NULL, NULL, false},
	    {{1 + 1e-15, 1, 1}, NULL, NULL, false},
	    // within [0, 1] and the interval
	    {{0.3, 0.2, 0.4}, NULL, NULL, false},
	    {{0.02, -0.01, 0.05}, NULL, NULL, false},
	    {{0.99, 0.97, 1.01}, NULL, NULL, false},
	    {{NAN, NAN, NAN}, NULL, NULL, false},
	    {{0.5, NAN, NAN}, NULL, NULL, false},
	    // small errors that the interval shows
	    {{-0.01, -0.05, 0.03}, small, small, false},
	    {{-0.5, -1.5, 0.9}, small, small, false},
	    {{1.02, 0.98, 1.06}, above, above, false},
	    {{-0.05, -0.08, -0.02}, whole, whole, false},
	    {{1.05, 1.01, 1.09}, whole, whole, false},
	    // an interval that does not contain its estimate, or no interval
	    {{0.5, 0.6, 0.9}, outside, outside_lost, true},
	    {{-0.5, -0.4, 0.3}, outside, outside_lost, true},
	    {{-0.01, NAN, NAN}, none, none, true},
	    // far outside [0, 1]
	    {{-422, -71, 2.8}, far, far_lost, true},
	    {{-422, -500, 2.8}, far, far_lost, true},
	    {{2.5, 0.1, 9}, far, far_lost, true},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
		for (int source = 0; source < 4; source++) {
			const bool lost = source & 1, large_only = source & 2;
			struct reading *r = noted(cases[k].estimate,
			                          (struct result_notes_source){.lost = lost, .large_only = large_only});
			const char *wanted = lost ? cases[k].lost : cases[k].plain, *note = reading_text(r, "/note");
			if (!wanted || (large_only && !cases[k].large))
				assert_null(note);
			else
				assert_ptr_equal(strstr(note, wanted), note);
			reading_close(r);
		}
}

static void estimates_of_which_the_same_is_true_share_a_sentence(void **state)
{
	(void)state;
	static const struct pound_estimate below = {-0.1, -0.3, 0.1}, far = {9, 8, 10};
	struct result_notes notes;
	result_notes_init(&notes);
	struct writer w;
	size_t length;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINE);
	result_notes_add(&notes, "S1", &below, (struct result_notes_source){0});
	result_notes_add(&notes, "ST", &far, (struct result_notes_source){0});
	result_notes_add(&notes, "S1_raw", &below, (struct result_notes_source){0});
	result_notes_write(&w, &notes);
	writer_end(&w);
	char *json = writer_take(&w, &length);
	struct reading *r = reading_open(json, length);
	assert_string_equal(
	    reading_text(r, "/note"),
	    "ST: far outside [0, 1] as there are too few rows to estimate the variance (use more rows); "
	    "S1, S1_raw: below "
	    "0 by sampling error, so the index is between 0 and the upper end of its interval");
	reading_close(r);
	free(json);
}

/* ---- results from few rows with large noise ---- */

/* The sentence of a note about an estimate by name, or "". */
static const char *sentence_about(const char *note, const char *name)
{
	static char sentence[400];
	for (const char *from = note, *end; from && *from; from = *end ? end + 2 : end) {
		end = strstr(from, "; ");
		end = end ? end : from + strlen(from);
		snprintf(sentence, sizeof sentence, ", %.*s", (int)(end - from), from);
		char *colon = strchr(sentence, ':'), first[64], last[64];
		*colon = 0;
		snprintf(first, sizeof first, ", %s,", name);
		snprintf(last, sizeof last, ", %s", name);
		const size_t n = strlen(sentence), m = strlen(last);
		if (strstr(sentence, first) || (n >= m && strcmp(sentence + n - m, last) == 0))
			return colon + 1;
	}
	return "";
}

static void check_sentence(const char *note, const char *name, double value, double low, double high)
{
	const char *said = sentence_about(note, name);
	const bool far = value < -1 || value > 2, outside = value < low - 1e-9 || value > high + 1e-9;
	assert_int_equal(strstr(said, "far outside") != NULL, far);
	assert_int_equal(strstr(said, "outside its own interval") != NULL, outside && !far);
	if (strstr(said, "by sampling error"))
		assert_true((value < 0 && high >= 0) || (value > 1 && low <= 1));
	if (value < -1e-9 || value > 1 + 1e-9)
		assert_true(*said);
	if (value >= low && value <= high && value >= 0 && value <= 1)
		assert_true(!*said);
}

static void no_estimate_is_outside_its_interval_without_a_word(void **state)
{
	(void)state;
	static const char form[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 0.5}, "
	    "{\"frequency_hz\": 2}], \"excitation\": {\"type\": \"kanai_tajimi\", \"cycles\": 5, \"signals\": "
	    "2}}, "
	    "\"inputs\": [{\"path\": \"/oscillators/1/mass_kg\", \"distribution\": {\"type\": "
	    "\"reciprocal_uniform\", \"max\": 6}}, {\"path\": \"/contact/restitution\", \"distribution\": "
	    "{\"type\": \"uniform\", \"min\": 0, \"max\": 1}}], \"design\": {\"method\": \"%s\", \"rows\": 16, "
	    "\"signals\": \"independent\", \"seed\": %d}, \"outputs\": [\"force_amplification\", \"impulse\"]}";
	static const char *const columns[] = {"S1",     "ST",     "S1_pick_freeze", "ST_pick_freeze",
	                                      "S1_raw", "ST_raw", "shapley"};
	int n_far = 0, n_outside = 0;
	for (int seed = 0; seed < 40; seed++) {
		char document[1024];
		snprintf(document, sizeof document, form, seed % 2 ? "lhs" : "random", seed);
		struct pound_study *study = study_documents_study(document);
		struct pound_run *run = specimen_run(study);
		static const struct timing timing = {0, 0, 1};
		size_t length;
		char *json = result_to_json(study, pound_run_result(run), &timing, &length);
		struct reading *r = reading_open(json, length);
		for (int k = 0; k < 2 * 2 * 7; k++) {
			char at[64];
			const char *name = columns[k / 4];
			snprintf(at, sizeof at, "/cells/0/outputs/%d/inputs/%d", k % 2, k / 2 % 2);
			const double value = reading_number(r, "%s/%s", at, name);
			const double low = reading_number(r, "%s/%s_low", at, name);
			const double high = reading_number(r, "%s/%s_high", at, name);
			if (isnan(value))
				continue;
			check_sentence(reading_text(r, "%s/note", at), name, value, low, high);
			n_far += value < -1 || value > 2;
			n_outside += value < low || value > high;
		}
		reading_close(r);
		free(json);
		pound_run_free(run);
		study_free(study);
	}
	check_report(
	    "estimates below -1 or above 2: %d, outside their intervals: %d, each with a note of the cause",
	    n_far, n_outside);
	assert_true(n_far > 0 && n_outside > 0);
}

CHECK_MAIN(cmocka_unit_test(a_sentence_is_said_where_it_is_true_and_nowhere_else),
           cmocka_unit_test(estimates_of_which_the_same_is_true_share_a_sentence),
           cmocka_unit_test(no_estimate_is_outside_its_interval_without_a_word))
