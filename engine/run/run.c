/* run.c - the computation of a study: its memory, its blocks, its reductions.
 *
 * 1. create allocates everything: the design, the blocks (ranges of items, see blocks.h), a request for each worker;
 * 2. a block writes the measures of its runs into its own slice of `values`;
 * 3. a reduction computes the result of one cell and output from the measures. */
#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "engine/design/design.h"
#include "engine/ground/excitation.h"
#include "engine/indices/error_budget.h"
#include "engine/indices/indices.h"
#include "engine/run/floor_outputs.h"
#include "engine/run/outputs.h"
#include "engine/run/row_response.h"
#include "engine/run/run.h"
#include "engine/run/separation_outputs.h"
#include "engine/run/trials.h"

enum {
	MEASURES = offsetof(struct pound_response, floors) / sizeof(double),
	COUNTS = sizeof(struct pound_work) / sizeof(int64_t),
	CHECK_EVERY = 100, /* distance of checked items */
	CHECKED_MIN = 8,   /* least number of checked runs per cell, if it has so many */
	COLUMNS = POUND_N_INDICES + POUND_N_NAMED + POUND_CURVE, /* estimates per input */
};

/* ---- creation ---- */

/* Doubles kept per response. */
static int response_measures(const struct pound_study *study)
{
	const size_t all = sizeof(struct pound_response) / sizeof(double);
	return study->scene.n_buildings                        ? pound_row_measures(study)
	       : pound_outputs_asked(study) & POUND_ASKS_CHAIN ? (int)all
	                                                       : (int)MEASURES;
}

/* The scenes of a study, without its design. */
struct pound_cells pound_run_campaign(const struct pound_study *study)
{
	bool sampled = pound_study_sampled(study), trials = study->kind == POUND_KIND_CONVERGENCE;
	struct pound_cells c = {.study = study,
	                        .n_cells = 1,
	                        .n_rows = sampled  ? pound_design_rows_most(study)
	                                  : trials ? pound_convergence_trials(study)
	                                           : 1,
	                        .n_samples = sampled ? pound_design_samples(study) : 1,
	                        .n_signals = study->replicates  ? study->replicates
	                                     : study->elsewhere ? 1
	                                                        : study->scene.excitation.signals,
	                        .trials = trials};
	for (int s = 0; s < study->n_sweeps; s++)
		c.n_cells *= study->sweeps[s].n_values;
	int checked_min = (CHECKED_MIN + c.n_samples - 1) / c.n_samples,
	    every = pound_blocks_items(&c) / checked_min;
	if ((sampled && !study->elsewhere) || study->kind == POUND_KIND_FLOOR_SPECTRUM)
		c.check_every = every > CHECK_EVERY ? CHECK_EVERY : every > 1 ? every : 1;
	return c;
}

/* The contents of the blocks, before the items are cut into blocks. */
struct pound_blocks pound_run_layout(const struct pound_cells *campaign)
{
	const struct pound_study *study = campaign->study;
	return (struct pound_blocks){.campaign = campaign,
	                             .n_measures =
	                                 pound_ordinate_measures(study) +
	                                 (pound_study_sampled(study) || study->kind == POUND_KIND_SEPARATION
	                                      ? 2 * study->n_outputs
	                                  : study->kind == POUND_KIND_CONVERGENCE ? (int)POUND_TRIAL_MEASURES
	                                  : study->kind == POUND_KIND_RESPONSE    ? response_measures(study)
	                                                                          : 0),
	                             .n_counts = COUNTS};
}

/* Runs of a cell that are checked. */
static int checks_of(const struct pound_cells *c)
{
	return pound_cells_checks(c, pound_blocks_items(c)) * c->n_samples;
}

static size_t checks_size(const struct pound_cells *c)
{
	return (size_t)checks_of(c) * (sizeof(struct pound_check) / sizeof(double));
}

/* Doubles that a worker keeps from one reduction to the next, at the start of its scratch. */
size_t pound_run_kept_size(const struct pound_cells *c)
{
	const struct pound_sample_values shape = pound_cells_values(c, c->n_rows, NULL);
	return pound_chaos_expansion_kept_size(&shape);
}

