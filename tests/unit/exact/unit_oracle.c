/* The oracle against closed forms and answers by other programs, before tests use it as a reference. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

// half a unit of the last of so many decimals
static double half_digit(int digits)
{
	return 0.5 * pow(10, -digits) * 1.001;
}

static struct pound_response respond(const struct specimen *specimen, double radians,
                                     const struct oracle_start *start, struct oracle_trace *trace)
{
	const struct pound_excitation *e = &specimen->study.scene.excitation;
	const struct oracle_motion motion = {e->time_step, e->n_record, e->record};
	const struct oracle_method method = {.radians = radians, .located = true};
	return oracle_response(&specimen->study.scene, &motion, &method, start, trace);
}

/* Two bodies of 1 and 3 kg on springs of negligible stiffness ((2 pi 1e-6 Hz 0.1 s)^2 = 4e-13); one of them moves at
 * 1 m/s when they collide. */
static double rebound(double restitution, bool tension, double *duration)
{
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	for (int body = 0; body < 2; body++) {
		scene->oscillators[body].frequency_hz = 1e-6;
		scene->oscillators[body].damping_ratio = 0;
	}
	scene->oscillators[1].mass = 3;
	scene->contact.restitution = restitution;
	scene->contact.tension = tension;
	scene->contact.stiffness_ratio = 1e4 / (3 * pow(2e-6 * pi, 2));
	specimen_record(&specimen, 0.1, 2);
	struct oracle_trace trace;
	respond(&specimen, 0.002, &(struct oracle_start){.v1 = 1}, &trace);
	specimen_free(&specimen);
	assert_int_equal(trace.n_contacts, 1);
	*duration = trace.contacts[0].duration * sqrt(1e4 / 0.75);
	return trace.contacts[0].departure / trace.contacts[0].speed;
}

static void an_isolated_impact_leaves_with_restitution_times_the_approach_speed(void **state)
{
	(void)state;
	// xi of equation (2), known answers
	static const double xi[] = {1,          .591155034, .455949811, .357857131, .279997993, .215453762,
	                            .160493047, .112808451, .070850300, .033518449, 0};
	for (int tenth = 1; tenth <= 10; tenth++) {
		double duration, eps = tenth / 10.0;
		check_near(rebound(eps, true, &duration), eps, 1e-11);
		check_near(duration, pi / sqrt(1 - xi[tenth] * xi[tenth]), 1e-8);
	}
}

static void a_contact_that_cannot_pull_leaves_faster(void **state)
{
	(void)state;
	static const double rebounds[] = {.135335283, .252729380, .324862848, .397140500, .472013980, .550283170,
	                                  .632290516, .718201361, .808099335, .902026069, 1};
	for (int tenth = 0; tenth <= 10; tenth++) {
		double duration;
		check_near(rebound(tenth / 10.0, false, &duration), rebounds[tenth], half_digit(9) + 1e-11);
	}
}

/* With zero gap the wall only makes the oscillator stiffer and more damped while u > 0, so every half cycle is a
 * damped half sine of its own frequency. */
static void a_wall_without_gap_is_touched_every_two_half_swings(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	scene->oscillators[1].rigid_wall = true;
	specimen_record(&specimen, 0.1, 41);
	struct oracle_trace trace;
	respond(&specimen, 0.002, &(struct oracle_start){.u1 = 0, .v1 = -1}, &trace);
	specimen_free(&specimen);

	double w = 2 * pi, l = log(0.6), c = 2 * -l / hypot(pi, l) * 10 * w;
	double w_touching = w * sqrt(101), xi = 0.05, xi_touching = (2 * xi * w + c) / (2 * w_touching);
	double apart = pi / (w * sqrt(1 - xi * xi));
	double together = pi / (w_touching * sqrt(1 - xi_touching * xi_touching));
	double slower = exp(-pi * xi / sqrt(1 - xi * xi));
	double slower_touching = exp(-pi * xi_touching / sqrt(1 - xi_touching * xi_touching));
	assert_int_equal(trace.n_contacts, 7);
	double start = apart, speed = slower;
	for (int k = 0; k < trace.n_contacts; k++) {
		const struct oracle_contact *contact = &trace.contacts[k];
		check_near(contact->start, start, 1e-11);
		check_near(contact->duration, together, 1e-11);
		check_near(contact->speed, speed, 1e-11 * speed);
		check_near(contact->departure, speed * slower_touching, 1e-11 * speed);
		// for F = K u + C u' and m u'' + (c + C) u' + (k + K) u = 0
		check_near(contact->impulse, 100.0 / 101.0 * speed * (1 + slower_touching), 1e-11 * speed);
		start += apart + together;
		speed *= slower * slower_touching;
	}
}

