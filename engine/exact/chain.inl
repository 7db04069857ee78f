/* chain.inl - the exact event-driven solver of rows of buildings: one chain at a time, its floors in SIMD lanes.
 *
 * Between events every story and contact is on a linear branch and the ground acceleration is linear in time, so a step is a power
 * series in time.  It ends at the first root of a guard, found to rounding, or at the next sample.  A chain's bits do not
 * depend on the lane count: lanes interact only by shifts between neighbors, and sums are taken in index order.
 *
 * Laws, contacts, root searches and tolerances are shared with the solver of pairs (exact.inl). */

enum {
	ORDER_LOW = 15,  /* order of the series of short steps */
	ORDER_HIGH = 21, /* ... of long steps */
};

enum { STOP_STEPS = 1024 }; /* steps between two polls of the caller's stop flag */

// clang-format off
#include "engine/exact/chain_state.inl"
#include "engine/exact/series.inl"
#include "engine/exact/chain_series.inl"
#include "engine/exact/nonlinear_contact.inl"
#include "engine/exact/impact.inl"
#include "engine/exact/chain_events.inl"
#include "engine/exact/chain_peaks.inl"
#include "engine/exact/chain_energy.inl"
#include "engine/exact/nonlinear_contact_step.inl"
#include "engine/exact/chain_observer.inl"
#include "engine/exact/chain_step.inl"
#include "engine/exact/chain_modal.inl"
// clang-format on

/* Whether a link's overlap can be computed from its floors again: the sides are separated by far more than rounding. */
static bool link_far(const struct chain *c, const struct link *l)
{
	double terms = l->link->gap;
	for (int k = 0; k < l->n_ends; k++)
		terms += fabs(l->weight[k] * c->u.at[l->floor[k]]);
	return !l->touching && !l->released && l->p < -0x1p-20 * terms && l->p + c->task->time_step * l->q < 0;
}

/* Sets the negligible motion of a building without contact to rest, while the ground does not move. */
static void building_to_rest(struct chain *c, int first, int stories)
{
	for (int i = first; i < first + stories; i++)
		if (fabs(c->d.at[i]) >= POUND_AT_REST || fabs(c->v.at[i]) * c->task->time_step >= POUND_AT_REST ||
		    c->offset.at[i] != 0 || c->low.at[i] > 0 || c->high.at[i] < 0)
			return;
	for (int i = first; i < first + stories; i++)
		c->d.at[i] = c->v.at[i] = 0;
}

static void chain_to_rest(struct chain *c)
{
	for (int j = 0; j < c->n_links; j++)
		if (c->link[j].touching || c->link[j].released)
			return;
	for (int first = 0, stories; first < c->n; first += stories) {
		stories = building_stories(c->task, first);
		building_to_rest(c, first, stories);
	}
}

/* Stops integrating the overlaps of links whose sides are far apart. */
static void links_release(struct chain *c)
{
	bool own = false;
	for (int j = 0; j < c->n_links; j++)
		own |= c->link[j].own;
	if (!own)
		return;
	chain_displacements(c);
	for (int j = 0; j < c->n_links; j++)
		if (c->link[j].own && link_far(c, &c->link[j]))
			c->link[j].own = false;
}

/* Enters the interval that ends at c->next. */
static void chain_interval(struct chain *c)
{
	interval_set(c, c->next);
	c->steps = 0;
	if (c->ground == 0 && c->slope == 0)
		chain_to_rest(c);
	links_release(c);
}

/* Integrates a chain from its start to the end of its ground motion. */
static enum pound_status chain_march(struct chain *c, const atomic_bool *stop)
{
	int64_t steps = 0;
	for (; c->next < c->task->n_samples; c->next++) {
		if (c->modal_motion.can) {
			links_release(c);
			modal_advance(c, stop);
			if (c->next == c->task->n_samples)
				break;
		}
		chain_interval(c);
		while (c->remainder > 0) {
			if (++c->steps > POUND_STEPS_LIMIT)
				return POUND_CHATTER;
			if (++steps % STOP_STEPS == 0 && pound_stopped(stop))
				return POUND_STOPPED;
			chain_step(c);
		}
	}
	c->next--;
	return POUND_OK;
}

static_assert(sizeof(struct chain) <= POUND_CHAIN_SCRATCH, "a chain fits into its work space");
static_assert(offsetof(struct chain, curved_step.clock) <= POUND_CHAIN_SCRATCH_STRAIGHT,
              "so does one that has no step but in time");

/* Runs every task to its end.
 *
 * Given    tasks    (n)
 *          scratch  pound_chain_scratch bytes for their form of contact force, 64-byte aligned
 *          stop     polled between steps: once it is set the results are invalid; NULL: never stopped
 * Returns  results  (n); status POUND_CHATTER where a task ended early, POUND_OVERFLOW where its motion is not finite
 *
 * Source   buildings.md 1 and 3 of the project's design pages
 * Test     unit_chain
 */
void POUND_CHAIN(const struct pound_chain_task *tasks, struct pound_chain_result *results, int n,
                 void *scratch, const atomic_bool *stop)
{
	struct chain *c = scratch;
	for (int j = 0; j < n && !pound_stopped(stop); j++) {
		chain_start(c, &tasks[j], &results[j]);
		modal_start(c);
		const enum pound_status status = chain_march(c, stop);
		chain_displacements(c);
		for (int i = 0; i < c->n_links; i++)
			if (c->link[i].touching) // a contact still open at the end counts with its impulse so far
				contact_over(c, &c->link[i]);
		if (c->modal_motion.can && status == POUND_OK)
			notes_look(c);
		chain_write(c, status);
	}
	lanes_leave();
}
