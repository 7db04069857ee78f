/* request_keys.h - keys of numbers that identify ground motions and runs: equal keys are the same motion or run. */
#ifndef REQUEST_KEYS_H
#define REQUEST_KEYS_H

#include "engine/exact/task.h"
#include "engine/numeric/random.h"

enum { POUND_KEY = 27 }; /* doubles of a key, both of a motion and of a run */

/* equal keys share one number; numbers in the order of first registration */
struct pound_keys {
	int n, n_slots;
	double *keys; /* (capacity x POUND_KEY) */
	int *slots;   /* (n_slots), -1: empty */
};

void pound_keys_clear(struct pound_keys *keys);
int pound_keys_motion(struct pound_keys *keys, const struct pound_excitation *e, struct pound_stream noise,
                      bool halved);
int pound_keys_run(struct pound_keys *keys, int motion, const struct pound_task *task);

#endif
