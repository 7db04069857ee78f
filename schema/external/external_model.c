/* external_model.c - an external model: writes the rows of a design as CSV, and computes indices from its outputs in CSV.
 *
 * 1. The header gives the role of each column: output, variance or replicate of an output, or input.
 * 2. The lines after the header are the samples of the design, in its order; inputs, if given, must equal the design's.
 * 3. The run reduces these outputs in the same way as outputs of its own runs. */
#include "schema/external/external_model.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/external/csv_reader.h"
#include "schema/json/json_writer.h"
#include "schema/result/result_json.h"

/* ---- rows out ---- */

static void put_number(struct writer *w, double value)
{
	char digits[WRITER_NUMBER_SIZE];
	writer_raw(w, digits, (size_t)writer_digits(value, digits));
}

/* Lines of a design.
 *
 * Given    study, run  -         -       the run's design
 *          first, n    -         -       rows to write, one line per sample; a header before row 0
 * Returns  value       (length)  -       CSV, lines end with a newline only; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     unit_external_model: rows_come_in_the_order_of_the_contract_and_read_back_to_the_same_numbers
 */
char *model_rows(const struct pound_study *study, const struct pound_run *run, int first, int n,
                 size_t *length)
{
	struct writer w;
	writer_init(&w);
	for (int j = 0; j < study->n_inputs && first == 0; j++) {
		writer_cell(&w, study->inputs[j].name);
		writer_raw(&w, j + 1 < study->n_inputs ? "," : "\n", 1);
	}
	for (int row = first; row < first + n; row++)
		for (int sample = 0; sample < pound_run_samples(run); sample++) {
			double x[POUND_INPUTS_MAX];
			pound_run_sample_inputs(run, row, sample, x);
			for (int j = 0; j < study->n_inputs; j++) {
				put_number(&w, x[j]);
				writer_raw(&w, j + 1 < study->n_inputs ? "," : "\n", 1);
			}
		}
	return writer_take(&w, length);
}

/* ---- columns ---- */

// so that squares of outputs, and products of squares, do not overflow
static const double OUTPUT_MOST = 1e60, VARIANCE_MOST = 1e120;

/* Faults of cells below the header. */
enum fault_kind { FAULT_NUMBER, FAULT_RANGE, FAULT_INPUT, N_FAULTS };

enum role { ROLE_OUTPUT, ROLE_VARIANCE, ROLE_REPLICATE, ROLE_INPUT, ROLE_OTHER };

enum { REPLICATES_MAX = 1000 };

struct column {
	char *name;
	enum role role;
	int index;     /* index of the output or input */
	int replicate; /* from 1; 0: not a replicate */
	struct csv_fault faults[N_FAULTS];
};

struct outputs {
	struct pound_study study; /* the given study with these outputs */
	int n_columns;
	struct column *columns; /* (n_columns) */
	char **names;           /* of the outputs  (study.n_outputs) */
	char **stems; /* names that are not column names, to be freed; NULL: it is a column name  (n_columns) */
};

/* Whether a name in a header is the name of an input, with or without the apostrophe of writer_cell. */
static bool is_input(const struct pound_input *input, const char *name)
{
	bool guarded = *name == '\'' && strchr("=+-@", input->name[0]);
	return strcmp(input->name, name + guarded) == 0;
}

static int column_named(const struct outputs *outputs, int n, const char *name, size_t length)
{
	for (int c = 0; c < n; c++)
		if (strncmp(outputs->columns[c].name, name, length) == 0 && !outputs->columns[c].name[length])
			return c;
	return -1;
}

static void column_role(const struct outputs *outputs, struct column *column)
{
	column->role = ROLE_OUTPUT;
	if (strcmp(column->name, "row") == 0 || strcmp(column->name, "sample") == 0)
		column->role = ROLE_OTHER;
	if (csv_variance_stem(column->name) > 0)
		column->role = ROLE_VARIANCE;
	if (csv_replicate_stem(column->name, &column->replicate) > 0)
		column->role = ROLE_REPLICATE;
	for (int j = 0; j < outputs->study.n_inputs; j++)
		if (is_input(&outputs->study.inputs[j], column->name)) {
			column->role = ROLE_INPUT;
			column->index = j;
		}
}

/* Joins columns of replicates to outputs.  All outputs must have the same number of replicates, and none may have none.
 *
 * Returns  value  number of outputs
 */
