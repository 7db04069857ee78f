/* unit_chain.c - rows of buildings against known answers by two independent programs with 113-bit arithmetic
 * (buildings.md 4). */
#include "engine/exact/task.h"
#include "engine/numeric/cpu_width.h"
#include "engine/solver/solver.h"
#include "tests/support/check.h"
#include "tests/support/known_rows.h"
#include "tests/support/scenes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double rounding = 1e-12;

enum {
	ALL = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS | POUND_CHAIN_ACCELERATIONS | POUND_CHAIN_FORCES
};

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

/* Compares a measure of some floors or links with known values of 15 digits. */
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

static void two_and_two_stories(unsigned asked)
{
	row_run_all(&row, row_known(&row, ROW_TWO_AND_TWO), asked);
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
	row_run_all(&row, row_known(&row, ROW_NO_TENSION), ALL | POUND_CHAIN_ENERGY);
	LINKS(row, IMPULSE_MAX, 92064.1704763961, 171145.829011237);
	LINKS(row, CONTACTS, 15, 24);
}

static void elastoplastic_stories_come_out(void **state)
{
	(void)state;
	row_run_all(&row, row_known(&row, ROW_ELASTOPLASTIC), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 0, DRIFT_MAX, .0543830397504243);
	FLOORS(row, 4, DRIFT_MAX, .00437356787206889);
	LINKS(row, IMPULSE_MAX, 20846.9044225477, 6377.99175536268, 46038.3574530376);
	LINKS(row, CONTACTS, 1, 1, 4);
	check_near(row.floor_measures[0][POUND_FLOOR_RESIDUAL], -.0237297967531740, 1e-13);
	check_near(row.floor_measures[3][POUND_FLOOR_RESIDUAL], -.00190093692600578, 1e-13);
	check_near(row.floor_measures[4][POUND_FLOOR_RESIDUAL], 0, 0);
}

static void oriented_and_elastic_stories_come_out(void **state)
{
	(void)state;
	row_run_all(&row, row_known(&row, ROW_ORIENTED), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 0, END_U, -.0288257306792830, -.0349757137371883, .00542429407945448, -.00765103769578269,
	       .000479404201646032);
	LINKS(row, IMPULSE_MAX, 46379.3500931483, 32147.0962135886);
}

static void a_row_of_three_comes_out(void **state)
{
	(void)state;
	row_run_all(&row, row_known(&row, ROW_OF_THREE), ALL | POUND_CHAIN_ENERGY);
	LINKS(row, IMPULSE_MAX, 64417.5150918300, 154865.564934878, 89265.2187302767, 235098.891474731);
	LINKS(row, CONTACTS, 7, 27, 11, 17);
}

static void a_wall_comes_out(void **state)
{
	(void)state;
	row_run_all(&row, row_known(&row, ROW_WALL), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 0, DRIFT_MAX, .0276030785389800, .0187474422578475, .0227574862260666, .0169328391209189);
	LINKS(row, IMPULSE_MAX, 85009.0893182793, 78054.5007567976);
}

static void levels_within_stories_come_out(void **state)
{
	(void)state;
	row_run_all(&row, row_known(&row, ROW_LEVELS), ALL | POUND_CHAIN_ENERGY);
	FLOORS(row, 2, END_U, .00352661275337169, .00678666765581637, .00704048971824242);
	LINKS(row, IMPULSE_MAX, 85896.7700219882, 46498.6591743184);
}

/* ---- invariants ---- */

static void rows_have_the_same_bytes_at_every_lane_count(void **state)
{
	(void)state;
	static struct row one, other;
	for (int number = 0; number < check_count(20, 1000); number++)
		for (int energy = 0; energy < 2; energy++) {
			const int n = row_random(&one, (uint64_t)number);
			other = one;
			const struct pound_chain_task task =
			    row_task(&one, n, 0.01, (unsigned)(ALL | (energy ? POUND_CHAIN_ENERGY : 0)));
			const struct pound_chain_task same = row_task(&other, n, 0.01, task.asked);
			row_run(&one, &task, 1);
			for (int lanes = 4; lanes <= 8; lanes += 4) {
				if (pound_dispatch_width(lanes) < 0)
					continue;
				row_run(&other, &same, lanes);
				assert_memory_equal(one.floor_measures, other.floor_measures, sizeof one.floor_measures);
				assert_memory_equal(one.link_measures, other.link_measures, sizeof one.link_measures);
			}
		}
}