/* A rigid wall at D below the amplitude, no damping: the next impact follows after (2/w)(pi - atan2(v+/w, D)).  A
 * contact spring of stiffness ratio R takes (pi/w) R^-1/2 and is compressed by (v/w) R^-1/2, so the error is of order
 * R^-1/2. */
static void a_wall_with_a_gap_tends_to_the_rigid_one_as_the_root_of_its_stiffness(void **state)
{
	(void)state;
	double missed[2], w = 2 * pi, gap = 0.05, v0 = 0.8;
	for (int k = 0; k < 2; k++) {
		struct specimen specimen;
		specimen_init(&specimen);
		struct pound_scene *scene = &specimen.study.scene;
		scene->oscillators[0].damping_ratio = 0;
		scene->oscillators[1].rigid_wall = true;
		scene->contact.gap = gap;
		scene->contact.stiffness_ratio = k ? 1e6 : 1e4;
		specimen_record(&specimen, 0.1, 41);
		struct oracle_trace trace;
		respond(&specimen, 0.005, &(struct oracle_start){.u1 = gap, .v1 = v0}, &trace);
		specimen_free(&specimen);
		assert_true(trace.n_contacts > 2);
		double speed = 0.6 * v0;
		check_near(trace.contacts[1].speed, speed, 0.1 * speed);
		check_near(trace.contacts[2].speed, 0.6 * speed, 0.1 * speed);
		double later = 2 / w * (pi - atan2(speed / w, gap));
		missed[k] = fabs(trace.contacts[1].start - trace.contacts[0].start - later);
	}
	check_near(missed[0] / missed[1], 10, 0.5);
}

static void elastic_impacts_keep_the_energy(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	scene->oscillators[0].damping_ratio = scene->oscillators[1].damping_ratio = 0;
	scene->contact.restitution = 1;
	specimen_record(&specimen, 0.1, 101);
	struct pound_response r = respond(&specimen, 0.002, &(struct oracle_start){.v1 = 1}, NULL);
	specimen_free(&specimen);
	double w1 = 2 * pi, w2 = 5 * pi, p = r.end_u1 - r.end_u2;
	double energy = pow(r.end_v1, 2) + pow(r.end_v2, 2) + pow(w1 * r.end_u1, 2) + pow(w2 * r.end_u2, 2) +
	                (p > 0 ? 100 * pow(w2 * p, 2) : 0);
	assert_true(r.contact_count > 5);
	check_near(energy, 1, 1e-10);
}

static void the_references_come_out_to_their_printed_digits(void **state)
{
	(void)state;
	for (int k = 0; k < SPECIMEN_REFERENCES; k++) {
		const struct specimen_reference *reference = &specimen_references[k];
		struct specimen specimen;
		specimen_init(&specimen);
		specimen_reference(&specimen, reference, 5e-4);
		struct oracle_trace trace;
		struct pound_response r = respond(&specimen, 0.002, NULL, &trace);
		struct pound_response coarse = respond(&specimen, 0.004, NULL, NULL);
		specimen_free(&specimen);
		// 12 digits are printed; the record approximates the half sine to (pi 5e-4 / 0.5)^4 / 100 = 1e-12
		double printed = 1e-11;
		assert_int_equal(trace.n_contacts, reference->contacts);
		check_near(trace.contacts[0].start, reference->first_start, 5e-11);
		check_near(trace.contacts[0].speed, reference->first_speed, 1e-11);
#define REFERENCE(member, want) \
	check_near(r.member, want, printed *fabs(want) + fabs(r.member - coarse.member))
		REFERENCE(displacement_max_1, reference->u1_max);
		REFERENCE(displacement_max_2, reference->u2_max);
		REFERENCE(impulse_max, reference->impulse_max);
		REFERENCE(end_u1, reference->end_u1);
		REFERENCE(end_u2, reference->end_u2);
#undef REFERENCE
	}
}

