/* outputs.c - the outputs of a study: each the ratio of the means of two measures over a scene's signals.
 *
 * Adding an output: its two measures and its row in outputs[]. */
#include "engine/run/outputs.h"

#include <math.h>
#include <stddef.h>

#include "engine/scene/law.h"

static bool left_is_linear(const struct pound_scene *scene)
{
	return pound_law_linear(pound_scene_law(scene, 0)->type);
}

static bool left_yields(const struct pound_scene *scene)
{
	return !left_is_linear(scene);
}

static bool bodies_meet(const struct pound_scene *scene)
{
	return scene->contact.present;
}

static double displacement(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->displacement_max_1;
}

static double displacement_free(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->displacement_max_free_1;
}

// a body that never moves has no demand, which is not for want of a result
static double demand(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return isnan(r->demand_1) ? 0 : r->demand_1;
}

static double demand_free(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return isnan(r->demand_free_1) ? 0 : r->demand_free_1;
}

/* Impulse over m1 w1: the displacement amplitude it gives to the left oscillator [m]. */
static double impulse(const struct pound_response *r, const struct pound_scene *scene)
{
	const struct pound_oscillator *o = &scene->oscillators[0];
	return r->impulse_max / (o->mass * (2 * 3.14159265358979323846 * o->frequency_hz));
}

/* An ordinate is filled in by floor_outputs.c, as it is not part of a response; it is a mean, not a ratio. */
static double absent(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)r, (void)scene;
	return 0;
}

static double one(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)r, (void)scene;
	return 1;
}

static bool always(const struct pound_scene *scene)
{
	(void)scene;
	return true;
}

typedef double measure(const struct pound_response *, const struct pound_scene *);

static const struct output {
	const char *name;
	const char *text;  /* one line of documentation */
	const char *needs; /* of a scene, or a study, in words */
	bool (*applies)(const struct pound_scene *);
	measure *numerator, *denominator;
	bool ordinates; /* one output for each frequency of the spectrum */
} outputs[] = {
    // the paper, Eq. (5), (7) and (9)
    {"force_amplification", "largest displacement of the left body, with over without pounding",
     "a linear law of the left oscillator", left_is_linear, displacement, displacement_free, false},
    {"demand_amplification", "ductility demand of the left body, with over without pounding",
     "a nonlinear law of the left oscillator", left_yields, demand, demand_free, false},
    {"impulse",
     "largest impulse of a contact over m_1 omega_1 times the largest displacement without pounding",
     "a contact", bodies_meet, impulse, displacement_free, false},
    {"floor_spectrum", "mean ordinate of the left floor's response spectrum, one output for each frequency",
     "a sensitivity study", always, absent, one, true},
};

const char *pound_output_name(int row)
{
	return row >= 0 && row < (int)(sizeof outputs / sizeof outputs[0]) ? outputs[row].name : NULL;
}

const char *pound_output_text(int row)
{
	return outputs[row].text;
}

const char *pound_output_needs(int row)
{
	return outputs[row].needs;
}

bool pound_output_has_ordinates(int row)
{
	return outputs[row].ordinates;
}

/* The frequency of an output: how many of the study's before it have ordinates. */
int pound_study_ordinate(const struct pound_study *study, int output)
{
	int k = 0;
	if (study->elsewhere || !outputs[study->outputs[output]].ordinates)
		return -1;
	for (int o = 0; o < output; o++)
		k += outputs[study->outputs[o]].ordinates;
	return k;
}

bool pound_output_applies(int row, const struct pound_scene *scene)
{
	return outputs[row].applies(scene);
}

/* The two measures of one signal whose means an output divides. */
void pound_outputs_measure(int row, const struct pound_scene *scene, const struct pound_response *response,
                           double *numerator, double *denominator)
{
	*numerator = outputs[row].numerator(response, scene);
	*denominator = outputs[row].denominator(response, scene);
}
