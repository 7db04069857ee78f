/* timeline_plot.c - the contacts of one ground motion in time, from the samples of a response study. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "schema/figure/plot.h"

enum { MARKS_MOST = 1000, PAIRS_MOST = 7 };

static const double RADIUS_MOST = 9, RADIUS_LEAST = 1.2; /* of marks; their areas show impulses */

bool plot_has_timeline(const cJSON *result)
{
	return plot_has_responses(result) || plot_has_impacts(result);
}

/* Whether the result, if given, has the chosen signal and cell: without this check an invalid choice looks like no contacts. */
static bool chosen_there(struct plot *plot, int signal)
{
	if (!plot_is_result(plot->result))
		return true;
	const cJSON *cell = plot_member(plot->result, "cells") ? plot_cell(plot) : NULL;
	const int n = cJSON_GetArraySize(plot_member(cell ? cell : plot->result, "signals"));
	if (!*plot->fault && signal >= n)
		snprintf(plot->fault, sizeof plot->fault,
		         "no sample of signal %d: signal must be a whole number in [0, %d]", signal, n - 1);
	return !*plot->fault;
}

/* The contacts of a cell to draw: the ones with the largest impulses if there are too many. */
struct contacts {
	int n, all;
	const double *time, *duration, *speed, *impulse, *building, *level,
	    *right_level; /* columns; NULL: not in the samples */
	int *rows;        /* rows in the table  (n) */
	double largest, latest;
	int strongest;
};

static int by_impulse(const void *a, const void *b)
{
	const double one = **(const double *const *)a, other = **(const double *const *)b;
	return (one < other) - (one > other);
}

static void contacts_read(struct plot *plot, const struct plot_table *table, struct contacts *contacts)
{
	const double *cell = plot_table_column(table, "cell");
	const int chosen = plot->choice->cell ? atoi(plot->choice->cell) : 0;
	const double **order = plot_memory(plot, sizeof *order * (size_t)(table->n + 1));
	*contacts = (struct contacts){.time = plot_table_column(table, "time_s"),
	                              .duration = plot_table_column(table, "duration_s"),
	                              .speed = plot_table_column(table, "approach_speed_m_s"),
	                              .impulse = plot_table_column(table, "impulse_n_s"),
	                              .building = plot_table_column(table, "left_building"),
	                              .level = plot_table_column(table, "left_level"),
	                              .right_level = plot_table_column(table, "right_level"),
	                              .rows = plot_memory(plot, sizeof *contacts->rows * (size_t)(table->n + 1))};
	if (!contacts->impulse || !contacts->duration || !contacts->speed || !contacts->building ||
	    !contacts->level || !contacts->right_level || !cell) {
		snprintf(plot->fault, sizeof plot->fault,
		         "the samples have no contacts: expected a column impulse_n_s and others");
		return;
	}
	for (int k = 0; order && k < table->n; k++)
		if (cell[k] == chosen && isfinite(contacts->impulse[k])) {
			order[contacts->all++] = &contacts->impulse[k];
			contacts->latest = fmax(contacts->latest, contacts->time[k]);
		}
	if (!order || !contacts->rows || contacts->all == 0)
		return;
	qsort(order, (size_t)contacts->all, sizeof *order, by_impulse);
	contacts->n = contacts->all < MARKS_MOST ? contacts->all : MARKS_MOST;
	for (int k = 0; k < contacts->n; k++)
		contacts->rows[k] = (int)(order[k] - contacts->impulse);
	contacts->strongest = contacts->rows[0];
	contacts->largest = *order[0];
}

/* The description of a contact, as the title of its mark. */
static const char *contact_text(const struct contacts *c, int row, char text[PLOT_TEXT])
{
	char number[5][32], level[80] = "";
	if (isfinite(c->level[row]))
		snprintf(level, sizeof level, ", level %s", draw_number(c->level[row], number[0]));
	snprintf(text, PLOT_TEXT, "%s s%s: impulse %s N s, approach %s m/s, %s s long",
	         draw_number(c->time[row], number[1]), level, draw_number(c->impulse[row], number[2]),
	         draw_number(c->speed[row], number[3]), draw_number(c->duration[row], number[4]));
	return text;
}

