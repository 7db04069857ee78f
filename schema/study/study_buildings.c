/* study_buildings.c - rows of buildings: reads their members and checks them against each other.
 *
 * 1. The number of storeys of a building is looked up first: its arrays must have as many elements.
 * 2. A contact inherits its absent members from the contact of the scene.
 * 3. The storeys that exist in every cell decide which levels, places and paths are valid. */
#include "schema/study/study_buildings.h"
#include "schema/study/study_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/study/field_types.h"
#include "schema/study/reader.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

enum { POINTER_SIZE = 80 };

/* ---- buildings ---- */

static const char BUILDING[] = "/scene/buildings/*", CONTACT[] = "/scene/contacts/*";

/* Refuses a member, if it is given, that another member makes unused. */
static void refuse(struct reader *r, const cJSON *object, const char *name, const char *why)
{
	if (!cJSON_GetObjectItemCaseSensitive(object, name))
		return;
	size_t length = reader_enter(r, name);
	problems_add(r->problems, r->pointer, "%s", why);
	reader_leave(r, length);
}

static void read_building(struct reader *r, const cJSON *node, int i)
{
	struct pound_building *building = &r->study->scene.buildings[i];
	const cJSON *storeys = cJSON_GetObjectItemCaseSensitive(node, "storeys");
	const struct field *count = fields_find("/scene/buildings/*/storeys");
	reader_defaults(BUILDING, (char *)building);
	building->damping_modes[0] = 1;
	building->damping_modes[1] = 3;
	building->rigid_wall = reader_wall(
	    r, BUILDING, node,
	    i < r->study->scene.n_buildings - 1 ? "only the last building of a row may be a rigid wall" : NULL);
	if (building->rigid_wall)
		return;
	const double n = cJSON_IsNumber(storeys) ? storeys->valuedouble : storeys ? 0 : 1;
	r->storeys = fields_in_range(count, n) && floor(n) == n ? (int)n : 0;
	if (!reader_object(r, BUILDING, node, (char *)building))
		return;
	if (cJSON_GetObjectItemCaseSensitive(node, "stiffness_n_m")) {
		refuse(r, node, "frequency_hz", "is not used when stiffness_n_m is given");
		refuse(r, node, "stiffness_profile", "is only used with frequency_hz");
	}
	if (building->damping_ratio.n > 1 && !pound_damping_takes_each(building->damping)) {
		size_t length = reader_enter(r, "damping_ratio");
		problems_add(r->problems, r->pointer, "must be one number with damping \"%s\"",
		             pound_damping_name(building->damping));
		reader_leave(r, length);
	}
	if (!pound_damping_takes_modes(building->damping))
		refuse(r, node, "damping_modes", "is only used with damping \"rayleigh\"");
}

/* Reads the buildings of a row, unless they are refused beside oscillators; offsets in fields.c count from the current building.
 *
 * Test     unit_study_cases
 */
void reader_buildings(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	if (problems_over(r->problems, field->pattern))
		return;
	r->study->scene.n_buildings = cJSON_GetArraySize(node); // read_building needs it
	r->study->scene.n_buildings = reader_each(r, field, node, read_building);
}

void reader_building_law(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	((struct pound_building *)(void *)base)->has_law = true;
	if (reader_object(r, field->pattern, node, base) &&
	    cJSON_GetObjectItemCaseSensitive(node, "yield_displacement_m"))
		refuse(r, node, "target_demand", "is not used when yield_displacement_m is given");
}

/* Reads a list of two numbers by its row of fields.c; false: one is invalid. */
static bool read_pair(struct reader *r, const struct field *field, const cJSON *node, double pair[2])
{
	const int before = r->problems->n;
	const cJSON *element = reader_elements(r, field, node) == 2 ? node->child : NULL;
	for (int k = 0; k < 2 && element; k++, element = element->next) {
		size_t length = reader_enter_element(r, k);
		field_types[field[1].type].number(r, field + 1, element, &pair[k]); // its element is the next row
		reader_leave(r, length);
	}
	return r->problems->n == before;
}

