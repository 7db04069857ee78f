/* indices_table.c - a sensitivity result has one block for each cell and output:
 *
 *   /oscillators/0/frequency_hz = 2
 *
 *   force_amplification: mean 1.071, variance 0.02893, variance fraction due to noise 0.113
 *     input    S1 [95 % interval]       ST [95 % interval]       ST from 0 to 1
 *     f_e       0.101 [ 0.021,  0.180]   0.412 [ 0.351,  0.472]  |#######         |
 *     widest 95 % interval: +-0.22 with 125 rows, +-0.16 with 250, +-0.11 with 500, +-0.081 with 1000
 *     about 4000 rows, 4 times as many, halve its width
 *     300 runs repeated with half the sample step: relative differences 1e-14 (median) to 2e-13 change no index by more than 3e-15
 *
 * and then a table for each other list of estimates, with the names that the estimates have in the JSON. */
#include "client/indices_table.h"

#include "client/cell.h"
#include "client/command.h"
#include "client/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_SIZE = 128 };    /* of the JSON Pointer of a value in a result */
enum { CHART = 16 };         /* columns of the chart of total indices */
enum { ESTIMATES_MAX = 32 }; /* of one list */
enum { INDENT = 2 };

/* ---- one estimate ---- */

/* An estimate and its interval: exact " 0.412 [ 0.351,  0.472]", else " 0.412 [0.35,0.47]"; "" if all are missing. */
static void interval(char *text, size_t size, const struct reading *result, const char *of, const char *index,
                     bool exact)
{
	static const char *const ends[] = {"", "_low", "_high"};
	char part[3][24];
	for (int i = 0; i < 3; i++) {
		double value = reading_number(result, "%s/%s%s", of, index, ends[i]);
		const char *form = exact || i == 0 ? "%6.3f" : "%.2f", *none = exact ? "     -" : "-";
		if (isfinite(value))
			table_round(part[i], sizeof part[i], form, value);
		else
			snprintf(part[i], sizeof part[i], "%s", none);
	}
	snprintf(text, size, exact ? "%s [%s, %s]" : "%s [%s,%s]", part[0], part[1], part[2]);
	if (!strpbrk(text, "0123456789"))
		*text = 0;
}

/* A bar for a share; empty text if the share is missing, because an empty bar means 0. */
static void chart(char text[CHART + 3], double share)
{
	*text = 0;
	if (!isfinite(share))
		return;
	long full = lround(fmin(fmax(share, 0.0), 1.0) * CHART);
	text[0] = '|';
	memset(text + 1, ' ', CHART);
	memset(text + 1, '#', (size_t)full);
	strcpy(text + 1 + CHART, "|");
}

/* S1 and ST of all inputs, the indices to quote. */
static void print_quoted(const struct reading *result, const char *output)
{
	static const char *const columns[] = {"input", " S1 [95 % interval]", " ST [95 % interval]",
	                                      "ST from 0 to 1", NULL};
	struct table *table = table_open(1, columns);
	table_keep_chart(table);
	char input[PATH_SIZE], text[80];
	for (int j = 0; j < reading_count(result, "%s/inputs", output); j++) {
		snprintf(input, sizeof input, "%s/inputs/%d", output, j);
		const char *name = reading_text(result, "%s/name", input);
		table_text(table, name ? name : reading_text(result, "%s/path", input));
		interval(text, sizeof text, result, input, "S1", true);
		table_text(table, text);
		interval(text, sizeof text, result, input, "ST", true);
		table_text(table, text);
		chart(text, reading_number(result, "%s/ST", input));
		table_text(table, text);
	}
	table_print(table, INDENT);
	table_close(table);
}

/* ---- any list of estimates ---- */

/* A list in a result, or one object, whose numbers have intervals. */
struct estimates {
	const struct reading *result;
	const char *at;    /* its JSON Pointer in the result */
	const char *about; /* head of the first column: what an element describes */
	int n_rows;        /* elements of the list; 0: an object */
	int n;
	const char *names[ESTIMATES_MAX]; /* (n) */
};

static void row_path(const struct estimates *of, int row, char path[PATH_SIZE])
{
	if (of->n_rows)
		snprintf(path, PATH_SIZE, "%s/%d", of->at, row);
	else
		snprintf(path, PATH_SIZE, "%s", of->at);
}

