/* study_check.c - checks between the members of a study: paths, ranges of varied fields, outputs, solvers.
 *
 * A check is skipped if a member it depends on is invalid itself: one mistake gives one problem. */
#include "schema/study/study_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/study/field_types.h"
#include "schema/study/study_buildings.h"
#include "schema/study/study_json.h"
#include "schema/study/study_separation.h"
#include "schema/study/study_size.h"
#include "schema/study/study_spectrum.h"
#include "schema/study/study_suite.h"

enum { POINTER_SIZE = 64 };

/* ---- paths ---- */

struct pound_field study_check_field(const char *path)
{
	// the lists of a scene; offsets in fields.c belong to the first element
	static const struct {
		const char *pattern;
		enum pound_part part;
		size_t start, size; /* origin of offsets, size of an element [bytes] */
	} lists[] = {
	    {"/scene/oscillators/", POUND_PART_SCENE, offsetof(struct pound_study, scene),
	     sizeof(struct pound_oscillator)},
	    {"/scene/buildings/", POUND_PART_BUILDINGS, 0, sizeof(struct pound_building)},
	    {"/scene/contacts/", POUND_PART_CONTACTS, 0, sizeof(struct pound_row_contact)},
	    {"/scene/", POUND_PART_SCENE, offsetof(struct pound_study, scene), 0},
	};
	struct field_place place;
	const struct field *field = fields_scene(path, &place);
	size_t k = 0;
	while (!fields_within(field, &lists[k].pattern, 1))
		k++;
	const bool each = field->type == FIELD_EACH;
	const size_t shift = (lists[k].size ? (size_t)place.element * lists[k].size : 0) +
	                     (place.index >= 0 && !each ? (size_t)place.index * sizeof(double) : 0);
	return (struct pound_field){.type = field_types[field->type].varied,
	                            .offset = field->offset - lists[k].start + shift,
	                            .part = lists[k].part,
	                            .storey = each ? place.index + 1 : 0};
}

/* Whether the members that decide whether varying a field has an effect are valid. */
static bool effect_known(const struct pound_study *study, const struct field *field, struct field_place place,
                         const struct problems *problems)
{
	static const struct {
		const char *within;    /* start of the pattern of a field */
		const char *decide[4]; /* members; %d is the element of the field's list */
	} rows[] = {
	    {"/scene/oscillators/", {"/scene/oscillators/%d"}},
	    {"/scene/buildings/", {"/scene/buildings/%d"}},
	    {"/scene/buildings/*/height_m", {"/outputs"}},
	    {"/scene/contacts/", {"/scene/contacts/%d", "/outputs"}},
	    {"/scene/contact/", {"/scene/contact", "/scene/contacts", "/outputs"}},
	    {"/scene/law/", {"/scene/law", "/scene/buildings", "/scene/oscillators"}},
	    {"/scene/excitation/scale/", {"/scene/excitation/scale"}},
	};
	// which of them a scene has
	bool is = !problems_over(problems, "/scene/oscillators") &&
	          !problems_over(problems, "/scene/buildings") && !problems_over(problems, "/scene/contacts");
	for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++)
		for (int i = 0; fields_within(field, &rows[k].within, 1) && rows[k].decide[i]; i++) {
			char pointer[POINTER_SIZE];
			snprintf(pointer, sizeof pointer, rows[k].decide[i], place.element);
			is &= !problems_at(problems, pointer);
		}
	const bool of_storey = fields_within(field, &rows[1].within, 1) && place.index >= 0;
	return is && (!of_storey || study_storeys_known(study, place.element, problems));
}

