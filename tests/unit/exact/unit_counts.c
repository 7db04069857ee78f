/* unit_counts.c - which contacts count: none that consists of rounding errors, and every other one however weak. */
#include <float.h>
#include <math.h>

#include "engine/exact/counts.h"
#include "engine/solver/solver.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

/* the solvers whose counts are compared */
enum { EVENT, EVENT_ONE, NEWMARK, CENTRAL, ADAPTIVE, COUNTERS };
static const char *const names[] = {"event", "event, one lane", "newmark", "central", "adaptive"};

struct count {
	enum pound_status status;
	int64_t contacts;
	double time, first, speed;
};

static struct count march_count(const struct pound_task *task, int lanes)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	struct pound_task_result r;
	assert_true(pound_exact_lanes(lanes, task, &r, 1, scratch, NULL));
	return (struct count){r.status, r.contacts, r.contact_time, r.first_contact, r.first_speed};
}

static struct count count_of(const struct pound_task *task, int who)
{
	const struct pound_solver solver = {.tolerance = 1e-10, .step = 1e-3};
	struct pound_task_result r;
	if (who <= EVENT_ONE)
		return march_count(task, who);
	if (who == ADAPTIVE)
		pound_adaptive_run(&solver, task, &r, NULL);
	else if (who == NEWMARK)
		pound_fixed_newmark(&solver, task, &r, NULL);
	else
		pound_fixed_central(&solver, task, &r, NULL);
	return (struct count){r.status, r.contacts, r.contact_time, r.first_contact, r.first_speed};
}

/* ---- the rule ---- */

static void a_contact_counts_by_what_it_changes_beside_the_largest_that_rounding_is_of(void **state)
{
	(void)state;
	// 3 + (5 2 + 7 + 0.5 3 + 0.25) 2/0.5 = 78 for one body, and 1 + 0 for the other, after a minute
	struct pound_counts c = {.body = {{-2, 3, 5, -7, 0.5, -0.25}, {0, -1, 0, 0, 0, 0}}, .time = 60};
	struct pound_counts_scale scale = {0};
	c.changed = 16 * DBL_EPSILON * 79 * (1 - 1e-9);
	assert_false(pound_contact_counts(&c, &scale));
	check_near(scale.most, 79, 1e-13);
	c.changed = 16 * DBL_EPSILON * 79 * (1 + 1e-9);
	assert_true(pound_contact_counts(&c, &scale));
	// in the first second nothing has been damped: 3 + 18.75 + 1
	scale = (struct pound_counts_scale){0};
	c.time = 1;
	assert_true(pound_contact_counts(&c, &scale));
	check_near(scale.most, 22.75, 1e-13);
	// each step has its rounding errors
	c.steps = 3;
	scale = (struct pound_counts_scale){0};
	c.changed = 16 * DBL_EPSILON * 4 * 22.75 * (1 - 1e-9);
	assert_false(pound_contact_counts(&c, &scale));
	c.changed = 16 * DBL_EPSILON * 4 * 22.75 * (1 + 1e-9);
	assert_true(pound_contact_counts(&c, &scale));
	// the largest scale so far also applies to later contacts
	scale.most = 1e3;
	assert_false(pound_contact_counts(&c, &scale));
	check_near(scale.most, 1e3, 0);
	// a large change of speed needs no sum while the bodies are not faster than when the scale was computed
	c.changed = 1;
	c.body[0].u = 1e9;
	assert_true(pound_contact_counts(&c, &scale));
	check_near(scale.most, 1e3, 0);
	c.body[0].v = 3.1;
	assert_true(pound_contact_counts(&c, &scale));
	assert_true(scale.most > 1e9);
}

/* ---- contacts without force ---- */

/* Two bodies in contact at rest whose frequencies differ by at most a rounding error. */
static void alike_make(struct specimen *specimen, int number, double sign)
{
	specimen_alike(specimen, number, number % SPECIMEN_LAWS);
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[1].frequency_hz =
	    scene->oscillators[0].frequency_hz * (1 + number / 4 % 3 * DBL_EPSILON);
	scene->contact.stiffness_ratio = 100;
	for (int k = 0; k < scene->excitation.n_record; k++)
		specimen->record[k] *= sign;
}

static void bodies_that_move_alike_have_no_contacts_in_any_motion_or_its_mirror_image(void **state)
{
	(void)state;
	const int n = check_count(24, 240);
	for (int number = 0; number < n; number++)
		for (int sign = 1; sign >= -1; sign -= 2)
			for (int who = EVENT; who <= CENTRAL; who++) {
				struct specimen specimen;
				alike_make(&specimen, number, sign);
				const struct pound_task task = floor_task_task(&specimen, true);
				const struct count c = count_of(&task, who);
				if (c.contacts != 0 || c.time != 0)
					print_message("%d, %d: %s\n", number, sign, names[who]);
				assert_int_equal(c.status, POUND_OK);
				assert_int_equal(c.contacts, 0);
				check_near(c.time, 0, 0);
				check_near(c.first, 0, 0);
				check_near(c.speed, 0, 0);
				specimen_free(&specimen);
			}
}

