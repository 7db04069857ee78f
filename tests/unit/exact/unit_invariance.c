/* Quantities that must not change, or change in a known way, if a scene is written in other units, mirrored or
 * resampled.  There is no oracle: the engine is compared with itself. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SCENES = 40, SAMPLES = 301 };

// the motion amplifies the difference of rounding errors between two runs: by less than 10^4 in 3 s, in these scenes
static const double amplified = 1e4 * 30 * DBL_EPSILON * SAMPLES;

/* Exponents of the units of a measure: value times mass^m length^l time^t. */
struct dimension {
	const char *name;
	int mass, length, time;
};

static const struct dimension dimensions[] = {
    {"displacement_max", 0, 1, 0}, {"force_max", 1, 1, -2},   {"yield_displacement", 0, 1, 0},
    {"demand", 0, 0, 0},           {"impulse_max", 1, 1, -1}, {"contact_count", 0, 0, 0},
    {"contact_time", 0, 0, 1},     {"end_u", 0, 1, 0},        {"end_v", 0, 1, -1},
};

static double in_units(int measure, double mass, double length, double time)
{
	const char *name = oracle_measure_name(measure);
	const struct dimension *d = dimensions;
	while (strncmp(name, d->name, strlen(d->name)) != 0)
		d++;
	return pow(mass, d->mass) * pow(length, d->length) * pow(time, d->time);
}

/* Writes a scene in units that are smaller by these factors, so that the numbers grow. */
static void rescale(struct specimen *specimen, double mass, double length, double time)
{
	struct pound_scene *scene = &specimen->study.scene;
	struct pound_excitation *e = &scene->excitation;
	scene->law.yield_displacement *= length;
	scene->contact.gap *= length;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		scene->oscillators[i].mass *= mass;
		scene->oscillators[i].frequency_hz /= time;
		scene->oscillators[i].law.yield_displacement *= length;
	}
	e->time_step *= time;
	for (int t = 0; t < e->n_record; t++)
		specimen->record[t] *= length / (time * time);
}

// allowed: relative to the measure, or for the end state relative to the largest motion
static void check_alike(const struct pound_response *got, const struct pound_response *want, double mass,
                        double length, double time, double allowed, int scene)
{
	for (int m = 0; m < ORACLE_MEASURES; m++) {
		char what[80];
		snprintf(what, sizeof what, "scene %d: %s", scene, oracle_measure_name(m));
		double unit = in_units(m, mass, length, time);
		double g = oracle_measure(got, m), w = unit * oracle_measure(want, m);
		if (isnan(g) && isnan(w))
			continue;
		// 30 rad/s is the fastest oscillator
		double end = strncmp(oracle_measure_name(m), "end_", 4) ? 0 : 30 * unit * want->displacement_max_1;
		check_near_at(g, w, allowed * fmax(fabs(w), end), what, __FILE__, __LINE__);
	}
}

static void compare_in_units(double mass, double length, double time, double allowed)
{
	for (int k = 0; k < SCENES; k++) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		struct pound_response want = specimen_engine(&specimen);
		rescale(&specimen, mass, length, time);
		struct pound_response got = specimen_engine(&specimen);
		specimen_free(&specimen);
		check_alike(&got, &want, mass, length, time, allowed, k);
	}
}

static void other_units_of_length_by_a_power_of_two_change_no_bit(void **state)
{
	(void)state;
	compare_in_units(1, 8, 1, 0);
	compare_in_units(1, 0x1p-70, 1, 0);
	compare_in_units(1, 0x1p60, 1, 0);
}

static void other_units_of_mass_by_a_power_of_two_change_no_bit(void **state)
{
	(void)state;
	compare_in_units(0x1p20, 1, 1, 0);
}

static void other_units_of_time_by_a_power_of_two_change_no_bit(void **state)
{
	(void)state;
	compare_in_units(1, 1, 4, 0);
	compare_in_units(1, 1, 0.125, 0);
}

static void any_other_units_change_only_the_last_digits(void **state)
{
	(void)state;
	compare_in_units(3.7, 1, 1, amplified);
	compare_in_units(1, 3.7, 1, amplified);
	compare_in_units(1, 1, 3.7, amplified);
}

/* A quarter of pi is not a power of two, so results are rounded differently. */
static void a_stronger_ground_motion_leaves_demands_and_ratios_as_they_are(void **state)
{
	(void)state;
	for (int k = 0; k < SCENES; k++) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		struct pound_scene *scene = &specimen.study.scene;
		scene->contact.gap = 0;
		scene->law.yield_displacement = scene->oscillators[1].law.yield_displacement = 0;
		struct pound_response want = specimen_engine(&specimen);
		for (int t = 0; t < SAMPLES; t++)
			specimen.record[t] *= 0.7853981633974483;
		struct pound_response got = specimen_engine(&specimen);
		specimen_free(&specimen);
		check_alike(&got, &want, 1, 0.7853981633974483, 1, amplified, k);
	}
}

