/* sweep_plot.c - figures over the cells of a swept study: `swept` of a sensitivity study, `responses` of a response study. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { OUTPUTS_MOST = 4, COLUMNS_MOST = 8, INPUTS_MOST = 16, PATHS_MOST = 8, PANEL_NARROWEST = 230 };

static const cJSON *cells_of(const cJSON *result)
{
	const cJSON *cells = plot_member(result, "cells");
	return plot_first(cells);
}

/* The path of the swept number along the axis: the chosen one, else the last path of a number with two or more values. */
static const char *path_across(const struct plot *plot, const cJSON *result)
{
	const cJSON *first = cells_of(result), *value, *cell;
	const char *path = NULL;
	cJSON_ArrayForEach(value, plot_member(first, "sweep"))
	{
		if (plot && plot->choice->x) {
			if (strcmp(plot->choice->x, value->string) == 0 && cJSON_IsNumber(value))
				return value->string;
			continue;
		}
		if (cJSON_IsNumber(value))
			for (cell = first->next; cell; cell = cell->next)
				if (plot_number(plot_member(cell, "sweep"), value->string) != value->valuedouble) {
					path = value->string;
					break;
				}
	}
	return path;
}

/* Whether two cells have the same sweep values, ignoring the path `but`. */
static bool alike(const cJSON *one, const cJSON *other, const char *but)
{
	const cJSON *value;
	cJSON_ArrayForEach(value, plot_member(one, "sweep"))
	{
		const cJSON *second = plot_member(plot_member(other, "sweep"), value->string);
		if (strcmp(value->string, but) != 0 && !cJSON_Compare(value, second, true))
			return false;
	}
	return true;
}

/* Cells that differ only in the swept number along the axis, in ascending order. */
struct line {
	const cJSON **cells; /* (n) */
	double *x;
	int n;
};

/* The lines of a result, at most `most`; `all` is their total number. */
static int lines_of(struct plot *plot, const char *path, int most, struct line *lines, int *all)
{
	const cJSON *cell, *first = cells_of(plot->result);
	int n = 0, cells = cJSON_GetArraySize(plot_member(plot->result, "cells"));
	*all = 0;
	for (cell = first; cell; cell = cell->next) {
		bool seen = false;
		for (const cJSON *before = first; before != cell && !seen; before = before->next)
			seen = alike(before, cell, path);
		*all += !seen;
		if (seen || n == most)
			continue;
		struct line *line = &lines[n];
		*line = (struct line){plot_memory(plot, sizeof *line->cells * (size_t)cells),
		                      plot_memory(plot, sizeof *line->x * (size_t)cells), 0};
		if (!line->cells || !line->x)
			return 0;
		for (const cJSON *at = cell; at; at = at->next) {
			double x = plot_number(plot_member(at, "sweep"), path);
			int k = line->n;
			if (!alike(cell, at, path))
				continue;
			for (; k > 0 && line->x[k - 1] > x; k--) {
				line->x[k] = line->x[k - 1];
				line->cells[k] = line->cells[k - 1];
			}
			line->x[k] = x;
			line->cells[k] = at;
			line->n++;
		}
		n++;
	}
	return n;
}

/* The axis of the swept number: logarithmic if its values span decades. */
static struct axis axis_across(const struct line *line)
{
	struct range range = RANGE_EMPTY;
	for (int k = 0; k < line->n; k++)
		range_add(&range, line->x[k]);
	return range.low > 0 && range.high > 30 * range.low ? axis_log(range) : axis_linear(range);
}

/* The paths whose values are the same in the first cells of all lines (`same`), or differ; both include the path along the axis. */
static int paths_of(const struct line *lines, int n, const char *across, bool same,
                    const char *paths[PATHS_MOST])
{
	const cJSON *value;
	int n_paths = 0;
	cJSON_ArrayForEach(value, plot_member(lines[0].cells[0], "sweep"))
	{
		bool differs = false;
		for (int c = 1; c < n; c++)
			differs = differs ||
			          !cJSON_Compare(
			              value, plot_member(plot_member(lines[c].cells[0], "sweep"), value->string), true);
		if (n_paths < PATHS_MOST && (differs != same || strcmp(value->string, across) == 0))
			paths[n_paths++] = value->string;
	}
	return n_paths;
}

