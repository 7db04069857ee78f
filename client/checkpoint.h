/* checkpoint.h - the finished blocks of one study in a file, so that `pound run` goes on after an interruption. */
#ifndef CHECKPOINT_H
#define CHECKPOINT_H

#include <stdbool.h>

#include "engine/pound.h"

struct checkpoint;

typedef void checkpoint_restored(void *to, int block);

/* Opens or makes the file, and restores what is in it; NULL: said on stderr why not. */
struct checkpoint *checkpoint_open(const char *path, const struct pound_study *study, struct pound_run *run,
                                   checkpoint_restored *restored, void *to);
void checkpoint_add(struct checkpoint *checkpoint, int block,
                    const double *values);            /* any thread; NULL: none */
void checkpoint_sync(struct checkpoint *checkpoint);  /* what was added is on the disk */
bool checkpoint_close(struct checkpoint *checkpoint); /* false: not all could be written; said on stderr */

#endif
