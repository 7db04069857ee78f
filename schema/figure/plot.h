/* plot.h - the state of drawing one figure, and functions that all figures use.  For the files of schema/figure only. */
#ifndef PLOT_H
#define PLOT_H

#include <cjson/cJSON.h>

#include "schema/figure/draw.h"
#include "schema/figure/figure.h"

enum { PLOT_MARGIN = 20, PLOT_TEXT = 256 };

struct plot {
	struct drawing d;
	const cJSON *result;
	const struct figure_source *source;
	const struct figure_choice *choice;
	char title[PLOT_TEXT], sentence[2 * PLOT_TEXT];
	char fault[200]; /* why an argument is invalid; "": all are valid */
	double y;        /* the drawing is empty below y */
	struct kept *kept;
};

/* Memory that is freed by plot_free; NULL: out of memory, and the figure becomes FIGURE_NOMEM. */
void *plot_memory(struct plot *plot, size_t size);
void plot_free(struct plot *plot); /* frees all of plot_memory */

/* Whether a parsed result has a figure; draws the figure, whose arguments must be valid. */
bool figure_shows(const struct figure_row *row, const cJSON *result);
enum figure_status figure_of(const struct figure_row *row, const cJSON *result,
                             const struct figure_source *source, const struct figure_choice *choice,
                             struct figure *figure);

/* ---- values of a result ---- */

bool plot_is_result(const cJSON *document); /* a result of any kind, and not a study document */
const cJSON *plot_member(const cJSON *object, const char *name);
const cJSON *plot_first(const cJSON *list);                                          /* NULL: none */
double plot_number(const cJSON *object, const char *name);                           /* NAN: none */
const char *plot_text(const cJSON *object, const char *name);                        /* "": none */
double *plot_numbers(struct plot *plot, const cJSON *list, int *n);                  /* null becomes NAN */
double *plot_column(struct plot *plot, const cJSON *list, const char *name, int *n); /* of the elements */
const cJSON *plot_cell(struct plot *plot); /* the chosen cell; NULL: invalid, see fault */

/* Whether an output has what a figure draws: a constant output has no interactions and no curves. */
typedef bool plot_drawable(const cJSON *output);
bool plot_any_output(const cJSON *result, plot_drawable *has); /* in any cell */

/* The outputs of a cell to draw, at most `most`: the chosen one, or all, outputs without a frequency first.  0: see fault. */
int plot_outputs(struct plot *plot, const cJSON *cell, plot_drawable *has, int most, const cJSON **outputs);

/* ---- samples in time ---- */

enum { PLOT_COLUMNS_MOST = 24 };

struct plot_table {
	int signal;       /* the chosen signal; -1: all */
	int n_columns, n; /* n: rows of the chosen signal and time */
	const char *names[PLOT_COLUMNS_MOST];
	size_t lengths[PLOT_COLUMNS_MOST];
	double *values[PLOT_COLUMNS_MOST]; /* (n) of each column */
};

bool plot_table(struct plot *plot, struct plot_table *table);       /* false: see fault */
bool plot_table_whole(struct plot *plot, struct plot_table *table); /* all rows; false: see fault */
const double *plot_table_column(const struct plot_table *table, const char *name); /* NULL: none */

/* ---- words ---- */

/* "force amplification", "floor spectrum at 2 Hz" */
const char *plot_output_name(const cJSON *output, char text[PLOT_TEXT]);
/* "/oscillators/0/frequency_hz" -> "left frequency [Hz]" */
const char *plot_path_name(const char *path, char text[PLOT_TEXT]);
/* "linear, left frequency 2 Hz"; "" without a sweep.  `but`: paths to leave out  (n_but) */
const char *plot_sweep_text(const cJSON *cell, int n_but, const char *const *but, char text[PLOT_TEXT]);

/* ---- the page ---- */

/* Writes the title and, below it, the study's name and `more`. */
void plot_head(struct plot *plot, const char *title, const char *more);
void plot_note(struct plot *plot, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Two functions for each row of the table: draw the figure, and whether a result has it. */
#define X(name)                          \
	void plot_##name(struct plot *plot); \
	bool plot_has_##name(const cJSON *result);
FIGURES(X)
#undef X

#endif
