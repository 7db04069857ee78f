/* warnings.c - warnings of valid but probably unintended values: a missing mass, g instead of m/s2, a gap that never closes. */
#include "schema/study/warnings.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/building.h"
#include "engine/scene/law.h"
#include "schema/study/study_check.h"

static const double G = 9.80665, PGA_MOST = 3, PGA_LEAST = 0.001; /* [m/s2], [g] */

enum { MASSES_APART = 1000, STEPS_LEAST = 10 };

/* probability of an input beyond the values that count, at each end */
static const double PEAK_TAIL = 0.01, FREQUENCY_TAIL = 0.001;

struct warnings {
	struct writer *w;
	bool open;
};

static void __attribute__((format(printf, 3, 4)))
warn(struct warnings *all, const char *pointer, const char *format, ...)
{
	char detail[256];
	va_list values;
	va_start(values, format);
	vsnprintf(detail, sizeof detail, format, values);
	va_end(values);
	if (!all->open)
		writer_array(all->w, "warnings", WRITER_LINES);
	all->open = true;
	writer_object(all->w, NULL, WRITER_LINE);
	writer_text(all->w, "pointer", pointer);
	writer_text(all->w, "detail", detail);
	writer_end(all->w);
}

/* ---- before a run ---- */

/* Bodies: two oscillators, or the buildings of a row. */
static int bodies_of(const struct pound_study *study)
{
	return study->scene.n_buildings ? study->scene.n_buildings : POUND_OSCILLATORS;
}

static bool is_wall(const struct pound_study *study, int i)
{
	return study->scene.n_buildings ? study->scene.buildings[i].rigid_wall
	                                : study->scene.oscillators[i].rigid_wall;
}

/* The interval of the masses of a body: from the lightest to the heaviest floor, or the range of inputs and sweeps. */
static void masses_of(const struct pound_study *study, int i, char path[static 40], double *low, double *high)
{
	snprintf(path, 40, study->scene.n_buildings ? "/buildings/%d/mass_kg" : "/oscillators/%d/mass_kg", i);
	*low = INFINITY, *high = 0;
	for (int k = 0; study->scene.n_buildings && k < study->scene.buildings[i].mass.n; k++) {
		*low = fmin(*low, study->scene.buildings[i].mass.values[k]);
		*high = fmax(*high, study->scene.buildings[i].mass.values[k]);
	}
	if (!study->scene.n_buildings)
		study_check_reach(study, path, low, high);
}

static void look_at_masses(struct warnings *all, const struct pound_study *study)
{
	char paths[POUND_BUILDINGS_MAX][40];
	double low[POUND_BUILDINGS_MAX], high[POUND_BUILDINGS_MAX], most = 0;
	for (int i = 0; i < bodies_of(study); i++) {
		if (is_wall(study, i))
			continue;
		masses_of(study, i, paths[i], &low[i], &high[i]);
		most = fmax(most, low[i]);
	}
	for (int i = 0; i < bodies_of(study); i++) {
		char pointer[48];
		snprintf(pointer, sizeof pointer, "/scene%.39s", paths[i]);
		if (!is_wall(study, i) && low[i] == 1 && high[i] == 1 && most >= MASSES_APART)
			warn(all, pointer, "is 1 kg, the default, but another mass is %.6g kg: was it left out?", most);
	}
}

/* The interval of a field without the tails of an input, `tail` of its probability each: a distribution without bounds has no
 * largest value. */
static void bulk_of(const struct pound_study *study, const char *path, double tail, double *low, double *high)
{
	study_check_reach(study, path, low, high);
	for (int j = 0; j < study->n_inputs; j++)
		if (study->inputs[j].path && strcmp(study->inputs[j].path, path) == 0) {
			*low = pound_distribution_quantile(&study->inputs[j].distribution, tail);
			*high = pound_distribution_quantile(&study->inputs[j].distribution, 1 - tail);
		}
}

