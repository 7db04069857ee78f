/* history_plot.c - figures of the samples of a floor_spectrum study: `history` of both oscillators, `force` of their contacts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "schema/figure/plot.h"

// panels of a history, each with up to two columns of the samples
static const struct series {
	const char *title, *unit;
	double height;
	struct {
		const char *column, *text;
	} lines[2];
} SERIES[] = {
    {"displacement", "[m]", 200, {{"u_m", "left"}, {"u_right_m", "right"}}},
    {"clear distance", "[m]", 150, {{"gap_m", "clear distance"}}},
    {"contact force", "[N]", 150, {{"contact_force_n", "contact force"}}},
    {"absolute acceleration",
     "[m/s²]",
     200,
     {{"acceleration_m_s2", "left"}, {"acceleration_right_m_s2", "right"}}},
};

static const char *const RIGHT_DASH = "5 2";

enum { N_SERIES = sizeof SERIES / sizeof SERIES[0] };

/* Draws a line through a history with many points: per pixel column only the first, lowest, highest and last point. */
static void draw_dense(struct plot *plot, const struct pen *pen, const struct panel *panel,
                       const double *time, const double *value, int n)
{
	double *x = plot_memory(plot, 2 * sizeof *x * (size_t)(n + 1)), *y = x ? x + n + 1 : NULL;
	int at = 0;
	for (int k = 0; x && k < n;) {
		double pixel = floor(axis_at(&panel->across, time[k]));
		int low = k, high = k, last = k;
		for (; last < n && floor(axis_at(&panel->across, time[last])) == pixel; last++) {
			low = value[last] < value[low] ? last : low;
			high = value[last] > value[high] ? last : high;
		}
		if (last == k) { // not finite
			k++;
			continue;
		}
		int kept[] = {k, low < high ? low : high, low < high ? high : low, last - 1};
		for (int i = 0; i < 4; i++)
			if (i == 0 || kept[i] != kept[i - 1]) {
				x[at] = axis_at(&panel->across, time[kept[i]]);
				y[at++] = axis_at(&panel->up, value[kept[i]]);
			}
		k = last;
	}
	if (x)
		draw_curve(&plot->d, pen, at, x, y);
}

/* Reads the chosen rows of the samples, at least one; false: invalid, see plot->fault. */
static bool table_chosen(struct plot *plot, struct plot_table *table)
{
	if (plot_table(plot, table) && table->n == 0)
		snprintf(plot->fault, sizeof plot->fault, "no sample of signal %d lies between from and to",
		         table->signal);
	return !*plot->fault;
}

static bool any_known(const struct plot_table *table, const char *name)
{
	const double *values = plot_table_column(table, name);
	bool any = false;
	for (int k = 0; values && k < table->n; k++)
		any = any || isfinite(values[k]);
	return any;
}

/* ---- history ---- */

bool plot_has_history(const cJSON *result)
{
	return plot_has_spectra(result);
}

/* Draws a tick at the start of each contact, at most one per pixel; returns the number of contacts. */
static int draw_begins(struct plot *plot, const struct panel *panel, const struct plot_table *table)
{
	const double *time = plot_table_column(table, "time_s"),
	             *force = plot_table_column(table, "contact_force_n");
	double last = -INFINITY;
	int n = 0;
	for (int k = 1; force && k < table->n; k++) {
		const double x = axis_at(&panel->across, time[k]);
		if (!(force[k] != 0 && force[k - 1] == 0))
			continue;
		n++;
		if (x - last < 2)
			continue;
		draw_line(&plot->d, &(struct pen){.ink = INK_TEXT, .width = 1}, x, panel->top - 5, x, panel->top + 2);
		last = x;
	}
	return n;
}

