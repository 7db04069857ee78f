/* cells.c - the scenes of a study: its cells (product of the sweeps), the rows of its design, a row's samples. */
#include "engine/design/design.h"
#include "engine/ground/excitation.h"
#include "engine/ground/suite.h"
#include "engine/run/request.h"

/* The solver of a row. */
struct pound_solver pound_cells_solver(const struct pound_cells *campaign, int row)
{
	return campaign->trials ? pound_convergence_solver(campaign->study, row) : campaign->study->solver;
}

/* Value of a sweep in a cell; the last sweep runs fastest. */
double pound_cells_sweep(const struct pound_cells *campaign, int cell, int sweep)
{
	const struct pound_study *study = campaign->study;
	for (int s = study->n_sweeps - 1; s > sweep; s--)
		cell /= study->sweeps[s].n_values;
	return study->sweeps[sweep].values[cell % study->sweeps[sweep].n_values];
}

/* The number of checked items before this one. */
int pound_cells_checks(const struct pound_cells *campaign, int item)
{
	int every = campaign->check_every;
	return every ? (item + every - 1) / every : 0;
}

/* The scene of one sample: the study's scene with the cell's sweep values and the sample's inputs.
 *
 * Given    row_memory   (pound_row_bytes)   for its own buildings and contacts; NULL: the study's, not varied
 */
struct pound_scene pound_cells_scene(const struct pound_cells *campaign, int cell, int row, int sample,
                                     void *row_memory)
{
	const struct pound_study *study = campaign->study;
	struct pound_scene scene = study->scene;
	if (row_memory)
		pound_row_own(&scene, row_memory);
	for (int s = 0; s < study->n_sweeps; s++)
		if (row_memory || study->sweeps[s].field.part == POUND_PART_SCENE)
			pound_scene_assign(&scene, study->sweeps[s].field, pound_cells_sweep(campaign, cell, s));
	const unsigned from_b = study->n_inputs > 0 ? pound_design_mask(study, sample) : 0;
	for (int j = 0; j < study->n_inputs; j++)
		if (row_memory || study->inputs[j].field.part == POUND_PART_SCENE)
			pound_scene_assign(&scene, study->inputs[j].field,
			                   pound_design_input(campaign->design, study->n_inputs, row, from_b, j));
	return scene;
}

/* The record of a signal of a scene with a suite. */
struct pound_suite_signal pound_cells_record(const struct pound_cells *campaign,
                                             const struct pound_scene *scene, const struct pound_place *place)
{
	return pound_suite_signal(&scene->excitation, campaign->references,
	                          pound_cells_noise(campaign, place->row, place->sample, place->signal));
}

struct pound_excitation pound_cells_excitation(const struct pound_cells *campaign,
                                               const struct pound_scene *scene,
                                               const struct pound_place *place)
{
	const struct pound_excitation *e = &scene->excitation;
	return e->n_records ? pound_suite_excitation(e, pound_cells_record(campaign, scene, place)) : *e;
}

/* The random stream of a ground motion: common to the samples of a row, or one for each sample. */
struct pound_stream pound_cells_noise(const struct pound_cells *campaign, int row, int sample, int signal)
{
	const struct pound_design *design = &campaign->study->design;
	return (struct pound_stream){.seed = design->seed,
	                             .what = POUND_STREAM_NOISE,
	                             .row = (uint32_t)(design->row + (campaign->trials ? 0 : row)),
	                             .sample = design->common_signals ? 0 : (uint32_t)sample,
	                             .signal = (uint32_t)signal};
}

/* Number of numerators of an output in a cell; also of denominators, or of variances of outputs computed elsewhere. */
size_t pound_cells_values_size(const struct pound_cells *c, int n_rows)
{
	return (size_t)n_rows * (size_t)c->n_samples * (size_t)c->n_signals;
}

/* Whether the outputs are means computed elsewhere, with variances, instead of ratios of means over signals. */
bool pound_cells_means(const struct pound_cells *c)
{
	return c->study->elsewhere && !c->study->replicates;
}

/* The values of an output in the first rows of a cell; columns: numerators, then denominators; NULL: only the shape.
 *
 * Test     unit_index_columns: a_study_s_result_holds_what_its_samples_give
 */
struct pound_sample_values pound_cells_values(const struct pound_cells *c, int n_rows, const double *columns)
{
	const double *second = columns ? columns + pound_cells_values_size(c, n_rows) : NULL;
	return (struct pound_sample_values){.n_rows = n_rows,
	                                    .n_inputs = c->study->n_inputs,
	                                    .n_signals = c->n_signals,
	                                    .same_signals = !c->study->elsewhere &&
	                                                    !pound_excitation_random(&c->study->scene.excitation),
	                                    .numerator = columns,
	                                    .denominator = pound_cells_means(c) ? NULL : second,
	                                    .variance = pound_cells_means(c) ? second : NULL,
	                                    .grouping = pound_design_grouping(c->study),
	                                    .order = pound_design_order(c->study),
	                                    .n_groups = c->study->n_groups,
	                                    .groups = c->study->groups,
	                                    .inputs = c->study->inputs};
}

bool pound_study_sampled(const struct pound_study *study)
{
	return study->kind == POUND_KIND_SENSITIVITY ||
	       (study->kind == POUND_KIND_SEPARATION && study->n_inputs > 0);
}

bool pound_study_pounds(const struct pound_study *study)
{
	return study->kind != POUND_KIND_SEPARATION || study->n_outputs > study->separation.n_own;
}
