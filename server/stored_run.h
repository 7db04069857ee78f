/* stored_run.h - the run of a stored study, with its stored blocks. */
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
	bool passing;         /* opening failed for lack of memory or a disk error: a retry may work */
	bool leftovers;       /* some stored blocks cannot be used: damaged, or of another version */
	double cpu_s, wall_s; /* spent on the stored blocks [s] */
};

/* NULL, or a sentence that says why it cannot be opened; see `passing`.  Close it in either case.  `stop` is the stop flag of
 * the run. */
const char *stored_run_open(struct store *store, int64_t id, int n_workers, const atomic_bool *stop,
                            struct stored_run *opened);
int stored_run_left(const struct stored_run *opened); /* blocks of the current rows that are not stored */
void stored_run_close(struct stored_run *opened);
double stored_run_clock(void); /* CPU time of this thread [s] */

#endif
