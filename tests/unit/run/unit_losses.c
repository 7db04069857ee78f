/* unit_losses.c - accelerations, forces, speeds, residual displacements and energies: closed forms, and conservation
 * of energy.
 *
 * A constant ground acceleration A puts in the energy -A sum m u(end): the part that the bodies do not have at the
 * end is lost. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/check.h"
#include "tests/support/results.h"

static const double PI = 3.14159265358979323846;

enum { SAMPLES = 301 };

/* A record of one constant acceleration [m/s2]. */
static const char *constant(double a)
{
	static char text[12 * SAMPLES + 200];
	int n =
	    snprintf(text, sizeof text, "{\"type\": \"record\", \"time_step_s\": 0.01, \"acceleration_m_s2\": [");
	for (int k = 0; k < SAMPLES; k++)
		n += snprintf(text + n, sizeof text - (size_t)n, "%s%g", k ? ", " : "", a);
	snprintf(text + n, sizeof text - (size_t)n, "]}");
	return text;
}

/* The response of a scene to a constant acceleration. */
static struct reading *response(const char *scene, double a, const char *outputs)
{
	static char document[16384];
	const int n = snprintf(document, sizeof document,
	                       "{\"kind\": \"response\", \"scene\": {%s, \"excitation\": %s}, \"outputs\": [%s]}",
	                       scene, constant(a), outputs);
	assert_in_range(n, 1, sizeof document - 1);
	return results_of_study(document);
}

static double output(const struct reading *r, const char *name)
{
	return reading_number((struct reading *)r, "/outputs/%s", name);
}

/* An undamped body beside a wall: u'' + w^2 u = -A; with the contact spring W^2 = w^2 + K/m. */
static void an_undamped_body_has_its_closed_forms(void **state)
{
	static const char body[] =
	    "\"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 1.5, \"damping_ratio\": 0}, "
	    "{\"rigid_wall\": true}]";
	const double w = 2 * PI * 1.5, a = 2;
	char scene[512];
	(void)state;
	snprintf(scene, sizeof scene, "%s, \"contact\": null", body);
	struct reading *r = response(scene, a, "\"peak_acceleration_m_s2\", \"acceleration_amplification\"");
	check_near(output(r, "peak_acceleration_m_s2"), 2 * a, 1e-13);
	check_near(output(r, "acceleration_amplification"), 1, 0);
	reading_close(r);

	// in contact with the wall from the start
	snprintf(scene, sizeof scene, "%s, \"contact\": {\"stiffness_ratio\": 8, \"restitution\": 1}", body);
	r = response(scene, -a,
	             "\"peak_contact_force_n\", \"peak_acceleration_m_s2\", \"peak_acceleration_free_m_s2\", "
	             "\"contact_energy_ratio\"");
	check_near(output(r, "peak_contact_force_n"), 3 * 2 * a * 8 / 9, 1e-12);
	check_near(output(r, "peak_acceleration_m_s2"), 2 * a, 1e-12);
	check_near(output(r, "peak_acceleration_free_m_s2"), 2 * a, 1e-12);
	reading_close(r);

	// the first impact has v^2 = 2 A g - w^2 g^2, and no later impact is faster
	static const char *const models[] = {"kelvin_voigt", "hertz_damp", "rigid"};
	const double gap = 0.03, v = sqrt(2 * a * gap - w * w * gap * gap);
	for (int k = 0; k < 3; k++) {
		snprintf(scene, sizeof scene,
		         "%s, \"contact\": {\"model\": \"%s\", \"gap_m\": %g, \"restitution\": 0.5}", body, models[k],
		         gap);
		r = response(scene, -a, "\"peak_approach_speed_m_s\", \"contact_count\", \"contact_energy_ratio\"");
		check_near(output(r, "peak_approach_speed_m_s"), v, 1e-12);
		assert_true(output(r, "contact_count") > 1 && output(r, "contact_energy_ratio") > 0.1);
		reading_close(r);
	}
}

/* ---- conservation ---- */

struct body {
	double mass, frequency, hardening;
};

static const struct body bodies[2] = {{3, 1, 0.05}, {1, 1.7, 0.05}};

