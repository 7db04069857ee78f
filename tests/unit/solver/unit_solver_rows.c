/* unit_solver_rows.c - rows of buildings by every solver: against the exact solver, which unit_chain tests, and
 * against pairs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/solver/solver.h"
#include "tests/support/check.h"
#include "tests/support/known_rows.h"
#include "tests/support/scenes.h"

enum { NEWMARK = 1, CENTRAL_DIFFERENCE = 2, DRIFTS = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS };

static const double PI = 3.14159265358979323846;

/* Measures of one run. */
struct rows {
	enum pound_status status;
	double floors[ROW_FLOORS][POUND_FLOOR_MEASURES], links[ROW_LINKS][POUND_LINK_MEASURES];
};

static void solve(const struct pound_chain_task *task, struct pound_solver solver, struct rows *rows)
{
	struct pound_chain_result result = {.floors = rows->floors[0], .links = rows->links[0]};
	void *scratch = aligned_alloc(64, POUND_CHAIN_SCRATCH);
	assert_non_null(scratch);
	assert_int_equal(pound_solver_rows(&solver, task, &result, 1, scratch, NULL), POUND_OK);
	rows->status = result.status;
	free(scratch);
}

/* Largest difference of a measure over the floors, relative to its largest value. */
static double apart(const struct pound_chain_task *task, const struct rows *a, const struct rows *b,
                    int measure)
{
	double most = 0, error = 0;
	for (int i = 0; i < task->n_floors; i++) {
		most = fmax(most, fabs(b->floors[i][measure]));
		error = fmax(error, fabs(a->floors[i][measure] - b->floors[i][measure]));
	}
	return error / most;
}

static double impulses_apart(const struct pound_chain_task *task, const struct rows *a, const struct rows *b)
{
	double most = 0, error = 0;
	for (int k = 0; k < task->n_links; k++) {
		most = fmax(most, b->links[k][POUND_LINK_IMPULSE_MAX]);
		error = fmax(error, fabs(a->links[k][POUND_LINK_IMPULSE_MAX] - b->links[k][POUND_LINK_IMPULSE_MAX]));
	}
	return most > 0 ? error / most : 0;
}

static double distance(const struct pound_chain_task *task, const struct rows *a, const struct rows *b)
{
	double most = impulses_apart(task, a, b);
	static const int measures[] = {POUND_FLOOR_DRIFT_MAX, POUND_FLOOR_DISPLACEMENT_MAX, POUND_FLOOR_END_U};
	for (int j = 0; j < 3; j++)
		most = fmax(most, apart(task, a, b, measures[j]));
	return most;
}

static struct row row;
static struct rows exact, other, fine;

static void the_adaptive_solver_has_the_known_answers(void **state)
{
	(void)state;
	for (int which = 0; which < ROW_KNOWN; which++) {
		const int n = row_known(&row, which);
		const struct pound_chain_task task = row_task(&row, n, 0.01, DRIFTS);
		solve(&task, (struct pound_solver){.method = POUND_SOLVER_EVENT}, &exact);
		solve(&task, (struct pound_solver){.method = POUND_SOLVER_ADAPTIVE, .tolerance = 1e-12}, &other);
		assert_int_equal(other.status, POUND_OK);
		// some hundred steps, each with the tolerance; each impact may amplify the earlier errors a few times
		check_near(distance(&task, &other, &exact), 0, 1e-9);
		for (int k = 0; k < task.n_links; k++) {
			check_near(other.links[k][POUND_LINK_CONTACTS], exact.links[k][POUND_LINK_CONTACTS], 0);
			check_near(other.links[k][POUND_LINK_FIRST_TIME], exact.links[k][POUND_LINK_FIRST_TIME], 1e-9);
			check_near(other.links[k][POUND_LINK_TIME], exact.links[k][POUND_LINK_TIME], 1e-8);
		}
		check_report("row %d: %.1e", which, distance(&task, &other, &exact));
	}
}

