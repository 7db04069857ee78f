/* unit_nonlinear_contact.c - contacts of every model in chains: isolated impacts and equilibrium against closed forms
 * and known answers of other programs, rows of buildings by their energy balance, and the same bits at every lane
 * count. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/exact/chain.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

enum { SAMPLES = 401, FLOORS = 6, LINKS = 4 };

static _Alignas(64) char scratch[POUND_CHAIN_SCRATCH];

static int row_of(const char *name)
{
	int row = 0;
	while (strcmp(pound_contact_name(row), name) != 0)
		row++;
	return row;
}

struct outcome {
	struct pound_chain_result result;
	double floors[FLOORS][POUND_FLOOR_MEASURES], links[LINKS][POUND_LINK_MEASURES];
};

static void run(const struct pound_chain_task *task, int lanes, struct outcome *o)
{
	memset(o, 0, sizeof *o);
	o->result = (struct pound_chain_result){.floors = o->floors[0], .links = o->links[0]};
	assert_true(pound_chain_lanes(lanes, task, &o->result, 1, scratch, NULL));
}

static const unsigned EVERYTHING = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS |
                                   POUND_CHAIN_ACCELERATIONS | POUND_CHAIN_FORCES | POUND_CHAIN_ENERGY;

/* ---- isolated impacts ---- */

/* The ground gives a free body 0.3 m/s before it meets a wall; the body's spring has a period of weeks. */
static void isolated(const struct pound_contact_law *law, double mass, struct outcome *o)
{
	static double ground[SAMPLES] = {-20, -20};
	const struct pound_chain_floor floor = {.mass = mass, .story = {.stiffness = 1e-12 * mass}, .base = true};
	const struct pound_link link = {.floor = {{0, 0}, {POUND_CHAIN_GROUND, POUND_CHAIN_GROUND}},
	                                .weight = {{1, 0}, {1, 0}},
	                                .law = *law,
	                                .gap = 0.01};
	const struct pound_chain_task task = {.ground = ground,
	                                      .n_samples = 21,
	                                      .time_step = 0.01,
	                                      .n_floors = 1,
	                                      .n_links = 1,
	                                      .floors = &floor,
	                                      .links = &link,
	                                      .asked = EVERYTHING};
	run(&task, 0, o);
	assert_int_equal(o->result.status, POUND_OK);
	assert_true(o->links[0][POUND_LINK_CONTACTS] == 1);
	check_near(o->links[0][POUND_LINK_FIRST_SPEED], 0.3, 1e-13);
	check_near(o->result.energy_residual, 0, 1e-12);
}

static void isolated_impacts_are_those_of_the_known_answers(void **state)
{
	(void)state;
	static const struct {
		const char *model;
		struct pound_contact_law law;        // its dashpot is z, x or D
		double restitution, duration, force; // 0: unknown
	} cases[] = {
	    {"linear", {.stiffness = 1e5, .tension = true}, 1, .00811155735194722, 77.4596669241483},
	    {"modified_kelvin_voigt",
	     {.stiffness = 1e5, .dashpot = 0.2, .tension = true},
	     .756134926838310,
	     .00766456574121097,
	     0},
	    {"hertz", {.stiffness = 1e6, .tension = true}, 1, .0138590709920071, 53.0929379397467},
	    {"hertz_damp", {.stiffness = 1e6, .dashpot = 0.5, .tension = true}, .748434931597434, 0, 0},
	    {"hunt_crossley", {.stiffness = 1e5, .dashpot = 0.5, .tension = true}, .748434931597434, 0, 0},
	    {"viscoelastic", {.stiffness = 1e6, .dashpot = 0.3, .tension = true}, .696375578094729, 0, 0},
	    {"damped_hertz", {.stiffness = 1e6, .dashpot = 0.3, .tension = true}, .416833396691265, 0, 0},
	    {"damped_hertz", {.stiffness = 1e6, .dashpot = 0.3, .tension = false}, .484938945766768, 0, 0},
	    {"bilinear",
	     {.stiffness = 1e5, .second_stiffness = 3e4, .yield_overlap = 2e-4, .tension = true},
	     .775673013829125,
	     0,
	     45.6070170039655},
	};
	const double m = 2.0 / 3;
	for (int i = 0; i < COUNT(cases); i++) {
		struct pound_contact_law law = cases[i].law;
		struct outcome o;
		law.model = row_of(cases[i].model);
		if (!pound_contact_reads(law.model, "speed_floor_m_s"))
			law.dashpot *= 2 * sqrt(law.stiffness * m);
		isolated(&law, m, &o);
		check_near(-o.floors[0][POUND_FLOOR_END_V] / 0.3, cases[i].restitution, 1e-12);
		check_near(o.links[0][POUND_LINK_IMPULSE_MAX], m * 0.3 * (1 + cases[i].restitution), 1e-12);
		if (cases[i].duration > 0)
			check_near(o.links[0][POUND_LINK_TIME], cases[i].duration, 1e-12 * cases[i].duration);
		if (cases[i].force > 0)
			check_near(o.links[0][POUND_LINK_FORCE_MAX], cases[i].force, 1e-12 * cases[i].force);
	}
}

