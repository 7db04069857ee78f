/* chain_scenes.c - rows of shear buildings as chains: an independent implementation of the model of buildings.md 1, for tests. */
#include "tests/support/chain_scenes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

struct row_building row_building(int stories, double mass, double stiffness)
{
	struct row_building b = {
	    .stories = stories, .damping_ratio = 0.05, .law.hardening = 0.05, .law.yield = 1};
	for (int i = 0; i < stories; i++) {
		b.mass[i] = mass;
		b.stiffness[i] = stiffness;
	}
	return b;
}

void row_init(struct row *row)
{
	memset(row, 0, sizeof *row);
	row->contact =
	    (struct pound_contact){.present = true, .stiffness_ratio = 100, .restitution = 0.6, .tension = true};
	while (strcmp(pound_contact_name(row->contact.model), "kelvin_voigt") != 0)
		row->contact.model++;
}

int row_harmonic(struct row *row, double frequency_hz, double duration, double peak)
{
	const int n = (int)lround(duration / 0.01) + 1;
	assert(n <= ROW_SAMPLES);
	for (int i = 0; i < n; i++)
		row->ground[i] = peak * sin(2 * pi * frequency_hz * (i * 0.01));
	return n;
}

/* Story stiffnesses from the first frequency of a building, and its dashpots. */
static void building_floors(struct row *row, int b, struct pound_chain_floor *floor)
{
	struct row_building *x = &row->buildings[b];
	const int n = x->stories;
	double w[POUND_STORIES], stiffness[POUND_STORIES];
	pound_modes_frequencies(n, x->mass, x->stiffness, w);
	const double scale = x->frequency_hz > 0 ? pow(2 * pi * x->frequency_hz / w[0], 2) : 1,
	             xi = x->damping_ratio;
	for (int i = 0; i < n; i++) {
		stiffness[i] = scale * x->stiffness[i];
		w[i] *= sqrt(scale);
	}
	const int high = n < 3 ? n - 1 : 2;
	if (x->damping == ROW_MODAL)
		pound_modes_damping(n, x->mass, stiffness, xi, row->modal[b]);
	for (int i = 0; i < n; i++) {
		floor[i] = (struct pound_chain_floor){.mass = x->mass[i], .base = i == 0, .story = x->law};
		floor[i].story.stiffness = stiffness[i];
		switch (x->damping) {
		case ROW_RAYLEIGH:
			floor[i].mass_damping = n == 1 ? 0 : 2 * xi * w[0] * w[high] / (w[0] + w[high]);
			floor[i].dashpot = 2 * xi * stiffness[i] / (n == 1 ? w[0] : w[0] + w[high]);
			break;
		case ROW_STIFFNESS:
			floor[i].dashpot = 2 * xi * stiffness[i] / w[0];
			break;
		case ROW_STORY:
			floor[i].dashpot = 2 * xi * sqrt(x->mass[i] * stiffness[i]);
			break;
		case ROW_MODAL:
			floor[i].modal = &row->modal[b][i * n];
			break;
		}
	}
}

/* One side of a link: floors and weights, contribution to 1/m, and initial stiffness of the story at that level. */
static void link_side(const struct row *row, struct pound_link *link, int side, int building, double level,
                      double *inverse_mass, double *stiffness)
{
	const int i = (int)ceil(level);
	const double t = level - (i - 1);
	const int upper = row->first[building] + i - 1;
	link->floor[side][0] = i > 1 ? upper - 1 : POUND_CHAIN_GROUND;
	link->floor[side][1] = upper;
	link->weight[side][0] = 1 - t;
	link->weight[side][1] = t;
	for (int k = 0; k < 2; k++)
		if (link->floor[side][k] != POUND_CHAIN_GROUND)
			*inverse_mass +=
			    link->weight[side][k] * link->weight[side][k] / row->floors[link->floor[side][k]].mass;
	*stiffness = fmax(*stiffness, row->floors[upper].story.stiffness);
}

static void row_link(struct row *row, int j, const struct row_contact *at)
{
	struct pound_link *link = &row->links[j];
	double inverse_mass = 0, stiffness = 0;
	*link = (struct pound_link){.gap = row->contact.gap,
	                            .floor = {{-1, -1}, {POUND_CHAIN_GROUND, POUND_CHAIN_GROUND}},
	                            .weight = {{0, 0}, {1, 0}}};
	link_side(row, link, 0, at->left, at->levels[0], &inverse_mass, &stiffness);
	if (at->left + 1 < row->n_buildings)
		link_side(row, link, 1, at->left + 1, at->levels[1], &inverse_mass, &stiffness);
	const struct pound_contact_place place = {
	    .stiffness = stiffness, .inverse_mass = inverse_mass, .mass = 1};
	link->law = pound_contact_law(&row->contact, &place);
}

struct pound_chain_task row_task(struct row *row, int n_samples, double time_step, unsigned asked)
{
	int floors = 0, links = row->contact.present ? row->n_contacts : 0;
	for (int b = 0; b < row->n_buildings; b++) {
		row->first[b] = floors;
		building_floors(row, b, &row->floors[floors]);
		floors += row->buildings[b].stories;
		assert(floors <= ROW_FLOORS);
	}
	for (int j = 0; j < links; j++)
		row_link(row, j, &row->contacts[j]);
	for (int b = 0; row->contact.present && row->n_contacts == 0 && b + !row->wall < row->n_buildings; b++) {
		const bool last = b + 1 == row->n_buildings;
		const int n = row->buildings[b].stories, other = last ? n : row->buildings[b + 1].stories;
		for (int i = 1; i <= n && i <= other; i++)
			row_link(row, links++, &(struct row_contact){b, {i, i}});
	}
	return (struct pound_chain_task){.ground = row->ground,
	                                 .n_samples = n_samples,
	                                 .time_step = time_step,
	                                 .n_floors = floors,
	                                 .n_links = links,
	                                 .floors = row->floors,
	                                 .links = row->links,
	                                 .asked = asked};
}

struct pound_chain_result row_run(struct row *row, const struct pound_chain_task *task, int lanes)
{
	struct pound_chain_result result = {.floors = row->floor_measures[0], .links = row->link_measures[0]};
	void *scratch = aligned_alloc(64, POUND_CHAIN_SCRATCH);
	if (!scratch || !pound_chain_lanes(lanes, task, &result, 1, scratch, NULL))
		abort();
	free(scratch);
	return result;
}