static void check_path(const struct pound_study *study, const char *path, bool input, const char *pointer,
                       struct problems *problems)
{
	char nearest[128];
	struct field_place place;
	const struct pound_scene *scene = &study->scene;
	const struct field *field = fields_scene(path, &place);
	const char *excitation = pound_excitation_name(scene->excitation.type);
	if (strncmp(path, "/excitation/acceleration_m_s2/", 30) == 0)
		field = fields_find("/scene/excitation/acceleration_m_s2/*");
	const int beyond = study_building_beyond(study, path, problems);
	if (beyond >= 0)
		problems_add(problems, pointer, "there is no building %d in this scene: the last is building %d",
		             beyond, study->scene.n_buildings - 1);
	else if (!field && fields_nearest_path(path, input, nearest, sizeof nearest))
		problems_add(problems, pointer, "no such field in \"scene\", did you mean \"%s\"?", nearest);
	else if (!field)
		problems_add(problems, pointer,
		             *nearest ? "no such field in \"scene\"; one that may vary there is \"%s\""
		                      : "must be a JSON Pointer into \"scene\", such as \"/contact/restitution\"",
		             nearest);
	else if (field->fixed)
		problems_add(problems, pointer, "this field cannot vary: %s", field->fixed);
	else if (!field_types[field->type].number)
		problems_add(problems, pointer, "names an object or a list, not a single field");
	else if (!fields_vary(field, input))
		problems_add(problems, pointer, "this field is not a real number; only a sweep can vary it");
	else if (problems_over(problems, "/scene/excitation/type") ||
	         problems_at(problems, "/scene/excitation/type"))
		return;
	else if (!fields_used(field, NULL, excitation, NULL))
		problems_add(problems, pointer, "this field is not used by excitation \"%s\"", excitation);
	else if (!effect_known(study, field, place, problems))
		return;
	else if (study_idle(study, field, place))
		problems_add(problems, pointer, "%s", study_idle(study, field, place));
}

/* Inputs and sweeps in one list, as both have paths. */
struct varied {
	const char *list; /* "inputs" or "sweep" */
	int index;
	const char *path; /* NULL: invalid */
	const char *name; /* of an input */
};

static int varied_all(const struct pound_study *study, struct varied all[POUND_INPUTS_MAX + POUND_SWEEPS_MAX])
{
	int n = 0;
	for (int j = 0; j < study->n_inputs; j++)
		all[n++] = (struct varied){"inputs", j, study->inputs[j].path, study->inputs[j].name};
	for (int s = 0; s < study->n_sweeps; s++)
		all[n++] = (struct varied){"sweep", s, study->sweeps[s].path, NULL};
	return n;
}

/* Whether one of two paths names all storeys of a building and the other one of them. */
static bool storeys_overlap(const char *a, const char *b)
{
	struct field_place place;
	return fields_scene(a, &place) && fields_scene(b, &place) &&
	       pound_field_overlaps(study_check_field(a), study_check_field(b));
}

static bool path_refused(const struct varied *varied, const struct problems *problems)
{
	char pointer[POINTER_SIZE];
	snprintf(pointer, sizeof pointer, "/%s/%d/path", varied->list, varied->index);
	return problems_at(problems, pointer);
}

static void check_paths(const struct pound_study *study, struct problems *problems)
{
	struct varied all[POUND_INPUTS_MAX + POUND_SWEEPS_MAX];
	int n = varied_all(study, all);
	for (int i = 0; i < n; i++) {
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/%s/%d/path", all[i].list, all[i].index);
		if (all[i].path && !study->elsewhere)
			check_path(study, all[i].path, all[i].name != NULL, pointer, problems);
		for (int k = 0; k < i && all[i].path; k++)
			if (all[k].path && strcmp(all[i].path, all[k].path) == 0) {
				problems_add(problems, pointer, "names the same field as /%s/%d", all[k].list, all[k].index);
				break;
			} else if (all[k].path && !problems_at(problems, pointer) && !path_refused(&all[k], problems) &&
			           storeys_overlap(all[i].path, all[k].path)) {
				problems_add(problems, pointer, "names a story that /%s/%d names too", all[k].list,
				             all[k].index);
				break;
			}
	}
}

/* Names of inputs, ratios and groups name columns and rows of results: each must be unique.
 *
 * Given    list, n   where the name is: "inputs", "ratios" or "groups", and the index there
 */
static void check_name(const struct pound_study *study, const char *list, int n, const char *name,
                       struct problems *problems)
{
	char pointer[POINTER_SIZE];
	const bool group = strcmp(list, "groups") == 0, ratio = strcmp(list, "ratios") == 0;
	const bool is_path = !group && !ratio && name == study->inputs[n].path;
	snprintf(pointer, sizeof pointer, "/%s/%d/name", list, n);
	for (int k = 0; name && k < (group || ratio ? study->n_inputs : n); k++) {
		const struct pound_input *other = &study->inputs[k];
		// two absent names are equal if their paths are, which check_paths reports
		if (other->name && strcmp(other->name, name) == 0 && !(is_path && other->name == other->path)) {
			problems_add(problems, pointer, "is already the name of /inputs/%d", k);
			return;
		}
	}
	for (int k = 0; name && group && k < n; k++)
		if (study->groups[k].name && strcmp(study->groups[k].name, name) == 0) {
			problems_add(problems, pointer, "is already the name of /groups/%d", k);
			return;
		}
	for (int k = 0; name && (group || ratio) && k < (group ? study->n_ratios : n); k++)
		if (study->ratios[k].name && strcmp(study->ratios[k].name, name) == 0) {
			problems_add(problems, pointer, "is already the name of /ratios/%d", k);
			return;
		}
}

