/* report.c - a result as one HTML page.
 *
 * 1. the study, warnings and notes of the result;
 * 2. figures, for each cell if they show one cell;
 * 3. tables, from the CSV of the result;
 * 4. accuracy, runs made and runs left out, the study document. */
#include "schema/figure/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"
#include "schema/json/json.h"
#include "schema/result/result_json.h"
#include "schema/result/widest_interval.h"

enum { CELLS_MOST = 32, CELLS_OF_ALL = 4, CONTACTS_MOST = 16, NOTES_MOST = 64, COLUMNS_MOST = 128 };

struct report {
	struct writer w;
	const struct figure_source *source;
	const cJSON *result;
	bool failed;
};

static const char STYLE[] =
    ":root{color-scheme:light dark}"
    "body{font:1rem/1.5 Helvetica,Arial,sans-serif;margin:0 "
    "auto;max-width:1160px;padding:1rem;color:#14171b;background:#fff;overflow-wrap:break-word}"
    "h1{font-size:1.5rem;line-height:1.25}"
    "h2{font-size:1.2rem;margin-top:2rem}figure{margin:1rem 0;overflow-x:auto}"
    "figure svg{width:100%;min-width:44rem;height:auto;display:block}"
    "table{border-collapse:collapse;font-size:.85rem;font-variant-numeric:tabular-nums}"
    "caption{text-align:left;padding:.3rem 0}"
    "th,td{padding:.15rem .4rem;border-bottom:1px solid #dfe3e8;text-align:right}"
    "th:first-child,td:first-child,.text{text-align:left}.text{overflow-wrap:anywhere}.wide{overflow-x:auto}"
    "summary{cursor:pointer;padding:.3rem 0}"
    "pre{overflow-x:auto;background:#f3f5f7;padding:.8rem;font-size:.85rem}.muted{color:#57606a}"
    "@media screen and (prefers-color-scheme:dark){body{color:#eceff2;background:#14171b}"
    "th,td{border-color:#323941}pre{background:#1d2228}.muted{color:#9aa4af}}"
    "@media print{details:not([open])>*{display:revert}figure,tr{break-inside:avoid}"
    "h2{break-after:avoid}pre{white-space:pre-wrap}figure svg{min-width:0;max-height:85vh}}";

static void put(struct report *report, const char *html)
{
	writer_raw(&report->w, html, strlen(html));
}

static void put_text(struct report *report, const char *text)
{
	draw_escaped(&report->w, text, strlen(text));
}

/* <name>text</name> */
static void put_element(struct report *report, const char *name, const char *text)
{
	char tag[64];
	snprintf(tag, sizeof tag, "<%.30s>", name);
	put(report, tag);
	put_text(report, text);
	snprintf(tag, sizeof tag, "</%.*s>\n", (int)strcspn(name, " "), name);
	put(report, tag);
}

