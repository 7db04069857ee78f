/* given_indices.c - sensitivity indices of given samples without a design.
 *
 * 1. Two tables have one line per sample: inputs and outputs.  The header of the outputs gives the role of each column: output,
 *    variance or replicate of an output, or input.
 * 2. Samples with a missing number are left out for every output, and counted; lines with the same inputs that are replicates
 *    become one sample.
 * 3. The engine checks the samples once and estimates the indices of each output; the result has the form of
 *    a sensitivity result. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/given.h"
#include "engine/pound.h"
#include "schema/external/csv_reader.h"
#include "schema/external/given_table.h"
#include "schema/json/json_writer.h"
#include "schema/result/result_json.h"

/* ---- complete samples ---- */

/* A column of the outputs. */
struct column {
	int output;    /* -1: an input */
	int next;      /* next column of this output; -1: it is the last */
	int replicate; /* from 1; 0: the output itself */
	bool variance; /* of the mean */
};

/* Complete samples, and memory for the estimates. */
struct samples {
	struct pound_given given;
	const struct given_table *outputs;
	struct column *columns;         /* (outputs->n_columns) */
	char **names;                   /* of the outputs  (n_outputs) */
	int *first;                     /* first column of each output  (n_outputs) */
	int n_outputs, n_rows, missing; /* n_rows: complete lines */
	int n_points;                   /* different inputs */
	bool noisy;                     /* outputs have variances or replicates */
	bool repeated;                  /* every sample has two lines or more */
	int *row;                       /* line of each complete row in the tables  (n_rows) */
	int *sample, *count;            /* sample of each row, rows of each sample  (n_rows) each */
	int *point, *repeats;           /* point of each sample, samples of each point  (n_rows) each */
	double *x, *y, *noise;          /* y, noise: one output  (n_rows) each */
	double *mean;                   /* of the output at each point  (n_rows) */
	double *values, *scratch;
	int *cell, *table;
	size_t *order;
	struct pound_given_indices *indices; /* of one output */
};

