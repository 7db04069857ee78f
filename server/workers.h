/* workers.h - the threads that run studies. */
#ifndef WORKERS_H
#define WORKERS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "engine/pound.h"
#include "schema/message/launcher.h"
#include "server/store.h"

struct work;

/* memory_max: estimated memory of all running studies together [bytes]; NULL: no memory or no threads */
struct work *work_start(struct store *store, int n_workers, double time_max, double cpu_max,
                        int64_t memory_max, const struct launch *launch);
int work_groups(const struct work *work);        /* worker groups that are connected */
long work_group_blocks(const struct work *work); /* blocks that they have run */

/* A view of a running study: a run of its own, which shares the values of the stored blocks. */
struct work_view {
	struct work *work;
	struct job *job; /* NULL: the view is closed */
	const struct pound_study *study;
	struct pound_run *run;
	int rows_done;  /* at the start of the design */
	int n_reducers; /* threads that may reduce at once */
};

/* false: the study is not in memory, not sampled, or out of memory; else close it before work_stop, by work_unview */
bool work_view(struct work *work, int64_t id, int n_reducers, const atomic_bool *stop,
               struct work_view *view);
void work_unview(struct work_view *view);

void work_wake(struct work *work);             /* a study was queued */
void work_drop(struct work *work, int64_t id); /* a study was cancelled or deleted */
/* Unfinished studies stay in the store; `alone`: nobody else uses work, so it is freed; false: it is not, and may be in use. */
bool work_stop(struct work *work, bool alone);

#endif
