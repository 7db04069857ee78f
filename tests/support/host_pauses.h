/* host_pauses.h - times at which a virtual machine was paused because the host used its processors.
 *
 * A thread on each processor, if permitted with real-time priority (SCHED_FIFO), wakes every two milliseconds; when it was not
 * woken, no thread was. */
#ifndef HOST_PAUSES_H
#define HOST_PAUSES_H

#include <stdbool.h>

void host_pauses_start(void);
void host_pauses_stop(void);

/* Whether a processor was paused at some time from `from` to `to` [s of the wall clock], or shortly before: each pause counts
 * for twice its length, because of the work that piled up. */
bool host_pauses_between(double from, double to);

double host_pauses_share(void); /* fraction of the time that a processor was paused, after host_pauses_stop */

#endif
