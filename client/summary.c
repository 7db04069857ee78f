/* summary.c - a sensitivity result on one screen.  If each index fits with its interval and a bar:
 *
 *   impulse: mean 0.8992, noise 3.8 %
 *     f_2      S1  0.243 +-0.049  ST  0.626 +-0.092  |#############       |
 *
 * else a column for each input, the largest first, and both indices of each output below each other; over cells, frequencies and
 * stories from the lowest to the highest.  What does not fit is left out in this order, and a line says so: inputs with
 * the smallest indices, S1, outputs. */
#include "client/summary.h"
#include "client/cell.h"

#include "client/command.h"
#include "client/groups_sentence.h"
#include "client/indices_table.h"
#include "client/table.h"
#include "schema/result/result_json.h"
#include "schema/result/widest_interval.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	SCREEN = 24, /* lines */
	INPUTS_MOST = 64,
	PARAGRAPHS = 12,
	PATH_SIZE = 128,
	COLUMNS = 4,      /* inputs that fit side by side with output names of any length */
	INPUT_WIDTH = 14, /* longest input name beside both indices and a bar */
	CELL_WIDTH = 13,  /* " -0.16..-0.14", " 0.63 +-0.09" */
	INDENT = 1,       /* small: four inputs fit beside both indices of names of 24 characters */
	BOTH_WIDTH = 3,   /* " S1" */
	CHART = 20,
};

enum { S1, ST, INDICES };

static const char *const INDEX_NAMES[INDICES] = {"S1", "ST"};

/* What distinguishes outputs with the same name. */
static const struct {
	const char *member, *plural;
} PLACE_NAMES[] = {{"frequency_hz", "frequencies"}, {"storey", "stories"}};

enum { PLACES = sizeof PLACE_NAMES / sizeof PLACE_NAMES[0] };

/* Range of an index of one input over all cells, frequencies and stories of one output name. */
struct span {
	double low, high, half; /* half-width of the last interval */
};

struct row {
	const char *output;
	int n;     /* outputs with this name in a cell: frequencies or stories */
	int place; /* row of PLACE_NAMES: what distinguishes them */
	struct span spans[INDICES][INPUTS_MOST];
};

struct summary {
	const struct reading *result;
	bool any[INDICES]; /* whether the index has a value for any input */
	int n_cells, n_outputs, n_rows, n_inputs;
	struct row *rows;                /* (n_rows) */
	const char *inputs[INPUTS_MOST]; /* (n_inputs) */
	int order[INPUTS_MOST];          /* (n_inputs) by largest index, descending */
};

/* Sentences above or below the indices. */
struct paragraphs {
	char *text[PARAGRAPHS];
	int n;
};

/* Adds an allocated text and takes ownership of it. */
static void paragraph_add(struct paragraphs *paragraphs, char *text)
{
	if (paragraphs->n < PARAGRAPHS)
		paragraphs->text[paragraphs->n++] = text;
	else
		free(text);
}

static int paragraphs_lines(const struct paragraphs *paragraphs)
{
	int lines = 0;
	for (int k = 0; k < paragraphs->n; k++)
		lines += table_prose_lines(0, paragraphs->text[k]);
	return lines;
}

static void paragraphs_print(struct paragraphs *paragraphs)
{
	for (int k = 0; k < paragraphs->n; k++) {
		table_prose(0, paragraphs->text[k]);
		free(paragraphs->text[k]);
	}
	paragraphs->n = 0;
}

/* ---- reading the result ---- */

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
	for (int k = 0; k < INDICES; k++)
		for (int j = 0; j < INPUTS_MOST; j++)
			row->spans[k][j] = (struct span){NAN, NAN, NAN};
	return row;
}

/* Half-width of an interval; fabs because rounding can make a zero width negative. */
static double half_width(const struct reading *result, const char *input, const char *index)
{
	return fabs(reading_number(result, "%s/%s_high", input, index) -
	            reading_number(result, "%s/%s_low", input, index)) /
	       2;
}

