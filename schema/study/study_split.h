/* study_split.h - studies whose number of signals the engine chooses: signals "auto". */
#ifndef STUDY_SPLIT_H
#define STUDY_SPLIT_H

#include "schema/study/reader.h"

/* What such a study needs, and may not have. */
void reader_split(struct reader *reader, const cJSON *document);

/* Puts in the least number of signals, and the rows that the runs allow with it: no choice asks for more. */
void study_split_lay(struct pound_study *study, struct problems *problems);

#endif
