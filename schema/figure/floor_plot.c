/* floor_plot.c - of a floor_spectrum: `spectra` of the left floor, `history` of both oscillators. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { SPECTRA_MOST = 8, HARMONICS_MOST = 12 };

/* ---- spectra ---- */

bool plot_has_spectra(const cJSON *result)
{
	return cJSON_GetArraySize(plot_member(result, "spectra")) > 0;
}

// how a spectrum is drawn, and what it is called
static const struct {
	const char *name, *text, *dash;
	enum ink ink;
} SPECTRA[] = {
    {"pounding", "with pounding", NULL, 0},
    {"free", "without pounding", "7 3", 1},
    {"dirac_peaks", "peaks of ideal pulses (dirac_peaks)", "2 3", 2},
    {"impact_only", "impacts only", "9 3 2 3", 3},
    {"dirac_line", "one ideal pulse (dirac_line)", "4 2", 4},
    {"dirac_train", "train of ideal pulses (dirac_train)", "1 2", 5},
};

enum { N_SPECTRA = sizeof SPECTRA / sizeof SPECTRA[0] };

static int style_of(const char *name)
{
	for (int k = 0; k < N_SPECTRA; k++)
		if (strcmp(SPECTRA[k].name, name) == 0)
			return k;
	return -1;
}

/* The chosen spectra that the result has; 0: a fault. */
static int spectra_of(struct plot *plot, const cJSON **spectra)
{
	const char *names = plot->choice->spectra ? plot->choice->spectra : "pounding,free,dirac_peaks";
	const cJSON *spectrum;
	int n = 0;
	for (const char *at = names; *at && n < SPECTRA_MOST;) {
		size_t length = strcspn(at, ",");
		bool found = false;
		cJSON_ArrayForEach(spectrum, plot_member(plot->result, "spectra"))
		{
			const char *name = plot_text(spectrum, "name");
			if (strlen(name) == length && strncmp(at, name, length) == 0 && style_of(name) >= 0) {
				spectra[n++] = spectrum;
				found = true;
				break;
			}
		}
		if (!found && plot->choice->spectra) {
			snprintf(plot->fault, sizeof plot->fault, "this result has no spectrum \"%.*s\"",
			         (int)(length < 60 ? length : 60), at);
			return 0;
		}
		at += length + (at[length] == ',');
	}
	if (n == 0)
		snprintf(plot->fault, sizeof plot->fault, "spectra must name a spectrum of this result");
	return n;
}

static const cJSON *spectrum_list(const cJSON *spectrum, const char *name)
{
	return plot_member(spectrum, name);
}

/* Thin lines at 2 n f_1, where a periodic train of pulses has its peaks. */
static void draw_harmonics(struct plot *plot, const struct panel *panel, bool periods)
{
	const cJSON *peaks = plot_member(plot->result, "peaks"), *peak = plot_first(peaks);
	double frequency = plot_number(peak, "frequency_hz") / plot_number(peak, "frequency_ratio");
	double last = -INFINITY;
	char text[32];
	for (int n = 1; n <= HARMONICS_MOST && isfinite(frequency); n++) {
		double x = axis_at(&panel->across, periods ? 1 / (2 * n * frequency) : 2 * n * frequency);
		if (!(x >= panel->left && x <= panel->right))
			continue;
		draw_line(&plot->d, &(struct pen){.ink = INK_MUTED, .width = 0.7, .opacity = 0.6}, x, panel->top, x,
		          panel->bottom);
		snprintf(text, sizeof text, n == 1 ? "2 f₁" : "%d", 2 * n);
		if (fabs(x - last) < (n == 2 ? 34 : 20))
			continue;
		draw_text(&plot->d,
		          &(struct label){.x = x, .y = panel->top - 4, .anchor = 'm', .size = 11, .ink = INK_MUTED},
		          text);
		last = x;
	}
}

