/* trials.c - the trials of a convergence study: histories and times of a block, and their reduction. */
#include "engine/run/trials.h"

#include <math.h>
#include <string.h>

/* Least CPU time to measure over [s]. */
static const double CLOCK_LEAST = 0.02;

/* CPU time per run of the request's last block, repeated until CLOCK_LEAST has passed; NAN without a clock. */
static enum pound_status run_time(const struct pound_run *run, struct pound_request *request,
                                  const struct pound_solver *solver, double *cpu)
{
	*cpu = NAN;
	if (!run->cpu)
		return POUND_OK;
	double start = run->cpu(), now;
	int n = 0, more;
	do {
		enum pound_status status = pound_request_repeat(request, solver, run->stop, &more);
		if (status)
			return status;
		n += more;
		now = run->cpu();
	} while (now - start < CLOCK_LEAST && n > 0);
	if (n > 0)
		*cpu = (now - start) / n;
	return POUND_OK;
}

/* Adds histories and CPU times to a block of one trial. */
enum pound_status pound_trials_block(const struct pound_run *run, struct pound_request *request, int first,
                                     int n, struct pound_trial_run *runs)
{
	const struct pound_cells *c = &run->campaign;
	const struct pound_solver solver = pound_cells_solver(c, first / c->n_signals);
	int samples[POUND_HISTORY], n_times = pound_convergence_times(c->study, samples);
	enum pound_status status = POUND_OK;
	for (int item = 0; item < n; item++) {
		double *history = runs[item].history;
		for (int k = 0; k < n_times && !status; k++) {
			if (k > 0 && isnan(history[k - 1]))
				history[k] = NAN; // it failed earlier
			else
				status =
				    pound_request_displacement(request, &solver, item, samples[k], run->stop, &history[k]);
		}
	}
	double cpu = NAN;
	if (!status)
		status = run_time(run, request, &solver, &cpu);
	for (int item = 0; item < n; item++)
		runs[item].cpu = cpu;
	return status;
}

void pound_trials_reduce(struct pound_run *run, double *scratch)
{
	int n = pound_blocks_items(&run->campaign);
	for (int item = 0; item < n; item++)
		memcpy(scratch + (size_t)item * POUND_TRIAL_MEASURES, pound_blocks_run(&run->layout, item, 0, 0),
		       sizeof(double) * POUND_TRIAL_MEASURES);
	pound_convergence_reduce(run->campaign.study, (const struct pound_trial_run *)scratch,
	                         run->result.trials);
	run->result.cells[0].runs_failed = 0;
	for (int j = 0; j < run->result.n_trials; j++)
		run->result.cells[0].runs_failed += run->result.trials[j].runs_failed;
}
