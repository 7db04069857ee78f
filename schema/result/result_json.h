/* result_json.h - writes results, samples, histories and ground motions as JSON, CSV, NumPy and PEER files.
 *
 * Every function returns zero-terminated bytes on the heap, which the caller frees; NULL: out of memory.
 * The bytes depend on study and result only, except the last member of the JSON, on its own line that starts with
 * `  "timing":`.  After `grep -v '^  "timing":'` two runs of one study compare equal.  Any thread. */
#ifndef RESULT_JSON_H
#define RESULT_JSON_H

#include <stddef.h>

#include "engine/pound.h"

struct timing {
	double wall_s, cpu_s; /* [s] */
	int threads;
};

/* timing NULL: no member "timing" */
char *result_to_json(const struct pound_study *study, const struct pound_result *result,
                     const struct timing *timing, size_t *length);

/* Write members of a sensitivity result: an index with its interval; the mean output given each input, nothing if the first input
 * has no curve. */
struct writer;
void result_estimate(struct writer *w, const char *name, const struct pound_estimate *estimate);
void result_curves(struct writer *w, const struct pound_study *study, const struct pound_curve *curves);

/* Tables of results; a kind of result has some of them: lists of every output with inputs, checks of a growing design; gaps of
 * every cell or contact, fragility curves; modes of buildings, signals, and of a row their stories and contacts; means and
 * recorded ground motions. */
// clang-format off
#define RESULT_TABLES(X) \
	X(inputs) X(second_order) X(closed) X(groups) X(ratios) X(conditional_means) X(stopping) \
	X(pounding) X(gaps) X(rules) X(gap_needed) X(fragility) X(return_periods) X(modes) X(signals) X(storeys) X(contacts) \
	X(outputs) X(records)
// clang-format on

/* A result as CSV, from the JSON of result_to_json: the table of that name, empty if the result has none; NULL: one row
 * per cell, output and input of a sensitivity study, per cell and signal of a response, per cell and gap of a separation, ... */
char *result_to_csv(const char *json, size_t json_length, const char *table, size_t *length);
size_t result_csv_cell(const char *csv, const char *end, char *cell, size_t size,
                       char *sign); /* next cell; returns its bytes, delimiter included */

/* Whether a study has samples: sensitivity runs, requested histories, or contacts of responses; and whether it has the latter two,
 * which are computed by running the study again. */
bool samples_exist(const struct pound_study *study);
bool histories_exist(const struct pound_study *study);

/* All samples of a sensitivity study (no other kind), inputs and outputs: by cell, row i, samples A_i, B_i,
 * AB_i of each input.  Columns: sweep paths, `row`, `sample`, input names, NAME and NAME.variance of each output. */
char *samples_to_csv(const struct pound_study *study, const struct pound_run *run, size_t *length);
char *samples_to_npy(const struct pound_study *study, const struct pound_run *run, size_t *length);

/* Histories of one signal, or of all (-1).  Floor spectrum study: the motion of both oscillators, at the samples, before and after
 * every event, and inside contacts.  Response study: the contacts in all cells.  NULL: out of memory, the run was stopped, or there
 * are too many rows; in the last case `reason` is a sentence, else NULL. */
char *histories_to_csv(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason);
char *histories_to_npy(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason);

/* The ground motions of one sample of a study with a scene.  Columns: signal, time_s, acceleration_m_s2. */
struct motion_choice {
	struct pound_place place;           /* cell, row, sample, and the first signal */
	bool one;                           /* only that signal; false: all signals */
	int signals;                        /* of the study */
	const char *name;                   /* of the study */
	const struct pound_record *records; /* of the study's suite; NULL: no suite */
};

/* Chooses the motions of a place; signal -1: all.  false: no such place, and the reason in `why`. */
bool motions_choose(const struct pound_study *study, const struct pound_run *run, struct pound_place place,
                    struct motion_choice *choice, char why[static 100]);
int64_t motions_samples(const struct pound_run *run,
                        const struct motion_choice *choice); /* of all chosen motions */

char *motions_to_csv(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
char *motions_to_npy(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
char *motions_to_peer(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
/* Pseudo-accelerations of the motions, one row per signal and period; for a suite with record and factor. */
struct periods;
char *motions_to_spectra(const struct pound_run *run, const struct motion_choice *choice,
                         const struct periods *periods, size_t *length);

#endif