void reader_modes(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_building *building = (struct pound_building *)(void *)base;
	double pair[2] = {0};
	if (!read_pair(r, field, node, pair))
		return;
	if (!(pair[0] < pair[1]))
		problems_add(r->problems, r->pointer, "must be ascending, got %.0f and %.0f", pair[0], pair[1]);
	building->damping_modes[0] = (int)pair[0];
	building->damping_modes[1] = (int)pair[1];
}

/* ---- contacts ---- */

void reader_levels(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_row_contact *contact = (struct pound_row_contact *)(void *)base;
	read_pair(r, field, node, contact->levels);
}

static size_t size_of(const struct field *field)
{
	static const size_t sizes[] = {[POUND_FIELD_REAL] = sizeof(double),
	                               [POUND_FIELD_COUNT] = sizeof(int),
	                               [POUND_FIELD_CHOICE] = sizeof(int),
	                               [POUND_FIELD_BOOL] = sizeof(bool),
	                               [POUND_FIELD_EACH] = 0};
	return sizes[field_types[field->type].varied];
}

static void read_row_contact(struct reader *r, const cJSON *node, int i)
{
	struct pound_row_contact *contact = &r->study->scene.contacts[i];
	contact->contact = r->study->scene.contact;
	if (!reader_object(r, CONTACT, node, (char *)contact))
		return;
	reader_contact(r, node, contact->contact.model);
	for (int k = 0; k < fields_count; k++) {
		const struct field *field = &fields[k];
		const size_t start = offsetof(struct pound_row_contact, contact);
		if (fields_child(field, CONTACT) && field->offset >= start &&
		    cJSON_GetObjectItemCaseSensitive(node, fields_name(field)))
			memset(contact->own + (field->offset - start), 1, size_of(field));
	}
	// its own stiffness ratio replaces an inherited stiffness
	if (cJSON_GetObjectItemCaseSensitive(node, "stiffness_ratio") &&
	    !cJSON_GetObjectItemCaseSensitive(node, "stiffness_n_m")) {
		contact->contact.stiffness = 0;
		memset(contact->own + offsetof(struct pound_contact, stiffness), 1,
		       sizeof contact->contact.stiffness);
	}
}

/* Reads the contacts of a row, each as a copy of the scene's contact.
 *
 * Test     unit_row_results: what_a_sweep_varies_is_what_a_document_says
 */
void reader_contacts(struct reader *r, const cJSON *document)
{
	const cJSON *scene = cJSON_GetObjectItemCaseSensitive(document, "scene");
	const cJSON *node = cJSON_GetObjectItemCaseSensitive(scene, "contacts");
	if (!cJSON_IsObject(scene) || !node)
		return;
	snprintf(r->pointer, sizeof r->pointer, "/scene/contacts");
	r->study->scene.n_contacts = reader_each(r, fields_find("/scene/contacts"), node, read_row_contact);
	if (!cJSON_HasObjectItem(scene, "buildings"))
		problems_add(r->problems, r->pointer,
		             "is only used with buildings; two oscillators have one contact");
	else if (!r->study->scene.contact.present)
		problems_add(r->problems, r->pointer, "is not used when contact is null");
	*r->pointer = 0;
}

static void read_place(struct reader *r, const cJSON *node, int i)
{
	reader_defaults("/places/*", (char *)&r->study->scene.places[i]);
	reader_object(r, "/places/*", node, (char *)&r->study->scene.places[i]);
}

void reader_places(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	r->study->scene.n_places = reader_each(r, field, node, read_place);
}

/* ---- storeys of all cells ---- */

static struct pound_field storeys_field(int building)
{
	return (struct pound_field){.type = POUND_FIELD_COUNT,
	                            .offset = (size_t)building * sizeof(struct pound_building) +
	                                      offsetof(struct pound_building, storeys),
	                            .part = POUND_PART_BUILDINGS};
}

/* The sweep of a building's number of storeys, NULL: none. */
static const struct pound_sweep *storeys_sweep(const struct pound_study *study, int building)
{
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].n_values && pound_field_alike(study->sweeps[s].field, storeys_field(building)))
			return &study->sweeps[s];
	return NULL;
}