/* Scratch of a reduction in doubles: kept factors, two columns of measures, the checks, and the scratch of the indices or of
 * their accuracy. */
size_t pound_run_reduction_size(const struct pound_cells *c)
{
	if (c->study->kind == POUND_KIND_FLOOR_SPECTRUM)
		return pound_ordinate_scratch(c->study, c->n_rows);
	if (c->study->kind == POUND_KIND_RESPONSE)
		return pound_row_bytes(&c->study->scene) / sizeof(double);
	if (c->study->n_outputs == 0)
		return 0;
	if (c->trials)
		return (size_t)pound_blocks_items(c) * POUND_TRIAL_MEASURES;
	if (!pound_study_sampled(c->study))
		return pound_separation_scratch(c);
	const struct pound_sample_values shape = pound_cells_values(c, c->n_rows, NULL);
	const struct pound_sampling wanted = {.estimator = c->study->design.estimator,
	                                      .ratios = c->study->n_ratios ? c->study : NULL};
	size_t variants = pound_index_columns_scratch(&shape, &wanted);
	size_t accuracy = (size_t)checks_of(c);
	size_t ordinates = pound_ordinate_scratch(c->study, c->n_rows);
	size_t most = variants > accuracy ? variants : accuracy;
	// the kept factors must not be overwritten
	const size_t whole = 2 * pound_cells_values_size(c, c->n_rows) + checks_size(c) +
	                     (most > ordinates ? most : ordinates),
	             separation = pound_separation_scratch(c);
	return pound_run_kept_size(c) + (whole > separation ? whole : separation);
}

/* Allocates scratch memory, 64-byte aligned; NULL: out of memory.  It is not zeroed, because a small study touches little of
 * it: only for users that write before they read. */
void *pound_run_room(size_t bytes)
{
	return aligned_alloc(64, (bytes / 64 + 1) * 64);
}

/* Allocates zeroed memory, 64-byte aligned; NULL: out of memory. */
void *pound_run_piece(size_t bytes)
{
	void *memory = pound_run_room(bytes);
	return memory ? memset(memory, 0, bytes) : NULL;
}

static bool workers_create(struct pound_run *run, int n_workers, struct pound_request_size largest)
{
	run->requests = pound_run_piece(sizeof *run->requests * (size_t)(n_workers + 1)); // ends with NULL
	run->scratch = pound_run_piece(sizeof *run->scratch * (size_t)(n_workers + 1));
	run->floors = pound_run_piece(sizeof *run->floors * (size_t)(n_workers + 1));
	if (!run->requests || !run->scratch || !run->floors)
		return false;
	const int tasks = largest.tasks + largest.rows.tasks;
	size_t spectra = pound_ordinate_bytes(run->campaign.study, tasks);
	for (int w = 0; w < n_workers; w++) {
		void *memory = pound_run_room(pound_request_bytes(largest));
		run->requests[w] = memory ? pound_request_init(memory, largest) : NULL;
		// zeroed, because it begins with the factors of pound_chaos_expansion_kept_size()
		run->scratch[w] = pound_run_piece(sizeof(double) * pound_run_reduction_size(&run->campaign));
		memory = spectra ? pound_run_room(spectra) : NULL;
		run->floors[w] = memory ? pound_ordinate_init(memory, run->campaign.study, tasks) : NULL;
		if (!run->requests[w] || !run->scratch[w] || (spectra && !memory))
			return false;
	}
	return true;
}

