/* unit_floor_pieces.c - the pieces of a floor's motion: each ends in the state where the next begins, by Newton's
 * law; and known answers. */
#include <float.h>
#include <math.h>

#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

static struct pound_floor_stretch stretch;

/* a task followed to its end, and totals over its pieces */
struct followed {
	const struct pound_task *task;
	struct pound_task_result result;
	enum pound_status status; /* status of the pieces */
	int pieces, maps, events, touching;
	double time, gap;       /* total of the steps; largest time between two pieces [s] */
	double impulse, pushed; /* largest impulse of a contact, and impulse of the current one [m/s] */
	double largest;         /* largest acceleration [m/s2] */
	struct {
		double u, v; /* end state of the preceding piece [m], [m/s] */
	} next;
	double u_error, v_error; /* largest error of a piece's start [m], [m/s] */
	double u_top, v_top;     /* largest displacement and speed */
};

/* The ground's acceleration at a time, from the sample interval that contains another time. */
static double ground_at(const struct pound_task *task, double time, double within)
{
	int k = (int)fmin(within / task->time_step, task->n_samples - 2);
	const double *a = &task->ground[k];
	return a[0] + (a[1] - a[0]) * (time / task->time_step - k);
}

/* A piece begins where the preceding one ends, except for rounding errors and neglected oscillations.
 *
 *   u'' = a - g    a  the floor's absolute acceleration, a polynomial;  g  the ground's acceleration, linear in time
 */
static void piece_follow(struct followed *f, double start, double u, double v)
{
	f->u_top = fmax(f->u_top, fabs(u));
	f->v_top = fmax(f->v_top, fabs(v));
	f->gap = fmax(f->gap, fabs(start - f->time));
	if (f->pieces == 0)
		return;
	f->u_error = fmax(f->u_error, fabs(u - f->next.u));
	f->v_error = fmax(f->v_error, fabs(v - f->next.v));
}

static void contact_end(struct followed *f)
{
	f->impulse = fmax(f->impulse, f->pushed);
	f->pushed = 0;
}

static void pieces_take(void *of)
{
	struct followed *f = of;
	const struct pound_task *task = f->task;
	assert_true(stretch.n_maps <= POUND_FLOOR_MAPS);
	for (int i = 0; i < stretch.n; i++) {
		const struct pound_floor_piece *p = &stretch.piece[i];
		const double damping = task->bodies[0].damping, drive = task->bodies[0].drive;
		double room[2][POUND_FLOOR_ROOM], sums[2][2] = {{0}};
		assert_true(p->step > 0 && p->map < stretch.n_maps);
		piece_follow(f, p->start, p->u, p->v);
		for (int d = 0; d < POUND_DRIVES; d++) {
			const double *a;
			const int order = pound_floor_drive(&stretch, p, d, damping, room[d], &a);
			for (int n = order; n >= 0; n--) {
				sums[d][0] += a[n] / (n + 1);
				sums[d][1] += a[n] / ((n + 1.0) * (n + 2));
			}
		}
		const double middle = p->start + 0.5 * p->step, h = p->step;
		const double g0 = ground_at(task, p->start, middle), g1 = ground_at(task, p->start + h, middle);
		f->next.u = p->u + h * (p->v + h * (sums[0][1] - drive * (g0 / 3 + g1 / 6)));
		f->next.v = p->v + h * (sums[0][0] - drive * 0.5 * (g0 + g1));
		f->largest = fmax(f->largest, p->floor.bound[0]);
		const bool touches = p->push.bound[0] > 0;
		if (!touches)
			contact_end(f);
		f->pushed -= h * sums[1][0];
		f->touching += touches;
		f->maps += p->map >= 0;
		f->events += p->after_event;
		f->time = p->start + p->step;
		f->pieces++;
	}
}

static void follow(struct followed *f, const struct pound_task *task)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	*f = (struct followed){.task = task};
	struct pound_floor_motion motion = {
	    .task = task, .stretch = &stretch, .taker = {pieces_take, f}, .pushed = true};
	const struct pound_task_observer observer = {.observe = pound_floor_observe, .into = &motion};
	struct pound_task observed = *task;
	observed.observer = &observer;
	pound_floor_start(&motion);
	assert_true(pound_exact_lanes(0, &observed, &f->result, 1, scratch, NULL));
	pieces_take(f);
	contact_end(f);
	piece_follow(f, f->time, f->result.u[0], f->result.v[0]);
	f->status = motion.status;
}

/* Follows a task and checks that each of its pieces leads to the next.
 *
 * Given    tolerance  of displacement and velocity, relative to the largest of each
 */
