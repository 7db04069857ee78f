/* height_plot.c - story drifts and floor accelerations of a row of buildings over their heights, with and without pounding. */
#include "schema/figure/plot.h"

#include <math.h>
#include <stdio.h>

enum { BUILDINGS_MOST = 8, STOREYS_MOST = 50, MARKS_MOST = 200, PANEL_NARROWEST = 200 };

/* A quantity of every story or floor, and its labels. */
struct quantity {
	const char *list, *with, *without; /* members of a building and of its elements */
	const char *of, *label, *unit;
	double
	    below; /* how far its mark is below the floor on top of the story, as a fraction of the story's height */
};

static const struct quantity QUANTITIES[] = {
    {"storeys", "drift_max_m", "drift_max_free_m", "story", "drift", "m", 0.5},
    {"floors", "acceleration_max_m_s2", "acceleration_max_free_m_s2", "floor", "acceleration", "m/s²", 0},
};

static const struct key KEYS[] = {
    {.name = "with pounding", .mark = {.series = 0}, .pen = {.ink = 0, .width = 1.8}, .marked = true},
    {.name = "without pounding",
     .mark = {.series = 5, .hollow = true},
     .pen = {.ink = 5, .width = 1.8, .dash = "6 3"},
     .marked = true},
};

static const cJSON *signals_of(const cJSON *result, const cJSON *cell)
{
	return plot_member(cell ? cell : result, "signals");
}

static const cJSON *building_of(const cJSON *signal, int b)
{
	return cJSON_GetArrayItem(plot_member(signal, "buildings"), b);
}

bool plot_has_heights(const cJSON *result)
{
	const cJSON *cell = plot_first(plot_member(result, "cells"));
	return building_of(plot_first(signals_of(result, cell)), 0) != NULL;
}

/* Mean over the signals of a number of a storey; values that are not finite are ignored. */
static double mean_of(const cJSON *signals, int b, const char *list, int i, const char *member)
{
	const cJSON *signal;
	double sum = 0;
	int n = 0;
	cJSON_ArrayForEach(signal, signals)
	{
		const double value =
		    plot_number(cJSON_GetArrayItem(plot_member(building_of(signal, b), list), i), member);
		if (isfinite(value)) {
			sum += value;
			n++;
		}
	}
	return n ? sum / n : NAN;
}

static int storeys_of(const cJSON *signals, int b)
{
	const int n = cJSON_GetArraySize(plot_member(building_of(plot_first(signals), b), "storeys"));
	return n < STOREYS_MOST ? n : STOREYS_MOST;
}

static double value_of(const cJSON *signals, int b, const struct quantity *quantity, int i, bool free)
{
	return mean_of(signals, b, quantity->list, i, free ? quantity->without : quantity->with);
}

/* The height of a story: its drift over its drift ratio, of a signal that moves it; NAN: none does. */
static double height_of(const cJSON *signals, int b, int i)
{
	const cJSON *signal;
	cJSON_ArrayForEach(signal, signals)
	{
		const cJSON *storey = cJSON_GetArrayItem(plot_member(building_of(signal, b), "storeys"), i);
		const double height = plot_number(storey, "drift_max_m") / plot_number(storey, "drift_ratio_max");
		if (isfinite(height) && height > 0)
			return height;
	}
	return NAN;
}

/* The vertical axis of all panels: heights in m, or the numbers of stories if a height is not known. */
struct vertical {
	bool metres;
	double top; /* of the tallest building */
};

static struct vertical vertical_of(const cJSON *signals)
{
	struct vertical up = {.metres = true};
	int tallest = 0;
	for (int b = 0; b < BUILDINGS_MOST; b++) {
		double top = 0;
		for (int i = 0; i < storeys_of(signals, b); i++)
			top += height_of(signals, b, i);
		up.metres &= isfinite(top);
		up.top = fmax(up.top, top);
		tallest = storeys_of(signals, b) > tallest ? storeys_of(signals, b) : tallest;
	}
	return up.metres ? up : (struct vertical){.top = tallest + 0.5};
}

/* The range of a quantity over all buildings, which share an axis so that they can be compared. */
static struct range range_of(const cJSON *signals, const struct quantity *quantity)
{
	struct range range = RANGE_EMPTY;
	for (int b = 0; b < BUILDINGS_MOST; b++)
		for (int i = 0; i < storeys_of(signals, b); i++)
			for (int free = 0; free < 2; free++)
				range_add(&range, value_of(signals, b, quantity, i, free));
	return range;
}

