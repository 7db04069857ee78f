/* study_separation.h - studies of the gap needed: checks between their members, and their own outputs. */
#ifndef STUDY_SEPARATION_H
#define STUDY_SEPARATION_H

#include "schema/study/reader.h"

/* Reads a list of numbers of /separation. */
void reader_separation(struct reader *reader, const struct field *field, const cJSON *node, char *base);

/* Refuses members of a design that have no effect without inputs. */
void reader_undesigned(struct reader *reader, const cJSON *document);

void study_separation_check(const struct pound_study *study, struct problems *problems);

/* Fills in defaults, and puts the outputs that every separation study has before the requested ones. */
void study_separation_lay(struct pound_study *study);

#endif