/* Whether a member is an estimate: in some row it has a value and an interval. */
static bool is_estimate(const struct estimates *of, const char *name)
{
	char path[PATH_SIZE];
	for (int row = 0; row < (of->n_rows ? of->n_rows : 1); row++) {
		row_path(of, row, path);
		if (reading_has(of->result, "%s/%s_low", path, name) &&
		    isfinite(reading_number(of->result, "%s/%s", path, name)))
			return true;
	}
	return false;
}

/* Finds the names of all estimates except the space-separated names in `but`. */
static void estimates_find(struct estimates *of, const char *but)
{
	char row[PATH_SIZE];
	const char *name;
	of->n_rows = reading_type(of->result, "%s", of->at) == 'a' ? reading_count(of->result, "%s", of->at) : 0;
	row_path(of, 0, row);
	of->n = 0;
	for (int i = 0; (name = reading_member(of->result, i, "%s", row)) && of->n < ESTIMATES_MAX; i++) {
		char *padded = command_text(" %s ", name);
		if (is_estimate(of, name) && !strstr(but, padded))
			of->names[of->n++] = name;
		free(padded);
	}
}

/* Label of a row: its name, or the names of its inputs; the caller frees it. */
static char *row_label(const struct estimates *of, int row)
{
	char path[PATH_SIZE];
	row_path(of, row, path);
	const char *name = reading_text(of->result, "%s/name", path), *input;
	char *label = command_text("%s", name ? name : "");
	for (int k = 0; (input = reading_text(of->result, "%s/inputs/%d", path, k)); k++)
		label = command_append(label, "%s%s", k ? ", " : "", input);
	return label;
}

/* Prints a table of all estimates of a list except the space-separated names in `but`. */
static void print_estimates(const struct reading *result, const char *output, const char *list,
                            const char *about, const char *but)
{
	char at[PATH_SIZE];
	snprintf(at, sizeof at, "%s/%s", output, list);
	struct estimates of = {.result = result, .at = at, .about = about};
	estimates_find(&of, but);
	if (of.n == 0)
		return;
	const char *columns[ESTIMATES_MAX + 2] = {of.about};
	memcpy(columns + 1, of.names, (size_t)of.n * sizeof *columns);
	struct table *table = table_open(1, columns);
	for (int row = 0; row < (of.n_rows ? of.n_rows : 1); row++) {
		char path[PATH_SIZE], text[80], *label = row_label(&of, row);
		row_path(&of, row, path);
		table_text(table, *label ? label : "");
		free(label);
		for (int k = 0; k < of.n; k++) {
			interval(text, sizeof text, result, path, of.names[k], false);
			table_text(table, *text ? text : NULL);
		}
	}
	putchar('\n');
	table_print(table, INDENT);
	table_close(table);
}

/* ---- notes and accuracy of an output ---- */

static void print_note(const char *note)
{
	char *sentence = command_text("note: %s", note);
	table_prose(INDENT, sentence);
	free(sentence);
}

/* Prints the note of an input, if any. */
static void print_input_note(const struct reading *result, const char *output, int j)
{
	const char *name = reading_text(result, "%s/inputs/%d/name", output, j);
	const char *note = reading_text(result, "%s/inputs/%d/note", output, j);
	if (!note)
		return;
	char *of_input =
	    command_text("%s: %s", name ? name : reading_text(result, "%s/inputs/%d/path", output, j), note);
	print_note(of_input);
	free(of_input);
}

/* Correlation of a floor spectrum ordinate with the largest impulse. */
static void print_correlation(const struct reading *result, const char *output)
{
	double correlation = reading_number(result, "%s/impulse_correlation", output);
	if (isfinite(correlation))
		printf("  correlation with the largest impulse %.3f [%.3f, %.3f]\n", correlation,
		       reading_number(result, "%s/impulse_correlation_low", output),
		       reading_number(result, "%s/impulse_correlation_high", output));
}

static void print_output_head(const struct reading *result, const char *output)
{
	static const struct measure measures[] = {{"variance", ", variance %.4g", 1},
	                                          {"noise_share", ", variance fraction due to noise %.4g", 1},
	                                          {"ratio_bias", ", bias of the ratio estimator %.4g", 1},
	                                          {"explained", ", cross-validated R2 of the polynomial %.4g", 1},
	                                          {NULL, NULL, 0}};
	char *head = cell_output(result, output, measures);
	putchar('\n');
	table_prose(0, head);
	free(head);
	if (reading_text(result, "%s/note", output))
		print_note(reading_text(result, "%s/note", output));
	print_correlation(result, output);
}

