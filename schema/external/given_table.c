/* given_table.c - sensitivity indices of given samples without a design.
 *
 * 1. Two tables are read, with one line per sample: inputs and outputs.
 * 2. Samples with a missing number are left out for every output, and counted.
 * 3. The engine checks the samples once and estimates the indices of each output; the result has the form of
 *    a sensitivity result. */
#include "schema/external/given_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/given.h"
#include "engine/pound.h"
#include "schema/external/csv_reader.h"
#include "schema/json/json_writer.h"
#include "schema/result/result_json.h"

// so that squares of outputs, and products of squares, do not overflow
static const double NUMBER_MOST = 1e60;

/* ---- tables ---- */

static int column_named(const struct given_table *table, int n, const char *name)
{
	for (int c = 0; c < n; c++)
		if (strcmp(table->names[c], name) == 0)
			return c;
	return -1;
}

static void header_read(struct given_table *table, struct csv *csv)
{
	const char *newline = memchr(csv->at, '\n', (size_t)(csv->end - csv->at));
	const size_t n = (size_t)((newline ? newline : csv->end) - csv->at);
	size_t n_columns = 1;
	for (size_t i = 0; i < n; i++)
		n_columns += csv->at[i] == ',';
	if (n_columns == 1 && (memchr(csv->at, ';', n) || memchr(csv->at, '\t', n))) {
		csv_complain(csv, NULL, "has no comma; columns must be separated by commas");
		return;
	}
	table->names = calloc(n_columns, sizeof *table->names);
	if (!table->names) {
		csv->problems->status = PROBLEMS_NOMEM;
		return;
	}
	do {
		csv_read(csv);
		char *name = strdup(csv->cell);
		if (!name) {
			csv->problems->status = PROBLEMS_NOMEM;
			return;
		}
		table->names[table->n_columns++] = name;
		const int c = table->n_columns - 1;
		csv_name_check(csv, c, column_named(table, c, table->names[c]));
	} while (!csv->ended);
}

/* Reads one line into a row of the table; faults are noted per column in `faults`  (n_columns). */
static void line_read(struct given_table *table, struct csv *csv, int row, struct csv_fault *faults)
{
	int n = 0;
	do {
		double number;
		csv_read(csv);
		const bool read = csv_number(csv, &number);
		if (n < table->n_columns) {
			table->cells[(size_t)row * table->n_columns + n] = number;
			if (!read)
				csv_fault_note(&faults[n], csv,
				               "must be a decimal number, or empty or nan where it is missing, got \"%.60s\"",
				               csv->cell);
			else if (fabs(number) > NUMBER_MOST)
				csv_fault_note(&faults[n], csv, "must be at most %g in magnitude, got %.60s", NUMBER_MOST,
				               csv->cell);
		}
		n++;
	} while (!csv->ended);
	if (n != table->n_columns)
		csv_fault_note(&csv->length, csv, "has %d cells, the header has %d", n, table->n_columns);
}

/* Removes blank lines at the end. */
static void end_trim(struct csv *csv)
{
	for (const char *end = csv->end; end > csv->at && csv_blank(end - 1, end); end--)
		if (*(end - 1) == '\n')
			csv->end = end;
}

static void lines_read(struct given_table *table, struct csv *csv)
{
	// a line whose only cell is empty is a missing sample
	if (table->n_columns > 1)
		end_trim(csv);
	const int n = csv_lines_left(csv);
	if (n > POUND_ROWS_MAX) {
		problems_add(csv->problems, "", "has %d lines after the header, expected at most %d", n,
		             POUND_ROWS_MAX);
		return;
	}
	table->n_rows = n;
	table->cells = calloc((size_t)n * table->n_columns + 1, sizeof *table->cells);
	struct csv_fault *faults = calloc((size_t)table->n_columns, sizeof *faults);
	if (!table->cells || !faults)
		csv->problems->status = PROBLEMS_NOMEM;
	for (int i = 0; i < n && table->cells && faults; i++) {
		csv->line++;
		line_read(table, csv, i, faults);
	}
	csv_fault_report(&csv->length, NULL, csv->problems);
	for (int c = 0; c < table->n_columns && faults; c++)
		csv_fault_report(&faults[c], table->names[c], csv->problems);
	free(faults);
}

