/* request_size.c - how much work space an item of a study takes at most. */
#include <string.h>

#include "engine/ground/excitation.h"
#include "engine/run/request.h"

/* Gives a scene buildings that have the storeys of a cell. */
static void storeys_put(const struct pound_cells *campaign, int cell,
                        struct pound_building buildings[POUND_BUILDINGS_MAX], struct pound_scene *scene)
{
	memcpy(buildings, scene->buildings, sizeof *buildings * (size_t)scene->n_buildings);
	scene->buildings = buildings;
	for (int s = 0; s < campaign->study->n_sweeps; s++)
		if (campaign->study->sweeps[s].field.part == POUND_PART_BUILDINGS)
			pound_scene_assign(scene, campaign->study->sweeps[s].field, pound_cells_sweep(campaign, cell, s));
}

/* Upper bounds for the items of one row: whatever may differ between its samples counts as different. */
struct pound_request_size pound_request_size(const struct pound_cells *campaign, int row)
{
	struct pound_request_size size = {0};
	const unsigned asked = pound_outputs_asked(campaign->study);
	for (int cell = 0; cell < campaign->n_cells; cell++)
		for (int sample = 0; sample < campaign->n_samples; sample++) {
			struct pound_building buildings[POUND_BUILDINGS_MAX];
			struct pound_scene scene = pound_cells_scene(campaign, cell, row, sample, NULL);
			int marches = scene.n_buildings == 0;
			for (int i = 0; i < POUND_OSCILLATORS && scene.n_buildings == 0; i++)
				marches += 2 + pound_scene_law(&scene, i)->corrections;
			if (scene.n_buildings) {
				storeys_put(campaign, cell, buildings, &scene);
				pound_row_size_add(&size.rows, &scene);
			}
			size.asks++;
			size.motions++;
			marches += scene.n_buildings == 0 && asked & POUND_ASKS_APART;
			size.tasks += marches;
			size.peaks += asked & (POUND_ASKS_APART | POUND_ASKS_APPROACH) ? marches : 0;
			size.samples += pound_excitation_samples(&scene.excitation);
		}
	return size;
}
