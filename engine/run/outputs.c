/* outputs.c - the outputs of a study: each is the ratio of the means of two measures over a scene's signals.
 *
 * To add an output, add its two measures and a row in outputs[]. */
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

// a body that never moves has no demand, but its run did not fail: count it as 0
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

/* Impulse over m1 w1: the resulting displacement amplitude of the left oscillator [m]. */
static double impulse(const struct pound_response *r, const struct pound_scene *scene)
{
	const struct pound_oscillator *o = &scene->oscillators[0];
	return r->impulse_max / (o->mass * (2 * 3.14159265358979323846 * o->frequency_hz));
}

/* Placeholder of a spectral ordinate, which floor_outputs.c fills in; the output is a mean, not a ratio. */
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
                                                     const struct pound_scene *scene, int at)
{
	const struct pound_storey_place *place = &scene->places[at];
	return &row->storeys[pound_row_first(scene, place->building) + place->storey - 1];
}

static double drift(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->drift_max;
}

static double drift_free(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->drift_max_free;
}

static double drift_ratio(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->drift_ratio_max;
}

static double drift_ratio_largest(const struct pound_row_response *row, const struct pound_scene *scene,
                                  int at)
{
	(void)at;
	double most = 0;
	for (int k = 0; k < scene->n_places; k++)
		most = fmax(most, drift_ratio(row, scene, k));
	return most;
}

static double shear(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->shear_max;
}

static double acceleration(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->acceleration_max;
}

static double acceleration_free(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->acceleration_max_free;
}

// a story that never moves has no demand: counted as 0, as for an oscillator
static double storey_demand(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	const double value = storey_of(row, scene, at)->demand;
	return isnan(value) ? 0 : value;
}

static double storey_demand_free(const struct pound_row_response *row, const struct pound_scene *scene,
                                 int at)
{
	const double value = storey_of(row, scene, at)->demand_free;
	return isnan(value) ? 0 : value;
}

/* The largest impulse of all contacts over the mass of building 0 and the frequency of its first mode [m]. */
static double row_impulse(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	double most = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		most = fmax(most, row->contacts[k].impulse_max);
	return most / row->impulse_scale;
}

static double top_free(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	return row->storeys[pound_row_storeys(scene, 0) - 1].displacement_max_free;
}

static double row_absent(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)row, (void)scene, (void)at;
	return 0;
}

static double row_one(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)row, (void)scene, (void)at;
	return 1;
}

static bool right_moves(const struct pound_scene *scene)
{
	return scene->n_buildings == 0 && !scene->oscillators[1].rigid_wall;
}

static bool right_is_linear(const struct pound_scene *scene)
{
	return right_moves(scene) && pound_law_linear(pound_scene_law(scene, 1)->type);
}

static bool right_yields(const struct pound_scene *scene)
{
	return right_moves(scene) && !right_is_linear(scene);
}

static double displacement_right(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->displacement_max_2;
}

static double displacement_free_right(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->displacement_max_free_2;
}

static double demand_right(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return isnan(r->demand_2) ? 0 : r->demand_2;
}

static double demand_free_right(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return isnan(r->demand_free_2) ? 0 : r->demand_free_2;
}

static double impulse_largest(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->impulse_max;
}

static double contact_count(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->contact_count;
}

static double contact_time(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->contact_time;
}

static double touches(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->contact_count > 0;
}

static double floor_displacement(const struct pound_row_response *row, const struct pound_scene *scene,
                                 int at)
{
	return storey_of(row, scene, at)->displacement_max;
}

static double floor_displacement_free(const struct pound_row_response *row, const struct pound_scene *scene,
                                      int at)
{
	return storey_of(row, scene, at)->displacement_max_free;
}

static double residual_drift(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return fabs(storey_of(row, scene, at)->residual_drift);
}

static double row_impulse_largest(const struct pound_row_response *row, const struct pound_scene *scene,
                                  int at)
{
	(void)at;
	double most = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		most = fmax(most, row->contacts[k].impulse_max);
	return most;
}

