/* study_json.h - the bytes of a study document -> the study, checked to the last member.
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

/* What one study may ask for. */
enum {
	STUDY_SAMPLES_MAX = 10000000, /* samples of one ground motion */
	STUDY_RUNS_MAX = 10000000,    /* pounding runs of one study */
	STUDY_VALUES_MAX = 1000,      /* of a discrete distribution */
	STUDY_CELLS_MAX = 10000,      /* combinations of sweep values */
	STUDY_AT_ONCE_MAX =
	    50000000, /* samples of ground motion of all cells and samples of one row: 400 MB a worker */
	STUDY_TRIALS_MAX = 100000,     /* runs of one convergence study */
	STUDY_FREQUENCIES_MAX = 10000, /* of one spectrum */
	STUDY_HISTORIES_MAX = 250000,  /* samples of all signals whose histories are wanted: some 10 rows each */
	STUDY_ORDINATES_MAX = 5000000, /* frequencies of the spectra of all signals */
	STUDY_STEPS_MAX = 1000000,     /* of a solver in one sample interval */
	STUDY_HASH_SIZE = 65,          /* characters of a study hash and its zero */
	STUDY_RECORDS_MAX = 1000,      /* of a suite */
	STUDY_SUITE_SAMPLES_MAX = 20000000, /* of all of them: 160 MB */
	STUDY_WHY_SIZE = 256,
	STUDY_FILE_SIZE = 32, /* of study_record_file */
};
#define STUDY_WORK_MAX 1e12 /* samples of ground motion of all runs, about a day on one core */

/* A file of a recorded ground motion. */
struct study_source {
	const char *file;             /* its path, from the folder of the study; NULL: not known */
	char sha256[STUDY_HASH_SIZE]; /* of its bytes, hexadecimal; "": not known */
};

/* How the files of recorded ground motions are read that a document names. */
struct study_files {
	/* The bytes, on the heap and with a 0 behind them; NULL: `why` says why there are none. */
	char *(*read)(const void *with, const struct study_source *of, size_t *length, char why[STUDY_WHY_SIZE]);
	const void *with;
};

struct study_document {
	const char *text; /* need not end with a zero */
	size_t length;
	const struct study_files *files; /* NULL: cannot be read */
	bool
	    design; /* for its design alone: a sensitivity study, which may have no scene (then `elsewhere` is set) */
};

/* The study on the heap, one owner, for study_free; NULL: every problem is in `problems`, its status says why. */
struct pound_study *study_from_document(const struct study_document *document, struct problems *problems);
struct pound_study *study_from_json(const char *text, size_t length, struct problems *problems);
struct pound_study *study_design_from_json(const char *text, size_t length, struct problems *problems);
void study_free(struct pound_study *study);

/* Whether a document names files of recorded ground motions.  Of one that does, for others who cannot read them: the document
 * with their samples in place of the names, or with their SHA-256 beside these; on the heap (NULL: out of memory). */
bool study_names_files(const char *text, size_t length);
char *study_inline(const struct study_document *document, const struct pound_study *study, size_t *length);
char *study_name_hashes(const struct study_document *document, const struct pound_study *study,
                        size_t *length);

/* The reverse: names of files in place of samples; and the name of the file of record k. */
char *study_with_files(const struct study_document *document, const struct pound_study *study,
                       size_t *length);
void study_record_file(int k, char file[STUDY_FILE_SIZE]);

/* The file that a record of a suite was read from; NULL: its samples are in the document. */
const struct study_source *study_source_of(const struct pound_study *study, int record);

const char *study_kind_name(int kind);            /* "response", "sensitivity", ...; NULL past the last */
int study_cells(const struct pound_study *study); /* combinations of sweep values, 1 without a sweep */
int64_t
study_runs(const struct pound_study *study); /* pounding runs it asks for, before anything is shared */
double study_samples(const struct pound_study *study); /* samples of its longest ground motion */
double study_steps(
    const struct pound_study *study); /* mean steps of a run, at most; its samples where each is one */

/* The scene of one cell: the study's with that combination of sweep values. */
void study_cell(const struct pound_study *study, int cell, struct pound_scene *scene);
/* The same with buildings and contacts of its own in memory  (pound_row_bytes), as study_cell leaves them unvaried. */
void study_cell_row(const struct pound_study *study, int cell, void *memory, struct pound_scene *scene);
double study_cell_sweep(const struct pound_study *study, int cell, int sweep); /* the sweep's value there */

/* A varied value as a document has it: a number, the name of a choice, true or false. */
void study_value(struct writer *writer, const char *name, const char *path, double value);
const char *study_choice(const char *path, double value); /* its name, or "true", "false"; NULL: a number */

/* SHA-256 in hex over the study's meaning: all defaults filled in; names, order and spelling do not count. */
void study_digest(const void *bytes, size_t n, char hex[STUDY_HASH_SIZE]);   /* SHA-256, hexadecimal digits */
bool study_hash(const struct pound_study *study, char hex[STUDY_HASH_SIZE]); /* false: out of memory */

#endif
