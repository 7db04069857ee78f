/* metrics.h - counters of what the server has done, also as text for Prometheus.  Any thread. */
#ifndef METRICS_H
#define METRICS_H

#include <stdatomic.h>
#include <stddef.h>

#include "schema/http/api.h"

enum {
	METRICS_OPERATIONS = API_N_OPERATIONS + 1 /* the last: unknown operation */,
	METRICS_BUCKETS = 7,
	METRICS_STATUSES = 600
};

struct metrics {
	atomic_ulong answers[METRICS_OPERATIONS][METRICS_STATUSES];
	atomic_ulong buckets[METRICS_BUCKETS + 1]; /* answers by duration; the last: above all bounds */
	atomic_ulong microseconds;                 /* duration of all answers together */
};

/* an answer was given; `operation` is a row of api_operations or -1 */
void metrics_answered(struct metrics *metrics, int operation, int status, double seconds);

/* The counters in Prometheus text format 0.0.4 (heap, NULL: out of memory). */
struct server;
char *metrics_text(const struct server *server, size_t *length);

#endif
