/* near_name.h - how much two names differ, to guess which one was meant. */
#ifndef NEAR_NAME_H
#define NEAR_NAME_H

#include <stdbool.h>

/* Search for the name that was probably meant: near_name_begin, near_name_try for every choice, near_name_found. */
struct near_name_search {
	const char *name, *nearest;
	int distance; /* of the nearest choice so far */
};

struct near_name_search near_name_begin(const char *name);
void near_name_try(struct near_name_search *search, const char *choice); /* keeps the pointer */
const char *near_name_found(const struct near_name_search *search);      /* NULL: no choice is near */

/* Distance of two names: letters to change, or 1 if one name is a prefix of the other. */
int near_name_distance(const char *a, const char *b);
/* Whether a name at this distance is probably a misspelling. */
bool near_name(int distance, const char *name);

#endif