/* Largest half-width of the intervals of S1 and ST at one number of rows. */
static double widest(const struct reading *result, const char *accuracy, int level)
{
	static const char *const halves[] = {"S1_half_widths", "ST_half_widths"};
	double most = NAN;
	for (int j = 0; j < reading_count(result, "%s/inputs", accuracy); j++)
		for (int h = 0; h < 2; h++)
			most = fmax(most, reading_number(result, "%s/inputs/%d/%s/%d", accuracy, j, halves[h], level));
	return most;
}

/* Sampling and integration error of the indices of an output. */
static void print_accuracy(const struct reading *result, const char *output)
{
	char accuracy[PATH_SIZE];
	snprintf(accuracy, sizeof accuracy, "%s/accuracy", output);
	if (reading_count(result, "%s/rows", accuracy) == 0)
		return;
	char *line = command_text("%s", "widest 95 % interval:");
	for (int k = 0; k < reading_count(result, "%s/rows", accuracy); k++) {
		double half = widest(result, accuracy, k);
		if (!isfinite(half)) {
			free(line);
			return;
		}
		line = command_append(line, "%s +-%.2g with %.0f%s", k ? "," : "", half,
		                      reading_number(result, "%s/rows/%d", accuracy, k), k ? "" : " rows");
	}
	table_prose(INDENT, line);
	free(line);
	double rows = reading_number(result, "%s/rows_to_halve", accuracy);
	const double used =
	    reading_number(result, "%s/rows/%d", accuracy, reading_count(result, "%s/rows", accuracy) - 1);
	if (isfinite(rows))
		printf("  about %.0f rows, %.2g times as many, halve its width\n", rows, rows / used);
	double checked = reading_number(result, "%s/runs_checked", accuracy);
	double change = reading_number(result, "%s/errors/integration", accuracy);
	char *checks = command_text("%.0f runs repeated with half the sample step", checked);
	if (isfinite(change))
		checks = command_append(
		    checks, ": relative differences %.2g (median) to %.2g change no index by more than %.2g",
		    reading_number(result, "%s/difference_median", accuracy),
		    reading_number(result, "%s/difference_largest", accuracy), change);
	if (checked > 0.0)
		table_prose(INDENT, checks);
	free(checks);
	const char *note = reading_text(result, "%s/note", accuracy);
	if (note)
		table_prose(INDENT, note);
}

/* ---- tables of an output ---- */

static void print_inputs(const struct reading *result, const char *output)
{
	print_quoted(result, output);
	for (int j = 0; j < reading_count(result, "%s/inputs", output); j++)
		print_input_note(result, output, j);
	print_accuracy(result, output);
}

static void print_others(const struct reading *result, const char *output)
{
	print_estimates(result, output, "inputs", "input", " S1 ST ");
	// inputs of an external model have no path
	const bool own = !reading_text(result, "%s/inputs/0/path", output);
	print_estimates(result, output, "excitation", own ? "noise of replicates" : "noise of signals", "");
}

static void print_second_order(const struct reading *result, const char *output)
{
	print_estimates(result, output, "second_order", "inputs", "");
}

static void print_closed(const struct reading *result, const char *output)
{
	print_estimates(result, output, "closed", "inputs", "");
}

static void print_groups(const struct reading *result, const char *output)
{
	print_estimates(result, output, "groups", "group", "");
}

static void print_ratios(const struct reading *result, const char *output)
{
	print_estimates(result, output, "ratios/variables", "variable", "");
	char ratios[PATH_SIZE], explained[80];
	snprintf(ratios, sizeof ratios, "%s/ratios", output);
	interval(explained, sizeof explained, result, ratios, "explained", false);
	if (*explained)
		printf("  together these variables explain %s of the variance\n", explained + strspn(explained, " "));
	if (reading_text(result, "%s/note", ratios))
		print_note(reading_text(result, "%s/note", ratios));
}

