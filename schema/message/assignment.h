/* assignment.h - the state of the blocks of a run: free, taken by a taker, or done.
 *
 * Threads of this process are taker 0, worker groups are takers 1, 2, ...  The caller holds a lock. */
#ifndef ASSIGNMENT_H
#define ASSIGNMENT_H

#include <stdbool.h>

enum { ASSIGNMENT_HERE = 0 };

struct assignment_block {
	signed char state; /* free, taken, done */
	bool here;         /* a thread of this process runs it */
	short copies;      /* number of takers that run it */
	int taker;         /* last taker */
	double since;      /* time of that [s] */
};

struct assignment {
	int n, next;                     /* no block below `next` is free */
	int n_timed;                     /* number of timed blocks, ... */
	double sum;                      /* ... and their total time from taken to done [s] */
	struct assignment_block *blocks; /* (n) */
};

bool assignment_init(struct assignment *assignment, int n); /* false: out of memory */
void assignment_free(struct assignment *assignment);
/* The next of the first n_blocks for a taker, -1: none.  If no block is free, a block that another group has had for very long. */
int assignment_next(struct assignment *assignment, int n_blocks, int taker, double now);
void assignment_take(struct assignment *assignment, int block, int taker, double now); /* marks it as taken */
void assignment_back(struct assignment *assignment, int block, int taker);
/* false: discard the values, as the block is done already or a thread of this process is running it */
bool assignment_done(struct assignment *assignment, int block, int taker, double now);
void assignment_restore(struct assignment *assignment, int block); /* marks it as done, from stored values */
bool assignment_is_done(const struct assignment *assignment, int block);

#endif
