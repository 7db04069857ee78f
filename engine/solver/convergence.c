/* convergence.c - errors of the solvers at several settings, relative to the event solver under the same signals.
 *
 * 1. Trial 0 is the event solver, the reference.  Trial 1 is the adaptive solver at its smallest tolerance, an independent check
 *    of the reference.  Then come the settings of each solver.  Each trial runs the whole study, including any search for yield
 *    displacements.
 * 2. Largest values are compared over the whole motion, in which impacts may amplify errors to the size of the response;
 *    displacement histories over the first seconds, before that.
 * 3. The observed order is the slope of log mean history error over log setting between two successive settings. */
#include "engine/solver/convergence.h"

#include <float.h>
#include <math.h>

#include "engine/ground/excitation.h"
#include "engine/numeric/elementary.h"
#include "engine/solver/solver.h"

static const double TIGHTEST =
    1e-12; /* tolerance of trial 1; with a smaller one rounding errors of rk8pd dominate */

enum { REFERENCE, SECOND_OPINION, FIRST };

/* Number of trials of a study, including the reference and the check. */
int pound_convergence_trials(const struct pound_study *study)
{
	int n = FIRST;
	for (int row = 0; row < POUND_SOLVERS; row++)
		n += study->convergence.settings[row].n;
	return n;
}

static struct pound_solver setting(const struct pound_study *study, int row, double value)
{
	if (pound_solver_takes_step(row))
		return (struct pound_solver){.method = row,
		                             .tolerance = NAN,
		                             .step = pound_fixed_step(study->scene.excitation.time_step, value)};
	return (struct pound_solver){.method = row, .tolerance = value, .step = NAN};
}

/* The solver of a trial and its setting, the step as it is taken; a setting that the solver does not have is NAN. */
struct pound_solver pound_convergence_solver(const struct pound_study *study, int trial)
{
	if (trial == REFERENCE)
		return (struct pound_solver){.tolerance = NAN, .step = NAN};
	if (trial == SECOND_OPINION)
		return setting(study, POUND_SOLVER_ADAPTIVE, TIGHTEST);
	int row = 0, k = trial - FIRST;
	for (; k >= study->convergence.settings[row].n; row++)
		k -= study->convergence.settings[row].n;
	return setting(study, row, study->convergence.settings[row].values[k]);
}

/* Samples of the ground motion at which displacements are compared: evenly spaced over the first seconds.  In a suite seconds
 * are counted with the longest time step of the records, and the samples end with the shortest record.
 *
 * Returns  samples   (value)   ascending, from 1 on
 *          value     -         number of samples
 */
int pound_convergence_times(const struct pound_study *study, int samples[static POUND_HISTORY])
{
	const struct pound_excitation *e = &study->scene.excitation;
	double asked = fmin(study->convergence.history / e->time_step, INT32_MAX);
	int least = 0, most = 0;
	if (e->n_records)
		pound_suite_samples(e, &least, &most);
	else
		least = pound_excitation_samples(e);
	int last = (int)fmin(fmax(floor(asked + 0.5), 1), least - 1);
	int n = last < POUND_HISTORY ? last : POUND_HISTORY;
	for (int k = 0; k < n; k++)
		samples[k] = (int)((int64_t)last * (k + 1) / n);
	return n;
}

/* ---- errors ---- */

struct sum {
	double total, largest;
	int n;
};

static void sum_add(struct sum *sum, double error)
{
	if (isnan(error))
		return;
	sum->total += error;
	sum->largest = fmax(sum->largest, error);
	sum->n++;
}

static struct pound_deviation error_of(const struct sum *sum)
{
	if (sum->n == 0)
		return (struct pound_deviation){NAN, NAN};
	return (struct pound_deviation){sum->total / sum->n, sum->largest};
}

/* Error relative to the reference; if the reference is 0, relative to the value. */
static double relative(double value, double reference)
{
	double of = reference != 0 ? fabs(reference) : fabs(value);
	return value == reference ? 0 : fabs(value - reference) / of;
}

