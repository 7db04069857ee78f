/* pair_peaks.h - peaks of the relative displacement of two bodies, for outputs that read them.
 *
 * An observer of the exact solver (task.h): between two instants the motion follows one linear system. */
#ifndef PAIR_PEAKS_H
#define PAIR_PEAKS_H

#include "engine/exact/task.h"

enum { POUND_PAIR_NOTES = 8 };

/* An interval that may contain a larger displacement than the largest so far. */
struct pound_pair_note {
	struct pound_instant_of_task from;
	double length;  /* [s] */
	double most[2]; /* upper bounds of closing and opening displacement inside [m] */
};

struct pound_pair_peaks {
	struct pound_task_observer observer;
	struct pound_task_body bodies[POUND_OSCILLATORS];
	double error[POUND_OSCILLATORS][3]; /* bound of the cubic's interpolation error: pair_peaks.c */
	double rate;                        /* of the faster body [rad/s] */
	struct pound_instant_of_task from;  /* the last instant */
	int samples_left;                   /* remaining samples of the ground motion */
	int n_notes;
	struct pound_pair_note notes[POUND_PAIR_NOTES];
	// so far
	double peak[2]; /* largest u_1 - u_2 and u_2 - u_1 outside of contacts, 0 at rest [m] */
};

/* Begins to observe a task: sets the task's observer. */
void pound_pair_peaks_start(struct pound_pair_peaks *peaks, struct pound_task *task);

/* Transition coefficients of both bodies of a pair over one sample interval. */
enum { POUND_PAIR_COLUMNS = 4 };
struct pound_pair_maps {
	double u[POUND_OSCILLATORS][POUND_PAIR_COLUMNS], v[POUND_OSCILLATORS][POUND_PAIR_COLUMNS],
	    error[POUND_OSCILLATORS][POUND_PAIR_COLUMNS];
};

/* Pairs of linear bodies followed in SIMD lanes, as they differ only in their ground motions. */
enum { POUND_PAIRS = 8 };
struct pound_pairs {
	int n; /* pairs collected */
	struct pound_pair_maps maps;
	struct pound_task tasks[POUND_PAIRS];
	double *peak[POUND_PAIRS]; /* closing and opening displacement  (2 each) */
};

bool pound_pairs_add(struct pound_pairs *pairs, const struct pound_task *task, double peak[2]);
void pound_pairs_finish(struct pound_pairs *pairs);

/* pair_peaks.inl: from sample to sample; intervals that need a search are noted for later  (n of both) */
void pound_pairs_w8(const struct pound_pairs *pairs, struct pound_pair_peaks *peaks);
void pound_pairs_w4(const struct pound_pairs *pairs, struct pound_pair_peaks *peaks);
void pound_pairs_w1(const struct pound_pairs *pairs, struct pound_pair_peaks *peaks);
void pound_pairs_portable(const struct pound_pairs *pairs, struct pound_pair_peaks *peaks);

void pound_pair_sample(struct pound_pair_peaks *peaks, const struct pound_task *task, int s,
                       struct pound_pair_note *note, const double peak[2]);

#endif
