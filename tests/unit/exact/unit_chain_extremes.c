/* unit_chain_extremes.c - a table of stiff and extreme rows of buildings: runs end, energy balances, same bytes with
 * 1, 4 and 8 lanes.
 *
 * `make extremes` prints the table. */
#include "engine/numeric/cpu_width.h"
#include "tests/support/chain_scenes.h"
#include "tests/support/check.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>

enum { ENERGY = POUND_CHAIN_DRIFTS | POUND_CHAIN_ENERGY, SAMPLES = 151 };

static struct row row;

static int law_row(const char *name)
{
	int row_of = 0;
	while (strcmp(pound_law_name(row_of), name) != 0)
		row_of++;
	return row_of;
}

static void contact_model(const char *name, double restitution)
{
	row.contact.model = 0;
	while (strcmp(pound_contact_name(row.contact.model), name) != 0)
		row.contact.model++;
	row.contact.restitution = restitution;
	row.contact.second_stiffness_ratio = 0.3;
	row.contact.yield_overlap = 2e-4;
	row.contact.reference_speed = 0.1;
	row.contact.speed_floor = 0.001;
}

/* Two buildings with contacts at all floors under 1.5 s of a sine that makes both yield. */
static void pair_of_buildings(int left, int right)
{
	row_init(&row);
	row.n_buildings = 2;
	row.contact.gap = 0.005;
	row.buildings[0] = row_building(left, 1e5, 1);
	row.buildings[1] = row_building(right, 1e5, 1);
	row.buildings[0].frequency_hz = left > 20 ? 0.6 : 1.5;
	row.buildings[1].frequency_hz = right > 20 ? 0.9 : 2.7;
	row_harmonic(&row, 1.4, 1.5, 4);
}

/* Runs the row with other lane counts: the same bytes. */
static void lanes_check(void)
{
	static struct row other;
	for (int lanes = 1; lanes <= 8; lanes = lanes == 1 ? 4 : 2 * lanes) {
		if (pound_dispatch_width(lanes) < 0)
			continue;
		other = row;
		const struct pound_chain_task task = row_task(&other, SAMPLES, 0.01, ENERGY);
		row_run(&other, &task, lanes);
		assert_memory_equal(row.floor_measures, other.floor_measures, sizeof row.floor_measures);
		assert_memory_equal(row.link_measures, other.link_measures, sizeof row.link_measures);
	}
}

/* Runs the row, prints its line of the table, and checks it. */
static void scene_check(const char *what)
{
	const struct pound_chain_task task = row_task(&row, SAMPLES, 0.01, ENERGY);
	const clock_t start = clock();
	const struct pound_chain_result result = row_run(&row, &task, 0);
	const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
	double contacts = 0, drift = 0, impulse = 0;
	for (int j = 0; j < task.n_links; j++) {
		contacts += row.link_measures[j][POUND_LINK_CONTACTS];
		impulse = fmax(impulse, row.link_measures[j][POUND_LINK_IMPULSE_MAX]);
	}
	for (int i = 0; i < task.n_floors; i++)
		drift = fmax(drift, row.floor_measures[i][POUND_FLOOR_DRIFT_MAX]);
	printf("| %s | %d | %.0f | %.3g | %.3g | %.1e | %.2g |\n", what, task.n_floors, contacts, drift, impulse,
	       result.energy_residual, seconds);
	assert_int_equal(result.status, POUND_OK);
	assert_true(drift > 0 && drift < 1);
	assert_true(result.energy_residual < 1e-10);
	lanes_check();
}

static void table_head(void)
{
	printf("| scene | floors | contacts | largest drift (m) | impulse (N s) | energy residual | s |\n"
	       "| --- | --- | --- | --- | --- | --- | --- |\n");
}

static const char *text(const char *format, ...)
{
	static char line[128];
	va_list values;
	va_start(values, format);
	vsnprintf(line, sizeof line, format, values);
	va_end(values);
	return line;
}

static void any_number_of_stories(void **state)
{
	(void)state;
	static const int stories[][2] = {{1, 1}, {1, 50}, {2, 3}, {10, 20}, {50, 50}};
	table_head();
	for (size_t k = 0; k < sizeof stories / sizeof stories[0]; k++) {
		pair_of_buildings(stories[k][0], stories[k][1]);
		scene_check(text("%d and %d stories", stories[k][0], stories[k][1]));
	}
}

static void contacts_of_any_stiffness(void **state)
{
	(void)state;
	for (double ratio = 1e2; ratio < 2e8; ratio *= 100)
		for (int tension = 0; tension < 2; tension++) {
			pair_of_buildings(3, 2);
			row.contact.stiffness_ratio = ratio;
			row.contact.tension = tension;
			scene_check(text(tension ? "K/k = %.0e" : "K/k = %.0e, no tension", ratio));
		}
}

