/* study_hash.c - the hash of a study: equal for documents of the same study.
 *
 * The study is written as a canonical document: every member that its kind and excitation use, in the order of
 * fields.c, numbers in their shortest form, names left out; the hash is the SHA-256 of this text. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <nettle/sha2.h>

#include "schema/json/json_writer.h"
#include "schema/study/field_types.h"
#include "schema/study/study_json.h"

struct canon {
	struct writer w;
	const struct pound_study *study;
	const char *kind, *excitation, *solver;
};

static bool is_name(const struct field *field)
{
	return strcmp(field->pattern, "/name") == 0 || strcmp(field->pattern, "/ratios/*/name") == 0 ||
	       strcmp(field->pattern, "/groups/*/name") == 0 || strcmp(field->pattern, "/inputs/*/name") == 0;
}

/* Whether a member of the scene has its default and was added after hashes had been stored: old hashes must stay valid. */
static bool is_unwritten(const struct field *field, const void *base)
{
	const struct pound_field at = {.type = field_types[field->type].varied, .offset = field->offset};
	return field->unwritten && pound_scene_field(base, at) == field->absent;
}

/* Writes the members of the object at a pattern, except objects and lists. */
static void write_members(struct canon *c, const char *pattern, const void *base)
{
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		if (fields_child(field, pattern) && fields_used(field, c->kind, c->excitation, c->solver) &&
		    !is_name(field) && !is_unwritten(field, base) && field_types[field->type].write)
			field_types[field->type].write(&c->w, field, fields_name(field),
			                               (const char *)base + field->offset);
	}
}

static void write_object(struct canon *c, const char *name, const char *pattern, const void *base)
{
	writer_object(&c->w, name, WRITER_LINES);
	write_members(c, pattern, base);
	writer_end(&c->w);
}

static void write_oscillators(struct canon *c)
{
	writer_array(&c->w, "oscillators", WRITER_LINES);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_oscillator *o = &c->study->scene.oscillators[i];
		const char *base = (const char *)c->study + (size_t)i * sizeof *o;
		writer_object(&c->w, NULL, WRITER_LINES);
		if (o->rigid_wall)
			writer_bool(&c->w, "rigid_wall", true);
		else
			write_members(c, "/scene/oscillators/*", base);
		if (o->has_law)
			write_object(c, "law", "/scene/oscillators/*/law", base);
		writer_end(&c->w);
	}
	writer_end(&c->w);
}

static void write_buildings(struct canon *c)
{
	writer_array(&c->w, "buildings", WRITER_LINES);
	for (int i = 0; i < c->study->scene.n_buildings; i++) {
		const struct pound_building *building = &c->study->scene.buildings[i];
		writer_object(&c->w, NULL, WRITER_LINES);
		if (building->rigid_wall)
			writer_bool(&c->w, "rigid_wall", true);
		else
			write_members(c, "/scene/buildings/*", building);
		for (int k = 0; k < 2 && pound_damping_takes_modes(building->damping); k++)
			writer_whole(&c->w, "damping_mode", building->damping_modes[k]);
		if (building->has_law)
			write_object(c, "law", "/scene/buildings/*/law", building);
		writer_end(&c->w);
	}
	writer_end(&c->w);
}

/* A contact is written with inherited values; its own members are also listed, as varying the scene's contact does not change
 * them. */
static void write_contacts(struct canon *c)
{
	writer_array(&c->w, "contacts", WRITER_LINES);
	for (int i = 0; i < c->study->scene.n_contacts; i++) {
		const struct pound_row_contact *contact = &c->study->scene.contacts[i];
		writer_object(&c->w, NULL, WRITER_LINES);
		write_members(c, "/scene/contacts/*", contact);
		for (int k = 0; k < 2; k++)
			writer_number(&c->w, "level", contact->levels[k]);
		for (int k = 0; k < fields_count; k++)
			if (fields_child(&fields[k], "/scene/contacts/*") &&
			    fields[k].offset >= offsetof(struct pound_row_contact, contact) &&
			    contact->own[fields[k].offset - offsetof(struct pound_row_contact, contact)])
				writer_text(&c->w, "own", fields_name(&fields[k]));
		writer_end(&c->w);
	}
	writer_end(&c->w);
}

