/* unit_contact_map.c - sustained contact against closed forms, however stiff it is, with its energy balance; and
 * results that must not depend on how the motion is divided into contact substeps. */
#include "tests/support/check.h"

#include <math.h>
#include <string.h>

#include "engine/exact/task.h"
#include "engine/run/scene.h"
#include "engine/scene/contact.h"

enum { SAMPLES = 201 };

static const double step = 0.01; // [s]

static struct pound_task_result march(const struct pound_task *task)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	struct pound_task_result result;
	assert_true(pound_exact_lanes(0, task, &result, 1, scratch, NULL));
	assert_int_equal(result.status, POUND_OK);
	return result;
}

/* A free mass that the ground presses on a wall by an acceleration of 1 + rate t [m/s2].
 *
 *   p'' + C p' + K p = 1 + rate t     long after the start p = (1 + rate t)/K - C rate/K^2
 */
static struct pound_task pressed(double ground[SAMPLES], double rate, double stiffness, double restitution)
{
	for (int i = 0; i < SAMPLES; i++)
		ground[i] = -(1 + rate * (i * step));
	return (struct pound_task){.ground = ground,
	                           .n_samples = SAMPLES,
	                           .time_step = step,
	                           .bodies = {{.drive = 1, .followed = true}},
	                           .contact = true,
	                           .contact_stiffness = stiffness,
	                           .contact_damping =
	                               2 * pound_contact_damping_ratio(0, restitution) * sqrt(stiffness),
	                           .accounted = true};
}

static void a_long_press_ends_where_its_ground_pushes_it(void **state)
{
	(void)state;
	double ground[SAMPLES], end = (SAMPLES - 1) * step;
	for (int t = 0; t < 24; t++) {
		double stiffness = pow(10, 4 + t / 2), damping; // up to 5e6 radians per sample
		struct pound_task task = pressed(ground, -0.25, stiffness, t % 3 * 0.3);
		damping = task.contact_damping;
		task.tension = t % 2;
		const struct pound_task_result r = march(&task);
		assert_int_equal(r.contacts, 1);
		check_near(r.contact_time, end, 1e-12);
		check_near(r.u[0] * stiffness, 1 - 0.25 * end + 0.25 * damping / stiffness, 1e-12);
		check_near(r.impulse_max, end - 0.125 * end * end + 0.25 / stiffness, 1e-12);
		check_near(r.energy_residual, 0, 1e-13);
	}
}

/* In a damped contact under a growing force the overlap grows: each contact substep ends at a new largest displacement. */
static void a_press_that_grows_for_long_goes_by_more_than_cells(void **state)
{
	(void)state;
	double ground[SAMPLES], end = (SAMPLES - 1) * step;
	for (int t = 0; t < 44; t++) {
		double stiffness = pow(10, 4 + t / 2); // up to 3e10 radians per sample
		struct pound_task task = pressed(ground, 0.25, stiffness, 0);
		for (int i = 0; i < SAMPLES; i++)
			ground[i] += 1; // from zero
		task.tension = t % 2;
		const struct pound_task_result r = march(&task);
		double pressed_by = 0.25 * end - 0.25 * task.contact_damping / stiffness;
		assert_int_equal(r.contacts, 1);
		check_near(r.contact_time, end, 1e-12);
		check_near(r.u[0] * stiffness, pressed_by, 1e-12);
		check_near(r.displacement_max[0] * stiffness, pressed_by, 1e-12);
		check_near(r.energy_residual, 0, 1e-13);
	}
}

static void a_press_that_fades_ends_when_the_overlap_or_the_force_is_gone(void **state)
{
	(void)state;
	double ground[SAMPLES];
	for (int t = 0; t < 24; t++) {
		double stiffness = pow(10, 4 + t / 2);
		struct pound_task task = pressed(ground, -1, stiffness, t % 3 * 0.3);
		task.tension = t % 2;
		const struct pound_task_result r = march(&task);
		double left = task.tension ? 1 + task.contact_damping / stiffness : 1;
		assert_int_equal(r.contacts, 1);
		check_near(r.contact_time, left, 1e-12);
		check_near(r.impulse_max, left - left * left / 2 + 1 / stiffness, 1e-12);
		check_near(r.energy_residual, 0, 1e-13);
	}
}

