/* solver.c - the ways to integrate a scene.  Adding one: its function and its row in solvers[]. */
#include "engine/solver/solver.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>

static const struct solver {
	const char *name;
	void (*run)(const struct pound_solver *, const struct pound_march_task *, struct pound_march_result *,
	            const atomic_bool *stop);
	bool tolerance, step; /* the settings it takes */
} solvers[] = {
    [POUND_SOLVER_EVENT] = {"event", NULL,
                            .tolerance = true}, // the march: many tasks at once, exact at any tolerance
    {"newmark", pound_fixed_newmark, .step = true},
    {"central_difference", pound_fixed_central, .step = true},
    [POUND_SOLVER_ADAPTIVE] = {"adaptive", pound_adaptive_run, .tolerance = true},
};

static_assert(sizeof solvers / sizeof solvers[0] == POUND_SOLVERS, "a row for each solver");

static const struct solver *solver_at(int row)
{
	return row >= 0 && row < (int)(sizeof solvers / sizeof solvers[0]) ? &solvers[row] : NULL;
}

const char *pound_solver_name(int row)
{
	const struct solver *solver = solver_at(row);
	return solver ? solver->name : NULL;
}

bool pound_solver_takes_tolerance(int row)
{
	return solver_at(row)->tolerance;
}

bool pound_solver_takes_step(int row)
{
	return solver_at(row)->step;
}

/* Runs tasks, with the method and the setting of a solver.
 *
 * Given    solver    -       -       row of the solvers, and the setting it takes
 *          tasks     (n)     -       see task.h
 *          stop      -       -       looked at throughout; NULL: never
 * Returns  results   (n)     -       each with a status of its own
 * Status   POUND_STOPPED  stop was set: the results are not to be used
 *          POUND_NOMEM    there was no memory for one of them, so too
 * Memory   scratch: POUND_MARCH_SCRATCH bytes, 64-byte aligned
 * Test     unit_fixed_step
 */
enum pound_status pound_solver_run(const struct pound_solver *solver, const struct pound_march_task *tasks,
                                   struct pound_march_result *results, int n, void *scratch,
                                   const atomic_bool *stop)
{
	const struct solver *row = solver_at(solver->method);
	if (!row->run)
		pound_march_lanes(0, tasks, results, n, scratch, stop);
	for (int j = 0; row->run && j < n && !pound_stopped(stop); j++) {
		row->run(solver, &tasks[j], &results[j], stop);
		results[j].energy_residual = NAN; // only the march keeps the balance
		if (results[j].status == POUND_NOMEM)
			return POUND_NOMEM;
	}
	return pound_stopped(stop) ? POUND_STOPPED : POUND_OK;
}
