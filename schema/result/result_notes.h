/* result_notes.h - notes about estimates of indices outside [0, 1] or outside their intervals. */
#ifndef RESULT_NOTES_H
#define RESULT_NOTES_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

enum { RESULT_NOTES = 8, RESULT_NOTES_NAMES = 512 };

/* Names of the estimates to which each note applies. */
struct result_notes {
	char names[RESULT_NOTES][RESULT_NOTES_NAMES];
};

/* Properties of an estimate that decide which notes apply. */
struct result_notes_source {
	bool lost;       /* the noise-corrected variance, its denominator, may be 0 */
	bool large_only; /* no note for a sampling error that the interval shows */
};

void result_notes_init(struct result_notes *notes);
void result_notes_add(struct result_notes *notes, const char *name, const struct pound_estimate *estimate,
                      struct result_notes_source source);
void result_notes_write(struct writer *w, const struct result_notes *notes);

void result_failures(struct writer *w, const struct pound_work *work); /* reasons of failed runs */

/* Writes the members "note" and "notes" of an output; nothing without a note. */
void result_notes_output(struct writer *w, const struct pound_indices *indices);

#endif
