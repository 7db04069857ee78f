/* impacts.c - every contact of one signal of a response study, by repeating the runs with pounding. */
#include <math.h>

#include "engine/run/request.h"
#include "engine/run/run.h"

/* Receiver of the contacts of a cell, in the units of the study. */
struct impacts {
	pound_impact_take *take;
	void *into;
	const struct pound_request_chain *chain;
	int cell;
};

static void impact_record(void *of, const struct pound_chain_contact *contact)
{
	const struct impacts *to = of;
	const struct pound_scene *scene = &to->chain->scene;
	struct pound_impact impact = {.cell = to->cell,
	                              .contact = contact->link,
	                              .levels = {NAN, NAN},
	                              .begin = contact->begin,
	                              .end = contact->end,
	                              .speed = ldexp(contact->speed, to->chain->exponent),
	                              .impulse = to->chain->mass * ldexp(contact->impulse, to->chain->exponent)};
	if (scene->n_buildings) {
		struct pound_row_contact of_row;
		pound_row_contact_of(scene, contact->link, &of_row);
		impact.left_building = of_row.left_building;
		for (int side = 0; side < 2; side++)
			impact.levels[side] = of_row.levels[side];
	}
	to->take(to->into, &impact);
}

static void status_keep(void *into, const struct pound_outcome *outcome)
{
	enum pound_status *first = into;
	*first = *first ? *first : outcome->status;
}

/* Reports every contact of a signal, cell after cell, in the order in which the contacts end.
 *
 * Given    run     of a response study by the event solver
 * Returns  take    called for each counted contact: as many times as contact_count of the response
 * Status   POUND_CHATTER and others  a motion could not be followed to its end
 *          POUND_STOPPED             pound_run_stop was called
 * Test     unit_impacts
 */
enum pound_status pound_run_impacts(struct pound_run *run, int signal, pound_impact_take *take, void *into)
{
	struct pound_work work = {0};
	enum pound_status status = POUND_OK, left = POUND_OK;
	int n_items;
	status = pound_request_run(run->requests[0], (struct pound_items){&run->campaign, signal, 1}, run->stop,
	                           &work, status_keep, &left);
	if (status || left)
		return status ? status : left;
	pound_request_count(run->requests[0], &n_items);
	for (int cell = 0; cell < n_items && !pound_stopped(run->stop); cell++) {
		struct pound_request_chain chain;
		struct impacts to = {take, into, &chain, cell};
		const struct pound_chain_recorder recorder = {impact_record, &to};
		pound_request_chain(run->requests[0], cell, &chain);
		if (!chain.task.links)
			continue;
		chain.task.recorder = &recorder;
		pound_chain_lanes(0, &chain.task, &chain.result, 1, chain.scratch, run->stop);
	}
	return pound_stopped(run->stop) ? POUND_STOPPED : POUND_OK;
}
