/* result_design.h - the rows of a sensitivity result and why the design stopped there. */
#ifndef RESULT_DESIGN_H
#define RESULT_DESIGN_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

enum { RESULT_NOTE_SIZE = 300 };

/* A note about a design, known before it is run; false: none. */
bool result_design_note(const struct pound_study *study, char *text, size_t size);

void result_design(struct writer *w, const struct pound_study *study, const struct pound_result *result);

#endif
