/* trial.h - studies run for a while, in the thread of the caller, to see what they take.  Any thread. */
#ifndef TRIAL_H
#define TRIAL_H

#include "engine/pound.h"

struct trial {
	double cpu_s;  /* taken [s] */
	bool complete; /* it ran to its end */
};

/* whole: with its reductions; ends after cpu_most [s], or once `unwanted` is set; NULL: nothing sets it */
struct trial trial_run(const struct pound_study *study, bool whole, double cpu_most,
                       const atomic_bool *unwanted);

#endif
