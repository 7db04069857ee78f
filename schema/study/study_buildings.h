/* study_buildings.h - rows of buildings in a study: checks between their members. */
#ifndef STUDY_BUILDINGS_H
#define STUDY_BUILDINGS_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/fields.h"

void study_buildings_check(const struct pound_study *study, struct problems *problems);

/* Fewest and most storeys of a building in any cell. */
int study_storeys_least(const struct pound_study *study, int building);
int study_storeys_most(const struct pound_study *study, int building);
/* Whether they are known in spite of the problems found. */
bool study_storeys_known(const struct pound_study *study, int building, const struct problems *problems);

/* Index of the building that a path names although the row has fewer; -1: none. */
int study_building_beyond(const struct pound_study *study, const char *path, const struct problems *problems);

/* Why varying a field of a row would change nothing; NULL: it may vary. */
const char *study_row_idle(const struct pound_study *study, const struct field *field,
                           struct field_place place);

/* Replaces outputs of floors and contacts by one output per place or contact. */
void study_places_lay(struct pound_study *study);

#endif
