/* The engine's responses against closed forms and references, through pound.h alone. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

// relative to the largest value of the compared quantity: a few thousand steps of a few rounding errors each
static const double rounding = 1e-12;

/* Known answers: the half sine. */

static void the_half_sine_references_come_out(void **state)
{
	(void)state;
	for (int k = 0; k < SPECIMEN_REFERENCES; k++) {
		const struct specimen_reference *want = &specimen_references[k];
		struct specimen specimen;
		specimen_init(&specimen);
		// the record approximates the half sine to (pi 5e-4 / 0.5)^4 / 100 = 1e-12
		specimen_reference(&specimen, want, 5e-4);
		struct pound_response got = specimen_engine(&specimen);
		specimen_free(&specimen);
		// 12 digits printed; the oracle reproduces them to 1e-11
		assert_true(got.contact_count == want->contacts);
		check_near(got.displacement_max_1, want->u1_max, 1e-10 * want->u1_max);
		check_near(got.displacement_max_2, want->u2_max, 1e-10 * want->u2_max);
		check_near(got.impulse_max, want->impulse_max, 1e-10 * want->impulse_max);
		check_near(got.end_u1, want->end_u1, 1e-10 * want->u1_max);
		check_near(got.end_u2, want->end_u2, 1e-10 * want->u2_max);
	}
}

static void the_contacts_of_the_first_reference_last_as_long_as_known(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	specimen_reference(&specimen, &specimen_references[0], 5e-4);
	double together = .0116569436277 + .0113459956214 + .0114358134709 + .0115042978507 + .0114795325852 +
	                  .0118046420015 + .0116096075632;
	check_near(specimen_engine(&specimen).contact_time, together, 1e-11);
	// halfway between the start and the end of the first contact, and between the first two contacts
	specimen.study.scene.excitation.n_record = 1505;
	struct pound_response open = specimen_engine(&specimen);
	assert_true(open.contact_count == 1);
	check_near(open.contact_time, 1504 * 5e-4 - .746232167723, 1e-11);
	specimen.study.scene.excitation.n_record = 1751;
	check_near(specimen_engine(&specimen).contact_time, .0116569436277, 1e-11);
	specimen_free(&specimen);
}

static void the_half_sine_shock_spectrum_comes_out(void **state)
{
	(void)state;
	// pulse duration over period; largest pseudo-acceleration over the peak of the pulse; undamped
	static const double spectrum[][2] = {
	    {0.1, .396273548},      {0.25, .942809042}, {0.5, 1.570796327}, {0.75, 1.763355757},
	    {0.80994, 1.768457654}, {1, 1.732050808},   {1.5, 1.5},         {2, 1.268075355},
	    {3, 1.169913495},       {5, 1.099801602},
	};
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	scene->contact.present = false;
	scene->oscillators[0].damping_ratio = 0;
	for (size_t k = 0; k < sizeof spectrum / sizeof spectrum[0]; k++) {
		// 2000 samples in the pulse: (pi / 2000)^4 / 100 = 6e-14; then two periods
		specimen_half_sine(&specimen, 1, 1, ceil(1 + 2 / spectrum[k][0]), 5e-4);
		scene->oscillators[0].frequency_hz = spectrum[k][0];
		double w = 2 * pi * spectrum[k][0];
		check_near(w * w * specimen_engine(&specimen).displacement_max_1, spectrum[k][1], 0.6e-9);
	}
	specimen_free(&specimen);
}

static void an_oscillator_under_sampled_force_follows_the_textbook(void **state)
{
	(void)state;
	struct specimen specimen;
	for (int t = 1; t <= SPECIMEN_TEXTBOOK; t++) {
		specimen_textbook(&specimen, t);
		check_near(specimen_engine(&specimen).end_u1, specimen_textbook_u[t - 1], 0.5001e-4);
		specimen_free(&specimen);
	}
}

/* One impact. */

/* A mass on a spring of negligible stiffness ((2 pi 1e-7 Hz 1 s)^2 = 4e-13) gets a velocity of 1 m/s from a triangle
 * of ground acceleration and meets the wall in free motion. */
