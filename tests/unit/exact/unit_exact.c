/* unit_exact.c - the exact solver against closed forms: one impact, impacts on a wall, and the same bits at every lane count. */
#include "tests/support/check.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/exact/task.h"
#include "engine/run/scene.h"
#include "engine/scene/contact.h"
#include "tests/support/scenes.h"

static const double PI = 3.14159265358979323846;

enum { STILL = 4001 };
static double still[STILL]; // ground at rest

static struct pound_task_result march(const struct pound_task *task)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	struct pound_task_result result;
	assert_true(pound_exact_lanes(0, task, &result, 1, scratch, NULL));
	return result;
}

static double rebound(const struct pound_task_result *r)
{
	return (r->v[1] - r->v[0]) / 1.5;
}

static void an_isolated_impact_leaves_with_the_restitution(void **state)
{
	(void)state;
	for (int e = 1; e <= 100; e++) {
		const struct pound_task task = specimen_impact(e / 100.0, true, 1000);
		const struct pound_task_result r = march(&task);
		check_near(rebound(&r), e / 100.0, 1e-12);
		assert_int_equal(r.contacts, 1);
		// the left mass takes the whole change of relative momentum: impulse = (1 + e) m v, m/m1 = 1/(1 + ratio)
		check_near(r.impulse_max, (1 + e / 100.0) * 1.5 / 1.5, 1e-12);
		double zeta = pound_contact_damping_ratio(0, e / 100.0);
		check_near(r.contact_time, PI / sqrt(7.9e3 * 1.5 * (1 - zeta * zeta)), 1e-12);
		check_near(r.first_contact, 0.1 / 1.5, 1e-15);
		check_near(r.first_speed, 1.5, 1e-15);
	}
}

static void a_plastic_impact_ends_with_one_velocity(void **state)
{
	(void)state;
	struct pound_task task = specimen_impact(0, true, 1000);
	task.n_samples = 101; // the overlap decays as t exp(-w t), to 1e-47 of its largest value in this second
	const struct pound_task_result r = march(&task);
	check_near(rebound(&r), 0, 1e-15);
	assert_int_equal(r.contacts, 1);
}

static void without_tension_the_rebound_is_that_of_release_at_zero_force(void **state)
{
	(void)state;
	// known_answers 5.1: e^(1 - 2 asin(zeta)/pi)
	for (int e = 1; e <= 100; e++) {
		const struct pound_task task = specimen_impact(e / 100.0, false, 1000);
		const struct pound_task_result r = march(&task);
		double zeta = pound_contact_damping_ratio(0, e / 100.0);
		check_near(rebound(&r), pow(e / 100.0, 1 - 2 * asin(zeta) / PI), 1e-12);
		assert_int_equal(r.contacts, 1);
	}
	const struct pound_task plastic = specimen_impact(0, false, 1000);
	const struct pound_task_result r = march(&plastic);
	check_near(rebound(&r), 0.135335283236612691894, 1e-12); // exp(-2)
}

/* Oscillator of 1 Hz against a wall, released at rest from -amplitude. */
static struct pound_task wall(double gap, double damping_ratio, double restitution, double stiffness_ratio)
{
	double k = 4 * PI * PI, stiffness = stiffness_ratio * k;
	return (struct pound_task){.ground = still,
	                           .n_samples = STILL,
	                           .time_step = 0.005,
	                           .bodies = {{.backbone = {.stiffness = k},
	                                       .damping = 4 * PI * damping_ratio,
	                                       .drive = 1,
	                                       .followed = true,
	                                       .u = -1}},
	                           .contact = true,
	                           .gap = gap,
	                           .contact_stiffness = stiffness,
	                           .contact_damping =
	                               2 * pound_contact_damping_ratio(0, restitution) * sqrt(stiffness),
	                           .tension = true};
}

static void a_wall_is_met_every_half_period(void **state)
{
	(void)state;
	// undamped and elastic: half a period of free motion, then half a period of the contact's oscillation, and so on
	const struct pound_task task = wall(0, 0, 1, 1000);
	const struct pound_task_result r = march(&task);
	double touch = 0.5 / sqrt(1001), period = 0.5 + touch;
	// the motion starts a quarter period before the first contact
	int contacts = (int)floor((20 - 0.25) / period) + 1;
	assert_int_equal(r.contacts, contacts);
	check_near(r.first_contact, 0.25, 1e-14);
	check_near(r.first_speed, 2 * PI, 1e-13);
	check_near(r.contact_time, contacts * touch, 1e-11);
	// each contact reverses the velocity: the impulse of the contact spring is 2 v K/(K + k)
	check_near(r.impulse_max, 4 * PI * 1000 / 1001, 1e-11);
	check_near(r.displacement_max[0], 1, 1e-12);
}

