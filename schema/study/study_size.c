/* study_size.c - the size of a study (cells, runs, samples, steps) and its limits. */
#include "schema/study/study_size.h"

#include <math.h>
#include <stdio.h>

#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

enum { POINTER_SIZE = 64 };

/* Values of a sweep.  An invalid sweep has none: its field keeps the value of the scene, which is one. */
static int values_of(const struct pound_sweep *sweep)
{
	return sweep->n_values ? sweep->n_values : 1;
}

double study_size_cells(const struct pound_study *study)
{
	double product = 1.0;
	for (int s = 0; s < study->n_sweeps; s++)
		product *= values_of(&study->sweeps[s]);
	return product;
}

/* Time steps of the shortest and the longest ground motion. */
void study_size_steps(const struct pound_study *study, double *least, double *most)
{
	double low, high, step_low, step_high, frequency_low, frequency_high;
	if (study->scene.excitation.n_record) {
		*least = *most = study->scene.excitation.n_record - 1;
		return;
	}
	if (study->scene.excitation.n_records) {
		int fewest, longest;
		pound_suite_samples(&study->scene.excitation, &fewest, &longest);
		*least = fewest - 1;
		*most = longest - 1;
		return;
	}
	study_check_reach(study, "/excitation/time_step_s", &step_low, &step_high);
	if (study_check_uses(study, "/scene/excitation/cycles")) {
		study_check_reach(study, "/excitation/cycles", &low, &high);
		study_check_reach(study, "/excitation/frequency_hz", &frequency_low, &frequency_high);
		low /= frequency_high;
		high /= frequency_low;
	} else {
		study_check_reach(study, "/excitation/duration_s", &low, &high);
	}
	*least = low / step_high;
	*most = high / step_low;
}

static const char *size_pointer(const struct pound_study *study)
{
	return pound_study_sampled(study) ? "/design/rows" : "/scene/excitation/signals";
}

/* Runs per cell and signal. */
static double design_runs(const struct pound_study *study)
{
	if (study->kind == POUND_KIND_CONVERGENCE)
		return pound_convergence_trials(study);
	return !pound_study_sampled(study) ? 1
	                                   : (double)pound_design_rows_most(study) * pound_design_samples(study);
}

/* Steps of the longest sample interval; 1 for a solver without a fixed step, as its steps are not known. */
static double interval_steps(const struct pound_study *study, const struct pound_solver *solver)
{
	double low, high;
	if (!pound_solver_takes_step(solver->method))
		return 1;
	study_check_reach(study, "/excitation/time_step_s", &low, &high);
	return fmax(1, ceil(high / solver->step));
}

static void check_step(const struct pound_study *study, const struct pound_solver *solver,
                       const char *pointer, struct problems *problems)
{
	double n = interval_steps(study, solver);
	if (n > STUDY_STEPS_MAX)
		problems_exceed(problems, pointer, n, STUDY_STEPS_MAX,
		                "needs %.3g steps in one sample interval; the limit is %d", n, STUDY_STEPS_MAX);
}

static void check_steps(const struct pound_study *study, struct problems *problems)
{
	char pointer[POINTER_SIZE];
	if (study->kind != POUND_KIND_CONVERGENCE)
		check_step(study, &study->solver, "/solver/step_s", problems);
	for (int row = 0; row < POUND_SOLVERS && study->kind == POUND_KIND_CONVERGENCE; row++)
		for (int k = 0; k < study->convergence.settings[row].n; k++) {
			const struct pound_solver solver = {.method = row,
			                                    .step = study->convergence.settings[row].values[k]};
			snprintf(pointer, sizeof pointer, "/convergence/%s/steps_s/%d", pound_solver_name(row), k);
			check_step(study, &solver, pointer, problems);
		}
}

void study_size_check_rows(const struct pound_study *study, struct problems *problems)
{
	const struct pound_design *design = &study->design;
	bool nets = pound_design_quasi_random(design->method), grows = design->until.half_width > 0;
	if (grows && pound_design_rows(study, 0) == 0)
		problems_add(problems, "/design/until/max_runs", "must be at least %lld: %d rows of %lld runs",
		             (long long)(pound_design_rows_least(study) * pound_design_row_runs(study)),
		             pound_design_rows_least(study), (long long)pound_design_row_runs(study));
	if (nets && !grows && design->rows < 2 * design->randomisations)
		problems_add(problems, "/design/rows", "must be at least %d, two for each randomisation, got %d",
		             2 * design->randomisations, design->rows);
}

/* A growing design needs intervals of every S1 and ST, and ST cannot be estimated from one random signal that the samples of a row
 * share. */
static void check_until(const struct pound_study *study, struct problems *problems)
{
	if (study->design.until.half_width > 0 && study_check_uses(study, "/scene/excitation/signals") &&
	    study->scene.excitation.signals == 1 && study->design.common_signals)
		problems_add(
		    problems, "/design/until",
		    "needs /scene/excitation/signals of 2 or more, or \"independent\" /design/signals: ST cannot "
		    "be estimated from one signal that the samples of a row share");
	bool listed = study->design.until.output == 0;
	for (int o = 0; o < study->n_outputs; o++)
		listed |= study->outputs[o] == study->design.until.output - 1;
	if (!listed && !problems_at(problems, "/outputs") && !problems_at(problems, "/design/until/output"))
		problems_add(problems, "/design/until/output", "must be one of the study's outputs, got \"%s\"",
		             pound_output_name(study->design.until.output - 1));
}

