/* row_runs.h - the runs that samples of a row of buildings need, each once: of every building alone, and with pounding. */
#ifndef ROW_RUNS_H
#define ROW_RUNS_H

#include "engine/exact/chain.h"
#include "engine/floor/floor.h"
#include "engine/run/outputs.h"
#include "engine/run/request_motions.h"
#include "engine/scene/building.h"

/* What is known of one building without pounding. */
struct pound_building_ask {
	int march;                /* the last one asked, -1: none */
	enum pound_status status; /* of the marches its yield drifts come from */
	bool wanted;              /* its response without pounding is needed, beyond finding its yield drifts */
	bool finished;            /* the last march is that response */
};

/* What a sample needs. */
struct pound_row_ask {
	struct pound_building_ask buildings[POUND_BUILDINGS_MAX];
	double *
	    yields; /* drifts of the storeys [m], scaled; 0: the law has none, or the storey never moves  (floors) */
	double impulse_scale; /* as in pound_row_response */
	unsigned asked;       /* of a chain */
	int march;            /* with pounding; -1: the responses without pounding are the answer */
	int closing;          /* of all buildings together without contact; -1: not run */
};

/* A damping matrix that is laid already, for buildings like this one. */
struct pound_modal_known {
	struct pound_storeys storeys;
	double damping_ratio;
	const double *matrix; /* NULL: none */
};

/* What the chains of a study are asked for: a response has all but energies, of outputs accelerations and forces are few. */
unsigned pound_row_asked(const struct pound_study *study);

/* The marches of a block; equal ones are run once. */
struct pound_row_asks {
	int n, done;                        /* marches asked, and run */
	struct pound_chain_task *tasks;     /* (n) */
	struct pound_chain_result *results; /* (n) */
	int *motions;                       /* of the tasks  (n) */
	int n_slots, *slots;                /* of the table of tasks  (n_slots), -1: empty */
	int n_floors, n_links, n_yields;    /* in use of the pools */
	struct pound_chain_floor *floors;   /* of the tasks, one after another */
	struct pound_link *links;
	double *floor_results; /* (n_floors x POUND_FLOOR_MEASURES) */
	double *link_results;  /* (n_links x POUND_LINK_MEASURES) */
	double *yields;        /* of the samples' storeys  (n_yields) */
	double *modal;         /* damping matrices  (n_modal) */
	int n_modal;
	struct pound_modal_known modal_known[POUND_BUILDINGS_MAX]; /* the last one of each building */
	void *scratch;                                             /* of the march */
	void *memory; /* buildings and contacts of the current scene  (pound_row_bytes) */
	struct pound_storey_response *storeys;   /* of the current response  (floors of a scene) */
	struct pound_contact_response *contacts; /* likewise  (contacts of a scene) */
};

/* Of a block, at most. */
struct pound_row_size {
	int tasks, floors, links, yields;
	int modal;             /* doubles of damping matrices */
	size_t memory;         /* bytes of a scene's buildings and contacts */
	size_t scratch;        /* bytes of work space of a march */
	int storeys, contacts; /* of a scene */
};

void pound_row_size_add(struct pound_row_size *size, const struct pound_scene *scene, unsigned outputs_asked);
void pound_row_size_add_pair(struct pound_row_size *size);
void pound_row_clear(struct pound_row_asks *asks);

/* Two oscillators as a row of one-story buildings, over the left mass; touching: with their contact.  Returns the march. */
int pound_row_ask_pair(struct pound_row_asks *asks, const struct pound_task *pair,
                       const struct pound_motion *motion, unsigned asked);

/* A sample's needs without pounding, to begin with; which stages it has; and one stage of all its buildings: 0 is linear,
 * each later one has the yield drifts found by then.  False: nothing is needed. */
void pound_row_ask_free(struct pound_row_asks *asks, const struct pound_scene *scene,
                        struct pound_row_ask *ask, bool response, unsigned asked);
int pound_row_stages(const struct pound_scene *scene);
int pound_row_stage(struct pound_row_asks *asks, const struct pound_scene *scene, struct pound_row_ask *ask,
                    const struct pound_motion *motion, int stage, struct pound_work *work);

/* Its run of all buildings together without contact, for how far their contacts close. */
void pound_row_ask_closing(struct pound_row_asks *asks, const struct pound_scene *scene,
                           struct pound_row_ask *ask, const struct pound_motion *motion);

/* Its run with pounding, unless the responses without it are the answer. */
void pound_row_ask_pounding(struct pound_row_asks *asks, const struct pound_scene *scene,
                            struct pound_row_ask *ask, const struct pound_motion *motion,
                            struct pound_work *work);

/* The yield drift of a storey that the document gives [m]; 0: it is found, or there is none. */
double pound_row_yield_given(const struct pound_scene *scene, int b, int i);

/* Runs the marches asked since the last time: those before checks_end by the exact solver, the others by that of the study. */
enum pound_status pound_row_run(struct pound_row_asks *asks, const struct pound_solver *solver,
                                int checks_end, const atomic_bool *stop);

/* Marches from one on once more. */
enum pound_status pound_row_repeat(struct pound_row_asks *asks, const struct pound_solver *solver, int from,
                                   const atomic_bool *stop);

int64_t pound_row_contacts_run(const struct pound_row_asks *asks, int from); /* in the marches from that on */

/* The floor at a place of a sample, whose free response was wanted; pounding has no task where it is the answer. */
struct pound_row_floor {
	double frequency_hz; /* of the building's first mode */
	struct pound_floor_of_chain free, pounding;
};

struct pound_row_floor pound_row_floor(const struct pound_row_asks *asks, const struct pound_scene *scene,
                                       const struct pound_row_ask *ask,
                                       const struct pound_storey_place *place);

/* The response of a sample in the units of the study. */
enum pound_status pound_row_response_of(const struct pound_row_asks *asks, const struct pound_scene *scene,
                                        const struct pound_row_ask *ask, int exponent,
                                        struct pound_row_response *response);

#endif
