/* convergence.h - trials of other solvers against the exact one: settings, values kept of a run, and errors. */
#ifndef CONVERGENCE_H
#define CONVERGENCE_H

#include "engine/pound.h"

enum { POUND_HISTORY = 32 }; /* most times at which displacements are compared */

/* Values kept of one signal of one trial; contains only doubles.  NAN: the run failed, or the scene has no such value. */
struct pound_trial_run {
	// largest values of the left body; in a row: of the top and of the stories of the left building, and of all contacts
	double displacement, demand, impulse;
	double cpu;                    /* CPU time of the run [s] */
	double history[POUND_HISTORY]; /* displacement of the left body, or of the left building's top [m] */
};

int pound_convergence_times(const struct pound_study *study, int samples[static POUND_HISTORY]);
void pound_convergence_reduce(const struct pound_study *study, const struct pound_trial_run *runs,
                              struct pound_trial *trials);

#endif
