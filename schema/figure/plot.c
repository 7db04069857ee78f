/* plot.c - functions that all figures use: numbers and names of a result, the head of a figure. */
#include "schema/figure/plot.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct kept {
	struct kept *next;
	double memory[];
};

void *plot_memory(struct plot *plot, size_t size)
{
	struct kept *kept = calloc(1, sizeof *kept + size);
	if (!kept) {
		plot->d.w.failed = true;
		return NULL;
	}
	kept->next = plot->kept;
	plot->kept = kept;
	return kept->memory;
}

void plot_free(struct plot *plot)
{
	for (struct kept *kept = plot->kept, *next; kept; kept = next) {
		next = kept->next;
		free(kept);
	}
	plot->kept = NULL;
}

const cJSON *plot_member(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

const cJSON *plot_first(const cJSON *list)
{
	return list ? list->child : NULL;
}

bool plot_is_result(const cJSON *document)
{
	static const char *const lists[] = {"cells", "signals", "spectra", "rows"};
	bool any = false;
	for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++)
		any = any || cJSON_IsArray(plot_member(document, lists[k]));
	return cJSON_IsObject(document) && *plot_text(document, "kind") && any;
}

static double number_of(const cJSON *value)
{
	return cJSON_IsNumber(value) ? value->valuedouble : NAN;
}

double plot_number(const cJSON *object, const char *name)
{
	return number_of(plot_member(object, name));
}

const char *plot_text(const cJSON *object, const char *name)
{
	const cJSON *value = plot_member(object, name);
	return cJSON_IsString(value) ? value->valuestring : "";
}

double *plot_numbers(struct plot *plot, const cJSON *list, int *n)
{
	const cJSON *element;
	double *numbers = plot_memory(plot, sizeof *numbers * (size_t)(cJSON_GetArraySize(list) + 1));
	*n = 0;
	if (numbers && cJSON_IsArray(list))
		cJSON_ArrayForEach(element, list) numbers[(*n)++] = number_of(element);
	return numbers;
}

double *plot_column(struct plot *plot, const cJSON *list, const char *name, int *n)
{
	const cJSON *element;
	double *numbers = plot_memory(plot, sizeof *numbers * (size_t)(cJSON_GetArraySize(list) + 1));
	*n = 0;
	if (numbers && cJSON_IsArray(list))
		cJSON_ArrayForEach(element, list) numbers[(*n)++] = plot_number(element, name);
	return numbers;
}

const cJSON *plot_cell(struct plot *plot)
{
	const cJSON *cells = plot_member(plot->result, "cells");
	const char *chosen = plot->choice->cell;
	int n = cJSON_GetArraySize(cells), cell = chosen ? atoi(chosen) : 0;
	if (cell < 0 || cell >= n) {
		snprintf(plot->fault, sizeof plot->fault, "cell must be a whole number in [0, %d]", n - 1);
		return NULL;
	}
	return cJSON_GetArrayItem(cells, cell);
}

bool plot_any_output(const cJSON *result, plot_drawable *has)
{
	const cJSON *cell, *output;
	cJSON_ArrayForEach(cell, plot_member(result, "cells"))
	{
		cJSON_ArrayForEach(output, plot_member(cell, "outputs")) if (has(output)) return true;
	}
	return false;
}

int plot_outputs(struct plot *plot, const cJSON *cell, plot_drawable *has, int most, const cJSON **outputs)
{
	const char *chosen = plot->choice->output;
	const cJSON *list = plot_member(cell, "outputs"), *output;
	int n = 0, named = 0;
	for (int pass = 0; pass < 2; pass++)
		cJSON_ArrayForEach(output, list)
		{
			bool ordinate = isfinite(plot_number(output, "frequency_hz"));
			if (ordinate != (pass == 1) || (chosen && strcmp(chosen, plot_text(output, "name")) != 0))
				continue;
			named++;
			if (n < most && has(output))
				outputs[n++] = output;
		}
	if (chosen && named == 0)
		snprintf(plot->fault, sizeof plot->fault, "this result has no output \"%.60s\"", chosen);
	else if (n == 0)
		snprintf(plot->fault, sizeof plot->fault, "%s%.60s%s has no numbers for this figure in this cell",
		         chosen ? "output \"" : "no output", chosen ? chosen : "", chosen ? "\"" : "");
	return n;
}

/* ---- words ---- */

static void blanks(char *text)
{
	for (; *text; text++)
		if (*text == '_')
			*text = ' ';
}

const char *plot_output_name(const cJSON *output, char text[PLOT_TEXT])
{
	char number[32];
	double frequency = plot_number(output, "frequency_hz");
	int n = snprintf(text, PLOT_TEXT, "%.180s", plot_text(output, "name"));
	blanks(text);
	if (isfinite(frequency))
		snprintf(text + n, (size_t)(PLOT_TEXT - n), " at %s Hz", draw_number(frequency, number));
	else if (isfinite(plot_number(output, "building")))
		snprintf(text + n, (size_t)(PLOT_TEXT - n), ", building %.0f, story %.0f",
		         plot_number(output, "building"), plot_number(output, "storey"));
	else if (isfinite(plot_number(output, "contact")))
		snprintf(text + n, (size_t)(PLOT_TEXT - n), ", contact %.0f", plot_number(output, "contact"));
	return text;
}

// suffixes of names that are units
static const struct {
	const char *end, *unit;
} UNITS[] = {{"_hz", "Hz"},   {"_kg", "kg"}, {"_m_s2", "m/s²"}, {"_m_s", "m/s"}, {"_n_s", "N s"},
             {"_n_m", "N/m"}, {"_m", "m"},   {"_s", "s"},       {"_n", "N"},     {"_n_m1_5", "N/m^1.5"}};

