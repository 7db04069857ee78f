/* solver.h - the solvers: all take the same tasks and give the same results.
 *
 * The head of each solver's file describes it; the exact solver is in engine/exact. */
#ifndef SOLVER_H
#define SOLVER_H

#include <stdatomic.h>

#include "engine/exact/chain.h"
#include "engine/exact/task.h"
#include "engine/pound.h"

/* rows of the exact solver and of the adaptive solver, an independent one */
enum { POUND_SOLVER_EVENT = 0, POUND_SOLVER_ADAPTIVE = 3 };

enum pound_status pound_solver_run(const struct pound_solver *solver, const struct pound_task *tasks,
                                   struct pound_task_result *results, int n, void *scratch,
                                   const atomic_bool *stop);

enum pound_status pound_solver_rows(const struct pound_solver *solver, const struct pound_chain_task *tasks,
                                    struct pound_chain_result *results, int n, void *scratch,
                                    const atomic_bool *stop);

bool pound_solver_gives_of_rows(int row, unsigned asked);

struct pound_contact_law pound_task_law(const struct pound_task *task); /* of the contact */

/* A pair as a chain, for forms of contact force that the exact solver of pairs does not have; must not be moved. */
struct pound_pair_chain {
	struct pound_chain_task task;
	struct pound_chain_floor floors[POUND_OSCILLATORS];
	struct pound_link link;
	double floor_measures[POUND_OSCILLATORS][POUND_FLOOR_MEASURES], link_measures[POUND_LINK_MEASURES];
};

bool pound_runs_as_chain(const struct pound_task *task);
void pound_pair_chain(const struct pound_task *task, struct pound_pair_chain *chain);
void pound_pair_result(const struct pound_task *task, const struct pound_chain_result *rows, int n_floors,
                       struct pound_task_result *result);

/* fixed_step.c */
double pound_fixed_step(double time_step, double step);
void pound_fixed_newmark(const struct pound_solver *solver, const struct pound_task *task,
                         struct pound_task_result *result, const atomic_bool *stop);
void pound_fixed_central(const struct pound_solver *solver, const struct pound_task *task,
                         struct pound_task_result *result, const atomic_bool *stop);

/* fixed_chain.c */
void pound_fixed_newmark_row(const struct pound_solver *solver, const struct pound_chain_task *task,
                             struct pound_chain_result *result, void *scratch, const atomic_bool *stop);
void pound_fixed_central_row(const struct pound_solver *solver, const struct pound_chain_task *task,
                             struct pound_chain_result *result, void *scratch, const atomic_bool *stop);

/* adaptive.c */
void pound_adaptive_run(const struct pound_solver *solver, const struct pound_task *task,
                        struct pound_task_result *result, const atomic_bool *stop);
void pound_adaptive_row(const struct pound_solver *solver, const struct pound_chain_task *task,
                        struct pound_chain_result *result, void *scratch, const atomic_bool *stop);

#endif