static void samples_free(struct samples *s)
{
	for (int o = 0; o < s->n_outputs; o++)
		free(s->names[o]);
	void *const memory[] = {s->columns, s->names,        s->first,  s->row,     s->sample, s->count, s->x,
	                        s->y,       s->noise,        s->values, s->scratch, s->cell,   s->table, s->order,
	                        s->indices, s->given.inputs, s->point,  s->repeats, s->mean};
	for (size_t k = 0; k < sizeof memory / sizeof memory[0]; k++)
		free(memory[k]);
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

/* The output with a name of some length, added if it is new. */
static int output_named(struct samples *s, const char *name, size_t length, struct problems *problems)
{
	for (int o = 0; o < s->n_outputs; o++)
		if (strlen(s->names[o]) == length && strncmp(s->names[o], name, length) == 0)
			return o;
	char *copy = strndup(name, length);
	if (!copy) {
		problems->status = PROBLEMS_NOMEM;
		return 0;
	}
	s->names[s->n_outputs] = copy;
	return s->n_outputs++;
}

/* Counts the columns of an output. */
struct output_columns {
	int single, variances, replicates, most;
};

static struct output_columns output_columns(const struct samples *s, int output)
{
	struct output_columns n = {0};
	for (int c = s->first[output]; c >= 0; c = s->columns[c].next) {
		const struct column *column = &s->columns[c];
		n.variances += column->variance;
		n.replicates += column->replicate > 0;
		n.single += !column->variance && column->replicate == 0;
		n.most = column->replicate > n.most ? column->replicate : n.most;
	}
	return n;
}

/* Checks that all outputs have the same kind of columns: one, one and its variance, or replicates from 1 to the same number. */
static void outputs_check(struct samples *s, struct problems *problems)
{
	bool variances = false, replicates = false;
	for (int o = 0; o < s->n_outputs; o++) {
		const struct output_columns n = output_columns(s, o);
		variances |= n.variances > 0 && n.single > 0;
		replicates |= n.replicates > 0;
	}
	for (int o = 0; o < s->n_outputs; o++) {
		const struct output_columns n = output_columns(s, o);
		if (n.single == 0 && n.replicates == 0)
			problems_add(problems, s->names[o], "has a variance, but no column of its own");
		else if (replicates && (n.replicates == 0 || n.single > 0 || n.variances > 0))
			problems_add(
			    problems, s->names[o],
			    "must have columns NAME.replicate1, NAME.replicate2, ... alone, as other outputs have");
		else if (replicates && (n.most < 2 || n.replicates != n.most))
			// column names are unique, so if the number of columns is right, each number occurs once
			problems_add(problems, s->names[o], "must have its replicates numbered from 1 on, at least 2");
		else if (variances && n.variances == 0)
			problems_add(problems, s->names[o],
			             "has no variance, but other outputs have; expected NAME.variance of all or of none");
	}
	s->noisy = variances || replicates;
}

/* Links the columns of each output, ascending. */
static void columns_link(struct samples *s)
{
	for (int o = 0; o < s->n_outputs; o++)
		s->first[o] = -1;
	for (int c = s->outputs->n_columns - 1; c >= 0; c--) {
		struct column *column = &s->columns[c];
		if (column->output < 0)
			continue;
		column->next = s->first[column->output];
		s->first[column->output] = c;
	}
}

static void outputs_find(const struct given_table *x, const struct given_table *y, struct samples *s,
                         struct problems *problems)
{
	for (int c = 0; c < y->n_columns; c++) {
		const char *name = y->names[c];
		struct column *column = &s->columns[c];
		const int input = given_column(x, x->n_columns, name);
		column->output = -1;
		if (input >= 0) {
			if (x->n_rows == y->n_rows)
				inputs_compare(x, y, input, c, problems);
			continue;
		}
		size_t length = csv_replicate_stem(name, &column->replicate);
		if (length == 0) {
			length = csv_variance_stem(name);
			column->variance = length > 0;
		}
		column->output = output_named(s, name, length > 0 ? length : strlen(name), problems);
	}
	if (s->n_outputs == 0)
		problems_add(problems, "line 1", "has no column of an output");
	columns_link(s);
	outputs_check(s, problems);
	for (int c = 0; c < y->n_columns; c++)
		for (int i = 0; i < y->n_rows && s->columns[c].variance; i++)
			if (y->cells[(size_t)i * y->n_columns + c] < 0.0) {
				char place[CSV_CELL_SIZE + 80];
				snprintf(place, sizeof place, "line %d, %s", i + 2, y->names[c]);
				problems_add(problems, place, "must be at least 0, got %.15g",
				             y->cells[(size_t)i * y->n_columns + c]);
				break;
			}
}

static bool complete(const struct given_table *table, int row)
{
	for (int c = 0; c < table->n_columns; c++)
		if (isnan(table->cells[(size_t)row * table->n_columns + c]))
			return false;
	return true;
}

/* Whether a column is sorted over the complete rows, up or down. */
static bool column_sorted(const struct samples *s, const struct given_table *table, int column)
{
	const double *cell = table->cells + column;
	bool up = true, down = true;
	for (int k = 1; k < s->n_rows; k++) {
		const double here = cell[(size_t)s->row[k] * table->n_columns],
		             before = cell[(size_t)s->row[k - 1] * table->n_columns];
		up &= here >= before;
		down &= here <= before;
	}
	return up != down;
}

/* Joins replicates, and sorts out what is known of the samples. */
static void samples_join(const struct given_table *x, struct samples *s, struct problems problems[2])
{
	const int n = s->n_rows, d = x->n_columns;
	s->given.n_rows = pound_given_join(n, d, s->x, s->table, s->sample);
	s->given.joined = s->given.n_rows < n;
	for (int k = 0; k < n; k++) {
		s->count[s->sample[k]]++;
		memmove(s->x + (size_t)s->sample[k] * d, s->x + (size_t)k * d, sizeof *s->x * (size_t)d);
	}
	s->repeated = true;
	for (int k = 0; k < s->given.n_rows; k++)
		s->repeated &= s->count[k] > 1;
	s->given.noise_known = s->noisy || s->repeated;
	for (int c = 0; c < x->n_columns; c++)
		s->given.sorted |= column_sorted(s, x, c);
	for (int c = 0; c < s->outputs->n_columns; c++)
		s->given.sorted |= column_sorted(s, s->outputs, c);
	if (n < POUND_GIVEN_ROWS_MIN)
		problems_add(&problems[GIVEN_OUTPUTS], "",
		             "%d samples are complete, expected at least %d: new runs are needed, of more samples or "
		             "of the rows of `pound design'",
		             n, POUND_GIVEN_ROWS_MIN);
	else if (s->given.n_rows < POUND_GIVEN_ROWS_MIN)
		problems_add(&problems[GIVEN_INPUTS], "",
		             "the %d complete lines are replicates of %d points, expected at least %d points: new "
		             "runs at other points are needed",
		             n, s->given.n_rows, POUND_GIVEN_ROWS_MIN);
}

/* Finds the points; samples that repeat all of them, not by design, have the noise of the spread at their points.  One input
 * alone has no noise to be separated: what it does not explain is the index of the others. */
static void points_find(struct samples *s)
{
	const int n = s->given.n_rows;
	s->n_points = pound_given_points(n, s->given.n_inputs, s->x, s->table, s->point);
	for (int i = 0; i < n; i++)
		s->repeats[s->point[i]]++;
	// two samples for each point on average
	s->given.pooled =
	    !s->given.noise_known && s->given.replicates == 0 && s->given.n_inputs > 1 && n >= 2 * s->n_points;
	s->given.noise_known |= s->given.pooled;
}

/* Takes the complete samples; adds a problem for every constant input. */
static void samples_take(const struct given_table *x, const struct given_table *y, struct samples *s,
                         struct problems problems[2])
{
	const int d = x->n_columns;
	int n = 0;
	for (int i = 0; i < x->n_rows; i++) {
		if (!complete(x, i) || !complete(y, i))
			continue;
		memcpy(s->x + (size_t)n * d, x->cells + (size_t)i * d, sizeof *s->x * (size_t)d);
		s->row[n++] = i;
	}
	s->n_rows = n;
	s->given.n_inputs = d;
	s->given.x = s->x;
	s->missing = x->n_rows - n;
	for (int j = 0; j < d && n > 0; j++) {
		bool varies = false;
		for (int i = 1; i < n; i++)
			varies |= s->x[(size_t)i * d + j] != s->x[j];
		if (!varies)
			problems_add(&problems[GIVEN_INPUTS], x->names[j],
			             "has the same value in every complete sample; leave this input out");
		s->given.inputs[j] = (struct pound_input){.name = x->names[j]};
	}
	samples_join(x, s, problems);
}

static bool samples_init(struct samples *s, const struct given_table *x, const struct given_table *y)
{
	const size_t n = (size_t)x->n_rows, d = (size_t)x->n_columns;
	*s = (struct samples){.outputs = y};
	s->columns = calloc((size_t)y->n_columns, sizeof *s->columns);
	s->names = calloc((size_t)y->n_columns, sizeof *s->names);
	s->first = calloc((size_t)y->n_columns, sizeof *s->first);
	s->row = calloc(n + 1, sizeof *s->row);
	s->sample = calloc(n + 1, sizeof *s->sample);
	s->count = calloc(n + 1, sizeof *s->count);
	s->point = calloc(n + 1, sizeof *s->point);
	s->repeats = calloc(n + 1, sizeof *s->repeats);
	s->mean = calloc(n + 1, sizeof *s->mean);
	s->cell = calloc(n + 1, sizeof *s->cell);
	s->table = calloc((size_t)pound_given_join_slots((int)n), sizeof *s->table);
	s->x = calloc(n * d + 1, sizeof *s->x);
	s->y = calloc(n + 1, sizeof *s->y);
	s->noise = calloc(n + 1, sizeof *s->noise);
	s->values = calloc(2 * d * n + 1, sizeof *s->values);
	s->order = calloc(n + 1, sizeof *s->order);
	s->scratch = calloc(pound_given_scratch((int)n, (int)d), sizeof *s->scratch);
	s->indices = calloc(1, sizeof *s->indices);
	s->given.inputs = calloc(d, sizeof *s->given.inputs);
	return s->columns && s->names && s->first && s->row && s->sample && s->count && s->point && s->repeats &&
	       s->mean && s->cell && s->table && s->x && s->y && s->noise && s->values && s->order &&
	       s->scratch && s->indices && s->given.inputs;
}

/* ---- one output ---- */

/* An output of a complete row: the mean over its replicates, and the variance of that mean if it is known. */
static double value_of(const struct samples *s, int output, int row, double *variance)
{
	const struct given_table *y = s->outputs;
	const double *cell = y->cells + (size_t)s->row[row] * y->n_columns;
	double sum = 0.0, squares = 0.0;
	int n = 0;
	*variance = 0.0;
	for (int c = s->first[output]; c >= 0; c = s->columns[c].next) {
		sum += s->columns[c].variance ? 0.0 : cell[c];
		n += !s->columns[c].variance;
		*variance = s->columns[c].variance ? cell[c] : *variance;
	}
	for (int c = s->first[output]; c >= 0 && n > 1; c = s->columns[c].next)
		squares += (cell[c] - sum / n) * (cell[c] - sum / n);
	if (n > 1)
		*variance = squares / (n - 1.0) / n;
	return sum / n;
}

/* The noise of each sample: the variance at equal inputs, pooled over the points. */
static void noise_pool(struct samples *s)
{
	const int n = s->given.n_rows;
	double squares = 0.0;
	memset(s->mean, 0, sizeof *s->mean * (size_t)s->n_points);
	for (int i = 0; i < n; i++)
		s->mean[s->point[i]] += (s->y[i] - s->y[0]) / s->repeats[s->point[i]];
	for (int i = 0; i < n; i++) {
		const double off = s->y[i] - s->y[0] - s->mean[s->point[i]];
		squares += off * off;
	}
	for (int i = 0; i < n; i++)
		s->noise[i] = squares / (n - s->n_points);
}

/* Fills in an output of every sample: its mean over the lines of the sample, and the variance of that mean. */
static struct pound_given_output output_of(struct samples *s, int output)
{
	double variance;
	memset(s->y, 0, sizeof *s->y * (size_t)s->n_rows);
	memset(s->noise, 0, sizeof *s->noise * (size_t)s->n_rows);
	for (int k = 0; k < s->n_rows; k++)
		s->y[s->sample[k]] += value_of(s, output, k, &variance) / s->count[s->sample[k]];
	for (int k = 0; k < s->n_rows; k++) {
		const double n = s->count[s->sample[k]], off = value_of(s, output, k, &variance) - s->y[s->sample[k]];
		s->noise[s->sample[k]] += s->repeated ? off * off / (n - 1.0) / n : variance / n / n;
	}
	if (s->given.pooled)
		noise_pool(s);
	return (struct pound_given_output){s->y, s->given.noise_known ? s->noise : NULL};
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
	writer_whole(w, "points", s->n_points);
	writer_whole(w, "samples_missing", s->missing);
	writer_bool(w, "factorial", s->given.replicates > 0);
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

static void write_output(struct writer *w, const struct samples *s, int output)
{
	const struct pound_given_indices *indices = s->indices;
	const struct pound_study inputs = {.n_inputs = s->given.n_inputs, .inputs = s->given.inputs};
	writer_object(w, NULL, WRITER_LINES);
	writer_text(w, "name", s->names[output]);
	writer_number(w, "mean", indices->mean);
	writer_number(w, "variance", indices->variance);
	writer_number(w, "noise_share", indices->noise_share);
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
	pound_given_inputs(&s->given, s->values, s->cell, s->order);
	points_find(s);
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
	writer_whole(&w, "runs", s->n_rows);
	writer_array(&w, "outputs", WRITER_LINES);
	for (int o = 0; o < s->n_outputs; o++) {
		const struct pound_given_output output = output_of(s, o);
		pound_given_estimate(&s->given, &checks, &output, s->scratch, s->indices);
		write_output(&w, s, o);
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
 * Returns  value      (length)  -       JSON; NULL: failed, see problems
 *          problems    (2)       -       of the inputs and of the outputs, enum given_role
 * Memory   allocates; the caller frees
 *
 * Test     unit_given_table: indices_of_two_tables_are_those_of_the_engine
 */
char *given_indices(const struct given_table *x, const struct given_table *y, struct problems problems[2],
                    size_t *length)
{
	struct samples s = {0};
	struct problems *const of_inputs = &problems[GIVEN_INPUTS], *const of_outputs = &problems[GIVEN_OUTPUTS];
	char *json = NULL;
	problems_init(of_inputs);
	problems_init(of_outputs);
	if (samples_init(&s, x, y)) {
		if (x->n_rows != y->n_rows)
			problems_add(of_outputs, "", "must have %d samples, as the inputs, got %d", x->n_rows, y->n_rows);
		outputs_find(x, y, &s, of_outputs);
		if (x->n_rows == y->n_rows)
			samples_take(x, y, &s, problems);
		if (of_inputs->status == PROBLEMS_NONE && of_outputs->status == PROBLEMS_NONE)
			json = result_of(&s, length);
	}
	if (!json && of_inputs->status == PROBLEMS_NONE && of_outputs->status == PROBLEMS_NONE)
		of_outputs->status = PROBLEMS_NOMEM;
	samples_free(&s);
	return json;
}