/* Starts a table up to its first row, in a box that scrolls on narrow pages. */
static void table_begin(struct report *report, const char *title, const char *head)
{
	put(report, "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"");
	put_text(report, title);
	put(report, "\">\n<table>\n");
	put(report, head);
}

static void table_end(struct report *report)
{
	put(report, "</tbody>\n</table>\n</div>\n");
}

/* Writes a name with blanks in place of underscores. */
static void put_words(struct report *report, const char *name)
{
	char words[80];
	snprintf(words, sizeof words, "%s", name);
	for (char *c = words; *c; c++)
		*c = *c == '_' ? ' ' : *c;
	put_text(report, words);
}

static void put_member(struct report *report, const cJSON *object, const char *name, const char *label)
{
	char text[80];
	const cJSON *value = plot_member(object, name);
	if (!cJSON_IsString(value) && !cJSON_IsNumber(value))
		return;
	put(report, "<tr><th scope=\"row\">");
	put_words(report, label);
	put(report, "</th><td class=\"text\">");
	snprintf(text, sizeof text,
	         fabs(value->valuedouble) < 1e15 && value->valuedouble == floor(value->valuedouble) ? "%.0f"
	                                                                                            : "%.4g",
	         value->valuedouble);
	put_text(report, cJSON_IsString(value) ? value->valuestring : text);
	put(report, "</td></tr>\n");
}

/* ---- the study ---- */

static void put_head(struct report *report)
{
	const cJSON *result = report->result, *timing = plot_member(result, "timing");
	const char *name = *plot_text(result, "name") ? plot_text(result, "name") : plot_text(result, "kind");
	put(report, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
	            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
	            "'unsafe-inline'\">\n<meta name=\"viewport\" content=\"width=device-width\">\n");
	put_element(report, "title", name);
	put(report, "<style>");
	put(report, STYLE);
	put(report, "</style>\n</head>\n<body>\n<main>\n");
	put_element(report, "h1", name);
	if (plot_member(result, "partial"))
		put_element(report, "p", plot_text(plot_member(result, "partial"), "note"));
	table_begin(report, "What was computed", "<caption>What was computed</caption>\n<tbody>\n");
	put_member(report, result, "kind", "kind of study");
	put_member(report, plot_member(result, "design"), "method", "design");
	put_member(report, plot_member(result, "design"), "rows", "rows");
	put_member(report, plot_member(result, "given"), "samples", "given samples");
	put_member(report, plot_member(result, "given"), "samples_missing",
	           "samples left out, a number is missing");
	// left out if no run has pounding: no output needs it, or there is no contact
	const cJSON *work = plot_member(result, "work"), *pounding = plot_member(work, "pounding_runs");
	if (plot_number(pounding, "run") > 0 || plot_number(work, "never_touching") > 0)
		put_member(report, pounding, "asked", "responses with pounding");
	put_member(report, result, "seed", "seed");
	put_member(report, timing, "cpu_s", "CPU time, s");
	put_member(report, result, "engine_version", "version of pound");
	put_member(report, result, "study_hash", "hash of the study");
	table_end(report);
}

/* ---- notes ---- */

struct notes {
	const char *text[NOTES_MOST];
	int times[NOTES_MOST], n;
};

/* Collects all notes of a result, each text once, with counts. */
static void notes_collect(const cJSON *value, struct notes *notes)
{
	const cJSON *inside;
	cJSON_ArrayForEach(inside, value)
	{
		if (cJSON_IsObject(inside) || cJSON_IsArray(inside)) {
			notes_collect(inside, notes);
			continue;
		}
		if (!inside->string || strcmp(inside->string, "note") != 0 || !cJSON_IsString(inside))
			continue;
		int k = 0;
		while (k < notes->n && strcmp(notes->text[k], inside->valuestring) != 0)
			k++;
		if (k == NOTES_MOST)
			continue;
		notes->times[k]++;
		notes->text[k] = inside->valuestring;
		notes->n += k == notes->n;
	}
}

/* Writes the warnings of the study. */
static void put_warnings(struct report *report)
{
	const cJSON *warnings = plot_member(report->result, "warnings"), *warning;
	char text[512];
	if (!plot_first(warnings))
		return;
	put(report, "<h2>Warnings</h2>\n<ul>\n");
	cJSON_ArrayForEach(warning, warnings)
	{
		snprintf(text, sizeof text, "%.200s: %.300s", plot_text(warning, "pointer"),
		         plot_text(warning, "detail"));
		put_element(report, "li", text);
	}
	put(report, "</ul>\n");
}

/* Writes the widest interval, and why an interval of fewer rows may be narrower, as list items. */
static void put_widest(struct report *report)
{
	struct widest_interval widest;
	struct reading *result = reading_open(report->source->json, report->source->length);
	if (!result) {
		report->failed = true;
		return;
	}
	widest_interval_find(result, &widest);
	if (*widest.size)
		put_element(report, "li", widest.size);
	if (*widest.narrower)
		put_element(report, "li", widest.narrower);
	reading_close(result);
}

/* Writes notes of the whole result, then notes of outputs and inputs in a closed <details>. */
static void put_notes(struct report *report)
{
	static const char *const whole[] = {"partial", "stopping", "design", "accuracy"};
	struct notes notes = {0};
	const cJSON *given = plot_member(plot_member(report->result, "given"), "notes"), *of_samples;
	notes_collect(report->result, &notes);
	if (notes.n == 0 && !plot_first(given))
		return;
	put(report, "<h2>Notes</h2>\n<ul>\n");
	cJSON_ArrayForEach(of_samples, given) if (cJSON_IsString(of_samples))
	    put_element(report, "li", of_samples->valuestring);
	for (size_t part = 0; part < sizeof whole / sizeof whole[0]; part++) {
		const char *note = plot_text(plot_member(report->result, whole[part]), "note");
		if (*note)
			put_element(report, "li", note);
		for (int k = 0; k < notes.n; k++)
			if (strcmp(notes.text[k], note) == 0)
				notes.times[k] = 0;
	}
	put_widest(report);
	put(report, "</ul>\n");
	if (notes.n == 0)
		return;
	put(report, "<details>\n<summary>notes of single outputs and inputs</summary>\n<ul>\n");
	for (int k = 0; k < notes.n; k++) {
		char times[40];
		if (notes.times[k] == 0)
			continue;
		put(report, "<li>");
		put_text(report, notes.text[k]);
		snprintf(times, sizeof times, " (%d times)", notes.times[k]);
		if (notes.times[k] > 1)
			put(report, times);
		put(report, "</li>\n");
	}
	put(report, "</ul>\n</details>\n");
}

/* ---- figures ---- */

static bool takes_cell(const struct figure_row *row)
{
	return strstr(row->takes, " cell ") != NULL;
}

/* Number of contacts with gaps needed in a row of buildings, each with its own figures; 1: the figure has no argument contact. */
static int contacts_of(const struct report *report, const struct figure_row *row)
{
	const cJSON *cell = plot_first(plot_member(report->result, "cells"));
	const int n = cJSON_GetArraySize(plot_member(cell, "contacts"));
	const bool chosen = strstr(row->takes, " contact ") && strcmp(row->kind, "separation") == 0 && n > 0;
	return !chosen ? 1 : n < CONTACTS_MOST ? n : CONTACTS_MOST;
}

static void put_figure(struct report *report, const struct figure_row *row, int cell, int contact)
{
	char number[16], place[16];
	struct figure figure;
	snprintf(number, sizeof number, "%d", cell);
	snprintf(place, sizeof place, "%d", contact);
	// at this width its text is 6 points in print, and not larger than the page's text on a screen
	const struct figure_choice choice = {.cell = takes_cell(row) && cell > 0 ? number : NULL,
	                                     .contact = contact > 0 ? place : NULL,
	                                     .width = "960"};
	enum figure_status status = figure_of(row, report->result, report->source, &choice, &figure);
	report->failed = report->failed || status == FIGURE_NOMEM;
	if (status != FIGURE_DRAWN)
		return;
	put(report, "<figure tabindex=\"0\">\n");
	writer_raw(&report->w, figure.svg, figure.length);
	put_element(report, "figcaption class=\"muted\"", row->text);
	put(report, "</figure>\n");
	free(figure.svg);
}

/* Writes figures of the whole result, then figures of each cell; if there are many cells, only the indices of each. */
static void put_figures(struct report *report)
{
	char text[PLOT_TEXT], line[PLOT_TEXT + 80];
	const cJSON *cells = plot_member(report->result, "cells"), *cell;
	int n = cJSON_GetArraySize(cells), k = 0;
	bool alone = n <= 1 || strcmp(plot_text(report->result, "kind"), "sensitivity") != 0;
	put(report, "<h2>Figures</h2>\n");
	for (const struct figure_row *row = figure_rows; row->name; row++)
		for (int contact = 0, most = contacts_of(report, row);
		     contact < most && figure_shows(row, report->result) && (alone || !takes_cell(row)); contact++)
			put_figure(report, row, 0, contact);
	if (alone)
		return;
	cJSON_ArrayForEach(cell, cells)
	{
		if (k == CELLS_MOST)
			break;
		put(report, "<details>\n");
		snprintf(line, sizeof line, "cell %d: %s", k, plot_sweep_text(cell, 0, NULL, text));
		put_element(report, "summary", line);
		for (const struct figure_row *row = figure_rows; row->name; row++)
			if (takes_cell(row) && figure_shows(row, report->result) &&
			    (n <= CELLS_OF_ALL || strcmp(row->name, "indices") == 0))
				put_figure(report, row, k, 0);
		put(report, "</details>\n");
		k++;
	}
	if (n > CELLS_OF_ALL)
		put_element(report, "p class=\"muted\"",
		            "Not shown: further figures of single cells; pound plot draws them from the result.");
}

/* ---- tables ---- */

/* Whether a column is shown; columns for specialists are only in the CSV. */
static bool column_shown(const char *name)
{
	static const char *const hidden[] = {"_raw", "_pick_freeze", "_random_forest", "accuracy.", "partial."};
	static const char *const of_output[] = {"name", "frequency_hz", "contact", "building", "storey", "mean"};
	for (size_t k = 0; k < sizeof hidden / sizeof hidden[0]; k++)
		if (strstr(name, hidden[k]))
			return false;
	bool shown = strncmp(name, "output.", 7) != 0;
	for (size_t k = 0; k < sizeof of_output / sizeof of_output[0]; k++)
		shown |= !shown && strcmp(name + 7, of_output[k]) == 0;
	return shown;
}

static void put_cell(struct report *report, const char *text, bool head)
{
	char number[32], *end;
	double value = strtod(text, &end);
	put(report, head ? "<th scope=\"col\">" : "<td>");
	if (!head && *text && !*end && isfinite(value)) {
		snprintf(number, sizeof number, "%.5g", value);
		put(report, number);
	} else
		put_text(report, text);
	put(report, head ? "</th>" : "</td>");
}

/* Writes CSV as an HTML table. */
static void put_csv(struct report *report, const char *title, const char *csv, size_t length)
{
	const char *at = csv, *end = csv + length;
	bool shown[COLUMNS_MOST] = {false}, head = true;
	table_begin(report, title, "<thead>\n");
	while (at < end) {
		char cell[512], sign = ',';
		put(report, "<tr>");
		for (int column = 0; sign != '\r' && at < end; column++) {
			at += result_csv_cell(at, end, cell, sizeof cell, &sign);
			if (head && column < COLUMNS_MOST)
				shown[column] = column_shown(cell);
			if (column < COLUMNS_MOST && shown[column])
				put_cell(report, cell, head);
		}
		put(report, head ? "</tr>\n</thead>\n<tbody>\n" : "</tr>\n");
		head = false;
	}
	table_end(report);
}

static bool put_table(struct report *report, const char *table, const char *title)
{
	size_t n = 0;
	char *csv = result_to_csv(report->source->json, report->source->length, table, &n);
	report->failed = report->failed || !csv;
	if (csv && n > 0) {
		put(report, "<details>\n<summary>");
		put_words(report, title);
		put(report, "</summary>\n");
		put_csv(report, title, csv, n);
		put(report, "</details>\n");
	}
	free(csv);
	return n > 0;
}

/* Writes the tables with names, or the default table of a kind without such tables. */
static void put_tables(struct report *report)
{
	bool any = false;
	put(report, "<h2>Tables</h2>\n<p class=\"muted\">Numbers are rounded to five digits here, not in the "
	            "result.</p>\n");
#define X(name) any |= put_table(report, #name, #name);
	RESULT_TABLES(X)
#undef X
	if (!any)
		put_table(report, NULL, "result");
}

/* ---- accuracy, work ---- */

static void put_accuracy(struct report *report)
{
	const cJSON *accuracy = plot_member(report->result, "accuracy"), *value;
	if (!accuracy)
		return;
	put(report, "<h2>Accuracy</h2>\n");
	table_begin(report, "Accuracy", "<tbody>\n");
	cJSON_ArrayForEach(value, accuracy) if (strcmp(value->string, "note") != 0)
	    put_member(report, accuracy, value->string, value->string);
	const cJSON *errors = plot_member(accuracy, "errors");
	cJSON_ArrayForEach(value, errors)
	{
		char label[80];
		const bool least = strcmp(value->string, "excitation_low") == 0;
		snprintf(label, sizeof label, "error from %.60s", least ? "excitation, at least" : value->string);
		put_member(report, errors, value->string, label);
	}
	table_end(report);
}

static void put_work(struct report *report)
{
	const cJSON *work = plot_member(report->result, "work"), *stage, *line;
	if (!work)
		return;
	put(report, "<h2>What was computed, and what was left out</h2>\n");
	table_begin(report, "Runs requested and computed",
	            "<thead><tr><th scope=\"col\">runs</th><th scope=\"col\">requested</th>"
	            "<th scope=\"col\">computed</th></tr></thead>\n<tbody>\n");
	cJSON_ArrayForEach(stage, work)
	{
		char numbers[96];
		if (!cJSON_IsObject(stage))
			continue;
		put(report, "<tr><td>");
		put_text(report, plot_text(stage, "what"));
		snprintf(numbers, sizeof numbers, "</td><td>%.0f</td><td>%.0f</td></tr>\n",
		         plot_number(stage, "asked"), plot_number(stage, "run"));
		put(report, numbers);
	}
	table_end(report);
	put(report, "<ul>\n");
	cJSON_ArrayForEach(line, plot_member(work, "failures"))
	{
		char text[200];
		snprintf(text, sizeof text, "failed: %.0f runs: %.120s", plot_number(line, "runs"),
		         plot_text(line, "reason"));
		put_element(report, "li", text);
	}
	cJSON_ArrayForEach(line, plot_member(work, "left_out")) if (cJSON_IsString(line))
	    put_element(report, "li", line->valuestring);
	put(report, "</ul>\n");
}

static void put_study(struct report *report, const char *study, size_t n_study)
{
	// given data have no study
	if (plot_member(report->result, "given"))
		return;
	put(report, "<h2>The study document</h2>\n");
	if (!study) {
		put_element(
		    report, "p",
		    "It was not given when this report was made; `pound report RESULT STUDY.json` includes it.");
		return;
	}
	put(report, "<pre tabindex=\"0\">");
	for (const char *line = study, *end = study + n_study; line < end;) {
		size_t n = 0;
		while (line + n < end && line[n] != '\n' && line[n] != '\t')
			n++;
		draw_escaped(&report->w, line, n);
		// newline and tab: the only control characters that are kept
		if (line + n < end)
			writer_raw(&report->w, line + n, 1);
		line += n + 1;
	}
	put(report, "</pre>\n");
}

/* Writes the page of a result.
 *
 * Memory   allocates; the caller frees
 * Test     unit_report: a_report_has_every_figure_table_note_and_what_was_left_out
 */
char *report_html(const struct figure_source *source, const char *study, size_t n_study, size_t *length)
{
	struct json_fault fault;
	cJSON *result = json_parse(source->json, source->length, &fault);
	struct report report = {.source = source, .result = result};
	if (!plot_is_result(result)) {
		cJSON_Delete(result);
		return NULL;
	}
	writer_init(&report.w);
	put_head(&report);
	put_warnings(&report);
	put_notes(&report);
	put_figures(&report);
	put_tables(&report);
	put_accuracy(&report);
	put_work(&report);
	put_study(&report, study, n_study);
	put(&report, "</main>\n</body>\n</html>\n");
	cJSON_Delete(result);
	report.w.failed = report.w.failed || report.failed;
	return writer_take(&report.w, length);
}
