/* known_rows.c - the rows of buildings.md 4 of the project's design pages, and rows at random. */
#include "tests/support/known_rows.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "tests/support/scenes.h"

int row_law(const char *name)
{
	int row = 0;
	while (strcmp(pound_law_name(row), name) != 0)
		row++;
	return row;
}

static int row_two_and_two(struct row *row)
{
	row->contact.gap = 0.01;
	row->n_buildings = 2;
	row->buildings[0] = row_building(2, 1e5, 0);
	row->buildings[1] = row_building(2, 0, 0);
	row->buildings[0].damping = row->buildings[1].damping = ROW_STORY;
	row->buildings[0].stiffness[0] = 4e7, row->buildings[0].stiffness[1] = 3e7;
	row->buildings[1].stiffness[0] = 1.2e8, row->buildings[1].stiffness[1] = 9e7;
	row->buildings[1].mass[0] = 1.5e5, row->buildings[1].mass[1] = 1e5;
	return row_harmonic(row, 1.7, 3, 3);
}

static int row_no_tension(struct row *row)
{
	row->contact.gap = 0.005;
	row->contact.tension = false;
	row->contact.restitution = 0.5;
	row->contact.calibration = 1;
	assert(strcmp(pound_calibration_name(1), "exact") == 0);
	row->n_buildings = 2;
	row->buildings[0] = row_building(3, 2e5, 1);
	row->buildings[0].frequency_hz = 2;
	row->buildings[0].stiffness[0] = 1.5, row->buildings[0].stiffness[1] = 1.2;
	row->buildings[1] = row_building(2, 1.5e5, 1);
	row->buildings[1].frequency_hz = 4;
	return row_harmonic(row, 2.2, 3, 2.5);
}

static int row_elastoplastic(struct row *row)
{
	row->contact.gap = 0.01;
	row->contact.restitution = 0.65;
	row->n_buildings = 2;
	row->buildings[0] = row_building(5, 2e5, 2.4e8);
	row->buildings[1] = row_building(3, 1.5e5, 2.4e8);
	for (int b = 0; b < 2; b++) {
		row->buildings[b].damping = ROW_STIFFNESS;
		row->buildings[b].law = (struct pound_backbone){
		    .law = row_law("elastoplastic"), .hardening = 0.05, .yield = b ? .004 : .006};
	}
	return row_harmonic(row, 1.6, 3, 4);
}

static int row_oriented(struct row *row)
{
	row->contact.gap = 0.008;
	row->n_buildings = 2;
	row->buildings[0] = row_building(3, 1e5, 9e7);
	row->buildings[0].stiffness[1] = 8e7, row->buildings[0].stiffness[2] = 7e7;
	row->buildings[0].law =
	    (struct pound_backbone){.law = row_law("origin_oriented"), .hardening = .05, .yield = .004};
	row->buildings[1] = row_building(2, 1e5, 1.5e8);
	row->buildings[1].stiffness[1] = 1.2e8;
	row->buildings[1].law =
	    (struct pound_backbone){.law = row_law("nonlinear_elastic"), .hardening = .05, .yield = .002};
	return row_harmonic(row, 2.5, 3, 5);
}

static int row_of_three(struct row *row)
{
	row->contact.gap = 0.01;
	row->n_buildings = 3;
	row->buildings[0] = row_building(2, 1e5, 1);
	row->buildings[1] = row_building(3, 1.2e5, 1);
	row->buildings[2] = row_building(2, 8e4, 1);
	row->buildings[0].frequency_hz = 1.8, row->buildings[1].frequency_hz = 1.4,
	row->buildings[2].frequency_hz = 2.9;
	return row_harmonic(row, 1.5, 3, 3);
}

static int row_wall(struct row *row)
{
	row->contact.gap = 0.02;
	row->n_buildings = 1;
	row->wall = true;
	row->buildings[0] = row_building(4, 1e5, 1);
	row->buildings[0].frequency_hz = 1.25;
	row->buildings[0].damping_ratio = .03;
	row->n_contacts = 2;
	row->contacts[0] = (struct row_contact){0, {4, 0}};
	row->contacts[1] = (struct row_contact){0, {3, 0}};
	return row_harmonic(row, 1.2, 3, 1.5);
}

static int row_levels(struct row *row)
{
	row->contact.gap = 0.004;
	row->n_buildings = 2;
	row->buildings[0] = row_building(2, 1e5, 1);
	row->buildings[1] = row_building(3, 1e5, 1);
	row->buildings[0].frequency_hz = 2.1, row->buildings[1].frequency_hz = 3;
	row->n_contacts = 2;
	row->contacts[0] = (struct row_contact){0, {2, 2.6}};
	row->contacts[1] = (struct row_contact){0, {1, 1.3}};
	return row_harmonic(row, 2, 2.5, 3);
}

int row_known(struct row *row, enum row_known which)
{
	static int (*const lay[])(struct row * row) = {
	    [ROW_TWO_AND_TWO] = row_two_and_two,
	    [ROW_NO_TENSION] = row_no_tension,
	    [ROW_ELASTOPLASTIC] = row_elastoplastic,
	    [ROW_ORIENTED] = row_oriented,
	    [ROW_OF_THREE] = row_of_three,
	    [ROW_WALL] = row_wall,
	    [ROW_LEVELS] = row_levels,
	};
	row_init(row);
	return lay[which](row);
}

/* A random row for each number: any law and damping, up to four buildings or a wall, levels within stories. */
int row_random(struct row *r, uint64_t number)
{
	uint64_t seed = number * 2654435761u + 88172645463325252u;
	row_init(r);
	r->n_buildings = 1 + (int)specimen_uniform(&seed, 0, 3.999);
	r->wall = r->n_buildings == 1 || specimen_uniform(&seed, 0, 1) < 0.3;
	r->contact.stiffness_ratio = pow(10, specimen_uniform(&seed, 1.5, 3));
	r->contact.gap = specimen_uniform(&seed, 0, 1) < 0.2 ? 0 : specimen_uniform(&seed, 0, 0.01);
	r->contact.restitution = specimen_uniform(&seed, 0.1, 1);
	r->contact.tension = specimen_uniform(&seed, 0, 1) < 0.5;
	for (int b = 0; b < r->n_buildings; b++) {
		struct row_building *x = &r->buildings[b];
		*x = row_building(1 + (int)specimen_uniform(&seed, 0, 11.999), 1e5, 1);
		for (int i = 0; i < x->stories; i++) {
			x->mass[i] *= specimen_uniform(&seed, 0.3, 3);
			x->stiffness[i] *= specimen_uniform(&seed, 0.3, 3);
		}
		x->frequency_hz = specimen_uniform(&seed, 0.5, 4);
		x->damping = (enum row_damping)specimen_uniform(&seed, 0, 3.999);
		x->damping_ratio = specimen_uniform(&seed, 0, 0.1);
		x->law = (struct pound_backbone){.law = (int)specimen_uniform(&seed, 0, 3.999),
		                                 .hardening = specimen_uniform(&seed, 0, 0.2),
		                                 .yield = pow(10, specimen_uniform(&seed, -3.5, -1.5))};
	}
	double a = 0;
	for (int i = 0; i <= 400; i++) {
		a = 0.7 * a + specimen_uniform(&seed, -2, 2);
		r->ground[i] = i > 350 ? 0 : a;
	}
	return 401;
}