static void stories_a_million_times_stiffer(void **state)
{
	(void)state;
	for (int stiff = 0; stiff < 3; stiff++) {
		pair_of_buildings(3, 2);
		row.buildings[0].stiffness[stiff] = 1e6;
		row.contact.stiffness_ratio = 1e-4;
		scene_check(text("story %.0f 1e6 times stiffer", stiff + 1.0));
	}
}

static void masses_of_any_ratio(void **state)
{
	(void)state;
	static const double ratios[] = {1e-3, 1e3};
	for (int k = 0; k < 2; k++) {
		pair_of_buildings(4, 4);
		for (int i = 0; i < 4; i++) {
			row.buildings[1].mass[i] *= ratios[k];
			row.buildings[1].stiffness[i] *= ratios[k];
		}
		scene_check(text("masses 1 to %.0e", ratios[k]));
		pair_of_buildings(4, 4);
		row.buildings[0].mass[2] *= ratios[k];
		scene_check(text("one floor %.0e times as heavy", ratios[k]));
	}
}

static void all_floors_at_once(void **state)
{
	(void)state;
	// floors of one building hit a wall simultaneously: all stories but the first are nearly rigid
	pair_of_buildings(4, 1);
	row.n_buildings = 1;
	row.wall = true;
	for (int i = 1; i < 4; i++)
		row.buildings[0].stiffness[i] = 1e4;
	row.contact.stiffness_ratio = 1e-2;
	scene_check("a stiff block meets a wall with four floors");
	// and floors of two equal buildings, one of which is at rest until the impact
	pair_of_buildings(5, 5);
	row.buildings[1] = row.buildings[0];
	row.buildings[1].frequency_hz *= 2;
	row.contact.gap = 0;
	scene_check("no gap, modes of the same shape");
}

static void bodies_pressed_on_each_other(void **state)
{
	(void)state;
	for (int restitution = 0; restitution < 2; restitution++) {
		pair_of_buildings(3, 1);
		row.n_buildings = 1;
		row.wall = true;
		row.contact.gap = 0.001;
		row.contact.restitution = restitution;
		row.buildings[0].damping_ratio = 0.1;
		for (int i = 0; i < SAMPLES; i++)
			row.ground[i] = -3;
		scene_check(text("pressed to a wall, restitution %.0f", restitution));
	}
}

static void levels_within_stories(void **state)
{
	(void)state;
	pair_of_buildings(3, 4);
	row.n_contacts = 4;
	for (int j = 0; j < 4; j++)
		row.contacts[j] = (struct row_contact){0, {0.7 + 0.7 * j, 0.5 + 0.9 * j}};
	scene_check("four pairs of levels within stories");
	pair_of_buildings(2, 2);
	row.n_contacts = 3;
	for (int j = 0; j < 3; j++)
		row.contacts[j] = (struct row_contact){0, {1 + 1e-6 * j, 1}};
	scene_check("three contacts at nearly the same levels");
}

static void stories_that_yield_at_once(void **state)
{
	(void)state;
	for (int law = 0; law < 4; law++) {
		// all drifts are equal: the first mode of these stiffnesses is a straight line
		pair_of_buildings(6, 6);
		for (int b = 0; b < 2; b++) {
			for (int i = 0; i < 6; i++)
				row.buildings[b].stiffness[i] = 42 - i * (i + 1);
			row.buildings[b].damping = ROW_STIFFNESS;
			row.buildings[b].law = (struct pound_backbone){.law = law, .hardening = 0, .yield = 0.002};
		}
		scene_check(text("%s, straight modes, no hardening", pound_law_name(law)));
	}
	pair_of_buildings(6, 6);
	row.buildings[1] = row.buildings[0];
	row.buildings[0].law = row.buildings[1].law =
	    (struct pound_backbone){.law = law_row("elastoplastic"), .hardening = .02, .yield = .001};
	row.contact.gap = 0;
	scene_check("equal buildings side by side");
}

static void every_contact_model(void **state)
{
	(void)state;
	for (int model = 0; pound_contact_name(model); model++) {
		char name[64];
		for (double ratio = 1e2; ratio < 2e6; ratio *= 1e4) {
			pair_of_buildings(5, 8);
			contact_model(pound_contact_name(model), 0.65);
			row.contact.stiffness_ratio = ratio;
			snprintf(name, sizeof name, "%s, K/k = %.0e", pound_contact_name(model), ratio);
			scene_check(name);
		}
		pair_of_buildings(3, 4);
		contact_model(pound_contact_name(model), 0.65);
		row.n_contacts = 4;
		for (int j = 0; j < 4; j++)
			row.contacts[j] = (struct row_contact){0, {0.7 + 0.7 * j, 0.5 + 0.9 * j}};
		snprintf(name, sizeof name, "%s, levels within stories", pound_contact_name(model));
		scene_check(name);
	}
}

