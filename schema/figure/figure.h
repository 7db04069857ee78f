/* figure.h - figures of results as SVG: a table of figures and a function that draws them.
 *
 *   struct figure_source source = {.json = json, .length = length};
 *   struct figure_choice choice = {.output = "impulse"};
 *   struct figure figure;
 *   if (figure_draw("indices", &source, &choice, &figure) == FIGURE_DRAWN)
 *       fwrite(figure.svg, 1, figure.length, stdout);
 *   free(figure.svg);
 *
 * The same result and choices give the same bytes.  Any thread. */
#ifndef FIGURE_H
#define FIGURE_H

#include <stdbool.h>
#include <stddef.h>

// clang-format off
/* The figures: X(name). */
#define FIGURES(X) X(indices) X(swept) X(given) X(widths) X(pairs) X(spectra) X(history) X(force) X(responses) \
	X(heights) X(impacts) X(timeline) X(errors) X(separation) X(fragility) \
	X(suite)

/* Arguments of figures: X(name, values between spaces or NULL, lowest, highest, text). */
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

/* Arguments as text, NULL: the default. */
struct figure_choice {
#define X(name, values, lowest, highest, text) const char *name;
	FIGURE_ARGUMENTS(X)
#undef X
};

struct figure_row {
	const char *name;  /* "indices" */
	const char *kind;  /* kind of study with this figure */
	const char *takes; /* names of its arguments, between spaces */
	const char *table; /* CSV table of the result with its numbers; NULL: the default table */
	bool sampled;      /* needs the samples besides the result */
	const char *text;  /* description in one line */
	const char *needs; /* what it needs and a result of the kind may lack; NULL: nothing */
};

/* The rows; the last one has name NULL. */
extern const struct figure_row figure_rows[];

enum figure_status {
	FIGURE_DRAWN,
	FIGURE_UNKNOWN, /* unknown name */
	FIGURE_ABSENT,  /* the result has no such figure */
	FIGURE_CHOICE,  /* an argument is invalid */
	FIGURE_RESULT,  /* the JSON is not a result */
	FIGURE_NOMEM,
};

struct figure_source {
	const char *json; /* (length) a result */
	size_t length;
	const char *samples; /* (n_samples) CSV, zero-terminated, for figures that need samples; NULL: none */
	size_t n_samples;
};

struct figure {
	char *svg; /* (length) on the heap, zero-terminated; NULL unless drawn */
	size_t length;
	char detail[240]; /* unless drawn: an error message */
};

const struct figure_row *figure_row(const char *name); /* NULL: none */
enum figure_status figure_draw(const char *name, const struct figure_source *source,
                               const struct figure_choice *choice, struct figure *figure);

/* The figures of a result, as JSON: name, title, arguments, table and a link that begins with `base`; figures that need
 * samples only if the source has samples.
 * NULL: not a result, or out of memory. */
char *figure_list(const struct figure_source *source, const char *base, size_t *length);

/* Whether a result has a figure. */
bool figure_has(const struct figure_row *row, const struct figure_source *source);

#endif
