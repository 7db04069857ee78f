/* result_separation.h - the members of a result that say how wide a gap has to be. */
#ifndef RESULT_SEPARATION_H
#define RESULT_SEPARATION_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Members of the object that is open in w: those of a cell, and behind all cells the fragility curves. */
void result_separation_cell(struct writer *w, const struct pound_study *study,
                            const struct pound_scene *scene, const struct pound_result *result, int cell);
void result_separation_fragility(struct writer *w, const struct pound_study *study,
                                 const struct pound_result *result);

#endif