static void fault_x(struct plot *plot)
{
	snprintf(plot->fault, sizeof plot->fault, "x must be the path of a swept number of this study");
}

/* ---- swept ---- */

bool plot_has_swept(const cJSON *result)
{
	return path_across(NULL, result) && cJSON_GetArraySize(plot_member(cells_of(result), "outputs")) > 0;
}

/* The output of a cell to draw in a row: the output with the row's name, or the amplification that exists for the cell's law. */
static const cJSON *same_output(const cJSON *cell, const cJSON *row)
{
	const cJSON *output;
	const char *name = plot_text(row, "name");
	cJSON_ArrayForEach(output, plot_member(cell, "outputs"))
	{
		const char *own = plot_text(output, "name");
		bool amplified = strstr(name, "_amplification") && strstr(own, "_amplification");
		if (isfinite(plot_number(row, "building")) || isfinite(plot_number(output, "building"))) {
			if (strcmp(own, name) == 0 && plot_number(row, "building") == plot_number(output, "building") &&
			    plot_number(row, "storey") == plot_number(output, "storey"))
				return output;
			continue;
		}
		const double contact = plot_number(row, "contact");
		if (isfinite(contact) && contact != plot_number(output, "contact"))
			continue;
		double a = plot_number(row, "frequency_hz"), b = plot_number(output, "frequency_hz");
		if ((strcmp(own, name) == 0 || amplified) && (a == b || (isnan(a) && isnan(b))))
			return output;
	}
	return NULL;
}

static const cJSON *input_of(const cJSON *cell, const cJSON *row, int input)
{
	return cJSON_GetArrayItem(plot_member(same_output(cell, row), "inputs"), input);
}

static void draw_input_line(struct plot *plot, const struct panel *panel, const struct line *line,
                            const cJSON *row, int input)
{
	const char *index = plot->choice->index ? plot->choice->index : "ST";
	char low[24], high[24], text[PLOT_TEXT], words[3][32];
	double *x = plot_memory(plot, 2 * sizeof *x * (size_t)line->n), *y = x ? x + line->n : NULL;
	const struct key key = key_of_series(NULL, input);
	snprintf(low, sizeof low, "%s_low", index);
	snprintf(high, sizeof high, "%s_high", index);
	if (!x)
		return;
	for (int k = 0; k < line->n; k++) {
		const cJSON *of = input_of(line->cells[k], row, input);
		x[k] = axis_at(&panel->across, line->x[k]);
		y[k] = axis_at(&panel->up, plot_number(of, index));
		draw_line(&plot->d, &(struct pen){.ink = key.pen.ink, .width = 1.4, .opacity = 0.7}, x[k],
		          axis_at(&panel->up, plot_number(of, low)), x[k],
		          axis_at(&panel->up, plot_number(of, high)));
	}
	draw_curve(&plot->d, &key.pen, line->n, x, y);
	for (int k = 0; k < line->n; k++) {
		const cJSON *of = input_of(line->cells[k], row, input);
		snprintf(text, sizeof text, "%.100s: %s %s [%s, %s]", plot_text(of, "name"), index,
		         draw_number(plot_number(of, index), words[0]), draw_number(plot_number(of, low), words[1]),
		         draw_number(plot_number(of, high), words[2]));
		draw_mark(&plot->d, &(struct mark){.series = input, .size = 3.5}, x[k], y[k], text);
	}
}

