/* draw.c - draws SVG documents, texts, lines, marks and legends; axes are in axis.c. */
#include "schema/figure/draw.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MARGIN = 20 };

// on white paper and on a dark screen; contrast at least 4.5:1 against the background, except the grid
static const struct {
	const char *light, *dark;
} INKS[N_INKS] = {
    {"#0072b2", "#5ab4f0"}, {"#b84a00", "#ff9a57"}, {"#00795a", "#4fd0a5"}, {"#9a3a86", "#e08ad0"},
    {"#7a5c00", "#d9b84a"}, {"#57606a", "#9aa4af"}, {"#14171b", "#eceff2"}, {"#57606a", "#9aa4af"},
    {"#dfe3e8", "#323941"}, {"#ffffff", "#14171b"},
};

static const char *const DASHES[] = {NULL, "7 3", "2 3", "9 3 2 3"};

static const char FONT[] = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/* ---- the document ---- */

static void put(struct drawing *drawing, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(struct drawing *drawing, const char *format, ...)
{
	char text[400];
	va_list arguments;
	va_start(arguments, format);
	int n = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	writer_raw(&drawing->w, text, (size_t)n < sizeof text ? (size_t)n : sizeof text - 1);
}

/* A coordinate: one decimal at most, and no minus zero. */
static void put_place(struct drawing *drawing, double value)
{
	char text[48];
	double tenths = nearbyint(fmin(fmax(value, -1e6), 1e6) * 10);
	int n = snprintf(text, sizeof text, "%.1f", tenths == 0 ? 0.0 : tenths / 10);
	if (n > 2 && text[n - 1] == '0')
		n -= 2;
	writer_raw(&drawing->w, text, (size_t)n);
}

static void put_attribute(struct drawing *drawing, const char *name, double value)
{
	put(drawing, " %s=\"", name);
	put_place(drawing, value);
	put(drawing, "\"");
}

/* Number of bytes of the UTF-8 character at `text`, 0 at its end; texts from JSON documents are valid UTF-8. */
static size_t character(const char *text)
{
	unsigned char c = (unsigned char)*text;
	size_t n = c == 0 ? 0 : c < 0x80 ? 1 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : 4;
	for (size_t k = 1; k < n; k++)
		if (((unsigned char)text[k] & 0xC0) != 0x80)
			return k;
	return n;
}

/* Whether a character is a control or bidirectional character, or not allowed in XML. */
static bool steers(const char *text, size_t n)
{
	const unsigned char *c = (const unsigned char *)text;
	unsigned code = n == 1   ? c[0]
	                : n == 2 ? (c[0] & 0x1Fu) << 6 | (c[1] & 0x3Fu)
	                : n == 3 ? (c[0] & 0x0Fu) << 12 | (c[1] & 0x3Fu) << 6 | (c[2] & 0x3Fu)
	                         : 0x10000;
	if (n == 1)
		return code < 0x20 || code >= 0x7F;
	return code < 0xA0 || code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
	       (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF || (n == 3 && code >= 0xFFFE);
}

/* Writes a text as XML or HTML, up to `most` bytes or its end.
 *
 * Test     unit_figure: a_name_stays_text
 */
void draw_escaped(struct writer *w, const char *text, size_t most)
{
	const char *end = text + most;
	for (size_t n; text < end && (n = character(text)) > 0; text += n) {
		const char *entity = *text == '&'      ? "&amp;"
		                     : *text == '<'    ? "&lt;"
		                     : *text == '>'    ? "&gt;"
		                     : *text == '"'    ? "&quot;"
		                     : *text == '\''   ? "&#39;"
		                     : steers(text, n) ? "\xEF\xBF\xBD"
		                                       : NULL;
		writer_raw(w, entity ? entity : text, entity ? strlen(entity) : n);
	}
}

static void put_text(struct drawing *drawing, const char *text, size_t most)
{
	draw_escaped(&drawing->w, text, most);
}

void draw_init(struct drawing *drawing, double width)
{
	*drawing = (struct drawing){.width = width};
	writer_init(&drawing->w);
}

static void grow(struct drawing *drawing, double y)
{
	drawing->height = fmax(drawing->height, y);
}

/* Puts the head of the document before the drawing.
 *
 * Test     unit_figure: every_figure_of_every_example_is_well_formed_and_within_its_view_box
 */
char *draw_take(struct drawing *drawing, const char *title, const char *sentence, size_t *length)
{
	struct drawing whole;
	size_t n_body;
	char *body = writer_take(&drawing->w, &n_body);
	double height = ceil(drawing->height + MARGIN / 2);
	draw_init(&whole, drawing->width);
	put(&whole, "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox=\"0 0 ");
	put_place(&whole, drawing->width);
	put(&whole, " ");
	put_place(&whole, height);
	put(&whole, "\"");
	put_attribute(&whole, "width", drawing->width);
	put_attribute(&whole, "height", height);
	put(&whole, " font-family=\"%s\" font-size=\"%d\">\n<title>", FONT, DRAW_TEXT_SIZE);
	put_text(&whole, title, strlen(title));
	put(&whole, "</title>\n<desc>");
	put_text(&whole, sentence, strlen(sentence));
	put(&whole, "</desc>\n<style>@media screen and (prefers-color-scheme:dark){");
	for (int ink = 0; ink < N_INKS; ink++)
		put(&whole, ".f%d{fill:%s}.s%d{stroke:%s}", ink, INKS[ink].dark, ink, INKS[ink].dark);
	put(&whole, "}</style>\n<rect class=\"f%d\" fill=\"%s\" width=\"100%%\" height=\"100%%\"/>\n", INK_PAPER,
	    INKS[INK_PAPER].light);
	if (body)
		writer_raw(&whole.w, body, n_body);
	else
		whole.w.failed = true;
	put(&whole, "</svg>\n");
	free(body);
	return writer_take(&whole.w, length);
}

/* ---- text ---- */

// widths of ' ' to '~' in Helvetica, in thousandths of the font size
static const short WIDTHS[] = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

static double width_of(const char *text, size_t n, double size)
{
	// other fonts are up to 1/8 wider; characters outside ASCII are at most square, superscript digits are small
	double em = n == 3 && strncmp(text, "\xE2\x81", 2) == 0 ? 400
	            : n > 1                                     ? (n == 2 ? 650 : 1000)
	            : *text >= ' ' && *text <= '~'              ? WIDTHS[*text - ' ']
	                                                        : 600;
	return em * 1.125e-3 * size;
}

double draw_width(const char *text, double size)
{
	double width = 0;
	for (size_t n; (n = character(text)) > 0; text += n)
		width += width_of(text, n, size);
	return width;
}

/* Number of leading bytes of a text that fit in a width together with an ellipsis; all bytes if the text fits. */
static size_t fitting(const char *text, double size, double fit)
{
	const char *at = text;
	if (fit <= 0 || draw_width(text, size) <= fit)
		return strlen(text);
	double width = size;
	for (size_t n; (n = character(at)) > 0 && (width += width_of(at, n, size)) <= fit; at += n)
		;
	return (size_t)(at - text);
}

/* Number of trailing bytes of a text that fit in a width. */
static size_t fitting_last(const char *text, double size, double fit)
{
	size_t whole = strlen(text), from = whole;
	double width = 0;
	for (size_t at = whole; at > 0; from = at) {
		do
			at--;
		while (at > 0 && ((unsigned char)text[at] & 0xC0) == 0x80);
		width += width_of(text + at, character(text + at), size);
		if (width > fit)
			break;
	}
	return whole - from;
}

/* Writes a text.  Of a long text the middle is left out, as names often differ at their ends; its title is the whole text.
 *
 * Test     unit_figure: a_long_name_keeps_its_beginning_and_its_end */
void draw_text(struct drawing *drawing, const struct label *label, const char *text)
{
	double size = label->size > 0 ? label->size : DRAW_TEXT_SIZE;
	enum ink ink = label->ink ? label->ink : INK_TEXT;
	const double wide = label->bold ? DRAW_BOLD * size : size;
	size_t whole = strlen(text), n = fitting(text, wide, label->fit), last = 0;
	if (n < whole) {
		// a place at the end is left whole if there is room: ", building 1, story 2"
		const char *place = strstr(text, ", ");
		const double room = label->fit - size, tail = place ? draw_width(place, wide) : room;
		const bool keep = tail < 0.8 * room;
		n = fitting(text, wide, keep ? label->fit - tail : 0.6 * room + size);
		last = keep ? strlen(place) : fitting_last(text + n, wide, 0.4 * room);
	}
	put(drawing, "<text class=\"f%d\" fill=\"%s\"", ink, INKS[ink].light);
	put_attribute(drawing, "x", label->x);
	put_attribute(drawing, "y", label->y);
	if (size != DRAW_TEXT_SIZE)
		put_attribute(drawing, "font-size", size);
	if (label->anchor == 'm' || label->anchor == 'e')
		put(drawing, " text-anchor=\"%s\"", label->anchor == 'm' ? "middle" : "end");
	if (label->bold)
		put(drawing, " font-weight=\"600\"");
	if (label->up) {
		put(drawing, " transform=\"rotate(-90 ");
		put_place(drawing, label->x);
		put(drawing, " ");
		put_place(drawing, label->y);
		put(drawing, ")\"");
	}
	put(drawing, ">");
	if (n < whole) {
		put(drawing, "<title>");
		put_text(drawing, text, whole);
		put(drawing, "</title>");
	}
	put_text(drawing, text, n);
	if (n < whole) {
		put(drawing, "…");
		put_text(drawing, text + whole - last, last);
	}
	put(drawing, "</text>\n");
	grow(drawing, label->y + size / 3);
}

/* The last blank among the first n bytes, preferably not after a digit, to keep a number with its unit; 0: none. */
static size_t last_blank(const char *text, size_t n)
{
	size_t any = 0;
	for (size_t blank = n; blank > 0; blank--) {
		const unsigned char before = (unsigned char)text[blank - 1];
		if (text[blank] != ' ')
			continue;
		// a digit, or the last byte of a superscript digit
		if ((before < '0' || before > '9') && before < 0x80)
			return blank;
		any = any ? any : blank;
	}
	return any;
}

double draw_prose(struct drawing *drawing, const struct label *label, const char *text, int lines)
{
	struct label here = *label;
	double size = label->size > 0 ? label->size : DRAW_TEXT_SIZE;
	const double wide = label->bold ? DRAW_BOLD * size : size;
	for (int line = 1; *text; line++, here.y += 1.35 * size) {
		size_t n = fitting(text, wide, label->fit), whole = strlen(text);
		if (line == lines || n == whole) {
			draw_text(drawing, &here, text);
			return here.y + 1.35 * size;
		}
		const size_t blank = last_blank(text, n);
		n = blank > 0 ? blank : n > 0 ? n : whole;
		char *part = strndup(text, n);
		if (part)
			draw_text(drawing, &here, part);
		else
			drawing->w.failed = true;
		free(part);
		text += n + (text[n] == ' ');
	}
	return here.y;
}

/* ---- lines and marks ---- */

static void put_stroke(struct drawing *drawing, const struct pen *pen)
{
	put(drawing, " class=\"s%d\" stroke=\"%s\"", pen->ink, INKS[pen->ink].light);
	if (pen->width > 0 && pen->width != 1)
		put_attribute(drawing, "stroke-width", pen->width);
	if (pen->dash)
		put(drawing, " stroke-dasharray=\"%s\"", pen->dash);
	if (pen->opacity > 0)
		put(drawing, " opacity=\"%.2g\"", pen->opacity);
}

static void put_fill(struct drawing *drawing, const struct pen *pen)
{
	put(drawing, " class=\"f%d\" fill=\"%s\"", pen->ink, INKS[pen->ink].light);
	if (pen->opacity > 0)
		put(drawing, " fill-opacity=\"%.2g\"", pen->opacity);
}

void draw_line(struct drawing *drawing, const struct pen *pen, double x1, double y1, double x2, double y2)
{
	if (!isfinite(x1) || !isfinite(y1) || !isfinite(x2) || !isfinite(y2))
		return;
	put(drawing, "<path");
	put_stroke(drawing, pen);
	put(drawing, " d=\"M");
	put_place(drawing, x1);
	put(drawing, " ");
	put_place(drawing, y1);
	put(drawing, x1 == x2 ? "V" : y1 == y2 ? "H" : "L");
	put_place(drawing, x1 == x2 ? y2 : x2);
	if (x1 != x2 && y1 != y2) {
		put(drawing, " ");
		put_place(drawing, y2);
	}
	put(drawing, "\"/>\n");
	grow(drawing, fmax(y1, y2));
}

static void put_point(struct drawing *drawing, char command, double x, double y)
{
	put(drawing, "%c", command);
	put_place(drawing, x);
	put(drawing, " ");
	put_place(drawing, y);
	grow(drawing, y);
}

/* Whether a point of a curve has no neighbor. */
static bool dot_at(int n, const double *x, const double *y, int k)
{
	return (k == 0 || !isfinite(x[k - 1]) || !isfinite(y[k - 1])) &&
	       (k == n - 1 || !isfinite(x[k + 1]) || !isfinite(y[k + 1]));
}

void draw_curve(struct drawing *drawing, const struct pen *pen, int n, const double *x, const double *y)
{
	bool inside = false, any = false, dots = false;
	for (int k = 0; k < n; k++) {
		const bool here = isfinite(x[k]) && isfinite(y[k]);
		any = any || here;
		dots = dots || (here && dot_at(n, x, y, k));
	}
	if (!any)
		return;
	// a line of zero length is visible by its round caps
	put(drawing, dots ? "<path fill=\"none\" stroke-linecap=\"round\""
	                  : "<path fill=\"none\" stroke-linejoin=\"round\"");
	put_stroke(drawing, pen);
	put(drawing, " d=\"");
	for (int k = 0; k < n; k++) {
		bool here = isfinite(x[k]) && isfinite(y[k]);
		if (here)
			put_point(drawing, inside ? 'L' : 'M', x[k], y[k]);
		if (here && dots && dot_at(n, x, y, k))
			put_point(drawing, 'L', x[k], y[k]);
		inside = here;
	}
	put(drawing, "\"/>\n");
}

void draw_band(struct drawing *drawing, const struct pen *pen, int n, const double *x, const double *low,
               const double *high)
{
	for (int from = 0, to; from < n; from = to + 1) {
		for (to = from; to < n && isfinite(x[to]) && isfinite(low[to]) && isfinite(high[to]); to++)
			;
		if (to - from < 2)
			continue;
		put(drawing, "<path stroke=\"none\"");
		put_fill(drawing, pen);
		put(drawing, " d=\"");
		for (int k = from; k < to; k++)
			put_point(drawing, k == from ? 'M' : 'L', x[k], high[k]);
		for (int k = to - 1; k >= from; k--)
			put_point(drawing, 'L', x[k], low[k]);
		put(drawing, "Z\"/>\n");
	}
}

void draw_box(struct drawing *drawing, const struct pen *pen, double x, double y, double width, double height)
{
	put(drawing, "<rect");
	put_fill(drawing, pen);
	put_attribute(drawing, "x", x);
	put_attribute(drawing, "y", y);
	put_attribute(drawing, "width", fmax(width, 0));
	put_attribute(drawing, "height", fmax(height, 0));
	put(drawing, "/>\n");
	grow(drawing, y + height);
}

const char *draw_dash(int series)
{
	return DASHES[series % 4];
}

// corners of the shapes at radius 1; the first shape has no corners: a circle
static const struct {
	int n;
	double x[4], y[4];
} SHAPES[] = {
    {0, {0}, {0}},
    {4, {-0.9, 0.9, 0.9, -0.9}, {-0.9, -0.9, 0.9, 0.9}},
    {4, {0, 1.25, 0, -1.25}, {-1.25, 0, 1.25, 0}},
    {3, {0, 1.15, -1.15}, {-1.15, 0.95, 0.95}},
    {3, {0, 1.15, -1.15}, {1.15, -0.95, -0.95}},
};

void draw_mark(struct drawing *drawing, const struct mark *mark, double x, double y, const char *value)
{
	int ink = mark->series % DRAW_SERIES, shape = mark->series % (int)(sizeof SHAPES / sizeof SHAPES[0]);
	double r = mark->size > 0 ? mark->size : 4;
	if (!isfinite(x) || !isfinite(y))
		return;
	const char *name = SHAPES[shape].n ? "path" : "circle";
	put(drawing, "<%s stroke-width=\"1.6\" class=\"s%d f%d\" stroke=\"%s\" fill=\"%s\"", name, ink,
	    mark->hollow ? (int)INK_PAPER : ink, INKS[ink].light,
	    INKS[mark->hollow ? INK_PAPER : (enum ink)ink].light);
	if (SHAPES[shape].n) {
		put(drawing, " d=\"");
		for (int k = 0; k < SHAPES[shape].n; k++)
			put_point(drawing, k ? 'L' : 'M', x + r * SHAPES[shape].x[k], y + r * SHAPES[shape].y[k]);
		put(drawing, "Z\"");
	} else {
		put_attribute(drawing, "cx", x);
		put_attribute(drawing, "cy", y);
		put_attribute(drawing, "r", r);
		grow(drawing, y + r);
	}
	if (value) {
		put(drawing, "><title>");
		put_text(drawing, value, strlen(value));
		put(drawing, "</title></%s>\n", name);
	} else
		put(drawing, "/>\n");
}

/* ---- legend ---- */

enum { KEY_SIGN = 30, KEY_GAP = 18, KEY_LINE = 20, KEY_WIDEST = 420 };

struct key key_of_series(const char *name, int series)
{
	return (struct key){
	    .name = name,
	    .mark = {.series = series},
	    .pen = {.ink = (enum ink)(series % DRAW_SERIES), .width = 1.8, .dash = draw_dash(series)},
	    .marked = true};
}

double draw_legend(struct drawing *drawing, int n, const struct key *keys, double y)
{
	double x = MARGIN;
	for (int k = 0; k < n; k++) {
		double widest = fmin(KEY_WIDEST, drawing->width - 2 * MARGIN - KEY_SIGN);
		double width = fmin(draw_width(keys[k].name, DRAW_TEXT_SIZE), widest);
		if (x > MARGIN && x + KEY_SIGN + width > drawing->width - MARGIN) {
			x = MARGIN;
			y += KEY_LINE;
		}
		double middle = y + 6;
		if (keys[k].band)
			draw_box(drawing, &(struct pen){.ink = keys[k].pen.ink, .opacity = 0.22}, x, middle - 6, 24, 12);
		if (keys[k].pen.width > 0)
			draw_line(drawing, &keys[k].pen, x, middle, x + 24, middle);
		if (keys[k].marked)
			draw_mark(drawing, &keys[k].mark, x + 12, middle, NULL);
		draw_text(drawing, &(struct label){.x = x + KEY_SIGN, .y = middle + 4, .fit = widest}, keys[k].name);
		x += KEY_SIGN + width + KEY_GAP;
	}
	return y + KEY_LINE;
}