static struct followed check_followed(const struct pound_task *task, double tolerance)
{
	struct followed f;
	follow(&f, task);
	assert_int_equal(f.status, POUND_OK);
	assert_int_equal(f.result.status, POUND_OK);
	const double end = (task->n_samples - 1) * task->time_step;
	check_near(f.time, end, f.pieces * DBL_EPSILON * end);
	check_near(f.gap, 0, f.pieces * DBL_EPSILON * end);
	// A body at rest in sustained contact has accelerations that cancel except for rounding errors; the contact's own
	// oscillation is neglected if its velocity is below 2^-48 of what these accelerations add in a radian of the
	// bodies' motion.  Here the ground acceleration is evaluated at times with a rounding error.
	double rate = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		rate = fmax(rate, fmax(sqrt(task->bodies[i].backbone.stiffness), task->bodies[i].damping));
	const double still = 4 * f.largest * (DBL_EPSILON * end + 0x1p-48 / rate);
	check_near(f.u_error, 0, tolerance * f.u_top + still * task->time_step);
	check_near(f.v_error, 0, tolerance * f.v_top + still);
	return f;
}

static void known_impacts_come_out_to_their_digits(void **state)
{
	(void)state;
	for (int k = 0; k < SPECIMEN_REFERENCES; k++) {
		const struct specimen_reference *reference = &specimen_references[k];
		struct specimen specimen;
		specimen_init(&specimen);
		specimen_reference(&specimen, reference, 0.0025);
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct followed f = check_followed(&task, 1e-13);
		assert_int_equal(f.result.contacts, (int)reference->contacts);
		// the record approximates the half sine to (pi 0.005)^4/100 = 6e-10
		check_near(f.impulse, reference->impulse_max, 1e-8 * reference->impulse_max);
		check_near(f.next.u, reference->end_u1, 1e-8);
		specimen_free(&specimen);
	}
}

static void every_piece_leads_to_the_next(void **state)
{
	(void)state;
	int touched = 0, events = 0, maps = 0;
	for (int number = 0; number < check_count(200, 2000); number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct followed f = check_followed(&task, 1e-12);
		check_near(f.impulse, f.result.impulse_max, 1e-12 * f.result.impulse_max);
		assert_true(f.pieces >= 400);
		touched += f.touching > 0;
		events += f.events;
		maps += f.maps;
		specimen_free(&specimen);
	}
	assert_true(touched > 100 && events > 200 * 10 && maps > 200 * 100);
}

/* Every sample of sustained contact takes ten thousand radians of the contact. */
static void a_quasi_static_contact_is_followed_by_whole_samples(void **state)
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
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct followed f = check_followed(&task, 1e-12);
		assert_true(f.result.contact_time > 0.1);
		assert_true(f.pieces < 10 * SAMPLES);
		check_near(f.impulse, f.result.impulse_max, 1e-12 * f.result.impulse_max);
		specimen_free(&specimen);
	}
}

/* The contact's own oscillation never decays; it is neglected where it is a rounding error of the bodies' motion. */
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
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct followed f = check_followed(&task, 1e-12);
		check_near(f.impulse, f.result.impulse_max, 1e-12 * f.result.impulse_max);
		specimen_free(&specimen);
	}
}

/* A large oscillation without energy loss is followed, unless it needs so many pieces that it would take hours. */
static void a_swing_that_takes_too_many_pieces_ends_as_chatter(void **state)
{
	(void)state;
	// the contact force starts at once, and the contact oscillates about it; the force grows, so the contact does not open
	static const double ground[] = {-0.01, -0.31, -0.61, -0.91};
	struct followed f;
	for (int stiff = 0; stiff < 2; stiff++) {
		// a thousand and a million cycles in a sample, each of four pieces or more
		const double k = 40;
		const struct pound_task task = {
		    .ground = ground,
		    .n_samples = 4,
		    .time_step = 0.1,
		    .bodies = {{.backbone = {.stiffness = k}, .damping = 0.6, .drive = 1}},
		    .contact = true,
		    .contact_stiffness = (stiff ? 1e14 : 1e8) * k,
		    .tension = true};
		follow(&f, &task);
		assert_int_equal(f.result.status, POUND_OK);
		assert_int_equal(f.result.contacts, 1);
		check_near(f.result.contact_time, 0.3, 1e-15);
		assert_int_equal(f.status, stiff ? POUND_CHATTER : POUND_OK);
		assert_true(f.pieces > 3000);
	}
}

/* In quasi-static contact a creeping body moves the other one. */
static void a_body_that_creeps_where_it_yielded_is_followed(void **state)
{
	(void)state;
	static const int vanishing[] = {2681, 2858}; // the squares of their remaining velocities underflow
	for (int k = 0; k < 602; k++) {
		struct specimen specimen;
		specimen_creeping(&specimen, k < 600 ? k : vanishing[k - 600], 1);
		const struct pound_task task = floor_task_task(&specimen, true);
		const struct followed f = check_followed(&task, 1e-12);
		check_near(f.impulse, f.result.impulse_max, 1e-9 * f.result.impulse_max);
		specimen_free(&specimen);
	}
}

