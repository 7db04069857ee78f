/* unit_chain.c - rows of buildings against known answers by two independent 113-bit programs (buildings.md 4). */
#include "tests/support/chain_scenes.h"
#include "tests/support/check.h"

#include <math.h>
#include <string.h>

static const double rounding = 1e-12;

enum {
	ALL = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS | POUND_CHAIN_ACCELERATIONS | POUND_CHAIN_FORCES
};

static int law_row(const char *name)
{
	int row = 0;
	while (strcmp(pound_law_name(row), name) != 0)
		row++;
	return row;
}

static void row_run_all(struct row *row, int samples, unsigned asked)
{
	const struct pound_chain_task task = row_task(row, samples, 0.01, asked);
	const struct pound_chain_result result = row_run(row, &task, 0);
	assert_int_equal(result.status, POUND_OK);
	if (asked & POUND_CHAIN_ENERGY) {
		check_report("energy residual %.1e", result.energy_residual);
		assert_true(result.energy_residual < 1e-11);
	}
}

/* Compares a measure of some floors or links with what is known: digits of 15 are. */
static void measures_check(const double *measures, int stride, int measure, int n, const double *want,
                           const char *what)
{
	double most = 0, error = 0;
	for (int i = 0; i < n; i++)
		most = fmax(most, fabs(want[i]));
	for (int i = 0; i < n; i++)
		error = fmax(error, fabs(measures[i * stride + measure] - want[i]));
	check_report("%s: error %.1e of the largest", what, error / most);
	for (int i = 0; i < n; i++)
		check_near(measures[i * stride + measure], want[i], rounding * most);
}

