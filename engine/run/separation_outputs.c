/* separation_outputs.c - gaps needed, from the runs of a separation study.
 *
 * With a design only the runs of matrices A and B count, without a design all signals: only these are random draws.
 * The runs of a design row are a cluster, because they share ground motions or structures; without a design every signal is a
 * cluster, or both directions of a record together. */
#include "engine/run/separation_outputs.h"

#include <math.h>
#include <stdlib.h>

#include "engine/scene/building.h"
#include "engine/separation/separation.h"

enum {
	GAPS_ROUND = 40, /* largest number of automatic gaps, besides 0 */
	MATRICES = 2,    /* A and B */
	// the first outputs, each once per contact; without RIGHT the right body is a wall
	GAP = 0,
	LEFT = 1,
	RIGHT = 2,
};

/* ---- memory ---- */

static bool separates(const struct pound_cells *c)
{
	return c->study->kind == POUND_KIND_SEPARATION;
}

static int cluster_size(const struct pound_cells *c)
{
	const struct pound_excitation *e = &c->study->scene.excitation;
	if (pound_study_sampled(c->study))
		return MATRICES * c->n_signals;
	return e->n_records && e->both && !e->draw ? 2 : 1; // signals 2 k and 2 k + 1 are record k
}

static int clusters_of(const struct pound_cells *c, int rows)
{
	return pound_study_sampled(c->study) ? rows : c->n_signals / cluster_size(c);
}

static size_t runs_of(const struct pound_cells *c)
{
	return (size_t)clusters_of(c, c->n_rows) * (size_t)cluster_size(c);
}

static int stripes_of(const struct pound_study *study)
{
	return study->separation.stripes < 0 ? 1 : study->sweeps[study->separation.stripes].n_values;
}

static int sets_of(const struct pound_cells *c)
{
	return c->study->separation.stripes < 0 ? 0 : c->n_cells / stripes_of(c->study);
}

int pound_study_gaps(const struct pound_study *study)
{
	return study->scene.n_buildings ? pound_row_contacts(&study->scene) : 1;
}

static int gaps_most(const struct pound_study *study)
{
	return study->separation.n_gaps ? study->separation.n_gaps : GAPS_ROUND + 1;
}

/* Doubles for the runs of all stripes, and for their sorted copy. */
static size_t numbers_of(const struct pound_cells *c)
{
	return 2 * runs_of(c) * (size_t)stripes_of(c->study);
}

/* The same plus the buildings of a scene. */
size_t pound_separation_scratch(const struct pound_cells *campaign)
{
	const size_t row = pound_row_bytes(&campaign->study->scene);
	return separates(campaign) ? numbers_of(campaign) + (row + sizeof(double) - 1) / sizeof(double) : 0;
}

/* Points the parts of the result into memory; memory NULL: only counts the bytes. */
static size_t carve(const struct pound_cells *c, char *memory, struct pound_separation_result *result)
{
	const struct pound_separation *asked = &c->study->separation;
	const size_t gaps = (size_t)gaps_most(c->study), each = (size_t)pound_study_gaps(c->study),
	             cells = (size_t)c->n_cells * each, sets = (size_t)sets_of(c) * each;
	const size_t values = pound_study_sampled(c->study) ? 0 : (size_t)c->n_signals;
	size_t at = 0;
	struct pound_separation_result none, *into = memory ? result : &none;
	into->needs = memory ? (struct pound_needs *)(void *)memory : NULL;
	at += sizeof *into->needs * cells;
	into->sets = memory ? (struct pound_stripe_set *)(void *)(memory + at) : NULL;
	at += sizeof *into->sets * sets;
	for (size_t k = 0; k < cells; k++) {
		if (memory) {
			into->needs[k].probability = (struct pound_estimate *)(void *)(memory + at);
			into->needs[k].gap = into->needs[k].probability + gaps;
			into->needs[k].needed = (double *)(into->needs[k].gap + asked->n_probabilities);
		}
		at +=
		    sizeof(struct pound_estimate) * (gaps + (size_t)asked->n_probabilities) + sizeof(double) * values;
	}
	for (size_t k = 0; k < sets; k++) {
		if (memory) {
			into->sets[k].curves = (struct pound_fragility *)(void *)(memory + at);
			into->sets[k].return_gap = (struct pound_estimate *)(void *)(into->sets[k].curves + gaps);
		}
		at +=
		    sizeof(struct pound_fragility) * gaps + sizeof(struct pound_estimate) * (size_t)asked->n_periods;
	}
	return at;
}

