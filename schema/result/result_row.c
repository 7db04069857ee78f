/* result_row.c - writes responses of rows of buildings as JSON: by building and storey, floor, contact. */
#include "schema/result/result_row.h"

#include <math.h>
#include <stddef.h>

#include "engine/scene/building.h"

static const double PI = 3.14159265358979323846;

struct measure {
	const char *name;
	size_t offset; /* in the response of a storey or of a contact */
};

#define X(member, name) {name, offsetof(struct pound_storey_response, member)},
static const struct measure storey_measures[] = {POUND_STOREY_MEASURES(X)},
                            floor_measures[] = {POUND_FLOOR_MEASURES(X)};
#undef X
#define X(member, name) {name, offsetof(struct pound_contact_response, member)},
static const struct measure contact_measures[] = {POUND_CONTACT_MEASURES(X)};
#undef X

enum {
	N_STOREY = sizeof storey_measures / sizeof storey_measures[0],
	N_FLOOR = sizeof floor_measures / sizeof floor_measures[0],
	N_CONTACT = sizeof contact_measures / sizeof contact_measures[0],
	N_END = 2, /* number of floor measures at the end of the signal, the last in the list */
};

static void write_measures(struct writer *w, const struct measure *measures, int n, const void *of)
{
	for (int k = 0; k < n; k++)
		writer_number(w, measures[k].name,
		              *(const double *)(const void *)((const char *)of + measures[k].offset));
}

static void write_building(struct writer *w, const struct pound_storey_response *storeys, int n)
{
	writer_object(w, NULL, WRITER_LINES);
	writer_array(w, "storeys", WRITER_LINES);
	for (int i = 0; i < n; i++) {
		writer_object(w, NULL, WRITER_LINE);
		write_measures(w, storey_measures, N_STOREY, &storeys[i]);
		writer_end(w);
	}
	writer_end(w);
	writer_array(w, "floors", WRITER_LINES);
	for (int i = 0; i < n; i++) {
		writer_object(w, NULL, WRITER_LINE);
		write_measures(w, floor_measures, N_FLOOR - N_END, &storeys[i]);
		writer_object(w, "end", WRITER_LINE);
		write_measures(w, floor_measures + N_FLOOR - N_END, N_END, &storeys[i]);
		writer_end(w);
		writer_end(w);
	}
	writer_end(w);
	writer_end(w);
}

static void write_contact(struct writer *w, const struct pound_scene *scene, int k,
                          const struct pound_contact_response *response)
{
	struct pound_row_contact contact;
	pound_row_contact_of(scene, k, &contact);
	writer_object(w, NULL, WRITER_LINE);
	writer_whole(w, "left_building", contact.left_building);
	writer_array(w, "levels", WRITER_LINE);
	for (int side = 0; side < 2; side++)
		writer_number(w, NULL, contact.levels[side]);
	writer_end(w);
	write_measures(w, contact_measures, N_CONTACT, response);
	writer_end(w);
}

/* Writes the modes of the buildings with their initial stiffness, one list for all, so that it is a table as it is.
 *
 * Test     unit_row_results: modes_are_of_the_buildings_of_the_cell
 */
void result_row_modes(struct writer *w, const struct pound_scene *scene)
{
	writer_array(w, "modes", WRITER_LINES);
	for (int b = 0; b < scene->n_buildings; b++) {
		struct pound_building_mode modes[POUND_STOREYS_MAX];
		const int n = pound_row_storeys(scene, b); // 0: a wall
		if (n)
			pound_building_modes(&scene->buildings[b], modes);
		for (int r = 0; r < n; r++) {
			writer_object(w, NULL, WRITER_LINE);
			writer_whole(w, "building", b);
			writer_whole(w, "mode", r + 1);
			writer_number(w, "frequency_hz", modes[r].frequency / (2 * PI));
			writer_number(w, "period_s", 2 * PI / modes[r].frequency);
			writer_number(w, "effective_mass_ratio", modes[r].mass_ratio);
			writer_number(w, "damping_ratio", modes[r].damping_ratio);
			writer_end(w);
		}
	}
	writer_end(w);
}

/* Writes the members of the response to one signal.
 *
 * Test     unit_row_results: rows_have_their_known_answers
 */
void result_row_signal(struct writer *w, const struct pound_scene *scene,
                       const struct pound_row_response *row)
{
	writer_array(w, "buildings", WRITER_LINES);
	for (int b = 0; b < scene->n_buildings; b++)
		write_building(w, row->storeys + pound_row_first(scene, b), pound_row_storeys(scene, b));
	writer_end(w);
	writer_array(w, "contacts", WRITER_LINES);
	for (int k = 0; k < pound_row_contacts(scene); k++)
		write_contact(w, scene, k, &row->contacts[k]);
	writer_end(w);
}

/* Whether the left building moves without pounding. */
bool result_row_moves(const struct pound_row_response *row, const struct pound_scene *scene)
{
	return row->storeys[pound_row_storeys(scene, 0) - 1].displacement_max_free != 0;
}

void result_row_place(struct writer *w, const struct pound_study *study, int output)
{
	bool any = false;
	if (pound_study_contact(study, output) >= 0)
		writer_whole(w, "contact", pound_study_contact(study, output));
	for (int o = 0; o < study->n_outputs && !study->elsewhere; o++)
		any |= pound_study_place(study, o) >= 0;
	if (!any)
		return;
	const int k = pound_study_place(study, output);
	writer_number(w, "building", k < 0 ? NAN : study->scene.places[k].building);
	writer_number(w, "storey", k < 0 ? NAN : study->scene.places[k].storey);
}