/* The outputs of all cells, with the two amplifications in one row. */
static int rows_of(struct plot *plot, const cJSON **rows, int *all)
{
	const char *chosen = plot->choice->output;
	int n = 0;
	*all = 0;
	for (const cJSON *cell = cells_of(plot->result); cell; cell = cell->next) {
		const cJSON *output;
		cJSON_ArrayForEach(output, plot_member(cell, "outputs"))
		{
			bool seen = false;
			if (chosen && strcmp(chosen, plot_text(output, "name")) != 0)
				continue;
			for (int o = 0; o < n; o++)
				seen = seen || same_output(cell, rows[o]) == output;
			*all += !seen && cell == cells_of(plot->result);
			if (!seen && n < OUTPUTS_MOST)
				rows[n++] = output;
		}
	}
	if (n == 0)
		snprintf(plot->fault, sizeof plot->fault, "this result has no output \"%.60s\"",
		         chosen ? chosen : "");
	return n;
}

static const char *row_name(const struct plot *plot, const cJSON *row, char text[PLOT_TEXT])
{
	plot_output_name(row, text);
	// one row for laws with and without a yield displacement
	if (!plot->choice->output && strstr(text, " amplification"))
		snprintf(text, PLOT_TEXT, "amplification");
	return text;
}

void plot_swept(struct plot *plot)
{
	const char *path = path_across(plot, plot->result),
	           *index = plot->choice->index ? plot->choice->index : "ST";
	const char *same[PATHS_MOST], *other[PATHS_MOST];
	const cJSON *rows[OUTPUTS_MOST], *input;
	struct line lines[COLUMNS_MOST];
	struct key keys[INPUTS_MOST];
	char across[PLOT_TEXT], text[PLOT_TEXT], title[2 * PLOT_TEXT];
	int all_lines, all_rows, n_inputs = 0;
	if (!path) {
		fault_x(plot);
		return;
	}
	int n_rows = rows_of(plot, rows, &all_rows),
	    n_lines = lines_of(plot, path, COLUMNS_MOST, lines, &all_lines);
	if (n_rows == 0 || n_lines == 0)
		return;
	plot_path_name(path, across);
	snprintf(title, sizeof title, "%s against %s, with 95 %% intervals",
	         strcmp(index, "ST") == 0 ? "Total indices ST" : "First-order indices S1", across);
	int n_same = paths_of(lines, n_lines, path, true, same),
	    n_other = paths_of(lines, n_lines, path, false, other);
	plot_head(plot, title, plot_sweep_text(lines[0].cells[0], n_other, other, text));
	cJSON_ArrayForEach(input, plot_member(rows[0], "inputs"))
	{
		if (n_inputs == INPUTS_MOST)
			break;
		keys[n_inputs] = key_of_series(plot_text(input, "name"), n_inputs);
		n_inputs++;
	}
	double top = draw_legend(&plot->d, n_inputs, keys, plot->y) + 8;
	int columns = panel_columns(&plot->d, n_lines, PANEL_NARROWEST);
	for (int o = 0; o < n_rows; o++) {
		struct range range = {0, 1};
		for (int c = 0; c < n_lines; c++)
			for (int k = 0; k < lines[c].n; k++)
				cJSON_ArrayForEach(input, plot_member(same_output(lines[c].cells[k], rows[o]), "inputs"))
				{
					char name[24];
					range_add(&range, plot_number(input, index));
					snprintf(name, sizeof name, "%s_low", index);
					range_add(&range, plot_number(input, name));
					snprintf(name, sizeof name, "%s_high", index);
					range_add(&range, plot_number(input, name));
				}
		top = draw_prose(&plot->d,
		                 &(struct label){.x = PLOT_MARGIN,
		                                 .y = top + 12,
		                                 .size = DRAW_TITLE_SIZE,
		                                 .bold = true,
		                                 .fit = plot->d.width - 2 * PLOT_MARGIN},
		                 row_name(plot, rows[o], text), 2) -
		      DRAW_TITLE_SIZE;
		for (int c = 0; c < n_lines; c++) {
			char column[PLOT_TEXT];
			plot_sweep_text(lines[c].cells[0], n_same, same, column);
			struct panel panel = {.height = 236,
			                      .title = *column ? column : NULL,
			                      .x_label = across,
			                      .y_label = index,
			                      .across = axis_across(&lines[c]),
			                      .up = axis_linear(range)};
			panel_place(&plot->d, columns, c, top + 4, &panel);
			panel_draw(&plot->d, &panel);
			for (int j = 0; j < n_inputs; j++)
				draw_input_line(plot, &panel, &lines[c], rows[o], j);
		}
		top = plot->d.height + 10;
	}
	if (n_lines < all_lines || n_rows < all_rows)
		plot_note(plot, "Shown: %d of %d combinations of the other swept values, %d of %d outputs.", n_lines,
		          all_lines, n_rows, all_rows);
	snprintf(plot->sentence, sizeof plot->sentence, "%d inputs, %d outputs, %d values of %s.", n_inputs,
	         n_rows, lines[0].n, across);
}

