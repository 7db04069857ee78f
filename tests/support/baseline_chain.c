/* baseline_chain.c - central differences with a fixed step for a row of shear buildings: forces of all stories and contacts, then
 * the next displacements.  Dashpots use the velocity half a step earlier. */
#include "tests/support/baseline_chain.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FLOORS = POUND_CHAIN_FLOORS };

struct loop {
	int n;
	double k[FLOORS], c[FLOORS], low[FLOORS], high[FLOORS], r[FLOORS], mass_damping[FLOORS], share[FLOORS];
	double inner[FLOORS], u[FLOORS + 1], before[FLOORS + 1], force[FLOORS + 1], drift[FLOORS], center[FLOORS],
	    top[FLOORS];
};

static void loop_start(struct loop *x, const struct pound_chain_task *task, double h)
{
	memset(x, 0, sizeof *x);
	x->n = task->n_floors;
	assert(x->n <= FLOORS);
	for (int i = 0; i < x->n; i++) {
		const struct pound_chain_floor *floor = &task->floors[i];
		x->k[i] = floor->story.stiffness;
		x->c[i] = floor->dashpot / h;
		x->high[i] = floor->story.yield;
		x->r[i] = floor->story.hardening;
		x->mass_damping[i] = floor->mass_damping * h;
		x->share[i] = h * h / floor->mass;
		x->inner[i] = floor->base ? 0 : 1;
		x->before[i + 1] = -0.5 * h * h * task->ground[0];
	}
}

/* Adds the forces of links in contact to the forces on floors. */
static void links_push(const struct pound_chain_task *task, struct loop *x, double h)
{
	for (int j = 0; j < task->n_links; j++) {
		const struct pound_link *l = &task->links[j];
		double p = -l->gap, q = 0;
		for (int side = 0; side < 2; side++)
			for (int k = 0; k < 2; k++) {
				const double weight = (side ? -1 : 1) * l->weight[side][k];
				const int i = l->floor[side][k] + 1;
				p += weight * x->u[i];
				q += weight * (x->u[i] - x->before[i]);
			}
		if (p <= 0)
			continue;
		const double force = l->law.stiffness * p + l->law.dashpot * q / h;
		for (int side = 0; side < 2; side++)
			for (int k = 0; k < 2; k++)
				if (l->floor[side][k] >= 0)
					x->force[l->floor[side][k]] -= (side ? -1 : 1) * l->weight[side][k] * force;
	}
}

static inline __attribute__((always_inline)) void stories_pull(struct loop *x, bool yields)
{
	for (int i = 0; i < x->n; i++) {
		const double d = x->u[i + 1] - x->inner[i] * x->u[i];
		const double rate = (x->u[i + 1] - x->before[i + 1]) - x->inner[i] * (x->u[i] - x->before[i]);
		double spring = x->k[i] * d;
		if (yields) {
			const double most = x->center[i] + x->high[i], least = x->center[i] - x->high[i];
			x->center[i] = d > most ? d - x->high[i] : d < least ? d + x->high[i] : x->center[i];
			spring -= (1 - x->r[i]) * x->k[i] * x->center[i];
		}
		x->drift[i] = spring + x->c[i] * rate;
		x->top[i] = fabs(d) > x->top[i] ? fabs(d) : x->top[i];
	}
	for (int i = 0; i < x->n; i++) // forces on floors
		x->force[i] = (i + 1 < x->n ? x->inner[i + 1] * x->drift[i + 1] : 0) - x->drift[i];
}

static inline __attribute__((always_inline)) void loop_run(const struct pound_chain_task *task, int steps,
                                                           double *drift_max, bool yields)
{
	struct loop *x = malloc(sizeof *x);
	if (!x)
		abort();
	const double h = task->time_step / steps;
	loop_start(x, task, h);
	for (int i = 1; i < task->n_samples; i++) {
		const double a0 = task->ground[i - 1], slope = (task->ground[i] - a0) / steps;
		for (int j = 0; j < steps; j++) {
			const double a = (a0 + slope * j) * h * h;
			stories_pull(x, yields);
			links_push(task, x, h);
			for (int f = 0; f < x->n; f++) {
				const double u = x->u[f + 1], way = u - x->before[f + 1];
				x->before[f + 1] = u;
				x->u[f + 1] = u + way - x->mass_damping[f] * way + x->force[f] * x->share[f] - a;
			}
		}
	}
	memcpy(drift_max, x->top, sizeof(double) * (size_t)x->n);
	free(x);
}

void baseline_chain_linear(const struct pound_chain_task *task, int steps, double *drift_max)
{
	loop_run(task, steps, drift_max, false);
}

void baseline_chain_yielding(const struct pound_chain_task *task, int steps, double *drift_max)
{
	loop_run(task, steps, drift_max, true);
}