#define FLOORS(row, floor, measure, ...)                                                     \
	measures_check((row).floor_measures[floor], POUND_FLOOR_MEASURES, POUND_FLOOR_##measure, \
	               (int)(sizeof(const double[]){__VA_ARGS__} / sizeof(double)),              \
	               (const double[]){__VA_ARGS__}, #measure)
#define LINKS(row, measure, ...)                                                      \
	measures_check((row).link_measures[0], POUND_LINK_MEASURES, POUND_LINK_##measure, \
	               (int)(sizeof(const double[]){__VA_ARGS__} / sizeof(double)),       \
	               (const double[]){__VA_ARGS__}, #measure)

static struct row row;

/* T2 */
static void two_and_two_stories(unsigned asked)
{
	row_init(&row);
	row.contact.gap = 0.01;
	row.n_buildings = 2;
	row.buildings[0] = row_building(2, 1e5, 0);
	row.buildings[1] = row_building(2, 0, 0);
	row.buildings[0].damping = row.buildings[1].damping = ROW_STORY;
	row.buildings[0].stiffness[0] = 4e7, row.buildings[0].stiffness[1] = 3e7;
	row.buildings[1].stiffness[0] = 1.2e8, row.buildings[1].stiffness[1] = 9e7;
	row.buildings[1].mass[0] = 1.5e5, row.buildings[1].mass[1] = 1e5;
	row_run_all(&row, row_harmonic(&row, 1.7, 3, 3), asked);
}

static void two_and_two_stories_come_out(void **state)
{
	(void)state;
	two_and_two_stories(ALL);
	FLOORS(row, 0, DRIFT_MAX, .0355398603521552, .0310402674200034);
	LINKS(row, IMPULSE_MAX, 47492.1856286693, 70454.5447246573);
	LINKS(row, CONTACTS, 10, 11);
	check_near(row.link_measures[1][POUND_LINK_FIRST_TIME], .445732289767119, 1e-14);
	FLOORS(row, 1, ACCELERATION_MAX, 157.957423978705);
	FLOORS(row, 3, ACCELERATION_MAX, 154.721872308446);
	two_and_two_stories(ALL | POUND_CHAIN_ENERGY);
}

static void three_and_two_stories_without_tension_come_out(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0.005;
	row.contact.tension = false;
	row.contact.restitution = 0.5;
	row.contact.calibration = 1;
	assert_string_equal(pound_calibration_name(1), "exact");
	row.n_buildings = 2;
	row.buildings[0] = row_building(3, 2e5, 1);
	row.buildings[0].frequency_hz = 2;
	row.buildings[0].stiffness[0] = 1.5, row.buildings[0].stiffness[1] = 1.2;
	row.buildings[1] = row_building(2, 1.5e5, 1);
	row.buildings[1].frequency_hz = 4;
	row_run_all(&row, row_harmonic(&row, 2.2, 3, 2.5), ALL | POUND_CHAIN_ENERGY);
	LINKS(row, IMPULSE_MAX, 92064.1704763961, 171145.829011237);
	LINKS(row, CONTACTS, 15, 24);
}

static void elastoplastic_stories_come_out(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0.01;
	row.contact.restitution = 0.65;
	row.n_buildings = 2;
	row.buildings[0] = row_building(5, 2e5, 2.4e8);
	row.buildings[1] = row_building(3, 1.5e5, 2.4e8);
	for (int b = 0; b < 2; b++) {
		row.buildings[b].damping = ROW_STIFFNESS;
		row.buildings[b].law = (struct pound_backbone){
		    .law = law_row("elastoplastic"), .hardening = 0.05, .yield = b ? .004 : .006};
	}
	row_run_all(&row, row_harmonic(&row, 1.6, 3, 4), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 0, DRIFT_MAX, .0543830397504243);
	FLOORS(row, 4, DRIFT_MAX, .00437356787206889);
	LINKS(row, IMPULSE_MAX, 20846.9044225477, 6377.99175536268, 46038.3574530376);
	LINKS(row, CONTACTS, 1, 1, 4);
	check_near(0.95 * row.floor_measures[0][POUND_FLOOR_CENTER], -.0237297967531740, 1e-13);
	check_near(0.95 * row.floor_measures[3][POUND_FLOOR_CENTER], -.00190093692600578, 1e-13);
	check_near(row.floor_measures[4][POUND_FLOOR_CENTER], 0, 0);
}

static void oriented_and_elastic_stories_come_out(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0.008;
	row.n_buildings = 2;
	row.buildings[0] = row_building(3, 1e5, 9e7);
	row.buildings[0].stiffness[1] = 8e7, row.buildings[0].stiffness[2] = 7e7;
	row.buildings[0].law =
	    (struct pound_backbone){.law = law_row("origin_oriented"), .hardening = .05, .yield = .004};
	row.buildings[1] = row_building(2, 1e5, 1.5e8);
	row.buildings[1].stiffness[1] = 1.2e8;
	row.buildings[1].law =
	    (struct pound_backbone){.law = law_row("nonlinear_elastic"), .hardening = .05, .yield = .002};
	row_run_all(&row, row_harmonic(&row, 2.5, 3, 5), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 0, END_U, -.0288257306792830, -.0349757137371883, .00542429407945448, -.00765103769578269,
	       .000479404201646032);
	LINKS(row, IMPULSE_MAX, 46379.3500931483, 32147.0962135886);
}

static void a_row_of_three_comes_out(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0.01;
	row.n_buildings = 3;
	row.buildings[0] = row_building(2, 1e5, 1);
	row.buildings[1] = row_building(3, 1.2e5, 1);
	row.buildings[2] = row_building(2, 8e4, 1);
	row.buildings[0].frequency_hz = 1.8, row.buildings[1].frequency_hz = 1.4,
	row.buildings[2].frequency_hz = 2.9;
	row_run_all(&row, row_harmonic(&row, 1.5, 3, 3), ALL | POUND_CHAIN_ENERGY);
	LINKS(row, IMPULSE_MAX, 64417.5150918300, 154865.564934878, 89265.2187302767, 235098.891474731);
	LINKS(row, CONTACTS, 7, 27, 11, 17);
}

static void a_wall_comes_out(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0.02;
	row.n_buildings = 1;
	row.wall = true;
	row.buildings[0] = row_building(4, 1e5, 1);
	row.buildings[0].frequency_hz = 1.25;
	row.buildings[0].damping_ratio = .03;
	row.n_contacts = 2;
	row.contacts[0] = (struct row_contact){0, {4, 0}};
	row.contacts[1] = (struct row_contact){0, {3, 0}};
	row_run_all(&row, row_harmonic(&row, 1.2, 3, 1.5), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 0, DRIFT_MAX, .0276030785389800, .0187474422578475, .0227574862260666, .0169328391209189);
	LINKS(row, IMPULSE_MAX, 85009.0893182793, 78054.5007567976);
}

static void levels_within_stories_come_out(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0.004;
	row.n_buildings = 2;
	row.buildings[0] = row_building(2, 1e5, 1);
	row.buildings[1] = row_building(3, 1e5, 1);
	row.buildings[0].frequency_hz = 2.1, row.buildings[1].frequency_hz = 3;
	row.n_contacts = 2;
	row.contacts[0] = (struct row_contact){0, {2, 2.6}};
	row.contacts[1] = (struct row_contact){0, {1, 1.3}};
	row_run_all(&row, row_harmonic(&row, 2, 2.5, 3), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 2, END_U, .00352661275337169, .00678666765581637, .00704048971824242);
	LINKS(row, IMPULSE_MAX, 85896.7700219882, 46498.6591743184);
}

CHECK_MAIN(cmocka_unit_test(two_and_two_stories_come_out),
           cmocka_unit_test(three_and_two_stories_without_tension_come_out),
           cmocka_unit_test(elastoplastic_stories_come_out),
           cmocka_unit_test(oriented_and_elastic_stories_come_out),
           cmocka_unit_test(a_row_of_three_comes_out), cmocka_unit_test(a_wall_comes_out),
           cmocka_unit_test(levels_within_stories_come_out))
