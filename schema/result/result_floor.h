/* result_floor.h - the members of a result that are floor spectra. */
#ifndef RESULT_FLOOR_H
#define RESULT_FLOOR_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Members of the object that is open in w: all of a study of spectra, or those of an output that is an ordinate. */
void result_floor_spectra(struct writer *w, const struct pound_study *study,
                          const struct pound_result *result);
void result_floor_ordinate(struct writer *w, const struct pound_study *study,
                           const struct pound_indices *indices, int output);

#endif
