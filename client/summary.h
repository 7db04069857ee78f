/* summary.h - a sensitivity result on one screen. */
#ifndef SUMMARY_H
#define SUMMARY_H

#include "schema/json/json_pointer.h"

/* Each total index from its lowest to its highest over the cells, and the accuracy of the whole. */
void summary_print(const struct reading *result);

/* A line of the tables that there are besides. */
void summary_more(const struct reading *result);

/* Why the interval of more rows is wider than that of fewer, if it is: half widths and rows. */
void summary_wider(double earlier, double rows_earlier, double last, double rows);

#endif
