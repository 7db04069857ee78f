/* row_runs.h - the runs of samples of rows of buildings, without duplicates: every building alone, and with pounding. */
#ifndef ROW_RUNS_H
#define ROW_RUNS_H

#include "engine/exact/chain.h"
#include "engine/floor/floor.h"
#include "engine/run/outputs.h"
#include "engine/run/request_motions.h"
#include "engine/scene/building.h"

/* State of the runs of one building without pounding. */
struct pound_building_ask {
	int march;                /* last one requested, -1: none */
	enum pound_status status; /* of the marches that determine its yield drifts */
	bool wanted;              /* its response without pounding is needed, beyond finding its yield drifts */
	bool finished;            /* the last march is that response */
};

/* The runs of one sample. */
struct pound_row_ask {
	struct pound_building_ask buildings[POUND_BUILDINGS_MAX];
	double *
	    yields; /* yield drifts of the stories [m], scaled; 0: the law has none, or the story never moves  (floors) */
	double impulse_scale; /* as in pound_row_response */
	unsigned asked;       /* POUND_CHAIN_* bits */
	int march;            /* with pounding; -1: the responses without pounding are final */
	int closing;          /* all buildings together without contact; -1: not run */
};

/* A damping matrix computed before, to reuse for an equal building. */
struct pound_modal_known {
	struct pound_storeys storeys;
	double damping_ratio;
	const double *matrix; /* NULL: none */
};

/* POUND_CHAIN_* bits that a study requests: a response study all except energies, other studies what their outputs read. */
unsigned pound_row_asked(const struct pound_study *study);

/* The marches of a block; equal marches are run once. */
struct pound_row_asks {
	int n, done;                        /* marches requested, and run */
	struct pound_chain_task *tasks;     /* (n) */
	struct pound_chain_result *results; /* (n) */
	int *motions;                       /* ground motions of the tasks  (n) */
	int n_slots, *slots;                /* hash table of tasks  (n_slots), -1: empty */
	int n_floors, n_links, n_yields;    /* used entries of the pools */
	struct pound_chain_floor *floors;   /* floors of all tasks, one task after another */
	struct pound_link *links;
	double *floor_results; /* (n_floors x POUND_FLOOR_MEASURES) */
	double *link_results;  /* (n_links x POUND_LINK_MEASURES) */
	double *yields;        /* yield drifts of the samples' stories  (n_yields) */
	double *modal;         /* damping matrices  (n_modal) */
	int n_modal;
	struct pound_modal_known modal_known[POUND_BUILDINGS_MAX]; /* last one of each building */
	void *scratch;                                             /* of the solver */
	void *memory; /* buildings and contacts of the current scene  (pound_row_bytes) */
	struct pound_storey_response *storeys;   /* of the current response  (floors of a scene) */
	struct pound_contact_response *contacts; /* likewise  (contacts of a scene) */
};

/* Upper bounds for a block. */
struct pound_row_size {
	int tasks, floors, links, yields;
	int modal;             /* doubles of damping matrices */
	size_t memory;         /* bytes of a scene's buildings and contacts */
	size_t scratch;        /* bytes of scratch memory of a march */
	int storeys, contacts; /* of a scene */
};

void pound_row_size_add(struct pound_row_size *size, const struct pound_scene *scene, unsigned outputs_asked);
void pound_row_size_add_pair(struct pound_row_size *size);
void pound_row_clear(struct pound_row_asks *asks);

/* Requests two oscillators as a row of one-story buildings, divided by the left mass, with contact if pair->contact.
 * Returns the march. */
int pound_row_ask_pair(struct pound_row_asks *asks, const struct pound_task *pair,
                       const struct pound_motion *motion, unsigned asked);

/* Initializes a sample's runs without pounding; number of its stages; requests one stage of all its buildings: stage 0 is
 * linear, each later stage uses the yield drifts found so far.  Returns the number of runs requested. */
void pound_row_ask_free(struct pound_row_asks *asks, const struct pound_scene *scene,
                        struct pound_row_ask *ask, bool response, unsigned asked);
int pound_row_stages(const struct pound_scene *scene);
int pound_row_stage(struct pound_row_asks *asks, const struct pound_scene *scene, struct pound_row_ask *ask,
                    const struct pound_motion *motion, int stage, struct pound_work *work);

/* Requests a sample's run of all buildings together without contact, for the closing displacements. */
void pound_row_ask_closing(struct pound_row_asks *asks, const struct pound_scene *scene,
                           struct pound_row_ask *ask, const struct pound_motion *motion);

/* Requests a sample's run with pounding, unless the responses without pounding are final. */
void pound_row_ask_pounding(struct pound_row_asks *asks, const struct pound_scene *scene,
                            struct pound_row_ask *ask, const struct pound_motion *motion,
                            struct pound_work *work);

/* The yield drift of a story as given in the study [m]; 0: to be found, or none. */
double pound_row_yield_given(const struct pound_scene *scene, int b, int i);

/* Runs the marches requested since the last call: those before checks_end with the exact solver, others with the study's. */
enum pound_status pound_row_run(struct pound_row_asks *asks, const struct pound_solver *solver,
                                int checks_end, const atomic_bool *stop);

/* Repeats the marches from `from` on. */
enum pound_status pound_row_repeat(struct pound_row_asks *asks, const struct pound_solver *solver, int from,
                                   const atomic_bool *stop);

int64_t pound_row_contacts_run(const struct pound_row_asks *asks, int from); /* in marches from `from` on */

/* The floor at a place of a sample with a free response; pounding.task NULL: the free response is final. */
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