/* Columns of the samples must differ, too: no input may have the name of another column. */
static void check_names(const struct pound_study *study, struct problems *problems)
{
	for (int k = 0; k < study->n_ratios; k++)
		check_name(study, "ratios", k, study->ratios[k].name, problems);
	for (int g = 0; g < study->n_groups; g++)
		check_name(study, "groups", g, study->groups[g].name, problems);
	for (int j = 0; j < study->n_inputs; j++) {
		const char *name = study->inputs[j].name;
		check_name(study, "inputs", j, name, problems);
		bool taken = name && (strcmp(name, "row") == 0 || strcmp(name, "sample") == 0);
		for (int o = 0; name && !study->elsewhere && pound_output_name(o); o++) {
			size_t length = strlen(pound_output_name(o));
			taken |=
			    strncmp(name, pound_output_name(o), length) == 0 &&
			    (!name[length] || strcmp(name + length, ".variance") == 0 || pound_output_has_ordinates(o));
		}
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/inputs/%d/name", j);
		if (taken)
			problems_add(problems, pointer,
			             "is already the name of a column of the samples (row, sample or an output); "
			             "expected another name");
		else if (study->elsewhere && !name && !study->inputs[j].path)
			problems_add(problems, pointer, "is required: a string of 1 to 100 characters");
	}
}

/* ---- ranges of varied fields ---- */

static bool has_parameter(const struct pound_distribution *distribution, const char *name)
{
	if (pound_distribution_lists_values(distribution->type))
		return true;
	for (int k = 0; pound_distribution_parameter(distribution->type, k); k++)
		if (strcmp(pound_distribution_parameter(distribution->type, k), name) == 0)
			return true;
	return false;
}

/* Whether every value of a distribution is in a field's range.  A bound that is a parameter of the distribution counts as a
 * value, any other bound (0 of a lognormal) does not. */
static bool supports(const struct field *field, const struct pound_distribution *distribution)
{
	double low, high;
	pound_distribution_support(distribution, &low, &high);
	bool from = fields_in_range(field, low) || (low == field->min && !has_parameter(distribution, "min"));
	bool to = fields_in_range(field, high) || (high == field->max && !has_parameter(distribution, "max"));
	return from && to;
}

static void check_supports(const struct pound_study *study, struct problems *problems)
{
	for (int j = 0; j < study->n_inputs; j++) {
		char pointer[POINTER_SIZE], range[80];
		double low, high;
		struct field_place place;
		const struct pound_input *input = &study->inputs[j];
		snprintf(pointer, sizeof pointer, "/inputs/%d/path", j);
		bool found = input->path && !problems_at(problems, pointer);
		snprintf(pointer, sizeof pointer, "/inputs/%d/distribution", j);
		if (!found || problems_at(problems, pointer) || problems_over(problems, pointer))
			continue;
		const struct field *field = fields_scene(input->path, &place);
		if (supports(field, &input->distribution))
			continue;
		pound_distribution_support(&input->distribution, &low, &high);
		fields_range(field, range, sizeof range);
		problems_add(problems, pointer, "gives values from %.15g to %.15g, but %s must be %s%s", low, high,
		             input->path, range,
		             isinf(low) ? ": truncated_normal, lognormal_median and uniform have bounds" : "");
	}
}

/* The interval of a field of the scene over all samples and cells. */
void study_check_reach(const struct pound_study *study, const char *path, double *low, double *high)
{
	struct pound_field field = study_check_field(path);
	*low = *high = pound_scene_field(&study->scene, field);
	for (int j = 0; j < study->n_inputs; j++)
		if (pound_field_alike(study->inputs[j].field, field))
			pound_distribution_support(&study->inputs[j].distribution, low, high);
	for (int s = 0; s < study->n_sweeps; s++) {
		const struct pound_sweep *sweep = &study->sweeps[s];
		if (!pound_field_alike(sweep->field, field))
			continue;
		*low = *high = sweep->values[0];
		for (int i = 1; i < sweep->n_values; i++) {
			*low = fmin(*low, sweep->values[i]);
			*high = fmax(*high, sweep->values[i]);
		}
	}
}