/* Removes a column from a table. */
static void column_drop(struct given_table *table, int column)
{
	const int n = table->n_columns;
	for (int i = 0; i < table->n_rows; i++)
		for (int c = 0, to = 0; c < n; c++)
			if (c != column)
				table->cells[(size_t)i * (n - 1) + to++] = table->cells[(size_t)i * n + c];
	free(table->names[column]);
	memmove(table->names + column, table->names + column + 1,
	        sizeof *table->names * (size_t)(n - column - 1));
	table->n_columns--;
}

/* Reads a table of samples from CSV.
 *
 * Given    role       -         -       of its columns
 *          csv        (length)  -       a header and one line per sample; columns `row` and `sample` are ignored
 * Returns  table      -         -       to be freed by given_table_free, also after errors
 *          problems   -         -       pointers are "line 3, NAME"
 *
 * Test     unit_given_table: what_is_wrong_with_a_table_is_reported_completely
 */
void given_table_read(struct given_table *table, enum given_role role, const char *csv, size_t length,
                      struct problems *problems)
{
	static const char mark[] = "\xEF\xBB\xBF"; // byte order mark, which spreadsheets write
	static const char *const others[] = {"row", "sample"};
	struct csv at = {.at = csv, .end = csv + length, .line = 1, .problems = problems};
	*table = (struct given_table){0};
	problems_init(problems);
	if (length >= 3 && memcmp(csv, mark, 3) == 0)
		at.at += 3;
	if (csv_blank(at.at, at.end)) {
		problems_add(problems, "", "is empty; expected a header and one line per sample");
		return;
	}
	if (!csv_is_text(&at))
		return;
	header_read(table, &at);
	if (problems->status != PROBLEMS_NONE)
		return;
	lines_read(table, &at);
	if (problems->status != PROBLEMS_NONE)
		return;
	for (int k = 0; k < 2; k++) {
		const int column = column_named(table, table->n_columns, others[k]);
		if (column >= 0)
			column_drop(table, column);
	}
	if (table->n_columns == 0)
		problems_add(problems, "line 1", "has no column of %s",
		             role == GIVEN_INPUTS ? "an input" : "an output");
	if (role == GIVEN_INPUTS && table->n_columns > POUND_INPUTS_MAX)
		problems_add(problems, "line 1", "has %d inputs, expected at most %d", table->n_columns,
		             POUND_INPUTS_MAX);
}

void given_table_free(struct given_table *table)
{
	for (int c = 0; c < table->n_columns; c++)
		free(table->names[c]);
	free(table->names);
	free(table->cells);
	*table = (struct given_table){0};
}

/* ---- complete samples ---- */

/* Complete samples, and memory for the estimates. */
struct samples {
	struct pound_given given;
	const struct given_table *outputs; /* in columns that are not inputs */
	int n_outputs, missing;
	int *column;                      /* column of each output in the table  (n_outputs) */
	int *row;                         /* row of each sample in the tables  (given.n_rows) */
	double *x, *y, *values, *scratch; /* y: one output  (given.n_rows) */
	size_t *order;
	struct pound_given_indices *indices; /* of one output */
};

static void samples_free(struct samples *s)
{
	free(s->column);
	free(s->row);
	free(s->x);
	free(s->y);
	free(s->values);
	free(s->scratch);
	free(s->order);
	free(s->indices);
	free(s->given.inputs);
}

/* A column of the outputs with the name of an input must equal that input, up to rounding to few digits. */
static void inputs_compare(const struct given_table *x, const struct given_table *y, int input, int column,
                           struct problems *problems)
{
	for (int i = 0; i < x->n_rows; i++) {
		const double here = y->cells[(size_t)i * y->n_columns + column],
		             there = x->cells[(size_t)i * x->n_columns + input];
		if (fabs(here - there) > 1e-4 * fmax(fabs(here), fabs(there)) + 1e-6) {
			char place[CSV_CELL_SIZE + 80];
			snprintf(place, sizeof place, "line %d, %s", i + 2, x->names[input]);
			problems_add(problems, place, "is %.15g, but the inputs have %.15g; check the order of the lines",
			             here, there);
			return;
		}
	}
}