void study_size_check(const struct pound_study *study, struct problems *problems)
{
	const char *pointer = size_pointer(study);
	bool sampled = pound_study_sampled(study);
	int most = study->kind == POUND_KIND_CONVERGENCE ? STUDY_TRIALS_MAX : STUDY_RUNS_MAX;
	double runs = study_size_cells(study) * design_runs(study) * study->scene.excitation.signals;
	if (sampled)
		study_size_check_rows(study, problems);
	if (sampled && !problems_at(problems, "/scene/excitation/type") &&
	    !problems_at(problems, "/design/signals"))
		check_until(study, problems);
	if (problems_at(problems, "/sweep"))
		return; // the number of cells is not known
	if (runs > most)
		problems_exceed(problems, pointer, runs, most, "needs %.15g pounding runs; the limit is %d", runs,
		                most);
	if (!study_check_steps_known(study, problems) || problems_at(problems, "/solver"))
		return;
	double at_once =
	    study_size_cells(study) * (sampled ? pound_design_samples(study) : 1) * study_samples(study);
	bool few = runs <= most; // else reported above
	if (few && runs * study_samples(study) > STUDY_WORK_MAX)
		problems_exceed(problems, pointer, runs * study_samples(study), STUDY_WORK_MAX,
		                "needs %.3g samples of ground motion in all runs; the limit is %.0e",
		                runs * study_samples(study), STUDY_WORK_MAX);
	else if (few && runs * study_steps(study) > STUDY_WORK_MAX)
		problems_exceed(problems, pointer, runs * study_steps(study), STUDY_WORK_MAX,
		                "needs %.3g steps of the solver in all runs; the limit is %.0e",
		                runs * study_steps(study), STUDY_WORK_MAX);
	const double floors = study->scene.n_buildings ? pound_row_floors(&study->scene) : 0;
	if (few && floors * runs * study_samples(study) > STUDY_WORK_MAX)
		problems_exceed(problems, pointer, floors * runs * study_samples(study), STUDY_WORK_MAX,
		                "needs %.3g samples of floors in all runs; the limit is %.0e",
		                floors * runs * study_samples(study), STUDY_WORK_MAX);
	if (at_once > STUDY_AT_ONCE_MAX)
		problems_exceed(problems, "/sweep", at_once, STUDY_AT_ONCE_MAX,
		                "needs %.3g samples of ground motion at once (cells x samples of a row x samples of "
		                "a motion); the limit is %d",
		                at_once, STUDY_AT_ONCE_MAX);
	check_steps(study, problems);
}

/* ---- sizes ---- */

int study_cells(const struct pound_study *study)
{
	return (int)study_size_cells(study);
}

int64_t study_runs(const struct pound_study *study)
{
	return (int64_t)(study_size_cells(study) * design_runs(study) * study->scene.excitation.signals);
}

double study_samples(const struct pound_study *study)
{
	double least, most;
	study_size_steps(study, &least, &most);
	return floor(most + 0.5) + 1;
}

double study_steps(const struct pound_study *study)
{
	int n = study->kind == POUND_KIND_CONVERGENCE ? pound_convergence_trials(study) : 1;
	double sum = 0;
	for (int j = 0; j < n; j++) {
		const struct pound_solver solver =
		    study->kind == POUND_KIND_CONVERGENCE ? pound_convergence_solver(study, j) : study->solver;
		sum += interval_steps(study, &solver);
	}
	return study_samples(study) * sum / n;
}

double study_cell_sweep(const struct pound_study *study, int cell, int sweep)
{
	for (int s = study->n_sweeps - 1; s > sweep; s--)
		cell /= values_of(&study->sweeps[s]);
	return study->sweeps[sweep].values[cell % study->sweeps[sweep].n_values];
}

/* The scene of a cell; the last sweep varies fastest.  Buildings and contacts are the study's: sweeps of them have no effect here.
 *
 * Test     unit_study_check: cells_are_the_product_of_the_sweeps_the_last_one_fastest
 */
void study_cell(const struct pound_study *study, int cell, struct pound_scene *scene)
{
	*scene = study->scene;
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].field.part == POUND_PART_SCENE && study->sweeps[s].n_values)
			pound_scene_assign(scene, study->sweeps[s].field, study_cell_sweep(study, cell, s));
}

void study_cell_row(const struct pound_study *study, int cell, void *memory, struct pound_scene *scene)
{
	study_cell(study, cell, scene);
	pound_row_own(scene, memory);
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].field.part != POUND_PART_SCENE && study->sweeps[s].n_values)
			pound_scene_assign(scene, study->sweeps[s].field, study_cell_sweep(study, cell, s));
}
