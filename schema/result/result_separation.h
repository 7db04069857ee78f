/* result_separation.h - gaps needed, probabilities of pounding and fragility curves as members of a result. */
#ifndef RESULT_SEPARATION_H
#define RESULT_SEPARATION_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Write members of the object that is open in w: of a cell, and after all cells the fragility curves. */
void result_separation_cell(struct writer *w, const struct pound_study *study,
                            const struct pound_scene *scene, const struct pound_result *result, int cell);
void result_separation_fragility(struct writer *w, const struct pound_study *study,
                                 const struct pound_result *result);

#endif