static void outputs_find(const struct given_table *x, const struct given_table *y, struct samples *s,
                         struct problems *problems)
{
	for (int c = 0; c < y->n_columns; c++) {
		const int input = column_named(x, x->n_columns, y->names[c]);
		if (input < 0)
			s->column[s->n_outputs++] = c;
		else
			inputs_compare(x, y, input, c, problems);
	}
	if (s->n_outputs == 0)
		problems_add(problems, "line 1", "has no column of an output");
}

static bool complete(const struct given_table *table, int row)
{
	for (int c = 0; c < table->n_columns; c++)
		if (isnan(table->cells[(size_t)row * table->n_columns + c]))
			return false;
	return true;
}

/* Takes the complete samples; adds a problem for every constant input. */
static void samples_take(const struct given_table *x, const struct given_table *y, struct samples *s,
                         struct problems *problems)
{
	const int d = x->n_columns;
	int n = 0;
	for (int i = 0; i < x->n_rows; i++) {
		if (!complete(x, i) || !complete(y, i))
			continue;
		memcpy(s->x + (size_t)n * d, x->cells + (size_t)i * d, sizeof *s->x * (size_t)d);
		s->row[n++] = i;
	}
	s->given.n_rows = n;
	s->given.n_inputs = d;
	s->given.x = s->x;
	s->missing = x->n_rows - n;
	if (n < POUND_GIVEN_ROWS_MIN)
		problems_add(problems, "", "%d samples are complete, expected at least %d", n, POUND_GIVEN_ROWS_MIN);
	for (int j = 0; j < d && n > 0; j++) {
		bool varies = false;
		for (int i = 1; i < n; i++)
			varies |= s->x[(size_t)i * d + j] != s->x[j];
		if (!varies)
			problems_add(problems, x->names[j],
			             "has the same value in every complete sample; leave this input out");
		s->given.inputs[j] = (struct pound_input){.name = x->names[j]};
	}
}

static bool samples_init(struct samples *s, const struct given_table *x, const struct given_table *y)
{
	const size_t n = (size_t)x->n_rows, d = (size_t)x->n_columns;
	*s = (struct samples){.outputs = y};
	s->column = calloc((size_t)y->n_columns, sizeof *s->column);
	s->row = calloc(n + 1, sizeof *s->row);
	s->x = calloc(n * d + 1, sizeof *s->x);
	s->y = calloc(n + 1, sizeof *s->y);
	s->values = calloc(2 * d * n + 1, sizeof *s->values);
	s->order = calloc(n + 1, sizeof *s->order);
	s->scratch = calloc(pound_given_scratch((int)n, (int)d), sizeof *s->scratch);
	s->indices = calloc(1, sizeof *s->indices);
	s->given.inputs = calloc(d, sizeof *s->given.inputs);
	return s->column && s->row && s->x && s->y && s->values && s->order && s->scratch && s->indices &&
	       s->given.inputs;
}

/* ---- the result ---- */

#define X(name, text) text,
static const char *const samples_notes[] = {POUND_GIVEN_SAMPLES_NOTES(X)};
static const char *const notes[] = {POUND_GIVEN_NOTES(X)};
#undef X

static void write_checks(struct writer *w, const struct samples *s, const struct pound_given_checks *checks)
{
	writer_object(w, "given", WRITER_LINES);
	writer_whole(w, "samples", s->given.n_rows);
	writer_whole(w, "samples_missing", s->missing);
	writer_bool(w, "inputs_independent", !(checks->notes >> POUND_GIVEN_DEPENDENT & 1));
	if (checks->pair[0] >= 0) {
		writer_array(w, "most_dependent", WRITER_LINE);
		for (int k = 0; k < 2; k++)
			writer_text(w, NULL, s->given.inputs[checks->pair[k]].name);
		writer_end(w);
		writer_number(w, "rank_correlation", checks->correlation);
	}
	writer_array(w, "notes", WRITER_LINES);
	for (int k = 0; k < POUND_GIVEN_N_SAMPLES_NOTES; k++)
		if (checks->notes >> k & 1)
			writer_text(w, NULL, samples_notes[k]);
	writer_end(w);
	writer_end(w);
}

static void write_note(struct writer *w, unsigned said)
{
	char text[1024];
	int n = 0;
	for (int k = 0; k < POUND_GIVEN_N_NOTES; k++)
		if (said >> k & 1)
			n += snprintf(text + n, sizeof text - (size_t)n, "%s%s", n ? "; " : "", notes[k]);
	if (n)
		writer_text(w, "note", text);
}