/* Whole samples by modes against power series in every step, which are used if an energy balance is requested. */
static void free_motion_agrees_with_series(void **state)
{
	(void)state;
	static struct row modal, slow;
	double worst = 0, residual = 0;
	const int rows = check_count(30, 2000);
	for (int number = 0; number < rows; number++) {
		const int n = row_random(&modal, (uint64_t)number);
		slow = modal;
		const unsigned asked = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS | POUND_CHAIN_ACCELERATIONS;
		const struct pound_chain_task task = row_task(&modal, n, 0.01, asked);
		const struct pound_chain_task same = row_task(&slow, n, 0.01, asked | POUND_CHAIN_ENERGY);
		assert_int_equal(row_run(&modal, &task, 0).status, POUND_OK);
		const struct pound_chain_result result = row_run(&slow, &same, 0);
		assert_int_equal(result.status, POUND_OK);
		residual = fmax(residual, result.energy_residual);
		for (int m = 0; m <= POUND_FLOOR_ACCELERATION_MAX; m++) {
			double top = 0, error = 0;
			for (int i = 0; i < task.n_floors; i++) {
				top = fmax(top, slow.floor_measures[i][m]);
				error = fmax(error, fabs(slow.floor_measures[i][m] - modal.floor_measures[i][m]));
			}
			worst = fmax(worst, error / top);
		}
	}
	check_report("%d rows: free motion off series by %.1e, energy residual %.1e at most", rows, worst,
	             residual);
	assert_true(residual < 1e-11);
	assert_true(worst < 1e-11); // impacts amplify errors
}

static void a_mirrored_row_under_a_mirrored_ground_is_mirrored(void **state)
{
	(void)state;
	static struct row left, right;
	for (int number = 0; number < 10; number++) {
		const int n = row_random(&left, (uint64_t)number);
		if (left.wall || left.n_buildings < 2)
			continue;
		right = left;
		for (int b = 0; b < left.n_buildings; b++)
			right.buildings[b] = left.buildings[left.n_buildings - 1 - b];
		for (int i = 0; i < n; i++)
			right.ground[i] = -left.ground[i];
		const struct pound_chain_task task = row_task(&left, n, 0.01, ALL),
		                              mirrored = row_task(&right, n, 0.01, ALL);
		row_run(&left, &task, 0);
		row_run(&right, &mirrored, 0);
		for (int b = 0; b < left.n_buildings; b++) {
			const int first = left.first[b], other = right.first[left.n_buildings - 1 - b];
			for (int i = 0; i < left.buildings[b].stories; i++)
				check_near(left.floor_measures[first + i][POUND_FLOOR_DRIFT_MAX],
				           right.floor_measures[other + i][POUND_FLOOR_DRIFT_MAX], 1e-11);
		}
	}
}

static void equal_buildings_do_not_meet(void **state)
{
	(void)state;
	row_init(&row);
	row.contact.gap = 0;
	row.n_buildings = 4;
	for (int b = 0; b < 4; b++) {
		row.buildings[b] = row_building(5, 1e5, 1e8);
		row.buildings[b].law =
		    (struct pound_backbone){.law = row_law("elastoplastic"), .hardening = .05, .yield = .003};
	}
	row_run_all(&row, row_harmonic(&row, 1.4, 5, 4), ALL);
	assert_true(row.floor_measures[0][POUND_FLOOR_DRIFT_MAX] > .003);
	for (int j = 0; j < 15; j++) {
		assert_true(row.link_measures[j][POUND_LINK_IMPULSE_MAX] < 1e-6); // rounding errors of 1e5 N s
		check_near(row.link_measures[j][POUND_LINK_CONTACTS], 0, 0);
	}
}

static void a_linear_row_scales(void **state)
{
	(void)state;
	static struct row once, twice;
	for (int number = 0; number < 10; number++) {
		const int n = row_random(&once, (uint64_t)number);
		for (int b = 0; b < once.n_buildings; b++)
			once.buildings[b].law.law = row_law("linear");
		twice = once;
		twice.contact.gap *= 2;
		for (int i = 0; i < n; i++)
			twice.ground[i] *= 2;
		const struct pound_chain_task task = row_task(&once, n, 0.01, ALL),
		                              more = row_task(&twice, n, 0.01, ALL);
		row_run(&once, &task, 0);
		row_run(&twice, &more, 0);
		for (int i = 0; i < task.n_floors; i++)
			for (int m = 0; m <= POUND_FLOOR_ACCELERATION_MAX; m++)
				check_near(2 * once.floor_measures[i][m], twice.floor_measures[i][m], 0);
	}
}

