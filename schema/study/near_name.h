/* near_name.h - how much two names differ, to guess which one was meant. */
#ifndef NEAR_NAME_H
#define NEAR_NAME_H

#include <stdbool.h>

/* Distance of two names: letters to change, or 1 if one name is a prefix of the other. */
int near_name_distance(const char *a, const char *b);
/* Whether a name at this distance is probably a misspelling. */
bool near_name(int distance, const char *name);

#endif
