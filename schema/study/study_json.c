/* study_json.c - reads a study document in JSON into a study.
 *
 * 1. strict check and parser: text -> tree, or the line and column where the text is not JSON;
 * 2. every member of the tree by its row of fields.c: known, used, not repeated, right type, in range;
 * 3. study_check.c checks members against each other.
 *
 * reader.c reads one value, study_varied.c the inputs and sweeps. */
#include "schema/study/study_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json.h"
#include "schema/study/field_types.h"
#include "schema/study/near_name.h"
#include "schema/study/reader.h"
#include "schema/study/study_buildings.h"
#include "schema/study/study_check.h"
#include "schema/study/study_separation.h"
#include "schema/study/study_spectrum.h"
#include "schema/study/study_split.h"
#include "schema/study/study_suite.h"

// default rows of a quasi-random design, powers of two; a growing design starts with the few
enum { ROWS_QUASI_RANDOM = 1024, ROWS_FIRST = 2 };

/* One allocation for a study and the arrays it points to. */
struct block {
	struct pound_study study;
	struct pound_input inputs[POUND_INPUTS_MAX];
	struct pound_sweep sweeps[POUND_SWEEPS_MAX];
	struct pound_building buildings[POUND_BUILDINGS_MAX];
	struct pound_storey_place places[POUND_PLACES_MAX];
	struct suite_source *suite; /* sources of the records of a suite */
	double numbers[];           /* samples and sweep values; contacts, records and texts follow them */
};

/* ---- objects ---- */

static const struct field *member_field(const char *pattern, const char *name)
{
	for (int i = 0; i < fields_count; i++)
		if (fields_child(&fields[i], pattern) && strcmp(fields_name(&fields[i]), name) == 0)
			return &fields[i];
	return NULL;
}

/* How to write a quantity that other programs have as a member of another name or unit; NULL: not known. */
static const char *instead_of(const char *name)
{
	static const char *const known[][2] = {
	    {"period_s", "frequency_hz = 1/period_s"},
	    {"period", "frequency_hz = 1/period"},
	    {"frequency_rad_s", "frequency_hz = frequency_rad_s/(2 pi)"},
	    {"omega_rad_s", "frequency_hz = omega_rad_s/(2 pi)"},
	    {"stiffness", "frequency_hz = sqrt(stiffness/mass_kg)/(2 pi)"},
	    {"gap_mm", "gap_m = gap_mm/1000"},
	    {"gap_cm", "gap_m = gap_cm/100"},
	    {"peak_g", "peak_m_s2 = 9.80665 peak_g"},
	    {"pga_g", "peak_m_s2 = 9.80665 pga_g"},
	    {"damping_percent", "damping_ratio = damping_percent/100"},
	    {"ductility", "target_demand, the ductility demand without pounding"},
	};
	for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
		if (strcmp(name, known[k][0]) == 0)
			return known[k][1];
	return NULL;
}

enum { OBJECTS_MOST = 3 }; // a name in more objects (type, name) is too ambiguous to suggest

/* The pattern of the first object with a member of this name in such a study; false: no object has one, or too many. */
static bool other_object(const struct reader *r, const char *name, char text[80])
{
	const struct field *first = NULL;
	int n = 0;
	for (int i = 0; i < fields_count; i++)
		if (strcmp(fields_name(&fields[i]), name) == 0 &&
		    fields_used(&fields[i], r->kind, r->excitation, r->solver)) {
			first = first ? first : &fields[i];
			n++;
		}
	if (n == 0 || n > OBJECTS_MOST)
		return false;
	snprintf(text, 80, "%.*s", (int)(fields_name(first) - 1 - first->pattern), first->pattern);
	return *text;
}