/* A body against a wall without a gap; the ground moves for 5 s, then rests for a number of seconds. */
static void dead_make(struct specimen *specimen, int number, int seconds)
{
	static const double restitutions[] = {0, 0.3, 0.6, 0.9};
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[0].frequency_hz = 2;
	scene->oscillators[1].rigid_wall = true;
	scene->contact.restitution = restitutions[number % 4];
	scene->contact.tension = number / 4 % 2;
	specimen_noise(specimen, 77 + (uint64_t)number, 1, 0.01, 501 + 100 * seconds);
	for (int k = 500; k <= 500 + 100 * seconds; k++)
		specimen->record[k] = 0;
}

static void a_body_dead_at_rest_on_a_wall_does_not_go_on_counting(void **state)
{
	(void)state;
	for (int number = 0; number < 8; number++) {
		int64_t first = -1;
		// with 5 % damping the motion is below rounding at most 36/(0.05 4 pi) = 57 s after the last shock
		for (int who = EVENT; who < COUNTERS; who++) {
			struct count counted[2];
			for (int k = 0; k < 2; k++) {
				struct specimen specimen;
				dead_make(&specimen, number, 60 << k);
				const struct pound_task task = floor_task_task(&specimen, true);
				counted[k] = count_of(&task, who);
				assert_int_equal(counted[k].status, POUND_OK);
				specimen_free(&specimen);
			}
			if (counted[0].contacts != counted[1].contacts)
				print_message("%d: %s\n", number, names[who]);
			assert_true(counted[0].contacts > 0);
			assert_int_equal(counted[1].contacts, counted[0].contacts);
			// without restitution the last contact does not end
			if (number % 4 > 0)
				check_near(counted[1].time, counted[0].time, 0);
			if (who == EVENT)
				first = counted[0].contacts;
			// contacts near the limit may count for one solver and not for another, which takes other steps
			if (who <= EVENT_ONE)
				assert_int_equal(counted[0].contacts, first);
			check_near((double)counted[0].contacts, (double)first,
			           who <= EVENT_ONE ? 0 : 0.1 * (double)first + 2);
		}
	}
}

static void a_body_that_has_never_moved_has_no_contact(void **state)
{
	(void)state;
	struct specimen specimen;
	dead_make(&specimen, 0, 1);
	for (int k = 0; k < 601; k++)
		specimen.record[k] = 0;
	const struct pound_task task = floor_task_task(&specimen, true);
	for (int who = EVENT; who < COUNTERS; who++)
		assert_int_equal(count_of(&task, who).contacts, 0);
	specimen_free(&specimen);
}

/* ---- contacts with force, however weak ---- */

static void forces_of_1e_9_count_as_large_ones_do(void **state)
{
	(void)state;
	// if the frequencies differ by this fraction, the contact force is proportional to it: the same contacts
	static const double parts[] = {1e-6, 1e-7, 1e-8, 1e-9};
	for (int number = 0; number < 4; number++) {
		struct pound_response before = {0};
		for (int k = 0; k < 4; k++) {
			struct specimen specimen;
			alike_make(&specimen, 4 * number, 1); // linear
			struct pound_scene *scene = &specimen.study.scene;
			scene->oscillators[1].frequency_hz = scene->oscillators[0].frequency_hz * (1 + parts[k]);
			const struct pound_response r = specimen_engine(&specimen);
			const struct pound_task task = floor_task_task(&specimen, true);
			assert_true(r.contact_count > 0);
			assert_int_equal(count_of(&task, EVENT_ONE).contacts, r.contact_count);
			if (k > 0) {
				assert_int_equal(r.contact_count, before.contact_count);
				check_near(r.impulse_max / before.impulse_max, 0.1, 1e-4);
			}
			before = r;
			specimen_free(&specimen);
		}
	}
}

CHECK_MAIN(cmocka_unit_test(a_contact_counts_by_what_it_changes_beside_the_largest_that_rounding_is_of),
           cmocka_unit_test(bodies_that_move_alike_have_no_contacts_in_any_motion_or_its_mirror_image),
           cmocka_unit_test(a_body_dead_at_rest_on_a_wall_does_not_go_on_counting),
           cmocka_unit_test(a_body_that_has_never_moved_has_no_contact),
           cmocka_unit_test(forces_of_1e_9_count_as_large_ones_do))
