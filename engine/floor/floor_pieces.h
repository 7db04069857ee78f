/* floor_pieces.h - the motion of the left floor under one task, as a sequence of exact pieces.
 *
 * The exact solver reports where one interval of a motion ends and the next begins (task.h); in a piece, which is an interval
 * or a segment of one, the floor's acceleration is a polynomial to rounding.  Only requests for whole histories pay for them. */
#ifndef FLOOR_PIECES_H
#define FLOOR_PIECES_H

#include "engine/exact/chain.h"
#include "engine/exact/task.h"

enum {
	POUND_FLOOR_ORDER = 21,   /* largest order of a piece's power series */
	POUND_FLOOR_ROOM = 24,    /* space for its coefficients, whole vectors */
	POUND_FLOOR_TERMS = 23,   /* of the series of an oscillator on it: 1.5^23/23! is below rounding */
	POUND_FLOOR_PIECES = 512, /* passed to the taker at once */
	POUND_FLOOR_MAPS = 4,     /* different stiffnesses of free motion in these pieces */
};

/* what drives an oscillator: the floor's absolute acceleration, or the contact's part of it */
enum pound_drive { POUND_DRIVE_FLOOR, POUND_DRIVE_PUSH, POUND_DRIVES };

/* Coefficients of powers of time/step, and bounds of |a|, |a'|, |a''|, derivatives by time/step  [m/s2].  The last coefficients are
 * below 1e-6 of the bound, or roundings of the velocity: an oscillator's response to them is rounding after POUND_FLOOR_TERMS. */
struct pound_polynomial {
	double bound[3];
	double c[POUND_FLOOR_ROOM]; /* (order + 1) */
};

struct pound_floor_piece {
	double start, step; /* [s] */
	double u, v;        /* of the left body at the start [m], [m/s]; of a floor of a chain not set */
	double jump;        /* of v at the start, by a rigid impact [m/s] */
	int map;            /* free motion over a whole sample: index of its stiffness; -1: any other piece */
	// in free motion: spring force, velocity, forcing and its growth  [m/s2], [m/s], [m/s2], [m/s2]
	double state[4];
	int order;                 /* of floor and push; not set in free motion */
	bool sampled, after_event; /* begins at a sample, at an event */
	// in free motion only bounds and the first two coefficients of floor are set, and bounds 0 of push; pound_floor_drive() has all
	struct pound_polynomial floor, push;
};

struct pound_floor_stretch {
	int n, n_maps;
	int order;                          /* of the series of free motion */
	double stiffness[POUND_FLOOR_MAPS]; /* per mass [1/s2]  (n_maps) */
	double bound[POUND_FLOOR_MAPS][3]
	            [4]; /* of |a|, |a'|, |a''| in free motion, per unit of each state[]  (n_maps) */
	struct pound_floor_piece piece[POUND_FLOOR_PIECES];
};

/* callback that receives the pieces */
struct pound_floor_taker {
	void (*take)(void *into);
	void *into;
};

/* What a history needs of a chain besides the pieces of its floor: about the current piece, and about the start of the chain's
 * piece. */
struct pound_floor_beside {
	struct pound_polynomial right; /* absolute acceleration of the other floor [m/s2] */
	int order;
	double ground, slope;                                    /* at the start of the piece [m/s2], [m/s3] */
	double u[POUND_CHAIN_OBSERVED], v[POUND_CHAIN_OBSERVED]; /* [m], [m/s] */
	double overlap, overlap_rate;                            /* [m], [m/s] */
	bool touching;
};

/* state of the observer of a motion */
struct pound_floor_motion {
	const struct pound_task *task;
	struct pound_floor_stretch *stretch; /* pieces not yet passed to the taker */
	struct pound_floor_taker taker;      /* called when the stretch is full; empties it */
	const atomic_bool *stop;             /* once set, no more pieces are made; NULL: none */
	enum pound_status status;            /* POUND_CHATTER: a piece could not be made, nor any after it */
	double rate, rate_touch;             /* fastest rate of the bodies, and in contact [rad/s] */
	int order;                           /* of the series of free motion over a sample */
	struct pound_instant_of_task from;   /* where the next piece begins */
	bool sampled, after_event;           /* of the next piece */
	double jump;                         /* likewise */
	bool pushed;                         /* the contact's part is needed; false: its bounds are 0 */
	struct pound_floor_beside *beside;   /* of a chain; if not NULL, the taker is called after every piece */
};

/* Coefficients of free motion's acceleration from its state. */
void pound_floor_free_motion(const double state[4], double k, double c, double h, int order, double *a);
/* Coefficients of a drive over any piece, and their order. */
int pound_floor_drive(const struct pound_floor_stretch *stretch, const struct pound_floor_piece *piece,
                      enum pound_drive drive, double damping, double room[POUND_FLOOR_ROOM],
                      const double **c);

/* Terms after which x^n/n! is below rounding, n <= POUND_FLOOR_TERMS. */
int pound_floor_terms(double x);

/* Bounds of an acceleration whose coefficients are set; returns its order without last terms below rounding of the others. */
int pound_floor_bound(struct pound_polynomial *a, int order);
/* Adds a piece; the caller fills its acceleration and push. */
struct pound_floor_piece *pound_floor_piece_add(struct pound_floor_motion *motion, double start, double step);

/* Initializes a motion whose task, stretch, taker and stop are set. */
void pound_floor_start(struct pound_floor_motion *motion);
/* Makes the pieces up to an instant; an observer of the exact solver. */
void pound_floor_observe(void *motion, const struct pound_instant_of_task *instant);

/* The same for a floor of a chain, the first floor of its observer: chain_pieces.c. */
void pound_floor_start_chain(struct pound_floor_motion *motion);
void pound_floor_observe_chain(void *motion, const struct pound_chain_piece *piece);

#endif
