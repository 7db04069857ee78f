/* output_label.h - an output of a result with its place, in words. */
#ifndef OUTPUT_LABEL_H
#define OUTPUT_LABEL_H

#include "schema/json/json_pointer.h"

enum { OUTPUT_LABEL = 256 };

/* "impulse at 2 Hz, building 1, story 2"; `output` is the JSON Pointer of the output. */
const char *output_label(const struct reading *result, const char *output, char text[OUTPUT_LABEL]);

#endif