/* Two bodies of different frequency that oscillate, collide, bounce and stay in contact under ground motion of two sines. */
static struct pound_task pounding(double *ground, int t, int n)
{
	double ratio = t % 2 ? 0.6 : 3, w[2] = {2 * M_PI * 2, 2 * M_PI * 3.1}, stiffness = pow(10, 4 + t % 7);
	for (int i = 0; i < n; i++) {
		double time = i * step;
		ground[i] = sin(9 * time) + 0.5 * cos(23 * time);
	}
	struct pound_task task = {.ground = ground,
	                          .n_samples = n,
	                          .time_step = step,
	                          .contact = true,
	                          .tension = t % 3,
	                          .contact_stiffness = stiffness,
	                          .contact_damping = 2 * pound_contact_damping_ratio(0, t % 4 * 0.3) *
	                                             sqrt(stiffness / (1 + ratio)),
	                          .mass_ratio = ratio};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		task.bodies[i] = (struct pound_task_body){
		    .backbone = {.law = t % 5 % 4, .stiffness = w[i] * w[i], .hardening = 0.05, .yield = 1e-3},
		    .damping = 0.1 * w[i],
		    .drive = 1,
		    .followed = true};
	return task;
}

static void samples_twice_as_dense_change_no_contact_however_stiff(void **state)
{
	(void)state;
	enum { N = 101, DENSE = 2 * N - 1 };
	double ground[N], dense[DENSE];
	int64_t contacts = 0;
	for (int t = 0; t < 140; t++) {
		struct pound_task task = pounding(ground, t, N);
		const struct pound_task_result once = march(&task);
		for (int i = 0; i < DENSE; i++)
			dense[i] = 0.5 * (ground[i / 2] + ground[(i + 1) / 2]);
		task.ground = dense;
		task.n_samples = DENSE;
		task.time_step = 0.5 * step;
		task.accounted = true;
		const struct pound_task_result twice = march(&task);
		contacts += once.contacts;
		assert_int_equal(twice.contacts, once.contacts);
		// the rounding errors of each contact are amplified by the next ones
		check_near(twice.impulse_max / once.impulse_max, 1, 1e-9);
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			check_near(twice.displacement_max[i] / once.displacement_max[i], 1, 1e-9);
		check_near(twice.energy_residual, 0, 1e-12);
	}
	assert_true(contacts > 2 * 140); // otherwise the comparison covers too few contacts
}

/* The ground presses a light body on a heavy one of a thousand times its frequency: 4e5 radians of the contact per
 * sample of sustained contact at rest, at the largest displacement so far.
 *
 *   k1 u1 + K p = 1,  k2 u2 - m1/m2 K p = 1,  u1 = u2 + p
 */
static void bodies_pressed_for_long_rest_where_their_springs_hold_them(void **state)
{
	(void)state;
	double ground[SAMPLES];
	for (int tension = 0; tension < 2; tension++) {
		const double w1 = 4 * M_PI, w2 = 4000 * M_PI, k1 = w1 * w1, k2 = w2 * w2, ratio = 1e-3;
		const double stiffness = 1e4 * k2 / ratio;
		struct pound_task task = pressed(ground, 0, stiffness, 0.5);
		task.bodies[0].backbone.stiffness = k1;
		task.bodies[1] = (struct pound_task_body){
		    .backbone = {.stiffness = k2}, .damping = 1.998 * w2, .drive = 1, .followed = true};
		task.mass_ratio = ratio;
		task.tension = tension;
		const struct pound_task_result r = march(&task);
		const double p = (1 - k1 / k2) / (stiffness + k1 + k1 * ratio * stiffness / k2);
		const double u2 = (1 + ratio * stiffness * p) / k2;
		assert_int_equal(r.contacts, 1);
		check_near(r.u[0] / (u2 + p), 1, 1e-13);
		check_near(r.u[1] / u2, 1, 1e-13);
		check_near(r.displacement_max[1] / u2, 1, 1e-13);
		check_near(r.energy_residual, 0, 1e-13);
	}
}

/* A strongly damped body has yielded and creeps to its equilibrium with a light body in contact: long before
 * equilibrium its displacement in a contact substep is below the rounding error of its position, and a velocity
 * reversal would end its branch.
 *
 *   (k1 + k2 m2/m1) u = 1 + m2/m1
 */
