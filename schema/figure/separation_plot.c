/* separation_plot.c - probability of pounding: `separation` over the gap, `fragility` over a swept intensity. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { CURVES_MOST = 5, POINTS = 80, RULES_MOST = 3 };

/* ---- separation ---- */

bool plot_has_separation(const cJSON *result)
{
	const cJSON *cell = plot_first(plot_member(result, "cells")),
	            *contact = plot_first(plot_member(cell, "contacts"));
	return plot_first(plot_member(contact ? contact : cell, "pounding")) != NULL;
}

/* The object with the gap results of a cell, or of the chosen contact in a row of buildings; NULL: no such contact, see plot->fault. */
static const cJSON *needs_of(struct plot *plot, const cJSON *cell)
{
	const cJSON *contacts = plot_member(cell, "contacts");
	const int n = cJSON_GetArraySize(contacts), k = plot->choice->contact ? atoi(plot->choice->contact) : 0;
	if (!contacts && !plot->choice->contact)
		return cell;
	if (k >= 0 && k < n)
		return cJSON_GetArrayItem(contacts, k);
	if (contacts)
		snprintf(plot->fault, sizeof plot->fault, "contact must be a whole number in [0, %d]", n - 1);
	else
		snprintf(plot->fault, sizeof plot->fault,
		         "this result has no contacts: its scene is two oscillators");
	return NULL;
}

/* Writes "contact 2, levels 3 and 2 of buildings 0 and 1, PGA 1 m/s2" into the buffer. */
static const char *place_text(const cJSON *needs, const char *sweep, char text[PLOT_TEXT])
{
	const cJSON *levels = plot_member(needs, "levels"), *first = plot_first(levels),
	            *second = first ? first->next : NULL;
	const double left = plot_number(needs, "left_building");
	char number[2][32];
	if (!cJSON_IsNumber(first) || !cJSON_IsNumber(second))
		return sweep;
	snprintf(text, PLOT_TEXT, "contact %.0f, levels %s and %s of buildings %.0f and %.0f%s%.100s",
	         plot_number(needs, "contact"), draw_number(first->valuedouble, number[0]),
	         draw_number(second->valuedouble, number[1]), left, left + 1, *sweep ? ", " : "", sweep);
	return text;
}

static const cJSON *rule_at(const cJSON *cell, int k)
{
	return cJSON_GetArrayItem(plot_member(cell, "rules"), k);
}

/* "absolute_sum" -> "absolute sum", "srss" -> "SRSS" */
static const char *spaced(const char *name, char text[PLOT_TEXT])
{
	snprintf(text, PLOT_TEXT, "%s", strcmp(name, "srss") == 0 ? "SRSS" : name);
	for (char *c = text; *c; c++)
		*c = *c == '_' ? ' ' : *c;
	return text;
}

static void draw_probability(struct plot *plot, const cJSON *cell, struct panel *panel)
{
	const cJSON *pounding = plot_member(cell, "pounding");
	struct range gaps = RANGE_EMPTY, whole = {0, 1};
	int n, n_p, n_low, n_high;
	double *gap = plot_column(plot, pounding, "gap_m", &n),
	       *p = plot_column(plot, pounding, "probability", &n_p),
	       *low = plot_column(plot, pounding, "low", &n_low),
	       *high = plot_column(plot, pounding, "high", &n_high);
	if (!gap || !p || !low || !high)
		return;
	for (int k = 0; k < n; k++)
		range_add(&gaps, gap[k]);
	for (int k = 0; k < RULES_MOST; k++)
		range_add(&gaps, plot_number(rule_at(cell, k), "gap_m"));
	panel->x_label = "gap [m]";
	panel->y_label = "probability of pounding";
	panel->across = axis_linear(gaps);
	panel->up = axis_linear(whole);
	panel_draw(&plot->d, panel);
	axis_places(&panel->across, n, gap);
	axis_places(&panel->up, n, p);
	axis_places(&panel->up, n, low);
	axis_places(&panel->up, n, high);
	draw_band(&plot->d, &(struct pen){.ink = 0, .opacity = 0.2}, n, gap, low, high);
	draw_curve(&plot->d, &(struct pen){.ink = 0, .width = 2}, n, gap, p);
	for (int k = 0; k < n; k++) {
		char text[PLOT_TEXT], number[2][32];
		const cJSON *point = cJSON_GetArrayItem(pounding, k);
		snprintf(text, sizeof text, "gap %s m: %s", draw_number(plot_number(point, "gap_m"), number[0]),
		         draw_number(plot_number(point, "probability"), number[1]));
		draw_mark(&plot->d, &(struct mark){.series = 0, .size = 3}, gap[k], p[k], text);
	}
	for (int k = 0; k < RULES_MOST; k++) {
		const double at = axis_at(&panel->across, plot_number(rule_at(cell, k), "gap_m"));
		if (isfinite(at))
			draw_line(&plot->d,
			          &(struct pen){.ink = (enum ink)(k + 1), .width = 1.8, .dash = draw_dash(k + 1)}, at,
			          panel->top, at, panel->bottom);
	}
}

