/* scene.c - reading and varying the scene of a study, and dividing it by masses for the solver. */
#include "engine/run/scene.h"
#include "engine/ground/excitation.h"
#include "engine/scene/contact.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

const struct pound_law *pound_scene_law(const struct pound_scene *scene, int oscillator)
{
	const struct pound_oscillator *o = &scene->oscillators[oscillator];
	return o->has_law ? &o->law : &scene->law;
}

/* The address of a field. */
static void *field_at(const struct pound_scene *scene, struct pound_field field)
{
	void *const parts[] = {[POUND_PART_SCENE] = (void *)scene,
	                       [POUND_PART_BUILDINGS] = scene->buildings,
	                       [POUND_PART_CONTACTS] = scene->contacts};
	return (char *)parts[field.part] + field.offset;
}

double pound_each_of(const struct pound_each *each, int i)
{
	return each->values[each->n == 1 ? 0 : i];
}

/* Sets the number of one story, or of all (storey 0). */
static void each_assign(struct pound_each *each, int storey, double value)
{
	for (int i = 0; i < POUND_STOREYS_MAX && storey > 0 && each->n == 1; i++)
		each->values[i] = each->values[0];
	each->n = storey == 0 ? 1 : POUND_STOREYS_MAX;
	each->values[storey == 0 ? 0 : storey - 1] = value;
}

/* Marks a varied member as the contact's own. */
static void own_assign(struct pound_scene *scene, struct pound_field field)
{
	static const size_t sizes[] = {[POUND_FIELD_REAL] = sizeof(double),
	                               [POUND_FIELD_COUNT] = sizeof(int),
	                               [POUND_FIELD_CHOICE] = sizeof(int),
	                               [POUND_FIELD_BOOL] = sizeof(bool),
	                               [POUND_FIELD_EACH] = 0};
	struct pound_row_contact *contact = &scene->contacts[field.offset / sizeof *contact];
	const size_t at = field.offset % sizeof *contact, start = offsetof(struct pound_row_contact, contact);
	if (at >= start)
		memset(contact->own + (at - start), 1, sizes[field.type]);
}

/* Writes a varied value into the field of a scene, converted to the field's type.
 *
 * Given    field    of a building or a contact: the scene must own its buildings and contacts
 * Test     unit_row_results: what_a_sweep_varies_is_what_a_document_says
 */
void pound_scene_assign(struct pound_scene *scene, struct pound_field field, double value)
{
	void *at = field_at(scene, field);
	if (field.part == POUND_PART_CONTACTS)
		own_assign(scene, field);
	if (field.type == POUND_FIELD_REAL)
		*(double *)at = value;
	else if (field.type == POUND_FIELD_EACH)
		each_assign(at, field.storey, value);
	else if (field.type == POUND_FIELD_BOOL)
		*(bool *)at = value != 0;
	else
		*(int *)at = (int)value;
}

double pound_scene_field(const struct pound_scene *scene, struct pound_field field)
{
	const void *at = field_at(scene, field);
	if (field.type == POUND_FIELD_REAL)
		return *(const double *)at;
	if (field.type == POUND_FIELD_EACH)
		return pound_each_of(at, field.storey > 0 ? field.storey - 1 : 0);
	return field.type == POUND_FIELD_BOOL ? *(const bool *)at : *(const int *)at;
}

bool pound_field_alike(struct pound_field a, struct pound_field b)
{
	return a.part == b.part && a.offset == b.offset && a.storey == b.storey;
}

bool pound_field_overlaps(struct pound_field a, struct pound_field b)
{
	return a.part == b.part && a.offset == b.offset &&
	       (a.storey == b.storey || a.storey == 0 || b.storey == 0);
}

/* Oscillator i as input of the solver, at rest; the caller sets its yield displacement.
 *
 * Given    scene, i
 * Returns  body      stiffness w^2 [1/s2], damping 2 xi w [1/s]; a rigid wall does not move relative to the ground
 * Source   model.md 1
 */
struct pound_task_body pound_scene_body(const struct pound_scene *scene, int i)
{
	const struct pound_oscillator *o = &scene->oscillators[i];
	const struct pound_law *law = pound_scene_law(scene, i);
	if (o->rigid_wall)
		return (struct pound_task_body){.drive = 0};
	double w = 2 * PI * o->frequency_hz;
	return (struct pound_task_body){
	    .backbone = {.law = law->type, .stiffness = w * w, .hardening = law->hardening_ratio},
	    .damping = 2 * o->damping_ratio * w,
	    .drive = 1,
	};
}

/* Contact of a scene, divided by the left mass, in a task whose bodies are set.
 *
 * Returns  task  gap [m], the law over m1, m1/m2 (0: wall)
 *
 *   m = m1 m2/(m1 + m2), with infinite mass of a wall; the reference stiffness of the contact is max(k1, k2)
 *
 * Source   model.md 1; the paper, Eq. (1)
 */
void pound_scene_contact(const struct pound_scene *scene, struct pound_task *task)
{
	const struct pound_contact *contact = &scene->contact;
	const struct pound_oscillator *left = &scene->oscillators[0];
	const struct pound_oscillator *right = &scene->oscillators[1];
	double k1 = task->bodies[0].backbone.stiffness; // per own mass
	double k2 = right->rigid_wall ? 0 : task->bodies[1].backbone.stiffness;
	task->contact = true;
	task->force = pound_contact_force(contact->model);
	task->gap = contact->gap;
	task->tension = contact->tension || !pound_contact_reads(contact->model, "tension");
	task->mass_ratio = right->rigid_wall ? 0 : left->mass / right->mass;
	// k2 m2/m1 = k2/mass_ratio
	const struct pound_contact_place place = {
	    .stiffness = right->rigid_wall ? k1 : fmax(k1, k2 / task->mass_ratio),
	    .inverse_mass = 1 + task->mass_ratio, // m/m1 = 1/(1 + m1/m2)
	    .mass = left->mass,
	};
	task->law = pound_contact_law(contact, &place);
	task->contact_stiffness = task->law.stiffness;
	task->contact_damping = task->law.dashpot;
}

/* Whether two laws are the same law with the same parameters; a linear law has none. */
static bool laws_alike(const struct pound_law *a, const struct pound_law *b)
{
	if (a->type != b->type)
		return false;
	return pound_law_linear(a->type) ||
	       (a->hardening_ratio == b->hardening_ratio && a->target_demand == b->target_demand &&
	        a->yield_displacement == b->yield_displacement && a->corrections == b->corrections);
}

/* Whether two oscillators move identically under any ground motion, so that they never touch with force. */
bool pound_scene_alike(const struct pound_scene *scene)
{
	const struct pound_oscillator *o = scene->oscillators;
	return !o[1].rigid_wall && laws_alike(pound_scene_law(scene, 0), pound_scene_law(scene, 1)) &&
	       o[0].frequency_hz == o[1].frequency_hz && o[0].damping_ratio == o[1].damping_ratio;
}

/* Reduction of the elastic displacement that gives the target demand, by the ratio of excitation to own frequency.
 *
 *   q_y = mu_d where f_e/f >= 1/6, else 1 + (mu_d - 1) 6 f_e/f
 *
 * Source   model.md 3; the paper, Figure 3
 */
double pound_scene_reduction(const struct pound_scene *scene, double frequency_hz, double demand)
{
	const double f_e = pound_excitation_frequency(&scene->excitation);
	const double rise = f_e > 0 ? 6 * f_e / frequency_hz : 1;
	return 1 + (demand - 1) * fmin(rise, 1);
}
