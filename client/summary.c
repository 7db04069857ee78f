/* summary.c - a sensitivity result on one screen.  Of few indices each with its interval and a bar:
 *
 *   impulse: mean 0.8992, noise 3.8 %
 *     f_2      S1  0.243 +-0.049  ST  0.626 +-0.092  |#############       |
 *
 * of many a row for each output and a column for each input, from the lowest to the highest over cells, frequencies,
 * stories. */
#include "client/summary.h"
#include "client/cell.h"

#include "client/command.h"
#include "client/table.h"
#include "schema/result/result_json.h"
#include "schema/result/widest_interval.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	LINES_MOST = 11, /* of indices */
	INPUTS_MOST = 64,
	PATH_SIZE = 128,
	LABEL_WIDTH = 32, /* columns of an output's name at most */
	INPUT_WIDTH = 14, /* of an input's, beside both indices and a bar */
	CELL_WIDTH = 14,  /* "-0.01 to 0.74", and a blank */
	CHART = 20,
};

/* An index of one input over what a result has under one output's name. */
struct span {
	double low, high;
};

struct row {
	const char *output;
	int n; /* outputs of that name in a cell: frequencies, stories */
	struct span spans[INPUTS_MOST];
};

struct summary {
	const struct reading *result;
	bool total; /* ST has values, else S1 */
	int n_cells, n_outputs, n_rows, n_inputs;
	struct row *rows;                /* (n_rows) */
	const char *inputs[INPUTS_MOST]; /* (n_inputs) */
	int order[INPUTS_MOST];          /* (n_inputs) the largest first */
};

/* ---- what the result has ---- */

static const char *input_name(const struct reading *result, const char *output, int input)
{
	const char *name = reading_text(result, "%s/inputs/%d/name", output, input);
	name = name ? name : reading_text(result, "%s/inputs/%d/path", output, input);
	return name ? name : "?";
}

static struct row *row_of(struct summary *summary, const char *output)
{
	for (int k = 0; k < summary->n_rows; k++)
		if (strcmp(summary->rows[k].output, output) == 0)
			return &summary->rows[k];
	summary->rows =
	    command_sure(realloc(summary->rows, (size_t)(summary->n_rows + 1) * sizeof *summary->rows));
	struct row *row = &summary->rows[summary->n_rows++];
	*row = (struct row){.output = output};
	for (int j = 0; j < INPUTS_MOST; j++)
		row->spans[j] = (struct span){NAN, NAN};
	return row;
}

/* Whether any index of that name has a value. */
static bool spans_find(struct summary *summary, bool total)
{
	const struct reading *result = summary->result;
	bool any = false;
	summary->total = total;
	summary->n_rows = summary->n_outputs = summary->n_inputs = 0;
	for (int c = 0; c < summary->n_cells; c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++) {
			char output[PATH_SIZE];
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", c, o);
			const char *name = reading_text(result, "%s/name", output);
			struct row *row = row_of(summary, name ? name : "?");
			row->n += c == 0;
			summary->n_outputs += c == 0;
			for (int j = 0; j < reading_count(result, "%s/inputs", output) && j < INPUTS_MOST; j++) {
				double value = reading_number(result, "%s/inputs/%d/%s", output, j, total ? "ST" : "S1");
				row->spans[j].low = fmin(row->spans[j].low, value);
				row->spans[j].high = fmax(row->spans[j].high, value);
				any = any || isfinite(value);
				if (j == summary->n_inputs)
					summary->inputs[summary->n_inputs++] = input_name(result, output, j);
			}
		}
	return any;
}

static double highest(const struct summary *summary, int input)
{
	double most = -INFINITY;
	for (int k = 0; k < summary->n_rows; k++)
		most = fmax(most, summary->rows[k].spans[input].high);
	return most;
}

/* The inputs by their largest index; equal ones in the study's order. */
static void order_find(struct summary *summary)
{
	for (int j = 0; j < summary->n_inputs; j++) {
		int at = j;
		for (; at > 0 && highest(summary, summary->order[at - 1]) < highest(summary, j); at--)
			summary->order[at] = summary->order[at - 1];
		summary->order[at] = j;
	}
}

/* ---- texts ---- */

static void chart(double share)
{
	long full = lround(fmin(fmax(share, 0.0), 1.0) * CHART);
	printf("  |%.*s%*s|", (int)full, "####################", CHART - (int)full, "");
}

/* ---- one cell, few outputs ---- */

/* "  ST  0.626 +-0.092"; nothing where no input has a value. */
static void print_estimate(const struct reading *result, const char *input, const char *index)
{
	double value = reading_number(result, "%s/%s", input, index);
	// of an interval without width the sign is a rounding
	double half = fabs(reading_number(result, "%s/%s_high", input, index) -
	                   reading_number(result, "%s/%s_low", input, index)) /
	              2;
	if (!isfinite(value))
		printf("  %s %6s %7s", index, "-", "");
	else if (half > 0 && half < 0.0005)
		printf("  %s %6.3f +-%-5s", index, value, "<.001");
	else if (isfinite(half))
		printf("  %s %6.3f +-%-5.3f", index, value, half);
	else
		printf("  %s %6.3f %7s", index, value, "");
}

