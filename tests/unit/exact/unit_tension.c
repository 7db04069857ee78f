/* unit_tension.c - contact without tension as defined in schema/study.md, against closed forms: when the force ends,
 * and when it returns.
 *
 * A constant acceleration a presses one body without spring and dashpot on a wall:
 *
 *   in contact   p'' = a - W^2 p - 2 zeta W p'        otherwise   p'' = a
 *
 * F/m = W^2 p + 2 zeta W p' falls to 0 while p > 0. */
#include <math.h>

#include "engine/scene/contact.h"
#include "engine/solver/solver.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

static const double PI = 3.14159265358979323846;
static const double W_CONTACT = 30, PUSH = 1.5, ZETA = 0.3,
                    AWAY = 0.02; /* [rad/s], [m/s2], 1, time before contact [s] */

enum { SAMPLES = 21 };
static double ground[SAMPLES];

struct motion {
	double p, q;
};

/* State after a time t of contact. */
static struct motion touching(struct motion from, double t)
{
	const double w = W_CONTACT, wd = w * sqrt(1 - ZETA * ZETA), rest = PUSH / (w * w);
	const double a = from.p - rest, b = (from.q + ZETA * w * a) / wd, fades = exp(-ZETA * w * t);
	const double c = cos(wd * t), s = sin(wd * t);
	return (struct motion){rest + fades * (a * c + b * s),
	                       fades * ((b * wd - ZETA * w * a) * c - (a * wd + ZETA * w * b) * s)};
}

static struct motion free_for(struct motion from, double t)
{
	return (struct motion){from.p + from.q * t + PUSH * t * t / 2, from.q + PUSH * t};
}

static double force(struct motion m)
{
	return W_CONTACT * W_CONTACT * m.p + 2 * ZETA * W_CONTACT * m.q;
}

/* Time at which the force of a contact that begins with speed v first falls to 0; NAN: never. */
static double release(double v)
{
	const struct motion start = {0, v};
	const double step = 1e-3 / W_CONTACT;
	for (int k = 1; k < 10000; k++)
		if (force(touching(start, k * step)) < 0) {
			double low = (k - 1) * step, high = k * step;
			for (int halving = 0; halving < 60; halving++) {
				double middle = (low + high) / 2;
				*(force(touching(start, middle)) < 0 ? &high : &low) = middle;
			}
			return low;
		}
	return NAN;
}

/* A body that meets the wall with speed v, until a given time. */
static struct pound_task task_of(double v, double until)
{
	for (int k = 0; k < SAMPLES; k++)
		ground[k] = -PUSH;
	const struct motion start = free_for((struct motion){0, v}, -AWAY);
	return (struct pound_task){.ground = ground,
	                           .n_samples = SAMPLES,
	                           .time_step = until / (SAMPLES - 1),
	                           .bodies = {{.drive = 1, .followed = true, .u = start.p, .v = start.q}},
	                           .contact = true,
	                           .contact_stiffness = W_CONTACT * W_CONTACT,
	                           .contact_damping = 2 * ZETA * W_CONTACT};
}

/* Checks the motion, the contacts and their time by the exact and the adaptive solver. */
static void check_solvers(const struct pound_task *task, struct motion end, int contacts, double time)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	static const int lanes[] = {0, 1};
	struct pound_task_result r;
	for (int k = 0; k < 2; k++) {
		assert_true(pound_exact_lanes(lanes[k], task, &r, 1, scratch, NULL));
		assert_int_equal(r.contacts, contacts);
		check_near(r.u[0], end.p, 1e-14);
		check_near(r.v[0], end.q, 1e-13);
		check_near(r.contact_time, time, 1e-13);
	}
	const struct pound_solver solver = {.tolerance = 1e-12};
	pound_adaptive_run(&solver, task, &r, NULL);
	assert_int_equal(r.contacts, contacts);
	check_near(r.u[0], end.p, 1e-10);
	check_near(r.contact_time, time, 1e-8);
}

static void contact_ends_when_its_force_falls_to_zero_with_an_overlap(void **state)
{
	(void)state;
	// an isolated impact: wd t = pi - 2 asin(zeta), where the overlap is v exp(-zeta W t) 2 zeta/W
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	for (int e = 1; e <= 100; e++) {
		const struct pound_task task = specimen_impact(e / 100.0, false, 1000);
		const double zeta = pound_contact_damping_ratio(0, e / 100.0);
		const double w = sqrt(task.contact_stiffness * (1 + task.mass_ratio)), wd = w * sqrt(1 - zeta * zeta);
		struct pound_task_result r;
		assert_true(pound_exact_lanes(0, &task, &r, 1, scratch, NULL));
		assert_int_equal(r.contacts, 1);
		check_near(r.contact_time, (PI - 2 * asin(zeta)) / wd, 1e-12);
	}
}

static void force_comes_back_when_it_would_push_or_when_parted_bodies_meet_again(void **state)
{
	(void)state;
	int stays = 0, returns = 0, clears = 0;
	// speeds in units of a/W: below 2 zeta the force would not fall at release, above 4 zeta the overlap ends first
	for (double speed = 0.5; speed < 6; speed += 0.0625) {
		const double w = W_CONTACT, v = speed * PUSH / w, ends = release(v);
		if (isnan(ends)) {
			const double time = 3 / w;
			const struct pound_task task = task_of(v, AWAY + time);
			check_solvers(&task, touching((struct motion){0, v}, time), 1, time);
			stays++;
			continue;
		}
		const struct motion parted = touching((struct motion){0, v}, ends);
		assert_true(parted.p > 0 && parted.q < 0);
		// separated, W^2 p + 2 zeta W p' = (W^2 q + 2 zeta W a) t + W^2 a t^2/2
		double away = -2 * (parted.q / PUSH + 2 * ZETA / w);
		struct motion again = free_for(parted, away);
		if (again.p > 0)
			returns++;
		else {
			// the overlap falls to 0 at the rate -(q^2 - 2 a p)^1/2, and rises through 0 at the opposite rate
			const double back = sqrt(parted.q * parted.q - 2 * PUSH * parted.p);
			away = (back - parted.q) / PUSH;
			again = (struct motion){0, back};
			clears++;
		}
		const double more = 0.1 / w;
		const struct motion end = touching(again, more);
		assert_true(force(end) > 0);
		const struct pound_task task = task_of(v, AWAY + ends + away + more);
		check_solvers(&task, end, 2, ends + more);
		// until then there is no force, though at first there is an overlap
		const struct pound_task between = task_of(v, AWAY + ends + 0.9 * away);
		check_solvers(&between, free_for(parted, 0.9 * away), 1, ends);
	}
	check_report("the force stays in %d cases, returns with an overlap in %d and without in %d", stays,
	             returns, clears);
	assert_true(stays > 0 && returns > 0 && clears > 0);
}

CHECK_MAIN(cmocka_unit_test(contact_ends_when_its_force_falls_to_zero_with_an_overlap),
           cmocka_unit_test(force_comes_back_when_it_would_push_or_when_parted_bodies_meet_again))
