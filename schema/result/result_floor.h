/* result_floor.h - floor spectra as members of a result. */
#ifndef RESULT_FLOOR_H
#define RESULT_FLOOR_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Write members of the object that is open in w: all of a floor spectrum study, or the members of an output that is an ordinate. */
void result_floor_spectra(struct writer *w, const struct pound_study *study,
                          const struct pound_result *result);
void result_floor_ordinate(struct writer *w, const struct pound_study *study,
                           const struct pound_indices *indices, int output);

#endif
