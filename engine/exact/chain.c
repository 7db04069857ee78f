/* chain.c - the exact solver of rows of buildings, at the widest lane count of this machine.
 *
 *   task ──> drifts of all stories in lanes ──> series ──> first event ──> next branch ──┐
 *                  ^                                                                     │
 *                  └─────────────────────────────────────────────────────────────────────┘   until the last sample
 *
 * chain.inl runs one chain after the other and includes, in this order:
 *
 *   chain_state.inl             columns of floors, links, the start and the end
 *   series.inl                  first roots of event functions on power series, shared with the solver of pairs
 *   chain_series.inl            the series of a step
 *   nonlinear_contact.inl       the same while a contact force is a product or a power
 *   impact.inl                  rigid impacts and held contacts
 *   chain_events.inl            the first event of a step
 *   chain_peaks.inl             largest values inside the step
 *   chain_energy.inl            work done in the step
 *   nonlinear_contact_step.inl  the first event and the end of a step with such a contact
 *   chain_observer.inl          pieces reported to an observer
 *   chain_step.inl              one step up to an event, and what follows
 *   chain_modal.inl             whole samples by modes
 *
 * It is compiled once for each lane count: chain_w8.c, chain_w4.c, chain_w1.c, chain_portable.c. */
#include "engine/exact/chain.h"
#include "engine/numeric/cpu_width.h"

typedef void chain_run(const struct pound_chain_task *, struct pound_chain_result *, int n, void *scratch,
                       const atomic_bool *stop);

/* Bytes of work space of chains whose contacts have a given form of force.
 *
 * Only product and power forms need series of every contact in a step (struct curved_step, at the end of struct chain).
 *
 * Test     unit_chain: the_largest_row_of_straight_contacts_takes_a_mebibyte
 */
size_t pound_chain_scratch(enum pound_force force)
{
	return force == POUND_FORCE_PRODUCT || force == POUND_FORCE_POWER ? POUND_CHAIN_SCRATCH
	                                                                  : POUND_CHAIN_SCRATCH_STRAIGHT;
}

/* Runs chains at a lane count; 0: the widest available.
 *
 * Given    scratch  pound_chain_scratch bytes for their form of contact force, 64-byte aligned
 *          stop     polled throughout: once it is set the results are invalid; NULL: never stopped
 * Returns  value    false: this machine has no such lanes, nothing was run
 *          results  one for each task  (n)
 */
bool pound_chain_lanes(int lanes, const struct pound_chain_task *tasks, struct pound_chain_result *results,
                       int n, void *scratch, const atomic_bool *stop)
{
	static chain_run *const run[POUND_WIDTHS] = {pound_chain_w8, pound_chain_w4, pound_chain_w1,
	                                             pound_chain_portable};
	int width = pound_dispatch_width(lanes);
	if (width >= 0)
		run[width](tasks, results, n, scratch, stop);
	return width >= 0;
}