static void write_place(struct canon *c, const char *name, const struct pound_storey_place *place)
{
	writer_object(&c->w, name, WRITER_LINES);
	writer_whole(&c->w, "building", place->building);
	writer_whole(&c->w, "storey", place->storey);
	writer_end(&c->w);
}

/* The places of the outputs of a row of buildings and of its spectrum. */
static void write_places(struct canon *c)
{
	writer_array(&c->w, "places", WRITER_LINES);
	for (int k = 0; k < c->study->scene.n_places; k++)
		write_place(c, NULL, &c->study->scene.places[k]);
	writer_end(&c->w);
	if (c->study->spectrum.n)
		write_place(c, "place", &c->study->spectrum.place);
}

/* The SHA-256 of some bytes, in hexadecimal digits. */
void study_digest(const void *bytes, size_t n, char hex[STUDY_HASH_SIZE])
{
	struct sha256_ctx sha;
	uint8_t digest[SHA256_DIGEST_SIZE];
	sha256_init(&sha);
	sha256_update(&sha, n, bytes);
	sha256_digest(&sha, sizeof digest, digest);
	for (int i = 0; i < SHA256_DIGEST_SIZE; i++)
		snprintf(hex + 2 * i, 3, "%02x", digest[i]);
}

/* The records of a suite, with a digest of their samples; the source of the samples does not matter. */
static void write_suite(struct canon *c)
{
	const struct pound_excitation *e = &c->study->scene.excitation;
	write_object(c, "scale", "/scene/excitation/scale", c->study);
	writer_array(&c->w, "records", WRITER_LINES);
	for (int k = 0; k < e->n_records; k++) {
		const struct pound_record *record = &e->records[k];
		char hex[STUDY_HASH_SIZE];
		study_digest(record->a, sizeof *record->a * (size_t)record->n, hex);
		writer_object(&c->w, NULL, WRITER_LINES);
		writer_number(&c->w, "time_step_s", record->time_step);
		writer_text(&c->w, "samples", hex);
		writer_number(&c->w, "factor", record->factor);
		writer_bool(&c->w, "reversed", record->reversed);
		writer_end(&c->w);
	}
	writer_end(&c->w);
}

static void write_scene(struct canon *c)
{
	const struct pound_excitation *e = &c->study->scene.excitation;
	writer_object(&c->w, "scene", WRITER_LINES);
	write_object(c, "law", "/scene/law", c->study);
	if (c->study->scene.n_buildings)
		write_buildings(c);
	else
		write_oscillators(c);
	if (c->study->scene.contact.present)
		write_object(c, "contact", "/scene/contact", c->study);
	if (c->study->scene.n_contacts)
		write_contacts(c);
	write_object(c, "excitation", "/scene/excitation", c->study);
	writer_array(&c->w, "record", WRITER_LINES);
	for (int i = 0; i < e->n_record; i++)
		writer_number(&c->w, NULL, e->record[i]);
	writer_end(&c->w);
	if (e->n_records)
		write_suite(c);
	writer_end(&c->w);
}

/* A list, if there is one. */
static void write_numbers(struct canon *c, const char *name, const double *number, int n)
{
	if (!n)
		return;
	writer_array(&c->w, name, WRITER_LINES);
	for (int k = 0; k < n; k++)
		writer_number(&c->w, NULL, number[k]);
	writer_end(&c->w);
}

static void write_inputs(struct canon *c)
{
	writer_array(&c->w, "inputs", WRITER_LINES);
	for (int j = 0; j < c->study->n_inputs; j++) {
		const struct pound_input *input = &c->study->inputs[j];
		writer_object(&c->w, NULL, WRITER_LINES);
		write_members(c, "/inputs/*", input);
		write_members(c, "/inputs/*/distribution", input);
		for (int k = 0; pound_distribution_parameter(input->distribution.type, k); k++)
			writer_number(&c->w, pound_distribution_parameter(input->distribution.type, k),
			              input->distribution.p[k]);
		write_numbers(c, "values", input->distribution.values, input->distribution.n_values);
		write_numbers(c, "weights", input->distribution.weights,
		              input->distribution.weights ? input->distribution.n_values : 0);
		writer_end(&c->w);
	}
	writer_end(&c->w);
}

static void write_ratios(struct canon *c)
{
	writer_array(&c->w, "ratios", WRITER_LINES);
	for (int k = 0; k < c->study->n_ratios; k++)
		for (int side = 0; side < 2; side++)
			writer_text(&c->w, NULL, c->study->ratios[k].of[side]);
	writer_end(&c->w);
}

