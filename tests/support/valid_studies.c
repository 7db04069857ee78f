/* Valid studies drawn at random.
 *
 * Kinds: response and sensitivity 3 of 8 each, floor_spectrum and convergence 1 of 8 each; a quarter of the responses
 * are of kind separation instead.  Drawn with equal chances in the
 * logarithm: frequencies 0.3 to 20 Hz, damping 0.01 to 0.2, mass 0.01 to 100, stiffness ratio 1 to 10^6, gap 10^-4 to 0.1 m (half: 0),
 * duration 1 to 40 s or 2 to 40 cycles of 0.5 to 10 Hz, sample step 0.002 to 0.02 s, signals 1 to 500 (sensitivity: 20, floor
 * spectrum: 50, convergence: 10), rows 16 to 32,000, frequencies of spectra 2 to 1,000, pulses (half: 0) 1 to 10^6, steps of solvers
 * 10^-5 to 10^-3 s, tolerances 10^-10 to 10^-4.  Restitution 0 to 1, corrections 0 to 10 (half: 1).  A tenth has a wall, a tenth no
 * contact, a third a linear law, 3 of 8 another solver, a quarter a sweep, where the kind allows it.
 *
 * Half have the default contact model, the others each of them with equal chances, calibrated either way, a third without tension.
 * A third of responses, sensitivities and floor spectra is of a row of 2 to 8 buildings of 1 to 50 storeys, every form of damping; a quarter of
 * the buildings have a law of their own, a third of the rows have one contact at levels of its own. */
#include "tests/support/valid_studies.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#include "schema/study/study_json.h"
#include "schema/study/trial.h"
#include "tests/support/check.h"

static uint64_t state_of;

static double uniform(void)
{
	state_of = state_of * 6364136223846793005u + 1442695040888963407u;
	return (double)(state_of >> 11) * 0x1p-53;
}

static double between(double low, double high)
{
	return low * pow(high / low, uniform());
}

static int below(int n)
{
	return (int)(n * uniform());
}

struct text {
	char *bytes; // (VALID_STUDY_SIZE)
	size_t n;
};

