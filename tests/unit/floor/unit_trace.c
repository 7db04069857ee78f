/* unit_trace.c - the trace against the march, which shares no code with it but the laws, and against known answers. */
#include <float.h>
#include <math.h>

#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

struct ended {
	struct pound_trace trace;
	int pieces, flights, turns;
	double time, gap; /* total of the steps; largest break between two pieces */
};

static struct pound_floor_stretch stretch;

/* A trace followed to its end; what it hands out is looked at for being without holes. */
static struct ended trace_to_end(const struct pound_march_task *task)
{
	struct ended e = {0};
	pound_trace_start(&e.trace, task);
	for (;;) {
		pound_trace_next(&e.trace, &stretch);
		if (stretch.n == 0)
			return e;
		for (int i = 0; i < stretch.n; i++) {
			const struct pound_floor_piece *p = &stretch.piece[i];
			e.gap = fmax(e.gap, fabs(p->start - e.time));
			e.time = p->start + p->step;
			e.pieces++;
			e.flights += p->map >= 0;
			e.turns += p->turned;
			assert_true(p->map < stretch.n_maps && stretch.n_maps <= POUND_FLOOR_MAPS);
			assert_true(p->step > 0);
		}
	}
}

static struct pound_march_result march(const struct pound_march_task *task)
{
	static _Alignas(64) char scratch[POUND_MARCH_SCRATCH];
	struct pound_march_result result;
	assert_true(pound_march_lanes(0, task, &result, 1, scratch, NULL));
	return result;
}

static void known_impacts_come_out_to_their_digits(void **state)
{
	(void)state;
	for (int k = 0; k < SPECIMEN_REFERENCES; k++) {
		const struct specimen_reference *reference = &specimen_references[k];
		struct specimen specimen;
		specimen_init(&specimen);
		specimen_reference(&specimen, reference, 0.0025);
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct ended e = trace_to_end(&task);
		assert_int_equal(e.trace.status, POUND_OK);
		assert_int_equal(e.trace.contacts, (int)reference->contacts);
		// the record is the half sine to (pi 0.005)^4/100 = 6e-10 of it
		check_near(e.trace.impulse_max, reference->impulse_max, 1e-8 * reference->impulse_max);
		check_near(e.trace.u[0], reference->end_u1, 1e-8);
		check_near(e.trace.u[1], reference->end_u2, 1e-8);
		specimen_free(&specimen);
	}
}

static void any_scene_moves_as_in_the_march(void **state)
{
	(void)state;
	int touched = 0, turned = 0;
	for (int number = 0; number < 64; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct pound_march_result r = march(&task);
		const struct ended e = trace_to_end(&task);
		assert_int_equal(e.trace.status, r.status);
		assert_int_equal(e.trace.contacts, r.contacts);
		// 4 s of impacts: roundings of 1e-16 grow by orders of magnitude, not to this
		double size = fmax(fabs(r.displacement_max[0]), 1e-3);
		check_near(e.trace.impulse_max, r.impulse_max, 1e-9 * fmax(r.impulse_max, 1e-2));
		check_near(e.trace.contact_time, r.contact_time, 1e-9);
		for (int i = 0; i < POUND_OSCILLATORS; i++) {
			check_near(e.trace.u[i], r.u[i], 1e-9 * size);
			check_near(e.trace.v[i], r.v[i], 1e-8 * size);
		}
		touched += r.contacts > 0;
		turned += e.turns > 2 * r.contacts;
		specimen_free(&specimen);
	}
	assert_true(touched > 30 && turned > 20);
}

/* Ten thousand radians of the contact go by in every sample in which the bodies stay pressed on each other. */
static void a_contact_that_has_settled_is_followed_by_whole_samples(void **state)
{
	(void)state;
	enum { SAMPLES = 301 };
	for (int wall = 0; wall < 2; wall++) {
		struct specimen specimen;
		specimen_init(&specimen);
		specimen.study.scene.contact.stiffness_ratio = 1e10;
		specimen.study.scene.contact.restitution = 0;
		specimen.study.scene.oscillators[1].rigid_wall = wall;
		double *ground = specimen_record(&specimen, 0.01, SAMPLES);
		for (int t = 0; t < SAMPLES; t++)
			ground[t] = -1;
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct pound_march_result r = march(&task);
		const struct ended e = trace_to_end(&task);
		assert_int_equal(e.trace.status, POUND_OK);
		assert_int_equal(e.trace.contacts, r.contacts);
		assert_true(r.contact_time > 0.1);
		assert_true(e.pieces < 10 * SAMPLES);
		check_near(e.trace.contact_time, r.contact_time, 1e-9);
		check_near(e.trace.impulse_max, r.impulse_max, 1e-9);
		check_near(e.trace.u[0], r.u[0], 1e-12);
		check_near(e.trace.v[0], r.v[0], 1e-11);
		specimen_free(&specimen);
	}
}