static double rebound(double restitution, bool tension, double *duration)
{
	enum { SAMPLES = 101 };
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	double k = 3 * pow(2e-7 * pi, 2);
	scene->oscillators[0] = (struct pound_oscillator){.mass = 3, .frequency_hz = 1e-7};
	scene->oscillators[1].rigid_wall = true;
	scene->contact.restitution = restitution;
	scene->contact.tension = tension;
	scene->contact.stiffness_ratio = 1e4 / k;
	scene->contact.gap = 0.2;
	double *a = specimen_record(&specimen, 0.01, SAMPLES);
	a[1] = -100;
	struct pound_response r = specimen_engine(&specimen);
	specimen_free(&specimen);
	assert_true(r.contact_count == 1);
	check_near(r.impulse_max, 3 * (1 - r.end_v1), 1e-11);
	*duration = r.contact_time * sqrt(1e4 / 3);
	return -r.end_v1;
}

static void an_isolated_impact_leaves_with_restitution_times_the_approach_speed(void **state)
{
	(void)state;
	for (int tenth = 1; tenth <= 10; tenth++) {
		double eps = tenth / 10.0, duration, l = log(eps), xi = -l / hypot(pi, l);
		check_near(rebound(eps, true, &duration), eps, rounding + 4e-13);
		check_near(duration, pi / sqrt(1 - xi * xi), 1e-10);
	}
}

static void a_contact_that_cannot_pull_leaves_with_the_known_higher_speeds(void **state)
{
	(void)state;
	static const double rebounds[] = {.135335283, .252729380, .324862848, .397140500, .472013980, .550283170,
	                                  .632290516, .718201361, .808099335, .902026069, 1};
	for (int tenth = 0; tenth <= 10; tenth++) {
		double eps = tenth / 10.0, duration, l = log(eps), xi = tenth ? -l / hypot(pi, l) : 1;
		check_near(rebound(eps, false, &duration), rebounds[tenth], 0.51e-9);
		double want = tenth ? (pi - 2 * asin(xi)) / sqrt(1 - xi * xi) : 2;
		check_near(duration, want, 1e-10);
	}
}

static void a_plastic_impact_that_may_pull_stops_the_body(void **state)
{
	(void)state;
	double duration, v = rebound(0, true, &duration);
	check_near(v, 0, rounding);
	// critically damped, p = v t exp(-w t): the oscillator's spring, 2e-17 of the contact's, ends the contact late
	assert_true(duration > 30);
}

/* With zero gap the wall only makes the oscillator stiffer and more damped while u > 0, so every half cycle is a
 * damped half sine of its own frequency.  The state after the pulse is computed by the engine in a shorter run. */
static void a_wall_without_gap_is_touched_every_two_half_swings(void **state)
{
	(void)state;
	enum { FROM = 31, TO = 401 };
	static const double restitutions[] = {0.1, 0.6, 0.95, 1};
	for (int k = 0; k < 4; k++) {
		struct specimen specimen;
		specimen_init(&specimen);
		struct pound_scene *scene = &specimen.study.scene;
		scene->oscillators[1].rigid_wall = true;
		scene->contact.restitution = restitutions[k];
		scene->contact.stiffness_ratio = 1000;
		double *a = specimen_record(&specimen, 0.01, TO);
		a[1] = 100;
		struct pound_response end = specimen_engine(&specimen);
		scene->excitation.n_record = FROM;
		struct pound_response free_motion = specimen_engine(&specimen);
		specimen_free(&specimen);
		assert_true(free_motion.contact_count == 0 && free_motion.end_u1 < 0);

		double w = 2 * pi, xi = 0.05, wd = w * sqrt(1 - xi * xi), l = log(restitutions[k]);
		double w2 = w * sqrt(1001), xi2 = (xi * w - l / hypot(pi, l) * sqrt(1000) * w) / w2;
		double apart = pi / wd, together = pi / (w2 * sqrt(1 - xi2 * xi2));
		double slower = exp(-pi * xi / sqrt(1 - xi * xi)), slower2 = exp(-pi * xi2 / sqrt(1 - xi2 * xi2));
		// u = e^(-xi w t) (u0 cos + s sin): rises through 0 at wd t = atan2(-u0, s)
		double s = (free_motion.end_v1 + xi * w * free_motion.end_u1) / wd,
		       to = atan2(-free_motion.end_u1, s) / wd;
		double t = (FROM - 1) * 0.01 + to, v = exp(-xi * w * to) * hypot(free_motion.end_u1, s) * wd;
		double impulse = 1000 / 1001.0 * v * (1 + slower2);
		int contacts = 0;
		while (t + together < (TO - 1) * 0.01) {
			contacts++;
			t += together + apart;
			v *= slower * slower2;
		}
		t -= apart;
		v /= slower;
		double left = (TO - 1) * 0.01 - t;
		assert_true(left > 0 && left < apart);
		assert_true(end.contact_count == contacts && contacts >= 3);
		check_near(end.contact_time, contacts * together, rounding);
		check_near(end.impulse_max, impulse, rounding * impulse);
		check_near(end.end_u1, -v / wd * exp(-xi * w * left) * sin(wd * left), rounding);
		check_near(end.end_v1, -v * exp(-xi * w * left) * (cos(wd * left) - xi * w / wd * sin(wd * left)),
		           rounding * w);
	}
}