/* The interval of the peak ground accelerations [m/s2]; false: not known. */
static bool peaks_of(const struct pound_study *study, double *low, double *high)
{
	const struct pound_excitation *e = &study->scene.excitation;
	double least = 1, most = 1;
	*low = INFINITY, *high = 0;
	if (study_check_uses(study, "/scene/excitation/peak_m_s2")) {
		bulk_of(study, "/excitation/peak_m_s2", PEAK_TAIL, low, high);
		return true;
	}
	if (e->scale.to > POUND_SCALE_PGA)
		return false;
	const struct pound_record one = {.n = e->n_record, .a = e->record, .factor = 1};
	for (int k = 0; k < (e->n_records ? e->n_records : 1); k++) {
		const struct pound_record *record = e->n_records ? &e->records[k] : &one;
		double peak = 0;
		for (int i = 0; i < record->n; i++)
			peak = fmax(peak, fabs(record->a[i]));
		*low = fmin(*low, peak * record->factor);
		*high = fmax(*high, peak * record->factor);
	}
	if (e->scale.to == POUND_SCALE_PGA)
		bulk_of(study, "/excitation/scale/intensity_m_s2", PEAK_TAIL, low, high);
	bulk_of(study, "/excitation/factor", PEAK_TAIL, &least, &most);
	*low *= least;
	*high *= most;
	return true;
}

static void look_at_peaks(struct warnings *all, const struct pound_study *study)
{
	const char *pointer = study_check_uses(study, "/scene/excitation/peak_m_s2")
	                          ? "/scene/excitation/peak_m_s2"
	                          : "/scene/excitation";
	double low, high;
	if (!peaks_of(study, &low, &high))
		return;
	if (high > PGA_MOST * G)
		warn(all, pointer, "has a peak of %.4g m/s2, %.4g g: is its unit m/s2?", high, high / G);
	if (low < PGA_LEAST * G)
		warn(all, pointer, "has a peak of %.4g m/s2, %.4g g: is its unit m/s2?", low, low / G);
}

/* Frequency of a building's first mode [Hz]; time steps too long for higher modes do little harm. */
static double first_frequency(const struct pound_building *building)
{
	struct pound_storeys storeys;
	pound_building_storeys(building, &storeys);
	return storeys.frequency / (2 * 3.14159265358979323846);
}

/* A building that is added to a row gets no contacts if the contacts are listed. */
static void look_at_neighbors(struct warnings *all, const struct pound_study *study)
{
	const struct pound_scene *scene = &study->scene;
	for (int b = 0; scene->n_contacts > 0 && b + 1 < scene->n_buildings; b++) {
		bool meet = false;
		for (int k = 0; k < scene->n_contacts; k++)
			meet |= scene->contacts[k].left_building == b;
		if (!meet)
			warn(all, "/scene/contacts",
			     "lists no contact between buildings %d and %d: they pass through each other", b, b + 1);
	}
}

/* Height of a level above the ground [m]; NAN: the building has no heights. */
static double elevation(const struct pound_building *building, double level)
{
	double sum = building->height.n > 0 ? 0 : NAN;
	for (int i = 0; i < building->storeys && i < level; i++)
		sum += fmin(1, level - i) * pound_each_of(&building->height, i);
	return sum;
}

/* Whether a contact joins levels at different heights [m]; a rigid wall has every height. */
static bool heights_differ(const struct pound_scene *scene, const struct pound_row_contact *contact,
                           double heights[2])
{
	const double most = 0.02; // levels are written with few digits
	const struct pound_building *left = &scene->buildings[contact->left_building];
	for (int side = 0; side < 2; side++)
		heights[side] = elevation(&left[side], contact->levels[side]);
	return !left[1].rigid_wall && fabs(heights[0] - heights[1]) > most * fmax(heights[0], heights[1]);
}

/* Contacts join levels by number: at other heights they are probably wrong.  Without a list of contacts the first of each gap is
 * named, and the others are counted. */