/* ---- observers ---- */

/* state at the end of the last piece, and largest jumps to the start of the next */
struct story {
	double time, u, v, gap_time, gap_u, gap_v, most;
	int pieces, samples;
};

static void story_add(void *into, const struct pound_chain_piece *piece)
{
	struct story *story = into;
	const struct pound_chain_floor_motion *floor = &piece->floors[0];
	const double h = piece->length;
	if (story->pieces++ > 0) {
		story->gap_time = fmax(story->gap_time, fabs(piece->time - story->time));
		story->gap_u = fmax(story->gap_u, fabs(floor->u - story->u));
		story->gap_v = fmax(story->gap_v, fabs(floor->v - floor->jump - story->v));
	}
	story->samples += piece->sampled;
	story->time = piece->time + h;
	story->u = floor->u + floor->v * h;
	story->v = floor->v;
	assert_false(piece->time_is_series);
	for (int n = piece->order; n >= 0; n--) {
		const double ground = n == 0 ? piece->ground : n == 1 ? piece->slope * h : 0;
		const double a = floor->acceleration[n] - ground;
		story->u += a * h * h / ((n + 1) * (n + 2));
		story->v += a * h / (n + 1);
		assert_true(piece->touching || floor->push[n] == 0);
	}
	story->most = fmax(story->most, fabs(story->u));
}

/* The second observed floor moves with the ground, without contact. */
static void an_observer_gets_the_whole_motion_of_a_floor(void **state)
{
	(void)state;
	static struct row r;
	for (int number = 0; number < 10; number++) {
		const int n = row_random(&r, (uint64_t)number);
		struct story story = {0};
		struct pound_chain_task task = row_task(&r, n, 0.01, ALL);
		const struct pound_chain_observer observer = {story_add, &story, .floor = task.n_floors - 1,
		                                              .link = -1};
		task.observer = &observer;
		assert_int_equal(row_run(&r, &task, 0).status, POUND_OK);
		const double *floor = r.floor_measures[task.n_floors - 1];
		assert_int_equal(story.samples, n - 1);
		check_near(story.time, (n - 1) * 0.01, 1e-12);
		check_near(story.gap_time, 0, 1e-12);
		check_near(story.gap_u, 0, 1e-13);
		check_near(story.gap_v, 0, 1e-11);
		check_near(story.u, floor[POUND_FLOOR_END_U], 1e-13);
		check_near(story.v, floor[POUND_FLOOR_END_V], 1e-11);
		assert_true(story.most <= floor[POUND_FLOOR_DISPLACEMENT_MAX] * (1 + 1e-13));
	}
}

/* ---- one story ---- */

/* A row of two one-story buildings as a pair. */
static struct pound_task pair_of(const struct row *r, const struct pound_chain_task *chain)
{
	const double m = r->floors[0].mass, m2 = r->floors[1].mass;
	struct pound_task task = {.ground = chain->ground,
	                          .n_samples = chain->n_samples,
	                          .time_step = chain->time_step,
	                          .contact = true,
	                          .gap = r->links[0].gap,
	                          .contact_stiffness = r->links[0].law.stiffness / m,
	                          .contact_damping = r->links[0].law.dashpot / m,
	                          .mass_ratio = m / m2,
	                          .tension = r->links[0].law.tension};
	for (int b = 0; b < 2; b++) {
		task.bodies[b] = (struct pound_task_body){.backbone = r->floors[b].story,
		                                          .damping = r->floors[b].dashpot / r->floors[b].mass,
		                                          .drive = 1,
		                                          .followed = true};
		task.bodies[b].backbone.stiffness /= r->floors[b].mass;
	}
	return task;
}

