/* run_samples.c - the samples of a study's design: inputs, ground motions, outputs. */
#include <assert.h>
#include <math.h>

#include "engine/design/design.h"
#include "engine/ground/excitation.h"
#include "engine/run/run.h"

int pound_run_samples(const struct pound_run *run)
{
	return run->campaign.n_samples;
}

void pound_run_sample_inputs(const struct pound_run *run, int row, int sample, double *x)
{
	const struct pound_study *study = run->campaign.study;
	const unsigned from_b = pound_design_mask(study, sample);
	for (int j = 0; j < study->n_inputs; j++)
		x[j] = pound_design_input(run->campaign.design, study->n_inputs, row, from_b, j);
}

static struct pound_excitation excitation_of(const struct pound_run *run, const struct pound_place *place)
{
	assert(!run->campaign.study->elsewhere && place->signal < run->campaign.n_signals);
	const struct pound_scene scene =
	    pound_cells_scene(&run->campaign, place->cell, place->row, place->sample, NULL);
	return pound_cells_excitation(&run->campaign, &scene, place);
}

int pound_run_motion_samples(const struct pound_run *run, const struct pound_place *place, double *step)
{
	const struct pound_excitation excitation = excitation_of(run, place);
	*step = excitation.time_step;
	return pound_excitation_samples(&excitation);
}

/* The ground motion of a signal, generated as for its runs.
 *
 * Test     unit_motions: motions_are_those_of_the_runs
 */
void pound_run_motion(const struct pound_run *run, const struct pound_place *place, double *a)
{
	const struct pound_excitation excitation = excitation_of(run, place);
	const struct pound_signal signal = {
	    .excitation = &excitation,
	    .noise = pound_cells_noise(&run->campaign, place->row, place->sample, place->signal),
	    .a = a};
	pound_signals_fill(&signal, 1);
}

struct pound_sample_output pound_run_sample_output(const struct pound_run *run, int cell, int row, int sample,
                                                   int output)
{
	const struct pound_cells *c = &run->campaign;
	assert(pound_study_sampled(c->study));
	if (pound_cells_means(c)) {
		const double *values = pound_blocks_run(&run->layout, row, cell, sample) + 2 * output;
		return (struct pound_sample_output){values[0], values[1]};
	}
	// the signals of a row are successive items, but may be in different blocks
	double above = 0, below = 0;
	for (int r = 0; r < c->n_signals; r++) {
		const double *values =
		    pound_blocks_run(&run->layout, row * c->n_signals + r, cell, sample) + 2 * output;
		above += values[0];
		below += values[1];
	}
	const double mean = below > 0 ? above / below : NAN;
	double sum = 0;
	for (int r = 0; r < c->n_signals; r++) {
		const double *values =
		    pound_blocks_run(&run->layout, row * c->n_signals + r, cell, sample) + 2 * output;
		double deviation = (values[0] - mean * values[1]) * c->n_signals / below;
		sum += deviation * deviation;
	}
	const bool noisy = c->n_signals > 1 && pound_excitation_random(&c->study->scene.excitation);
	return (struct pound_sample_output){mean,
	                                    noisy && below > 0 ? sum / (c->n_signals - 1) / c->n_signals : NAN};
}

void pound_run_sample_assign(struct pound_run *run, int row, int sample, int output, double value,
                             double variance)
{
	assert(pound_cells_means(&run->campaign));
	double *values = pound_blocks_run(&run->layout, row, 0, sample) + 2 * output;
	values[0] = isfinite(value) ? value : NAN;
	values[1] = variance;
}

void pound_run_replicates_assign(struct pound_run *run, int row, int sample, int output, const double *value)
{
	const int n = run->campaign.n_signals;
	assert(run->campaign.study->replicates == n);
	for (int r = 0; r < n; r++) {
		double *values = pound_blocks_run(&run->layout, row * n + r, 0, sample) + 2 * output;
		values[0] = isfinite(value[r]) ? value[r] : NAN;
		values[1] = 1.0; // a mean is a ratio of means with equal denominators
	}
}