static void look_at_levels(struct warnings *all, const struct pound_study *study)
{
	const struct pound_scene *scene = &study->scene;
	for (int k = 0; k < pound_row_contacts(scene); k++) {
		struct pound_row_contact contact, next;
		double heights[2], ignored[2];
		char pointer[48] = "/scene/contacts", rest[32] = "";
		int more = 0;
		pound_row_contact_of(scene, k, &contact);
		if (!heights_differ(scene, &contact, heights))
			continue;
		if (scene->n_contacts)
			snprintf(pointer, sizeof pointer, "/scene/contacts/%d/levels", k);
		for (; !scene->n_contacts && k + 1 < pound_row_contacts(scene); k++) {
			pound_row_contact_of(scene, k + 1, &next);
			if (next.left_building != contact.left_building)
				break;
			more += heights_differ(scene, &next, ignored);
		}
		if (more)
			snprintf(rest, sizeof rest, ", and %d more pair%s", more, more == 1 ? "" : "s");
		warn(all, pointer,
		     "join level %.4g of building %d at %.4g m and level %.4g of building %d at %.4g m%s",
		     contact.levels[0], contact.left_building, heights[0], contact.levels[1],
		     contact.left_building + 1, heights[1], rest);
	}
}

/* Rayleigh damping takes the highest mode there is in place of a higher one. */
static void look_at_modes(struct warnings *all, const struct pound_study *study)
{
	for (int b = 0; b < study->scene.n_buildings; b++) {
		const struct pound_building *building = &study->scene.buildings[b];
		const int *modes = building->damping_modes;
		char pointer[48];
		const bool absent = modes[0] == 1 && modes[1] == 3; // the default
		if (building->rigid_wall || !pound_damping_takes_modes(building->damping) || absent ||
		    modes[1] <= building->storeys)
			continue;
		snprintf(pointer, sizeof pointer, "/scene/buildings/%d/damping_modes", b);
		warn(all, pointer, "has mode %d of a building of %d: the highest mode is used instead", modes[1],
		     building->storeys);
	}
}

/* A rigid impact has no finite acceleration. */
static void look_at_rigid(struct warnings *all, const struct pound_study *study)
{
	const struct pound_scene *scene = &study->scene;
	bool reads = study->kind == POUND_KIND_RESPONSE && scene->n_buildings > 0;
	for (int k = 0; k < study->n_outputs; k++) {
		const char *name = pound_output_name(study->outputs[k]);
		reads |= strstr(name, "acceleration") && !strstr(name, "_free_");
	}
	bool jumps = !scene->n_buildings && scene->contact.present &&
	             pound_contact_force(scene->contact.model) == POUND_FORCE_IMPACT;
	for (int k = 0; k < pound_row_contacts(scene) && scene->n_buildings; k++) {
		struct pound_row_contact contact;
		pound_row_contact_of(scene, k, &contact);
		jumps |= pound_contact_force(contact.contact.model) == POUND_FORCE_IMPACT;
	}
	if (reads && jumps)
		warn(all, "/scene/contact/model",
		     "makes velocities jump: accelerations with pounding do not include the impacts");
}

static void look_at_steps(struct warnings *all, const struct pound_study *study)
{
	double fastest = 0, low, high, step = study->scene.excitation.time_step;
	for (int i = 0; i < bodies_of(study); i++) {
		char path[40];
		if (is_wall(study, i))
			continue;
		snprintf(path, sizeof path, "/oscillators/%d/frequency_hz", i);
		if (study->scene.n_buildings)
			high = first_frequency(&study->scene.buildings[i]);
		else
			bulk_of(study, path, FREQUENCY_TAIL, &low, &high);
		fastest = fmax(fastest, high);
	}
	if (study_check_uses(study, "/scene/excitation/time_step_s"))
		study_check_reach(study, "/excitation/time_step_s", &low, &step);
	if (step * fastest > 1.0 / STEPS_LEAST)
		warn(all,
		     study->scene.excitation.n_records ? "/scene/excitation/records"
		                                       : "/scene/excitation/time_step_s",
		     "%.4g s is more than a tenth of the shortest period, %.4g s: linear interpolation weakens the "
		     "ground motion near resonance",
		     step, 1 / fastest);
}

