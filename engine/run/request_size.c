/* request_size.c - the scratch memory of a request, and upper bounds of its use by an item of a study. */
#include <string.h>

#include "engine/ground/excitation.h"
#include "engine/numeric/hash.h"
#include "engine/run/request_parts.h"

/* Gives a scene its own buildings with the numbers of stories of a cell. */
static void storeys_put(const struct pound_cells *campaign, int cell,
                        struct pound_building buildings[POUND_BUILDINGS_MAX], struct pound_scene *scene)
{
	memcpy(buildings, scene->buildings, sizeof *buildings * (size_t)scene->n_buildings);
	scene->buildings = buildings;
	for (int s = 0; s < campaign->study->n_sweeps; s++)
		if (campaign->study->sweeps[s].field.part == POUND_PART_BUILDINGS)
			pound_scene_assign(scene, campaign->study->sweeps[s].field, pound_cells_sweep(campaign, cell, s));
}

/* Whether contact models of a row vary; the scenes here do not have the varied models. */
static bool models_vary(const struct pound_study *study)
{
	bool vary = false;
	for (int s = 0; s < study->n_sweeps; s++)
		vary |= study->sweeps[s].field.part == POUND_PART_CONTACTS &&
		        study->sweeps[s].field.type == POUND_FIELD_CHOICE;
	for (int j = 0; j < study->n_inputs; j++)
		vary |= study->inputs[j].field.part == POUND_PART_CONTACTS &&
		        study->inputs[j].field.type == POUND_FIELD_CHOICE;
	return vary;
}

/* Upper bounds for the items of one row: everything that may differ between its samples counts as different. */
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
				pound_row_size_add(&size.rows, &scene, asked);
			}
			size.rows.scratch = models_vary(campaign->study) ? POUND_CHAIN_SCRATCH : size.rows.scratch;
			size.asks++;
			size.motions++;
			if (scene.n_buildings == 0 && asked & POUND_ASKS_CHAIN)
				pound_row_size_add_pair(&size.rows);
			marches += scene.n_buildings == 0 && asked & POUND_ASKS_FREE_PAIR;
			size.tasks += marches;
			size.peaks += asked & POUND_ASKS_FREE_PAIR ? marches : 0;
			size.samples += pound_excitation_samples(&scene.excitation);
		}
	return size;
}

/* ---- scratch memory ---- */

/* Scratch of the solver in bytes: rows of buildings only take less than oscillators. */
size_t pound_request_scratch(struct pound_request_size size)
{
	return size.tasks || !size.rows.tasks ? (size_t)POUND_EXACT_SCRATCH : size.rows.scratch;
}

/* Carves a request out of memory, or with memory NULL only counts the bytes. */
static size_t request_carve(char *memory, struct pound_request *request, struct pound_request_size size)
{
	const struct pound_row_size *rows = &size.rows;
	const struct {
		void *into;
		size_t bytes;
	} parts[] = {
	    {&request->motion_keys.keys, sizeof(double) * POUND_KEY * (size_t)size.motions},
	    {&request->march_keys.keys, sizeof(double) * POUND_KEY * (size_t)size.tasks},
	    {&request->motion_keys.slots, sizeof(int) * (size_t)pound_hash_slots(size.motions)},
	    {&request->march_keys.slots, sizeof(int) * (size_t)pound_hash_slots(size.tasks)},
	    {&request->motions, sizeof *request->motions * (size_t)size.motions},
	    {&request->ground, sizeof(double) * (size_t)size.samples},
	    {&request->asks, sizeof *request->asks * (size_t)size.asks},
	    {&request->tasks, sizeof *request->tasks * (size_t)size.tasks},
	    {&request->results, sizeof *request->results * (size_t)size.tasks},
	    {&request->peaks, sizeof *request->peaks * (size_t)size.peaks},
	    {&request->free_pair, sizeof *request->free_pair * (size_t)(size.peaks ? size.asks : 0)},
	    {&request->scratch, pound_request_scratch(size)},
	    {&request->row_asks, sizeof *request->row_asks * (size_t)(rows->storeys ? size.asks : 0)},
	    {&request->rows.tasks, sizeof *request->rows.tasks * (size_t)rows->tasks},
	    {&request->rows.results, sizeof *request->rows.results * (size_t)rows->tasks},
	    {&request->rows.motions, sizeof(int) * (size_t)rows->tasks},
	    {&request->rows.slots, sizeof(int) * (size_t)(rows->tasks ? pound_hash_slots(rows->tasks) : 0)},
	    {&request->rows.floors, sizeof *request->rows.floors * (size_t)rows->floors},
	    {&request->rows.links, sizeof *request->rows.links * (size_t)rows->links},
	    {&request->rows.floor_results, sizeof(double) * POUND_FLOOR_MEASURES * (size_t)rows->floors},
	    {&request->rows.link_results, sizeof(double) * POUND_LINK_MEASURES * (size_t)rows->links},
	    {&request->rows.yields, sizeof(double) * (size_t)rows->yields},
	    {&request->rows.modal, sizeof(double) * (size_t)rows->modal},
	    {&request->rows.memory, rows->memory},
	    {&request->rows.storeys, sizeof *request->rows.storeys * (size_t)rows->storeys},
	    {&request->rows.contacts, sizeof *request->rows.contacts * (size_t)rows->contacts},
	};
	size_t at = (sizeof *request + 63) / 64 * 64;
	for (size_t j = 0; j < sizeof parts / sizeof parts[0]; j++) {
		if (memory)
			*(void **)parts[j].into = memory + at;
		at += (parts[j].bytes + 63) / 64 * 64;
	}
	return at;
}

/* Bytes of a request, to be 64-byte aligned. */
size_t pound_request_bytes(struct pound_request_size size)
{
	struct pound_request request;
	return request_carve(NULL, &request, size);
}

struct pound_request *pound_request_init(void *memory, struct pound_request_size size)
{
	struct pound_request *request = memory;
	memset(request, 0, sizeof *request);
	request_carve(memory, request, size);
	request->peaks = size.peaks ? request->peaks : NULL;
	request->size = size;
	request->motion_keys.n_slots = pound_hash_slots(size.motions);
	request->march_keys.n_slots = pound_hash_slots(size.tasks);
	request->rows.n_slots = size.rows.tasks ? pound_hash_slots(size.rows.tasks) : 0;
	request->rows.scratch = request->scratch;
	return request;
}
