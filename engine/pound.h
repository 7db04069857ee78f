/* pound.h - the functions that compute the result (result.h) of a study (study.h).
 *
 * The headers directly in engine/ are the interface to other folders.
 * Any function may run in any thread; two threads may run blocks of one run at once with different worker numbers. */
#ifndef POUND_H
#define POUND_H

#include <stdatomic.h>

#include "engine/result.h"
#include "engine/study.h"

#define POUND_VERSION "0.24.0"

/* The computation of one study; owns all its memory.  The study must outlive the run.
 *
 *   create -> block 0 .. blocks-1 (any order, any thread) -> reduce 0 .. reductions-1 (likewise) -> grow -> result
 *             block blocks .. <- more blocks ---------------------------------------------------------'
 *
 * A model that runs elsewhere has no blocks: create -> sample_inputs ... sample_assign ... -> reduce -> result.
 *
 * A finished block is pound_run_block_size() doubles at pound_run_block_values(); restoring them replaces
 * running the block, so a caller can store blocks and resume after a restart with the same bytes. */
struct pound_run;

/* Outputs of samples (rows x samples x outputs x cells) from which the indices of pound_run_rows_quick() are made. */
enum { POUND_VALUES_QUICK = 40 * 1024 };

struct pound_run *pound_run_create(const struct pound_study *study, int n_workers); /* NULL: out of memory */
/* the same; NULL soon after the flag is set: drawing a design of a million rows takes seconds */
struct pound_run *pound_run_create_by(const struct pound_study *study, int n_workers,
                                      const atomic_bool *stop);
/* Work of one signal of one row of the design: equal ground motions and equal runs count once. */
struct pound_run_shared {
	double samples; /* of a ground motion, on average */
	double motions, marches;
};
/* memory of a run [bytes]; nothing is allocated */
double pound_run_bytes(const struct pound_study *study, int n_workers, const struct pound_run_shared *shared);
void pound_run_free(struct pound_run *run);
int pound_run_blocks(const struct pound_run *run);                    /* to run before the next reductions */
int pound_run_blocks_most(const struct pound_run *run);               /* at most, if the design grows */
int64_t pound_run_block_runs(const struct pound_run *run, int block); /* pounding runs requested */
enum pound_status pound_run_block(struct pound_run *run, int block, int worker);
size_t pound_run_block_size(const struct pound_run *run, int block); /* doubles */
const double *pound_run_block_values(const struct pound_run *run, int block);
void pound_run_block_restore(struct pound_run *run, int block, const double *values);
int pound_run_reductions(const struct pound_run *run);
enum pound_status pound_run_reduce(struct pound_run *run, int reduction, int worker);
const struct pound_result *
pound_run_result(struct pound_run *run); /* after the last reduction; owned by run */
/* After the last reduction: true if an interval is too wide, so that the design grows: run the additional blocks and
 * repeat all reductions.  False: the result is final. */
bool pound_run_grow(struct pound_run *run);
/* Intermediate results: how many rows at the start of the design are complete, done: (pound_run_blocks_most); and a switch
 * to reductions and results of the first `rows` rows. */
int pound_run_rows_done(const struct pound_run *run, const bool *done);
void pound_run_rows_take(struct pound_run *run, int rows);
void pound_run_rows_complete(struct pound_run *run, int rows); /* says of how many these are the first */
/* ... how many rows such a result may have that is to be made in about a tenth of a second, ... */
int pound_run_rows_quick(const struct pound_run *run);
/* ... and a second run that shares the values of a sampled run, to reduce complete rows while the run goes on */
struct pound_run *pound_run_view(const struct pound_run *run, int n_workers, const atomic_bool *stop);
int pound_run_rows(const struct pound_run *run); /* used by the reductions */
/* Seconds of CPU time of the calling thread, for the times of a convergence study; before the first block. */
void pound_run_clock(struct pound_run *run, double (*cpu)(void));
/* Blocks and reductions return POUND_STOPPED soon: they check the flag every few milliseconds. */
void pound_run_stop(struct pound_run *run);
/* The caller's flag, which must outlive the run, replaces the flag that pound_run_stop sets. */
void pound_run_stop_by(struct pound_run *run, const atomic_bool *stop);
bool pound_run_stopped(const struct pound_run *run);