/* ---- after a run ---- */

static void look_at_gap(struct warnings *all, const struct pound_study *study,
                        const struct pound_result *result)
{
	const bool touches = study->scene.contact.present || study->scene.n_contacts > 0;
	if (!touches || !pound_study_pounds(study) || study->kind == POUND_KIND_SEPARATION ||
	    result->work.contacts > 0 || result->work.pounding_runs.asked == 0)
		return;
	double needed = 0;
	for (int cell = 0; cell < result->n_cells && study->kind == POUND_KIND_RESPONSE; cell++)
		for (int s = 0; s < result->cells[cell].n_signals && !study->scene.n_buildings; s++)
			needed = fmax(needed, result->cells[cell].signals[s].gap_needed);
	if (needed > 0)
		warn(all, "/scene/contact/gap_m", "no run has a contact: the largest closing displacement is %.4g m",
		     needed);
	else
		warn(all, study->scene.n_buildings ? "/scene/contacts" : "/scene/contact/gap_m",
		     "no run has a contact");
}

/* Warns of a given yield displacement that no run reaches. */
static void look_at_yield(struct warnings *all, const struct pound_study *study,
                          const struct pound_result *result)
{
	for (int i = 0; i < POUND_OSCILLATORS && study->kind == POUND_KIND_RESPONSE; i++) {
		const struct pound_law *law = pound_scene_law(&study->scene, i);
		double demand = 0;
		char pointer[64];
		if (!(law->yield_displacement > 0) || study->scene.n_buildings ||
		    study->scene.oscillators[i].rigid_wall)
			continue;
		for (int cell = 0; cell < result->n_cells; cell++)
			for (int s = 0; s < result->cells[cell].n_signals; s++) {
				const struct pound_response *one = &result->cells[cell].signals[s];
				const double of[] = {i ? one->demand_2 : one->demand_1,
				                     i ? one->demand_free_2 : one->demand_free_1};
				demand = fmax(demand, fmax(of[0], of[1]));
			}
		snprintf(pointer, sizeof pointer,
		         law == &study->scene.law ? "/scene/law/yield_displacement_m"
		                                  : "/scene/oscillators/%d/law/yield_displacement_m",
		         i);
		if (demand > 0 && demand < 1)
			warn(all, pointer, "is never reached by oscillator %d: its largest demand is %.4g", i, demand);
	}
}

/* Warns of given yield drifts that no run reaches. */
static void look_at_yield_drifts(struct warnings *all, const struct pound_study *study,
                                 const struct pound_result *result)
{
	bool varied = false; // cells may then differ in their storeys
	for (int s = 0; s < study->n_sweeps; s++)
		varied |= study->sweeps[s].field.part == POUND_PART_BUILDINGS;
	for (int b = 0; b < study->scene.n_buildings && study->kind == POUND_KIND_RESPONSE && !varied; b++) {
		const struct pound_building *building = &study->scene.buildings[b];
		const bool own = building->has_law;
		double demand = 0;
		char pointer[64];
		if (is_wall(study, b) ||
		    !(own ? building->yield_drift.n > 0 : study->scene.law.yield_displacement > 0))
			continue;
		for (int cell = 0; cell < result->n_cells; cell++)
			for (int s = 0; s < result->cells[cell].n_signals; s++) {
				const struct pound_storey_response *storeys =
				    &result->cells[cell].rows[s].storeys[pound_row_first(&study->scene, b)];
				for (int i = 0; i < pound_row_storeys(&study->scene, b); i++)
					demand = fmax(demand, fmax(storeys[i].demand, storeys[i].demand_free));
			}
		snprintf(pointer, sizeof pointer,
		         own ? "/scene/buildings/%d/law/yield_displacement_m" : "/scene/law/yield_displacement_m", b);
		if (demand > 0 && demand < 1)
			warn(all, pointer, "is never reached by building %d: its largest demand is %.4g", b, demand);
	}
}

