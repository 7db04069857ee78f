/* study_contact.c - refuses members of a contact that its models do not read, and values that they cannot use.
 *
 * The model may be swept: a member is used if at least one of the models reads it. */
#include <stdio.h>
#include <string.h>

#include "schema/study/field_types.h"
#include "schema/study/reader.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

enum { POINTER_SIZE = 64 };

/* given members that determine a stiffness */
struct stiffness_given {
	bool linear; /* stiffness_n_m */
	bool power;  /* hertz_stiffness_n_m1_5 */
};

/* The given member that a model reads instead of `member`, NULL: none. */
static const char *instead(int model, const char *member, struct stiffness_given given)
{
	static const char linear[] = "stiffness_n_m", power[] = "hertz_stiffness_n_m1_5";
	const bool ratio = strcmp(member, "stiffness_ratio") == 0,
	           speed = strcmp(member, "reference_speed_m_s") == 0;
	if (given.power && pound_contact_reads(model, power) && (ratio || speed || strcmp(member, linear) == 0))
		return power;
	return given.linear && ratio ? linear : NULL;
}

/* ---- members of a document ---- */

/* The models of a contact in all cells.
 *
 * Given    model   of the contact without sweeps
 * Returns  models  (value)   rows, at least one; invalid names are left out
 */
static int models_of(const struct reader *r, int model, int models[static POUND_CONTACT_MODELS])
{
	char path[sizeof r->pointer + 8];
	const cJSON *sweep, *value;
	snprintf(path, sizeof path, "%s/model", r->pointer + strlen("/scene"));
	cJSON_ArrayForEach(sweep, r->sweeps)
	{
		const char *swept = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(sweep, "path"));
		int n = 0;
		if (!swept || strcmp(swept, path) != 0)
			continue;
		cJSON_ArrayForEach(value, cJSON_GetObjectItemCaseSensitive(sweep, "values"))
		{
			const char *name = cJSON_GetStringValue(value);
			const int row = name ? fields_choice(pound_contact_name, name) : -1;
			if (row >= 0 && n < POUND_CONTACT_MODELS)
				models[n++] = row;
		}
		if (n > 0)
			return n;
	}
	models[0] = model;
	return 1;
}

static bool has(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* Adds a problem for every member of a contact that none of its models reads.
 *
 * Given    node    the contact's object, already read; r->pointer points to it
 *          model   of the contact without sweeps
 * Test     unit_study_cases
 */
void reader_contact(struct reader *r, const cJSON *node, int model)
{
	int models[POUND_CONTACT_MODELS];
	const cJSON *member, *name = cJSON_GetObjectItemCaseSensitive(node, "model");
	if (name && (!cJSON_IsString(name) || fields_choice(pound_contact_name, name->valuestring) < 0))
		return; // the model is invalid
	const int n = models_of(r, model, models);
	const struct stiffness_given given = {has(node, "stiffness_n_m"), has(node, "hertz_stiffness_n_m1_5")};
	cJSON_ArrayForEach(member, node)
	{
		char pattern[128];
		bool reads = false, used = false;
		snprintf(pattern, sizeof pattern, "/scene/contact/%s", member->string);
		if (!fields_find(pattern) || reader_seen(node, member))
			continue;
		for (int k = 0; k < n; k++) {
			reads |= pound_contact_reads(models[k], member->string);
			used |=
			    pound_contact_reads(models[k], member->string) && !instead(models[k], member->string, given);
		}
		size_t length = reader_enter(r, member->string);
		if (!reads)
			problems_add(r->problems, r->pointer, "is not used by contact model \"%s\"",
			             pound_contact_name(models[0]));
		else if (!used)
			problems_add(r->problems, r->pointer, "is not used when %s is given",
			             instead(models[0], member->string, given));
		reader_leave(r, length);
	}
}

/* ---- members that vary ---- */

/* Whether a field is varied by an input or a sweep, or has a value other than 0. */
static bool given_or_varied(const struct pound_study *study, const char *path, double value)
{
	const struct pound_field field = study_check_field(path);
	bool given = value > 0;
	for (int j = 0; j < study->n_inputs; j++)
		given |= study->inputs[j].path && pound_field_alike(study->inputs[j].field, field);
	for (int s = 0; s < study->n_sweeps; s++)
		given |= study->sweeps[s].path && pound_field_alike(study->sweeps[s].field, field);
	return given;
}

/* The sweep of a member of the contact, NULL: none. */
static const struct pound_sweep *sweep_of(const struct pound_study *study, const char *path)
{
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].path && strcmp(study->sweeps[s].path, path) == 0)
			return &study->sweeps[s];
	return NULL;
}