/* The sample behind row `row` and design block `sample` (0: A, 1: B, 2 + j: A with column j from B, ...), after all
 * blocks: the input values, and for each output in a cell the ratio of means over its signals and the variance
 * of that mean (NAN: failed run, or the variance with one signal). */
int pound_run_samples(const struct pound_run *run); /* number in a row */
void pound_run_sample_inputs(const struct pound_run *run, int row, int sample, double *x);
struct pound_sample_output {
	double mean, variance;
};
struct pound_sample_output pound_run_sample_output(const struct pound_run *run, int cell, int row, int sample,
                                                   int output);

/* The ground motion of a signal of a sample, which need not have been run: the number of its samples, and its
 * accelerations [m/s2] at times 0, step, ...  (value of pound_run_motion_samples) */
struct pound_place {
	int cell, row, sample, signal;
};

int pound_run_motion_samples(const struct pound_run *run, const struct pound_place *place, double *step);
void pound_run_motion(const struct pound_run *run, const struct pound_place *place, double *a);
/* The record of a suite that the signal is. */
struct pound_suite_signal pound_run_motion_record(const struct pound_run *run,
                                                  const struct pound_place *place);

/* Sets an output of a sample that was computed elsewhere, before the reductions: its value, and the variance of the
 * value over the model's randomness (NAN: not known).  A value that is not finite: a failed run. */
void pound_run_sample_assign(struct pound_run *run, int row, int sample, int output, double value,
                             double variance);

/* The same for a study with replicates, all values of a sample at once.  value: (study->replicates), in the order of the
 * noise draws: the values r of all samples of a row share their noise if the study's signals are common */
void pound_run_replicates_assign(struct pound_run *run, int row, int sample, int output, const double *value);

/* Both oscillators at one time, with pounding: left, right. */
struct pound_instant {
	double time;                                       /* [s] */
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS]; /* relative to the ground [m], [m/s] */
	double acceleration[POUND_OSCILLATORS];            /* absolute [m/s2] */
	double force;                                      /* of the contact, > 0 pushes the bodies apart [N] */
	double gap;    /* clear distance, < 0: overlap; NAN: the scene has no contact [m] */
	double ground; /* acceleration [m/s2] */
};

/* The history of one signal of a floor spectrum study: at its samples, on both sides of every event, and so often between
 * them that straight lines between rows give the response spectrum within 0.5 % (engine/floor/spectra.md).  Runs the signal
 * again, in the scratch memory of worker 0. */
typedef void pound_run_take(void *into, int signal, const struct pound_instant *instant);
enum pound_status pound_run_history(struct pound_run *run, int signal, pound_run_take *take, void *into);

/* A counted contact of a response; with rigid contact, an impact. */
struct pound_impact {
	int cell, contact, left_building; /* contact: index in the order of the result */
	double levels[2];                 /* of the left building and its right neighbor; NAN: two oscillators */
	double begin, end;                /* [s] */
	double speed, impulse;            /* approach speed at `begin` [m/s]; of the contact force [N s] */
};

/* The contacts of one signal of a response study, in every cell.  Runs it again, in the scratch memory of worker 0. */
typedef void pound_impact_take(void *into, const struct pound_impact *impact);
enum pound_status pound_run_impacts(struct pound_run *run, int signal, pound_impact_take *take, void *into);

/* Intensity measures of a ground motion: motion_measures.c. */
struct pound_motion_measures {
	double pga;      /* peak ground acceleration [m/s2] */
	double pgv;      /* peak ground velocity [m/s] */
	double pgd;      /* peak ground displacement [m] */
	double arias;    /* Arias intensity [m/s] */
	double duration; /* significant duration, 5 to 95 % of the Arias intensity [s] */
};

void pound_motion_measure(int n, const double *a, double step, struct pound_motion_measures *measures);

const char *pound_status_text(enum pound_status status);
const char *pound_status_error(enum pound_status status); /* why a study has no result */

#endif
