/* study_unused.c - fields of a scene that have no effect, so that varying them would be a mistake. */
#include <stdio.h>
#include <string.h>

#include "schema/study/study_buildings.h"
#include "schema/study/study_check.h"

enum { PATH_SIZE = 64 };

/* The sweep of a law's member, NULL: none. */
static const struct pound_sweep *law_sweep(const struct pound_study *study, int oscillator, const char *name)
{
	char path[PATH_SIZE];
	if (oscillator < 0)
		snprintf(path, sizeof path, "/law/%s", name);
	else
		snprintf(path, sizeof path, "/oscillators/%d/law/%s", oscillator, name);
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].path && strcmp(study->sweeps[s].path, path) == 0)
			return &study->sweeps[s];
	return NULL;
}

/* Whether a law is the linear one; an invalid law is NAN or negative. */
static bool linear(double law)
{
	const char *name = law >= 0 ? pound_law_name((int)law) : NULL;
	return name && strcmp(name, "linear") == 0;
}

/* Whether a law is linear in every cell; invalid values count as not linear. */
static bool always_linear(const struct pound_study *study, const struct pound_law *law, int oscillator)
{
	const struct pound_sweep *types = law_sweep(study, oscillator, "type");
	bool all = types ? types->n_values > 0 : linear(law->type);
	for (int i = 0; types && i < types->n_values; i++)
		all &= linear(types->values[i]);
	return all;
}

static bool yield_given(const struct pound_study *study, const struct pound_law *law, int oscillator)
{
	bool given = law->yield_displacement > 0 || law_sweep(study, oscillator, "yield_displacement_m");
	const size_t offset = (size_t)((const char *)&law->yield_displacement - (const char *)&study->scene);
	for (int j = 0; j < study->n_inputs; j++)
		given |= study->inputs[j].path && study->inputs[j].field.part == POUND_PART_SCENE &&
		         study->inputs[j].field.offset == offset;
	return given;
}

/* Why varying a field of an oscillator's or the scene's law would change nothing; NULL: it may vary. */
static const char *law_idle(const struct pound_study *study, const struct field *field, int oscillator)
{
	const struct pound_scene *scene = &study->scene;
	const struct pound_oscillator *o = scene->oscillators;
	const struct pound_law *law = oscillator < 0 ? &scene->law : &o[oscillator].law;
	const char *name = fields_name(field);
	if (oscillator >= 0 && !o[oscillator].has_law)
		return "this oscillator has no law of its own";
	if (oscillator < 0 && scene->n_buildings == 0 && o[0].has_law && (o[1].has_law || o[1].rigid_wall))
		return "has no effect: no oscillator uses the scene's law";
	if (strcmp(name, "type") == 0)
		return NULL;
	if (always_linear(study, law, oscillator))
		return "has no effect: the law is linear";
	if ((strcmp(name, "target_demand") == 0 || strcmp(name, "corrections") == 0) &&
	    yield_given(study, law, oscillator))
		return "has no effect: yield_displacement_m is given";
	return NULL;
}

/* Whether a field describes the behavior of contacts, not their position. */
static bool of_contact(const char *pattern)
{
	return strncmp(pattern, "/scene/contact/", 15) == 0 ||
	       (strncmp(pattern, "/scene/contacts/", 16) == 0 && !strstr(pattern, "/levels/"));
}

/* Why varying a field of the scene would change nothing.
 *
 * Given    study       -   read, possibly with problems in its inputs and sweeps
 *          place       -   indices in the path of the field
 * Returns  value       -   the reason; NULL: it may vary
 *
 * Test     unit_study_cases
 */
const char *study_idle(const struct pound_study *study, const struct field *field, struct field_place place)
{
	const struct pound_scene *scene = &study->scene;
	const char *in_row = study_row_idle(study, field, place);
	if (in_row)
		return in_row;
	const int oscillator = scene->n_buildings ? -1 : place.element;
	if (oscillator == 1 && scene->oscillators[1].rigid_wall)
		return "a rigid wall has no such field";
	if (strncmp(field->pattern, "/scene/excitation/scale/", 24) == 0 &&
	    scene->excitation.scale.to == POUND_SCALE_NONE)
		return "has no effect: the records are not scaled";
	if (strncmp(field->pattern, "/scene/contact/", 15) == 0 && !scene->contact.present)
		return "has no effect: there is no contact in this scene";
	if (of_contact(field->pattern) && study->kind == POUND_KIND_SEPARATION && study->n_outputs == 0)
		return "has no effect: without \"outputs\" a study of separation runs nothing with contact";
	if (strncmp(field->pattern, "/scene/contact/", 15) == 0)
		return study_contact_idle(study, fields_name(field));
	if (strstr(field->pattern, "/law/") && !strstr(field->pattern, "/buildings/"))
		return law_idle(study, field, oscillator);
	return NULL;
}