/* 2.943275184324705 p_max/v with p_max = (5 m v^2/(4 K))^(2/5), for any mass and stiffness. */
static void a_hertz_contact_lasts_as_long_as_its_closed_form(void **state)
{
	(void)state;
	for (double k = 1e6; k < 2e9; k *= 30)
		for (double m = 0.1; m < 20; m *= 5) {
			const struct pound_contact_law law = {.model = row_of("hertz"), .stiffness = k, .tension = true};
			struct outcome o;
			isolated(&law, m, &o);
			const double want = 2.943275184324705 * pow(5 * m * 0.3 * 0.3 / (4 * k), 0.4) / 0.3;
			check_near(o.links[0][POUND_LINK_TIME], want, 1e-12 * want);
		}
}

static void exact_calibrations_give_the_restitution_that_was_asked_for(void **state)
{
	(void)state;
	static const char *const models[] = {"kelvin_voigt", "modified_kelvin_voigt", "viscoelastic",
	                                     "damped_hertz", "hunt_crossley",         "hertz_damp",
	                                     "rigid"};
	for (int i = 0; i < COUNT(models); i++)
		for (int tension = 0; tension < 2; tension++)
			for (double e = 0.05; e < 1; e += 0.05) {
				const struct pound_contact contact = {.model = row_of(models[i]),
				                                      .stiffness = 1e5,
				                                      .reference_speed = 0.1,
				                                      .restitution = e,
				                                      .calibration = 1,
				                                      .tension = tension,
				                                      .speed_floor = 1e-3};
				const struct pound_contact_place place = {.stiffness = 1, .inverse_mass = 0.5, .mass = 1};
				const struct pound_contact_law law = pound_contact_law(&contact, &place);
				struct outcome o;
				isolated(&law, 2, &o);
				check_near(-o.floors[0][POUND_FLOOR_END_V] / 0.3, e, 1e-12);
			}
}

/* Two free bodies of the same speed meet their walls at the same time: each contact is as in a separate run. */
static void contacts_that_begin_at_one_instant_are_those_of_each(void **state)
{
	(void)state;
	static const char *const models[] = {"hertz", "hertz_damp", "viscoelastic", "damped_hertz"};
	static double ground[SAMPLES] = {-20, -20};
	static const double mass[2] = {2, 3}, stiffness[2] = {1e6, 4e5};
	const int n = COUNT(models);
	for (int pair = 0; pair < n * n * 2; pair++) {
		struct pound_chain_floor floors[2];
		struct pound_link links[2];
		struct outcome both, one[2];
		for (int i = 0; i < 2; i++) {
			const struct pound_contact_law law = {
			    .model = row_of(models[i ? pair / 2 / n : pair / 2 % n]),
			    .stiffness = stiffness[i],
			    .dashpot =
			        pound_contact_reads(row_of(models[i ? pair / 2 / n : pair / 2 % n]), "speed_floor_m_s")
			            ? 0.5
			            : 0.3 * 2 * sqrt(stiffness[i] * mass[i]),
			    .tension = pair % 2};
			isolated(&law, mass[i], &one[i]);
			floors[i] = (struct pound_chain_floor){
			    .mass = mass[i], .story = {.stiffness = 1e-12 * mass[i]}, .base = true};
			links[i] = (struct pound_link){.floor = {{i, i}, {POUND_CHAIN_GROUND, POUND_CHAIN_GROUND}},
			                               .weight = {{1, 0}, {1, 0}},
			                               .law = law,
			                               .gap = 0.01};
		}
		const struct pound_chain_task task = {.ground = ground,
		                                      .n_samples = 21,
		                                      .time_step = 0.01,
		                                      .n_floors = 2,
		                                      .n_links = 2,
		                                      .floors = floors,
		                                      .links = links,
		                                      .asked = EVERYTHING};
		run(&task, 0, &both);
		assert_int_equal(both.result.status, POUND_OK);
		for (int i = 0; i < 2; i++) {
			static const int measures[] = {POUND_LINK_IMPULSE_MAX, POUND_LINK_FORCE_MAX, POUND_LINK_TIME};
			check_near(both.floors[i][POUND_FLOOR_END_V], one[i].floors[0][POUND_FLOOR_END_V], 1e-13);
			for (int k = 0; k < COUNT(measures); k++) {
				const double alone = one[i].links[0][measures[k]];
				check_near(both.links[i][measures[k]], alone, 1e-12 * alone);
			}
		}
	}
}

