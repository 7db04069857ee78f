/* partial_results.h - cached partial results of a few studies: making one takes as long as computing all indices of its rows.  Any thread. */
#ifndef PARTIAL_RESULTS_H
#define PARTIAL_RESULTS_H

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

enum { PARTIAL_RESULTS = 8 };

struct partial_result {
	int64_t id; /* of the study; 0: none */
	int rows;   /* of the design, from which it was made */
	char *body; /* (length) bytes of JSON */
	size_t length;
	double until; /* [s] monotonic, when it expires */
};

struct partial_results {
	pthread_mutex_t lock;
	struct partial_result result[PARTIAL_RESULTS];
};

/* A copy of a study's last partial result, for the caller to free; NULL: none, expired, or out of memory. */
char *partial_results_take(struct partial_results *results, int64_t id, size_t *length, int *rows);
/* Keeps a copy of a partial result; took: the time it took to make [s]. */
void partial_results_give(struct partial_results *results, const struct partial_result *made, double took);
void partial_results_free(struct partial_results *results);

#endif
