/* pair_peaks.h - peaks of two bodies' motion against each other, for outputs that read them.
 *
 * An observer of the exact solver (task.h): the motion between two instants is one linear system. */
#ifndef PAIR_PEAKS_H
#define PAIR_PEAKS_H

#include "engine/exact/task.h"

struct pound_pair_peaks {
	struct pound_task_observer observer;
	struct pound_task_body bodies[POUND_OSCILLATORS];
	double rate;                       /* of the faster body [rad/s] */
	struct pound_instant_of_task from; /* the last instant */
	// so far
	double closing, opening; /* largest u_1 - u_2 and u_2 - u_1 outside of contacts, 0 at rest [m] */
	double approach;         /* largest rate of u_1 - u_2 at the start of a contact [m/s] */
};

/* Begins to observe a task, whose observer it becomes. */
void pound_pair_peaks_start(struct pound_pair_peaks *peaks, struct pound_task *task);

#endif