static void one_story_goes_as_the_pair(void **state)
{
	(void)state;
	static struct row r;
	double worst = 0;
	const int rows = check_count(60, 5000);
	void *scratch = aligned_alloc(64, POUND_EXACT_SCRATCH);
	assert_non_null(scratch);
	for (int number = 0; number < rows; number++) {
		const int n = row_random(&r, (uint64_t)number);
		r.n_buildings = 2;
		r.wall = false;
		for (int b = 0; b < 2; b++) {
			r.buildings[b] = row_building(1, 1e5 * (b + 1), 1);
			r.buildings[b].law = (struct pound_backbone){
			    .law = number % 4, .hardening = 0.05, .yield = 0.001 * (1 + number % 7)};
			r.buildings[b].frequency_hz = b ? 2.7 : 1.1;
		}
		const struct pound_chain_task task = row_task(&r, n, 0.01, ALL);
		const struct pound_task pair = pair_of(&r, &task);
		struct pound_task_result want;
		assert_true(pound_exact_lanes(0, &pair, &want, 1, scratch, NULL));
		row_run(&r, &task, 0);
		const double *link = r.link_measures[0];
		check_near(link[POUND_LINK_CONTACTS], (double)want.contacts, 0);
		const double of[][2] = {{r.floor_measures[0][POUND_FLOOR_DRIFT_MAX], want.displacement_max[0]},
		                        {r.floor_measures[1][POUND_FLOOR_DISPLACEMENT_MAX], want.displacement_max[1]},
		                        {link[POUND_LINK_IMPULSE_MAX], want.impulse_max * r.floors[0].mass},
		                        {link[POUND_LINK_TIME], want.contact_time},
		                        {link[POUND_LINK_FIRST_TIME], want.first_contact},
		                        {link[POUND_LINK_FIRST_SPEED], want.first_speed}};
		for (size_t k = 0; k < sizeof of / sizeof of[0]; k++)
			worst = fmax(worst, fabs(of[k][0] - of[k][1]) / fmax(fabs(of[k][1]), 1e-3));
	}
	free(scratch);
	check_report("%d rows of one story: off the pair by %.1e at most", rows, worst);
	assert_true(worst < 1e-12);
}

/* ---- work space ---- */

/* Eight buildings of 50 stories with contacts at every floor, by every solver of rows; the bytes after the work space
 * are checked. */
static void the_largest_row_of_straight_contacts_takes_a_mebibyte(void **state)
{
	(void)state;
	enum { SAMPLES = 61, LINKS = 350, END = 64, FILL = 0x5a };
	static struct pound_chain_floor floors[POUND_CHAIN_FLOORS];
	static struct pound_link links[LINKS];
	static double ground[SAMPLES], measures[2][POUND_CHAIN_FLOORS][POUND_FLOOR_MEASURES],
	    contacts[2][LINKS][POUND_LINK_MEASURES];
	for (int i = 0; i < POUND_CHAIN_FLOORS; i++)
		floors[i] = (struct pound_chain_floor){.mass = 1e5,
		                                       .dashpot = 1e6,
		                                       .mass_damping = 0.1,
		                                       .story = {.law = row_law("elastoplastic"),
		                                                 .stiffness = (1 + i / 50) * 1e9,
		                                                 .hardening = .05,
		                                                 .yield = .001},
		                                       .base = i % 50 == 0};
	for (int k = 0; k < LINKS; k++)
		links[k] = (struct pound_link){.floor = {{k, k}, {k + 50, k + 50}},
		                               .weight = {{0, 1}, {0, 1}},
		                               .law = {.stiffness = 2e10, .dashpot = 5e6, .tension = true},
		                               .gap = 1e-5};
	for (int t = 0; t < SAMPLES; t++)
		ground[t] = -4 * sin(0.15 * t);
	const struct pound_chain_task task = {.ground = ground,
	                                      .n_samples = SAMPLES,
	                                      .time_step = 0.01,
	                                      .n_floors = POUND_CHAIN_FLOORS,
	                                      .n_links = LINKS,
	                                      .floors = floors,
	                                      .links = links,
	                                      .asked = ALL};
	assert_int_equal(pound_chain_scratch(POUND_FORCE_LINEAR), 1 << 20);
	for (int method = 0; method < POUND_SOLVER_ADAPTIVE; method++) {
		const struct pound_solver solver = {.method = method, .step = 0.001};
		for (int spare = 0; spare < 2; spare++) {
			const size_t bytes =
			    spare ? (size_t)POUND_CHAIN_SCRATCH : pound_chain_scratch(POUND_FORCE_LINEAR);
			unsigned char *scratch = aligned_alloc(64, bytes + END);
			assert_non_null(scratch);
			memset(scratch + bytes, FILL, END);
			struct pound_chain_result result = {.floors = measures[spare][0], .links = contacts[spare][0]};
			assert_int_equal(pound_solver_rows(&solver, &task, &result, 1, scratch, NULL), POUND_OK);
			assert_int_equal(result.status, POUND_OK);
			for (int j = 0; j < END; j++)
				assert_int_equal(scratch[bytes + (size_t)j], FILL);
			free(scratch);
		}
		assert_memory_equal(measures[0], measures[1], sizeof measures[0]);
		assert_memory_equal(contacts[0], contacts[1], sizeof contacts[0]);
		double met = 0;
		for (int k = 0; k < LINKS; k++)
			met += contacts[0][k][POUND_LINK_CONTACTS];
		assert_true(met > 0);
	}
	check_report("work space of a worker: %d KiB, %d KiB with products and powers", (1 << 20) / 1024,
	             POUND_CHAIN_SCRATCH / 1024);
}

