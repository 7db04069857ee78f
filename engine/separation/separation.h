/* separation.h - how wide a gap must be: statistics of the needed gap, from runs without contact. */
#ifndef SEPARATION_H
#define SEPARATION_H

#include "engine/pound.h"

/* The gap that each run needs.  Clusters are independent of each other; the runs of one cluster may be dependent, because they
 * share a ground motion or a structure. */
struct pound_needed {
	int n_clusters, size; /* size: runs of each cluster */
	const double *gap;    /* [m], NAN: the run has no result  (n_clusters x size) */
	const double *
	    sorted; /* by pound_needed_sort, for clusters of one run; NULL: each count reads all gaps  (n_sorted) */
	int64_t n_sorted;
};

/* Runs that pound: their needed gap is larger than the gap. */
struct pound_needed_count {
	int64_t pounding, runs, clusters; /* runs with a result; clusters with at least one such run */
};

struct pound_needed_count pound_needed_count(const struct pound_needed *needed, double gap);
struct pound_estimate pound_needed_probability(const struct pound_needed *needed, double gap);
int64_t pound_needed_sort(const struct pound_needed *needed, double *sorted);
struct pound_estimate pound_needed_gap(const struct pound_needed *needed, const double *sorted, int64_t n,
                                       double probability);

double pound_rule_correlation(const double frequency[POUND_OSCILLATORS],
                              const double damping[POUND_OSCILLATORS]);
double pound_rule_gap(int rule, const double displacement[POUND_OSCILLATORS], double correlation);

/* The needed gaps at ascending intensities (stripes); cluster c has the same ground motions or structure at all of them. */
struct pound_stripes {
	int n;
	const double *intensity;           /* > 0, ascending  (n) */
	const struct pound_needed *needed; /* with the same n_clusters and size at each intensity  (n) */
};

struct pound_fragility pound_fragility_fit(const struct pound_stripes *stripes, double gap);

/* The mean annual rate at which an intensity is exceeded: linear in logarithms between points. */
struct pound_hazard {
	int n;
	const double *intensity, *rate; /* > 0, ascending; > 0, descending [1/a]  (n) */
};

/* The weight of each stripe's probability in the annual rate [1/a]; returns the rate of exceeding the last stripe [1/a]. */
double pound_hazard_weights(const struct pound_hazard *hazard, const struct pound_stripes *stripes,
                            double *weights);
struct pound_estimate pound_hazard_rate(const struct pound_stripes *stripes, const double *weights,
                                        double beyond, double gap);
struct pound_estimate pound_hazard_gap(const struct pound_stripes *stripes, const double *weights,
                                       double beyond, double rate, double *scratch);

#endif