static void input_add(struct summary *summary, struct row *row, const char *output, int input)
{
	char at[PATH_SIZE];
	snprintf(at, sizeof at, "%s/inputs/%d", output, input);
	for (int k = 0; k < INDICES; k++) {
		struct span *span = &row->spans[k][input];
		const double value = reading_number(summary->result, "%s/%s", at, INDEX_NAMES[k]);
		span->low = fmin(span->low, value);
		span->high = fmax(span->high, value);
		span->half = half_width(summary->result, at, INDEX_NAMES[k]);
		summary->any[k] |= isfinite(value);
	}
	if (input == summary->n_inputs)
		summary->inputs[summary->n_inputs++] = input_name(summary->result, output, input);
}

static void spans_find(struct summary *summary)
{
	const struct reading *result = summary->result;
	for (int c = 0; c < summary->n_cells; c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++) {
			char output[PATH_SIZE / 2];
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", c, o);
			const char *name = reading_text(result, "%s/name", output);
			struct row *row = row_of(summary, name ? name : "?");
			row->n += c == 0;
			for (int k = 0; k < PLACES; k++)
				if (isfinite(reading_number(result, "%s/%s", output, PLACE_NAMES[k].member)))
					row->place = k;
			summary->n_outputs += c == 0;
			for (int j = 0; j < reading_count(result, "%s/inputs", output) && j < INPUTS_MOST; j++)
				input_add(summary, row, output, j);
		}
}

/* ST if it has values, else S1. */
static int main_index(const struct summary *summary)
{
	return summary->any[ST] ? ST : S1;
}

static double highest(const struct summary *summary, int input)
{
	double most = -INFINITY;
	for (int k = 0; k < summary->n_rows; k++)
		most = fmax(most, summary->rows[k].spans[main_index(summary)][input].high);
	return most;
}

/* Sorts the inputs by their largest index, descending; equal inputs stay in the order of the study. */
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

/* ---- every index with its interval and a bar ---- */

/* Prints "  ST  0.626 +-0.092"; "-" if the index has no value. */
static void print_estimate(const struct reading *result, const char *input, const char *index)
{
	const double value = reading_number(result, "%s/%s", input, index);
	const double half = half_width(result, input, index);
	char rounded[16];
	table_round(rounded, sizeof rounded, "%6.3f", value);
	if (!isfinite(value))
		printf("  %s %6s %7s", index, "-", "");
	else if (half > 0 && half < 0.0005)
		printf("  %s %s +-%-5s", index, rounded, "<.001");
	else if (isfinite(half))
		printf("  %s %s +-%-5.3f", index, rounded, half);
	else
		printf("  %s %s %7s", index, rounded, "");
}

/* Rows needed for reliable intervals, of the note of the output that its intervals are too narrow; NAN: the present rows are
 * enough. */
static double rows_needed(const struct reading *result, const char *output)
{
	for (int k = 0; k < reading_count(result, "%s/notes", output); k++)
		if (reading_has(result, "%s/notes/%d/rows_needed", output, k))
			return reading_number(result, "%s/notes/%d/rows_needed", output, k);
	return NAN;
}

/* "impulse: mean 0.89, noise 4 %"; the caller frees it. */
static char *output_head(const struct reading *result, const char *output)
{
	static const struct measure measures[] = {{"noise_share", ", noise %.2g %%", 100}, {NULL, NULL, 0}};
	const double needed = rows_needed(result, output);
	char *head = cell_output(result, output, measures);
	return isfinite(needed) ? command_append(head, ", needs %.0f rows", needed) : head;
}

static void print_input(const struct summary *summary, const char *output, int j, int width)
{
	char input[PATH_SIZE], *label = table_cut(summary->inputs[j], width);
	fputs("    ", stdout);
	table_say(label);
	printf("%*s", width - table_width(label), "");
	free(label);
	snprintf(input, sizeof input, "%s/inputs/%d", output, j);
	print_estimate(summary->result, input, "S1");
	if (summary->any[ST])
		print_estimate(summary->result, input, "ST");
	const double share = reading_number(summary->result, "%s/%s", input, INDEX_NAMES[main_index(summary)]);
	if (isfinite(share))
		chart(share);
	putchar('\n');
}

