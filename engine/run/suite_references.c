/* suite_references.c - reference intensities of the records of a suite (a record's peak, its spectral acceleration, or the suite's
 * median of these), and the adequacy of their sampling. */
#include "engine/run/suite_references.h"

#include <gsl/gsl_sort.h>
#include <math.h>

#include "engine/ground/excitation.h"
#include "engine/scene/building.h"
#include "engine/solver/solver.h"

static const double PI = 3.14159265358979323846;

/* Median of sorted numbers; of an even number the geometric mean of the middle two. */
static double median(const double *sorted, int n)
{
	return n % 2 ? sorted[n / 2] : sqrt(sorted[n / 2 - 1]) * sqrt(sorted[n / 2]);
}

enum {
	PAIRS =
	    2 *
	    POUND_BUILDINGS_MAX /* tasks to check a record: each body on the record and on its interpolation */
};

#define TASKS(suite) ((size_t)((suite)->n_records > PAIRS ? (suite)->n_records : PAIRS))

/* Layout of the scratch memory: the solver's, tasks, their results, and the longest record at twice its rate. */
static size_t results_start(const struct pound_excitation *suite)
{
	return POUND_EXACT_SCRATCH + TASKS(suite) * sizeof(struct pound_task);
}

size_t pound_suite_scratch(const struct pound_excitation *suite)
{
	int least, longest;
	pound_suite_samples(suite, &least, &longest);
	return results_start(suite) + TASKS(suite) * sizeof(struct pound_task_result) +
	       sizeof(double) * 2 * (size_t)longest;
}

static const struct pound_solver exact = {.method = POUND_SOLVER_EVENT};

/* A linear oscillator on a record. */
static struct pound_task oscillator(const struct pound_record *record, double w, double damping_ratio)
{
	return (struct pound_task){.ground = record->a,
	                           .n_samples = record->n,
	                           .time_step = record->time_step,
	                           .bodies = {{.backbone = {.stiffness = w * w},
	                                       .damping = 2 * damping_ratio * w,
	                                       .drive = 1,
	                                       .followed = true}}};
}

/* Spectral accelerations of all records, each times its factor. */
static enum pound_status spectral(const struct pound_excitation *suite, char *scratch,
                                  const atomic_bool *stop, double *sa)
{
	const double w = 2 * PI / suite->scale.period;
	struct pound_task *tasks = (struct pound_task *)(void *)(scratch + POUND_EXACT_SCRATCH);
	struct pound_task_result *results = (struct pound_task_result *)(void *)(scratch + results_start(suite));
	for (int k = 0; k < suite->n_records; k++)
		tasks[k] = (struct pound_task){.ground = suite->records[k].a,
		                               .n_samples = suite->records[k].n,
		                               .time_step = suite->records[k].time_step,
		                               .bodies = {{.backbone = {.stiffness = w * w},
		                                           .damping = 2 * suite->scale.damping_ratio * w,
		                                           .drive = 1,
		                                           .followed = true}}};
	enum pound_status status = pound_solver_run(&exact, tasks, results, suite->n_records, scratch, stop);
	for (int k = 0; k < suite->n_records && status == POUND_OK; k++) {
		status = results[k].status;
		sa[k] = suite->records[k].factor * (w * w * results[k].displacement_max[0]);
	}
	return status;
}

/* Reference intensity of each record, the divisor of the target intensity.
 *
 * Given    suite       -            -      scaled; no record is 0 throughout
 * Returns  references  (n_records)  m/s2   of each record times its own factor
 * Status   POUND_STOPPED  stop was set
 * Memory   scratch     (pound_suite_scratch)
 *
 *   pga         max |a_k|
 *   sa          w^2 max |u_k|,  u'' + 2 xi w u' + w^2 u = -a_k,  w = 2 pi/T      pseudo-acceleration, exact
 *   median_sa   median of sa over the suite, the same for all records
 *
 * Test     unit_suite: factors_are_those_of_their_definition
 */
