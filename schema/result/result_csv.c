/* result_csv.c - a result -> CSV, from its JSON: whatever members a result has become columns.
 *
 * Sensitivity: the table that is asked for by name, of all cells and outputs.  Response: one row per cell and signal.
 * Separation: one row per cell and gap.  Convergence: one row per setting, its time beside it.  Floor spectra: one row per frequency. */
#include <stdio.h>
#include <string.h>

#include "schema/json/json.h"
#include "schema/json/json_writer.h"
#include "schema/result/result_json.h"

static const cJSON *member(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* The first element of a list that may be absent, and the one behind an element. */
static const cJSON *first(const cJSON *list)
{
	return list ? list->child : NULL;
}

static const cJSON *behind(const cJSON *element)
{
	return element ? element->next : NULL;
}

/* ---- lines ---- */

/* A table in the making: first a line of the names of its cells, then lines of their values. */
struct lines {
	struct writer *w;
	bool header, inside; /* the current line is that of names; it has a cell */
};

static void put_value(struct writer *w, const cJSON *value)
{
	char digits[WRITER_NUMBER_SIZE];
	if (cJSON_IsString(value))
		writer_cell(w, value->valuestring);
	else if (cJSON_IsNumber(value))
		writer_raw(w, digits, (size_t)writer_digits(value->valuedouble, digits));
	else if (cJSON_IsBool(value))
		writer_cell(w, cJSON_IsTrue(value) ? "true" : "false");
}

/* The next cell: its name behind a prefix, or its value; NULL: it has none. */
static void put(struct lines *lines, const char *prefix, const char *name, const cJSON *value)
{
	char text[256];
	writer_raw(lines->w, ",", lines->inside);
	lines->inside = true;
	snprintf(text, sizeof text, "%s%s", prefix, name);
	if (lines->header)
		writer_cell(lines->w, text);
	else
		put_value(lines->w, value);
}

/* The scalar members of an object, each a cell. */
static void put_scalars(struct lines *lines, const cJSON *object, const char *prefix)
{
	const cJSON *value;
	cJSON_ArrayForEach(value, object)
	{
		bool scalar = !cJSON_IsArray(value) && !cJSON_IsObject(value);
		if (scalar && strcmp(value->string, "note") != 0)
			put(lines, prefix, value->string, value);
	}
}

static void put_end(struct lines *lines)
{
	writer_raw(lines->w, "\r\n", 2);
	lines->header = lines->inside = false;
}

/* ---- sensitivity ---- */

/* Where a line of a table belongs, and what it is about. */
struct place {
	const cJSON *result, *cell, *output;
	const cJSON *element; /* of the table's list */
	int index;            /* of the element in its list */
	int point;            /* of the element's curve */
	int width;            /* the most inputs of a set in this table */
};

/* An intermediate result says in every line of how many rows it is. */
static void put_cell(struct lines *lines, const struct place *at)
{
	put_scalars(lines, member(at->result, "partial"), "partial.");
	put_scalars(lines, member(at->cell, "sweep"), "");
}

static void put_output(struct lines *lines, const struct place *at)
{
	put_cell(lines, at);
	put(lines, "output.", "name", member(at->output, "name"));
	if (member(at->output, "frequency_hz"))
		put(lines, "output.", "frequency_hz", member(at->output, "frequency_hz"));
}

static void put_input(struct lines *lines, const struct place *at)
{
	const cJSON *accuracy = member(at->output, "accuracy");
	put_cell(lines, at);
	put_scalars(lines, at->output, "output.");
	put_scalars(lines, member(at->output, "excitation"), "output.excitation.");
	put_scalars(lines, accuracy, "output.accuracy.");
	put_scalars(lines, at->element, "");
	put_scalars(lines, cJSON_GetArrayItem(member(accuracy, "inputs"), at->index), "accuracy.");
}

static void put_set(struct lines *lines, const struct place *at)
{
	const cJSON *inputs = member(at->element, "inputs");
	put_output(lines, at);
	for (int k = 0; k < at->width; k++) {
		char name[32];
		snprintf(name, sizeof name, "input_%d", k + 1);
		put(lines, "", name, cJSON_GetArrayItem(inputs, k));
	}
	put_scalars(lines, at->element, "");
}

static void put_group(struct lines *lines, const struct place *at)
{
	put_output(lines, at);
	put_scalars(lines, at->element, "");
}

static void put_variable(struct lines *lines, const struct place *at)
{
	put_output(lines, at);
	put_scalars(lines, member(at->output, "ratios"), "");
	put_scalars(lines, at->element, "");
}

static void put_point(struct lines *lines, const struct place *at)
{
	static const char *const curve[] = {"x", "mean", "low", "high"};
	put_output(lines, at);
	put_scalars(lines, at->element, "");
	for (int k = 0; k < 4; k++)
		put(lines, "", curve[k], cJSON_GetArrayItem(member(at->element, curve[k]), at->point));
}

/* The lists that are tables, by their names in an output. */
static const struct table {
	const char *name;
	void (*put)(struct lines *lines, const struct place *at);
	const char *within; /* the list is this member of the one of that name; NULL: that itself */
	const char *points; /* member of an element with a line for each of its own; NULL: a line an element */
} tables[] = {
    {"inputs", put_input, NULL, NULL},
    {"second_order", put_set, NULL, NULL},
    {"closed", put_set, NULL, NULL},
    {"groups", put_group, NULL, NULL},
    {"ratios", put_variable, "variables", NULL},
    {"conditional_means", put_point, NULL, "x"},
};

static const cJSON *list_of(const struct table *table, const cJSON *output)
{
	const cJSON *list = member(output, table->name);
	return table->within ? member(list, table->within) : list;
}

static int width_of(const struct table *table, const cJSON *cells)
{
	int width = 0;
	const cJSON *cell, *output, *element;
	cJSON_ArrayForEach(cell, cells) cJSON_ArrayForEach(output, member(cell, "outputs"))
	    cJSON_ArrayForEach(element, list_of(table, output))
	{
		int n = cJSON_GetArraySize(member(element, "inputs"));
		width = n > width ? n : width;
	}
	return width;
}

/* The lines of one output; before the first of all, their names. */
static void put_outputs(struct lines *lines, const struct table *table, struct place *at)
{
	at->index = 0;
	cJSON_ArrayForEach(at->element, list_of(table, at->output))
	{
		int n = table->points ? cJSON_GetArraySize(member(at->element, table->points)) : 1;
		for (at->point = 0; at->point < n; at->point++) {
			if (lines->header) {
				table->put(lines, at);
				put_end(lines);
			}
			table->put(lines, at);
			put_end(lines);
		}
		at->index++;
	}
}

static void put_sensitivity(struct lines *lines, const struct table *table, const cJSON *result)
{
	const cJSON *cells = member(result, "cells");
	struct place at = {.result = result, .width = width_of(table, cells)};
	cJSON_ArrayForEach(at.cell, cells) cJSON_ArrayForEach(at.output, member(at.cell, "outputs"))
	    put_outputs(lines, table, &at);
}

/* Every look at the intervals of a design that grew, and what was to be reached. */
static void put_look(struct lines *lines, const cJSON *stopping, const cJSON *look, const cJSON *sweep)
{
	static const char *const members[] = {"rows", "runs", "half_width", "index", "input", "output"};
	const cJSON *value;
	for (int k = 0; k < 6; k++)
		put(lines, "", members[k], member(look, members[k]));
	cJSON_ArrayForEach(value, sweep)
	    put(lines, "", value->string, member(member(look, "sweep"), value->string));
	put(lines, "asked.", "half_width", member(stopping, "half_width"));
	put(lines, "asked.", "max_runs", member(stopping, "max_runs"));
	put(lines, "", "reached", member(stopping, "reached"));
	put_end(lines);
}

static void put_stopping(struct lines *lines, const cJSON *result)
{
	const cJSON *stopping = member(result, "stopping"), *looks = member(stopping, "looks"), *look;
	const cJSON *sweep = member(cJSON_GetArrayItem(member(result, "cells"), 0), "sweep");
	if (looks)
		put_look(lines, stopping, looks->child, sweep);
	cJSON_ArrayForEach(look, looks) put_look(lines, stopping, look, sweep);
}

/* ---- response, convergence, floor spectra ---- */

/* A row of buildings in one line: every storey, floor and contact by its number. */
static void put_row(struct lines *lines, const cJSON *signal)
{
	static const char *const lists[] = {"storeys", "floors"}, *const ones[] = {"storey", "floor"};
	const cJSON *building, *element;
	int b = 0, k = 0;
	char prefix[64];
	cJSON_ArrayForEach(building, member(signal, "buildings"))
	{
		for (int list = 0; list < 2; list++) {
			int i = 0;
			cJSON_ArrayForEach(element, member(building, lists[list]))
			{
				snprintf(prefix, sizeof prefix, "building_%d.%s_%d.", b, ones[list], ++i);
				put_scalars(lines, element, prefix);
				snprintf(prefix, sizeof prefix, "building_%d.%s_%d.end.", b, ones[list], i);
				put_scalars(lines, member(element, "end"), prefix);
			}
		}
		b++;
	}
	cJSON_ArrayForEach(element, member(signal, "contacts"))
	{
		snprintf(prefix, sizeof prefix, "contact_%d.", k++);
		put_scalars(lines, element, prefix);
	}
}

static void put_signal(struct lines *lines, const cJSON *cell, const cJSON *signal)
{
	int index = 1;
	const cJSON *oscillator;
	put_scalars(lines, member(cell, "sweep"), "");
	put_scalars(lines, signal, "");
	cJSON_ArrayForEach(oscillator, member(signal, "oscillators"))
	{
		char prefix[32];
		snprintf(prefix, sizeof prefix, "oscillator_%d.", index++);
		put_scalars(lines, oscillator, prefix);
	}
	put_row(lines, signal);
	put_scalars(lines, member(signal, "end"), "end.");
	put_end(lines);
}

static void put_signals(struct lines *lines, const cJSON *cell)
{
	const cJSON *signal;
	cJSON_ArrayForEach(signal, member(cell, "signals"))
	{
		if (lines->header)
			put_signal(lines, cell, signal);
		put_signal(lines, cell, signal);
	}
}

/* The probability to pound with each gap, of the cell or of a contact in it. */
static void put_gaps(struct lines *lines, const cJSON *cell, const cJSON *needs)
{
	const cJSON *gap;
	cJSON_ArrayForEach(gap, member(needs, "pounding")) for (int header = lines->header; header >= 0; header--)
	{
		put_scalars(lines, member(cell, "sweep"), "");
		if (member(needs, "contact"))
			put(lines, "", "contact", member(needs, "contact"));
		put_scalars(lines, gap, "");
		put_end(lines);
	}
}

static void put_trial(struct lines *lines, const cJSON *row, const cJSON *time)
{
	put_scalars(lines, row, "");
	put(lines, "", "cpu_s", time);
	put_end(lines);
}

static void put_trials(struct lines *lines, const cJSON *rows, const cJSON *times)
{
	const cJSON *row, *time = first(times);
	put_trial(lines, first(rows), time);
	cJSON_ArrayForEach(row, rows)
	{
		put_trial(lines, row, time);
		time = behind(time);
	}
}

/* Columns of numbers, one for each array of each spectrum, side by side. */
struct column {
	char name[64];
	const cJSON *next;
};

enum { COLUMNS_MAX = 32 };

static int columns_add(struct column *columns, int n, const cJSON *spectra)
{
	const cJSON *spectrum, *values;
	cJSON_ArrayForEach(spectrum, spectra) cJSON_ArrayForEach(values, spectrum)
	{
		if (!cJSON_IsArray(values) || n == COLUMNS_MAX)
			continue;
		snprintf(columns[n].name, sizeof columns[n].name, "%s.%s",
		         cJSON_GetStringValue(member(spectrum, "name")), values->string);
		columns[n++].next = values->child;
	}
	return n;
}

static void put_spectra(struct writer *w, const cJSON *result)
{
	struct column columns[COLUMNS_MAX] = {{"frequency_hz", first(member(result, "frequencies_hz"))}};
	int n = columns_add(columns, 1, member(result, "spectra"));
	n = columns_add(columns, n, member(member(result, "accuracy"), "spectra"));
	for (int j = 0; j < n; j++) {
		writer_raw(w, ",", j > 0);
		writer_cell(w, columns[j].name);
	}
	writer_raw(w, "\r\n", 2);
	while (columns[0].next) {
		for (int j = 0; j < n; j++) {
			writer_raw(w, ",", j > 0);
			put_value(w, columns[j].next);
			columns[j].next = behind(columns[j].next);
		}
		writer_raw(w, "\r\n", 2);
	}
}

static const struct table *table_named(const char *name)
{
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
		if (strcmp(tables[i].name, name) == 0)
			return &tables[i];
	return NULL;
}

/* Every kind of result by the members that it has. */
static void put_result(struct lines *lines, const cJSON *result)
{
	const cJSON *cells = member(result, "cells"), *cell, *contact;
	if (cJSON_IsArray(member(result, "rows")))
		put_trials(lines, member(result, "rows"), member(member(result, "timing"), "run_cpu_s"));
	else if (cJSON_IsArray(member(result, "spectra")))
		put_spectra(lines->w, result);
	else if (cJSON_IsArray(member(result, "signals")))
		put_signals(lines, result);
	else if (cells && member(first(cells), "pounding"))
		cJSON_ArrayForEach(cell, cells) put_gaps(lines, cell, cell);
	else if (cells && member(first(member(first(cells), "contacts")), "pounding"))
		cJSON_ArrayForEach(cell, cells) cJSON_ArrayForEach(contact, member(cell, "contacts"))
		    put_gaps(lines, cell, contact);
	else if (cells && member(first(cells), "signals"))
		cJSON_ArrayForEach(cell, cells) put_signals(lines, cell);
	else
		put_sensitivity(lines, &tables[0], result);
}

/* A result as CSV (RFC 4180).
 *
 * Given    json      (json_length)  -  the bytes of result_to_json
 *          table     -              -  one of RESULT_TABLES; NULL: the first, or whatever other kinds have
 * Returns  value     (length)       -  CSV, empty when the result has no such table; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     unit_result_csv: a_row_for_every_cell_output_and_input
 */
char *result_to_csv(const char *json, size_t json_length, const char *table, size_t *length)
{
	struct json_fault fault;
	struct writer w;
	struct lines lines = {.w = &w, .header = true};
	*length = 0;
	cJSON *result = json_parse(json, json_length, &fault);
	if (!result)
		return NULL;
	writer_init(&w);
	if (!table)
		put_result(&lines, result);
	else if (strcmp(table, "stopping") == 0)
		put_stopping(&lines, result);
	else if (table_named(table))
		put_sensitivity(&lines, table_named(table), result);
	cJSON_Delete(result);
	return writer_take(&w, length);
}