void plot_history(struct plot *plot)
{
	struct plot_table table;
	char more[PLOT_TEXT], number[2][32];
	int impacts = 0;
	struct range times = RANGE_EMPTY, ups = RANGE_EMPTY;
	if (!table_chosen(plot, &table))
		return;
	const double *time = plot_table_column(&table, "time_s");
	if (!plot_table_column(&table, "u_m")) {
		snprintf(plot->fault, sizeof plot->fault,
		         "the samples are not time histories: they have no column u_m");
		return;
	}
	for (int k = 0; k < table.n; k++)
		range_add(&times, time[k]);
	snprintf(more, sizeof more, "ground motion %d; ticks above the displacement: a contact begins",
	         table.signal);
	plot_head(plot, "Motion and impacts", more);
	// a row of buildings has the history of one floor only
	const bool both = any_known(&table, "u_right_m");
	const struct key keys[2] = {{.name = "left", .pen = {.width = 1.5}},
	                            {.name = "right", .pen = {.ink = 1, .width = 1.5, .dash = RIGHT_DASH}}};
	double top = both ? draw_legend(&plot->d, 2, keys, plot->y) + 8 : plot->y + 4;
	for (int s = 0; s < N_SERIES; s++) {
		struct range range = {0, 0};
		const double *columns[2] = {NULL, NULL};
		int known = 0;
		for (int l = 0; l < 2 && SERIES[s].lines[l].column; l++) {
			columns[l] = plot_table_column(&table, SERIES[s].lines[l].column);
			for (int k = 0; columns[l] && k < table.n; k++)
				range_add(&range, columns[l][k]), known += isfinite(columns[l][k]);
		}
		if (known == 0) // a scene without contact has no clear distance
			continue;
		if (s == 0)
			ups = range;
		struct panel panel = {.height = SERIES[s].height,
		                      .room = 58,
		                      .title = SERIES[s].title,
		                      .y_label = SERIES[s].unit,
		                      .x_label = s == N_SERIES - 1 ? "time [s]" : NULL};
		panel.across = times.low < times.high ? axis_between(times.low, times.high) : axis_linear(times);
		panel.up = axis_linear(range);
		panel_place(&plot->d, 1, 0, top, &panel);
		panel_draw(&plot->d, &panel);
		for (int l = 0; l < 2 && columns[l]; l++)
			draw_dense(plot, &(struct pen){.ink = (enum ink)l, .width = 1.1, .dash = l ? RIGHT_DASH : NULL},
			           &panel, time, columns[l], table.n);
		for (int l = 0; table.n == 1 && l < 2 && columns[l]; l++)
			draw_mark(&plot->d, &(struct mark){.series = l}, axis_at(&panel.across, time[0]),
			          axis_at(&panel.up, columns[l][0]), NULL);
		if (s == 0)
			impacts = draw_begins(plot, &panel, &table);
		top = plot->d.height + 8;
	}
	snprintf(plot->sentence, sizeof plot->sentence, "%d impacts; displacements lie in [%s, %s] m.", impacts,
	         draw_number(ups.low, number[0]), draw_number(ups.high, number[1]));
}

/* ---- force ---- */

bool plot_has_force(const cJSON *result)
{
	return plot_has_spectra(result);
}

enum { LOOPS_MOST = 200, POINTS_MOST = 16000, SIDE_MOST = 640 };

/* The rows [first, last] of the samples during one contact. */
struct loop {
	int first, last;
	double peak; /* largest force [N] */
};

static int by_peak(const void *one, const void *other)
{
	const struct loop *a = one, *b = other;
	return a->peak != b->peak ? (a->peak < b->peak) - (a->peak > b->peak) : a->first - b->first;
}

/* Finds the contacts, in descending order of their largest force.  Each includes the rows with zero force before and after it, where
 * the overlap is zero or the force has jumped. */
static int loops_of(const struct plot_table *table, const double *gap, const double *force,
                    struct loop *loops)
{
	int n = 0;
	for (int k = 0; k < table->n; k++) {
		if (!isfinite(force[k]) || !isfinite(gap[k]) || force[k] == 0)
			continue;
		struct loop *loop = &loops[n++];
		*loop = (struct loop){k > 0 ? k - 1 : k, k, -INFINITY};
		for (; k < table->n && isfinite(force[k]) && force[k] != 0; k++)
			loop->peak = fmax(loop->peak, force[k]);
		loop->last = k < table->n ? k : k - 1;
	}
	qsort(loops, (size_t)n, sizeof *loops, by_peak);
	return n;
}

