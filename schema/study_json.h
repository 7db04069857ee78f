/* study_json.h - the bytes of a study document -> the study, checked to the last member.
 *
 * Any thread. */
#ifndef STUDY_JSON_H
#define STUDY_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/pound.h"
#include "schema/problems.h"

/* What one study may ask for. */
enum {
	STUDY_SAMPLES_MAX = 10000000, /* samples of one ground motion */
	STUDY_RUNS_MAX = 10000000,    /* pounding runs of one study */
	STUDY_CELLS_MAX = 10000,      /* combinations of sweep values */
	STUDY_HASH_SIZE = 65,         /* characters of a study hash and its zero */
};

/* The study on the heap, one owner, for study_free; NULL with every problem in `problems` (status says which kind). */
struct pound_study *study_from_json(const char *text, size_t length, struct problems *problems);
void study_free(struct pound_study *study);

const char *study_kind_name(int kind);            /* "response", "sensitivity"; NULL past the last */
int study_cells(const struct pound_study *study); /* combinations of sweep values, 1 without a sweep */
int64_t
study_runs(const struct pound_study *study); /* pounding runs it asks for, before anything is shared */
double study_samples(const struct pound_study *study); /* samples of its longest ground motion */

/* The scene of one cell: the study's with that combination of sweep values. */
void study_cell(const struct pound_study *study, int cell, struct pound_scene *scene);

/* SHA-256 in hex over the study's meaning: all defaults filled in; names, order and spelling do not count. */
bool study_hash(const struct pound_study *study, char hex[STUDY_HASH_SIZE]); /* false: out of memory */

#endif