static void wall_impacts_lose_speed_by_restitution_and_damping(void **state)
{
	(void)state;
	// damped contact oscillation and damped free oscillation alternate: the end state follows in closed form
	const double xi = 0.02, e = 0.8, ratio = 500;
	struct pound_task task = wall(0, xi, e, ratio);
	const struct pound_task_result r = march(&task);
	double w = 2 * PI, wd = w * sqrt(1 - xi * xi);
	double c = task.bodies[0].damping + task.contact_damping, k = w * w * (1 + ratio);
	double wc = sqrt(k - c * c / 4);
	// from u = -1, v = 0 to the first crossing of 0 (speed v), then alternately contact and free motion
	double t = (PI / 2 + asin(xi)) / wd, v = w * exp(-xi * w * t);
	check_near(r.first_contact, t, 1e-13);
	check_near(r.first_speed, v, 1e-12);
	int contacts = 0;
	for (;;) {
		contacts++;
		if (t + PI / wc > 20)
			break;
		t += PI / wc, v *= exp(-c / 2 * PI / wc);
		if (t + PI / wd > 20)
			break;
		t += PI / wd, v *= exp(-xi * w * PI / wd);
	}
	assert_int_equal(r.contacts, contacts);
	// last free motion, away from the wall
	check_near(r.u[0], -v / wd * exp(-xi * w * (20 - t)) * sin(wd * (20 - t)), 1e-12);
}

/* Displacement of a body in contact with a wall, from rest under an acceleration of 1; omega and zeta are of body and
 * contact. */
static double pressed_closed(double omega, double zeta, double t)
{
	const double root = omega * sqrt(fabs(zeta * zeta - 1)), decay = zeta * omega, fade = exp(-decay * t);
	const double even = zeta > 1 ? cosh(root * t) : cos(root * t),
	             odd = zeta > 1 ? sinh(root * t) : sin(root * t);
	return (1 - fade * (even + decay / root * odd)) / (omega * omega);
}

static void a_body_pressed_on_a_wall_yields_as_its_own_and_the_contacts_damping_let_it(void **state)
{
	(void)state;
	uint64_t seed = 1;
	for (int n = 0; n < 2000; n++) {
		const struct pound_task task = specimen_pressed(&seed);
		const struct pound_task_body *body = &task.bodies[0];
		const double omega = sqrt(body->backbone.stiffness + task.contact_stiffness);
		const double zeta = (body->damping + task.contact_damping) / (2 * omega);
		const double end = (task.n_samples - 1) * task.time_step, settled = 1 / (omega * omega);
		const struct pound_task_result r = march(&task);
		check_near((r.u[0] - pressed_closed(omega, zeta, end)) / settled, 0, 32 * DBL_EPSILON);
	}
}

static void bodies_at_rest_without_ground_motion_stay_at_rest(void **state)
{
	(void)state;
	struct pound_task task = wall(0, 0.05, 0.5, 100);
	task.bodies[0].u = 0;
	const struct pound_task_result r = march(&task);
	assert_int_equal(r.contacts, 0);
	assert_true(r.displacement_max[0] == 0 && r.impulse_max == 0);
}

/* ---- the same bits at every lane count ---- */

enum { TASKS = 149, SAMPLES = 700 }; // more tasks than are simulated at once, at any lane count

