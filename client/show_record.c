/* show_record.c - `pound record`: contents of files of recorded ground motions. */
#include "client/command.h"
#include "client/document.h"
#include "client/table.h"
#include "engine/pound.h"
#include "schema/json/json_writer.h"
#include "schema/record/record.h"
#include "schema/result/motion_spectrum.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* a file: one row of the table */
struct shown {
	const char *path;
	struct record record;
	struct pound_motion_measures measures;
	double *psa;  /* pseudo-accelerations at the requested periods [m/s2]  (n_periods) */
	double *fine; /* pseudo-accelerations with band-limited interpolation to twice the sampling rate [m/s2] */
};

static double samples(const struct shown *shown)
{
	return shown->record.n;
}

static double step(const struct shown *shown)
{
	return shown->record.step;
}

static double length(const struct shown *shown)
{
	return (shown->record.n - 1) * shown->record.step;
}

static double pga(const struct shown *shown)
{
	return shown->measures.pga;
}

static double pgv(const struct shown *shown)
{
	return shown->measures.pgv;
}

static double pgd(const struct shown *shown)
{
	return shown->measures.pgd;
}

static double arias(const struct shown *shown)
{
	return shown->measures.arias;
}

static double significant(const struct shown *shown)
{
	return shown->measures.duration;
}

/* Columns besides path, format, unit and title. */
static const struct {
	const char *name;
	double (*value)(const struct shown *shown);
} columns[] = {
    {"samples", samples}, {"step_s", step}, {"length_s", length}, {"pga_m_s2", pga},
    {"pgv_m_s", pgv},     {"pgd_m", pgd},   {"arias_m_s", arias}, {"d5_95_s", significant},
};

enum { COLUMNS = sizeof columns / sizeof columns[0] };

static enum outcome read_file(const struct options *options, struct shown *shown)
{
	size_t n;
	struct problems problems;
	const struct record_choice choice = {
	    .unit = options->unit, .step = options->step, .channel = options->channel};
	char *text = document_read(shown->path, &n);
	if (!text)
		return OUTCOME_FAILED;
	const bool good = record_read(text, n, &choice, &shown->record, &problems);
	free(text);
	if (!good)
		return document_reject(shown->path, &problems);
	pound_motion_measure(shown->record.n, shown->record.acceleration, shown->record.step, &shown->measures);
	return OUTCOME_OK;
}

/* Relative error of the pseudo-acceleration due to linear interpolation between samples, defined as in the result of a suite. */
static double interpolation(const struct shown *shown, int k)
{
	return shown->fine[k] > 0 ? shown->psa[k] / shown->fine[k] - 1 : 0;
}

static void print_json(int n, const struct shown *shown, const struct periods *periods)
{
	struct writer w;
	size_t length;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_array(&w, "records", WRITER_LINES);
	for (int i = 0; i < n; i++) {
		writer_object(&w, NULL, WRITER_LINES);
		writer_text(&w, "file", shown[i].path);
		writer_text(&w, "format", shown[i].record.format);
		writer_text(&w, "unit", shown[i].record.unit);
		writer_text(&w, "title", shown[i].record.title);
		for (int c = 0; c < COLUMNS; c++)
			writer_number(&w, columns[c].name, columns[c].value(&shown[i]));
		writer_array(&w, "spectrum", WRITER_LINES);
		for (int k = 0; k < periods->n; k++) {
			writer_object(&w, NULL, WRITER_LINE);
			writer_number(&w, "period_s", periods->period[k]);
			writer_number(&w, "damping_ratio", motion_spectrum_damping);
			writer_number(&w, "psa_m_s2", shown[i].psa[k]);
			writer_number(&w, "interpolation_difference", interpolation(&shown[i], k));
			writer_end(&w);
		}
		writer_end(&w);
		writer_end(&w);
	}
	writer_end(&w);
	writer_end(&w);
	char *json = command_sure(writer_take(&w, &length));
	fwrite(json, 1, length, stdout);
	free(json);
}

/* One row for each file; with periods, a second table of pseudo-accelerations, a row for each file and period. */
static void print_tables(int n, const struct shown *shown, const struct periods *periods, bool csv)
{
	const char *names[COLUMNS + 4] = {"file", "format", "unit"};
	for (int c = 0; c < COLUMNS; c++)
		names[3 + c] = columns[c].name;
	struct table *table = table_open(1, periods->n ? (const char *const[]){"file", "period_s", "psa_m_s2",
	                                                                       "interpolation_difference", NULL}
	                                               : names);
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < periods->n; k++) {
			table_text(table, shown[i].path);
			table_number(table, periods->period[k]);
			table_number(table, shown[i].psa[k]);
			table_number(table, interpolation(&shown[i], k));
		}
		if (periods->n)
			continue;
		table_text(table, shown[i].path);
		table_text(table, shown[i].record.format);
		table_text(table, shown[i].record.unit);
		for (int c = 0; c < COLUMNS; c++)
			table_number(table, columns[c].value(&shown[i]));
	}
	if (csv)
		table_print_csv(table);
	else
		table_print(table, 0);
	table_close(table);
}

/* Reads a file and computes its spectra; reports errors on stderr. */
static enum outcome take_file(const struct options *options, const struct periods *periods,
                              struct shown *shown)
{
	const enum outcome read = read_file(options, shown);
	shown->psa = command_sure(calloc((size_t)periods->n + 1, sizeof *shown->psa));
	shown->fine = command_sure(calloc((size_t)periods->n + 1, sizeof *shown->fine));
	if (read == OUTCOME_OK && periods->n &&
	    (motion_spectrum(&shown->record, periods, shown->psa) != POUND_OK ||
	     motion_spectrum_finer(&shown->record, periods, shown->fine) != POUND_OK)) {
		command_complain("%s: the response spectrum cannot be computed", shown->path);
		return OUTCOME_FAILED;
	}
	return read;
}

static void free_file(struct shown *shown)
{
	record_free(&shown->record);
	free(shown->psa);
	free(shown->fine);
}

/* `pound record FILE...`: format, motion measures, and with --periods the response spectrum of each file.  Invalid files are reported
 * on stderr, and the others shown.
 *
 * Returns  value   OUTCOME_USAGE: a file is not a valid record
 * Test     client_record: files_are_shown_with_their_measures
 */
enum outcome record_show(const struct options *options)
{
	struct periods periods;
	if (!motion_spectrum_periods(options->periods, &periods)) {
		command_complain("--periods takes %s, got '%s'", motion_spectrum_expected, options->periods);
		return OUTCOME_USAGE;
	}
	struct shown *shown = command_sure(calloc((size_t)options->n_files, sizeof *shown));
	enum outcome outcome = OUTCOME_OK;
	int n = 0;
	for (int i = 0; i < options->n_files; i++) {
		shown[n] = (struct shown){.path = options->files[i]};
		const enum outcome taken = take_file(options, &periods, &shown[n]);
		outcome = taken == OUTCOME_OK ? outcome : taken;
		if (taken == OUTCOME_OK)
			n++;
		else
			free_file(&shown[n]);
	}
	if (n > 0 && strcmp(options->format, "json") == 0)
		print_json(n, shown, &periods);
	else if (n > 0)
		print_tables(n, shown, &periods, strcmp(options->format, "csv") == 0);
	if (outcome != OUTCOME_OK && options->n_files > 1)
		command_complain("%d of %d files are not shown", options->n_files - n, options->n_files);
	for (int i = 0; i < n; i++)
		free_file(&shown[i]);
	free(shown);
	return outcome;
}
