/* result_design.h - the rows a sensitivity result is of, and why there are so many. */
#ifndef RESULT_DESIGN_H
#define RESULT_DESIGN_H

#include "engine/pound.h"
#include "schema/writer.h"

void result_design(struct writer *w, const struct pound_study *study, const struct pound_result *result);

#endif