void plot_separation(struct plot *plot)
{
	char sweep[PLOT_TEXT], place[PLOT_TEXT], names[RULES_MOST][PLOT_TEXT], number[3][32];
	struct key keys[1 + RULES_MOST] = {
	    {.name = "fraction of runs that pound, 95 % band", .pen = {.ink = 0, .width = 2}, .band = true}};
	const cJSON *chosen = plot_cell(plot), *cell = chosen ? needs_of(plot, chosen) : NULL, *at_5 = NULL, *gap;
	if (!cell)
		return;
	for (int k = 0; k < RULES_MOST; k++)
		keys[1 + k] = (struct key){.name = spaced(plot_text(rule_at(cell, k), "name"), names[k]),
		                           .pen = {.ink = (enum ink)(k + 1), .width = 1.8, .dash = draw_dash(k + 1)}};
	plot_head(plot, "Probability of pounding and gap needed",
	          place_text(cell, plot_sweep_text(chosen, 0, NULL, sweep), place));
	const double top = draw_legend(&plot->d, 1 + RULES_MOST, keys, plot->y) + 8;
	struct panel panel = {.height = 360};
	panel_place(&plot->d, 1, 0, top, &panel);
	draw_probability(plot, cell, &panel);
	cJSON_ArrayForEach(gap, plot_member(cell, "gaps")) if (plot_number(gap, "probability") == 0.05) at_5 =
	    gap;
	const cJSON *needed = plot_member(cell, "gap_needed");
	snprintf(plot->sentence, sizeof plot->sentence, "Mean gap needed %s m, largest %s m of %.0f runs%s%s%s.",
	         draw_number(plot_number(needed, "mean_m"), number[0]),
	         draw_number(plot_number(needed, "largest_m"), number[1]), plot_number(needed, "runs"),
	         at_5 ? "; 5 % need more than " : "",
	         at_5 ? draw_number(plot_number(at_5, "gap_m"), number[2]) : "", at_5 ? " m" : "");
}

/* ---- fragility ---- */

bool plot_has_fragility(const cJSON *result)
{
	return plot_first(plot_member(result, "fragility")) != NULL;
}

/* Whether a cell belongs to a set: all sweep values of the set are the cell's. */
static bool in_set(const cJSON *set, const cJSON *cell)
{
	const cJSON *value;
	cJSON_ArrayForEach(
	    value,
	    plot_member(set, "sweep")) if (!cJSON_Compare(value,
	                                                  plot_member(plot_member(cell, "sweep"), value->string),
	                                                  true)) return false;
	return true;
}