/* Whether each story has a mark with its values; marks of very many stories would make the file too large. */
static bool is_marked(const cJSON *signals)
{
	int n = 0;
	for (int b = 0; b < BUILDINGS_MOST; b++)
		n += storeys_of(signals, b);
	return n <= MARKS_MOST;
}

/* Draws one building: the stories from the ground up, without and with pounding. */
static void draw_building(struct plot *plot, const cJSON *signals, int b, const struct quantity *quantity,
                          struct panel *panel)
{
	const int n = storeys_of(signals, b);
	const bool marked = is_marked(signals);
	const struct vertical up = vertical_of(signals);
	double value[STOREYS_MOST], x[STOREYS_MOST], y[STOREYS_MOST];
	char label[PLOT_TEXT], title[PLOT_TEXT];
	snprintf(label, sizeof label, "%s [%s]", quantity->label, quantity->unit);
	snprintf(title, sizeof title, "building %d", b);
	panel->title = title;
	panel->x_label = label;
	panel->y_label = up.metres ? "height [m]" : quantity->of;
	panel->up = axis_between(up.metres ? 0 : 0.5, up.top);
	panel->up.whole = !up.metres;
	panel_draw(&plot->d, panel);
	for (int free = 1; free >= 0; free--) {
		double floor = 0;
		for (int i = 0; i < n; i++) {
			const double height = up.metres ? height_of(signals, b, i) : 1;
			floor += height;
			value[i] = value_of(signals, b, quantity, i, free);
			x[i] = axis_at(&panel->across, value[i]);
			y[i] = axis_at(&panel->up, floor - (up.metres ? quantity->below * height : 0));
		}
		draw_curve(&plot->d, &KEYS[free].pen, n, x, y);
		for (int i = 0; i < n && marked; i++) {
			char text[PLOT_TEXT], number[32];
			snprintf(text, sizeof text, "%s %d, %s: %s %s", quantity->of, i + 1, KEYS[free].name,
			         draw_number(value[i], number), quantity->unit);
			draw_mark(&plot->d, &(struct mark){.series = KEYS[free].mark.series, .hollow = free, .size = 3.5},
			          x[i], y[i], text);
		}
	}
}

void plot_heights(struct plot *plot)
{
	const cJSON *cell = plot_member(plot->result, "cells") ? plot_cell(plot) : NULL;
	const cJSON *signals = signals_of(plot->result, cell);
	char sweep[PLOT_TEXT], number[2][32];
	int buildings[BUILDINGS_MOST], n = 0, tallest = 0;
	if (*plot->fault)
		return;
	for (int b = 0; b < BUILDINGS_MOST; b++)
		if (storeys_of(signals, b) > 0) { // a rigid wall has no storeys
			buildings[n++] = b;
			tallest = storeys_of(signals, b) > tallest ? storeys_of(signals, b) : tallest;
		}
	plot_head(plot, "Peak story drifts and floor accelerations over the height",
	          cell ? plot_sweep_text(cell, 0, NULL, sweep) : "means over the signals");
	double top = draw_legend(&plot->d, 2, KEYS, plot->y) + 6;
	const int columns = panel_columns(&plot->d, n, PANEL_NARROWEST);
	for (size_t q = 0; q < sizeof QUANTITIES / sizeof QUANTITIES[0]; q++) {
		struct range range = range_of(signals, &QUANTITIES[q]);
		const bool bare = range.low > range.high;
		range_add(&range, 0);
		for (int k = 0; k < n; k++) {
			struct panel panel = {.height = fmin(120 + 24 * tallest, 300),
			                      .bare = bare,
			                      .across = axis_linear(range.high > 0 ? range : (struct range){0, 1})};
			panel_place(&plot->d, columns, k, top, &panel);
			draw_building(plot, signals, buildings[k], &QUANTITIES[q], &panel);
		}
		top = plot->d.height + 12;
	}
	snprintf(plot->sentence, sizeof plot->sentence,
	         "Building 0, story 1: mean peak drift %s m with pounding, %s m without.",
	         draw_number(mean_of(signals, 0, "storeys", 0, "drift_max_m"), number[0]),
	         draw_number(mean_of(signals, 0, "storeys", 0, "drift_max_free_m"), number[1]));
}
