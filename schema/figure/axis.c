/* axis.c - ranges, ticks and panels.
 *
 * A tick is k m 10^e with integer k and m = 1, 2 or 5; its text is made from these integers, so that it has only the
 * necessary digits and no rounding errors. */
#include "schema/figure/draw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GAP = 20, TICK = 5, PANEL_HEIGHT = 240, LOG_LEAST = -307, LOG_MOST = 307 };

const struct range RANGE_EMPTY = {INFINITY, -INFINITY};

void range_add(struct range *range, double value)
{
	if (!isfinite(value))
		return;
	range->low = fmin(range->low, value);
	range->high = fmax(range->high, value);
}

/* value 10^exponent, in two factors so that neither is 0 or infinite. */
static double scaled(double value, int exponent)
{
	int half = exponent / 2;
	return value * pow(10, half) * pow(10, exponent - half);
}

/* The power of ten of a number's first digit. */
static int decade(double value)
{
	int e = (int)floor(log10(value));
	// correct rounding errors of log10
	return scaled(value, -e) >= 10 ? e + 1 : scaled(value, -e) < 1 ? e - 1 : e;
}

/* ---- axes ---- */

/* The distance *m 10^*e of at most `most` ticks; false: below the resolution of doubles. */
static bool step_of(const struct axis *axis, int most, int *m, int *e)
{
	double raw = axis->half_span / most * 2, largest = fmax(fabs(axis->low), fabs(axis->high));
	if (!(raw > 0) || raw < 1e-14 * largest || raw < 1e-306)
		return false;
	*e = decade(raw);
	double first = scaled(raw, -*e);
	*m = first <= 1 ? 1 : first <= 2 ? 2 : first <= 5 ? 5 : 10;
	if (*m == 10) {
		*m = 1;
		++*e;
	}
	if (axis->whole && *e < 0) {
		*m = 1;
		*e = 0;
	}
	return true;
}

static void axis_halve(struct axis *axis)
{
	axis->half_low = axis->low / 2;
	axis->half_span = axis->high / 2 - axis->low / 2;
}

struct axis axis_between(double low, double high)
{
	struct axis axis = {.low = low, .high = high};
	axis_halve(&axis);
	return axis;
}

/* An axis that ends at ticks.
 *
 * Test     unit_figure: ticks_of_any_range_are_few_and_inside
 */
struct axis axis_linear(struct range range)
{
	int m, e;
	bool empty = range.low > range.high;
	struct axis axis = {.low = empty ? 0 : range.low, .high = empty ? 1 : range.high};
	if (axis.high / 2 - axis.low / 2 < 1e-306) {
		// all equal: the value in the middle, with a tenth of it to each side
		double around = axis.low != 0 ? fmax(0.1 * fabs(axis.low), 1e-305) : 1;
		axis.low = fmax(axis.low - around, -1.7e308);
		axis.high = fmin(axis.high + around, 1.7e308);
	}
	axis_halve(&axis);
	if (step_of(&axis, 10, &m, &e)) {
		double step = scaled(m, e), low = floor(axis.low / step) * step, high = ceil(axis.high / step) * step;
		axis.low = isfinite(low) ? low : axis.low;
		axis.high = isfinite(high) ? high : axis.high;
		axis_halve(&axis);
	}
	return axis;
}

static const double mantissas[] = {1, 2, 5};

/* The largest number of the form 1, 2 or 5 times a power of ten up to a value; up: the smallest from the value on. */
static double nice(double value, bool up)
{
	int e = decade(value);
	double first = scaled(value, -e), best = up ? 10 : 1;
	for (int k = 0; k < 3; k++)
		if (up ? mantissas[2 - k] >= first * (1 - 1e-12) : mantissas[k] <= first * (1 + 1e-12))
			best = mantissas[up ? 2 - k : k];
	return scaled(best, e);
}

