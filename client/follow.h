/* follow.h - a study on the server, watched until it has ended. */
#ifndef FOLLOW_H
#define FOLLOW_H

#include "client/wire.h"

/* Draws the bar until the study has ended.  `last` is the last status object, freed by the caller in any case.
 * OUTCOME_STUDY_FAILED: said on stderr why. */
enum outcome follow_study(struct wire *wire, const char *id, struct wire_reply *last);

/* Whether a study has failed or was cancelled, by what the server says now; false where it does not say. */
bool follow_failed(struct wire *wire, const char *id);

#endif
