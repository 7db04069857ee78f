/* outputs.c - the outputs of a study: each the ratio of the means of two measures over a scene's signals.
 *
 * Adding an output: its two measures and its row in outputs[]. */
#include "engine/run/outputs.h"

#include <math.h>
#include <stddef.h>

#include "engine/scene/law.h"

static bool left_is_linear(const struct pound_scene *scene)
{
	return scene->n_buildings == 0 && pound_law_linear(pound_scene_law(scene, 0)->type);
}

/* Whether the left oscillator has a nonlinear law, or every building with a place. */
static bool bodies_yield(const struct pound_scene *scene)
{
	if (scene->n_buildings == 0)
		return !left_is_linear(scene);
	int k = 0;
	while (k < scene->n_places && !pound_law_linear(pound_row_law(scene, scene->places[k].building)->type))
		k++;
	return k == scene->n_places &&
	       !pound_law_linear(pound_row_law(scene, scene->n_places ? scene->places[0].building : 0)->type);
}

static bool is_row(const struct pound_scene *scene)
{
	return scene->n_buildings > 0;
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

/* ---- of rows of buildings ---- */

static const struct pound_storey_response *storey_of(const struct pound_row_response *row,
                                                     const struct pound_scene *scene,
                                                     const struct pound_storey_place *place)
{
	return &row->storeys[pound_row_first(scene, place->building) + place->storey - 1];
}

static double drift(const struct pound_row_response *row, const struct pound_scene *scene,
                    const struct pound_storey_place *place)
{
	return storey_of(row, scene, place)->drift_max;
}

static double drift_free(const struct pound_row_response *row, const struct pound_scene *scene,
                         const struct pound_storey_place *place)
{
	return storey_of(row, scene, place)->drift_max_free;
}

static double acceleration(const struct pound_row_response *row, const struct pound_scene *scene,
                           const struct pound_storey_place *place)
{
	return storey_of(row, scene, place)->acceleration_max;
}

static double acceleration_free(const struct pound_row_response *row, const struct pound_scene *scene,
                                const struct pound_storey_place *place)
{
	return storey_of(row, scene, place)->acceleration_max_free;
}

// as of one oscillator, a storey that never moves has no demand
static double storey_demand(const struct pound_row_response *row, const struct pound_scene *scene,
                            const struct pound_storey_place *place)
{
	const double value = storey_of(row, scene, place)->demand;
	return isnan(value) ? 0 : value;
}

static double storey_demand_free(const struct pound_row_response *row, const struct pound_scene *scene,
                                 const struct pound_storey_place *place)
{
	const double value = storey_of(row, scene, place)->demand_free;
	return isnan(value) ? 0 : value;
}

/* The largest impulse of all contacts over the mass of building 0 and the frequency of its first mode [m]. */
static double row_impulse(const struct pound_row_response *row, const struct pound_scene *scene,
                          const struct pound_storey_place *place)
{
	(void)place;
	double most = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		most = fmax(most, row->contacts[k].impulse_max);
	return most / row->impulse_scale;
}

static double top_free(const struct pound_row_response *row, const struct pound_scene *scene,
                       const struct pound_storey_place *place)
{
	(void)place;
	return row->storeys[pound_row_storeys(scene, 0) - 1].displacement_max_free;
}

static double row_absent(const struct pound_row_response *row, const struct pound_scene *scene,
                         const struct pound_storey_place *place)
{
	(void)row, (void)scene, (void)place;
	return 0;
}

static double row_one(const struct pound_row_response *row, const struct pound_scene *scene,
                      const struct pound_storey_place *place)
{
	(void)row, (void)scene, (void)place;
	return 1;
}

typedef double measure(const struct pound_response *, const struct pound_scene *);
typedef double row_measure(const struct pound_row_response *, const struct pound_scene *,
                           const struct pound_storey_place *);

static const struct output {
	const char *name;
	const char *text;              /* one line of documentation */
	const char *needs, *row_needs; /* of two oscillators and of a row, or of a study, in words */
	bool (*applies)(const struct pound_scene *);
	measure *numerator, *denominator;             /* of two oscillators; NULL: it has none */
	row_measure *row_numerator, *row_denominator; /* of a row of buildings; NULL likewise */
	bool places;                                  /* of a row one output for each place */
	bool ordinates;                               /* one output for each frequency of the spectrum */
} outputs[] = {
    // the paper, Eq. (5), (7), (9) and (19)
    {"force_amplification", "largest displacement of the left body, with over without pounding",
     "a linear law of the left oscillator", "two oscillators", left_is_linear, displacement,
     displacement_free, NULL, NULL, false, false},
    {"demand_amplification",
     "ductility demand of the left body, or of the story at each place, with over without pounding",
     "a nonlinear law of the left oscillator", "a nonlinear law of every building that has a place",
     bodies_yield, demand, demand_free, storey_demand, storey_demand_free, true, false},
    {"impulse",
     "largest impulse of a contact over m_1 omega_1 times the largest displacement without pounding",
     "a contact", "a contact", bodies_meet, impulse, displacement_free, row_impulse, top_free, false, false},
    {"floor_spectrum", "mean ordinate of the left floor's response spectrum, one output for each frequency",
     "a sensitivity study", "a sensitivity study", always, absent, one, row_absent, row_one, false, true},
    {"drift_amplification", "largest story drift at each place, with over without pounding", "buildings",
     "buildings", is_row, NULL, NULL, drift, drift_free, true, false},
    {"acceleration_amplification",
     "largest absolute acceleration of the floor at each place, with over without pounding", "buildings",
     "buildings", is_row, NULL, NULL, acceleration, acceleration_free, true, false},
};

const char *pound_output_name(int row)
{
	return row >= 0 && row < (int)(sizeof outputs / sizeof outputs[0]) ? outputs[row].name : NULL;
}

const char *pound_output_text(int row)
{
	return outputs[row].text;
}

const char *pound_output_needs(int row, const struct pound_scene *scene)
{
	return scene->n_buildings > 0 ? outputs[row].row_needs : outputs[row].needs;
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

/* Whether an output reads accelerations of floors, which are not computed otherwise. */
bool pound_output_accelerations(int row)
{
	return outputs[row].row_numerator == acceleration;
}

bool pound_output_has_places(int row, const struct pound_scene *scene)
{
	return scene->n_buildings > 0 && outputs[row].places;
}

/* The place of an output: how many of the study's before it are of the same row. */
int pound_study_place(const struct pound_study *study, int output)
{
	int k = 0;
	if (study->elsewhere || !pound_output_has_places(study->outputs[output], &study->scene))
		return -1;
	for (int o = 0; o < output; o++)
		k += study->outputs[o] == study->outputs[output];
	return k;
}

bool pound_output_applies(int row, const struct pound_scene *scene)
{
	return outputs[row].applies(scene);
}

/* The two measures of one signal whose means an output divides. */
void pound_outputs_measure(const struct pound_study *study, int output, const struct pound_outcome *outcome,
                           double *numerator, double *denominator)
{
	const struct output *row = &outputs[study->outputs[output]];
	const struct pound_scene *scene = outcome->scene;
	if (scene->n_buildings == 0) {
		*numerator = row->numerator(outcome->pair, scene);
		*denominator = row->denominator(outcome->pair, scene);
		return;
	}
	const int k = pound_study_place(study, output);
	const struct pound_storey_place *place = k < 0 ? NULL : &scene->places[k];
	*numerator = row->row_numerator(outcome->row, scene, place);
	*denominator = row->row_denominator(outcome->row, scene, place);
}