static void tasks_fill(struct pound_task *tasks, double *ground, uint64_t seed)
{
	for (int t = 0; t < TASKS; t++) {
		double *a = ground + t * SAMPLES, slow = 0;
		for (int s = 0; s < SAMPLES; s++)
			a[s] = slow = 0.9 * slow + specimen_uniform(&seed, -0.5, 0.5);
		double ratio = exp(specimen_uniform(&seed, -2, 2));
		double stiffness = 0, contact = pow(10, 2 + t % 9 % 4 * 2);
		tasks[t] = (struct pound_task){.ground = a,
		                               .n_samples = SAMPLES - t, // so that lanes end at different times
		                               .time_step = 0.01,
		                               .contact = t % 7 != 0,
		                               .gap = t % 3 ? 0 : 1e-3,
		                               .mass_ratio = ratio,
		                               .tension = t % 2};
		for (int i = 0; i < 2; i++) {
			double w = 2 * PI * specimen_uniform(&seed, 0.5, 5.5);
			tasks[t].bodies[i] = (struct pound_task_body){.backbone = {.law = t % SPECIMEN_LAWS,
			                                                           .stiffness = w * w,
			                                                           .hardening = 0.05,
			                                                           .yield = 0.3 / (w * w)},
			                                              .damping = 0.1 * w,
			                                              .drive = 1,
			                                              .followed = i == 0 || t % 3 == 0};
			stiffness = fmax(stiffness, w * w * (i ? 1 / ratio : 1));
		}
		tasks[t].contact_stiffness = contact * stiffness;
		double zeta = pound_contact_damping_ratio(0, t % 5 / 4.0);
		tasks[t].contact_damping = 2 * zeta * sqrt(contact * stiffness / (1 + ratio));
	}
}

static void every_lane_count_gives_the_same_bits(void **state)
{
	(void)state;
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	struct pound_task_result one[TASKS], many[TASKS];
	memset(one, 0, sizeof one);
	memset(many, 0, sizeof many);
	for (uint64_t seed = 1; seed <= 4; seed++) {
		tasks_fill(tasks, ground, seed);
		pound_exact_portable(tasks, one, TASKS, scratch, NULL);
		int64_t contacts = 0;
		for (int t = 0; t < TASKS; t++)
			contacts += one[t].contacts;
		assert_true(contacts > 5 * TASKS); // otherwise the comparison covers too few contacts
		for (int lanes = 1; lanes <= 8; lanes++)
			if (pound_exact_lanes(lanes, tasks, many, TASKS, scratch, NULL))
				assert_memory_equal(one, many, sizeof one);
	}
}

/* Samples of 0.6 and 0.5 rad, or of 1.95 and 1.63: the largest sample may be 4 % or 44 % below the largest
 * displacement, which is v/w.  Each sample may add the 16 rounding errors that its map is allowed.  In the longer
 * signal, more samples than can be noted reach the same value. */
static void a_largest_displacement_between_samples_is_that_of_the_motion(void **state)
{
	(void)state;
	static const struct {
		int length;
		double step;
	} cases[] = {{5, 0.01}, {9, 0.01}, {401, 0.01}, {5, 0.0325}, {401, 0.0325}};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
		for (int paired = 0; paired < 2; paired++) {
			const struct pound_task task = {
			    .ground = still,
			    .n_samples = cases[k].length,
			    .time_step = cases[k].step,
			    .bodies =
			        {{.backbone = {.stiffness = 3600}, .drive = 1, .v = 1, .followed = true},
			         {.backbone = {.stiffness = 2500}, .drive = paired, .v = -paired, .followed = true}},
			    .contact = paired,
			    .gap = 1,
			    .contact_stiffness = 3.6e5,
			    .mass_ratio = 1,
			    .tension = true};
			const struct pound_task_result r = march(&task);
			const double roundings = 16 * 2.2e-16 * cases[k].length;
			check_near(60 * r.displacement_max[0], 1, roundings);
			check_near(50 * r.displacement_max[1], paired, roundings);
		}
}

/* Every cycle has the same phase at its samples, up to 15 degrees, so each may contain the largest displacement:
 * there is no room to note them all before a ground pulse makes the later cycles 1 % larger. */
static void more_swings_than_can_be_noted_have_their_largest_displacement(void **state)
{
	(void)state;
	enum { SWINGS = 241, PULSE = 120 };
	double ground[SWINGS] = {0};
	const double h = 0.01, w = PI / 6 / h;
	// its area is h times its height; after whole periods the velocity equals the initial one
	ground[PULSE] = -0.01 * w / h / sin(PI / 12);
	struct pound_task task = {.ground = ground,
	                          .n_samples = SWINGS,
	                          .time_step = h,
	                          .bodies = {{.backbone = {.stiffness = w * w},
	                                      .drive = 1,
	                                      .u = cos(PI / 12),
	                                      .v = w * sin(PI / 12),
	                                      .followed = true}}};
	const double mapped = march(&task).displacement_max[0];
	task.accounted = true;
	const double stepped = march(&task).displacement_max[0];
	assert_true(stepped > 1.005);
	check_near(mapped / stepped, 1, 16 * 2.2e-16 * SWINGS);
}

