/* study_separation.h - studies of how wide a gap has to be: what their members mean together, and their own outputs. */
#ifndef STUDY_SEPARATION_H
#define STUDY_SEPARATION_H

#include "schema/study/reader.h"

/* A list of numbers of /separation. */
void reader_separation(struct reader *reader, const struct field *field, const cJSON *node, char *base);

/* Refuses a design that is given for nothing, as there are no inputs. */
void reader_undesigned(struct reader *reader, const cJSON *document);

void study_separation_check(const struct pound_study *study, struct problems *problems);

/* Puts in what absent members mean, and the study's own outputs before those that it asks for. */
void study_separation_lay(struct pound_study *study);

#endif
