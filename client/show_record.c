/* show_record.c - `pound record`: what is in files of recorded ground motions. */
#include "client/command.h"
#include "client/document.h"
#include "client/table.h"
#include "engine/pound.h"
#include "schema/json/json_writer.h"
#include "schema/record/record.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PERIODS_MAX = 100 };

static const double DAMPING = 0.05, PI = 3.14159265358979323846;

/* one row of the table: a file */
struct shown {
	const char *path;
	struct record record;
	struct pound_motion_measures measures;
	double *psa; /* pseudo-accelerations at the periods asked [m/s2]  (n_periods) */
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

/* What is shown of a file besides its path, format and title. */
static const struct {
	const char *name;
	double (*value)(const struct shown *shown);
} columns[] = {
    {"samples", samples}, {"step_s", step}, {"length_s", length}, {"pga_m_s2", pga},
    {"pgv_m_s", pgv},     {"pgd_m", pgd},   {"arias_m_s", arias}, {"d5_95_s", significant},
};

enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* The periods of a list between commas; their number, 0: said why it is none. */
static int periods_of(const char *list, double periods[PERIODS_MAX])
{
	int n = 0;
	for (const char *at = list; at; n++) {
		char *end;
		periods[n] = strtod(at, &end);
		if (end == at || (*end && *end != ',') || !(periods[n] > 0 && periods[n] <= 1000) ||
		    n == PERIODS_MAX - 1) {
			command_complain("--periods takes up to %d numbers in (0, 1000] s between commas, got '%s'",
			                 PERIODS_MAX - 1, list);
			return 0;
		}
		at = *end ? end + 1 : NULL;
	}
	return n;
}

/* Pseudo-accelerations of oscillators on the ground, by a study without contact that sweeps the frequency. */
static enum pound_status spectrum(const struct record *record, int n, const double *periods, double *psa)
{
	double frequencies[PERIODS_MAX];
	for (int k = 0; k < n; k++)
		frequencies[k] = 1 / periods[k];
	struct pound_sweep sweep = {
	    .path = "/oscillators/0/frequency_hz",
	    .field = {.type = POUND_FIELD_REAL,
	              .offset = offsetof(struct pound_scene, oscillators[0].frequency_hz)},
	    .n_values = n,
	    .values = frequencies};
	struct pound_study study = {.kind = POUND_KIND_RESPONSE, .n_sweeps = 1, .sweeps = &sweep};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		study.scene.oscillators[i] =
		    (struct pound_oscillator){.mass = 1, .frequency_hz = 1, .damping_ratio = DAMPING};
	for (int row = 0; pound_excitation_name(row); row++)
		if (strcmp(pound_excitation_name(row), "record") == 0)
			study.scene.excitation.type = row;
	study.scene.excitation.time_step = record->step;
	study.scene.excitation.signals = 1;
	study.scene.excitation.n_record = record->n;
	study.scene.excitation.record = record->acceleration;
	struct pound_run *run = pound_run_create(&study, 1);
	enum pound_status status = run ? POUND_OK : POUND_NOMEM;
	for (int b = 0; status == POUND_OK && b < pound_run_blocks(run); b++)
		status = pound_run_block(run, b, 0);
	for (int r = 0; status == POUND_OK && r < pound_run_reductions(run); r++)
		status = pound_run_reduce(run, r, 0);
	for (int k = 0; status == POUND_OK && k < n; k++) {
		const double w = 2 * PI * frequencies[k];
		psa[k] = w * w * pound_run_result(run)->cells[k].signals[0].displacement_max_free_1;
	}
	pound_run_free(run);
	return status;
}

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

static void print_json(int n, const struct shown *shown, int n_periods, const double *periods)
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
		for (int k = 0; k < n_periods; k++) {
			writer_object(&w, NULL, WRITER_LINE);
			writer_number(&w, "period_s", periods[k]);
			writer_number(&w, "damping_ratio", DAMPING);
			writer_number(&w, "psa_m_s2", shown[i].psa[k]);
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
static void print_tables(int n, const struct shown *shown, int n_periods, const double *periods, bool csv)
{
	const char *names[COLUMNS + 4] = {"file", "format", "unit"};
	for (int c = 0; c < COLUMNS; c++)
		names[3 + c] = columns[c].name;
	struct table *table =
	    table_open(n_periods ? (const char *const[]){"file", "period_s", "psa_m_s2", NULL} : names);
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < n_periods; k++) {
			table_text(table, shown[i].path);
			table_number(table, periods[k]);
			table_number(table, shown[i].psa[k]);
		}
		if (n_periods)
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

/* `pound record FILE...`: what was read, its measures, and with --periods its response spectrum.
 *
 * Returns  value   OUTCOME_USAGE: a file is no record
 * Test     client_record: files_are_shown_with_their_measures
 */
enum outcome record_show(const struct options *options)
{
	double periods[PERIODS_MAX];
	const int n_periods = options->periods ? periods_of(options->periods, periods) : 0;
	if (options->periods && n_periods == 0)
		return OUTCOME_USAGE;
	struct shown *shown = command_sure(calloc((size_t)options->n_files, sizeof *shown));
	enum outcome outcome = OUTCOME_OK;
	for (int i = 0; i < options->n_files; i++) {
		shown[i].path = options->files[i];
		shown[i].psa = command_sure(calloc((size_t)n_periods + 1, sizeof *shown[i].psa));
		const enum outcome read = read_file(options, &shown[i]);
		outcome = read == OUTCOME_OK ? outcome : read;
		if (read == OUTCOME_OK && n_periods &&
		    spectrum(&shown[i].record, n_periods, periods, shown[i].psa) != POUND_OK) {
			command_complain("%s: the response spectrum cannot be computed", shown[i].path);
			outcome = OUTCOME_FAILED;
		}
	}
	if (outcome == OUTCOME_OK && strcmp(options->format, "json") == 0)
		print_json(options->n_files, shown, n_periods, periods);
	else if (outcome == OUTCOME_OK)
		print_tables(options->n_files, shown, n_periods, periods, strcmp(options->format, "csv") == 0);
	for (int i = 0; i < options->n_files; i++) {
		record_free(&shown[i].record);
		free(shown[i].psa);
	}
	free(shown);
	return outcome;
}