/* The memory blocks of the result. */
void pound_run_result_parts(struct pound_run *run, struct pound_run_part parts[POUND_RUN_PARTS])
{
	const struct pound_cells *c = &run->campaign;
	const struct pound_study *study = c->study;
	const size_t n_cells = (size_t)c->n_cells, n_indices = n_cells * (size_t)study->n_outputs;
	run->result.n_trials = c->trials ? c->n_rows : 0;
	const struct pound_run_part all[POUND_RUN_PARTS] = {
	    {&run->result.cells, sizeof *run->result.cells * n_cells},
	    {&run->responses, sizeof *run->responses * n_cells * (size_t)c->n_signals},
	    {&run->row_responses,
	     sizeof *run->row_responses * (study->scene.n_buildings ? n_cells * (size_t)c->n_signals : 0)},
	    {&run->indices, sizeof *run->indices * n_indices},
	    {&run->estimates, sizeof *run->estimates * n_indices * COLUMNS * (size_t)study->n_inputs},
	    {&run->result.trials, sizeof *run->result.trials * (size_t)run->result.n_trials},
	    {&run->spectra, sizeof *run->spectra * POUND_N_SPECTRA * 4 * (size_t)study->spectrum.n},
	    {&run->result.looks, sizeof *run->result.looks * (size_t)pound_run_looks_most(study)},
	    {&run->references, sizeof *run->references * 2 * (size_t)study->scene.excitation.n_records},
	    {&run->records, sizeof *run->records * (pound_run_suite(study) ? n_cells * (size_t)c->n_signals : 0)},
	    {&run->separation, pound_separation_bytes(c)},
	};
	memcpy(parts, all, sizeof all);
}

bool pound_run_result_create(struct pound_run *run)
{
	const struct pound_cells *c = &run->campaign;
	const struct pound_study *study = c->study;
	const size_t n_outputs = (size_t)study->n_outputs;
	struct pound_run_part parts[POUND_RUN_PARTS];
	run->result.n_cells = c->n_cells;
	pound_run_result_parts(run, parts);
	for (int j = 0; j < POUND_RUN_PARTS; j++)
		if (!(*(void **)parts[j].into = pound_run_piece(parts[j].bytes)))
			return false;
	pound_ordinate_layout(study, run->spectra, &run->result.floor);
	pound_separation_layout(c, run->separation, &run->result.separation);
	for (int cell = 0; cell < c->n_cells; cell++) {
		struct pound_cell *into = &run->result.cells[cell];
		for (int s = 0; s < study->n_sweeps; s++)
			into->sweep[s] = pound_cells_sweep(c, cell, s);
		into->n_signals = c->n_signals;
		into->signals = &run->responses[cell * c->n_signals];
		into->rows = study->scene.n_buildings ? &run->row_responses[cell * c->n_signals] : NULL;
		into->records = pound_run_suite(study) ? &run->records[cell * c->n_signals] : NULL;
		into->indices = &run->indices[cell * study->n_outputs];
		for (int o = 0; o < study->n_outputs; o++) {
			size_t first = ((size_t)cell * n_outputs + (size_t)o) * COLUMNS;
			struct pound_estimate *column = &run->estimates[first * (size_t)study->n_inputs];
			for (int k = 0; k < POUND_N_INDICES; k++, column += study->n_inputs)
				into->indices[o].index[k] = column;
			for (int k = 0; k < POUND_N_NAMED; k++, column += study->n_inputs)
				into->indices[o].named[k] = column;
			into->indices[o].curves = (struct pound_curve *)column;
		}
	}
	return true;
}

static bool suite_scale(struct pound_run *run, const atomic_bool *stop)
{
	void *scratch = pound_run_piece(pound_run_scale_bytes(run->campaign.study)); // temporary
	const bool scaled = scratch && pound_run_scale(run, scratch, stop);
	free(scratch);
	return scaled;
}

/* Chooses the number of signals of a split study by a pilot; false: no memory, or stop was set. */
static bool pilot_run(struct pound_run *run, const atomic_bool *stop)
{
	const struct pound_study study = pound_pilot_study(&run->study);
	struct pound_run *pilot = pound_run_create_by(&study, 1, stop);
	double *scratch = pilot ? pound_run_room(sizeof *scratch * pound_pilot_scratch(pilot)) : NULL;
	if (pilot && stop)
		pilot->stop = stop;
	const bool done = scratch && !pound_pilot_run(run, pilot, scratch);
	free(scratch);
	pound_run_free(pilot);
	return done;
}

struct pound_run *pound_run_create(const struct pound_study *study, int n_workers)
{
	return pound_run_create_by(study, n_workers, NULL);
}

/* Prepares a study for n_workers threads; allocates all memory of the run.
 *
 * Given    stop    checked while the design is drawn; NULL: never
 * Returns  value   NULL: out of memory, or stop was set
 * Test     unit_stop: what_takes_long_ends_soon_when_it_is_stopped
 */
