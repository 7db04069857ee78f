/* suite_references.c - what the records of a suite are scaled by: a record's peak, its spectral acceleration, or the median of
 * these over the suite. */
#include "engine/run/suite_references.h"

#include <gsl/gsl_sort.h>
#include <math.h>

#include "engine/ground/excitation.h"
#include "engine/solver/solver.h"

static const double PI = 3.14159265358979323846;

/* The middle one of sorted numbers, of an even number the geometric mean of both. */
static double median(const double *sorted, int n)
{
	return n % 2 ? sorted[n / 2] : sqrt(sorted[n / 2 - 1]) * sqrt(sorted[n / 2]);
}

/* What is in the work space: that of the solver, then tasks and their results. */
static size_t results_start(const struct pound_excitation *suite)
{
	return POUND_EXACT_SCRATCH + (size_t)suite->n_records * sizeof(struct pound_task);
}

size_t pound_suite_scratch(const struct pound_excitation *suite)
{
	return results_start(suite) + (size_t)suite->n_records * sizeof(struct pound_task_result);
}

/* Spectral accelerations of all records, each times its factor. */
static enum pound_status spectral(const struct pound_excitation *suite, char *scratch,
                                  const atomic_bool *stop, double *sa)
{
	static const struct pound_solver exact = {.method = POUND_SOLVER_EVENT};
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

/* What the intensity is divided by to scale each record.
 *
 * Given    suite       -            -      to be scaled; no record is 0 throughout
 * Returns  references  (n_records)  m/s2   of the record times its own factor
 * Status   POUND_STOPPED  stop was set
 * Memory   scratch     (pound_suite_scratch)
 *
 *   pga         max |a_k|
 *   sa          w^2 max |u_k|,  u'' + 2 xi w u' + w^2 u = -a_k,  w = 2 pi/T      pseudo-acceleration, exact
 *   median_sa   of these the median, the same for all records
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
