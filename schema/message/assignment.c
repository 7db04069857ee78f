/* assignment.c - assigns free blocks in ascending order of their numbers, so blocks that were given back come first. */
#include "schema/message/assignment.h"

#include <assert.h>
#include <stdlib.h>

enum { FREE, TAKEN, DONE };

/* a block is assigned a second time if it has been taken for longer than both */
static const double LATE_MEANS = 10; /* mean times of a block */
static const double LATE_LEAST = 5;  /* [s] */

bool assignment_init(struct assignment *a, int n)
{
	*a = (struct assignment){.n = n, .blocks = calloc((size_t)n + 1, sizeof *a->blocks)};
	return a->blocks;
}

void assignment_free(struct assignment *a)
{
	free(a->blocks);
}

static bool is_late(const struct assignment *a, const struct assignment_block *block, int taker, double now)
{
	const double mean = a->n_timed ? a->sum / a->n_timed : 0, out = now - block->since;
	return block->state == TAKEN && !block->here && block->copies == 1 && block->taker != taker &&
	       out > LATE_LEAST && out > LATE_MEANS * mean;
}

/* Finds the next block for a taker.
 *
 * Given    n_blocks   number of blocks that may run now
 *          taker      ASSIGNMENT_HERE, or the number of a group
 *          now        s   monotonic
 * Test     unit_assignment: a_block_that_is_out_for_long_runs_elsewhere_and_counts_once
 */
int assignment_next(struct assignment *a, int n_blocks, int taker, double now)
{
	int block = a->next;
	while (block < n_blocks && a->blocks[block].state != FREE)
		block++;
	a->next = block;
	if (block == n_blocks)
		for (block = 0; block < n_blocks && !is_late(a, &a->blocks[block], taker, now);)
			block++;
	return block < n_blocks ? block : -1;
}

void assignment_take(struct assignment *a, int block, int taker, double now)
{
	struct assignment_block *b = &a->blocks[block];
	b->state = TAKEN;
	b->here = taker == ASSIGNMENT_HERE;
	b->copies++;
	b->taker = taker;
	b->since = now;
}

/* Gives back a block that was not run. */
void assignment_back(struct assignment *a, int block, int taker)
{
	struct assignment_block *b = &a->blocks[block];
	assert(b->copies > 0);
	b->copies--;
	b->here = b->here && taker != ASSIGNMENT_HERE;
	if (b->state != TAKEN || b->copies > 0)
		return;
	b->state = FREE;
	a->next = block < a->next ? block : a->next;
}

bool assignment_done(struct assignment *a, int block, int taker, double now)
{
	struct assignment_block *b = &a->blocks[block];
	assert(b->copies > 0);
	b->copies--;
	if (b->state == DONE || (b->here && taker != ASSIGNMENT_HERE))
		return false;
	b->state = DONE;
	b->here = false;
	a->sum += now - b->since;
	a->n_timed++;
	return true;
}

void assignment_restore(struct assignment *a, int block)
{
	a->blocks[block].state = DONE;
}

bool assignment_is_done(const struct assignment *a, int block)
{
	return a->blocks[block].state == DONE;
}