/* The energy balance is computed in single steps only: whole samples must give the same extremes as single steps, for
 * every law. */
static void whole_samples_find_the_largest_displacements_of_single_steps(void **state)
{
	(void)state;
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	struct pound_task_result mapped[TASKS], stepped[TASKS];
	static const double samples[] = {0.017, 0.052}; // up to 0.6 and 1.8 rad
	for (int k = 0; k < 2; k++) {
		tasks_fill(tasks, ground, 4);
		for (int t = 0; t < TASKS; t++) {
			tasks[t].time_step = samples[k];
			tasks[t].gap = 1e3;
			tasks[t].bodies[1].followed = true;
		}
		pound_exact_lanes(0, tasks, mapped, TASKS, scratch, NULL);
		for (int t = 0; t < TASKS; t++)
			tasks[t].accounted = true;
		pound_exact_lanes(0, tasks, stepped, TASKS, scratch, NULL);
		for (int t = 0; t < TASKS; t++)
			for (int i = 0; i < 2; i++)
				check_near(mapped[t].displacement_max[i] / stepped[t].displacement_max[i], 1,
				           16 * 2.2e-16 * SAMPLES);
	}
}

static void the_energy_put_in_is_found_again(void **state)
{
	(void)state;
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	struct pound_task_result results[TASKS];
	tasks_fill(tasks, ground, 3);
	for (int t = 0; t < TASKS; t++)
		tasks[t].accounted = true;
	pound_exact_lanes(0, tasks, results, TASKS, scratch, NULL);
	// about 2e4 steps, each with a rounding error of the energy it transfers
	for (int t = 0; t < TASKS; t++)
		check_near(results[t].energy_residual, 0, 2e4 * 2.2e-16);
}

/* Runs tasks together, at any lane count, and each alone, and compares the bits. */
static void check_alone_as_together(const struct pound_task *tasks)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	struct pound_task_result together[TASKS], alone[TASKS];
	memset(together, 0, sizeof together);
	memset(alone, 0, sizeof alone);
	for (int t = 0; t < TASKS; t++)
		pound_exact_lanes(0, &tasks[t], &alone[t], 1, scratch, NULL);
	for (int lanes = 1; lanes <= 8; lanes++)
		if (pound_exact_lanes(lanes, tasks, together, TASKS, scratch, NULL))
			assert_memory_equal(together, alone, sizeof alone);
}

static void a_run_does_not_depend_on_its_neighbours(void **state)
{
	(void)state;
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	tasks_fill(tasks, ground, 2);
	check_alone_as_together(tasks);
}

/* Bodies separated and at rest in the end: the time at which the solver detects it must depend on the one simulation only. */
static void a_motion_that_dies_away_does_not_depend_on_its_neighbours(void **state)
{
	(void)state;
	enum { LONG = 9001 };
	static double ground[TASKS * SAMPLES], shaken[LONG];
	struct pound_task tasks[TASKS];
	tasks_fill(tasks, ground, 2);
	memcpy(shaken, ground, 200 * sizeof(double));
	for (int t = 0; t < TASKS; t++) {
		tasks[t].ground = shaken;
		tasks[t].n_samples = LONG - 40 * t;
		tasks[t].gap = 1e3;
		for (int i = 0; i < 2; i++) {
			tasks[t].bodies[i].backbone.law = 0;
			tasks[t].bodies[i].damping = 10 + 0.2 * t; // 1e-277 after 20 to 120 s
		}
	}
	check_alone_as_together(tasks);
}

/* The energy balance of another task in the lanes adds no step to a run. */
static void a_run_does_not_depend_on_whose_energy_is_accounted_for(void **state)
{
	(void)state;
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	for (uint64_t seed = 1; seed <= 4; seed++) {
		tasks_fill(tasks, ground, seed);
		for (int t = 0; t < TASKS; t++)
			tasks[t].accounted = t % 4 == 1;
		check_alone_as_together(tasks);
	}
}

/* From the start of a contact the overlap grows from 0: the checks that another task's contact needs, which ends by
 * its force, must not affect the run. */
