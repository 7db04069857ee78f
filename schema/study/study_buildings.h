/* study_buildings.h - rows of buildings in a study: what their members mean together. */
#ifndef STUDY_BUILDINGS_H
#define STUDY_BUILDINGS_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/fields.h"

void study_buildings_check(const struct pound_study *study, struct problems *problems);

/* Storeys of a building in the cell that has the fewest of them, or the most. */
int study_storeys_least(const struct pound_study *study, int building);
int study_storeys_most(const struct pound_study *study, int building);

/* Why varying a field of a row would change nothing, NULL when it may. */
const char *study_row_idle(const struct pound_study *study, const struct field *field,
                           struct field_place place);

/* Puts an output in place of each place's. */
void study_places_lay(struct pound_study *study);

#endif
