/* floor_tasks.h - tasks of specimens, for tests of what follows one floor. */
#ifndef FLOOR_TASKS_H
#define FLOOR_TASKS_H

#include "engine/floor/floor.h"
#include "tests/support/scenes.h"

/* The task of a specimen's scene, with the yield displacements that the engine finds; contact false: without it. */
struct pound_task floor_task_task(const struct specimen *specimen, bool contact);

/* Spectra of a task, as many drives as asked; fails the test when the motion cannot be followed. */
struct pound_floor_answer floor_task_spectra(const struct pound_task *task,
                                             const struct pound_spectrum *spectrum, int n_drives,
                                             double radians, int lanes, double *psa[POUND_DRIVES]);

/* a row of a history, of one floor */
struct floor_line {
	double time, v, acceleration; /* [s], relative to the ground [m/s], absolute [m/s2] */
};

/* Largest w^2 |z| of an oscillator on a floor whose acceleration is straight between n rows and whose velocity may jump where
 * two rows have one time. */
double floor_task_lines(int n, const struct floor_line *rows, double w, double damping_ratio);

#endif
