/* floor_pieces.h - the motion of the left floor under one task, as exact pieces one after the other.
 *
 * The exact solver reports where one interval of a motion ends and the next begins (task.h); in a piece, which is one of these
 * or a part of one, the floor's acceleration is a polynomial to rounding.  Only what needs whole histories pays for them. */
#ifndef FLOOR_PIECES_H
#define FLOOR_PIECES_H

#include "engine/exact/chain.h"
#include "engine/exact/task.h"

enum {
	POUND_FLOOR_ORDER = 21,   /* of a piece's power series, at most */
	POUND_FLOOR_ROOM = 24,    /* for its coefficients, whole vectors */
	POUND_FLOOR_TERMS = 23,   /* of any motion it drives: 1.5^23/23! is below rounding */
	POUND_FLOOR_PIECES = 512, /* given to the observer at once */
	POUND_FLOOR_MAPS = 4,     /* different stiffnesses of free motion among them */
};

/* what drives an oscillator: the floor's absolute acceleration, or the part of it that the contact gives */
enum pound_drive { POUND_DRIVE_FLOOR, POUND_DRIVE_PUSH, POUND_DRIVES };

/* Coefficients of powers of time over the piece's step, and bounds of |a|, |a'|, |a''| in that time  [m/s2].  The last are below
 * 1e-6 of the bound, or roundings of the velocity: what they do to an oscillator ends in rounding within POUND_FLOOR_TERMS. */
struct pound_polynomial {
	double bound[3];
	double c[POUND_FLOOR_ROOM]; /* (order + 1) */
};

struct pound_floor_piece {
	double start, step; /* [s] */
	double u, v;        /* of the left body at the start [m], [m/s]; of a floor of a chain not set */
	double jump;        /* that v has just made: a rigid impact [m/s] */
	int map;            /* free motion over a whole sample: number of its stiffness; -1: any other piece */
	// of free motion: spring force, velocity, forcing and what that grows by  [m/s2], [m/s], [m/s2], [m/s2]
	double state[4];
	int order;                 /* of floor and push; not of free motion */
	bool sampled, after_event; /* begins at a sample, at an event */
	// of free motion only the bounds and the first two coefficients are set, of its push bounds of 0; pound_floor_drive() has all
	struct pound_polynomial floor, push;
};

struct pound_floor_stretch {
	int n, n_maps;
	int order;                          /* of the series of free motion */
	double stiffness[POUND_FLOOR_MAPS]; /* per mass [1/s2]  (n_maps) */
	double bound[POUND_FLOOR_MAPS][3]
	            [4]; /* of |a|, |a'|, |a''| of free motion, by the magnitudes of its state  (n_maps) */
	struct pound_floor_piece piece[POUND_FLOOR_PIECES];
};

/* who takes the pieces */
struct pound_floor_taker {
	void (*take)(void *into);
	void *into;
};

/* What a history takes of a chain beside the pieces of its floor: of the piece in hand, and of where that of the chain began. */
struct pound_floor_beside {
	struct pound_polynomial right; /* absolute acceleration of the other floor [m/s2] */
	int order;
	double ground, slope;                                    /* at the start of the piece [m/s2], [m/s3] */
	double u[POUND_CHAIN_OBSERVED], v[POUND_CHAIN_OBSERVED]; /* [m], [m/s] */
	double overlap, overlap_rate;                            /* [m], [m/s] */
	bool touching;
};

/* a motion, as far as it was reported */
struct pound_floor_motion {
	const struct pound_task *task;
	struct pound_floor_stretch *stretch; /* of the pieces that were not taken yet */
	struct pound_floor_taker taker;      /* called when it is full; it is empty afterwards */
	const atomic_bool *stop;             /* when it is set no more pieces are made; NULL: never */
	enum pound_status status;          /* POUND_CHATTER: a piece could not be made, and none behind it was */
	double rate, rate_touch;           /* fastest of the bodies, of both in contact [rad/s] */
	int order;                         /* of the series of free motion over a sample */
	struct pound_instant_of_task from; /* where the next piece begins */
	bool sampled, after_event;         /* as struct pound_floor_piece has them */
	double jump;                       /* likewise */
	bool pushed;                       /* the contact's part is wanted; false: its bounds are 0 */
	struct pound_floor_beside *beside; /* of a chain: not NULL, every piece is taken at once */
};

/* Coefficients of free motion's acceleration from its state. */
void pound_floor_free_motion(const double state[4], double k, double c, double h, int order, double *a);
/* Coefficients of a drive over any piece, and their order. */
int pound_floor_drive(const struct pound_floor_stretch *stretch, const struct pound_floor_piece *piece,
                      enum pound_drive drive, double damping, double room[POUND_FLOOR_ROOM],
                      const double **c);

/* Terms after which x^n/n! is below rounding, n <= POUND_FLOOR_TERMS. */
int pound_floor_terms(double x);

/* Bounds of an acceleration whose coefficients are set; returns its order without the terms that are rounding beside the others. */
int pound_floor_bound(struct pound_polynomial *a, int order);
/* One more piece, of which acceleration and push are to be filled. */
struct pound_floor_piece *pound_floor_piece_add(struct pound_floor_motion *motion, double start, double step);

/* A motion that no instant was reported of yet; task, stretch, taker and stop are set. */
void pound_floor_start(struct pound_floor_motion *motion);
/* Makes the pieces up to an instant; an observer of the exact solver. */
void pound_floor_observe(void *motion, const struct pound_instant_of_task *instant);

/* The same of a floor of a chain, the first that its observer has: chain_pieces.c. */
void pound_floor_start_chain(struct pound_floor_motion *motion);
void pound_floor_observe_chain(void *motion, const struct pound_chain_piece *piece);

#endif