static void every_contact_of_the_first_reference_comes_out(void **state)
{
	(void)state;
	// start, duration, impulse
	static const double contacts[7][3] = {
	    {.746232167723, .0116569436277, .236645435429},  {1.00555613394, .0113459956214, .0803750337661},
	    {1.42405893989, .0114358134709, .0789711479962}, {1.72261890828, .0115042978507, .0570627266994},
	    {2.16971578449, .0114795325852, .0295766271256}, {2.39045173829, .0118046420015, .0283303638476},
	    {2.90362072457, .0116096075632, .0242515847423},
	};
	struct specimen specimen;
	specimen_init(&specimen);
	specimen_reference(&specimen, &specimen_references[0], 5e-4);
	struct oracle_trace trace;
	respond(&specimen, 0.002, NULL, &trace);
	specimen_free(&specimen);
	for (int k = 0; k < 7; k++) {
		check_near(trace.contacts[k].start, contacts[k][0], 1e-11);
		check_near(trace.contacts[k].duration, contacts[k][1], 1e-12);
		check_near(trace.contacts[k].impulse, contacts[k][2], 1e-12);
	}
}

static void an_oscillator_under_a_half_sine_force_follows_the_textbook(void **state)
{
	(void)state;
	// for linear interpolation between the samples, and for the half sine
	static const double smooth[] = {.0328,  .2332, .6487, 1.1605, 1.5242,
	                                1.4814, .9245, .0593, -.7752, -1.2718};
	struct specimen specimen;
	for (int t = 1; t <= SPECIMEN_TEXTBOOK; t++) {
		specimen_textbook(&specimen, t);
		check_near(respond(&specimen, 0.005, NULL, NULL).end_u1, specimen_textbook_u[t - 1], half_digit(4));
		specimen_half_sine(&specimen, -10 / 0.2533, 0.6, t < 6 ? 0.6 : t / 10.0, 1e-3);
		specimen.study.scene.excitation.n_record = 100 * t + 1;
		check_near(respond(&specimen, 0.005, NULL, NULL).end_u1, smooth[t - 1], half_digit(4));
		specimen_free(&specimen);
	}
}

// work done on a law (k = 1, yield 1) along straight paths between reversals
static double work(struct oracle_law *law, const double *turns, int n)
{
	enum { STEPS = 1000 };
	long double sum = 0;
	for (int k = 0; k + 1 < n; k++) {
		long double h = ((long double)turns[k + 1] - turns[k]) / STEPS;
		for (int i = 0; i < STEPS; i++) {
			long double u = turns[k] + h * i;
			sum += h / 2 * oracle_law_force(law, u);
			oracle_law_settle(law, u + h);
			sum += h / 2 * oracle_law_force(law, u + h);
		}
	}
	return (double)sum;
}

static void an_elastoplastic_loop_has_the_area_of_its_parallelogram(void **state)
{
	(void)state;
	struct oracle_law law = oracle_law("elastoplastic", 1, 0.05, 1);
	work(&law, (double[]){0, 2, -2, 2}, 4);
	check_near(work(&law, (double[]){2, -2, 2}, 3), 3.8, 1e-12);
	check_near(work(&law, (double[]){2, -2, 2}, 3), 3.8, 1e-12);
}

static void an_origin_oriented_law_loses_energy_on_the_first_push_only(void **state)
{
	(void)state;
	struct oracle_law law = oracle_law("origin_oriented", 1, 0.05, 1);
	check_near(work(&law, (double[]){0, 2, 0}, 3), 0.475, 1e-12);
	check_near(work(&law, (double[]){0, 2, 0}, 3), 0, 1e-12);
	// the other side has not been reached yet
	check_near((double)oracle_law_force(&law, -1), -1, 1e-15);
	check_near(work(&law, (double[]){0, -2, 0}, 3), 0.475, 1e-12);
}

/* Free period of a nonlinear elastic oscillator (initial period 1, yield 1) over its initial one: a quarter is a
 * segment of a sine up to the yield displacement and a segment of a cosine about 1 - 1/r beyond. */