/* The fewest (sign 1) or the most (-1) storeys of a building in any cell. */
static int storeys_extreme(const struct pound_study *study, int building, int sign)
{
	const struct pound_sweep *sweep = storeys_sweep(study, building);
	double found = study->scene.buildings[building].storeys;
	for (int k = 0; sweep && k < sweep->n_values; k++)
		if (k == 0 || sign * sweep->values[k] < sign * found)
			found = sweep->values[k];
	return (int)found;
}

int study_storeys_least(const struct pound_study *study, int building)
{
	return storeys_extreme(study, building, 1);
}

int study_storeys_most(const struct pound_study *study, int building)
{
	return storeys_extreme(study, building, -1);
}

bool study_storeys_known(const struct pound_study *study, int building, const struct problems *problems)
{
	char path[POINTER_SIZE], wall[POINTER_SIZE];
	snprintf(path, sizeof path, "/buildings/%d/storeys", building);
	snprintf(wall, sizeof wall, "/scene/buildings/%d/rigid_wall", building);
	return study_check_known(study, path, problems) && !problems_at(problems, wall);
}

/* The same for every building of the row. */
static bool all_storeys_known(const struct pound_study *study, const struct problems *problems)
{
	bool is = true;
	for (int b = 0; b < study->scene.n_buildings; b++)
		is &= study_storeys_known(study, b, problems);
	return is;
}

/* ---- checks ---- */

/* A building with a varied number of storeys cannot have arrays. */
static void check_arrays(const struct pound_study *study, int b, struct problems *problems)
{
	static const struct {
		const char *name;
		size_t offset;
	} all[] = {{"mass_kg", offsetof(struct pound_building, mass)},
	           {"stiffness_n_m", offsetof(struct pound_building, stiffness)},
	           {"stiffness_profile", offsetof(struct pound_building, profile)},
	           {"height_m", offsetof(struct pound_building, height)},
	           {"damping_ratio", offsetof(struct pound_building, damping_ratio)},
	           {"law/yield_displacement_m", offsetof(struct pound_building, yield_drift)}};
	const char *building = (const char *)&study->scene.buildings[b];
	for (size_t k = 0; storeys_sweep(study, b) && k < sizeof all / sizeof all[0]; k++) {
		const struct pound_each *each = (const struct pound_each *)(const void *)(building + all[k].offset);
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/scene/buildings/%d/%s", b, all[k].name);
		if (each->n > 1 && !problems_at(problems, pointer))
			problems_add(problems, pointer, "must be one number, as a sweep varies the number of stories");
	}
}

/* Checks that a level is in a building in every cell; check_levels calls this for each swept value. */
static void check_level(const struct pound_study *study, int c, int side, double level,
                        struct problems *problems)
{
	const struct pound_row_contact *contact = &study->scene.contacts[c];
	const int b = contact->left_building + side;
	char pointer[POINTER_SIZE];
	snprintf(pointer, sizeof pointer, "/scene/contacts/%d/levels/%d", c, side);
	if (!study_storeys_known(study, b, problems))
		return;
	const int least = study_storeys_least(study, b);
	if (!study->scene.buildings[b].rigid_wall && level > least && !problems_at(problems, pointer))
		problems_add(problems, pointer, "is above building %d, whose top is level %d, got %.15g", b, least,
		             level);
}

static struct pound_field level_field(int c, int side)
{
	return (struct pound_field){.type = POUND_FIELD_REAL,
	                            .offset = (size_t)c * sizeof(struct pound_row_contact) +
	                                      offsetof(struct pound_row_contact, levels) +
	                                      (size_t)side * sizeof(double),
	                            .part = POUND_PART_CONTACTS};
}

static void check_levels(const struct pound_study *study, int c, struct problems *problems)
{
	for (int side = 0; side < 2; side++) {
		const struct pound_field field = level_field(c, side);
		check_level(study, c, side, study->scene.contacts[c].levels[side], problems);
		for (int s = 0; s < study->n_sweeps; s++)
			for (int k = 0; k < study->sweeps[s].n_values && pound_field_alike(study->sweeps[s].field, field);
			     k++)
				check_level(study, c, side, study->sweeps[s].values[k], problems);
		for (int j = 0; j < study->n_inputs; j++) {
			double low = 0, high = 0;
			char distribution[POINTER_SIZE];
			snprintf(distribution, sizeof distribution, "/inputs/%d/distribution", j);
			if (!pound_field_alike(study->inputs[j].field, field) || problems_at(problems, distribution) ||
			    problems_over(problems, distribution))
				continue;
			pound_distribution_support(&study->inputs[j].distribution, &low, &high);
			check_level(study, c, side, high, problems);
		}
	}
}

