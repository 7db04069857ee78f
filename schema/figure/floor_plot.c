/* floor_plot.c - the floor spectra of a floor_spectrum study. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { SPECTRA_MOST = 8, HARMONICS_MOST = 12 };

/* ---- spectra ---- */

bool plot_has_spectra(const cJSON *result)
{
	return cJSON_GetArraySize(plot_member(result, "spectra")) > 0;
}

// name, legend text and line of each spectrum
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

/* The chosen spectra of the result; 0: invalid, see plot->fault. */
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

/* Draws thin lines at 2 n f_1, the peaks of a periodic pulse train. */
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
	snprintf(more, sizeof more, "damping ratio %s; bands from the 16th to the 84th percentile of the signals",
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
	axis_places(&panel.across, n, x);
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