/* ---- responses ---- */

bool plot_has_responses(const cJSON *result)
{
	const cJSON *cell = cells_of(result), *signals = plot_member(cell ? cell : result, "signals");
	return plot_member(cJSON_GetArrayItem(signals, 0), "oscillators") != NULL;
}

static const char *const SIDES[] = {"left", "right"};

static double peak_of(const cJSON *signal, int oscillator, bool free)
{
	return plot_number(cJSON_GetArrayItem(plot_member(signal, "oscillators"), oscillator),
	                   free ? "displacement_max_free_m" : "displacement_max_m");
}

static const struct key PEAKS[] = {
    {.name = "without pounding", .mark = {.series = 5, .hollow = true}, .marked = true},
    {.name = "left, with pounding", .mark = {.series = 0}, .marked = true},
    {.name = "right, with pounding", .mark = {.series = 1}, .marked = true},
};

/* Draws one cell: a column per signal, with a line from the peak without to the peak with pounding. */
static void draw_signals(struct plot *plot, const cJSON *signals)
{
	const cJSON *signal;
	struct range range = RANGE_EMPTY;
	int n = cJSON_GetArraySize(signals), k = 0;
	char text[PLOT_TEXT], number[2][32];
	cJSON_ArrayForEach(signal, signals) for (int o = 0; o < 2; o++)
	{
		range_add(&range, peak_of(signal, o, true));
		range_add(&range, peak_of(signal, o, false));
	}
	struct panel panel = {.height = 340,
	                      .x_label = "ground motion",
	                      .y_label = "peak displacement [m]",
	                      .bare = range.low > range.high};
	range_add(&range, 0);
	double top = draw_legend(&plot->d, 3, PEAKS, plot->y) + 6;
	panel.across = axis_between(-0.6, n - 0.4);
	panel.across.whole = true;
	panel.up = axis_linear(range.high > 0 ? range : (struct range){0, 1});
	panel_place(&plot->d, 1, 0, top, &panel);
	panel_draw(&plot->d, &panel);
	cJSON_ArrayForEach(signal, signals)
	{
		for (int o = 0; o < 2; o++) {
			double room = (panel.right - panel.left) / n,
			       x = axis_at(&panel.across, k) + (o ? 1 : -1) * fmin(room / 4, 9);
			double with = peak_of(signal, o, false), without = peak_of(signal, o, true);
			snprintf(text, sizeof text, "signal %d, %s: %s m with, %s m without pounding", k, SIDES[o],
			         draw_number(with, number[0]), draw_number(without, number[1]));
			draw_line(&plot->d, &(struct pen){.ink = (enum ink)o, .width = 1.4}, x,
			          axis_at(&panel.up, without), x, axis_at(&panel.up, with));
			draw_mark(&plot->d, &(struct mark){.series = 5, .hollow = true, .size = 3.5}, x,
			          axis_at(&panel.up, without), NULL);
			draw_mark(&plot->d, &(struct mark){.series = o}, x, axis_at(&panel.up, with), text);
		}
		k++;
	}
}