struct axis axis_log(struct range range)
{
	bool empty = range.low > range.high;
	double low = empty ? 1 : fmin(fmax(range.low, scaled(1, LOG_LEAST)), scaled(1, LOG_MOST));
	double high = empty ? 10 : fmin(fmax(range.high, low), scaled(1, LOG_MOST));
	struct axis axis = {.low = nice(low, false), .high = nice(high, true), .log = true};
	if (axis.high <= axis.low * 1.0001) {
		axis.low = fmax(axis.low / 10, scaled(1, LOG_LEAST));
		axis.high *= 10;
	}
	return axis;
}

double axis_at(const struct axis *axis, double value)
{
	if (!isfinite(value) || (axis->log && !(value > 0)))
		return NAN;
	double within = fmin(fmax(value, scaled(1, LOG_LEAST)), scaled(1, LOG_MOST));
	double part = axis->log ? (log10(within) - log10(axis->low)) / (log10(axis->high) - log10(axis->low))
	                        : (value / 2 - axis->half_low) / axis->half_span;
	return axis->start + part * (axis->end - axis->start);
}

void axis_places(const struct axis *axis, int n, double *values)
{
	for (int k = 0; k < n; k++)
		values[k] = axis_at(axis, values[k]);
}

/* ---- ticks ---- */

static int superscript(char *text, size_t size, int exponent)
{
	static const char *const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
	char plain[12];
	int n = 0;
	snprintf(plain, sizeof plain, "%d", exponent);
	*text = '\0';
	for (const char *c = plain; *c; c++)
		n += snprintf(text + n, size - (size_t)n, "%s", *c == '-' ? "⁻" : digits[*c - '0']);
	return n;
}

const char *draw_number(double value, char text[32])
{
	char raised[20], digits[16];
	if (!isfinite(value))
		return strcpy(text, "no value");
	if (value == 0 || (fabs(value) >= 1e-3 && fabs(value) < 1e5)) {
		snprintf(text, 32, "%.3g", value);
		if (fabs(value) >= 1000)
			snprintf(text, 32, "%.0f", value);
		return text;
	}
	int e = decade(fabs(value));
	superscript(raised, sizeof raised, e);
	snprintf(digits, sizeof digits, "%.3g", scaled(value, -e));
	if (strcmp(digits, "1") == 0)
		snprintf(text, 32, "10%.15s", raised);
	else
		snprintf(text, 32, "%.10s·10%.15s", digits, raised);
	return text;
}

static void ticks_add(struct ticks *ticks, double value, const char *text)
{
	if (ticks->n == TICKS_MAX)
		return;
	struct tick *tick = &ticks->tick[ticks->n++];
	tick->value = value;
	snprintf(tick->text, sizeof tick->text, "%s", text);
	ticks->widest = fmax(ticks->widest, draw_width(tick->text, DRAW_TEXT_SIZE));
}

static void ticks_linear(const struct axis *axis, int most, struct ticks *ticks)
{
	int m, e;
	char text[32];
	double largest = fmax(fabs(axis->low), fabs(axis->high));
	if (!step_of(axis, most, &m, &e)) {
		ticks_add(ticks, axis->low, draw_number(axis->low, text));
		ticks_add(ticks, axis->high, draw_number(axis->high, text));
		return;
	}
	double step = scaled(m, e);
	int first = decade(largest);
	ticks->exponent = first >= 5 || first <= -4 ? first : 0;
	int decimals = ticks->exponent - e > 0 ? ticks->exponent - e : 0;
	// the ends of the axis are ticks, up to rounding
	for (double k = ceil(axis->low / step - 1e-6); k <= axis->high / step + 1e-6; k++) {
		double digits = scaled(k * m, e - ticks->exponent);
		snprintf(text, sizeof text, "%.*f", decimals < 16 ? decimals : 16, digits == 0 ? 0.0 : digits);
		if (*text == '-') {
			char plain[32];
			snprintf(plain, sizeof plain, "%s", text + 1);
			snprintf(text, sizeof text, "−%.28s", plain);
		}
		ticks_add(ticks, k * step, text);
	}
}

