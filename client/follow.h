/* follow.h - follows a study on the server until it has ended. */
#ifndef FOLLOW_H
#define FOLLOW_H

#include "client/wire.h"

/* Draws the bar until the study has ended.  `last` is the last status object, freed by the caller in any case.
 * OUTCOME_STUDY_FAILED: reported on stderr. */
enum outcome follow_study(struct wire *wire, const char *id, struct wire_reply *last);

/* Whether a study has failed or was cancelled, by its present status on the server; false if that is not known. */
bool follow_failed(struct wire *wire, const char *id);

#endif
