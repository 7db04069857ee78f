/* row_response.c - the response of a row of buildings, from its marches, and packed as doubles. */
#include "engine/run/row_response.h"

#include <math.h>
#include <string.h>

#include "engine/run/row_runs.h"
#include "engine/scene/law.h"

/* indices before the stories */
enum { HEAD_IMPULSE_SCALE, HEAD_ENERGY, HEAD_WORK_IN, HEAD };

enum {
	STOREY_DOUBLES = sizeof(struct pound_storey_response) / sizeof(double),
	CONTACT_DOUBLES = sizeof(struct pound_contact_response) / sizeof(double),
};

/* ---- packing ---- */

/* The largest number of stories of a building in any cell. */
static int storeys_most(const struct pound_study *study, int b)
{
	const struct pound_field field = {.type = POUND_FIELD_COUNT,
	                                  .offset = (size_t)b * sizeof(struct pound_building) +
	                                            offsetof(struct pound_building, storeys),
	                                  .part = POUND_PART_BUILDINGS};
	double most = study->scene.buildings[b].storeys;
	for (int s = 0; s < study->n_sweeps; s++)
		for (int k = 0; k < study->sweeps[s].n_values && pound_field_alike(study->sweeps[s].field, field);
		     k++)
			most = fmax(most, study->sweeps[s].values[k]);
	return (int)most;
}

int pound_row_measures(const struct pound_study *study)
{
	struct pound_building buildings[POUND_BUILDINGS_MAX];
	struct pound_scene scene = study->scene;
	memcpy(buildings, study->scene.buildings, sizeof *buildings * (size_t)scene.n_buildings);
	scene.buildings = buildings;
	for (int b = 0; b < scene.n_buildings; b++)
		buildings[b].storeys = storeys_most(study, b);
	return HEAD + pound_row_floors(&scene) * STOREY_DOUBLES + pound_row_contacts(&scene) * CONTACT_DOUBLES;
}

void pound_row_keep(const struct pound_outcome *outcome, int n, double *kept)
{
	const struct pound_row_response *row = outcome->row;
	const int floors = pound_row_floors(outcome->scene), contacts = pound_row_contacts(outcome->scene);
	for (int k = 0; k < n; k++)
		kept[k] = NAN;
	if (outcome->status)
		return;
	kept[HEAD_IMPULSE_SCALE] = row->impulse_scale;
	kept[HEAD_ENERGY] = row->energy_residual;
	kept[HEAD_WORK_IN] = row->work_in;
	memcpy(kept + HEAD, row->storeys, sizeof *row->storeys * (size_t)floors);
	memcpy(kept + HEAD + floors * STOREY_DOUBLES, row->contacts, sizeof *row->contacts * (size_t)contacts);
}

struct pound_row_response pound_row_kept(const struct pound_scene *scene, const double *kept)
{
	const double *storeys = kept + HEAD, *contacts = storeys + pound_row_floors(scene) * STOREY_DOUBLES;
	return (struct pound_row_response){.impulse_scale = kept[HEAD_IMPULSE_SCALE],
	                                   .energy_residual = kept[HEAD_ENERGY],
	                                   .work_in = kept[HEAD_WORK_IN],
	                                   .storeys = (const struct pound_storey_response *)(const void *)storeys,
	                                   .contacts =
	                                       (const struct pound_contact_response *)(const void *)contacts};
}

void pound_row_trial(const struct pound_outcome *outcome, struct pound_trial_run *trial)
{
	const struct pound_scene *scene = outcome->scene;
	const int storeys = pound_row_storeys(scene, 0);
	*trial = (struct pound_trial_run){.displacement = NAN, .demand = NAN, .impulse = NAN, .cpu = NAN};
	if (outcome->status)
		return;
	trial->displacement = outcome->row->storeys[storeys - 1].displacement_max;
	for (int i = 0; i < storeys; i++)
		trial->demand = fmax(trial->demand, outcome->row->storeys[i].demand); // NAN if undefined
	trial->impulse = pound_row_impulse(outcome);
}

double pound_row_impulse(const struct pound_outcome *outcome)
{
	double most = 0, mass = 0;
	for (int k = 0; k < pound_row_contacts(outcome->scene); k++)
		most = fmax(most, outcome->row->contacts[k].impulse_max);
	for (int i = 0; i < pound_row_storeys(outcome->scene, 0); i++)
		mass += pound_each_of(&outcome->scene->buildings[0].mass, i);
	return most / mass;
}

/* ---- from marches ---- */

/* Data of a story: measures of its marches. */
struct storey_known {
	const double *with, *free; /* (POUND_FLOOR_MEASURES); free NULL: not run */
	double yield;              /* [m] scaled; 0: none */
	double given;              /* by the study [m]; 0: found */
	double height;             /* [m] */
	int exponent;
};