static void unknown(struct reader *r, const char *pattern, const char *name)
{
	struct near_name_search search = near_name_begin(name);
	for (int i = 0; i < fields_count; i++)
		if (fields_child(&fields[i], pattern) && fields_used(&fields[i], r->kind, r->excitation, r->solver) &&
		    !(r->study->elsewhere && fields[i].sceneless == FIELD_UNUSED))
			near_name_try(&search, fields_name(&fields[i]));
	const char *meant = near_name_found(&search);
	char within[80], other[80];
	snprintf(within, sizeof within, "/scene/%.64s", name);
	if (instead_of(name))
		problems_add(r->problems, r->pointer, "unknown member: write %s", instead_of(name));
	else if (!*pattern && fields_find(within))
		problems_add(r->problems, r->pointer, "unknown member: it belongs in /scene");
	else if (meant)
		problems_add(r->problems, r->pointer, "unknown member, did you mean \"%s\"?", meant);
	else if (other_object(r, name, other))
		problems_add(r->problems, r->pointer, "unknown member: it belongs in %s", other);
	else
		problems_add(r->problems, r->pointer, "unknown member");
}

static void unused(struct reader *r, const struct field *field)
{
	if (!fields_used(field, r->kind, NULL, NULL))
		problems_add(r->problems, r->pointer, "is not used by kind \"%s\"", r->kind);
	else if (!fields_used(field, NULL, NULL, r->solver))
		problems_add(r->problems, r->pointer, "is not used by solver \"%s\"", r->solver);
	else
		problems_add(r->problems, r->pointer, "is not used by excitation \"%s\"", r->excitation);
}

/* Whether an earlier member has the same name. */
bool reader_seen(const cJSON *object, const cJSON *member)
{
	for (const cJSON *other = object->child; other != member; other = other->next)
		if (strcmp(other->string, member->string) == 0)
			return true;
	return false;
}

/* Adds a problem for every missing required member of an object.
 *
 * Test     unit_study_cases
 */
void reader_require(struct reader *r, const cJSON *node, const char *pattern)
{
	const struct field *object = fields_find(pattern);
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		// unknown kind: require only members of all kinds, or of the same kinds as the object
		bool kind_known =
		    r->kind || !field->kinds || (object && object->kinds && strcmp(object->kinds, field->kinds) == 0);
		bool needed = isnan(field->absent) && fields_child(field, pattern) && kind_known &&
		              (r->excitation || !field->types) &&
		              fields_used(field, r->kind, r->excitation, r->solver) &&
		              !(r->study->elsewhere && field->sceneless) &&
		              !(r->kind && fields_listed(field->optional, r->kind));
		if (!needed || cJSON_GetObjectItemCaseSensitive(node, fields_name(field)) ||
		    (field->instead && cJSON_GetObjectItemCaseSensitive(node, field->instead)))
			continue;
		char expected[256];
		fields_expected(field, expected, sizeof expected);
		size_t length = reader_enter(r, fields_name(field));
		problems_add(r->problems, r->pointer, "is required: %s", expected);
		reader_leave(r, length);
	}
}

/* Reads the members of an object, each by its row of fields.c.
 *
 * Given    pattern   -         -       of the object in fields.c
 *          base      -         -       origin of the offsets of its members
 * Returns  value     -         -       false: not an object
 *
 * Test     unit_study_cases
 */