static int replicates_join(struct outputs *outputs, struct csv *csv, int n_outputs)
{
	const int single = n_outputs;
	int most = 0, n = 0;
	for (int c = 0; c < outputs->n_columns; c++) {
		struct column *column = &outputs->columns[c];
		if (column->role != ROLE_REPLICATE)
			continue;
		const size_t stem = csv_replicate_stem(column->name, &column->replicate);
		int o = single;
		while (o < n_outputs &&
		       (strlen(outputs->names[o]) != stem || strncmp(outputs->names[o], column->name, stem) != 0))
			o++;
		if (o == n_outputs &&
		    !(outputs->names[n_outputs++] = outputs->stems[o] = strndup(column->name, stem)))
			csv->problems->status = PROBLEMS_NOMEM;
		column->index = o;
		most = column->replicate > most ? column->replicate : most;
		n++;
	}
	if (n == 0 || csv->problems->status == PROBLEMS_NOMEM)
		return n_outputs;
	char what[160];
	snprintf(what, sizeof what,
	         "replicates must be numbered from 1 to the same number, 2 to %d, for every output",
	         REPLICATES_MAX);
	// column names are unique, so if the number of columns is right, each number occurs once
	if (most < 2 || most > REPLICATES_MAX || n != most * (n_outputs - single))
		csv_complain(csv, NULL, what);
	if (single > 0)
		csv_complain(
		    csv, outputs->names[0],
		    "has no replicates, but other outputs have; expected NAME.replicate1, ... of all or of none");
	outputs->study.replicates = most;
	return n_outputs;
}

/* Finds the outputs and the columns of their variances and replicates. */
static void columns_join(struct outputs *outputs, struct csv *csv)
{
	int n_outputs = 0;
	for (int c = 0; c < outputs->n_columns; c++) {
		struct column *column = &outputs->columns[c];
		if (column->role != ROLE_OUTPUT)
			continue;
		column->index = n_outputs;
		outputs->names[n_outputs++] = column->name;
	}
	for (int c = 0; c < outputs->n_columns; c++) {
		struct column *column = &outputs->columns[c];
		if (column->role != ROLE_VARIANCE)
			continue;
		int of = column_named(outputs, outputs->n_columns, column->name, csv_variance_stem(column->name));
		if (of < 0 || outputs->columns[of].role != ROLE_OUTPUT)
			csv_complain(csv, column->name, "has no matching output column");
		else
			column->index = outputs->columns[of].index;
	}
	n_outputs = replicates_join(outputs, csv, n_outputs);
	outputs->study.n_outputs = n_outputs;
	outputs->study.output_names = outputs->names;
	if (n_outputs == 0)
		csv_complain(
		    csv, NULL,
		    "has no output column; expected one per output, and NAME.variance where that is known, or "
		    "NAME.replicate1, NAME.replicate2, ...");
}

static void column_read(struct outputs *outputs, struct csv *csv)
{
	int c = outputs->n_columns;
	struct column *column = &outputs->columns[c];
	csv_read(csv);
	column->name = strdup(csv->cell);
	if (!column->name) {
		csv->problems->status = PROBLEMS_NOMEM;
		return;
	}
	outputs->n_columns++;
	column_role(outputs, column);
	csv_name_check(csv, c, column_named(outputs, c, column->name, strlen(column->name)));
}

/* Reads the first line: the role of each column. */
static bool header_read(struct outputs *outputs, struct csv *csv)
{
	const char *newline = memchr(csv->at, '\n', (size_t)(csv->end - csv->at));
	size_t n = (size_t)((newline ? newline : csv->end) - csv->at), n_columns = 1;
	if (csv_blank(csv->at, csv->end)) {
		problems_add(csv->problems, "", "is empty; expected a header and one line per sample of the design");
		return false;
	}
	for (size_t i = 0; i < n; i++)
		n_columns += csv->at[i] == ',';
	if (n_columns == 1 && (memchr(csv->at, ';', n) || memchr(csv->at, '\t', n))) {
		csv_complain(csv, NULL, "has no comma; columns must be separated by commas");
		return false;
	}
	outputs->columns = calloc(n_columns, sizeof *outputs->columns);
	outputs->names = calloc(n_columns, sizeof *outputs->names);
	outputs->stems = calloc(n_columns, sizeof *outputs->stems);
	if (!outputs->columns || !outputs->names || !outputs->stems) {
		csv->problems->status = PROBLEMS_NOMEM;
		return false;
	}
	do
		column_read(outputs, csv);
	while (!csv->ended && csv->problems->status != PROBLEMS_NOMEM);
	columns_join(outputs, csv);
	return csv->problems->status == PROBLEMS_NONE;
}