/* Draws the fragility curve of a gap and the fractions of runs with pounding. */
static void draw_fragility(struct plot *plot, const cJSON *set, int g, int series, const struct panel *panel)
{
	const cJSON *curve = cJSON_GetArrayItem(plot_member(set, "curves"), g), *cell;
	const double median = plot_number(curve, "median"), dispersion = plot_number(curve, "dispersion");
	double x[POINTS], y[POINTS];
	for (int k = 0; k < POINTS; k++) {
		const double at = panel->across.low * pow(panel->across.high / panel->across.low, k / (POINTS - 1.0));
		x[k] = axis_at(&panel->across, at);
		y[k] = axis_at(&panel->up, 0.5 * erfc(-log(at / median) / (dispersion * sqrt(2))));
	}
	draw_curve(&plot->d, &(struct pen){.ink = (enum ink)series, .width = 2}, POINTS, x, y);
	cJSON_ArrayForEach(cell, plot_member(plot->result, "cells"))
	{
		if (!in_set(set, cell))
			continue;
		const cJSON *point = cJSON_GetArrayItem(plot_member(needs_of(plot, cell), "pounding"), g);
		const double at = plot_number(plot_member(cell, "sweep"), plot_text(set, "intensity"));
		char text[PLOT_TEXT], number[3][32];
		snprintf(text, sizeof text, "gap %s m, intensity %s: %s",
		         draw_number(plot_number(point, "gap_m"), number[0]), draw_number(at, number[1]),
		         draw_number(plot_number(point, "probability"), number[2]));
		draw_mark(&plot->d, &(struct mark){.series = series, .size = 3.5}, axis_at(&panel->across, at),
		          axis_at(&panel->up, plot_number(point, "probability")), text);
	}
}

void plot_fragility(struct plot *plot)
{
	const cJSON *chosen = plot_cell(plot), *set = plot_first(plot_member(plot->result, "fragility")), *cell,
	            *curve;
	char label[PLOT_TEXT], names[CURVES_MOST][PLOT_TEXT], sweep[PLOT_TEXT], place[PLOT_TEXT], number[2][32];
	struct range across = RANGE_EMPTY, whole = {0, 1};
	struct key keys[CURVES_MOST];
	int with[CURVES_MOST], n_curves = 0, n = 0, g = 0;
	const cJSON *needs = chosen ? needs_of(plot, chosen) : NULL;
	if (!needs)
		return;
	while (set && (!in_set(set, chosen) || (plot_member(set, "contact") &&
	                                        plot_number(set, "contact") != plot_number(needs, "contact"))))
		set = set->next;
	const char *intensity = plot_text(set, "intensity");
	cJSON_ArrayForEach(cell, plot_member(plot->result, "cells")) if (in_set(set, cell))
	    range_add(&across, plot_number(plot_member(cell, "sweep"), intensity));
	cJSON_ArrayForEach(curve, plot_member(set, "curves")) n_curves += isfinite(plot_number(curve, "median"));
	// as many gaps as there are distinct colors, evenly spaced among the gaps with a curve
	int seen = 0;
	cJSON_ArrayForEach(curve, plot_member(set, "curves"))
	{
		if (isfinite(plot_number(curve, "median"))) {
			const int most = n_curves < CURVES_MOST ? n_curves : CURVES_MOST;
			if (n < most && seen * (most > 1 ? most - 1 : 1) >= n * (n_curves - 1)) {
				snprintf(names[n], PLOT_TEXT, "gap %s m",
				         draw_number(plot_number(curve, "gap_m"), number[0]));
				keys[n] = (struct key){.name = names[n],
				                       .mark = {.series = n},
				                       .pen = {.ink = (enum ink)n, .width = 2},
				                       .marked = true};
				with[n++] = g;
			}
			seen++;
		}
		g++;
	}
	plot_path_name(intensity, label);
	plot_head(plot, "Fragility curves",
	          place_text(needs, plot_sweep_text(chosen, 1, &intensity, sweep), place));
	const double top = draw_legend(&plot->d, n, keys, plot->y) + 8;
	struct panel panel = {.height = 360, .x_label = label, .y_label = "probability of pounding"};
	panel_place(&plot->d, 1, 0, top, &panel);
	panel.across = axis_log(across);
	panel.up = axis_linear(whole);
	panel_draw(&plot->d, &panel);
	for (int k = 0; k < n; k++)
		draw_fragility(plot, set, with[k], k, &panel);
	const cJSON *first = n ? cJSON_GetArrayItem(plot_member(set, "curves"), with[0]) : NULL;
	if (first)
		snprintf(
		    plot->sentence, sizeof plot->sentence,
		    "%.100s: half of the motions of intensity %s pound, dispersion %s. Marks: fractions of the runs.",
		    names[0], draw_number(plot_number(first, "median"), number[0]),
		    draw_number(plot_number(first, "dispersion"), number[1]));
	else
		snprintf(plot->sentence, sizeof plot->sentence, "No gap has a curve.");
}
