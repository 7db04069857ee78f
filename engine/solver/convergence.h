/* convergence.h - solvers beside the exact one: which are tried, what is kept of a run, and their errors. */
#ifndef CONVERGENCE_H
#define CONVERGENCE_H

#include "engine/pound.h"

enum { POUND_HISTORY = 32 }; /* times at which displacements are compared, at most */

/* What is kept of one signal of one trial: doubles and nothing else; NAN: failed, or the scene has none. */
struct pound_trial_run {
	// of the left body; of a row of the top of the left building, of its storeys, and of all contacts
	double displacement, demand, impulse; /* the largest */
	double cpu;                           /* of a run [s] */
	double history[POUND_HISTORY]; /* displacement of the left body, or of the left building's top [m] */
};

int pound_convergence_times(const struct pound_study *study, int samples[static POUND_HISTORY]);
void pound_convergence_reduce(const struct pound_study *study, const struct pound_trial_run *runs,
                              struct pound_trial *trials);

#endif