/* ---- lines ---- */

/* A line: its sample in the design and the values of its cells. */
struct line {
	struct pound_run *run;
	int row, sample;
	double x[POUND_INPUTS_MAX];
	double *value;    /* (n_outputs x replicates) */
	double *variance; /* (n_outputs) */
	bool strange;     /* an input that differs from the design was reported */
};

/* Whether an input equals the design's, up to rounding to few digits. */
static bool alike(double given, double wanted)
{
	return fabs(given - wanted) <= 1e-4 * fmax(fabs(given), fabs(wanted)) + 1e-6;
}

/* Number of values of an output in a line. */
static int values_of(const struct outputs *outputs)
{
	return outputs->study.replicates ? outputs->study.replicates : 1;
}

static void cell_take(const struct outputs *outputs, struct csv *csv, struct line *line, int c)
{
	struct column *column = &outputs->columns[c];
	double number;
	if (column->role == ROLE_OTHER)
		return;
	if (!csv_number(csv, &number)) {
		csv_fault_note(&column->faults[FAULT_NUMBER], csv,
		               "must be a decimal number, or empty or nan for a failed run, got \"%.60s\"",
		               csv->cell);
	} else if (column->role == ROLE_OUTPUT || column->role == ROLE_REPLICATE) {
		line->value[column->index * values_of(outputs) + (column->replicate ? column->replicate - 1 : 0)] =
		    number;
		if (fabs(number) > OUTPUT_MOST)
			csv_fault_note(&column->faults[FAULT_RANGE], csv, "must be at most %g in magnitude, got %.60s",
			               OUTPUT_MOST, csv->cell);
	} else if (column->role == ROLE_VARIANCE) {
		line->variance[column->index] = isfinite(number) ? number : INFINITY;
		if (number < 0)
			csv_fault_note(&column->faults[FAULT_RANGE], csv, "must be at least 0, got %.60s", csv->cell);
		else if (number > VARIANCE_MOST)
			csv_fault_note(&column->faults[FAULT_RANGE], csv, "must be at most %g, got %.60s", VARIANCE_MOST,
			               csv->cell);
	} else if (!line->strange && !alike(number, line->x[column->index])) {
		csv_fault_note(
		    &column->faults[FAULT_INPUT], csv,
		    "is %.15g, but the design has %.15g; check the order of the lines, the seed and rounding", number,
		    line->x[column->index]);
		line->strange = true;
	}
}

/* Passes a line's outputs to the run; if a number is missing, the whole sample counts as failed. */
static void line_assign(const struct outputs *outputs, const struct line *line)
{
	const int n = values_of(outputs);
	bool failed = false;
	for (int o = 0; o < outputs->study.n_outputs; o++) {
		failed |= isinf(line->variance[o]);
		for (int k = 0; k < n; k++)
			failed |= !isfinite(line->value[o * n + k]);
	}
	for (int k = 0; k < outputs->study.n_outputs * n && failed; k++)
		line->value[k] = NAN;
	for (int o = 0; o < outputs->study.n_outputs; o++)
		if (outputs->study.replicates)
			pound_run_replicates_assign(line->run, line->row, line->sample, o, line->value + (size_t)o * n);
		else
			pound_run_sample_assign(line->run, line->row, line->sample, o, line->value[o], line->variance[o]);
}

static void line_read(const struct outputs *outputs, struct csv *csv, struct line *line)
{
	int n = 0;
	csv->line++;
	line->strange = false;
	pound_run_sample_inputs(line->run, line->row, line->sample, line->x);
	for (int o = 0; o < outputs->study.n_outputs; o++)
		line->variance[o] = NAN;
	for (int k = 0; k < outputs->study.n_outputs * values_of(outputs); k++)
		line->value[k] = NAN;
	do {
		csv_read(csv);
		if (n < outputs->n_columns)
			cell_take(outputs, csv, line, n);
		n++;
	} while (!csv->ended);
	csv_length_check(csv, n, outputs->n_columns);
	line_assign(outputs, line);
}