static void a_run_that_starts_with_an_impact_does_not_depend_on_its_neighbours(void **state)
{
	(void)state;
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	for (int round = 1; round <= 20; round++) {
		uint64_t seed = (uint64_t)round;
		tasks_fill(tasks, ground, seed);
		for (int t = 0; t < TASKS; t++) {
			double *a = ground + t * SAMPLES;
			tasks[t].n_samples = 2 + t % 3;
			tasks[t].gap = 0;
			tasks[t].contact = true;
			tasks[t].bodies[0].v = 1;
			tasks[t].bodies[1].v = -specimen_uniform(&seed, 0, 1);
			memset(a, 0, sizeof(double) * (size_t)tasks[t].n_samples);
		}
		check_alone_as_together(tasks);
	}
}

/* After a plastic impact, identical bodies stay in contact.  One third of the tasks are such; another third differ
 * only by subnormal stiffnesses, which have no effect over a contact substep; the others are ordinary. */
static void a_run_does_not_depend_on_bodies_alike_beside_it(void **state)
{
	(void)state;
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS];
	tasks_fill(tasks, ground, 5);
	for (int t = 0; t < TASKS; t++) {
		struct pound_task_body *body = tasks[t].bodies;
		if (t % 3 == 0)
			continue;
		body[0].backbone.law = 0;
		body[1].backbone = body[0].backbone;
		body[1].damping = body[0].damping;
		for (int i = 0; i < 2 && t % 3 == 1; i++)
			body[i].backbone = (struct pound_backbone){.stiffness = 1e-321 + i * 2e-321};
		tasks[t].contact = true;
		tasks[t].gap = 0;
		tasks[t].tension = true;
		tasks[t].bodies[0].v = 0.1;
		tasks[t].contact_stiffness = 4e4;
		tasks[t].contact_damping = 2 * sqrt(tasks[t].contact_stiffness / (1 + tasks[t].mass_ratio));
	}
	check_alone_as_together(tasks);
}

/* A few short runs of one scene, one run each of some other scenes, many of another, and then two scenes alternately:
 * runs of one scene share constants and maps once slots become free.  Some have an energy balance, some another law. */
static void a_run_does_not_depend_on_what_it_has_in_common_with_others(void **state)
{
	(void)state;
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS], scenes[TASKS];
	for (uint64_t seed = 1; seed <= 6; seed++) {
		tasks_fill(scenes, ground, seed);
		for (int t = 0; t < TASKS; t++) {
			int scene = (int)seed + (t < 20 ? 0 : t < 25 ? t : t < 125 ? 1 : 2 + t % 2);
			tasks[t] = scenes[scene];
			tasks[t].ground = scenes[t].ground;
			tasks[t].n_samples = t < 20 ? 50 : SAMPLES - t;
			tasks[t].contact = true;
			tasks[t].time_step = seed < 6 ? 0.01 : 0.3; // too long for maps
			tasks[t].accounted = t % 16 == 9;
			for (int i = 0; i < 2 && t % 16 != 10; i++)
				tasks[t].bodies[i].backbone.law = 0;
		}
		check_alone_as_together(tasks);
	}
}

/* Changes one more property of a task among tasks that differ in their laws only. */
static void kin_spoil(struct pound_task *task, int which)
{
	double *const numbers[] = {&task->time_step,         &task->gap,
	                           &task->contact_stiffness, &task->contact_damping,
	                           &task->mass_ratio,        &task->bodies[0].backbone.stiffness,
	                           &task->bodies[1].damping, &task->bodies[0].drive,
	                           &task->bodies[0].u,       &task->bodies[0].v};
	enum { NUMBERS = sizeof numbers / sizeof numbers[0] };
	if (which < NUMBERS)
		*numbers[which] = *numbers[which] == 0 ? 1e-4 : *numbers[which] * 1.125;
	else if (which == NUMBERS)
		task->n_samples--;
	else if (which == NUMBERS + 1)
		task->bodies[1].followed = !task->bodies[1].followed;
	else if (which == NUMBERS + 2)
		task->contact = !task->contact;
	else if (which == NUMBERS + 3)
		task->tension = !task->tension;
	else if (which == NUMBERS + 4)
		task->accounted = true;
	else
		task->bodies[0].u = -task->bodies[0].u; // changes the sign of a zero
}