/* Whether yield drifts of a building are found from a target demand. */
static bool has_target(const struct pound_study *study, int b)
{
	const struct pound_building *building = &study->scene.buildings[b];
	return !is_wall(study, b) && !pound_law_linear(pound_row_law(&study->scene, b)->type) &&
	       !(building->has_law ? building->yield_drift.n > 0 : study->scene.law.yield_displacement > 0);
}

static void target_pointer(const struct pound_study *study, int b, char pointer[64])
{
	snprintf(pointer, 64,
	         study->scene.buildings[b].has_law ? "/scene/buildings/%d/law/target_demand"
	                                           : "/scene/law/target_demand",
	         b);
}

/* Demands of stories are in the results of responses alone. */
static void look_at_targets(struct warnings *all, const struct pound_study *study)
{
	const bool reports = study->kind == POUND_KIND_RESPONSE || study->kind == POUND_KIND_CONVERGENCE;
	for (int b = 0; b < study->scene.n_buildings && !reports; b++) {
		char pointer[64];
		if (!has_target(study, b))
			continue;
		target_pointer(study, b, pointer);
		warn(all, pointer,
		     "yield drifts of building %d are set story by story, without a search: demands may be several "
		     "times "
		     "larger or smaller; a response study of this scene reports them",
		     b);
	}
}

/* Demands of stories that are not near their target: yield drifts are set story by story, without a search. */
static void look_at_demands(struct warnings *all, const struct pound_study *study,
                            const struct pound_result *result)
{
	const double off = 1.1;
	bool varied = false; // cells may then differ in their targets and stories
	for (int s = 0; s < study->n_sweeps; s++)
		varied |= study->sweeps[s].field.part == POUND_PART_BUILDINGS ||
		          strncmp(study->sweeps[s].path, "/law/", 5) == 0;
	for (int b = 0; b < study->scene.n_buildings && study->kind == POUND_KIND_RESPONSE && !varied; b++) {
		const struct pound_law *law = pound_row_law(&study->scene, b);
		double least = INFINITY, most = 0;
		char pointer[64];
		if (!has_target(study, b))
			continue;
		for (int cell = 0; cell < result->n_cells; cell++)
			for (int s = 0; s < result->cells[cell].n_signals; s++) {
				const struct pound_storey_response *storeys =
				    &result->cells[cell].rows[s].storeys[pound_row_first(&study->scene, b)];
				for (int i = 0; i < pound_row_storeys(&study->scene, b); i++) {
					least = fmin(least, storeys[i].demand_free);
					most = fmax(most, storeys[i].demand_free);
				}
			}
		target_pointer(study, b, pointer);
		if (most > 0 && (most > off * law->target_demand || off * least < law->target_demand))
			warn(
			    all, pointer,
			    "is %.4g, but demands of building %d without pounding are %.3g to %.3g: yield drifts are set "
			    "story by story, without a search; give yield_displacement_m",
			    law->target_demand, b, least, most);
	}
}

/* Writes the warnings of a study.
 *
 * Test     unit_warnings
 */
void warnings_write(struct writer *w, const struct pound_study *study, const struct pound_result *result)
{
	struct warnings all = {.w = w};
	if (study->elsewhere)
		return;
	look_at_masses(&all, study);
	look_at_neighbors(&all, study);
	look_at_levels(&all, study);
	look_at_modes(&all, study);
	look_at_rigid(&all, study);
	look_at_targets(&all, study);
	look_at_steps(&all, study);
	look_at_peaks(&all, study);
	if (result) {
		look_at_gap(&all, study, result);
		look_at_yield(&all, study, result);
		look_at_yield_drifts(&all, study, result);
		look_at_demands(&all, study, result);
	}
	if (all.open)
		writer_end(w);
}
