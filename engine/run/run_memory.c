/* run_memory.c - memory of the computation of a study, before anything is allocated. */
#include "engine/run/floor_outputs.h"
#include "engine/run/outputs.h"
#include "engine/run/run.h"

/* Memory of a run as laid out by pound_run_create, without allocated but untouched memory.
 *
 * Given    n_workers   -
 *          shared      work of an item without duplicates
 * Returns  value       bytes
 * Test     service_estimates: the_memory_of_a_study_is_estimated
 */
double pound_run_bytes(const struct pound_study *study, int n_workers, const struct pound_run_shared *shared)
{
	struct pound_run run = {.campaign = pound_run_campaign(study)};
	const struct pound_cells *c = &run.campaign;
	struct pound_run_part parts[POUND_RUN_PARTS];
	struct pound_request_size item = {.asks = c->n_cells * c->n_samples,
	                                  .motions = (int)shared->motions,
	                                  .tasks = (int)shared->marches,
	                                  .samples = (int64_t)(shared->motions * shared->samples)},
	                          largest = {0};
	const unsigned asked = pound_outputs_asked(study);
	double bytes = sizeof(double) * 4.0 * c->n_rows * study->n_inputs; // the design and its probabilities
	pound_run_result_parts(&run, parts);
	for (int j = 0; j < POUND_RUN_PARTS; j++)
		bytes += (double)parts[j].bytes;
	// a row of buildings has its own kind of tasks
	if (study->scene.n_buildings)
		item.tasks = 0;
	item.peaks = asked & POUND_ASKS_FREE_PAIR ? item.tasks : 0;
	for (int k = 0; k < item.asks && !study->scene.n_buildings && asked & POUND_ASKS_CHAIN; k++)
		pound_row_size_add_pair(&item.rows);
	for (int k = 0; k < item.asks && study->scene.n_buildings; k++)
		pound_row_size_add(&item.rows, &study->scene, pound_outputs_asked(study));
	run.layout = pound_run_layout(c);
	if (!study->elsewhere)
		run.layout.n_blocks = pound_blocks_alike(c, item, &largest);
	bytes += (double)pound_run_scale_bytes(study);
	bytes += (double)sizeof(int) * run.layout.n_blocks +
	         (double)sizeof(double) * (double)pound_blocks_doubles(&run.layout);
	// a worker without a block does not touch its request
	const int n_busy = n_workers < run.layout.n_blocks ? n_workers : run.layout.n_blocks;
	return bytes +
	       n_busy * ((double)pound_request_bytes(largest) - (double)pound_request_scratch(largest) +
	                 (double)pound_ordinate_bytes(study, largest.tasks + largest.rows.tasks)) +
	       n_workers * (double)sizeof(double) * (double)pound_run_reduction_size(c);
}