/* Conditional means, each curve as digits: 0 is its lowest value, 9 its highest. */
static void print_curves(const struct reading *result, const char *output)
{
	static const char *const columns[] = {
	    "input", "from", "to", "lowest", "highest", "mean output: 0 lowest ... 9 highest", NULL};
	struct table *table = table_open(1, columns);
	table_keep_chart(table);
	for (int j = 0; j < reading_count(result, "%s/conditional_means", output); j++) {
		char curve[PATH_SIZE], digits[128] = "";
		double low = NAN, high = NAN;
		snprintf(curve, sizeof curve, "%s/conditional_means/%d", output, j);
		int n = reading_count(result, "%s/mean", curve);
		for (int k = 0; k < n; k++) {
			double mean = reading_number(result, "%s/mean/%d", curve, k);
			low = fmin(low, mean), high = fmax(high, mean);
		}
		for (int k = 0; k < n && k < (int)sizeof digits - 1; k++) {
			double part = (reading_number(result, "%s/mean/%d", curve, k) - low) / (high - low);
			digits[k] = isfinite(part) ? (char)('0' + (int)fmin(10 * part, 9)) : '-';
		}
		table_text(table, reading_text(result, "%s/name", curve));
		table_number(table, reading_number(result, "%s/x/0", curve));
		table_number(table, reading_number(result, "%s/x/%d", curve, n - 1));
		table_number(table, low);
		table_number(table, high);
		table_text(table, digits);
	}
	putchar('\n');
	table_print(table, INDENT);
	table_close(table);
}

// clang-format off
/* Sections of an output in print order. */
static const struct {
	const char *name; /* member of the output in the JSON; the names in RESULT_TABLES can be requested with --table */
	void (*print)(const struct reading *result, const char *output);
} SECTIONS[] = {
	{"inputs",            print_inputs},
	{"excitation",        print_others},
	{"second_order",      print_second_order},
	{"closed",            print_closed},
	{"groups",            print_groups},
	{"ratios",            print_ratios},
	{"conditional_means", print_curves},
};
// clang-format on

/* Prints the named section of every output; NULL: all sections. */
static void print_outputs(const struct reading *result, const char *name)
{
	char cell[PATH_SIZE / 4], output[PATH_SIZE / 2];
	for (int c = 0; c < reading_count(result, "/cells"); c++) {
		snprintf(cell, sizeof cell, "/cells/%d", c);
		cell_sweep(result, c);
		cell_failed(result, cell);
		for (int o = 0; o < reading_count(result, "%s/outputs", cell); o++) {
			snprintf(output, sizeof output, "%s/outputs/%d", cell, o);
			print_output_head(result, output);
			for (size_t k = 0; k < sizeof SECTIONS / sizeof SECTIONS[0]; k++)
				if (reading_has(result, "%s/%s", output, SECTIONS[k].name) &&
				    (!name || strcmp(name, SECTIONS[k].name) == 0))
					SECTIONS[k].print(result, output);
		}
		for (int k = 0; reading_has(result, "%s/not_applicable/%d", cell, k); k++) {
			char *line = command_text("%s: does not apply: it %s",
			                          reading_text(result, "%s/not_applicable/%d/name", cell, k),
			                          reading_text(result, "%s/not_applicable/%d/note", cell, k));
			putchar('\n');
			table_prose(0, line);
			free(line);
		}
	}
}

/* ---- the design ---- */

/* Marks an intermediate result. */
static void print_partial(const struct reading *result)
{
	if (!reading_has(result, "/partial"))
		return;
	printf("\nPARTIAL RESULT, %.0f of %.0f rows: ", reading_number(result, "/partial/rows"),
	       reading_number(result, "/partial/rows_most"));
	table_say(reading_text(result, "/partial/note"));
	putchar('\n');
}

/* The chosen number of signals per row, and the expected accuracy of other choices. */
static void print_split(const struct reading *result)
{
	static const char *const columns[] = {"signals", "rows", "runs", "half_width", "bias", NULL};
	struct table *table = table_open(1, columns);
	putchar('\n');
	table_prose(0, reading_text(result, "/stopping/signals/note"));
	for (int k = 0; k < reading_count(result, "/stopping/signals/choices"); k++)
		for (int c = 0; columns[c]; c++)
			table_number(table, reading_number(result, "/stopping/signals/choices/%d/%s", k, columns[c]));
	table_print(table, INDENT);
	table_close(table);
}

