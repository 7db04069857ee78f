/* run.c - a study being computed: its memory, its blocks, its reductions.
 *
 * 1. create lays out everything: the design, the blocks (ranges of items, see plan.h), a plan for each worker;
 * 2. a block writes the measures of its runs into its own slice of `values`;
 * 3. a reduction turns the measures of one cell and output into its place of the result. */
#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "engine/accuracy.h"
#include "engine/convergence.h"
#include "engine/design.h"
#include "engine/excitation.h"
#include "engine/indices.h"
#include "engine/outputs.h"
#include "engine/run.h"

enum {
	BLOCK_RUNS = 768,        /* pounding runs of a block, about: enough to keep all lanes filled, soon done */
	BLOCK_SAMPLES = 1 << 21, /* of its ground motions at most, unless one item has more: 16 MiB */
	MEASURES = sizeof(struct pound_response) / sizeof(double),
	COUNTS = sizeof(struct pound_work) / sizeof(int64_t),
	CHECK_EVERY = 100, /* items between two checked ones */
	CHECKED_MIN = 8,   /* runs of a cell to check at least, if it has them */
	TRIAL_MEASURES = sizeof(struct pound_trial_run) / sizeof(double),
};

/* CPU time that a run is timed over at least [s]. */
static const double CLOCK_LEAST = 0.02;

static int runs_of_item(const struct pound_campaign *c)
{
	return c->n_cells * c->n_samples;
}

static int items_of(const struct pound_campaign *c)
{
	return c->n_rows * c->n_signals;
}

/* Doubles of an item's measures. */
static size_t item_size(const struct pound_run *run)
{
	return (size_t)runs_of_item(&run->campaign) * (size_t)run->n_measures;
}

/* How many items before this one are kept, checks counted as items. */
static size_t kept_before(const struct pound_run *run, int item)
{
	return (size_t)item + (size_t)pound_campaign_checks(&run->campaign, item);
}

/* Where a block's values begin. */
static double *block_values(const struct pound_run *run, int block)
{
	return run->values + kept_before(run, run->first[block]) * item_size(run) + (size_t)block * COUNTS;
}

