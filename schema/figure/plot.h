/* plot.h - a figure while it is drawn, for the files of schema/figure only. */
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
	char fault[200]; /* why a choice is none; "": every one is */
	double y;        /* from where on the drawing is empty */
	struct kept *kept;
};

/* Memory until the figure is drawn; without any left an allocation ends in NULL and the figure in FIGURE_NOMEM. */
void *plot_memory(struct plot *plot, size_t size);
void plot_free(struct plot *plot); /* what was kept */

/* Whether a parsed result has a figure, and that drawn; its choices must be those that it takes. */
bool figure_shows(const struct figure_row *row, const cJSON *result);
enum figure_status figure_of(const struct figure_row *row, const cJSON *result,
                             const struct figure_source *source, const struct figure_choice *choice,
                             struct figure *figure);

/* ---- what a result holds ---- */

bool plot_is_result(const cJSON *document); /* of any kind of study, and no study itself */
const cJSON *plot_member(const cJSON *object, const char *name);
const cJSON *plot_first(const cJSON *list);                                          /* NULL: none */
double plot_number(const cJSON *object, const char *name);                           /* NAN: none */
const char *plot_text(const cJSON *object, const char *name);                        /* "": none */
double *plot_numbers(struct plot *plot, const cJSON *list, int *n);                  /* null is NAN */
double *plot_column(struct plot *plot, const cJSON *list, const char *name, int *n); /* of each element */
const cJSON *plot_cell(struct plot *plot); /* the chosen one; NULL: a fault */

/* Outputs of a cell that are drawn, at most `most`: the chosen one, or those without a frequency first.  0: a fault. */
int plot_outputs(struct plot *plot, const cJSON *cell, int most, const cJSON **outputs);

/* ---- samples in time ---- */

enum { PLOT_COLUMNS_MOST = 24 };

struct plot_table {
	int signal;       /* the chosen one; -1: every one */
	int n_columns, n; /* rows of the signal and time */
	const char *names[PLOT_COLUMNS_MOST];
	size_t lengths[PLOT_COLUMNS_MOST];
	double *values[PLOT_COLUMNS_MOST]; /* (n) of one signal */
};

bool plot_table(struct plot *plot, struct plot_table *table);       /* false: a fault */
bool plot_table_whole(struct plot *plot, struct plot_table *table); /* every row; false: a fault */
const double *plot_table_column(const struct plot_table *table, const char *name); /* NULL: none */

/* ---- words ---- */

/* "force amplification", "floor spectrum at 2 Hz" */
const char *plot_output_name(const cJSON *output, char text[PLOT_TEXT]);
/* "/oscillators/0/frequency_hz" -> "left frequency [Hz]" */
const char *plot_path_name(const char *path, char text[PLOT_TEXT]);
/* "law type linear, left frequency 2 Hz"; "" without a sweep.  `but`: paths that are left out  (n_but) */
const char *plot_sweep_text(const cJSON *cell, int n_but, const char *const *but, char text[PLOT_TEXT]);

/* ---- the page ---- */

/* Writes the title and, below it, the study's name and `more`. */
void plot_head(struct plot *plot, const char *title, const char *more);
void plot_note(struct plot *plot, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* One function for each row of the table, and whether a result has it. */
#define X(name)                          \
	void plot_##name(struct plot *plot); \
	bool plot_has_##name(const cJSON *result);
FIGURES(X)
#undef X

#endif
