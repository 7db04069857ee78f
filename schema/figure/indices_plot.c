/* indices_plot.c - Sobol' indices of one cell: `indices`, `pairs`. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { ROW = 26, PANEL_NARROWEST = 320, OUTPUTS_MOST = 12, ORDINATES_MOST = 64, PAIR = 46 };

// marks of an input: an index with its interval, hollow or filled
static const struct part {
	const char *name, *low, *high, *text;
	bool hollow;
} PARTS[] = {
    {"S1", "S1_low", "S1_high", "first-order index S1", true},
    {"ST", "ST_low", "ST_high", "total index ST", false},
};

static bool is_given(const struct plot *plot)
{
	return strcmp(plot_text(plot->result, "kind"), "given_data") == 0;
}

static const char *noise_name(const struct plot *plot)
{
	return is_given(plot) ? "noise of replicates" : "noise of signals";
}

/* Whether an output has a row for its noise; given data without replicates have none. */
static bool has_noise(const struct plot *plot, const cJSON *output)
{
	return !is_given(plot) || isfinite(plot_number(output, "noise_share"));
}

static bool drawn(const struct plot *plot, const struct part *part)
{
	return !plot->choice->index || strcmp(plot->choice->index, part->name) == 0;
}

static bool is_output(const cJSON *output)
{
	return cJSON_IsObject(output);
}

bool plot_has_indices(const cJSON *result)
{
	return plot_any_output(result, is_output);
}

/* "f_2: ST 0.51 [0.42, 0.6]" */
static const char *value_text(const cJSON *input, const struct part *part, char text[PLOT_TEXT])
{
	char value[32], low[32], high[32];
	snprintf(text, PLOT_TEXT, "%.120s: %s %s [%s, %s]", plot_text(input, "name"), part->name,
	         draw_number(plot_number(input, part->name), value),
	         draw_number(plot_number(input, part->low), low),
	         draw_number(plot_number(input, part->high), high));
	return text;
}

/* ---- one output: inputs in rows ---- */

/* Draws the variance fraction due to signal randomness. */
static void draw_noise(struct plot *plot, const struct axis *axis, const cJSON *output, double names,
                       double y)
{
	char number[32];
	double share = plot_number(output, "noise_share"), at = axis_at(axis, fmin(fmax(share, 0), axis->high));
	double zero = axis_at(axis, 0);
	draw_text(
	    &plot->d,
	    &(struct label){.x = axis->start - 8, .y = y + 4, .anchor = 'e', .ink = INK_MUTED, .fit = names},
	    noise_name(plot));
	if (!isfinite(share)) {
		draw_text(&plot->d, &(struct label){.x = zero + 6, .y = y + 4, .ink = INK_MUTED}, "no value");
		return;
	}
	draw_box(&plot->d, &(struct pen){.ink = INK_MUTED, .opacity = 0.55}, zero, y - 5, at - zero, 10);
	// after the bar, or inside at its end if there is no room after it
	bool inside = at + 50 > axis->end;
	draw_text(&plot->d,
	          &(struct label){.x = inside ? at - 6 : at + 6, .y = y + 4, .anchor = inside ? 'e' : 's'},
	          draw_number(share, number));
}

static void draw_input(struct plot *plot, const struct axis *axis, const cJSON *input, double y)
{
	char text[PLOT_TEXT];
	bool any = false;
	for (int k = 0; k < 2; k++) {
		const struct part *part = &PARTS[k];
		double value = plot_number(input, part->name), at = y + (drawn(plot, &PARTS[1 - k]) ? k ? 5 : -5 : 0);
		if (!drawn(plot, part) || !isfinite(value))
			continue;
		any = true;
		draw_line(&plot->d, &(struct pen){.ink = (enum ink)k, .width = 1.6},
		          axis_at(axis, plot_number(input, part->low)), at,
		          axis_at(axis, plot_number(input, part->high)), at);
		draw_mark(&plot->d, &(struct mark){.series = k, .hollow = part->hollow}, axis_at(axis, value), at,
		          value_text(input, part, text));
	}
	if (!any)
		draw_text(&plot->d, &(struct label){.x = axis_at(axis, 0) + 6, .y = y + 4, .ink = INK_MUTED},
		          "no value");
}

