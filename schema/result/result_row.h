/* result_row.h - responses of rows of buildings as members of a result. */
#ifndef RESULT_ROW_H
#define RESULT_ROW_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Writes the modes of all buildings; `scene` has the buildings of the cell. */
void result_row_modes(struct writer *w, const struct pound_scene *scene);

/* Writes the response to one signal; `scene` has the buildings of the cell. */
void result_row_signal(struct writer *w, const struct pound_scene *scene,
                       const struct pound_row_response *row);
bool result_row_moves(const struct pound_row_response *row, const struct pound_scene *scene);

/* Writes the place of an output; null for outputs without a place, if another output of the study has one. */
void result_row_place(struct writer *w, const struct pound_study *study, int output);

#endif
