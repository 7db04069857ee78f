/* coordinator.h - worker groups in other processes: launchers, connections and assigned blocks.
 *
 * One thread per group starts the launcher when there are blocks to run, waits for its connection, assigns blocks and
 * receives their values.  When the connection ends, it gives back the blocks that were not run.  Workers started by other means
 * (--worker-listen) form further groups, which connect and disconnect at any time. */
#ifndef COORDINATOR_H
#define COORDINATOR_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "schema/message/launcher.h"
#include "schema/message/message.h"

enum { COORDINATOR_GROUPS_MAX = 256 }; /* groups of launchers, and the same number of external groups */

/* A study whose blocks are assigned; it must outlive its taken blocks. */
struct coordinator_study {
	uint64_t id;
	const struct pound_study *study;
	struct pound_run *run;
	const char *document; /* (length) bytes */
	size_t length;
};

struct coordinator_block {
	const struct coordinator_study *study;
	int number;
};

/* Callbacks, called in the coordinator's threads; `group` counts from 1. */
struct coordinator_source {
	void *of;
	bool (*wanted)(void *of); /* whether there are blocks for worker groups */
	/* takes a block of a study that is not among the refused; false: none now */
	bool (*take)(void *of, int group, const uint64_t refused[], int n_refused,
	             struct coordinator_block *block);
	void (*back)(void *of, int group, const struct coordinator_block *block); /* not run */
	/* run: with values (pound_run_block_size), or with a status other than POUND_OK */
	void (*done)(void *of, int group, const struct coordinator_block *block, const struct message *message,
	             const double *values);
	bool (*lives)(void *of, uint64_t study); /* whether the study still needs its blocks */
	void (*log)(const char *line);
};

struct coordinator;

/* NULL: no memory or no threads.  The strings of launch must outlive the coordinator, which closes the socket of launch. */
struct coordinator *coordinator_start(const struct launch *launch, const struct coordinator_source *source);
void coordinator_wake(
    struct coordinator *coordinator); /* call if there are new blocks or ended studies; async-signal-safe */
int coordinator_groups(const struct coordinator *coordinator);  /* connected now */
long coordinator_blocks(const struct coordinator *coordinator); /* blocks run by all groups */
void coordinator_stop(struct coordinator *coordinator);         /* ends connections and launchers */

#endif
