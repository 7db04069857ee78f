/* study_json.h - reads a study document in JSON into a study and checks every member.
 *
 * Any thread. */
#ifndef STUDY_JSON_H
#define STUDY_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/pound.h"
#include "schema/json/problems.h"

struct writer;

/* Limits of one study. */
enum {
	STUDY_SAMPLES_MAX = 10000000,  /* samples of one ground motion */
	STUDY_RUNS_MAX = 10000000,     /* pounding runs of one study */
	STUDY_VALUES_MAX = 1000,       /* values of a discrete distribution */
	STUDY_CELLS_MAX = 10000,       /* combinations of sweep values */
	STUDY_AT_ONCE_MAX = 50000000,  /* samples of ground motion for one row in all cells: 400 MB per worker */
	STUDY_TRIALS_MAX = 100000,     /* runs of one convergence study */
	STUDY_FREQUENCIES_MAX = 10000, /* frequencies of one spectrum */
	STUDY_HISTORIES_MAX = 250000,  /* samples of all signals with time histories: some 10 rows each */
	STUDY_ORDINATES_MAX = 5000000, /* frequencies of the spectra of all signals */
	STUDY_STEPS_MAX = 1000000,     /* steps of a solver in one sample interval */
	STUDY_HASH_SIZE = 65,          /* bytes of a study hash, terminating zero included */
	STUDY_RECORDS_MAX = 1000,      /* records of a suite */
	STUDY_SUITE_SAMPLES_MAX = 20000000, /* samples of all records of a suite: 160 MB */
	STUDY_WHY_SIZE = 256,
	STUDY_FILE_SIZE = 32, /* bytes that study_record_file writes at most */
};
#define STUDY_WORK_MAX 1e12 /* samples of ground motion of all runs, about a day on one core */

/* A file of a recorded ground motion. */
struct study_source {
	const char *file;             /* path relative to the folder of the study; NULL: not known */
	char sha256[STUDY_HASH_SIZE]; /* of the file, hexadecimal; "": not known */
};

/* Reads the files of recorded ground motions that a document names. */
struct study_files {
	/* The contents on the heap, zero-terminated; NULL: failed, and `why` is the reason. */
	char *(*read)(const void *with, const struct study_source *of, size_t *length, char why[STUDY_WHY_SIZE]);
	const void *with;
};

struct study_document {
	const char *text; /* not necessarily zero-terminated */
	size_t length;
	const struct study_files *files; /* NULL: files cannot be read */
	bool
	    design; /* read only its design: a sensitivity study, possibly without scene (then `elsewhere` is set) */
};

/* The study on the heap, to be freed by study_free; NULL: failed, see the list and the status in `problems`. */
struct pound_study *study_from_document(const struct study_document *document, struct problems *problems);
struct pound_study *study_from_json(const char *text, size_t length, struct problems *problems);
struct pound_study *study_design_from_json(const char *text, size_t length, struct problems *problems);
void study_free(struct pound_study *study);

/* Whether a document names files of recorded ground motions.  Copies of such a document for other machines: with the samples in
 * place of the file names, or with the SHA-256 beside each name; on the heap (NULL: out of memory). */
bool study_names_files(const char *text, size_t length);
char *study_inline(const struct study_document *document, const struct pound_study *study, size_t *length);
char *study_name_hashes(const struct study_document *document, const struct pound_study *study,
                        size_t *length);

/* The reverse: a copy with file names in place of samples; and the file name of record k. */
char *study_with_files(const struct study_document *document, const struct pound_study *study,
                       size_t *length);
void study_record_file(int k, char file[STUDY_FILE_SIZE]);

/* The file from which a record of a suite was read; NULL: its samples are in the document. */
const struct study_source *study_source_of(const struct pound_study *study, int record);

const char *study_kind_name(int kind);            /* "response", "sensitivity", ...; NULL past the last */
int study_cells(const struct pound_study *study); /* combinations of sweep values, 1 without a sweep */
int64_t
study_runs(const struct pound_study *study); /* pounding runs requested, shared ones counted each time */
double study_samples(const struct pound_study *study); /* samples of its longest ground motion */
double study_steps(
    const struct pound_study *study); /* most steps of a run, mean over trials; adaptive: its samples */

/* The scene of one cell: the study's scene with the cell's combination of sweep values. */
void study_cell(const struct pound_study *study, int cell, struct pound_scene *scene);
/* The same, with own copies of buildings and contacts in `memory` (pound_row_bytes): study_cell leaves these unvaried. */
void study_cell_row(const struct pound_study *study, int cell, void *memory, struct pound_scene *scene);
double study_cell_sweep(const struct pound_study *study, int cell, int sweep); /* value of a sweep */

/* Writes a varied value as in a document: a number, the name of a choice, true or false. */
void study_value(struct writer *writer, const char *name, const char *path, double value);
const char *study_choice(const char *path, double value); /* name, or "true", "false"; NULL: a number */

/* SHA-256 of the study with all defaults filled in: names, order of members and number formats do not matter. */
void study_digest(const void *bytes, size_t n, char hex[STUDY_HASH_SIZE]);   /* SHA-256, hexadecimal digits */
bool study_hash(const struct pound_study *study, char hex[STUDY_HASH_SIZE]); /* false: out of memory */

#endif
