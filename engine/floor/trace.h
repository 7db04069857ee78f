/* trace.h - the motion of the left floor under one task, as exact pieces one after the other.
 *
 * A piece ends at a sample of the ground motion, at an event, or where its power series no longer reaches; in it the
 * floor's acceleration is a polynomial to rounding.  Only what needs whole histories pays for them: the march keeps
 * none. */
#ifndef TRACE_H
#define TRACE_H

#include "engine/exact/counts.h"
#include "engine/exact/task.h"

enum {
	POUND_TRACE_ORDER = 21,   /* of a piece's power series, at most */
	POUND_TRACE_TERMS = 23,   /* of any motion it drives: 1.5^23/23! is below rounding */
	POUND_TRACE_PIECES = 512, /* handed out at once */
	POUND_TRACE_MAPS = 4,     /* stiffnesses of flights told apart among them */
	POUND_TRACE_GLIDES = 4,   /* stiffnesses of a body that maps are kept of */
};

/* what drives an oscillator: the floor's absolute acceleration, or the part of it that the contact gives */
enum pound_drive { POUND_DRIVE_FLOOR, POUND_DRIVE_PUSH, POUND_DRIVES };

/* Coefficients of powers of time over the piece's step, and bounds of |a|, |a'|, |a''| in that time  [m/s2] */
struct pound_polynomial {
	double bound[3];
	double c[POUND_TRACE_ORDER + 1]; /* (order + 1) */
};

struct pound_trace_piece {
	double start, step; /* [s] */
	double u, v;        /* of the left body at the start [m], [m/s] */
	int map;            /* a flight, a whole sample apart: number of its stiffness; -1: any other piece */
	// of a flight: spring force, velocity, forcing and what that grows by  [m/s2], [m/s], [m/s2], [m/s2]
	double state[4];
	int order;            /* of floor and push; not of a flight */
	bool sampled, turned; /* begins at a sample, at an event */
	// of a flight only the bounds are set, those of its push 0; pound_trace_drive() has the coefficients of both
	struct pound_polynomial floor, push;
};

struct pound_trace_stretch {
	int n, n_maps;
	int order;                          /* of the series of flights */
	double stiffness[POUND_TRACE_MAPS]; /* per mass [1/s2]  (n_maps) */
	struct pound_trace_piece piece[POUND_TRACE_PIECES];
};

/* A body of one stiffness over a whole sample.  What makes its motion: displacement and velocity at the start, the forcing
 * there (drive times ground, and offset) and what that grows by  [m], [m/s], [m/s2], [m/s2] */
struct pound_trace_glide {
	double stiffness;  /* per mass [1/s2]; < 0: none */
	double move[2][4]; /* displacement and velocity at the end, by these */
	double error[4];   /* of the cubic through both ends [m], by their magnitudes */
	double bound
	    [3][4]; /* of the left body: of the floor's |a|, |a'|, |a''|, by the magnitudes of a flight's state */
};

struct pound_trace {
	const struct pound_march_task *task;
	enum pound_status status;
	struct pound_branch at[POUND_OSCILLATORS];
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS], p, q; /* p, q: overlap and its rate */
	bool touching, parted;                                   /* parted: overlapping without force */
	bool fresh;                                              /* the contact's force is exactly 0 now */
	bool sampled, turned;    /* the state is that of a sample, that after an event */
	double rate, rate_touch; /* fastest of the motion [rad/s] */
	struct pound_trace_glide glide[POUND_OSCILLATORS][POUND_TRACE_GLIDES];
	int glide_next[POUND_OSCILLATORS];
	int order_sample; /* of a series over a sample interval */
	double ground, slope, left;
	double pace;     /* share of the usual step: shorter where a search was unsure */
	int next, steps; /* the sample in front; since the one behind */
	double impulse, impulse_max, contact_time; /* F/m1 integrated [m/s]; [s] */
	double counted_time;                       /* of contacts that count [s] */
	struct pound_counts_scale counts_scale;
	int64_t contacts, touch_steps; /* that count; of the contact in hand */
};

/* Coefficients of a flight's acceleration from its state. */
void pound_trace_flight(const double state[4], double k, double c, double h, int order, double *a);
/* Coefficients of a drive over any piece, and their order. */
int pound_trace_drive(const struct pound_trace_stretch *stretch, const struct pound_trace_piece *piece,
                      enum pound_drive drive, double damping, double room[POUND_TRACE_ORDER + 1],
                      const double **c);

/* Terms after which x^n/n! is below rounding, n <= POUND_TRACE_TERMS. */
int pound_trace_terms(double x);

void pound_trace_start(struct pound_trace *trace, const struct pound_march_task *task);
/* The next pieces; none after the last.  trace->status tells whether the motion was followed to its end. */
void pound_trace_next(struct pound_trace *trace, struct pound_trace_stretch *stretch);

#endif