/* A linear building by maps from sample to sample, in work space with arbitrary contents. */
static void what_work_space_held_before_is_not_read(void **state)
{
	(void)state;
	enum { SAMPLES = 201, FLOORS = 4, STRAIGHT = 1 << 20, FILLS = 3 };
	static const int fills[FILLS] = {0, 0x5a, 0xff};
	static struct pound_chain_floor floors[FLOORS];
	static double ground[SAMPLES], measures[FILLS][FLOORS][POUND_FLOOR_MEASURES];
	for (int i = 0; i < FLOORS; i++)
		floors[i] = (struct pound_chain_floor){
		    .mass = 1, .dashpot = 1, .mass_damping = 0.1, .story = {.stiffness = 900}, .base = i == 0};
	for (int t = 0; t < SAMPLES; t++)
		ground[t] = -4 * sin(0.15 * t);
	for (int n = 1; n <= FLOORS; n++) {
		const struct pound_chain_task task = {.ground = ground,
		                                      .n_samples = SAMPLES,
		                                      .time_step = 0.01,
		                                      .n_floors = n,
		                                      .floors = floors,
		                                      .asked = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS |
		                                               POUND_CHAIN_ACCELERATIONS};
		for (int f = 0; f < FILLS; f++) {
			unsigned char *scratch = aligned_alloc(64, POUND_CHAIN_SCRATCH);
			assert_non_null(scratch);
			memset(scratch, fills[f], POUND_CHAIN_SCRATCH);
			struct pound_chain_result result = {.floors = measures[f][0]};
			assert_true(pound_chain_lanes(0, &task, &result, 1, scratch, NULL));
			assert_int_equal(result.status, POUND_OK);
			for (size_t j = STRAIGHT; j < POUND_CHAIN_SCRATCH; j++)
				assert_int_equal(scratch[j], fills[f]);
			assert_memory_equal(measures[f], measures[0], sizeof measures[0]);
			free(scratch);
		}
	}
}

CHECK_MAIN(cmocka_unit_test(the_largest_row_of_straight_contacts_takes_a_mebibyte),
           cmocka_unit_test(what_work_space_held_before_is_not_read),
           cmocka_unit_test(two_and_two_stories_come_out),
           cmocka_unit_test(three_and_two_stories_without_tension_come_out),
           cmocka_unit_test(elastoplastic_stories_come_out),
           cmocka_unit_test(oriented_and_elastic_stories_come_out),
           cmocka_unit_test(a_row_of_three_comes_out), cmocka_unit_test(a_wall_comes_out),
           cmocka_unit_test(levels_within_stories_come_out),
           cmocka_unit_test(rows_have_the_same_bytes_at_every_lane_count),
           cmocka_unit_test(free_motion_agrees_with_series),
           cmocka_unit_test(a_mirrored_row_under_a_mirrored_ground_is_mirrored),
           cmocka_unit_test(equal_buildings_do_not_meet), cmocka_unit_test(a_linear_row_scales),
           cmocka_unit_test(an_observer_gets_the_whole_motion_of_a_floor),
           cmocka_unit_test(one_story_goes_as_the_pair))
