/* widest_interval.h - the widest interval of a sensitivity result, in sentences for people. */
#ifndef WIDEST_INTERVAL_H
#define WIDEST_INTERVAL_H

#include "schema/json/json_pointer.h"

enum { WIDEST_TEXT = 2048 };

/* A sentence that does not apply is empty. */
struct widest_interval {
	char size[WIDEST_TEXT];     /* its half-width and index, and the rows that would halve it */
	char narrower[WIDEST_TEXT]; /* why fewer rows had a narrower interval, and which interval to quote */
};

void widest_interval_find(const struct reading *result, struct widest_interval *text);

#endif
