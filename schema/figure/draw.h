/* draw.h - draws lines, marks, text and axes as SVG.
 *
 *   struct drawing d;
 *   draw_init(&d, 1120);
 *   draw_text(&d, &(struct label){.x = 20, .y = 20, .size = 14}, "a title");
 *   char *svg = draw_take(&d, "a title", "a sentence", &length);
 *
 * The same calls give the same bytes: coordinates have one decimal, texts are escaped.  Every color is an attribute for white
 * paper and a class for dark screens; one style element sets the classes, and only the dark scheme needs it.
 * Lengths are pixels at the drawing's own width, y grows downward.  Only draw_take reports that memory ran out. */
#ifndef DRAW_H
#define DRAW_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/json/json_writer.h"

enum {
	DRAW_TEXT_SIZE = 12,
	DRAW_TITLE_SIZE = 13,
	DRAW_HEAD_SIZE = 15,
	DRAW_SERIES = 6, /* number of series colors; marks and dashes repeat with other periods */
};

/* Width of bold text over width of regular text, in the widest common font (DejaVu Sans). */
#define DRAW_BOLD 1.12

/* Colors: series 0 to DRAW_SERIES - 1, then these. */
enum ink { INK_SERIES, INK_TEXT = DRAW_SERIES, INK_MUTED, INK_GRID, INK_PAPER, N_INKS };

struct drawing {
	struct writer w;
	double width, height; /* the height grows while drawing */
};

void draw_init(struct drawing *drawing, double width);
/* The whole document; NULL: out of memory. */
char *draw_take(struct drawing *drawing, const char *title, const char *sentence, size_t *length);

/* ---- text ---- */

/* Writes a text for XML: special characters become entities; control and bidirectional characters become U+FFFD. */
void draw_escaped(struct writer *writer, const char *text, size_t most);

struct label {
	double x, y;   /* of the baseline */
	double size;   /* 0: DRAW_TEXT_SIZE */
	double fit;    /* largest width: the middle of a longer text is left out; 0: any */
	enum ink ink;  /* text is never INK_SERIES (0): 0 is INK_TEXT */
	char anchor;   /* 's'tart (also 0), 'm'iddle or 'e'nd of the text is at x */
	bool bold, up; /* up: rotated, reads upward */
};

void draw_text(struct drawing *drawing, const struct label *label, const char *text);
/* An upper estimate of the width of a text in common fonts. */
double draw_width(const char *text, double size);
/* Writes a text in at most `lines` lines of width label->fit; returns the baseline of the next line. */
double draw_prose(struct drawing *drawing, const struct label *label, const char *text, int lines);

/* ---- lines and marks ---- */

struct pen {
	enum ink ink;
	double width;     /* 0: 1 */
	const char *dash; /* NULL: solid */
	double opacity;   /* 0: 1 */
};

void draw_line(struct drawing *drawing, const struct pen *pen, double x1, double y1, double x2, double y2);
/* A line through the finite points; other points are gaps, and a single point between two gaps is a dot. */
void draw_curve(struct drawing *drawing, const struct pen *pen, int n, const double *x, const double *y);
/* The area between two curves, with gaps likewise. */
void draw_band(struct drawing *drawing, const struct pen *pen, int n, const double *x, const double *low,
               const double *high);
void draw_box(struct drawing *drawing, const struct pen *pen, double x, double y, double width,
              double height);

struct mark {
	int series; /* color and shape */
	bool hollow;
	double size; /* radius; 0: 4 */
};

/* `value` is its title, which browsers show as a tooltip; NULL: none. */
void draw_mark(struct drawing *drawing, const struct mark *mark, double x, double y, const char *value);
const char *draw_dash(int series); /* dashes of a line */

/* ---- axes ---- */

struct range {
	double low, high; /* low > high: empty */
};

extern const struct range RANGE_EMPTY;
void range_add(struct range *range, double value); /* values that are not finite are ignored */

struct axis {
	double low, high;           /* values at the positions ... */
	double start, end;          /* ... start and end */
	bool log, whole;            /* whole: ticks at whole numbers only */
	double half_low, half_span; /* halves of the mapped interval, so that no difference overflows */
};

/* An axis that covers a range, which may be empty or one point; a logarithmic axis covers its values > 0. */
struct axis axis_linear(struct range range);
struct axis axis_log(struct range range);
struct axis axis_between(double low, double high);                /* linear, with these ends */
double axis_at(const struct axis *axis, double value);            /* position of a value; NAN: none */
void axis_places(const struct axis *axis, int n, double *values); /* replaces values by positions */

enum { TICKS_MAX = 24 };

struct ticks {
	int n;
	struct tick {
		double value;
		char text[24]; /* "": only a line */
	} tick[TICKS_MAX];
	int exponent; /* power of ten of the axis label, a factor of the texts; 0: none */
	double widest;
};

/* Ticks at multiples of 1, 2 or 5 times a power of ten, at most `most` of them with a text. */
void axis_ticks(const struct axis *axis, int most, struct ticks *ticks);
/* As many ticks of a horizontal axis as have room for their texts. */
void axis_ticks_across(const struct axis *axis, struct ticks *ticks);
/* "label [m] (10⁻³)" */
void axis_label(const struct ticks *ticks, const char *label, char *text, size_t size);
/* a number with few digits and superscripts for a power of ten: "0.25", "3.1·10⁻⁷"; or "no value" */
const char *draw_number(double value, char text[32]);

/* A panel: one plot with frame, axes and labels. */
struct panel {
	double x, y, width, height; /* outside, labels included */
	const char *title, *x_label, *y_label;
	bool bare; /* no values: a text says so */
	struct axis across, up;
	double room;                     /* least width for tick labels, so that stacked panels align */
	double left, right, top, bottom; /* of the plot area, set by panel_draw */
};

/* Draws grid, axes, ticks and labels, and sets the positions of both axes. */
void panel_draw(struct drawing *drawing, struct panel *panel);
/* The number of columns of panels that fit, and the position of panel `index` in a grid below `top`. */
int panel_columns(const struct drawing *drawing, int n, double narrowest);
void panel_place(const struct drawing *drawing, int columns, int index, double top, struct panel *panel);

/* An entry of a legend. */
struct key {
	const char *name;
	struct mark mark;
	struct pen pen; /* width 0: no line */
	bool marked, band;
};

/* The entry of a series with a line and marks. */
struct key key_of_series(const char *name, int series);

/* Draws entries in rows below y; returns the y below the last row. */
double draw_legend(struct drawing *drawing, int n, const struct key *keys, double y);

#endif
