/* pair_peaks.h - peaks of two bodies' motion against each other, for outputs that read them.
 *
 * An observer of the exact solver (task.h): the motion between two instants is one linear system. */
#ifndef PAIR_PEAKS_H
#define PAIR_PEAKS_H

#include "engine/exact/task.h"

enum { POUND_PAIR_NOTES = 8 };

/* An interval that may hold a larger displacement than the largest so far. */
struct pound_pair_note {
	struct pound_instant_of_task from;
	double length;  /* [s] */
	double most[2]; /* closing and opening displacement inside, at most [m] */
};

struct pound_pair_peaks {
	struct pound_task_observer observer;
	struct pound_task_body bodies[POUND_OSCILLATORS];
	double rate;                       /* of the faster body [rad/s] */
	struct pound_instant_of_task from; /* the last instant */
	int samples_left;                  /* of the ground motion */
	int n_notes;
	struct pound_pair_note notes[POUND_PAIR_NOTES];
	// so far
	double peak[2];  /* largest u_1 - u_2 and u_2 - u_1 outside of contacts, 0 at rest [m] */
	double approach; /* largest rate of u_1 - u_2 at the start of a contact [m/s] */
};

/* Begins to observe a task, whose observer it becomes. */
void pound_pair_peaks_start(struct pound_pair_peaks *peaks, struct pound_task *task);

/* Both bodies over a sample. */
enum { POUND_PAIR_COLUMNS = 4 };
struct pound_pair_maps {
	double step, stiffness[POUND_OSCILLATORS], damping[POUND_OSCILLATORS], drive[POUND_OSCILLATORS];
	double u[POUND_PAIR_COLUMNS][POUND_OSCILLATORS], v[POUND_PAIR_COLUMNS][POUND_OSCILLATORS],
	    error[POUND_PAIR_COLUMNS][POUND_OSCILLATORS];
};

bool pound_pair_peaks_linear(struct pound_pair_maps *maps, const struct pound_task *task, double peak[2]);

#endif