static void draw_output(struct plot *plot, const cJSON *output, struct panel *panel, struct range range)
{
	const struct pen grid = {.ink = INK_GRID}, line = {.ink = INK_TEXT};
	const cJSON *inputs = plot_member(output, "inputs"), *input;
	int n = cJSON_GetArraySize(inputs);
	char title[PLOT_TEXT];
	struct ticks ticks;
	const bool noise = has_noise(plot, output);
	double names = noise ? draw_width(noise_name(plot), DRAW_TEXT_SIZE) : 0;
	cJSON_ArrayForEach(input, inputs) names =
	    fmax(names, draw_width(plot_text(input, "name"), DRAW_TEXT_SIZE));
	names = fmin(names, 0.38 * panel->width);
	struct axis axis = axis_linear(range);
	axis.start = panel->x + names + 10;
	axis.end = panel->x + panel->width - 12;
	double top = panel->y + 22, bottom = top + (n + noise) * ROW + 4;
	axis_ticks_across(&axis, &ticks);
	plot_output_name(output, title);
	// aligned with the frame, unless it needs the room above the names
	const double wide = draw_width(title, DRAW_BOLD * DRAW_TITLE_SIZE);
	const double left = fmin(axis.start, fmax(panel->x, axis.end - wide - 1));
	draw_text(
	    &plot->d,
	    &(struct label){
	        .x = left, .y = panel->y + 13, .size = DRAW_TITLE_SIZE, .bold = true, .fit = axis.end - left},
	    title);
	for (int k = 0; k < ticks.n; k++) {
		double x = axis_at(&axis, ticks.tick[k].value);
		draw_line(&plot->d, ticks.tick[k].value == 0 ? &line : &grid, x, top, x, bottom);
		draw_text(&plot->d, &(struct label){.x = x, .y = bottom + 16, .anchor = 'm', .ink = INK_MUTED},
		          ticks.tick[k].text);
	}
	draw_line(&plot->d, &line, axis.start, bottom, axis.end, bottom);
	double y = top + ROW / 2 + 2;
	cJSON_ArrayForEach(input, inputs)
	{
		draw_text(&plot->d, &(struct label){.x = axis.start - 8, .y = y + 4, .anchor = 'e', .fit = names},
		          plot_text(input, "name"));
		draw_input(plot, &axis, input, y);
		y += ROW;
	}
	if (noise)
		draw_noise(plot, &axis, output, names, y);
}

/* The range of the indices of some outputs, at least [0, 1]. */
static struct range range_of(const struct plot *plot, const cJSON *const *outputs, int n)
{
	struct range range = {0, 1};
	const cJSON *input;
	for (int o = 0; o < n; o++)
		cJSON_ArrayForEach(input, plot_member(outputs[o], "inputs")) for (int k = 0; k < 2;
		                                                                  k++) if (drawn(plot, &PARTS[k]))
		{
			range_add(&range, plot_number(input, PARTS[k].name));
			range_add(&range, plot_number(input, PARTS[k].low));
			range_add(&range, plot_number(input, PARTS[k].high));
		}
	return range;
}

/* ---- outputs at many frequencies: a panel for each input ---- */