bool reader_object(struct reader *r, const char *pattern, const cJSON *node, char *base)
{
	if (!cJSON_IsObject(node)) {
		reader_mistyped_field(r, fields_find(pattern), node);
		return false;
	}
	const cJSON *member;
	cJSON_ArrayForEach(member, node)
	{
		size_t length = reader_enter(r, member->string);
		const struct field *field = member_field(pattern, member->string);
		if (reader_seen(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else if (!field)
			unknown(r, pattern, member->string);
		else if (!fields_used(field, r->kind, r->excitation, r->solver))
			unused(r, field);
		else if (r->study->elsewhere && field->sceneless == FIELD_UNUSED)
			problems_add(r->problems, r->pointer, "is not used without a scene");
		else
			reader_value(r, field, member, base);
		reader_leave(r, length);
	}
	reader_require(r, node, pattern);
	return true;
}

void reader_defaults(const char *pattern, char *base)
{
	char within[64];
	snprintf(within, sizeof within, "%s/", pattern);
	for (int i = 0; i < fields_count; i++) {
		void (*const store)(void *at, double value) = field_types[fields[i].type].store;
		const char *const start = within;
		if (store && fields_within(&fields[i], &start, 1))
			store(base + fields[i].offset, isnan(fields[i].absent) ? 0 : fields[i].absent);
	}
}

static void read_law(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	if (!reader_object(r, field->pattern, node, base) ||
	    !cJSON_GetObjectItemCaseSensitive(node, "yield_displacement_m") ||
	    !cJSON_GetObjectItemCaseSensitive(node, "target_demand"))
		return;
	size_t length = reader_enter(r, "target_demand");
	problems_add(r->problems, r->pointer, "is not used when yield_displacement_m is given");
	reader_leave(r, length);
}

static void read_own_law(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	((struct pound_study *)base)->scene.oscillators[0].has_law =
	    true; // base belongs to the current oscillator
	read_law(r, field, node, base);
}

static void read_contact(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	r->study->scene.contact.present = !cJSON_IsNull(node);
	if (!cJSON_IsNull(node) && reader_object(r, field->pattern, node, base))
		reader_contact(r, node, r->study->scene.contact.model);
}

/* Adds a problem if a member is given that the design does not use. */
static void unneeded(struct reader *r, const cJSON *object, const char *name, const char *design)
{
	if (!cJSON_GetObjectItemCaseSensitive(object, name))
		return;
	size_t length = reader_enter(r, name);
	problems_add(r->problems, r->pointer, "is not used by design \"%s\"", design);
	reader_leave(r, length);
}

static void read_design(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_design *design = &r->study->design;
	const struct field *rows = fields_find("/design/rows");
	if (!reader_object(r, field->pattern, node, base) || !r->kind || !fields_listed(rows->kinds, r->kind))
		return;
	if (problems_at(r->problems, "/design/method"))
		return; // it decides which members are used
	if (!pound_design_quasi_random(design->method))
		unneeded(r, node, "randomisations", pound_design_name(design->method));
	else if (!cJSON_GetObjectItemCaseSensitive(node, "rows"))
		design->rows = design->until.half_width > 0 ? ROWS_FIRST : ROWS_QUASI_RANDOM;
}

/* ---- lists ---- */

/* Refuses every other member of a rigid wall, and the wall itself for the reason `refused` if not NULL.
 *
 * Returns  value   false: no rigid wall, and nothing was read
 * Test     unit_study_cases
 */
bool reader_wall(struct reader *r, const char *pattern, const cJSON *node, const char *refused)
{
	const cJSON *wall = cJSON_GetObjectItemCaseSensitive(node, "rigid_wall"), *member;
	if (!cJSON_IsTrue(wall))
		return false;
	cJSON_ArrayForEach(member, node)
	{
		size_t length = reader_enter(r, member->string);
		if (reader_seen(node, member))
			problems_add(r->problems, r->pointer, "duplicate member");
		else if (member != wall && !member_field(pattern, member->string))
			unknown(r, pattern, member->string);
		else if (member != wall)
			problems_add(r->problems, r->pointer, "is not used by a rigid wall");
		else if (refused)
			problems_add(r->problems, r->pointer, "%s", refused);
		reader_leave(r, length);
	}
	return true;
}

static void read_oscillator(struct reader *r, const cJSON *node, int i)
{
	struct pound_oscillator *oscillator = &r->study->scene.oscillators[i];
	// offsets in fields.c belong to the first oscillator
	char *base = (char *)r->study + (size_t)i * sizeof *oscillator;
	oscillator->rigid_wall =
	    reader_wall(r, "/scene/oscillators/*", node,
	                i == 0 ? "only the right oscillator (index 1) may be a rigid wall" : NULL);
	if (!oscillator->rigid_wall)
		reader_object(r, "/scene/oscillators/*", node, base);
}

static void read_oscillators(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	reader_each(r, field, node, read_oscillator);
}

static void read_record(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	struct pound_excitation *excitation = &r->study->scene.excitation;
	excitation->n_record = reader_numbers(r, field, field + 1, node, &excitation->record); // the next row
}

static void read_output(struct reader *r, const cJSON *element, int o)
{
	double row;
	const struct field *field = fields_find("/outputs/*");
	if (field_types[field->type].number(r, field, element, &row))
		for (int k = 0; k < o; k++)
			if (r->study->outputs[k] == (int)row)
				problems_add(r->problems, r->pointer, "is listed twice");
	r->study->outputs[o] = (int)row;
}

static void read_outputs(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	r->study->n_outputs = reader_each(r, field, node, read_output);
}

/* Contacts inherit from the scene's contact, so reader_contacts reads them after the whole document. */
static void read_later(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)r, (void)field, (void)node, (void)base;
}

/* ---- any value ---- */

static const struct {
	const char *pattern;
	void (*read)(struct reader *r, const struct field *field, const cJSON *node, char *base);
} readers[] = {
    {"/scene/law", read_law},
    {"/scene/oscillators", read_oscillators},
    {"/scene/oscillators/*/law", read_own_law},
    {"/scene/contact", read_contact},
    {"/scene/buildings", reader_buildings},
    {"/scene/buildings/*/law", reader_building_law},
    {"/scene/buildings/*/damping_modes", reader_modes},
    {"/scene/contacts", read_later},
    {"/scene/contacts/*/levels", reader_levels},
    {"/places", reader_places},
    {"/scene/excitation/acceleration_m_s2", read_record},
    {"/scene/excitation/records", reader_records},
    {"/scene/excitation/records/*/acceleration_m_s2", reader_samples},
    {"/scene/excitation/scale", reader_scale},
    {"/inputs", reader_inputs},
    {"/inputs/*/distribution", reader_distribution},
    {"/ratios", reader_ratios},
    {"/ratios/*/of", reader_ratio},
    {"/groups", reader_groups},
    {"/groups/*/of", reader_group},
    {"/sweep", reader_sweeps},
    {"/design", read_design},
    {"/sweep/*/values", reader_values},
    {"/outputs", read_outputs},
    {"/spectrum/frequencies_hz", reader_frequencies},
    {"/separation/gaps_m", reader_separation},
    {"/separation/probabilities", reader_separation},
    {"/separation/hazard/intensities", reader_separation},
    {"/separation/hazard/annual_rates", reader_separation},
    {"/separation/return_periods_years", reader_separation},
    {"/convergence/newmark/steps_s", reader_settings},
    {"/convergence/central_difference/steps_s", reader_settings},
    {"/convergence/adaptive/tolerances", reader_settings},
};

/* Reads the value of a field: with its own function if it has one, else with the function of its type. */
void reader_value(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	for (size_t i = 0; i < sizeof readers / sizeof readers[0]; i++)
		if (strcmp(readers[i].pattern, field->pattern) == 0) {
			readers[i].read(r, field, node, base);
			return;
		}
	field_types[field->type].read(r, field, node, base);
}

/* ---- the document ---- */

/* Fills a study with the defaults of its members; members that its excitation does not use are 0. */
static void defaults(struct pound_study *study, const char *excitation)
{
	// lists whose elements are stored outside struct pound_study
	static const char *const elsewhere_kept[] = {
	    "/inputs/",          "/sweep/",          "/ratios/", "/groups/",
	    "/scene/buildings/", "/scene/contacts/", "/places/", "/scene/excitation/records/"};
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		void (*const store)(void *at, double value) = field_types[field->type].store;
		if (!store || fields_within(field, elsewhere_kept, sizeof elsewhere_kept / sizeof *elsewhere_kept))
			continue;
		bool absent = !isnan(field->absent) && fields_used(field, NULL, excitation, NULL);
		int copies = strncmp(field->pattern, "/scene/oscillators/*/", 21) == 0 ? POUND_OSCILLATORS : 1;
		for (int k = 0; k < copies; k++)
			store((char *)study + field->offset + (size_t)k * sizeof study->scene.oscillators[0],
			      absent ? field->absent : 0.0);
	}
	settings_default(study);
	study->scene.contact.present = true;
	if (study->scene.excitation.signals == 0)
		study->scene.excitation.signals = 1;
}

