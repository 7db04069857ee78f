/* suite_plot.c - response spectra of ground motions, from the output of `pound motion --periods`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { LINES_MOST = 200, SIGNALS_MOST = 1000, POINTS_MOST = 20000 };

/* Drawn from the output of another command, so no result has this figure. */
bool plot_has_suite(const cJSON *result)
{
	(void)result;
	return false;
}

/* The spectra of a table, signal by signal, all with the same periods. */
struct spectra {
	int n, n_periods;
	const double *period, *psa; /* (n_periods), (n x n_periods) */
};

static bool spectra_read(struct plot *plot, struct spectra *spectra)
{
	struct plot_table table;
	*spectra = (struct spectra){0};
	if (!plot_table_whole(plot, &table))
		return false;
	const double *signal = plot_table_column(&table, "signal"),
	             *period = plot_table_column(&table, "period_s"),
	             *psa = plot_table_column(&table, "psa_m_s2");
	if (!period || !psa || table.n == 0) {
		snprintf(plot->fault, sizeof plot->fault,
		         "the samples are not spectra of ground motions: expected columns period_s and psa_m_s2, as "
		         "pound motion --periods prints them");
		return false;
	}
	int n = 1;
	while (n < table.n && signal[n] == signal[0])
		n++;
	spectra->n_periods = n;
	spectra->n = table.n / n < SIGNALS_MOST ? table.n / n : SIGNALS_MOST;
	spectra->period = period;
	spectra->psa = psa;
	return true;
}

static int ascending(const void *a, const void *b)
{
	const double one = *(const double *)a, other = *(const double *)b;
	return (one > other) - (one < other);
}

/* A quantile over the signals at each period, linear between order statistics. */
static double *quantile(struct plot *plot, const struct spectra *spectra, double q)
{
	double *at = plot_memory(plot, sizeof *at * (size_t)spectra->n_periods),
	       *sorted = plot_memory(plot, sizeof *sorted * (size_t)spectra->n);
	for (int k = 0; at && sorted && k < spectra->n_periods; k++) {
		int n = 0;
		for (int s = 0; s < spectra->n; s++)
			if (spectra->psa[s * spectra->n_periods + k] > 0)
				sorted[n++] = spectra->psa[s * spectra->n_periods + k];
		qsort(sorted, (size_t)n, sizeof *sorted, ascending);
		const double place = q * (n - 1);
		const int low = n ? (int)place : 0;
		at[k] = n == 0        ? NAN
		        : low + 1 < n ? sorted[low] + (place - low) * (sorted[low + 1] - sorted[low])
		                      : sorted[low];
	}
	return sorted ? at : NULL;
}

void plot_suite(struct plot *plot)
{
	static const struct key keys[] = {
	    {.name = "median, and 16 to 84 %", .pen = {.ink = 0, .width = 2.4}, .band = true},
	    {.name = "each ground motion", .pen = {.ink = INK_MUTED, .width = 0.9, .opacity = 0.6}}};
	struct spectra spectra;
	struct range across = RANGE_EMPTY, up = RANGE_EMPTY;
	char more[PLOT_TEXT], number[2][32];
	if (!spectra_read(plot, &spectra))
		return;
	const int n = spectra.n_periods;
	double highest = 0, at = NAN;
	for (int k = 0; k < n; k++)
		range_add(&across, spectra.period[k]);
	for (int k = 0; k < n * spectra.n; k++) {
		if (!(spectra.psa[k] > 0))
			continue;
		range_add(&up, spectra.psa[k]);
		if (spectra.psa[k] > highest) {
			highest = spectra.psa[k];
			at = spectra.period[k % n];
		}
	}
	snprintf(more, sizeof more, "%d ground motions at %d periods", spectra.n, n);
	plot_head(plot, "Response spectra of the ground motions", more);
	const double top = draw_legend(&plot->d, 2, keys, plot->y) + 8;
	struct panel panel = {.height = 400,
	                      .x_label = "period [s]",
	                      .y_label = "pseudo-acceleration [m/s²]",
	                      .bare = up.low > up.high,
	                      .across = axis_log(across),
	                      .up = axis_log(up)};
	panel_place(&plot->d, 1, 0, top, &panel);
	panel_draw(&plot->d, &panel);
	double *x = plot_memory(plot, 2 * sizeof *x * (size_t)n), *y = x ? x + n : NULL;
	double *low = quantile(plot, &spectra, 0.16), *middle = quantile(plot, &spectra, 0.5),
	       *high = quantile(plot, &spectra, 0.84);
	if (!x || !low || !middle || !high)
		return;
	memcpy(x, spectra.period, sizeof *x * (size_t)n);
	axis_places(&panel.across, n, x);
	const int points = POINTS_MOST / n > 1 ? POINTS_MOST / n : 1,
	          most = points < LINES_MOST ? points : LINES_MOST;
	const int shown = spectra.n < most ? spectra.n : most;
	for (int s = 0; s < shown; s++) {
		memcpy(y, spectra.psa + (size_t)s * (size_t)n, sizeof *y * (size_t)n);
		axis_places(&panel.up, n, y);
		draw_curve(&plot->d, &keys[1].pen, n, x, y);
	}
	axis_places(&panel.up, n, low);
	axis_places(&panel.up, n, middle);
	axis_places(&panel.up, n, high);
	draw_band(&plot->d, &(struct pen){.ink = 0, .opacity = 0.18}, n, x, low, high);
	draw_curve(&plot->d, &keys[0].pen, n, x, middle);
	if (n == 1)
		draw_mark(&plot->d, &(struct mark){.series = 0}, x[0], middle[0], NULL);
	if (shown < spectra.n)
		plot_note(plot, "Shown: the lines of %d ground motions of %d; median and band are of all.", shown,
		          spectra.n);
	snprintf(plot->sentence, sizeof plot->sentence,
	         "%d ground motions; the largest pseudo-acceleration, %s m/s², is at %s s.", spectra.n,
	         draw_number(highest, number[0]), draw_number(at, number[1]));
}
