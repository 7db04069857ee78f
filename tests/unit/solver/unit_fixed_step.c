/* unit_fixed_step.c - the fixed-step integrators against closed forms and against the exact solver. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <math.h>
#include <string.h>

#include "engine/run/scene.h"
#include "engine/solver/solver.h"

static const double PI = 3.14159265358979323846;

enum { NEWMARK = 1, CENTRAL_DIFFERENCE = 2, STILL = 401 };
static const double still[STILL]; // ground at rest

static struct pound_task_result integrate(int method, double step, const struct pound_task *task)
{
	static const atomic_bool stop;
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	const struct pound_solver solver = {.method = method, .step = step};
	struct pound_task_result result;
	pound_solver_run(&solver, task, &result, 1, scratch, &stop);
	return result;
}

/* One oscillator of 1 Hz released from 1 m with the velocity `speed`, for 4 s. */
static struct pound_task vibration(double damping_ratio, double speed)
{
	double w = 2 * PI;
	return (struct pound_task){.ground = still,
	                           .n_samples = STILL,
	                           .time_step = 0.01,
	                           .bodies = {{.backbone = {.stiffness = w * w},
	                                       .damping = 2 * damping_ratio * w,
	                                       .drive = 1,
	                                       .u = 1,
	                                       .v = speed,
	                                       .followed = true}}};
}

static void the_solvers_have_their_names_in_these_rows(void **state)
{
	(void)state;
	assert_string_equal(pound_solver_name(0), "event");
	assert_string_equal(pound_solver_name(NEWMARK), "newmark");
	assert_string_equal(pound_solver_name(CENTRAL_DIFFERENCE), "central_difference");
	assert_true(pound_solver_takes_step(NEWMARK) && pound_solver_takes_step(CENTRAL_DIFFERENCE));
	assert_false(pound_solver_takes_step(0) || pound_solver_takes_tolerance(NEWMARK));
}

static void the_error_of_free_vibration_falls_with_the_square_of_the_step(void **state)
{
	(void)state;
	const double xi = 0.05, speed = 3, w = 2 * PI, t = 4, wd = w * sqrt(1 - xi * xi);
	const struct pound_task task = vibration(xi, speed);
	double u = exp(-xi * w * t) * (cos(wd * t) + (speed + xi * w) / wd * sin(wd * t));
	for (int method = NEWMARK; method <= CENTRAL_DIFFERENCE; method++) {
		double before = 0;
		for (double step = 5e-3; step > 3e-4; step /= 2) {
			double error = fabs(integrate(method, step, &task).u[0] - u);
			// the next term is (w h)^2 of this one, 0.1 % at the first step; log2 multiplies it by 1.44
			if (before > 0)
				check_near(log2(before / error), 2, 0.01);
			before = error;
		}
		assert_true(before < 1e-4);
	}
}

static void newmark_keeps_the_energy_of_free_vibration_at_any_step(void **state)
{
	(void)state;
	struct pound_task task = vibration(0, 2);
	for (int k = 0; k < 12; k++) {
		double w = 2 * PI * pow(2, k);
		task.bodies[0].backbone.stiffness = w * w;
		const struct pound_task_result r = integrate(NEWMARK, 1, &task);
		assert_int_equal(r.status, POUND_OK);
		// rounding errors of 400 steps, each of some ten operations
		double energy = w * w + 2 * 2;
		check_near((w * w * r.u[0] * r.u[0] + r.v[0] * r.v[0]) / energy, 1, 1e-11);
	}
}

static void central_differences_vibrate_with_their_known_period(void **state)
{
	(void)state;
	// u_n = cos(n theta) with sin(theta/2) = w h/2
	const struct pound_task task = vibration(0, 0);
	for (int n = 1; n <= 8; n *= 2) {
		double h = 0.01 / n, theta = 2 * asin(2 * PI * h / 2);
		check_near(integrate(CENTRAL_DIFFERENCE, h, &task).u[0], cos(400 * n * theta), 1e-10);
	}
}

static void an_explicit_step_beyond_its_limit_ends_with_a_status(void **state)
{
	(void)state;
	struct pound_task task = vibration(0, 0);
	task.bodies[0].backbone.stiffness = pow(1.99 / 0.01, 2);
	assert_int_equal(integrate(CENTRAL_DIFFERENCE, 0.01, &task).status, POUND_OK);
	task.bodies[0].backbone.stiffness = pow(2.1 / 0.01, 2);
	const struct pound_task_result r = integrate(CENTRAL_DIFFERENCE, 0.01, &task);
	assert_int_equal(r.status, POUND_UNSTABLE);
	check_near(r.displacement_max[0] + r.u[0] + r.impulse_max, 0, 0);
	// also if it overflows before the next check, or is not a number
	task.bodies[0].backbone.stiffness = 1e300;
	assert_int_equal(integrate(CENTRAL_DIFFERENCE, 0.01, &task).status, POUND_UNSTABLE);
}