/* The name that an object gives for a choice, or the default; NULL: invalid. */
static const char *chosen(const cJSON *object, const char *pattern)
{
	const struct field *field = fields_find(pattern);
	const cJSON *name = cJSON_GetObjectItemCaseSensitive(object, fields_name(field));
	if (cJSON_IsString(name))
		return field->choice(fields_choice(field->choice, name->valuestring));
	return name || isnan(field->absent) ? NULL : field->choice((int)field->absent);
}

/* Looks up kind, excitation, solver and sweeps before the document is read, as they decide which members are used, and refuses
 * buildings beside oscillators. */
static void foresee(struct reader *r, const cJSON *document)
{
	const cJSON *scene = cJSON_GetObjectItemCaseSensitive(document, "scene");
	const cJSON *excitation = cJSON_GetObjectItemCaseSensitive(scene, "excitation");
	const cJSON *solver = cJSON_GetObjectItemCaseSensitive(document, "solver");
	r->sweeps = cJSON_GetObjectItemCaseSensitive(document, "sweep");
	r->kind = chosen(document, "/kind");
	r->excitation = chosen(excitation, "/scene/excitation/type");
	r->solver = chosen(solver, "/solver/method");
	if (cJSON_HasObjectItem(scene, "buildings") && cJSON_HasObjectItem(scene, "oscillators"))
		problems_add(r->problems, "/scene/buildings", "is not used when oscillators are given");
}