enum pound_status pound_suite_references(const struct pound_excitation *suite, void *scratch,
                                         const atomic_bool *stop, double *references)
{
	const size_t n = (size_t)suite->n_records;
	for (size_t k = 0; k < n && suite->scale.to == POUND_SCALE_PGA; k++)
		references[k] =
		    suite->records[k].factor * pound_excitation_largest(suite->records[k].n, suite->records[k].a);
	if (suite->scale.to == POUND_SCALE_PGA)
		return POUND_OK;
	const enum pound_status status = spectral(suite, scratch, stop, references);
	if (status == POUND_OK && suite->scale.to == POUND_SCALE_MEDIAN_SA) {
		gsl_sort(references, 1, n);
		const double middle = median(references, suite->n_records);
		for (size_t k = 0; k < n; k++)
			references[k] = middle;
	}
	return status;
}

/* The oscillator that represents a body: a building's first mode with the damping of its first story; false: a wall. */
static bool body_of(const struct pound_scene *scene, int i, double *w, double *damping_ratio)
{
	if (!scene->n_buildings) {
		const struct pound_oscillator *body = &scene->oscillators[i];
		*w = 2 * PI * body->frequency_hz, *damping_ratio = body->damping_ratio;
		return !body->rigid_wall;
	}
	struct pound_storeys storeys;
	if (pound_row_storeys(scene, i) == 0)
		return false;
	pound_building_storeys(&scene->buildings[i], &storeys);
	*w = storeys.frequency, *damping_ratio = pound_each_of(&scene->buildings[i].damping_ratio, 0);
	return true;
}

/* Error of linear interpolation between samples: peak displacement of a body on the record over the peak on its band-limited
 * interpolation at twice the rate, which is also linear between samples, less 1.
 *
 * Given    scene        -            -   bodies taken as linear and without contact, a building as its first mode
 * Returns  differences  (n_records)  -   largest over all bodies; NAN: only walls
 * Status   POUND_STOPPED  stop was set
 * Memory   scratch      (pound_suite_scratch)
 *
 * Valid    an oscillator at the frequency f of a sine: cos^2(pi f dt / 2) - 1, -0.024 of 10 samples per cycle
 * Test     unit_suite: the_cost_of_linear_interpolation_is_that_of_its_closed_form
 */
enum pound_status pound_suite_differences(const struct pound_scene *scene, void *scratch,
                                          const atomic_bool *stop, double *differences)
{
	const struct pound_excitation *suite = &scene->excitation;
	struct pound_task *tasks = (struct pound_task *)(void *)((char *)scratch + POUND_EXACT_SCRATCH);
	struct pound_task_result *results =
	    (struct pound_task_result *)(void *)((char *)scratch + results_start(suite));
	double *twice = (double *)(void *)(results + TASKS(suite));
	enum pound_status status = POUND_OK;
	for (int k = 0; k < suite->n_records && status == POUND_OK; k++) {
		const struct pound_record *record = &suite->records[k];
		const struct pound_record finer = {
		    .n = 2 * record->n - 1, .time_step = record->time_step / 2, .a = twice};
		int n = 0;
		pound_interpolation_twice(record->n, record->a, twice);
		for (int i = 0; i < (scene->n_buildings ? scene->n_buildings : POUND_OSCILLATORS); i++) {
			double w, damping_ratio;
			if (!body_of(scene, i, &w, &damping_ratio))
				continue;
			tasks[n++] = oscillator(record, w, damping_ratio);
			tasks[n++] = oscillator(&finer, w, damping_ratio);
		}
		status = n ? pound_solver_run(&exact, tasks, results, n, scratch, stop) : POUND_OK;
		differences[k] = n ? 0 : NAN;
		for (int j = 0; j < n && status == POUND_OK; j += 2) {
			const double u = results[j].displacement_max[0], fine = results[j + 1].displacement_max[0];
			const double difference = fine > 0 ? u / fine - 1 : 0;
			differences[k] = fabs(difference) > fabs(differences[k]) ? difference : differences[k];
		}
	}
	return status;
}
