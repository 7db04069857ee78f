/* shared_start.inl - tasks that differ in nothing but their laws, run as one simulation as long as no edge of a branch decides.
 *
 * Included by exact.inl alone, once per lane count.  All laws start on the same elastic branch.  A family goes along it between
 * the edges nearest to it.  Where one of them decides what it does next, or may, that is taken back: a member leaves, to go on
 * from there by itself, and the others try again.  Every proof and search that finds nothing of an edge finds nothing of one
 * farther away.  So every member does what it would have done alone, to the last bit; who leaves first, and when, is of no
 * consequence for that.
 *
 * Included by exact.inl after next_step.inl. */

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/numeric/hash.h"

enum {
	SHARED_TASKS = 4096,             /* the first of a call's, among which shared_starts are looked for */
	SHARED_SLOTS = 2 * SHARED_TASKS, /* of their hash table */
};

/* the shared_starts of a call's tasks */
struct shared_starts {
	// number of a first member and 1, 0: empty; where that family is full, of the next one like it
	int slot[SHARED_SLOTS];
	int next[SHARED_TASKS];     /* number of the next member; 0: there is none */
	bool edged[SHARED_TASKS];   /* of a first member: a law of the family has more than one branch */
	bool follows[SHARED_TASKS]; /* is not the first of its family */
};

/* A zero and its negative make different bits. */
static bool same(double a, double b)
{
	return memcmp(&a, &b, sizeof a) == 0;
}

static bool bodies_same(const struct pound_task_body *a, const struct pound_task_body *b)
{
	return same(a->backbone.stiffness, b->backbone.stiffness) && same(a->damping, b->damping) &&
	       same(a->drive, b->drive) && same(a->u, b->u) && same(a->v, b->v) && a->followed == b->followed;
}

/* Whether tasks differ in nothing but their laws. */
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

/* Adds a task to the family whose first member another is, if there is room and one of them may leave its branch. */
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

/* Finds the shared_starts of n tasks. */
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

/* Whether a task is the first of its family: a simulation begins with it. */
static bool shared_first(const struct shared_starts *f, int j)
{
	return j >= SHARED_TASKS || !f->follows[j];
}

/* Whether a law of a task, or of one that goes along with it, has more than one branch. */
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

/* A simulation goes between its own edges, and nearer ones of those it has with it. */
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

/* Takes the others of its family along with the simulation of the first, which is at its start. */
static void shared_gather(const struct shared_starts *f, const struct pound_task *tasks,
                          struct pound_task_result *results, int first, struct simulation *sim)
{
	if (first >= SHARED_TASKS || f->next[first] == 0)
		return;
	for (int j = f->next[first]; j > 0; j = f->next[j])
		sim->others[sim->n_others++] = (struct pound_member){&tasks[j], &results[j]};
	shared_edges(sim);
}

/* How near bodies are to the ends of the first branches of a task's laws: roughly, in which order members will leave.  From
 * rest it is the narrower branch that is nearer to its end. */
static double edge_nearness(const struct simulation *sim, const struct pound_task *task)
{
	double share = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		share = most(share, (fabs(sim->x.u[i]) + DBL_MIN) / first_branch(task, i).high);
	return share;
}

/* Copies a simulation, as it is before a step. */
static void simulation_copy(struct simulation *to, const struct simulation *from)
{
	memcpy(to, from, offsetof(struct simulation, own_maps));
	contact_maps_copy(to, from);
}

/* The member that seems nearest to an edge leaves the family.
 *
 * Given    stage  in which it does
 * Returns  own    its simulation, which waits
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
		// it is the one that the others go with: these go with another from here on
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

/* One that has left goes on. */
static void shared_resume(struct simulation *sim, const struct simulation *own)
{
	simulation_copy(sim, own);
	contact_maps_resume(sim, sim->stage);
}

/* The end of a simulation is that of those who are still with it. */
static void shared_end(const struct simulation *sim)
{
	for (int k = 0; k < sim->n_others; k++)
		*sim->others[k].result = *sim->result;
}