static struct pound_storey_response storey_of(const struct storey_known *k)
{
	const int e = k->exponent;
	// a given yield drift may be too small to be represented in the scale of the motion
	const double per_yield = k->yield == 0 ? NAN : k->given > 0 ? k->given : k->yield;
	const int per = k->given > 0 ? e : 0;
	const double *with = k->with, *free = k->free;
	struct pound_storey_response r = {
	    .drift_max = ldexp(with[POUND_FLOOR_DRIFT_MAX], e),
	    .drift_max_free = free ? ldexp(free[POUND_FLOOR_DRIFT_MAX], e) : NAN,
	    .shear_max = ldexp(with[POUND_FLOOR_SHEAR_MAX], e),
	    .yield_drift = k->yield == 0  ? NAN
	                   : k->given > 0 ? k->given
	                                  : ldexp(k->yield, e),
	    .demand = ldexp(with[POUND_FLOOR_DRIFT_MAX] / per_yield, per),
	    .demand_free = free ? ldexp(free[POUND_FLOOR_DRIFT_MAX] / per_yield, per) : NAN,
	    .residual_drift = ldexp(with[POUND_FLOOR_RESIDUAL], e),
	    .displacement_max = ldexp(with[POUND_FLOOR_DISPLACEMENT_MAX], e),
	    .displacement_max_free = free ? ldexp(free[POUND_FLOOR_DISPLACEMENT_MAX], e) : NAN,
	    .acceleration_max = ldexp(with[POUND_FLOOR_ACCELERATION_MAX], e),
	    .acceleration_max_free = free ? ldexp(free[POUND_FLOOR_ACCELERATION_MAX], e) : NAN,
	    .end_u = ldexp(with[POUND_FLOOR_END_U], e),
	    .end_v = ldexp(with[POUND_FLOOR_END_V], e),
	    .lost = ldexp(with[POUND_FLOOR_LOST], 2 * e),
	};
	r.drift_ratio_max = r.drift_max / k->height;
	return r;
}

/* A measure of a contact in the run without contact; NAN: not run. */
static double without(const double *closing, enum pound_link_measure measure, int e)
{
	return closing ? ldexp(closing[measure], e) : NAN;
}

/* Given    closing   measures of the contact in the run without contact; NULL: not run */
static struct pound_contact_response contact_of(const double *link, const double *closing, int e)
{
	return (struct pound_contact_response){
	    .impulse_max = ldexp(link[POUND_LINK_IMPULSE_MAX], e),
	    .force_max = ldexp(link[POUND_LINK_FORCE_MAX], e),
	    .contact_count = link[POUND_LINK_CONTACTS],
	    .contact_time = link[POUND_LINK_TIME],
	    .first_time = link[POUND_LINK_FIRST_TIME],
	    .first_speed = ldexp(link[POUND_LINK_FIRST_SPEED], e),
	    .speed_max = ldexp(link[POUND_LINK_SPEED_MAX], e),
	    .lost = ldexp(link[POUND_LINK_LOST], 2 * e),
	    .gap_needed = without(closing, POUND_LINK_CLOSING_MAX, e),
	    .level_free = {without(closing, POUND_LINK_LEFT_MAX, e), without(closing, POUND_LINK_RIGHT_MAX, e)}};
}

/* Fills the stories of one building; returns the first failure of its marches. */
static enum pound_status building_of(const struct pound_row_asks *asks, const struct pound_scene *scene,
                                     const struct pound_row_ask *ask, int b, int exponent,
                                     struct pound_row_response *row)
{
	static const double still[POUND_FLOOR_MEASURES] = {0};
	const struct pound_building *building = &scene->buildings[b];
	const struct pound_building_ask *known = &ask->buildings[b];
	const struct pound_chain_result *free = known->finished ? &asks->results[known->march] : NULL;
	const int first = pound_row_first(scene, b);
	if (ask->march < 0 && free) {
		row->energy_residual = fmax(row->energy_residual, free->energy_residual);
		row->work_in += ldexp(free->work_in, 2 * exponent);
	}
	for (int i = 0; i < pound_row_storeys(scene, b); i++) {
		const double *alone = free ? free->floors + i * POUND_FLOOR_MEASURES : NULL;
		const double *with = ask->march >= 0
		                         ? asks->results[ask->march].floors + (first + i) * POUND_FLOOR_MEASURES
		                     : alone ? alone
		                             : still;
		const struct storey_known storey = {.with = with,
		                                    .free = alone,
		                                    .yield = ask->yields[first + i],
		                                    .given = pound_row_yield_given(scene, b, i),
		                                    .height = pound_each_of(&building->height, i),
		                                    .exponent = exponent};
		asks->storeys[first + i] = storey_of(&storey);
	}
	return known->status ? known->status : free ? free->status : POUND_OK;
}

/* Whether any of n numbers is infinite. */
static bool beyond(const double *numbers, int n)
{
	int k = 0;
	while (k < n && !isinf(numbers[k]))
		k++;
	return k < n;
}

enum pound_status pound_row_response_of(const struct pound_row_asks *asks, const struct pound_scene *scene,
                                        const struct pound_row_ask *ask, int exponent,
                                        struct pound_row_response *response)
{
	static const double open[POUND_LINK_MEASURES] = {0};
	const struct pound_chain_result *with = ask->march < 0 ? NULL : &asks->results[ask->march];
	const struct pound_chain_result *closing = ask->closing < 0 ? NULL : &asks->results[ask->closing];
	const int floors = pound_row_floors(scene), contacts = pound_row_contacts(scene);
	enum pound_status status = with ? with->status : POUND_OK;
	status = status || !closing ? status : closing->status;
	*response = (struct pound_row_response){.impulse_scale = ask->impulse_scale,
	                                        .energy_residual = with ? with->energy_residual : NAN,
	                                        .work_in = with ? ldexp(with->work_in, 2 * exponent) : 0,
	                                        .storeys = asks->storeys,
	                                        .contacts = asks->contacts};
	for (int b = 0; b < scene->n_buildings; b++) {
		const enum pound_status of_building = building_of(asks, scene, ask, b, exponent, response);
		status = status ? status : of_building;
	}
	for (int k = 0; k < contacts; k++)
		asks->contacts[k] = contact_of(with ? with->links + k * POUND_LINK_MEASURES : open,
		                               closing ? closing->links + k * POUND_LINK_MEASURES : NULL, exponent);
	// the scaled motion is finite, but derived quantities may overflow
	const bool over = beyond(&asks->storeys->drift_max, floors * STOREY_DOUBLES) ||
	                  (contacts && beyond(&asks->contacts->impulse_max, contacts * CONTACT_DOUBLES));
	return over && status == POUND_OK ? POUND_OVERFLOW : status;
}
