/* unit_report.c - a result as one HTML page: the page is complete, loads nothing, and names remain text. */
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/figure/report.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/result/widest_interval.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

/* A result of a study document, and its histories if it has any. */
static struct figure_source result_of(const char *document)
{
	struct figure_source source = {0};
	const struct timing timing = {1, 1, 1};
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = specimen_run(study);
	source.json = result_to_json(study, pound_run_result(run), &timing, &source.length);
	if (histories_exist(study))
		source.samples = histories_to_csv(study, run, -1, &source.n_samples, &(const char *){NULL});
	pound_run_free(run);
	study_free(study);
	assert_non_null(source.json);
	return source;
}

static void source_free(struct figure_source *source)
{
	free((char *)source->json);
	free((char *)source->samples);
}

static int count(const char *text, const char *word)
{
	int n = 0;
	for (; (text = strstr(text, word)); text++)
		n++;
	return n;
}

/* Fails unless every element is closed, and nothing is loaded from elsewhere. */
static void check_page(const char *page)
{
	static const char *const pairs[][2] = {
	    {"<table>", "</table>"}, {"<tr>", "</tr>"},           {"<svg ", "</svg>"},
	    {"<ul>", "</ul>"},       {"<details>", "</details>"}, {"<figure ", "</figure>"},
	    {"<li>", "</li>"},       {"<pre", "</pre>"},          {"<td", "</td>"}};
	static const char *const none[] = {"<script", " src=", "href", "url(", "@import", "onload", "<iframe"};
	assert_int_equal(strncmp(page, "<!DOCTYPE html>\n<html lang=\"en\">", 32), 0);
	assert_non_null(strstr(page, "content=\"default-src 'none'; style-src 'unsafe-inline'\""));
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
		assert_int_equal(count(page, pairs[i][0]), count(page, pairs[i][1]));
	for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
		if (strstr(page, none[i]))
			fail_msg("the page has %s", none[i]);
}

static void a_report_has_every_figure_table_note_and_what_was_left_out(void **state)
{
	static const char *const names[] = {"sensitivity_small", "until",          "paper_linear",
	                                    "floor_spectrum",    "response_sweep", "convergence"};
	int narrower = 0; /* results in which the interval from all rows is not the narrowest */
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		size_t n;
		int figures = 0;
		const char *document = example_text(names[i]);
		struct figure_source source = result_of(document);
		char *page = report_html(&source, document, strlen(document), &n);
		struct reading *result = reading_open(source.json, source.length);
		assert_non_null(page);
		assert_int_equal(strlen(page), n);
		check_page(page);
		for (const struct figure_row *row = figure_rows; row->name; row++)
			if (figure_has(row, &source)) {
				assert_non_null(strstr(page, row->text));
				figures++;
			}
		assert_int_equal(count(page, "<figure "), figures);
		assert_true(count(page, "<table>") >= 3);
		for (int k = 0; k < reading_count(result, "/work/left_out"); k++)
			assert_non_null(strstr(page, reading_text(result, "/work/left_out/%d", k)));
		if (reading_text(result, "/accuracy/note"))
			assert_non_null(strstr(page, reading_text(result, "/accuracy/note")));
		struct widest_interval widest;
		widest_interval_find(result, &widest);
		const char *item = strstr(page, widest.narrower);
		assert_true(!*widest.narrower || (item && strncmp(item - 4, "<li>", 4) == 0));
		narrower += *widest.narrower != 0;
		// every table scrolls in its own box
		assert_int_equal(count(page, "<div class=\"wide\""), count(page, "<table>"));
		assert_non_null(strstr(page, "&quot;kind&quot;: &quot;"));
		reading_close(result);
		free(page);
		source_free(&source);
	}
	assert_true(narrower > 0);
}

static void a_report_of_a_swept_study_has_the_indices_of_each_cell(void **state)
{
	size_t n;
	char *document = study_documents_with(
	    example_text("sensitivity_small"), "\"design\"",
	    "\"sweep\": [{\"path\": \"/oscillators/0/frequency_hz\", \"values\": [1, 2, 4]}], \"design\"");
	struct figure_source source = result_of(document);
	char *page = report_html(&source, NULL, 0, &n);
	(void)state;
	check_page(page);
	assert_int_equal(count(page, "<figure "), 1 + 3);
	assert_non_null(strstr(page, "<summary>cell 2: left frequency 4 Hz</summary>"));
	assert_non_null(strstr(page, "It was not given"));
	free(page);
	source_free(&source);
	free(document);
}