/* Its own swing never dies away, and is left out where it is a rounding of the bodies' motion. */
static void a_contact_without_losses_is_followed_however_stiff(void **state)
{
	(void)state;
	enum { SAMPLES = 100 };
	static const double stiffnesses[] = {1e8, 1e10, 1e12, 1e15, 1e20, 1e30};
	for (int k = 0; k < 6; k++) {
		struct specimen specimen;
		specimen_init(&specimen);
		specimen.study.scene.contact.stiffness_ratio = stiffnesses[k];
		specimen.study.scene.contact.restitution = 1;
		double *ground = specimen_record(&specimen, 0.01, SAMPLES);
		for (int t = 0; t < SAMPLES; t++)
			ground[t] = -fmin(1, t / 20.0);
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct pound_march_result r = march(&task);
		const struct ended e = trace_to_end(&task);
		assert_int_equal(r.status, POUND_OK);
		assert_int_equal(e.trace.status, POUND_OK);
		assert_int_equal(e.trace.contacts, r.contacts);
		check_near(e.trace.contact_time, r.contact_time, 1e-9);
		check_near(e.trace.impulse_max, r.impulse_max, 1e-9 * r.impulse_max);
		check_near(e.trace.u[0], r.u[0], 1e-12);
		check_near(e.trace.v[0], r.v[0], 1e-11);
		specimen_free(&specimen);
	}
}

/* A contact that has settled takes its bodies along, to the last rounding: else they turn where they do not. */
static void a_body_that_creeps_where_it_yielded_moves_as_in_the_march(void **state)
{
	(void)state;
	static const int vanishing[] = {2681, 2858}; // the squares of what is left of their velocities do
	for (int k = 0; k < 602; k++) {
		const int number = k < 600 ? k : vanishing[k - 600];
		struct specimen specimen;
		specimen_creeping(&specimen, number, 1);
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct pound_march_result r = march(&task);
		const struct ended e = trace_to_end(&task);
		if (e.trace.status != POUND_OK)
			fail_msg("creeping %d ends with: %s", number, pound_status_text(e.trace.status));
		check_near(e.trace.impulse_max, r.impulse_max, 1e-9 * r.impulse_max);
		specimen_free(&specimen);
	}
}

/* They go the same way but for roundings, and whether they touch the while is one of these. */
static void linear_bodies_alike_but_for_roundings_move_as_in_the_march(void **state)
{
	(void)state;
	for (int number = 0; number < 200; number++) {
		struct specimen specimen;
		specimen_alike(&specimen, number, 0);
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct pound_march_result r = march(&task);
		const struct ended e = trace_to_end(&task);
		assert_int_equal(r.status, POUND_OK);
		assert_int_equal(e.trace.status, POUND_OK);
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			check_near(e.trace.u[i], r.u[i], 1e-12 * r.displacement_max[i]); // 10 s of roundings
		specimen_free(&specimen);
	}
}

/* The trace counts the bodies' own damping in contact by a rule of its own. */
static void a_damped_body_pressed_on_a_wall_moves_as_in_the_march(void **state)
{
	(void)state;
	uint64_t seed = 3;
	for (int n = 0; n < 2000; n++) {
		const struct pound_march_task task = specimen_pressed(&seed);
		const double settled = 1 / (task.bodies[0].skeleton.stiffness + task.contact_stiffness);
		const struct ended e = trace_to_end(&task);
		check_near((e.trace.u[0] - march(&task).u[0]) / settled, 0, 64 * DBL_EPSILON);
	}
}

/* Past critical damping the faster of two roots sets the steps: 60 times as fast as the frequency, at most. */
static void a_contact_past_critical_damping_moves_as_in_the_march(void **state)
{
	(void)state;
	uint64_t seed = 9;
	for (int n = 0; n < 2000; n++) {
		struct pound_march_task task = specimen_pressed(&seed);
		const double settled = 1 / (task.bodies[0].skeleton.stiffness + task.contact_stiffness);
		task.contact_damping *= specimen_uniform(&seed, 1, 30);
		const struct ended e = trace_to_end(&task);
		check_near((e.trace.u[0] - march(&task).u[0]) / settled, 0, 64 * DBL_EPSILON);
	}
}

