/* solver.c - the table of solvers.  To add a solver, add its function and a row to solvers[]. */
#include "engine/solver/solver.h"

#include "engine/exact/chain.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

// all forms of contact force except rigid impacts
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

#define MARCHED \
	(POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS | POUND_CHAIN_ACCELERATIONS | POUND_CHAIN_FORCES)

static const struct solver {
	const char *name;
	const char *text; /* one line of documentation */
	void (*run)(const struct pound_solver *, const struct pound_task *, struct pound_task_result *,
	            const atomic_bool *stop);
	void (*run_row)(const struct pound_solver *, const struct pound_chain_task *, struct pound_chain_result *,
	                void *scratch, const atomic_bool *stop);
	bool tolerance, step; /* settings that the solver reads */
	unsigned rows;        /* results for rows of buildings: bits of enum pound_chain_asked */
	bool observed;        /* calls the observers of a task */
	bool portable;        /* the same bytes on every processor */
	// forms of contact force that the solver can integrate, for pairs and for rows; every solver takes every law
	bool forces[POUND_FORCES], row_forces[POUND_FORCES];
} solvers[] = {
    // run NULL: exact_run and pound_chain_lanes, which take many tasks at once
    [POUND_SOLVER_EVENT] = {"event", "exact to rounding: from event to event, by maps and power series", NULL,
                            NULL, .tolerance = true, .rows = MARCHED | POUND_CHAIN_ENERGY, .observed = true,
                            .portable = true, .forces = EVERY, .row_forces = EVERY},
    {"newmark", "average acceleration, one step for all", pound_fixed_newmark, pound_fixed_newmark_row,
     .step = true, .rows = MARCHED, .portable = true, .forces = BRANCHES, .row_forces = BRANCHES},
    {"central_difference", "central differences, one step for all", pound_fixed_central,
     pound_fixed_central_row, .step = true, .rows = MARCHED, .portable = true, .forces = BRANCHES,
     .row_forces = BRANCHES},
    [POUND_SOLVER_ADAPTIVE] = {"adaptive",
                               "GSL's Runge-Kutta-Prince-Dormand (8, 9), restarted at every event",
                               pound_adaptive_run, pound_adaptive_row, .tolerance = true,
                               .rows = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS, .forces = EVERY,
                               .row_forces = BRANCHES},
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

/* Whether a solver can integrate a form of contact force between two oscillators.
 *
 * Callers that run another solver on the scene of a study, for a check or an estimate, assert this. */
bool pound_solver_takes_force(int row, enum pound_force force)
{
	return solver_at(row)->forces[force];
}

/* Whether a solver can integrate a form of contact force in rows of buildings. */
bool pound_solver_takes_row_force(int row, enum pound_force force)
{
	return solver_at(row)->row_forces[force];
}

/* Whether a solver gives all requested results of rows of buildings (bits of enum pound_chain_asked). */
bool pound_solver_gives_of_rows(int row, unsigned asked)
{
	return (asked & ~solver_at(row)->rows) == 0;
}

bool pound_solver_is_observed(int row)
{
	return solver_at(row)->observed;
}

/* Whether result bytes are the same on every processor; GSL's steppers call functions of the C library that are not. */
bool pound_solver_is_portable(int row)
{
	return solver_at(row)->portable;
}

bool pound_solver_takes_tolerance(int row)
{
	return solver_at(row)->tolerance;
}

bool pound_solver_takes_step(int row)
{
	return solver_at(row)->step;
}

/* The contact law of a task; a linear one is Kelvin-Voigt, model 0. */
struct pound_contact_law pound_task_law(const struct pound_task *task)
{
	if (task->force != POUND_FORCE_LINEAR)
		return task->law;
	return (struct pound_contact_law){
	    .stiffness = task->contact_stiffness, .dashpot = task->contact_damping, .tension = task->tension};
}

/* ---- the exact solver ---- */

/* Two oscillators as a chain of two one-story buildings, or of one building beside a wall; masses are over the left mass.
 *
 * Given    task   at rest at the start
 * Returns  chain  must not be moved: chain->task points into it
 */
void pound_pair_chain(const struct pound_task *task, struct pound_pair_chain *chain)
{
	const bool wall = task->mass_ratio == 0;
	const double mass[POUND_OSCILLATORS] = {1, wall ? 1 : 1 / task->mass_ratio};
	const int right = wall ? POUND_CHAIN_GROUND : 1, n = wall ? 1 : POUND_OSCILLATORS;
	memset(chain, 0, sizeof *chain); // chains are compared byte by byte
	for (int w = 0; w < 2; w++)
		chain->link.floor[1][w] = right;
	chain->link.weight[0][0] = chain->link.weight[1][0] = 1;
	chain->link.law = pound_task_law(task);
	chain->link.gap = task->gap;
	for (int i = 0; i < n; i++) {
		const struct pound_task_body *body = &task->bodies[i];
		assert(body->u == 0 && body->v == 0 && body->drive == 1);
		struct pound_chain_floor *floor = &chain->floors[i];
		floor->mass = mass[i];
		floor->dashpot = body->damping * mass[i];
		floor->story = body->backbone;
		floor->story.stiffness *= mass[i];
		floor->base = true;
	}
	chain->task = (struct pound_chain_task){.ground = task->ground,
	                                        .n_samples = task->n_samples,
	                                        .time_step = task->time_step,
	                                        .n_floors = n,
	                                        .n_links = 1,
	                                        .floors = chain->floors,
	                                        .links = &chain->link};
}

/* The result of a pair from the result of a chain.
 *
 * Given    rows     n_floors floors and one contact; 1 floor: the right body is a wall, which does not move
 */
void pound_pair_result(const struct pound_task *task, const struct pound_chain_result *rows, int n_floors,
                       struct pound_task_result *result)
{
	const double *row = rows->links;
	*result = (struct pound_task_result){.status = rows->status,
	                                     .impulse_max = row[POUND_LINK_IMPULSE_MAX],
	                                     .contact_time = row[POUND_LINK_TIME],
	                                     .contacts = (int64_t)row[POUND_LINK_CONTACTS],
	                                     .energy_residual = rows->energy_residual,
	                                     .first_contact = row[POUND_LINK_FIRST_TIME],
	                                     .first_speed = row[POUND_LINK_FIRST_SPEED]};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const bool moves = i < n_floors;
		const double *floor = rows->floors + i * POUND_FLOOR_MEASURES;
		result->displacement_max[i] = !task->bodies[i].followed ? NAN
		                              : moves                   ? floor[POUND_FLOOR_DRIFT_MAX]
		                                                        : 0;
		result->u[i] = moves ? floor[POUND_FLOOR_END_U] : 0;
		result->v[i] = moves ? floor[POUND_FLOOR_END_V] : 0;
	}
}

