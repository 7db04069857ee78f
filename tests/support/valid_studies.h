/* valid_studies.h - valid studies drawn at random, and the time that they take. */
#ifndef VALID_STUDIES_H
#define VALID_STUDIES_H

#include <stdint.h>

#include "engine/pound.h"

enum { VALID_STUDY_SIZE = 4096 };

struct pound_study *valid_study(uint64_t seed, char *text, int *drawn);
double valid_study_taken(const struct pound_study *study, double most); /* [s] of CPU time */

#endif
