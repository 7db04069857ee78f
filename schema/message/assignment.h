/* assignment.h - which blocks of a run are taken, by whom, and which are done.
 *
 * Threads of this process are taker 0, groups of workers are 1, 2, ...  Under a lock of the user. */
#ifndef ASSIGNMENT_H
#define ASSIGNMENT_H

#include <stdbool.h>

enum { ASSIGNMENT_HERE = 0 };

struct assignment_block {
	signed char state; /* free, taken, done */
	bool here;         /* a thread of this process has it */
	short copies;      /* takers that have it */
	int taker;         /* that took it last */
	double since;      /* when it did [s] */
};

struct assignment {
	int n, next;                     /* no block below `next` is free */
	int n_timed;                     /* blocks that were done, which took ... */
	double sum;                      /* ... from their taking [s] */
	struct assignment_block *blocks; /* (n) */
};

bool assignment_init(struct assignment *assignment, int n); /* false: out of memory */
void assignment_free(struct assignment *assignment);
/* The next block of the first n_blocks for a taker, -1: none.  When none is free, one that another group has had for very long. */
int assignment_next(struct assignment *assignment, int n_blocks, int taker, double now);
void assignment_take(struct assignment *assignment, int block, int taker, double now); /* the next one */
void assignment_back(struct assignment *assignment, int block, int taker);
/* false: its values are not wanted, as they are there already or a thread of this process makes them now */
bool assignment_done(struct assignment *assignment, int block, int taker, double now);
void assignment_restore(struct assignment *assignment, int block); /* it was done before */
bool assignment_is_done(const struct assignment *assignment, int block);

#endif
