/* stop.h - the flag by which a caller stops a long computation. */
#ifndef STOP_H
#define STOP_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* Whether the caller has requested a stop; NULL: never.  Solvers check the flag between batches, intervals or samples. */
static inline bool pound_stopped(const atomic_bool *stop)
{
	return stop && atomic_load_explicit(stop, memory_order_relaxed);
}

#endif
