/* draw.h - SVG from lines, marks, text and axes.
 *
 *   struct drawing d;
 *   draw_init(&d, 1120);
 *   draw_text(&d, &(struct label){.x = 20, .y = 20, .size = 14}, "a title");
 *   char *svg = draw_take(&d, "a title", "a sentence", &length);
 *
 * Same calls, same bytes: coordinates have one decimal, texts are escaped.  Every color is an attribute for white
 * paper and a class for a dark screen; one style element, which nothing but the dark scheme needs, sets the classes.
 * Lengths are pixels at the drawing's own width, y grows downward.  Out of memory shows only in draw_take. */
#ifndef DRAW_H
#define DRAW_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/json/json_writer.h"

enum {
	DRAW_TEXT_SIZE = 12,
	DRAW_TITLE_SIZE = 13,
	DRAW_HEAD_SIZE = 15,
	DRAW_SERIES = 6, /* colors of series; marks and dashes change with other periods */
};

/* Colors: series 0 to DRAW_SERIES - 1, then these. */
enum ink { INK_SERIES, INK_TEXT = DRAW_SERIES, INK_MUTED, INK_GRID, INK_PAPER, N_INKS };

struct drawing {
	struct writer w;
	double width, height; /* the height grows with what is drawn */
};

void draw_init(struct drawing *drawing, double width);
/* The whole document; NULL: out of memory. */
char *draw_take(struct drawing *drawing, const char *title, const char *sentence, size_t *length);

/* ---- text ---- */

/* A text made harmless: what is a sign of XML is an entity, what would steer a reader is U+FFFD. */
void draw_escaped(struct writer *writer, const char *text, size_t most);

struct label {
	double x, y;   /* of the baseline */
	double size;   /* 0: DRAW_TEXT_SIZE */
	double fit;    /* the width it may take, of a longer text the middle is left out; 0: any */
	enum ink ink;  /* INK_SERIES is never that of a text: 0 is INK_TEXT */
	char anchor;   /* 's'tart (also 0), 'm'iddle, 'e'nd of the text is at x */
	bool bold, up; /* up: read from below */
};

void draw_text(struct drawing *drawing, const struct label *label, const char *text);
/* The width that a text takes in common fonts, rather too much than too little. */
double draw_width(const char *text, double size);
/* A text of a document in lines of at most `width`, no more than `lines`; returns the baseline of the next line. */
double draw_prose(struct drawing *drawing, const struct label *label, const char *text, int lines);

/* ---- lines and marks ---- */

struct pen {
	enum ink ink;
	double width;     /* 0: 1 */
	const char *dash; /* NULL: solid */
	double opacity;   /* 0: 1 */
};

void draw_line(struct drawing *drawing, const struct pen *pen, double x1, double y1, double x2, double y2);
/* A line through the points that are finite; a point that is not is a gap, one between two gaps a dot. */
void draw_curve(struct drawing *drawing, const struct pen *pen, int n, const double *x, const double *y);
/* The area between two curves, likewise. */
void draw_band(struct drawing *drawing, const struct pen *pen, int n, const double *x, const double *low,
               const double *high);
void draw_box(struct drawing *drawing, const struct pen *pen, double x, double y, double width,
              double height);

struct mark {
	int series; /* its color and its shape */
	bool hollow;
	double size; /* radius; 0: 4 */
};

/* `value` is its title, what the picture says about it; NULL: none. */
void draw_mark(struct drawing *drawing, const struct mark *mark, double x, double y, const char *value);
const char *draw_dash(int series); /* of a line */

/* ---- axes ---- */

struct range {
	double low, high; /* low > high: empty */
};

extern const struct range RANGE_EMPTY;
void range_add(struct range *range, double value); /* what is not finite is left out */

struct axis {
	double low, high;           /* values at ... */
	double start, end;          /* ... these places */
	bool log, whole;            /* whole: ticks at whole numbers only */
	double half_low, half_span; /* of what is mapped: halves, so that no difference overflows */
};

/* An axis around all values of a range, which may be empty or one point; the logarithmic one around those > 0. */
struct axis axis_linear(struct range range);
struct axis axis_log(struct range range);
struct axis axis_between(double low, double high);                /* linear, with these ends */
double axis_at(const struct axis *axis, double value);            /* NAN: it has no place */
void axis_places(const struct axis *axis, int n, double *values); /* in place of each value its place */

enum { TICKS_MAX = 24 };

struct ticks {
	int n;
	struct tick {
		double value;
		char text[24]; /* "": a line only */
	} tick[TICKS_MAX];
	int exponent; /* of ten, by which the texts are to be multiplied; 0: none */
	double widest;
};

/* Ticks at 1, 2 or 5 times a power of ten, at most `most` of them with a text. */
void axis_ticks(const struct axis *axis, int most, struct ticks *ticks);
/* As many of an axis from left to right as fit side by side. */
void axis_ticks_across(const struct axis *axis, struct ticks *ticks);
/* "label [m] (10⁻³)" */
void axis_label(const struct ticks *ticks, const char *label, char *text, size_t size);
/* a number in few digits, with superscripts for a power of ten: "0.25", "3.1·10⁻⁷"; "no value" */
const char *draw_number(double value, char text[32]);

/* A plot: its frame from (x, y), and where its values are inside. */
struct panel {
	double x, y, width, height; /* with labels */
	const char *title, *x_label, *y_label;
	bool bare; /* nothing of it has a value: it says so */
	struct axis across, up;
	double room;                     /* at least for the labels of ticks, so that stacked panels align */
	double left, right, top, bottom; /* of the inside, set by panel_draw */
};

/* Draws grid, axes, ticks and labels, and places both axes. */
void panel_draw(struct drawing *drawing, struct panel *panel);
/* The columns that fit, and the panel in place `index` of a grid from `top` down. */
int panel_columns(const struct drawing *drawing, int n, double narrowest);
void panel_place(const struct drawing *drawing, int columns, int index, double top, struct panel *panel);

/* What a legend shows beside each name. */
struct key {
	const char *name;
	struct mark mark;
	struct pen pen; /* width 0: no line */
	bool marked, band;
};

/* Of a series with a line and marks. */
struct key key_of_series(const char *name, int series);

/* Names in rows from y down, to the drawing's width; returns where they end. */
double draw_legend(struct drawing *drawing, int n, const struct key *keys, double y);

#endif
