/* run.h - the inside of a study being computed. */
#ifndef RUN_H
#define RUN_H

#include <stdatomic.h>

#include "engine/plan.h"

struct pound_run {
	struct pound_campaign campaign;
	int n_measures; /* doubles kept of a run */
	int n_blocks;
	int *first;     /* items: block b is first[b] .. first[b + 1] - 1  (n_blocks + 1) */
	double *values; /* of all blocks, each followed by those of its checks and its counts of work */
	struct pound_plan **plans; /* (n_workers) */
	double **scratch;          /* of reductions  (n_workers) */
	struct pound_result result;
	double *u;                        /* the design as probabilities  (rows x 2 x n_inputs) */
	struct pound_estimate *estimates; /* (n_cells x n_outputs x POUND_N_INDEXES x n_inputs) */
	struct pound_indices *indices;    /* (n_cells x n_outputs) */
	struct pound_response *responses; /* (n_cells x n_signals) */
	double (*cpu)(void);              /* clock of the calling thread [s]; NULL: none */
	atomic_bool stop;
};

/* The measures of one run  (n_measures). */
const double *pound_run_values(const struct pound_run *run, int item, int cell, int sample);

#endif
