/* compute.h - the blocks and reductions of one run, by threads of this process and workers in other processes. */
#ifndef COMPUTE_H
#define COMPUTE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "client/checkpoint.h"
#include "engine/pound.h"
#include "schema/message/launcher.h"

struct compute {
	const struct pound_study *study;
	struct pound_run *run;
	const char *document; /* (length) bytes */
	size_t length;
	int n_threads;
	const struct launch *launch;    /* of workers in other processes */
	const char *checkpoint;         /* file of finished blocks, NULL: none */
	const atomic_bool *interrupted; /* by the user */
	double elsewhere_s;             /* CPU time of the blocks run by workers in other processes [s] */
	bool refused;                   /* the checkpoint cannot be used: reported on stderr */
};

enum pound_status compute_run(struct compute *compute);

#endif