void plot_spectra(struct plot *plot)
{
	const bool periods = plot->choice->axis && strcmp(plot->choice->axis, "s") == 0;
	const cJSON *spectra[SPECTRA_MOST], *frequencies = plot_member(plot->result, "frequencies_hz"), *value;
	struct key keys[SPECTRA_MOST];
	struct range across = RANGE_EMPTY, up = RANGE_EMPTY;
	char more[PLOT_TEXT], number[3][32];
	static const char *const members[] = {"mean_m_s2", "p16_m_s2", "p84_m_s2"};
	int n, n_spectra = spectra_of(plot, spectra);
	double *x = plot_numbers(plot, frequencies, &n), highest = 0, at = NAN;
	if (n_spectra == 0 || !x)
		return;
	for (int k = 0; k < n; k++) {
		x[k] = periods ? 1 / x[k] : x[k];
		range_add(&across, x[k]);
	}
	for (int s = 0; s < n_spectra; s++)
		for (int m = 0; m < 3; m++)
			cJSON_ArrayForEach(value, spectrum_list(spectra[s], members[m])) if (cJSON_IsNumber(value) &&
			                                                                     value->valuedouble > 0)
			    range_add(&up, value->valuedouble);
	snprintf(more, sizeof more,
	         "left floor, damping ratio %s; bands from the 16th to the 84th percentile of the signals",
	         draw_number(plot_number(plot->result, "damping_ratio"), number[0]));
	plot_head(plot, "Floor response spectra", more);
	for (int s = 0; s < n_spectra; s++) {
		int style = style_of(plot_text(spectra[s], "name"));
		keys[s] = (struct key){.name = SPECTRA[style].text,
		                       .pen = {.ink = SPECTRA[style].ink, .width = 2, .dash = SPECTRA[style].dash},
		                       .band = style < 2};
	}
	double top = draw_legend(&plot->d, n_spectra, keys, plot->y) + 18;
	struct panel panel = {.height = 460,
	                      .x_label = periods ? "period [s]" : "frequency [Hz]",
	                      .y_label = "pseudo-acceleration [m/s²]",
	                      .bare = up.low > up.high,
	                      .across = axis_log(across),
	                      .up = axis_log(up)};
	panel_place(&plot->d, 1, 0, top, &panel);
	panel_draw(&plot->d, &panel);
	draw_harmonics(plot, &panel, periods);
	for (int k = 0; k < n; k++)
		x[k] = axis_at(&panel.across, x[k]);
	for (int s = 0; s < n_spectra; s++) {
		double *y[3];
		int sizes[3], k = 0;
		bool whole = true;
		for (int m = 0; m < 3; m++) {
			y[m] = plot_numbers(plot, spectrum_list(spectra[s], members[m]), &sizes[m]);
			whole = whole && y[m] && sizes[m] == n;
			for (k = 0; whole && k < n; k++) {
				if (m == 0 && s == 0 && y[m][k] > highest) {
					highest = y[m][k];
					value = cJSON_GetArrayItem(frequencies, k);
					at = value ? value->valuedouble : NAN;
				}
				y[m][k] = axis_at(&panel.up, y[m][k]);
			}
		}
		if (!y[0] || sizes[0] != n)
			continue;
		if (whole && keys[s].band)
			draw_band(&plot->d, &(struct pen){.ink = keys[s].pen.ink, .opacity = 0.18}, n, x, y[1], y[2]);
		draw_curve(&plot->d, &keys[s].pen, n, x, y[0]);
		if (n == 1)
			draw_mark(&plot->d, &(struct mark){.series = (int)keys[s].pen.ink}, x[0], y[0][0], NULL);
	}
	snprintf(plot->sentence, sizeof plot->sentence, "The spectrum %s is largest, %s m/s², at %s Hz.",
	         keys[0].name, draw_number(highest, number[0]), draw_number(at, number[1]));
}

/* ---- history ---- */

bool plot_has_history(const cJSON *result)
{
	return plot_has_spectra(result);
}

// what is drawn of a history, each in a panel: columns of the samples, those there are
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

enum { N_SERIES = sizeof SERIES / sizeof SERIES[0], COLUMNS_MOST = 24 };

struct table {
	int n_columns, n;
	const char *names[COLUMNS_MOST];
	size_t lengths[COLUMNS_MOST];
	double *values[COLUMNS_MOST]; /* (n) of one signal */
};

