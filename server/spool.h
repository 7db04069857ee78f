/* spool.h - long answers in unnamed temporary files, so that a slow reader keeps none in memory.  Any thread. */
#ifndef SPOOL_H
#define SPOOL_H

#include <stdatomic.h>
#include <stddef.h>

#include "server/reply.h"

enum { SPOOL_LONG = 256 * 1024 /* [bytes] from which an answer is spooled */ };

struct spools {
	struct store *store; /* the files are beside its database */
	int most;            /* files that may be open */
	atomic_int n;        /* files that are open */
};

int spool_open(struct spools *spools, size_t n); /* an empty file for n bytes; -1: not possible now */
void spool_close(struct spools *spools, int file);
void spool_reply(struct spools *spools, struct reply *reply); /* moves a long body into a file, if possible */

#endif
