/* study_spectrum.h - the floor spectra that a study asks for: what must hold, and an output for each ordinate. */
#ifndef STUDY_SPECTRUM_H
#define STUDY_SPECTRUM_H

#include "engine/pound.h"
#include "schema/json/problems.h"

enum { STUDY_OUTPUT_SIZE = 64 };

void study_spectrum_check(const struct pound_study *study, struct problems *problems);

/* After the check: drops a spectrum that is not asked for, and puts an output in place of each ordinate. */
void study_spectrum_lay(struct pound_study *study);

/* The name of an output among all of a study's: an ordinate's has its frequency, "floor_spectrum.2.5_hz". */
const char *study_output_name(const struct pound_study *study, int output, char name[STUDY_OUTPUT_SIZE]);

#endif