/* Energy of a body at the end: kinetic, and of the spring, whose force is zero at the residual displacement. */
static double left_in(const struct reading *r, int i, bool elastoplastic)
{
	const double w = 2 * PI * bodies[i].frequency, k = bodies[i].mass * w * w;
	const double u = reading_number((struct reading *)r, "/signals/0/end/u%d_m", i + 1),
	             v = reading_number((struct reading *)r, "/signals/0/end/v%d_m_s", i + 1);
	double residual = 0;
	if (elastoplastic) // the output is a magnitude: the nearer of both signs
		residual = output(r, i ? "residual_displacement_right_m" : "residual_displacement_m");
	const double away = fmin(fabs(u - residual), fabs(u + residual));
	return 0.5 * bodies[i].mass * v * v + 0.5 * k * away * away;
}

/* Every contact model, linear and yielding bodies without dashpots: energy is put in, stored in the bodies, or lost
 * in the laws or in the contact. */
static void what_is_put_in_is_found_again(void **state)
{
	static const char *const laws[] = {"{\"type\": \"linear\"}",
	                                   "{\"type\": \"elastoplastic\", \"yield_displacement_m\": 0.06}"};
	static const char *const models[] = {
	    "kelvin_voigt", "linear",       "modified_kelvin_voigt", "hunt_crossley", "hertz",
	    "hertz_damp",   "viscoelastic", "damped_hertz",          "bilinear",      "rigid"};
	double worst = 0;
	(void)state;
	for (int law = 0; law < 2; law++)
		for (size_t k = 0; k < sizeof models / sizeof models[0]; k++) {
			char scene[1024];
			const bool elastic = strcmp(models[k], "linear") == 0 || strcmp(models[k], "hertz") == 0,
			           damped = !elastic && strcmp(models[k], "bilinear") != 0;
			snprintf(
			    scene, sizeof scene,
			    "\"law\": %s, \"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 1, \"damping_ratio\": 0}, "
			    "{\"mass_kg\": 1, \"frequency_hz\": 1.7, \"damping_ratio\": 0}], \"contact\": {\"model\": "
			    "\"%s\", \"gap_m\": 0.01%s}",
			    laws[law], models[k],
			    elastic  ? ""
			    : damped ? ", \"restitution\": 0.6"
			             : ", \"yield_overlap_m\": 1e-4, \"second_stiffness_ratio\": 0.2");
			const double a = law ? -2 : 2; // else bodies yield apart and never meet again
			struct reading *r =
			    response(scene, a,
			             law ? "\"contact_energy_ratio\", \"hysteresis_energy_ratio\", "
			                   "\"hysteresis_energy_ratio_right\", "
			                   "\"residual_displacement_m\", \"residual_displacement_right_m\""
			                 : "\"contact_energy_ratio\"");
			double in = 0, left = 0;
			for (int i = 0; i < 2; i++) {
				in -= a * bodies[i].mass * reading_number(r, "/signals/0/end/u%d_m", i + 1);
				left += left_in(r, i, law);
			}
			double lost = output(r, "contact_energy_ratio");
			assert_true(reading_number(r, "/signals/0/contact_count") > 0);
			// energy stored in a contact that has not ended counts as lost
			assert_true(elastic ? law || fabs(lost) < 1e-12 : lost > 1e-9);
			if (law) {
				assert_true(output(r, "hysteresis_energy_ratio") > 1e-3);
				lost += output(r, "hysteresis_energy_ratio") + output(r, "hysteresis_energy_ratio_right");
			}
			worst = fmax(worst, fabs(lost + left / in - 1));
			check_near(lost + left / in, 1, 1e-11);
			reading_close(r);
		}
	check_report("what is put in is found again to %.1e of it", worst);
}

/* ---- pairs and rows ---- */