static void draw_ordinates(struct plot *plot, const cJSON *const *outputs, int n, int input,
                           struct panel *panel)
{
	double *x = plot_memory(plot, 5 * sizeof *x * (size_t)n);
	if (!x)
		return;
	double *value = x + n, *low = value + n, *high = low + n, *across = high + n;
	struct range frequencies = RANGE_EMPTY;
	for (int o = 0; o < n; o++) {
		x[o] = plot_number(outputs[o], "frequency_hz");
		range_add(&frequencies, x[o]);
	}
	panel->title = plot_text(cJSON_GetArrayItem(plot_member(outputs[0], "inputs"), input), "name");
	panel->x_label = "frequency [Hz]";
	panel->across = axis_log(frequencies);
	panel->up = axis_linear(range_of(plot, outputs, n));
	panel_draw(&plot->d, panel);
	for (int k = 0; k < 2; k++) {
		char text[PLOT_TEXT];
		const struct part *part = &PARTS[k];
		if (!drawn(plot, part))
			continue;
		for (int o = 0; o < n; o++) {
			const cJSON *of = cJSON_GetArrayItem(plot_member(outputs[o], "inputs"), input);
			across[o] = axis_at(&panel->across, x[o]);
			value[o] = axis_at(&panel->up, plot_number(of, part->name));
			low[o] = axis_at(&panel->up, plot_number(of, part->low));
			high[o] = axis_at(&panel->up, plot_number(of, part->high));
		}
		draw_band(&plot->d, &(struct pen){.ink = (enum ink)k, .opacity = 0.16}, n, across, low, high);
		draw_curve(&plot->d,
		           &(struct pen){.ink = (enum ink)k, .width = 1.8, .dash = part->hollow ? "6 3" : NULL}, n,
		           across, value);
		for (int o = 0; o < n && n <= 24; o++)
			draw_mark(&plot->d, &(struct mark){.series = k, .hollow = part->hollow, .size = 3}, across[o],
			          value[o],
			          value_text(cJSON_GetArrayItem(plot_member(outputs[o], "inputs"), input), part, text));
	}
}

/* ---- indices ---- */

static double draw_keys(struct plot *plot, bool band)
{
	struct key keys[2];
	int n = 0;
	for (int k = 0; k < 2; k++)
		if (drawn(plot, &PARTS[k]))
			keys[n++] = (struct key){
			    .name = PARTS[k].text,
			    .mark = {.series = k, .hollow = PARTS[k].hollow},
			    .pen = {.ink = (enum ink)k, .width = 1.8, .dash = band && PARTS[k].hollow ? "6 3" : NULL},
			    .marked = true,
			    .band = band};
	return draw_legend(&plot->d, n, keys, plot->y);
}

/* Describes the input with the largest ST of the first output in words, for readers who do not see the picture. */
static void say_largest(struct plot *plot, const cJSON *output)
{
	const cJSON *input, *largest = NULL;
	char text[PLOT_TEXT], name[PLOT_TEXT], number[32];
	cJSON_ArrayForEach(input, plot_member(output, "inputs"))
	{
		double value = plot_number(input, "ST");
		if (isfinite(value) && (!largest || value > plot_number(largest, "ST")))
			largest = input;
	}
	if (!largest) {
		snprintf(plot->sentence, sizeof plot->sentence, "No total index of %.100s has a value.",
		         plot_output_name(output, name));
		return;
	}
	int n = snprintf(plot->sentence, sizeof plot->sentence, "Largest total index of %.100s: input %.160s.",
	                 plot_output_name(output, name), value_text(largest, &PARTS[1], text));
	if (has_noise(plot, output))
		snprintf(plot->sentence + n, sizeof plot->sentence - (size_t)n,
		         " The %s accounts for %s of the variance.", noise_name(plot),
		         draw_number(plot_number(output, "noise_share"), number));
}

