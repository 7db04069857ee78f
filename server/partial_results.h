/* partial_results.h - cached partial results of a few studies: making one takes as long as computing all indices of its rows.  Any thread. */
#ifndef PARTIAL_RESULTS_H
#define PARTIAL_RESULTS_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PARTIAL_RESULTS = 8 };

struct partial_result {
	int64_t id; /* of the study; 0: none */
	int rows;   /* of the design, from which it was made */
	bool ended; /* of all complete rows of a study that goes on no more */
	char *body; /* (length) bytes of JSON */
	size_t length;
	double until; /* [s] monotonic, until when it is fresh */
};

struct partial_results {
	pthread_mutex_t lock;
	struct partial_result result[PARTIAL_RESULTS];
};

/* A copy of a study's last partial result, whose body the caller frees; NULL: none, or out of memory.
 *
 * Returns  value   it is fresh: no later one is needed */
bool partial_results_take(struct partial_results *results, int64_t id, struct partial_result *copy);
/* Keeps a copy of a partial result, unless the kept one has more rows; took: the time it took to make [s], 0: it is not fresh, a
 * later one is wanted. */
void partial_results_give(struct partial_results *results, const struct partial_result *made, double took);
void partial_results_free(struct partial_results *results);

#endif
