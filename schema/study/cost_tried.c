/* cost_tried.c - corrects the estimated CPU time of a study with the measured time of a few of its runs.
 *
 * operations_count cannot know how often small impacts follow each other, nor how fast the machine is.  A trial measures a few
 * runs; the ratio of measured to estimated time of the trial corrects the estimate of all runs.
 *
 * The trial is the study with few signals or rows and at most three values per sweep; while a trial takes hardly any time, it is
 * repeated with four times as many runs.  A trial that is stopped gives a lower bound; if the bound is near the estimate or above,
 * the runs are uncommonly slow and get more time. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/trial.h"

enum { SWEEP_VALUES = 3, MORE = 4 };

/* [s] of CPU time: estimate from which a trial is made; limit of a trial, and of an uncommonly slow one; and time of a trial that
 * is long enough: four times as much stays within the limit */
static const double TRIED_LEAST = 0.01, TRIAL_MOST = 0.1, UNCOMMON_MOST = 0.5, TRIAL_ENOUGH = 0.02;

/* measured over estimated time from which a stopped trial counts as uncommonly slow */
static const double UNCOMMON = 0.3;

/* factor on the ratio of measured to estimated time, of a complete trial and of a stopped one; from the mean of many studies */
static const double OTHERS = 1.25, STOPPED = 2;

/* CPU time that nearly all tried studies stay below, over the corrected estimate */
static const double TRIED_HIGH = 2.5;

/* A study reduced to some of its runs. */
struct part {
	struct pound_study study;
	struct pound_sweep sweeps[POUND_SWEEPS_MAX];
	double values[POUND_SWEEPS_MAX][SWEEP_VALUES];
	int items, most; /* signals, or rows of the design */
};

static void part_init(struct part *part, const struct pound_study *study)
{
	part->study = *study;
	part->study.sweeps = part->sweeps;
	part->study.n_groups = part->study.n_ratios = 0;
	for (int s = 0; s < study->n_sweeps; s++) {
		struct pound_sweep *sweep = &part->sweeps[s];
		*sweep = study->sweeps[s];
		if (sweep->n_values <= SWEEP_VALUES)
			continue;
		for (int k = 0; k < SWEEP_VALUES; k++)
			part->values[s][k] = sweep->values[k * (sweep->n_values - 1) / (SWEEP_VALUES - 1)];
		sweep->values = part->values[s];
		sweep->n_values = SWEEP_VALUES;
	}
	part->most = pound_study_sampled(study) ? pound_design_rows_most(study) : study->scene.excitation.signals;
	part->items = pound_study_sampled(study) ? 2 : 1;
}

static void part_take(struct part *part)
{
	const struct pound_design *design = &part->study.design;
	if (!pound_study_sampled(&part->study)) {
		part->study.scene.excitation.signals = part->items;
		return;
	}
	part->study.scene.excitation.signals = 1;
	part->study.design = (struct pound_design){.rows = part->items,
	                                           .seed = design->seed,
	                                           .row = design->row,
	                                           .common_signals = design->common_signals,
	                                           .order = design->order};
}

/* CPU time of a study's runs as counted, without trial [s]. */
static double counted_of(const struct pound_study *study)
{
	const struct pound_study like = study_separation_like(study);
	return cost_of_runs(&like);
}

/* Runs a trial of a study and corrects its estimated CPU times.
 *
 * Given    study      valid
 *          cost       from cost_of, within the limits of the server
 *          unwanted   ends the trial when it is set; may be NULL
 * Returns  cost       with corrected CPU times
 * Test     unit_estimates; soak_valid
 */
void cost_try(struct cost *cost, const struct pound_study *study, const atomic_bool *unwanted)
{
	// a convergence study times its own trials
	if (!cost_tried(cost) || study->kind == POUND_KIND_CONVERGENCE)
		return;
	const double all = counted_of(study);
	struct part part;
	struct trial trial;
	part_init(&part, study);
	for (;; part.items = (int)fmin(MORE * (double)part.items, part.most)) {
		part_take(&part);
		trial = trial_run(&part.study, false, TRIAL_MOST, unwanted);
		if (!trial.complete || trial.cpu_s > TRIAL_ENOUGH || part.items >= part.most)
			break;
	}
	const double counted = counted_of(&part.study);
	if (!trial.complete && trial.cpu_s > UNCOMMON * counted)
		trial = trial_run(&part.study, false, UNCOMMON_MOST, unwanted);
	const double ratio = trial.cpu_s / counted;
	if (trial.complete) {
		cost->cpu_s += (OTHERS * ratio - 1) * all;
		cost->cpu_s_high = TRIED_HIGH * cost->cpu_s;
	} else
		cost->cpu_s += (fmax(STOPPED * ratio, 1) - 1) * all;
	cost->cpu_s_high = fmax(cost->cpu_s_high, cost->cpu_s);
}

bool cost_tried(const struct cost *cost)
{
	return cost->cpu_s >= TRIED_LEAST;
}
