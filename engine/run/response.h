/* response.h - from the runs of a scene under one ground motion to its response, in the units of the study. */
#ifndef RESPONSE_H
#define RESPONSE_H

#include "engine/exact/chain.h"
#include "engine/exact/task.h"

struct pound_body_known {
	const struct pound_task_result *free; /* without pounding; NULL: not run */
	double yield;             /* yield displacement [m], in the scale of the ground motion; 0: none */
	enum pound_status status; /* of the runs that determine it */
};

/* the runs of a scene */
struct pound_runs_known {
	const struct pound_scene *scene;
	int exponent;                             /* motions are scaled by 2^-exponent */
	const struct pound_task_result *pounding; /* NULL: the responses without pounding are final */
	struct pound_body_known bodies[POUND_OSCILLATORS];
	const struct pound_task_result
	    *free_pair;           /* both without contact, if the solver followed them; else NULL */
	const double *peaks_free; /* closing and opening displacement of both  (2); NULL: no output reads it */
	const struct pound_chain_result *chain,
	    *chain_free; /* both as one-story buildings, over the left mass; NULL: no output reads it */
};

enum pound_status pound_response_of(const struct pound_runs_known *known, struct pound_response *out);

#endif