static void faults_report(const struct outputs *outputs, const struct csv *csv)
{
	csv_fault_report(&csv->length, NULL, csv->problems);
	for (int c = 0; c < outputs->n_columns; c++)
		for (int kind = 0; kind < N_FAULTS; kind++)
			csv_fault_report(&outputs->columns[c].faults[kind], outputs->columns[c].name, csv->problems);
}

/* Reads all lines after the header into the run. */
static void lines_read(const struct outputs *outputs, struct csv *csv, struct pound_run *run)
{
	const size_t n_outputs = (size_t)outputs->study.n_outputs, n_values = n_outputs * values_of(outputs);
	double *numbers = calloc(n_outputs + n_values, sizeof *numbers);
	struct line line = {.run = run, .value = numbers, .variance = numbers + n_values};
	const int n_samples = pound_run_samples(run), rows = pound_run_rows(run);
	int64_t wanted = (int64_t)rows * n_samples, there = csv_lines_left(csv);
	const char *after = csv->at;
	for (int64_t k = 0; k < wanted && after < csv->end; k++) {
		const char *newline = memchr(after, '\n', (size_t)(csv->end - after));
		after = newline ? newline + 1 : csv->end;
	}
	if (!numbers) {
		csv->problems->status = PROBLEMS_NOMEM;
	} else if (there < wanted || !csv_blank(after, csv->end)) {
		problems_add(csv->problems, "",
		             "has %lld lines after the header, expected %lld: %d samples for each of %d rows",
		             (long long)there, (long long)wanted, n_samples, rows);
	} else {
		for (line.row = 0; line.row < rows; line.row++)
			for (line.sample = 0; line.sample < n_samples; line.sample++)
				line_read(outputs, csv, &line);
		faults_report(outputs, csv);
	}
	free(numbers);
}

/* ---- the result ---- */

static void check_study(const struct pound_study *study, struct problems *problems)
{
	if (study->n_sweeps)
		problems_add(problems, "/sweep",
		             "a study of an external model has one cell, so it cannot have a sweep");
}

static char *reduce(const struct outputs *outputs, struct pound_run *run, size_t *length)
{
	for (int k = 0; k < pound_run_reductions(run); k++) {
		enum pound_status status = pound_run_reduce(run, k, 0);
		assert(status == POUND_OK);
		(void)status;
	}
	return result_to_json(&outputs->study, pound_run_result(run), NULL, length);
}

/* Computes the indices of an external model's outputs.
 *
 * Given    study     -             -   read by study_design_from_json
 *          csv       (csv_length)  -   header, then one line per sample of the design, in the order of model_rows
 * Returns  value     (length)      -   JSON; NULL: failed, see problems->status; pointers are "line 3, NAME"
 * Memory   allocates; the caller frees
 *
 * An output or a variance that is empty or nan marks a failed run: its row is left out for every output.  A growing design has
 * only the rows up to its first check of the intervals.
 *
 * Test     unit_external_model
 */
char *model_indices(const struct pound_study *study, const char *csv, size_t csv_length,
                    struct problems *problems, size_t *length)
{
	static const char mark[] = "\xEF\xBB\xBF"; // byte order mark, which spreadsheets write
	struct outputs outputs = {.study = *study};
	struct csv at = {.at = csv, .end = csv + csv_length, .line = 1, .problems = problems};
	char *json = NULL;
	problems_init(problems);
	if (csv_length >= 3 && memcmp(csv, mark, 3) == 0)
		at.at += 3;
	outputs.study.elsewhere = true;
	check_study(study, problems);
	if (problems->status == PROBLEMS_NONE && csv_is_text(&at) && header_read(&outputs, &at)) {
		struct pound_run *run = pound_run_create(&outputs.study, 1);
		if (run)
			lines_read(&outputs, &at, run);
		if (run && problems->status == PROBLEMS_NONE)
			json = reduce(&outputs, run, length);
		if (json && pound_run_result(run)->cells[0].rows_dropped == pound_run_rows(run)) {
			free(json);
			json = NULL;
			problems_add(problems, "", "no row of the design has all its outputs, so there are no indices");
		}
		pound_run_free(run);
		if (!json && problems->status == PROBLEMS_NONE)
			problems->status = PROBLEMS_NOMEM;
	}
	for (int c = 0; c < outputs.n_columns; c++) {
		free(outputs.columns[c].name);
		free(outputs.stems ? outputs.stems[c] : NULL);
	}
	free(outputs.stems);
	free(outputs.columns);
	free(outputs.names);
	return json;
}