/* One-story buildings have the outputs of two oscillators. */
static void one_story_rows_have_the_outputs_of_pairs(void **state)
{
	static const struct {
		const char *pair, *row;
	} names[] = {{"peak_contact_force_n", "peak_contact_force_n"},
	             {"peak_approach_speed_m_s", "peak_approach_speed_m_s"},
	             {"contact_energy_ratio", "contact_energy_ratio"},
	             {"hysteresis_energy_ratio", "hysteresis_energy_ratio.building_0.storey_1"},
	             {"hysteresis_energy_ratio_right", "hysteresis_energy_ratio.building_1.storey_1"},
	             {"residual_displacement_m", "residual_displacement_m.building_0.storey_1"},
	             {"residual_displacement_right_m", "residual_displacement_m.building_1.storey_1"},
	             {"peak_acceleration_m_s2", "peak_acceleration_m_s2.building_0.storey_1"},
	             {"peak_acceleration_right_m_s2", "peak_acceleration_m_s2.building_1.storey_1"},
	             {"peak_acceleration_free_m_s2", "peak_acceleration_free_m_s2.building_0.storey_1"},
	             {"peak_acceleration_free_right_m_s2", "peak_acceleration_free_m_s2.building_1.storey_1"},
	             {"acceleration_amplification_right", "acceleration_amplification.building_1.storey_1"}};
	static const char scene[] =
	    "\"law\": {\"type\": \"elastoplastic\"}, \"contact\": {\"gap_m\": 0.01}, \"excitation\": "
	    "{\"signals\": 6}";
	char pair[2048], row[2048], asked[1024] = "";
	double worst = 0;
	(void)state;
	for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
		snprintf(asked + strlen(asked), sizeof asked - strlen(asked), "%s\"%s\"", k ? ", " : "",
		         names[k].pair);
	snprintf(pair, sizeof pair,
	         "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 1}, "
	         "{\"mass_kg\": 2, \"frequency_hz\": 1.7}], %s}, \"outputs\": [%s]}",
	         scene, asked);
	snprintf(
	    row, sizeof row,
	    "{\"kind\": \"response\", \"scene\": {\"buildings\": [{\"storeys\": 1, \"mass_kg\": 3, "
	    "\"frequency_hz\": 1}, {\"storeys\": 1, \"mass_kg\": 2, \"frequency_hz\": 1.7}], %s}, \"places\": "
	    "[{\"building\": 0, \"storey\": 1}, {\"building\": 1, \"storey\": 1}], \"outputs\": "
	    "[\"peak_contact_force_n\", \"peak_approach_speed_m_s\", \"contact_energy_ratio\", "
	    "\"hysteresis_energy_ratio\", \"residual_displacement_m\", \"peak_acceleration_m_s2\", "
	    "\"peak_acceleration_free_m_s2\", \"acceleration_amplification\"]}",
	    scene);
	struct reading *of_pair = results_of_study(pair), *of_row = results_of_study(row);
	for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
		const double want = output(of_pair, names[k].pair), got = output(of_row, names[k].row);
		assert_true(want > 0);
		worst = fmax(worst, fabs(got / want - 1));
		check_near(got, want, 1e-10 * want);
	}
	check_report("outputs of one-story rows as those of pairs to %.1e", worst);
	assert_true(reading_number(of_pair, "/work/chain_runs/run") > 0);
	reading_close(of_pair);
	reading_close(of_row);
}

/* Runs that no output needs are left out. */
static void what_is_not_asked_for_is_not_run(void **state)
{
	static const char *const outputs[] = {"\"peak_impulse_n_s\"",
	                                      "\"peak_impulse_n_s\", \"peak_contact_force_n\"",
	                                      "\"peak_impulse_n_s\", \"acceleration_amplification\""};
	static const double runs[] = {0, 4, 8};
	double impulse[3];
	(void)state;
	for (int k = 0; k < 3; k++) {
		char document[1024];
		snprintf(document, sizeof document,
		         "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, "
		         "{\"frequency_hz\": "
		         "1.7}], \"contact\": {}, \"excitation\": {\"signals\": 4}}, \"outputs\": [%s]}",
		         outputs[k]);
		struct reading *r = results_of_study(document);
		impulse[k] = output(r, "peak_impulse_n_s");
		if (k == 0)
			assert_true(isnan(reading_number(r, "/work/chain_runs/run")));
		else
			check_near(reading_number(r, "/work/chain_runs/run"), runs[k], 0);
		check_near(impulse[k], impulse[0], 0);
		reading_close(r);
	}
}

CHECK_MAIN(cmocka_unit_test(an_undamped_body_has_its_closed_forms),
           cmocka_unit_test(what_is_put_in_is_found_again),
           cmocka_unit_test(one_story_rows_have_the_outputs_of_pairs),
           cmocka_unit_test(what_is_not_asked_for_is_not_run))
