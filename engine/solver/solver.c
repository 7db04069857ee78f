/* solver.c - the ways to integrate a scene.  Adding one: its function and its row in solvers[]. */
#include "engine/solver/solver.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>

// forms of contact force that have branches: all but velocities that jump
#define BRANCHES                                                                                  \
	{                                                                                             \
		[POUND_FORCE_LINEAR] = true, [POUND_FORCE_STRAIGHT] = true, [POUND_FORCE_PRODUCT] = true, \
		[POUND_FORCE_POWER] = true                                                                \
	}

#define EVERY                                                                                     \
	{                                                                                             \
		[POUND_FORCE_LINEAR] = true, [POUND_FORCE_STRAIGHT] = true, [POUND_FORCE_PRODUCT] = true, \
		[POUND_FORCE_POWER] = true, [POUND_FORCE_IMPACT] = true                                   \
	}

static const struct solver {
	const char *name;
	const char *text; /* one line of documentation */
	void (*run)(const struct pound_solver *, const struct pound_task *, struct pound_task_result *,
	            const atomic_bool *stop);
	bool tolerance, step; /* the settings it takes */
	bool rows;            /* it integrates rows of buildings */
	bool forces
	    [POUND_FORCES]; /* forms of contact force that it can integrate; it takes every law, as branches */
} solvers[] = {
    // many tasks at once
    [POUND_SOLVER_EVENT] = {"event", "exact to rounding: from event to event, by maps and power series", NULL,
                            .tolerance = true, .rows = true, .forces = {[POUND_FORCE_LINEAR] = true}},
    {"newmark", "average acceleration, one step for all", pound_fixed_newmark, .step = true,
     .forces = BRANCHES},
    {"central_difference", "central differences, one step for all", pound_fixed_central, .step = true,
     .forces = BRANCHES},
    [POUND_SOLVER_ADAPTIVE] = {"adaptive",
                               "GSL's Runge-Kutta-Prince-Dormand (8, 9), restarted at every event",
                               pound_adaptive_run, .tolerance = true, .forces = EVERY},
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

const char *pound_solver_text(int row)
{
	return solver_at(row)->text;
}

/* Whether a solver can integrate a form of contact force.
 *
 * A check or an estimate that runs a solver on a study's scene asserts this: it may not run another model. */
bool pound_solver_takes_force(int row, enum pound_force force)
{
	return solver_at(row)->forces[force];
}

bool pound_solver_takes_rows(int row)
{
	return solver_at(row)->rows;
}

bool pound_solver_takes_tolerance(int row)
{
	return solver_at(row)->tolerance;
}

bool pound_solver_takes_step(int row)
{
	return solver_at(row)->step;
}

/* The contact of a task: a linear one is Kelvin-Voigt's, which is row 0. */
struct pound_contact_law pound_task_law(const struct pound_task *task)
{
	if (task->force != POUND_FORCE_LINEAR)
		return task->law;
	return (struct pound_contact_law){
	    .stiffness = task->contact_stiffness, .dashpot = task->contact_damping, .tension = task->tension};
}

/* Runs tasks, with the method and the setting of a solver.
 *
 * Given    solver    -       -       row of the solvers, and the setting it takes
 *          tasks     (n)     -       see task.h
 *          stop      -       -       looked at throughout; NULL: never
 * Returns  results   (n)     -       each with a status of its own
 * Status   POUND_STOPPED  stop was set: the results are not to be used
 *          POUND_NOMEM    there was no memory for one of them, so too
 * Memory   scratch: POUND_EXACT_SCRATCH bytes, 64-byte aligned
 * Test     unit_fixed_step
 */
enum pound_status pound_solver_run(const struct pound_solver *solver, const struct pound_task *tasks,
                                   struct pound_task_result *results, int n, void *scratch,
                                   const atomic_bool *stop)
{
	const struct solver *row = solver_at(solver->method);
	for (int j = 0; j < n; j++)
		assert(!tasks[j].contact || row->forces[tasks[j].force]);
	if (!row->run)
		pound_exact_lanes(0, tasks, results, n, scratch, stop);
	for (int j = 0; row->run && j < n && !pound_stopped(stop); j++) {
		row->run(solver, &tasks[j], &results[j], stop);
		results[j].energy_residual = NAN; // only the march keeps the balance
		if (results[j].status == POUND_NOMEM)
			return POUND_NOMEM;
	}
	return pound_stopped(stop) ? POUND_STOPPED : POUND_OK;
}
