/* warnings.h - what is valid in a study and probably not meant. */
#ifndef WARNINGS_H
#define WARNINGS_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Member "warnings": objects {pointer, detail}; nothing where there are none.  Result NULL: what is seen before it is run. */
void warnings_write(struct writer *w, const struct pound_study *study, const struct pound_result *result);

#endif