/* Runs a pair as a chain and converts the result to the result of a pair. */
static void chain_run(const struct pound_task *task, struct pound_task_result *result, void *scratch,
                      const atomic_bool *stop)
{
	struct pound_pair_chain chain;
	pound_pair_chain(task, &chain);
	chain.task.asked = POUND_CHAIN_DRIFTS | (task->accounted ? POUND_CHAIN_ENERGY : 0);
	struct pound_chain_result rows = {.floors = chain.floor_measures[0], .links = chain.link_measures};
	pound_chain_lanes(0, &chain.task, &rows, 1, scratch, stop);
	pound_pair_result(task, &rows, chain.task.n_floors, result);
}

bool pound_runs_as_chain(const struct pound_task *task)
{
	return task->contact && task->force != POUND_FORCE_LINEAR;
}

/* Runs tasks with the exact solver: consecutive pairs together in lanes, all other tasks as chains. */
static void exact_run(const struct pound_task *tasks, struct pound_task_result *results, int n, void *scratch,
                      const atomic_bool *stop)
{
	for (int j = 0, end; j < n && !pound_stopped(stop); j = end) {
		for (end = j; end < n && !pound_runs_as_chain(&tasks[end]); end++)
			continue;
		if (end > j)
			pound_exact_lanes(0, &tasks[j], &results[j], end - j, scratch, stop);
		else
			chain_run(&tasks[end], &results[end], scratch, stop), end++;
	}
}

static_assert((int)POUND_CHAIN_SCRATCH <= (int)POUND_EXACT_SCRATCH,
              "a chain fits into the work space of pairs");

/* Runs tasks, with the method and the setting of a solver.
 *
 * Given    solver    -       -       row of the solvers, and its setting
 *          tasks     (n)     -       see task.h
 *          stop      -       -       checked throughout; NULL: never
 * Returns  results   (n)     -       each with its status
 * Status   POUND_STOPPED  stop was set: the results must not be used
 *          POUND_NOMEM    out of memory in one task: the results must not be used
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
		exact_run(tasks, results, n, scratch, stop);
	for (int j = 0; row->run && j < n && !pound_stopped(stop); j++) {
		row->run(solver, &tasks[j], &results[j], stop);
		results[j].energy_residual = NAN; // only the exact solver computes the energy balance
		if (results[j].status == POUND_NOMEM)
			return POUND_NOMEM;
	}
	return pound_stopped(stop) ? POUND_STOPPED : POUND_OK;
}

/* Runs rows of buildings, with the method and the setting of a solver.
 *
 * Given    solver    -       -       row of the solvers, and its setting
 *          tasks     (n)     -       see chain.h; only results that the solver gives are requested
 *          stop      -       -       checked throughout; NULL: never
 * Returns  results   (n)     -       each with its status
 * Status   POUND_STOPPED  stop was set: the results must not be used
 *          POUND_NOMEM    out of memory in one task: the results must not be used
 * Memory   scratch: the most bytes that pound_chain_scratch returns for the forms of contact force, 64-byte aligned
 * Test     unit_solver_rows
 */
enum pound_status pound_solver_rows(const struct pound_solver *solver, const struct pound_chain_task *tasks,
                                    struct pound_chain_result *results, int n, void *scratch,
                                    const atomic_bool *stop)
{
	const struct solver *row = solver_at(solver->method);
	if (!row->run_row)
		pound_chain_lanes(0, tasks, results, n, scratch, stop);
	for (int j = 0; row->run_row && j < n && !pound_stopped(stop); j++) {
		for (int k = 0; k < tasks[j].n_links; k++)
			assert(row->row_forces[pound_contact_force(tasks[j].links[k].law.model)]);
		row->run_row(solver, &tasks[j], &results[j], scratch, stop);
		if (results[j].status == POUND_NOMEM)
			return POUND_NOMEM;
	}
	return pound_stopped(stop) ? POUND_STOPPED : POUND_OK;
}
