/* request.h - the runs that a block of a study needs, without duplicates.
 *
 * An item is one signal of one row of the design.  Its samples in every cell are requested together, so that common parts
 * (ground motions, responses without pounding, whole runs) are found and run once. */
#ifndef REQUEST_H
#define REQUEST_H

#include <stdatomic.h>

#include "engine/exact/task.h"
#include "engine/indices/indices.h"
#include "engine/numeric/random.h"
#include "engine/pound.h"
#include "engine/run/outputs.h"
#include "engine/run/row_runs.h"
#include "engine/solver/solver.h"

/* the scenes of a study by cell, row of the design and sample of the row */
struct pound_cells {
	const struct pound_study *study;
	const double *design; /* inputs of A and B  (rows x 2 x n_inputs) */
	int n_cells, n_rows, n_samples, n_signals;
	int check_every;          /* items 0, check_every, ... are repeated to check the integration; 0: none */
	const double *references; /* reference intensities of a scaled suite  (suite_references.h) */
	bool trials;              /* each row is the same scene under the same signals with another solver */
};

int pound_cells_checks(const struct pound_cells *campaign, int item); /* number of checks before this item */

struct pound_scene pound_cells_scene(const struct pound_cells *campaign, int cell, int row, int sample,
                                     void *row_memory);
/* The ground motion of a signal of that scene: the scene's excitation, or the signal's record of a suite. */
struct pound_excitation pound_cells_excitation(const struct pound_cells *campaign,
                                               const struct pound_scene *scene,
                                               const struct pound_place *place);
struct pound_suite_signal pound_cells_record(const struct pound_cells *campaign,
                                             const struct pound_scene *scene,
                                             const struct pound_place *place);
struct pound_stream pound_cells_noise(const struct pound_cells *campaign, int row, int sample, int signal);
struct pound_solver pound_cells_solver(const struct pound_cells *campaign, int row);
double pound_cells_sweep(const struct pound_cells *campaign, int cell, int sweep);
size_t pound_cells_values_size(const struct pound_cells *c,
                               int n_rows); /* numerators of an output in a cell */
bool pound_cells_means(const struct pound_cells *c);
struct pound_sample_values pound_cells_values(const struct pound_cells *c, int n_rows, const double *columns);

struct pound_request_size {
	int asks;                   /* samples of all items, at most */
	int motions;                /* ground motions at most */
	int tasks;                  /* solver runs, at most */
	int peaks;                  /* of these with observed pairs */
	int64_t samples;            /* of all ground motions at most */
	struct pound_row_size rows; /* for rows of buildings */
};

/* Upper bounds for an item of one row, without its check. */
struct pound_request_size pound_request_size(const struct pound_cells *campaign, int row);

struct pound_request; /* scratch memory of one worker */

size_t pound_request_bytes(struct pound_request_size size);
size_t pound_request_scratch(struct pound_request_size size); /* of these for the solver */
struct pound_request *pound_request_init(void *memory, struct pound_request_size size);

/* Runs items [first, first + n), of one row if rows are trials, and passes every response to `take`, in the order of
 * item, cell, sample, then the responses of the checks in the same order. */
struct pound_items {
	const struct pound_cells *campaign;
	int first, n; /* item = row n_signals + signal */
};
typedef void pound_request_take(void *into, const struct pound_outcome *outcome);
enum pound_status pound_request_run(struct pound_request *request, struct pound_items items,
                                    const atomic_bool *stop, struct pound_work *work,
                                    pound_request_take *take, void *into);

/* After pound_request_run, if each item has one sample: the displacement of the left body, or of the top of the left
 * building, at a sample of the ground motion, by running the item's march up to it; NAN: the run failed. */
enum pound_status pound_request_displacement(struct pound_request *request, const struct pound_solver *solver,
                                             int item, int sample, const atomic_bool *stop, double *u);

/* After pound_request_run: the number of asks (samples requested); the first n_items belong to items, the others to checks. */
int pound_request_count(const struct pound_request *request, int *n_items);

/* The floor of an ask: the left body, or in a row of buildings the place of the spectrum; motions are scaled by 2^-exponent. */
struct pound_request_floor {
	bool contact;              /* the scene has a contact */
	bool touches;              /* false: the response without pounding is the answer */
	double mass, frequency_hz; /* of the floor [kg]; first frequency of its body without pounding */
	const struct pound_task *pounding, *free; /* of two oscillators; pounding NULL: no contact occurs */
	struct pound_row_floor row;               /* of a row of buildings */
	int march;                                /* number of the task with the final response */
	int exponent;
	void *scratch; /* for a repeated run: POUND_EXACT_SCRATCH bytes, or the scratch of row runs */
};

struct pound_request_floor pound_request_floor(const struct pound_request *request, int ask);
/* The task with both bodies of an ask, motions also scaled by 2^-exponent. */
struct pound_task pound_request_pair(const struct pound_request *request, int ask);

/* After pound_request_run: the response with pounding of an ask as a chain, for a repeated run; motions are scaled by
 * 2^-exponent.  The struct points into itself and into the request. */
struct pound_request_chain {
	struct pound_scene scene;
	struct pound_chain_task task; /* links NULL: no contact occurs */
	struct pound_chain_result result;
	struct pound_pair_chain pair; /* of two oscillators */
	double mass;                  /* divisor of impulses [kg] */
	int exponent;
	void *scratch;
};
void pound_request_chain(const struct pound_request *request, int ask, struct pound_request_chain *chain);

/* After pound_request_run, to measure time: repeats its marches with pounding, or all marches if there are none.
 * n: number of marches. */
enum pound_status pound_request_repeat(struct pound_request *request, const struct pound_solver *solver,
                                       const atomic_bool *stop, int *n);

#endif
