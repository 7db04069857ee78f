/* latency.h - when questions were asked and answered, and what a part of the answers took at most. */
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
double latency_quantile(struct latencies *l,
                        double part); /* what a part of them is below [ms]; 0: there are none */
void latency_report(const char *what, struct latencies *l); /* prints their number, p50, p99 and maximum */

/* Leaves those out that came while the machine was away (tests/support/host_pauses.h), after host_pauses_stop. */
void latency_there(struct latencies *l);

/* How long each test of make soak is to last: SOAK, 60 when it is not set [s]. */
double latency_soak_s(void);

#endif