/* Checks the model of one contact: a solver that can integrate it, restitution and yield overlap. */
static void check_model(const struct pound_study *study, int c, struct problems *problems)
{
	struct pound_row_contact contact;
	char at[POINTER_SIZE], pointer[POINTER_SIZE + 32];
	snprintf(at, sizeof at, "/scene/contacts/%d", c);
	pound_row_contact_of(&study->scene, c, &contact);
	const int model = contact.contact.model;
	if (problems_at(problems, at) || problems_at(problems, "/scene/contact") ||
	    problems_at(problems, "/solver"))
		return;
	snprintf(pointer, sizeof pointer, "%s/model", at);
	for (int row = 0;
	     row < POUND_SOLVERS && !problems_at(problems, "/kind") && !problems_at(problems, "/convergence") &&
	     study->scene.contacts[c].own[offsetof(struct pound_contact, model)];
	     row++)
		if (study_check_solves(study, row) && !pound_solver_takes_row_force(row, pound_contact_force(model)))
			problems_add(problems, pointer,
			             "the solver \"%s\" cannot integrate the contact model \"%s\" between buildings",
			             pound_solver_name(row), pound_contact_name(model));
	snprintf(pointer, sizeof pointer, "%s/restitution", at);
	if (contact.contact.restitution == 0 && !pound_contact_takes_zero(&contact.contact) &&
	    !problems_at(problems, "/scene/contact/restitution"))
		problems_add(
		    problems, pointer,
		    "the %s calibration of contact model \"%s\" has no dashpot for restitution 0: it must be "
		    "greater than 0",
		    pound_calibration_name(contact.contact.calibration), pound_contact_name(model));
	snprintf(pointer, sizeof pointer, "%s/yield_overlap_m", at);
	if (pound_contact_reads(model, "yield_overlap_m") && contact.contact.yield_overlap == 0 &&
	    !problems_at(problems, "/scene/contact/yield_overlap_m"))
		problems_add(problems, pointer, "is required by contact model \"%s\": a number greater than 0 m",
		             pound_contact_name(model));
}

static void check_contacts(const struct pound_study *study, struct problems *problems)
{
	const struct pound_scene *scene = &study->scene;
	for (int c = 0; c < scene->n_contacts; c++) {
		check_model(study, c, problems);
		const struct pound_row_contact *contact = &scene->contacts[c];
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/scene/contacts/%d/left_building", c);
		if (problems_at(problems, pointer) || problems_over(problems, pointer))
			continue;
		if (contact->left_building >= scene->n_buildings - 1) {
			problems_add(problems, pointer, "must be less than %d, the index of the last building, got %d",
			             scene->n_buildings - 1, contact->left_building);
			continue;
		}
		snprintf(pointer, sizeof pointer, "/scene/contacts/%d/levels", c);
		if (problems_at(problems, pointer))
			continue;
		check_levels(study, c, problems);
		const bool wall = scene->buildings[contact->left_building + 1].rigid_wall;
		for (int k = 0; k < c; k++)
			if (scene->contacts[k].left_building == contact->left_building &&
			    scene->contacts[k].levels[0] == contact->levels[0] &&
			    (wall || scene->contacts[k].levels[1] == contact->levels[1]) && contact->levels[0] > 0) {
				problems_add(problems, pointer, "joins the same levels as contact %d", k);
				break;
			}
	}
}