static void swapping_the_bodies_and_the_sign_of_the_ground_swaps_the_response(void **state)
{
	(void)state;
	for (int k = 0; k < SCENES; k++) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		struct pound_scene *scene = &specimen.study.scene;
		scene->oscillators[1].rigid_wall = false;
		struct pound_response r = specimen_engine(&specimen);

		struct pound_oscillator left = scene->oscillators[0];
		scene->oscillators[0] = scene->oscillators[1];
		scene->oscillators[1] = left;
		if (scene->oscillators[0].has_law) {
			// the other one keeps the scene's law
			scene->oscillators[1].law = scene->law;
			scene->oscillators[1].has_law = true;
		}
		for (int t = 0; t < SAMPLES; t++)
			specimen.record[t] *= -1;
		struct pound_response got = specimen_engine(&specimen);
		specimen_free(&specimen);
		struct pound_response want = {
		    .displacement_max_1 = r.displacement_max_2,
		    .displacement_max_free_1 = r.displacement_max_free_2,
		    .force_max_1 = r.force_max_2,
		    .yield_displacement_1 = r.yield_displacement_2,
		    .demand_1 = r.demand_2,
		    .demand_free_1 = r.demand_free_2,
		    .displacement_max_2 = r.displacement_max_1,
		    .displacement_max_free_2 = r.displacement_max_free_1,
		    .force_max_2 = r.force_max_1,
		    .yield_displacement_2 = r.yield_displacement_1,
		    .demand_2 = r.demand_1,
		    .demand_free_2 = r.demand_free_1,
		    .impulse_max = r.impulse_max,
		    .contact_count = r.contact_count,
		    .contact_time = r.contact_time,
		    .end_u1 = -r.end_u2,
		    .end_v1 = -r.end_v2,
		    .end_u2 = -r.end_u1,
		    .end_v2 = -r.end_v1,
		};
		check_alike(&got, &want, 1, 1, 1, amplified, k);
	}
}

static void ground_at_rest_before_the_motion_changes_no_bit(void **state)
{
	(void)state;
	enum { REST = 37 };
	for (int k = 0; k < SCENES; k++) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		specimen.record[0] = 0;
		struct pound_response want = specimen_engine(&specimen);
		struct specimen later = {.study = specimen.study};
		double *a = specimen_record(&later, 0.01, SAMPLES + REST);
		memcpy(a + REST, specimen.record, SAMPLES * sizeof *a);
		struct pound_response got = specimen_engine(&later);
		specimen_free(&later);
		specimen_free(&specimen);
		check_alike(&got, &want, 1, 1, 1, 0, k);
	}
}

/* The motion is linear between samples by definition, so additional samples on these lines do not change it. */
static void samples_between_samples_change_only_the_last_digits(void **state)
{
	(void)state;
	for (int k = 0; k < SCENES; k++) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		struct pound_response want = specimen_engine(&specimen);
		for (int parts = 2; parts <= 5; parts += 3) {
			struct specimen finer = {.study = specimen.study};
			double *a = specimen_record(&finer, 0.01 / parts, parts * (SAMPLES - 1) + 1);
			for (int t = 0; t < parts * (SAMPLES - 1); t++) {
				double share = (double)(t % parts) / parts;
				a[t] = specimen.record[t / parts] * (1 - share) + specimen.record[t / parts + 1] * share;
			}
			a[parts * (SAMPLES - 1)] = specimen.record[SAMPLES - 1];
			struct pound_response got = specimen_engine(&finer);
			specimen_free(&finer);
			check_alike(&got, &want, 1, 1, 1, amplified, k);
		}
		specimen_free(&specimen);
	}
}

/* Nonlinear laws must give the same response as the linear law, in every fourth scene (the linear scenes).
 *
 * Given    yield      yield displacement of the laws [m]
 *          own        keep each scene's second stiffness; otherwise it equals the first
 */
static void check_linear(double yield, bool own)
{
	for (int k = 0; k < SCENES; k += SPECIMEN_LAWS) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		specimen.study.scene.oscillators[1].has_law = false;
		struct pound_response want = specimen_engine(&specimen);
		if (!own)
			specimen.study.scene.law.hardening_ratio = 1;
		for (int l = 1; l < SPECIMEN_LAWS; l++) {
			specimen_law(&specimen, specimen_laws[l], yield);
			struct pound_response got = specimen_engine(&specimen);
			got.yield_displacement_1 = got.yield_displacement_2 = NAN;
			got.demand_1 = got.demand_2 = got.demand_free_1 = got.demand_free_2 = NAN;
			check_alike(&got, &want, 1, 1, 1, amplified, k);
		}
		specimen_free(&specimen);
	}
}

