/* statistics_growth.c - designs that grow until every interval of S1 and ST is narrow: runs used, errors, and
 * coverage of the intervals at the stop. */
#include "tests/long/statistics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DESIGNS = 2, CELLS_MAX = 64, RUNS_MAX = 20000 };

static const char *const designs[DESIGNS] = {"lhs", "sobol"};

// wide enough for most designs to stop early, where repeated looks could bias the coverage
static const double HALF_WIDTH = 0.05;

struct cell {
	const struct function *function;
	int design;
	double runs; /* sums over the seeds */
	int narrow;  /* stopped because intervals were narrow */
	int decided; /* covering intervals of the deciding (widest) index */
	struct statistics_score score;
};

struct campaign {
	int n_seeds, n_cells;
	struct cell cells[CELLS_MAX];
};

static void seed_run(struct cell *cell, uint64_t seed)
{
	struct pound_design design = statistics_design(cell->design, 2, seed);
	design.until = (struct pound_until){.half_width = HALF_WIDTH, .max_runs = RUNS_MAX};
	const struct pound_study study = statistics_study(&design);
	struct pound_run *run = statistics_sure(pound_run_create(&study, 1));
	int rows = 0;
	do {
		statistics_assign(run, cell->function, rows, NULL);
		rows = pound_run_rows(run);
		pound_run_reduce(run, 0, 0);
	} while (pound_run_grow(run));
	const struct pound_result *result = pound_run_result(run);
	const struct pound_indices *indices = &result->cells[0].indices[0];
	cell->runs += (double)result->rows * pound_run_samples(run);
	const struct pound_look *last = &result->looks[result->n_looks - 1];
	cell->narrow += last->half_width <= HALF_WIDTH;
	const struct pound_estimate *widest = &indices->index[last->index][last->input];
	const double exact = cell->function->index[(last->index == POUND_ST ? FUNCTION_INPUTS : 0) + last->input];
	cell->decided += widest->low <= exact && exact <= widest->high;
	statistics_score_indices(&cell->score, cell->function, indices, POUND_S1, POUND_ST);
	pound_run_free(run);
}

static int design_named(const char *name)
{
	int design = 0;
	while (strcmp(pound_design_name(design), name))
		design++;
	return design;
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

static double least_covered(const struct cell *cell)
{
	double least = 1.0;
	for (int k = 0; k < STATISTICS_INDEXES; k++)
		least = fmin(least, cell->score.covered[k] / cell->score.n);
	return least;
}

static void numbers_print(double runs, double error, double covered, double least, double decided,
                          double narrow)
{
	printf(" %.0f | %.3f | %.3f (%.2f) | %.3f | %.2f |", runs, error, covered, least, decided, narrow);
}

static void cell_print(const struct cell *cell)
{
	double n = cell->score.n;
	numbers_print(cell->runs / n, statistics_error(&cell->score, -1), statistics_coverage(&cell->score, -1),
	              least_covered(cell), cell->decided / n, cell->narrow / n);
}

/* Means over all functions for one design. */
static void all_print(const struct campaign *c, int design)
{
	double runs = 0.0, error = 0.0, covered = 0.0, narrow = 0.0, decided = 0.0, least = 1.0;
	int n = 0;
	for (int k = 0; k < c->n_cells; k++) {
		const struct cell *cell = &c->cells[k];
		if (cell->design != design)
			continue;
		n++;
		runs += cell->runs / cell->score.n;
		error += statistics_error(&cell->score, -1);
		covered += statistics_coverage(&cell->score, -1);
		narrow += (double)cell->narrow / cell->score.n;
		decided += (double)cell->decided / cell->score.n;
		least = fmin(least, least_covered(cell));
	}
	numbers_print(runs / n, error / n, covered / n, least, decided / n, narrow / n);
}

/* Prints, for designs that grow to a half width of 0.05 within 20,000 runs: mean runs, root mean square error of all
 * eight indices, coverage of the intervals at the stop (of one index the least), coverage of the widest interval,
 * which decided, and how often the intervals were narrow enough. */
void statistics_growth(int n_seeds)
{
	static struct campaign c;
	c.n_seeds = n_seeds;
	for (int k = 0; statistics_function(k); k++)
		for (int d = 0; d < DESIGNS; d++)
			c.cells[c.n_cells++] =
			    (struct cell){.function = statistics_function(k), .design = design_named(designs[d])};
	statistics_jobs(c.n_cells, cell_run, &c);
	printf("\n| function |");
	for (int d = 0; d < DESIGNS; d++)
		printf(" %s runs | error | covered | widest covered | narrow |", designs[d]);
	printf("\n| --- |");
	for (int d = 0; d < DESIGNS; d++)
		printf(" --- | --- | --- | --- | --- |");
	for (int k = 0; k < c.n_cells; k++) {
		if (k == 0 || c.cells[k].function != c.cells[k - 1].function)
			printf("\n| %s |", c.cells[k].function->name);
		cell_print(&c.cells[k]);
	}
	printf("\n| all |");
	for (int d = 0; d < DESIGNS; d++)
		all_print(&c, design_named(designs[d]));
	printf("\n");
}