/* Bounces that become shorter until sustained contact, and separation when the ground acceleration changes sign. */
static void rigid_impacts_that_end_in_sticking(void **state)
{
	(void)state;
	static const double restitutions[] = {0, 0.3, 0.6, 0.9, 0.97};
	for (size_t k = 0; k < sizeof restitutions / sizeof restitutions[0]; k++) {
		for (int wall = 0; wall < 2; wall++) {
			pair_of_buildings(3, 2);
			contact_model("rigid", restitutions[k]);
			row.contact.gap = 0.001;
			if (wall)
				row.n_buildings = 1, row.wall = true;
			else
				row.buildings[1].frequency_hz = 9;
			for (int i = 0; i < SAMPLES; i++)
				row.ground[i] = i < 100 ? -3 : 3;
			row.buildings[0].damping_ratio = 0.1;
			scene_check(text(wall ? "rigid, pressed to a wall, restitution %.2g"
			                      : "rigid, pressed to a stiffer building, restitution %.2g",
			                 restitutions[k]));
		}
		pair_of_buildings(4, 1);
		contact_model("rigid", restitutions[k]);
		row.n_buildings = 1;
		row.wall = true;
		for (int i = 1; i < 4; i++)
			row.buildings[0].stiffness[i] = 1e4;
		scene_check(text("rigid, a stiff block meets a wall, restitution %.2g", restitutions[k]));
	}
}

static void rigid_impacts_while_all_stories_yield(void **state)
{
	(void)state;
	pair_of_buildings(6, 6);
	contact_model("rigid", 0.6);
	for (int b = 0; b < 2; b++) {
		for (int i = 0; i < 6; i++)
			row.buildings[b].stiffness[i] = 42 - i * (i + 1);
		row.buildings[b].damping = ROW_STIFFNESS;
		row.buildings[b].law =
		    (struct pound_backbone){.law = law_row("elastoplastic"), .hardening = 0, .yield = 0.002};
	}
	row.buildings[1].law.yield = 0.004;
	row_harmonic(&row, 1.4, 1.5, -4);
	scene_check("rigid, elastoplastic, straight modes, no hardening");
}

static void streets_of_every_length(void **state)
{
	(void)state;
	for (int n = 3; n <= 8; n += 5) {
		row_init(&row);
		row.n_buildings = n;
		row.contact.gap = 0.004;
		for (int b = 0; b < n; b++) {
			row.buildings[b] = row_building(2 + b % 5, 1e5, 1);
			row.buildings[b].frequency_hz = 1.2 + 0.4 * (b * 3 % 7);
		}
		row_harmonic(&row, 1.4, 1.5, 4);
		scene_check(text("%.0f buildings", n));
		contact_model("rigid", 0.6);
		scene_check(text("%.0f buildings, rigid", n));
	}
}

static void what_takes_too_many_steps_has_a_name(void **state)
{
	(void)state;
	pair_of_buildings(2, 2);
	row.contact.stiffness_ratio = 1e18;
	row.contact.gap = 0;
	row.buildings[0].frequency_hz = 1.5;
	for (int i = 0; i < SAMPLES; i++)
		row.ground[i] = i % 2 ? -3 : -2.9;
	const struct pound_chain_task task = row_task(&row, SAMPLES, 0.01, ENERGY);
	assert_int_equal(row_run(&row, &task, 0).status, POUND_CHATTER);
}

CHECK_MAIN(cmocka_unit_test(any_number_of_stories), cmocka_unit_test(contacts_of_any_stiffness),
           cmocka_unit_test(stories_a_million_times_stiffer), cmocka_unit_test(masses_of_any_ratio),
           cmocka_unit_test(all_floors_at_once), cmocka_unit_test(bodies_pressed_on_each_other),
           cmocka_unit_test(levels_within_stories), cmocka_unit_test(stories_that_yield_at_once),
           cmocka_unit_test(every_contact_model), cmocka_unit_test(rigid_impacts_that_end_in_sticking),
           cmocka_unit_test(rigid_impacts_while_all_stories_yield), cmocka_unit_test(streets_of_every_length),
           cmocka_unit_test(what_takes_too_many_steps_has_a_name))
