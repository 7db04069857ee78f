/* study_spectrum.h - floor spectra of a study: checks, and one output per ordinate (frequency). */
#ifndef STUDY_SPECTRUM_H
#define STUDY_SPECTRUM_H

#include "engine/pound.h"
#include "schema/json/problems.h"

enum { STUDY_OUTPUT_SIZE = 64 };

void study_spectrum_check(const struct pound_study *study, struct problems *problems);

/* After the check: removes a spectrum that is not requested, and makes one output of each ordinate. */
void study_spectrum_lay(struct pound_study *study);

/* The name of an output, unique in the study: with the frequency of an ordinate, "floor_spectrum.2.5_hz". */
const char *study_output_name(const struct pound_study *study, int output, char name[STUDY_OUTPUT_SIZE]);

#endif