static double lengthened_period(double mu, double r)
{
	double v0 = sqrt(1 + 2 * (mu - 1) + r * (mu - 1) * (mu - 1)), centre = 1 - 1 / r;
	return 2 / pi * (asin(1 / v0) + acos((1 - centre) / (mu - centre)) / sqrt(r));
}

static void a_nonlinear_elastic_oscillator_swings_in_its_lengthened_period(void **state)
{
	(void)state;
	static const double demands[] = {1.5, 2, 3, 5, 10};
	static const double periods[] = {1.128116229, 1.270272291, 1.512377218, 1.874464551, 2.439072811};
	struct oracle_law law = oracle_law("nonlinear_elastic", 1, 0.05, 1);
	check_near(work(&law, (double[]){0, 2, -2, 0}, 4), 0, 1e-12);

	struct specimen specimen;
	specimen_init(&specimen);
	struct pound_scene *scene = &specimen.study.scene;
	scene->contact.present = false;
	scene->oscillators[0].damping_ratio = 0;
	specimen_law(&specimen, "nonlinear_elastic", 1);
	for (int k = 0; k < 5; k++) {
		double period = lengthened_period(demands[k], 0.05);
		check_near(period, periods[k], 1e-9);
		specimen_record(&specimen, period / 10, 11);
		struct pound_response r = respond(&specimen, 0.002, &(struct oracle_start){.u1 = demands[k]}, NULL);
		check_near(r.end_u1, demands[k], 1e-11 * demands[k]);
		check_near(r.end_v1, 0, 1e-11 * 2 * pi * demands[k]);
	}
	specimen_free(&specimen);
}

static void a_pounding_specimen(struct specimen *specimen, const char *law)
{
	specimen_init(specimen);
	specimen_law(specimen, law, 0);
	specimen_noise(specimen, 7, 1, 0.01, 301);
}

static void the_error_falls_with_the_fourth_power_of_the_step(void **state)
{
	(void)state;
	for (int k = 0; k < SPECIMEN_LAWS; k++) {
		struct specimen specimen;
		a_pounding_specimen(&specimen, specimen_laws[k]);
		struct pound_response a = specimen_oracle(&specimen, 0.04);
		struct pound_response b = specimen_oracle(&specimen, 0.02);
		struct pound_response c = specimen_oracle(&specimen, 0.01);
		specimen_free(&specimen);
		assert_true(c.contact_count > 3);
		// 16, with a tolerance of 4 for the next power of the step
		check_near((a.impulse_max - b.impulse_max) / (b.impulse_max - c.impulse_max), 16, 4);
	}
}

static void locating_nothing_gives_the_same_answers_in_the_limit(void **state)
{
	(void)state;
	for (int k = 0; k < SPECIMEN_LAWS; k++) {
		struct specimen specimen;
		a_pounding_specimen(&specimen, specimen_laws[k]);
		struct pound_response want = specimen_oracle(&specimen, 0.005);
		const struct pound_excitation *e = &specimen.study.scene.excitation;
		const struct oracle_motion motion = {e->time_step, e->n_record, e->record};
		double missed[2];
		for (int fine = 0; fine < 2; fine++) {
			const struct oracle_method method = {.radians = fine ? 0.002 : 0.02};
			struct pound_response got = oracle_response(&specimen.study.scene, &motion, &method, NULL, NULL);
			assert_true(got.contact_count == want.contact_count);
			missed[fine] = fabs(got.impulse_max / want.impulse_max - 1) +
			               fabs(got.displacement_max_1 / want.displacement_max_1 - 1) +
			               fabs(got.displacement_max_2 / want.displacement_max_2 - 1);
		}
		specimen_free(&specimen);
		// a contact begins and ends up to one step of pi / 0.002 late; later contacts amplify the error
		assert_true(missed[1] < 0.002);
		assert_true(missed[1] < missed[0]);
	}
}