static double row_force_largest(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	double most = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		most = fmax(most, row->contacts[k].force_max);
	return most;
}

static double row_contact_count(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	double sum = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		sum += row->contacts[k].contact_count;
	return sum;
}

static double row_contact_time(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	double sum = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		sum += row->contacts[k].contact_time;
	return sum;
}

static double row_touches(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return row_contact_count(row, scene, at) > 0;
}

static double gap_needed(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->gap_needed;
}

static double relative_free(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->relative_free;
}

static double approach(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->floors.approach;
}

static double force(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->floors.force;
}

static double lost_contact(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->floors.lost_contact;
}

static double work_in(const struct pound_response *r, const struct pound_scene *scene)
{
	(void)scene;
	return r->floors.work_in;
}

/* of either body as a one-story building */
#define OF_FLOOR(name, member, body)                                                    \
	static double name(const struct pound_response *r, const struct pound_scene *scene) \
	{                                                                                   \
		(void)scene;                                                                    \
		return fabs(r->floors.member[body]);                                            \
	}
OF_FLOOR(acceleration_left, acceleration, 0)
OF_FLOOR(acceleration_right, acceleration, 1)
OF_FLOOR(acceleration_free_left, acceleration_free, 0)
OF_FLOOR(acceleration_free_right, acceleration_free, 1)
OF_FLOOR(residual_left, residual, 0)
OF_FLOOR(residual_right, residual, 1)
OF_FLOOR(lost_left, lost, 0)
OF_FLOOR(lost_right, lost, 1)
#undef OF_FLOOR

static double floor_residual(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	const struct pound_storey_place *place = &scene->places[at];
	const struct pound_storey_response *first = &row->storeys[pound_row_first(scene, place->building)];
	double sum = 0;
	for (int i = 0; i < place->storey; i++)
		sum += first[i].residual_drift;
	return fabs(sum);
}

static double storey_lost(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	return storey_of(row, scene, at)->lost;
}

static double row_lost_contact(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	double sum = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		sum += row->contacts[k].lost;
	return sum;
}

static double row_work_in(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)scene, (void)at;
	return row->work_in;
}

static double row_approach(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)at;
	double most = 0;
	for (int k = 0; k < pound_row_contacts(scene); k++)
		most = fmax(most, row->contacts[k].speed_max);
	return most;
}

static double row_gap_needed(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)scene;
	return row->contacts[at].gap_needed;
}

static double row_left_free(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)scene;
	return row->contacts[at].level_free[0];
}

static double row_right_free(const struct pound_row_response *row, const struct pound_scene *scene, int at)
{
	(void)scene;
	return row->contacts[at].level_free[1];
}

static bool has_levels(const struct pound_scene *scene)
{
	return is_row(scene) && pound_row_contacts(scene) > 0;
}

static bool has_gaps(const struct pound_scene *scene)
{
	return !is_row(scene) || pound_row_contacts(scene) > 0;
}

static bool is_pair(const struct pound_scene *scene)
{
	return scene->n_buildings == 0;
}

typedef double measure(const struct pound_response *, const struct pound_scene *);
typedef double row_measure(const struct pound_row_response *, const struct pound_scene *,
                           int at); /* index of its place or contact */

