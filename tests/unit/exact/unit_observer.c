/* unit_observer.c - the instants that an observer receives: closed forms, another solver, no gaps in time, the same
 * bits everywhere. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/scene/contact.h"
#include "engine/solver/solver.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

static const double PI = 3.14159265358979323846;

enum { INSTANTS_MAX = 1 << 15 };

/* the instants of a task, in the order in which they were reported */
struct story {
	int n;
	struct pound_instant_of_task at[INSTANTS_MAX];
};

static void story_add(void *of, const struct pound_instant_of_task *instant)
{
	struct story *story = of;
	assert_true(story->n < INSTANTS_MAX);
	story->at[story->n++] = *instant;
}

static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
static struct story story, again;

static struct pound_task_result observe(struct pound_task task, int lanes, struct story *into)
{
	const struct pound_task_observer observer = {.observe = story_add, .into = into};
	struct pound_task_result result;
	into->n = 0;
	task.observer = &observer;
	assert_true(pound_exact_lanes(lanes, &task, &result, 1, scratch, NULL));
	return result;
}

static struct pound_task_result march(const struct pound_task *task)
{
	struct pound_task_result result;
	assert_true(pound_exact_lanes(0, task, &result, 1, scratch, NULL));
	return result;
}

static void an_isolated_impact_is_two_events(void **state)
{
	(void)state;
	for (int e = 1; e <= 100; e++) {
		const struct pound_task task = specimen_impact(e / 100.0, true, 100);
		observe(task, 0, &story);
		const double zeta = pound_contact_damping_ratio(0, e / 100.0);
		const double lasts = PI / sqrt(7.9e3 * 1.5 * (1 - zeta * zeta));
		int events = 0;
		double touching = 0;
		for (int i = 0; i < story.n; i++) {
			const struct pound_instant_of_task *now = &story.at[i];
			touching += i > 0 && story.at[i - 1].touching ? now->elapsed : 0;
			if (now->sampled)
				continue;
			// the bodies meet after 10 cm at 1.5 m/s, and separate with the restitution
			check_near(now->time, 0.1 / 1.5 + events * lasts, 1e-14);
			check_near(now->v[0] - now->v[1], events ? -1.5 * e / 100 : 1.5, 1e-12);
			check_near(now->overlap, 0, 0);
			assert_int_equal(now->touching, events == 0);
			events++;
		}
		assert_int_equal(events, 2);
		check_near(touching / lasts, 1, 1e-12);
	}
}

/* Every sample is reported, in order of time, and the elapsed times between two samples add up to the sample step. */
static void check_whole(const struct pound_task *task)
{
	const double h = task->time_step;
	int samples = 0;
	double elapsed = 0;
	for (int i = 0; i < story.n; i++) {
		const struct pound_instant_of_task *now = &story.at[i];
		assert_true(now->elapsed >= 0);
		elapsed += now->elapsed;
		// up to a few hundred steps, each with a rounding error of the remainder of the interval
		const double rounded = 1e-13 * h, time = samples > 0 ? (samples - 1) * h + elapsed : 0;
		check_near(now->time, time, rounded + 2 * DBL_EPSILON * time);
		if (!now->sampled || (samples > 0 && elapsed == 0))
			continue;
		check_near(elapsed, samples > 0 ? h : 0, rounded);
		check_near(now->time, samples * h, 0);
		check_near(now->ground, task->ground[samples], 0);
		elapsed = 0;
		samples++;
	}
	assert_int_equal(samples, task->n_samples);
}

static void instants_leave_no_hole(void **state)
{
	(void)state;
	for (int number = 0; number < 300; number++) {
		struct specimen specimen;
		// every other one is at rest in the end, and bodies in contact come to rest within an interval
		if (number % 2)
			specimen_creeping(&specimen, number, 1);
		else
			specimen_random(&specimen, number, 0.01, 401);
		const struct pound_task task = floor_task_task(&specimen, number % 10 != 8);
		assert_int_equal(observe(task, 0, &story).status, POUND_OK);
		check_whole(&task);
		specimen_free(&specimen);
	}
}

/* Bodies in contact at rest, before the ground moves and long after. */
static void instants_go_on_in_silence(void **state)
{
	(void)state;
	for (int wall = 0; wall < 2; wall++) {
		struct specimen specimen;
		specimen_init(&specimen);
		specimen.study.scene.oscillators[1].rigid_wall = wall;
		specimen.study.scene.contact.stiffness_ratio = 1e8;
		specimen.study.scene.contact.restitution = 0;
		specimen_record(&specimen, 0.1, 12001)[50] = -1;
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct pound_task_result r = observe(task, 0, &story);
		assert_int_equal(r.status, POUND_OK);
		check_near(r.u[0], 0, 0);
		check_whole(&task);
		specimen_free(&specimen);
	}
}