static void check_place(const struct pound_study *study, const struct pound_storey_place *place,
                        const char *at, struct problems *problems)
{
	char pointer[POINTER_SIZE], wall[POINTER_SIZE];
	snprintf(pointer, sizeof pointer, "%s/building", at);
	snprintf(wall, sizeof wall, "/scene/buildings/%d/rigid_wall", place->building);
	if (problems_at(problems, pointer) || problems_over(problems, pointer) || problems_at(problems, wall) ||
	    problems_over(problems, wall))
		return;
	const int last = study->scene.n_buildings - 1;
	const bool ends_with_wall = study->scene.buildings[last].rigid_wall;
	if (place->building > last - ends_with_wall) {
		problems_add(problems, pointer, "must be at most %d, the index of the last building%s, got %d",
		             last - ends_with_wall, ends_with_wall ? " before the rigid wall" : "", place->building);
		return;
	}
	const int least = study_storeys_least(study, place->building);
	snprintf(pointer, sizeof pointer, "%s/storey", at);
	if (place->storey > least && !problems_at(problems, pointer) &&
	    study_storeys_known(study, place->building, problems))
		problems_add(problems, pointer, "must be at most %d, the stories of building %d%s, got %d", least,
		             place->building, storeys_sweep(study, place->building) ? " in every cell" : "",
		             place->storey);
}

static void check_places(const struct pound_study *study, struct problems *problems)
{
	const bool row = study->scene.n_buildings > 0;
	if (!row && study->scene.n_places)
		problems_add(problems, "/places", "is only used with buildings");
	if (!row && study->spectrum.place.storey)
		problems_add(problems, "/spectrum/place", "is only used with buildings");
	for (int k = 0; k < study->scene.n_places && row && !problems_over(problems, "/places"); k++) {
		char at[POINTER_SIZE];
		snprintf(at, sizeof at, "/places/%d", k);
		check_place(study, &study->scene.places[k], at, problems);
		for (int j = 0; j < k; j++)
			if (memcmp(&study->scene.places[j], &study->scene.places[k], sizeof study->scene.places[k]) ==
			        0 &&
			    !problems_at(problems, at) && !problems_over(problems, at)) {
				problems_add(problems, at, "is the same as place %d", j);
				break;
			}
	}
	if (row && study->spectrum.place.storey && !problems_over(problems, "/spectrum"))
		check_place(study, &study->spectrum.place, "/spectrum/place", problems);
}

/* Refuses outputs of rows that the study's solver cannot compute; solvers are never replaced silently. */
static void check_solvers(const struct pound_study *study, struct problems *problems)
{
	const bool known = !problems_at(problems, "/solver") && !problems_at(problems, "/convergence") &&
	                   !problems_at(problems, "/outputs");
	for (int row = 0; row < POUND_SOLVERS && known; row++)
		if (study_check_solves(study, row) && !pound_row_takes_solver(study, row))
			problems_add(problems, "/solver/method",
			             "the solver \"%s\" cannot compute accelerations and contact forces of buildings",
			             pound_solver_name(row));
}

/* Outputs of each contact need the same contacts in every cell. */
static void check_gaps(const struct pound_study *study, struct problems *problems)
{
	const bool separation = study->kind == POUND_KIND_SEPARATION;
	bool asks = separation;
	for (int o = 0; o < study->n_outputs; o++)
		asks |= study->outputs[o] >= 0 && pound_output_has_contacts(study->outputs[o], &study->scene);
	for (int b = 0; asks && b < study->scene.n_buildings && study->scene.n_contacts == 0; b++)
		if (storeys_sweep(study, b) && !problems_at(problems, "/scene/contacts")) {
			problems_add(problems, "/scene/contacts",
			             "must list the contacts: their number would change with the swept number of "
			             "stories");
			break;
		}
	if (separation && pound_row_contacts(&study->scene) == 0 && !problems_over(problems, "/scene/contact"))
		problems_add(problems, study->scene.contact.present ? "/scene/buildings" : "/scene/contact",
		             "kind \"%s\" needs a contact between buildings, as gaps are where contacts are",
		             study_kind_name(study->kind));
	if (separation && pound_row_contacts(&study->scene) > POUND_GAPS_OF_ROW_MAX &&
	    !problems_at(problems, "/scene/contacts") && all_storeys_known(study, problems))
		problems_add(problems, "/scene/contacts",
		             "kind \"%s\" takes at most %d contacts, this row has %d: list at most that many",
		             study_kind_name(study->kind), POUND_GAPS_OF_ROW_MAX, pound_row_contacts(&study->scene));
}

