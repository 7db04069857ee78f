/* host_pauses.h - when the machine itself did nothing: a virtual one whose processors the host has taken.
 *
 * A thread on each processor, before all others where it may (SCHED_FIFO), wakes every two milliseconds; when it was not
 * woken, nobody was. */
#ifndef HOST_PAUSES_H
#define HOST_PAUSES_H

#include <stdbool.h>

void host_pauses_start(void);
void host_pauses_stop(void);

/* Whether a processor was away at some time from `from` to `to` [s of the wall clock], or shortly before: as much later as
 * it was away, what had piled up meanwhile is counted to it. */
bool host_pauses_between(double from, double to);

double host_pauses_share(void); /* part of the time for which a processor was away, after host_pauses_stop */

#endif
