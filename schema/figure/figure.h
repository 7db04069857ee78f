/* figure.h - pictures of results, as SVG: a table of figures and one function that draws them.
 *
 *   struct figure_source source = {.json = json, .length = length};
 *   struct figure_choice choice = {.output = "impulse"};
 *   struct figure figure;
 *   if (figure_draw("indices", &source, &choice, &figure) == FIGURE_DRAWN)
 *       fwrite(figure.svg, 1, figure.length, stdout);
 *   free(figure.svg);
 *
 * The same bytes and choices give the same picture.  Any thread. */
#ifndef FIGURE_H
#define FIGURE_H

#include <stdbool.h>
#include <stddef.h>

// clang-format off
/* The figures: X(name). */
#define FIGURES(X) X(indices) X(swept) X(given) X(widths) X(pairs) X(spectra) X(history) X(force) X(responses) \
	X(heights) X(impacts) X(timeline) X(errors) X(separation) X(fragility) \
	X(suite)

/* What can be chosen of a figure: X(name, values between spaces or NULL, lowest, highest, text). */
#define FIGURE_ARGUMENTS(X)                                                                                   \
	X(cell,     NULL,                        0, 1000000, "cell of a swept study, from 0")                      \
	X(contact,  NULL,                        0, 1000000, "contact of a row of buildings, from 0 (default: 0)")  \
	X(output,   NULL,                        0, 0,       "name of an output (default: all)")                   \
	X(index,    " S1 ST ",                   0, 0,       "which index (default: both, or ST)")                 \
	X(x,        NULL,                        0, 0,       "path of the swept number along the axis (default: the last)") \
	X(axis,     " hz s ",                    0, 0,       "frequencies or periods (default: hz)")               \
	X(spectra,  NULL,                        0, 0,       "names of spectra, comma-separated (default: pounding,free,dirac_peaks)") \
	X(quantity, " displacement demand impulse history ", 0, 0, "error of which quantity (default: displacement)") \
	X(signal,   NULL,                        0, 1000000, "ground motion, from 0 (default: 0)")                 \
	X(from,     NULL,                        0, 0,       "start of the time shown, s (default: 0)")            \
	X(to,       NULL,                        0, 0,       "end of the time shown, s (default: the end)")        \
	X(width,    NULL,                        320, 2400,  "width in pixels (default: 1120)")
// clang-format on

/* Each as its text, NULL: the default. */
struct figure_choice {
#define X(name, values, lowest, highest, text) const char *name;
	FIGURE_ARGUMENTS(X)
#undef X
};

struct figure_row {
	const char *name;  /* "indices" */
	const char *kind;  /* of the studies that have it */
	const char *takes; /* its arguments, between spaces */
	const char *table; /* of a result's CSV tables, the one with its numbers; NULL: the CSV of the result */
	bool sampled;      /* it is drawn from the samples too, not from the result alone */
	const char *text;  /* one line */
	const char *needs; /* what a result of its kind may lack; NULL: nothing */
};

/* The rows, the last one has no name. */
extern const struct figure_row figure_rows[];

enum figure_status {
	FIGURE_DRAWN,
	FIGURE_UNKNOWN, /* no figure has that name */
	FIGURE_ABSENT,  /* the result has no such figure */
	FIGURE_CHOICE,  /* a choice is not one */
	FIGURE_RESULT,  /* the bytes are no result */
	FIGURE_NOMEM,
};

struct figure_source {
	const char *json; /* (length) a result */
	size_t length;
	const char *samples; /* (n_samples) CSV and a NUL, for the figures that need it; NULL: none */
	size_t n_samples;
};

struct figure {
	char *svg; /* (length) on the heap, and a NUL; NULL unless drawn */
	size_t length;
	char detail[240]; /* unless drawn: a sentence */
};

const struct figure_row *figure_row(const char *name); /* NULL: none */
enum figure_status figure_draw(const char *name, const struct figure_source *source,
                               const struct figure_choice *choice, struct figure *figure);

/* The figures that a result has, as JSON: name, title, arguments, table and a link that begins with `base`; those of
 * samples when the source has some.
 * NULL: the bytes are no result, or out of memory. */
char *figure_list(const struct figure_source *source, const char *base, size_t *length);

/* Whether a result has a figure. */
bool figure_has(const struct figure_row *row, const struct figure_source *source);

#endif
