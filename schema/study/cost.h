/* cost.h - what a study will take, before any of it is run.  Any thread. */
#ifndef COST_H
#define COST_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/pound.h"
#include "schema/json/problems.h"

struct cost {
	int64_t runs;      /* pounding runs asked for, before anything is shared */
	double cpu_s;      /* of one core, all in all [s] */
	double bytes;      /* in the database: blocks and result */
	double memory;     /* while it runs [bytes] */
	double cpu_s_high; /* 97 of 100 studies like it take at most [s] */
};

struct cost cost_of(const struct pound_study *study, int n_workers); /* that run its blocks */
double cost_of_runs(const struct pound_study *study);                /* [s], without reductions, as counted */

/* A study that takes a while is tried for a tenth of a second at most: what a few of its runs take corrects the count. */
bool cost_tried(const struct cost *cost);
void cost_try(struct cost *cost, const struct pound_study *study, const atomic_bool *unwanted);

/* Of a study of separation: one of another kind that takes as long, and the bytes of a result that only such a study has; of other
 * kinds the study itself, and 0. */
struct pound_study study_separation_like(const struct pound_study *study);
double study_separation_bytes(const struct pound_study *study);
bool cost_allowed(const struct cost *cost, const struct cost *most, struct problems *problems);
char *cost_to_json(const struct cost *cost, const struct pound_study *study,
                   size_t *length); /* NULL: no memory */

#endif
