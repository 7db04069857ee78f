/* floor_tasks.c - tasks of specimens. */
#include "tests/support/floor_tasks.h"

#include "engine/run/scene.h"
#include "tests/support/check.h"

/* The task as the plan makes it, but not scaled. */
struct pound_task floor_task_task(const struct specimen *specimen, bool contact)
{
	const struct pound_scene *scene = &specimen->study.scene;
	const struct pound_response response = specimen_engine(specimen);
	const double yield[] = {response.yield_displacement_1, response.yield_displacement_2};
	struct pound_task task = {.ground = specimen->record,
	                          .n_samples = scene->excitation.n_record,
	                          .time_step = scene->excitation.time_step};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		task.bodies[i] = pound_scene_body(scene, i);
		task.bodies[i].followed = true;
		task.bodies[i].backbone.yield = pound_law_linear(task.bodies[i].backbone.law) ? 0 : yield[i];
	}
	if (contact)
		pound_scene_contact(scene, &task);
	return task;
}

/* Spectra of a task in work space of their own. */
struct pound_floor_answer floor_task_spectra(const struct pound_task *task,
                                             const struct pound_spectrum *spectrum, int n_drives,
                                             double radians, int lanes, double *psa[POUND_DRIVES])
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	size_t bytes = (pound_floor_bytes(spectrum->n) / 64 + 1) * 64;
	void *memory = aligned_alloc(64, bytes);
	assert_non_null(memory);
	struct pound_floor *floor = pound_floor_init(memory, spectrum);
	const struct pound_floor_ask ask = {
	    .task = task, .n_drives = n_drives, .radians = radians, .lanes = lanes, .scratch = scratch};
	struct pound_floor_answer answer = {.psa = {psa[0], psa[1]}};
	assert_int_equal(pound_floor_spectra(floor, &ask, &answer), POUND_OK);
	free(memory);
	return answer;
}