/* The laws.  An undamped oscillator of period 1 at rest gets the velocity v0 from a triangle of ground acceleration
 * two samples wide; its linear response afterwards is that to an impulse at the middle of the triangle, times
 * sinc^2(w step / 2). */

enum { PULSE_STEPS_PER_SECOND = 1000 };

struct push {
	double v0;     // [m/s] at `start`
	double start;  // [s]
	double energy; // v0^2 / w^2, twice the energy over k
};

static struct push pushed(struct specimen *specimen, const char *law, double demand, double duration)
{
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	scene->contact.present = false;
	scene->oscillators[0].damping_ratio = 0;
	specimen_law(specimen, law, 0.01);
	int n = (int)lround(duration * PULSE_STEPS_PER_SECOND) + 1;
	double step = duration / (n - 1), w = 2 * pi, x = w * step / 2, mu = demand - 1;
	// the v0 that leads to a displacement of demand times the yield displacement
	struct push push = {.start = step, .energy = 1e-4 * (1 + 2 * mu + 0.05 * mu * mu)};
	push.v0 = w * sqrt(push.energy);
	double *a = specimen_record(specimen, step, n);
	a[1] = -push.v0 / step / (sin(x) / x * (sin(x) / x));
	return push;
}

static void a_push_reaches_the_displacement_of_its_energy(void **state)
{
	(void)state;
	static const char *const laws[] = {"elastoplastic", "nonlinear_elastic", "origin_oriented"};
	static const double demands[] = {1.5, 2, 3, 5, 10};
	for (int l = 0; l < 3; l++) {
		for (int k = 0; k < 5; k++) {
			struct specimen specimen;
			pushed(&specimen, laws[l], demands[k], 0.9);
			struct pound_response r = specimen_engine(&specimen);
			specimen_free(&specimen);
			check_near(r.demand_1, demands[k], rounding * demands[k]);
			check_near(r.demand_free_1, demands[k], rounding * demands[k]);
			check_near(r.displacement_max_1, 0.01 * demands[k], rounding * 0.01 * demands[k]);
			check_near(r.yield_displacement_1, 0.01, 0);
		}
	}
}

static void a_nonlinear_elastic_oscillator_swings_in_its_lengthened_period(void **state)
{
	(void)state;
	static const double demands[] = {1.5, 2, 3, 5, 10};
	static const double periods[] = {1.128116229, 1.270272291, 1.512377218, 1.874464551, 2.439072811};
	for (int k = 0; k < 5; k++) {
		// the run ends one period after the middle of the pulse, which is one step after time 0
		double duration = periods[k];
		int steps = (int)lround(duration * PULSE_STEPS_PER_SECOND);
		struct specimen specimen;
		struct push push = pushed(&specimen, "nonlinear_elastic", demands[k], duration * (steps + 1) / steps);
		assert_int_equal(specimen.study.scene.excitation.n_record, steps + 2);
		struct pound_response r = specimen_engine(&specimen);
		specimen_free(&specimen);
		// the periods are printed to 1e-9
		check_near(r.end_u1, 0, push.v0 * 1e-9);
		check_near(r.end_v1, push.v0, rounding * push.v0);
	}
}

/* Time from the pulse to the largest displacement: a segment of a sine, then a segment of a cosine about 1 - 1/r. */
static double time_to_reversal(double demand, double r)
{
	double mu = demand - 1, centre = 1 - 1 / r;
	return (asin(1 / sqrt(1 + 2 * mu + r * mu * mu)) + acos((1 - centre) / (demand - centre)) / sqrt(r)) /
	       (2 * pi);
}