struct pound_run *pound_run_create_by(const struct pound_study *study, int n_workers, const atomic_bool *stop)
{
	assert(n_workers >= 1);
	struct pound_run *run = pound_run_piece(sizeof *run);
	if (!run)
		return NULL;
	run->stop = &run->stopped;
	run->study = *study;
	study = &run->study;
	if (study->design.split && !pilot_run(run, stop))
		goto fail;
	run->campaign = pound_run_campaign(study);
	run->rows = pound_study_sampled(study) ? pound_design_rows(study, 0) : run->campaign.n_rows;
	run->layout = pound_run_layout(&run->campaign);
	size_t n_design = 2 * (size_t)run->campaign.n_rows * (size_t)study->n_inputs;
	double *design = pound_run_piece(sizeof(double) * n_design);
	run->campaign.design = design;
	run->u = pound_run_piece(sizeof(double) * n_design);
	if (!design || !run->u)
		goto fail;
	if (pound_study_sampled(study)) {
		pound_design_probabilities(study, stop, run->u);
		pound_design_values(study, run->u, stop, design);
	}
	if (pound_stopped(stop))
		goto fail;
	struct pound_request_size largest = {0};
	run->layout.n_blocks = pound_blocks_cut(&run->campaign, NULL, &largest);
	run->layout.first = pound_run_piece(sizeof *run->layout.first * (size_t)(run->layout.n_blocks + 1));
	if (!run->layout.first || pound_stopped(stop))
		goto fail;
	pound_blocks_cut(&run->campaign, run->layout.first, &largest);
	run->layout.values = pound_run_piece(sizeof(double) * pound_blocks_doubles(&run->layout));
	if (!run->layout.values || !workers_create(run, n_workers, largest) || !pound_run_result_create(run) ||
	    !suite_scale(run, stop))
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
	if (run->view) {
		run->campaign.design = run->u = run->layout.values = NULL;
		run->layout.first = NULL;
	}
	for (int w = 0; run->requests && run->requests[w]; w++)
		free(run->requests[w]);
	for (int w = 0; run->scratch && run->scratch[w]; w++)
		free(run->scratch[w]);
	for (int w = 0; run->floors && run->floors[w]; w++)
		free(run->floors[w]);
	void *const pieces[] = {(void *)run->campaign.design,
	                        run->u,
	                        run->layout.first,
	                        run->layout.values,
	                        run->requests,
	                        run->scratch,
	                        run->floors,
	                        run->spectra,
	                        run->result.cells,
	                        run->result.trials,
	                        run->result.looks,
	                        run->responses,
	                        run->row_responses,
	                        run->references,
	                        run->records,
	                        run->indices,
	                        run->estimates,
	                        run->separation};
	for (size_t j = 0; j < sizeof pieces / sizeof pieces[0]; j++)
		free(pieces[j]);
	free(run);
}

void pound_run_stop(struct pound_run *run)
{
	atomic_store(&run->stopped, true);
}

void pound_run_stop_by(struct pound_run *run, const atomic_bool *stop)
{
	run->stop = stop;
}

bool pound_run_stopped(const struct pound_run *run)
{
	return pound_stopped(run->stop);
}

void pound_run_clock(struct pound_run *run, double (*cpu)(void))
{
	run->cpu = cpu;
}

/* ---- blocks ---- */

/* Blocks of the current rows. */
static int blocks_in_hand(const struct pound_run *run)
{
	return run->rows ? pound_blocks_block_of(&run->layout, run->rows * run->campaign.n_signals - 1) + 1 : 0;
}

int pound_run_blocks(const struct pound_run *run)
{
	return run->campaign.study->elsewhere ? 0 : blocks_in_hand(run);
}

int pound_run_blocks_most(const struct pound_run *run)
{
	return run->layout.n_blocks;
}

int64_t pound_run_block_runs(const struct pound_run *run, int block)
{
	return pound_blocks_block_runs(&run->layout, block);
}

size_t pound_run_block_size(const struct pound_run *run, int block)
{
	return pound_blocks_block_doubles(&run->layout, block);
}

const double *pound_run_block_values(const struct pound_run *run, int block)
{
	return pound_blocks_block(&run->layout, block);
}

