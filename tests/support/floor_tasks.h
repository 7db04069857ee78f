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

#endif