/* An observed task takes other steps, but has the same motion. */
static void an_observed_motion_is_that_of_the_unobserved(void **state)
{
	(void)state;
	int touched = 0, events = 0;
	for (int number = 0; number < 64; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct pound_task_result r = march(&task), o = observe(task, 0, &story);
		assert_int_equal(o.status, r.status);
		assert_int_equal(o.contacts, r.contacts);
		// in 4 s of impacts rounding errors of 1e-16 grow by orders of magnitude, but stay below this
		double size = fmax(r.displacement_max[0], 1e-3), touching = 0;
		check_near(o.impulse_max, r.impulse_max, 1e-9 * fmax(r.impulse_max, 1e-2));
		for (int i = 0; i < POUND_OSCILLATORS; i++) {
			check_near(o.u[i], r.u[i], 1e-9 * size);
			check_near(o.v[i], r.v[i], 1e-8 * size);
			check_near(o.displacement_max[i], r.displacement_max[i], 1e-9 * size);
			check_near(story.at[story.n - 1].u[i], o.u[i], 0);
		}
		for (int i = 1; i < story.n; i++) {
			touching += story.at[i - 1].touching ? story.at[i].elapsed : 0;
			events += !story.at[i].sampled;
		}
		check_near(touching, r.contact_time, 1e-9);
		touched += r.contacts > 0;
		specimen_free(&specimen);
	}
	assert_true(touched > 30 && events > 64 * 10);
}

/* The adaptive solver, which shares no step with the exact one: random scenes for 1 s, at 1e-12. */
static void an_observed_motion_is_that_of_the_adaptive_solver(void **state)
{
	(void)state;
	const struct pound_solver solver = {.tolerance = 1e-12};
	for (int number = 0; number < check_count(24, 240); number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 101);
		const struct pound_task task = floor_task_task(&specimen, true);
		struct pound_task_result a;
		pound_adaptive_run(&solver, &task, &a, NULL);
		assert_int_equal(a.status, POUND_OK);
		observe(task, 0, &story);
		const struct pound_instant_of_task *end = &story.at[story.n - 1];
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			check_near(end->u[i], a.u[i], 1e-9 * fmax(a.displacement_max[0], 1e-3));
		specimen_free(&specimen);
	}
}

/* ---- the same bits everywhere ---- */

static void check_same(const struct story *a, const struct story *b)
{
	assert_int_equal(a->n, b->n);
	for (int i = 0; i < a->n; i++) {
		const struct pound_instant_of_task *x = &a->at[i], *y = &b->at[i];
		assert_true(x->time == y->time && x->elapsed == y->elapsed && x->sampled == y->sampled);
		assert_true(x->touching == y->touching && x->ground == y->ground && x->slope == y->slope);
		assert_memory_equal(x->u, y->u, sizeof x->u);
		assert_memory_equal(x->v, y->v, sizeof x->v);
		assert_memory_equal(x->stiffness, y->stiffness, sizeof x->stiffness);
		assert_memory_equal(x->spring_offset, y->spring_offset, sizeof x->spring_offset);
		if (x->touching)
			assert_true(x->overlap == y->overlap && x->overlap_rate == y->overlap_rate);
	}
}

static void every_lane_count_reports_the_same_bits(void **state)
{
	(void)state;
	for (int number = 0; number < 40; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		const struct pound_task task = floor_task_task(&specimen, true);
		observe(task, 0, &story);
		for (int lanes = 1; lanes <= 8; lanes++) {
			struct pound_task_result none;
			if (!pound_exact_lanes(lanes, &task, &none, 0, scratch, NULL))
				continue;
			observe(task, lanes, &again);
			check_same(&story, &again);
		}
		specimen_free(&specimen);
	}
}