size_t pound_separation_bytes(const struct pound_cells *campaign)
{
	return separates(campaign) ? carve(campaign, NULL, NULL) : 0;
}

void pound_separation_layout(const struct pound_cells *campaign, void *memory,
                             struct pound_separation_result *result)
{
	if (separates(campaign))
		carve(campaign, memory, result);
}

/* ---- gaps needed ---- */

/* Numerator and denominator of an output of a run. */
static const double *run_values(const struct pound_run *run, int cell, int row, int sample, int signal,
                                int output)
{
	return pound_blocks_run(&run->layout, row * run->campaign.n_signals + signal, cell, sample) + 2 * output;
}

static int samples_counted(const struct pound_run *run)
{
	return pound_study_sampled(run->campaign.study) ? MATRICES : 1;
}

/* The number of output GAP, LEFT or RIGHT at a contact. */
static int own(const struct pound_run *run, int output, int contact)
{
	return output * pound_study_gaps(run->campaign.study) + contact;
}

/* The gaps needed at a contact in a cell. */
static struct pound_needed needed_of(const struct pound_run *run, int cell, int contact, double *gap)
{
	const struct pound_cells *c = &run->campaign;
	double *at = gap;
	for (int row = 0; row < run->rows; row++)
		for (int sample = 0; sample < samples_counted(run); sample++)
			for (int signal = 0; signal < c->n_signals; signal++)
				*at++ = *run_values(run, cell, row, sample, signal, own(run, GAP, contact));
	return (struct pound_needed){
	    .n_clusters = clusters_of(c, run->rows), .size = cluster_size(c), .gap = gap};
}

/* Mean, standard deviation and maximum of the gaps needed. */
static void moments(const struct pound_needed *needed, struct pound_needs *needs)
{
	const size_t n = (size_t)needed->n_clusters * (size_t)needed->size;
	const struct pound_needed_count count = pound_needed_count(needed, 0);
	double sum = 0, squares = 0;
	needs->runs = count.runs;
	needs->clusters = (int)count.clusters;
	needs->largest = NAN;
	for (size_t k = 0; k < n; k++) {
		sum += isnan(needed->gap[k]) ? 0 : needed->gap[k];
		needs->largest = fmax(needs->largest, needed->gap[k]);
	}
	needs->mean = sum / (double)count.runs;
	for (size_t k = 0; k < n; k++) {
		const double off = needed->gap[k] - needs->mean;
		squares += isnan(off) ? 0 : off * off;
	}
	needs->deviation = count.runs > 1 ? sqrt(squares / (double)(count.runs - 1)) : NAN;
}

/* ---- rules ---- */

/* a structure of a cell: a row of the design and a sample of the row */
struct structure {
	const struct pound_run *run;
	int cell, row, sample;
};

/* Means over the signals of a structure of the peak displacements on both sides of a contact; returns how many are valid. */
static int displacements_of(const struct structure *s, int contact, double mean[POUND_OSCILLATORS])
{
	const struct pound_run *run = s->run;
	const bool wall = run->campaign.study->separation.n_own <= own(run, RIGHT, 0);
	double sum[POUND_OSCILLATORS] = {0};
	int n = 0;
	for (int signal = 0; signal < run->campaign.n_signals; signal++) {
		const double left = *run_values(run, s->cell, s->row, s->sample, signal, own(run, LEFT, contact));
		if (isnan(left))
			continue;
		sum[0] += left;
		sum[1] += wall ? 0 : *run_values(run, s->cell, s->row, s->sample, signal, own(run, RIGHT, contact));
		n++;
	}
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		mean[i] = sum[i] / n;
	return n;
}

/* frequencies and damping ratios of the first modes of a scene's bodies; 0: a wall */
struct first_modes {
	double frequency[POUND_BUILDINGS_MAX], damping[POUND_BUILDINGS_MAX];
};

static void first_modes_of(const struct pound_scene *scene, struct first_modes *modes)
{
	for (int b = 0; b < scene->n_buildings; b++) {
		struct pound_building_mode of_building[POUND_STOREYS_MAX] = {0};
		if (pound_row_storeys(scene, b))
			pound_building_modes(&scene->buildings[b], of_building);
		modes->frequency[b] = of_building->frequency;
		modes->damping[b] = of_building->damping_ratio;
	}
	for (int i = 0; i < POUND_OSCILLATORS && !scene->n_buildings; i++) {
		const struct pound_oscillator *o = &scene->oscillators[i];
		modes->frequency[i] = o->rigid_wall ? 0 : o->frequency_hz;
		modes->damping[i] = o->damping_ratio;
	}
}

