/* results.h - results for tests, read as JSON. */
#ifndef RESULTS_H
#define RESULTS_H

#include "engine/pound.h"
#include "schema/json/json_pointer.h"

/* The study of a valid design, for an external model. */
struct pound_study *results_design(const char *document);

/* The result of a study that must succeed; the caller closes it. */
struct reading *results_of_study(const char *document);

/* The indices of a valid design and valid lines of model outputs; the caller closes them. */
struct reading *results_of_lines(const char *document, const char *csv);

#endif
