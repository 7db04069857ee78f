/* exact.c - the exact event-driven solver, at the widest lane count of this machine.
 *
 *   tasks ──> queue of each kind of step ──> batch of W simulations ──> W lanes
 *                 ^                                                       │
 *                 └──────────── simulations that need another kind ───────┘   until the queues are empty
 *
 * A task is a scene under a ground motion (task.h).  exact.inl runs the lanes and includes, in this order:
 *
 *   simulation.inl    state of one simulation in memory
 *   free_motion.inl   whole samples without contact, by precomputed maps
 *   contact_substep.inl   whole substeps of contact, by precomputed maps
 *   series.inl        motion between two events as power series in time; first roots of a guard on it
 *   contact_map.inl   maps over many contact substeps at once
 *   energy.inl        the work done in a step
 *   step.inl          one step up to an event
 *   observer.inl      reports the instants of a simulation to its observer
 *   next_step.inl     one simulation at a time: its start, its next step and branch, its end
 *   shared_start.inl  tasks that differ only in their laws, run as one until the first of them may yield
 *   batch.inl         loads simulations into lanes and stores them
 *   scheduler.inl     the queues
 *
 * It is compiled once for each lane count: exact_w8.c, exact_w4.c, exact_w1.c, exact_portable.c. */
#include "engine/exact/task.h"
#include "engine/numeric/cpu_width.h"

typedef void march(const struct pound_task *, struct pound_task_result *, int n, void *scratch,
                   const atomic_bool *stop);

/* Runs tasks at a lane count; 0: the widest available.
 *
 * Given    stop     polled throughout: once it is set the results are invalid; NULL: never stopped
 * Returns  value    false: this machine has no such lanes, nothing was run
 *          results  one for each task  (n)
 */
bool pound_exact_lanes(int lanes, const struct pound_task *tasks, struct pound_task_result *results, int n,
                       void *scratch, const atomic_bool *stop)
{
	static march *const run[POUND_WIDTHS] = {pound_exact_w8, pound_exact_w4, pound_exact_w1,
	                                         pound_exact_portable};
	int width = pound_dispatch_width(lanes);
	if (width >= 0)
		run[width](tasks, results, n, scratch, stop);
	return width >= 0;
}
