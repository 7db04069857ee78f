/* shared_start.inl - tasks that differ only in their laws, run as one simulation until one of them may leave its first branch.
 *
 * Included by exact.inl alone, once per lane count.  All laws start on the same elastic branch.  A shared simulation uses the
 * nearest edges of all its tasks.  If an edge decides a step, or may, the step is undone: one task leaves and continues
 * separately from there, and the others repeat the step.  A proof or search that excludes an edge also excludes every edge
 * farther away, so each task's result has the same bits as if it had run alone, whichever task leaves first, and
 * whenever.
 *
 * Included by exact.inl after next_step.inl. */

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/numeric/hash.h"

enum {
	SHARED_TASKS = 4096,             /* only the first tasks of a call are grouped */
	SHARED_SLOTS = 2 * SHARED_TASKS, /* slots of their hash table */
};

/* groups of tasks with a shared start: linked lists, found by a hash table */
struct shared_starts {
	// index of a group's first task + 1, 0: empty; once a group is full, the first task of the next equal group
	int slot[SHARED_SLOTS];
	int next[SHARED_TASKS];     /* index of the next task of the group; 0: none */
	bool edged[SHARED_TASKS];   /* of a first task: a law in the group has more than one branch */
	bool follows[SHARED_TASKS]; /* not the first task of its group */
};

/* Compares bits: 0 and -0 can give different results. */
static bool same(double a, double b)
{
	return memcmp(&a, &b, sizeof a) == 0;
}

static bool bodies_same(const struct pound_task_body *a, const struct pound_task_body *b)
{
	return same(a->backbone.stiffness, b->backbone.stiffness) && same(a->damping, b->damping) &&
	       same(a->drive, b->drive) && same(a->u, b->u) && same(a->v, b->v) && a->followed == b->followed;
}

/* Whether tasks differ only in their laws. */
static bool tasks_same(const struct pound_task *a, const struct pound_task *b)
{
	return a->ground == b->ground && a->n_samples == b->n_samples && same(a->time_step, b->time_step) &&
	       a->contact == b->contact && same(a->gap, b->gap) &&
	       same(a->contact_stiffness, b->contact_stiffness) && same(a->contact_damping, b->contact_damping) &&
	       same(a->mass_ratio, b->mass_ratio) && a->tension == b->tension && !a->accounted && !b->accounted &&
	       !a->observer && !b->observer && bodies_same(&a->bodies[0], &b->bodies[0]) &&
	       bodies_same(&a->bodies[1], &b->bodies[1]);
}

/* The slot in which the search for tasks of the same scene begins. */
static int task_slot(const struct pound_task *task, int slots)
{
	const struct pound_task_body *body = task->bodies;
	const double numbers[] = {body[0].backbone.stiffness,
	                          body[0].damping,
	                          body[1].backbone.stiffness,
	                          body[1].damping,
	                          task->gap,
	                          task->mass_ratio,
	                          task->contact_stiffness,
	                          task->contact_damping};
	return pound_hash_slot((uintptr_t)task->ground, numbers, sizeof numbers / sizeof numbers[0], slots);
}

/* Adds a task to the group of another first task, if there is room and a law of either has more than one branch. */
static void shared_add(struct shared_starts *f, int first, int j)
{
	int last = first, members = 1;
	for (; f->next[last] > 0; last = f->next[last])
		members++;
	if (members > POUND_OTHERS || !(f->edged[j] || f->edged[first]))
		return;
	f->next[last] = j;
	f->follows[j] = true;
	f->edged[first] |= f->edged[j];
}

/* Groups n tasks by shared start. */
static void shared_find(struct shared_starts *f, const struct pound_task *tasks, int n)
{
	const int looked = n < SHARED_TASKS ? n : SHARED_TASKS;
	const int slots = pound_hash_slots(looked);
	memset(f->slot, 0, sizeof f->slot[0] * (size_t)slots);
	for (int j = 0; j < looked; j++) {
		f->next[j] = 0;
		f->edged[j] = simulation_edged(&tasks[j]);
		f->follows[j] = false;
		int at = task_slot(&tasks[j], slots);
		while (f->slot[at] > 0 && !tasks_same(&tasks[f->slot[at] - 1], &tasks[j]))
			at = (at + 1) & (slots - 1);
		if (f->slot[at] > 0)
			shared_add(f, f->slot[at] - 1, j);
		if (!f->follows[j])
			f->slot[at] = j + 1;
	}
}