static void an_elastoplastic_oscillator_turns_back_with_its_first_stiffness(void **state)
{
	(void)state;
	struct specimen specimen;
	struct push push = pushed(&specimen, "elastoplastic", 2, 0.65);
	struct pound_response r = specimen_engine(&specimen);
	specimen_free(&specimen);
	// from u = 2 yield displacements, released by the force 1.05 k yield, with the first stiffness until 2 yield
	// displacements back
	double w = 2 * pi, angle = w * (0.65 - push.start - time_to_reversal(2, 0.05));
	double force = 0.01 * 1.05, back = force * (1 - cos(angle));
	assert_true(angle > pi / 2 && back < 0.02);
	check_near(r.end_u1, 0.02 - back, rounding);
	check_near(r.end_v1, -w * force * sin(angle), rounding * w);
}

/* Every velocity reversal of a decaying oscillation loses half a loop; in the end it oscillates elastically about a
 * position that the loops have shifted.  The loop to demand 2 dissipates 2 (1 - r) (mu - 1) per yielding stroke. */
static void a_yielding_stroke_loses_the_area_of_half_a_loop(void **state)
{
	(void)state;
	struct specimen specimen;
	struct push push = pushed(&specimen, "elastoplastic", 2, 0.65);
	struct pound_response r = specimen_engine(&specimen);
	specimen_free(&specimen);
	// during unloading, still elastic: energy of the springs k2 and k - k2 of the parallel model, over k/2
	double u = r.end_u1, v = r.end_v1 / (2 * pi), slider = 0.01;
	double energy = v * v + 0.05 * u * u + 0.95 * (u - slider) * (u - slider);
	assert_true(u - slider > -0.01);
	check_near((push.energy - energy) / 1e-4 / 2, 0.95 * (2 - 1), 1e-10);
}

// an origin-oriented oscillator whose pulse leads to twice its yield displacement, some time after the middle of the pulse
static struct pound_response pushed_to_two(double after)
{
	// the middle of the pulse is one step after time 0
	int steps = (int)lround(after * PULSE_STEPS_PER_SECOND);
	struct specimen specimen;
	pushed(&specimen, "origin_oriented", 2, after * (steps + 1) / steps);
	struct pound_response r = specimen_engine(&specimen);
	specimen_free(&specimen);
	return r;
}

static void an_origin_oriented_oscillator_loses_energy_on_the_first_push_only(void **state)
{
	(void)state;
	// to the largest displacement, then along the secant to the origin: a quarter of the period of the secant stiffness
	double w = 2 * pi, secant = 1.05 / 2, quarter = 0.25 / sqrt(secant);
	double at_origin = time_to_reversal(2, 0.05) + quarter;
	struct pound_response r = pushed_to_two(at_origin);
	check_near(r.end_u1, 0, rounding);
	check_near(r.end_v1, -w * 0.02 * sqrt(secant), rounding * w);
	// of 1/2 + 1 + r/2, in units of k times the squared yield displacement
	check_near(1.525 - pow(r.end_v1 / w / 0.01, 2) / 2, 0.475, 1e-10);

	// the other side is undamaged: the remaining energy, 2.1, leads to the demand at which 1 + 2 mu + r mu^2 = 2.1
	double mu = (sqrt(1 + 0.05 * 1.1) - 1) / 0.05, demand = 1 + mu,
	       at_other_side = at_origin + time_to_reversal(demand, 0.05);
	r = pushed_to_two(at_other_side);
	check_near(r.end_u1, -0.01 * demand, rounding);
	check_near(r.end_v1, 0, 1e-11);

	// from there it oscillates along the two secants: a period later it is back, without energy loss
	double quarter_other = 0.25 / sqrt((1 + 0.05 * mu) / demand), other = 0.01 * demand;
	double secant_other = (1 + 0.05 * mu) / demand, far = other * sqrt(secant_other / secant);
	r = pushed_to_two(at_other_side + 2 * quarter_other + 2 * quarter);
	assert_true(far < 0.02);
	check_near(r.end_u1, -other, rounding);
	check_near(r.end_v1, 0, 1e-11);
}

/* Two oscillators. */

