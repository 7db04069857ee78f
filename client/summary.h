/* summary.h - a sensitivity result on one screen of 24 lines of 80 columns. */
#ifndef SUMMARY_H
#define SUMMARY_H

#include "schema/json/json_pointer.h"

/* The indices to quote, their uncertainty and its causes, and how to see the other results. */
void summary_print(const struct reading *result);

#endif