/* The bodies move alike except for rounding errors, which decide whether they touch meanwhile. */
static void bodies_alike_but_for_roundings_are_followed(void **state)
{
	(void)state;
	for (int number = 0; number < 200; number++) {
		struct specimen specimen;
		specimen_alike(&specimen, number, number % SPECIMEN_LAWS);
		const struct pound_task task = floor_task_task(&specimen, true);
		check_followed(&task, 1e-12);
		specimen_free(&specimen);
	}
}

/* Beyond critical damping of the contact the faster of two decay rates sets the steps: at most 60 times the frequency. */
static void a_damped_body_pressed_on_a_wall_is_followed(void **state)
{
	(void)state;
	uint64_t seed = 3;
	for (int n = 0; n < 4000; n++) {
		struct pound_task task = specimen_pressed(&seed);
		if (n >= 2000)
			task.contact_damping *= specimen_uniform(&seed, 1, 30);
		check_followed(&task, 1e-13);
	}
}

/* Bodies in almost plastic contact lose half of their motion in a second: after minutes no motion remains to be followed. */
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
	const struct pound_task task = floor_task_task(&specimen, true);
	const struct followed f = check_followed(&task, 1e-11);
	check_near(f.next.u, 0, 0);
	check_near(f.next.v, 0, 0);
	specimen_free(&specimen);
}

/* From rest under a constant acceleration an undamped floor moves as 1 - cos. */
static void a_floor_without_contact_is_all_free_motion(void **state)
{
	(void)state;
	enum { SAMPLES = 401 };
	static double ground[SAMPLES];
	for (int t = 0; t < SAMPLES; t++)
		ground[t] = -1;
	const double w = 10, h = 0.01;
	const struct pound_task task = {.ground = ground,
	                                .n_samples = SAMPLES,
	                                .time_step = h,
	                                .bodies = {{.backbone = {.stiffness = w * w}, .drive = 1}}};
	const struct followed f = check_followed(&task, 1e-14);
	assert_int_equal(f.maps, 400);
	assert_int_equal(f.pieces, 400);
	check_near(f.next.u, (1 - cos(w * 400 * h)) / (w * w), 400 * DBL_EPSILON / w);
	check_near(f.largest, 2, 0.15); // an upper bound: w^2 u by the magnitudes of its terms
}

/* If a floor is so stiff that a series does not cover a sample, shorter pieces follow it. */
static void a_floor_too_fast_for_the_samples_is_followed(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	specimen.study.scene.oscillators[0].frequency_hz = 900;
	specimen_half_sine(&specimen, 1, 0.5, 1, 0.01);
	const struct pound_task task = floor_task_task(&specimen, false);
	const struct followed f = check_followed(&task, 1e-12);
	assert_true(f.maps == 0 && f.pieces >= 3770);
	specimen_free(&specimen);
}

/* A yielded body stays on its branch as long as its velocity keeps its sign; under white noise the velocity may
 * change its sign twice between two samples. */
static void a_body_that_turns_between_two_samples_is_followed(void **state)
{
	(void)state;
	enum { SAMPLES = 201 };
	uint64_t seed = 11;
	for (int n = 0; n < 300; n++) {
		double ground[SAMPLES];
		for (int i = 0; i < SAMPLES; i++)
			ground[i] = specimen_uniform(&seed, -10, 10);
		struct pound_task task = {.ground = ground, .n_samples = SAMPLES, .time_step = 0.05};
		task.bodies[0] = (struct pound_task_body){.backbone = {.law = n % SPECIMEN_LAWS,
		                                                       .stiffness = specimen_uniform(&seed, 10, 100),
		                                                       .hardening = 0.1,
		                                                       .yield = specimen_uniform(&seed, 0.001, 0.03)},
		                                          .damping = specimen_uniform(&seed, 0, 1),
		                                          .drive = 1,
		                                          .followed = true};
		check_followed(&task, 1e-13);
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
           cmocka_unit_test(every_piece_leads_to_the_next),
           cmocka_unit_test(a_quasi_static_contact_is_followed_by_whole_samples),
           cmocka_unit_test(a_contact_without_losses_is_followed_however_stiff),
           cmocka_unit_test(a_swing_that_takes_too_many_pieces_ends_as_chatter),
           cmocka_unit_test(a_body_that_creeps_where_it_yielded_is_followed),
           cmocka_unit_test(bodies_alike_but_for_roundings_are_followed),
           cmocka_unit_test(a_damped_body_pressed_on_a_wall_is_followed),
           cmocka_unit_test(a_motion_that_dies_away_in_silence_is_over),
           cmocka_unit_test(a_floor_without_contact_is_all_free_motion),
           cmocka_unit_test(a_floor_too_fast_for_the_samples_is_followed),
           cmocka_unit_test(a_body_that_turns_between_two_samples_is_followed))