/* Adds the gaps of the rules at all contacts of a structure; false: no signal has a result. */
static bool rules_add(const struct structure *s, struct pound_needs *needs, void *row_memory)
{
	const struct pound_scene scene =
	    pound_cells_scene(&s->run->campaign, s->cell, s->row, s->sample, row_memory);
	struct first_modes modes;
	bool any = false;
	first_modes_of(&scene, &modes);
	for (int g = 0; g < pound_study_gaps(s->run->campaign.study); g++) {
		struct pound_row_contact contact = {.left_building = 0};
		double mean[POUND_OSCILLATORS];
		if (!displacements_of(s, g, mean))
			continue;
		if (scene.n_buildings)
			pound_row_contact_of(&scene, g, &contact);
		const double rho = pound_rule_correlation(&modes.frequency[contact.left_building],
		                                          &modes.damping[contact.left_building]);
		needs[g].correlation += rho;
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			needs[g].displacement[i] += mean[i];
		for (int k = 0; k < POUND_RULES; k++)
			needs[g].rules[k].gap += pound_rule_gap(k, mean, rho);
		any = true;
	}
	return any;
}

/* Gaps of the rules: for each structure from the means over its signals, then the mean over the structures. */
static void rules_apply(const struct pound_run *run, int cell, struct pound_needs *needs, void *row_memory)
{
	const int gaps = pound_study_gaps(run->campaign.study);
	double n = 0;
	for (int g = 0; g < gaps; g++) {
		needs[g].displacement[0] = needs[g].displacement[1] = needs[g].correlation = 0;
		for (int k = 0; k < POUND_RULES; k++)
			needs[g].rules[k].gap = 0;
	}
	for (int row = 0; row < run->rows; row++)
		for (int sample = 0; sample < samples_counted(run); sample++)
			n += rules_add(&(struct structure){run, cell, row, sample}, needs, row_memory);
	for (int g = 0; g < gaps; g++) {
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			needs[g].displacement[i] /= n;
		needs[g].correlation /= n;
		for (int k = 0; k < POUND_RULES; k++)
			needs[g].rules[k].gap /= n;
	}
}

/* ---- a study ---- */

/* An integer times a power of ten, rounded once. */
static double decimal(double whole, int exponent)
{
	double power = 1;
	for (int k = abs(exponent); k > 0; k--)
		power *= 10;
	return exponent < 0 ? whole / power : whole * power;
}

/* Round gaps from 0 to at least the largest gap needed: integer multiples of 1, 2 or 5 times a power of ten. */
static int gaps_round(double largest, double *gaps)
{
	static const double factors[] = {1, 2, 5};
	int exponent = 0, k = 0, n = 0;
	gaps[0] = 0;
	if (!(largest > 0x1p-1000) || !(largest < 0x1p1000))
		return 1;
	while (decimal(GAPS_ROUND, exponent) >= largest)
		exponent--;
	while (decimal(GAPS_ROUND * factors[k], exponent) < largest)
		if (++k == 3) {
			k = 0;
			exponent++;
		}
	while (n < GAPS_ROUND && gaps[n] < largest) {
		n++;
		gaps[n] = decimal(n * factors[k], exponent);
	}
	return n + 1;
}

/* The outputs of a cell of a study without a design, with pounding or without. */
static void outputs_reduce(struct pound_run *run, int cell)
{
	struct pound_cell *into = &run->result.cells[cell];
	into->runs_failed = 0;
	for (int signal = 0; signal < run->campaign.n_signals; signal++)
		into->runs_failed += isnan(*run_values(run, cell, 0, 0, signal, GAP));
	for (int o = 0; o < run->campaign.study->n_outputs; o++) {
		double above = 0, below = 0;
		for (int signal = 0; signal < run->campaign.n_signals; signal++) {
			const double *values = run_values(run, cell, 0, 0, signal, o);
			above += isnan(values[0]) ? 0 : values[0];
			below += isnan(values[0]) ? 0 : values[1];
		}
		into->outputs[o] = below > 0 ? above / below : NAN;
	}
}

