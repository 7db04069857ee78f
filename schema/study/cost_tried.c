/* cost_tried.c - what a study will take, by a few of its runs.
 *
 * What operations_count cannot know, most of all how often small impacts follow each other, and how fast the machine is, a few
 * runs show: their CPU time over what was counted for them is by what the count of all is multiplied.
 *
 * The trial is the study with few signals or rows, and with no more than three values of a sweep; four times as many runs follow
 * while they take next to nothing.  One that is stopped has at least shown a lower bound; where that is near what was counted, the
 * runs are of an uncommon kind, and get more time. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/trial.h"

enum { SWEEP_VALUES = 3, MORE = 4 };

/* [s] of CPU time: estimated, with which a study is tried; of a trial at most, of one of an uncommon kind; and what is enough to go
 * by: four times as much is no more than a trial may take */
static const double TRIED_LEAST = 0.01, TRIAL_MOST = 0.1, UNCOMMON_MOST = 0.5, TRIAL_ENOUGH = 0.02;

/* of what was counted, with which a trial that was stopped is uncommon */
static const double UNCOMMON = 0.3;

/* how much more than a few runs all take, in the mean, and than a trial that was stopped had taken until then */
static const double OTHERS = 1.25, STOPPED = 2;

/* what nearly all tried studies take at most, over the estimate */
static const double TRIED_HIGH = 2.5;

/* Some of a study's runs. */
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

/* CPU time of its runs as it is counted [s]. */
static double counted_of(const struct pound_study *study)
{
	const struct pound_study like = study_separation_like(study);
	return cost_of_runs(&like);
}

/* Tries a study, and corrects what it is estimated to take.
 *
 * Given    study      valid
 *          cost       by cost_of, which the server allows
 *          unwanted   ends the trial when it is set; NULL: nothing does
 * Returns  cost       its CPU times
 * Test     unit_estimates; soak_valid
 */
void cost_try(struct cost *cost, const struct pound_study *study, const atomic_bool *unwanted)
{
	// trials of a convergence study are timed anyway
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