/* A contact of a few steps has a wrong result even if it does not diverge. */
static void nor_is_one_beyond_that_of_a_touching_pair_passed_in_silence(void **state)
{
	(void)state;
	struct pound_task task = specimen_impact(0.5, true, 21);
	const double limit = 2 / sqrt(task.contact_stiffness * (1 + task.mass_ratio));
	task.time_step = 0.99 * limit;
	assert_int_equal(integrate(CENTRAL_DIFFERENCE, task.time_step, &task).status, POUND_OK);
	task.time_step = 1.01 * limit;
	assert_int_equal(integrate(CENTRAL_DIFFERENCE, task.time_step, &task).status, POUND_UNSTABLE);
	assert_int_equal(integrate(NEWMARK, task.time_step, &task).status, POUND_OK);
	task.gap = 10;
	assert_int_equal(integrate(CENTRAL_DIFFERENCE, task.time_step, &task).status, POUND_OK);
}

static void a_step_is_cut_to_fit_the_sample_interval(void **state)
{
	(void)state;
	static const double same[][2] = {{0.003, 0.0025}, {7, 0.01}, {0.00100001, 0.001}, {0.01 / 3, 0.0034}};
	const struct pound_task task = vibration(0.02, 1);
	for (int method = NEWMARK; method <= CENTRAL_DIFFERENCE; method++)
		for (size_t k = 0; k < sizeof same / sizeof same[0]; k++)
			check_near(integrate(method, same[k][0], &task).u[0], integrate(method, same[k][1], &task).u[0],
			           0);
}

static void an_impact_leaves_with_the_restitution_to_the_first_power_of_the_step(void **state)
{
	(void)state;
	for (int method = NEWMARK; method <= CENTRAL_DIFFERENCE; method++)
		for (int e = 0; e <= 10; e++)
			for (double step = 1e-4; step > 1e-6; step /= 10) {
				const struct pound_task task = specimen_impact(e / 10.0, true, 21);
				const struct pound_task_result r = integrate(method, step, &task);
				// the contact begins and ends up to one step late, each with a force up to C v: 2 w h in total
				double w = sqrt(task.contact_stiffness * 1.5);
				check_near((r.v[1] - r.v[0]) / 1.5, e / 10.0, 2 * w * step);
				check_near(r.impulse_max, (1 + e / 10.0) * 1.5 / 1.5, 4 * w * step);
				assert_int_equal(r.contacts, 1);
				check_near(r.first_contact, 0.1 / 1.5, 2 * step);
				check_near(r.first_speed, 1.5, 1e-9);
			}
}

static double distance(const struct pound_response *a, const struct pound_response *b)
{
	double u = fabs(a->displacement_max_1 / b->displacement_max_1 - 1);
	double impulse = b->impulse_max > 0 ? fabs(a->impulse_max / b->impulse_max - 1) : a->impulse_max;
	return fmax(u, impulse);
}

/* Random scenes with every law and both contact rules, for 1 s.  The contact is up to 1e4 times stiffer: w h <= 0.03
 * at the finer step, so an impact has an error of some per cent, and later impacts a few times that. */
static void responses_come_to_those_of_the_march(void **state)
{
	(void)state;
	enum { SCENES = 32 };
	for (int method = NEWMARK; method <= CENTRAL_DIFFERENCE; method++) {
		double sum[2] = {0, 0};
		for (int k = 0; k < SCENES; k++) {
			struct specimen specimen;
			specimen_random(&specimen, k, 0.01, 101);
			struct pound_response exact = specimen_engine(&specimen);
			specimen.study.solver.method = method;
			for (int fine = 0; fine < 2; fine++) {
				specimen.study.solver.step = fine ? 1e-5 : 1e-4;
				struct pound_response response = specimen_engine(&specimen);
				double d = distance(&response, &exact);
				check_near(d, 0, fine ? 2e-3 : 5e-2);
				sum[fine] += d;
			}
			specimen_free(&specimen);
		}
		// first order in the step would be 10
		assert_true(sum[0] / sum[1] > 8);
	}
}

CHECK_MAIN(cmocka_unit_test(the_solvers_have_their_names_in_these_rows),
           cmocka_unit_test(the_error_of_free_vibration_falls_with_the_square_of_the_step),
           cmocka_unit_test(newmark_keeps_the_energy_of_free_vibration_at_any_step),
           cmocka_unit_test(central_differences_vibrate_with_their_known_period),
           cmocka_unit_test(an_explicit_step_beyond_its_limit_ends_with_a_status),
           cmocka_unit_test(nor_is_one_beyond_that_of_a_touching_pair_passed_in_silence),
           cmocka_unit_test(a_step_is_cut_to_fit_the_sample_interval),
           cmocka_unit_test(an_impact_leaves_with_the_restitution_to_the_first_power_of_the_step),
           cmocka_unit_test(responses_come_to_those_of_the_march))
