/* partial_results.h - the last results so far of a few studies: making one takes as long as all indices of its rows.  Any thread. */
#ifndef PARTIAL_RESULTS_H
#define PARTIAL_RESULTS_H

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

enum { PARTIAL_RESULTS = 8 };

struct partial_result {
	int64_t id; /* of the study; 0: none */
	int rows;   /* of the design that it is of */
	char *body; /* (length) bytes of JSON */
	size_t length;
	double until; /* [s] monotonic: so long it is given */
};

struct partial_results {
	pthread_mutex_t lock;
	struct partial_result result[PARTIAL_RESULTS];
};

/* A copy of a study's last result, for the caller to free; NULL: no result, one that is too old, or no memory. */
char *partial_results_take(struct partial_results *results, int64_t id, size_t *length, int *rows);
/* Keeps a copy of a result that took so long to make [s]. */
void partial_results_give(struct partial_results *results, const struct partial_result *made, double took);
void partial_results_free(struct partial_results *results);

#endif