/* ---- rigid contacts ---- */

/* A constant acceleration of 1 m/s2 drives a body against a wall 10 mm away; it bounces with e = 0.5 from
 * (2 gap/a)^1/2 on, and is in sustained contact from three times that time until the ground acceleration changes sign
 * at 0.81 s. */
static void hops_of_a_rigid_contact_end_at_the_wall(void **state)
{
	(void)state;
	static double ground[SAMPLES];
	for (int t = 0; t < 101; t++)
		ground[t] = t < 80 ? -1 : -1 + 0.5 * (t - 79);
	const struct pound_chain_floor floor = {.mass = 2, .story = {.stiffness = 1e-12}, .base = true};
	struct pound_link link = {.floor = {{0, 0}, {POUND_CHAIN_GROUND, POUND_CHAIN_GROUND}},
	                          .weight = {{1, 0}, {1, 0}},
	                          .law = {.model = row_of("rigid"), .restitution = 0.5, .speed_floor = 1e-3},
	                          .gap = 0.01};
	const struct pound_chain_task task = {.ground = ground,
	                                      .n_samples = 101,
	                                      .time_step = 0.01,
	                                      .n_floors = 1,
	                                      .n_links = 1,
	                                      .floors = &floor,
	                                      .links = &link,
	                                      .asked = EVERYTHING};
	struct outcome o;
	run(&task, 0, &o);
	assert_int_equal(o.result.status, POUND_OK);
	check_near(o.links[0][POUND_LINK_FIRST_TIME], .141421356237310, 1e-13);
	check_near(o.links[0][POUND_LINK_TIME], 0.81 - .424264068711929, 1e-12);
	// speeds of 0.5^k (2 a gap)^1/2 down to 1e-3
	assert_true(o.links[0][POUND_LINK_CONTACTS] == 8);
	// 2 N until 0.79 s, then down to 0 in 0.02 s
	check_near(o.links[0][POUND_LINK_IMPULSE_MAX], 2 * (0.79 - .424264068711929) + 0.02, 1e-12);
	check_near(o.links[0][POUND_LINK_FORCE_MAX], 2, 1e-12);
	// the ground after 0.81 s: 0.5 (t - 0.81)/0.01
	check_near(o.floors[0][POUND_FLOOR_END_V], -25 * 0.19 * 0.19, 1e-11);
	check_near(o.result.energy_residual, 0, 1e-12);
	// without restitution it is in sustained contact from the first impact on
	link.law.restitution = 0;
	run(&task, 0, &o);
	check_near(o.links[0][POUND_LINK_TIME], 0.81 - .141421356237310, 1e-12);
	assert_true(o.links[0][POUND_LINK_CONTACTS] == 1);
}

/* ---- rows ---- */

/* Three buildings of two stories under noise; each contact has another model. */
struct touch_row {
	double ground[SAMPLES];
	struct pound_chain_floor floors[FLOORS];
	struct pound_link links[LINKS];
	struct pound_chain_task task;
};

