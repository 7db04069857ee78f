/* result_csv.c - a result -> CSV, from its JSON: whatever members a result has become columns.
 *
 * Sensitivity: one row per cell, output and input.  Response: one row per cell and signal.  Convergence: one row per
 * setting, its time beside it.  Floor spectra: one row per frequency. */
#include <stdio.h>
#include <string.h>

#include "schema/document.h"
#include "schema/result_json.h"
#include "schema/writer.h"

static const cJSON *member(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

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

static void put_comma(struct writer *w, bool *first)
{
	if (!*first)
		writer_raw(w, ",", 1);
	*first = false;
}

/* The scalar members of an object, each a cell: its name in the header row, its value in the others. */
static void put_scalars(struct writer *w, const cJSON *object, const char *prefix, bool header, bool *first)
{
	const cJSON *value;
	cJSON_ArrayForEach(value, object)
	{
		if (cJSON_IsArray(value) || cJSON_IsObject(value) || strcmp(value->string, "note") == 0)
			continue;
		put_comma(w, first);
		if (!header) {
			put_value(w, value);
			continue;
		}
		char name[256];
		snprintf(name, sizeof name, "%s%s", prefix, value->string);
		writer_cell(w, name);
	}
}

static void put_sensitivity_row(struct writer *w, const cJSON *cell, const cJSON *output, const cJSON *input,
                                const cJSON *input_accuracy, bool header)
{
	bool first = true;
	put_scalars(w, member(cell, "sweep"), "", header, &first);
	put_scalars(w, output, "output.", header, &first);
	put_scalars(w, member(output, "excitation"), "output.excitation.", header, &first);
	put_scalars(w, member(output, "accuracy"), "output.accuracy.", header, &first);
	put_scalars(w, input, "", header, &first);
	put_scalars(w, input_accuracy, "accuracy.", header, &first);
	writer_raw(w, "\r\n", 2);
}

static void put_sensitivity(struct writer *w, const cJSON *cells)
{
	bool header = true;
	int place = 0; /* of the input */
	const cJSON *cell, *output, *input;
	cJSON_ArrayForEach(cell, cells) cJSON_ArrayForEach(output, member(cell, "outputs"))
	    cJSON_ArrayForEach(input, member(output, "inputs"))
	{
		const cJSON *accuracy = cJSON_GetArrayItem(member(member(output, "accuracy"), "inputs"), place);
		place = input->next ? place + 1 : 0;
		if (header)
			put_sensitivity_row(w, cell, output, input, accuracy, true);
		header = false;
		put_sensitivity_row(w, cell, output, input, accuracy, false);
	}
}

static void put_signal_row(struct writer *w, const cJSON *cell, const cJSON *signal, bool header)
{
	bool first = true;
	int index = 1;
	const cJSON *oscillator;
	put_scalars(w, member(cell, "sweep"), "", header, &first);
	put_scalars(w, signal, "", header, &first);
	cJSON_ArrayForEach(oscillator, member(signal, "oscillators"))
	{
		char prefix[32];
		snprintf(prefix, sizeof prefix, "oscillator_%d.", index++);
		put_scalars(w, oscillator, prefix, header, &first);
	}
	put_scalars(w, member(signal, "end"), "end.", header, &first);
	writer_raw(w, "\r\n", 2);
}

static void put_signals(struct writer *w, const cJSON *cell, bool *header)
{
	const cJSON *signal;
	cJSON_ArrayForEach(signal, member(cell, "signals"))
	{
		if (*header)
			put_signal_row(w, cell, signal, true);
		*header = false;
		put_signal_row(w, cell, signal, false);
	}
}

static void put_trials(struct writer *w, const cJSON *rows, const cJSON *times)
{
	bool first = true;
	put_scalars(w, rows->child, "", true, &first);
	writer_raw(w, ",cpu_s\r\n", 8);
	const cJSON *row, *time = times->child;
	cJSON_ArrayForEach(row, rows)
	{
		first = true;
		put_scalars(w, row, "", false, &first);
		put_comma(w, &first);
		put_value(w, time);
		writer_raw(w, "\r\n", 2);
		time = time->next;
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
	struct column columns[COLUMNS_MAX] = {{"frequency_hz", member(result, "frequencies_hz")->child}};
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
			columns[j].next = columns[j].next->next;
		}
		writer_raw(w, "\r\n", 2);
	}
}

/* A result as CSV (RFC 4180).
 *
 * Given    json      (json_length)  -  the bytes of result_to_json
 * Returns  value     (length)       -  CSV; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     unit_result_csv: a_row_for_every_cell_output_and_input
 */
char *result_to_csv(const char *json, size_t json_length, size_t *length)
{
	struct gate_fault fault;
	struct writer w;
	bool header = true;
	*length = 0;
	cJSON *result = document_parse(json, json_length, &fault);
	if (!result)
		return NULL;
	const cJSON *cells = member(result, "cells"), *cell;
	writer_init(&w);
	if (cJSON_IsArray(member(result, "rows")))
		put_trials(&w, member(result, "rows"), member(member(result, "timing"), "run_cpu_s"));
	else if (cJSON_IsArray(member(result, "spectra")))
		put_spectra(&w, result);
	else if (cJSON_IsArray(member(result, "signals")))
		put_signals(&w, result, &header);
	else if (cells && member(cells->child, "signals"))
		cJSON_ArrayForEach(cell, cells) put_signals(&w, cell, &header);
	else
		put_sensitivity(&w, cells);
	cJSON_Delete(result);
	return writer_take(&w, length);
}