/* Whether an invalid path may have been meant for a field that an input or a sweep may vary: it names no other field, and is not
 * near to the path of one. */
static bool may_mean(const struct varied *invalid, const char *path)
{
	char nearest[128];
	struct field_place place;
	const struct field *field = fields_scene(path, &place);
	return !fields_scene(invalid->path, &place) && field && fields_vary(field, invalid->name) &&
	       (!fields_nearest_path(invalid->path, invalid->name, nearest, sizeof nearest) ||
	        strcmp(nearest, path) == 0);
}

/* Whether a field's interval is known in spite of other problems: the field is valid, and so are inputs and sweeps of it. */
bool study_check_known(const struct pound_study *study, const char *path, const struct problems *problems)
{
	struct varied all[POUND_INPUTS_MAX + POUND_SWEEPS_MAX];
	int n = varied_all(study, all);
	char pointer[POINTER_SIZE];
	snprintf(pointer, sizeof pointer, "/scene%s", path);
	if (problems_at(problems, pointer) || problems_over(problems, pointer))
		return false;
	for (int i = 0; i < n; i++) {
		const bool here = all[i].path && strcmp(all[i].path, path) == 0;
		if (!all[i].path || (path_refused(&all[i], problems) && (here || may_mean(&all[i], path))))
			return false;
		snprintf(pointer, sizeof pointer, "/%s/%d", all[i].list, all[i].index);
		if (problems_over(problems, pointer))
			return false;
		snprintf(pointer, sizeof pointer, "/%s/%d/%s", all[i].list, all[i].index,
		         all[i].name ? "distribution" : "values");
		if (here && problems_at(problems, pointer))
			return false;
	}
	return !problems_over(problems, "/inputs") && !problems_over(problems, "/sweep");
}

bool study_check_uses(const struct pound_study *study, const char *pattern)
{
	return fields_used(fields_find(pattern), NULL, pound_excitation_name(study->scene.excitation.type), NULL);
}

/* The same for all fields of a list that ends with NULL. */
static bool all_known(const struct pound_study *study, const char *const paths[],
                      const struct problems *problems)
{
	while (*paths && study_check_known(study, *paths, problems))
		paths++;
	return !*paths;
}

/* Whether the length of the ground motion is known. */
bool study_check_steps_known(const struct pound_study *study, const struct problems *problems)
{
	static const char *const all[] = {"/excitation/type", "/excitation/time_step_s",
	                                  "/excitation/acceleration_m_s2", "/excitation/records", NULL},
	                         *const by_cycles[] = {"/excitation/cycles", "/excitation/frequency_hz", NULL},
	                         *const by_duration[] = {"/excitation/duration_s", NULL};
	if (!all_known(study, all, problems))
		return false;
	return study->scene.excitation.n_record || study->scene.excitation.n_records ||
	       all_known(study, study_check_uses(study, "/scene/excitation/cycles") ? by_cycles : by_duration,
	                 problems);
}

/* A sine with fewer than two samples per cycle would appear as a slower sine (aliasing). */
static void check_harmonic(const struct pound_study *study, struct problems *problems)
{
	static const char *const wave[] = {"/excitation/type", "/excitation/frequency_hz",
	                                   "/excitation/time_step_s", NULL};
	double low, frequency, step;
	if (!all_known(study, wave, problems) || !study_check_uses(study, "/scene/excitation/frequency_hz") ||
	    study_check_uses(study, "/scene/excitation/signals"))
		return;
	study_check_reach(study, "/excitation/frequency_hz", &low, &frequency);
	study_check_reach(study, "/excitation/time_step_s", &low, &step);
	if (!(2 * frequency * step < 1))
		problems_add(
		    problems, "/scene/excitation/frequency_hz",
		    "a sine needs more than two samples per cycle: at a time step of %.15g s it must be below "
		    "%.15g Hz, got %.15g",
		    step, 0.5 / step, frequency);
}

