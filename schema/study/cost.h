/* cost.h - estimates the CPU time, memory and storage of a study before it is run.  Any thread. */
#ifndef COST_H
#define COST_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/pound.h"
#include "schema/json/problems.h"

struct cost {
	int64_t runs;      /* pounding runs requested, before shared work is subtracted */
	double cpu_s;      /* total, on one core [s] */
	double bytes;      /* stored in the database: blocks and result */
	double memory;     /* while the study runs [bytes] */
	double cpu_s_high; /* upper limit that 97 % of such studies stay below [s] */
};

struct cost cost_of(const struct pound_study *study, int n_workers); /* n_workers run its blocks */
double cost_of_runs(const struct pound_study *study);                /* [s], as counted, without reductions */

/* Corrects the estimate of a long study with the measured time of a few of its runs, in at most a tenth of a second. */
bool cost_tried(const struct cost *cost);
void cost_try(struct cost *cost, const struct pound_study *study, const atomic_bool *unwanted);

/* For a separation study: a study of another kind that takes as long, and the bytes that only a separation result has.  For other
 * kinds: the study itself, and 0. */
struct pound_study study_separation_like(const struct pound_study *study);
double study_separation_bytes(const struct pound_study *study);
bool cost_allowed(const struct cost *cost, const struct cost *most, struct problems *problems);
char *cost_to_json(const struct cost *cost, const struct pound_study *study,
                   size_t *length); /* NULL: no memory */

#endif
