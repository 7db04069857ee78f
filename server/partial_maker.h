/* partial_maker.h - makes partial results: soon, of few rows, in the thread of a request; of all complete rows, in its own. */
#ifndef PARTIAL_MAKER_H
#define PARTIAL_MAKER_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/partial_results.h"
#include "server/stored_run.h"
#include "server/workers.h"

struct server;

/* The complete rows of a study: of its run in memory, else of its stored blocks. */
struct partial_source {
	struct work_view view;
	struct stored_run opened; /* if `stored` */
	bool stored;
	const struct pound_study *study;
	struct pound_run *run;
	int rows_done;  /* 0: none, or the study is not sampled */
	bool ended;     /* the study has failed or was cancelled; set by the caller */
	int n_reducers; /* threads that may reduce at once */
};

/* NULL, or a sentence that says why it cannot be opened; close it in either case. */
const char *partial_source_open(struct server *server, int64_t id, const atomic_bool *stop,
                                struct partial_source *source);
void partial_source_close(struct partial_source *source);

struct partial_maker {
	struct server *server;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	int64_t wanted[PARTIAL_RESULTS]; /* studies, oldest first  (n_wanted) */
	int n_wanted;
	int64_t busy; /* the study whose result is being made, 0: none */
	atomic_bool stopping;
	bool started;
	pthread_t thread;
	atomic_ullong values; /* outputs of samples from which requests made results themselves */
};

bool partial_maker_start(struct partial_maker *maker, struct server *server); /* false: no thread */
/* A result for a request: the kept one in `result`, or one of so many of the complete rows, at least one, as take little time; of
 * all of them if the study has ended.  Its body is on the heap; NULL: a status says why, or out of memory. */
enum pound_status partial_maker_soon(struct partial_maker *maker, struct partial_source *source, int64_t id,
                                     struct partial_result *result);
bool partial_maker_stop(
    struct partial_maker *maker); /* false: it did not end in time, and may still use memory */

#endif
