/* study_size.h - checks a study against the limits of its size.  For study_check.c; the sizes are in study_json.h. */
#ifndef STUDY_SIZE_H
#define STUDY_SIZE_H

#include "engine/pound.h"
#include "schema/json/problems.h"

/* Combinations of sweep values, possibly above the limit. */
double study_size_cells(const struct pound_study *study);

/* Time steps of the shortest and the longest ground motion. */
void study_size_steps(const struct pound_study *study, double *least, double *most);

/* Checks that the design starts with enough rows for intervals. */
void study_size_check_rows(const struct pound_study *study, struct problems *problems);

/* Checks runs, samples and steps of all cells; the numbers of cells and rows must be valid. */
void study_size_check(const struct pound_study *study, struct problems *problems);

#endif