/* Some of many tasks are observed; one of these differs from its neighbor only by being observed. */
static void an_observer_changes_nothing_for_others_nor_they_for_it(void **state)
{
	(void)state;
	enum { TASKS = 40, OBSERVED = 4 };
	static struct story stories[OBSERVED];
	static struct specimen specimens[TASKS / 2];
	struct pound_task tasks[TASKS];
	struct pound_task_result with[TASKS], without[TASKS];
	struct pound_task_observer observers[OBSERVED];
	memset(with, 0, sizeof with);
	memset(without, 0, sizeof without);
	for (int t = 0; t < TASKS; t++) {
		if (t % 2 == 0)
			specimen_random(&specimens[t / 2], t, 0.01, 401);
		tasks[t] = floor_task_task(&specimens[t / 2], t % 8 > 1);
	}
	assert_true(pound_exact_lanes(0, tasks, without, TASKS, scratch, NULL));
	for (int k = 0; k < OBSERVED; k++) {
		stories[k].n = 0;
		observers[k] = (struct pound_task_observer){.observe = story_add, .into = &stories[k]};
		tasks[9 * k].observer = &observers[k];
	}
	assert_true(pound_exact_lanes(0, tasks, with, TASKS, scratch, NULL));
	for (int t = 0; t < TASKS; t++)
		if (!tasks[t].observer)
			assert_memory_equal(&with[t], &without[t], sizeof with[t]);
	for (int k = 0; k < OBSERVED; k++) {
		observe(tasks[9 * k], 0, &again);
		check_same(&stories[k], &again);
	}
	for (int s = 0; s < TASKS / 2; s++)
		specimen_free(&specimens[s]);
}

/* An observer that does not need every sample. */
struct short_story {
	struct story *story;
	double most[2];
	int n_passed;
};

static void raise_most(double most[2], const struct pound_instant_of_task *instant)
{
	const double p = instant->u[0] - instant->u[1];
	most[0] = fmax(most[0], p);
	most[1] = fmax(most[1], -p);
}

static void short_add(void *of, const struct pound_instant_of_task *instant)
{
	struct short_story *into = of;
	raise_most(into->most, instant);
	story_add(into->story, instant);
}

static void short_pass(void *of, const struct pound_instant_of_task *instant, int n)
{
	struct short_story *into = of;
	assert_true(n > 0 && instant->sampled && !instant->touching);
	into->n_passed += n - 1;
	story_add(into->story, instant);
}

static void what_is_passed_is_in_the_whole_story_and_nowhere_the_largest(void **state)
{
	int passed = 0, heard = 0;
	(void)state;
	for (int number = 0; number < 300; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		struct pound_task task = floor_task_task(&specimen, number % 3 != 0);
		for (int lanes = 1; lanes <= 8; lanes = lanes == 1 ? 4 : 2 * lanes) {
			struct pound_task_result result, same;
			struct short_story part = {.story = &again};
			const struct pound_task_observer observer = {
			    .observe = short_add, .into = &part, .most = part.most, .pass = short_pass};
			if (!pound_exact_lanes(lanes, &task, &result, 0, scratch, NULL))
				continue;
			memset(&result, 0, sizeof result);
			memset(&same, 0, sizeof same);
			task.observer = NULL;
			same = observe(task, lanes, &story);
			again.n = 0;
			task.observer = &observer;
			assert_true(pound_exact_lanes(lanes, &task, &result, 1, scratch, NULL));
			check_near(result.u[0], same.u[0], 0);
			check_near(result.v[1], same.v[1], 0);
			// the reported instants are a subsequence with equal bits, and `most` covers the omitted ones
			double most[2] = {0, 0};
			int k = 0;
			for (int i = 0; i < story.n; i++) {
				raise_most(most, &story.at[i]);
				if (k < again.n && again.at[k].time == story.at[i].time &&
				    again.at[k].sampled == story.at[i].sampled && again.at[k].u[0] == story.at[i].u[0] &&
				    again.at[k].v[1] == story.at[i].v[1] && again.at[k].ground == story.at[i].ground &&
				    again.at[k].slope == story.at[i].slope)
					k++;
			}
			assert_int_equal(k, again.n);
			assert_int_equal(again.n + part.n_passed, story.n);
			check_near(part.most[0], most[0], 0);
			check_near(part.most[1], most[1], 0);
			passed += part.n_passed;
			heard += again.n;
		}
		specimen_free(&specimen);
	}
	check_report("instants heard %d, passed %d", heard, passed);
	assert_true(passed > heard / 4);
}

CHECK_MAIN(cmocka_unit_test(what_is_passed_is_in_the_whole_story_and_nowhere_the_largest),
           cmocka_unit_test(an_isolated_impact_is_two_events), cmocka_unit_test(instants_leave_no_hole),
           cmocka_unit_test(instants_go_on_in_silence),
           cmocka_unit_test(an_observed_motion_is_that_of_the_unobserved),
           cmocka_unit_test(an_observed_motion_is_that_of_the_adaptive_solver),
           cmocka_unit_test(every_lane_count_reports_the_same_bits),
           cmocka_unit_test(an_observer_changes_nothing_for_others_nor_they_for_it))