/* The rows of a signal in [from, to] s.  A sample is a number or empty; the first columns are signal and time_s. */
static bool table_read(struct plot *plot, int signal, double from, double to, struct table *table)
{
	const char *at = plot->source->samples, *end = at + plot->source->n_samples;
	size_t lines = 0;
	*table = (struct table){0};
	for (const char *c = at; c < end; c++)
		lines += *c == '\n' || *c == '\r';
	while (at < end && *at != '\r' && *at != '\n' && table->n_columns < COLUMNS_MOST) {
		size_t n = 0;
		while (at + n < end && !strchr(",\r\n", at[n]))
			n++;
		table->names[table->n_columns] = at;
		table->lengths[table->n_columns] = n;
		table->values[table->n_columns] = plot_memory(plot, sizeof(double) * (lines + 1));
		if (!table->values[table->n_columns++])
			return false;
		at += n + (at + n < end && at[n] == ',');
	}
	if (table->n_columns < 3 || strncmp(table->names[0], "signal,time_s,", 14) != 0)
		return false;
	while (at < end) {
		double row[COLUMNS_MOST];
		at += strspn(at, "\r\n");
		if (at >= end || !*at)
			break;
		for (int c = 0; c < table->n_columns; c++) {
			// a number does not begin on the next line
			char *after = (char *)at;
			row[c] = isspace((unsigned char)*at) ? NAN : strtod(at, &after);
			row[c] = after == at ? NAN : row[c];
			at = after + strcspn(after, ",\r\n");
			at += *at == ',';
		}
		at += strcspn(at, "\r\n");
		if (row[0] == signal && isfinite(row[1]) && row[1] >= from && row[1] <= to) {
			for (int c = 0; c < table->n_columns; c++)
				table->values[c][table->n] = row[c];
			table->n++;
		}
	}
	return true;
}

static const double *table_column(const struct table *table, const char *name)
{
	for (int c = 0; c < table->n_columns; c++)
		if (table->lengths[c] == strlen(name) && strncmp(table->names[c], name, table->lengths[c]) == 0)
			return table->values[c];
	return NULL;
}

/* A line through all points of a history: of each pixel across the first, lowest, highest and last. */
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
		if (last == k) { // it has no place
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

static double second_of(struct plot *plot, const char *name, const char *text, double absent)
{
	char *end;
	double value = text ? strtod(text, &end) : absent;
	if (text && (!*text || *end || !isfinite(value) || isspace((unsigned char)*text)))
		snprintf(plot->fault, sizeof plot->fault, "%s must be a time in s", name);
	return value;
}

void plot_history(struct plot *plot)
{
	struct table table;
	char more[PLOT_TEXT], number[2][32];
	int signal = plot->choice->signal ? atoi(plot->choice->signal) : 0, impacts = 0;
	double from = second_of(plot, "from", plot->choice->from, 0);
	double to = second_of(plot, "to", plot->choice->to, INFINITY);
	struct range times = RANGE_EMPTY, ups = RANGE_EMPTY;
	if (*plot->fault)
		return;
	if (!table_read(plot, signal, from, to, &table)) {
		snprintf(plot->fault, sizeof plot->fault,
		         "the samples are no histories: they begin with signal,time_s");
		return;
	}
	const double *time = table_column(&table, "time_s"), *force = table_column(&table, "contact_force_n");
	if (table.n == 0) {
		snprintf(plot->fault, sizeof plot->fault, "no sample of signal %d lies between from and to", signal);
		return;
	}
	for (int k = 0; k < table.n; k++)
		range_add(&times, time[k]);
	snprintf(more, sizeof more, "ground motion %d; ticks above the displacement: a contact begins", signal);
	plot_head(plot, "Motion of both oscillators, and their impacts", more);
	const bool both = table_column(&table, "u_right_m");
	const struct key keys[2] = {{.name = "left", .pen = {.width = 1.5}},
	                            {.name = "right", .pen = {.ink = 1, .width = 1.5, .dash = RIGHT_DASH}}};
	double top = both ? draw_legend(&plot->d, 2, keys, plot->y) + 8 : plot->y + 4;
	for (int s = 0; s < N_SERIES; s++) {
		struct range range = {0, 0};
		const double *columns[2] = {NULL, NULL};
		int known = 0;
		for (int l = 0; l < 2 && SERIES[s].lines[l].column; l++) {
			columns[l] = table_column(&table, SERIES[s].lines[l].column);
			for (int k = 0; columns[l] && k < table.n; k++)
				range_add(&range, columns[l][k]), known += isfinite(columns[l][k]);
		}
		if (known == 0) // a scene without contact has no clear distance
			continue;
		if (s == 0)
			ups = range;
		struct panel panel = {.height = SERIES[s].height,
		                      .room = 48,
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
		for (int k = 1; s == 0 && force && k < table.n; k++)
			if (force[k] != 0 && force[k - 1] == 0) {
				double x = axis_at(&panel.across, time[k]);
				draw_line(&plot->d, &(struct pen){.ink = INK_TEXT, .width = 1}, x, panel.top - 5, x,
				          panel.top + 2);
				impacts++;
			}
		top = plot->d.height + 8;
	}
	snprintf(plot->sentence, sizeof plot->sentence, "%d impacts; displacements lie in [%s, %s] m.", impacts,
	         draw_number(ups.low, number[0]), draw_number(ups.high, number[1]));
}