static void check_excitation(const struct pound_study *study, struct problems *problems)
{
	static const char *const envelope[] = {"/excitation/type", "/excitation/rise", "/excitation/fall", NULL};
	double low, rise, fall, least, most;
	if (all_known(study, envelope, problems) && study_check_uses(study, "/scene/excitation/rise")) {
		study_check_reach(study, "/excitation/rise", &low, &rise);
		study_check_reach(study, "/excitation/fall", &low, &fall);
		if (rise + fall > 1.0)
			problems_add(problems, "/scene/excitation/fall", "rise + fall must be at most 1, got %.15g",
			             rise + fall);
	}
	check_harmonic(study, problems);
	if (!study_check_steps_known(study, problems))
		return;
	study_size_steps(study, &least, &most);
	if (!(least >= 1.0))
		problems_add(problems, "/scene/excitation/time_step_s",
		             "the ground motion must last at least one time step; the shortest lasts %.3g of one",
		             least);
	if (!(most < STUDY_SAMPLES_MAX))
		problems_exceed(problems, "/scene/excitation/time_step_s", most + 1, STUDY_SAMPLES_MAX,
		                "a ground motion may have at most %d samples; the longest has %.3g",
		                STUDY_SAMPLES_MAX, most + 1);
}

/* ---- outputs ---- */

bool study_check_applies(const struct pound_study *study, int output)
{
	for (int cell = 0; cell < study_cells(study); cell++) {
		struct pound_scene scene;
		study_cell(study, cell, &scene);
		if (pound_output_applies(output, &scene))
			return true;
	}
	return false;
}

/* Whether an output would apply if all bodies had one law. */
static bool applies_with_a_law(const struct pound_study *study, int output)
{
	struct pound_scene scene = study->scene;
	struct pound_building buildings[POUND_BUILDINGS_MAX];
	for (int k = 0; k < POUND_OSCILLATORS; k++)
		scene.oscillators[k].has_law = false;
	for (int b = 0; b < scene.n_buildings; b++) {
		buildings[b] = study->scene.buildings[b];
		buildings[b].has_law = false;
	}
	scene.buildings = buildings;
	scene.n_places = 0;
	bool applies = false;
	for (int row = 0; pound_law_name(row); row++) {
		scene.law.type = row;
		applies |= pound_output_applies(output, &scene);
	}
	return applies;
}

/* Whether an output would apply at a story of some building, if the places were others. */
static bool applies_at_a_place(const struct pound_study *study, int output)
{
	struct pound_study other = *study;
	struct pound_storey_place place = {.storey = 1};
	other.scene.places = &place;
	other.scene.n_places = 1;
	bool applies = false;
	for (; place.building < study->scene.n_buildings; place.building++)
		applies |= !study->scene.buildings[place.building].rigid_wall && study_check_applies(&other, output);
	return applies;
}

/* Whether the members that decide which bodies and contacts a scene has are valid. */
static bool bodies_known(const struct problems *problems)
{
	static const char *const lists[] = {"/scene/oscillators", "/scene/oscillators/1/rigid_wall",
	                                    "/scene/buildings", "/scene/contact"};
	bool is = true;
	for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++)
		is &= !problems_over(problems, lists[k]);
	return is;
}

static void check_outputs(const struct pound_study *study, struct problems *problems)
{
	// an invalid law may be meant to be any
	static const char *const needed[] = {"/law/type", "/oscillators/0/law/type", "/oscillators/1/law/type",
	                                     NULL};
	if (!bodies_known(problems))
		return;
	const bool places = !problems_at(problems, "/places");
	bool laws = all_known(study, needed, problems);
	for (int b = 0; b < study->scene.n_buildings; b++) {
		char law[POINTER_SIZE];
		snprintf(law, sizeof law, "/buildings/%d/law/type", b);
		laws &= study_check_known(study, law, problems);
	}
	for (int o = 0; o < study->n_outputs; o++) {
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/outputs/%d", o);
		if (problems_at(problems, pointer))
			continue;
		if (pound_output_observes(study->outputs[o], &study->scene) && !problems_at(problems, "/solver") &&
		    !pound_solver_is_observed(study->solver.method))
			problems_add(problems, pointer, "cannot be computed with the solver \"%s\", only with \"event\"",
			             pound_solver_name(study->solver.method));
		if (!study_check_applies(study, study->outputs[o]) &&
		    (places || !applies_at_a_place(study, study->outputs[o])) &&
		    (laws || !applies_with_a_law(study, study->outputs[o])))
			problems_add(problems, pointer, "does not apply to this scene: it needs %s",
			             pound_output_needs(study->outputs[o], &study->scene));
	}
}

/* ---- solvers ---- */

