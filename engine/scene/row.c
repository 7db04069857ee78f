/* row.c - a row of buildings as floors and contacts in a fixed order. */
#include <string.h>

#include "engine/study.h"

int pound_row_storeys(const struct pound_scene *scene, int building)
{
	const struct pound_building *b = &scene->buildings[building];
	return b->rigid_wall ? 0 : b->storeys;
}

int pound_row_first(const struct pound_scene *scene, int building)
{
	int n = 0;
	for (int b = 0; b < building; b++)
		n += pound_row_storeys(scene, b);
	return n;
}

int pound_row_floors(const struct pound_scene *scene)
{
	return pound_row_first(scene, scene->n_buildings);
}

const struct pound_law *pound_row_law(const struct pound_scene *scene, int building)
{
	const struct pound_building *b = &scene->buildings[building];
	return b->has_law ? &b->law : &scene->law;
}

/* Number of contacts of a gap if the document lists none: floor i touches floor i. */
static int floors_in_common(const struct pound_scene *scene, int gap)
{
	const int left = pound_row_storeys(scene, gap), right = pound_row_storeys(scene, gap + 1);
	return right > 0 && right < left ? right : left;
}

int pound_row_contacts(const struct pound_scene *scene)
{
	int n = scene->n_contacts;
	for (int gap = 0; gap < scene->n_buildings - 1 && scene->n_contacts == 0; gap++)
		n += floors_in_common(scene, gap);
	return scene->contact.present ? n : 0;
}

/* Contact k of a row; members that the contact does not set are taken from the scene's contact.
 *
 * Test     unit_row_results: what_a_sweep_varies_is_what_a_document_says
 */
void pound_row_contact_of(const struct pound_scene *scene, int k, struct pound_row_contact *contact)
{
	*contact = (struct pound_row_contact){.contact = scene->contact};
	if (scene->n_contacts) {
		const struct pound_row_contact *given = &scene->contacts[k];
		unsigned char *to = (unsigned char *)&contact->contact;
		const unsigned char *from = (const unsigned char *)&given->contact;
		contact->left_building = given->left_building;
		memcpy(contact->levels, given->levels, sizeof given->levels);
		for (size_t j = 0; j < sizeof given->contact; j++)
			to[j] = given->own[j] ? from[j] : to[j];
		return;
	}
	while (k >= floors_in_common(scene, contact->left_building))
		k -= floors_in_common(scene, contact->left_building++);
	contact->levels[0] = contact->levels[1] = k + 1;
}

/* Bytes of a scene's buildings and contacts; 0: not a row of buildings. */
size_t pound_row_bytes(const struct pound_scene *scene)
{
	return sizeof *scene->buildings * (size_t)scene->n_buildings +
	       sizeof *scene->contacts * (size_t)scene->n_contacts;
}

/* Copies the buildings and contacts of a scene, so that they can be varied.
 *
 * Given    memory   (pound_row_bytes)   outlives the scene
 */
void pound_row_own(struct pound_scene *scene, void *memory)
{
	const size_t buildings = sizeof *scene->buildings * (size_t)scene->n_buildings;
	if (scene->n_buildings == 0)
		return;
	memcpy(memory, scene->buildings, buildings);
	scene->buildings = memory;
	if (scene->n_contacts)
		memcpy((char *)memory + buildings, scene->contacts,
		       sizeof *scene->contacts * (size_t)scene->n_contacts);
	scene->contacts = (struct pound_row_contact *)(void *)((char *)memory + buildings);
}