/* Prints, or only counts, the lines of the form with a bar for each input; returns their number.  Needs a study with one cell. */
static int bars(const struct summary *summary, bool print)
{
	const struct reading *result = summary->result;
	// inputs of an external model have no path
	const bool own = !reading_text(result, "/cells/0/outputs/0/inputs/0/path");
	bool narrow = false;
	int width = 0, lines = 2;
	if (print)
		printf("Fraction of an output's variance due to an input alone (S1), with interactions\n"
		       "(ST), and to the randomness of %s (noise); +-: 95 %% half-width.\n",
		       own ? "replicates" : "ground motions");
	for (int j = 0; j < summary->n_inputs; j++) {
		const int n = table_width(summary->inputs[j]);
		width = n > width ? n : width;
	}
	width = width > INPUT_WIDTH ? INPUT_WIDTH : width;
	for (int o = 0; o < summary->n_outputs; o++) {
		char output[PATH_SIZE / 2];
		snprintf(output, sizeof output, "/cells/0/outputs/%d", o);
		char *head = output_head(result, output);
		lines += table_prose_lines(2, head) + summary->n_inputs;
		narrow |= isfinite(rows_needed(result, output));
		if (print)
			table_prose(2, head);
		for (int k = 0; print && k < summary->n_inputs; k++)
			print_input(summary, output, summary->order[k], width);
		free(head);
	}
	if (print && narrow)
		puts("Few rows hold the variance: intervals are too narrow where more rows are needed.");
	return lines + narrow;
}

/* ---- a column for each input ---- */

/* What fits on the screen. */
struct layout {
	bool both;     /* S1 and ST in two lines */
	int outputs;   /* outputs shown */
	int label;     /* width of the output names and of "S1" */
	int columns;   /* inputs side by side */
	int n_columns; /* inputs shown, in blocks below each other */
};

static bool is_range(const struct summary *summary, const struct row *row)
{
	return summary->n_cells > 1 || row->n > 1;
}

static int at_most(int value, int most)
{
	return value < most ? value : most;
}

static int at_least(int value, int least)
{
	return value > least ? value : least;
}

/* The name of an output, cut to a width; the caller frees it. */
static char *row_label(const struct row *row, int width)
{
	char *whole = row->n > 1 ? command_text("%s (%d)", row->output, row->n) : command_text("%s", row->output);
	char *label = table_cut(whole, width);
	free(whole);
	return label;
}

static struct layout layout_within(const struct summary *summary, int lines)
{
	struct layout layout = {.both = summary->any[S1] && summary->any[ST] && 1 + 2 * summary->n_rows <= lines};
	const int each = layout.both ? 2 : 1;
	layout.outputs = at_most(summary->n_rows, at_least((lines - 1) / each, 1));
	const int most = TABLE_WIDTH - INDENT - BOTH_WIDTH - at_most(summary->n_inputs, COLUMNS) * CELL_WIDTH;
	for (int k = 0; k < layout.outputs; k++) {
		char *label = row_label(&summary->rows[k], most);
		layout.label = at_least(layout.label, table_width(label));
		free(label);
	}
	layout.label += layout.both ? BOTH_WIDTH : 0;
	layout.columns = at_most((TABLE_WIDTH - INDENT - layout.label) / CELL_WIDTH, summary->n_inputs);
	layout.n_columns =
	    at_most(layout.columns * at_least(lines / (1 + each * layout.outputs), 1), summary->n_inputs);
	return layout;
}

/* Sentence about what a layout leaves out; the caller frees it.  NULL: nothing. */
static char *left_out(const struct summary *summary, const struct layout *layout)
{
	char *text = command_text("%s", "not shown:");
	const size_t nothing = strlen(text);
	if (layout->outputs < summary->n_rows)
		text = command_append(text, " %d of %d outputs;", summary->n_rows - layout->outputs, summary->n_rows);
	if (!layout->both && summary->any[S1] && summary->any[ST])
		text = command_append(text, " S1;");
	if (layout->n_columns < summary->n_inputs)
		text = command_append(text, " %d of %d inputs, those with the smallest indices;",
		                      summary->n_inputs - layout->n_columns, summary->n_inputs);
	if (strlen(text) > nothing)
		return command_append(text, " --table inputs shows all");
	free(text);
	return NULL;
}

/* Two decimals, for large numbers none; no "-0.00". */
static const char *value_text(double value, char text[24])
{
	snprintf(text, 24, fabs(value) < 9.995 ? "%.2f" : "%.0f", fabs(value) < 0.005 ? 0.0 : value);
	return text;
}

