/* study_suite.h - the recorded ground motions of a suite as a document has them.  For the files of schema/study only. */
#ifndef STUDY_SUITE_H
#define STUDY_SUITE_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

/* One element of the records: the motion, and where its samples come from. */
struct suite_record {
	struct pound_record record;
	const char *file;   /* NULL: its samples are in the document, or it is named by its SHA-256 */
	const char *sha256; /* of a file, hexadecimal; NULL: not given */
	const char *unit;   /* of a file that names none; NULL: not known */
	int channel;        /* of a file with several accelerations, from 1; 0: not chosen */
};

/* What the block of a study keeps of a record. */
struct suite_source {
	double *samples; /* on the heap, freed with the study; NULL: they are in its block */
	struct study_source named;
};

/* Records that a document of that length has at most. */
int suite_room(size_t length);

/* What must hold of all records together. */
void study_suite_check(const struct pound_study *study, struct problems *problems);

#endif