/* Any law, damping, contact with and without tension, levels within stories, up to 36 floors; 4 s of noise. */
static void the_adaptive_solver_follows_rows_at_random(void **state)
{
	(void)state;
	double worst = 0;
	for (int number = 0; number < check_count(8, 200); number++) {
		const int n = row_random(&row, (uint64_t)number);
		const struct pound_chain_task task = row_task(&row, n, 0.01, DRIFTS);
		solve(&task, (struct pound_solver){.method = POUND_SOLVER_EVENT}, &exact);
		solve(&task, (struct pound_solver){.method = POUND_SOLVER_ADAPTIVE, .tolerance = 1e-11}, &other);
		assert_int_equal(other.status, POUND_OK);
		worst = fmax(worst, distance(&task, &other, &exact));
	}
	check_report("off the exact solver by %.1e at most", worst);
	assert_true(worst < 1e-7); // up to a thousand impacts
}

/* The sum of the errors decreases at least linearly with the step. */
static void fixed_steps_converge_to_the_known_answers(void **state)
{
	(void)state;
	for (int method = NEWMARK; method <= CENTRAL_DIFFERENCE; method++) {
		double coarse = 0, finer = 0;
		for (int which = 0; which < ROW_KNOWN; which++) {
			const int n = row_known(&row, which);
			const struct pound_chain_task task =
			    row_task(&row, n, 0.01, DRIFTS | POUND_CHAIN_ACCELERATIONS | POUND_CHAIN_FORCES);
			solve(&task, (struct pound_solver){.method = POUND_SOLVER_EVENT}, &exact);
			solve(&task, (struct pound_solver){.method = method, .step = 1e-4}, &other);
			solve(&task, (struct pound_solver){.method = method, .step = 1e-5}, &fine);
			assert_int_equal(other.status, POUND_OK);
			assert_int_equal(fine.status, POUND_OK);
			coarse += distance(&task, &other, &exact);
			finer += distance(&task, &fine, &exact);
			// an impact one step late has an error of w h with the contact's w, some 1e-2 at the finer step; later
			// impacts amplify it
			check_near(distance(&task, &fine, &exact), 0, 0.05);
			check_near(apart(&task, &fine, &exact, POUND_FLOOR_ACCELERATION_MAX), 0, 0.05);
			for (int k = 0; k < task.n_links; k++)
				check_near(fine.links[k][POUND_LINK_FORCE_MAX] / exact.links[k][POUND_LINK_FORCE_MAX], 1,
				           0.05);
		}
		check_report("%s: sum of errors %.1e at 1e-4 s, %.1e at 1e-5 s", pound_solver_name(method), coarse,
		             finer);
		assert_true(coarse / finer > 5);
	}
}

/* Linear rows without contact, with every damping form: errors of the final displacements are of second order in the step. */
static void without_contact_fixed_steps_are_of_second_order(void **state)
{
	(void)state;
	static const int stories[] = {1, 3, 10, 30};
	for (int method = NEWMARK; method <= CENTRAL_DIFFERENCE; method++)
		for (int k = 0; k < 16; k++) {
			double errors[3];
			row_init(&row);
			row.contact.present = false;
			row.n_buildings = 1;
			row.buildings[0] = row_building(stories[k / 4], 1e5, 1);
			row.buildings[0].frequency_hz = 2.3 / (1 + k / 4);
			row.buildings[0].damping = (enum row_damping)(k % 4);
			const int n = row_harmonic(&row, 1.1, 3, 2);
			const struct pound_chain_task task = row_task(&row, n, 0.01, DRIFTS);
			solve(&task, (struct pound_solver){.method = POUND_SOLVER_EVENT}, &exact);
			for (int j = 0; j < 3; j++) {
				solve(&task, (struct pound_solver){.method = method, .step = 1e-3 / (1 << j)}, &other);
				assert_int_equal(other.status, POUND_OK);
				errors[j] = apart(&task, &other, &exact, POUND_FLOOR_END_U);
			}
			// the next term is (w h)^2 of this one, with w h up to 0.1 in the highest mode, which contributes little
			check_near(log2(errors[0] / errors[1]), 2, 0.03);
			check_near(log2(errors[1] / errors[2]), 2, 0.01);
		}
}

