/* workers.h - the threads that run studies. */
#ifndef WORKERS_H
#define WORKERS_H

#include <stdbool.h>
#include <stdint.h>

#include "schema/message/launcher.h"
#include "server/store.h"

struct work;

/* memory_max: estimated memory of all running studies together [bytes]; NULL: no memory or no threads */
struct work *work_start(struct store *store, int n_workers, double time_max, double cpu_max,
                        int64_t memory_max, const struct launch *launch);
int work_groups(const struct work *work);        /* worker groups that are connected */
long work_group_blocks(const struct work *work); /* blocks that they have run */
void work_wake(struct work *work);               /* a study was queued */
void work_drop(struct work *work, int64_t id);   /* a study was cancelled or deleted */
bool work_stop(
    struct work *work); /* unfinished studies stay in the store; false: a worker did not exit in time */

#endif
