/* request_parts.h - internals of a request, for request.c, request_answers.c and request_size.c only. */
#ifndef REQUEST_PARTS_H
#define REQUEST_PARTS_H

#include "engine/run/demand.h"
#include "engine/run/pair_peaks.h"
#include "engine/run/request.h"
#include "engine/run/request_keys.h"
#include "engine/run/request_motions.h"

/* state of the runs of one body without pounding */
struct body_ask {
	int march;                /* last one requested, -1: none */
	double yield;             /* [m] scaled; 0: the law has none, or the body never moves */
	enum pound_status status; /* of the marches that determine its yield displacement */
	bool wanted;   /* its response without pounding is needed, beyond finding its yield displacement */
	bool finished; /* the last march is that response */
	bool found;    /* the search for the target demand is over */
	struct pound_demand demand;
};

struct ask {
	struct pound_scene scene;
	int cell, row, sample; /* of the scene */
	int motion;
	bool response; /* the whole response is requested */
	bool balanced; /* with energy balances of its runs */
	struct body_ask bodies[POUND_OSCILLATORS];
	int march;             /* with pounding; -1: the responses without pounding are final */
	int free_pair;         /* both bodies without contact, observed; -1: not run */
	int chain, chain_free; /* both bodies as one-story buildings: final, and without contact; -1: not run */
};

struct pound_request {
	struct pound_request_size size;
	struct pound_keys motion_keys, march_keys;
	struct pound_motion *motions;       /* (motions) */
	double *ground;                     /* (samples) */
	struct ask *asks;                   /* (asks) */
	struct pound_row_ask *row_asks;     /* for rows of buildings, instead of bodies and march  (asks) */
	struct pound_row_asks rows;         /* marches of row_asks */
	const struct pound_cells *campaign; /* of the last run */
	struct pound_task *tasks;           /* (tasks) */
	struct pound_task_result *results;  /* (tasks) */
	struct pound_pair_peaks *peaks; /* of observed marches, by march  (tasks; NULL: no output reads them) */
	double (*free_pair)
	    [2]; /* closing and opening displacement of both bodies without contact, by ask  (asks; none: not read) */
	struct pound_pairs pairs;    /* linear pairs to follow without contact */
	void *scratch;               /* of the solver */
	int n_before, n_rows_before; /* number of marches without pounding, which come first */
	int n_asks, n_items;         /* of the last run; n_items: without checks */
};

/* The scene of an ask with its own buildings, valid until the next call. */
struct pound_scene pound_request_row_scene(const struct pound_request *request, const struct ask *ask);

/* Task of both bodies of an ask, with known yield displacements, and their contact; the ground motion is not set. */
struct pound_task pound_request_pair_task(const struct pound_request *request, const struct ask *ask);

#endif
