/* result_suite.h - recorded ground motions of a result -> JSON.  For the files of schema/result only. */
#ifndef RESULT_SUITE_H
#define RESULT_SUITE_H

#include "engine/pound.h"
#include "schema/json/json_writer.h"

/* Member "suite": the records and their factors; nothing of another excitation. */
void result_suite(struct writer *w, const struct pound_study *study, const struct pound_result *result);

/* Members of a signal: which record it is. */
void result_suite_signal(struct writer *w, const struct pound_suite_signal *signal);

#endif
