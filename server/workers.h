/* workers.h - the threads that run studies, and a study's run with the blocks that are stored. */
#ifndef WORK_H
#define WORK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "engine/pound.h"
#include "server/store.h"

/* A study as it stands in the store: its document read, its run made, its stored blocks restored. */
struct work_run {
	struct pound_study *study;
	struct pound_run *run;
	bool *stored;         /* (pound_run_blocks_most) */
	bool passing;         /* it could not be opened for want of memory or by a fault of the disk */
	bool leftovers;       /* there are blocks that cannot be used: damaged, or another version's */
	double cpu_s, wall_s; /* spent on the stored ones [s] */
};

/* NULL, or a sentence why it cannot be opened, and whether that may pass; to be closed in either case.  `stop` is the run's
 * flag to stop by. */
const char *work_open(struct store *store, int64_t id, int n_workers, const atomic_bool *stop,
                      struct work_run *opened);
int work_left(const struct work_run *opened); /* blocks of the rows in hand that are not stored */
void work_close(struct work_run *opened);

struct work;

/* the studies that run at a time take no more memory [bytes] by their estimates; NULL: no memory or no threads */
struct work *work_start(struct store *store, int n_workers, double time_max, int64_t memory_max);
void work_wake(struct work *work);             /* a study was queued */
void work_drop(struct work *work, int64_t id); /* a study was cancelled or deleted */
bool work_stop(
    struct work *work); /* what is unfinished stays in the store; false: a worker has not ended in time */

#endif