static void a_law_that_never_yields_is_linear(void **state)
{
	(void)state;
	check_linear(10, true);
}

static void a_hardening_ratio_of_one_is_linear(void **state)
{
	(void)state;
	check_linear(0.002, false);
}

/* Energy of the motion, of the springs and of the contact spring, of linear bodies.  p > 0 in contact, p <= 0 separated. */
static double energy(const struct pound_scene *scene, const struct pound_response *r)
{
	double sum = 0, k_max = 0;
	const double u[2] = {r->end_u1, r->end_u2}, v[2] = {r->end_v1, r->end_v2};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_oscillator *o = &scene->oscillators[i];
		double w = 2 * 3.14159265358979323846 * o->frequency_hz, k = o->mass * w * w;
		sum += 0.5 * o->mass * v[i] * v[i] + 0.5 * k * u[i] * u[i];
		k_max = fmax(k_max, k);
	}
	double p = fmax(0, u[0] - u[1] - scene->contact.gap);
	return sum + 0.5 * scene->contact.stiffness_ratio * k_max * p * p;
}

static void energy_only_falls_once_the_ground_is_still(void **state)
{
	(void)state;
	enum { STILL = 101, STEP = 10 };
	for (int k = SPECIMEN_LAWS; k < SPECIMEN_LAWS * SCENES; k += 2 * SPECIMEN_LAWS) {
		// linear, with contact that may pull: all stored energy is in the springs
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		struct pound_scene *scene = &specimen.study.scene;
		scene->oscillators[1].rigid_wall = scene->oscillators[1].has_law = false;
		memset(specimen.record + STILL - 1, 0, (SAMPLES - STILL + 1) * sizeof *specimen.record);
		double before = INFINITY;
		for (int n = STILL; n <= SAMPLES; n += STEP) {
			scene->excitation.n_record = n;
			struct pound_response r = specimen_engine(&specimen);
			double now = energy(scene, &r);
			assert_true(now <= before * (1 + 1e-12));
			before = now;
		}
		specimen_free(&specimen);
	}
}

/* The filter's corner is proportional to its frequency and the duration to its period, so time has no other scale. */
static void twice_every_frequency_and_half_the_step_leaves_the_paper_s_outputs_bit_for_bit(void **state)
{
	(void)state;
	for (int l = 0; l < SPECIMEN_LAWS; l++) {
		struct specimen specimen;
		specimen_init(&specimen);
		specimen_law(&specimen, specimen_laws[l], 0);
		struct pound_scene *scene = &specimen.study.scene;
		struct pound_excitation *e = &scene->excitation;
		while (strcmp(pound_excitation_name(e->type), "kanai_tajimi") != 0)
			e->type--;
		e->frequency_hz = 2.5;
		e->damping_ratio = 0.6;
		e->high_pass_ratio = 0.1;
		e->cycles = 20;
		e->rise = 0.15;
		e->fall = 0.25;
		e->peak = 1;
		struct pound_response want = specimen_engine(&specimen);
		e->frequency_hz *= 2;
		e->time_step /= 2;
		e->peak *= 4;
		scene->oscillators[0].frequency_hz *= 2;
		scene->oscillators[1].frequency_hz *= 2;
		struct pound_response got = specimen_engine(&specimen);
		specimen_free(&specimen);
		check_alike(&got, &want, 1, 1, 0.5, 0, l);
	}
}

CHECK_MAIN(cmocka_unit_test(other_units_of_length_by_a_power_of_two_change_no_bit),
           cmocka_unit_test(other_units_of_mass_by_a_power_of_two_change_no_bit),
           cmocka_unit_test(other_units_of_time_by_a_power_of_two_change_no_bit),
           cmocka_unit_test(any_other_units_change_only_the_last_digits),
           cmocka_unit_test(a_stronger_ground_motion_leaves_demands_and_ratios_as_they_are),
           cmocka_unit_test(swapping_the_bodies_and_the_sign_of_the_ground_swaps_the_response),
           cmocka_unit_test(ground_at_rest_before_the_motion_changes_no_bit),
           cmocka_unit_test(samples_between_samples_change_only_the_last_digits),
           cmocka_unit_test(a_law_that_never_yields_is_linear),
           cmocka_unit_test(a_hardening_ratio_of_one_is_linear),
           cmocka_unit_test(energy_only_falls_once_the_ground_is_still),
           cmocka_unit_test(twice_every_frequency_and_half_the_step_leaves_the_paper_s_outputs_bit_for_bit))
