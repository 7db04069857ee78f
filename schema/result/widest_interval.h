/* widest_interval.h - how wide the widest interval of a sensitivity result is, in sentences for people. */
#ifndef WIDEST_INTERVAL_H
#define WIDEST_INTERVAL_H

#include "schema/json/json_pointer.h"

enum { WIDEST_TEXT = 2048 };

/* Each sentence is empty where there is nothing to say. */
struct widest_interval {
	char size[WIDEST_TEXT];     /* which it is, and the rows that would halve it */
	char narrower[WIDEST_TEXT]; /* why fewer rows had a narrower one, and which of them to quote */
};

void widest_interval_find(const struct reading *result, struct widest_interval *text);

#endif