static void touch_row_make(struct touch_row *s, int number, int model)
{
	uint64_t stream = 1000 + (uint64_t)number;
	memset(s, 0, sizeof *s);
	for (int t = 1; t < SAMPLES; t++)
		s->ground[t] = specimen_uniform(&stream, -6, 6);
	for (int i = 0; i < FLOORS; i++) {
		const double m = specimen_uniform(&stream, 5e4, 3e5), w = specimen_uniform(&stream, 10, 40);
		s->floors[i] = (struct pound_chain_floor){
		    .mass = m,
		    .dashpot = 0.02 * m * w,
		    .story = {.law = number % 2, .stiffness = m * w * w, .hardening = 0.1, .yield = 0.01},
		    .base = i % 2 == 0};
	}
	for (int j = 0; j < LINKS; j++) {
		const int left = j / 2 * 2 + j % 2;
		const double K = s->floors[left].story.stiffness;
		const struct pound_contact contact = {.model = model >= 0 ? model
		                                                          : (number + 3 * j) % POUND_CONTACT_MODELS,
		                                      .stiffness_ratio = pow(10, specimen_uniform(&stream, 1, 4)),
		                                      .reference_speed = 0.1,
		                                      .restitution = specimen_uniform(&stream, 0.2, 1),
		                                      .calibration = j % 2,
		                                      .tension = number / 2 % 2,
		                                      .second_stiffness_ratio = 0.3,
		                                      .yield_overlap = 1e-3,
		                                      .speed_floor = 1e-3};
		const struct pound_contact_place place = {.stiffness = K,
		                                          .inverse_mass =
		                                              1 / s->floors[left].mass + 1 / s->floors[left + 2].mass,
		                                          .mass = 1};
		s->links[j] = (struct pound_link){.floor = {{left, left}, {left + 2, left + 2}},
		                                  .weight = {{1, 0}, {1, 0}},
		                                  .law = pound_contact_law(&contact, &place),
		                                  .gap = number % 3 * 0.005};
	}
	s->task = (struct pound_chain_task){.ground = s->ground,
	                                    .n_samples = SAMPLES,
	                                    .time_step = 0.01,
	                                    .n_floors = FLOORS,
	                                    .n_links = LINKS,
	                                    .floors = s->floors,
	                                    .links = s->links,
	                                    .asked = EVERYTHING};
}

static void energy_is_kept_by_every_model_in_rows_of_buildings(void **state)
{
	(void)state;
	static struct touch_row s;
	struct outcome o;
	for (int number = 0; number < 60; number++) {
		touch_row_make(&s, number, number < 40 ? number % POUND_CONTACT_MODELS : -1);
		run(&s.task, 0, &o);
		double contacts = 0;
		for (int j = 0; j < LINKS; j++)
			contacts += o.links[j][POUND_LINK_CONTACTS];
		if (o.result.status != POUND_OK || !(o.result.energy_residual < 1e-11) || contacts < 5)
			fail_msg("row %d: status %d, residual %g, %g contacts", number, o.result.status,
			         o.result.energy_residual, contacts);
	}
}

static void every_lane_count_gives_the_same_bits(void **state)
{
	(void)state;
	static const int lanes[] = {4, 8};
	static struct touch_row s;
	struct outcome one, other;
	for (int number = 0; number < 12; number++) {
		touch_row_make(&s, number, number < POUND_CONTACT_MODELS ? number : -1);
		run(&s.task, 1, &one);
		for (int k = 0; k < COUNT(lanes); k++) {
			memset(&other, 0, sizeof other);
			other.result = (struct pound_chain_result){.floors = other.floors[0], .links = other.links[0]};
			if (!pound_chain_lanes(lanes[k], &s.task, &other.result, 1, scratch, NULL))
				continue; // not supported by this processor
			assert_memory_equal(one.floors, other.floors, sizeof one.floors);
			assert_memory_equal(one.links, other.links, sizeof one.links);
			assert_true(one.result.energy_residual == other.result.energy_residual);
		}
	}
}

CHECK_MAIN(cmocka_unit_test(isolated_impacts_are_those_of_the_known_answers),
           cmocka_unit_test(a_hertz_contact_lasts_as_long_as_its_closed_form),
           cmocka_unit_test(exact_calibrations_give_the_restitution_that_was_asked_for),
           cmocka_unit_test(contacts_that_begin_at_one_instant_are_those_of_each),
           cmocka_unit_test(hops_of_a_rigid_contact_end_at_the_wall),
           cmocka_unit_test(energy_is_kept_by_every_model_in_rows_of_buildings),
           cmocka_unit_test(every_lane_count_gives_the_same_bits))
