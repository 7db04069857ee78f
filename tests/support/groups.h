/* groups.h - observes worker groups in tests: process ids that their launchers write to a file, blocks in a checkpoint. */
#ifndef GROUPS_H
#define GROUPS_H

#include <stdbool.h>
#include <sys/types.h>

enum { GROUPS_PIDS_MAX = 64 };

double groups_now(void); /* [s] monotonic */
void groups_write(const char *path, const char *text);
/* The processes that a file lists; returns how many. */
int groups_pids(const char *file, pid_t pids[GROUPS_PIDS_MAX]);
/* Waits until a file lists n processes, which fails the test after a minute. */
void groups_wait(const char *file, int n, pid_t pids[GROUPS_PIDS_MAX]);
bool groups_is_gone(pid_t pid);
/* Waits until all these processes have exited, at most limit_ms, else the test fails; returns the time it took [s]. */
double groups_gone(const char *file, int limit_ms);
int groups_port(void); /* a free port of loopback */
/* Blocks that workers ran, as `pound run` reports. */
int groups_blocks(const char *err);
/* Records of a checkpoint: numbers of blocks with one record and with more. */
void groups_records(const char *checkpoint, int *n_once, int *n_more);

#endif
