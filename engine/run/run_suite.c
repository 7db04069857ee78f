/* run_suite.c - a study under a suite of records: scaling of the records, and the record of each signal. */
#include "engine/run/run.h"
#include "engine/run/suite_references.h"

bool pound_run_suite(const struct pound_study *study)
{
	return study->kind == POUND_KIND_RESPONSE && study->scene.excitation.n_records > 0;
}

size_t pound_run_scale_bytes(const struct pound_study *study)
{
	const struct pound_excitation *suite = &study->scene.excitation;
	return suite->n_records ? pound_suite_scratch(suite) : 0;
}

/* The scene of the first cell, every input at its median. */
static struct pound_scene middle_scene(const struct pound_study *study)
{
	struct pound_scene scene = study->scene;
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].field.part == POUND_PART_SCENE)
			pound_scene_assign(&scene, study->sweeps[s].field, study->sweeps[s].values[0]);
	for (int j = 0; j < study->n_inputs; j++)
		if (study->inputs[j].field.part == POUND_PART_SCENE)
			pound_scene_assign(&scene, study->inputs[j].field,
			                   pound_distribution_quantile(&study->inputs[j].distribution, 0.5));
	return scene;
}

/* Computes the references of a scaled suite, and checks the sampling of its records.
 *
 * Given    scratch   (pound_run_scale_bytes)
 * Returns  run       references and differences, also in its result
 *          value     false: stop was set
 */
bool pound_run_scale(struct pound_run *run, void *scratch, const atomic_bool *stop)
{
	const struct pound_study *study = run->campaign.study;
	const struct pound_excitation *suite = &study->scene.excitation;
	if (suite->n_records == 0)
		return true;
	double *differences = run->references + suite->n_records;
	run->result.differences = differences;
	const struct pound_scene scene = middle_scene(study);
	if (suite->scale.to != POUND_SCALE_NONE) {
		run->campaign.references = run->result.references = run->references;
		if (pound_suite_references(suite, scratch, stop, run->references))
			return false;
	}
	return pound_suite_differences(&scene, scratch, stop, differences) == POUND_OK;
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
