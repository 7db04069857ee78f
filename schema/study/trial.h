/* trial.h - runs a study for a limited time, in the caller's thread, to measure its CPU time.  Any thread. */
#ifndef TRIAL_H
#define TRIAL_H

#include "engine/pound.h"

struct trial {
	double cpu_s;  /* used [s] */
	bool complete; /* the study ran to its end */
};

/* whole: with reductions; the trial ends after cpu_most [s] of CPU time, or when `unwanted` (may be NULL) is set */
struct trial trial_run(const struct pound_study *study, bool whole, double cpu_most,
                       const atomic_bool *unwanted);

#endif