static void equal_oscillators_never_press_on_each_other(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	specimen_noise(&specimen, 3, 1, 0.01, 501);
	scene->oscillators[1].frequency_hz = scene->oscillators[0].frequency_hz;
	for (int k = 0; k < SPECIMEN_LAWS; k++) {
		scene->law.type = k;
		scene->oscillators[1].mass = (double[]){1, 0.3, 7, 2}[k % 4];
		scene->contact.restitution = (double[]){0, 0.4, 1, 0.6}[k % 4];
		struct pound_response r = specimen_engine(&specimen);
		check_near(r.impulse_max, 0, 0);
		check_near(r.displacement_max_1, r.displacement_max_free_1, 0);
		check_near(r.displacement_max_2, r.displacement_max_free_2, 0);
		check_near(r.displacement_max_1, r.displacement_max_2, 1e-15);
	}
	specimen_free(&specimen);
}

/* Identical bodies never press on each other; for nearly identical ones the impulse is proportional to the detuning. */
static void nearly_equal_oscillators_nearly_never_press_on_each_other(void **state)
{
	(void)state;
	for (int k = 0; k < 2 * SPECIMEN_LAWS; k++) {
		struct specimen specimen;
		specimen_init(&specimen);
		struct pound_scene *scene = &specimen.study.scene;
		specimen_noise(&specimen, 7, 1, 0.01, 501);
		specimen_law(&specimen, specimen_laws[k / 2], 0);
		scene->contact.tension = k % 2;
		double f = scene->oscillators[0].frequency_hz;
		double impulse[3];
		for (int d = 0; d < 3; d++) {
			scene->oscillators[1].frequency_hz = f * (1 + (double[]){0, 1e-10, 1e-8}[d]);
			impulse[d] = specimen_engine(&specimen).impulse_max;
		}
		specimen_free(&specimen);
		check_near(impulse[0], 0, 0);
		check_near(impulse[2] / impulse[1], 100, 0.1);
	}
}

static void a_gap_that_is_never_reached_leaves_both_free(void **state)
{
	(void)state;
	for (int l = 0; l < SPECIMEN_LAWS; l++) {
		struct specimen specimen;
		specimen_init(&specimen);
		struct pound_scene *scene = &specimen.study.scene;
		specimen_noise(&specimen, 4, 1, 0.01, 501);
		specimen_law(&specimen, specimen_laws[l], 0);
		scene->contact.gap = 10;
		struct pound_response far = specimen_engine(&specimen);
		scene->contact.present = false;
		struct pound_response none = specimen_engine(&specimen);
		specimen_free(&specimen);
		check_near(far.contact_count, 0, 0);
		check_near(far.impulse_max, 0, 0);
		check_near(far.contact_time, 0, 0);
		check_near(far.displacement_max_1, far.displacement_max_free_1, 0);
		check_near(far.displacement_max_2, far.displacement_max_free_2, 0);
		check_near(far.displacement_max_1, none.displacement_max_1, 0);
		check_near(far.end_v2, none.end_v2, 0);
	}
}

/* The largest gap that is reached is found by bisection: just below it there is one light contact, just above it none. */
static void a_gap_is_touched_exactly_when_the_free_responses_close_it(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	specimen_noise(&specimen, 4, 1, 0.01, 501);
	double touched = 0, open = 1;
	for (int k = 0; k < 60; k++) {
		scene->contact.gap = (touched + open) / 2;
		*(specimen_engine(&specimen).contact_count > 0 ? &touched : &open) = scene->contact.gap;
	}
	assert_true(touched > 0.001);
	scene->contact.gap = touched * (1 - 1e-9);
	struct pound_response light = specimen_engine(&specimen);
	check_near(light.contact_count, 1, 0);
	assert_true(light.impulse_max > 0);
	check_near(light.displacement_max_1, light.displacement_max_free_1, 1e-4 * light.displacement_max_1);
	// p'' from a parabola through the contact: 1e-9 gap deep; at least half of 2 sqrt(2 depth / p''), p'' < 10 m/s2
	assert_true(light.contact_time > 2 * sqrt(2e-9 * touched / 10) * 0.5);
	specimen_free(&specimen);
}

/* From rest with zero gap the softer body moves farther against the ground: by a difference of damping with the third
 * power of time, by a difference of stiffness with the fourth; one power more if the ground acceleration starts from
 * zero. */