static void print_span(const struct span *span, bool range)
{
	char text[64] = "-", low[24], high[24];
	const double half = span->half;
	value_text(span->low, low);
	value_text(range ? span->high : half, high);
	if (isfinite(span->low) && (range ? strcmp(low, high) != 0 : isfinite(half)))
		snprintf(text, sizeof text, range ? "%s..%s" : "%s +-%s", low,
		         !range && half > 0 && half < 0.005 ? "<.01" : high);
	else if (isfinite(span->low))
		snprintf(text, sizeof text, "%s", low);
	printf(" %*s", CELL_WIDTH - 1, text);
}

/* Prints one line: an index of an output.  `name` is the output's, or empty in its second line. */
static void print_index(const struct summary *summary, const struct layout *layout, const struct row *row,
                        int index, const char *name, int first)
{
	const int end = at_most(first + layout->columns, layout->n_columns);
	printf("%*s", INDENT, "");
	table_say(name);
	printf("%*s%s", layout->label - (layout->both ? 2 : 0) - table_width(name), "",
	       layout->both ? INDEX_NAMES[index] : "");
	for (int k = first; k < end; k++)
		print_span(&row->spans[index][summary->order[k]], is_range(summary, row));
	putchar('\n');
}

/* Prints a block: the inputs from `first` on that fit side by side. */
static void print_block(const struct summary *summary, const struct layout *layout, int first)
{
	const int end = at_most(first + layout->columns, layout->n_columns);
	printf("%*s", INDENT + layout->label, "");
	for (int k = first; k < end; k++) {
		char *name = table_cut(summary->inputs[summary->order[k]], CELL_WIDTH - 1);
		printf("%*s", CELL_WIDTH - table_width(name), "");
		table_say(name);
		free(name);
	}
	putchar('\n');
	for (int r = 0; r < layout->outputs; r++) {
		char *label = row_label(&summary->rows[r], layout->label - (layout->both ? BOTH_WIDTH : 0));
		if (layout->both) {
			print_index(summary, layout, &summary->rows[r], S1, label, first);
			print_index(summary, layout, &summary->rows[r], ST, "", first);
		} else
			print_index(summary, layout, &summary->rows[r], main_index(summary), label, first);
		free(label);
	}
}

/* What the ranges are over: "the 2 cells of the sweep and stories"; "" without ranges.  The caller frees it. */
static char *over_of(const struct summary *summary)
{
	bool is[PLACES] = {false};
	char *text = command_text("%s", "");
	if (summary->n_cells > 1)
		text = command_append(text, "the %d cells of the sweep", summary->n_cells);
	for (int k = 0; k < summary->n_rows; k++)
		is[summary->rows[k].place] |= summary->rows[k].n > 1;
	for (int place = 0; place < PLACES; place++)
		if (is[place])
			text = command_append(text, "%s%s", *text ? " and " : "", PLACE_NAMES[place].plural);
	return text;
}

/* Sentence that explains the numbers and their ranges; the caller frees it. */
static char *intro_of(const struct summary *summary, bool both)
{
	bool places = false, values = false;
	char *over = over_of(summary);
	for (int k = 0; k < summary->n_rows; k++) {
		places |= summary->rows[k].n > 1;
		values |= !is_range(summary, &summary->rows[k]);
	}
	char *text = command_text("Fraction of an output's variance due to an input %s%s%s",
	                          both || !summary->any[ST] ? "alone (S1)" : "", both ? " and " : "",
	                          summary->any[ST] ? "with its interactions (ST)" : "");
	if (*over)
		text = command_append(text, ", lowest to highest over %s%s", over,
		                      summary->n_cells > 1 ? " that have the output" : "");
	free(over);
	return command_append(text, "%s%s.", places ? " (number in parentheses)" : "",
	                      values ? "; +-: half-width of the 95 % interval" : "");
}

/* Sentence with the number of outputs whose intervals are too narrow; the caller frees it.  NULL: none. */
static char *too_narrow(const struct reading *result)
{
	int n = 0, of = 0;
	double rows = 0;
	for (int c = 0; c < reading_count(result, "/cells"); c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++, of++) {
			char output[PATH_SIZE / 2];
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", c, o);
			const double needed = rows_needed(result, output);
			n += isfinite(needed);
			rows = fmax(rows, needed);
		}
	return n == 0 ? NULL
	              : command_text(
	                    "Intervals of %d of %d outputs are too narrow, as few rows hold the variance: up to "
	                    "%.0f rows are needed.",
	                    n, of, rows);
}