/* Fills the needs at a contact in a cell, after rules_apply. */
static void needs_reduce(struct pound_run *run, int cell, int contact, double *scratch)
{
	const struct pound_separation *asked = &run->campaign.study->separation;
	const struct pound_separation_result *result = &run->result.separation;
	struct pound_needs *needs = &result->needs[cell * pound_study_gaps(run->campaign.study) + contact];
	struct pound_needed needed = needed_of(run, cell, contact, scratch);
	const size_t runs = (size_t)needed.n_clusters * (size_t)needed.size;
	double *sorted = scratch + runs;
	needed.n_sorted = pound_needed_sort(&needed, sorted);
	needed.sorted = sorted;
	moments(&needed, needs);
	for (int k = 0; k < POUND_RULES; k++) {
		struct pound_rule *rule = &needs->rules[k];
		rule->over = rule->gap / needs->mean;
		rule->probability = pound_needed_probability(&needed, rule->gap);
	}
	for (int g = 0; g < result->n_gaps; g++)
		needs->probability[g] = pound_needed_probability(&needed, result->gaps[g]);
	for (int k = 0; k < asked->n_probabilities; k++)
		needs->gap[k] = pound_needed_gap(&needed, sorted, needed.n_sorted, asked->probabilities[k]);
	for (size_t k = 0; k < runs && !pound_study_sampled(run->campaign.study); k++)
		needs->needed[k] = needed.gap[k];
}

/* Distance of the cells that differ only in one sweep. */
static int stride_of(const struct pound_study *study, int sweep)
{
	int stride = 1;
	for (int s = study->n_sweeps - 1; s > sweep; s--)
		stride *= study->sweeps[s].n_values;
	return stride;
}

static void set_reduce(struct pound_run *run, struct pound_stripe_set *set, double *scratch)
{
	const struct pound_separation *asked = &run->campaign.study->separation;
	const struct pound_separation_result *result = &run->result.separation;
	const struct pound_sweep *sweep = &run->campaign.study->sweeps[asked->stripes];
	const int stride = stride_of(run->campaign.study, asked->stripes);
	struct pound_needed needed[POUND_STRIPES_MAX];
	double weights[POUND_STRIPES_MAX];
	const struct pound_stripes stripes = {sweep->n_values, sweep->values, needed};
	const struct pound_hazard hazard = {asked->n_intensities, asked->intensities, asked->rates};
	const size_t runs = runs_of(&run->campaign);
	for (int i = 0; i < stripes.n; i++)
		needed[i] = needed_of(run, set->cell + i * stride, set->contact, scratch + (size_t)i * runs);
	set->beyond = hazard.n ? pound_hazard_weights(&hazard, &stripes, weights) : NAN;
	for (int g = 0; g < result->n_gaps; g++) {
		set->curves[g] = pound_fragility_fit(&stripes, result->gaps[g]);
		set->curves[g].rate = hazard.n ? pound_hazard_rate(&stripes, weights, set->beyond, result->gaps[g])
		                               : (struct pound_estimate){NAN, NAN, NAN};
	}
	for (int k = 0; k < asked->n_periods; k++)
		set->return_gap[k] = pound_hazard_gap(&stripes, weights, set->beyond, 1 / asked->periods[k],
		                                      scratch + (size_t)stripes.n * runs);
}

/* Test     unit_separation_result */
void pound_separation_reduce(struct pound_run *run, double *scratch)
{
	const struct pound_cells *c = &run->campaign;
	const struct pound_separation *asked = &c->study->separation;
	struct pound_separation_result *result = &run->result.separation;
	const int gaps = pound_study_gaps(c->study);
	double largest = 0;
	for (int k = 0; k < c->n_cells * gaps && !asked->n_gaps; k++) {
		struct pound_needs needs;
		const struct pound_needed needed = needed_of(run, k / gaps, k % gaps, scratch);
		moments(&needed, &needs);
		largest = fmax(largest, needs.largest);
	}
	result->n_gaps = asked->n_gaps ? asked->n_gaps : gaps_round(largest, result->gaps);
	for (int g = 0; g < asked->n_gaps; g++)
		result->gaps[g] = asked->gaps[g];
	for (int cell = 0; cell < c->n_cells; cell++) {
		rules_apply(run, cell, &result->needs[cell * gaps], scratch + numbers_of(c));
		for (int contact = 0; contact < gaps; contact++)
			needs_reduce(run, cell, contact, scratch);
		if (!pound_study_sampled(c->study))
			outputs_reduce(run, cell);
	}
	result->n_sets = 0;
	const int stride = asked->stripes < 0 ? 0 : stride_of(c->study, asked->stripes);
	for (int cell = 0; cell < c->n_cells && asked->stripes >= 0; cell++)
		for (int contact = 0; contact < gaps && cell / stride % stripes_of(c->study) == 0; contact++) {
			struct pound_stripe_set *set = &result->sets[result->n_sets++];
			set->cell = cell;
			set->contact = contact;
			set_reduce(run, set, scratch);
		}
}
