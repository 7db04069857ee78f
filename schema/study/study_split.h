/* study_split.h - studies whose number of signals the engine chooses: signals "auto". */
#ifndef STUDY_SPLIT_H
#define STUDY_SPLIT_H

#include "schema/study/reader.h"

/* Checks the members that signals "auto" requires and excludes. */
void reader_split(struct reader *reader, const cJSON *document);

/* Fills in the least number of signals and the rows that the runs allow with it: no other number of signals allows more rows. */
void study_split_lay(struct pound_study *study, struct problems *problems);

#endif