static void a_yielded_body_creeps_to_rest_however_stiff_the_contact(void **state)
{
	(void)state;
	double ground[SAMPLES];
	for (int t = 0; t < 8; t++) {
		const double w1 = 8 * M_PI, w2 = 40 * M_PI, light = 1e-6, zeta[] = {0.7, 0.999};
		const double stiffness = pow(10, 6 + t / 2) * w1 * w1;
		struct pound_task task = pressed(ground, 0, stiffness, 0);
		task.bodies[0].backbone =
		    (struct pound_backbone){.law = 1, .stiffness = w1 * w1, .hardening = 1, .yield = 1e-5};
		task.bodies[0].damping = 2 * zeta[t % 2] * w1;
		task.bodies[1] = task.bodies[0];
		task.bodies[1].backbone.stiffness = w2 * w2;
		task.bodies[1].damping = 0.1 * w2;
		task.contact_damping = 2 * sqrt(stiffness * light);
		task.mass_ratio = 1 / light;
		task.tension = true;
		const struct pound_task_result r = march(&task);
		assert_int_equal(r.contacts, 1);
		check_near(r.u[0] * (w1 * w1 + w2 * w2 * light) / (1 + light), 1, 1e-13);
		check_near(r.energy_residual, 0, 1e-13);
	}
}

/* The ground acceleration separates a mass from the wall within a contact substep: at the end of the sample its force
 * has ended, but not its overlap.  With an energy balance, every step checks for the end of the force. */
static void a_touch_shorter_than_a_cell_ends_with_its_force(void **state)
{
	(void)state;
	const double rest = 0.5 * step; // remainder of the sample in which the contact begins
	double ground[SAMPLES];
	for (int t = 1; t < 20; t++) {
		struct pound_task task = pressed(ground, 0, 6400, 0); // a contact substep is a sample
		const double speed = (0.5 + 0.025 * t) * rest;
		for (int i = 0; i < SAMPLES; i++)
			ground[i] = 1;
		task.bodies[0].u = -(speed * rest + 0.5 * rest * rest);
		task.bodies[0].v = speed + rest;
		task.tension = false;
		const struct pound_task_result accounted = march(&task);
		task.accounted = false;
		const struct pound_task_result r = march(&task);
		assert_int_equal(r.contacts, 1);
		check_near(r.impulse_max / accounted.impulse_max, 1, 1e-12);
		check_near(r.contact_time / accounted.contact_time, 1, 1e-12);
		assert_true(r.contact_time < rest);
	}
}

/* After a plastic impact identical bodies move together, in contact without a force once the overlap has decayed;
 * their center of mass moves as one oscillator all along.
 *
 *   u = v m1/(m1 + m2) exp(-zeta w t) sin(wd t)/wd
 */
static void bodies_alike_go_on_as_one_after_a_plastic_impact(void **state)
{
	(void)state;
	const double w = 4 * M_PI, zeta = 0.05, wd = w * sqrt(1 - zeta * zeta), ratio = 0.5;
	const double end = (SAMPLES - 1) * step;
	const double u = ratio / (1 + ratio) * exp(-zeta * w * end) * sin(wd * end) / wd;
	double ground[SAMPLES];
	for (int t = 0; t < 12; t++) {
		const double stiffness = pow(10, 4 + t / 2 * 2) * w * w;
		struct pound_task task = pressed(ground, 0, stiffness, 0);
		memset(ground, 0, sizeof ground);
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			task.bodies[i] = (struct pound_task_body){
			    .backbone = {.stiffness = w * w}, .damping = 2 * zeta * w, .drive = 1, .followed = true};
		task.bodies[0].v = 1;
		task.mass_ratio = ratio;
		task.contact_damping = 2 * sqrt(stiffness / (1 + ratio));
		task.tension = true;
		task.accounted = t % 2;
		const struct pound_task_result r = march(&task);
		assert_int_equal(r.contacts, 1);
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			check_near(r.u[i] / u, 1, 1e-12);
	}
}

CHECK_MAIN(cmocka_unit_test(a_long_press_ends_where_its_ground_pushes_it),
           cmocka_unit_test(a_press_that_grows_for_long_goes_by_more_than_cells),
           cmocka_unit_test(a_press_that_fades_ends_when_the_overlap_or_the_force_is_gone),
           cmocka_unit_test(samples_twice_as_dense_change_no_contact_however_stiff),
           cmocka_unit_test(bodies_pressed_for_long_rest_where_their_springs_hold_them),
           cmocka_unit_test(a_yielded_body_creeps_to_rest_however_stiff_the_contact),
           cmocka_unit_test(a_touch_shorter_than_a_cell_ends_with_its_force),
           cmocka_unit_test(bodies_alike_go_on_as_one_after_a_plastic_impact))
