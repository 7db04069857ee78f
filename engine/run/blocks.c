/* blocks.c - cuts a study's items into blocks, and locates the values of a run in them. */
#include "engine/run/blocks.h"

#include <math.h>

#include "engine/design/design.h"

enum {
	BLOCK_RUNS = 768,  /* approximate pounding runs of a block: enough to fill all lanes, but soon done */
	BLOCK_FLOORS = 96, /* the same with floor oscillators, which take longer */
	BLOCK_SPECTRA = 8, /* the same with whole spectra, which take longer still */
	BLOCK_SHORT = 4,   /* floors of a row above which its runs take longer */
	BLOCK_SAMPLES = 1 << 21, /* of a block's ground motions at most, unless one item has more: 16 MiB */
};

/* Items of all rows. */
int pound_blocks_items(const struct pound_cells *campaign)
{
	return campaign->n_rows * campaign->n_signals;
}

static size_t larger(size_t a, size_t b)
{
	return a > b ? a : b;
}

static int block_runs(const struct pound_study *study)
{
	if (study->scene.n_buildings)
		return 1 + BLOCK_RUNS * BLOCK_SHORT / (BLOCK_SHORT + pound_row_floors(&study->scene));
	if (study->spectrum.n == 0)
		return BLOCK_RUNS;
	return study->kind == POUND_KIND_FLOOR_SPECTRUM ? BLOCK_SPECTRA : BLOCK_FLOORS;
}

// sums over the samples of a block; storeys, contacts and memory are maxima, as they hold one scene
static void row_size_add(struct pound_row_size *block, const struct pound_row_size *item, int times)
{
	block->tasks += times * item->tasks;
	block->floors += times * item->floors;
	block->links += times * item->links;
	block->yields += times * item->yields;
	block->modal += times * item->modal;
	block->memory = larger(block->memory, item->memory);
	block->scratch = larger(block->scratch, item->scratch);
	block->storeys = (int)larger((size_t)block->storeys, (size_t)item->storeys);
	block->contacts = (int)larger((size_t)block->contacts, (size_t)item->contacts);
}

static void row_size_max(struct pound_row_size *largest, const struct pound_row_size *block)
{
	largest->tasks = (int)larger((size_t)largest->tasks, (size_t)block->tasks);
	largest->floors = (int)larger((size_t)largest->floors, (size_t)block->floors);
	largest->links = (int)larger((size_t)largest->links, (size_t)block->links);
	largest->yields = (int)larger((size_t)largest->yields, (size_t)block->yields);
	largest->modal = (int)larger((size_t)largest->modal, (size_t)block->modal);
	largest->memory = larger(largest->memory, block->memory);
	largest->scratch = larger(largest->scratch, block->scratch);
	largest->storeys = (int)larger((size_t)largest->storeys, (size_t)block->storeys);
	largest->contacts = (int)larger((size_t)largest->contacts, (size_t)block->contacts);
}

static void size_add(struct pound_request_size *block, struct pound_request_size item, bool checked)
{
	int times = checked ? 2 : 1;
	block->asks += times * item.asks;
	block->motions += times * item.motions;
	block->tasks += times * item.tasks;
	block->peaks += times * item.peaks;
	block->samples += (checked ? 3 : 1) * item.samples;
	row_size_add(&block->rows, &item.rows, times);
}

/* Cuts the items into blocks.
 *
 * Given    campaign    -              a study run elsewhere is one block
 * Returns  value       -              number of blocks
 *          first       (blocks + 1)   the first item of each, and the end; NULL: not requested
 *          largest     -              raised to the largest block
 *
 * A block ends when it is full, at each look of a growing design, and with a trial, because it has one solver.
 *
 * Test     unit_growth: a_block_ends_where_the_design_is_looked_at
 */
int pound_blocks_cut(const struct pound_cells *campaign, int *first, struct pound_request_size *largest)
{
	const struct pound_cells *c = campaign;
	const bool sampled = pound_study_sampled(c->study);
	struct pound_request_size block = {0}, item = {0};
	int n_blocks = c->study->elsewhere, n_items = pound_blocks_items(c), look = 0;
	int look_end = sampled ? pound_design_rows(c->study, 0) : c->n_rows;
	for (int i = 0; i < n_items && !c->study->elsewhere; i++) {
		if (i % c->n_signals == 0)
			item = pound_request_size(c, i / c->n_signals);
		bool full =
		    block.asks + item.asks > block_runs(c->study) || block.samples + item.samples > BLOCK_SAMPLES;
		bool solved = c->trials && i % c->n_signals == 0;
		bool looked = i == look_end * c->n_signals;
		if (looked)
			look_end = pound_design_rows(c->study, ++look);
		if (i == 0 || full || solved || looked) {
			if (first)
				first[n_blocks] = i;
			n_blocks++;
			block = (struct pound_request_size){0};
		}
		size_add(&block, item, pound_cells_checks(c, i) < pound_cells_checks(c, i + 1));
		largest->asks = block.asks > largest->asks ? block.asks : largest->asks;
		largest->motions = block.motions > largest->motions ? block.motions : largest->motions;
		largest->peaks = block.peaks > largest->peaks ? block.peaks : largest->peaks;
		largest->tasks = block.tasks > largest->tasks ? block.tasks : largest->tasks;
		largest->samples = block.samples > largest->samples ? block.samples : largest->samples;
		row_size_max(&largest->rows, &block.rows);
	}
	if (first)
		first[n_blocks] = n_items;
	return n_blocks;
}