/* Wilson's 95 % interval of k of n: (p + z^2/2n -+ z sqrt(p (1 - p) / n + z^2 / 4 n^2)) / (1 + z^2 / n). */
static void wilson(double k, double n, double *low, double *high)
{
	const double z = 1.959963984540054, p = k / n, middle = p + z * z / (2 * n);
	const double half = z * sqrt(p * (1 - p) / n + z * z / (4 * n * n)), all = 1 + z * z / n;
	*low = (middle - half) / all;
	*high = (middle + half) / all;
}

/* Mean over the signals of a cell; values that are not finite are ignored. */
static double mean_peak(const cJSON *cell, int oscillator, bool free)
{
	const cJSON *signal;
	double sum = 0;
	int n = 0;
	cJSON_ArrayForEach(signal, plot_member(cell, "signals"))
	{
		double peak = peak_of(signal, oscillator, free);
		if (isfinite(peak)) {
			sum += peak;
			n++;
		}
	}
	return n ? sum / n : NAN;
}

static void draw_means(struct plot *plot, const struct line *line, struct panel *panel)
{
	struct range range = RANGE_EMPTY;
	double *x = plot_memory(plot, 2 * sizeof *x * (size_t)line->n), *y = x ? x + line->n : NULL;
	if (!x)
		return;
	for (int k = 0; k < line->n; k++)
		for (int o = 0; o < 4; o++)
			range_add(&range, mean_peak(line->cells[k], o / 2, o % 2));
	panel->bare = range.low > range.high;
	range_add(&range, 0);
	panel->across = axis_across(line);
	panel->up = axis_linear(range.high > 0 ? range : (struct range){0, 1});
	panel->y_label = "mean peak [m]";
	panel->room = 40;
	panel_draw(&plot->d, panel);
	for (int o = 0; o < 4; o++) {
		char text[PLOT_TEXT], number[32];
		bool free = o % 2;
		for (int k = 0; k < line->n; k++) {
			x[k] = axis_at(&panel->across, line->x[k]);
			y[k] = axis_at(&panel->up, mean_peak(line->cells[k], o / 2, free));
		}
		draw_curve(&plot->d,
		           &(struct pen){.ink = (enum ink)(o / 2), .width = 1.8, .dash = free ? "6 3" : NULL},
		           line->n, x, y);
		for (int k = 0; k < line->n; k++) {
			snprintf(text, sizeof text, "%s %s pounding: %s m", SIDES[o / 2], free ? "without" : "with",
			         draw_number(mean_peak(line->cells[k], o / 2, free), number));
			draw_mark(&plot->d, &(struct mark){.series = o / 2, .hollow = free, .size = 3.5}, x[k], y[k],
			          text);
		}
	}
}

static void draw_contacts(struct plot *plot, const struct line *line, struct panel *panel)
{
	double *x = plot_memory(plot, 4 * sizeof *x * (size_t)line->n);
	if (!x)
		return;
	double *y = x + line->n, *low = y + line->n, *high = low + line->n;
	panel->across = axis_across(line);
	panel->up = axis_linear((struct range){0, 1});
	panel->y_label = "with contact";
	panel->room = 40;
	panel_draw(&plot->d, panel);
	for (int k = 0; k < line->n; k++) {
		const cJSON *signal;
		double n = 0, touching = 0;
		cJSON_ArrayForEach(signal, plot_member(line->cells[k], "signals"))
		{
			double count = plot_number(signal, "contact_count");
			n += isfinite(count);
			touching += count > 0;
		}
		wilson(touching, n, &low[k], &high[k]);
		x[k] = axis_at(&panel->across, line->x[k]);
		y[k] = axis_at(&panel->up, touching / n);
		low[k] = axis_at(&panel->up, low[k]);
		high[k] = axis_at(&panel->up, high[k]);
		draw_line(&plot->d, &(struct pen){.ink = 2, .width = 1.4}, x[k], low[k], x[k], high[k]);
	}
	draw_curve(&plot->d, &(struct pen){.ink = 2, .width = 1.8}, line->n, x, y);
	for (int k = 0; k < line->n; k++)
		draw_mark(&plot->d, &(struct mark){.series = 2, .size = 3.5}, x[k], y[k], NULL);
}