bool study_check_solves(const struct pound_study *study, int solver)
{
	bool uses = study->kind != POUND_KIND_CONVERGENCE && study->solver.method == solver;
	for (int j = 0; study->kind == POUND_KIND_CONVERGENCE && j < pound_convergence_trials(study); j++)
		uses |= pound_convergence_solver(study, j).method == solver;
	return uses;
}

static bool takes_force(const struct pound_scene *scene, int solver, enum pound_force force)
{
	return scene->n_buildings ? pound_solver_takes_row_force(solver, force)
	                          : pound_solver_takes_force(solver, force);
}

/* Every solver of the study must support every contact model of its cells; otherwise the study is refused, as models and solvers
 * are never replaced silently. */
static void check_forces(const struct pound_study *study, struct problems *problems)
{
	static const char *const needed[] = {"/contact/model", NULL};
	static const char pointer[] = "/scene/contact/model";
	if (!all_known(study, needed, problems) || problems_at(problems, "/solver") ||
	    problems_at(problems, "/convergence") || problems_at(problems, "/outputs") || !bodies_known(problems))
		return;
	for (int cell = 0; cell < study_cells(study) && !problems_at(problems, pointer); cell++) {
		struct pound_scene scene;
		study_cell(study, cell, &scene);
		if (!scene.contact.present)
			continue;
		enum pound_force force = pound_contact_force(scene.contact.model);
		for (int row = 0; row < POUND_SOLVERS; row++)
			if (study_check_solves(study, row) && !takes_force(&scene, row, force))
				problems_add(problems, pointer,
				             "the solver \"%s\" cannot integrate the contact model \"%s\"%s",
				             pound_solver_name(row), pound_contact_name(scene.contact.model),
				             scene.n_buildings ? " between buildings" : "");
	}
}

/* ---- design ---- */

static void check_order(const struct pound_study *study, struct problems *problems)
{
	const char *order = pound_order_name(study->design.order);
	if (pound_study_sampled(study) && strcmp(order, "factorial") == 0 &&
	    study->n_inputs > POUND_FACTORIAL_INPUTS_MAX)
		problems_add(
		    problems, "/design/order",
		    "\"factorial\" runs all 2^n_inputs mixtures of A and B, so it takes at most %d inputs, got %d",
		    POUND_FACTORIAL_INPUTS_MAX, study->n_inputs);
}

/* ---- ratios ---- */

/* Whether a numerator also appears elsewhere in the ratios up to this place. */
static bool above_elsewhere(const struct pound_study *study, int ratio, int side)
{
	const char *path = study->ratios[ratio].of[side];
	for (int k = 0; k <= ratio; k++)
		for (int s = 0; s < 2; s++) {
			const char *other = study->ratios[k].of[s];
			if ((k < ratio || s < side) && (s == 0 || side == 0) && other && strcmp(other, path) == 0)
				return true;
		}
	return false;
}

/* Whether the path of some input is invalid, so that a ratio or group may refer to that input. */
static bool unread_input(const struct pound_study *study)
{
	for (int j = 0; j < study->n_inputs; j++)
		if (!study->inputs[j].path && !(study->elsewhere && study->inputs[j].name))
			return true;
	return false;
}

static void check_ratio(const struct pound_study *study, int ratio, int side, struct problems *problems)
{
	char pointer[POINTER_SIZE], distribution[POINTER_SIZE];
	const char *path = study->ratios[ratio].of[side];
	if (!path)
		return;
	const int input = pound_study_input(study, path);
	snprintf(pointer, sizeof pointer, "/ratios/%d/of/%d", ratio, side);
	snprintf(distribution, sizeof distribution, "/inputs/%d/distribution", input);
	if (input < 0 && !unread_input(study))
		problems_add(problems, pointer, "is not the path of an input of this study");
	else if (input >= 0 && !problems_at(problems, distribution) &&
	         !pound_ratio_takes(&study->inputs[input].distribution))
		problems_add(problems, pointer,
		             "names /inputs/%d, but inputs of a ratio must be \"uniform\" or \"log_uniform\" and > 0",
		             input);
	if (above_elsewhere(study, ratio, side))
		problems_add(problems, pointer, "a numerator may not appear anywhere else in the ratios");
}