static void write_groups(struct canon *c)
{
	writer_array(&c->w, "groups", WRITER_LINES);
	for (int g = 0; g < c->study->n_groups; g++)
		writer_whole(&c->w, NULL, c->study->groups[g].inputs);
	writer_end(&c->w);
}

static void write_sweeps(struct canon *c)
{
	writer_array(&c->w, "sweep", WRITER_LINES);
	for (int s = 0; s < c->study->n_sweeps; s++) {
		const struct pound_sweep *sweep = &c->study->sweeps[s];
		writer_object(&c->w, NULL, WRITER_LINES);
		write_members(c, "/sweep/*", sweep);
		writer_array(&c->w, "values", WRITER_LINES);
		for (int i = 0; i < sweep->n_values; i++)
			study_value(&c->w, NULL, sweep->path, sweep->values[i]);
		writer_end(&c->w);
		writer_end(&c->w);
	}
	writer_end(&c->w);
}

static void write_convergence(struct canon *c)
{
	write_object(c, "convergence", "/convergence", c->study);
	for (int row = 0; row < POUND_SOLVERS; row++) {
		const struct pound_settings *settings = &c->study->convergence.settings[row];
		writer_array(&c->w, pound_solver_name(row), WRITER_LINES);
		for (int k = 0; k < settings->n; k++)
			writer_number(&c->w, NULL, settings->values[k]);
		writer_end(&c->w);
	}
}

static void write_spectrum(struct canon *c)
{
	write_object(c, "spectrum", "/spectrum", c->study);
	writer_array(&c->w, "frequencies_hz", WRITER_LINES);
	for (int k = 0; k < c->study->spectrum.n; k++)
		writer_number(&c->w, NULL, pound_spectrum_frequency(&c->study->spectrum, k));
	writer_end(&c->w);
}

/* Writes a varied value as in a document. */
void study_value(struct writer *writer, const char *name, const char *path, double value)
{
	struct field_place place;
	field_write(writer, fields_scene(path, &place), name, value);
}

/* The name of a varied value; NULL: the value is written as a number. */
const char *study_choice(const char *path, double value)
{
	struct field_place place;
	const struct field *field = fields_scene(path, &place);
	return field_types[field->type].word ? field_types[field->type].word(field, value) : NULL;
}

/* The hash of a study.
 *
 * Given    study     -         -       read by study_from_json
 * Returns  hex       (65)      -       SHA-256 in lower-case hex, zero-terminated
 *          value     -         -       false: out of memory
 *
 * Test     unit_study_hash: spelling_order_and_names_do_not_change_it
 */
bool study_hash(const struct pound_study *study, char hex[STUDY_HASH_SIZE])
{
	struct canon c = {.study = study,
	                  .kind = study_kind_name(study->kind),
	                  .excitation = pound_excitation_name(study->scene.excitation.type),
	                  .solver = pound_solver_name(study->solver.method)};
	writer_init(&c.w);
	writer_object(&c.w, NULL, WRITER_LINES);
	write_members(&c, "", study);
	if (!study->elsewhere)
		write_scene(&c);
	write_inputs(&c);
	if (study->n_ratios)
		write_ratios(&c);
	if (study->n_groups)
		write_groups(&c);
	if (!study->elsewhere)
		write_sweeps(&c);
	write_object(&c, "design", "/design", study);
	if (study->design.split)
		writer_text(&c.w, "signals", "auto");
	if (study->design.until.half_width > 0)
		write_object(&c, "until", "/design/until", study);
	if (!study->elsewhere) {
		writer_array(&c.w, "outputs", WRITER_LINES);
		for (int o = 0; o < study->n_outputs; o++)
			writer_text(&c.w, NULL, pound_output_name(study->outputs[o]));
		writer_end(&c.w);
		write_object(&c, "solver", "/solver", study);
	}
	if (study->scene.n_buildings)
		write_places(&c);
	if (study->spectrum.n)
		write_spectrum(&c);
	if (study->kind == POUND_KIND_CONVERGENCE)
		write_convergence(&c);
	writer_end(&c.w);
	size_t length;
	char *text = writer_take(&c.w, &length);
	if (!text)
		return false;
	study_digest(text, length, hex);
	free(text);
	return true;
}
