/* checkpoint.h - the finished blocks of one study in a file, so that `pound run` resumes after an interruption. */
#ifndef CHECKPOINT_H
#define CHECKPOINT_H

#include <stdbool.h>

#include "engine/pound.h"

struct checkpoint;

typedef void checkpoint_restored(void *to, int block);

/* Opens or creates the file, and restores its blocks; NULL: failed, reported on stderr. */
struct checkpoint *checkpoint_open(const char *path, const struct pound_study *study, struct pound_run *run,
                                   checkpoint_restored *restored, void *to);
void checkpoint_add(struct checkpoint *checkpoint, int block,
                    const double *values);            /* any thread; NULL: none */
void checkpoint_sync(struct checkpoint *checkpoint);  /* added blocks are on the disk */
bool checkpoint_close(struct checkpoint *checkpoint); /* false: a write failed; reported on stderr */

#endif