/* Bodies that all but stick to each other lose half of their motion in a second: minutes later there is nothing to follow. */
static void a_motion_that_dies_away_in_silence_is_over(void **state)
{
	(void)state;
	enum { SAMPLES = 33001 };
	struct specimen specimen;
	specimen_init(&specimen);
	specimen.study.scene.oscillators[0].frequency_hz = 2;
	specimen.study.scene.oscillators[1].frequency_hz = 3.1;
	specimen.study.scene.contact.stiffness_ratio = 1e8;
	specimen.study.scene.contact.restitution = 0;
	specimen_record(&specimen, 0.01, SAMPLES)[10] = -1;
	const struct pound_march_task task = riding_task(&specimen, true);
	const struct ended e = trace_to_end(&task);
	assert_int_equal(e.trace.status, POUND_OK);
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		assert_true(e.trace.u[i] == 0 && e.trace.v[i] == 0);
	specimen_free(&specimen);
}

static void pieces_follow_each_other_without_holes(void **state)
{
	(void)state;
	int flights = 0;
	for (int number = 0; number < 16; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		const struct pound_march_task task = riding_task(&specimen, true);
		const struct ended e = trace_to_end(&task);
		check_near(e.time, 4, 1e-12);
		check_near(e.gap, 0, 1e-12);
		assert_true(e.pieces >= 400);
		flights += e.flights;
		specimen_free(&specimen);
	}
	assert_true(flights > 16 * 100);
}

/* The floor's acceleration is the ground's and its own, u'' + a_g: integrated twice it gives the motion. */
static void the_acceleration_is_that_of_the_motion(void **state)
{
	(void)state;
	for (int number = 0; number < 8; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 201);
		const struct pound_march_task task = riding_task(&specimen, true);
		struct pound_trace trace;
		double v = 0, ground = 0, largest = 0; // integral of the floor's and of the ground's acceleration
		pound_trace_start(&trace, &task);
		for (pound_trace_next(&trace, &stretch); stretch.n; pound_trace_next(&trace, &stretch))
			for (int i = 0; i < stretch.n; i++) {
				const struct pound_floor_piece *p = &stretch.piece[i];
				double room[POUND_FLOOR_ORDER + 1];
				const double *a, damping = task.bodies[0].damping;
				const int order = pound_floor_drive(&stretch, p, POUND_DRIVE_FLOOR, damping, room, &a);
				for (int n = 0; n <= order; n++)
					v += p->step * a[n] / (n + 1);
				largest = fmax(largest, p->floor.bound[0]);
			}
		for (int t = 1; t < task.n_samples; t++)
			ground += 0.5 * task.time_step * (task.ground[t - 1] + task.ground[t]);
		check_near(v - ground, trace.v[0], 1e-12 * largest);
		specimen_free(&specimen);
	}
}

static void a_floor_without_contact_is_all_flight(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	specimen_noise(&specimen, 3, 1, 0.01, 401);
	const struct pound_march_task task = riding_task(&specimen, false);
	const struct ended e = trace_to_end(&task);
	assert_int_equal(e.flights, 400);
	assert_int_equal(e.pieces, 400);
	check_near(e.trace.u[0], march(&task).u[0], 1e-14); // 400 samples of 0.03 m
	specimen_free(&specimen);
}

/* A floor so stiff that a series does not reach over a sample goes on in shorter pieces. */
static void a_floor_too_fast_for_the_samples_is_followed(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	specimen.study.scene.oscillators[0].frequency_hz = 900;
	specimen_half_sine(&specimen, 1, 0.5, 1, 0.01);
	const struct pound_march_task task = riding_task(&specimen, false);
	const struct ended e = trace_to_end(&task);
	assert_true(e.flights == 0 && e.pieces >= 3770);
	check_near(e.trace.v[0], march(&task).v[0], 1e-15);
	specimen_free(&specimen);
}

/* Two bodies about the middle of a sample, A cos(w[0] (t - h/2)) and B cos(w[1] (t - h/2)), about where a constant ground
 * acceleration holds them.  At both ends of the sample the overlap stands still: the cubic through these is flat, and in the
 * middle the overlap is above it. */