/* Whether a task is the first of its group, and so starts a simulation. */
static bool shared_first(const struct shared_starts *f, int j)
{
	return j >= SHARED_TASKS || !f->follows[j];
}

/* Whether a law of a task, or of a task that shares its simulation, has more than one branch. */
static bool shared_edged(const struct shared_starts *f, const struct pound_task *tasks, int j)
{
	return j < SHARED_TASKS ? f->edged[j] : simulation_edged(&tasks[j]);
}

/* The first branch of a body's law. */
static struct pound_branch first_branch(const struct pound_task *task, int i)
{
	struct pound_law_state at;
	pound_law_start(&task->bodies[i].backbone, &at);
	return at.branch;
}

/* Sets a simulation's edges to the nearest edges of all its tasks. */
static void shared_edges(struct simulation *sim)
{
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		double low = sim->at[i].branch.low, high = sim->at[i].branch.high;
		for (int k = 0; k < sim->n_others; k++) {
			struct pound_branch branch = first_branch(sim->others[k].task, i);
			low = fmax(low, branch.low);
			high = fmin(high, branch.high);
		}
		sim->x.body[i].low = low;
		sim->x.body[i].high = high;
	}
	sim->traits &= ~(unsigned)(TRAIT_SHARED | TRAIT_EDGED);
	if (sim->n_others > 0)
		sim->traits |= TRAIT_SHARED | TRAIT_EDGED;
	if (simulation_edged(sim->task))
		sim->traits |= TRAIT_EDGED;
}

/* Adds the other tasks of a group to the simulation of its first task, which is at its start. */
static void shared_gather(const struct shared_starts *f, const struct pound_task *tasks,
                          struct pound_task_result *results, int first, struct simulation *sim)
{
	if (first >= SHARED_TASKS || f->next[first] == 0)
		return;
	for (int j = f->next[first]; j > 0; j = f->next[j])
		sim->others[sim->n_others++] = (struct pound_member){&tasks[j], &results[j]};
	shared_edges(sim);
}

/* Largest |u| over the end of the first branch, of both bodies: estimates in which order tasks will leave.  At rest the
 * narrower branch counts as nearer (DBL_MIN). */
static double edge_nearness(const struct simulation *sim, const struct pound_task *task)
{
	double share = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		share = most(share, (fabs(sim->x.u[i]) + DBL_MIN) / first_branch(task, i).high);
	return share;
}

/* Copies a simulation before a step. */
static void simulation_copy(struct simulation *to, const struct simulation *from)
{
	memcpy(to, from, offsetof(struct simulation, own_maps));
	contact_maps_copy(to, from);
}

/* Takes the task that seems nearest to an edge out of a shared simulation.
 *
 * Given    stage  the stage to repeat
 * Returns  own    the task's own simulation, to be resumed later
 */
static void shared_leave(struct simulation *sim, struct simulation *own, enum pound_stage stage)
{
	assert(sim->n_others > 0 && sim->looked == POUND_OSCILLATORS);
	struct pound_member *nearest = &sim->others[0];
	for (int k = 1; k < sim->n_others; k++)
		if (edge_nearness(sim, sim->others[k].task) > edge_nearness(sim, nearest->task))
			nearest = &sim->others[k];
	struct pound_member leaver = *nearest, self = {sim->task, sim->result};
	*nearest = sim->others[--sim->n_others];
	*leaver.result = *sim->result;
	simulation_copy(own, sim);
	own->n_others = 0;
	own->stage = stage;
	if (edge_nearness(sim, leaver.task) < edge_nearness(sim, self.task)) {
		// the simulation's own task is nearest: another task takes its place
		sim->task = leaver.task;
		sim->result = leaver.result;
		leaver = self;
	}
	own->task = leaver.task;
	own->result = leaver.result;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		pound_law_start(&sim->task->bodies[i].backbone, &sim->at[i]);
		pound_law_start(&own->task->bodies[i].backbone, &own->at[i]);
	}
	shared_edges(sim);
	shared_edges(own);
}

/* Resumes a task that has left a shared simulation. */
static void shared_resume(struct simulation *sim, const struct simulation *own)
{
	simulation_copy(sim, own);
	contact_maps_resume(sim, sim->stage);
}

/* Copies a simulation's result to the tasks that still share it. */
static void shared_end(const struct simulation *sim)
{
	for (int k = 0; k < sim->n_others; k++)
		*sim->others[k].result = *sim->result;
}
