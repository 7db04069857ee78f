/* request.h - what a block of a study needs, each thing once.
 *
 * An item is one signal of one row of the design.  Its samples in every cell are asked for together, so whatever they
 * have in common (ground motions, responses without pounding, whole runs) is found and run once. */
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
	int check_every;          /* items 0, check_every, ... are run again to check the integration; 0: none */
	const double *references; /* of the records of a suite that are scaled  (suite_references.h) */
	bool trials; /* the rows are one scene under the same signals, each with a solver of its own */
};

int pound_cells_checks(const struct pound_cells *campaign, int item); /* among the items before this */

struct pound_scene pound_cells_scene(const struct pound_cells *campaign, int cell, int row, int sample,
                                     void *row_memory);
/* The ground motion of a signal of that scene: the scene's excitation, or of a suite the record that the signal is. */
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
	int asks;                   /* runs asked for at most */
	int motions;                /* ground motions at most */
	int tasks;                  /* marches at most */
	int peaks;                  /* of them whose pairs are observed */
	int64_t samples;            /* of all ground motions at most */
	struct pound_row_size rows; /* of rows of buildings */
};

/* Upper bounds for an item of one row, its check left out. */
struct pound_request_size pound_request_size(const struct pound_cells *campaign, int row);

struct pound_request; /* work space of one worker */

size_t pound_request_bytes(struct pound_request_size size);
size_t pound_request_scratch(struct pound_request_size size); /* of them for marches */
struct pound_request *pound_request_init(void *memory, struct pound_request_size size);

/* Runs items [first, first + n), of one row where rows are trials, and hands every response to `take`, in the order of
 * item, cell, sample, then those of the checks in the same order. */
struct pound_items {
	const struct pound_cells *campaign;
	int first, n; /* item = row n_signals + signal */
};
typedef void pound_request_take(void *into, const struct pound_outcome *outcome);
enum pound_status pound_request_run(struct pound_request *request, struct pound_items items,
                                    const atomic_bool *stop, struct pound_work *work,
                                    pound_request_take *take, void *into);

/* After pound_request_run, for its items in turn where each has one sample: the displacement of the left body, or of the
 * top of the left building, at a sample of the ground motion, by running its march that far; NAN: it failed. */
enum pound_status pound_request_displacement(struct pound_request *request, const struct pound_solver *solver,
                                             int item, int sample, const atomic_bool *stop, double *u);

/* After pound_request_run: its asks, of which the first n_items are those of the items and the others those of checks. */
int pound_request_count(const struct pound_request *request, int *n_items);

/* The floor of an ask: the left body, or of a row of buildings the place of the spectrum; its motions are times 2^-exponent. */
struct pound_request_floor {
	bool contact;                             /* the scene has one */
	bool touches;                             /* false: the response without pounding is the answer */
	double mass, frequency_hz;                /* of the floor [kg]; first of the body without pounding */
	const struct pound_task *pounding, *free; /* of two oscillators; pounding NULL: it does not touch */
	struct pound_row_floor row;               /* of a row of buildings */
	int march;                                /* number of the task that is the answer */
	int exponent;
	void *scratch; /* for who follows it: POUND_EXACT_SCRATCH bytes, or those of its row's marches */
};

struct pound_request_floor pound_request_floor(const struct pound_request *request, int ask);
/* The task that follows both bodies of an ask, its motion times 2^-exponent, too. */
struct pound_task pound_request_pair(const struct pound_request *request, int ask);

/* After pound_request_run: the response with pounding of an ask as a chain, to be followed once more; its motions are times
 * 2^-exponent.  It points into itself and into the request. */
struct pound_request_chain {
	struct pound_scene scene;
	struct pound_chain_task task; /* links NULL: the bodies do not touch */
	struct pound_chain_result result;
	struct pound_pair_chain pair; /* of two oscillators */
	double mass;                  /* that impulses are over [kg] */
	int exponent;
	void *scratch;
};
void pound_request_chain(const struct pound_request *request, int ask, struct pound_request_chain *chain);

/* After pound_request_run, for taking the time: its marches with pounding once more, all its marches if there is none.
 * n: how many. */
enum pound_status pound_request_repeat(struct pound_request *request, const struct pound_solver *solver,
                                       const atomic_bool *stop, int *n);

#endif
