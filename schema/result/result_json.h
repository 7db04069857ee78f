/* result_json.h - a study's result -> the bytes a client gets.
 *
 * Every function returns bytes on the heap for the caller to free, zero-terminated too; NULL: out of memory.
 * They are a function of study and result alone, but for the last member, on a line of its own that starts with
 * `  "timing":`.  `grep -v '^  "timing":'` makes two runs of one study compare equal.  Any thread. */
#ifndef RESULT_JSON_H
#define RESULT_JSON_H

#include <stddef.h>

#include "engine/pound.h"

struct timing {
	double wall_s, cpu_s; /* [s] */
	int threads;
};

/* timing NULL: without */
char *result_to_json(const struct pound_study *study, const struct pound_result *result,
                     const struct timing *timing, size_t *length);

/* Members of a sensitivity result: an index with its interval; the mean output given each input of the study, nothing where
 * the first has no value. */
struct writer;
void result_estimate(struct writer *w, const char *name, const struct pound_estimate *estimate);
void result_curves(struct writer *w, const struct pound_study *study, const struct pound_curve *curves);

/* Tables of results, each of those that have it: lists of every output with inputs, and the looks of a design that grew; gaps of every
 * cell or contact, fragility curves; signals, means and recorded ground motions. */
// clang-format off
#define RESULT_TABLES(X) \
	X(inputs) X(second_order) X(closed) X(groups) X(ratios) X(conditional_means) X(stopping) \
	X(pounding) X(gaps) X(rules) X(gap_needed) X(fragility) X(return_periods) X(signals) X(outputs) X(records)
// clang-format on

/* The same result as CSV, from the bytes of result_to_json: the table of that name, empty when it has none; NULL: one row
 * per cell, output and input of a sensitivity study, per cell and signal of a response, per cell and gap of a separation, ... */
char *result_to_csv(const char *json, size_t json_length, const char *table, size_t *length);
size_t result_csv_cell(const char *csv, const char *end, char *cell, size_t size,
                       char *sign); /* its next cell; the bytes of it and of the sign behind it */

/* Whether a study has samples: its runs, the histories that it asks for, or the contacts of its responses; and whether they are made
 * by running it once more: the latter two. */
bool samples_exist(const struct pound_study *study);
bool histories_exist(const struct pound_study *study);

/* Every input row of a sensitivity study (of no other) and its outputs: cells in order, rows i, samples A_i, B_i,
 * AB_i of each input.  Columns: sweep paths, `row`, `sample`, input names, NAME and NAME.variance of each output. */
char *samples_to_csv(const struct pound_study *study, const struct pound_run *run, size_t *length);
char *samples_to_npy(const struct pound_study *study, const struct pound_run *run, size_t *length);

/* Of a signal, or -1: of every one: the motion of both oscillators of a study of spectra, at the samples, on both sides of every
 * event, and inside contacts; the contacts of a study of responses in all its cells.  NULL: out of memory, the run is stopped, or there are too many rows,
 * which is a sentence in `reason`, else NULL. */
char *histories_to_csv(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason);
char *histories_to_npy(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason);

/* The ground motions of one sample of a study with a scene.  Columns: signal, time_s, acceleration_m_s2. */
struct motion_choice {
	struct pound_place place;           /* its signal is read where one is chosen */
	bool one;                           /* that signal alone; false: all */
	int signals;                        /* of the study */
	const char *name;                   /* of the study */
	const struct pound_record *records; /* of its suite; NULL: it has none */
};

/* The motions of a place; one without a signal (-1) has all of them.  false: there is no such place, and why. */
bool motions_choose(const struct pound_study *study, const struct pound_run *run, struct pound_place place,
                    struct motion_choice *choice, char why[static 100]);
int64_t motions_samples(const struct pound_run *run,
                        const struct motion_choice *choice); /* of all that are chosen */

char *motions_to_csv(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
char *motions_to_npy(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
char *motions_to_peer(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
/* Their pseudo-accelerations, a row for each signal and period; of a suite with its record and factor. */
struct periods;
char *motions_to_spectra(const struct pound_run *run, const struct motion_choice *choice,
                         const struct periods *periods, size_t *length);

#endif
