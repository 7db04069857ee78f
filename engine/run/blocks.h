/* blocks.h - memory layout of the values of a study's runs.
 *
 * The sequence of items is cut into blocks.  A block holds the measures of its items' runs, by item, cell and sample, then
 * the measures of its checks in the same order, then counts of its work. */
#ifndef BLOCKS_H
#define BLOCKS_H

#include "engine/run/request.h"

struct pound_blocks {
	const struct pound_cells *campaign;
	int n_measures; /* doubles kept per run */
	int n_counts;   /* at the end of a block */
	int n_blocks;
	int *first;     /* items: block b is first[b] .. first[b + 1] - 1  (n_blocks + 1) */
	double *values; /* of all blocks  (pound_blocks_doubles) */
};

int pound_blocks_items(const struct pound_cells *campaign);
/* Returns the number of blocks; first NULL: only counts the blocks and finds the largest size. */
int pound_blocks_cut(const struct pound_cells *campaign, int *first, struct pound_request_size *largest);
/* The same if every item has the given size. */
int pound_blocks_alike(const struct pound_cells *campaign, struct pound_request_size item,
                       struct pound_request_size *largest);
size_t pound_blocks_doubles(const struct pound_blocks *layout);

int pound_blocks_block_of(const struct pound_blocks *layout, int item);
int64_t pound_blocks_block_runs(const struct pound_blocks *layout, int block);
size_t pound_blocks_block_doubles(const struct pound_blocks *layout, int block);
double *pound_blocks_block(const struct pound_blocks *layout, int block);
const double *pound_blocks_counts(const struct pound_blocks *layout, int block);

/* The measures of one run, and of the run that checks it. */
double *pound_blocks_run(const struct pound_blocks *layout, int item, int cell, int sample);
const double *pound_blocks_check(const struct pound_blocks *layout, int item, int cell, int sample);

#endif