static void the_yield_displacement_is_the_elastic_one_over_the_reduction_factor(void **state)
{
	(void)state;
	struct specimen specimen;
	a_pounding_specimen(&specimen, "elastoplastic");
	struct pound_scene *scene = &specimen.study.scene;
	scene->law.corrections = 0;
	scene->law.target_demand = 3;
	struct pound_response plain = specimen_oracle(&specimen, 0.01);
	specimen_law(&specimen, "linear", 0);
	struct pound_response linear = specimen_oracle(&specimen, 0.01);
	check_near(plain.yield_displacement_1, linear.displacement_max_free_1 / 3, 1e-12);
	check_near(plain.yield_displacement_2, linear.displacement_max_free_2 / 3, 1e-12);
	assert_true(isnan(linear.yield_displacement_1) && isnan(linear.demand_2));

	// Figure 3: from 1 at f_e = 0 to mu_d at f_e = f / 6; the motion is still the record
	specimen_law(&specimen, "elastoplastic", 0);
	while (strcmp(pound_excitation_name(scene->excitation.type), "kanai_tajimi") != 0)
		scene->excitation.type--;
	scene->excitation.frequency_hz = 0.25;
	struct pound_response slow = specimen_oracle(&specimen, 0.01);
	specimen_free(&specimen);
	check_near(slow.yield_displacement_1, linear.displacement_max_free_1 / 3, 1e-12);
	check_near(slow.yield_displacement_2, linear.displacement_max_free_2 / 2.2, 1e-12);
}

static void a_correction_divides_the_largest_displacement_by_the_target(void **state)
{
	(void)state;
	for (int k = 1; k < SPECIMEN_LAWS; k++) {
		struct specimen specimen;
		a_pounding_specimen(&specimen, specimen_laws[k]);
		struct pound_scene *scene = &specimen.study.scene;
		scene->law.corrections = 0;
		struct pound_response before = specimen_oracle(&specimen, 0.01);
		scene->law.corrections = 1;
		struct pound_response after = specimen_oracle(&specimen, 0.01);
		check_near(after.yield_displacement_1, before.displacement_max_free_1 / 2, 1e-12);
		check_near(after.yield_displacement_2, before.displacement_max_free_2 / 2, 1e-12);
		check_near(after.demand_free_1, after.displacement_max_free_1 / after.yield_displacement_1, 1e-12);
		specimen_free(&specimen);
	}
}

static void equal_oscillators_never_press_on_each_other(void **state)
{
	(void)state;
	struct specimen specimen;
	a_pounding_specimen(&specimen, "linear");
	struct pound_scene *scene = &specimen.study.scene;
	scene->oscillators[1].frequency_hz = scene->oscillators[0].frequency_hz;
	scene->oscillators[1].mass = 3;
	struct pound_response r = specimen_oracle(&specimen, 0.01);
	specimen_free(&specimen);
	// penetrations of long double rounding (0.1 m times 1e-18 per step, 5000 steps) on a spring of 1e4 N/m
	check_near(r.impulse_max, 0, 1e-11);
	check_near(r.displacement_max_1, r.displacement_max_2, 1e-14);
}

CHECK_MAIN(cmocka_unit_test(an_isolated_impact_leaves_with_restitution_times_the_approach_speed),
           cmocka_unit_test(a_contact_that_cannot_pull_leaves_faster),
           cmocka_unit_test(a_wall_without_gap_is_touched_every_two_half_swings),
           cmocka_unit_test(a_wall_with_a_gap_tends_to_the_rigid_one_as_the_root_of_its_stiffness),
           cmocka_unit_test(elastic_impacts_keep_the_energy),
           cmocka_unit_test(the_references_come_out_to_their_printed_digits),
           cmocka_unit_test(every_contact_of_the_first_reference_comes_out),
           cmocka_unit_test(an_oscillator_under_a_half_sine_force_follows_the_textbook),
           cmocka_unit_test(an_elastoplastic_loop_has_the_area_of_its_parallelogram),
           cmocka_unit_test(an_origin_oriented_law_loses_energy_on_the_first_push_only),
           cmocka_unit_test(a_nonlinear_elastic_oscillator_swings_in_its_lengthened_period),
           cmocka_unit_test(the_error_falls_with_the_fourth_power_of_the_step),
           cmocka_unit_test(locating_nothing_gives_the_same_answers_in_the_limit),
           cmocka_unit_test(the_yield_displacement_is_the_elastic_one_over_the_reduction_factor),
           cmocka_unit_test(a_correction_divides_the_largest_displacement_by_the_target),
           cmocka_unit_test(equal_oscillators_never_press_on_each_other))
