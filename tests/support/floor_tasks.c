/* floor_tasks.c - floor spectrum tasks of specimens. */
#include "tests/support/floor_tasks.h"

#include <math.h>

#include "engine/run/scene.h"
#include "tests/support/check.h"

/* The task as created by the plan, but not scaled. */
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

/* Computes the spectra of a task in newly allocated work space. */
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
	assert_int_equal(pound_floor_spectra(floor, &ask, &answer, 1), POUND_OK);
	free(memory);
	return answer;
}

/* Response of an oscillator to piecewise linear acceleration.
 *
 *   z'' + 2 xi w z' + w^2 z = -(a0 + s t) from row to row
 *
 * Valid    the motion is sampled 160 times per period between rows: the error of the largest displacement is 2e-4
 * Source   Nigam and Jennings, Bulletin of the Seismological Society of America 59 (1969) 909
 */
double floor_task_lines(int n, const struct floor_line *rows, double w, double xi)
{
	static const double PI = 3.14159265358979323846;
	const double wd = w * sqrt(1 - xi * xi);
	double z = 0, v = 0, most = 0;
	for (int i = 1; i < n; i++) {
		const double h = rows[i].time - rows[i - 1].time, a0 = rows[i - 1].acceleration;
		if (!(h > 0)) {
			v -= rows[i].v - rows[i - 1].v;
			continue;
		}
		const double s = (rows[i].acceleration - a0) / h;
		const double p0 = -a0 / (w * w) + 2 * xi * s / (w * w * w), p1 = -s / (w * w);
		const double c = z - p0, d = (v - p1 + xi * w * c) / wd;
		const int parts = (int)ceil(w * h / (2 * PI / 160));
		for (int k = 1; k <= parts; k++) {
			const double t = h * k / parts, decay = exp(-xi * w * t), co = cos(wd * t), si = sin(wd * t);
			z = p0 + p1 * t + decay * (c * co + d * si);
			v = p1 + decay * ((d * wd - xi * w * c) * co - (c * wd + xi * w * d) * si);
			most = fmax(most, fabs(z));
		}
	}
	return w * w * most;
}