static void outputs_default(struct pound_study *study)
{
	for (int k = 0; fields_outputs_absent[k]; k++) {
		int output = fields_choice(pound_output_name, fields_outputs_absent[k]);
		// an output that needs runs of its own must be requested
		if (study_check_applies(study, output) && !pound_output_observes(output, &study->scene))
			study->outputs[study->n_outputs++] = output;
	}
}

/* Most contacts that a document of that length can have: each has at least its levels. */
static size_t contacts_room(size_t length)
{
	const size_t most = length / strlen("{\"levels\":[1,1]}") + 1;
	return most < POUND_CONTACTS_MAX ? most : POUND_CONTACTS_MAX;
}

static struct pound_study *block_create(size_t length)
{
	// an element of a list takes at least two characters, and a string is never longer than in the document
	const size_t numbers = length / 2 + 1, contacts = contacts_room(length),
	             records = (size_t)suite_room(length);
	const struct pound_excitation *e;
	struct block *block =
	    calloc(1, sizeof *block + numbers * sizeof(double) + contacts * sizeof(struct pound_row_contact) +
	                  records * (sizeof *e->records + sizeof *block->suite) + length + 1);
	if (!block)
		return NULL;
	block->study.scene.buildings = block->buildings;
	block->study.scene.contacts = (struct pound_row_contact *)(block->numbers + numbers);
	block->study.scene.excitation.records = (struct pound_record *)(block->study.scene.contacts + contacts);
	block->suite = (struct suite_source *)(block->study.scene.excitation.records + records);
	block->study.scene.places = block->places;
	block->study.inputs = block->inputs;
	block->study.sweeps = block->sweeps;
	return &block->study;
}

/* A study of an external model is a sensitivity study, also without a member "kind". */
static void sceneless(struct reader *r)
{
	r->study->elsewhere = true;
	r->study->design.common_signals = false;
	r->study->kind = POUND_KIND_SENSITIVITY;
	if (!r->kind)
		r->kind = study_kind_name(POUND_KIND_SENSITIVITY);
}