/* Draws one contact without points that coincide with the previous one; returns the number of points drawn. */
static int draw_loop(struct plot *plot, const struct panel *panel, const struct pen *pen,
                     const struct loop *loop, const double *gap, const double *force)
{
	const int rows = loop->last - loop->first + 1;
	double *x = plot_memory(plot, 2 * sizeof *x * (size_t)rows), *y = x ? x + rows : NULL;
	int n = 0;
	for (int k = loop->first; x && k <= loop->last; k++) {
		// in the row before or after the contact the bodies may be separated
		const double overlap = force[k] == 0 ? fmax(-gap[k], 0) : -gap[k];
		const double at_x = axis_at(&panel->across, overlap), at_y = axis_at(&panel->up, force[k]);
		if (n > 0 && k < loop->last && hypot(at_x - x[n - 1], at_y - y[n - 1]) < 0.8)
			continue;
		x[n] = at_x;
		y[n++] = at_y;
	}
	if (x)
		draw_curve(&plot->d, pen, n, x, y);
	return n;
}

void plot_force(struct plot *plot)
{
	struct plot_table table;
	struct range across = {0, 0}, up = {0, 0};
	char more[PLOT_TEXT], number[2][32];
	int points = 0, drawn = 0;
	if (!table_chosen(plot, &table))
		return;
	const double *gap = plot_table_column(&table, "gap_m"),
	             *force = plot_table_column(&table, "contact_force_n");
	struct loop *loops = plot_memory(plot, sizeof *loops * (size_t)(table.n + 1));
	if (!gap || !force) {
		snprintf(plot->fault, sizeof plot->fault, "the samples have no columns gap_m and contact_force_n");
		return;
	}
	const int n = loops ? loops_of(&table, gap, force, loops) : 0;
	for (int i = 0; i < n; i++)
		for (int k = loops[i].first; k <= loops[i].last; k++) {
			range_add(&across, force[k] == 0 ? 0 : -gap[k]);
			range_add(&up, force[k]);
		}
	// force and overlap at the ends of a contact are zero up to rounding
	across.low = across.low > -1e-6 * across.high ? 0 : across.low;
	up.low = up.low > -1e-6 * up.high ? 0 : up.low;
	if (n)
		snprintf(more, sizeof more,
		         "ground motion %d, %d contacts; the contact with the largest force is thick", table.signal,
		         n);
	else
		snprintf(more, sizeof more, "ground motion %d: no contact, or no contact with a known overlap",
		         table.signal);
	plot_head(plot, "Contact force against overlap", more);
	struct panel panel = {.height = fmin(fmax(0.7 * plot->d.width, 300), 460),
	                      .x_label = "overlap [m]",
	                      .y_label = "contact force [N]",
	                      .bare = n == 0,
	                      .across = axis_linear(n ? across : (struct range){0, 1}),
	                      .up = axis_linear(n ? up : (struct range){0, 1})};
	panel_place(&plot->d, 1, 0, plot->y + 4, &panel);
	panel.width = fmin(panel.width, SIDE_MOST);
	panel_draw(&plot->d, &panel);
	for (; drawn < n && drawn < LOOPS_MOST && points < POINTS_MOST; drawn++)
		points += draw_loop(plot, &panel,
		                    &(struct pen){.ink = drawn ? INK_MUTED : INK_SERIES,
		                                  .width = drawn ? 0.9 : 2.2,
		                                  .opacity = drawn ? 0.7 : 0},
		                    &loops[drawn], gap, force);
	if (drawn < n)
		plot_note(plot, "Shown: the %d contacts with the largest forces, of %d.", drawn, n);
	if (n)
		snprintf(plot->sentence, sizeof plot->sentence,
		         "%d contacts; the largest force is %s N, the largest overlap %s m.", n,
		         draw_number(loops[0].peak, number[0]), draw_number(across.high, number[1]));
	else
		snprintf(plot->sentence, sizeof plot->sentence, "No contact.");
}
