/* stop.h - the flag by which a caller ends what takes long. */
#ifndef STOP_H
#define STOP_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* Whether the caller wants no more of it: what follows a motion asks this between batches, stretches or samples. */
static inline bool pound_stopped(const atomic_bool *stop)
{
	return stop && atomic_load_explicit(stop, memory_order_relaxed);
}

#endif