/* For a row of buildings each contact has its own gap, and runs that were not computed are not counted. */
static void a_report_of_a_row_has_the_gap_of_each_contact(void **state)
{
	size_t n;
	(void)state;
	struct figure_source source = result_of(example_text("separation_row"));
	char *page = report_html(&source, NULL, 0, &n);
	assert_non_null(page);
	check_page(page);
	assert_non_null(strstr(page, "contact 0, levels 4 and 4.8 of buildings 0 and 1"));
	assert_non_null(strstr(page, "contact 1, levels 5.5 and 5 of buildings 1 and 2"));
	assert_null(strstr(page, "responses with pounding</th><td"));
	free(page);
	source_free(&source);
}

/* Every table that names an output names its building and story. */
static void a_report_says_of_which_place_a_row_of_a_table_is(void **state)
{
	static const char result[] =
	    "{\"kind\": \"sensitivity\", \"engine_version\": \"1\", \"cells\": [{\"outputs\": [{\"name\": "
	    "\"peak_drift_m\", \"contact\": 3, \"building\": 1, \"storey\": 2, \"mean\": 5, \"variance\": 6, "
	    "\"inputs\": "
	    "[{\"name\": "
	    "\"a\", \"S1\": 0.5}], \"groups\": [{\"name\": \"g\", \"S1\": 0.25}]}]}]}";
	size_t n;
	(void)state;
	char *page =
	    report_html(&(struct figure_source){.json = result, .length = sizeof result - 1}, NULL, 0, &n);
	assert_non_null(page);
	assert_int_equal(count(page, ">output.contact</th><th scope=\"col\">output.building</th><th "
	                             "scope=\"col\">output.storey</th>"),
	                 3); // inputs, groups and outputs
	assert_int_equal(count(page, "<td>peak_drift_m</td><td>3</td><td>1</td><td>2</td>"), 3);
	assert_int_equal(count(page, "<td>peak_drift_m</td><td>3</td><td>1</td><td>2</td><td>5</td></tr>"), 1);
	assert_null(strstr(page, "output.variance"));
	free(page);
}

static void warnings_are_said_first(void **state)
{
	size_t n;
	char *document = study_documents_with(example_text("response"), "\"gap_m\": 0", "\"gap_m\": 9");
	struct figure_source source = result_of(document);
	char *page = report_html(&source, document, strlen(document), &n);
	(void)state;
	check_page(page);
	const char *warning =
	    strstr(page, "<h2>Warnings</h2>\n<ul>\n<li>/scene/contact/gap_m: no run has a contact</li>");
	assert_non_null(warning);
	assert_true(warning < strstr(page, "<h2>Figures</h2>"));
	free(page);
	source_free(&source);
	free(document);
}

static void a_hostile_name_stays_text(void **state)
{
	size_t n;
	char *document =
	    study_documents_with(example_text("sensitivity_small"), "f_2", "</td><script>alert(1)</script>\\\"&");
	struct figure_source source = result_of(document);
	char *page = report_html(&source, document, strlen(document), &n);
	(void)state;
	check_page(page);
	assert_non_null(strstr(page, "<td>&lt;/td&gt;&lt;script&gt;alert(1)&lt;/script&gt;&quot;&amp;</td>"));
	free(page);
	source_free(&source);
	free(document);
}

static void what_is_no_result_has_no_report(void **state)
{
	size_t n;
	(void)state;
	static const char *const texts[] = {
	    "", "{", "[]", "{}", "{\"kind\": 1}", "null", "{\"kind\": \"response\", \"scene\": {}}"};
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
		assert_null(
		    report_html(&(struct figure_source){.json = texts[i], .length = strlen(texts[i])}, NULL, 0, &n));
}

CHECK_MAIN(cmocka_unit_test(a_report_has_every_figure_table_note_and_what_was_left_out),
           cmocka_unit_test(a_report_of_a_swept_study_has_the_indices_of_each_cell),
           cmocka_unit_test(a_report_of_a_row_has_the_gap_of_each_contact),
           cmocka_unit_test(a_report_says_of_which_place_a_row_of_a_table_is),
           cmocka_unit_test(warnings_are_said_first), cmocka_unit_test(a_hostile_name_stays_text),
           cmocka_unit_test(what_is_no_result_has_no_report))