/* Two oscillators: draws a line per contact with the impulse as its height. */
static void draw_stems(struct plot *plot, const struct contacts *c, struct panel *panel)
{
	char text[PLOT_TEXT];
	panel->height = 300;
	panel->y_label = "impulse [N s]";
	panel->bare = c->n == 0;
	panel->up = axis_linear((struct range){0, c->largest > 0 ? c->largest : 1});
	panel_draw(&plot->d, panel);
	for (int k = 0; k < c->n; k++) {
		const int row = c->rows[k];
		const double x = axis_at(&panel->across, c->time[row]), y = axis_at(&panel->up, c->impulse[row]);
		draw_line(&plot->d, &(struct pen){.ink = 0, .width = 1.2}, x, axis_at(&panel->up, 0), x, y);
		draw_mark(&plot->d, &(struct mark){.series = 0, .size = 3}, x, y, contact_text(c, row, text));
	}
}

/* The levels between a building and its right neighbor: draws a mark per contact whose area is the impulse. */
static void draw_levels(struct plot *plot, const struct contacts *c, int building, double highest,
                        struct panel *panel)
{
	char text[PLOT_TEXT], title[80];
	snprintf(title, sizeof title, "buildings %d and %d", building, building + 1);
	panel->title = title;
	panel->height = fmin(110 + 24 * highest, 300);
	panel->y_label = "level";
	panel->up = axis_between(0.5, highest + 0.5);
	panel->up.whole = true;
	panel_draw(&plot->d, panel);
	for (int k = 0; k < c->n; k++) {
		const int row = c->rows[k];
		if (c->building[row] == building)
			draw_mark(
			    &plot->d,
			    &(struct mark){.series = 0,
			                   .hollow = true,
			                   .size = fmax(RADIUS_MOST * sqrt(c->impulse[row] / c->largest), RADIUS_LEAST)},
			    axis_at(&panel->across, c->time[row]), axis_at(&panel->up, c->level[row]),
			    contact_text(c, row, text));
	}
}

void plot_timeline(struct plot *plot)
{
	struct plot_table table;
	struct contacts c;
	char more[PLOT_TEXT], number[3][32];
	double highest = 1;
	bool levels = false, there[PAIRS_MOST] = {false};
	int last = 0;
	if (!plot_table(plot, &table) || !chosen_there(plot, table.signal))
		return;
	contacts_read(plot, &table, &c);
	if (*plot->fault || !c.rows)
		return;
	for (int k = 0; k < c.n; k++) {
		const double building = c.building[c.rows[k]];
		if (!(building >= 0 && building < PAIRS_MOST))
			continue;
		levels = there[(int)building] = true;
		last = fmax(building, last);
		highest = fmax(highest, c.level[c.rows[k]]);
	}
	snprintf(more, sizeof more, "ground motion %d, %d contacts%s", table.signal, c.all,
	         levels ? "; the area of a mark is its impulse" : "");
	plot_head(plot, "Contacts in time", more);
	double top = plot->y + 4;
	for (int building = 0; building < (levels ? PAIRS_MOST : 1); building++) {
		struct panel panel = {.room = 58, .across = axis_between(0, c.latest > 0 ? c.latest : 1)};
		if (levels && !there[building])
			continue;
		panel.x_label = building == last ? "time [s]" : NULL;
		panel_place(&plot->d, 1, 0, top, &panel);
		if (levels)
			draw_levels(plot, &c, building, highest, &panel);
		else
			draw_stems(plot, &c, &panel);
		top = plot->d.height + 8;
	}
	if (c.n < c.all)
		plot_note(plot, "Shown: the %d contacts with the largest impulses, of %d.", c.n, c.all);
	if (c.n == 0)
		snprintf(plot->sentence, sizeof plot->sentence, "No contact.");
	else
		snprintf(plot->sentence, sizeof plot->sentence,
		         "%d contacts; the largest impulse, %s N s, begins at %s s%s%s.", c.all,
		         draw_number(c.largest, number[0]), draw_number(c.time[c.strongest], number[1]),
		         levels ? " at level " : "", levels ? draw_number(c.level[c.strongest], number[2]) : "");
}
