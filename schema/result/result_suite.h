/* result_suite.h - recorded ground motions as members of a result.  For the files of schema/result only. */
#ifndef RESULT_SUITE_H
#define RESULT_SUITE_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Writes member "suite", the records and their factors, if the excitation is a suite. */
void result_suite(struct writer *w, const struct pound_study *study, const struct pound_result *result);

/* Writes the record and factor of a signal. */
void result_suite_signal(struct writer *w, const struct pound_suite_signal *signal);

#endif
