/* stored_run.h - a study's run with the blocks that are stored. */
#ifndef STORED_RUN_H
#define STORED_RUN_H

#include <stdatomic.h>
#include <stdbool.h>

#include "engine/pound.h"
#include "server/store.h"

/* A study as stored: its document read, its run made, its stored blocks restored. */
struct stored_run {
	char *document; /* (length) bytes */
	size_t length;
	struct pound_study *study;
	struct pound_run *run;
	bool *stored;         /* (pound_run_blocks_most) */
	bool passing;         /* it could not be opened for want of memory or by a fault of the disk */
	bool leftovers;       /* there are blocks that cannot be used: damaged, or another version's */
	double cpu_s, wall_s; /* spent on the stored ones [s] */
};

/* NULL, or a sentence why it cannot be opened, and whether that may pass; to be closed in either case.  `stop` is the run's
 * flag to stop by. */
const char *stored_run_open(struct store *store, int64_t id, int n_workers, const atomic_bool *stop,
                            struct stored_run *opened);
int stored_run_left(const struct stored_run *opened); /* blocks of the current rows that are not stored */
void stored_run_close(struct stored_run *opened);
double stored_run_clock(void); /* CPU time of this thread [s] */

#endif
