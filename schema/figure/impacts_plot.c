/* impacts_plot.c - impacts of a row of buildings by level: when they begin, how many and how strong they are. */
#include "schema/figure/plot.h"

#include <math.h>
#include <stdio.h>

enum { PAIRS_MOST = 7, CONTACTS_MOST = 400, MARKS_MOST = 200, PANEL_NARROWEST = 200 };

static const struct quantity {
	const char *member, *label, *unit;
	bool once; /* only of signals with an impact */
} QUANTITIES[] = {
    {"first_time_s", "first impact [s]", "s", true},
    {"contact_count", "number of impacts", "", false},
    {"impulse_max_n_s", "largest impulse [N s]", "N s", false},
};

static const struct key KEYS[] = {
    {.name = "mean over the signals", .mark = {.series = 0}, .pen = {.ink = 0, .width = 1.8}, .marked = true},
    {.name = "lowest to highest signal", .pen = {.ink = INK_MUTED, .width = 1.6}},
};

static const cJSON *signals_of(const cJSON *result, const cJSON *cell)
{
	return plot_member(cell ? cell : result, "signals");
}

bool plot_has_impacts(const cJSON *result)
{
	const cJSON *signal = plot_first(signals_of(result, plot_first(plot_member(result, "cells"))));
	return plot_member(signal, "buildings") && cJSON_GetArraySize(plot_member(signal, "contacts")) > 0;
}

/* A quantity of one contact over the signals. */
struct impacts {
	int left;        /* building */
	double level[2]; /* on the building and on its right neighbor */
	double mean;     /* NAN: none */
	struct range range;
};

static struct impacts impacts_of(const cJSON *signals, int contact, const struct quantity *quantity)
{
	const cJSON *signal, *first = cJSON_GetArrayItem(plot_member(plot_first(signals), "contacts"), contact);
	const cJSON *levels = plot_member(first, "levels");
	struct impacts impacts = {.left = (int)fmin(fmax(plot_number(first, "left_building"), 0), PAIRS_MOST),
	                          .range = RANGE_EMPTY};
	double sum = 0;
	int n = 0;
	for (int side = 0; side < 2; side++) {
		const cJSON *level = cJSON_GetArrayItem(levels, side);
		impacts.level[side] = cJSON_IsNumber(level) ? level->valuedouble : NAN;
	}
	cJSON_ArrayForEach(signal, signals)
	{
		const cJSON *of = cJSON_GetArrayItem(plot_member(signal, "contacts"), contact);
		const double value = plot_number(of, quantity->member);
		if (!isfinite(value) || (quantity->once && !(plot_number(of, "contact_count") > 0)))
			continue;
		range_add(&impacts.range, value);
		sum += value;
		n++;
	}
	impacts.mean = n ? sum / n : NAN;
	return impacts;
}

/* Draws the levels of one pair of neighbors, from the ground up. */
static void draw_pair(struct plot *plot, const struct impacts *impacts, int n,
                      const struct quantity *quantity, struct panel *panel)
{
	double *x = plot_memory(plot, 2 * sizeof *x * (size_t)(n + 1)), *y = x ? x + n + 1 : NULL;
	char text[PLOT_TEXT], number[5][32];
	if (!x)
		return;
	panel_draw(&plot->d, panel);
	for (int k = 0; k < n; k++) {
		x[k] = axis_at(&panel->across, impacts[k].mean);
		y[k] = axis_at(&panel->up, impacts[k].level[0]);
		draw_line(&plot->d, &KEYS[1].pen, axis_at(&panel->across, impacts[k].range.low), y[k],
		          axis_at(&panel->across, impacts[k].range.high), y[k]);
	}
	draw_curve(&plot->d, &KEYS[0].pen, n, x, y);
	for (int k = 0; k < n && n <= MARKS_MOST / PAIRS_MOST; k++) {
		snprintf(text, sizeof text, "level %s of the left building, %s of the right one: mean %s %s [%s, %s]",
		         draw_number(impacts[k].level[0], number[0]), draw_number(impacts[k].level[1], number[1]),
		         draw_number(impacts[k].mean, number[2]), quantity->unit,
		         draw_number(impacts[k].range.low, number[3]), draw_number(impacts[k].range.high, number[4]));
		draw_mark(&plot->d, &(struct mark){.series = 0, .size = 3.5}, x[k], y[k], text);
	}
}

void plot_impacts(struct plot *plot)
{
	const cJSON *cell = plot_member(plot->result, "cells") ? plot_cell(plot) : NULL;
	const cJSON *signals = signals_of(plot->result, cell);
	char sweep[PLOT_TEXT], title[PLOT_TEXT], number[2][32];
	struct impacts *impacts = plot_memory(plot, sizeof *impacts * CONTACTS_MOST);
	int n_pairs = 0;
	if (*plot->fault || !impacts)
		return;
	const int all = cJSON_GetArraySize(plot_member(plot_first(signals), "contacts"));
	const int n = all < CONTACTS_MOST ? all : CONTACTS_MOST;
	plot_head(plot, "Impacts by level", cell ? plot_sweep_text(cell, 0, NULL, sweep) : "");
	double top = draw_legend(&plot->d, 2, KEYS, plot->y) + 6;
	for (size_t q = 0; q < sizeof QUANTITIES / sizeof QUANTITIES[0]; q++) {
		struct range range = RANGE_EMPTY, levels = RANGE_EMPTY;
		for (int k = 0; k < n; k++) {
			impacts[k] = impacts_of(signals, k, &QUANTITIES[q]);
			range_add(&range, impacts[k].range.low);
			range_add(&range, impacts[k].range.high);
			range_add(&levels, impacts[k].level[0]);
			n_pairs += q == 0 && (k == 0 || impacts[k].left != impacts[k - 1].left);
		}
		const bool bare = range.low > range.high;
		range_add(&range, 0);
		const int columns = panel_columns(&plot->d, n_pairs, PANEL_NARROWEST);
		for (int from = 0, to, column = 0; from < n; from = to, column++) {
			for (to = from; to < n && impacts[to].left == impacts[from].left; to++)
				;
			snprintf(title, sizeof title, "buildings %d and %d", impacts[from].left, impacts[from].left + 1);
			struct panel panel = {.height = fmin(120 + 24 * fmax(levels.high, 1), 300),
			                      .title = title,
			                      .x_label = QUANTITIES[q].label,
			                      .y_label = "level",
			                      .bare = bare,
			                      .across = axis_linear(range.high > 0 ? range : (struct range){0, 1}),
			                      .up = axis_between(fmin(levels.low, 1) - 0.5, fmax(levels.high, 1) + 0.5)};
			panel.up.whole = true;
			panel_place(&plot->d, columns, column, top, &panel);
			draw_pair(plot, impacts + from, to - from, &QUANTITIES[q], &panel);
		}
		top = plot->d.height + 12;
	}
	// the last quantity is the largest impulse
	int most = 0;
	for (int k = 1; k < n; k++)
		if (isfinite(impacts[k].range.high) && !(impacts[most].range.high >= impacts[k].range.high))
			most = k;
	snprintf(plot->sentence, sizeof plot->sentence,
	         "The largest impulse, %s N s, is between buildings %d and %d at level %s of the left one.",
	         draw_number(impacts[most].range.high, number[0]), impacts[most].left, impacts[most].left + 1,
	         draw_number(impacts[most].level[0], number[1]));
}
