/* latency.h - times of requests and their answers, and quantiles of the latency. */
#ifndef LATENCY_H
#define LATENCY_H

struct latencies {
	struct latency_answer {
		double asked, came; /* [s] of the wall clock */
	} * answers;            /* (n) for free */
	int n, room;
};

double latency_now(void); /* [s] of the wall clock */
void latency_add(struct latencies *l, double asked, double came);
double latency_quantile(struct latencies *l, double part);  /* quantile of the latency [ms]; 0: no answers */
void latency_report(const char *what, struct latencies *l); /* prints their number, p50, p99 and maximum */

/* Removes the answers that came during host pauses (tests/support/host_pauses.h), after host_pauses_stop. */
void latency_there(struct latencies *l);

/* How long each test of make soak is to last: SOAK, 60 when it is not set [s]. */
double latency_soak_s(void);

#endif