/* Number of blocks if all items have the same size.
 *
 * Returns  largest   largest block, with its checks
 * Test     service_estimates: the_memory_of_a_study_is_estimated
 */
int pound_blocks_alike(const struct pound_cells *campaign, struct pound_request_size item,
                       struct pound_request_size *largest)
{
	const struct pound_cells *c = campaign;
	const int n_items = pound_blocks_items(c);
	int n = block_runs(c->study) / item.asks;
	n = (int)fmin(fmax(1, fmin(n, (double)BLOCK_SAMPLES / (double)item.samples)),
	              c->trials ? c->n_signals : n_items);
	*largest = (struct pound_request_size){0};
	for (int i = 0; i < n; i++)
		size_add(largest, item, pound_cells_checks(c, i) < pound_cells_checks(c, i + 1));
	return (n_items + n - 1) / n;
}

/* Doubles of an item's measures. */
static size_t item_doubles(const struct pound_blocks *layout)
{
	return (size_t)layout->campaign->n_cells * (size_t)layout->campaign->n_samples *
	       (size_t)layout->n_measures;
}

/* Number of items stored before this one, counting checks as items. */
static size_t kept_before(const struct pound_blocks *layout, int item)
{
	return (size_t)item + (size_t)pound_cells_checks(layout->campaign, item);
}

/* Doubles of all blocks. */
size_t pound_blocks_doubles(const struct pound_blocks *layout)
{
	return kept_before(layout, pound_blocks_items(layout->campaign)) * item_doubles(layout) +
	       (size_t)layout->n_blocks * (size_t)layout->n_counts;
}

/* The block that holds an item; for the end of the items the number of blocks. */
int pound_blocks_block_of(const struct pound_blocks *layout, int item)
{
	int low = 0, high = layout->n_blocks + 1;
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		if (layout->first[middle] <= item)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* Pounding runs requested in a block. */
int64_t pound_blocks_block_runs(const struct pound_blocks *layout, int block)
{
	return (int64_t)(layout->first[block + 1] - layout->first[block]) * layout->campaign->n_cells *
	       layout->campaign->n_samples;
}

size_t pound_blocks_block_doubles(const struct pound_blocks *layout, int block)
{
	size_t n = kept_before(layout, layout->first[block + 1]) - kept_before(layout, layout->first[block]);
	return n * item_doubles(layout) + (size_t)layout->n_counts;
}

/* The start of a block's values. */
double *pound_blocks_block(const struct pound_blocks *layout, int block)
{
	return layout->values + kept_before(layout, layout->first[block]) * item_doubles(layout) +
	       (size_t)block * (size_t)layout->n_counts;
}

/* The start of its counts of work. */
const double *pound_blocks_counts(const struct pound_blocks *layout, int block)
{
	return pound_blocks_block(layout, block) + pound_blocks_block_doubles(layout, block) - layout->n_counts;
}

/* The measures of one run of the place-th item of a block. */
static double *place_values(const struct pound_blocks *layout, int block, int place, int cell, int sample)
{
	return pound_blocks_block(layout, block) + (size_t)place * item_doubles(layout) +
	       (size_t)(cell * layout->campaign->n_samples + sample) * (size_t)layout->n_measures;
}

/* The measures of one run. */
double *pound_blocks_run(const struct pound_blocks *layout, int item, int cell, int sample)
{
	int block = pound_blocks_block_of(layout, item);
	return place_values(layout, block, item - layout->first[block], cell, sample);
}

/* The measures of the check of a run. */
const double *pound_blocks_check(const struct pound_blocks *layout, int item, int cell, int sample)
{
	const struct pound_cells *c = layout->campaign;
	int block = pound_blocks_block_of(layout, item);
	int first = layout->first[block], n = layout->first[block + 1] - first;
	int place = n + pound_cells_checks(c, item) - pound_cells_checks(c, first);
	return place_values(layout, block, place, cell, sample);
}
