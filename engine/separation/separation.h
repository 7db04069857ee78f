/* separation.h - how wide a gap has to be: statistics of the gap needed, from runs without contact. */
#ifndef SEPARATION_H
#define SEPARATION_H

#include "engine/pound.h"

/* The gap that each run needs.  Clusters are independent of each other; the runs of one cluster need not be: they share a
 * ground motion or a structure. */
struct pound_needed {
	int n_clusters, size; /* runs of each */
	const double *gap;    /* [m], NAN: the run has no result  (n_clusters x size) */
	const double *
	    sorted; /* by pound_needed_sort, for clusters of one run; NULL: each count looks at all  (n_sorted) */
	int64_t n_sorted;
};

/* Runs whose gap needed is larger than a gap: they pound. */
struct pound_needed_count {
	int64_t pounding, runs, clusters; /* clusters that have a run with a result */
};

struct pound_needed_count pound_needed_count(const struct pound_needed *needed, double gap);
struct pound_estimate pound_needed_probability(const struct pound_needed *needed, double gap);
int64_t pound_needed_sort(const struct pound_needed *needed, double *sorted);
struct pound_estimate pound_needed_gap(const struct pound_needed *needed, const double *sorted, int64_t n,
                                       double probability);

double pound_rule_correlation(const double frequency[POUND_OSCILLATORS],
                              const double damping[POUND_OSCILLATORS]);
double pound_rule_gap(int rule, const double displacement[POUND_OSCILLATORS], double correlation);

/* The gaps needed at growing intensities; cluster c is the same at all of them. */
struct pound_stripes {
	int n;
	const double *intensity;           /* > 0, ascending  (n) */
	const struct pound_needed *needed; /* of as many clusters and runs each  (n) */
};

struct pound_fragility pound_fragility_fit(const struct pound_stripes *stripes, double gap);

/* How often a year an intensity is exceeded: straight lines between points in logarithms. */
struct pound_hazard {
	int n;
	const double *intensity, *rate; /* > 0, ascending; > 0, descending [1/a]  (n) */
};

/* What each stripe's probability counts in the annual rate, and what is added for earthquakes beyond all stripes. */
double pound_hazard_weights(const struct pound_hazard *hazard, const struct pound_stripes *stripes,
                            double *weights);
struct pound_estimate pound_hazard_rate(const struct pound_stripes *stripes, const double *weights,
                                        double beyond, double gap);
struct pound_estimate pound_hazard_gap(const struct pound_stripes *stripes, const double *weights,
                                       double beyond, double rate, double *scratch);

#endif