static void write_second_order(struct writer *w, const struct samples *s)
{
	if (s->indices->n_second == 0)
		return;
	writer_array(w, "second_order", WRITER_LINES);
	for (int k = 0; k < s->indices->n_second; k++) {
		writer_object(w, NULL, WRITER_LINE);
		writer_array(w, "inputs", WRITER_LINE);
		for (int j = 0; j < s->given.n_inputs; j++)
			if (s->indices->second[k].inputs >> j & 1)
				writer_text(w, NULL, s->given.inputs[j].name);
		writer_end(w);
		result_estimate(w, "S2", &s->indices->second[k].estimate);
		writer_end(w);
	}
	writer_end(w);
}

static void write_output(struct writer *w, const struct samples *s, int column)
{
	const struct pound_given_indices *indices = s->indices;
	const struct pound_study inputs = {.n_inputs = s->given.n_inputs, .inputs = s->given.inputs};
	writer_object(w, NULL, WRITER_LINES);
	writer_text(w, "name", s->outputs->names[column]);
	writer_number(w, "mean", indices->mean);
	writer_number(w, "variance", indices->variance);
	writer_number(w, "explained", indices->explained);
	writer_whole(w, "degree", indices->degree);
	writer_whole(w, "terms", indices->terms);
	write_note(w, indices->notes);
	writer_array(w, "inputs", WRITER_LINES);
	for (int j = 0; j < s->given.n_inputs; j++) {
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name", s->given.inputs[j].name);
		result_estimate(w, "S1", &indices->first[j]);
		result_estimate(w, "ST", &indices->total[j]);
		writer_end(w);
	}
	writer_end(w);
	write_second_order(w, s);
	result_curves(w, &inputs, indices->curves);
	writer_end(w);
}

static char *result_of(struct samples *s, size_t *length)
{
	struct writer w;
	struct pound_given_checks checks;
	pound_given_inputs(&s->given, s->values, s->order);
	pound_given_check(&s->given, s->scratch, &checks);
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "kind", "given_data");
	writer_text(&w, "engine_version", POUND_VERSION);
	write_checks(&w, s, &checks);
	writer_array(&w, "cells", WRITER_LINES);
	writer_object(&w, NULL, WRITER_LINES);
	writer_object(&w, "sweep", WRITER_LINE);
	writer_end(&w);
	writer_whole(&w, "runs", s->given.n_rows);
	writer_array(&w, "outputs", WRITER_LINES);
	for (int o = 0; o < s->n_outputs; o++) {
		for (int i = 0; i < s->given.n_rows; i++)
			s->y[i] = s->outputs->cells[(size_t)s->row[i] * s->outputs->n_columns + s->column[o]];
		pound_given_estimate(&s->given, &checks, s->y, s->scratch, s->indices);
		write_output(&w, s, s->column[o]);
	}
	writer_end(&w);
	writer_end(&w);
	writer_end(&w);
	writer_end(&w);
	return writer_take(&w, length);
}

/* The indices of the outputs of given samples.
 *
 * Given    x, y       -         -       inputs and outputs, with one line per sample in the same order
 * Returns  value      (length)  -       JSON; NULL: failed, see problems->status; pointers are into the outputs
 * Memory   allocates; the caller frees
 *
 * Test     unit_given_table: indices_of_two_tables_are_those_of_the_engine
 */
char *given_indices(const struct given_table *x, const struct given_table *y, struct problems *problems,
                    size_t *length)
{
	struct samples s = {0};
	char *json = NULL;
	problems_init(problems);
	if (x->n_rows != y->n_rows) {
		problems_add(problems, "", "has %d samples, but the inputs have %d", y->n_rows, x->n_rows);
		return NULL;
	}
	if (samples_init(&s, x, y)) {
		outputs_find(x, y, &s, problems);
		samples_take(x, y, &s, problems);
		if (problems->status == PROBLEMS_NONE)
			json = result_of(&s, length);
	}
	if (!json && problems->status == PROBLEMS_NONE)
		problems->status = PROBLEMS_NOMEM;
	samples_free(&s);
	return json;
}
