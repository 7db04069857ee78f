/* groups.h - worker groups as tests see them: processes that their launchers note in a file, blocks in a checkpoint. */
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
/* Waits until none of them is there, which fails the test after limit_ms; how long that took [s]. */
double groups_gone(const char *file, int limit_ms);
int groups_port(void); /* a port of loopback that nobody listens on */
/* Blocks that workers ran, as `pound run` reports. */
int groups_blocks(const char *err);
/* Records of a checkpoint: how many blocks have one, and how many have more. */
void groups_records(const char *checkpoint, int *n_once, int *n_more);

#endif