void plot_indices(struct plot *plot)
{
	char sweep[PLOT_TEXT], text[PLOT_TEXT];
	const cJSON *cell = plot_cell(plot), *outputs[ORDINATES_MOST + OUTPUTS_MOST];
	int n = cell ? plot_outputs(plot, cell, is_output, ORDINATES_MOST + OUTPUTS_MOST, outputs) : 0,
	    n_plain = 0;
	if (n == 0)
		return;
	while (n_plain < n && !isfinite(plot_number(outputs[n_plain], "frequency_hz")))
		n_plain++;
	plot_head(plot, "Sobol' indices with 95 % intervals", plot_sweep_text(cell, 0, NULL, sweep));
	double y = draw_keys(plot, n_plain < n) + 8;
	int inputs = cJSON_GetArraySize(plot_member(outputs[0], "inputs"));
	// one or two ordinates are drawn like other outputs
	bool curves = n - n_plain > 2;
	int n_rows = curves ? n_plain : n;
	int columns = panel_columns(&plot->d, n_rows, PANEL_NARROWEST);
	for (int o = 0; o < n_rows; o++) {
		struct panel panel = {.height = (inputs + 1) * ROW + 52};
		panel_place(&plot->d, columns, o, y, &panel);
		draw_output(plot, outputs[o], &panel, range_of(plot, outputs, n_rows));
	}
	if (curves) {
		y = n_rows ? plot->d.height + 16 : y;
		snprintf(text, sizeof text, "indices of the %.100s over frequency, a panel for each input",
		         plot_text(outputs[n_plain], "name"));
		for (char *c = text; *c; c++)
			*c = *c == '_' ? ' ' : *c;
		y = draw_prose(&plot->d,
		               &(struct label){.x = PLOT_MARGIN,
		                               .y = y + 14,
		                               .size = DRAW_TITLE_SIZE,
		                               .bold = true,
		                               .fit = plot->d.width - 2 * PLOT_MARGIN},
		               text, 3);
		columns = panel_columns(&plot->d, inputs, 250);
		for (int j = 0; j < inputs; j++) {
			struct panel panel = {.height = 220};
			panel_place(&plot->d, columns, j, y - 8, &panel);
			draw_ordinates(plot, outputs + n_plain, n - n_plain, j, &panel);
		}
	}
	say_largest(plot, outputs[0]);
}

/* ---- pairs ---- */

static bool has_interactions(const cJSON *output)
{
	return cJSON_GetArraySize(plot_member(output, "second_order")) > 0;
}

bool plot_has_pairs(const cJSON *result)
{
	return plot_any_output(result, has_interactions);
}

static int place_of(const cJSON *inputs, const char *name)
{
	const cJSON *input;
	int j = 0;
	cJSON_ArrayForEach(input, inputs)
	{
		if (strcmp(plot_text(input, "name"), name) == 0)
			return j;
		j++;
	}
	return -1;
}

