/* baseline_loop.h - two linear oscillators that pound, by a plain time-stepping loop: the baseline for the engine's
 * speed.
 *
 * Never linked into the product.  SI units; calls may run in any thread. */
#ifndef BASELINE_LOOP_H
#define BASELINE_LOOP_H

#include "engine/exact/task.h"

struct baseline_result {
	double displacement_max; /* of the left body [m] */
	double impulse_max;      /* largest integral of F/m1 over one contact [m/s] */
	int contacts;
};

/* `steps` steps of equal length from each sample to the next; the task's laws are linear, its contact ends at no
 * overlap. */
struct baseline_result baseline_plain(const struct pound_task *task, int steps);
struct baseline_result baseline_tuned(const struct pound_task *task, int steps);

#endif