static void bodies_that_meet_between_two_samples_only_are_not_flown_past_each_other(void **state)
{
	(void)state;
	uint64_t seed = 5;
	int bumps = 0;
	for (int n = 0; n < 1000; n++) {
		const double h = 0.01, w[2] = {specimen_uniform(&seed, 10, 100), specimen_uniform(&seed, 10, 100)};
		const double half[2] = {0.5 * h * w[0], 0.5 * h * w[1]}, square[2] = {w[0] * w[0], w[1] * w[1]};
		const double B = w[0] > w[1] ? 1 : -1, A = B * w[1] * sin(half[1]) / (w[0] * sin(half[0]));
		const double ends =
		    A * cos(half[0]) - B * cos(half[1]); // what the swings bring of the distance there
		const double bump = 2 * (A * pow(sin(0.5 * half[0]), 2) - B * pow(sin(0.5 * half[1]), 2));
		if (bump < 1e-9) // of motions as large as 1
			continue;
		bumps++;
		for (int meets = 0; meets < 2; meets++) {
			// the ground's acceleration shifts the overlap so that its ends are as near as this
			const double short_of = bump * (meets ? 0.5 : 2), gap = 1;
			const double a = (gap - short_of - ends) / (1 / square[1] - 1 / square[0]);
			const double ground[] = {a, a};
			struct pound_march_task task = {.ground = ground,
			                                .n_samples = 2,
			                                .time_step = h,
			                                .contact = true,
			                                .gap = gap,
			                                .contact_stiffness = 100 * square[0],
			                                .mass_ratio = 1,
			                                .tension = true};
			for (int i = 0; i < 2; i++)
				task.bodies[i] = (struct pound_march_body){.skeleton = {.stiffness = square[i]},
				                                           .u = (i ? B : A) * cos(half[i]) - a / square[i],
				                                           .v = (i ? B : A) * w[i] * sin(half[i]),
				                                           .drive = 1,
				                                           .followed = true};
			assert_int_equal(trace_to_end(&task).trace.contacts, meets);
			assert_int_equal(march(&task).contacts, meets);
		}
	}
	assert_true(bumps > 900);
}

/* A body that has yielded goes on as long as its velocity keeps its sign, which it may lose and have again between two
 * samples: white noise does that to it. */
static void a_body_that_turns_between_two_samples_moves_as_in_the_march(void **state)
{
	(void)state;
	enum { SAMPLES = 201, LAWS = 4 };
	uint64_t seed = 11;
	assert_non_null(pound_law_name(LAWS - 1));
	assert_null(pound_law_name(LAWS));
	for (int n = 0; n < 300; n++) {
		double ground[SAMPLES];
		for (int i = 0; i < SAMPLES; i++)
			ground[i] = specimen_uniform(&seed, -10, 10);
		const double k = specimen_uniform(&seed, 10, 100);
		struct pound_march_task task = {.ground = ground, .n_samples = SAMPLES, .time_step = 0.05};
		task.bodies[0] =
		    (struct pound_march_body){.skeleton = {.law = n % LAWS,
		                                           .stiffness = k,
		                                           .hardening = 0.1,
		                                           .yield = specimen_uniform(&seed, 0.001, 0.03)},
		                              .damping = specimen_uniform(&seed, 0, 1),
		                              .drive = 1,
		                              .followed = true};
		const struct ended e = trace_to_end(&task);
		const struct pound_march_result r = march(&task);
		check_near(e.trace.u[0], r.u[0], 1e-12 * r.displacement_max[0]);
		check_near(e.trace.v[0], r.v[0], 1e-12 * sqrt(k) * r.displacement_max[0]);
	}
}

static void terms_end_in_rounding(void **state)
{
	(void)state;
	for (double x = 1e-18; x <= 1.5; x *= 1.05) {
		int n = pound_floor_terms(x);
		assert_true(pow(x, n) / tgamma(n + 1) < 0x1p-53 && n <= POUND_FLOOR_TERMS);
		assert_true(n == 0 || pow(x, n - 1) / tgamma(n) > 0x1p-56);
	}
	assert_int_equal(pound_floor_terms(0), 0);
}

CHECK_MAIN(cmocka_unit_test(terms_end_in_rounding), cmocka_unit_test(known_impacts_come_out_to_their_digits),
           cmocka_unit_test(any_scene_moves_as_in_the_march),
           cmocka_unit_test(a_contact_that_has_settled_is_followed_by_whole_samples),
           cmocka_unit_test(a_contact_without_losses_is_followed_however_stiff),
           cmocka_unit_test(a_body_that_creeps_where_it_yielded_moves_as_in_the_march),
           cmocka_unit_test(linear_bodies_alike_but_for_roundings_move_as_in_the_march),
           cmocka_unit_test(a_damped_body_pressed_on_a_wall_moves_as_in_the_march),
           cmocka_unit_test(a_contact_past_critical_damping_moves_as_in_the_march),
           cmocka_unit_test(a_motion_that_dies_away_in_silence_is_over),
           cmocka_unit_test(pieces_follow_each_other_without_holes),
           cmocka_unit_test(the_acceleration_is_that_of_the_motion),
           cmocka_unit_test(a_floor_without_contact_is_all_flight),
           cmocka_unit_test(a_floor_too_fast_for_the_samples_is_followed),
           cmocka_unit_test(a_body_that_turns_between_two_samples_moves_as_in_the_march),
           cmocka_unit_test(bodies_that_meet_between_two_samples_only_are_not_flown_past_each_other))