/* Every place has its own outputs; the default places are all storeys of the left building. */
static void check_outputs_number(const struct pound_study *study, struct problems *problems)
{
	const int places = study->scene.n_places ? study->scene.n_places : study_storeys_least(study, 0);
	int n = study->kind == POUND_KIND_SEPARATION ? 3 * pound_row_contacts(&study->scene) : 0;
	for (int o = 0; o < study->n_outputs; o++)
		n += pound_output_has_contacts(study->outputs[o], &study->scene) ? pound_row_contacts(&study->scene)
		     : pound_output_has_places(study->outputs[o], &study->scene) ? places
		     : pound_output_has_ordinates(study->outputs[o])             ? study->spectrum.n
		                                                                 : 1;
	if (n > POUND_OUTPUTS_MAX && !problems_at(problems, "/spectrum") && all_storeys_known(study, problems))
		problems_exceed(problems, "/outputs", n, POUND_OUTPUTS_MAX,
		                "needs %d outputs over all places and frequencies; the limit is %d", n,
		                POUND_OUTPUTS_MAX);
}

/* Checks the members of a row against each other, in every cell.
 *
 * Given    study      -     read, possibly with problems
 * Returns  problems   -     further problems are added
 *
 * Test     unit_study_cases
 */
void study_buildings_check(const struct pound_study *study, struct problems *problems)
{
	const struct pound_scene *scene = &study->scene;
	const bool kind = !problems_at(problems, "/kind");
	if (problems_over(problems, "/scene/buildings") || problems_over(problems, "/scene/oscillators"))
		return;
	if (scene->n_buildings && kind)
		check_solvers(study, problems);
	for (int b = 0; b < scene->n_buildings; b++)
		check_arrays(study, b, problems);
	if (!problems_over(problems, "/scene/contacts") && scene->n_buildings)
		check_contacts(study, problems);
	check_places(study, problems);
	if (scene->n_buildings && kind && !problems_over(problems, "/scene/contacts"))
		check_gaps(study, problems);
	if (scene->n_buildings && kind && !problems_at(problems, "/outputs") && !problems_at(problems, "/places"))
		check_outputs_number(study, problems);
}

/* ---- varied fields ---- */

int study_building_beyond(const struct pound_study *study, const char *path, const struct problems *problems)
{
	int b = -1;
	const bool row = study->scene.n_buildings > 0 && !problems_over(problems, "/scene/buildings");
	return row && sscanf(path, "/buildings/%3d/", &b) == 1 && b >= study->scene.n_buildings ? b : -1;
}

static bool yields_given(const struct pound_study *study, int b)
{
	const struct pound_field field = {.type = POUND_FIELD_EACH,
	                                  .offset = (size_t)b * sizeof(struct pound_building) +
	                                            offsetof(struct pound_building, yield_drift),
	                                  .part = POUND_PART_BUILDINGS};
	bool given = study->scene.buildings[b].yield_drift.n > 0;
	for (int j = 0; j < study->n_inputs; j++)
		given |= study->inputs[j].path && pound_field_overlaps(study->inputs[j].field, field);
	for (int s = 0; s < study->n_sweeps; s++)
		given |= study->sweeps[s].path && pound_field_overlaps(study->sweeps[s].field, field);
	return given;
}

/* Whether a result has drift ratios, which heights divide; every response has. */
static bool has_drift_ratios(const struct pound_study *study)
{
	bool has = study->kind == POUND_KIND_RESPONSE;
	for (int o = 0; o < study->n_outputs; o++)
		has |= strstr(pound_output_name(study->outputs[o]), "drift_ratio") != NULL;
	return has;
}

