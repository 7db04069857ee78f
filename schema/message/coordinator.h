/* coordinator.h - worker groups in other processes: their launchers, their connections, the blocks assigned to them.
 *
 * One thread per group: starts the launcher when there are blocks to run, waits for its connection, assigns blocks and
 * receives their values.  When the connection ends, it gives back the blocks that were not run.  Further groups are those that
 * others start: they come and go at any time. */
#ifndef COORDINATOR_H
#define COORDINATOR_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "schema/message/launcher.h"
#include "schema/message/message.h"

enum { COORDINATOR_GROUPS_MAX = 256 }; /* that launchers start; as many that others start */

/* A study whose blocks are assigned; it outlives the blocks that are taken. */
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

/* What the coordinator asks, in its threads; `group` is from 1. */
struct coordinator_source {
	void *of;
	bool (*wanted)(void *of); /* there are blocks for worker groups */
	/* takes one, of a study that is not among the refused; false: there is none now */
	bool (*take)(void *of, int group, const uint64_t refused[], int n_refused,
	             struct coordinator_block *block);
	void (*back)(void *of, int group, const struct coordinator_block *block); /* it was not run */
	/* it was run: values (pound_run_block_size), or a status that is not POUND_OK */
	void (*done)(void *of, int group, const struct coordinator_block *block, const struct message *message,
	             const double *values);
	bool (*lives)(void *of, uint64_t study); /* its blocks are still wanted */
	void (*log)(const char *line);
};

struct coordinator;

/* NULL: no memory or no threads.  What the launch points to outlives the coordinator, which closes its socket. */
struct coordinator *coordinator_start(const struct launch *launch, const struct coordinator_source *source);
void coordinator_wake(
    struct coordinator *coordinator); /* there are blocks, or studies have ended; signal-safe */
int coordinator_groups(const struct coordinator *coordinator);  /* connected now */
long coordinator_blocks(const struct coordinator *coordinator); /* blocks run by them */
void coordinator_stop(struct coordinator *coordinator);         /* ends connections and launchers */

#endif
