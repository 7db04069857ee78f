/* unit_free_motion.c - maps over whole samples: bounds of the motion inside a sample, against maps over fractions of it. */
#include "tests/support/check.h"

#include <math.h>
#include <string.h>

// clang-format off
#include "engine/exact/simulation.inl"
#include "engine/exact/free_motion.inl"

#include "engine/exact/contact_substep.inl"
// clang-format on
#include "tests/support/scenes.h"

/* a body at the start of a sample of length h; `next` is the ground acceleration at its end */
struct sample {
	struct lanes g;
	double h, next;
};

/* A body with a sample of up to two radians, damped up to twice the critical damping. */
static struct sample sample_random(uint64_t *seed)
{
	struct sample s = {.h = 0.01, .next = specimen_uniform(seed, -0.5, 0.5)};
	const double radians = specimen_uniform(seed, 0, REACH_MAP), rest = REACH_MAP - radians;
	const double damping = specimen_uniform(seed, 0, fmin(4 * radians, rest));
	s.g.body[0].stiffness = radians * radians / (s.h * s.h);
	s.g.body[0].damping = damping / s.h;
	s.g.body[0].drive = 1;
	s.g.body[0].offset = specimen_uniform(seed, -0.5, 0.5);
	s.g.ground = specimen_uniform(seed, -0.5, 0.5);
	const double unit = 1 / fmax(s.g.body[0].stiffness, 1); // forcing and spring of equal size
	s.g.u[0] = unit * specimen_uniform(seed, -0.5, 0.5);
	s.g.v[0] = unit / s.h * specimen_uniform(seed, -0.5, 0.5);
	return s;
}

/* The motion after a fraction of the sample: displacement, velocity, and bounds in between. */
static struct cubic sample_move(const struct sample *s, double share)
{
	struct sample part = *s;
	struct pound_map map;
	map_fill(&map, s->g.body[0].stiffness, s->g.body[0].damping, share * s->h);
	memcpy(&part.g.map[0], &map, sizeof map);
	const struct free_map free = free_map_of(&part.g, 0);
	const double ground = s->g.ground, grown = share * (s->next - ground);
	const struct kinematics from = {s->g.u[0], s->g.v[0]},
	                        to = free_move(&free, from, ground, ground + grown);
	return cubic_of(&free, from, to, fabs(ground) + fabs(grown), share * s->h / 3);
}

enum { SAMPLES = 4000, PARTS = 16 };

static void the_cubic_misses_the_motion_by_no_more_than_its_error(void **state)
{
	(void)state;
	uint64_t seed = 1;
	double nearest = 0;
	for (int n = 0; n < SAMPLES; n++) {
		const struct sample s = sample_random(&seed);
		const struct cubic whole = sample_move(&s, 1);
		for (int j = 1; j < PARTS; j++) {
			const double t = (double)j / PARTS, b = 1 - t, u = sample_move(&s, t).u;
			const double cubic = b * b * b * s.g.u[0] + 3 * b * b * t * whole.b1 + 3 * b * t * t * whole.b2 +
			                     t * t * t * whole.u;
			// the error of the inner points raises the cubic by 3/4 of it in the middle
			const double lifted = 3 * t * b * whole.error;
			assert_true(fabs(u - cubic) <= lifted);
			nearest = fmax(nearest, fabs(u - cubic) / lifted);
		}
	}
	assert_true(nearest > 0.5); // otherwise the bound would be wider than necessary
}

static void no_velocity_inside_is_below_the_bound_of_it(void **state)
{
	(void)state;
	uint64_t seed = 2;
	double nearest = INFINITY;
	for (int n = 0; n < SAMPLES; n++) {
		const struct sample s = sample_random(&seed);
		const struct cubic whole = sample_move(&s, 1);
		const double third = s.h / 3;
		for (int way = -1; way <= 1; way += 2) {
			const double bound = cubic_slowest(s.g.v[0], &whole, third, way);
			for (int j = 1; j < PARTS; j++) {
				const double v = sample_move(&s, (double)j / PARTS).v;
				assert_true(way * third * v >= bound);
				nearest = fmin(nearest, (way * third * v - bound) / whole.error);
			}
		}
	}
	assert_true(nearest < 1);
}

/* The same motion by one sample and by two halves. */
static void two_halves_of_a_sample_are_the_whole(void **state)
{
	(void)state;
	uint64_t seed = 3;
	for (int n = 0; n < SAMPLES; n++) {
		struct sample s = sample_random(&seed);
		const struct cubic whole = sample_move(&s, 1), half = sample_move(&s, 0.5);
		const double h = s.h, unit = fabs(s.g.u[0]) + fabs(s.g.v[0]) * h + h * h;
		s.g.u[0] = half.u;
		s.g.v[0] = half.v;
		s.g.ground = 0.5 * (s.g.ground + s.next);
		s.h = 0.5 * h;
		const struct cubic rest = sample_move(&s, 1);
		check_near((rest.u - whole.u) / unit, 0, 16 * 2.2e-16);
		check_near((rest.v - whole.v) * h / unit, 0, 32 * 2.2e-16);
	}
}

/* With the velocity along - cos(phase), a body moves back for 2 acos(along) radians of the phase, by
 * 2 (sin a - a cos a). */
static void a_swing_that_is_just_ahead_takes_a_body_back_by_no_more_than_is_said(void **state)
{
	(void)state;
	for (int n = 0; n <= 200; n++) {
		const double share = pow(10, -0.06 * n), along = 1 - share, radian = 0.01 * (1 + n % 7);
		const double a = 2 * asin(sqrt(0.5 * share)); // acos(1 - share) to all digits
		const double way = a > 0.01 ? sin(a) - a * cos(a) : a * a * a * (1.0 / 3 - a * a / 30),
		             back = 2 * radian * way;
		// the fraction has the rounding error of `along`
		assert_false(sustained_steady(along, 1, 0, radian, 0.999 * back / SUSTAINED_ROUNDING));
		assert_true(sustained_steady(along, 1, 0, radian, 2 * back / SUSTAINED_ROUNDING));
		assert_true(sustained_steady(1 + share, 1, 0, radian, 0));
		assert_false(sustained_steady(-share, 1, 0, radian, 1));
	}
	assert_false(sustained_steady(0, 0, 0, 1, 1)); // at rest the velocity has no sign
	assert_false(sustained_steady(1, 1, NAN, 1, 1));
}

CHECK_MAIN(cmocka_unit_test(the_cubic_misses_the_motion_by_no_more_than_its_error),
           cmocka_unit_test(no_velocity_inside_is_below_the_bound_of_it),
           cmocka_unit_test(two_halves_of_a_sample_are_the_whole),
           cmocka_unit_test(a_swing_that_is_just_ahead_takes_a_body_back_by_no_more_than_is_said))