void pound_run_block_restore(struct pound_run *run, int block, const double *values)
{
	memcpy(pound_blocks_block(&run->layout, block), values,
	       sizeof(double) * pound_run_block_size(run, block));
}

struct slice {
	const struct pound_study *study;
	double *at; /* the next run's measures */
};

/* Stores the measures of a response that the study's outputs need; NAN for a failed run. */
static void response_keep(void *into, const struct pound_outcome *outcome)
{
	struct slice *slice = into;
	const struct pound_scene *scene = outcome->scene;
	const struct pound_response *response = outcome->pair;
	const enum pound_status status = outcome->status;
	if (slice->study->kind == POUND_KIND_CONVERGENCE && scene->n_buildings) {
		pound_row_trial(outcome, (struct pound_trial_run *)slice->at);
		slice->at += POUND_TRIAL_MEASURES;
		return;
	}
	if (slice->study->kind == POUND_KIND_CONVERGENCE) {
		struct pound_trial_run *trial = (struct pound_trial_run *)slice->at;
		*trial = (struct pound_trial_run){.displacement = status ? NAN : response->displacement_max_1,
		                                  .demand = status ? NAN : response->demand_1,
		                                  .impulse = status ? NAN : response->impulse_max,
		                                  .cpu = NAN};
		slice->at += POUND_TRIAL_MEASURES;
		return;
	}
	if (slice->study->kind == POUND_KIND_RESPONSE && scene->n_buildings) {
		pound_row_keep(outcome, response_measures(slice->study), slice->at);
		slice->at += response_measures(slice->study);
		return;
	}
	if (slice->study->kind == POUND_KIND_RESPONSE) {
		const int n = response_measures(slice->study);
		memcpy(slice->at, response, sizeof(double) * (size_t)n);
		for (int j = 0; j < n && status; j++)
			slice->at[j] = NAN;
		slice->at += n;
		return;
	}
	for (int o = 0; o < slice->study->n_outputs; o++, slice->at += 2) {
		slice->at[0] = slice->at[1] = 0;
		if (pound_output_applies(slice->study->outputs[o], scene))
			pound_outputs_measure(slice->study, o, outcome, &slice->at[0], &slice->at[1]);
		if (status)
			slice->at[0] = slice->at[1] = NAN;
	}
	int n = pound_ordinate_measures(slice->study);
	for (int j = 0; j < n; j++) // spectra are filled in later
		*slice->at++ = status               ? NAN
		               : scene->n_buildings ? pound_row_impulse(outcome)
		                                    : response->impulse_max / scene->oscillators[0].mass;
}

/* Computes a block into its slice of the values.
 *
 * Status   POUND_STOPPED  pound_run_stop was called; the block's values must not be used
 *          POUND_NOMEM    no memory for a run; values must not be used either; the block may be tried again
 */
enum pound_status pound_run_block(struct pound_run *run, int block, int worker)
{
	struct slice slice = {.study = run->campaign.study, .at = pound_blocks_block(&run->layout, block)};
	struct pound_work work = {0};
	int first = run->layout.first[block], n = run->layout.first[block + 1] - first;
	enum pound_status status =
	    pound_request_run(run->requests[worker], (struct pound_items){&run->campaign, first, n}, run->stop,
	                      &work, response_keep, &slice);
	if (!status && run->campaign.trials)
		status = pound_trials_block(run, run->requests[worker], first, n,
		                            (struct pound_trial_run *)pound_blocks_block(&run->layout, block));
	if (!status && run->floors[worker])
		status = pound_ordinate_block(run->floors[worker], run->campaign.study, run->requests[worker],
		                              pound_blocks_block(&run->layout, block), run->stop, &work);
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
	return pound_study_sampled(run->campaign.study);
}

/* One per output and cell; one for all trials, one for all spectra; one for all gaps needed, the last. */
int pound_run_reductions(const struct pound_run *run)
{
	if (run->campaign.trials || run->campaign.study->kind == POUND_KIND_FLOOR_SPECTRUM)
		return 1;
	const int indices = run->campaign.n_cells * run->campaign.study->n_outputs;
	if (run->campaign.study->kind == POUND_KIND_SEPARATION)
		return (has_indices(run) ? indices : 0) + 1;
	return indices;
}