/* Rows without which an output's intervals are too narrow, as its note ends; NAN: those are enough. */
static double rows_needed(const struct reading *result, const char *output)
{
	const char *note = reading_text(result, "%s/note", output),
	           *few = note ? strstr(note, "few rows hold") : NULL;
	const char *colon = few ? strchr(few, ':') : NULL;
	return colon ? strtod(colon + 1, NULL) : NAN;
}

static void print_output(const struct summary *summary, int output)
{
	const struct reading *result = summary->result;
	char at[PATH_SIZE], input[PATH_SIZE + 32];
	int width = 0;
	snprintf(at, sizeof at, "/cells/0/outputs/%d", output);
	static const struct measure measures[] = {{"noise_share", ", noise %.2g %%", 100}, {NULL, NULL, 0}};
	const double needed = rows_needed(result, at);
	char *head = cell_output(result, at, measures);
	if (isfinite(needed))
		head = command_append(head, ", needs %.0f rows", needed);
	table_prose(2, head);
	free(head);
	for (int j = 0; j < summary->n_inputs; j++) {
		int n = table_width(summary->inputs[j]);
		width = n > width ? n : width;
	}
	width = width > INPUT_WIDTH ? INPUT_WIDTH : width;
	for (int k = 0; k < summary->n_inputs; k++) {
		int j = summary->order[k];
		char *label = table_cut(summary->inputs[j], width);
		fputs("    ", stdout);
		table_say(label);
		printf("%*s", width - table_width(label), "");
		free(label);
		snprintf(input, sizeof input, "%s/inputs/%d", at, j);
		print_estimate(result, input, "S1");
		if (summary->total)
			print_estimate(result, input, "ST");
		double share = reading_number(result, "%s/%s", input, summary->total ? "ST" : "S1");
		if (isfinite(share))
			chart(share);
		putchar('\n');
	}
}

static void print_outputs(const struct summary *summary)
{
	// an input of a model of one's own has no path
	const bool own = !reading_text(summary->result, "/cells/0/outputs/0/inputs/0/path");
	printf("\nShare of an output's variance due to an input alone (S1), to an input with its\n"
	       "interactions (ST), to the randomness of %s (noise); +-: 95 %% interval.\n",
	       own ? "replicates" : "motions");
	bool narrow = false;
	for (int o = 0; o < summary->n_outputs; o++) {
		char at[PATH_SIZE];
		snprintf(at, sizeof at, "/cells/0/outputs/%d", o);
		print_output(summary, o);
		narrow |= isfinite(rows_needed(summary->result, at));
	}
	if (narrow)
		puts("Intervals of what needs more rows are too narrow: few rows hold the variance.");
}

/* ---- many of both ---- */

/* No "-0.00". */
static double rounded(double value)
{
	return fabs(value) < 0.005 ? 0.0 : value;
}

static void print_span(const struct span *span)
{
	char text[32] = "-";
	if (isfinite(span->low)) {
		snprintf(text, sizeof text, "%.2f to %.2f", rounded(span->low), rounded(span->high));
		if (span->low == span->high)
			snprintf(text, sizeof text, "%.2f", rounded(span->high));
	}
	printf("%*s", CELL_WIDTH, text);
}

static char *row_label(const struct row *row, int width)
{
	char *whole = row->n > 1 ? command_text("%s (%d)", row->output, row->n) : command_text("%s", row->output);
	char *label = table_cut(whole, width);
	free(whole);
	return label;
}

static void print_rows(const struct summary *summary)
{
	int width = 0, shown = summary->n_rows < LINES_MOST - 1 ? summary->n_rows : LINES_MOST - 1;
	for (int k = 0; k < shown; k++) {
		char *label = row_label(&summary->rows[k], LABEL_WIDTH);
		width = table_width(label) > width ? table_width(label) : width;
		free(label);
	}
	int columns = (TABLE_WIDTH - 2 - width) / CELL_WIDTH;
	columns = columns < summary->n_inputs ? columns : summary->n_inputs;
	printf("%*s", 2 + width, "");
	for (int k = 0; k < columns; k++) {
		char *name = table_cut(summary->inputs[summary->order[k]], CELL_WIDTH - 1);
		command_tame(name);
		printf("%*s%s", CELL_WIDTH - table_width(name), "", name);
		free(name);
	}
	putchar('\n');
	for (int r = 0; r < shown; r++) {
		char *label = row_label(&summary->rows[r], LABEL_WIDTH);
		fputs("  ", stdout);
		table_say(label);
		printf("%*s", width - table_width(label), "");
		free(label);
		for (int k = 0; k < columns; k++)
			print_span(&summary->rows[r].spans[summary->order[k]]);
		putchar('\n');
	}
	if (shown < summary->n_rows)
		printf("  not shown: %d of %d outputs\n", summary->n_rows - shown, summary->n_rows);
	if (columns < summary->n_inputs)
		printf("  not shown: %d of %d inputs, those with the smallest indices\n", summary->n_inputs - columns,
		       summary->n_inputs);
}

