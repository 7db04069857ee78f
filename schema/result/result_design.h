/* result_design.h - the rows a sensitivity result is of, and why there are so many. */
#ifndef RESULT_DESIGN_H
#define RESULT_DESIGN_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

enum { RESULT_NOTE_SIZE = 300 };

/* What there is to say about a design before it is run; false: nothing. */
bool result_design_note(const struct pound_study *study, char *text, size_t size);

void result_design(struct writer *w, const struct pound_study *study, const struct pound_result *result);

#endif
