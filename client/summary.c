/* summary.c - a sensitivity result of many cells or outputs on one screen: each total index from its lowest to its highest. */
#include "client/summary.h"

#include "client/command.h"
#include "client/table.h"
#include "schema/result/result_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_MOST = 24, PATH_SIZE = 128, NAME_SIZE = 96 };

/* The total index of one input in one output, over the cells. */
struct span {
	char output[NAME_SIZE], input[NAME_SIZE];
	double low, high;
	int cell; /* of the highest */
};

struct spans {
	struct span *all; /* (n) */
	int n, room;
};

static struct span *span_of(struct spans *spans, const char *output, const char *input)
{
	for (int k = 0; k < spans->n; k++)
		if (strcmp(spans->all[k].output, output) == 0 && strcmp(spans->all[k].input, input) == 0)
			return &spans->all[k];
	if (spans->n == spans->room) {
		spans->room = spans->room ? 2 * spans->room : 64;
		spans->all = command_sure(realloc(spans->all, (size_t)spans->room * sizeof *spans->all));
	}
	struct span *span = &spans->all[spans->n++];
	*span = (struct span){.low = NAN, .high = NAN};
	snprintf(span->output, sizeof span->output, "%s", output);
	snprintf(span->input, sizeof span->input, "%s", input);
	return span;
}

static void output_name(const struct reading *result, const char *output, char name[NAME_SIZE])
{
	double frequency = reading_number(result, "%s/frequency_hz", output);
	const char *text = reading_text(result, "%s/name", output);
	double building = reading_number(result, "%s/building", output);
	if (isfinite(building))
		snprintf(name, NAME_SIZE, "%.60s, building %.0f, story %.0f", text ? text : "?", building,
		         reading_number(result, "%s/storey", output));
	else
		snprintf(name, NAME_SIZE, isfinite(frequency) ? "%.60s %.4g Hz" : "%.60s", text ? text : "?",
		         frequency);
}

static void spans_find(const struct reading *result, struct spans *spans)
{
	char output[PATH_SIZE], name[NAME_SIZE];
	for (int c = 0; c < reading_count(result, "/cells"); c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++) {
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", c, o);
			output_name(result, output, name);
			for (int j = 0; j < reading_count(result, "%s/inputs", output); j++) {
				const char *input = reading_text(result, "%s/inputs/%d/name", output, j);
				double value = reading_number(result, "%s/inputs/%d/ST", output, j);
				struct span *span = span_of(spans, name, input ? input : "?");
				if (isfinite(value) && !(value <= span->high)) {
					span->high = value;
					span->cell = c;
				}
				span->low = fmin(span->low, value);
			}
		}
}

static void print_spans(const struct reading *result, const struct spans *spans)
{
	static const char *const columns[] = {"output", "input", "lowest ST", "highest ST", "in cell", NULL};
	struct table *table = table_open(columns);
	int cells = reading_count(result, "/cells"), shown = spans->n < ROWS_MOST ? spans->n : ROWS_MOST;
	for (int k = 0; k < shown; k++) {
		table_text(table, spans->all[k].output);
		table_text(table, spans->all[k].input);
		table_number(table, spans->all[k].low);
		table_number(table, spans->all[k].high);
		table_number(table, cells > 1 ? spans->all[k].cell : NAN);
	}
	printf("\ntotal indices ST: the share of an output's variance that an input explains, alone and with "
	       "others%s\n",
	       cells > 1 ? ",\nover all cells" : "");
	table_print(table, 2);
	table_close(table);
	if (shown < spans->n)
		printf("  and %d more rows\n", spans->n - shown);
	if (cells > 1)
		printf("  %d cells, counted from 0: one for each combination of the swept values\n", cells);
}

/* The accuracy of the whole. */
static void print_note(const struct reading *result)
{
	const char *note = reading_text(result, "/accuracy/note");
	putchar('\n');
	if (note)
		table_prose(0, note);
}

void summary_print(const struct reading *result)
{
	struct spans spans = {0};
	spans_find(result, &spans);
	print_spans(result, &spans);
	print_note(result);
	free(spans.all);
}

/* Prints the tables that a result has besides, by their names. */
void summary_more(const struct reading *result)
{
	static const char *const names[] = {
#define X(name) #name,
	    RESULT_TABLES(X)
#undef X
	};
	fputs("\nmore with --format table and --table all", stdout);
	for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
		if (reading_has(result, "/cells/0/outputs/0/%s", names[k]) || reading_has(result, "/%s", names[k]))
			printf(", %s", names[k]);
	puts("\npictures: pound plot, or pound report for all of it on one page");
}

void summary_wider(double earlier, double rows_earlier, double last, double rows)
{
	if (!(last > 1.1 * earlier))
		return;
	char *sentence = command_text(
	    "wider at %.0f rows than at %.0f: rare rows add much to the variance, and fewer rows may "
	    "miss them, so that their interval comes out too narrow; quote the wider one",
	    rows, rows_earlier);
	table_prose(2, sentence);
	free(sentence);
}