static const struct output {
	const char *name;
	const char *text;              /* one line of documentation */
	const char *needs, *row_needs; /* required of two oscillators and of a row, or of a study, in words */
	bool (*applies)(const struct pound_scene *);
	measure *of, *over;          /* of two oscillators: the output is mean(of) / mean(over) */
	row_measure *row, *row_over; /* the same for a row of buildings */
	bool places, contacts;       /* of a row: one output for each place, for each contact */
	bool ordinates;              /* one output for each frequency of the spectrum */
	unsigned asks;               /* of enum pound_output_ask */
} outputs[] = {
    // the paper, Eq. (5), (7), (9) and (19)
    {"force_amplification", "largest displacement of the left body, with over without pounding",
     "a linear law of the left oscillator", "two oscillators", left_is_linear, displacement,
     displacement_free, .asks = 0},
    {"demand_amplification",
     "ductility demand of the left body, or of the story at each place, with over without pounding",
     "a nonlinear law of the left oscillator", "a nonlinear law of every building that has a place",
     bodies_yield, demand, demand_free, storey_demand, storey_demand_free, .places = true},
    {"impulse",
     "largest impulse of a contact over m_1 omega_1 times the largest displacement without pounding",
     "a contact", "a contact", bodies_meet, impulse, displacement_free, row_impulse, top_free, .asks = 0},
    {"floor_spectrum",
     "mean ordinate of the response spectrum of the left body, or of the floor at /spectrum/place: one for "
     "each frequency",
     "a sensitivity study", "a sensitivity study", always, absent, one, row_absent, row_one,
     .ordinates = true},
    {"drift_amplification", "largest story drift at each place, with over without pounding", "buildings",
     "buildings", is_row, NULL, NULL, drift, drift_free, .places = true},
    {"acceleration_amplification",
     "largest absolute acceleration of the left body, or of the floor at each place, with over without "
     "pounding",
     "", "", always, acceleration_left, acceleration_free_left, acceleration, acceleration_free,
     .places = true, .asks = POUND_ASKS_ACCELERATIONS | POUND_ASKS_FREE_FLOORS},
    // the right body's amplifications
    {"force_amplification_right", "largest displacement of the right body, with over without pounding",
     "a right oscillator with a linear law", "two oscillators", right_is_linear, displacement_right,
     displacement_free_right, .asks = POUND_ASKS_RIGHT},
    {"demand_amplification_right", "ductility demand of the right body, with over without pounding",
     "a right oscillator with a nonlinear law", "two oscillators", right_yields, demand_right,
     demand_free_right, .asks = POUND_ASKS_RIGHT},
    // means
    {"peak_displacement_m", "largest displacement of the left body, or of the floor at each place [m]", "",
     "", always, displacement, one, floor_displacement, row_one, .places = true},
    {"peak_displacement_right_m", "largest displacement of the right body [m]", "a right oscillator",
     "two oscillators", right_moves, displacement_right, one, .asks = POUND_ASKS_RIGHT},
    {"peak_displacement_free_m",
     "largest displacement of the left body, or of the floor at each place, without pounding [m]", "", "",
     always, displacement_free, one, floor_displacement_free, row_one, .places = true},
    {"peak_displacement_free_right_m", "largest displacement of the right body without pounding [m]",
     "a right oscillator", "two oscillators", right_moves, displacement_free_right, one,
     .asks = POUND_ASKS_RIGHT},
    {"ductility_demand", "ductility demand of the left body, or of the story at each place",
     "a nonlinear law of the left oscillator", "a nonlinear law of every building that has a place",
     bodies_yield, demand, one, storey_demand, row_one, .places = true},
    {"ductility_demand_right", "ductility demand of the right body",
     "a right oscillator with a nonlinear law", "two oscillators", right_yields, demand_right, one,
     .asks = POUND_ASKS_RIGHT},
    {"peak_drift_m", "largest drift of the story at each place [m]", "buildings", "buildings", is_row, NULL,
     NULL, drift, row_one, .places = true},
    {"peak_drift_free_m", "largest drift of the story at each place, without pounding [m]", "buildings",
     "buildings", is_row, NULL, NULL, drift_free, row_one, .places = true},
    {"peak_drift_ratio", "largest drift of the story at each place over its height", "buildings", "buildings",
     is_row, NULL, NULL, drift_ratio, row_one, .places = true},
    {"largest_drift_ratio", "largest drift ratio of the stories at all places, by default of building 0",
     "buildings", "buildings", is_row, NULL, NULL, drift_ratio_largest, row_one, .asks = 0},
    {"peak_shear_n", "largest spring force of the story at each place; of a first story, the base shear [N]",
     "buildings", "buildings", is_row, NULL, NULL, shear, row_one, .places = true},
    {"residual_drift_m", "magnitude of the residual drift of the story at each place [m]", "buildings",
     "buildings", is_row, NULL, NULL, residual_drift, row_one, .places = true},
    {"peak_acceleration_m_s2",
     "largest absolute acceleration of the left body, or of the floor at each place [m/s2]", "", "", always,
     acceleration_left, one, acceleration, row_one, .places = true, .asks = POUND_ASKS_ACCELERATIONS},
    {"peak_acceleration_free_m_s2",
     "largest absolute acceleration of the left body, or of the floor at each place, without pounding [m/s2]",
     "", "", always, acceleration_free_left, one, acceleration_free, row_one, .places = true,
     .asks = POUND_ASKS_ACCELERATIONS | POUND_ASKS_FREE_FLOORS},
    {"pounding_probability", "share of the signals in which bodies touch: 1 or 0 for each", "a contact",
     "a contact", bodies_meet, touches, one, row_touches, row_one, .asks = 0},
    {"contact_count", "number of contacts, of all gaps", "a contact", "a contact", bodies_meet, contact_count,
     one, row_contact_count, row_one, .asks = 0},
    {"contact_time_s", "time in contact, added up over all gaps [s]", "a contact", "a contact", bodies_meet,
     contact_time, one, row_contact_time, row_one, .asks = 0},
    {"peak_impulse_n_s", "largest impulse of one contact [N s]", "a contact", "a contact", bodies_meet,
     impulse_largest, one, row_impulse_largest, row_one, .asks = 0},
    {"peak_contact_force_n", "largest force that pushes in a contact [N]", "a contact", "a contact",
     bodies_meet, force, one, row_force_largest, row_one, .asks = POUND_ASKS_FORCES},
    {"gap_needed_m",
     "largest closing displacement u_1 - u_2 without contact, of the bodies or at each contact of a row [m]",
     "", "a contact", has_gaps, gap_needed, one, row_gap_needed, row_one, .contacts = true,
     .asks = POUND_ASKS_FREE_PAIR},
    {"level_displacement_free_left_m",
     "largest displacement of the left building at the level of each contact, without contact [m]",
     "buildings", "a contact", has_levels, NULL, NULL, row_left_free, row_one, .contacts = true,
     .asks = POUND_ASKS_FREE_PAIR},
    {"level_displacement_free_right_m",
     "largest displacement of the right building at the level of each contact, without contact [m]",
     "buildings", "a contact", has_levels, NULL, NULL, row_right_free, row_one, .contacts = true,
     .asks = POUND_ASKS_FREE_PAIR},
    {"peak_relative_displacement_free_m", "largest abs(u_1 - u_2) of the bodies without contact [m]",
     "two oscillators", "two oscillators", is_pair, relative_free, one, .asks = POUND_ASKS_FREE_PAIR},
    {"peak_approach_speed_m_s", "largest speed at which a contact begins [m/s]", "a contact", "a contact",
     bodies_meet, approach, one, row_approach, row_one, .asks = POUND_ASKS_STILL},
    {"acceleration_amplification_right",
     "largest absolute acceleration of the right body, with over without pounding", "a right oscillator",
     "two oscillators", right_moves, acceleration_right, acceleration_free_right,
     .asks = POUND_ASKS_ACCELERATIONS | POUND_ASKS_FREE_FLOORS},
    {"peak_acceleration_right_m_s2", "largest absolute acceleration of the right body [m/s2]",
     "a right oscillator", "two oscillators", right_moves, acceleration_right, one,
     .asks = POUND_ASKS_ACCELERATIONS},
    {"peak_acceleration_free_right_m_s2",
     "largest absolute acceleration of the right body without pounding [m/s2]", "a right oscillator",
     "two oscillators", right_moves, acceleration_free_right, one,
     .asks = POUND_ASKS_ACCELERATIONS | POUND_ASKS_FREE_FLOORS},
    {"residual_displacement_m",
     "magnitude of the residual displacement of the left body, or of the floor at each place [m]",
     "a nonlinear law of the left oscillator", "a nonlinear law of every building that has a place",
     bodies_yield, residual_left, one, floor_residual, row_one, .places = true, .asks = POUND_ASKS_STILL},
    {"residual_displacement_right_m", "magnitude of the residual displacement of the right body [m]",
     "a right oscillator with a nonlinear law", "two oscillators", right_yields, residual_right, one,
     .asks = POUND_ASKS_STILL},
    {"contact_energy_ratio", "energy lost in contacts over the energy that the ground puts in", "a contact",
     "a contact", bodies_meet, lost_contact, work_in, row_lost_contact, row_work_in,
     .asks = POUND_ASKS_ENERGIES},
    {"hysteresis_energy_ratio",
     "energy lost by the law of the left body, or of the story at each place, over the energy that the "
     "ground "
     "puts in",
     "a nonlinear law of the left oscillator", "a nonlinear law of every building that has a place",
     bodies_yield, lost_left, work_in, storey_lost, row_work_in, .places = true, .asks = POUND_ASKS_ENERGIES},
    {"hysteresis_energy_ratio_right",
     "energy lost by the law of the right body over the energy that the ground puts in",
     "a right oscillator with a nonlinear law", "two oscillators", right_yields, lost_right, work_in,
     .asks = POUND_ASKS_ENERGIES},
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

bool pound_output_observes(int row, const struct pound_scene *scene)
{
	return is_pair(scene) && outputs[row].asks & (POUND_ASKS_FREE_PAIR | POUND_ASKS_CHAIN);
}

bool pound_output_has_ordinates(int row)
{
	return outputs[row].ordinates;
}

/* The frequency index of an output: the number of earlier outputs with ordinates. */
int pound_study_ordinate(const struct pound_study *study, int output)
{
	int k = 0;
	if (study->elsewhere || !outputs[study->outputs[output]].ordinates)
		return -1;
	for (int o = 0; o < output; o++)
		k += outputs[study->outputs[o]].ordinates;
	return k;
}

/* Additional data that the outputs of a study read, beyond what every study computes. */
unsigned pound_outputs_asked(const struct pound_study *study)
{
	unsigned asked = 0;
	for (int o = 0; o < study->n_outputs && !study->elsewhere; o++)
		asked |= outputs[study->outputs[o]].asks;
	return asked;
}

bool pound_output_has_places(int row, const struct pound_scene *scene)
{
	return scene->n_buildings > 0 && outputs[row].places;
}

bool pound_output_has_contacts(int row, const struct pound_scene *scene)
{
	return scene->n_buildings > 0 && outputs[row].contacts;
}

/* The number of earlier outputs of the study with the same row. */
static int before(const struct pound_study *study, int output)
{
	int k = 0;
	for (int o = 0; o < output; o++)
		k += study->outputs[o] == study->outputs[output];
	return k;
}

int pound_study_place(const struct pound_study *study, int output)
{
	const bool has = !study->elsewhere && pound_output_has_places(study->outputs[output], &study->scene);
	return has ? before(study, output) : -1;
}

int pound_study_contact(const struct pound_study *study, int output)
{
	const bool has = !study->elsewhere && pound_output_has_contacts(study->outputs[output], &study->scene);
	return has ? before(study, output) : -1;
}

bool pound_output_applies(int row, const struct pound_scene *scene)
{
	return outputs[row].applies(scene);
}

/* The two measures of an output for one signal. */
void pound_outputs_measure(const struct pound_study *study, int output, const struct pound_outcome *outcome,
                           double *numerator, double *denominator)
{
	const struct output *row = &outputs[study->outputs[output]];
	const struct pound_scene *scene = outcome->scene;
	if (scene->n_buildings == 0) {
		*numerator = row->of(outcome->pair, scene);
		*denominator = row->over(outcome->pair, scene);
		return;
	}
	const int at = before(study, output);
	*numerator = row->row(outcome->row, scene, at);
	*denominator = row->row_over(outcome->row, scene, at);
}