/* The measures of an output in a cell as columns (rows x samples x signals); returns the failed runs. */
int64_t pound_run_columns(const struct pound_run *run, int cell, int output, double *numerator,
                          double *denominator)
{
	const struct pound_cells *c = &run->campaign;
	int64_t failed = 0;
	for (int row = 0; row < run->rows && !pound_stopped(run->stop); row++)
		for (int signal = 0; signal < c->n_signals; signal++) {
			// the samples of an item are one after the other: one search for its block
			const double *values =
			    pound_blocks_run(&run->layout, row * c->n_signals + signal, cell, 0) + 2 * output;
			for (int sample = 0; sample < c->n_samples; sample++, values += run->layout.n_measures) {
				size_t at = ((size_t)row * (size_t)c->n_samples + (size_t)sample) * (size_t)c->n_signals +
				            (size_t)signal;
				numerator[at] = values[0];
				denominator[at] = values[1];
				failed += isnan(values[0]) || (isnan(values[1]) && !pound_cells_means(c));
			}
		}
	return failed;
}

/* The checked runs of an output in a cell; returns how many. */
static int checks_fill(const struct pound_run *run, int cell, int output, struct pound_check *checks)
{
	const struct pound_cells *c = &run->campaign;
	int n = 0;
	for (int item = 0; item < run->rows * c->n_signals && c->check_every; item += c->check_every)
		for (int sample = 0; sample < c->n_samples; sample++) {
			const double *run_once = pound_blocks_run(&run->layout, item, cell, sample) + 2 * output;
			const double *again = pound_blocks_check(&run->layout, item, cell, sample) + 2 * output;
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

struct pound_sampling pound_run_sampling(const struct pound_run *run)
{
	const struct pound_study *study = run->campaign.study;
	const bool random = pound_excitation_random(&study->scene.excitation);
	return (struct pound_sampling){
	    .u = run->u,
	    .random = study->elsewhere || random,
	    // in a scene without random signals the samples of a row have no noise to share
	    .fresh_signals = !study->design.common_signals || (study->elsewhere && !random),
	    .n_resamples = study->design.resamples,
	    .quasi_random = pound_design_quasi_random(study->design.method),
	    .estimator = study->design.estimator,
	    .ratios = study->n_ratios ? study : NULL};
}

static void indices_reduce(struct pound_run *run, int cell, int output, double *kept)
{
	const struct pound_cells *c = &run->campaign;
	double *scratch = kept + pound_run_kept_size(c);
	struct pound_sample_values values = pound_cells_values(c, run->rows, scratch);
	values.stop = run->stop;
	const size_t n = pound_cells_values_size(c, run->rows);
	struct pound_cell *into = &run->result.cells[cell];
	int64_t failed = pound_run_columns(run, cell, output, scratch, scratch + n);
	struct pound_sampling sampling = pound_run_sampling(run);
	if (pound_cells_means(c))
		sampling.random = any_known(values.variance, n);
	sampling.kept = kept;
	struct pound_checks checks = {.check = (struct pound_check *)(scratch + 2 * n)};
	checks.n = checks_fill(run, cell, output, checks.check);
	double *rest = scratch + 2 * n + checks_size(c);
	if (pound_stopped(run->stop))
		return;
	int dropped =
	    pound_index_columns_indices(&values, &sampling, c->study->design.seed, rest, &into->indices[output]);
	if (pound_stopped(run->stop))
		return;
	// the note on common signals does not apply to replicates of a user's model
	if (c->study->elsewhere)
		into->indices[output].notes &= ~(1u << POUND_NOTE_FRESH_SIGNALS);
	pound_accuracy_estimate(&values, checks, sampling.quasi_random, rest, &into->indices[output]);
	into->indices[output].impulse_correlation = pound_ordinate_correlation(run, cell, output, rest);
	if (output == 0) {
		into->runs_failed = failed;
		into->rows_dropped = dropped;
	}
}

/* Ratio of means over the signals with a result. */
static void responses_reduce(struct pound_run *run, int cell, int output, void *row_memory)
{
	const struct pound_cells *c = &run->campaign;
	struct pound_cell *into = &run->result.cells[cell];
	// the layout of the measures depends on the number of stories, which a sweep may vary
	struct pound_scene scene = pound_cells_scene(c, cell, 0, 0, row_memory);
	double above = 0, below = 0;
	for (int signal = 0; signal < c->n_signals; signal++) {
		const double *kept = pound_blocks_run(&run->layout, signal, cell, 0);
		struct pound_response response = {0};
		struct pound_row_response row = {0};
		if (scene.n_buildings)
			row = pound_row_kept(&scene, kept);
		else
			memcpy(&response, kept, sizeof(double) * (size_t)response_measures(c->study));
		if (isnan(*kept))
			continue;
		const struct pound_outcome outcome = {.scene = &scene, .pair = &response, .row = &row};
		double numerator = NAN, denominator = NAN;
		if (pound_output_applies(c->study->outputs[output], &scene))
			pound_outputs_measure(c->study, output, &outcome, &numerator, &denominator);
		above += numerator;
		below += denominator;
	}
	into->outputs[output] = below > 0 ? above / below : NAN;
}

/* The work of the current blocks. */
static struct pound_work work_of(const struct pound_run *run)
{
	struct pound_work work = {0};
	int64_t *counts = (int64_t *)&work;
	for (int b = 0; b < blocks_in_hand(run); b++) {
		const double *counted = pound_blocks_counts(&run->layout, b);
		for (int j = 0; j < (int)COUNTS; j++)
			counts[j] += (int64_t)counted[j];
	}
	return work;
}

/* POUND_OK if any run has a result, else the most frequent failure. */
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

/* Computes one output of one cell, after all blocks are done; the first reduction also checks that any run has a result.
 *
 * Status   POUND_STOPPED  pound_run_stop was called
 *          run status     no run of the study has a result; the most frequent failure
 * Test     unit_status: a_study_without_a_result_ends_with_the_reason_of_its_runs
 */
enum pound_status pound_run_reduce(struct pound_run *run, int reduction, int worker)
{
	int n_outputs = run->campaign.study->n_outputs;
	if (pound_stopped(run->stop))
		return POUND_STOPPED;
	enum pound_status status = reduction == 0 ? nothing_left(run) : POUND_OK;
	if (status)
		return status;
	if (run->campaign.trials)
		pound_trials_reduce(run, run->scratch[worker]);
	else if (run->campaign.study->kind == POUND_KIND_FLOOR_SPECTRUM)
		pound_ordinate_reduce(run, run->scratch[worker], &run->result.floor);
	else if (run->campaign.study->kind == POUND_KIND_SEPARATION && reduction == pound_run_reductions(run) - 1)
		pound_separation_reduce(run, run->scratch[worker] +
		                                 (has_indices(run) ? pound_run_kept_size(&run->campaign) : 0));
	else if (has_indices(run))
		indices_reduce(run, reduction / n_outputs, reduction % n_outputs, run->scratch[worker]);
	else
		responses_reduce(run, reduction / n_outputs, reduction % n_outputs, run->scratch[worker]);
	return pound_stopped(run->stop) ? POUND_STOPPED : POUND_OK;
}

/* The result, after all reductions are done; owned by run. */
const struct pound_result *pound_run_result(struct pound_run *run)
{
	const struct pound_cells *c = &run->campaign;
	run->result.work = work_of(run);
	run->result.rows = run->rows;
	pound_run_records(run);
	for (int cell = 0; cell < c->n_cells; cell++)
		run->result.cells[cell].runs = (int64_t)run->rows * c->n_signals * c->n_samples;
	for (int cell = 0; cell < c->n_cells && c->study->kind == POUND_KIND_RESPONSE; cell++) {
		struct pound_cell *into = &run->result.cells[cell];
		into->runs_failed = 0;
		for (int signal = 0; signal < c->n_signals; signal++) {
			const double *kept = pound_blocks_run(&run->layout, signal, cell, 0);
			if (c->study->scene.n_buildings) {
				const struct pound_scene scene = pound_cells_scene(c, cell, 0, 0, run->scratch[0]);
				into->rows[signal] = pound_row_kept(&scene, kept);
			} else
				memcpy(&into->signals[signal], kept, sizeof(double) * (size_t)response_measures(c->study));
			into->runs_failed += isnan(*kept);
		}
	}
	return &run->result;
}