/* What the rows are, and what their ranges are over. */
static void print_over(const struct summary *summary)
{
	char *cells = summary->n_cells > 1 ? command_text(" the %d cells of the sweep", summary->n_cells)
	                                   : command_text("%s", "");
	const char *of = "";
	for (int k = 0; k < summary->n_rows; k++)
		if (summary->rows[k].n > 1)
			of = " frequencies or stories (their number)";
	char *sentence = command_text(
	    "Share of an output's variance due to an input %s (%s)%s%s%s%s:",
	    summary->total ? "with its interactions with others" : "alone", summary->total ? "ST" : "S1",
	    *cells || *of ? ", lowest to highest over" : "", cells, *cells && *of ? " and" : "", of);
	putchar('\n');
	table_prose(0, sentence);
	free(sentence);
	free(cells);
}

/* ---- how far they may be off ---- */

/* What is uncertain for another reason than the rows, and the widest interval. */
static void print_accuracy(const struct reading *result)
{
	struct widest_interval widest;
	const char *note = reading_text(result, "/accuracy/note"),
	           *dominant = reading_text(result, "/accuracy/dominant");
	if (note && dominant && strcmp(dominant, "sampling") != 0)
		table_prose(0, note);
	widest_interval_find(result, &widest);
	if (*widest.size)
		table_prose(0, widest.size);
	if (*widest.narrower)
		table_prose(0, widest.narrower);
}

/* ---- the screen ---- */

static void print_numbers(const struct reading *result)
{
	const char *name = reading_text(result, "/name");
	double failed = 0, dropped = 0, runs = 0;
	for (int c = 0; c < reading_count(result, "/cells"); c++) {
		double of_cell = reading_number(result, "/cells/%d/runs_failed", c);
		const double rows = reading_number(result, "/cells/%d/rows_dropped", c);
		failed += isfinite(of_cell) ? of_cell : 0;
		dropped += isfinite(rows) ? rows : 0;
		runs += reading_number(result, "/cells/%d/runs", c);
	}
	table_prose(0, name ? name : "a study without a name");
	fputs("sensitivity study: ", stdout);
	if (reading_count(result, "/cells") > 1)
		printf("%d cells, ", reading_count(result, "/cells"));
	if (reading_has(result, "/design"))
		printf("%.0f rows (%s), ", reading_number(result, "/design/rows"),
		       reading_text(result, "/design/method"));
	printf("%.0f runs", runs);
	if (failed > 0)
		printf(", %.0f failed and %.0f rows left out with them", failed, dropped);
	if (reading_has(result, "/timing"))
		printf(", %.3g s with %.0f threads", reading_number(result, "/timing/wall_s"),
		       reading_number(result, "/timing/threads"));
	putchar('\n');
	if (reading_has(result, "/partial")) {
		char *sentence =
		    command_text("PARTIAL RESULT, %.0f of %.0f rows: %s", reading_number(result, "/partial/rows"),
		                 reading_number(result, "/partial/rows_most"), reading_text(result, "/partial/note"));
		table_prose(0, sentence);
		free(sentence);
	}
	if (reading_has(result, "/stopping")) {
		char *sentence = command_text("%.0f rows: %s", reading_number(result, "/stopping/rows"),
		                              reading_text(result, "/stopping/note"));
		table_prose(0, sentence);
		free(sentence);
	}
}

static void print_more(const struct reading *result)
{
	static const char *const names[] = {
#define X(name) #name,
	    RESULT_TABLES(X)
#undef X
	};
	char *line = command_text("%s", "More with --table all");
	for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
		if (reading_has(result, "/cells/0/outputs/0/%s", names[k]) || reading_has(result, "/%s", names[k])) {
			char *longer = command_text("%s, %s", line, names[k]);
			free(line);
			line = longer;
		}
	table_prose(0, line);
	free(line);
	puts("Figures: pound plot, or pound report for all of it on one page");
}

void summary_print(const struct reading *result)
{
	struct summary summary = {.result = result, .n_cells = reading_count(result, "/cells")};
	bool any = spans_find(&summary, true) || spans_find(&summary, false);
	order_find(&summary);
	print_numbers(result);
	if (!any) {
		const char *note = reading_text(result, "/cells/0/outputs/0/note");
		puts("\nNo index to quote has a value.");
		if (note)
			table_prose(0, note);
	} else {
		if (summary.n_cells == 1 && summary.n_outputs * (1 + summary.n_inputs) <= LINES_MOST)
			print_outputs(&summary);
		else {
			print_over(&summary);
			print_rows(&summary);
		}
	}
	print_accuracy(result);
	print_more(result);
	free(summary.rows);
}
