/* unit_contact_models.c - every contact model by every solver that supports it, against known answers of other
 * programs.
 *
 * Two oscillators, 1e5 kg at 2 Hz and 1.7e5 kg at 3.1 Hz, 5 % damping, gap 4 mm, under 2.5 s of a sine of 1.9 Hz and
 * 3 m/s2, sampled at 0.01 s; contacts are 100 times as stiff as the stiffer oscillator, or 2e9 N/m^1.5. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/run/scene.h"
#include "engine/solver/solver.h"
#include "tests/support/check.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

enum { SAMPLES = 251 };

struct known {
	int contacts;
	double impulse, time, u[2]; /* impulse [N s] */
	double force;               /* largest [N] */
};

static const struct model_case {
	const char *model;
	bool exact, released; /* calibration; no tension */
	double restitution;
	struct known known; /* contacts 0: unknown */
} cases[] = {
    {"linear",
     false,
     false,
     0.6,
     {9, 93876.7338786870, .0883520729825056, {.0167041542312387, .0233884675622301}, 14976161.9366289}},
    {"kelvin_voigt",
     true,
     true,
     0.4,
     {9, 63415.4630085173, .0750156299231338, {.0180513561187237, .0177945545640341}, 11945053.1595344}},
    {"modified_kelvin_voigt",
     false,
     false,
     0.6,
     {9, 70513.0484900248, .0807873571883122, {.0174790681878366, .0208941469792553}, 11988704.1109273}},
    {"hertz",
     false,
     false,
     0.6,
     {6, 88888.9721818787, .289353302319863, {.0263221266009357, .0111931635567602}, 2953463.48797653}},
    {"hertz_damp",
     true,
     false,
     0.6,
     {7, 75372.1989044192, .339810866805263, {.0241256751988095, .0100156138462380}, 2863007.08181032}},
    {"viscoelastic",
     false,
     false,
     0.6,
     {7, 75519.0765612290, .349059823999101, {.0231502852699162, .0108801315694411}, 2257875.94466737}},
    {"bilinear",
     false,
     false,
     0.6,
     {9, 89678.7216022189, .130532934815042, {.0164921627556637, .0241451171318295}, 9432222.90278947}},
    {"rigid", false, false, 0.6, {9, 68044.0846871759, 0, {.0162258704777903, .0210452514521382}, 0}},
    {"hunt_crossley", false, false, 0.6, {0}},
    {"damped_hertz", false, false, 0.6, {0}},
    {"damped_hertz", false, true, 0.6, {0}},
};

static double ground[SAMPLES];
static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];

static int row_of(const char *(*name)(int row), const char *wanted)
{
	int row = 0;
	while (strcmp(name(row), wanted) != 0)
		row++;
	return row;
}

static struct pound_task task_of(const struct model_case *of)
{
	const int model = row_of(pound_contact_name, of->model);
	const struct pound_scene scene = {
	    .law = {.type = row_of(pound_law_name, "linear")},
	    .oscillators = {{.mass = 1e5, .frequency_hz = 2, .damping_ratio = 0.05},
	                    {.mass = 1.7e5, .frequency_hz = 3.1, .damping_ratio = 0.05}},
	    .contact = {.present = true,
	                .model = model,
	                .stiffness_ratio = 100,
	                .hertz_stiffness = pound_contact_force(model) == POUND_FORCE_POWER ? 2e9 : 0,
	                .reference_speed = 0.1,
	                .restitution = of->restitution,
	                .calibration = of->exact,
	                .gap = 0.004,
	                .tension = !of->released,
	                .second_stiffness_ratio = 0.4,
	                .yield_overlap = 2e-4,
	                .speed_floor = 1e-3}};
	struct pound_task task = {.ground = ground, .n_samples = SAMPLES, .time_step = 0.01};
	for (int t = 0; t < SAMPLES; t++)
		ground[t] = 3 * sin(2 * 3.14159265358979323846 * 1.9 * 0.01 * t);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		task.bodies[i] = pound_scene_body(&scene, i);
		task.bodies[i].followed = true;
	}
	pound_scene_contact(&scene, &task);
	return task;
}

static struct pound_task_result result_of(const struct pound_task *task, const struct pound_solver *solver)
{
	struct pound_task_result result;
	assert_int_equal(pound_solver_run(solver, task, &result, 1, scratch, NULL), POUND_OK);
	assert_int_equal(result.status, POUND_OK);
	return result;
}

/* Largest relative error of a result. */
static double error_of(const struct pound_task_result *r, const struct known *known)
{
	double error = fabs(r->impulse_max * 1e5 / known->impulse - 1);
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		error = fmax(error, fabs(r->u[i] / known->u[i] - 1));
	return fmax(error, known->time > 0 ? fabs(r->contact_time / known->time - 1) : r->contact_time);
}