static void check_ratios(const struct pound_study *study, struct problems *problems)
{
	for (int k = 0; k < study->n_ratios; k++)
		for (int side = 0; side < 2; side++)
			check_ratio(study, k, side, problems);
	if (study->n_ratios && !problems_at(problems, "/ratios") && !problems_at(problems, "/inputs") &&
	    pound_ratio_variables(study, NULL) > POUND_FACTORIAL_INPUTS_MAX)
		problems_add(problems, "/ratios", "ratios plus remaining inputs: at most %d, got %d",
		             POUND_FACTORIAL_INPUTS_MAX, pound_ratio_variables(study, NULL));
}

/* ---- groups ---- */

static void check_group(const struct pound_study *study, int g, struct problems *problems)
{
	const struct pound_group *group = &study->groups[g];
	unsigned seen = 0;
	char pointer[POINTER_SIZE];
	for (int k = 0; k < group->n; k++) {
		const int input = group->of[k] ? pound_study_input(study, group->of[k]) : -1;
		snprintf(pointer, sizeof pointer, "/groups/%d/of/%d", g, k);
		if (group->of[k] && input < 0 && !unread_input(study))
			problems_add(problems, pointer, "is not the path of an input of this study");
		if (input >= 0 && seen >> input & 1)
			problems_add(problems, pointer, "is in this group already");
		seen |= input >= 0 ? 1u << input : 0u;
	}
	snprintf(pointer, sizeof pointer, "/groups/%d/of", g);
	if (study->n_inputs > 0 && seen == pound_inputs_all(study->n_inputs) &&
	    !problems_over(problems, "/inputs"))
		problems_add(problems, pointer, "must not contain every input: its indices would be 1");
}

static void check_groups(const struct pound_study *study, struct problems *problems)
{
	for (int g = 0; g < study->n_groups; g++)
		check_group(study, g, problems);
}

/* ---- the study ---- */

/* Whether the members that determine the number of rows are valid. */
static bool rows_known(const struct problems *problems)
{
	static const char *const all[] = {"/design/method", "/design/rows",  "/design/randomisations",
	                                  "/design/until",  "/design/order", "/design/estimator"};
	bool is = !problems_over(problems, "/inputs");
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		is &= !problems_at(problems, all[i]) && !problems_over(problems, all[i]);
	return is;
}

/* Removes the values of sweeps that have problems, so that the cells are those of the other sweeps. */
static void sweeps_drop_invalid(struct pound_study *study, const struct problems *problems)
{
	for (int s = 0; s < study->n_sweeps; s++) {
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/sweep/%d", s);
		if (problems_at(problems, pointer))
			study->sweeps[s].n_values = 0;
	}
}

/* Checks members against each other.  Each check runs if the members that it reads are valid, so that one request reports as many
 * problems as possible and none that follows from another.
 *
 * Given    study     -         -       read, possibly with problems
 * Returns  study     -         -       without the values of invalid sweeps
 *          problems  -         -       further problems are added
 *
 * Test     unit_study_cases, unit_study_check
 */
void study_check(struct pound_study *study, struct problems *problems)
{
	sweeps_drop_invalid(study, problems);
	check_paths(study, problems);
	check_names(study, problems);
	sweeps_drop_invalid(study, problems);
	const bool kind = !problems_at(problems, "/kind");
	if (kind && !problems_over(problems, "/inputs") && !problems_over(problems, "/design/order"))
		check_order(study, problems);
	check_ratios(study, problems);
	check_groups(study, problems);
	if (study->elsewhere) {
		if (kind && rows_known(problems))
			study_size_check_rows(study, problems);
		return;
	}
	check_supports(study, problems);
	check_excitation(study, problems);
	study_suite_check(study, problems);
	study_buildings_check(study, problems);
	if (study_size_cells(study) > STUDY_CELLS_MAX && problems_at(problems, "/sweep"))
		return;
	if (study_size_cells(study) > STUDY_CELLS_MAX) {
		problems_exceed(problems, "/sweep", study_size_cells(study), STUDY_CELLS_MAX,
		                "needs %.15g cells; the limit is %d", study_size_cells(study), STUDY_CELLS_MAX);
		return;
	}
	study_contact_check(study, problems);
	if (!kind)
		return;
	check_outputs(study, problems);
	check_forces(study, problems);
	study_spectrum_check(study, problems);
	study_separation_check(study, problems);
	if (rows_known(problems) && study_check_known(study, "/excitation/signals", problems) &&
	    !problems_at(problems, "/convergence"))
		study_size_check(study, problems);
}
