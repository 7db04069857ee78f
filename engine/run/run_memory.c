/* run_memory.c - what a study being computed takes of memory, before anything is allocated. */
#include <stddef.h>

#include "engine/ground/excitation.h"
#include "engine/run/floor_outputs.h"
#include "engine/run/run.h"

/* corrections of a search for a demand that most come to an end with */
static const int CORRECTIONS_MEAN = 6;

static bool of_motion(struct pound_field field)
{
	const size_t first = offsetof(struct pound_scene, excitation);
	return field.offset >= first && field.offset < first + sizeof(struct pound_excitation);
}

/* Ground motions of an item that differ. */
static int motions(const struct pound_cells *c)
{
	const struct pound_study *study = c->study;
	int n = c->n_samples, n_inputs = 0, n_cells = 1;
	for (int j = 0; j < study->n_inputs; j++)
		n_inputs += of_motion(study->inputs[j].field);
	for (int s = 0; s < study->n_sweeps; s++)
		n_cells *= of_motion(study->sweeps[s].field) ? study->sweeps[s].n_values : 1;
	// A, B, and A with each such column of B
	if (study->design.common_signals || !pound_excitation_random(&study->scene.excitation))
		n = n_inputs && 2 + n_inputs < n ? 2 + n_inputs : n_inputs ? n : 1;
	return n_cells * n;
}

/* Marches of an ask, most of which are used: what is not stays untouched. */
static int marches(const struct pound_study *study)
{
	int n = 1;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const int corrections = pound_scene_law(&study->scene, i)->corrections;
		n += 2 + (corrections < CORRECTIONS_MEAN ? corrections : CORRECTIONS_MEAN);
	}
	return n;
}

/* Memory of a run, as pound_run_create lays it out, without what it leaves untouched.
 *
 * Given    n_workers   -
 *          samples     of a ground motion, in the mean
 * Returns  value       bytes
 * Test     service_estimates: the_memory_of_a_study_is_estimated
 */
double pound_run_bytes(const struct pound_study *study, int n_workers, double samples)
{
	struct pound_run run = {.campaign = pound_run_campaign(study)};
	const struct pound_cells *c = &run.campaign;
	struct pound_run_part parts[POUND_RUN_PARTS];
	struct pound_request_size item = {.asks = c->n_cells * c->n_samples, .motions = motions(c)},
	                          largest = {0};
	double bytes = sizeof(double) * 4.0 * c->n_rows * study->n_inputs; // the design and its probabilities
	pound_run_result_parts(&run, parts);
	for (int j = 0; j < POUND_RUN_PARTS; j++)
		bytes += (double)parts[j].bytes;
	item.tasks = item.asks * marches(study);
	item.samples = (int64_t)(samples * item.motions);
	run.layout = pound_run_layout(c);
	if (!study->elsewhere)
		run.layout.n_blocks = pound_blocks_alike(c, item, &largest);
	bytes += (double)sizeof(int) * run.layout.n_blocks +
	         (double)sizeof(double) * (double)pound_blocks_doubles(&run.layout);
	// who has no block does not touch its request
	const int n_busy = n_workers < run.layout.n_blocks ? n_workers : run.layout.n_blocks;
	return bytes +
	       n_busy * ((double)pound_request_bytes(largest) - POUND_EXACT_SCRATCH +
	                 (double)pound_ordinate_bytes(study, largest.tasks)) +
	       n_workers * (double)sizeof(double) * (double)pound_run_reduction_size(c);
}
