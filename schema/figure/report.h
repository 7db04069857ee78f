/* report.h - a result as one self-contained HTML page: figures, tables, notes, accuracy, runs that were left out.
 * For readers without the program.  Any thread. */
#ifndef REPORT_H
#define REPORT_H

#include "schema/figure/figure.h"

/* The page, (length) bytes on the heap, zero-terminated; `study` is the study document, NULL: not known.
 * NULL: not a result, or out of memory. */
char *report_html(const struct figure_source *source, const char *study, size_t n_study, size_t *length);

#endif