/* Prints the form with a column for each input in at most `lines` lines. */
static void print_columns(const struct summary *summary, int lines)
{
	char *intro = intro_of(summary, summary->any[S1] && summary->any[ST]),
	     *narrow = too_narrow(summary->result);
	lines -= table_prose_lines(0, intro) + (narrow ? table_prose_lines(0, narrow) : 0);
	free(intro);
	struct layout layout = layout_within(summary, lines);
	char *missing = left_out(summary, &layout);
	if (missing) {
		layout = layout_within(summary, lines - table_prose_lines(INDENT, missing));
		free(missing);
		missing = left_out(summary, &layout);
	}
	intro = intro_of(summary, layout.both);
	table_prose(0, intro);
	free(intro);
	for (int first = 0; first < layout.n_columns; first += layout.columns)
		print_block(summary, &layout, first);
	if (missing)
		table_prose(INDENT, missing);
	if (narrow)
		table_prose(0, narrow);
	free(missing);
	free(narrow);
}

/* ---- paragraphs above and below the indices ---- */

static char *runs_of(const struct reading *result)
{
	double failed = 0, dropped = 0, runs = 0;
	const int n_cells = reading_count(result, "/cells");
	for (int c = 0; c < n_cells; c++) {
		const double of_cell = reading_number(result, "/cells/%d/runs_failed", c);
		const double rows = reading_number(result, "/cells/%d/rows_dropped", c);
		failed += isfinite(of_cell) ? of_cell : 0;
		dropped += isfinite(rows) ? rows : 0;
		runs += reading_number(result, "/cells/%d/runs", c);
	}
	char *text = command_text("sensitivity study: ");
	if (n_cells > 1)
		text = command_append(text, "%d cells, ", n_cells);
	if (reading_has(result, "/design"))
		text = command_append(text, "%.0f rows (%s), ", reading_number(result, "/design/rows"),
		                      reading_text(result, "/design/method"));
	text = command_append(text, "%.0f runs", runs);
	if (failed > 0)
		text = command_append(text, ", %.0f failed, so %.0f row%s left out", failed, dropped,
		                      dropped == 1 ? " is" : "s are");
	if (reading_has(result, "/timing"))
		text = command_append(text, ", %.3g s with %.0f threads", reading_number(result, "/timing/wall_s"),
		                      reading_number(result, "/timing/threads"));
	return text;
}

static void above_find(const struct reading *result, struct paragraphs *above)
{
	const char *name = reading_text(result, "/name");
	paragraph_add(above, command_text("%s", name ? name : "a study without a name"));
	paragraph_add(above, runs_of(result));
	if (reading_has(result, "/partial"))
		paragraph_add(above, command_text("PARTIAL RESULT, %.0f of %.0f rows: %s",
		                                  reading_number(result, "/partial/rows"),
		                                  reading_number(result, "/partial/rows_most"),
		                                  reading_text(result, "/partial/note")));
	// the remainder of the sentence explains the table of choices, not shown here
	const char *split = reading_text(result, "/stopping/signals/note");
	if (split)
		paragraph_add(above, command_text("%.*s", (int)strcspn(split, ";"), split));
	if (reading_has(result, "/stopping/note"))
		paragraph_add(above, command_text("%.0f rows: %s", reading_number(result, "/stopping/rows"),
		                                  reading_text(result, "/stopping/note")));
}

static char *tables_of(const struct reading *result)
{
	static const char *const names[] = {
#define X(name) #name,
	    RESULT_TABLES(X)
#undef X
	};
	char *line = command_text("More tables (--table NAME): all");
	for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
		if (indices_have_table(result, names[k]))
			line = command_append(line, ", %s", names[k]);
	return line;
}

/* The notes of an output without the note on few rows, which too_narrow reports, and the note on indices that the summary does not
 * show; the caller frees it.  NULL: nothing is left. */
