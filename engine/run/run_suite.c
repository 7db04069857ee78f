/* run_suite.c - a study under a suite of records: these scaled once, and which of them its signals are. */
#include "engine/run/run.h"
#include "engine/run/suite_references.h"

bool pound_run_suite(const struct pound_study *study)
{
	return study->kind == POUND_KIND_RESPONSE && study->scene.excitation.n_records > 0;
}

size_t pound_run_scale_bytes(const struct pound_study *study)
{
	const struct pound_excitation *suite = &study->scene.excitation;
	return suite->scale.to == POUND_SCALE_NONE ? 0 : pound_suite_scratch(suite);
}

/* Scales the records of a suite that is to be scaled.
 *
 * Given    scratch   (pound_run_scale_bytes)
 * Returns  run       references, also of its result
 *          value     false: stop was set
 */
bool pound_run_scale(struct pound_run *run, void *scratch, const atomic_bool *stop)
{
	const struct pound_excitation *suite = &run->campaign.study->scene.excitation;
	if (suite->scale.to == POUND_SCALE_NONE)
		return true;
	run->campaign.references = run->result.references = run->references;
	return pound_suite_references(suite, scratch, stop, run->references) == POUND_OK;
}

struct pound_suite_signal pound_run_motion_record(const struct pound_run *run,
                                                  const struct pound_place *place)
{
	const struct pound_scene scene =
	    pound_cells_scene(&run->campaign, place->cell, place->row, place->sample, NULL);
	return pound_cells_record(&run->campaign, &scene, place);
}

void pound_run_records(struct pound_run *run)
{
	const struct pound_cells *c = &run->campaign;
	for (int cell = 0; cell < c->n_cells && pound_run_suite(c->study); cell++)
		for (int signal = 0; signal < c->n_signals; signal++)
			run->result.cells[cell].records[signal] =
			    pound_run_motion_record(run, &(struct pound_place){cell, 0, 0, signal});
}