/* Sets the number of signals of a suite. */
static void signals_count(struct pound_excitation *e)
{
	if (e->n_records)
		e->signals = e->draw ? e->draw : pound_suite_signals(e);
}

/* Reads a study document.
 *
 * Given    document  -         -       its text may be any bytes
 * Returns  value     -         -       the study; NULL: failed, see problems->status
 *          problems  -         -       problems in the order of the document
 * Memory   allocates one block, about 5 bytes per byte of text, and the samples of files; free with study_free
 *
 * Test     unit_study_cases, unit_study_json, unit_suite
 */
struct pound_study *study_from_document(const struct study_document *source, struct problems *problems)
{
	const char *const text = source->text;
	const size_t length = source->length;
	const bool design = source->design;
	struct json_fault fault;
	problems_init(problems);
	cJSON *document = json_parse(text, length, &fault);
	if (!document && fault.line) {
		problems_add(problems, "", "%s", fault.detail);
		problems->status = PROBLEMS_MALFORMED;
		problems->line = fault.line;
		problems->column = fault.column;
		return NULL;
	}
	struct pound_study *study = document ? block_create(length) : NULL;
	if (!study) {
		problems->status = PROBLEMS_NOMEM;
		cJSON_Delete(document);
		return NULL;
	}
	struct block *block = (struct block *)study;
	struct reader r = {.problems = problems,
	                   .study = study,
	                   .number = block->numbers,
	                   .files = source->files,
	                   .designed = source->design,
	                   .suite = block->suite};
	r.text = (char *)(block->suite + suite_room(length));
	foresee(&r, document);
	defaults(study, r.excitation);
	if (design && cJSON_IsObject(document) && !cJSON_HasObjectItem(document, "scene"))
		sceneless(&r);
	reader_object(&r, "", document, (char *)study);
	reader_contacts(&r, document);
	reader_ordinates(&r, document);
	reader_undesigned(&r, document);
	signals_count(&study->scene.excitation);
	reader_split(&r, document);
	if (design && r.kind && study->kind != POUND_KIND_SENSITIVITY)
		problems_add(problems, "/kind", "must be \"%s\": no other kind has a design",
		             study_kind_name(POUND_KIND_SENSITIVITY));
	reader_groups_find(study);
	study_split_lay(study, problems);
	study_check(study, problems);
	problems_sort(problems, document);
	cJSON_Delete(document);
	if (problems->n) {
		study_free(study);
		return NULL;
	}
	if (study->n_outputs == 0 && study->kind != POUND_KIND_FLOOR_SPECTRUM &&
	    study->kind != POUND_KIND_SEPARATION && !study->elsewhere)
		outputs_default(study);
	study_separation_lay(study);
	study_places_lay(study);
	study_spectrum_lay(study);
	return study;
}

/* Reads a study document that names no files.
 *
 * Test     unit_study_cases, unit_study_json
 */
struct pound_study *study_from_json(const char *text, size_t length, struct problems *problems)
{
	return study_from_document(&(struct study_document){.text = text, .length = length}, problems);
}

/* Reads a document for its design only: a sensitivity study with a scene, or without one, of an external model.
 *
 * Given, Returns, Memory as study_from_json
 *
 * Test     unit_external_model: a_study_without_a_scene_is_inputs_and_a_design
 */
struct pound_study *study_design_from_json(const char *text, size_t length, struct problems *problems)
{
	return study_from_document(&(struct study_document){.text = text, .length = length, .design = true},
	                           problems);
}

const struct study_source *study_source_of(const struct pound_study *study, int record)
{
	const struct suite_source *source = &((const struct block *)study)->suite[record];
	return source->samples ? &source->named : NULL;
}

void study_free(struct pound_study *study)
{
	if (!study)
		return;
	const struct block *block = (const struct block *)study;
	for (int k = 0; k < study->scene.excitation.n_records; k++)
		free(block->suite[k].samples);
	free(study);
}