/* Decades between two ticks: the first of 1, 2, 5, 10, ... that is at least `least`. */
static int stride_of(int least)
{
	static const int strides[] = {1, 2, 5, 10, 20, 50, 100, 200, 500};
	size_t k = 0;
	while (strides[k] < least && k + 1 < sizeof strides / sizeof strides[0])
		k++;
	return strides[k];
}

static void ticks_log(const struct axis *axis, int most, struct ticks *ticks)
{
	int from = decade(axis->low), to = decade(axis->high * 1.0001);
	bool plain = axis->low > 0.9e-3 && axis->high < 1.1e5;
	int decades = to - from + 1, stride = stride_of((decades + most - 1) / most);
	bool between = 3 * decades <= (most < TICKS_MAX - 3 ? most : TICKS_MAX - 3);
	for (int e = from; e <= to; e++)
		for (int k = 0; k < (between ? 3 : 1); k++) {
			char text[32], raised[20];
			double value = scaled(mantissas[k], e);
			if (value < axis->low * 0.999 || value > axis->high * 1.001 || e % stride)
				continue;
			superscript(raised, sizeof raised, e);
			if (plain)
				snprintf(text, sizeof text, "%.10g", value);
			else if (k == 0)
				snprintf(text, sizeof text, "10%.20s", raised);
			else
				snprintf(text, sizeof text, "%.0f·10%.20s", mantissas[k], raised);
			ticks_add(ticks, value, text);
		}
	if (ticks->n >= 2)
		return;
	// fewer than two ticks: show both ends and a tick between them
	const struct ticks inner = *ticks;
	char text[32];
	*ticks = (struct ticks){0};
	ticks_add(ticks, axis->low, draw_number(axis->low, text));
	if (inner.n && inner.tick[0].value > 1.001 * axis->low && inner.tick[0].value < 0.999 * axis->high)
		ticks_add(ticks, inner.tick[0].value, inner.tick[0].text);
	ticks_add(ticks, axis->high, draw_number(axis->high, text));
}

void axis_ticks(const struct axis *axis, int most, struct ticks *ticks)
{
	*ticks = (struct ticks){0};
	most = most < 2 ? 2 : most > TICKS_MAX - 2 ? TICKS_MAX - 2 : most;
	(axis->log ? ticks_log : ticks_linear)(axis, most, ticks);
}

void axis_label(const struct ticks *ticks, const char *label, char *text, size_t size)
{
	char raised[20];
	superscript(raised, sizeof raised, ticks->exponent);
	snprintf(text, size, ticks->exponent ? "%.170s (10%s)" : "%s", label, raised);
}

enum { ACROSS_MOST = 14 };

void axis_ticks_across(const struct axis *axis, struct ticks *ticks)
{
	double last;
	int most = (int)fmin((axis->end - axis->start) / 30, ACROSS_MOST);
	for (;;) {
		bool collide = false;
		axis_ticks(axis, most, ticks);
		last = -INFINITY;
		for (int k = 0; k < ticks->n; k++) {
			double half = draw_width(ticks->tick[k].text, DRAW_TEXT_SIZE) / 2;
			double at = axis_at(axis, ticks->tick[k].value);
			collide = collide || at - half < last;
			last = at + half + 8;
		}
		if (!collide || most <= 2)
			return;
		most--;
	}
}

/* ---- panels ---- */

/* The ticks of the vertical axis, and the left end of the plot area beside their texts. */
static void panel_ticks_up(struct panel *panel, struct ticks *up)
{
	axis_ticks(&panel->up, (int)((panel->bottom - panel->top) / (panel->up.whole ? 22 : 30)), up);
	panel->left = panel->x + fmax(up->widest, panel->room) + 10 + (panel->y_label ? 18 : 0);
}