static void bodies_that_touch_at_rest_press_on_each_other_from_the_first_moment(void **state)
{
	(void)state;
	enum { LEFT_SOFTER = 1, FORWARD = 2, UNDAMPED = 4, FROM_ZERO = 8, CASES = 16 };
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	for (int k = 0; k < CASES; k++) {
		scene->oscillators[0].frequency_hz = k & LEFT_SOFTER ? 1 : 3;
		scene->oscillators[1].frequency_hz = k & LEFT_SOFTER ? 3 : 1;
		scene->oscillators[0].damping_ratio = scene->oscillators[1].damping_ratio = k & UNDAMPED ? 0 : 0.05;
		double *a = specimen_record(&specimen, 0.01, 4);
		for (int t = 0; t < 4; t++)
			a[t] = (k & FORWARD ? 1 : -1) * (k & FROM_ZERO ? t : 1);
		struct pound_response got = specimen_engine(&specimen);
		struct pound_response want = specimen_oracle(&specimen, 0.002);
		bool closes = !(k & LEFT_SOFTER) != !(k & FORWARD);
		check_near(got.contact_count, closes, 0);
		check_near(got.contact_time, closes ? 0.03 : 0, rounding);
		check_near(got.impulse_max, want.impulse_max, 1e-9 * want.impulse_max);
		check_near(got.end_u1, want.end_u1, 1e-10 * fabs(want.end_u1));
		check_near(got.end_u2, want.end_u2, 1e-10 * fabs(want.end_u2));
	}
	specimen_free(&specimen);
}

static void elastic_impacts_of_undamped_oscillators_keep_the_energy(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	scene->oscillators[0].damping_ratio = scene->oscillators[1].damping_ratio = 0;
	scene->oscillators[1].mass = 2;
	scene->contact.restitution = 1;
	double *a = specimen_record(&specimen, 0.01, 1001);
	a[1] = a[2] = -20;
	double w1 = 2 * pi, w2 = 5 * pi, energy = 0;
	for (int n = 4; n <= 1001; n += 997) {
		scene->excitation.n_record = n;
		struct pound_response r = specimen_engine(&specimen);
		double p = fmax(0, r.end_u1 - r.end_u2);
		double now = pow(r.end_v1, 2) + 2 * pow(r.end_v2, 2) + pow(w1 * r.end_u1, 2) +
		             2 * pow(w2 * r.end_u2, 2) + 200 * pow(w2 * p, 2);
		if (energy > 0) {
			assert_true(r.contact_count > 5);
			check_near(now, energy, rounding * energy);
		}
		energy = now;
	}
	specimen_free(&specimen);
}

CHECK_MAIN(cmocka_unit_test(the_half_sine_references_come_out),
           cmocka_unit_test(the_contacts_of_the_first_reference_last_as_long_as_known),
           cmocka_unit_test(the_half_sine_shock_spectrum_comes_out),
           cmocka_unit_test(an_oscillator_under_sampled_force_follows_the_textbook),
           cmocka_unit_test(an_isolated_impact_leaves_with_restitution_times_the_approach_speed),
           cmocka_unit_test(a_contact_that_cannot_pull_leaves_with_the_known_higher_speeds),
           cmocka_unit_test(a_plastic_impact_that_may_pull_stops_the_body),
           cmocka_unit_test(a_wall_without_gap_is_touched_every_two_half_swings),
           cmocka_unit_test(a_push_reaches_the_displacement_of_its_energy),
           cmocka_unit_test(a_nonlinear_elastic_oscillator_swings_in_its_lengthened_period),
           cmocka_unit_test(an_elastoplastic_oscillator_turns_back_with_its_first_stiffness),
           cmocka_unit_test(a_yielding_stroke_loses_the_area_of_half_a_loop),
           cmocka_unit_test(an_origin_oriented_oscillator_loses_energy_on_the_first_push_only),
           cmocka_unit_test(equal_oscillators_never_press_on_each_other),
           cmocka_unit_test(nearly_equal_oscillators_nearly_never_press_on_each_other),
           cmocka_unit_test(a_gap_that_is_never_reached_leaves_both_free),
           cmocka_unit_test(a_gap_is_touched_exactly_when_the_free_responses_close_it),
           cmocka_unit_test(bodies_that_touch_at_rest_press_on_each_other_from_the_first_moment),
           cmocka_unit_test(elastic_impacts_of_undamped_oscillators_keep_the_energy))