/* How the design grew. */
static void print_growth(const struct reading *result)
{
	static const char *const columns[] = {"rows", "runs", "half_width", "index", "input", "output", NULL};
	struct table *table = table_open(1, columns);
	char *sentence = command_text("%.0f rows: %s", reading_number(result, "/stopping/rows"),
	                              reading_text(result, "/stopping/note"));
	putchar('\n');
	table_prose(0, sentence);
	free(sentence);
	for (int k = 0; k < reading_count(result, "/stopping/looks"); k++) {
		for (int c = 0; c < 3; c++)
			table_number(table, reading_number(result, "/stopping/looks/%d/%s", k,
			                                   c == 2 ? "half_width" : columns[c]));
		for (int c = 3; columns[c]; c++)
			table_text(table, reading_text(result, "/stopping/looks/%d/%s", k, columns[c]));
	}
	table_print(table, INDENT);
	table_close(table);
}

static void print_stopping(const struct reading *result)
{
	if (reading_has(result, "/stopping/signals/note"))
		print_split(result);
	if (reading_has(result, "/stopping/note"))
		print_growth(result);
}

/* CPU time at several numbers of rows. */
static void print_cost(const struct reading *result)
{
	char *sentence = command_text("CPU time:");
	if (reading_has(result, "/timing"))
		putchar('\n');
	for (int k = 0; k < reading_count(result, "/timing/rows"); k++)
		sentence = command_append(sentence, "%s %.2g%s with %.0f%s", k ? "," : "",
		                          reading_number(result, "/timing/rows/%d/cpu_s", k), k ? "" : " s",
		                          reading_number(result, "/timing/rows/%d/rows", k), k ? "" : " rows");
	if (reading_count(result, "/timing/rows") > 0)
		table_prose(INDENT, sentence);
	free(sentence);
}

static void print_design(const struct reading *result)
{
	double randomisations = reading_number(result, "/design/randomisations");
	fputs("design ", stdout);
	table_say(reading_text(result, "/design/method"));
	printf(", %.0f rows", reading_number(result, "/design/rows"));
	if (isfinite(randomisations))
		printf(" in %.0f randomisations", randomisations);
	putchar('\n');
	if (reading_text(result, "/design/note"))
		table_prose(0, reading_text(result, "/design/note"));
}

void indices_print(const struct reading *result)
{
	print_design(result);
	print_partial(result);
	if (reading_has(result, "/stopping"))
		print_stopping(result);
	print_outputs(result, NULL);
	print_cost(result);
}

/* Indices from given samples, after the checks of the samples. */
void given_data_print(const struct reading *result)
{
	const double missing = reading_number(result, "/given/samples_missing");
	const double samples = reading_number(result, "/given/samples"),
	             points = reading_number(result, "/given/points"),
	             lines = reading_number(result, "/cells/0/runs");
	printf("%.0f samples", samples);
	if (points < samples)
		printf(" at %.0f different points", points);
	if (lines > samples)
		printf(", the means of %.0f lines", lines);
	if (missing > 0)
		printf("; %.0f more are left out because a number is missing", missing);
	putchar('\n');
	if (reading_has(result, "/given/most_dependent")) {
		fputs("inputs with the strongest dependence: ", stdout);
		table_say(reading_text(result, "/given/most_dependent/0"));
		fputs(" and ", stdout);
		table_say(reading_text(result, "/given/most_dependent/1"));
		char correlation[16];
		table_round(correlation, sizeof correlation, "%.2f",
		            reading_number(result, "/given/rank_correlation"));
		printf(", rank correlation %s\n", correlation);
	}
	for (int k = 0; k < reading_count(result, "/given/notes"); k++)
		print_note(reading_text(result, "/given/notes/%d", k));
	print_outputs(result, NULL);
}

/* Whether the section exists in any output of any cell. */
static bool section_anywhere(const struct reading *result, const char *name)
{
	bool is = false, any = false;
	for (size_t k = 0; k < sizeof SECTIONS / sizeof SECTIONS[0]; k++)
		is |= strcmp(name, SECTIONS[k].name) == 0;
	for (int c = 0; is && c < reading_count(result, "/cells"); c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++)
			any |= reading_has(result, "/cells/%d/outputs/%d/%s", c, o, name);
	return any;
}

bool indices_have_table(const struct reading *result, const char *table)
{
	return strcmp(table, "stopping") == 0 ? reading_has(result, "/stopping")
	                                      : section_anywhere(result, table);
}

bool indices_print_table(const struct reading *result, const char *table)
{
	if (!indices_have_table(result, table))
		return false;
	print_partial(result);
	if (strcmp(table, "stopping") == 0)
		print_stopping(result);
	else
		print_outputs(result, table);
	return true;
}
