/* run_growth.c - a design that grows until every interval that counts is narrow, and results of its first rows.
 *
 * 1. Each look (interim analysis) finds, after its reductions, the widest interval that counts over all cells, outputs and
 *    inputs: of S1 and ST, or of an ST whose interval overlaps another input's, so that their order is not certain.
 * 2. The design grows as long as this interval is too wide.
 *
 * Repeated looks at a design of 10 batches or more, or of Sobol' sequences that double, do not reduce the coverage of the
 * final intervals: tests/unit/run/unit_growth.c, and make statistics in detail. */
#include "engine/run/run.h"

#include <assert.h>
#include <math.h>

/* Number of looks if the design grows to its end. */
int pound_run_looks_most(const struct pound_study *study)
{
	int looks = 0, most = pound_design_rows_most(study);
	if (!pound_study_sampled(study) || !(study->design.until.half_width > 0))
		return 0;
	while (pound_design_rows(study, looks++) < most)
		;
	return looks;
}

/* Whether an interval of ST overlaps another input's; an undefined interval does. */
static bool overlaps(const struct pound_estimate *total, int n_inputs, int input)
{
	for (int j = 0; j < n_inputs; j++)
		if (j != input && !(total[j].low > total[input].high || total[j].high < total[input].low))
			return true;
	return false;
}

static void widen(struct pound_look *widest, const struct pound_look *at, const struct pound_study *study,
                  const struct pound_indices *indices)
{
	static const enum pound_index asked[] = {POUND_S1, POUND_ST};
	const bool order = study->design.until.goal == POUND_GOAL_ORDER;
	for (int k = order; k < 2; k++)
		for (int j = 0; j < study->n_inputs; j++) {
			const struct pound_estimate *e = &indices->index[asked[k]][j];
			double width = e->high - e->low, half = isnan(width) ? INFINITY : 0.5 * width;
			if (half > widest->half_width &&
			    (!order || overlaps(indices->index[POUND_ST], study->n_inputs, j)))
				*widest = (struct pound_look){.half_width = half,
				                              .cell = at->cell,
				                              .output = at->output,
				                              .input = j,
				                              .index = asked[k]};
		}
}

/* Whether the intervals of an output of a scene count. */
static bool awaited(const struct pound_study *study, int output, const struct pound_scene *scene)
{
	const int one = study->design.until.output;
	return study->elsewhere || (pound_output_applies(study->outputs[output], scene) &&
	                            (one == 0 || study->outputs[output] == one - 1));
}

/* The widest interval that counts.
 *
 * Given    cells       (of the study)    reduced
 * Returns  value       -                 all members except rows; the first of several equally wide ones
 *
 * A constant output has no indices and does not count; an index without an interval for any other reason has infinite
 * width.  Half width -1: no interval counts.
 *
 * Test     unit_growth: a_design_stops_at_the_first_look_that_finds_every_interval_narrow
 */
static struct pound_look widest_of(const struct pound_cells *campaign, const struct pound_cell *cells)
{
	const struct pound_study *study = campaign->study;
	struct pound_look widest = {.half_width = -1};
	for (int cell = 0; cell < campaign->n_cells; cell++) {
		const struct pound_scene scene = pound_cells_scene(campaign, cell, 0, 0, NULL);
		for (int output = 0; output < study->n_outputs; output++) {
			const struct pound_indices *indices = &cells[cell].indices[output];
			bool constant = indices->notes >> POUND_NOTE_CONSTANT & 1;
			if (!constant && awaited(study, output, &scene))
				widen(&widest, &(struct pound_look){.cell = cell, .output = output}, study, indices);
		}
	}
	return widest;
}

/* Checks the intervals after all reductions.
 *
 * Returns  value   true: the design grows: there are more blocks, and all reductions must be repeated
 * Test     unit_growth: a_design_stops_at_the_first_look_that_finds_every_interval_narrow
 */
bool pound_run_grow(struct pound_run *run)
{
	const struct pound_study *study = run->campaign.study;
	if (!(study->design.until.half_width > 0))
		return false;
	struct pound_look *look = &run->result.looks[run->result.n_looks++];
	*look = widest_of(&run->campaign, run->result.cells);
	look->rows = run->rows;
	run->rows = pound_design_rows(study, run->result.n_looks);
	bool grows = look->half_width > study->design.until.half_width && run->rows > look->rows;
	run->rows = grows ? run->rows : look->rows;
	return grows;
}

/* Number of complete rows at the start of the design.
 *
 * Given    done    (pound_run_blocks_most)    blocks run or restored
 * Test     unit_growth: an_intermediate_result_has_whole_rows_only
 */
int pound_run_rows_done(const struct pound_run *run, const bool *done)
{
	int blocks = 0;
	while (blocks < run->layout.n_blocks && done[blocks])
		blocks++;
	return run->layout.first[blocks] / run->campaign.n_signals;
}

/* Rows of an intermediate result that is made soon whatever the size of the design: its indices are made from so many outputs
 * of samples, which take about a tenth of a second, but from as many rows as all indices need.
 *
 * Returns  value   at most the rows of the design
 * Test     unit_growth: an_intermediate_result_that_is_made_soon_has_a_limit_of_its_work
 */
int pound_run_rows_quick(const struct pound_run *run)
{
	const struct pound_cells *c = &run->campaign;
	const int64_t of_row = (int64_t)c->n_cells * c->study->n_outputs * c->n_samples;
	const int rows = of_row > 0 ? (int)(POUND_VALUES_QUICK / of_row) : c->n_rows;
	const int enough = rows > POUND_ROWS_MIN ? rows : POUND_ROWS_MIN;
	return enough < c->n_rows ? enough : c->n_rows;
}

/* Restricts the following reductions and the result to the first rows of the design. */
void pound_run_rows_take(struct pound_run *run, int rows)
{
	assert(pound_study_sampled(run->campaign.study) && rows <= run->campaign.n_rows);
	run->rows = rows;
	run->result.rows_done = rows;
}

/* Of how many complete rows the result has the first.
 *
 * Given    run     rows taken
 *          rows    complete, at least as many as were taken
 */
void pound_run_rows_complete(struct pound_run *run, int rows)
{
	assert(rows >= run->rows);
	run->result.rows_done = rows;
}

int pound_run_rows(const struct pound_run *run)
{
	return run->rows;
}
