/* request_answers.c - data of a request after its runs: floors, pairs, chains, displacements; and repeated runs. */
#include <assert.h>
#include <math.h>

#include "engine/run/request_parts.h"

/* pound_request_displacement for a row of buildings: top of the left building; overwrites the result of its march. */
static enum pound_status row_displacement(struct pound_request *request, const struct pound_solver *solver,
                                          int item, int sample, const atomic_bool *stop, double *u)
{
	const struct pound_scene scene = pound_request_row_scene(request, &request->asks[item]);
	const struct pound_storey_place top = {.building = 0, .storey = pound_row_storeys(&scene, 0)};
	const struct pound_row_floor floor =
	    pound_row_floor(&request->rows, &scene, &request->row_asks[item], &top);
	const struct pound_floor_of_chain *of = floor.pounding.task ? &floor.pounding : &floor.free;
	struct pound_chain_task task = *of->task;
	struct pound_chain_result result = *of->result;
	assert(sample >= 1 && sample < task.n_samples);
	task.n_samples = sample + 1;
	const enum pound_status status = pound_solver_rows(solver, &task, &result, 1, request->scratch, stop);
	if (status)
		return status;
	*u = result.status ? NAN : result.floors[of->floor * POUND_FLOOR_MEASURES + POUND_FLOOR_END_U];
	*u = ldexp(*u, request->motions[request->asks[item].motion].exponent);
	return POUND_OK;
}

enum pound_status pound_request_displacement(struct pound_request *request, const struct pound_solver *solver,
                                             int item, int sample, const atomic_bool *stop, double *u)
{
	const struct ask *ask = &request->asks[item];
	if (ask->scene.n_buildings)
		return row_displacement(request, solver, item, sample, stop, u);
	struct pound_task task = request->tasks[ask->march < 0 ? ask->bodies[0].march : ask->march];
	struct pound_task_result result;
	assert(sample >= 1 && sample < task.n_samples);
	task.n_samples = sample + 1;
	enum pound_status status = pound_solver_run(solver, &task, &result, 1, request->scratch, stop);
	if (status)
		return status;
	*u = result.status ? NAN : ldexp(result.u[0], request->motions[ask->motion].exponent);
	return POUND_OK;
}

enum pound_status pound_request_repeat(struct pound_request *request, const struct pound_solver *solver,
                                       const atomic_bool *stop, int *n)
{
	const struct pound_row_asks *rows = &request->rows;
	if (rows->n > 0) {
		const int first = request->n_rows_before < rows->n ? request->n_rows_before : 0;
		*n = rows->n - first;
		return pound_row_repeat(&request->rows, solver, first, stop);
	}
	int from = request->n_before < request->march_keys.n ? request->n_before : 0;
	*n = request->march_keys.n - from;
	return pound_solver_run(solver, &request->tasks[from], &request->results[from], *n, request->scratch,
	                        stop);
}

int pound_request_count(const struct pound_request *request, int *n_items)
{
	*n_items = request->n_items;
	return request->n_asks;
}

struct pound_request_floor pound_request_floor(const struct pound_request *request, int ask)
{
	const struct ask *a = &request->asks[ask];
	struct pound_request_floor floor = {.contact = a->scene.contact.present,
	                                    .exponent = request->motions[a->motion].exponent,
	                                    .scratch = request->scratch};
	if (a->scene.n_buildings) {
		const struct pound_scene scene = pound_request_row_scene(request, a);
		floor.row = pound_row_floor(&request->rows, &scene, &request->row_asks[ask],
		                            &request->campaign->study->spectrum.place);
		floor.touches = floor.row.pounding.task;
		const struct pound_floor_of_chain *of = floor.touches ? &floor.row.pounding : &floor.row.free;
		floor.mass = of->task->floors[of->floor].mass;
		floor.frequency_hz = floor.row.frequency_hz;
		floor.march = (int)(of->task - request->rows.tasks);
		return floor;
	}
	floor.mass = a->scene.oscillators[0].mass;
	floor.frequency_hz = a->scene.oscillators[0].frequency_hz;
	floor.touches = a->march >= 0;
	floor.pounding = a->march < 0 ? NULL : &request->tasks[a->march];
	floor.free = &request->tasks[a->bodies[0].march];
	floor.march = a->march < 0 ? a->bodies[0].march : a->march;
	return floor;
}

/* The two bodies of an ask together; without contact if the responses without pounding are final. */
struct pound_task pound_request_pair(const struct pound_request *request, int ask)
{
	const struct ask *a = &request->asks[ask];
	const struct pound_motion *m = &request->motions[a->motion];
	struct pound_task task = a->march < 0 ? pound_request_pair_task(request, a) : request->tasks[a->march];
	task.contact = a->march >= 0;
	task.ground = m->ground;
	task.n_samples = m->n_samples;
	task.time_step = m->time_step;
	return task;
}

void pound_request_chain(const struct pound_request *request, int ask, struct pound_request_chain *chain)
{
	const struct ask *a = &request->asks[ask];
	const struct pound_row_ask *row = &request->row_asks[ask];
	*chain = (struct pound_request_chain){.scene = a->scene,
	                                      .mass = 1,
	                                      .exponent = request->motions[a->motion].exponent,
	                                      .scratch = request->scratch};
	if (a->scene.n_buildings) {
		chain->scene = pound_request_row_scene(request, a);
		if (row->march < 0)
			return;
		chain->task = request->rows.tasks[row->march];
		chain->result = request->rows.results[row->march];
	} else if (a->march >= 0) {
		const struct pound_task task = pound_request_pair(request, ask);
		pound_pair_chain(&task, &chain->pair);
		chain->task = chain->pair.task;
		chain->result = (struct pound_chain_result){.floors = chain->pair.floor_measures[0],
		                                            .links = chain->pair.link_measures};
		chain->mass = a->scene.oscillators[0].mass;
	}
}