static struct known known_of(const struct model_case *of)
{
	if (of->known.contacts > 0)
		return of->known;
	const struct pound_task task = task_of(of);
	const struct pound_solver solver = {.method = POUND_SOLVER_ADAPTIVE, .tolerance = 1e-13};
	const struct pound_task_result r = result_of(&task, &solver);
	return (struct known){(int)r.contacts, r.impulse_max * 1e5, r.contact_time, {r.u[0], r.u[1]}, 0};
}

static void the_adaptive_solver_has_the_known_answers_of_every_model(void **state)
{
	(void)state;
	for (int i = 0; i < COUNT(cases); i++) {
		if (cases[i].known.contacts == 0)
			continue;
		const struct pound_task task = task_of(&cases[i]);
		const struct pound_solver solver = {.method = POUND_SOLVER_ADAPTIVE, .tolerance = 1e-12};
		const struct pound_task_result r = result_of(&task, &solver);
		assert_int_equal(r.contacts, cases[i].known.contacts);
		check_near(r.first_contact, .411331188317195, 1e-11);
		check_near(r.first_speed, .513724371110237, 1e-10);
		// a hundred times the tolerance, times ten for the amplification by nine contacts
		check_near(error_of(&r, &cases[i].known), 0, 1e-9);
	}
}

static void the_exact_solver_has_the_known_answers_of_every_model(void **state)
{
	(void)state;
	for (int i = 0; i < COUNT(cases); i++) {
		struct pound_task task = task_of(&cases[i]);
		task.accounted = true;
		const struct pound_solver solver = {.method = POUND_SOLVER_EVENT};
		const struct pound_task_result r = result_of(&task, &solver);
		check_near(r.energy_residual, 0, 1e-12);
		check_near(r.first_contact, .411331188317195, 1e-14);
		check_near(r.first_speed, .513724371110237, 1e-13);
		const struct known known = known_of(&cases[i]);
		assert_int_equal(r.contacts, known.contacts);
		// unknown values are compared with the adaptive solver
		check_near(error_of(&r, &known), 0, cases[i].known.contacts > 0 ? 1e-12 : 1e-9);
	}
}

/* The same scenes as rows of one-story buildings, which also have the largest force. */
static void rows_have_the_known_largest_forces(void **state)
{
	(void)state;
	for (int i = 0; i < COUNT(cases); i++) {
		if (cases[i].known.contacts == 0)
			continue;
		const struct pound_task task = task_of(&cases[i]);
		struct pound_pair_chain chain;
		pound_pair_chain(&task, &chain);
		chain.task.asked = POUND_CHAIN_FORCES;
		struct pound_chain_result result = {.floors = chain.floor_measures[0], .links = chain.link_measures};
		assert_true(pound_chain_lanes(0, &chain.task, &result, 1, scratch, NULL));
		assert_int_equal(result.status, POUND_OK);
		// forces are per mass of the left body
		check_near(chain.link_measures[POUND_LINK_FORCE_MAX] * 1e5, cases[i].known.force,
		           1e-12 * cases[i].known.force);
		check_near(chain.link_measures[POUND_LINK_IMPULSE_MAX] * 1e5, cases[i].known.impulse,
		           1e-12 * cases[i].known.impulse);
	}
}

/* Errors of the fixed steps decrease with the step: at least to a tenth for a step of a hundredth. */
static void fixed_steps_converge_to_the_known_answers_of_every_model_they_take(void **state)
{
	(void)state;
	int compared = 0;
	for (int row = 0; row < POUND_SOLVERS; row++)
		for (int i = 0; pound_solver_takes_step(row) && i < COUNT(cases); i++) {
			const struct pound_task task = task_of(&cases[i]);
			if (!pound_solver_takes_force(row, task.force))
				continue;
			const struct known known = known_of(&cases[i]);
			const struct pound_solver coarse = {.method = row, .step = 1e-4},
			                          fine = {.method = row, .step = 1e-6};
			const struct pound_task_result r = result_of(&task, &coarse), s = result_of(&task, &fine);
			assert_int_equal(s.contacts, known.contacts);
			const double before = error_of(&r, &known), after = error_of(&s, &known);
			// a contact begins and ends up to one step late
			const double late = 2 * known.contacts * fine.step / known.time;
			if (!(after < fmax(0.1 * before, late)) || !(after < 2e-3))
				fail_msg("%s, %s: errors %g, %g", pound_solver_name(row), cases[i].model, before, after);
			compared++;
		}
	assert_int_equal(compared, 2 * (COUNT(cases) - 1)); // all except rigid
}

CHECK_MAIN(cmocka_unit_test(the_exact_solver_has_the_known_answers_of_every_model),
           cmocka_unit_test(the_adaptive_solver_has_the_known_answers_of_every_model),
           cmocka_unit_test(rows_have_the_known_largest_forces),
           cmocka_unit_test(fixed_steps_converge_to_the_known_answers_of_every_model_they_take))
