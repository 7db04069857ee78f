/* trace.h - the motion of the left floor under one task, as exact pieces one after the other.
 *
 * A piece ends at a sample of the ground motion, at an event, or where its power series no longer reaches; in it the
 * floor's acceleration is a polynomial to rounding.  Only what needs whole histories pays for them: the march keeps
 * none. */
#ifndef TRACE_H
#define TRACE_H

#include "engine/march.h"

enum {
	POUND_TRACE_ORDER = 21,   /* of a piece's power series, at most */
	POUND_TRACE_TERMS = 23,   /* of any motion it drives: 1.5^23/23! is below rounding */
	POUND_TRACE_PIECES = 512, /* handed out at once */
	POUND_TRACE_MAPS = 4,     /* stiffnesses told apart among them */
};

/* Coefficients of powers of time over the piece's step, and bounds of |a|, |a'|, |a''| in that time  [m/s2] */
struct pound_polynomial {
	double bound[3];
	double c[POUND_TRACE_ORDER + 1]; /* (order + 1) */
};

struct pound_trace_piece {
	double start, step; /* [s] */
	double u, v;        /* of the left body at the start [m], [m/s] */
	int map;            /* a whole sample of free flight: number of its stiffness; -1: any other piece */
	double state[4];    /* of a flight: spring force [m/s2], v, ground acceleration, what it grows by */
	int order;
	bool sampled, turned; /* begins at a sample, at an event */
	// absolute acceleration, and the part of it the contact gives; of a flight without coefficients: pound_trace_floor()
	struct pound_polynomial floor, push;
};

struct pound_trace_stretch {
	int n, n_maps;
	int order;                          /* of the series of flights */
	double stiffness[POUND_TRACE_MAPS]; /* per mass [1/s2]  (n_maps) */
	struct pound_trace_piece piece[POUND_TRACE_PIECES];
};

/* a body on a piece of its law over a whole sample, by what it has at the start */
struct pound_trace_glide {
	double stiffness; /* < 0: none */
	// u and v at the end, and the error of the cubic, by u, v, the forcing and what that grows by
	double move[2][4], error[4];
	double bound[3][4]; /* of the floor's acceleration and its derivatives, by a flight's state */
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
	struct pound_trace_glide glide[POUND_OSCILLATORS][POUND_TRACE_MAPS];
	int glide_next[POUND_OSCILLATORS];
	int order_sample; /* of a series over a sample interval */
	double ground, slope, left;
	double pace; /* share of the usual step: shorter where a search was unsure */
	int next, events;
	double impulse, impulse_max, contact_time; /* F/m1 integrated [m/s]; [s] */
	int64_t contacts;
};

/* Coefficients of the floor's acceleration over a flight of one sample h, from its state.
 *
 * Given    k, c  stiffness [1/s2] and damping [1/s] per mass
 * Returns  a     (order + 1)
 */
void pound_trace_flight(const double state[4], double k, double c, double h, int order, double *a);
/* Coefficients of the floor's acceleration over any piece, (order + 1): its own or, of a flight, those made into `room`.
 *
 * Given    damping  of the left body, per mass [1/s]
 */
const double *pound_trace_floor(const struct pound_trace_stretch *stretch,
                                const struct pound_trace_piece *piece, double damping,
                                double room[POUND_TRACE_ORDER + 1]);

/* Terms after which x^n/n! is below rounding, n <= POUND_TRACE_TERMS. */
int pound_trace_terms(double x);

void pound_trace_start(struct pound_trace *trace, const struct pound_march_task *task);
/* The next pieces; none after the last.  trace->status tells whether the motion was followed to its end. */
void pound_trace_next(struct pound_trace *trace, struct pound_trace_stretch *stretch);

#endif