/* N equal floors have w_N = 2 sqrt(k/m) sin((2N - 1) pi/(4N + 2)). */
static void a_step_beyond_2_over_the_highest_frequency_ends_with_a_status(void **state)
{
	(void)state;
	for (int n = 1; n <= 50; n += 7) {
		row_init(&row);
		row.contact.present = false;
		row.n_buildings = 1;
		row.buildings[0] = row_building(n, 1e5, 1e8);
		const double w = 2 * sqrt(1e3) * sin((2 * n - 1) * PI / (4 * n + 2));
		const int samples = row_harmonic(&row, 1, 1, 1);
		struct pound_chain_task task = row_task(&row, samples, 0.99 * 2 / w, DRIFTS);
		solve(&task, (struct pound_solver){.method = CENTRAL_DIFFERENCE, .step = 1}, &other);
		assert_int_equal(other.status, POUND_OK);
		task.time_step = 1.01 * 2 / w;
		solve(&task, (struct pound_solver){.method = CENTRAL_DIFFERENCE, .step = 1}, &other);
		assert_int_equal(other.status, POUND_UNSTABLE);
		solve(&task, (struct pound_solver){.method = NEWMARK, .step = 1}, &other);
		assert_int_equal(other.status, POUND_OK);
	}
}

/* Two floors in contact: w^2 = K/m_eff, neglecting their own springs, which are 1e4 times softer. */
static void nor_is_one_beyond_that_of_what_touches_passed_in_silence(void **state)
{
	(void)state;
	row_init(&row);
	row.n_buildings = 2;
	row.contact.gap = 0.001;
	row.contact.stiffness_ratio = 1e4;
	row.buildings[0] = row_building(1, 1e5, 1e6);
	row.buildings[1] = row_building(1, 1e5, 2e6);
	const int samples = row_harmonic(&row, 0.5, 2, 1);
	struct pound_chain_task task = row_task(&row, samples, 0.01, DRIFTS);
	const double limit = 2 / sqrt(2e10 * 2e-5);
	for (int over = 0; over < 2; over++) {
		// whole steps per sample
		task.time_step = (over ? 1.01 : 0.99) * limit * 4;
		solve(&task, (struct pound_solver){.method = CENTRAL_DIFFERENCE, .step = task.time_step / 4}, &other);
		assert_int_equal(other.status, over ? POUND_UNSTABLE : POUND_OK);
		solve(&task, (struct pound_solver){.method = NEWMARK, .step = task.time_step / 4}, &other);
		assert_int_equal(other.status, POUND_OK);
		assert_true(other.links[0][POUND_LINK_CONTACTS] > 0);
	}
}

/* One-story rows and the same scenes as pairs.  The fixed steps of rows and pairs share no code: 1e4 steps have
 * rounding errors of 1e-14, and each of some four contacts, which begins at a whole step, amplifies the difference up
 * to 30 times. */