/* Largest difference of the displacements over the largest displacement of the reference; NAN: a run failed. */
static double history_error(const struct pound_trial_run *run, const struct pound_trial_run *reference, int n)
{
	double apart = 0, largest = 0;
	for (int k = 0; k < n; k++) {
		// NAN if the run has failed: its displacements are NAN from then on
		double d = fabs(run->history[k] - reference->history[k]);
		apart = d <= apart ? apart : d;
		largest = fmax(largest, fabs(reference->history[k]));
	}
	return largest > 0 ? apart / largest : relative(apart, 0);
}

static double setting_of(const struct pound_solver *solver)
{
	return pound_solver_takes_step(solver->method) ? solver->step : solver->tolerance;
}

/* Observed order between two trials; NAN: an error is 0 or missing, or the setting does not decrease. */
static double order_between(const struct pound_trial *coarse, const struct pound_trial *fine)
{
	double ratio = setting_of(&coarse->solver) / setting_of(&fine->solver);
	if (!(ratio > 1) || !(coarse->history.mean > 0) || !(fine->history.mean > 0))
		return NAN;
	return pound_elementary_log(coarse->history.mean / fine->history.mean) / pound_elementary_log(ratio);
}

/* Errors of all trials.
 *
 * Given    runs      (n_trials x n_signals)   trials in the order of pound_convergence_solver
 * Returns  trials    (n_trials)               errors over all signals for which neither run failed
 * Test     unit_convergence
 */
void pound_convergence_reduce(const struct pound_study *study, const struct pound_trial_run *runs,
                              struct pound_trial *trials)
{
	int n_trials = pound_convergence_trials(study), n_signals = study->scene.excitation.signals;
	int samples[POUND_HISTORY], n_times = pound_convergence_times(study, samples);
	for (int j = 0; j < n_trials; j++) {
		struct pound_trial *trial = &trials[j];
		struct sum displacement = {0}, demand = {0}, impulse = {0}, history = {0}, cpu = {0};
		*trial = (struct pound_trial){.solver = pound_convergence_solver(study, j), .order = NAN};
		for (int i = 0; i < n_signals; i++) {
			const struct pound_trial_run *run = &runs[j * n_signals + i], *reference = &runs[i];
			trial->runs_failed += isnan(run->displacement);
			sum_add(&displacement, relative(run->displacement, reference->displacement));
			sum_add(&demand, relative(run->demand, reference->demand));
			sum_add(&impulse, relative(run->impulse, reference->impulse));
			sum_add(&history, history_error(run, reference, n_times));
			sum_add(&cpu, run->cpu);
		}
		trial->displacement = error_of(&displacement);
		trial->demand = error_of(&demand);
		trial->impulse = error_of(&impulse);
		trial->history = error_of(&history);
		trial->cpu = error_of(&cpu).mean;
		if (j > FIRST && trials[j - 1].solver.method == trial->solver.method)
			trial->order = order_between(&trials[j - 1], trial);
	}
}

/* Observed order of a solver: slope of log mean history error over log setting, by least squares over its settings.
 *
 * Given    trials    (n_trials)   from pound_convergence_reduce
 * Returns  value     -            NAN: fewer than two settings have an error > 0
 *
 * Test     unit_convergence: without_contact_both_fixed_steps_are_of_second_order
 */
double pound_convergence_order(const struct pound_trial *trials, int n_trials, int method)
{
	double n = 0, x = 0, y = 0, xx = 0, xy = 0;
	for (int j = FIRST; j < n_trials; j++) {
		if (trials[j].solver.method != method || !(trials[j].history.mean > 0))
			continue;
		double p = pound_elementary_log(setting_of(&trials[j].solver));
		double q = pound_elementary_log(trials[j].history.mean);
		n++, x += p, y += q, xx += p * p, xy += p * q;
	}
	return n > 1 ? (n * xy - x * y) / (n * xx - x * x) : NAN;
}
