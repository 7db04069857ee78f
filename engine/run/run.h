/* run.h - internals of the computation of a study. */
#ifndef RUN_H
#define RUN_H

#include <stdatomic.h>

#include "engine/run/blocks.h"

struct pound_run {
	struct pound_study study; /* as given, or with the number of signals from the pilot */
	struct pound_cells campaign;
	struct pound_blocks layout;
	int rows;                        /* current: of the look, or of an intermediate result */
	bool view;                       /* design, probabilities and blocks belong to another run */
	struct pound_request **requests; /* (n_workers) */
	double **scratch;                /* for reductions  (n_workers) */
	struct pound_ordinates **floors; /* (n_workers); entries NULL: no spectra requested */
	struct pound_result result;
	double *u;                                /* the design as probabilities  (rows x 2 x n_inputs) */
	struct pound_estimate *estimates;         /* columns  (n_cells x n_outputs x columns x n_inputs) */
	struct pound_indices *indices;            /* (n_cells x n_outputs) */
	struct pound_response *responses;         /* (n_cells x n_signals) */
	struct pound_row_response *row_responses; /* likewise, for a row of buildings */
	struct pound_suite_signal *records;       /* of the result  (n_cells x n_signals) */
	double *references;      /* of a suite's records, then their differences  (2 x n_records) */
	void *separation;        /* of the result */
	double *spectra;         /* of the result  (POUND_N_SPECTRA x 4 x frequencies) */
	double (*cpu)(void);     /* clock of the calling thread [s]; NULL: none */
	atomic_bool stopped;     /* set by pound_run_stop */
	const atomic_bool *stop; /* &stopped, or the caller's flag */
};

/* The layout, before anything is allocated. */
struct pound_cells pound_run_campaign(const struct pound_study *study);
struct pound_blocks pound_run_layout(const struct pound_cells *campaign);
size_t pound_run_reduction_size(const struct pound_cells *campaign); /* doubles of a worker's scratch, ... */
size_t
pound_run_kept_size(const struct pound_cells *campaign); /* ... of which the first are zero at the start */

/* Memory on the heap, 64-byte aligned, and the same zeroed; NULL: out of memory. */
void *pound_run_room(size_t bytes);
void *pound_run_piece(size_t bytes);

enum { POUND_RUN_PARTS = 11 };
struct pound_run_part {
	void *into; /* address of the pointer to it */
	size_t bytes;
};
bool pound_run_result_create(struct pound_run *run); /* false: out of memory */
void pound_run_result_parts(struct pound_run *run, struct pound_run_part parts[POUND_RUN_PARTS]);

/* Suites of records: whether a result lists the record of each signal; scaling of the records, false: stop was set; the list of
 * records. */
bool pound_run_suite(const struct pound_study *study);
size_t pound_run_scale_bytes(const struct pound_study *study); /* of scratch; 0: no records */
bool pound_run_scale(struct pound_run *run, void *scratch, const atomic_bool *stop);
void pound_run_records(struct pound_run *run);

/* The measures of an output in a cell as columns (rows x samples x signals), returns the failed runs; their sampling. */
int64_t pound_run_columns(const struct pound_run *run, int cell, int output, double *numerator,
                          double *denominator);
struct pound_sampling pound_run_sampling(const struct pound_run *run);
/* A split design: the pilot's study; and the pilot's run, which sets run->study and the result's split. */
struct pound_study pound_pilot_study(const struct pound_study *study);
size_t pound_pilot_scratch(const struct pound_run *pilot); /* doubles */
enum pound_status pound_pilot_run(struct pound_run *run, struct pound_run *pilot, double *scratch);

int pound_run_looks_most(const struct pound_study *study); /* 0: the design does not grow */

#endif