static void one_storey_rows_agree_with_pairs(void **state)
{
	(void)state;
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	static const struct pound_solver solvers[] = {{.method = NEWMARK, .step = 1e-3},
	                                              {.method = CENTRAL_DIFFERENCE, .step = 1e-4},
	                                              {.method = POUND_SOLVER_ADAPTIVE, .tolerance = 1e-10}};
	double worst[3] = {0};
	for (int number = 0; number < 40; number++)
		for (int k = 0; k < 3; k++) {
			const int n = row_random(&row, (uint64_t)number);
			row.n_buildings = 2;
			row.wall = false;
			for (int b = 0; b < 2; b++) {
				row.buildings[b] = row_building(1, 1e5 * (b + 1), 1);
				row.buildings[b].law =
				    (struct pound_backbone){.law = number % 4, .hardening = 0.05, .yield = 0.003};
				row.buildings[b].frequency_hz = b ? 2.7 : 1.1;
			}
			const struct pound_chain_task task = row_task(&row, n > 151 ? 151 : n, 0.01, DRIFTS);
			const double m = row.floors[0].mass;
			struct pound_task pair = {.ground = task.ground,
			                          .n_samples = task.n_samples,
			                          .time_step = task.time_step,
			                          .contact = true,
			                          .gap = row.links[0].gap,
			                          .contact_stiffness = row.links[0].law.stiffness / m,
			                          .contact_damping = row.links[0].law.dashpot / m,
			                          .mass_ratio = m / row.floors[1].mass,
			                          .tension = row.links[0].law.tension};
			for (int b = 0; b < 2; b++) {
				pair.bodies[b] =
				    (struct pound_task_body){.backbone = row.floors[b].story,
				                             .damping = row.floors[b].dashpot / row.floors[b].mass,
				                             .drive = 1,
				                             .followed = true};
				pair.bodies[b].backbone.stiffness /= row.floors[b].mass;
			}
			struct pound_task_result want;
			assert_int_equal(pound_solver_run(&solvers[k], &pair, &want, 1, scratch, NULL), POUND_OK);
			solve(&task, solvers[k], &other);
			assert_int_equal(other.status, want.status);
			if (want.status)
				continue;
			const double of[][2] = {{other.floors[0][POUND_FLOOR_DRIFT_MAX], want.displacement_max[0]},
			                        {other.floors[1][POUND_FLOOR_DISPLACEMENT_MAX], want.displacement_max[1]},
			                        {other.floors[0][POUND_FLOOR_END_U], want.u[0]},
			                        {other.links[0][POUND_LINK_IMPULSE_MAX], want.impulse_max * m},
			                        {other.links[0][POUND_LINK_FIRST_TIME], want.first_contact},
			                        {other.links[0][POUND_LINK_CONTACTS], (double)want.contacts}};
			for (size_t j = 0; j < sizeof of / sizeof of[0]; j++)
				worst[k] = fmax(worst[k], fabs(of[j][0] - of[j][1]) / fmax(fabs(of[j][1]), 1e-3));
		}
	check_report("off pairs by %.1e, %.1e, %.1e at most", worst[0], worst[1], worst[2]);
	assert_true(worst[0] < 1e-8 && worst[1] < 1e-8 && worst[2] < 1e-10);
}

/* Contacts whose force is a product, a power, or piecewise linear, between floors. */
static void solvers_agree_on_every_contact_model_that_they_take(void **state)
{
	(void)state;
	int compared = 0;
	for (int model = 0; model < POUND_CONTACT_MODELS; model++) {
		const enum pound_force force = pound_contact_force(model);
		const int n = row_known(&row, ROW_TWO_AND_TWO);
		row.contact.model = model;
		row.contact.calibration = 1;
		row.contact.hertz_stiffness = force == POUND_FORCE_POWER ? 2e9 : 0;
		row.contact.second_stiffness_ratio = 0.4;
		row.contact.yield_overlap = 2e-4;
		row.contact.speed_floor = 1e-3;
		const struct pound_chain_task task = row_task(&row, n, 0.01, DRIFTS);
		solve(&task, (struct pound_solver){.method = POUND_SOLVER_EVENT}, &exact);
		for (int solver = 1; solver < POUND_SOLVERS; solver++) {
			if (!pound_solver_takes_row_force(solver, force))
				continue;
			const bool steps = pound_solver_takes_step(solver);
			solve(&task, (struct pound_solver){.method = solver, .tolerance = 1e-12, .step = 1e-5}, &other);
			assert_int_equal(other.status, POUND_OK);
			const double error = distance(&task, &other, &exact);
			if (!(error < (steps ? 0.02 : 1e-9)))
				fail_msg("%s, %s: %g", pound_contact_name(model), pound_solver_name(solver), error);
			compared++;
		}
	}
	assert_int_equal(compared, 3 * (POUND_CONTACT_MODELS - 1)); // all except rigid
}

CHECK_MAIN(cmocka_unit_test(the_adaptive_solver_has_the_known_answers),
           cmocka_unit_test(the_adaptive_solver_follows_rows_at_random),
           cmocka_unit_test(fixed_steps_converge_to_the_known_answers),
           cmocka_unit_test(without_contact_fixed_steps_are_of_second_order),
           cmocka_unit_test(a_step_beyond_2_over_the_highest_frequency_ends_with_a_status),
           cmocka_unit_test(nor_is_one_beyond_that_of_what_touches_passed_in_silence),
           cmocka_unit_test(one_storey_rows_agree_with_pairs),
           cmocka_unit_test(solvers_agree_on_every_contact_model_that_they_take))
