/* study_size.h - limits of how much a study may ask for.  For study_check.c; what it asks for: study_json.h. */
#ifndef STUDY_SIZE_H
#define STUDY_SIZE_H

#include "engine/pound.h"
#include "schema/json/problems.h"

/* Combinations of sweep values, however many. */
double study_size_cells(const struct pound_study *study);

/* Time steps of the shortest and the longest ground motion. */
void study_size_steps(const struct pound_study *study, double *least, double *most);

/* Rows enough for intervals, from the start. */
void study_size_check_rows(const struct pound_study *study, struct problems *problems);

/* Runs, samples and steps of all cells; the number of cells and of rows is known to be right. */
void study_size_check(const struct pound_study *study, struct problems *problems);

#endif
