/* The engine against the oracle on random scenes.
 *
 *   1. Each seed gives a random specimen.
 *   2. The oracle computes it with two step lengths, and with ground samples changed at random by 1e-9 of themselves: the
 *      first shows its own error, the second the amplification of rounding errors.
 *   3. The engine must agree within that error plus its own rounding errors times the amplification.  If the motion is so
 *      chaotic that the oracle does not agree with itself to 1e-6, half the duration is tried. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SCENES = 96, SAMPLES = 301 };

// a step of the engine: one sample, some ten terms of a series, each rounded a few times
static const double roundings = 30 * DBL_EPSILON * SAMPLES;
static const double nudge = 1e-9;
static const double pi = 3.14159265358979323846;

static struct pound_response nudged(const struct specimen *specimen, double radians, uint64_t stream)
{
	struct specimen other = {.study = specimen->study};
	const struct pound_excitation *e = &specimen->study.scene.excitation;
	double *a = specimen_record(&other, e->time_step, e->n_record);
	for (int t = 0; t < e->n_record; t++)
		a[t] = e->record[t] * (1 + specimen_uniform(&stream, -nudge, nudge));
	struct pound_response response = specimen_oracle(&other, radians);
	specimen_free(&other);
	return response;
}

// reference value for the relative error of a measure; the state at the end may be near 0
static double scale(const struct pound_response *r, const struct pound_scene *scene, int measure)
{
	const char *name = oracle_measure_name(measure);
	double w = 2 * pi * scene->oscillators[0].frequency_hz;
	if (!strncmp(name, "end_u", 5))
		return r->displacement_max_1;
	if (!strncmp(name, "end_v", 5))
		return w * r->displacement_max_1;
	return fabs(oracle_measure(r, measure));
}

// the start of a grazing contact at rest is far less certain than the motion that follows
static bool is_contact_time(int measure)
{
	return !strcmp(oracle_measure_name(measure), "contact_time");
}

// the largest difference of any measure, so that no measure is compared with an error that is small by chance
static double difference(const struct pound_response *a, const struct pound_response *b,
                         const struct pound_scene *scene)
{
	double largest = 0;
	for (int m = 0; m < ORACLE_MEASURES; m++) {
		double apart = fabs(oracle_measure(a, m) - oracle_measure(b, m));
		if (apart > 0 && !is_contact_time(m))
			largest = fmax(largest, apart / scale(b, scene, m));
	}
	return largest;
}

/* Compares one scene over the longest duration that is not chaotic; returns its number of samples. */
static int compare(struct specimen *specimen, int scene_number)
{
	const struct pound_scene *scene = &specimen->study.scene;
	struct pound_excitation *e = &specimen->study.scene.excitation;
	struct pound_response fine, coarse;
	double own;
	for (;; e->n_record = e->n_record / 2 + 1) {
		fine = specimen_oracle(specimen, 0.01);
		coarse = specimen_oracle(specimen, 0.02);
		own = difference(&coarse, &fine, scene);
		if (own < 1e-6 || e->n_record < 5)
			break;
	}
	struct pound_response moved = nudged(specimen, 0.01, (uint64_t)scene_number);
	double amplified = roundings / nudge * difference(&moved, &fine, scene);
	struct pound_response engine = specimen_engine(specimen);
	for (int m = 0; m < ORACLE_MEASURES; m++) {
		char what[80];
		snprintf(what, sizeof what, "scene %d, %d samples: %s", scene_number, e->n_record,
		         oracle_measure_name(m));
		double got = oracle_measure(&engine, m), want = oracle_measure(&fine, m);
		if (isnan(want) && isnan(got))
			continue;
		double allowed = (own + amplified + roundings) * scale(&fine, scene, m);
		// the end of a grazing contact at rest converges with the step, but not steadily
		if (is_contact_time(m))
			allowed = 10 * (allowed + fabs(want - coarse.contact_time)) +
			          roundings / nudge * fabs(want - moved.contact_time);
		check_near_at(got, want, allowed, what, __FILE__, __LINE__);
	}
	return e->n_record;
}

static void the_engine_agrees_with_the_oracle_on_random_scenes(void **state)
{
	(void)state;
	int whole = 0, touched = 0;
	for (int k = 0; k < SCENES; k++) {
		struct specimen specimen;
		specimen_random(&specimen, k, 0.01, SAMPLES);
		int samples = compare(&specimen, k);
		whole += samples == SAMPLES;
		touched += specimen_engine(&specimen).contact_count > 0;
		specimen_free(&specimen);
	}
	// most scenes must have contacts and be compared to their end
	assert_true(whole > SCENES * 3 / 4);
	assert_true(touched > SCENES * 3 / 4);
}

CHECK_MAIN(cmocka_unit_test(the_engine_agrees_with_the_oracle_on_random_scenes))
