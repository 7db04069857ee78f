/* figure.c - the table of figures: from a result document to an SVG picture. */
#include "schema/figure/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"
#include "schema/json/json.h"
#include "schema/study/near_name.h"

enum { WIDTH = 1120 };

// clang-format off
const struct figure_row figure_rows[] = {
	{"indices",   "sensitivity",    " cell output index width ",  "inputs",            false, "first-order and total indices with 95 % intervals, a panel for each output", NULL},
	{"swept",     "sensitivity",    " output index x width ",     "inputs",            false, "indices against a swept number, a line for each input", "it needs a \"sweep\" over a number"},
	{"given",     "sensitivity",    " cell output width ",        "conditional_means", false, "mean output given one input, with its band", "it needs 30 rows, and an output that varies"},
	{"widths",    "sensitivity",    " cell output width ",        "stopping",          false, "half-widths of the intervals over CPU time or rows", "it needs 60 rows, and an output that varies"},
	{"pairs",     "sensitivity",    " cell output width ",        "second_order",      false, "second-order indices of every two inputs", "it needs 30 rows, and at most 4 inputs or \"order\": \"second\""},
	{"spectra",   "floor_spectrum", " axis spectra width ",         NULL,                false, "floor response spectra with and without pounding", NULL},
	{"history",   "floor_spectrum", " signal from to width ",     NULL,                true,  "motion, clear distance and contact force in time", "it is drawn from the samples of a study with \"histories\": true (pound run --samples FILE)"},
	{"force",     "floor_spectrum", " signal from to width ",     NULL,                true,  "contact force against overlap, a loop for each contact", "it is drawn from the samples of a study with \"histories\": true (pound run --samples FILE)"},
	{"responses", "response",       " cell x width ",             NULL,                false, "peak displacements with and without pounding", "it shows two oscillators, not a row of buildings"},
	{"heights",   "response",       " cell width ",               NULL,                false, "story drifts and floor accelerations over the height, with and without pounding", "it shows a row of buildings"},
	{"impacts",   "response",       " cell width ",               NULL,                false, "first impact, number and largest impulse of impacts by level", "it shows a row of buildings with contacts"},
	{"timeline",  "response",       " cell signal from to width ", NULL,              true,  "every contact in time, by its level and its impulse", "it is drawn from the samples (pound run --samples FILE)"},
	{"errors",    "convergence",    " quantity width ",           NULL,                false, "error of each solver against its CPU time", NULL},
	{"separation", "separation",    " cell contact width ",       "pounding",          false, "probability of pounding over the gap, and the gaps that design rules require", NULL},
	{"fragility", "separation",     " cell contact width ",       "fragility",         false, "fragility curves over a swept intensity, a line for each gap, and the fractions of runs that pound", "it needs \"intensity\", the path of a sweep"},
	{"suite",     "any",            " width ",                    NULL,                true,  "response spectra of a study's ground motions, by pound motion --periods", "it is drawn from a table of its own (pound motion --periods)"},
	{0},
};

static const struct {
	void (*draw)(struct plot *plot);
	bool (*has)(const cJSON *result);
} functions[] = {
#define X(name) {plot_##name, plot_has_##name},
	FIGURES(X)
#undef X
};

static const struct {
	const char *name, *values;
	int lowest, highest;
	size_t offset; /* in struct figure_choice */
} arguments[] = {
#define X(name, values, lowest, highest, text) {#name, values, lowest, highest, offsetof(struct figure_choice, name)},
	FIGURE_ARGUMENTS(X)
#undef X
};
// clang-format on

const struct figure_row *figure_row(const char *name)
{
	for (const struct figure_row *row = figure_rows; row->name; row++)
		if (strcmp(row->name, name) == 0)
			return row;
	return NULL;
}