/* The unit at the end of a name of n characters, and the characters before it. */
static const char *unit_of(const char *name, size_t *n)
{
	for (size_t k = 0; k < sizeof UNITS / sizeof UNITS[0]; k++) {
		size_t end = strlen(UNITS[k].end);
		if (*n > end && strncmp(name + *n - end, UNITS[k].end, end) == 0) {
			*n -= end;
			return UNITS[k].unit;
		}
	}
	return NULL;
}

/* The body to which a path belongs: "left ", "building 2 ". */
static const char *body_of(const char *path, char text[32])
{
	static const struct {
		const char *list, *name;
	} lists[] = {{"/buildings/", "building"}, {"/contacts/", "contact"}};
	for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++) {
		const size_t n = strlen(lists[k].list),
		             digits = strspn(path + n * !strncmp(path, lists[k].list, n), "0123456789");
		if (strncmp(path, lists[k].list, n) == 0 && digits > 0 && digits < 8 && path[n + digits] == '/') {
			snprintf(text, 32, "%s %.*s ", lists[k].name, (int)digits, path + n);
			return text;
		}
	}
	return strncmp(path, "/oscillators/0/", 15) == 0   ? "left "
	       : strncmp(path, "/oscillators/1/", 15) == 0 ? "right "
	       : strncmp(path, "/excitation/", 12) == 0    ? "ground motion "
	                                                   : "";
}

/* The name of a path in words, "left frequency"; returns its unit or NULL. */
static const char *words_of(const char *path, char text[PLOT_TEXT])
{
	const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
	size_t n = strlen(name);
	const char *unit = unit_of(name, &n);
	char body[32];
	snprintf(text, PLOT_TEXT, "%s%.*s", strcmp(name, "type") == 0 ? "law " : body_of(path, body),
	         (int)(n < 200 ? n : 200), name);
	blanks(text);
	return unit;
}

const char *plot_path_name(const char *path, char text[PLOT_TEXT])
{
	const char *unit = words_of(path, text);
	size_t n = strlen(text);
	if (unit)
		snprintf(text + n, PLOT_TEXT - n, " [%s]", unit);
	return text;
}

static bool among(const char *const *names, int n, const char *name)
{
	for (int k = 0; k < n; k++)
		if (strcmp(names[k], name) == 0)
			return true;
	return false;
}

const char *plot_sweep_text(const cJSON *cell, int n_but, const char *const *but, char text[PLOT_TEXT])
{
	const cJSON *value;
	int n = 0;
	*text = '\0';
	cJSON_ArrayForEach(value, plot_member(cell, "sweep"))
	{
		char words[PLOT_TEXT], number[32];
		if (among(but, n_but, value->string))
			continue;
		const char *unit = words_of(value->string, words);
		bool word = cJSON_IsString(value);
		char *shown = word ? value->valuestring : NULL;
		// names of laws need no "law type" before them
		n +=
		    snprintf(text + n, (size_t)(PLOT_TEXT - n), "%s%.40s%s%.60s%s%s", n ? ", " : "",
		             word && strcmp(words, "law type") == 0 ? "" : words,
		             word && strcmp(words, "law type") == 0 ? "" : " ",
		             word ? shown : draw_number(number_of(value), number), unit ? " " : "", unit ? unit : "");
		if (n >= PLOT_TEXT - 130)
			break;
	}
	blanks(text);
	return text;
}

/* ---- the head ---- */

enum { HEAD_LINES = 4 }; /* lines of the study's name, and of the text after it */

void plot_head(struct plot *plot, const char *title, const char *more)
{
	char both[3 * PLOT_TEXT];
	const char *name = plot_text(plot->result, "name");
	const cJSON *partial = plot_member(plot->result, "partial");
	double width = plot->d.width - 2 * PLOT_MARGIN;
	snprintf(plot->title, sizeof plot->title, "%s", title);
	plot->y = draw_prose(
	    &plot->d,
	    &(struct label){.x = PLOT_MARGIN, .y = 28, .size = DRAW_HEAD_SIZE, .bold = true, .fit = width}, title,
	    3);
	snprintf(both, sizeof both, "%.400s%s%s", name, *name && *more ? "; " : "", more);
	// on one line if both fit
	const bool fits = draw_width(both, DRAW_TEXT_SIZE) <= width;
	const char *lines[] = {fits ? both : name, fits ? "" : more};
	for (int k = 0; k < 2; k++)
		if (*lines[k])
			plot->y = draw_prose(
			    &plot->d, &(struct label){.x = PLOT_MARGIN, .y = plot->y, .fit = width, .ink = INK_MUTED},
			    lines[k], HEAD_LINES);
	if (partial) {
		char rows[80];
		snprintf(rows, sizeof rows, "INTERMEDIATE RESULT, %.0f of %.0f rows", plot_number(partial, "rows"),
		         plot_number(partial, "rows_most"));
		draw_text(&plot->d, &(struct label){.x = PLOT_MARGIN, .y = plot->y, .bold = true, .fit = width},
		          rows);
		plot->y += 17;
	}
}

/* Writes a note below the figure. */
void plot_note(struct plot *plot, const char *format, ...)
{
	char text[2 * PLOT_TEXT];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	plot->y = draw_prose(&plot->d,
	                     &(struct label){.x = PLOT_MARGIN,
	                                     .y = plot->d.height + 16,
	                                     .fit = plot->d.width - 2 * PLOT_MARGIN,
	                                     .ink = INK_MUTED},
	                     text, 4);
}
