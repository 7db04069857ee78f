/* motion_reply.h - the ground motions of a study and their response spectra. */
#ifndef MOTION_REPLY_H
#define MOTION_REPLY_H

#include "server/http.h"
#include "server/stored_run.h"

/* The answer to a request for the ground motions of a study, which may have any status. */
struct reply motions_of(const struct request *request, const struct stored_run *opened);

#endif