/* Draws a square for each pair below the diagonal; `names` is the width for the inputs' names. */
static void draw_pairs(struct plot *plot, const cJSON *output, double x, double y, double side, double names)
{
	const cJSON *inputs = plot_member(output, "inputs"), *pair, *input;
	char text[2 * PLOT_TEXT], title[PLOT_TEXT], number[32], low[32], high[32];
	int n = cJSON_GetArraySize(inputs), row = 0;
	draw_text(&plot->d, &(struct label){.x = x, .y = y + 13, .size = DRAW_TITLE_SIZE, .bold = true},
	          plot_output_name(output, title));
	y += 42;
	cJSON_ArrayForEach(input, inputs)
	{
		const char *name = plot_text(input, "name");
		if (row > 0)
			draw_text(&plot->d,
			          &(struct label){.x = x + names - 6,
			                          .y = y + (row - 1) * side + side / 2 + 4,
			                          .anchor = 'e',
			                          .fit = names - 6},
			          name);
		// above the first square of the column, at the end of the input's row
		if (row < n - 1)
			draw_text(&plot->d,
			          &(struct label){.x = x + names + row * side + 4,
			                          .y = y + row * side - 6,
			                          .ink = INK_MUTED,
			                          .fit = plot->d.width - x - names - row * side - 8},
			          name);
		row++;
	}
	cJSON_ArrayForEach(pair, plot_member(output, "second_order"))
	{
		const cJSON *both = plot_member(pair, "inputs");
		const cJSON *one = cJSON_GetArrayItem(both, 0), *other = cJSON_GetArrayItem(both, 1);
		int a = place_of(inputs, cJSON_IsString(one) ? one->valuestring : "");
		int b = place_of(inputs, cJSON_IsString(other) ? other->valuestring : "");
		double value = plot_number(pair, "S2");
		if (a < 0 || b < 0)
			continue;
		int left = a < b ? a : b, below = a < b ? b : a;
		double at_x = x + names + left * side, at_y = y + (below - 1) * side;
		draw_box(&plot->d, &(struct pen){.ink = INK_GRID, .opacity = 0.45}, at_x + 1, at_y + 1, side - 2,
		         side - 2);
		if (isfinite(value))
			draw_box(&plot->d,
			         &(struct pen){.ink = value < 0 ? (enum ink)1 : (enum ink)0,
			                       .opacity = 0.005 + 0.5 * fmin(fabs(value), 1)},
			         at_x + 1, at_y + 1, side - 2, side - 2);
		double hundredths = nearbyint(100 * value);
		snprintf(text, sizeof text, isfinite(value) ? "%s%.2f" : "–", hundredths < 0 ? "−" : "",
		         fabs(hundredths / 100));
		draw_text(
		    &plot->d,
		    &(struct label){.x = at_x + side / 2, .y = at_y + side / 2 - 1, .anchor = 'm', .bold = true},
		    text);
		double half = (plot_number(pair, "S2_high") - plot_number(pair, "S2_low")) / 2;
		if (isfinite(half)) {
			snprintf(text, sizeof text, "±%.2f", half);
			draw_text(&plot->d,
			          &(struct label){.x = at_x + side / 2,
			                          .y = at_y + side / 2 + 13,
			                          .anchor = 'm',
			                          .size = 11,
			                          .ink = INK_MUTED},
			          text);
		}
		snprintf(plot->sentence, sizeof plot->sentence,
		         "The last pair, %.80s and %.80s in %.80s, has S2 %s [%s, %s].",
		         cJSON_IsString(one) ? one->valuestring : "", cJSON_IsString(other) ? other->valuestring : "",
		         title, draw_number(value, number), draw_number(plot_number(pair, "S2_low"), low),
		         draw_number(plot_number(pair, "S2_high"), high));
	}
	plot->d.height = fmax(plot->d.height, y + (n - 1) * side + 8);
}

void plot_pairs(struct plot *plot)
{
	char sweep[PLOT_TEXT];
	const cJSON *cell = plot_cell(plot), *outputs[6], *input;
	int n = cell ? plot_outputs(plot, cell, has_interactions, 6, outputs) : 0;
	if (n == 0)
		return;
	plot_head(plot, "Second-order indices S2 of every two inputs, with half widths of their 95 % intervals",
	          plot_sweep_text(cell, 0, NULL, sweep));
	const cJSON *inputs = plot_member(outputs[0], "inputs");
	int n_inputs = cJSON_GetArraySize(inputs);
	double names = 40;
	cJSON_ArrayForEach(input, inputs) names =
	    fmax(names, draw_width(plot_text(input, "name"), DRAW_TEXT_SIZE) + 10);
	names = fmin(names, 140);
	double side = fmax(fmin((plot->d.width - 3 * PLOT_MARGIN - names) / (n_inputs - 1), 72), PAIR);
	double whole = names + (n_inputs - 1) * side + PLOT_MARGIN + 20, x = PLOT_MARGIN, y = plot->y + 8;
	// squares must have room for their numbers, so a matrix of many inputs is wider than requested
	plot->d.width = fmax(plot->d.width, whole + PLOT_MARGIN);
	for (int o = 0; o < n; o++) {
		if (x > PLOT_MARGIN && x + whole > plot->d.width) {
			x = PLOT_MARGIN;
			y = plot->d.height + 10;
		}
		draw_pairs(plot, outputs[o], x, y, side, names);
		x += whole;
	}
}
