/* spool.h - long answers in files without names, so that no client who reads slowly keeps one in memory.  Any thread. */
#ifndef SPOOL_H
#define SPOOL_H

#include <stdatomic.h>
#include <stddef.h>

#include "server/reply.h"

enum { SPOOL_LONG = 256 * 1024 /* [bytes] of an answer that goes into one */ };

struct spools {
	struct store *store; /* beside whose database they are */
	int most;            /* that there may be */
	atomic_int n;        /* and are */
};

int spool_open(struct spools *spools, size_t n); /* an empty one for n bytes; -1: none can be had */
void spool_close(struct spools *spools, int file);
void spool_reply(struct spools *spools, struct reply *reply); /* puts a long body into one, if it can be */

#endif
