/* report.h - a result as one HTML page that needs nothing else: figures, tables, notes, accuracy, what was left out.
 * For those who have not the program.  Any thread. */
#ifndef REPORT_H
#define REPORT_H

#include "schema/figure/figure.h"

/* The page, (length) bytes on the heap and a NUL; `study` is the study document, NULL: not known.
 * NULL: the bytes are no result of a study, or out of memory. */
char *report_html(const struct figure_source *source, const char *study, size_t n_study, size_t *length);

#endif