static bool listed(const char *list, const char *word)
{
	size_t n = strlen(word);
	for (const char *at = list; n > 0 && (at = strstr(at, word)); at++)
		if (at > list && at[-1] == ' ' && at[n] == ' ')
			return true;
	return false;
}

/* Whether every given argument belongs to the figure and is valid; if not, `detail` has the error message. */
static bool choice_taken(const struct figure_row *row, const struct figure_choice *choice, char *detail,
                         size_t size)
{
	for (size_t k = 0; k < sizeof arguments / sizeof arguments[0]; k++) {
		const char *value = *(const char *const *)(const void *)((const char *)choice + arguments[k].offset);
		const char *name = arguments[k].name;
		char *end = NULL;
		if (!value)
			continue;
		if (!listed(row->takes, name)) {
			snprintf(detail, size, "figure %s takes no argument \"%s\"; it takes:%s", row->name, name,
			         row->takes);
			return false;
		}
		if (arguments[k].values && !listed(arguments[k].values, value)) {
			snprintf(detail, size, "%s must be one of%s", name, arguments[k].values);
			return false;
		}
		long number = arguments[k].highest ? strtol(value, &end, 10) : 0;
		if (end && (*value < '0' || *value > '9' || *end || number < arguments[k].lowest ||
		            number > arguments[k].highest)) {
			snprintf(detail, size, "%s must be a whole number in [%d, %d]", name, arguments[k].lowest,
			         arguments[k].highest);
			return false;
		}
	}
	return true;
}

/* The kind of study whose figures a result has: indices of given data have the form of a sensitivity study's. */
static const char *kind_of(const cJSON *result)
{
	const char *kind = plot_text(result, "kind");
	return strcmp(kind, "given_data") == 0 ? "sensitivity" : kind;
}

bool figure_shows(const struct figure_row *row, const cJSON *result)
{
	return strcmp(row->kind, kind_of(result)) == 0 && functions[row - figure_rows].has(result);
}

static enum figure_status out_of_memory(struct figure *figure)
{
	snprintf(figure->detail, sizeof figure->detail, "out of memory");
	return FIGURE_NOMEM;
}

static enum figure_status draw(const struct figure_row *row, struct plot *plot, struct figure *figure)
{
	const char *width = plot->choice->width;
	draw_init(&plot->d, width ? strtod(width, NULL) : WIDTH);
	functions[row - figure_rows].draw(plot);
	if (*plot->fault) {
		snprintf(figure->detail, sizeof figure->detail, "%s", plot->fault);
		free(plot->d.w.text);
		return FIGURE_CHOICE;
	}
	figure->svg = draw_take(&plot->d, plot->title, plot->sentence, &figure->length);
	return figure->svg ? FIGURE_DRAWN : out_of_memory(figure);
}

/* Writes why a result does not have a figure, and which figures it has. */
static void absent(const struct figure_row *row, const cJSON *result, bool sampled, struct figure *figure)
{
	const char *kind = plot_text(result, "kind"), *before = "; it has: ";
	char why[120];
	snprintf(why, sizeof why, "it shows studies of kind \"%s\", not \"%.40s\"", row->kind, kind);
	if (strcmp(row->kind, kind) == 0 || strcmp(row->kind, "any") == 0)
		snprintf(why, sizeof why, "%s", row->needs ? row->needs : "the result lacks its numbers");
	if (strcmp(kind, "given_data") == 0)
		snprintf(why, sizeof why, "given data do not have its numbers");
	size_t n = (size_t)snprintf(figure->detail, sizeof figure->detail, "this result has no figure \"%s\": %s",
	                            row->name, why);
	for (const struct figure_row *has = figure_rows; has->name; has++)
		if (figure_shows(has, result) && (!has->sampled || sampled) && n < sizeof figure->detail) {
			n += (size_t)snprintf(figure->detail + n, sizeof figure->detail - n, "%s%s", before, has->name);
			before = ", ";
		}
}

