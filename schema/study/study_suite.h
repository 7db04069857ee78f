/* study_suite.h - the recorded ground motions of a suite in a document.  For the files of schema/study only. */
#ifndef STUDY_SUITE_H
#define STUDY_SUITE_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

/* One element of the records: the motion, and where its samples come from. */
struct suite_record {
	struct pound_record record;
	const char *file;   /* NULL: samples are in the document, or the file is named by its SHA-256 */
	const char *sha256; /* of the file, hexadecimal; NULL: not given */
	const char *unit;   /* for a file that names none; NULL: not given */
	int channel;        /* which acceleration of a file with several, from 1; 0: not given */
};

/* The source of a record, kept with the study. */
struct suite_source {
	double *samples; /* on the heap, freed with the study; NULL: samples are in the study's block */
	struct study_source named;
};

/* Most records that a document of that length can have. */
int suite_room(size_t length);

/* Checks all records and their scale. */
void study_suite_check(const struct pound_study *study, struct problems *problems);

#endif