const char *study_contact_idle(const struct pound_study *study, const char *member)
{
	const struct pound_contact *contact = &study->scene.contact;
	const struct pound_sweep *swept = sweep_of(study, "/contact/model");
	const struct stiffness_given given = {
	    given_or_varied(study, "/contact/stiffness_n_m", contact->stiffness),
	    given_or_varied(study, "/contact/hertz_stiffness_n_m1_5", contact->hertz_stiffness)};
	bool reads = swept && !swept->n_values, used = reads; // an invalid sweep may be meant to be of any model
	for (int k = 0; k < (swept ? swept->n_values : 1); k++) {
		// invalid values are NAN or negative
		const double row = swept ? swept->values[k] : contact->model;
		const bool here = !(row >= 0) || pound_contact_reads((int)row, member);
		reads |= here;
		used |= here && !(row >= 0 && instead((int)row, member, given));
	}
	return !reads  ? "has no effect: the contact model does not use it"
	       : !used ? "has no effect: a stiffness is given that is used instead"
	               : NULL;
}

/* ---- values that a model cannot use ---- */

/* Pointer to the source of a member's value: its distribution, its sweep or the member itself. */
static void source_of(const struct pound_study *study, const char *path, char pointer[static POINTER_SIZE])
{
	snprintf(pointer, POINTER_SIZE, "/scene%s", path);
	for (int j = 0; j < study->n_inputs; j++)
		if (study->inputs[j].path && strcmp(study->inputs[j].path, path) == 0)
			snprintf(pointer, POINTER_SIZE, "/inputs/%d/distribution", j);
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].path && strcmp(study->sweeps[s].path, path) == 0)
			snprintf(pointer, POINTER_SIZE, "/sweep/%d/values", s);
}

/* In every cell, the restitution must have a finite dashpot, and the yield overlap must be given if the model needs it. */
void study_contact_check(const struct pound_study *study, struct problems *problems)
{
	static const char restitution[] = "/contact/restitution", yield[] = "/contact/yield_overlap_m";
	static const char *const needed[] = {"/contact/model", "/contact/calibration", "/contact/tension"};
	char at_restitution[POINTER_SIZE], at_yield[POINTER_SIZE];
	double least, least_yield, most;
	for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++)
		if (!study_check_known(study, needed[i], problems))
			return;
	if (!study_check_known(study, restitution, problems) || !study_check_known(study, yield, problems))
		return;
	source_of(study, restitution, at_restitution);
	source_of(study, yield, at_yield);
	study_check_reach(study, restitution, &least, &most);
	study_check_reach(study, yield, &least_yield, &most);
	for (int cell = 0; cell < study_cells(study); cell++) {
		struct pound_scene scene;
		study_cell(study, cell, &scene);
		const struct pound_contact *contact = &scene.contact;
		if (!contact->present)
			continue;
		if (least == 0 && !problems_at(problems, at_restitution) && !pound_contact_takes_zero(contact) &&
		    (!sweep_of(study, restitution) || contact->restitution == 0))
			problems_add(
			    problems, at_restitution,
			    "the %s calibration of contact model \"%s\" has no dashpot for restitution 0: it must be "
			    "greater than 0",
			    pound_calibration_name(contact->calibration), pound_contact_name(contact->model));
		if (least_yield == 0 && pound_contact_reads(contact->model, "yield_overlap_m") &&
		    !problems_at(problems, at_yield))
			problems_add(problems, at_yield, "is required by contact model \"%s\": a number greater than 0 m",
			             pound_contact_name(contact->model));
	}
}