static void say(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(struct text *text, const char *format, ...)
{
	va_list values;
	va_start(values, format);
	text->n += (size_t)vsnprintf(text->bytes + text->n, VALID_STUDY_SIZE - text->n, format, values);
	va_end(values);
}

static void say_law(struct text *text)
{
	if (below(3) == 0)
		say(text, "\"law\": {\"type\": \"linear\"}");
	else
		say(text, "\"law\": {\"type\": \"elastoplastic\", \"hardening_ratio\": %.3g, \"corrections\": %d}",
		    below(2) * between(0.01, 0.2), below(2) ? 1 : below(11));
}

static void say_contact(struct text *text)
{
	if (below(10) == 0) {
		say(text, "\"contact\": null, ");
		return;
	}
	say(text, "\"contact\": {");
	if (below(2)) {
		const int model = below(POUND_CONTACT_MODELS);
		say(text, "\"model\": \"%s\", ", pound_contact_name(model));
		if (pound_contact_reads(model, "calibration") && below(2))
			say(text, "\"calibration\": \"exact\", ");
		if (pound_contact_reads(model, "tension") && below(3) == 0)
			say(text, "\"tension\": false, ");
		if (pound_contact_reads(model, "yield_overlap_m"))
			say(text, "\"yield_overlap_m\": %.3g, ", between(1e-5, 1e-2));
		if (pound_contact_reads(model, "stiffness_ratio"))
			say(text, "\"stiffness_ratio\": %.3g, ", between(1, 1e6));
		if (pound_contact_reads(model, "restitution"))
			say(text, "\"restitution\": %.3g, ", uniform());
	} else
		say(text, "\"stiffness_ratio\": %.3g, \"restitution\": %.3g, ", between(1, 1e6), uniform());
	say(text, "\"gap_m\": %.3g}, ", below(2) ? between(1e-4, 0.1) : 0);
}

static void say_excitation(struct text *text, int signals_most)
{
	if (below(3) == 0)
		say(text, "\"excitation\": {\"type\": \"white_noise\", \"duration_s\": %.3g, ", between(1, 40));
	else
		say(text, "\"excitation\": {\"frequency_hz\": %.3g, \"cycles\": %.3g, ", between(0.5, 10),
		    between(2, 40));
	say(text, "\"time_step_s\": %.3g, \"signals\": %d}}", between(0.002, 0.02),
	    1 + (int)between(1, signals_most));
}

static void say_scene(struct text *text, int signals_most)
{
	say(text, "\"scene\": {");
	say_law(text);
	say(text, ", \"oscillators\": [{\"frequency_hz\": %.3g, \"damping_ratio\": %.3g}, ", between(0.3, 20),
	    between(0.01, 0.2));
	if (below(10) == 0)
		say(text, "{\"rigid_wall\": true}], ");
	else
		say(text, "{\"mass_kg\": %.3g, \"frequency_hz\": %.3g, \"damping_ratio\": %.3g}], ",
		    between(0.01, 100), between(0.3, 20), between(0.01, 0.2));
	say_contact(text);
	say_excitation(text, signals_most);
}

/* A row of buildings; the first two have a frequency and a mass, which an input may vary. */
static void say_row(struct text *text, int signals_most)
{
	const int n = 2 + below(POUND_BUILDINGS_MAX - 1);
	int storeys[POUND_BUILDINGS_MAX];
	say(text, "\"scene\": {");
	say_law(text);
	say(text, ", \"buildings\": [");
	for (int b = 0; b < n; b++) {
		storeys[b] = (int)between(1, POUND_STOREYS_MAX + 1);
		if (b == n - 1 && below(10) == 0) {
			say(text, ", {\"rigid_wall\": true}");
			continue;
		}
		say(text, "%s{\"storeys\": %d, \"mass_kg\": %.3g, \"frequency_hz\": %.3g, \"damping\": \"%s\"",
		    b ? ", " : "", storeys[b], between(0.1, 10), between(0.3, 10) / sqrt(storeys[b]),
		    pound_damping_name(below(4)));
		say(text, ", \"damping_ratio\": %.3g", between(0.01, 0.1));
		if (below(4) == 0) {
			say(text, ", ");
			say_law(text);
		}
		say(text, "}");
	}
	say(text, "], ");
	if (below(3) == 0) {
		const double own = uniform();
		say(text, "\"contacts\": [{\"left_building\": 0, \"levels\": [%.3g, %.3g]}], ", own * storeys[0],
		    own * storeys[1]);
	}
	say_contact(text);
	say_excitation(text, signals_most);
}

static void say_solver(struct text *text)
{
	switch (below(8)) {
	case 0:
		say(text, ", \"solver\": {\"method\": \"newmark\", \"step_s\": %.3g}", between(1e-5, 1e-3));
		break;
	case 1:
		say(text, ", \"solver\": {\"method\": \"central_difference\", \"step_s\": %.3g}",
		    between(1e-5, 1e-4));
		break;
	case 2:
		say(text, ", \"solver\": {\"method\": \"adaptive\", \"tolerance\": %.3g}", between(1e-10, 1e-4));
		break;
	}
}

static void say_sweep(struct text *text)
{
	static const char *const sweeps[] = {
	    "{\"path\": \"/contact/restitution\", \"values\": [0.1, 0.4, 0.7, 0.95]}",
	    "{\"path\": \"/oscillators/0/frequency_hz\", \"values\": [0.5, 2, 5, 12]}",
	    "{\"path\": \"/excitation/time_step_s\", \"values\": [0.004, 0.01]}"};
	if (below(4) == 0)
		say(text, ", \"sweep\": [%s]", sweeps[below(3)]);
}

static void say_sensitivity(struct text *text, bool row)
{
	static const char *const inputs[] = {
	    "{\"path\": \"/oscillators/0/frequency_hz\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, "
	    "\"max\": 5}}",
	    "{\"path\": \"/oscillators/0/damping_ratio\", \"distribution\": {\"type\": \"uniform\", \"min\": "
	    "0.01, \"max\": 0.1}}",
	    "{\"path\": \"/excitation/time_step_s\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.005, "
	    "\"max\": 0.01}}",
	    "{\"path\": \"/excitation/peak_m_s2\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, "
	    "\"max\": 5}}",
	    "{\"path\": \"/excitation/rise\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.1, \"max\": "
	    "0.3}}",
	};
	// for rows of buildings, in place of the first two inputs
	static const char *const of_row[] = {
	    "{\"path\": \"/buildings/0/frequency_hz\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, "
	    "\"max\": 2}}",
	    "{\"path\": \"/buildings/1/mass_kg\", \"distribution\": {\"type\": \"uniform\", \"min\": 1, "
	    "\"max\": 5}}",
	};
	static const char *const methods[] = {"lhs", "random", "sobol"}, *const orders[] = {"total", "second"};
	const int n = 1 + below(5);
	if (row)
		say_row(text, 20);
	else
		say_scene(text, 20);
	if (row)
		say(text, ", \"places\": [{\"building\": 0, \"storey\": 1}]");
	say(text, ", \"inputs\": [");
	for (int j = 0; j < n; j++)
		say(text, "%s%s", j ? ", " : "", row && j < 2 ? of_row[j] : inputs[j]);
	say(text, "], \"design\": {\"method\": \"%s\", \"order\": \"%s\", \"rows\": %d}", methods[below(3)],
	    orders[below(2)], 16 * (int)between(1, 2000));
}

static void draw(struct text *text)
{
	const int kind = below(8);
	text->n = 0;
	const bool row = kind < 7 && below(3) == 0;
	if (kind < 3) {
		say(text, "{\"kind\": \"%s\", ", below(4) == 0 ? "separation" : "response");
		if (row)
			say_row(text, 100);
		else
			say_scene(text, 500);
	} else if (kind < 6) {
		say(text, "{\"kind\": \"sensitivity\", ");
		say_sensitivity(text, row);
	} else if (kind < 7) {
		say(text, "{\"kind\": \"floor_spectrum\", ");
		if (row)
			say_row(text, 10);
		else
			say_scene(text, 50);
		say(text, ", \"spectrum\": {\"frequencies_hz\": {\"count\": %d}, \"pulses\": %d}",
		    2 + (int)between(1, 1000), below(2) ? 0 : (int)between(1, 1e6));
	} else {
		say(text, "{\"kind\": \"convergence\", ");
		say_scene(text, 10);
		say(text,
		    ", \"convergence\": {\"newmark\": {\"steps_s\": [%.3g]}, \"central_difference\": {\"steps_s\": "
		    "[]}, "
		    "\"adaptive\": {\"tolerances\": [%.3g]}}",
		    between(1e-4, 1e-3), between(1e-8, 1e-4));
	}
	if (kind < 6 && !row) {
		say_solver(text);
		say_sweep(text);
	}
	say(text, "}");
}

/* Draws studies until one is valid.
 *
 * Given    seed     seed of a new sequence; 0: continue the present sequence
 * Returns  text     (VALID_STUDY_SIZE)
 *          drawn    incremented for each study drawn, valid or not
 *          value    for study_free
 */
struct pound_study *valid_study(uint64_t seed, char *text, int *drawn)
{
	static struct problems problems;
	struct text into = {.bytes = text};
	struct pound_study *study;
	state_of = seed ? seed : state_of;
	do {
		draw(&into);
		++*drawn;
	} while (!(study = study_from_json(text, into.n, &problems)));
	return study;
}

/* CPU time that a study takes [s]; if it was stopped, the time until then.
 *
 * Given    most   s   limit after which the study is stopped
 */
double valid_study_taken(const struct pound_study *study, double most)
{
	return trial_run(study, true, most, NULL).cpu_s;
}