static char *notes_shown(const struct reading *result, const char *output)
{
	static const char *const left_out[] = {"few_decide", "fresh_signals"};
	// indices of given samples have one note without names
	const char *note = reading_text(result, "%s/note", output);
	char *shown = NULL;
	if (note && !reading_has(result, "%s/notes", output))
		return command_text("%s", note);
	for (int k = 0; k < reading_count(result, "%s/notes", output); k++) {
		const char *name = reading_text(result, "%s/notes/%d/name", output, k),
		           *text = reading_text(result, "%s/notes/%d/text", output, k);
		bool out = !name || !text;
		for (size_t i = 0; i < sizeof left_out / sizeof left_out[0] && !out; i++)
			out = strcmp(name, left_out[i]) == 0;
		if (!out)
			shown = shown ? command_append(shown, "; %s", text) : command_text("%s", text);
	}
	return shown;
}

/* Whether a list of names, separated by ", ", has a name. */
static bool listed(const char *names, const char *name)
{
	const size_t length = strlen(name);
	for (const char *at = names; (at = strstr(at, name)); at += length)
		if ((at == names || at[-1] == ' ') && (at[length] == ',' || at[length] == '\0'))
			return true;
	return false;
}

/* The first note with the names of its outputs, and the number of outputs with another note; the caller frees it.  NULL: no
 * output has a note. */
static char *notes_of(const struct reading *result)
{
	char *first = NULL, *names = NULL;
	int others = 0;
	for (int c = 0; c < reading_count(result, "/cells"); c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++) {
			char output[PATH_SIZE / 2];
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", c, o);
			char *note = notes_shown(result, output);
			const char *name = reading_text(result, "%s/name", output);
			if (note && !first) {
				first = note;
				names = command_text("%s", name);
				continue;
			}
			if (note && strcmp(note, first) != 0)
				others++;
			else if (note && !listed(names, name))
				names = command_append(names, ", %s", name);
			free(note);
		}
	char *line = first ? command_text("Note on %s: %s.", names, first) : NULL;
	free(first), free(names);
	return others ? command_append(line, " %d more note%s: --table inputs", others, others == 1 ? "" : "s")
	              : line;
}

/* Errors that more rows do not reduce, the widest interval, and where to find the other tables. */
static void below_find(const struct summary *summary, struct paragraphs *below)
{
	const struct reading *result = summary->result;
	struct widest_interval widest;
	char *over = over_of(summary);
	const char *note = reading_text(result, "/accuracy/note"),
	           *dominant = reading_text(result, "/accuracy/dominant");
	char *const sentences[] = {groups_sentence(result, over), notes_of(result)};
	free(over);
	for (int k = 0; k < 2; k++)
		if (sentences[k])
			paragraph_add(below, sentences[k]);
	if (note && !(dominant && strcmp(dominant, "sampling") == 0))
		paragraph_add(below, command_text("%s", note));
	widest_interval_find(result, &widest);
	if (*widest.size)
		paragraph_add(below, command_text("%s", widest.size));
	if (*widest.narrower)
		paragraph_add(below, command_text("%s", widest.narrower));
	paragraph_add(below, tables_of(result));
	paragraph_add(below,
	              command_text("Figures: `pound plot'. All tables and figures on one page: `pound report'."));
}

/* ---- the screen ---- */

/* Prints the indices to quote, their uncertainty and its cause, and where to find the other tables.
 *
 * Test     client_tables: a_table_without_a_name_is_a_summary_of_one_screen
 */
void summary_print(const struct reading *result)
{
	struct summary summary = {.result = result, .n_cells = reading_count(result, "/cells")};
	struct paragraphs above = {0}, below = {0};
	spans_find(&summary);
	order_find(&summary);
	above_find(result, &above);
	below_find(&summary, &below);
	const int lines = SCREEN - 1 - paragraphs_lines(&above) - paragraphs_lines(&below);
	paragraphs_print(&above);
	putchar('\n');
	if (!summary.any[S1] && !summary.any[ST]) {
		const char *note = reading_text(result, "/cells/0/outputs/0/note");
		puts("No index has a value.");
		if (note)
			table_prose(0, note);
	} else if (summary.n_cells == 1 && bars(&summary, false) <= lines)
		bars(&summary, true);
	else
		print_columns(&summary, lines);
	paragraphs_print(&below);
	free(summary.rows);
}