void panel_draw(struct drawing *drawing, struct panel *panel)
{
	const struct pen grid = {.ink = INK_GRID}, axis = {.ink = INK_TEXT};
	struct ticks across, up;
	char label[200];
	panel->bottom = panel->y + panel->height - (panel->x_label ? 40 : 24);
	panel->right = panel->x + panel->width - 12;
	panel->top = panel->y + (panel->title ? 21 : 8);
	panel_ticks_up(panel, &up);
	// the title is aligned with the frame and may take several lines of its height
	if (panel->title)
		panel->top = 8 +
		             draw_prose(drawing,
		                        &(struct label){.x = panel->left,
		                                        .y = panel->y + 13,
		                                        .size = DRAW_TITLE_SIZE,
		                                        .bold = true,
		                                        .fit = panel->right - panel->left},
		                        panel->title, 3) -
		             DRAW_TITLE_SIZE;
	panel_ticks_up(panel, &up);
	panel->up.start = panel->bottom, panel->up.end = panel->top;
	panel->across.start = panel->left, panel->across.end = panel->right;
	axis_ticks_across(&panel->across, &across);
	for (int k = 0; k < up.n; k++) {
		double y = axis_at(&panel->up, up.tick[k].value);
		draw_line(drawing, &grid, panel->left, y, panel->right, y);
		draw_text(drawing,
		          &(struct label){.x = panel->left - TICK - 2, .y = y + 4, .anchor = 'e', .ink = INK_MUTED},
		          up.tick[k].text);
	}
	for (int k = 0; k < across.n; k++) {
		double x = axis_at(&panel->across, across.tick[k].value);
		draw_line(drawing, &axis, x, panel->bottom, x, panel->bottom + TICK);
		draw_text(drawing, &(struct label){.x = x, .y = panel->bottom + 18, .anchor = 'm', .ink = INK_MUTED},
		          across.tick[k].text);
	}
	draw_line(drawing, &axis, panel->left, panel->bottom, panel->right, panel->bottom);
	draw_line(drawing, &axis, panel->left, panel->bottom, panel->left, panel->top);
	if (panel->x_label) {
		axis_label(&across, panel->x_label, label, sizeof label);
		draw_text(drawing,
		          &(struct label){.x = (panel->left + panel->right) / 2,
		                          .y = panel->bottom + 35,
		                          .anchor = 'm',
		                          .fit = panel->right - panel->left},
		          label);
	}
	if (panel->y_label || up.exponent) {
		axis_label(&up, panel->y_label ? panel->y_label : "", label, sizeof label);
		draw_text(drawing,
		          &(struct label){.x = panel->x + 12,
		                          .y = (panel->top + panel->bottom) / 2,
		                          .anchor = 'm',
		                          .up = true,
		                          .fit = panel->bottom - panel->top},
		          label);
	}
	if (panel->bare)
		draw_text(drawing, &(struct label){.x = panel->left + 8, .y = panel->top + 14, .ink = INK_MUTED},
		          "no value");
	drawing->height = fmax(drawing->height, panel->y + panel->height);
}

int panel_columns(const struct drawing *drawing, int n, double narrowest)
{
	int most = (int)((drawing->width - GAP) / (narrowest + GAP));
	most = most < 1 ? 1 : most;
	if (n <= most)
		return n < 1 ? 1 : n;
	// as few columns as possible for the same number of rows
	int rows = (n + most - 1) / most;
	return (n + rows - 1) / rows;
}

void panel_place(const struct drawing *drawing, int columns, int index, double top, struct panel *panel)
{
	panel->height = panel->height > 0 ? panel->height : PANEL_HEIGHT;
	panel->width = (drawing->width - GAP * (columns + 1)) / columns;
	panel->x = GAP + index % columns * (panel->width + GAP);
	panel->y = top + index / columns * (panel->height + 12);
}