static void unknown(const char *name, struct figure *figure)
{
	struct near_name_search search = near_name_begin(name);
	for (const struct figure_row *row = figure_rows; row->name; row++)
		near_name_try(&search, row->name);
	const char *meant = near_name_found(&search);
	snprintf(figure->detail, sizeof figure->detail, "no figure is called \"%.60s\"%s%s%s", name,
	         meant ? ", did you mean \"" : "", meant ? meant : "", meant ? "\"?" : "");
}

/* Draws a figure of a parsed result with valid arguments. */
enum figure_status figure_of(const struct figure_row *row, const cJSON *result,
                             const struct figure_source *source, const struct figure_choice *choice,
                             struct figure *figure)
{
	*figure = (struct figure){0};
	// figures of samples can be drawn without a result
	if ((row->sampled && !source->samples) || (plot_is_result(result) && !figure_shows(row, result))) {
		absent(row, result, source->samples, figure);
		return FIGURE_ABSENT;
	}
	struct plot plot = {.result = result, .source = source, .choice = choice};
	enum figure_status status = draw(row, &plot, figure);
	plot_free(&plot);
	return status;
}

/* Draws a figure.
 *
 * Given    name     of a row
 *          choice   arguments as the user wrote them
 * Returns  value    status; the caller frees figure->svg
 * Test     unit_figure: every_figure_of_every_example_is_well_formed_and_within_its_view_box
 */
enum figure_status figure_draw(const char *name, const struct figure_source *source,
                               const struct figure_choice *choice, struct figure *figure)
{
	struct json_fault fault;
	const struct figure_row *row = figure_row(name);
	*figure = (struct figure){0};
	if (!row) {
		unknown(name, figure);
		return FIGURE_UNKNOWN;
	}
	if (!choice_taken(row, choice, figure->detail, sizeof figure->detail))
		return FIGURE_CHOICE;
	cJSON *result = json_parse(source->json, source->length, &fault);
	if (!result && fault.line == 0)
		return out_of_memory(figure);
	enum figure_status status = FIGURE_RESULT;
	if (plot_is_result(result) || (cJSON_IsObject(result) && row->sampled && source->samples))
		status = figure_of(row, result, source, choice, figure);
	else
		snprintf(figure->detail, sizeof figure->detail,
		         "this is not the result of a study: `pound run STUDY.json` prints one");
	cJSON_Delete(result);
	return status;
}

static void write_row(struct writer *w, const struct figure_row *row, const char *base)
{
	char text[160];
	writer_object(w, NULL, WRITER_LINE);
	writer_text(w, "name", row->name);
	writer_text(w, "title", row->text);
	writer_array(w, "arguments", WRITER_LINE);
	for (size_t k = 0; k < sizeof arguments / sizeof arguments[0]; k++)
		if (listed(row->takes, arguments[k].name))
			writer_text(w, NULL, arguments[k].name);
	writer_end(w);
	writer_text(w, "table", row->table);
	snprintf(text, sizeof text, "%.100s/figures/%s", base, row->name);
	writer_text(w, "link", text);
	writer_end(w);
}

char *figure_list(const struct figure_source *source, const char *base, size_t *length)
{
	struct json_fault fault;
	struct writer w;
	cJSON *result = json_parse(source->json, source->length, &fault);
	if (!result)
		return NULL;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_array(&w, "figures", WRITER_LINES);
	for (const struct figure_row *row = figure_rows; row->name; row++)
		if (figure_shows(row, result) && (!row->sampled || source->samples))
			write_row(&w, row, base);
	writer_end(&w);
	writer_end(&w);
	cJSON_Delete(result);
	return writer_take(&w, length);
}

bool figure_has(const struct figure_row *row, const struct figure_source *source)
{
	struct json_fault fault;
	cJSON *result = json_parse(source->json, source->length, &fault);
	bool there = result && figure_shows(row, result);
	cJSON_Delete(result);
	return there;
}