static const char *building_idle(const struct pound_study *study, const struct field *field,
                                 struct field_place place)
{
	const struct pound_building *building = &study->scene.buildings[place.element];
	const char *name = fields_name(field);
	const bool by_stiffness = building->stiffness.n > 0;
	if (building->rigid_wall)
		return "a rigid wall has no such field";
	if (place.index >= 0 && place.index >= study_storeys_least(study, place.element))
		return storeys_sweep(study, place.element) ? "the building has no such story in every cell"
		                                           : "the building has no such story";
	if (strcmp(name, "height_m") == 0 && !has_drift_ratios(study))
		return "has no effect: no output is a drift ratio";
	if (strcmp(name, "stiffness_n_m") == 0 && !by_stiffness)
		return "has no effect: frequency_hz is given";
	if ((strcmp(name, "frequency_hz") == 0 || strcmp(name, "stiffness_profile") == 0) && by_stiffness)
		return "has no effect: stiffness_n_m is given";
	if (strcmp(name, "damping_ratio") == 0 && place.index >= 0 &&
	    !pound_damping_takes_each(building->damping))
		return "all stories have one damping ratio with this form of damping";
	if (!strstr(field->pattern, "/law/"))
		return NULL;
	if (!building->has_law)
		return "this building has no law of its own";
	if (strcmp(pound_law_name(building->law.type), "linear") == 0)
		return "has no effect: the law is linear";
	if ((strcmp(name, "target_demand") == 0 || strcmp(name, "corrections") == 0) &&
	    yields_given(study, place.element))
		return "has no effect: yield_displacement_m is given";
	return NULL;
}

/* Whether every contact of the row gives this member itself, so that the value of the scene's contact is unused. */
static bool all_own(const struct pound_study *study, const struct field *field)
{
	const size_t at = field->offset - offsetof(struct pound_study, scene.contact);
	int c = 0;
	while (c < study->scene.n_contacts && study->scene.contacts[c].own[at])
		c++;
	return study->scene.n_contacts > 0 && c == study->scene.n_contacts;
}

/* Why varying a field would change nothing, for scenes with buildings and for paths into buildings.
 *
 * Returns  value   the reason; NULL: it may vary, or neither scene nor path has buildings
 *
 * Test     unit_study_cases
 */
const char *study_row_idle(const struct pound_study *study, const struct field *field,
                           struct field_place place)
{
	static const char *const of_rows[] = {"/scene/buildings/", "/scene/contacts/"},
	                         *const of_pairs[] = {"/scene/oscillators/"},
	                         *const of_contact[] = {"/scene/contact/"}, *const of_law[] = {"/scene/law/"};
	const bool row = study->scene.n_buildings > 0;
	if (!row)
		return fields_within(field, of_rows, 2) ? "this scene has no buildings" : NULL;
	if (fields_within(field, of_pairs, 1))
		return "this scene has no oscillators";
	if (fields_within(field, of_rows, 1))
		return building_idle(study, field, place);
	if (fields_within(field, of_rows + 1, 1) && place.element >= study->scene.n_contacts)
		return "there is no such contact in this scene";
	if (fields_within(field, of_contact, 1) && all_own(study, field))
		return "has no effect: every contact has its own";
	bool follows = false; // whether a building has the scene's law
	for (int b = 0; b < study->scene.n_buildings; b++)
		follows |= !study->scene.buildings[b].has_law && !study->scene.buildings[b].rigid_wall;
	if (fields_within(field, of_law, 1) && !follows)
		return "has no effect: no building uses the scene's law";
	return NULL;
}

/* ---- outputs ---- */

/* Number of outputs that replace one: one per place or contact. */
static int copies_of(const struct pound_study *study, int row)
{
	return pound_output_has_places(row, &study->scene)     ? study->scene.n_places
	       : pound_output_has_contacts(row, &study->scene) ? pound_row_contacts(&study->scene)
	                                                       : 1;
}

/* Replaces outputs of places and contacts by one per place or contact; default places: all storeys of the left building.
 *
 * Test     unit_row_results: places_are_outputs
 */
void study_places_lay(struct pound_study *study)
{
	if (study->scene.n_buildings == 0)
		return;
	const int storeys = study_storeys_least(study, 0);
	for (int i = 0; study->scene.n_places == i && i < storeys; i++)
		study->scene.places[study->scene.n_places++] =
		    (struct pound_storey_place){.building = 0, .storey = i + 1};
	if (!study->spectrum.place.storey)
		study->spectrum.place.storey = storeys;
	int outputs[POUND_OUTPUTS_MAX], n = 0;
	for (int o = 0; o < study->n_outputs; o++)
		for (int k = 0; k < copies_of(study, study->outputs[o]); k++)
			outputs[n++] = study->outputs[o];
	memcpy(study->outputs, outputs, sizeof *outputs * (size_t)n);
	study->n_outputs = n;
}
