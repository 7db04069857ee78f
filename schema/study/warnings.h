/* warnings.h - warnings of values that are valid but probably not intended. */
#ifndef WARNINGS_H
#define WARNINGS_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Writes member "warnings", objects {pointer, detail}, if there are any.  result NULL: only warnings known before a run. */
void warnings_write(struct writer *w, const struct pound_study *study, const struct pound_result *result);

#endif