/* Tasks that differ in their laws only are simulated as one until the first yields: groups of six, of which four may
 * run together; some yield at once, two at the same time, or never, and one differs in something else.  In every
 * other round the ground comes to rest meanwhile; in the last rounds the samples are too long for maps. */
static void a_run_does_not_depend_on_those_that_differ_in_their_laws_alone(void **state)
{
	(void)state;
	uint64_t yields = 1;
	enum { FAMILY = 6, FAMILIES = (TASKS + FAMILY - 1) / FAMILY };
	static double ground[TASKS * SAMPLES];
	struct pound_task tasks[TASKS], scenes[TASKS];
	for (uint64_t seed = 1; seed <= 20; seed++) {
		tasks_fill(scenes, ground, seed);
		for (int t = 0; t < TASKS; t++) {
			const int scene = t % FAMILIES, member = t / FAMILIES;
			tasks[t] = scenes[scene];
			tasks[t].n_samples = SAMPLES - scene;
			tasks[t].time_step = seed < 11 ? 0.01 : 0.1;
			if (!tasks[t].contact)
				tasks[t].bodies[1] = (struct pound_task_body){0}; // the left body alone
			if (member == 0 && seed % 2)
				memset(ground + scene * SAMPLES + 100, 0, sizeof(double) * 400);
			for (int i = 0; i < 2; i++) {
				struct pound_backbone *law = &tasks[t].bodies[i].backbone;
				if (law->stiffness == 0)
					continue;
				law->law = (member + scene) % 5 == 4 ? (member + scene) % 3 : (member + (int)seed) % 4;
				law->yield *= member == 3   ? 1e-9
				              : member == 4 ? 1e9
				                            : pow(10, specimen_uniform(&yields, -1, 1.5));
				law->hardening = 0.01 * member;
			}
			if (member == 2)
				tasks[t].bodies[0].backbone.yield = tasks[scene].bodies[0].backbone.yield;
			if (member == 1 && seed % 4 < 2)
				kin_spoil(&tasks[t], (scene + (int)seed) % 16);
		}
		check_alone_as_together(tasks);
	}
}

static void pressed_contact_of_more_swings_than_numbers_can_count_ends_as_chatter(void **state)
{
	(void)state;
	static const double pushes[3] = {-1, -1, -1};
	struct pound_task task = wall(0, 0.05, 0, 1e40);
	task.ground = pushes;
	task.n_samples = 3;
	task.bodies[0].u = 0;
	task.bodies[0].drive = 1;
	assert_int_equal(march(&task).status, POUND_CHATTER);
}

CHECK_MAIN(cmocka_unit_test(an_isolated_impact_leaves_with_the_restitution),
           cmocka_unit_test(a_plastic_impact_ends_with_one_velocity),
           cmocka_unit_test(without_tension_the_rebound_is_that_of_release_at_zero_force),
           cmocka_unit_test(a_wall_is_met_every_half_period),
           cmocka_unit_test(wall_impacts_lose_speed_by_restitution_and_damping),
           cmocka_unit_test(a_body_pressed_on_a_wall_yields_as_its_own_and_the_contacts_damping_let_it),
           cmocka_unit_test(bodies_at_rest_without_ground_motion_stay_at_rest),
           cmocka_unit_test(every_lane_count_gives_the_same_bits),
           cmocka_unit_test(a_largest_displacement_between_samples_is_that_of_the_motion),
           cmocka_unit_test(more_swings_than_can_be_noted_have_their_largest_displacement),
           cmocka_unit_test(whole_samples_find_the_largest_displacements_of_single_steps),
           cmocka_unit_test(the_energy_put_in_is_found_again),
           cmocka_unit_test(a_run_does_not_depend_on_its_neighbours),
           cmocka_unit_test(a_motion_that_dies_away_does_not_depend_on_its_neighbours),
           cmocka_unit_test(a_run_does_not_depend_on_whose_energy_is_accounted_for),
           cmocka_unit_test(a_run_that_starts_with_an_impact_does_not_depend_on_its_neighbours),
           cmocka_unit_test(a_run_does_not_depend_on_bodies_alike_beside_it),
           cmocka_unit_test(a_run_does_not_depend_on_what_it_has_in_common_with_others),
           cmocka_unit_test(a_run_does_not_depend_on_those_that_differ_in_their_laws_alone),
           cmocka_unit_test(pressed_contact_of_more_swings_than_numbers_can_count_ends_as_chatter))
