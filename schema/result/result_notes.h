/* result_notes.h - what there is to say about estimates of indices, in words that are true of their numbers. */
#ifndef RESULT_NOTES_H
#define RESULT_NOTES_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

enum { RESULT_NOTES = 8, RESULT_NOTES_NAMES = 512 };

/* Names of the estimates that each sentence is about. */
struct result_notes {
	char names[RESULT_NOTES][RESULT_NOTES_NAMES];
};

/* Where an estimate comes from. */
struct result_notes_source {
	bool lost;       /* the variance that it is a share of may be 0, once the noise is taken away */
	bool large_only; /* a sampling error that its interval shows needs no words */
};

void result_notes_init(struct result_notes *notes);
void result_notes_add(struct result_notes *notes, const char *name, const struct pound_estimate *estimate,
                      struct result_notes_source source);
void result_notes_write(struct writer *w, const struct result_notes *notes);

void result_failures(struct writer *w, const struct pound_work *work); /* why runs have no result */

#endif