static void draw_cells(struct plot *plot, const char *path, const char *title)
{
	static const struct key keys[] = {
	    {.name = "left, with pounding",
	     .mark = {.series = 0},
	     .pen = {.ink = 0, .width = 1.8},
	     .marked = true},
	    {.name = "left, without",
	     .mark = {.series = 0, .hollow = true},
	     .pen = {.ink = 0, .width = 1.8, .dash = "6 3"},
	     .marked = true},
	    {.name = "right, with pounding",
	     .mark = {.series = 1},
	     .pen = {.ink = 1, .width = 1.8},
	     .marked = true},
	    {.name = "right, without",
	     .mark = {.series = 1, .hollow = true},
	     .pen = {.ink = 1, .width = 1.8, .dash = "6 3"},
	     .marked = true},
	    {.name = "share of signals with contact",
	     .mark = {.series = 2},
	     .pen = {.ink = 2, .width = 1.8},
	     .marked = true},
	};
	struct line lines[COLUMNS_MOST];
	char across[PLOT_TEXT], sweep[PLOT_TEXT], more[PLOT_TEXT + 32];
	const char *same[PATHS_MOST], *other[PATHS_MOST];
	int all, n = lines_of(plot, path, COLUMNS_MOST, lines, &all);
	if (n == 0)
		return;
	int n_same = paths_of(lines, n, path, true, same), n_other = paths_of(lines, n, path, false, other);
	// swept values that are the same in all panels
	plot_sweep_text(lines[0].cells[0], n_other, other, sweep);
	snprintf(more, sizeof more, "means over the signals%s%s", *sweep ? "; " : "", sweep);
	plot_head(plot, title, more);
	plot_path_name(path, across);
	double top = draw_legend(&plot->d, 5, keys, plot->y) + 6;
	int columns = panel_columns(&plot->d, n, PANEL_NARROWEST + 20);
	for (int rows = 0; rows < 2; rows++) {
		for (int c = 0; c < n; c++) {
			char column[PLOT_TEXT];
			plot_sweep_text(lines[c].cells[0], n_same, same, column);
			struct panel panel = {
			    .height = rows ? 200 : 250, .title = *column ? column : NULL, .x_label = across};
			panel_place(&plot->d, columns, c, top, &panel);
			(rows ? draw_contacts : draw_means)(plot, &lines[c], &panel);
		}
		top = plot->d.height + 12;
	}
	if (n < all)
		plot_note(plot, "Shown: %d of %d combinations of the other swept values.", n, all);
}

void plot_responses(struct plot *plot)
{
	const cJSON *cell = cells_of(plot->result) ? plot_cell(plot) : NULL;
	const cJSON *signals = plot_member(cell ? cell : plot->result, "signals");
	const char *path = cell && !plot->choice->cell ? path_across(plot, plot->result) : NULL;
	static const char title[] = "Peak displacements with and without pounding";
	char number[2][32], sweep[PLOT_TEXT];
	if (*plot->fault)
		return;
	if (plot->choice->x && !path) {
		fault_x(plot);
		return;
	}
	if (path)
		draw_cells(plot, path, title);
	else {
		plot_head(plot, title, plot_sweep_text(cell, 0, NULL, sweep));
		draw_signals(plot, signals);
	}
	snprintf(plot->sentence, sizeof plot->sentence,
	         "Left oscillator, first ground motion: %s m with pounding, %s m without.",
	         draw_number(peak_of(plot_first(signals), 0, false), number[0]),
	         draw_number(peak_of(plot_first(signals), 0, true), number[1]));
}