/* The block that holds an item. */
static int block_of(const struct pound_run *run, int item)
{
	int low = 0, high = run->n_blocks;
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		if (run->first[middle] <= item)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* The measures of one run of the place-th item of a block. */
static const double *place_values(const struct pound_run *run, int block, int place, int cell, int sample)
{
	return block_values(run, block) + (size_t)place * item_size(run) +
	       (size_t)(cell * run->campaign.n_samples + sample) * (size_t)run->n_measures;
}

/* The measures of one run. */
const double *pound_run_values(const struct pound_run *run, int item, int cell, int sample)
{
	int block = block_of(run, item);
	return place_values(run, block, item - run->first[block], cell, sample);
}

/* The measures of the run that checks it. */
static const double *check_values(const struct pound_run *run, int item, int cell, int sample)
{
	const struct pound_campaign *c = &run->campaign;
	int block = block_of(run, item), first = run->first[block], n = run->first[block + 1] - first;
	int place = n + pound_campaign_checks(c, item) - pound_campaign_checks(c, first);
	return place_values(run, block, place, cell, sample);
}

/* ---- life ---- */

static struct pound_campaign campaign_of(const struct pound_study *study)
{
	bool sampled = study->kind == POUND_KIND_SENSITIVITY, trials = study->kind == POUND_KIND_CONVERGENCE;
	struct pound_campaign c = {.study = study,
	                           .n_cells = 1,
	                           .n_rows = sampled  ? pound_design_rows_most(study)
	                                     : trials ? pound_convergence_trials(study)
	                                              : 1,
	                           .n_samples = sampled ? study->n_inputs + 2 : 1,
	                           .n_signals = study->elsewhere ? 1 : study->scene.excitation.signals,
	                           .trials = trials};
	for (int s = 0; s < study->n_sweeps; s++)
		c.n_cells *= study->sweeps[s].n_values;
	int checked_min = (CHECKED_MIN + c.n_samples - 1) / c.n_samples, every = items_of(&c) / checked_min;
	if (sampled && !study->elsewhere)
		c.check_every = every > CHECK_EVERY ? CHECK_EVERY : every > 1 ? every : 1;
	return c;
}

static void size_add(struct pound_plan_size *block, struct pound_plan_size item, bool checked)
{
	int times = checked ? 2 : 1;
	block->asks += times * item.asks;
	block->motions += times * item.motions;
	block->tasks += times * item.tasks;
	block->samples += (checked ? 3 : 1) * item.samples;
}

/* Cuts the items into blocks and finds the largest; with first NULL only counts them.  What is run elsewhere is one. */
static int blocks_cut(const struct pound_campaign *c, int *first, struct pound_plan_size *largest)
{
	struct pound_plan_size block = {0};
	int n_blocks = c->study->elsewhere, n_items = items_of(c);
	struct pound_plan_size item = {0};
	for (int i = 0; i < n_items && !c->study->elsewhere; i++) {
		if (i % c->n_signals == 0)
			item = pound_plan_size(c, i / c->n_signals);
		bool full = block.asks + item.asks > BLOCK_RUNS || block.samples + item.samples > BLOCK_SAMPLES;
		bool solved = c->trials && i % c->n_signals == 0; // a block has one solver
		if (i == 0 || full || solved) {
			if (first)
				first[n_blocks] = i;
			n_blocks++;
			block = (struct pound_plan_size){0};
		}
		size_add(&block, item, pound_campaign_checks(c, i) < pound_campaign_checks(c, i + 1));
		largest->asks = block.asks > largest->asks ? block.asks : largest->asks;
		largest->motions = block.motions > largest->motions ? block.motions : largest->motions;
		largest->tasks = block.tasks > largest->tasks ? block.tasks : largest->tasks;
		largest->samples = block.samples > largest->samples ? block.samples : largest->samples;
	}
	if (first)
		first[n_blocks] = n_items;
	return n_blocks;
}

/* Runs of a cell that are checked. */
static int checks_of(const struct pound_campaign *c)
{
	return pound_campaign_checks(c, items_of(c)) * c->n_samples;
}

static size_t checks_size(const struct pound_campaign *c)
{
	return (size_t)checks_of(c) * (sizeof(struct pound_check) / sizeof(double));
}

/* Doubles a reduction works in: two columns of measures, the checks, and what the indexes and then their accuracy
 * need. */
static size_t reduction_size(const struct pound_campaign *c)
{
	const int n_rows = c->n_rows, n_inputs = c->study->n_inputs, n_signals = c->n_signals;
	if (c->study->n_outputs == 0)
		return 0;
	if (c->trials)
		return (size_t)items_of(c) * TRIAL_MEASURES;
	if (c->study->kind != POUND_KIND_SENSITIVITY)
		return 0;
	size_t variants = pound_variants_scratch(n_rows, n_inputs, n_signals);
	size_t accuracy = pound_accuracy_scratch(n_rows, n_inputs, n_signals, checks_of(c));
	return 2 * (size_t)n_rows * (size_t)c->n_samples * (size_t)n_signals + checks_size(c) +
	       (variants > accuracy ? variants : accuracy);
}

/* Allocates one piece of zeroed memory, 64-byte aligned; NULL: out of memory. */
static void *piece(size_t bytes)
{
	size_t whole = (bytes / 64 + 1) * 64;
	void *memory = aligned_alloc(64, whole);
	return memory ? memset(memory, 0, whole) : NULL;
}

static bool workers_create(struct pound_run *run, int n_workers, struct pound_plan_size largest)
{
	run->plans = piece(sizeof *run->plans * (size_t)(n_workers + 1)); // ends with NULL
	run->scratch = piece(sizeof *run->scratch * (size_t)(n_workers + 1));
	if (!run->plans || !run->scratch)
		return false;
	for (int w = 0; w < n_workers; w++) {
		void *memory = piece(pound_plan_bytes(largest));
		run->plans[w] = memory ? pound_plan_init(memory, largest) : NULL;
		run->scratch[w] = piece(sizeof(double) * reduction_size(&run->campaign));
		if (!run->plans[w] || !run->scratch[w])
			return false;
	}
	return true;
}

static bool result_create(struct pound_run *run)
{
	const struct pound_campaign *c = &run->campaign;
	const struct pound_study *study = c->study;
	size_t n_cells = (size_t)c->n_cells, n_outputs = (size_t)study->n_outputs;
	run->result.n_cells = c->n_cells;
	run->result.cells = piece(sizeof *run->result.cells * n_cells);
	run->responses = piece(sizeof *run->responses * n_cells * (size_t)c->n_signals);
	run->indices = piece(sizeof *run->indices * n_cells * n_outputs);
	run->estimates =
	    piece(sizeof *run->estimates * n_cells * n_outputs * POUND_N_INDEXES * (size_t)study->n_inputs);
	run->result.n_trials = c->trials ? c->n_rows : 0;
	run->result.trials = piece(sizeof *run->result.trials * (size_t)run->result.n_trials);
	if (!run->result.cells || !run->responses || !run->indices || !run->estimates || !run->result.trials)
		return false;
	for (int cell = 0; cell < c->n_cells; cell++) {
		struct pound_cell *into = &run->result.cells[cell];
		for (int s = 0; s < study->n_sweeps; s++)
			into->sweep[s] = pound_campaign_sweep(c, cell, s);
		into->n_signals = c->n_signals;
		into->signals = &run->responses[cell * c->n_signals];
		into->indices = &run->indices[cell * study->n_outputs];
		into->runs = (int64_t)items_of(c) * c->n_samples;
		for (int o = 0; o < study->n_outputs; o++) {
			size_t first = ((size_t)cell * n_outputs + (size_t)o) * POUND_N_INDEXES;
			for (size_t k = 0; k < POUND_N_INDEXES; k++)
				into->indices[o].index[k] = &run->estimates[(first + k) * (size_t)study->n_inputs];
		}
	}
	return true;
}

/* A study laid out to be computed by n_workers threads; allocates all it will ever need. */
struct pound_run *pound_run_create(const struct pound_study *study, int n_workers)
{
	assert(n_workers >= 1);
	struct pound_run *run = piece(sizeof *run);
	if (!run)
		return NULL;
	run->campaign = campaign_of(study);
	run->n_measures = study->kind == POUND_KIND_SENSITIVITY   ? 2 * study->n_outputs
	                  : study->kind == POUND_KIND_CONVERGENCE ? (int)TRIAL_MEASURES
	                                                          : (int)MEASURES;
	size_t n_design = 2 * (size_t)run->campaign.n_rows * (size_t)study->n_inputs;
	double *design = piece(sizeof(double) * n_design);
	run->campaign.design = design;
	run->u = piece(sizeof(double) * n_design);
	if (!design || !run->u)
		goto fail;
	if (study->kind == POUND_KIND_SENSITIVITY) {
		pound_design_probabilities(study, run->u);
		pound_design_fill(study, design);
	}
	struct pound_plan_size largest = {0};
	run->n_blocks = blocks_cut(&run->campaign, NULL, &largest);
	run->first = piece(sizeof *run->first * (size_t)(run->n_blocks + 1));
	if (!run->first)
		goto fail;
	blocks_cut(&run->campaign, run->first, &largest);
	run->values = piece(sizeof(double) * (kept_before(run, items_of(&run->campaign)) * item_size(run) +
	                                      (size_t)run->n_blocks * COUNTS));
	if (!run->values || !workers_create(run, n_workers, largest) || !result_create(run))
		goto fail;
	return run;
fail:
	pound_run_free(run);
	return NULL;
}

void pound_run_free(struct pound_run *run)
{
	if (!run)
		return;
	for (int w = 0; run->plans && run->plans[w]; w++)
		free(run->plans[w]);
	for (int w = 0; run->scratch && run->scratch[w]; w++)
		free(run->scratch[w]);
	void *const pieces[] = {(void *)run->campaign.design,
	                        run->u,
	                        run->first,
	                        run->values,
	                        run->plans,
	                        run->scratch,
	                        run->result.cells,
	                        run->result.trials,
	                        run->responses,
	                        run->indices,
	                        run->estimates};
	for (size_t j = 0; j < sizeof pieces / sizeof pieces[0]; j++)
		free(pieces[j]);
	free(run);
}

void pound_run_stop(struct pound_run *run)
{
	atomic_store(&run->stop, true);
}

void pound_run_clock(struct pound_run *run, double (*cpu)(void))
{
	run->cpu = cpu;
}

/* ---- blocks ---- */

int pound_run_blocks(const struct pound_run *run)
{
	return run->campaign.study->elsewhere ? 0 : run->n_blocks;
}

int64_t pound_run_block_runs(const struct pound_run *run, int block)
{
	return (int64_t)(run->first[block + 1] - run->first[block]) * runs_of_item(&run->campaign);
}

size_t pound_run_block_size(const struct pound_run *run, int block)
{
	size_t n = kept_before(run, run->first[block + 1]) - kept_before(run, run->first[block]);
	return n * item_size(run) + COUNTS;
}

const double *pound_run_block_values(const struct pound_run *run, int block)
{
	return block_values(run, block);
}

void pound_run_block_restore(struct pound_run *run, int block, const double *values)
{
	memcpy(block_values(run, block), values, sizeof(double) * pound_run_block_size(run, block));
}

struct slice {
	const struct pound_study *study;
	double *at; /* the next run's measures */
};

/* Keeps of a response what the study's outputs need; NAN for a failed run. */
static void response_keep(void *into, const struct pound_scene *scene, const struct pound_response *response,
                          enum pound_status status)
{
	struct slice *slice = into;
	if (slice->study->kind == POUND_KIND_CONVERGENCE) {
		struct pound_trial_run *trial = (struct pound_trial_run *)slice->at;
		*trial = (struct pound_trial_run){.displacement = status ? NAN : response->displacement_max_1,
		                                  .demand = status ? NAN : response->demand_1,
		                                  .impulse = status ? NAN : response->impulse_max,
		                                  .cpu = NAN};
		slice->at += TRIAL_MEASURES;
		return;
	}
	if (slice->study->kind == POUND_KIND_RESPONSE) {
		memcpy(slice->at, response, sizeof *response);
		for (size_t j = 0; j < MEASURES && status; j++)
			slice->at[j] = NAN;
		slice->at += MEASURES;
		return;
	}
	for (int o = 0; o < slice->study->n_outputs; o++, slice->at += 2) {
		slice->at[0] = slice->at[1] = 0;
		if (pound_output_applies(slice->study->outputs[o], scene))
			pound_outputs_measure(slice->study->outputs[o], scene, response, &slice->at[0], &slice->at[1]);
		if (status)
			slice->at[0] = slice->at[1] = NAN;
	}
}

/* CPU time of a run in the plan's last block, NAN without a clock: as many rounds as can be told from its ticks. */
static double run_time(const struct pound_run *run, struct pound_plan *plan,
                       const struct pound_solver *solver)
{
	int n = 0;
	if (!run->cpu)
		return NAN;
	double start = run->cpu(), now;
	do {
		n += pound_plan_repeat(plan, solver, &run->stop);
		now = run->cpu();
	} while (now - start < CLOCK_LEAST && n > 0 && !run->stop);
	return n > 0 ? (now - start) / n : NAN;
}

/* Adds to a block of one trial the histories and the time of a run. */
static enum pound_status trial_block(const struct pound_run *run, struct pound_plan *plan, int first, int n,
                                     struct pound_trial_run *runs)
{
	const struct pound_campaign *c = &run->campaign;
	const struct pound_solver solver = pound_campaign_solver(c, first / c->n_signals);
	int samples[POUND_HISTORY], n_times = pound_convergence_times(c->study, samples);
	for (int item = 0; item < n; item++)
		for (int k = 0; k < n_times; k++)
			if (pound_plan_displacement(plan, &solver, item, samples[k], &run->stop, &runs[item].history[k]))
				runs[item].history[k] = NAN;
	double cpu = run_time(run, plan, &solver);
	for (int item = 0; item < n; item++)
		runs[item].cpu = cpu;
	return atomic_load(&run->stop) ? POUND_STOPPED : POUND_OK;
}

/* Computes a block into its slice of the values.
 *
 * Status   POUND_STOPPED  pound_run_stop was called; the block's values are not to be used
 */
enum pound_status pound_run_block(struct pound_run *run, int block, int worker)
{
	struct slice slice = {.study = run->campaign.study, .at = block_values(run, block)};
	struct pound_work work = {0};
	int first = run->first[block], n = run->first[block + 1] - first;
	enum pound_status status = pound_plan_run(run->plans[worker], &run->campaign, first, n, &run->stop, &work,
	                                          response_keep, &slice);
	if (!status && run->campaign.trials)
		status = trial_block(run, run->plans[worker], first, n,
		                     (struct pound_trial_run *)block_values(run, block));
	if (status)
		return status;
	const int64_t *counts = (const int64_t *)&work;
	for (int j = 0; j < (int)COUNTS; j++)
		*slice.at++ = (double)counts[j];
	return POUND_OK;
}

/* ---- reductions ---- */

static bool has_indices(const struct pound_run *run)
{
	return run->campaign.study->kind == POUND_KIND_SENSITIVITY;
}

/* One for each output of each cell; one for all trials. */
int pound_run_reductions(const struct pound_run *run)
{
	if (run->campaign.trials)
		return 1;
	return run->campaign.n_cells * run->campaign.study->n_outputs;
}

/* The measures of an output in a cell as columns (rows x samples x signals); returns the failed runs. */
static int64_t columns_fill(const struct pound_run *run, int cell, int output, double *numerator,
                            double *denominator)
{
	const struct pound_campaign *c = &run->campaign;
	int64_t failed = 0;
	for (int row = 0; row < c->n_rows; row++)
		for (int signal = 0; signal < c->n_signals; signal++)
			for (int sample = 0; sample < c->n_samples; sample++) {
				const double *values =
				    pound_run_values(run, row * c->n_signals + signal, cell, sample) + 2 * output;
				size_t at = ((size_t)row * (size_t)c->n_samples + (size_t)sample) * (size_t)c->n_signals +
				            (size_t)signal;
				numerator[at] = values[0];
				denominator[at] = values[1];
				failed += isnan(values[0]) || (isnan(values[1]) && !c->study->elsewhere);
			}
	return failed;
}

/* The runs of an output in a cell that were made twice; returns how many. */
static int checks_fill(const struct pound_run *run, int cell, int output, struct pound_check *checks)
{
	const struct pound_campaign *c = &run->campaign;
	int n = 0;
	for (int item = 0; item < items_of(c) && c->check_every; item += c->check_every)
		for (int sample = 0; sample < c->n_samples; sample++) {
			const double *run_once = pound_run_values(run, item, cell, sample) + 2 * output;
			const double *again = check_values(run, item, cell, sample) + 2 * output;
			checks[n++] = (struct pound_check){.row = item / c->n_signals,
			                                   .sample = sample,
			                                   .numerator = {run_once[0], again[0]},
			                                   .denominator = {run_once[1], again[1]}};
		}
	return n;
}

static bool any_known(const double *variance, size_t n)
{
	for (size_t k = 0; k < n; k++)
		if (!isnan(variance[k]))
			return true;
	return false;
}

static void indices_reduce(struct pound_run *run, int cell, int output, double *scratch)
{
	const struct pound_campaign *c = &run->campaign;
	size_t n = (size_t)c->n_rows * (size_t)c->n_samples * (size_t)c->n_signals;
	const bool elsewhere = c->study->elsewhere;
	struct pound_sample_values values = {.n_rows = c->n_rows,
	                                     .n_inputs = c->study->n_inputs,
	                                     .n_signals = c->n_signals,
	                                     .numerator = scratch,
	                                     .denominator = elsewhere ? NULL : scratch + n,
	                                     .variance = elsewhere ? scratch + n : NULL,
	                                     .grouping = pound_design_grouping(c->study)};
	struct pound_cell *into = &run->result.cells[cell];
	int64_t failed = columns_fill(run, cell, output, scratch, scratch + n);
	const struct pound_sampling sampling = {
	    .u = run->u,
	    .random =
	        elsewhere ? any_known(values.variance, n) : pound_excitation_random(&c->study->scene.excitation),
	    .fresh_signals = !c->study->design.common_signals,
	    .quasi_random = pound_design_quasi_random(c->study->design.method)};
	struct pound_checks checks = {.check = (struct pound_check *)(scratch + 2 * n)};
	checks.n = checks_fill(run, cell, output, checks.check);
	double *rest = scratch + 2 * n + checks_size(c);
	int dropped =
	    pound_variants_indices(&values, &sampling, c->study->design.seed, rest, &into->indices[output]);
	pound_accuracy_estimate(&values, checks, dropped, c->study->design.seed, rest, &into->indices[output]);
	if (output == 0) {
		into->runs_failed = failed;
		into->rows_dropped = dropped;
	}
}

static bool failed(const struct pound_response *response)
{
	return isnan(response->displacement_max_1);
}

/* Ratio of means over the signals whose run has a result. */
static void responses_reduce(struct pound_run *run, int cell, int output)
{
	const struct pound_campaign *c = &run->campaign;
	struct pound_cell *into = &run->result.cells[cell];
	struct pound_scene scene = pound_campaign_scene(c, cell, 0, 0);
	int row = c->study->outputs[output];
	double above = 0, below = 0;
	for (int signal = 0; signal < c->n_signals; signal++) {
		struct pound_response response;
		memcpy(&response, pound_run_values(run, signal, cell, 0), sizeof response);
		if (failed(&response))
			continue;
		double numerator = NAN, denominator = NAN;
		if (pound_output_applies(row, &scene))
			pound_outputs_measure(row, &scene, &response, &numerator, &denominator);
		above += numerator;
		below += denominator;
	}
	into->outputs[output] = below > 0 ? above / below : NAN;
}

static void trials_reduce(struct pound_run *run, double *scratch)
{
	int n = items_of(&run->campaign);
	for (int item = 0; item < n; item++)
		memcpy(scratch + (size_t)item * TRIAL_MEASURES, pound_run_values(run, item, 0, 0),
		       sizeof(double) * TRIAL_MEASURES);
	pound_convergence_reduce(run->campaign.study, (const struct pound_trial_run *)scratch,
	                         run->result.trials);
	run->result.cells[0].runs_failed = 0;
	for (int j = 0; j < run->result.n_trials; j++)
		run->result.cells[0].runs_failed += run->result.trials[j].runs_failed;
}

/* The work of all blocks. */
static struct pound_work work_of(const struct pound_run *run)
{
	struct pound_work work = {0};
	int64_t *counts = (int64_t *)&work;
	for (int b = 0; b < run->n_blocks; b++) {
		const double *counted = block_values(run, b) + pound_run_block_size(run, b) - COUNTS;
		for (int j = 0; j < (int)COUNTS; j++)
			counts[j] += (int64_t)counted[j];
	}
	return work;
}

/* The status of most runs where none has a result, POUND_OK where one has. */
static enum pound_status nothing_left(const struct pound_run *run)
{
	struct pound_work work = work_of(run);
	int64_t failed_runs = 0;
	int most = 0;
	for (int k = 0; k < POUND_N_FAILURES; k++) {
		failed_runs += work.failed[k];
		most = work.failed[k] > work.failed[most] ? k : most;
	}
	return run->campaign.study->elsewhere || failed_runs < work.pounding_runs.asked
	           ? POUND_OK
	           : (enum pound_status)(POUND_CHATTER - most);
}

/* Computes one output of one cell, once all blocks are done; the first also looks whether there is anything to reduce.
 *
 * Status   POUND_STOPPED  pound_run_stop was called
 *          that of runs   no run of the study has a result, most of them for this reason
 * Test     unit_status: a_study_without_a_result_ends_with_the_reason_of_its_runs
 */
enum pound_status pound_run_reduce(struct pound_run *run, int reduction, int worker)
{
	int n_outputs = run->campaign.study->n_outputs;
	if (atomic_load(&run->stop))
		return POUND_STOPPED;
	enum pound_status status = reduction == 0 ? nothing_left(run) : POUND_OK;
	if (status)
		return status;
	if (run->campaign.trials)
		trials_reduce(run, run->scratch[worker]);
	else if (has_indices(run))
		indices_reduce(run, reduction / n_outputs, reduction % n_outputs, run->scratch[worker]);
	else
		responses_reduce(run, reduction / n_outputs, reduction % n_outputs);
	return POUND_OK;
}

/* The result, once all reductions are done; owned by run. */
const struct pound_result *pound_run_result(struct pound_run *run)
{
	const struct pound_campaign *c = &run->campaign;
	run->result.work = work_of(run);
	for (int cell = 0; cell < c->n_cells && c->study->kind == POUND_KIND_RESPONSE; cell++) {
		struct pound_cell *into = &run->result.cells[cell];
		into->runs_failed = 0;
		for (int signal = 0; signal < c->n_signals; signal++) {
			memcpy(&into->signals[signal], pound_run_values(run, signal, cell, 0),
			       sizeof into->signals[signal]);
			into->runs_failed += failed(&into->signals[signal]);
		}
	}
	return &run->result;
}
